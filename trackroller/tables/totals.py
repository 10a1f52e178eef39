"""Find the lines of a table that sum up other lines: they are no cases."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.units import split_quantity

ROUNDED = 0.01  # relative difference between a sum and what a line of totals states
FAR = 1.8  # times the largest addend

_SUM = re.compile(
    r"(?:grand |sub-?)?totals?|sum|summe|gesamt(?:summe)?|zwischensumme|mean|average|mittelwert|[Σ∑]",
    re.IGNORECASE,
)


def total_lines(lines: Mapping[int, list[str]], numbers: Sequence[int], labels: Sequence[int]) -> list[int]:
    """Return the numbers of lines that are named as a total, and of a last line that surely is one.

    Parameters
    ----------
    lines : mapping
        The cells of each line by its number.
    numbers : sequence of int
        Places of the columns of numbers.
    labels : sequence of int
        Places of the columns in which a total may have its name.
    """
    rows = list(lines.items())
    totals = [number for number, line in rows if _is_named_total(line, labels)]
    if rows and _sums_up([line for _, line in rows[:-1]], rows[-1][1], numbers):
        totals.append(rows[-1][0])
    return list(dict.fromkeys(totals))


def _is_named_total(line: list[str], labels: Sequence[int]) -> bool:
    return any(_SUM.fullmatch(line[j].strip(" :")) for j in labels)


def _sums_up(above: list[list[str]], line: list[str], numbers: Sequence[int]) -> bool:
    """Return whether the numbers of a line are sums of the lines above, maybe rounded, of three addends at least.

    Levels such as 0, 10, 20 and 30 or 0, 3, 0 and 3 often add up; their sum is not far above the largest.
    """
    is_far = False
    for j in numbers:
        value = value_of(line[j])
        if not line[j] or value == 0:
            continue
        addends = [number for number in (value_of(cells[j]) for cells in above) if number]
        if len(addends) < 3 or not math.isclose(sum(addends), value, rel_tol=ROUNDED):
            return False
        if abs(value) > FAR * max(map(abs, addends)):
            is_far = True
    return is_far


def value_of(cell: str) -> float:
    """Return the number of a cell, whatever unit stands behind it; NaN for a cell without a number."""
    digits, _ = split_quantity(cell) or (cell, "")
    return number_or_nan(digits)
