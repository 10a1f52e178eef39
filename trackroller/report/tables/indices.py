"""Tables for a decision: indices of factors and groups, design points, and the Pareto set."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.analysis.labels import INDEX_WORDS
from trackroller.analysis.ranking import headline, order
from trackroller.report.numbers import capital, count, level_text
from trackroller.report.tables.table import Table
from trackroller.report.words.accuracy import FRICTION_OUTPUTS
from trackroller.report.words.indices import HALF, category, index_text, of_output
from trackroller.report.words.sentence import Sentence

# the measures of a factor, in the order of the table of all measures
MEASURES = "S1 ST main_share mu_star sigma effect curvature first fit_alone delta prcc".split()


def index_table(sens: xr.Dataset, error: Sentence | None) -> Table:
    """List for every output the index that ranks the factors, and the rows from which it was computed."""
    index, rows = headline(sens), []
    for output in map(str, sens["output"].values):
        part = sens.sel(output=output)
        ranks = [f"{r.name} {index_text(part.sel(factor=r.factor), index)}" for r in order(sens, output)]
        ranks = [*ranks[:4], *([f"{len(ranks) - 4} more"] if len(ranks) > 4 else [])]
        mark = " *" if error and output in FRICTION_OUTPUTS else ""
        rows.append([capital(of_output(sens, output)) + mark, "; ".join(ranks) or "–", str(part["note"].item())])
    heads = ["Output", f"Factors that matter most ({INDEX_WORDS[index]})", "Computed from"]
    treatment = str(sens.attrs.get("treatment", ""))
    note = f"{HALF}. The method needs {sens.attrs.get('needs', 'nothing')}. {capital(treatment)}."
    if any(row[0].endswith("*") for row in rows) and error:
        note += f" * {error.text}"
    return Table("indices", "What decides each output", heads, rows, note)


def measure_table(sens: xr.Dataset, output: str, error: Sentence | None) -> Table:
    """List every index of every factor on one output; an index that chance alone reaches stands in brackets."""
    part = sens.sel(output=output)
    known = [key for key in MEASURES if key in part and np.isfinite(part[key]).any()]
    rows = []
    for rank in order(sens, output):
        one, cells = part.sel(factor=rank.factor), []
        for key in known:
            noise = float(one.get(f"{key}_noise", np.nan))
            text = index_text(one, key)
            cells.append(f"({text})" if float(one[key]) <= noise else text)
        rows.append([capital(rank.name), *cells])
    title = f"All measures: {of_output(sens, output)}"
    note = f"{HALF}; an index in brackets is no larger than chance alone gives for a factor without influence."
    note += f" {error.text}" if error and output in FRICTION_OUTPUTS else ""
    heads = ["Factor", *(capital(INDEX_WORDS[key]) for key in known)]
    return Table(f"measures_{output}", title, heads, rows, note)


def part_tables(sens: xr.Dataset) -> list[Table]:
    """List the indices of groups and those within the levels of a category, for every output."""
    tables = []
    if "group_ST" in sens:
        rows = []
        for output in _with_index(sens, "group_ST"):
            part = sens.sel(output=output)
            for group in part["group"].values:
                one = part.sel(group=group)
                cells = [index_text(one, name) for name in ("group_S1", "group_ST")]
                names = [capital(str(one["group_name"].item())), str(one["group_members"].item())]
                rows.append([capital(of_output(sens, output)), *names, *cells])
        heads = ["Output", "Group", "Factors", "First-order index", "Total index"]
        note = f"{HALF}. The first-order index of a group holds the interactions inside the group."
        tables.append(Table("groups", "What groups of factors decide", heads, rows, note))
    if "conditional_S1" in sens:
        tables.append(_level_table(sens))
    return tables


def _level_table(sens: xr.Dataset) -> Table:
    """List the factors by their index within each level, the largest first."""
    name = "conditional_ST" if "conditional_ST" in sens else "conditional_S1"
    rows = []
    for output in _with_index(sens, name):
        for level in sens["level"].values:
            part = sens.sel(output=output, level=level)
            value = part[name].values
            order = [i for i in np.argsort(-np.nan_to_num(value, nan=-1.0), kind="stable") if np.isfinite(value[i])]
            names = part["factor_name"].values
            leading = [f"{names[i]} {index_text(part.isel(factor=int(i)), name)}" for i in order[:4]]
            size = count(int(part["conditional_rows"]))
            words = level_text(str(sens["level"].attrs["factor"]), level)
            rows.append([capital(of_output(sens, output)), words, "; ".join(leading) or "–", size])
    index = INDEX_WORDS["ST" if name.endswith("ST") else "S1"]
    unit = {"saltelli": "Blocks", "grid": "Cells"}.get(str(sens.attrs.get("method")), "Rows")
    heads = ["Output", capital(category(sens)), f"Factors that matter most ({index})", unit]
    note = f"{HALF}. The variance is that among the cases of one level."
    return Table("levels", f"What decides within each {category(sens)}", heads, rows, note)


def _with_index(sens: xr.Dataset, name: str) -> list[str]:
    return [str(o) for o in sens["output"].values if np.isfinite(sens[name].sel(output=o)).any()]
