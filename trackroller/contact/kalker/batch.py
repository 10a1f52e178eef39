"""Tangential problems of many patches: scaling, friction law and resultants; threads share the
patches.

Inside a patch, lengths are divided by c = sqrt(a b), tractions by mu p_max and slips by mu p_max /
G.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from trackroller.contact.friction_laws import FrictionLaw
from trackroller.contact.influence import (
    coupling_slip,
    hertz_coupling_slip,
    influence,
    plane_influence,
    rounded,
)
from trackroller.contact.kalker.loops import reals
from trackroller.contact.kalker.newton import Problem, newton, room_for
from trackroller.numerics.compiled import compiled
from trackroller.numerics.threads import share_rows

PIECE = 16  # patches of the same shape that a thread solves in one call
# shares of a friction law that are met one after the other
TOWARDS_LAW = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)


class Batch(NamedTuple):
    """Patches to solve, arrays (n,) unless stated.

    semi_axis_lateral, semi_axis_rolling [mm]; bound : mu p_max [MPa]; ratio : mu p_max / G;
    poisson_ratio; coupling : K / mu; along (n, nx) : rolling part of the rigid slip; lateral [-],
    spin [1/mm] : the lateral part is lateral - spin y; travel_speed [mm/s]; height, share (n, ny,
    nx), for ellipses (1, ny, nx) : mean pressure over the largest and share inside the patch of
    each element; is_hertzian : the pressures are those of ellipses, or of discs; film : flexibility
    of a film between the bodies times G [mm]; is_plane : two discs, one column of elements.
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
    film: np.ndarray
    is_plane: bool

    @property
    def solvable(self) -> np.ndarray:
        """Return which patches have friction and finite sizes, (n,)."""
        size = self.semi_axis_lateral * self.semi_axis_rolling
        with np.errstate(invalid="ignore"):
            finite = (
                np.isfinite(self.ratio * size)
                & (self.semi_axis_lateral > 0.0)
                & (self.semi_axis_rolling > 0.0)
            )
            return finite & (self.ratio > 0.0)


@compiled
def _rigid_slip(batch, i, out):
    """Write the scaled rigid slip of patch i into `out` (ny, nx), lateral + 1j rolling."""
    ny, nx = out.shape
    factor = 1.0 / batch.ratio[i] if batch.ratio[i] > 0.0 else 1.0
    for k in range(ny):
        y = batch.semi_axis_rolling[i] * ((2.0 * k + 1.0) / ny - 1.0)
        lateral = factor * (batch.lateral[i] - batch.spin[i] * y)
        for j in range(nx):
            out[k, j] = complex(lateral, factor * batch.along[i, j])


class Report(NamedTuple):
    """Numbers of n solved patches: forces (n, 3) F_T, F_A [N], M_R [N mm]; the others (n,).

    stick_fraction [-]; dissipation : summed over the elements; work : of the rigid slip;
    pressure_work : of the pressures on unlike materials [N]; residual of the friction law over mu
    p_max; Newton steps; products B tau; own_slip per travel speed, which the traction mu p_max of
    an element causes at itself.
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
        zeros = {field: np.zeros(n) for field in cls._fields}
        return cls(**zeros | {"forces": np.zeros((n, 3)), "own_slip": np.ones(n)})

    @property
    def energy_residual(self) -> np.ndarray:
        """Return the dissipation over the work of rigid slip and pressures, less 1; shape (n,)."""
        work = self.work + self.pressure_work
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(work != 0, self.dissipation / work - 1.0, 0.0)


class SolvedPatches(NamedTuple):
    """Start and result of n patches.

    traction (n, 2, ny, nx) over mu p_max: first the start, then the result; slip (n, 2, ny, nx) per
    travel speed; stick (n, ny, nx); factor (n, ny, nx) : friction over its value at rest, (n, 1, 1)
    if it is constant; report.
    """

    traction: np.ndarray
    slip: np.ndarray
    stick: np.ndarray
    factor: np.ndarray
    report: Report

    @classmethod
    def start(cls, traction: np.ndarray, law: FrictionLaw) -> SolvedPatches:
        """Return room for the result of an iteration that starts from `traction` (n, 2, ny, nx)."""
        n, _, ny, nx = traction.shape
        factor = np.ones((n, 1, 1) if law.is_constant else (n, ny, nx))
        return cls(
            traction, np.empty_like(traction), np.zeros((n, ny, nx), bool), factor, Report.empty(n)
        )

    @property
    def own_slip(self) -> np.ndarray:
        """Return the slip that an element's unit traction causes at itself, (n,)."""
        return self.report.own_slip


class _Fields(NamedTuple):
    """Fields of one patch: traction, slip, rigid slip and rigid slip with that of the pressures,
    (ny, nx, 2).
    """

    traction: np.ndarray
    slip: np.ndarray
    rigid: np.ndarray
    driver: np.ndarray
    bound: np.ndarray


class _Sums(NamedTuple):
    """Sums over the elements of one patch, per element area; the last two are shares of the patch
    in elements.
    """

    lateral: float
    driving: float
    moment: float
    dissipation: float
    work: float
    pressure_work: float
    sticking: float
    covered: float


@compiled
def _sums(field, height, share, rho, a, b, stick):
    """Add up resultants, works and stick of one patch with tractions over mu p_max; mark sticking
    elements.
    """
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
            pressed -= tx * (driver[i, j, 0] - rigid[i, j, 0]) + ty * (
                driver[i, j, 1] - rigid[i, j, 1]
            )
            covered += share[i, j]
            if (tx - rho * sx) ** 2 + (ty - rho * sy) ** 2 <= bound[i, j] ** 2:
                stick[i, j] = True
                sticking += share[i, j]
    return _Sums(force_x, force_y, moment, dissipation, work, pressed, sticking, covered)


@compiled
def _solve(problem, room, traction, tolerance, limit):
    """Solve by Newton's method; if a friction law defeats it, approach the law from constant
    friction in steps.
    """
    at, residual, steps, products = newton(problem, room, traction, tolerance, limit)
    if residual <= tolerance or problem.knots.size == 1:
        return at, residual, steps, products
    for part in TOWARDS_LAW:
        factors = problem.factors[0] + part * (problem.factors - problem.factors[0])
        eased = Problem(
            problem.influence, problem.rigid, problem.height, problem.scale, problem.knots, factors
        )
        at, residual, more, further = newton(eased, room, at[0].copy(), tolerance, limit)
        steps, products = steps + more, products + further
        if residual > tolerance:
            break  # a steeper share of the law will not converge either
    return at, residual, steps, products


@compiled
def _solve_patches(which, batch, functions, pressed, law, limits, out):
    """Solve the patches `which` (m,), whose elements have the same shape; see `_solve_piece`."""
    knots, factors = law
    tolerance, limit, krylov = limits
    ny, nx = batch.height.shape[1:]
    room, report = room_for(ny, nx, krylov), out.report
    rigid, start = np.empty((ny, nx), np.complex128), np.empty((ny, nx), np.complex128)
    for i in which:
        one = i if batch.height.shape[0] > 1 else 0
        height, ratio, traction = batch.height[one], batch.ratio[i], out.traction[i]
        _rigid_slip(batch, i, rigid)
        driver = rigid
        if batch.coupling[i] != 0.0:
            driver = rigid + batch.coupling[i] * pressed
        problem = Problem(functions, driver, height, ratio * batch.travel_speed[i], knots, factors)
        for k in range(ny):
            for j in range(nx):
                start[k, j] = complex(traction[0, k, j], traction[1, k, j])
        at, report.residual[i], report.steps[i], report.products[i] = _solve(
            problem, room, start, tolerance, limit
        )
        field = _Fields(reals(at[0]), reals(at[1]), reals(rigid), reals(driver), room.bound)
        sides = batch.semi_axis_lateral[i], batch.semi_axis_rolling[i]
        sums = _sums(field, height, batch.share[one], 1.0 / functions.own, *sides, out.stick[i])
        _write_report(report, i, sums, 4.0 * sides[0] * sides[1] / (nx * ny), batch.bound[i], ratio)
        report.own_slip[i] = ratio * functions.own
        _write_fields(out, i, field, height, ratio)


@compiled
def _write_fields(out, i, field, height, ratio):
    """Store tractions, slips and, under a friction law, factors of patch i."""
    varies = out.factor.shape[1:] == height.shape
    for k in range(height.shape[0]):
        for j in range(height.shape[1]):
            for c in range(2):
                out.traction[i, c, k, j] = field.traction[k, j, c]
                out.slip[i, c, k, j] = ratio * field.slip[k, j, c]
            if varies and height[k, j] > 0.0:
                out.factor[i, k, j] = field.bound[k, j] / height[k, j]


@compiled
def _write_report(report, i, sums, cell, bound, ratio):
    """Store the sums of patch i with their units; `cell` is the area of an element [mm^2]."""
    report.stick_fraction[i] = sums.sticking / sums.covered
    report.forces[i, 0] = sums.lateral * cell * bound
    report.forces[i, 1] = sums.driving * cell * bound
    report.forces[i, 2] = sums.moment * cell * bound
    scale = bound * ratio
    report.dissipation[i] = sums.dissipation * cell * scale
    report.work[i], report.pressure_work[i] = (
        sums.work * cell * scale,
        sums.pressure_work * cell * scale,
    )


class _Piece(NamedTuple):
    """Numbers of patches with the same elements; half sides, Poisson's ratio and film of one,
    scaled and rounded.
    """

    which: np.ndarray
    lateral: float
    rolling: float
    poisson_ratio: float
    film: float


def _pieces(batch: Batch) -> list[_Piece]:
    """Return the solvable patches in pieces of at most PIECE with the same elements and, on grids,
    pressures.
    """
    shapes: dict[tuple, list[int]] = {}
    for i in np.flatnonzero(batch.solvable).tolist():
        a, b = batch.semi_axis_lateral[i], batch.semi_axis_rolling[i]
        c = math.sqrt(a * b)
        key = rounded(a / c, b / c, batch.poisson_ratio[i], batch.film[i] / c)
        shapes.setdefault(key if batch.is_hertzian else (*key, i), []).append(i)
    return [
        _Piece(np.array(rows[k : k + PIECE]), *key[:4])
        for key, rows in shapes.items()
        for k in range(0, len(rows), PIECE)
    ]


def _pressed_slip(batch: Batch, i: int, a: float, b: float) -> np.ndarray:
    """Return the slip (ny, nx), x + iy, that the pressure of patch i causes on unlike bodies for K
    = G = 1.
    """
    _, ny, nx = batch.height.shape
    if batch.is_plane:
        # of each place alone: the strain along the surface of a half-plane under pressure
        return 2j * batch.height[0]
    if batch.is_hertzian:
        return np.asarray(hertz_coupling_slip(a, b, ny, nx))
    return coupling_slip(batch.height[i], 2.0 * a / nx, 2.0 * b / ny)


def _solve_piece(
    batch: Batch, law: FrictionLaw, control, out: SolvedPatches, piece: _Piece
) -> None:
    """Solve the patches of a piece."""
    _, ny, nx = batch.height.shape
    which, a, b, poisson_ratio, film = piece
    hx, hy = 2.0 * a / nx, 2.0 * b / ny
    if batch.is_plane:
        functions = plane_influence(hy, poisson_ratio, ny, film)
    else:
        functions = influence(hx, hy, poisson_ratio, ny, nx, film=film)
    pressed = np.zeros((ny, nx), complex)
    if np.any(batch.coupling[which] != 0.0):
        pressed = _pressed_slip(batch, which[0], a, b)
    limits = control.tolerance, control.steps, control.krylov
    _solve_patches(which, batch, functions, pressed, (law.speed, law.factor), limits, out)


def solve_batch(batch: Batch, law: FrictionLaw, control, out: SolvedPatches) -> None:
    """Solve all patches of a batch, one per thread at a time.

    Parameters
    ----------
    batch : Batch
        The n patches.
    law : FrictionLaw
        Friction over its value at rest by slip speed.
    control : KalkerSettings
        Tolerance, Newton steps and Krylov space.
    out : SolvedPatches
        Start of the iteration, overwritten by the result.
    """

    rest = ~batch.solvable
    for i in np.flatnonzero(rest).tolist():
        rigid = np.empty(batch.height.shape[1:], complex)
        _rigid_slip(batch, i, rigid)
        out.slip[i] = rigid.real, rigid.imag
    out.traction[rest] = 0.0
    pieces = _pieces(batch)

    def work(first: int, last: int) -> None:
        for piece in pieces[first:last]:
            _solve_piece(batch, law, control, out, piece)

    share_rows(work, len(pieces), 1, 1)
