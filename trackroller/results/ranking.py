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
from trackroller.roller.output_names import is_life, pair_first

ENDS = ("low", "high")
USABLE = 0.5  # share of the design below which an index decides nothing


class Rank(NamedTuple):
    """The index of a factor with its interval, NaN without an interval."""

    factor: str
    name: str
    value: float
    low: float
    high: float


def estimate(part: xr.Dataset, name: str) -> np.ndarray:
    """Return a value of an analysis and the bounds of its interval, shape (3, ...), NaN for bounds that are missing."""
    value = part[name].values.astype(float)
    bounds = (part[f"{name}_{end}"].values if f"{name}_{end}" in part else np.full_like(value, np.nan) for end in ENDS)
    return np.stack([value, *bounds])


def method_of(sens: xr.Dataset) -> Method | None:
    """Return the design of experiments behind an analysis; None if the analysis does not name one."""
    return METHODS.get(str(sens.attrs.get("method")))


def index_words(sens: xr.Dataset, name: str) -> Index:
    """Return what the method of an analysis declares of an index."""
    return index_of(method_of(sens), name)


def robust_design(sens: xr.Dataset) -> bool:
    """Return whether the analysis is that of an inner/outer design."""
    method = method_of(sens)
    return method is not None and method.points


def main_lives(sens: xr.Dataset) -> list[str]:
    """Name the lives of design points that a report shows: those that the study asks for, otherwise the deciding one.

    The life of the pair decides, or that of the roller where the guide's hours are unknown.
    """
    lives = [str(n) for n in sens["output"].values if is_life(str(n))]
    lives = [n for n in lives if np.isfinite(sens["percentile_value"].sel(output=n)).any()]
    return lives if sens.attrs.get("outputs_named") else pair_first(lives)[:1]


def best_points(part: xr.Dataset) -> np.ndarray:
    """Return the numbers of the design points, the best B10 first; the one with other cases as life 0 decides.

    Parameters
    ----------
    part : analysis of an inner/outer design for one life
    """
    safe, b10s = (np.nan_to_num(part[name].values, nan=-1.0) for name in ("b10_safe", "b10"))
    return np.lexsort((-b10s, -safe))


def headline(sens: xr.Dataset) -> str:
    """Name the index that ranks the factors of a design: ST, mu_star, main_share, effect or first."""
    method = method_of(sens)
    index = method.headline if method is not None else "first"
    if "first" in sens and (index not in sens or not np.isfinite(sens[index]).any()):
        return "first"
    return index


def order(sens: xr.Dataset, output: str, index: str = "") -> list[Rank]:
    """Sort the factors of an output by falling size of an index, by default the headline; leave out NaN."""
    index = index or headline(sens)
    part = sens.sel(output=output)
    names = part["factor_name"].values if "factor_name" in part.coords else part["factor"].values
    rows = zip(map(str, part["factor"].values), map(str, names), *estimate(part, index).tolist(), strict=True)
    signed = index_words(sens, index).signed
    ranks = [rank for rank in map(Rank._make, rows) if np.isfinite(rank.value)]
    return sorted(ranks, key=lambda r: -abs(r.value) if signed else -r.value)


def used_share(sens: xr.Dataset, output: str) -> float:
    """Return the share of the design that the indices of an output use [1]."""
    return float(sens["used_share"].sel(output=output)) if "used_share" in sens else 1.0


def decisive(sens: xr.Dataset, output: str) -> bool:
    """Return whether an output has an index that uses at least half of the design."""
    return bool(order(sens, output)) and used_share(sens, output) >= USABLE


def ranked_factors(sens: xr.Dataset | None, output: str, among: Sequence[str]) -> dict[str, float]:
    """Return the size of the headline index of some factors, the largest first.

    Parameters
    ----------
    sens : analysis of the study, None without one
    output : name of an output, such as `peak_stress_roller`
    among : names of the factors, in the order of the study file

    Returns
    -------
    Factor and size [share of variance, or unit of the output]. Without an index of the output: 0 for every factor, in
    the order of the study file, because no factor is known to decide.
    """
    size = dict.fromkeys(among, 0.0)
    if sens is not None and not robust_design(sens) and output in sens["output"].values:
        size |= {rank.factor: abs(rank.value) for rank in order(sens, output) if rank.factor in size}
    return dict(sorted(size.items(), key=lambda item: -item[1]))
