"""Tangential problems of many patches: scaling, friction law and resultants; threads share the patches.

Inside a patch, lengths are divided by c = sqrt(a b), tractions by mu p_max and slips by mu p_max / G.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np
from numba import njit

from trackroller.contact.friction_laws import FrictionLaw
from trackroller.contact.influence import coupling_slip, hertz_coupling_slip, influence
from trackroller.contact.kalker.loops import reals
from trackroller.contact.kalker.newton import Problem, newton
from trackroller.numerics.threads import share_rows

TOWARDS_LAW = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)  # shares of a friction law that are met one after the other


@dataclass(frozen=True)
class Batch:
    """Patches to solve, arrays (n,) unless stated.

    semi_axis_lateral, semi_axis_rolling [mm]; bound : mu p_max [MPa]; ratio : mu p_max / G; poisson_ratio;
    coupling : K / mu; along (n, nx) : rolling part of the rigid slip; lateral [-], spin [1/mm] : the lateral part is
    lateral - spin y; travel_speed [mm/s]; height, share (n, ny, nx) : mean pressure over the largest and share inside
    the patch of each element; is_hertzian : the pressures are those of ellipses.
    """

    semi_axis_lateral: np.ndarray
    semi_axis_rolling: np.ndarray
    bound: np.ndarray
    ratio: np.ndarray
    poisson_ratio: np.ndarray
    coupling: np.ndarray
    along: np.ndarray
    lateral: np.ndarray
    spin: np.ndarray
    travel_speed: np.ndarray
    height: np.ndarray
    share: np.ndarray
    is_hertzian: bool

    def rigid_slip(self, i: int) -> np.ndarray:
        """Return the scaled rigid slip (ny, nx) of patch i as complex numbers, lateral + 1j rolling."""
        ny = self.height.shape[1]
        y = self.semi_axis_rolling[i] * ((2.0 * np.arange(ny) + 1.0) / ny - 1.0)
        factor = 1.0 / self.ratio[i] if self.ratio[i] > 0.0 else 1.0
        return factor * ((self.lateral[i] - self.spin[i] * y)[:, None] + 1j * self.along[i][None, :])


@dataclass(frozen=True)
class Report:
    """Numbers of n solved patches: forces (n, 3) F_T, F_A [N], M_R [N mm]; the others (n,).

    stick_fraction [-]; dissipation : summed over the elements; work : of the rigid slip; pressure_work : of the
    pressures on unlike materials [N]; residual of the friction law over mu p_max; Newton steps; products B tau;
    own_slip per travel speed, which the traction mu p_max of an element causes at itself.
    """

    forces: np.ndarray
    stick_fraction: np.ndarray
    dissipation: np.ndarray
    work: np.ndarray
    pressure_work: np.ndarray
    residual: np.ndarray
    steps: np.ndarray
    products: np.ndarray
    own_slip: np.ndarray

    @classmethod
    def empty(cls, n: int) -> Report:
        """Return a report of zeros."""
        zeros = {field.name: np.zeros(n) for field in fields(cls)}
        return cls(**zeros | {"forces": np.zeros((n, 3)), "own_slip": np.ones(n)})

    @property
    def energy_residual(self) -> np.ndarray:
        """Return the dissipation over the work of rigid slip and pressures, less 1; shape (n,)."""
        work = self.work + self.pressure_work
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(work != 0, self.dissipation / work - 1.0, 0.0)


@dataclass(frozen=True)
class Found:
    """Start and result of n patches.

    traction (n, 2, ny, nx) over mu p_max: first the start, then the result; slip (n, 2, ny, nx) per travel speed;
    stick (n, ny, nx); factor (n, ny, nx) : friction over its value at rest, (n, 1, 1) if it is constant; report.
    """

    traction: np.ndarray
    slip: np.ndarray
    stick: np.ndarray
    factor: np.ndarray
    report: Report

    @classmethod
    def start(cls, traction: np.ndarray, law: FrictionLaw) -> Found:
        """Return room for the result of an iteration that starts from `traction` (n, 2, ny, nx)."""
        n, _, ny, nx = traction.shape
        factor = np.ones((n, 1, 1) if law.is_constant else (n, ny, nx))
        return cls(traction, np.empty_like(traction), np.zeros((n, ny, nx), bool), factor, Report.empty(n))

    @property
    def own_slip(self) -> np.ndarray:
        """Return the slip that an element's unit traction causes at itself, (n,)."""
        return self.report.own_slip


class _Fields(NamedTuple):
    """Fields of one patch: traction, slip, rigid slip and rigid slip with that of the pressures, (ny, nx, 2)."""

    traction: np.ndarray
    slip: np.ndarray
    rigid: np.ndarray
    driver: np.ndarray
    bound: np.ndarray


class _Sums(NamedTuple):
    """Sums over the elements of one patch, per element area; the last two are shares of the patch in elements."""

    lateral: float
    driving: float
    moment: float
    dissipation: float
    work: float
    pressure_work: float
    sticking: float
    covered: float


@njit(cache=True, nogil=True)
def _sums(field, height, share, rho, a, b, stick):
    """Add up resultants, works and stick of one patch with tractions over mu p_max; mark sticking elements."""
    traction, slip, rigid, driver, bound = field
    ny, nx = bound.shape
    force_x = force_y = moment = dissipation = work = pressed = sticking = covered = 0.0
    for i in range(ny):
        y = b * ((2.0 * i + 1.0) / ny - 1.0)
        for j in range(nx):
            if height[i, j] <= 0.0:
                continue
            x = a * ((2.0 * j + 1.0) / nx - 1.0)
            tx, ty = traction[i, j, 0], traction[i, j, 1]
            sx, sy = slip[i, j, 0], slip[i, j, 1]
            force_x += tx
            force_y += ty
            moment += x * ty - y * tx
            dissipation -= tx * sx + ty * sy
            work -= tx * rigid[i, j, 0] + ty * rigid[i, j, 1]
            pressed -= tx * (driver[i, j, 0] - rigid[i, j, 0]) + ty * (driver[i, j, 1] - rigid[i, j, 1])
            covered += share[i, j]
            if (tx - rho * sx) ** 2 + (ty - rho * sy) ** 2 <= bound[i, j] ** 2:
                stick[i, j] = True
                sticking += share[i, j]
    return _Sums(force_x, force_y, moment, dissipation, work, pressed, sticking, covered)


def _solve(problem: Problem, traction: np.ndarray, control, report: Report, i: int):
    """Solve by Newton's method; if a friction law defeats it, approach the law from constant friction in steps."""
    limits = control.tolerance, control.steps, control.krylov
    *found, report.residual[i], report.steps[i], report.products[i] = newton(problem, traction, *limits)
    if report.residual[i] <= control.tolerance or problem.knots.size == 1:
        return found
    for part in TOWARDS_LAW:
        factors = problem.factors[0] + part * (problem.factors - problem.factors[0])
        eased = Problem(problem.influence, problem.rigid, problem.height, problem.scale, problem.knots, factors)
        *found, report.residual[i], steps, products = newton(eased, found[0], *limits)
        report.steps[i] += steps
        report.products[i] += products
        if report.residual[i] > control.tolerance:
            break  # a steeper share of the law will not converge either
    return found


def _one_patch(batch: Batch, law: FrictionLaw, control, found: Found, i: int) -> None:
    """Solve patch i."""
    a, b, ratio = batch.semi_axis_lateral[i], batch.semi_axis_rolling[i], batch.ratio[i]
    traction, slip, stick, report = found.traction[i], found.slip[i], found.stick[i], found.report
    rigid = batch.rigid_slip(i)
    if not (ratio > 0.0 and a > 0.0 and b > 0.0 and math.isfinite(ratio * a * b)):
        traction[:] = 0.0
        slip[0], slip[1] = rigid.real, rigid.imag
        return
    height = np.ascontiguousarray(batch.height[i])
    ny, nx = height.shape
    c = math.sqrt(a * b)
    hx, hy = 2.0 * a / (nx * c), 2.0 * b / (ny * c)
    functions = influence(hx, hy, batch.poisson_ratio[i], ny, nx)
    report.own_slip[i] = ratio * functions.own
    coupling = batch.coupling[i]
    driver = rigid
    if coupling != 0.0:
        hertz = batch.is_hertzian
        pressed = hertz_coupling_slip(a / c, b / c, ny, nx) if hertz else coupling_slip(height, hx, hy)
        driver = rigid + coupling * pressed
    problem = Problem(functions, driver, height, ratio * batch.travel_speed[i], law.speed, law.factor)
    solved, moved, bound = _solve(problem, traction[0] + 1j * traction[1], control, report, i)
    field = _Fields(reals(solved), reals(moved), reals(rigid), reals(driver), bound)
    sums = _sums(field, height, batch.share[i], 1.0 / functions.own, a, b, stick)
    _write(report, i, sums, 4.0 * a * b / (nx * ny), batch.bound[i], ratio)
    traction[0], traction[1] = solved.real, solved.imag
    if law.speed.size > 1:
        found.factor[i] = np.divide(bound, height, out=np.ones_like(height), where=height > 0.0)
    slip[0], slip[1] = ratio * moved.real, ratio * moved.imag


def _write(report: Report, i: int, sums: _Sums, cell: float, bound: float, ratio: float) -> None:
    """Store the sums of patch i with their units; `cell` is the area of an element [mm^2]."""
    report.stick_fraction[i] = sums.sticking / sums.covered
    report.forces[i] = np.array([sums.lateral, sums.driving, sums.moment]) * cell * bound
    scale = bound * ratio
    report.dissipation[i] = sums.dissipation * cell * scale
    report.work[i], report.pressure_work[i] = sums.work * cell * scale, sums.pressure_work * cell * scale


def solve_batch(batch: Batch, law: FrictionLaw, control, found: Found) -> None:
    """Solve all patches of a batch, one per thread at a time.

    Parameters
    ----------
    batch : Batch
        The n patches.
    law : FrictionLaw
        Friction over its value at rest by slip speed.
    control : KalkerSettings
        Tolerance, Newton steps and Krylov space.
    found : Found
        Start of the iteration, overwritten by the result.
    """

    def work(first: int, last: int) -> None:
        for i in range(first, last):
            _one_patch(batch, law, control, found, i)

    share_rows(work, batch.ratio.size, 1, 1)
