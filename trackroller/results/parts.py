"""Sobol indices of groups of factors, and of each factor within the levels of a category."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from trackroller.methods import Design
from trackroller.methods.factor import label
from trackroller.methods.method import Estimates
from trackroller.methods.saltelli import all_groups
from trackroller.results.labels import factor_name, stacked
from trackroller.study.file.goals import Analysis
from trackroller.study.outputs import Output


def parts_of(design: Design, columns: Sequence[Output], asked: Analysis) -> xr.Dataset:
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
        estimates = [design.method.group_indices(column.values, design, groups) for column in columns]
        variables |= stacked(estimates, ("output", "group"))
    if category := asked.conditional_on:
        levels = design.factors[category].levels
        coords["level"] = ("level", np.array([label(level) for level in levels], dtype=object), {"factor": category})
        coords["factor"] = np.array(list(design.factors), dtype=object)
        estimates = [within_levels(column.values, design, category) for column in columns]
        variables |= stacked(estimates, ("output", "level", "factor"))
    return xr.Dataset(variables, coords | {"output": np.array([c.name for c in columns], dtype=object)})


def within_levels(y: np.ndarray, design: Design, category: str) -> Estimates:
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
    by_level = [design.method.level_indices(y, design, place, level_of == i) for i in range(len(levels))]
    return {name: np.stack([part[name] for part in by_level]) for name in by_level[0]}
