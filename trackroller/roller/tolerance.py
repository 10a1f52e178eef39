"""Meet a tolerance: walk the rungs of accuracy, and give each case the result of the first rung
that keeps it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.damage import fatigue
from trackroller.parameters.accuracy import RUNGS, Tolerance
from trackroller.roller.block_results import BlockResults, join
from trackroller.roller.case_limits import solved_of
from trackroller.roller.dataset import validity_bit
from trackroller.roller.expected_errors import least_errors

if TYPE_CHECKING:
    from trackroller.roller.case import CaseTable
    from trackroller.roller.options import Options

FORCE_ERRORS = (
    "force_error_estimate",
    "normal_force_error_estimate",
    "friction_energy_error_estimate",
)


def meet(
    table: CaseTable, options: Options, solve: Callable[[CaseTable, Options], BlockResults]
) -> BlockResults:
    """Solve cases on the rungs of accuracy until their estimated errors are within the tolerance.

    Parameters
    ----------
    table : CaseTable
        The cases.
    options : Options
        Their options; without a tolerance the cases are solved once.
    solve : callable
        Solve a table with options.

    Returns
    -------
    BlockResults
        The results. With a tolerance they have `error_over_tolerance` (n,), NaN for cases that did
        not converge, and the flag `tolerance_missed` where no rung keeps the tolerance. Such a case
        has the result of the rung with the smallest estimated error.

    Notes
    -----
    A case skips a rung that cannot keep its tolerance, see `expected_errors.least_errors`. This
    saves about a quarter of the time at a tolerance of 0.01.
    """
    tolerance = options.tolerance
    if tolerance is None:
        return solve(table, options)
    blocks: list[BlockResults] = []
    row_of_best = np.full(len(table), -1)  # of the best result so far
    best = np.full(len(table), np.inf)  # its error
    unmet = np.arange(len(table))
    for rung in RUNGS:
        own = options.changed(accuracy=rung)
        if rung == RUNGS[-1]:
            rows = unmet
        else:
            rows = unmet[_may_keep(table.take(unmet), own, tolerance)]
        if not rows.size and (blocks or rung != RUNGS[-1]):
            continue
        block = solve(table.take(rows), own)
        over = _over(table.take(rows), block, own, tolerance)
        block.values["error_over_tolerance"] = over
        known = np.where(np.isnan(over), np.inf, over)
        better = (row_of_best[rows] < 0) | (known <= best[rows])
        row_of_best[rows[better]] = sum(map(len, blocks)) + np.flatnonzero(better)
        best[rows[better]] = known[better]
        blocks.append(block)
        unmet = unmet[~(best[unmet] <= 1.0)]
    block_of_best = join(blocks).take(row_of_best)
    missed = block_of_best.values["error_over_tolerance"] > 1.0
    block_of_best.bits |= np.where(missed, validity_bit("tolerance_missed"), 0).astype(
        block_of_best.bits.dtype
    )
    return block_of_best


def _peak_tolerance(table: CaseTable, options: Options, tolerance: Tolerance) -> np.ndarray:
    """Return the tolerance of the peaks of each case, (n,): that of a life is its tolerance over
    the exponent.
    """
    if not np.isfinite(tolerance.life):
        return np.full(len(table), tolerance.peak)
    exponent = np.broadcast_to(
        fatigue.curve_of(solved_of(table, {}, options)).slope(0.0), (len(table), 1, 2)
    )
    return np.fmin(tolerance.peak, tolerance.life / np.fmax(exponent.max(axis=(1, 2)), 1.0))


def _over(
    table: CaseTable, block: BlockResults, options: Options, tolerance: Tolerance
) -> np.ndarray:
    """Return the largest estimated error of each case over its tolerance, (n,); NaN for cases
    without convergence.
    """

    def largest(*names: str) -> Any:
        """Return the largest of results, (n,); a result that a regime leaves undefined does not
        count.
        """
        errors = [
            np.nan_to_num(block.values[name]).reshape(len(table), -1)
            for name in names
            if name in block.values
        ]
        if errors:
            return np.max(np.concatenate(errors, axis=1), axis=1)
        return np.zeros(len(table))

    peaks = largest("error_estimate") / _peak_tolerance(table, options, tolerance)
    over = np.fmax(largest(*FORCE_ERRORS) / tolerance.forces, peaks)
    return np.where(block.converged == 1, over, np.nan)


def _may_keep(table: CaseTable, options: Options, tolerance: Tolerance) -> np.ndarray:
    """Return whether the rung of the options may keep the tolerance of each case, (n,)."""
    forces, peaks = least_errors(table, options)
    return (forces <= tolerance.forces) & (peaks <= _peak_tolerance(table, options, tolerance))
