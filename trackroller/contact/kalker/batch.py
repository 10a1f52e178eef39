"""Tangential problems of many patches: scaling, friction law, resultants; patches are shared among threads.

Per patch: lengths over c = sqrt(a b), tractions over mu p_max, slips over mu p_max / G.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

from trackroller.contact.influence import coupling_slip, influence
from trackroller.contact.kalker.columns import column_ranges
from trackroller.contact.kalker.loops import reals, row_means
from trackroller.contact.kalker.newton import Problem, newton
from trackroller.numerics.threads import share_rows

# columns of the numbers reported for each patch
(F_T, F_A, M_R, STICK, POWER, WORK, PRESSURE_WORK, RESIDUAL, STEPS, PRODUCTS) = range(10)
REPORT = 10
TOWARDS_LAW = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)  # shares of a friction law that are met one after the other


def _rigid_slip(along, lateral, spin, b, factor, ny):
    """Scaled rigid slip (ny, nx): `along` (nx,) is its rolling part, lateral - spin y the other."""
    y = b * ((2.0 * np.arange(ny) + 1.0) / ny - 1.0)
    return factor * ((lateral - spin * y)[:, None] + 1j * along[None, :])


@njit(cache=True, nogil=True)
def _sums(traction, slip, rigid, driver, height, bound, rho, share, a, b, stick, report):
    """Resultants, stick share and works of one patch into `report`, with tractions over mu p_max.

    `driver` is the rigid slip with that of the pressures on unlike materials.
    """
    ny, nx = bound.shape
    total = np.zeros(8)
    for i in range(ny):
        y = b * ((2.0 * i + 1.0) / ny - 1.0)
        for j in range(nx):
            if height[i, j] <= 0.0:
                continue
            x = a * ((2.0 * j + 1.0) / nx - 1.0)
            tx, ty = traction[i, j, 0], traction[i, j, 1]
            sx, sy = slip[i, j, 0], slip[i, j, 1]
            total[0] += tx
            total[1] += ty
            total[2] += x * ty - y * tx
            total[4] -= tx * sx + ty * sy
            total[5] -= tx * rigid[i, j, 0] + ty * rigid[i, j, 1]
            total[6] -= tx * (driver[i, j, 0] - rigid[i, j, 0]) + ty * (driver[i, j, 1] - rigid[i, j, 1])
            total[7] += share[i, j]
            if (tx - rho * sx) ** 2 + (ty - rho * sy) ** 2 <= bound[i, j] ** 2:
                stick[i, j] = True
                total[3] += share[i, j]
    cell = 4.0 * a * b / (nx * ny)
    for k in (0, 1, 2, 4, 5, 6):
        report[k] = total[k] * cell
    report[STICK] = total[3] / total[7]


def _solve(problem: Problem, traction, control, report):
    """Newton's method; if a friction law defeats it, from constant friction towards the law in steps."""
    limits = (float(control[0]), int(control[1]), int(control[2]))
    first = newton(problem, traction, *limits)
    report[RESIDUAL], report[STEPS], report[PRODUCTS] = first[3:]
    if first[3] <= control[0] or problem.knots.size == 1:
        return first[:3]
    for part in TOWARDS_LAW:
        factors = problem.factors[0] + part * (problem.factors - problem.factors[0])
        eased = Problem(problem.influence, problem.rigid, problem.height, problem.scale, problem.knots, factors)
        traction, slip, bound, report[RESIDUAL], steps, products = newton(eased, traction, *limits)
        report[STEPS] += steps
        report[PRODUCTS] += products
        if report[RESIDUAL] > control[0]:
            break  # a law that is steeper yet will not be met either
    return traction, slip, bound


def _one_patch(
    a,
    b,
    scale,
    ratio,
    poisson,
    coupling,
    along,
    lateral,
    spin,
    travel,
    height,
    share,
    speeds,
    values,
    control,
    traction,
    slip,
    stick,
    report,
):
    """Solve one patch; `traction` is the start. ratio = mu p_max / G, coupling = K / mu."""
    ny, nx = height.shape
    report[:] = 0.0
    rigid = _rigid_slip(along, lateral, spin, b, 1.0 / ratio if ratio > 0.0 else 1.0, ny)
    if not (ratio > 0.0 and a > 0.0 and b > 0.0 and math.isfinite(ratio * a * b)):
        traction[:] = 0.0
        slip[0], slip[1] = rigid.real, rigid.imag
        return
    c = math.sqrt(a * b)
    hx, hy = 2.0 * a / (nx * c), 2.0 * b / (ny * c)
    functions = influence(hx, hy, poisson, ny, nx)
    driver = rigid if coupling == 0.0 else rigid + coupling * coupling_slip(height, hx, hy)
    problem = Problem(functions, driver, np.ascontiguousarray(height), ratio * travel, speeds, values)
    found, moved, bound = _solve(problem, traction[0] + 1j * traction[1], control, report)
    _sums(
        reals(found),
        reals(moved),
        reals(rigid),
        reals(driver),
        height,
        bound,
        1.0 / functions.own,
        share,
        a,
        b,
        stick,
        report,
    )
    report[:3] *= scale
    report[[POWER, WORK, PRESSURE_WORK]] *= scale * ratio
    traction[0], traction[1] = found.real, found.imag
    if speeds.size > 1:  # the slips that the law has seen, so that tractions and slips told agree with it
        first, count = column_ranges(problem.height)
        row_means(reals(moved.copy()), first, count, reals(moved))
        moved[stick] = 0.0
    slip[0], slip[1] = ratio * moved.real, ratio * moved.imag


def solve_batch(
    a,
    b,
    scale,
    ratio,
    poisson,
    coupling,
    along,
    lateral,
    spin,
    travel,
    height,
    share,
    speeds,
    values,
    control,
    traction,
    slip,
    stick,
    report,
):
    """Patches i = 0..n-1, one per thread at a time.

    a, b [mm], scale = mu p_max [MPa], ratio = mu p_max / G, nu, K / mu, lateral [-], spin [1/mm]: (n,);
    along (n, nx): rolling part of the rigid slip; travel (n,): travel speed [mm/s]; height, share (ny, nx):
    `unit_cells`; speeds (m,): slip speeds [mm/s], and values (m,): friction over its reference there; control:
    tolerance, Newton steps, Krylov space.
    traction (n, 2, ny, nx): start and result over mu p_max; slip likewise, per travel speed; stick
    (n, ny, nx), False at the start; report (n, REPORT).
    """
    rows: tuple[Any, ...] = (a, b, scale, ratio, poisson, coupling, along, lateral, spin, travel)
    law: tuple[Any, ...] = (height, share, speeds, values, control)

    def work(first: int, last: int) -> None:
        for i in range(first, last):
            own: Any = (*(v[i] for v in rows), *law, traction[i], slip[i], stick[i], report[i])
            _one_patch(*own)

    share_rows(work, a.size, 1, 1)


def energy_residual(report: np.ndarray) -> np.ndarray:
    """Dissipation summed over the elements over the work of rigid slip and pressures, less 1; (n,)."""
    work = report[:, WORK] + report[:, PRESSURE_WORK]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(work != 0, report[:, POWER] / work - 1.0, 0.0)


@njit(cache=True)
def refine(coarse, coarse_height, height, fine):
    """Start of a grid (n, 2, 2 ny, 2 nx) from the one with half the elements.

    The share of the traction bound is interpolated linearly; steps between the elements would make slip between them.
    """
    ny, nx = coarse_height.shape
    for k in range(fine.shape[0]):
        for i in range(2 * ny):
            near_i, far_i = i // 2, min(max(i // 2 + 2 * (i % 2) - 1, 0), ny - 1)
            for j in range(2 * nx):
                near_j, far_j = j // 2, min(max(j // 2 + 2 * (j % 2) - 1, 0), nx - 1)
                x, y, total = 0.0, 0.0, 0.0
                for m, q, weight in (
                    (near_i, near_j, 9.0),
                    (far_i, near_j, 3.0),
                    (near_i, far_j, 3.0),
                    (far_i, far_j, 1.0),
                ):
                    if coarse_height[m, q] > 0.0:
                        x += weight * coarse[k, 0, m, q] / coarse_height[m, q]
                        y += weight * coarse[k, 1, m, q] / coarse_height[m, q]
                        total += weight
                share = height[i, j] / total if total > 0.0 else 0.0
                fine[k, 0, i, j], fine[k, 1, i, j] = x * share, y * share
