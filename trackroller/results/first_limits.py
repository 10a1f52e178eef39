"""Which limit ends the pair first, and which factors decide it."""

from __future__ import annotations

import numpy as np
import pandas as pd

from trackroller.damage import LIMITS
from trackroller.damage.first_limit import breaking
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


def reached_by_body(results: SolvedCases, end: str = "") -> np.ndarray:
    """Return the hours until each limit of each body is reached, shape (n, limit, 2) [h]; infinity
    if never known.

    Parameters
    ----------
    results : the solved study
    end : `_low` or `_high` for the ends of the ranges of the placeholders
    """
    hours = flat(results.data, "life_hours_by_limit", results.dims)
    if end and f"life_hours_by_limit{end}" in results.data:
        ranged = flat(results.data, f"life_hours_by_limit{end}", results.dims)
        hours = np.where(np.isnan(ranged), hours, ranged)
    limits = [LIMITS[name] for name in results.data["limit"].values.tolist()]
    breaks = np.stack([results.flagged("static", body) for body in BODIES], axis=1)
    counted = np.array([not limit.beside for limit in limits])[:, None]
    reached = np.where(breaking(breaks, limits), 0.0, np.where(counted, hours, np.nan))
    return np.asarray(np.nan_to_num(reached, nan=np.inf, posinf=np.inf))


def first_at(
    results: SolvedCases, end: str, reached: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return which limit ends each case at an end of the ranges, and whether it ends the guide,
    shape (n,) each.

    A limit has the name '' where none is reached. `reached` holds other hours than those of
    `reached_by_body`.
    """
    if reached is None:
        reached = reached_by_body(results, end)
    flattened = reached.reshape(len(reached), -1)
    place = flattened.argmin(axis=1)
    names = np.array(results.data["limit"].values.tolist(), dtype=object)[place // reached.shape[2]]
    known = np.isfinite(flattened[np.arange(len(place)), place])
    return np.where(known, names, ""), np.asarray(
        known & (place % reached.shape[2] == BODIES.index("guide"))
    )


# values that are known within a range only
COEFFICIENT = "wear_coefficient_factor"
POSITION = "placeholder_position"
UNSURE = (COEFFICIENT, POSITION)
