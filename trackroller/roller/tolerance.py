"""Meet a tolerance case by case: say which cases keep it, and solve whole cases again whose patches cannot be refined.

The stages refine the patches whose estimated errors are too large, see `contact.kalker.correction` and
`roller.stages.ellipse_stresses`. Patches under a friction law and solved patches keep their elements. Their cases are
solved again on more elements while an estimated error is larger than its tolerance.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from trackroller.roller.accuracy import WHOLE_ELEMENTS
from trackroller.roller.blocks import Block, join
from trackroller.roller.dataset import validity_bit

if TYPE_CHECKING:
    from trackroller.roller.case import CaseTable
    from trackroller.roller.options import Options


def meet(table: CaseTable, options: Options, solve: Callable[[CaseTable, Options], Block]) -> Block:
    """Solve cases within their tolerance, as far as their estimated errors reach it.

    Parameters
    ----------
    table : CaseTable
        The cases.
    options : Options
        Their options; without a tolerance by case the cases are solved once.
    solve : callable
        Solve a table with options.

    Returns
    -------
    Block
        The results, with `error_over_tolerance`, (n,), and the flag `tolerance_missed` if there is a tolerance.
    """
    block, tolerance = solve(table, options), options.tolerance
    if tolerance is None:
        return block
    whole = (table.friction_law != "") | (options.normal != "hertz")
    for elements in WHOLE_ELEMENTS:
        rows = np.flatnonzero(whole & (block.values["error_over_tolerance"] > 1.0) & (block.converged == 1))
        if rows.size:
            finer = solve(table.take(rows), options.changed(accuracy=tolerance.settings(elements)))
            place = np.arange(len(block))
            place[rows] = len(block) + np.arange(rows.size)
            block = join([block, finer]).take(place)
    over = np.where(block.converged == 1, block.values["error_over_tolerance"], np.nan)
    block.values["error_over_tolerance"] = over
    block.bits |= np.where(over > 1.0, validity_bit("tolerance_missed"), 0).astype(block.bits.dtype)
    return block
