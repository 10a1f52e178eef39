"""Kalker's simplified theory (FASTSIM, 1982): each point deforms alone, so that strips are independent.

The displacement is u_i = L_i tau_i with a flexibility for either direction. While little slides they reproduce the
linear theory of the elliptical patch: L_y = 8 b/(3 G C11), and L_x = 8 b/(3 G C22) under lateral creepage,
pi b sqrt(b/a)/(4 G C23) under spin, b the semi-axis in the rolling direction. Kalker (1982) divides the creepages by
flexibilities of their own instead, and with that moves the pole of the rigid slip: sliding tractions turn the wrong
way, and the work of the slip is not that of the creepages. Here the rigid slip stays what it is.
Where all slides the flexibilities are those of `linear.sliding_flexibility`, exact with the pole of the slip far away
(flexibility that depends on sliding: Spiryagin et al. 2013).
ASSUME: the traction bound is mu p with Hertz's pressure, not the paraboloid of the original algorithm: with large
spin nearly everything slides, and the spin moment then follows the true pressure (Sichani et al. 2016 on the same
choice in FaStrip).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit

from trackroller.contact.common import Elastic, Ellipse, Resultants, Slip, SurfaceTractions
from trackroller.contact.fastsim.point import Totals, add, enter, extrapolated, step, write
from trackroller.contact.friction_laws import FrictionLaw, Knots, constant
from trackroller.contact.linear import creepage_coefficients, sliding_flexibility
from trackroller.contact.slip import Creepage
from trackroller.numerics.threads import share_rows

# Between linear theory and full sliding the flexibilities change with the creepages; fitted to the exact theory.
SLIDING_FORCE = 2.5  # forces of the linear theory over mu F_N at which half of the change is done
POLE_INSIDE = 0.9  # flexibility of sliding about the middle of the patch over that with the pole far away
SUBSTEPS = 4  # between the points of a grid of tractions


@dataclass(frozen=True)
class FastsimSettings:
    """strips across the patch, steps along each (a second pass with twice as many serves extrapolation),

    points of a traction grid, `parabolic` for the traction bound of the original algorithm, friction law and the
    travel speed [mm/s] where a call does not give its own; profile_slip as in `kalker.KalkerSettings`.
    """

    strips: int = 32
    steps: int = 48
    points: int = 40
    parabolic: bool = False
    law: FrictionLaw | None = None
    travel_speed: float = 1.0
    profile_slip: bool = False


@njit(cache=True)
def _bound(x, y, parabolic):
    square = max(1.0 - x * x - y * y, 0.0)
    return 4.0 / 3.0 * square if parabolic else math.sqrt(square)


class Strips(NamedTuple):
    """Ellipses and their strips, arrays (n,) unless stated, or one ellipse.

    a, b [mm]; bound : mu p_max [MPa]; along (n, m) : rolling part of the rigid slip in each strip; lateral, spin : its
    lateral part is lateral - spin y; flexible_x, flexible_y : flexibilities [mm/MPa]; speed : travel speed [mm/s];
    parabolic : traction bound of the original algorithm.
    """

    a: np.ndarray
    b: np.ndarray
    bound: np.ndarray
    along: np.ndarray
    lateral: np.ndarray
    spin: np.ndarray
    flexible_x: np.ndarray
    flexible_y: np.ndarray
    speed: np.ndarray
    parabolic: bool


@njit(cache=True)
def _one(strips, i):
    """Return ellipse i of a batch."""
    a, b, bound, along, lateral, spin, flexible_x, flexible_y, speed, parabolic = strips
    return Strips(
        a[i], b[i], bound[i], along[i], lateral[i], spin[i], flexible_x[i], flexible_y[i], speed[i], parabolic
    )


@njit(cache=True)
def _sums(e, steps, nodes, weights, law):
    """Add up the totals of one ellipse from its strips at `nodes` over a."""
    total = Totals(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for i in range(nodes.size):
        u = nodes[i]
        length = math.sqrt(1.0 - u * u)
        x, h, wy = e.a * u, 2.0 * e.b * length / steps, e.along[i]
        state = enter(e.lateral - e.spin * e.b * length, wy, law)
        for j in range(steps):
            y = e.b * length * (1.0 - 2.0 * (j + 1.0) / steps)
            g, middle = e.bound * _bound(u, y / e.b, e.parabolic), y + 0.5 * h
            new = step(e.lateral - e.spin * middle, wy, h, e.flexible_x, e.flexible_y, g, law, state)
            total = add(total, state, new, x, middle, weights[i] * e.a * h, g)
            state = new
    return total


@njit(cache=True, nogil=True)
def _all_sums(first, last, strips, steps, nodes, weights, law, totals):
    for i in range(first, last):
        e = _one(strips, i)
        write(totals, i, _sums(e, steps, nodes, weights, Knots(law.speed / e.speed, law.factor)))


@njit(cache=True, nogil=True)
def _all_fields(first, last, strips, law, shear, slip):
    """March from the leading edge; write tractions and slip (n, 2, points, points) at element centres."""
    points = shear.shape[2]
    for i in range(first, last):
        e = _one(strips, i)
        knots = Knots(law.speed / e.speed, law.factor)
        for k in range(points):
            u = (2.0 * k + 1.0) / points - 1.0
            y, wy = e.b * math.sqrt(1.0 - u * u), e.along[k]
            state = enter(e.lateral - e.spin * y, wy, knots)
            for j in range(points - 1, -1, -1):
                target = e.b * ((2.0 * j + 1.0) / points - 1.0)
                if target >= y or 1.0 - u * u <= (target / e.b) ** 2:
                    continue
                h = (y - target) / SUBSTEPS
                for _ in range(SUBSTEPS):
                    y -= h
                    g = e.bound * _bound(u, y / e.b, e.parabolic)
                    wx = e.lateral - e.spin * (y + 0.5 * h)
                    state = step(wx, wy, h, e.flexible_x, e.flexible_y, g, knots, state)
                shear[i, 0, j, k], shear[i, 1, j, k] = state.shear_x, state.shear_y
                slip[i, 0, j, k], slip[i, 1, j, k] = state.slip_x, state.slip_y


@dataclass(frozen=True)
class FastsimSolution:
    """Arrays (n,): resultants on the roller, friction_energy_per_distance [N], stick_fraction and friction_change.

    friction_change : how far the friction of a falling law is from that of the local slip, mean over the bound [-]
    """

    resultants: Resultants
    friction_energy_per_distance: np.ndarray
    stick_fraction: np.ndarray
    friction_change: np.ndarray


class Flexibilities(NamedTuple):
    """Flexibilities of x and y [mm/MPa], and that of x over the one under lateral creepage alone [1]; (n,)."""

    x: np.ndarray
    y: np.ndarray
    over_lateral: np.ndarray


def flexibilities(a, b, limit, creep: Creepage, shear_modulus, poisson_ratio) -> Flexibilities:
    """Return the flexibilities of n ellipses, between those of the linear theory and those of full sliding.

    Parameters
    ----------
    a, b : ndarray, shape (n,)
        Semi-axes across and along the rolling direction [mm].
    limit : ndarray, shape (n,)
        mu F_N [N].
    creep : Creepage
        Creepages about the middle of the ellipse, arrays (n,).
    shear_modulus, poisson_ratio : ndarray, shape (n,)
        Combined constants [MPa], [1].

    Raises
    ------
    InputError
        For axis ratios beyond the linear coefficients.
    """
    xi, eta, phi, g, nu = creep.longitudinal, creep.lateral, creep.spin, shear_modulus, poisson_ratio
    c = creepage_coefficients(b / a, nu)
    l_1, l_2 = 8.0 * b / (3.0 * g * c.c11), 8.0 * b / (3.0 * g * c.c22)
    l_3 = np.pi * b * np.sqrt(b / a) / (4.0 * g * c.c23)
    across, turn = np.abs(eta), np.sqrt(a * b) * np.abs(phi)
    both = across + turn
    l_x = np.where(both > 0, (across * l_2 + turn * l_3) / np.where(both > 0, both, 1.0), l_2)
    # forces of the linear theory over the largest force: a measure of how much of the patch slides
    square = a * b * g
    forces = np.hypot(square * c.c11 * xi, square * (c.c22 * eta - np.sqrt(a * b) * c.c23 * phi))
    with np.errstate(divide="ignore", invalid="ignore"):
        slides = 1.0 / (1.0 + (SLIDING_FORCE * limit / forces) ** 2)
        pole = 1.0 / (1.0 + (phi * a) ** 2 / (xi**2 + eta**2))  # 1 far away, 0 in the middle
    share = np.where(forces > 0, slides, 0.0)
    far = sliding_flexibility(b / a, nu) * (b / g * (POLE_INSIDE + (1.0 - POLE_INSIDE) * np.nan_to_num(pole)))[:, None]
    return Flexibilities(l_x + share * (far[:, 0] - l_x), l_1 + share * (far[:, 1] - l_1), l_x / l_2)


def _strips(ellipse, creep: Creepage, friction, elastic: Elastic, settings, travel_speed, places) -> Strips:
    """Return the strips of n ellipses at `places` (m,) over a."""
    a, b, p, xi, eta, phi, mu, g, nu, speed = (
        np.array(v, float, order="C")
        for v in np.broadcast_arrays(
            ellipse.semi_axis_lateral,
            ellipse.semi_axis_rolling,
            ellipse.max_pressure,
            creep.longitudinal,
            creep.lateral,
            creep.spin,
            friction,
            elastic.shear_modulus,
            elastic.poisson_ratio,
            settings.travel_speed if travel_speed is None else travel_speed,
        )
    )
    whole = Creepage(xi, eta, phi, creep.profile)
    flexible = flexibilities(a, b, 2.0 / 3.0 * np.pi * a * b * mu * p, whole, g, nu)
    along, lateral = np.ascontiguousarray(whole.along(a[:, None] * places)), eta * flexible.over_lateral
    return Strips(a, b, mu * p, along, lateral, phi, flexible.x, flexible.y, speed, settings.parabolic)


def _totals(strips: Strips, steps: int, nodes: np.ndarray, weights: np.ndarray, law: Knots) -> Totals[np.ndarray]:
    """Return the totals of all ellipses with `steps` steps along each strip."""
    n = strips.a.size
    totals = Totals(*(np.empty(n) for _ in Totals._fields))
    share_rows(lambda first, last: _all_sums(first, last, strips, steps, nodes, weights, law, totals), n, 8)
    return totals


def solve_patch(
    ellipse: Ellipse,
    creep: Creepage,
    friction,
    elastic: Elastic,
    settings: FastsimSettings | None = None,
    travel_speed=None,
) -> FastsimSolution:
    """Solve n elliptical patches in steady rolling by the simplified theory.

    Parameters
    ----------
    ellipse : Ellipse
        Hertzian patches, arrays (n,) [mm], [MPa].
    creep : Creepage
        Rigid slip w = (eta - phi y, xi + phi x), arrays (n,) or scalars [1], [1/mm].
    friction : array_like, shape (n,) or ()
        Friction coefficient mu [1].
    elastic : Elastic
        Combined elastic constants, arrays (n,). The coupling constant is not used.
    settings : FastsimSettings, optional
        Numbers of strips and steps, friction law and travel speed.
    travel_speed : array_like, shape (n,) or (), optional
        Travel speed for friction laws [mm/s]; default: that of the settings.

    Returns
    -------
    FastsimSolution
        Resultants on the roller [N], [N mm], dissipation [N] and adhesion share [1], arrays (n,).

    Notes
    -----
    Valid for axis ratios b/a of 0.2 to 5 and small lateral creepage beside spin; the validation pages state the error
    against the exact theory. The patches are solved with the number of steps and with twice this number, and the two
    solutions are extrapolated.

    References
    ----------
    Kalker, J. J. (1982). A fast algorithm for the simplified theory of rolling contact. Vehicle System Dynamics 11,
    1-13.
    """
    settings = settings or FastsimSettings()
    law = (settings.law or constant()).knots
    nodes, weights = np.polynomial.legendre.leggauss(settings.strips)
    strips = _strips(ellipse, creep, friction, elastic, settings, travel_speed, nodes)
    coarse, fine = (_totals(strips, steps, nodes, weights, law) for steps in (settings.steps, 2 * settings.steps))
    best = extrapolated(coarse, fine)
    force = 2.0 / 3.0 * np.pi * strips.a * strips.b * strips.bound
    return FastsimSolution(
        Resultants(best.lateral, best.driving, best.moment),
        best.dissipation,
        fine.adhesion / (np.pi * strips.a * strips.b),
        fine.lack / np.where(force > 0, force, 1.0),
    )


def resultants(
    ellipse: Ellipse, slip: Slip, friction, elastic: Elastic, settings: FastsimSettings | None = None
) -> Resultants:
    """Friction forces [N] and spin moment [N mm] on the roller, shape (n,); see `solve_patch`."""
    settings = settings or FastsimSettings()
    return solve_patch(ellipse, Creepage.of_slip(slip, settings.profile_slip), friction, elastic, settings).resultants


def tractions(
    ellipse: Ellipse,
    slip: Slip,
    friction,
    elastic: Elastic,
    settings: FastsimSettings | None = None,
    travel_speed=None,
) -> SurfaceTractions:
    """Pressure (of Hertz), shear and slip at points x points element centres; 0 outside the ellipse."""
    settings = settings or FastsimSettings()
    law, points = (settings.law or constant()).knots, settings.points
    u = (2.0 * np.arange(points) + 1.0) / points - 1.0
    creep = Creepage.of_slip(slip, settings.profile_slip)
    strips = _strips(ellipse, creep, friction, elastic, settings, travel_speed, u)
    a, b = strips.a, strips.b
    shear, moved = (np.zeros((a.size, 2, points, points)) for _ in range(2))
    share_rows(lambda first, last: _all_fields(first, last, strips, law, shear, moved), a.size, 4)
    root = np.sqrt(np.maximum(1.0 - u[None, :] ** 2 - u[:, None] ** 2, 0.0))
    pressure = np.broadcast_to(ellipse.max_pressure, a.shape)[:, None, None] * root
    stick = (root > 0) & (moved[:, 0] == 0.0) & (moved[:, 1] == 0.0)
    return SurfaceTractions(
        a[:, None] * u, b[:, None] * u, pressure, shear[:, 0], shear[:, 1], moved[:, 0], moved[:, 1], stick
    )
