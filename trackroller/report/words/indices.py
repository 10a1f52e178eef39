"""Sentences and tables on the indices of a study: which factor decides, interactions, whether the samples suffice."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from trackroller.report.numbers import capital, count, level_text, percent, plus_minus, unit_text
from trackroller.report.tables.table import Table
from trackroller.report.words.accuracy import FRICTION_OUTPUTS
from trackroller.report.words.sentence import Sentence, say
from trackroller.results.findings import NEGLIGIBLE, Finding
from trackroller.results.labels import INDEX_WORDS, RELIABLE, factor_name
from trackroller.results.ranking import SIGNED, estimate, headline, method_of, order
from trackroller.results.results import Results

HALF = "± is half the 95 % interval"


def index_text(part: xr.Dataset, name: str) -> str:
    """Write one index with half its 95 % interval; an index without a sign is not shown below 0."""
    value, low, high = map(float, estimate(part, name))
    return plus_minus(value if name in SIGNED else float(np.maximum(0.0, value)), low, high)


def of_output(sens: xr.Dataset, output: str) -> str:
    """Name an output, 'log life of the roller' on the logarithmic scale."""
    part = sens.sel(output=output)
    text = str(part["output_name"].item())
    return f"log {text}" if str(part["scale"].item()) == "log10" else text


def effect_unit(sens: xr.Dataset, output: str) -> str:
    """Name the unit of an effect; on the logarithmic scale it is a power of ten."""
    part = sens.sel(output=output)
    return "powers of ten" if str(part["scale"].item()) == "log10" else unit_text(str(part["output_units"].item()))


def coded_levels(results: Results, sens: xr.Dataset) -> dict[str, str]:
    """Return the two levels of each category whose effect has a sign, from the first to the second one, by factor."""
    if headline(sens) not in SIGNED:
        return {}
    pairs = {n: f.levels for n, f in results.design.factors.items() if f.discrete and not f.ordered}
    return {
        name: " to ".join(level_text(name, level) for level in levels)
        for name, levels in pairs.items()
        if len(levels) == 2
    }


def index_words(sens: xr.Dataset, finding: Finding, levels: Mapping[str, str] | None = None) -> Sentence:
    """Name the factors that decide an output, by one index with its interval.

    Parameters
    ----------
    sens, finding : the indices, and the finding on one output
    levels : words for both levels of a category by factor, where an effect has a sign
    """
    values, output = finding.values, finding.values["output"]
    ranks, sized, index = values["ranks"], values["sized"], values["index"]
    together = [ranks[0].name, *(r.name for r in values["ties"])]
    large = [r for r in ranks[1:] if r not in [*values["small"], *values["ties"], *values["unsure"]]]
    unit = f" {effect_unit(sens, output)}".replace(" –", "") if sized else ""
    shares = [f"{r.name} {percent(r.value, r.low, r.high)}" for r in large]
    coded = {r.name: f" (from {levels[r.factor]})" for r in ranks if levels and r.factor in levels}
    sizes = [f"{r.name}{coded.get(r.name, '')} by {plus_minus(r.value, r.low, r.high)}{unit}" for r in large]
    together = [name + coded.get(name, "") for name in together] if sized else together
    words = {"what": of_output(sens, output), "first": ranks[0], "together": together, "unit": unit}
    words |= {
        "small": [r.name for r in values["small"]],
        "unsure": [f"{r.name} (0 to {percent(r.high)})" for r in values["unsure"]],
        "words": INDEX_WORDS[index],
        "further": sizes if sized else shares,
    }
    return say("indices", "index", **{**values, **words}, negligible=NEGLIGIBLE, reliable=RELIABLE)


def interaction_words(sens: xr.Dataset, finding: Finding) -> Sentence:
    """Name the strongest interaction on an output."""
    return say("indices", "interaction", **finding.values, what=of_output(sens, finding.values["output"]))


def group_words(sens: xr.Dataset, finding: Finding) -> Sentence:
    """State the total index of each group of factors, the largest first."""
    values = finding.values
    parts = [(name, percent(*one)) for _, name, *one in values["ranks"]]
    what = of_output(sens, values["output"])
    return say("indices", "groups", **values, what=what, words=INDEX_WORDS["ST"], parts=parts)


def level_words(sens: xr.Dataset, finding: Finding) -> Sentence:
    """Name the factor with the largest first-order index within each level of a category."""
    values, name = finding.values, str(sens["level"].attrs["factor"])
    parts = [
        f"{r.name} {percent(r.value, r.low, r.high)} with {level_text(name, v)}" for v, r in values["lead"].items()
    ]
    what = of_output(sens, values["output"])
    return say("indices", "levels", **values, what=what, words=INDEX_WORDS["S1"], category=category(sens), parts=parts)


def category(sens: xr.Dataset) -> str:
    """Name the factor whose levels the conditional indices stand for."""
    return factor_name(str(sens["level"].attrs["factor"]))


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
    method = method_of(sens)
    unit = capital(method.unit if method is not None else "rows")
    rows = []
    for output in _with_index(sens, name):
        for level in sens["level"].values:
            part = sens.sel(output=output, level=level).dropna("factor", subset=[name])
            ones = [part.isel(factor=i) for i in np.argsort(-part[name].values, kind="stable")[:4]]
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
