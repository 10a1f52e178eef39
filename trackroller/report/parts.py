"""Sentences and tables on groups of factors and on the levels of a category, where the study file asks for them."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.analysis.labels import factor_name
from trackroller.report.claims import Sentence, estimate
from trackroller.report.numbers import capital, count, level_text, listing, percent
from trackroller.report.sentences import HALF, INDEX_WORDS, index_text, of_output
from trackroller.report.tables import Table


def sentences(sens: xr.Dataset, output: str) -> list[Sentence]:
    """Return the sentences on the groups and on the levels for one output, as far as the analysis has them."""
    found = (groups(sens, output), levels(sens, output))
    return [said for said in found if said is not None]


def groups(sens: xr.Dataset, output: str) -> Sentence | None:
    """State the total index of each group of factors, the largest first."""
    if "group_ST" not in sens:
        return None
    part = sens.sel(output=output)
    value, low, high = estimate(part, "group_ST")
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
        value, low, high = estimate(part.sel(level=level), "conditional_S1")
        if not np.isfinite(value).any():
            continue
        best = int(np.nanargmax(value))
        lead[str(level)] = str(part["factor"].values[best])
        words = level_text(str(sens["level"].attrs["factor"]), level)
        told.append(f"{part['factor_name'].values[best]} {percent(value[best], low[best], high[best])} with {words}")
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
                cells = [index_text(one, name) for name in ("group_S1", "group_ST")]
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
            told = [f"{part['factor_name'].values[i]} {index_text(part.isel(factor=int(i)), name)}" for i in order[:4]]
            size = count(int(part["conditional_rows"]))
            words = level_text(str(sens["level"].attrs["factor"]), level)
            rows.append([capital(of_output(sens, output)), words, "; ".join(told) or "–", size])
    index = INDEX_WORDS["ST" if name.endswith("ST") else "S1"]
    unit = {"saltelli": "Blocks", "grid": "Cells"}.get(str(sens.attrs.get("method")), "Rows")
    heads = ["Output", capital(category(sens)), f"Factors that matter most ({index})", unit]
    note = f"{HALF}. The variance is that among the cases of one level."
    return Table("levels", f"What decides within each {category(sens)}", heads, rows, note)


def _with_index(sens: xr.Dataset, name: str) -> list[str]:
    return [str(o) for o in sens["output"].values if np.isfinite(sens[name].sel(output=o)).any()]
