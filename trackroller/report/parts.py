"""Sentences and tables on groups of factors and on the levels of a category, where the study file asks for them."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.analysis.labels import factor_name
from trackroller.report.claims import Sentence
from trackroller.report.numbers import capital, count, listing, percent, plus_minus
from trackroller.report.sentences import INDEX_WORDS, of_output
from trackroller.report.tables import Table

HALF = "± is half the 95 % interval"


def sentences(sens: xr.Dataset, output: str) -> list[Sentence]:
    """Return the sentences on the groups and on the levels for one output, as far as the analysis has them."""
    found = (groups(sens, output), levels(sens, output))
    return [said for said in found if said is not None]


def groups(sens: xr.Dataset, output: str) -> Sentence | None:
    """State the total index of each group of factors, the largest first."""
    if "group_ST" not in sens:
        return None
    part = sens.sel(output=output)
    value, low, high = (_bound(part, f"group_ST{end}") for end in ("", "_low", "_high"))
    if not np.isfinite(value).all():
        return None
    order = np.argsort(-value, kind="stable")
    names = part["group_name"].values
    told = [f"{names[i]} {percent(value[i], low[i], high[i])}" for i in order]
    what = f"of the variance of {of_output(sens, output)} ({INDEX_WORDS['ST']})"
    text = f"By groups, {names[order[0]]} accounts for {percent(value[order[0]], low[order[0]], high[order[0]])} {what}"
    text += f", {listing(told[1:])}." if told[1:] else "."
    ranks = [(str(part["group"].values[i]), float(value[i]), float(low[i]), float(high[i])) for i in order]
    return Sentence("groups", text, {"output": output, "ranks": ranks})


def levels(sens: xr.Dataset, output: str) -> Sentence | None:
    """Name the factor with the largest first-order index within each level of a category."""
    if "conditional_S1" not in sens:
        return None
    part, told, lead = sens.sel(output=output), [], {}
    for level in part["level"].values:
        value, low, high = (_bound(part.sel(level=level), f"conditional_S1{end}") for end in ("", "_low", "_high"))
        if not np.isfinite(value).any():
            continue
        best = int(np.nanargmax(value))
        lead[str(level)] = str(part["factor"].values[best])
        told.append(f"{part['factor_name'].values[best]} {percent(value[best], low[best], high[best])} with {level}")
    if not told:
        return None
    what = f"{INDEX_WORDS['S1']} of the variance of {of_output(sens, output)}"
    text = f"By {category(sens)}, the largest {what} is: {'; '.join(told)}."
    return Sentence("levels", text, {"output": output, "lead": lead})


def category(sens: xr.Dataset) -> str:
    """Name the factor whose levels the conditional indices stand for."""
    return factor_name(str(sens["level"].attrs["factor"]))


def tables(sens: xr.Dataset) -> list[Table]:
    """List the indices of groups and those within the levels of a category, for every output."""
    found = []
    if "group_ST" in sens:
        rows = []
        for output in _with_index(sens, "group_ST"):
            part = sens.sel(output=output)
            for group in part["group"].values:
                one = part.sel(group=group)
                cells = [_value(one, name) for name in ("group_S1", "group_ST")]
                told = [capital(str(one["group_name"].item())), str(one["group_members"].item())]
                rows.append([capital(of_output(sens, output)), *told, *cells])
        heads = ["Output", "Group", "Factors", "First-order index", "Total index"]
        note = f"{HALF}. The first-order index of a group holds the interactions inside the group."
        found.append(Table("groups", "What groups of factors decide", heads, rows, note))
    if "conditional_S1" in sens:
        found.append(_level_table(sens))
    return found


def _level_table(sens: xr.Dataset) -> Table:
    """List the factors by their index within each level, the largest first."""
    name = "conditional_ST" if "conditional_ST" in sens else "conditional_S1"
    rows = []
    for output in _with_index(sens, name):
        for level in sens["level"].values:
            part = sens.sel(output=output, level=level)
            value = part[name].values
            order = [i for i in np.argsort(-np.nan_to_num(value, nan=-1.0), kind="stable") if np.isfinite(value[i])]
            told = [f"{part['factor_name'].values[i]} {_value(part.isel(factor=int(i)), name)}" for i in order[:4]]
            size = count(int(part["conditional_rows"]))
            rows.append([capital(of_output(sens, output)), str(level), "; ".join(told) or "–", size])
    index = INDEX_WORDS["ST" if name.endswith("ST") else "S1"]
    unit = {"saltelli": "Blocks", "grid": "Cells"}.get(str(sens.attrs.get("method")), "Rows")
    heads = ["Output", capital(category(sens)), f"Factors that matter most ({index})", unit]
    note = f"{HALF}. The variance is that among the cases of one level."
    return Table("levels", f"What decides within each {category(sens)}", heads, rows, note)


def _with_index(sens: xr.Dataset, name: str) -> list[str]:
    return [str(o) for o in sens["output"].values if np.isfinite(sens[name].sel(output=o)).any()]


def _bound(part: xr.Dataset, name: str) -> np.ndarray:
    """Return an index or a bound of it; NaN where the analysis has none."""
    base = part[name.removesuffix("_low").removesuffix("_high")].values
    return np.asarray(part[name].values if name in part else np.full_like(base, np.nan))


def _value(one: xr.Dataset, name: str) -> str:
    """Write one index with half its interval, not below 0."""
    value, low, high = (float(_bound(one, f"{name}{end}")) for end in ("", "_low", "_high"))
    return plus_minus(max(0.0, value) if np.isfinite(value) else value, low, high)
