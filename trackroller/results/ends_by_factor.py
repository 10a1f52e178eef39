"""What ends the cases of a study at each level of its factors, as a table of counts."""

from __future__ import annotations

import numpy as np
import pandas as pd

from trackroller.damage import limit_word
from trackroller.parameters import BODIES
from trackroller.parameters.carriage_fields import long_name_of
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.factor_levels import BINS, classes
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.subgroups import level_text
from trackroller.roller.output_names import is_life
from trackroller.study.design.factor_names import OPTION_FACTORS

NOTHING = "nothing ends it"
UNKNOWN = "not known"


def end_of_case(ranges: CaseRanges) -> np.ndarray:
    """Return what ends each case in words, shape (n,): a limit of a body, or why the case is not
    held or judged.
    """
    life = ranges.results.life
    if not is_life(ranges.output[0]) and life is not None:
        return end_of_case(CaseRanges(ranges.results, life, True))
    names, guide = ranges.first
    out = np.empty(len(names), dtype=object)
    for row, (reason, name) in enumerate(zip(ranges.reason, names, strict=True)):
        if reason:
            out[row] = limit_word(str(reason).removeprefix("limit "))
        elif np.isposinf(ranges.value[row]):
            out[row] = NOTHING
        elif name:
            out[row] = f"{limit_word(str(name))} of the {BODIES[int(guide[row])]}"
        else:
            out[row] = UNKNOWN
    return out


def ends_by_factor(results: SolvedCases, ranges: CaseRanges) -> pd.DataFrame:
    """Return counts of cases by what ends them (columns) at each level or class of a factor (rows).

    Parameters
    ----------
    results : the solved study
    ranges : the life of its cases

    Returns
    -------
    Columns `factor` (its words) and `level`, then one column for each end, the most frequent one
    first. The first row holds all cases. Cases of a less exact contact model are left out.
    """
    rows = results.of_one_model()
    ends = end_of_case(ranges)[rows]
    order = pd.Series(ends).value_counts().index.tolist()
    counts = [{"factor": "all", "level": ""} | _counts(ends, order)]
    for name in results.factors:
        if name in OPTION_FACTORS:
            continue
        index, levels = classes(results.table, name, rows, BINS)
        for place, level in enumerate(levels):
            here = index == place
            if here.any():
                counts.append(
                    {"factor": long_name_of(name), "level": _words(name, level)}
                    | _counts(ends[here], order)
                )
    return pd.DataFrame(counts)


def _counts(ends: np.ndarray, order: list[str]) -> dict[str, int]:
    return {end: int((ends == end).sum()) for end in order}


def _words(name: str, level: object) -> str:
    """Return a level, or both ends of a class of levels, in words."""
    if isinstance(level, tuple):
        return f"{level_text(name, level[0])} to {level_text(name, level[1])}"
    return level_text(name, level)
