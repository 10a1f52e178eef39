"""Sobol indices of groups of factors, and of each factor within the levels of a category."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from trackroller.analysis.givendata import firsts
from trackroller.analysis.indices import Estimates, complete_part, variance_share
from trackroller.analysis.labels import factor_name, stacked
from trackroller.analysis.sobol import closed_indices, with_bounds
from trackroller.errors import InputError
from trackroller.study.design.factors import label
from trackroller.study.design.saltelli import all_groups
from trackroller.study.design.sampling import SampledDesign
from trackroller.study.file.goals import Analysis
from trackroller.study.outputs import Output

ENDS = ("", "_low", "_high")


def parts_of(design: SampledDesign, columns: Sequence[Output], asked: Analysis) -> xr.Dataset:
    """Compute the indices of groups and within the levels of a category that a study file asks for.

    Parameters
    ----------
    design : the design
    columns : the outputs
    asked : the key `analysis` of the study file, with `groups` and `conditional_on`

    Returns
    -------
    group_S1, group_ST (output, group) and conditional_S1, conditional_ST (output, level, factor), each with _low and
    _high, and conditional_rows (output, level). Empty if the study file asks for neither. A grid has no interval, a
    random sample or a table no conditional_ST.
    """
    variables: dict[str, Any] = {}
    coords: dict[str, Any] = {}
    if asked.groups:
        groups = all_groups(asked.groups, design.factors)
        coords["group"] = np.array(list(groups), dtype=object)
        words = [factor_name(name) if name in design.factors else name.replace("_", " ") for name in groups]
        coords["group_name"] = ("group", np.array(words, dtype=object))
        members = [", ".join(map(factor_name, names)) for names in groups.values()]
        coords["group_members"] = ("group", np.array(members, dtype=object))
        estimates = [of_groups(column.values, design, groups) for column in columns]
        variables |= stacked(estimates, ("output", "group"))
    if category := asked.conditional_on:
        levels = design.factors[category].levels
        coords["level"] = ("level", np.array([label(level) for level in levels], dtype=object), {"factor": category})
        coords["factor"] = np.array(list(design.factors), dtype=object)
        estimates = [within_levels(column.values, design, category) for column in columns]
        variables |= stacked(estimates, ("output", "level", "factor"))
    return xr.Dataset(variables, coords | {"output": np.array([c.name for c in columns], dtype=object)})


def of_groups(y: np.ndarray, design: SampledDesign, groups: Mapping[str, Sequence[str]]) -> Estimates:
    """Estimate the first-order and the total index of groups of factors.

    Parameters
    ----------
    y : output, shape (n,), NaN where unusable
    design : a grid or a Saltelli design
    groups : name -> factors; together they hold each factor once

    Returns
    -------
    group_S1, the share of variance Var(E[y | group]) / V, and group_ST, one minus that of all other factors, shape
    (groups,). From a Saltelli design each with _low and _high.

    Notes
    -----
    Valid for independent factors. A grid is exact. The columns of a Saltelli design are exchanged by group.
    """
    if design.method == "grid":
        names = list(design.factors)
        places = [tuple(names.index(name) for name in members) for members in groups.values()]
        first, total, _ = _grid_indices(y.reshape(design.meta["shape"]), places)
        return {"group_S1": first, "group_ST": total}
    second, exchanged = bool(design.meta["second_order"]), design.meta.get("groups")
    if exchanged is None:  # of an earlier version
        raise InputError("analysis.groups", list(groups), "a design drawn by group", "Run the study again.")
    columns, sets = len(exchanged), [1 << exchanged.index(name) for name in groups]
    block = design.blocks(y)
    block = block[np.isfinite(block).all(axis=1)]
    whole = (1 << columns) - 1
    drawn = closed_indices(block, columns, second, [*sets, *(whole ^ one for one in sets)])
    return with_bounds("group_S1", drawn[:, : len(sets)]) | with_bounds("group_ST", 1 - drawn[:, len(sets) :])


def _grid_indices(table: np.ndarray, groups: Sequence[tuple[int, ...]]) -> tuple[np.ndarray, np.ndarray, int]:
    """Return first-order and total indices of groups of a grid's axes, and the number of cells behind them."""
    part = table[np.ix_(*complete_part(table))]
    rest = [tuple(j for j in range(table.ndim) if j not in group) for group in groups]
    first, others = (np.array([variance_share(part, axes) for axes in which]) for which in (groups, rest))
    return first, 1 - others, part.size


def within_levels(y: np.ndarray, design: SampledDesign, category: str) -> Estimates:
    """Estimate the indices of all other factors within each level of a category.

    Parameters
    ----------
    y : output, shape (n,), NaN where unusable
    design : a grid, a Saltelli design, a random sample or a table
    category : a factor with a list of values

    Returns
    -------
    conditional_S1 with _low and _high, shape (levels, k), NaN for the category itself; conditional_ST too from a grid
    and a Saltelli design; conditional_rows, the blocks, cells or rows of each level, shape (levels,).

    Notes
    -----
    The variance is that among the rows of the level. Valid for independent factors, as the index over all rows.
    """
    place, levels = list(design.factors).index(category), design.factors[category].levels
    code = {level: i for i, level in enumerate(levels)}
    level_of = np.array([code[value] for value in design.columns[category].tolist()])
    one = {"grid": _grid_level, "saltelli": _saltelli_level}.get(design.method, _sample_level)
    by_level = [one(y, design, place, level_of == i) for i in range(len(levels))]
    return {name: np.stack([part[name] for part in by_level]) for name in by_level[0]}


def _spread(values: np.ndarray, place: int) -> np.ndarray:
    """Return values of all other factors with NaN for the category, shape (k,)."""
    return np.insert(np.asarray(values, dtype=float), place, np.nan)


def _grid_level(y: np.ndarray, design: SampledDesign, place: int, inside: np.ndarray) -> Estimates:
    shape = tuple(size for j, size in enumerate(design.meta["shape"]) if j != place)
    table = y[inside].reshape(shape)  # the other factors keep their order
    first, total, cells = _grid_indices(table, [(j,) for j in range(len(shape))])
    none = np.full(len(shape) + 1, np.nan)
    out: Estimates = {"conditional_rows": np.array(cells)}
    for name, values in (("conditional_S1", first), ("conditional_ST", total)):
        out |= {name: _spread(values, place), f"{name}_low": none, f"{name}_high": none}
    return out


def _saltelli_level(y: np.ndarray, design: SampledDesign, place: int, inside: np.ndarray) -> Estimates:
    """Estimate from the blocks whose rows all lie at one level.

    Where A lies at the level, A, the rows AB_j of all other factors and BA of the category (B with the category of A)
    form such a block. Where B lies there, B, BA_j and AB of the category do. Without BA, A and B must both lie there.
    """
    count = len(design.factors)
    second = bool(design.meta["second_order"])
    block, inside = design.blocks(y), design.blocks(inside)
    others = np.delete(np.arange(count), place)
    if second:
        of_a, of_b = np.flatnonzero(inside[:, 0]), np.flatnonzero(inside[:, -1])
        rows = [
            block[of_a][:, np.r_[0, 1 + others, 1 + count + place]],
            block[of_b][:, np.r_[-1, 1 + count + others, 1 + place]],
        ]
        cluster = np.concatenate([of_a, of_b])
    else:
        cluster = np.flatnonzero(inside[:, 0] & inside[:, -1])
        rows = [block[cluster][:, np.r_[0, 1 + others, -1]]]
    part = np.concatenate(rows)
    good = np.isfinite(part).all(axis=1)
    part, cluster = part[good], cluster[good]
    whole, single = (1 << (count - 1)) - 1, [1 << j for j in range(count - 1)]
    sets = [*single, *(whole ^ j for j in single)]
    drawn = closed_indices(part, count - 1, False, sets, cluster=cluster)
    first, rest = np.split(drawn, 2, axis=1)
    out: Estimates = {"conditional_rows": np.array(len(part))}
    bounds = with_bounds("conditional_S1", first) | with_bounds("conditional_ST", 1 - rest)
    return out | {name: _spread(values, place) for name, values in bounds.items()}


def _sample_level(y: np.ndarray, design: SampledDesign, place: int, inside: np.ndarray) -> Estimates:
    rows = inside & np.isfinite(y)
    shares = firsts(y[rows], np.delete(design.places[rows], place, axis=1), np.delete(design.ordered, place))
    out: Estimates = {"conditional_rows": np.array(rows.sum())}
    return out | {f"conditional_S1{end}": _spread(shares[f"first{end}"], place) for end in ENDS}
