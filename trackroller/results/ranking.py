"""Rank the factors of an output by an index of the analysis.

Words, tables and figures take the share of a factor from here and nowhere else.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from trackroller.methods import METHODS, Method
from trackroller.methods.method import Index, index_of

ENDS = ("low", "high")


class Rank(NamedTuple):
    """The index of a factor with its interval, NaN without an interval."""

    factor: str
    name: str
    value: float
    low: float
    high: float


def estimate(part: xr.Dataset, name: str) -> np.ndarray:
    """Return a value of an analysis and the bounds of its interval, shape (3, ...), NaN for bounds
    that are missing.
    """
    value = part[name].values.astype(float)
    bounds = (
        part[f"{name}_{end}"].values if f"{name}_{end}" in part else np.full_like(value, np.nan)
        for end in ENDS
    )
    return np.stack([value, *bounds])


def method_of(sens: xr.Dataset) -> Method | None:
    """Return the design of experiments behind an analysis; None if the analysis does not name
    one.
    """
    return METHODS.get(str(sens.attrs.get("method")))


def index_words(sens: xr.Dataset, name: str) -> Index:
    """Return what the method of an analysis declares of an index."""
    return index_of(method_of(sens), name)


def robust_design(sens: xr.Dataset) -> bool:
    """Return whether the analysis is that of an inner/outer design."""
    method = method_of(sens)
    return method is not None and method.points


def headline(sens: xr.Dataset) -> str:
    """Name the index that ranks the factors of a design: ST, mu_star, main_share, effect or
    first.
    """
    method = method_of(sens)
    index = "first"
    if method is not None:
        index = method.headline
    if "first" in sens and (index not in sens or not np.isfinite(sens[index]).any()):
        return "first"
    return index


def order(sens: xr.Dataset, output: str, index: str = "") -> list[Rank]:
    """Sort the factors of an output by falling size of an index, by default the headline; leave out
    NaN.
    """
    index = index or headline(sens)
    part = sens.sel(output=output)
    if "factor_name" in part.coords:
        names = part["factor_name"].values
    else:
        names = part["factor"].values
    rows = zip(
        map(str, part["factor"].values),
        map(str, names),
        *estimate(part, index).tolist(),
        strict=True,
    )
    ranks = [rank for rank in map(Rank._make, rows) if np.isfinite(rank.value)]
    if index_words(sens, index).signed:
        return sorted(ranks, key=lambda rank: -abs(rank.value))
    return sorted(ranks, key=lambda rank: -rank.value)


def used_share(sens: xr.Dataset, output: str) -> float:
    """Return the share of the design that the indices of an output use [1]."""
    if "used_share" in sens:
        return float(sens["used_share"].sel(output=output))
    return 1.0


def ranked_factors(sens: xr.Dataset | None, output: str, among: Sequence[str]) -> dict[str, float]:
    """Return the size of the headline index of some factors, the largest first.

    Parameters
    ----------
    sens : analysis of the study, None without one
    output : name of an output, such as `peak_stress_roller`
    among : names of the factors, in the order of the study file

    Returns
    -------
    Factor and size [share of variance, or unit of the output]. Without an index of the output: 0
    for every factor, in the order of the study file, because no factor is known to decide.
    """
    size = dict.fromkeys(among, 0.0)
    if sens is not None and not robust_design(sens) and output in sens["output"].values:
        size |= {
            rank.factor: abs(rank.value) for rank in order(sens, output) if rank.factor in size
        }
    return dict(sorted(size.items(), key=lambda item: -item[1]))
