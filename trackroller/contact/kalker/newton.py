"""Solve for adhesion and slip on a patch by a semi-smooth Newton method with Krylov steps.

For each element with traction bound g the law of dry friction is the fixed point tau = P_g(tau -
rho s), where P_g shortens a vector to at most g and s = w + B tau is the slip (Alart & Curnier
1991). Newton's method is here the active-set method of sticking and sliding elements. GMRES with
fast products B tau solves its linear systems. If friction depends on the slip, g is a function of
s, and its derivative enters Newton's matrix.

The preconditioner of GMRES solves each column of elements along the rolling direction on its own.
Each element has two directions: `along` the traction and `across` it. A sliding element moves
across only, a sticking one in both directions. Each direction of a column is a small banded system
with the exact influence of the column on itself, up to a distance of `BAND` elements. The influence
of elements further away, of other columns, and of one direction on the other, is left out. GMRES
then needs about 10 products instead of 60 to 100, with a band as with whole columns. The
preconditioner has single precision, which costs GMRES no product: the products themselves have
double precision, so that the solution depends on the rounding of the preconditioner by 1e-10 at
most.

The whole iteration is compiled, transforms included. With short compiled calls the threads would
wait for the interpreter most of the time. Fields are complex, x + iy, (ny, nx); compiled loops run
over their real numbers, (ny, nx, 2).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from trackroller.contact.influence import Influence, convolve
from trackroller.contact.kalker.loops import (
    ACROSS,
    ALONG,
    NORMAL_X,
    NORMAL_Y,
    XX,
    XY,
    YX,
    YY,
    find_slits,
    hold,
    jacobian,
    law_of_slip,
    reals,
    residual,
    row_means,
)
from trackroller.numerics.compiled import assign, compiled, fast
from trackroller.numerics.lanes import LANES, multiply, subtract_multiple

COLUMN, DIRECTION, FIRST, ROWS = range(4)  # of a system
# Elements on each side that a system holds. 12 need 1 % more products than whole columns, 8 need 2
# % more.
BAND = 12
WIDTH = 2 * BAND + 1


class Systems(NamedTuple):
    """Systems of one patch: `which` (2 nx, 4) are column, direction, first row and number of rows
    of each.

    `x`, `y` (groups, ny LANES) are the directions of their elements, `factors` (groups, ny, WIDTH,
    LANES) the factors L U of the matrices by their columns, each from `BAND` rows above the
    diagonal to `BAND` rows below it; the systems of a group stand side by side. `line` (6, 2 ny
    LANES) is work space.
    """

    which: np.ndarray
    x: np.ndarray
    y: np.ndarray
    factors: np.ndarray
    line: np.ndarray


@compiled
def systems_for(ny, nx):
    """Return empty arrays that `factorise` fills with the systems of ny x nx elements."""
    groups = -(-2 * nx // LANES)
    return Systems(
        np.zeros((groups * LANES, 4), np.int64),
        np.zeros((groups, ny * LANES), np.float32),
        np.zeros((groups, ny * LANES), np.float32),
        np.empty((groups, ny, WIDTH, LANES), np.float32),
        np.zeros((6, 2 * ny * LANES), np.float32),
    )


@compiled
def column_ranges(bound):
    """Return the first row with a bound > 0 in each column, and the number of rows up to the last
    one.
    """
    ny, nx = bound.shape
    first, count = np.zeros(nx, np.int64), np.zeros(nx, np.int64)
    for j in range(nx):
        for i in range(ny):
            if bound[i, j] > 0.0:
                if count[j] == 0:
                    first[j] = i
                count[j] = i - first[j] + 1
    return first, count


@compiled
def _list_systems(derivative, first, count, which):
    """Write the systems of the loaded columns into `which` and return their number; columns of like
    length meet.

    A system along the traction reaches from the first to the last sticking element; sliding ones
    have nothing to solve.
    """
    nx, number = count.size, 0
    which[:, ROWS] = 0
    for direction in (ACROSS, ALONG):
        for k in range(nx):
            j = k // 2 if k % 2 == 0 else nx - 1 - k // 2
            low, high = first[j], first[j] + count[j]
            while low < high and derivative[direction, low, j] == 0.0:
                low += 1
            while high > low and derivative[direction, high - 1, j] == 0.0:
                high -= 1
            if high > low:
                which[number, COLUMN], which[number, DIRECTION] = j, direction
                which[number, FIRST], which[number, ROWS] = low, high - low
                number += 1
    return number


@fast
def _factorise(columns, n):
    """Factorise matrices (., WIDTH, LANES) into L U in place; `columns` holds the matrices by their
    columns.

    Rows are not exchanged: the differences lean towards the leading edge, which keeps the pivots
    away from 0. Zero pivots are left out.
    """
    flat, one = columns.reshape(-1), np.float32(1.0)
    for k in range(n):
        diagonal, rows = (k * WIDTH + BAND) * LANES, min(BAND, n - k - 1)
        below = diagonal + LANES
        for lane in range(LANES):
            pivot = flat[diagonal + lane]
            flat[diagonal + lane] = one / pivot if pivot != 0.0 else 0.0
        multiply(flat, below, flat, diagonal, rows)
        for m in range(k + 1, k + rows + 1):
            row = (m * WIDTH + BAND + k - m) * LANES
            subtract_multiple(flat, row + LANES, flat, below, flat, row, rows)


@fast
def _spread(slips, rho, lines):
    """Write rho times the slips (2, 2 ny - 1) into two `lines`, each number once for every lane."""
    for c in range(2):
        for i in range(slips.shape[1]):
            for lane in range(LANES):
                lines[c, i * LANES + lane] = rho * slips[c, i]


@fast
def _fill(systems, group, derivative, n):
    """Write the matrices 1 - w + w rho d B d of a group; w is the derivative in the direction d of
    each element.
    """
    which, x, y = (
        systems.which[group * LANES : (group + 1) * LANES],
        systems.x[group],
        systems.y[group],
    )
    line = systems.line
    own_x, own_y, along_x, along_y, minus_y, other = (
        line[0],
        line[1],
        line[2],
        line[3],
        line[4],
        line[5],
    )
    ny, size = derivative.shape[1], n * LANES
    weight = other[size:]
    x[:], y[:], weight[:] = 0.0, 0.0, 0.0
    for lane in range(LANES):
        j, along, first = which[lane, COLUMN], which[lane, DIRECTION] == ALONG, which[lane, FIRST]
        for i in range(which[lane, ROWS]):
            at = i * LANES + lane
            c, s = derivative[NORMAL_X, first + i, j], derivative[NORMAL_Y, first + i, j]
            x[at], y[at] = (c, s) if along else (-s, c)
            weight[at] = derivative[which[lane, DIRECTION], first + i, j]
    for t in range(size):
        along_x[t], along_y[t], minus_y[t] = weight[t] * x[t], weight[t] * y[t], -y[t]
    for m in range(n):
        low, high = max(m - BAND, 0), min(m + BAND + 1, n)
        column, to, start = (
            systems.factors[group, m].reshape(-1),
            (BAND - m) * LANES,
            (ny - 1 - m) * LANES,
        )
        for t in range(low * LANES, high * LANES):
            column[to + t] = along_x[t] * own_x[start + t]
            other[t] = along_y[t] * own_y[start + t]
        multiply(column, to + low * LANES, x, m * LANES, high - low)
        subtract_multiple(
            column, to + low * LANES, other, low * LANES, minus_y, m * LANES, high - low
        )
        for t in range(m * LANES, (m + 1) * LANES):
            column[to + t] += np.float32(1.0) - weight[t]


@fast
def factorise(slips, derivative, rho, first, count, systems):
    """Factorise the systems of all columns in `systems` and return the number of their groups.

    Rows beyond those of a system are rows of the identity. `derivative` (4, ny, nx) is that of
    `loops.jacobian`.
    """
    _spread(slips, rho, systems.line)
    groups = -(-_list_systems(derivative, first, count, systems.which) // LANES)
    for group in range(groups):
        n = systems.which[group * LANES : (group + 1) * LANES, ROWS].max()
        _fill(systems, group, derivative, n)
        _factorise(systems.factors[group], n)
    return groups


@fast
def apply_inverse(systems, groups, field, out):
    """Apply the preconditioner to `field` and write `out`, both (ny, nx, 2); elements without
    system stay unchanged.
    """
    line, before = systems.line[2], systems.line[3]
    assign(out, field)
    for group in range(groups):
        which, flat = (
            systems.which[group * LANES : (group + 1) * LANES],
            systems.factors[group].reshape(-1),
        )
        n, x, y = which[:, ROWS].max(), systems.x[group], systems.y[group]
        line[: n * LANES] = 0.0
        for lane in range(LANES):
            j, first = which[lane, COLUMN], which[lane, FIRST]
            for i in range(which[lane, ROWS]):
                at = i * LANES + lane
                line[at] = x[at] * field[first + i, j, 0] + y[at] * field[first + i, j, 1]
        assign(before[: n * LANES], line[: n * LANES])
        for m in range(n):
            below = (m * WIDTH + BAND + 1) * LANES
            subtract_multiple(
                line, (m + 1) * LANES, flat, below, line, m * LANES, min(BAND, n - m - 1)
            )
        for m in range(n - 1, -1, -1):
            diagonal, rows = (m * WIDTH + BAND) * LANES, min(BAND, m)
            multiply(line, m * LANES, flat, diagonal, 1)
            subtract_multiple(
                line, (m - rows) * LANES, flat, diagonal - rows * LANES, line, m * LANES, rows
            )
        for lane in range(LANES):
            j, first = which[lane, COLUMN], which[lane, FIRST]
            for i in range(which[lane, ROWS]):
                at = i * LANES + lane
                change = line[at] - before[at]
                out[first + i, j, 0] += change * x[at]
                out[first + i, j, 1] += change * y[at]


class Operator(NamedTuple):
    """Spectra p, q of the product B, which maps tractions to slips; see `Influence`."""

    p: np.ndarray
    q: np.ndarray


class Columns(NamedTuple):
    """Loaded columns: own influence `slips` (see `Influence.column`), first loaded row and number
    of loaded rows.
    """

    slips: np.ndarray
    first: np.ndarray
    loaded: np.ndarray


class Derivative(NamedTuple):
    """Derivative of the friction law in each element; see `loops.jacobian`.

    projection : P' (4, ny, nx); turn : (4, ny, nx), used only where friction `falls`; rho : scale
        of the slips.
    """

    projection: np.ndarray
    turn: np.ndarray
    falls: bool
    rho: float


class Space(NamedTuple):
    """Work space of a Newton step.

    systems : of the preconditioner; basis : Krylov basis (m + 1, 2 ny nx); moves : of each vector
        of the basis the traction and the slip that it stands for, complex (m, 2, ny, nx);
        transforms : see `convolve`.
    """

    systems: Systems
    basis: np.ndarray
    moves: np.ndarray
    transforms: np.ndarray


class Triangle(NamedTuple):
    """Hessenberg matrix (m + 1, m) on its way to a triangle, Givens rotations (2, m) and right-hand
    side (m + 1,).
    """

    hessenberg: np.ndarray
    givens: np.ndarray
    rhs: np.ndarray


@fast
def dot(a, b):
    """Return the scalar product of two vectors."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@compiled
def _rotate(triangle, k):
    """Apply Givens rotations to column k; the last entry of the right-hand side becomes the
    residual's norm.
    """
    hessenberg, givens, rhs = triangle
    for i in range(k):
        c, s = givens[0, i], givens[1, i]
        a, b = hessenberg[i, k], hessenberg[i + 1, k]
        hessenberg[i, k], hessenberg[i + 1, k] = c * a + s * b, c * b - s * a
    a, b = hessenberg[k, k], hessenberg[k + 1, k]
    length = math.sqrt(a * a + b * b)
    c, s = (1.0, 0.0) if length == 0.0 else (a / length, b / length)
    givens[0, k], givens[1, k] = c, s
    hessenberg[k, k], hessenberg[k + 1, k] = length, 0.0
    rhs[k + 1] = -s * rhs[k]
    rhs[k] = c * rhs[k]


@fast
def arnoldi(direction, product, mean, derivative, basis, k, triangle):
    """Extend the Krylov space by Newton's matrix times `direction` and return the norm of the
    residual.

    The matrix times a direction d is d - P'(d - rho B d) - turn M B d, made orthogonal to basis[: k
    + 1]; `product` is B d and `mean` its `row_means` M B d.
    """
    projection, turn, rho = derivative.projection, derivative.turn, derivative.rho
    hessenberg = triangle.hessenberg
    ny, nx = projection.shape[1], projection.shape[2]
    v = basis[k + 1]
    for i in range(ny):
        for j in range(nx):
            bx, by = product[i, j, 0], product[i, j, 1]
            dx, dy = direction[i, j, 0], direction[i, j, 1]
            x, y = dx - rho * bx, dy - rho * by
            c, s = projection[NORMAL_X, i, j], projection[NORMAL_Y, i, j]
            along = projection[ALONG, i, j] * (c * x + s * y)
            across = projection[ACROSS, i, j] * (c * y - s * x)
            mx, my = mean[i, j, 0], mean[i, j, 1]
            place = 2 * (i * nx + j)
            v[place] = dx - c * along + s * across - turn[XX, i, j] * mx - turn[XY, i, j] * my
            v[place + 1] = dy - s * along - c * across - turn[YX, i, j] * mx - turn[YY, i, j] * my
    for i in range(k + 1):
        h = dot(basis[i], v)
        hessenberg[i, k] = h
        row = basis[i]
        for j in range(v.size):
            v[j] -= h * row[j]
    h = math.sqrt(dot(v, v))
    hessenberg[k + 1, k] = h
    if h > 0.0:
        for j in range(v.size):
            v[j] /= h
    _rotate(triangle, k)
    return abs(triangle.rhs[k + 1])


@compiled
def combination(vectors, triangle, done, out):
    """Write the least-squares combination of vectors[: done] (m, n) into `out` (n,)."""
    hessenberg, rhs = triangle.hessenberg, triangle.rhs
    out[:] = 0.0
    for i in range(done - 1, -1, -1):
        for j in range(i + 1, done):
            rhs[i] -= hessenberg[i, j] * rhs[j]
        rhs[i] = rhs[i] / hessenberg[i, i] if hessenberg[i, i] != 0.0 else 0.0
        for j in range(out.size):
            out[j] += rhs[i] * vectors[i, j]


@compiled
def solve(value, derivative, columns, operator, tolerance, space, move):
    """Solve Newton's matrix against the residual `value` (ny, nx) by preconditioned GMRES; return
    the products.

    The solution and the slip that it causes go into `move` (2, ny, nx). `tolerance` limits the
    linear residual over the norm of `value`.
    """
    ny, nx = value.shape
    slips, first, count = columns
    groups = factorise(slips, derivative.projection, derivative.rho, first, count, space.systems)
    limit = space.moves.shape[0]
    triangle = Triangle(np.zeros((limit + 1, limit)), np.zeros((2, limit)), np.zeros(limit + 1))
    mean = np.zeros((ny, nx, 2))
    flat = reals(value).reshape(-1)
    norm = math.sqrt(dot(flat, flat))
    for j in range(flat.size):
        space.basis[0, j] = flat[j] / norm
    triangle.rhs[0] = norm
    done = 0
    for k in range(limit):
        traction, slip = space.moves[k, 0], space.moves[k, 1]
        apply_inverse(space.systems, groups, space.basis[k].reshape(ny, nx, 2), reals(traction))
        convolve(traction, operator.p, operator.q, space.transforms, slip)
        if derivative.falls:
            row_means(reals(slip), first, count, mean)
        rest = arnoldi(reals(traction), reals(slip), mean, derivative, space.basis, k, triangle)
        done = k + 1
        if rest <= tolerance * norm:
            break
    vectors = space.moves.reshape(limit, -1).view(np.float64)
    combination(vectors, triangle, done, move.reshape(-1).view(np.float64))
    return done


# If many elements between sticking ones are wrongly taken as sliding, Newton's method corrects only
# one of them in each step, from the leading edge on, with short steps. After SHORT steps of at most
# half length, a leap sets all of them to stick at once. The residual may then rise by the factor
# RISE. If it does not fall below its former value within TRIAL steps, the leap is undone.
SHORT, RISE, TRIAL = 2, 8.0, 3


class Problem(NamedTuple):
    """Tangential problem of one patch.

    Attributes
    ----------
    influence : Influence
        Influence functions of the elements.
    rigid : ndarray of complex, shape (ny, nx)
        Scaled rigid slip, x + iy.
    height : ndarray, shape (ny, nx)
        Scaled traction bound at rest.
    scale : float
        Slip speed per scaled slip [mm/s].
    knots, factors : ndarray, shape (m,)
        Slip speeds [mm/s] and friction over its value at rest [1].
    """

    influence: Influence
    rigid: np.ndarray
    height: np.ndarray
    scale: float
    knots: np.ndarray
    factors: np.ndarray


class Law(NamedTuple):
    """The friction law on one patch; attributes as in `Problem`, `falls` if friction depends on the
    slip.
    """

    height: np.ndarray
    scale: float
    knots: np.ndarray
    factors: np.ndarray
    falls: bool
    rho: float


class Room(NamedTuple):
    """Work space for patches of ny x nx elements: fields of the iteration and arrays of its linear
    systems.
    """

    bound: np.ndarray
    slope: np.ndarray
    held: np.ndarray
    mean: np.ndarray
    value: np.ndarray
    projection: np.ndarray
    turn: np.ndarray
    space: Space


@compiled
def room_for(ny, nx, krylov):
    """Return work space for patches of ny x nx elements, with a Krylov space of at most `krylov`
    vectors.
    """
    return Room(
        np.empty((ny, nx)),
        np.zeros((ny, nx)),
        np.zeros((ny, nx), np.bool_),
        np.zeros((ny, nx, 2)),
        np.empty((ny, nx), np.complex128),
        np.empty((4, ny, nx)),
        np.empty((4, ny, nx)),
        Space(
            systems_for(ny, nx),
            np.empty((krylov + 1, 2 * ny * nx)),
            np.empty((krylov, 2, ny, nx), np.complex128),
            np.empty((2, 2 * ny, 2 * nx), np.complex128),
        ),
    )


class Work(NamedTuple):
    """Work space of one patch and the parts of its linear systems."""

    room: Room
    derivative: Derivative
    columns: Columns
    operator: Operator


@compiled
def _state(law, work, traction, slip):
    """Compute bounds and residual at a traction and slip; return the residual's largest component
    and its norm.
    """
    if law.falls:
        row_means(reals(slip), work.columns.first, work.columns.loaded, work.room.mean)
        law_of_slip(
            work.room.mean,
            law.height,
            law.scale,
            law.knots,
            law.factors,
            work.room.bound,
            work.room.slope,
        )
    return residual(reals(traction), reals(slip), work.room.bound, law.rho, reals(work.room.value))


@compiled
def _step(law, work, traction, slip, tolerance, leap, move):
    """Write Newton's step and the slip that it causes into `move`; return its products. A leap
    holds the slits.
    """
    moved, d = reals(slip), work.derivative
    jacobian(
        reals(traction),
        moved,
        work.room.mean,
        work.room.bound,
        work.room.slope,
        law.rho,
        d.projection,
        d.turn,
    )
    if leap:
        hold(work.room.held, moved, law.rho, reals(work.room.value), d.projection, d.turn)
    return solve(work.room.value, d, work.columns, work.operator, tolerance, work.room.space, move)


@compiled
def _move(start, step, length, out):
    """Write start - length step into `out`."""
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = start[i, j] - length * step[i, j]


@compiled
def _search(law, work, at, norm, moves, new):
    """Halve the step until the residual's norm falls, at most four times; return residual, norm and
    step length.

    `at`, `moves` and `new` hold a traction and a slip (2, ny, nx); `new` is written.
    """
    length = 1.0
    while True:
        for k in range(2):
            _move(at[k], moves[k], length, new[k])
        largest, new_norm = _state(law, work, new[0], new[1])
        if new_norm < (1.0 - 0.1 * length) * norm or length < 0.05 or math.isnan(new_norm):
            return largest, new_norm, length
        length *= 0.5


@compiled
def _iterate(law, work, at, tolerance, limit):
    """Iterate on the tractions and slips `at` (2, ny, nx); return residual, Newton steps and
    products.
    """
    new, moves, before = np.empty_like(at), np.empty_like(at), np.empty_like(at)
    largest, norm = _state(law, work, at[0], at[1])
    norm_before, left, short = norm, 0, 0  # state before a leap; steps left to improve on it
    products, iteration = 1, 0
    while largest > tolerance and iteration < limit:
        iteration += 1
        # Far from the solution a rough linear solution is enough. Near it, a precise one gives
        # quadratic convergence.
        inner = max(0.3 * tolerance / largest, min(0.3, largest))
        leap = short >= SHORT and left == 0
        if leap:
            leap = (
                find_slits(reals(at[0]), reals(at[1]), work.room.bound, law.rho, work.room.held) > 0
            )
        products += _step(law, work, at[0], at[1], inner, leap, moves)
        if leap:
            for k in range(2):
                _move(at[k], moves[k], 1.0, new[k])
            new_largest, new_norm = _state(law, work, new[0], new[1])
            short = 0
            if new_norm < RISE * norm:
                norm_before, left, largest, norm = norm, TRIAL, new_largest, new_norm
                assign(before, at)
                assign(at, new)
            else:
                largest, norm = _state(law, work, at[0], at[1])
            continue
        largest, norm, length = _search(law, work, at, norm, moves, new)
        assign(at, new)
        short = short + 1 if length <= 0.5 else 0
        if left > 0:
            improved = norm < 0.9 * norm_before
            left = 0 if improved else left - 1
            if left == 0 and not improved:
                assign(at, before)
                largest, norm = _state(law, work, at[0], at[1])
                short = -TRIAL
    return largest, iteration, products


@compiled
def newton(problem, room, traction, tolerance, limit):
    """Solve the friction law on one patch, starting from `traction`.

    Parameters
    ----------
    problem : Problem
        The patch.
    room : Room
        Work space, overwritten.
    traction : ndarray of complex, shape (ny, nx)
        Start, scaled.
    tolerance : float
        Largest residual of the friction law in any element, scaled as the traction.
    limit : int
        Limit of Newton steps.

    Returns
    -------
    tuple
        Tractions and slips (2, ny, nx); largest component of the residual; number of Newton steps;
        number of products. The traction bounds at these slips are in `room`.
    """
    functions, rho, falls = problem.influence, 1.0 / problem.influence.own, problem.knots.size > 1
    first, loaded = column_ranges(problem.height)
    room.mean[:] = 0.0
    # constant friction needs the bounds once; a friction law overwrites them with those of its
    # slips
    law_of_slip(
        room.mean,
        problem.height,
        problem.scale,
        problem.knots,
        problem.factors,
        room.bound,
        room.slope,
    )
    work = Work(
        room,
        Derivative(room.projection, room.turn, falls, rho),
        Columns(functions.column, first, loaded),
        Operator(functions.p, functions.q),
    )
    law = Law(problem.height, problem.scale, problem.knots, problem.factors, falls, rho)
    at = np.empty((2, *traction.shape), np.complex128)
    assign(at[0], traction)
    assign(at[1], problem.rigid)
    if np.any(traction != 0.0):
        convolve(traction, functions.p, functions.q, room.space.transforms, room.value)
        assign(at[1], at[1] + room.value)
    largest, steps, products = _iterate(law, work, at, tolerance, limit)
    return at, largest, steps, products
