"""Solve for adhesion and slip on a patch by a semi-smooth Newton method with Krylov steps.

For each element with traction bound g the law of dry friction is the fixed point tau = P_g(tau - rho s), where
P_g shortens a vector to at most g and s = w + B tau is the slip (Alart & Curnier 1991). Newton's method is here the
active-set method of sticking and sliding elements. GMRES with fast products B tau solves its linear systems. If
friction depends on the slip, g is a function of s, and its derivative enters Newton's matrix.

Fields are complex, x + iy, (ny, nx); compiled loops run over their real numbers, (ny, nx, 2).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from trackroller.contact.influence import Influence, convolve
from trackroller.contact.kalker.columns import column_ranges, systems_for
from trackroller.contact.kalker.krylov import Columns, Derivative, Operator, Space, solve
from trackroller.contact.kalker.loops import find_slits, hold, jacobian, law_of_slip, reals, residual, row_means
from trackroller.numerics.compiled import assign, compiled

# If many elements between sticking ones are wrongly taken as sliding, Newton's method corrects only one of them in each
# step, from the leading edge on, with short steps. After SHORT steps of at most half length, a leap sets all of them to
# stick at once. The residual may then rise by the factor RISE. If it does not fall below its former value within TRIAL
# steps, the leap is undone.
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
    """The friction law on one patch; attributes as in `Problem`, `falls` if friction depends on the slip."""

    height: np.ndarray
    scale: float
    knots: np.ndarray
    factors: np.ndarray
    falls: bool
    rho: float


class Room(NamedTuple):
    """Work space for patches of ny x nx elements: fields of the iteration and arrays of its linear systems."""

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
    """Return work space for patches of ny x nx elements, with a Krylov space of at most `krylov` vectors."""
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
    """Compute bounds and residual at a traction and slip; return the residual's largest component and its norm."""
    if law.falls:
        row_means(reals(slip), work.columns.first, work.columns.loaded, work.room.mean)
        law_of_slip(work.room.mean, law.height, law.scale, law.knots, law.factors, work.room.bound, work.room.slope)
    return residual(reals(traction), reals(slip), work.room.bound, law.rho, reals(work.room.value))


@compiled
def _step(law, work, traction, slip, tolerance, leap, move):
    """Write Newton's step and the slip that it causes into `move`; return its products. A leap holds the slits."""
    moved, d = reals(slip), work.derivative
    jacobian(reals(traction), moved, work.room.mean, work.room.bound, work.room.slope, law.rho, d.projection, d.turn)
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
    """Halve the step until the residual's norm falls, at most four times; return residual, norm and step length.

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
    """Iterate on the tractions and slips `at` (2, ny, nx); return residual, Newton steps and products."""
    new, moves, before = np.empty_like(at), np.empty_like(at), np.empty_like(at)
    largest, norm = _state(law, work, at[0], at[1])
    norm_before, left, short = norm, 0, 0  # state before a leap; steps left to improve on it
    products, iteration = 1, 0
    while largest > tolerance and iteration < limit:
        iteration += 1
        # Far from the solution a rough linear solution is enough. Near it, a precise one gives quadratic convergence.
        inner = max(0.3 * tolerance / largest, min(0.3, largest))
        leap = short >= SHORT and left == 0
        if leap:
            leap = find_slits(reals(at[0]), reals(at[1]), work.room.bound, law.rho, work.room.held) > 0
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
        Tractions and slips (2, ny, nx); largest component of the residual; number of Newton steps; number of products.
        The traction bounds at these slips are in `room`.
    """
    functions, rho, falls = problem.influence, 1.0 / problem.influence.own, problem.knots.size > 1
    first, loaded = column_ranges(problem.height)
    room.mean[:] = 0.0
    # constant friction needs the bounds once; a friction law overwrites them with those of its slips
    law_of_slip(room.mean, problem.height, problem.scale, problem.knots, problem.factors, room.bound, room.slope)
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
