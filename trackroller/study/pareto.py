"""The designs that no other beats: Pareto set of a study under constraints."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError
from trackroller.study.factors import label
from trackroller.study.outputs import outputs, regimes
from trackroller.study.restore import design_of

_LIMIT = re.compile(r"\s*([\w\[\],]+)\s*(<=|>=|<|>)\s*([-+.\deE]+)\s*")
_TESTS = {"<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal}


def pareto_mask(objectives: np.ndarray, directions: Iterable[str], allowed: np.ndarray | None = None) -> np.ndarray:
    """Rows that no allowed row beats in every objective.

    Parameters
    ----------
    objectives : shape (n, m); a row with a NaN is no candidate
    directions : `min` or `max` for each objective, m of them
    allowed : rows within the constraints, shape (n,)

    Returns
    -------
    Mask, shape (n,). Equal rows all stay. Cost: n times the size of the set.
    """
    signs = []
    for direction in directions:
        if direction not in ("min", "max"):
            raise InputError("objectives", direction, "min or max")
        signs.append(1.0 if direction == "min" else -1.0)
    costs = np.asarray(objectives, dtype=float) * np.array(signs)
    candidate = ~np.isnan(costs).any(axis=1)
    if allowed is not None:
        candidate &= allowed
    rows = np.flatnonzero(candidate)
    # in lexicographic order a row can be beaten by earlier ones only
    rows = rows[np.lexsort(costs[rows].T[::-1])]
    front: list[int] = []
    held = np.empty((0, costs.shape[1]))
    for row in rows:
        worse = (held <= costs[row]).all(axis=1) & (held < costs[row]).any(axis=1)
        if not worse.any():
            front.append(int(row))
            held = costs[front]
    mask = np.zeros(len(costs), dtype=bool)
    mask[front] = True
    return mask


def pareto(ds: xr.Dataset, objectives: Mapping[str, str], constraints: Iterable[str] = (),
           keep: Iterable[str] = ("rolling",)) -> xr.Dataset:  # fmt: skip
    """Pareto set of a solved study.

    Parameters
    ----------
    ds : gathered study with its study file as attribute
    objectives : output or numeric factor -> `min` or `max`, e.g. {"roller_life_hours": "max", "friction_power": "min"}
    constraints : texts such as "max_pressure < 1200"; outputs or numeric factors
    keep : regimes that are allowed (default: no full slip, no lift-off)

    Returns
    -------
    Dataset over `row` (all rows that are allowed, by regime and constraints): the factors, the objectives, the
    constrained outputs, and `optimal` (1 in the set). Attributes count what each constraint excluded.

    Raises
    ------
    InputError : unknown names, a constraint that cannot be read, fewer than two objectives
    """
    if len(objectives) < 2:
        raise InputError("objectives", dict(objectives), "at least two outputs, each with min or max")
    design = design_of(ds)
    limits = [_limit(text) for text in constraints]
    columns: dict[str, tuple[np.ndarray, str, str]] = {}
    for name in [*objectives, *(n for n, *_ in limits)]:
        if name in design.columns and design.columns[name].dtype != object:
            columns[name] = (design.columns[name], "", name.replace("_", " "))
        elif name not in columns:
            found = outputs(ds, design.factors, [name], keep, natural=[name], unlimited=True)[0]
            columns[name] = (found.values, found.units, found.long_name)
    allowed = ~np.isnan(np.stack([columns[n][0] for n in objectives])).any(axis=0)
    excluded = {"regime or undefined": int((~allowed).sum())}
    for name, test, bound in limits:
        good = _TESTS[test](columns[name][0], bound)
        excluded[f"{name} {test} {bound:g}"] = int((allowed & ~good).sum())
        allowed &= good
    table = np.stack([columns[n][0] for n in objectives], axis=1)
    optimal = pareto_mask(table, objectives.values(), allowed)
    data: dict[str, Any] = {name: ("row", values[0][allowed], {"units": values[1], "long_name": values[2]})
                            for name, values in columns.items()}  # fmt: skip
    for name, value in design.columns.items():
        if name not in data:
            text = np.array([label(v) for v in value], dtype=object) if value.dtype == object else value
            data[name] = ("row", text[allowed])
    data["optimal"] = ("row", optimal[allowed].astype(np.int8), {"long_name": "in the Pareto set"})
    dims = tuple(d for d in ds.dims if d == "case" or d in design.factors)
    out = xr.Dataset(data, coords={"row": np.flatnonzero(allowed)})
    out.attrs = {
        "objectives": ", ".join(f"{n} {d}" for n, d in objectives.items()),
        "factors": ", ".join(design.factors), "rows": design.size,
        "excluded": "; ".join(f"{n} by {why}" for why, n in excluded.items() if n) or "nothing",
        "not_rolling": int((regimes(ds, dims) != 0).sum()), "study": ds.attrs.get("study", ""),
    }  # fmt: skip
    return out


def _limit(text: str) -> tuple[str, str, float]:
    match = _LIMIT.fullmatch(text) if isinstance(text, str) else None
    try:
        if match:
            return match[1], match[2], float(match[3])
    except ValueError:
        pass
    raise InputError("constraints", text, "a name, one of < <= > >=, and a number, such as 'max_pressure < 1200'")
