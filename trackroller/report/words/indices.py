"""Sentences on the indices of a study: which factor decides, interactions, whether the samples suffice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from trackroller.analysis.labels import INDEX_WORDS, RELIABLE, factor_name
from trackroller.analysis.ranking import SIGNED, USABLE, Rank, estimate, headline, order, used_share
from trackroller.report.numbers import (
    capital,
    count,
    level_text,
    listing,
    percent,
    plus_minus,
    rounded,
    shortened,
    unit_text,
)
from trackroller.report.words.sentence import Sentence

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
    ranks, what, index = order(sens, output), of_output(sens, output), headline(sens)
    if not ranks:
        text = f"No index can be given for {what}: {sens.sel(output=output)['note'].item()}."
        return Sentence("no_index", text, {"output": output})
    used = used_share(sens, output)
    if used < USABLE:
        text = f"No factor is named as decisive for {what}: its indices use only {percent(used)} of the cases."
        return Sentence("no_index", text, {"output": output, "used": used})
    text = _range_words(sens, output, ranks) if index in ("mu_star", "effect") else _share_words(ranks, what, index)
    if used < RELIABLE:
        text = f"{text[:-1]}; the index uses {percent(used)} of the cases."
    if tied := _correlated(sens):
        text = f"{text[:-1]}; {listing(tied)} are correlated, and the index of each holds influence of the others."
    values = {"output": output, "index": index, "ranks": [(r.factor, r.value, r.low, r.high) for r in ranks]}
    return Sentence("index", text, values)


def _correlated(sens: xr.Dataset) -> list[str]:
    """Name the factors that are correlated with another factor."""
    return [str(n) for n in sens["factor_name"].values[sens["correlated"].values == 1]] if "correlated" in sens else []


def _share_words(ranks: list[Rank], what: str, index: str) -> str:
    first, *others = ranks
    verb = "accounts for" if index == "ST" else "explains"
    share = f"{percent(first.value, first.low, first.high)} of the variance of {what} ({INDEX_WORDS[index]})"
    text = f"{capital(first.name)} {verb} {share}"
    small = [r for r in others if (r.high if np.isfinite(r.high) else r.value) < SMALL]
    more = [f"{r.name} {percent(r.value, r.low, r.high)}" for r in others if r not in small]
    text += f", {shortened(more)}" if more else ""
    if small:
        many = "each " if len(small) > 1 else ""
        text += f"; {shortened([r.name for r in small])} {many}less than {100 * SMALL:.0f} %"
    return text + "."


def _range_words(sens: xr.Dataset, output: str, ranks: list[Rank]) -> str:
    index, first = headline(sens), ranks[0]
    unit = f" {effect_unit(sens, output)}".replace(" –", "")
    what = of_output(sens, output)
    text = f"Over its whole range {first.name} changes {what} most, by {plus_minus(first.value, first.low, first.high)}"
    text += f"{unit}{' on average' if index == 'mu_star' else ''}"
    more = [
        f"{r.name} by {plus_minus(r.value, r.low, r.high)}{unit}"
        for r in ranks[1:]
        if abs(r.value) >= 0.1 * abs(first.value)
    ]
    text += f", {shortened(more)}" if more else ""
    small = [r.name for r in ranks if abs(r.value) < 0.1 * abs(first.value)]
    text += f"; {shortened(small)} by less than a tenth of the largest" if small else ""
    return text + "."


def convergence(sens: xr.Dataset, output: str) -> Sentence:
    """Say how wide the widest interval is, and whether there were samples enough."""
    ranks, times = order(sens, output), float(sens.sel(output=output).get("take_times", np.nan))
    if not ranks or not np.isfinite(times):
        return Sentence("no_index", "There are too few usable samples to judge convergence.", {"output": output})
    widest = max(ranks, key=lambda r: r.high - r.low)
    half, size = (widest.high - widest.low) / 2, int(sens["sample_size"].values[-1])
    wide = rounded(half, 2) if headline(sens) == "mu_star" else f"{100 * half:.1f} % of the variance"
    text = f"With {count(size)} samples the widest 95 % interval, of {widest.name}, is ± {wide}. The indices have "
    text += "converged." if times <= 1 else f"not converged: take {times:.0f} times as many samples."
    return Sentence("widest", text, {"output": output, "factor": widest.factor, "half": half, "size": size})


def morris(sens: xr.Dataset, output: str) -> Sentence:
    """Say which factors have the same effect everywhere, and whose effect is curved or depends on others."""
    part, ranks = sens.sel(output=output), order(sens, output)
    if not ranks:
        return Sentence("no_index", f"No effect can be given for {of_output(sens, output)}.", {"output": output})
    sigma = dict(zip(part["factor"].values, part["sigma"].values, strict=True))
    strong = [r for r in ranks if r.value >= 0.1 * ranks[0].value]
    bent = [r.name for r in strong if sigma[r.factor] > 0.5 * r.value]
    straight = [r.name for r in strong if sigma[r.factor] <= 0.5 * r.value]
    said = [f"the effect of {listing(straight)} is nearly the same everywhere"] if straight else []
    if bent:
        said.append(f"the effect of {listing(bent)} is curved or depends on other factors")
    text = f"On {of_output(sens, output)}, {'; '.join(said)}."
    return Sentence("morris", text, {"output": output, "bent": bent, "straight": straight})


def interactions(sens: xr.Dataset, output: str) -> Sentence:
    """Name the strongest interaction of two factors, or say that none is found."""
    part, what = sens.sel(output=output), of_output(sens, output)
    name = next((n for n in ("S2", "interaction_share", "interaction") if n in part), "")
    table = part[name].values if name else np.array([[np.nan]])
    if not np.isfinite(table).any():
        return Sentence("no_index", f"No interaction can be given for {what}.", {"output": output})
    i, j = np.unravel_index(np.nanargmax(np.abs(table)), table.shape)
    names = part["factor_name"].values
    value, low, high = map(float, estimate(part, name)[:, i, j])
    values = {"output": output, "index": name, "pair": (i, j), "value": value, "low": low, "high": high}
    if name == "interaction":
        text = f"The strongest interaction on {what} is {names[i]} with {names[j]}: {rounded(value)}."
        return Sentence("interaction", text, values)
    if (np.isfinite(low) and low <= 0) or value < 0.01:
        return Sentence("no_interaction", f"No interaction of two factors on {what} is found.", values)
    text = f"The strongest interaction on {what}, {names[i]} with {names[j]}, makes {percent(value, low, high)} of the "
    text += "variance"
    if "fit_share" in part:
        text += f" (by a fitted polynomial that predicts {percent(float(part['fit_share']))} of the variance)"
    if "higher_share" in part:
        text += f"; interactions of three and more factors make {percent(float(part['higher_share']))}"
    return Sentence("interaction", text + ".", values)


def part_sentences(sens: xr.Dataset, output: str) -> list[Sentence]:
    """Return the sentences on the groups and on the levels for one output, as far as the analysis has them."""
    sentences = (group_indices(sens, output), level_indices(sens, output))
    return [said for said in sentences if said is not None]


def group_indices(sens: xr.Dataset, output: str) -> Sentence | None:
    """State the total index of each group of factors, the largest first."""
    if "group_ST" not in sens:
        return None
    part = sens.sel(output=output)
    value, low, high = estimate(part, "group_ST")
    if not np.isfinite(value).all():
        return None
    order = np.argsort(-value, kind="stable")
    names = part["group_name"].values
    parts = [f"{names[i]} {percent(value[i], low[i], high[i])}" for i in order]
    what = f"of the variance of {of_output(sens, output)} ({INDEX_WORDS['ST']})"
    text = f"By groups, {names[order[0]]} accounts for {percent(value[order[0]], low[order[0]], high[order[0]])} {what}"
    text += f", {listing(parts[1:])}." if parts[1:] else "."
    ranks = [(str(part["group"].values[i]), float(value[i]), float(low[i]), float(high[i])) for i in order]
    return Sentence("groups", text, {"output": output, "ranks": ranks})


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
    what = f"{INDEX_WORDS['S1']} of the variance of {of_output(sens, output)}"
    text = f"By {category(sens)}, the largest {what} is: {'; '.join(parts)}."
    return Sentence("levels", text, {"output": output, "lead": lead})


def category(sens: xr.Dataset) -> str:
    """Name the factor whose levels the conditional indices stand for."""
    return factor_name(str(sens["level"].attrs["factor"]))
