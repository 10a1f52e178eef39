"""Meet a tolerance case by case: solve all cases on few elements, and only the doubtful ones again on more.

Each number of elements is a rung. The estimated error of a case is the change from the rung before, extrapolated by the
observed order of convergence, or less if the stages estimate a smaller error of the forces themselves. On the first
rung only these own estimates count. A case goes on to the first rung that promises to meet its tolerance.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from trackroller.damage import fatigue
from trackroller.roller.accuracy import Tolerance
from trackroller.roller.blocks import Block, join
from trackroller.roller.dataset import validity_bit
from trackroller.roller.stages.case import solved_of

if TYPE_CHECKING:
    from trackroller.roller.case import CaseTable
    from trackroller.roller.options import Options

ORDER = 1.3  # of convergence of forces and peaks, the lowest that was seen while elements double
SAFETY = 2.0  # factor on the extrapolated change
LEAP = 2  # rungs that a case goes up at once at most: a large estimate is a rough one
REACH = 8.0  # an error is not worth the next rung above this many times what the order promises there
# Factors on the errors that the stages estimate themselves, on the first rung, where nothing can be compared, and on
# later ones. With them 99 % of the forces and peaks of random designs lie within the tolerance.
FIRST_FORCES, FIRST_PEAKS = 2.8, 5.0
LATER_FORCES, LATER_PEAKS = 1.0, 0.4


def meet(table: CaseTable, options: Options, solve: Callable[[CaseTable, Options], Block]) -> Block:
    """Solve cases on the rungs of their tolerance, each case until its estimated error is small enough.

    Parameters
    ----------
    table : CaseTable
        The cases.
    options : Options
        Their options; without a tolerance by case they have one rung, and the cases are solved once.
    solve : callable
        Solve a table with options whose accuracy is a rung.

    Returns
    -------
    Block
        The results, with `error_over_tolerance`, (n,), and the flag `tolerance_missed` if there is a tolerance.
    """
    tolerance = options.tolerance
    if tolerance is None:
        return solve(table, options)
    rungs, at = tolerance.rungs, np.zeros(len(table), int)
    elements = np.array([rung.elements for rung in rungs])
    block = solve(table, options.changed(accuracy=rungs[0]))
    forces, peaks = _own_errors(block)
    limit = _peak_tolerance(table, block, tolerance, options)
    over = np.fmax(FIRST_FORCES * forces / tolerance.forces, FIRST_PEAKS * peaks / limit)
    over = np.where(block.converged == 1, over, 0.0)
    for number, rung in enumerate(rungs[1:], start=1):
        rows = np.flatnonzero(_next_rung(at, over, elements) == number)
        if rows.size == 0:
            continue
        part = table.take(rows)
        finer = solve(part, options.changed(accuracy=rung))
        factor = SAFETY / ((rung.elements / elements[at[rows]]) ** ORDER - 1.0)
        changed = _changes(table.friction_coefficient[rows], block.take(rows), finer)
        forces, peaks = _own_errors(finer)
        peaks = np.fmax(changed.pop("peak_stress", 0.0) * factor, LATER_PEAKS * peaks)
        forces = np.fmin(np.max([*changed.values()], axis=0) * factor, LATER_FORCES * forces)
        met = np.fmax(forces / tolerance.forces, peaks / _peak_tolerance(part, finer, tolerance, options))
        over[rows], at[rows] = np.where(finer.converged == 1, met, 0.0), number
        place = np.arange(len(block))
        place[rows] = len(block) + np.arange(rows.size)
        block = join([block, finer]).take(place)
    block.values.pop("peak_resolved", None)
    block.values["error_over_tolerance"] = np.where(block.converged == 1, over, np.nan)
    block.bits |= np.where(over > 1.0, validity_bit("tolerance_missed"), 0).astype(block.bits.dtype)
    return block


def _next_rung(at: np.ndarray, over: np.ndarray, elements: np.ndarray) -> np.ndarray:
    """Return the rung on which each case is solved next, (n,); 0 if it stays as it is.

    `at` is the rung of each case, (n,), `over` its error over its tolerance, (n,), `elements` those of the rungs.
    """
    gain = (elements / elements[at][:, None]) ** ORDER
    enough = (gain >= over[:, None]) & (gain > 1.0)
    following = np.where(enough.any(axis=1), enough.argmax(axis=1), len(elements) - 1)
    following = np.minimum(following, at + LEAP)
    hopeless = (at > 0) & (over > REACH * gain[np.arange(len(at)), following])
    return np.where((over <= 1.0) | hopeless | (following <= at), 0, following)


def _largest(values: np.ndarray | None, n: int) -> np.ndarray:
    """Return the largest known value of each case, (n,); 0 without one."""
    if values is None:
        return np.zeros(n)
    return np.asarray(np.nan_to_num(np.abs(values)).reshape(n, -1).max(axis=1))


def _own_errors(block: Block) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest errors of the forces and of the peaks that the stages estimate themselves, (n,) each."""
    names = "force_error_estimate", "normal_force_error_estimate", "error_estimate"
    force, normal, peak = (_largest(block.values.get(name), len(block)) for name in names)
    return np.fmax(force, normal), peak


def _changes(friction: np.ndarray, before: Block, after: Block) -> dict[str, np.ndarray]:
    """Return the largest change of each quantity of each case, (n,); `Tolerance` says relative to what."""
    n, old, new = len(after), before.values, after.values
    capacity = friction[:, None] * new["normal_force"]
    scale: dict[str, np.ndarray] = {
        name: new[name] for name in ("normal_force", "friction_energy_per_distance", "peak_stress") if name in new
    }
    if "peak_resolved" in new:  # finer elements around the adhesion area tell their own error
        scale["peak_stress"] = np.where(new["peak_resolved"][:, :, None] == 1, np.inf, new["peak_stress"])
    scale |= {"lateral_force": capacity, "driving_force": capacity}
    scale["spin_moment"] = capacity * np.sqrt(new["semi_axis_lateral"] * new["semi_axis_rolling"])
    with np.errstate(divide="ignore", invalid="ignore"):
        return {name: _largest((new[name] - old[name]) / size, n) for name, size in scale.items()}


def _peak_tolerance(table: CaseTable, block: Block, tolerance: Tolerance, options: Options) -> np.ndarray:
    """Return the tolerance of the peak stress, (n,): that of the life over the exponent of its S-N curve counts too."""
    limit = np.full(len(block), tolerance.peak)
    if not np.isfinite(tolerance.life) or "peak_stress" not in block.values:
        return limit
    solved = solved_of(table, block.values, options)
    exponent = fatigue.curve_of(solved).slope(fatigue.amplitude(solved))
    return np.fmin(limit, tolerance.life / np.fmax(_largest(exponent, len(block)), 1.0))
