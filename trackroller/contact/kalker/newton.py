"""Solve for adhesion and slip on a patch by a semi-smooth Newton method with Krylov steps.

For each element with traction bound g the law of dry friction is the fixed point tau = P_g(tau - rho s), where
P_g shortens a vector to at most g and s = w + B tau is the slip (Alart & Curnier 1991). Newton's method is here the
active-set method of sticking and sliding elements. GMRES with fast products B tau solves its linear systems. If
friction depends on the slip, g is a function of s, and its derivative enters Newton's matrix.

Fields are complex, x + iy, (ny, nx); compiled loops run over their real numbers, (ny, nx, 2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from trackroller.contact.influence import Influence, leading_rows
from trackroller.contact.kalker.columns import column_ranges, column_slips
from trackroller.contact.kalker.krylov import Columns, Derivative, Operator, Space, multiply, solve
from trackroller.contact.kalker.loops import find_slits, hold, jacobian, law_of_slip, reals, residual, row_means

# If many elements between sticking ones are wrongly taken as sliding, Newton's method corrects only one of them in each
# step, from the leading edge on, with short steps. After SHORT steps of at most half length, a leap sets all of them to
# stick at once. The residual may then rise by the factor RISE. If it does not fall below its former value within TRIAL
# steps, the leap is undone.
SHORT, RISE, TRIAL = 2, 8.0, 3


@dataclass(frozen=True)
class Problem:
    """Tangential problem of one patch.

    Parameters
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
    rolling : bool
        True: B is -d/dy of the displacements (steady rolling). False: B gives the displacements (shift from rest).
    """

    influence: Influence
    rigid: np.ndarray
    height: np.ndarray
    scale: float
    knots: np.ndarray
    factors: np.ndarray
    rolling: bool = True


@dataclass(frozen=True)
class _State:
    """Tractions, slips, and the largest component and the norm of the friction law's residual."""

    traction: np.ndarray
    slip: np.ndarray
    largest: float
    norm: float


class _Newton:
    """Work space and steps of Newton's method for one patch."""

    def __init__(self, problem: Problem, krylov: int) -> None:
        ny, nx = problem.height.shape
        functions = problem.influence
        self.problem, self.rho = problem, 1.0 / (functions.own if problem.rolling else functions.own_displacement)
        if problem.rolling:
            slips = column_slips(functions.column, functions.hy)
        else:
            slips = np.ascontiguousarray(np.repeat(functions.column[:, None, 1:-2], 2, axis=1))
        self.columns = Columns(slips, *column_ranges(problem.height))
        self.operator = Operator(functions.p, functions.q, leading_rows(problem.height), functions.hy, problem.rolling)
        self.derivative = Derivative(np.empty((3, ny, nx)), np.empty((4, ny, nx)), problem.knots.size > 1, self.rho)
        self.space = Space(
            np.empty((nx, 2, ny, ny)),
            np.empty((krylov + 1, 2 * ny * nx)),
            np.empty((2, *functions.p.shape), complex),
        )
        self.bound, self.slope, self.held = np.empty((ny, nx)), np.zeros((ny, nx)), np.zeros((ny, nx), bool)
        self.mean = np.zeros((ny, nx, 2))
        self.value, self.product = np.empty((ny, nx), complex), np.empty((ny, nx), complex)

    def multiply(self, field: np.ndarray) -> np.ndarray:
        """Return B `field` in an array that the next call overwrites."""
        multiply(field, self.operator, self.space.transforms, self.product)
        return self.product

    def state(self, traction: np.ndarray, slip: np.ndarray) -> _State:
        """Return the state at a traction and slip, and keep its residual and its traction bounds."""
        p = self.problem
        if self.derivative.falls:
            row_means(reals(slip), self.columns.first, self.columns.loaded, self.mean)
        law_of_slip(self.mean, p.height, p.scale, p.knots, p.factors, self.bound, self.slope)
        return _State(traction, slip, *residual(reals(traction), reals(slip), self.bound, self.rho, reals(self.value)))

    def slits(self, at: _State) -> bool:
        """Mark sliding elements in narrow gaps between sticking ones; return True if there are any."""
        return find_slits(reals(at.traction), reals(at.slip), self.bound, self.rho, self.held) > 0

    def step(self, at: _State, tolerance: float, leap: bool) -> tuple[np.ndarray, np.ndarray, int]:
        """Return Newton's step, the slip that it causes and its number of products; a leap makes the slits stick."""
        slip, d = reals(at.slip), self.derivative
        jacobian(reals(at.traction), slip, self.mean, self.bound, self.slope, self.rho, d.projection, d.turn)
        if leap:
            hold(self.held, slip, self.rho, reals(self.value), d.projection, d.turn)
        step = np.empty_like(self.value)
        products = solve(self.value, d, self.columns, self.operator, tolerance, self.space, step)
        return step, self.multiply(step), products + 1

    def search(self, at: _State, step: np.ndarray, change: np.ndarray) -> tuple[_State, float]:
        """Halve the step until the residual's norm falls, at most four times; return the state and the step length."""
        length = 1.0
        while True:
            new = self.state(at.traction - length * step, at.slip - length * change)
            if new.norm < (1.0 - 0.1 * length) * at.norm or length < 0.05 or math.isnan(new.norm):
                return new, length
            length *= 0.5


def newton(problem: Problem, traction: np.ndarray, tolerance: float, limit: int, krylov: int):
    """Solve the friction law on one patch, starting from `traction`.

    Parameters
    ----------
    problem : Problem
        The patch.
    traction : ndarray of complex, shape (ny, nx)
        Start, scaled.
    tolerance : float
        Largest residual of the friction law in any element, scaled as the traction.
    limit, krylov : int
        Limits of Newton steps and of the Krylov space of one step.

    Returns
    -------
    tuple
        Tractions, slips and traction bounds at these slips, (ny, nx) each; largest component of the residual; number
        of Newton steps; number of products.
    """
    work = _Newton(problem, krylov)
    at = work.state(traction, problem.rigid + work.multiply(traction))
    before, left, short = at, 0, 0  # state before a leap; steps left to improve on it
    products, iteration = 1, 0
    while at.largest > tolerance and iteration < limit:
        iteration += 1
        # Far from the solution a rough linear solution is enough. Near it, a precise one gives quadratic convergence.
        inner = max(0.3 * tolerance / at.largest, min(0.03, 0.1 * at.largest))
        leap = short >= SHORT and not left and work.slits(at)
        step, change, used = work.step(at, inner, leap)
        products += used
        if leap:
            new = work.state(at.traction - step, at.slip - change)
            short = 0
            if new.norm < RISE * at.norm:
                before, left, at = at, TRIAL, new
            else:
                at = work.state(at.traction, at.slip)
            continue
        at, length = work.search(at, step, change)
        short = short + 1 if length <= 0.5 else 0
        if left:
            left = 0 if at.norm < 0.9 * before.norm else left - 1
            if not left and not at.norm < 0.9 * before.norm:
                at, short = work.state(before.traction, before.slip), -TRIAL
    return at.traction, at.slip, work.bound, at.largest, iteration, products
