"""Declare what a result variable is: its dimensions, unit, symbol and name."""

from __future__ import annotations

from dataclasses import dataclass

BODIES = ("roller", "guide")  # values of the coordinate `body`
# `regime` holds the place of the word, from 0
REGIMES = ("rolling", "full_slip", "lift_off", "failed")
# further fields of a variable: the worse contact counts, or both contacts add up
LARGEST, SMALLEST, SUM = ({"joined": way} for way in ("max", "min", "sum"))
ESTIMATE = LARGEST | {"estimate": True}  # of the error of another result
LIFE = {"scale": "log10", "life": True}


@dataclass(frozen=True)
class Variable:
    """A result: its dimensions, unit, symbol and name.

    Parameters
    ----------
    name, group : str
        Name in a data set, and the group of `outputs` that brings the variable.
    dims : tuple of str
        Dimensions after `case`.
    units, symbol, long_name : str
        Unit as the CF conventions write it, symbol of the publication, and name for figures and
        reports.
    odd : bool
        Whether the value changes its sign in the mirror image of a roller, as lateral positions and
        forces do.
    shown : bool
        Whether the sheet, the table of cases and the explorer show the value; the dimensions are
        none or `contact`.
    joined : str
        How one number follows from both contacts: `max`, `min`, `sum`, or not at all (an empty
        text).
    scale : str
        Scale on which an analysis compares the values, `natural` or `log10`.
    life : bool
        Whether the value is a life: longer is better, 0 and infinity are values, and hours become
        years of a duty.
    of : str
        `roller`, `guide` or `pair`, if the value is that of one of them and has no dimension
        `body`.
    end : str
        `low` or `high`, if the value is that end of the range of another result.
    estimate : bool
        Whether the value is an estimated error of another result.
    label : str
        Words of a report, if they are not the long name.
    """

    name: str
    group: str
    dims: tuple[str, ...]
    units: str
    symbol: str
    long_name: str
    odd: bool = False
    shown: bool = False
    joined: str = ""
    scale: str = "natural"
    life: bool = False
    of: str = ""
    end: str = ""
    estimate: bool = False
    label: str = ""
