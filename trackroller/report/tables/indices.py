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


def index_table(sens: xr.Dataset, error: Sentence | None) -> Table | None:
    """List for every output the index that ranks the factors, and the rows from which it was computed."""
    index, rows, marked = headline(sens), [], False
    for output in map(str, sens["output"].values):
        part = sens.sel(output=output)
        ranks = [f"{r.name} {index_text(part.sel(factor=r.factor), index)}" for r in order(sens, output)]
        ranks = [*ranks[:4], *([f"{len(ranks) - 4} more"] if len(ranks) > 4 else [])]
        mark = " *" * (error is not None and output in FRICTION_OUTPUTS)
        row = {"Output": capital(of_output(sens, output)) + mark}
        row[f"Factors that matter most ({INDEX_WORDS[index]})"] = "; ".join(ranks) or "–"
        rows.append(row | {"Computed from": str(part["note"].item())})
        marked |= bool(mark)
    treatment = str(sens.attrs.get("treatment", ""))
    note = f"{HALF}. The method needs {sens.attrs.get('needs', 'nothing')}. {capital(treatment)}."
    note += f" * {error.text}" if marked and error else ""
    return Table.of("indices", "What decides each output", rows, note)


def measure_table(sens: xr.Dataset, output: str, error: Sentence | None) -> Table | None:
    """List every index of every factor on one output; an index that chance alone reaches stands in brackets."""
    part = sens.sel(output=output)
    known = [key for key in MEASURES if key in part and np.isfinite(part[key]).any()]
    rows = []
    for rank in order(sens, output):
        one, row = part.sel(factor=rank.factor), {"Factor": capital(rank.name)}
        for key in known:
            noise, text = float(one.get(f"{key}_noise", np.nan)), index_text(one, key)
            row[capital(INDEX_WORDS[key])] = f"({text})" if float(one[key]) <= noise else text
        rows.append(row)
    note = f"{HALF}; an index in brackets is no larger than chance alone gives for a factor without influence."
    note += f" {error.text}" if error and output in FRICTION_OUTPUTS else ""
    return Table.of(f"measures_{output}", f"All measures: {of_output(sens, output)}", rows, note)


def part_tables(sens: xr.Dataset) -> list[Table]:
    """List the indices of groups and those within the levels of a category, for every output."""
    return [table for table in (_group_table(sens), _level_table(sens)) if table is not None]


def _group_table(sens: xr.Dataset) -> Table | None:
    rows = []
    for output in _with_index(sens, "group_ST"):
        for group in sens["group"].values:
            one, row = sens.sel(output=output, group=group), {"Output": capital(of_output(sens, output))}
            row |= {"Group": capital(str(one["group_name"].item())), "Factors": str(one["group_members"].item())}
            row |= {"First-order index": index_text(one, "group_S1"), "Total index": index_text(one, "group_ST")}
            rows.append(row)
    note = f"{HALF}. The first-order index of a group holds the interactions inside the group."
    return Table.of("groups", "What groups of factors decide", rows, note)


def _level_table(sens: xr.Dataset) -> Table | None:
    """List the factors by their index within each level, the largest first."""
    name = "conditional_ST" if "conditional_ST" in sens else "conditional_S1"
    leading = f"Factors that matter most ({INDEX_WORDS['ST' if name.endswith('ST') else 'S1']})"
    unit = {"saltelli": "Blocks", "grid": "Cells"}.get(str(sens.attrs.get("method")), "Rows")
    rows = []
    for output in _with_index(sens, name):
        for level in sens["level"].values:
            part = sens.sel(output=output, level=level)
            ranked = (-part[name]).dropna("factor").argsort(kind="stable").values
            ones = [part.dropna("factor", subset=[name]).isel(factor=int(i)) for i in ranked[:4]]
            ranks = [f"{one['factor_name'].item()} {index_text(one, name)}" for one in ones]
            row = {"Output": capital(of_output(sens, output))}
            row[capital(category(sens))] = level_text(str(sens["level"].attrs["factor"]), level)
            row[leading] = "; ".join(ranks) or "–"
            rows.append(row | {unit: count(int(part["conditional_rows"]))})
    note = f"{HALF}. The variance is that among the cases of one level."
    return Table.of("levels", f"What decides within each {category(sens)}", rows, note) if rows else None


def _with_index(sens: xr.Dataset, name: str) -> list[str]:
    known = sens["output"].values if name in sens else ()
    return [str(o) for o in known if np.isfinite(sens[name].sel(output=o)).any()]
