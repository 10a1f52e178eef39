"""Which limit ends the pair first, and which factors decide it."""

from __future__ import annotations

import numpy as np
import pandas as pd

from trackroller.damage import LIMITS
from trackroller.damage.first_limit import breaking, with_evidence
from trackroller.parameters import BODIES, FIRST_TO_FAIL
from trackroller.results.factor_levels import MOST_LEVELS
from trackroller.results.life_columns import FIRST_LIMIT
from trackroller.results.solved_cases import SolvedCases
from trackroller.study.outputs import flat


def first_limit(results: SolvedCases) -> np.ndarray:
    """Return the name of the limit that ends the pair first in every case, shape (n,); '' where it
    is not known.
    """
    guide = results.first_failing(FIRST_LIMIT[0]) == FIRST_TO_FAIL.index("guide")
    numbers = [
        np.nan_to_num(results.column(f"limiting_mechanism_{body}", np.nan), nan=-1).astype(int)
        for body in BODIES
    ]
    # the last one, -1, is that of a case whose limit is not known
    names = np.array([*results.limits, ""], dtype=object)
    names[~np.isin(names, list(LIMITS))] = ""
    return np.asarray(names[np.where(guide, numbers[1], numbers[0])])


def deciding(results: SolvedCases, names: np.ndarray, most: int = 2) -> list[str]:
    """Return the factors on which the first limit of the valid cases depends most, the strongest
    first.

    Parameters
    ----------
    results : the solved study
    names : first limit of every case, shape (n,)
    most : number of factors at most

    Notes
    -----
    Factors are ranked by the mutual information of their levels and the first limit. Factors
    without mutual information are left out, and so are factors with more than `MOST_LEVELS` levels,
    whose table would be too long, or with fewer than two cases a level, which tell every case
    apart.
    """
    information: dict[str, float] = {}
    longest = min(MOST_LEVELS, int(results.valid.sum()) // 2)
    for factor in (f for f in results.factors if len(results.levels(f)) <= longest):
        counts = pd.crosstab(
            results.table[factor].to_numpy()[results.valid], names[results.valid]
        ).to_numpy(dtype=float)
        share = counts / max(counts.sum(), 1.0)
        expected = share.sum(axis=1, keepdims=True) * share.sum(axis=0, keepdims=True)
        with np.errstate(divide="ignore", invalid="ignore"):
            information[factor] = float(np.nansum(share * np.log(share / expected)))
    return sorted((f for f in information if information[f] > 1e-9), key=lambda f: -information[f])[
        :most
    ]


def hours_by_body(results: SolvedCases, end: str = "") -> np.ndarray:
    """Return the hours by each limit of each body, shape (n, limit, 2) [h]; NaN if they are not
    known.

    Parameters
    ----------
    results : the solved study
    end : `_low` or `_high` for the ends of the ranges of the placeholders
    """
    hours = flat(results.data, "life_hours_by_limit", results.dims)
    if end and f"life_hours_by_limit{end}" in results.data:
        ranged = flat(results.data, f"life_hours_by_limit{end}", results.dims)
        hours = np.where(np.isnan(ranged), hours, ranged)
    return np.asarray(hours, dtype=float)


def reached_by_body(
    results: SolvedCases, end: str = "", hours: np.ndarray | None = None
) -> np.ndarray:
    """Return the hours until each limit of each body is reached, shape (n, limit, 2) [h]; infinity
    if never known.

    The range of an end reaches to the life by other tests of it.

    Parameters
    ----------
    results : the solved study
    end : `_low` or `_high` for the ends of the ranges of the placeholders
    hours : other hours than those of `hours_by_body`
    """
    if hours is None:
        hours = hours_by_body(results, end)
    limits = [LIMITS[name] for name in results.data["limit"].values.tolist()]
    breaks = np.stack([results.flagged("static", body) for body in BODIES], axis=1)
    counted = np.array([not limit.beside for limit in limits])[:, None]
    joined = with_evidence(hours, limits, end)
    reached = np.where(breaking(breaks, limits), 0.0, np.where(counted, joined, np.nan))
    return np.asarray(np.nan_to_num(reached, nan=np.inf, posinf=np.inf))


def first_at(
    results: SolvedCases, end: str, hours: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return which limit ends each case at an end of the ranges, and whether it ends the guide,
    shape (n,) each.

    A limit has the name '' where none is reached, and that of its other tests where these give the
    end. `hours` holds other ones than those of `hours_by_body`.
    """
    if hours is None:
        hours = hours_by_body(results, end)
    reached = reached_by_body(results, end, hours)
    flattened = reached.reshape(len(reached), -1)
    place = flattened.argmin(axis=1)
    rows = np.arange(len(place))
    listed = results.data["limit"].values.tolist()
    names = np.array(listed, dtype=object)[place // reached.shape[2]]
    body = place % reached.shape[2]
    for number, name in enumerate(listed):
        of_line = names == LIMITS[name].evidence_of
        names[of_line & (hours[rows, number, body] == flattened[rows, place])] = name
    known = np.isfinite(flattened[rows, place])
    return np.where(known, names, ""), np.asarray(known & (body == BODIES.index("guide")))


# values that are known within a range only
COEFFICIENT = "wear_coefficient_factor"
POSITION = "placeholder_position"
UNSURE = (COEFFICIENT, POSITION)
