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
from functools import partial

import numpy as np
from numba import njit

from trackroller.contact.common import Elastic, Ellipse, Resultants, Slip, SurfaceTractions
from trackroller.contact.fastsim.point import enter, step
from trackroller.contact.friction_laws import FrictionLaw, constant
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


@njit(cache=True)
def _patch(a, b, scale, rigid, bend, flexibility, steps, nodes, weights, parabolic, knots, factors, total):
    """F_T, F_A, M_R, dissipation per distance, share of stick and lack of friction of one patch into `total` (6,).

    rigid = (xi, eta, phi): rigid slip w = (eta - phi y, xi + phi x + bend), bend of each strip.
    """
    state = np.zeros(6)
    for k in range(6):
        total[k] = 0.0
    for i in range(nodes.size):
        u = nodes[i]
        length = math.sqrt(1.0 - u * u)
        x, h = a * u, 2.0 * b * length / steps
        wy = rigid[0] + rigid[2] * x + bend[i]
        enter(rigid[1] - rigid[2] * b * length, wy, knots, factors, state)
        for j in range(steps):
            y = b * length * (1.0 - 2.0 * (j + 1.0) / steps)
            before_x, before_y = state[0], state[1]
            g = scale * _bound(u, y / b, parabolic)
            step(rigid[1] - rigid[2] * (y + 0.5 * h), wy, h, flexibility, g, knots, factors, state)
            area = weights[i] * a * h
            mean_x, mean_y, middle = 0.5 * (before_x + state[0]), 0.5 * (before_y + state[1]), y + 0.5 * h
            total[0] += area * mean_x
            total[1] += area * mean_y
            total[2] += area * (x * mean_y - middle * mean_x)
            total[3] -= area * (mean_x * state[2] + mean_y * state[3])
            if state[2] == 0.0 and state[3] == 0.0:
                total[4] += area / (math.pi * a * b)
            total[5] += area * g * state[5]


@njit(cache=True, nogil=True)
def _all_patches(
    rows, a, b, scale, rigid, bend, flexibility, travel, steps, nodes, weights, parabolic, knots, factors, totals
):
    for i in range(rows[0], rows[1]):
        _patch(
            a[i],
            b[i],
            scale[i],
            rigid[i],
            bend[i],
            flexibility[i],
            steps,
            nodes,
            weights,
            parabolic,
            knots / travel[i],
            factors,
            totals[i],
        )


@njit(cache=True, nogil=True)
def _all_fields(rows, a, b, scale, rigid, bend, flexibility, travel, points, parabolic, knots, factors, shear, slip):
    """Tractions and slip (n, 2, points, points) at element centres, marched from the leading edge of each strip."""
    for i in range(rows[0], rows[1]):
        speeds = knots / travel[i]
        state = np.zeros(6)
        for k in range(points):
            u = (2.0 * k + 1.0) / points - 1.0
            y, x = b[i] * math.sqrt(1.0 - u * u), a[i] * u
            wy = rigid[i, 0] + rigid[i, 2] * x + bend[i, k]
            enter(rigid[i, 1] - rigid[i, 2] * y, wy, speeds, factors, state)
            for j in range(points - 1, -1, -1):
                target = b[i] * ((2.0 * j + 1.0) / points - 1.0)
                if target >= y or 1.0 - u * u <= (target / b[i]) ** 2:
                    continue
                h = (y - target) / SUBSTEPS
                for _ in range(SUBSTEPS):
                    y -= h
                    g = scale[i] * _bound(u, y / b[i], parabolic)
                    wx = rigid[i, 1] - rigid[i, 2] * (y + 0.5 * h)
                    step(wx, wy, h, flexibility[i], g, speeds, factors, state)
                shear[i, 0, j, k], shear[i, 1, j, k] = state[0], state[1]
                slip[i, 0, j, k], slip[i, 1, j, k] = state[2], state[3]


@dataclass(frozen=True)
class FastsimSolution:
    """Arrays (n,): resultants on the roller, friction_energy_per_distance [N], stick_fraction and friction_change.

    friction_change : how far the friction of a falling law is from that of the local slip, mean over the bound [-]
    """

    resultants: Resultants
    friction_energy_per_distance: np.ndarray
    stick_fraction: np.ndarray
    friction_change: np.ndarray


def flexibilities(a, b, limit, rigid, shear_modulus, poisson_ratio) -> tuple[np.ndarray, np.ndarray]:
    """Flexibilities of x and y (n, 2) [mm/MPa], and that of x over the one under lateral creepage alone, (n,) [-].

    Parameters
    ----------
    a, b : semi-axes across and along the rolling direction [mm], (n,)
    limit : mu F_N [N], (n,)
    rigid : xi, eta [-] and phi [1/mm] about the middle of the ellipse, (n, 3)
    shear_modulus, poisson_ratio : combined constants [MPa], [-], (n,)

    Raises `InputError` for axis ratios beyond the linear coefficients.
    """
    (xi, eta, phi), g, nu = rigid.T, shear_modulus, poisson_ratio
    c = creepage_coefficients(b / a, nu)
    l_1, l_2 = 8.0 * b / (3.0 * g * c.c11), 8.0 * b / (3.0 * g * c.c22)
    l_3 = np.pi * b * np.sqrt(b / a) / (4.0 * g * c.c23)
    across, turn = np.abs(eta), np.sqrt(a * b) * np.abs(phi)
    both = across + turn
    l_x = np.where(both > 0, (across * l_2 + turn * l_3) / np.where(both > 0, both, 1.0), l_2)
    sticking = np.stack([l_x, l_1], axis=1)
    # the forces of the linear theory over the largest: a measure of how much slides
    square = a * b * g
    forces = np.hypot(square * c.c11 * xi, square * (c.c22 * eta - np.sqrt(a * b) * c.c23 * phi))
    with np.errstate(divide="ignore", invalid="ignore"):
        slides = 1.0 / (1.0 + (SLIDING_FORCE * limit / forces) ** 2)
        pole = 1.0 / (1.0 + (phi * a) ** 2 / (xi**2 + eta**2))  # 1 far away, 0 in the middle
    share = np.where(forces > 0, slides, 0.0)[:, None]
    far = sliding_flexibility(b / a, nu) * (b / g * (POLE_INSIDE + (1.0 - POLE_INSIDE) * np.nan_to_num(pole)))[:, None]
    return sticking + share * (far - sticking), l_x / l_2


def _problem(ellipse: Ellipse, creep: Creepage, friction, elastic: Elastic):
    """Arrays a, b, mu p_max, rigid slips (n, 3) and flexibilities (n, 2: x, y) [mm/MPa] of n patches."""
    a, b, p, xi, eta, phi, mu, g, nu = (
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
        )
    )
    limit = 2.0 / 3.0 * np.pi * a * b * mu * p
    flexibility, across = flexibilities(a, b, limit, np.stack([xi, eta, phi], axis=1), g, nu)
    return a, b, mu * p, np.stack([xi, eta * across, phi], axis=1), flexibility


def _bend(profile: Slip | None, a: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Rolling slip that the guide's profile adds in the strips at `places` (m,) over a, shape (n, m)."""
    if profile is None:
        return np.zeros((a.size, places.size))
    return np.ascontiguousarray(profile.beyond_tangent(a[:, None] * places))


def _rows_of(function, rest: tuple, first: int, last: int) -> None:
    function((first, last), *rest)


def _travel(travel_speed, settings: FastsimSettings, n: int) -> np.ndarray:
    given = settings.travel_speed if travel_speed is None else travel_speed
    return np.array(np.broadcast_to(np.asarray(given, float), n), order="C")


def solve_patch(
    ellipse: Ellipse,
    creep: Creepage,
    friction,
    elastic: Elastic,
    settings: FastsimSettings | None = None,
    travel_speed=None,
) -> FastsimSolution:
    """Simplified theory for n patches with rigid slip w = (eta - phi y, xi + phi x).

    Parameters
    ----------
    ellipse : Hertzian patches, arrays (n,)
    creep : creepages, (n,) or scalars
    friction : coefficient mu [-], (n,) or scalar
    elastic : combined constants; the coupling constant is not used
    travel_speed : [mm/s], (n,) or scalar, for friction laws; that of the settings if not given

    Errors against the exact theory, axis ratios of 0.2 to 5, creepages from stick to sliding (root mean square, worst):
    2.4 and 8 % of mu F_N in the lateral force, 1.4 and 5 % in the driving force, 1.2 and 6 % of mu F_N sqrt(ab) in
    the moment (tests/test_fastsim.py). Beyond these axis ratios, and with lateral creepage beside spin, which no
    roller has, up to 16 % in the lateral force.
    """
    settings = settings or FastsimSettings()
    law = settings.law or constant()
    a, b, scale, rigid, flexibility = _problem(ellipse, creep, friction, elastic)
    nodes, weights = np.polynomial.legendre.leggauss(settings.strips)
    totals, bend = np.empty((2, a.size, 6)), _bend(creep.profile, a, nodes)
    travel = _travel(travel_speed, settings, a.size)
    for k, steps in enumerate((settings.steps, 2 * settings.steps)):
        rest = (
            a,
            b,
            scale,
            rigid,
            bend,
            flexibility,
            travel,
            steps,
            nodes,
            weights,
            settings.parabolic,
            law.speed,
            law.factor,
            totals[k],
        )
        share_rows(partial(_rows_of, _all_patches, rest), a.size, 8)
    force = 2.0 / 3.0 * np.pi * a * b * scale
    lack = totals[1, :, 5] / np.where(force > 0, force, 1.0)
    best = 2.0 * totals[1] - totals[0]  # the steps are of first order
    return FastsimSolution(Resultants(best[:, 0], best[:, 1], best[:, 2]), best[:, 3], totals[1, :, 4], lack)


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
    law = settings.law or constant()
    a, b, scale, rigid, flexibility = _problem(ellipse, Creepage.of_slip(slip), friction, elastic)
    points = settings.points
    shear, moved = (np.zeros((a.size, 2, points, points)) for _ in range(2))
    u = (2.0 * np.arange(points) + 1.0) / points - 1.0
    bend = _bend(slip if settings.profile_slip else None, a, u)
    rest = (
        a,
        b,
        scale,
        rigid,
        bend,
        flexibility,
        _travel(travel_speed, settings, a.size),
        points,
        settings.parabolic,
        law.speed,
        law.factor,
        shear,
        moved,
    )
    share_rows(partial(_rows_of, _all_fields, rest), a.size, 4)
    root = np.sqrt(np.maximum(1.0 - u[None, :] ** 2 - u[:, None] ** 2, 0.0))
    pressure = np.broadcast_to(ellipse.max_pressure, a.shape)[:, None, None] * root
    stick = (root > 0) & (moved[:, 0] == 0.0) & (moved[:, 1] == 0.0)
    return SurfaceTractions(
        a[:, None] * u, b[:, None] * u, pressure, shear[:, 0], shear[:, 1], moved[:, 0], moved[:, 1], stick
    )
