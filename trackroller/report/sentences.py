"""One plain sentence under each figure, computed from the data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from trackroller.analysis.convergence import advice
from trackroller.parameters import PARAMETERS
from trackroller.report.phrases import listing, number, percent, unit_words, upper, with_unit, within
from trackroller.study.design.levels import short

SMALL = 0.02  # share of variance below which a factor is called negligible
SIGNED = ("effect", "curvature", "prcc", "mu")  # indices whose size counts, whatever their sign
HEADLINES = {"saltelli": "ST", "morris": "mu_star", "grid": "main_share"}


@dataclass(frozen=True)
class Rank:
    """A factor's headline index with its interval (NaN where there is none), as `order` puts them."""

    factor: str
    name: str
    value: float
    low: float
    high: float


def headline(sens: xr.Dataset) -> str:
    """Name of the index that ranks the factors of a design: ST, mu_star, main_share, effect or first."""
    found = HEADLINES.get(str(sens.attrs.get("method")), "effect" if "effect" in sens else "first")
    if found == "main_share" and not np.isfinite(sens[found]).any() and "first" in sens:
        return "first"
    return found


def order(sens: xr.Dataset, output: str, index: str = "") -> list[Rank]:
    """Factors of an output by falling size of an index (default: the headline); NaN ones left out."""
    index = index or headline(sens)
    part = sens.sel(output=output)
    nan = np.full(part.sizes["factor"], np.nan)
    low = part[f"{index}_low"].values if f"{index}_low" in part else nan
    high = part[f"{index}_high"].values if f"{index}_high" in part else nan
    names = part["factor_name"].values if "factor_name" in part.coords else part["factor"].values
    rows = [
        Rank(str(f), str(n), float(v), float(a), float(b))
        for f, n, v, a, b in zip(part["factor"].values, names, part[index].values, low, high, strict=True)
        if np.isfinite(v)
    ]
    return sorted(rows, key=lambda r: -abs(r.value) if index in SIGNED else -r.value)


def of_output(sens: xr.Dataset, output: str) -> str:
    """An output in words, 'log life of the roller' on the logarithmic scale."""
    part = sens.sel(output=output)
    text = str(part["output_name"].item())
    return f"log {text}" if str(part["scale"].item()) == "log10" else text


def caveat(sens: xr.Dataset, output: str) -> str:
    """What a reader must know of left-out rows and of convergence; empty if nothing."""
    part = sens.sel(output=output)
    said = []
    if "reliable" in part and not int(part["reliable"]):
        said.append(f"Only {float(part['used_share']) * 100:.0f} % of the design could be used: {part['note'].item()}.")
    times = float(part["take_times"]) if "take_times" in part else np.nan
    if np.isfinite(times):
        said.append("The indices have converged." if times <= 1 else f"{upper(advice(times))}.")
    return " ".join(said)


def advice_of(sens: xr.Dataset, output: str) -> str:
    """Convergence of an output's indices in words; empty where the method has no course."""
    part = sens.sel(output=output)
    times = float(part["take_times"]) if "take_times" in part else np.nan
    return advice(times) if np.isfinite(times) else ""


def tornado(sens: xr.Dataset, output: str) -> str:
    """What matters for an output and how sure that is."""
    ranks = order(sens, output)
    what = of_output(sens, output)
    if not ranks:
        return f"No index can be given for {what}: {sens.sel(output=output)['note'].item()}."
    method, index = str(sens.attrs["method"]), headline(sens)
    if method == "morris" or index == "effect":
        text = _range_words(sens, output, ranks, what, index)
    else:
        text = _share_words(sens, output, ranks, what, index)
    return f"{text} {caveat(sens, output)}".strip()


def _share_words(sens: xr.Dataset, output: str, ranks: list[Rank], what: str, index: str) -> str:
    alone = {r.factor: r for r in order(sens, output, "S1")} if index == "ST" else {}
    first = ranks[0]
    if index == "ST" and first.factor in alone:
        own = alone[first.factor]
        text = f"{upper(first.name)} explains {percent(own.value, own.low, own.high)} of the variance of {what} alone"
        if first.value - own.value > (first.high - first.low) / 2:
            text += f" and {percent(first.value, first.low, first.high)} with its interactions"
    else:
        share = percent(first.value, first.low, first.high)
        text = f"{upper(first.name)} explains {share} of the variance of {what}"
    more = [f"{r.name} {percent(r.value, r.low, r.high)}" for r in ranks[1:4] if r.value >= SMALL]
    if more:
        text += f"; then {listing(more)}"
    small = [r.name for r in ranks if (r.high if np.isfinite(r.high) else r.value) < SMALL]
    if small:
        # only a total index speaks of what a factor does together with others
        end = "may be left out" if index == "ST" else f"explain{'s' if len(small) == 1 else ''} next to nothing alone"
        text += f". {upper(listing(small))} {end} (below {SMALL * 100:.0f} %)"
    return text + "."


def _range_words(sens: xr.Dataset, output: str, ranks: list[Rank], what: str, index: str) -> str:
    part = sens.sel(output=output)
    unit = "decades" if str(part["scale"].item()) == "log10" else unit_words(str(part["output_units"].item()))
    first = ranks[0]
    by = f"{within(first.value, (first.high - first.low) / 2)} {unit}".strip()
    text = f"Over its whole range {first.name} changes {what} most, by {by}"
    text += " on average" if index == "mu_star" else ""
    more = [f"{r.name} ({number(r.value)})" for r in ranks[1:4] if abs(r.value) >= 0.1 * abs(first.value)]
    if more:
        text += f"; then {listing(more)}"
    small = [r.name for r in ranks if abs(r.value) < 0.1 * abs(first.value)]
    if small:
        text += f". {upper(listing(small))} matter{'s' if len(small) == 1 else ''} less than a tenth of that"
    return text + "."


def convergence(sens: xr.Dataset, output: str) -> str:
    """Whether there were samples enough."""
    part = sens.sel(output=output)
    times = float(part["take_times"])
    ranks = order(sens, output)
    if not ranks or not np.isfinite(times):
        return "There are too few usable samples to judge convergence."
    widest = max(ranks, key=lambda r: r.high - r.low)
    half = (widest.high - widest.low) / 2
    size = int(sens["sample_size"].values[-1])
    wide = number(float(f"{half:.2g}")) if headline(sens) == "mu_star" else f"{half * 100:.1f} % of the variance"
    return f"With {size} samples the widest 95 % interval, of {widest.name}, is ± {wide}: {advice(times)}."


def morris(sens: xr.Dataset, output: str) -> str:
    """Which factors act straight and which bend or depend on others."""
    part = sens.sel(output=output)
    ranks = order(sens, output)
    if not ranks:
        return f"No effect can be given for {of_output(sens, output)}."
    top = ranks[0].value
    sigma = dict(zip(part["factor"].values, part["sigma"].values, strict=True))
    mattering = [r for r in ranks if r.value >= 0.1 * top]
    bent = [r.name for r in mattering if sigma[r.factor] > 0.5 * r.value]
    straight = [r.name for r in mattering if sigma[r.factor] <= 0.5 * r.value]
    said = []
    if straight:
        said.append(f"{listing(straight)} act{'s' if len(straight) == 1 else ''} nearly alike everywhere")
    if bent:
        acts = "acts" if len(bent) == 1 else "act"
        said.append(f"{listing(bent)} {acts} differently from place to place (curved, or through other factors)")
    text = "; ".join(said)
    return f"On {of_output(sens, output)}, {text}. {caveat(sens, output)}".strip()


def interactions(sens: xr.Dataset, output: str) -> str:
    """The strongest pair."""
    part = sens.sel(output=output)
    name = next((n for n in ("S2", "interaction_share", "interaction") if n in part), "")
    values = part[name].values if name else np.array([[np.nan]])
    if not np.isfinite(values).any():
        return f"No interaction can be given for {of_output(sens, output)}."
    i, j = np.unravel_index(np.nanargmax(np.abs(values)), values.shape)
    names = part["factor_name"].values
    value = float(values[i, j])
    if name == "interaction":
        return f"The strongest interaction on {of_output(sens, output)} is {names[i]} with {names[j]}: {number(value)}."
    low, high = (float(part[f"{name}{e}"].values[i, j]) if f"{name}{e}" in part else np.nan for e in ("_low", "_high"))
    how = ""
    if "fit_share" in part:
        how = f" (approximate: by a polynomial that predicts {percent(float(part['fit_share']))} of the variance)"
    if not np.isfinite(low) and value < 0.01:
        return f"No interaction of two factors makes 1 % of the variance of {of_output(sens, output)}."
    if np.isfinite(low) and low <= 0:
        return (
            f"No interaction of two factors on {of_output(sens, output)} is beyond doubt; the largest, {names[i]} "
            f"with {names[j]}, is {percent(value, low, high)} of the variance{how}."
        )
    text = (
        f"The strongest interaction on {of_output(sens, output)}, {names[i]} with {names[j]}, "
        f"makes {percent(value, low, high)} of the variance{how}"
    )
    if "higher_share" in part:
        text += f"; interactions of three and more factors {percent(float(part['higher_share']))}"
    return text + "."


def overview(sens: xr.Dataset) -> str:
    """The factor that leads for each output."""
    lead: dict[str, list[str]] = {}
    for output in map(str, sens["output"].values):
        if ranks := order(sens, output):
            lead.setdefault(ranks[0].name, []).append(str(sens.sel(output=output)["output_name"].item()))
    if not lead:
        return "No index can be given for any output."
    return upper("; ".join(f"{name} leads for {listing(what)}" for name, what in lead.items())) + "."


def band(factor: str, levels: Sequence[str], median: np.ndarray, what: str, unit: str, ordered: bool = True) -> str:
    """How the median of an output goes along one factor, or between the values of a list without order."""
    good = np.flatnonzero(np.isfinite(median))
    if good.size < 2:
        return f"the median {what} cannot be followed along {factor}"
    low, high = good[np.argmin(median[good])], good[np.argmax(median[good])]
    least, most = float(median[low]), float(median[high])
    if most - least <= 0.05 * max(abs(least), abs(most)):
        return f"the median {what} hardly changes with {factor}"
    if not ordered:
        return (
            f"the median {what} is {with_unit(least, unit)} with {factor} {levels[low]} and "
            f"{with_unit(most, unit)} with {levels[high]}"
        )
    first, last = float(median[good[0]]), float(median[good[-1]])
    if abs(last - first) < 0.5 * (most - least):
        return (
            f"the median {what} goes between {number(least)} and {with_unit(most, unit)} along {factor}, "
            f"without a steady trend"
        )
    verb = "rises" if last > first else "falls"
    ratio = max(first, last) / min(first, last) if min(first, last) > 0 else np.nan
    times = f" (by a factor of {number(ratio)})" if np.isfinite(ratio) else ""
    return (
        f"the median {what} {verb} from {number(first)} to {with_unit(last, unit)}{times} as {factor} goes from "
        f"{levels[good[0]]} to {levels[good[-1]]}"
    )


def pareto(front: xr.Dataset) -> str:
    """Size and ends of a Pareto set."""
    best = front["optimal"].values == 1
    count, allowed = int(best.sum()), front.sizes["row"]
    model = f" Designs as the contact model {front.attrs['model']} has them." if front.attrs.get("model") else ""
    if not count:
        return f"No design is left: {front.attrs['excluded']}.{model}"
    if count == 1:
        row = int(np.flatnonzero(best)[0])
        goals = [item.split(" ")[0] for item in front.attrs["objectives"].split(", ")]
        reached = []
        for name in goals:
            attrs, value = front[name].attrs, float(front[name].values[row])
            reached.append(f"{attrs.get('long_name', name)} {with_unit(value, attrs.get('units', ''))}")
        return (
            f"One of {allowed} allowed designs is best in everything: {listing(reached)}. "
            f"Left out: {front.attrs['excluded']}.{model}"
        )
    said = []
    for item in front.attrs["objectives"].split(", "):
        name, direction = item.split(" ")
        values = front[name].values[best]
        unit = front[name].attrs.get("units", "")
        words = front[name].attrs.get("long_name", name)
        ends = (values.max(), values.min()) if direction == "max" else (values.min(), values.max())
        goes = "down" if direction == "max" else "up"
        said.append(f"{words} from {number(ends[0])} {goes} to {with_unit(ends[1], unit)}")
    return (
        f"{count} of {allowed} allowed designs are beaten by no other; among them one can trade "
        f"{listing(said)}. Left out: {front.attrs['excluded']}.{model}"
    )


def robustness(table: xr.Dataset, output: str) -> str:
    """The best design point by B10 (or median), and how often others slip or lift off."""
    part = table.sel(output=output)
    has_life = bool(np.isfinite(part["b10_safe"]).any() or np.isposinf(part["b10_safe"]).any())
    if not has_life:
        return f"No B10 can be given for {part['output_name'].item()}."
    safe = np.nan_to_num(part["b10_safe"].values, nan=-1.0)
    slip = table["probability"].sel(regime="full_slip").values
    lift = table["probability"].sel(regime="lift_off").values
    best = int(np.argmax(np.where(safe > 0, safe, np.nan_to_num(part["b10"].values, nan=0.0) * 1e-9)))
    b10, low, high = (float(part[n].values[best]) for n in ("b10", "b10_low", "b10_high"))
    where, unit = point_words(table, best), str(part["output_units"].item())
    if str(part["output_name"].item()).endswith("overrollings"):
        unit = "overrollings"
    still = float(table["probability"].sel(regime="rolling").values[best]) == 1.0
    text = (
        f"At {where} nine of ten {'cases' if still else 'of the rolling cases'} reach {with_unit(b10, unit)} "
        f"({number(low)} to {number(high)}), the best B10 of the {part['output_name'].item()}"
    )
    if not still:
        all_in = float(part["b10_safe"].values[best])
        text += (
            f"; with every other regime counted as life 0 it is {with_unit(all_in, unit)}"
            if all_in > 0
            else "; one in ten or more do not roll, so that counting these no B10 is left"
        )
    text += f"; full slip there in {percent(slip[best])} and lift-off in {percent(lift[best])} of the cases"
    worst = int(np.argmax(slip + lift))
    if worst != best and slip[worst] + lift[worst] > slip[best] + lift[best]:
        text += f", at worst in {percent(slip[worst] + lift[worst])} ({point_words(table, worst)})"
    return text + "."


def _unit_of(name: str) -> str:
    unit = PARAMETERS[name].unit if name in PARAMETERS else "-"
    return "°" if unit == "deg" else unit


def point_words(table: xr.Dataset, point: int) -> str:
    """A design point as 'profile ratio 1.1, contact angle 30'."""
    names = [n for n in str(table.attrs.get("outer_factors", "")).split(", ") if n]
    said = []
    for name in names:
        value = table[name].values[point]
        number = "" if isinstance(value, str) else with_unit(float(value), _unit_of(name)).replace(" °", "°")
        text = number or short(name, value)
        said.append(f"{name.replace('_', ' ')} {text}")
    return ", ".join(said) or "the one design point"
