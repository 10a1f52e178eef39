"""Sentences and tables on the indices of a study: which factor decides, interactions, whether the samples suffice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from trackroller.report.numbers import capital, count, level_text, percent, plus_minus, unit_text
from trackroller.report.tables.table import Table
from trackroller.report.words.accuracy import FRICTION_OUTPUTS
from trackroller.report.words.sentence import Sentence, say
from trackroller.results.labels import INDEX_WORDS, RELIABLE, factor_name
from trackroller.results.ranking import SIGNED, USABLE, Rank, estimate, headline, method_of, order, used_share

HALF = "± is half the 95 % interval"
SMALL = 0.02  # share of variance below which a factor is called negligible


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


def caveat(sens: xr.Dataset, output: str) -> str:
    """State rows that were left out, and why first-order indices exceed 100 %; an empty text without either."""
    part, said = sens.sel(output=output), []
    if "reliable" in part and not int(part["reliable"]):
        said.append(f"Rows that could be used: {part['note'].item()}.")
    if headline(sens) in ("first", "S1") and "first_order_sum_note" in part:
        said += [why] if (why := str(part["first_order_sum_note"].item())) else []
    return " ".join(said)


def tornado(sens: xr.Dataset, output: str) -> Sentence:
    """Name the factors that decide an output, and say how far the index can be trusted."""
    said = decides(sens, output)
    return replace(said, text=f"{said.text} {caveat(sens, output)}".strip()) if said.kind == "index" else said


def decides(sens: xr.Dataset, output: str) -> Sentence:
    """Name the factors that decide an output, by one index with its interval."""
    ranks, index, used = order(sens, output), headline(sens), used_share(sens, output)
    values = {"output": output, "what": of_output(sens, output), "index": index}
    if not ranks:
        return say("indices", "no_index", **values, note=sens.sel(output=output)["note"].item())
    if used < USABLE:
        return say("indices", "no_index", **values, used=used)
    sized = index in ("mu_star", "effect")
    unit = f" {effect_unit(sens, output)}".replace(" –", "") if sized else ""
    large = [r for r in ranks[1:] if not _small(r, ranks[0], sized)]
    shares = [f"{r.name} {percent(r.value, r.low, r.high)}" for r in large]
    sizes = [f"{r.name} by {plus_minus(r.value, r.low, r.high)}{unit}" for r in large]
    return say(
        "indices",
        "index",
        **values,
        ranks=[(r.factor, r.value, r.low, r.high) for r in ranks],
        first=ranks[0],
        further=sizes if sized else shares,
        small=[r.name for r in ranks[1:] if r not in large],
        sized=sized,
        unit=unit,
        words=INDEX_WORDS[index],
        negligible=SMALL,
        used=used,
        reliable=RELIABLE,
        correlated=sens["factor_name"].values[sens["correlated"].values == 1].tolist() if "correlated" in sens else [],
    )


def _small(rank: Rank, first: Rank, sized: bool) -> bool:
    """Return whether a factor has less than a tenth of the largest effect, or a negligible share of variance."""
    if sized:
        return bool(abs(rank.value) < 0.1 * abs(first.value))
    return bool((rank.high if np.isfinite(rank.high) else rank.value) < SMALL)


def convergence(sens: xr.Dataset, output: str) -> Sentence:
    """Say how wide the widest interval is, and whether there were samples enough."""
    ranks, times = order(sens, output), float(sens.sel(output=output).get("take_times", np.nan))
    if not ranks or not np.isfinite(times):
        return Sentence("no_index", "There are too few usable samples to judge convergence.", {"output": output})
    widest = max(ranks, key=lambda r: r.high - r.low)
    values = {"output": output, "factor": widest.factor, "name": widest.name, "half": (widest.high - widest.low) / 2}
    values |= {"size": int(sens["sample_size"].values[-1]), "sized": headline(sens) == "mu_star"}
    return say("indices", "widest", **values, times=times)


def morris(sens: xr.Dataset, output: str) -> Sentence:
    """Say which factors have the same effect everywhere, and whose effect is curved or depends on others."""
    part, ranks = sens.sel(output=output), order(sens, output)
    if not ranks:
        return Sentence("no_index", f"No effect can be given for {of_output(sens, output)}.", {"output": output})
    sigma = dict(zip(part["factor"].values, part["sigma"].values, strict=True))
    strong = [r for r in ranks if r.value >= 0.1 * ranks[0].value]
    bent = [r.name for r in strong if sigma[r.factor] > 0.5 * r.value]
    straight = [r.name for r in strong if sigma[r.factor] <= 0.5 * r.value]
    return say("indices", "morris", what=of_output(sens, output), output=output, bent=bent, straight=straight)


def interactions(sens: xr.Dataset, output: str) -> Sentence:
    """Name the strongest interaction of two factors, or say that none is found."""
    part, what = sens.sel(output=output), of_output(sens, output)
    name = next((n for n in ("S2", "interaction_share", "interaction") if n in part), "")
    table = part[name].values if name else np.array([[np.nan]])
    if not np.isfinite(table).any():
        return Sentence("no_index", f"No interaction can be given for {what}.", {"output": output})
    i, j = np.unravel_index(np.nanargmax(np.abs(table)), table.shape)
    value, low, high = map(float, estimate(part, name)[:, i, j])
    values = {"output": output, "index": name, "pair": (i, j), "value": value, "low": low, "high": high, "what": what}
    shared = name != "interaction"
    if shared and ((np.isfinite(low) and low <= 0) or value < 0.01):
        return say("indices", "no_interaction", **values)
    fit, higher = (float(part[n]) if n in part else None for n in ("fit_share", "higher_share"))
    names = part["factor_name"].values[[i, j]].tolist()
    return say("indices", "interaction", **values, names=names, share=shared, fit=fit, higher=higher)


def part_sentences(sens: xr.Dataset, output: str) -> list[Sentence]:
    """Return the sentences on the groups and on the levels for one output, as far as the analysis has them."""
    sentences = (group_indices(sens, output), level_indices(sens, output))
    return [said for said in sentences if said is not None]


def group_indices(sens: xr.Dataset, output: str) -> Sentence | None:
    """State the total index of each group of factors, the largest first."""
    if "group_ST" not in sens:
        return None
    part = sens.sel(output=output)
    part = part.isel(group=np.argsort(-part["group_ST"].values, kind="stable"))
    if part["group_ST"].isnull().any():
        return None
    found = estimate(part, "group_ST").T.tolist()
    ranks = [(str(group), *one) for group, one in zip(part["group"].values, found, strict=True)]
    parts = [(str(name), percent(*one)) for name, one in zip(part["group_name"].values, found, strict=True)]
    values = {"output": output, "what": of_output(sens, output), "words": INDEX_WORDS["ST"], "ranks": ranks}
    return say("indices", "groups", **values, parts=parts)


def level_indices(sens: xr.Dataset, output: str) -> Sentence | None:
    """Name the factor with the largest first-order index within each level of a category."""
    if "conditional_S1" not in sens:
        return None
    part, parts, lead = sens.sel(output=output), [], {}
    for level in part["level"].values:
        value, low, high = estimate(part.sel(level=level), "conditional_S1")
        if not np.isfinite(value).any():
            continue
        best = int(np.nanargmax(value))
        lead[str(level)] = str(part["factor"].values[best])
        words = level_text(str(sens["level"].attrs["factor"]), level)
        parts.append(f"{part['factor_name'].values[best]} {percent(value[best], low[best], high[best])} with {words}")
    if not parts:
        return None
    values = {"output": output, "what": of_output(sens, output), "words": INDEX_WORDS["S1"], "lead": lead}
    return say("indices", "levels", **values, category=category(sens), parts=parts)


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
