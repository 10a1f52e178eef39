"""Kalker's simplified theory (FASTSIM, 1982) on elliptical patches.

Each point deforms alone, u_i = L_i tau_i, so that the strips along the rolling direction are independent. While little
of the patch slides, the flexibilities L_i reproduce the linear theory of the ellipse: L_y = 8 b/(3 G C11), and
L_x = 8 b/(3 G C22) under lateral creepage or pi b sqrt(b/a)/(4 G C23) under spin, with b the semi-axis in the rolling
direction. Where all points slide, they are those of `linear.sliding_flexibility`, which are exact for a distant spin
pole. Spiryagin et al. (2013) also let the flexibility depend on sliding.

Kalker (1982) divides the creepages by flexibilities instead. This moves the pole of the rigid slip: sliding tractions
turn the wrong way, and the work of the slip is not that of the creepages. Here the rigid slip stays unchanged.

ASSUME: the traction bound is mu p with Hertz's pressure, not the paraboloid of the original algorithm. With large spin
nearly all points slide, and the spin moment then follows the true pressure (Sichani et al. 2016 on the same choice in
FaStrip).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

import numpy as np

from trackroller.contact.common import Elastic, Ellipse, Resultants, SurfaceTractions
from trackroller.contact.fastsim.point import Strips, Totals, advance, enter, march, one_strip, write
from trackroller.contact.friction_laws import FrictionLaw, Knots, constant
from trackroller.contact.linear import creepage_coefficients, linear_resultants, sliding_flexibility
from trackroller.contact.slip import Creepage, Slip
from trackroller.numerics.compiled import compiled
from trackroller.numerics.threads import share_rows

# The flexibilities change from linear theory to full sliding with the creepages. Both numbers are fitted to the exact
# theory.
SLIDING_FORCE = 2.5  # forces of the linear theory over mu F_N at which half of the change is done
POLE_INSIDE = 0.9  # flexibility of sliding about the middle of the patch over that with the pole far away
SUBSTEPS = 4  # steps between the points of a grid of tractions


@dataclass(frozen=True)
class FastsimSettings:
    """Discretisation of the simplified theory.

    Parameters
    ----------
    strips : int
        Number of strips across an ellipse.
    steps : int
        Number of steps along a strip. A second pass with twice as many steps serves to extrapolate.
    points : int
        Points along each axis of the tractions.
    law : FrictionLaw
        Friction as a function of the slip speed.
    profile_slip : bool
        Use the rigid slip of the guide's profile, eq. (20), instead of its tangent xi + phi x.
    """

    strips: int = 32
    steps: int = 48
    points: int = 40
    law: FrictionLaw = field(default_factory=constant)
    profile_slip: bool = False


@dataclass(frozen=True)
class FastsimSolution:
    """Solution of n patches by the simplified theory.

    Attributes
    ----------
    resultants : Resultants
        Forces [N] and spin moment [N mm] on the roller, (n,).
    friction_energy_per_distance : ndarray, shape (n,)
        Dissipation per distance travelled [N].
    stick_fraction : ndarray, shape (n,)
        Share of the adhesion area in the patch [1].
    """

    resultants: Resultants
    friction_energy_per_distance: np.ndarray
    stick_fraction: np.ndarray


class Ellipses(NamedTuple):
    """Semi-axes a, b [mm] and largest traction bound mu p_max [MPa] of n ellipses, arrays (n,)."""

    a: np.ndarray
    b: np.ndarray
    bound: np.ndarray


@compiled
def _all_sums(ellipses, strips, rule, law, steps, totals, first, last):
    """Write the totals of the ellipses first..last; rule = strips over a and their weights."""
    nodes, weights = rule
    middles, bounds = np.empty(steps), np.empty(steps)
    for i in range(first, last):
        a, b, bound = ellipses.a[i], ellipses.b[i], ellipses.bound[i]
        knots, total = Knots(law.speed / strips.speed[i], law.factor), Totals(0.0, 0.0, 0.0, 0.0, 0.0)
        for k in range(nodes.size):
            edge = b * math.sqrt(1.0 - nodes[k] * nodes[k])
            h = 2.0 * edge / steps
            for j in range(steps):
                y = edge * (1.0 - 2.0 * (j + 1.0) / steps)
                middles[j] = y + 0.5 * h
                bounds[j] = bound * math.sqrt(max(1.0 - nodes[k] * nodes[k] - (y / b) * (y / b), 0.0))
            strip = one_strip(strips, i, k)
            total = march(total, strip, edge, h, weights[k] * a * h, middles, bounds, knots)
        write(totals, i, total)


@compiled
def _all_fields(ellipses, strips, law, shear, slip, first, last):
    """March from the leading edge; write tractions and slip (n, 2, points, points) at element centres."""
    points = shear.shape[2]
    middles, bounds = np.empty(SUBSTEPS), np.empty(SUBSTEPS)
    for i in range(first, last):
        b, knots = ellipses.b[i], Knots(law.speed / strips.speed[i], law.factor)
        for k in range(points):
            strip, u = one_strip(strips, i, k), (2.0 * k + 1.0) / points - 1.0
            y = b * math.sqrt(1.0 - u * u)
            state = enter(strip, y, knots)
            for j in range(points - 1, -1, -1):
                target = b * ((2.0 * j + 1.0) / points - 1.0)
                if target >= y or 1.0 - u * u <= (target / b) ** 2:
                    continue
                h = (y - target) / SUBSTEPS
                for m in range(SUBSTEPS):
                    y -= h
                    middles[m] = y + 0.5 * h
                    bounds[m] = ellipses.bound[i] * math.sqrt(max(1.0 - u * u - (y / b) * (y / b), 0.0))
                state = advance(strip, h, middles, bounds, knots, state)
                shear[i, 0, j, k], shear[i, 1, j, k] = state.shear_x, state.shear_y
                slip[i, 0, j, k], slip[i, 1, j, k] = state.slip_x, state.slip_y


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
    held = linear_resultants(a, b, creep, g, c)
    forces = np.hypot(held.driving_force, held.lateral_force)
    with np.errstate(divide="ignore", invalid="ignore"):
        slides = 1.0 / (1.0 + (SLIDING_FORCE * limit / forces) ** 2)
        pole = 1.0 / (1.0 + (phi * a) ** 2 / (xi**2 + eta**2))  # 1 far away, 0 in the middle
    share = np.where(forces > 0, slides, 0.0)
    far = sliding_flexibility(b / a, nu) * (b / g * (POLE_INSIDE + (1.0 - POLE_INSIDE) * np.nan_to_num(pole)))[:, None]
    return Flexibilities(l_x + share * (far[:, 0] - l_x), l_1 + share * (far[:, 1] - l_1), l_x / l_2)


def _problem(ellipse, creep: Creepage, friction, elastic: Elastic, travel_speed, places) -> tuple[Ellipses, Strips]:
    """Return n ellipses and their strips at `places` (m,) over a."""
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
            travel_speed,
        )
    )
    whole, x = Creepage(xi, eta, phi, creep.profile), a[:, None] * places
    flexible = flexibilities(a, b, 2.0 / 3.0 * np.pi * a * b * mu * p, whole, g, nu)
    flexible_x, flexible_y = (np.repeat(v[:, None], places.size, axis=1) for v in (flexible.x, flexible.y))
    along, lateral = np.ascontiguousarray(whole.along(x)), eta * flexible.over_lateral
    return Ellipses(a, b, mu * p), Strips(x, lateral, phi, along, flexible_x, flexible_y, speed)


def solve_patch(
    ellipse: Ellipse,
    creep: Creepage,
    friction,
    elastic: Elastic,
    settings: FastsimSettings | None = None,
    travel_speed=1.0,
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
        Numbers of strips and steps, and the friction law.
    travel_speed : array_like, shape (n,) or ()
        Travel speed for friction laws that are not constant [mm/s].

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
    rule, law = np.polynomial.legendre.leggauss(settings.strips), settings.law.knots
    ellipses, strips = _problem(ellipse, creep, friction, elastic, travel_speed, rule[0])
    # the error is of first order in the length of a step
    coarse, fine = (Totals(*(np.zeros(len(ellipses.a)) for _ in Totals._fields)) for _ in range(2))
    for totals, steps in ((coarse, settings.steps), (fine, 2 * settings.steps)):
        share_rows(partial(_all_sums, ellipses, strips, rule, law, steps, totals), len(ellipses.a), 4)
    area = np.pi * ellipses.a * ellipses.b
    known = np.isfinite(area * ellipses.bound)
    best = Totals(*(np.where(known, 2.0 * f - c, np.nan) for c, f in zip(coarse, fine, strict=True)))
    with np.errstate(divide="ignore", invalid="ignore"):
        stick = fine.adhesion / area
    return FastsimSolution(Resultants(best.lateral, best.driving, best.moment), best.dissipation, stick)


def tractions(
    ellipse: Ellipse,
    slip: Slip,
    friction,
    elastic: Elastic,
    settings: FastsimSettings | None = None,
    travel_speed=1.0,
) -> SurfaceTractions:
    """Return Hertz's pressure, shear and slip at points x points element centres, 0 outside the ellipse.

    Parameters are those of `solve_patch`; `slip` has the kinematics of the patches, arrays (n,).
    """
    settings = settings or FastsimSettings()
    law, points = settings.law.knots, settings.points
    u = (2.0 * np.arange(points) + 1.0) / points - 1.0
    creep = Creepage.of_slip(slip, settings.profile_slip)
    ellipses, strips = _problem(ellipse, creep, friction, elastic, travel_speed, u)
    shear, moved = (np.zeros((len(strips.x), 2, points, points)) for _ in range(2))
    share_rows(partial(_all_fields, ellipses, strips, law, shear, moved), len(strips.x), 4)
    x, y, pressure = ellipse.grid(points)
    stick = (pressure > 0) & (moved == 0.0).all(axis=1)
    return SurfaceTractions(x, y, pressure, shear[:, 0], shear[:, 1], moved[:, 0], moved[:, 1], stick)
