"""Tangential problems of many patches in parallel: scaling, friction law, resultants. Compiled.

Per patch: lengths over c = sqrt(a b), tractions over mu p_max, slips over mu p_max / G.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from trackroller.contact.kalker_influence import coupling_slip, prepare
from trackroller.contact.kalker_newton import newton
from trackroller.threads import share_rows

# columns of the numbers reported for each patch
(F_T, F_A, M_R, STICK, POWER, WORK, RESIDUAL, STEPS, PRODUCTS, FRICTION_ERROR) = range(10)
REPORT = 10
FRICTION_SWEEPS = 40
FRICTION_TOLERANCE = 1e-5  # relative change of the friction coefficient of any element


@njit(cache=True)
def _friction_field(slip, scale, speeds, values, mixing, field):
    """Friction over its reference at the slip of each element; returns the largest relative change."""
    largest = 0.0
    for i in range(field.shape[0]):
        for j in range(field.shape[1]):
            speed = scale * math.hypot(slip[0, i, j], slip[1, i, j])
            k = np.searchsorted(speeds, speed)
            if k == 0:
                new = values[0]
            elif k == speeds.size:
                new = values[-1]
            else:
                t = (speed - speeds[k - 1]) / (speeds[k] - speeds[k - 1])
                new = (1.0 - t) * values[k - 1] + t * values[k]
            change = new - field[i, j]
            largest = max(largest, abs(change) / max(new, 1e-30))
            field[i, j] += mixing * change
    return largest


@njit(cache=True)
def _rigid_slip(along, lateral, spin, b, factor, ny):
    """Scaled rigid slip (2, ny, nx): along (nx,) is its rolling part, lateral - spin y the other."""
    nx = along.size
    rigid = np.empty((2, ny, nx))
    for i in range(ny):
        y = b * ((2.0 * i + 1.0) / ny - 1.0)
        for j in range(nx):
            rigid[0, i, j] = (lateral - spin * y) * factor
            rigid[1, i, j] = along[j] * factor
    return rigid


@njit(cache=True)
def _sums(traction, slip, rigid, bound, rho, share, a, b, report):
    """Resultants, stick share and works of one patch into `report`, with tractions over mu p_max."""
    ny, nx = bound.shape
    total = np.zeros(7)
    for i in range(ny):
        y = b * ((2.0 * i + 1.0) / ny - 1.0)
        for j in range(nx):
            g = bound[i, j]
            if g <= 0.0:
                continue
            x = a * ((2.0 * j + 1.0) / nx - 1.0)
            tx, ty = traction[0, i, j], traction[1, i, j]
            sx, sy = slip[0, i, j], slip[1, i, j]
            total[0] += tx
            total[1] += ty
            total[2] += x * ty - y * tx
            total[4] -= tx * sx + ty * sy
            total[5] -= tx * rigid[0, i, j] + ty * rigid[1, i, j]
            total[6] += share[i, j]
            if (tx - rho * sx) ** 2 + (ty - rho * sy) ** 2 <= g * g:
                total[3] += share[i, j]
    cell = 4.0 * a * b / (nx * ny)
    for k in (0, 1, 2, 4, 5):
        report[k] = total[k] * cell
    report[STICK] = total[3] / total[6]


@njit(cache=True)
def _friction_sweeps(multipliers, own, hy, driver, height, speeds, values, speed_scale, control, traction, slip,
                     bound, report):  # fmt: skip
    """Newton's method inside a fixed point for the friction of each element; bound (ny, nx) is that of the last."""
    friction = np.ones(height.shape)
    for sweep in range(FRICTION_SWEEPS):
        largest, used, multiplied = newton(
            multipliers, own, hy, driver, bound, traction, slip, control[0], int(control[1]), int(control[2])
        )
        report[RESIDUAL] = largest
        report[STEPS] += used
        report[PRODUCTS] += multiplied
        if speeds.size == 1:
            break
        mixing = 1.0 if sweep < 8 else 0.5
        report[FRICTION_ERROR] = _friction_field(slip, speed_scale, speeds, values, mixing, friction)
        if report[FRICTION_ERROR] < FRICTION_TOLERANCE:
            break
        for i in range(height.shape[0]):
            for j in range(height.shape[1]):
                bound[i, j] = height[i, j] * friction[i, j]


@njit(cache=True)
def _one_patch(a, b, scale, ratio, poisson, coupling, along, lateral, spin, travel, height, share, speeds, values,
               control, traction, slip, report):  # fmt: skip
    """Solve one patch; `traction` is the start. ratio = mu p_max / G, coupling = K / mu."""
    ny, nx = height.shape
    report[:] = 0.0
    factor = 1.0 / ratio if ratio > 0.0 else 1.0
    rigid = _rigid_slip(along, lateral, spin, b, factor, ny)
    if not (ratio > 0.0 and a > 0.0 and b > 0.0 and math.isfinite(ratio * a * b)):
        traction[:] = 0.0
        slip[:] = rigid
        return
    c = math.sqrt(a * b)
    hx, hy = 2.0 * a / (nx * c), 2.0 * b / (ny * c)
    multipliers, own = prepare(hx, hy, poisson, ny, nx)
    driver = rigid
    if coupling != 0.0:
        driver = coupling_slip(height, hx, hy)
        for i in range(ny):
            for j in range(nx):
                driver[0, i, j] = rigid[0, i, j] + coupling * driver[0, i, j]
                driver[1, i, j] = rigid[1, i, j] + coupling * driver[1, i, j]
    bound = height.copy()
    _friction_sweeps(multipliers, own, hy, driver, height, speeds, values, ratio * travel, control, traction, slip,
                     bound, report)  # fmt: skip
    _sums(traction, slip, rigid, bound, 1.0 / own, share, a, b, report)
    for k in range(3):
        report[k] *= scale
    report[POWER] *= scale * ratio
    report[WORK] *= scale * ratio
    for i in range(ny):
        for j in range(nx):
            slip[0, i, j] *= ratio
            slip[1, i, j] *= ratio


@njit(cache=True, nogil=True)
def _solve_rows(rows, a, b, scale, ratio, poisson, coupling, along, lateral, spin, travel, height, share, speeds,
                values, control, traction, slip, report):  # fmt: skip
    for i in range(rows[0], rows[1]):
        _one_patch(a[i], b[i], scale[i], ratio[i], poisson[i], coupling[i], along[i], lateral[i], spin[i], travel[i],
                   height, share, speeds, values, control, traction[i], slip[i], report[i])  # fmt: skip


def solve_batch(a, b, scale, ratio, poisson, coupling, along, lateral, spin, travel, height, share, speeds, values,
                control, traction, slip, report):  # fmt: skip
    """Patches i = 0..n-1, one per core at a time.

    a, b [mm], scale = mu p_max [MPa], ratio = mu p_max / G, nu, K / mu, lateral [-], spin [1/mm]: (n,);
    along (n, nx): rolling part of the rigid slip; travel (n,): travel speed [mm/s]; height, share (ny, nx):
    `unit_cells`; speeds (m,): slip speeds [mm/s], and values (m,): friction over its reference there; control:
    tolerance, Newton steps, Krylov space.
    traction (n, 2, ny, nx): start and result over mu p_max; slip likewise, per travel speed; report (n, REPORT).
    """
    given = (a, b, scale, ratio, poisson, coupling, along, lateral, spin, travel, height, share, speeds, values,
             control, traction, slip, report)  # fmt: skip
    share_rows(lambda first, last: _solve_rows((first, last), *given), a.size, 1, 1)


@njit(cache=True)
def refine(coarse, coarse_height, height, fine):
    """Start of a grid (n, 2, 2 ny, 2 nx) from the one with half the elements: the same share of the bound."""
    for k in range(fine.shape[0]):
        for c in range(2):
            for i in range(fine.shape[2]):
                for j in range(fine.shape[3]):
                    g = coarse_height[i // 2, j // 2]
                    fine[k, c, i, j] = coarse[k, c, i // 2, j // 2] * height[i, j] / g if g > 0.0 else 0.0
