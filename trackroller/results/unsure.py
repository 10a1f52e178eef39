"""Tell which conclusions do not rest on values that are known within a range only."""

from __future__ import annotations

import numpy as np

from trackroller.results.candidates import Candidates
from trackroller.results.columns import codes
from trackroller.results.first_limits import reached_hours

COEFFICIENT, POSITION = "wear_coefficient_factor", "placeholder_position"
UNSURE = (COEFFICIENT, POSITION)


def varied(candidates: Candidates) -> list[str]:
    """Return the conditions of a study that stand for values that are known within a range only."""
    return [name for name in UNSURE if name in candidates.conditions]


def settled(candidates: Candidates) -> tuple[int, int] | None:
    """Count the conditions of designs whose first limit is the same for all values within their ranges.

    Parameters
    ----------
    candidates : Candidates
        The designs of a study with a condition of `UNSURE`.

    Returns
    -------
    tuple of int or None
        Number of settled conditions, and of all conditions in which a limit is reached and all places of the values
        are valid cases; None if the study varies no such condition.

    Notes
    -----
    Values of different limits differ independently: a limit comes first for certain if its longest life is not longer
    than the shortest lives of all other limits.
    """
    results = candidates.results
    if not varied(candidates) or not results.limits:
        return None
    place = codes(results.table, (name for name in results.factors if name not in UNSURE))
    reached = reached_hours(results)
    whole = np.prod([len(results.levels(name)) for name in varied(candidates)])  # places within the ranges
    groups, first = [place[results.valid] == g for g in np.unique(place[results.valid])], reached[results.valid]
    groups = [rows for rows in groups if rows.sum() == whole]
    certain = ends = 0
    for rows in groups:
        least, most = first[rows].min(axis=0), first[rows].max(axis=0)
        if np.isfinite(least).any():
            ends += 1
            rule = int(np.argmin(most))
            certain += bool(np.isfinite(most[rule]) and (most[rule] <= np.delete(least, rule)).all())
    return certain, ends
