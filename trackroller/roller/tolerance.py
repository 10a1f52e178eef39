"""Meet a tolerance case by case: solve all cases on few elements, and only the doubtful ones again on more.

The estimated error of a case is the change from the rung before, extrapolated by the observed order of convergence. On
the first rung, and for peaks on every rung, the errors count that the stages estimate themselves.
"""

from __future__ import annotations

import itertools
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
SAFETY = 1.5  # factor on the extrapolated change
REACH = 4.0  # an error is not worth the next rung above this many times what the order promises there
# Factors on the errors that the stages estimate themselves on the first rung, where nothing can be compared: with them
# 99 % of the forces and peaks of random designs lie within the tolerance.
FIRST_FORCES, FIRST_PEAKS = 2.5, 5.0


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
    rungs = tolerance.rungs
    block = solve(table, options.changed(accuracy=rungs[0]))
    over = _estimated(block, tolerance, _peak_tolerance(table, block, tolerance, options))
    for before, rung in itertools.pairwise(rungs):
        gain = (rung.elements / before.elements) ** ORDER
        rows = np.flatnonzero((over > 1.0) & ((over <= REACH * gain) | (before is rungs[0])))
        if rows.size == 0:
            break
        finer = solve(table.take(rows), options.changed(accuracy=rung))
        limit = _peak_tolerance(table.take(rows), finer, tolerance, options)
        changed = _changes(table.friction_coefficient[rows], block.take(rows), finer)
        own = _largest(finer.values.get("error_estimate"), len(rows))
        peak = np.fmax(changed.pop("peak_stress", 0.0) * SAFETY / (gain - 1.0), own)
        forces = np.max([*changed.values()], axis=0) * SAFETY / (gain - 1.0)
        over[rows] = np.where(finer.converged == 1, np.fmax(forces / tolerance.forces, peak / limit), 0.0)
        place = np.arange(len(block))
        place[rows] = len(block) + np.arange(rows.size)
        block = join([block, finer]).take(place)
    block.values["error_over_tolerance"] = np.where(block.converged == 1, over, np.nan)
    block.bits |= np.where(over > 1.0, validity_bit("tolerance_missed"), 0).astype(block.bits.dtype)
    return block


def _largest(values: np.ndarray | None, n: int) -> np.ndarray:
    """Return the largest known value of each case, (n,); 0 without one."""
    if values is None:
        return np.zeros(n)
    return np.asarray(np.nan_to_num(np.abs(values)).reshape(n, -1).max(axis=1))


def _estimated(block: Block, tolerance: Tolerance, peaks: np.ndarray) -> np.ndarray:
    """Return the errors over their tolerances that the stages of the first rung estimate themselves, (n,)."""
    forces = [_largest(block.values.get(f"{name}force_error_estimate"), len(block)) for name in ("", "normal_")]
    peak = _largest(block.values.get("error_estimate"), len(block))
    over = np.fmax(FIRST_FORCES * np.max(forces, axis=0) / tolerance.forces, FIRST_PEAKS * peak / peaks)
    return np.where(block.converged == 1, over, 0.0)


def _changes(friction: np.ndarray, before: Block, after: Block) -> dict[str, np.ndarray]:
    """Return the largest change of each quantity of each case, (n,); `Tolerance` says relative to what."""
    n, old, new = len(after), before.values, after.values
    capacity = friction[:, None] * new["normal_force"]
    scale: dict[str, np.ndarray] = {
        name: new[name] for name in ("normal_force", "friction_energy_per_distance", "peak_stress") if name in new
    }
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
