"""Compare designs whose values are known within a range only, and tell which conclusions do not rest on them."""

from __future__ import annotations

import numpy as np

from trackroller.parameters import MATERIAL_FIELDS
from trackroller.results.candidates import Candidates
from trackroller.results.columns import codes
from trackroller.results.first_limits import reached_hours

COEFFICIENT, POSITION = "wear_coefficient_factor", "placeholder_position"
UNSURE = (COEFFICIENT, POSITION)
OF_MATERIALS = ("material_pair", *MATERIAL_FIELDS)


def varied(candidates: Candidates) -> list[str]:
    """Return the conditions of a study that stand for values that are known within a range only."""
    return [name for name in UNSURE if name in candidates.conditions]


def unbeaten(candidates: Candidates) -> np.ndarray | None:
    """Return the designs that are the best for some values within their ranges.

    Parameters
    ----------
    candidates : Candidates
        The designs of a study with a condition of `UNSURE`.

    Returns
    -------
    numpy.ndarray or None
        Numbers of the designs, as in the index of `Candidates.table`. None if the study varies no such condition, or
        cannot compare its designs.

    Notes
    -----
    At each level of these conditions a design counts with its worst life over the other conditions; a case that is not
    valid counts as 0. Designs of the same materials share their values, so they are compared level by level. The values
    of other materials differ independently: a design is beaten if its longest life is shorter than the
    shortest life of another design.
    """
    results = candidates.results
    names = varied(candidates)
    if not names or not candidates.rising or not candidates.matched:
        return None
    lives = np.where(candidates.usable, results.column(candidates.goal[0]), 0.0)
    levels, level = np.unique(results.table[names].to_numpy(float), axis=0, return_inverse=True)
    worst = np.full((len(candidates.size), len(levels)), np.inf)
    own = candidates.place >= 0
    np.minimum.at(worst, (candidates.place[own], level[own]), lives[own])
    named = [name for name in OF_MATERIALS if name in candidates.choices]
    pairs = candidates.table.sort_index()[named].astype(str).agg(" / ".join, axis=1).to_numpy() if named else None
    alike = np.ones((len(worst), len(worst)), bool) if pairs is None else pairs[:, None] == pairs[None, :]
    least, most = worst.min(axis=1), worst.max(axis=1)
    level_by_level = (worst[None] >= worst[:, None]).all(axis=2) & (worst[None] > worst[:, None]).any(axis=2)
    beaten = np.where(alike, level_by_level, least[None, :] > most[:, None])
    return np.flatnonzero(~beaten.any(axis=1) & (most > 0.0))


def settled(candidates: Candidates) -> tuple[int, int] | None:
    """Count the conditions of designs whose first limit is the same for all values within their ranges.

    Parameters
    ----------
    candidates : Candidates
        The designs of a study with a condition of `UNSURE`.

    Returns
    -------
    tuple of int or None
        Number of settled conditions, and of all conditions in which a limit is reached; None if the study varies no
        such condition.

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
    groups, first = [place[results.valid] == g for g in np.unique(place[results.valid])], reached[results.valid]
    certain = ends = 0
    for rows in groups:
        least, most = first[rows].min(axis=0), first[rows].max(axis=0)
        if np.isfinite(least).any():
            ends += 1
            rule = int(np.argmin(most))
            certain += bool(np.isfinite(most[rule]) and (most[rule] <= np.delete(least, rule)).all())
    return certain, ends
