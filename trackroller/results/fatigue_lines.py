"""Tests that lives by fatigue follow from: bending or rolling contact, by limit and material."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from trackroller.damage import LIMITS

OF_ROLLING = "S-N line of rolling tests"
ALONE = "alone"  # behind the line of a life that other tests do not bound


def line_of(limit: str, material: Mapping[str, Any]) -> str:
    """Return the words for the tests that a life by a limit follows from; '' for a limit that is
    not of fatigue.

    Parameters
    ----------
    limit : name of the limit; another name has no line
    material : values of the material of the body by name

    Examples
    --------
    >>> line_of("fatigue", {}), line_of("pressure_line", {}), line_of("wear", {})
    ('bending line', 'rolling-contact line', '')
    """
    if limit not in LIMITS:
        return ""
    if limit == "fatigue" and material.get("sn_in_rolling") == 1:
        return OF_ROLLING
    return LIMITS[limit].line


def lines_text(low: str, high: str, alone: bool) -> str:
    """Return the lines of both ends of a life, as the column of a table says them.

    Parameters
    ----------
    low, high : lines at the low and at the high end
    alone : whether no other tests of the material bound the life

    Examples
    --------
    >>> lines_text("bending line", "bending line", True)
    'bending line alone'
    >>> lines_text("bending line", "rolling-contact line", False)
    'bending line to rolling-contact line'
    """
    if low != high:
        return " to ".join(filter(None, (low, high)))
    if low and alone:
        return f"{low} {ALONE}"
    return low
