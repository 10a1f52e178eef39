"""Kalker's simplified theory (FASTSIM, 1982): each point deforms alone, u = L tau, so that strips are independent.

The flexibilities reproduce the linear theory for the elliptical patch: L1 = 8 b/(3 G C11), L2 = 8 b/(3 G C22),
L3 = pi b sqrt(b/a)/(4 G C23) with b the semi-axis in the rolling direction, one for each creepage (Kalker 1982).
ASSUME: the traction bound is mu p with Hertz's pressure, not the paraboloid of the original algorithm: with large
spin nearly everything slides, and the spin moment then follows the true pressure (Sichani et al. 2016 on the same
choice in FaStrip). What large spin adds to the lateral force stays off by some 10 %; the exact theory has it right.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from trackroller.contact.common import Elastic, Ellipse, Resultants, Slip, SurfaceTractions
from trackroller.contact.friction_laws import FrictionLaw, constant
from trackroller.contact.linear import creepage_coefficients
from trackroller.threads import share_rows

SWEEPS = 30  # halvings of the interval in which a step finds the friction of its slip speed
SUBSTEPS = 4  # between the points of a grid of tractions


@dataclass(frozen=True)
class FastsimSettings:
    """strips across the patch, steps along each (a second pass with twice as many serves extrapolation),

    points of a traction grid, `parabolic` for the traction bound of the original algorithm, friction law and the
    travel speed [mm/s] where a call does not give its own.
    """

    strips: int = 32
    steps: int = 48
    points: int = 40
    parabolic: bool = False
    law: FrictionLaw | None = None
    travel_speed: float = 1.0


@njit(cache=True)
def _step(tx, ty, dx, dy, h, flexibility, bound, speeds, factors, out):
    """One step: tractions (tx, ty) with drives w/L (dx, dy) over h; out = tau_x, tau_y, s_x, s_y, friction change."""
    trial_x, trial_y = tx - h * dx, ty - h * dy
    trial = math.hypot(trial_x, trial_y)
    friction = factors[0]
    if speeds.size > 1 and trial > 0.0:
        # a falling law may be met more than once: halving the interval finds one of them for sure
        low, high = factors.min(), factors.max()
        for _ in range(SWEEPS):
            friction = 0.5 * (low + high)
            speed = flexibility * max(trial - bound * friction, 0.0) / h
            if np.interp(speed, speeds, factors) < friction:
                high = friction
            else:
                low = friction
        if trial > bound * friction:
            out[4] = max(out[4], (high - low) / factors.max())
    g = bound * friction
    share = g / trial if trial > g else 1.0
    out[0], out[1] = share * trial_x, share * trial_y
    out[2] = -flexibility * (1.0 - share) * trial_x / h
    out[3] = -flexibility * (1.0 - share) * trial_y / h


@njit(cache=True)
def _bound(x, y, parabolic):
    square = max(1.0 - x * x - y * y, 0.0)
    return 4.0 / 3.0 * square if parabolic else math.sqrt(square)


@njit(cache=True)
def _patch(a, b, scale, drive, flexibility, steps, nodes, weights, parabolic, speeds, factors, total):
    """F_T, F_A, M_R, dissipation per distance and share of stick of one patch into `total` (6,).

    drive = (xi/L1, eta/L2, phi/L3) [MPa/mm, MPa/mm, MPa/mm^2].
    """
    out = np.zeros(5)
    for k in range(6):
        total[k] = 0.0
    for i in range(nodes.size):
        u = nodes[i]
        length = math.sqrt(1.0 - u * u)
        x, h = a * u, 2.0 * b * length / steps
        tx, ty = 0.0, 0.0
        for j in range(steps):
            y = b * length * (1.0 - 2.0 * (j + 1.0) / steps)
            before_x, before_y = tx, ty
            g = scale * _bound(u, y / b, parabolic)
            _step(tx, ty, drive[1] - drive[2] * y, drive[0] + drive[2] * x, h, flexibility, g, speeds, factors, out)
            tx, ty = out[0], out[1]
            area = weights[i] * a * h
            mean_x, mean_y, middle = 0.5 * (before_x + tx), 0.5 * (before_y + ty), y + 0.5 * h
            total[0] += area * mean_x
            total[1] += area * mean_y
            total[2] += area * (x * mean_y - middle * mean_x)
            total[3] -= area * (mean_x * out[2] + mean_y * out[3])
            if out[2] == 0.0 and out[3] == 0.0:
                total[4] += area / (math.pi * a * b)
    total[5] = out[4]


@njit(cache=True, nogil=True)
def _all_patches(rows, a, b, scale, drive, flexibility, travel, steps, nodes, weights, parabolic, speeds, factors,
                 totals):  # fmt: skip
    for i in range(rows[0], rows[1]):
        _patch(a[i], b[i], scale[i], drive[i], flexibility[i], steps, nodes, weights, parabolic, speeds / travel[i],
               factors, totals[i])  # fmt: skip


@njit(cache=True, nogil=True)
def _all_fields(rows, a, b, scale, drive, flexibility, travel, points, parabolic, knots, factors, shear, slip):
    """Tractions and slip (n, 2, points, points) at element centres, marched from the leading edge of each strip."""
    for i in range(rows[0], rows[1]):
        speeds = knots / travel[i]
        out = np.zeros(5)
        for k in range(points):
            u = (2.0 * k + 1.0) / points - 1.0
            y, x = b[i] * math.sqrt(1.0 - u * u), a[i] * u
            tx, ty = 0.0, 0.0
            for j in range(points - 1, -1, -1):
                target = b[i] * ((2.0 * j + 1.0) / points - 1.0)
                if target >= y or 1.0 - u * u <= (target / b[i]) ** 2:
                    continue
                h = (y - target) / SUBSTEPS
                for _ in range(SUBSTEPS):
                    y -= h
                    g = scale[i] * _bound(u, y / b[i], parabolic)
                    _step(tx, ty, drive[i, 1] - drive[i, 2] * y, drive[i, 0] + drive[i, 2] * x, h, flexibility[i], g,
                          speeds, factors, out)  # fmt: skip
                    tx, ty = out[0], out[1]
                shear[i, 0, j, k], shear[i, 1, j, k] = tx, ty
                slip[i, 0, j, k], slip[i, 1, j, k] = out[2], out[3]


@dataclass(frozen=True)
class FastsimSolution:
    """resultants on the roller; friction_energy_per_distance [N]; stick_fraction; last friction change; arrays (n,)."""

    resultants: Resultants
    friction_energy_per_distance: np.ndarray
    stick_fraction: np.ndarray
    friction_change: np.ndarray


def _problem(ellipse: Ellipse, longitudinal, lateral, spin, friction, elastic: Elastic):
    """Arrays a, b, mu p_max, drives (n, 3) and the mean flexibility [mm/MPa] of n patches."""
    a, b, p, xi, eta, phi, mu, g, nu = (np.array(v, float, order="C") for v in np.broadcast_arrays(
        ellipse.semi_axis_lateral, ellipse.semi_axis_rolling, ellipse.max_pressure, longitudinal, lateral, spin,
        friction, elastic.shear_modulus, elastic.poisson_ratio))  # fmt: skip
    c = creepage_coefficients(b / a, nu)
    l_1, l_2 = 8.0 * b / (3.0 * g * c.c11), 8.0 * b / (3.0 * g * c.c22)
    l_3 = np.pi * b * np.sqrt(b / a) / (4.0 * g * c.c23)
    # mean flexibility for the slip, Kalker (1990) eq. (3.77): weighted with the creepages
    size = np.stack([np.abs(xi), np.abs(eta), np.sqrt(a * b) * np.abs(phi)])
    norm = np.sqrt((size**2).sum(axis=0))
    weighted = size[0] * l_1 + size[1] * l_2 + size[2] * l_3
    flexibility = np.where(norm > 0, weighted / np.where(norm > 0, norm, 1.0), l_1)
    return a, b, mu * p, np.stack([xi / l_1, eta / l_2, phi / l_3], axis=1), flexibility


def _travel(travel_speed, settings: FastsimSettings, n: int) -> np.ndarray:
    given = settings.travel_speed if travel_speed is None else travel_speed
    return np.array(np.broadcast_to(np.asarray(given, float), n), order="C")


def solve_patch(
    ellipse: Ellipse, longitudinal, lateral, spin, friction, elastic: Elastic,
    settings: FastsimSettings | None = None, travel_speed=None,
) -> FastsimSolution:  # fmt: skip
    """Simplified theory for n patches with rigid slip w = (eta - phi y, xi + phi x).

    Parameters
    ----------
    ellipse : Hertzian patches, arrays (n,)
    longitudinal, lateral, spin : xi, eta [-], phi [1/mm], (n,) or scalars
    friction : coefficient mu [-], (n,) or scalar
    elastic : combined constants; the coupling constant is not used
    travel_speed : [mm/s], (n,) or scalar, for friction laws; that of the settings if not given

    Errors against the exact theory: within 5 % without spin, 10 to 15 % of the lateral force with large spin.
    """
    settings = settings or FastsimSettings()
    law = settings.law or constant()
    a, b, scale, drive, flexibility = _problem(ellipse, longitudinal, lateral, spin, friction, elastic)
    nodes, weights = np.polynomial.legendre.leggauss(settings.strips)
    totals = np.empty((2, a.size, 6))
    travel = _travel(travel_speed, settings, a.size)
    for k, steps in enumerate((settings.steps, 2 * settings.steps)):
        rest = (a, b, scale, drive, flexibility, travel, steps, nodes, weights, settings.parabolic, law.speed,
                law.factor, totals[k])  # fmt: skip
        share_rows(lambda first, last, rest=rest: _all_patches((first, last), *rest), a.size, 8)
    best = 2.0 * totals[1] - totals[0]  # the steps are of first order
    return FastsimSolution(Resultants(best[:, 0], best[:, 1], best[:, 2]), best[:, 3], totals[1, :, 4], totals[1, :, 5])


def resultants(
    ellipse: Ellipse, slip: Slip, friction, elastic: Elastic, settings: FastsimSettings | None = None
) -> Resultants:
    """Friction forces [N] and spin moment [N mm] on the roller, shape (n,); see `solve_patch`."""
    return solve_patch(ellipse, slip.longitudinal, 0.0, slip.spin, friction, elastic, settings).resultants


def tractions(
    ellipse: Ellipse, slip: Slip, friction, elastic: Elastic, settings: FastsimSettings | None = None,
    travel_speed=None,
) -> SurfaceTractions:  # fmt: skip
    """Pressure (of Hertz), shear and slip at points x points element centres; 0 outside the ellipse."""
    settings = settings or FastsimSettings()
    law = settings.law or constant()
    a, b, scale, drive, flexibility = _problem(ellipse, slip.longitudinal, 0.0, slip.spin, friction, elastic)
    points = settings.points
    shear, moved = (np.zeros((a.size, 2, points, points)) for _ in range(2))
    rest = (a, b, scale, drive, flexibility, _travel(travel_speed, settings, a.size), points, settings.parabolic,
            law.speed, law.factor, shear, moved)  # fmt: skip
    share_rows(lambda first, last: _all_fields((first, last), *rest), a.size, 4)
    u = (2.0 * np.arange(points) + 1.0) / points - 1.0
    root = np.sqrt(np.maximum(1.0 - u[None, :] ** 2 - u[:, None] ** 2, 0.0))
    pressure = np.broadcast_to(ellipse.max_pressure, a.shape)[:, None, None] * root
    stick = (root > 0) & (moved[:, 0] == 0.0) & (moved[:, 1] == 0.0)
    return SurfaceTractions(a[:, None] * u, b[:, None] * u, pressure, shear[:, 0], shear[:, 1], moved[:, 0],
                            moved[:, 1], stick)  # fmt: skip
