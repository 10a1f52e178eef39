"""Tables for a decision: indices of factors and groups, design points, and the Pareto set."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from trackroller.analysis.labels import factor_name
from trackroller.analysis.ranking import estimate, headline, order
from trackroller.analysis.table import StudyView
from trackroller.damage.sn_curve import DECADES
from trackroller.report.numbers import capital, count, level_text, listing, percent, rounded, unit_text
from trackroller.report.tables.cases import Table, factor_cell
from trackroller.report.words import pareto as choices
from trackroller.report.words.flags import FRICTION_OUTPUTS
from trackroller.report.words.indices import HALF, INDEX_WORDS, index_text, of_output
from trackroller.report.words.sentence import Sentence
from trackroller.report.words.targets import MAX_POINTS
from trackroller.study.file.goals import statistic
from trackroller.study.outputs import read_study, settings

MAX_DESIGNS = 12  # rows of the table of the Pareto set
OTHERS = {"full_slip": "full slip", "lift_off": "lift-off", "failed": "failure"}


def index_table(sens: xr.Dataset, error: Sentence | None) -> Table:
    """List for every output the index that ranks the factors, and the rows from which it was computed."""
    index, rows = headline(sens), []
    for output in map(str, sens["output"].values):
        part = sens.sel(output=output)
        ranks = [f"{r.name} {index_text(part.sel(factor=r.factor), index)}" for r in order(sens, output)[:4]]
        mark = " *" if error and output in FRICTION_OUTPUTS else ""
        rows.append([capital(of_output(sens, output)) + mark, "; ".join(ranks) or "–", str(part["note"].item())])
    heads = ["Output", f"Factors that matter most ({INDEX_WORDS[index]})", "Computed from"]
    told = str(sens.attrs.get("treatment", ""))
    note = f"{HALF}. The method needs {sens.attrs.get('needs', 'nothing')}. {capital(told)}."
    if any(row[0].endswith("*") for row in rows) and error:
        note += f" * {error.text}"
    return Table("indices", "What decides each output", heads, rows, note)


def measure_table(sens: xr.Dataset, output: str, error: Sentence | None) -> Table:
    """List every index of every factor on one output; those within chance stand in brackets."""
    part = sens.sel(output=output)
    known = [key for key in INDEX_WORDS if key in part and np.isfinite(part[key]).any()]
    rows = []
    for rank in order(sens, output):
        one, cells = part.sel(factor=rank.factor), []
        for key in known:
            noise = float(one.get(f"{key}_noise", np.nan))
            text = index_text(one, key)
            cells.append(f"({text})" if float(one[key]) <= noise else text)
        rows.append([capital(rank.name), *cells])
    title = f"All measures: {of_output(sens, output)}"
    note = f"{HALF}; an index in brackets is no larger than chance gives a factor without influence."
    note += f" {error.text}" if error and output in FRICTION_OUTPUTS else ""
    heads = ["Factor", *(capital(INDEX_WORDS[key]) for key in known)]
    return Table(f"measures_{output}", title, heads, rows, note)


def robust_tables(table: xr.Dataset, error: Sentence | None) -> list[Table]:
    """List every analysed output of an inner/outer design by design point: lives first, the best point on top."""
    names = [str(n) for n in table["output"].values]
    asked = settings(read_study(table)).get("outputs")
    lives = [n for n in names if "life" in n and np.isfinite(table["percentile_value"].sel(output=n)).any()]
    others = [n for n in names if "life" not in n] if asked or not lives else []
    found = [part for n in lives for part in _life_tables(table, n)]
    return found + [_point_table(table, n, error) for n in others]


def _life_tables(table: xr.Dataset, output: str) -> list[Table]:
    """Return the tables of B10, regimes and percentiles of the design points.

    Percentiles have a table of their own where B10 holds the scatter of the material, because they do not hold it.
    """
    part, scatter = table.sel(output=output), float(table.attrs.get("log_life_scatter", 0.0))
    safe = np.nan_to_num(part["b10_safe"].values)
    points = np.lexsort((-np.nan_to_num(part["b10"].values), -safe))[:MAX_POINTS]
    seen = [r for r in OTHERS if float(table["probability"].sel(regime=r).max()) > 0]
    heads = ["Design point", "B10", "B10, 95 % interval", "B10, other cases as life 0"]
    heads += [f"{capital(OTHERS[r])} (95 % interval)" for r in seen]
    rows = []
    for p in map(int, points):
        b10, low, high = map(float, estimate(part, "b10")[:, p])
        span = f"{rounded(low)} to {rounded(high)}" if np.isfinite(high) else "–"
        chances = [choices.chance(*estimate(table.sel(regime=r), "probability")[:, p]) for r in seen]
        rows.append([capital(choices.point_words(table, p)), b10, span, float(part["b10_safe"][p]), *chances])
    unit = unit_text(str(part["output_units"].item()))
    name = capital(str(part["output_name"].item()))
    own = f"B10 holds the material's own scatter of life, T_N = {rounded(10 ** (DECADES * scatter))}."
    note = own if scatter > 0 else "B10 holds the scatter of the study's factors alone, not that of the material."
    if never := [r for r in OTHERS if r not in seen]:
        high = 100 * float(table["probability_high"].sel(regime=never).max())
        shown = listing([OTHERS[r] for r in never], "or")
        note += f" No case shows {shown}: its probability is below {high:.2g} % at each design point (95 % confidence)."
    if (left := table.sizes["point"] - MAX_POINTS) > 0:
        note += f" {left} more design points are in sensitivity.nc."
    first = Table(f"b10_{output}", f"{name}: B10 [{unit}], best design points first", heads, rows, note)
    return [first, _point_table(table, output, None, points)]


def _point_table(table: xr.Dataset, output: str, error: Sentence | None, points: np.ndarray | None = None) -> Table:
    """Return the mean and percentiles of an output at each design point, by the scatter of the study's factors only."""
    part = table.sel(output=output)
    points = np.arange(min(table.sizes["point"], MAX_POINTS)) if points is None else points
    shares = (5.0, 50.0, 95.0)
    rows = []
    for p in map(int, points):
        spread = [float(part["percentile_value"].sel(percentile=q)[p]) for q in shares]
        rows.append([capital(choices.point_words(table, p)), float(part["mean"][p]), *spread])
    heads = ["Design point", "Mean", *(f"{q:.0f} %" for q in shares)]
    name, unit = capital(str(part["output_name"].item())), unit_text(str(part["output_units"].item()))
    note = "Rolling cases; scatter of the study's factors alone, without that of the material."
    note += f" {error.text}" if error and output in FRICTION_OUTPUTS else ""
    return Table(f"percentiles_{output}", f"{name} [{unit}]: mean and percentiles", heads, rows, note)


def pareto_table(front: xr.Dataset, view: StudyView, error: Sentence | None) -> Table | None:
    """List Pareto-optimal designs along the first goal, with a column that says which lie outside the model."""
    goals = choices.goals_of(front)
    best = np.flatnonzero(front["optimal"].values == 1)
    if not len(best):
        return None
    first, way = goals[0]
    best = best[np.argsort(front[first].values[best] * (-1 if way == "max" else 1), kind="stable")]
    shown = best[np.unique(np.linspace(0, len(best) - 1, min(MAX_DESIGNS, len(best))).astype(int))]
    names = [n for n, _ in goals] + [str(n) for n in front.data_vars if n not in (*dict(goals), "optimal")]
    arrows = {name: " ↑" if way == "max" else " ↓" for name, way in goals}
    cells = [[v if isinstance(v, str) else float(v) + 0.0 for v in front[n].values[shown]] for n in names]  # -0 is 0
    columns = [[factor_cell(n, v) for v in values] for n, values in zip(names, cells, strict=True)]
    rows: list[list[Any]] = [list(row) for row in zip(front["row"].values[shown].tolist(), *columns, strict=True)]
    kind = str(front.attrs.get("kind", "design"))
    heads = [capital(kind), *(choices.heading(front, n) + arrows.get(n, "") for n in names)]
    if kind == "design":
        heads = ["Case", *heads[1:], "Model"]
        rows = [[*row, "inside" if view.valid[row[0]] else "outside"] for row in rows]
    told = [f"{choices.goal_words(front, n)} as {'high' if w == 'max' else 'low'} as possible" for n, w in goals]
    note = f"{capital('; '.join(told))}."
    note += f" Allowed where {front.attrs['constraints']}." if front.attrs.get("constraints") else ""
    if len(best) > len(rows):
        note += f" The table shows {len(rows)} of the {len(best)} {kind}s, spread evenly along the first goal."
    note += f" {error.text}" if error and any(statistic(n)[1] in FRICTION_OUTPUTS for n, _ in goals) else ""
    return Table("pareto", f"Pareto-optimal {kind}s", heads, rows, note)


def part_sentences(sens: xr.Dataset, output: str) -> list[Sentence]:
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


def part_tables(sens: xr.Dataset) -> list[Table]:
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
