"""What a study shows beside its verdict: findings as data, each with the rows that carry it.

A finding is made only if the rows can carry it: no effect between confounded factors, no index over a grid with
gaps, no "only at" from a sample, no share over several contact models.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, partial
from itertools import chain
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from scipy.stats import norm, spearmanr

from trackroller.methods.correlation import CORRELATED
from trackroller.parameters import BODIES, REGIMES
from trackroller.results import effects
from trackroller.results.candidates import slip_margin
from trackroller.results.columns import codes
from trackroller.results.effects import Effect
from trackroller.results.first_limits import first_limit, outlasted
from trackroller.results.groups import MOST_LEVELS, Product, confined
from trackroller.results.lives import FIRST_LIMIT
from trackroller.results.ranking import (
    SIZED,
    Rank,
    decisive,
    estimate,
    headline,
    order,
    robust_design,
    used_share,
)
from trackroller.results.results import Results
from trackroller.roller.output_names import is_life, pair_first
from trackroller.study.design.entries import FACTOR_NAMES, OPTION_FACTORS

MOST = 5  # findings under *Why*
MOST_PRODUCTS = 3  # of levels of two factors that confine an event
MOST_EFFECTS = 3  # of them on effects of factors
FEW = 20  # with fewer events or cases the share of an event at a level is not looked at
WORTH = 0.05  # of the variance: a smaller interaction changes no decision
APART = 2.0  # ratio of the effects within two levels of a category, from which on each is told
EVEN = 0.1  # difference of the shares of cases that constraints leave, up to which they cut evenly
ALIKE = 1e-6  # relative difference of two indices that count as equal
NOTHING = 0.005  # of the variance: the low end of an interval below it is told as 0 %
ROUNDING = 1e-9  # of the margin to slip
NEGLIGIBLE = 0.02  # share of the variance below which a factor does not matter


@dataclass(frozen=True)
class Finding:
    """A statement on a study as data.

    Attributes
    ----------
    kind : what is stated
    values : the numbers and names of the statement
    among : the set of cases that it speaks of: `valid`, `rolling` or `all`
    rows : the cases of this set that it rests on, shape (n,) bool
    spans : the levels that these rows have of each factor; the smallest and the largest value where there are many
    models : contact models of these rows
    """

    kind: str
    values: Mapping[str, Any]
    among: str
    rows: np.ndarray = field(repr=False)
    spans: Mapping[str, tuple[Any, ...]]
    models: tuple[str, ...]


def finding(results: Results, kind: str, among: str, rows: np.ndarray, **values: Any) -> Finding:
    """Return a statement with the levels and the contact models of the rows that it rests on."""
    spans: dict[str, tuple[Any, ...]] = {}
    for name in results.factors:
        own = results.table[name][rows]
        levels = [v for v in results.levels(name) if (own == v).any()] if own.nunique() <= MOST_LEVELS else []
        spans[name] = tuple(levels) or (own.min(), own.max())
    return Finding(kind, values, among, rows, spans, _models(results, rows))


def _models(results: Results, rows: np.ndarray) -> tuple[str, ...]:
    if "contact_model" in results.table:
        return tuple(results.table["contact_model"][rows].unique())
    return (results.config.contact_model,)


def confounded_with(results: Results, name: str, rows: np.ndarray) -> list[str]:
    """Return the factors that are confounded with a factor in these rows: an effect of one may be that of another.

    Factors are confounded if the level of one gives that of the other, or by a rank correlation of `CORRELATED`.
    `trackroller.methods.correlation.correlated_pairs` says which factors of a whole design are correlated.
    """
    table = results.table[rows]
    own = codes(table, (name,))
    tied = []
    for other in (f for f in results.factors if f != name):
        theirs = codes(table, (other,))
        levels, others = len(np.unique(own)), len(np.unique(theirs))
        if min(levels, others) < 2:
            continue
        pairs = len(np.unique(own * (int(theirs.max()) + 1) + theirs))
        one_to_one = pairs == max(levels, others) and max(levels, others) < len(table)
        same_order = results.numeric(name) and results.numeric(other) and _correlated(table[name], table[other])
        if one_to_one or same_order:
            tied.append(other)
    return tied


def _correlated(one: Any, other: Any) -> bool:
    good = np.isfinite(one.to_numpy(dtype=float)) & np.isfinite(other.to_numpy(dtype=float))
    if good.sum() < 3 or one[good].nunique() < 2 or other[good].nunique() < 2:
        return False
    return bool(abs(spearmanr(one[good], other[good]).statistic) >= CORRELATED)


def cut_evenly(results: Results, name: str) -> bool:
    """Return whether constraints leave the same share of the cases in the lower and the upper half of a factor."""
    if results.allowed is None:
        return True
    own = results.table[name].to_numpy(dtype=float)
    halves = own <= np.nanmedian(own), own > np.nanmedian(own)
    shares = [results.allowed[results.inside & half].mean() for half in halves if (results.inside & half).any()]
    return max(shares, default=1.0) - min(shares, default=1.0) <= EVEN


# why one design lasts longer than another


def why(results: Results) -> list[Finding]:
    """Return at most `MOST` findings on what decides the life of a study, or its peak stress.

    Parameters
    ----------
    results : Results
        A solved study.

    Returns
    -------
    The most important finding first: which limits end the lives, which factors decide, and the largest effects.
    """
    shown = shown_output(results)
    found, sens = [*limits_first(results)], results.analysis
    strongest = strongest_effects(results, shown[0]) if shown is not None else []
    fitted = [i for i, one in enumerate(strongest) if one.kind == "fitted"]
    if sens is not None and not robust_design(sens):
        indices = _of_analysis(results, sens)
        if fitted and headline(sens) == "first":  # a fit tells the same of such a sample, and closer
            indices = [one for one in indices if one.kind != "index"]
        found += indices
    for i, one in enumerate(strongest):  # one sentence says that lives lie beyond the data, one how well a fit predicts
        once = {"beyond": one.values["beyond"] if i == 0 else 0} | ({"share": np.nan} if i in fitted[1:] else {})
        strongest[i] = replace(one, values={**one.values, **once})
    asked = [name for name in results.config.analysis.outputs or () if not is_life(name) and name not in REGIMES]
    others = [strongest_effects(results, name)[:1] for name in asked if shown is None or name != shown[0]]
    return [*found, *strongest, *chain.from_iterable(others)][:MOST]


def shown_output(results: Results) -> tuple[str, str, str] | None:
    """Return column, words and unit of the life of a study, or of its peak stress where it has no life."""
    if results.life:
        return results.life
    stresses = [(f"peak_stress_{body}", f"peak stress of the {body}", "MPa") for body in BODIES]
    return next((shown for shown in stresses if results.has(shown[0])), None)


def limits_first(results: Results) -> list[Finding]:
    """Count the limits that end the valid cases first; nothing without limits."""
    candidates = results.candidates()
    if candidates is None or candidates.goal != FIRST_LIMIT:
        return []
    rows = results.of_one_model(results.valid)
    names = first_limit(results)[rows]
    counts = {n: int((names == n).sum()) for n in sorted(set(names) - {""}, key=lambda n: -int((names == n).sum()))}
    if len(counts) == 1:
        beaten = outlasted(results, next(iter(counts)), rows)
        facts = {"counts": counts, "of": int(rows.sum()), "beaten": beaten}
        return [finding(results, "first_limits", "valid", rows, **facts)] if beaten else []
    if not counts:
        return []
    return [finding(results, "first_limits", "valid", rows, counts=counts, of=int(rows.sum()), beaten={})]


def _of_analysis(results: Results, sens: xr.Dataset) -> list[Finding]:
    """Return the findings of the indices: the factors that decide, by group and by level, and an interaction."""
    names = [str(n) for n in sens["output"].values if str(n) not in REGIMES]  # `ends` says where these occur
    lives = pair_first(filter(is_life, names))
    output = next((n for n in dict.fromkeys([*lives, *names]) if decisive(sens, n)), None)
    if output is None or not carries_indices(results, sens, output):
        return []
    if is_life(output) and results.without_fatigue.any():  # lives by fewer limits are among the rows
        return []
    values = {kind: found for kind, of in OF_ANALYSIS.items() if (found := of(sens, output)) is not None}
    large = [r.factor for r in values["index"]["ranks"] if r not in values["index"]["small"]]
    if results.config.method.observed and any(confounded_with(results, name, results.counted) for name in large):
        values.pop("index")  # the share of one factor may be that of another
    if "index" in values:
        told = results.quantity(output)[0].astype(float)  # a life counts by its logarithm
        used = np.isfinite(told) & ((told > 0) | ~is_life(output))
        values["index"]["outside"] = int((results.counted & ~results.valid & used).sum())
    kinds = [*values]
    if headline(sens) == "first":  # a design with groups serves these better than single factors
        kinds.sort(key=lambda kind: kind not in ("groups", "levels"))
    return [finding(results, kind, "rolling", results.counted, **values[kind]) for kind in kinds]


def carries_indices(results: Results, sens: xr.Dataset, output: str) -> bool:
    """Return whether indices describe the design: solved by one model, and of a grid every combination of levels."""
    if any(name in OPTION_FACTORS for name in results.factors):
        return False
    return not results.grid or used_share(sens, output) > 1 - ALIKE


def index_values(sens: xr.Dataset, output: str) -> dict[str, Any] | None:
    """Return the factors that decide an output, by one index with its interval; None if no index is known.

    Factors with equal indices stand together.
    """
    ranks, index = order(sens, output), headline(sens)
    if not ranks:
        return None
    sized, correlated = index in SIZED, []
    if "correlated" in sens:
        correlated = sens["factor_name"].values[sens["correlated"].values == 1].tolist()
    ties = [r for r in ranks[1:] if abs(r.value - ranks[0].value) <= ALIKE * abs(ranks[0].value)]
    small = [r for r in ranks[1:] if _small(r, ranks[0], sized)]
    values = {"output": output, "index": index, "sized": sized, "ranks": ranks, "ties": ties, "small": small}
    # an interval that holds 0 neither ranks a factor nor says that it is small
    values["unsure"] = [r for r in ranks[1:] if not sized and r not in [*ties, *small] and r.low < NOTHING]
    return values | {"correlated": correlated, "used": used_share(sens, output)}


def _small(rank: Rank, first: Rank, sized: bool) -> bool:
    """Return whether a factor has less than a tenth of the largest effect, or a negligible share of variance."""
    if sized:
        return bool(abs(rank.value) < 0.1 * abs(first.value))
    return bool((rank.high if np.isfinite(rank.high) else rank.value) < NEGLIGIBLE)


def group_values(sens: xr.Dataset, output: str) -> dict[str, Any] | None:
    """Return the total index of each group of factors, the largest first."""
    if "group_ST" not in sens:
        return None
    part = sens.sel(output=output)
    part = part.isel(group=np.argsort(-part["group_ST"].values, kind="stable"))
    if part["group_ST"].isnull().any():
        return None
    names = zip(map(str, part["group"].values), map(str, part["group_name"].values), strict=True)
    ranks = [Rank(*name, *one) for name, one in zip(names, estimate(part, "group_ST").T.tolist(), strict=True)]
    return {"output": output, "ranks": ranks}


def level_values(sens: xr.Dataset, output: str) -> dict[str, Any] | None:
    """Return the factor with the largest first-order index within each level of a category."""
    if "conditional_S1" not in sens:
        return None
    part, lead = sens.sel(output=output), {}
    for level in part["level"].values:
        value, low, high = estimate(part.sel(level=level), "conditional_S1")
        if np.isfinite(value).any():
            best = int(np.nanargmax(value))
            names = str(part["factor"].values[best]), str(part["factor_name"].values[best])
            lead[str(level)] = Rank(*names, value[best], low[best], high[best])
    return {"output": output, "lead": lead} if lead else None


def interaction_values(sens: xr.Dataset, output: str) -> dict[str, Any] | None:
    """Return the strongest interaction of two factors; None if it is below `WORTH`, or may be chance."""
    part = sens.sel(output=output)
    name = next((n for n in ("S2", "interaction_share", "interaction") if n in part), "")
    table = part[name].values if name else np.array([[np.nan]])
    if not np.isfinite(table).any():
        return None
    i, j = np.unravel_index(np.nanargmax(np.abs(table)), table.shape)
    value, low, high = map(float, estimate(part, name)[:, i, j])
    shared, ranks = name != "interaction", order(sens, output)
    chance = np.isfinite(low) and low <= 0
    if (chance or value < WORTH) if shared else (not ranks or abs(value) < 0.1 * abs(ranks[0].value)):
        return None
    fit, higher = (float(part[n]) if n in part else None for n in ("fit_share", "higher_share"))
    names = part["factor_name"].values[[i, j]].tolist()
    values = {"output": output, "index": name, "pair": (i, j), "names": names, "share": shared}
    return values | {"value": value, "low": low, "high": high, "fit": fit, "higher": higher}


OF_ANALYSIS = {  # the statements on an output of an analysis, in their order
    "index": index_values,
    "groups": group_values,
    "levels": level_values,
    "interaction": interaction_values,
}


def strongest_effects(results: Results, column: str) -> list[Finding]:
    """Return the largest effects of the factors on an output, at most `MOST_EFFECTS`, those in one direction first.

    Among those on a life choices of the design come before conditions, and the speed last: hours are distance over
    speed.
    """
    rows = results.of_one_model(results.valid)
    fit = cache(partial(effects.fitted_effects, results, column, rows))  # one serves all factors, and pairs need none
    found = [one for name in results.factors if (one := effect_of(results, column, name, fit=fit)) is not None]

    def size(one: Finding) -> tuple[bool, float]:
        return one.kind == "pairs_both", -abs(float(np.log(one.values["effect"].ratio)))

    def place(one: Finding) -> tuple[bool, bool, bool, float]:
        name = one.values["effect"].factor
        return size(one)[0], name == "velocity", results.roles.get(name) != "choice", size(one)[1]

    found = sorted(found, key=size)[:MOST_EFFECTS]
    return sorted(found, key=place) if is_life(column) else found


def effect_of(
    results: Results,
    column: str,
    factor: str,
    rows: np.ndarray | None = None,
    fit: Callable[[], tuple[float, list[Effect]]] | None = None,
) -> Finding | None:
    """Say how an output changes with a factor.

    Cases that differ in nothing else are compared where there are enough of them, otherwise a fit of a sample is asked.

    Parameters
    ----------
    column : column of the output
    factor : name of the factor
    rows : cases that count, shape (n,) bool; default: the valid ones
    fit : returns `effects.fitted_effects` of these cases; default: they are fitted anew

    Returns
    -------
    Finding or None
        None where the factor changes nothing, too few cases can be compared, a fit predicts too little or cannot tell
        the factor from others, or constraints cut unevenly.
    """
    rows = results.of_one_model(results.valid if rows is None else rows)
    if factor in OPTION_FACTORS or not rows.any():
        return None
    effect = effects.paired_effect(results, column, factor, rows)
    if effect is not None:
        return _of_pairs(results, column, effect, rows)
    if results.config.method.proposes:  # a search prefers good designs: it is no sample
        return None
    share, fitted = effects.fitted_effects(results, column, rows) if fit is None else fit()
    effect = next((one for one in fitted if one.factor == factor), None)
    if effect is None or not _beyond_chance(effect, len(results.factors)) or not cut_evenly(results, factor):
        return None
    return finding(results, "fitted", "valid", rows, **_values(results, column, effect, rows), share=share)


def _values(results: Results, column: str, effect: Effect, rows: np.ndarray) -> dict[str, Any]:
    beyond = int((rows & results.beyond_data(column)).sum())
    return {"column": column, "effect": effect, "beyond": beyond, "of": int(rows.sum())}


def _of_pairs(results: Results, column: str, effect: Effect, rows: np.ndarray) -> Finding | None:
    """Return the median change of cases that differ in one factor only; None where it changes nothing."""
    parts = [p for p in effects.strata(results, column, effect, rows) if p[2].size >= effects.FEWEST_PAIRS]
    against = [p for p in parts if (p[2].ratio - 1) * (effect.ratio - 1) < 0]
    if not against and not _changes(effect):
        return None
    same = effect.rising if effect.ratio > 1 else effect.falling
    folds = [np.log(p[2].ratio) for p in _most_spread(parts)]
    apart = bool(folds) and max(folds) - min(folds) > np.log(APART) and bool(np.isfinite(folds).all())
    values = _values(results, column, effect, rows) | {
        "parts": parts,
        "same": same,
        "against": bool(against),
        "apart": _most_spread(parts) if against or apart else [],
        "changed": effects.also_changed(results, effect.factor, rows),
    }
    kind = "pairs_both" if against or same < effects.MOST * (effect.rising + effect.falling) else "pairs"
    return finding(results, kind, "valid", rows, **values)


def _changes(effect: Effect) -> bool:
    return max(effect.ratio, 1 / effect.ratio) > 1 + effects.UNCHANGED


def _most_spread(parts: list[tuple[str, Any, Effect]]) -> list[tuple[str, Any, Effect]]:
    """Return the effects within the levels of the category whose levels disagree most."""
    spread: dict[str, list[float]] = {}
    for category, _, effect in parts:
        spread.setdefault(category, []).append(np.log(effect.ratio))
    most = max(spread, key=lambda name: max(spread[name]) - min(spread[name]), default="")
    return [part for part in parts if part[0] == most]


def _beyond_chance(effect: Effect, looks: int) -> bool:
    """Return whether a fitted effect is larger than the largest that chance gives one of `looks` factors.

    The interval of one factor is widened so that all of them together hold the truth in 95 % of all samples.
    """
    wider = norm.ppf(1.0 - 0.025 / max(looks, 1)) / norm.ppf(0.975)
    low, high = (effect.ratio * (end / effect.ratio) ** wider for end in effect.interval)
    return bool(low > 1 or high < 1) and _changes(effect)


# where rolling and the model end


def ends(results: Results) -> list[Finding]:
    """Return a finding for each regime other than rolling that occurs: how often, and at which levels."""
    found = [slip_law(results) or regime_of(results, REGIMES.index("full_slip"))]
    found += [regime_of(results, REGIMES.index(name)) for name in ("lift_off", "failed")]
    valid = results.valid
    found += [occurrence(results, rows, name, valid) for name, rows in results.limits_in("exceeded").items()]
    return [one for one in found if one is not None]


def regime_of(results: Results, code: int) -> Finding | None:
    """Say how often a regime occurs and at which levels of the factors; None if it never does."""
    return occurrence(results, results.regime == code, REGIMES[code])


def slip_law(results: Results) -> Finding | None:
    """Say that full slip occurs where the drive exceeds the friction; None unless this holds in all rows.

    A roller that lifts off does not slip.
    """
    hit, lifted = (results.regime == REGIMES.index(name) for name in ("full_slip", "lift_off"))
    margin = slip_margin(results)
    margin = np.where(results.column("motor_force", results.config.base.get("motor_force", np.nan)) == 0, 1.0, margin)
    looked = results.of_one_model()
    hit, over = hit & looked, looked & (margin < -ROUNDING)
    if not hit.any() or np.isnan(margin[looked]).any() or (hit & (margin > ROUNDING)).any():
        return None
    if (over & ~hit & ~lifted).any():
        return None
    values = {"count": int(hit.sum()), "of": int(looked.sum()), "lifted": int((over & lifted).sum())}
    return finding(results, "slip_law", "all", looked, what="full_slip", **values)


def occurrence(results: Results, event: np.ndarray, what: str, among: np.ndarray | None = None) -> Finding | None:
    """Say how often an event occurs and at which levels of the factors.

    That it occurs only at some levels is said of a grid, in which every combination was tried, and of a sample if one
    factor decides all of its cases. Where two factors together confine it, their combinations are named.

    Parameters
    ----------
    event : whether it occurs, shape (n,) bool
    what : name of the event
    among : the valid cases, shape (n,) bool, for an event that is known of these only; default: all cases

    Returns
    -------
    Finding or None
        None if the event never occurs.
    """
    looked = results.of_one_model(among)
    kept = "all" if among is None else "valid"
    hit, whole, cases = event & looked, int(looked.sum()), int((event & looked).sum())
    if not cases:
        return None
    values: dict[str, Any] = {"what": what, "count": cases, "of": whole}
    if cases == whole:
        return finding(results, "everywhere", kept, looked, **values)
    only = [(name, levels, meets(results, name, levels) & looked) for name, levels in confining(results, hit, looked)]
    # a sample carries no more than a law: one factor decides each of its cases
    only = only if results.grid else [one for one in only if cases >= FEW and (one[2] == hit).all()][:1]
    inside = np.logical_and.reduce([looked, *(rows for _, _, rows in only)])
    exact = int(inside.sum()) == cases and all(isinstance(levels, list) for _, levels, _ in only)
    products = [] if only and exact else crossed(results, hit, looked)
    if products:
        return finding(results, "crossed", kept, looked, **values, products=products)
    if not exact and len(only) > 1 and not _alike(results, hit, inside, [name for name, _, _ in only]):
        only, inside = only[:1], only[0][2]
    # few events may share levels by chance, unless all cases at these levels have the event
    if only and (cases >= FEW or exact):
        conditions = [(name, levels) for name, levels, _ in only]
        return finding(results, "only", kept, looked, **values, conditions=conditions, inside=int(inside.sum()))
    if cases < FEW:
        return finding(results, "cases", kept, looked, **values)
    most = most_frequent(results, hit, looked)
    if most is None:
        return finding(results, "share", kept, looked, **values)
    return finding(
        results, "frequent", kept, looked, **values, **dict(zip(("factor", "most", "least"), most, strict=True))
    )


def crossed(results: Results, hit: np.ndarray, among: np.ndarray) -> list[Product]:
    """Return the levels of two factors that together confine an event; of a table only if they decide its cases.

    Labels of a table come first: the reader knows its rows by them.
    """
    if not (results.grid or results.config.method.observed):
        return []
    names = [n for n in results.factors if n not in OPTION_FACTORS and 1 < len(results.levels(n)) <= MOST_LEVELS]
    names.sort(key=lambda name: name in FACTOR_NAMES)
    return confined(results.table, names, hit, among, MOST_PRODUCTS, whole=not results.grid)


def _alike(results: Results, hit: np.ndarray, inside: np.ndarray, names: list[str]) -> bool:
    """Return whether an event occurs in some but not in all cases of each combination of levels."""
    shares = pd.Series(hit[inside]).groupby(codes(results.table[inside], names)).mean()
    return bool(shares.between(0, 1, inclusive="neither").all())


def meets(results: Results, name: str, levels: Any) -> np.ndarray:
    """Mark the cases at one of the levels (a list), or within the bounds (a pair), shape (n,) bool."""
    column = results.table[name]
    if isinstance(levels, tuple):
        return column.between(*levels).to_numpy(bool)
    return column.isin(levels).to_numpy(bool)


def confining(results: Results, hit: np.ndarray, among: np.ndarray) -> list[tuple[str, Any]]:
    """Return at most three factors whose levels confine an event, sorted by the cases that they leave out."""
    by_loss = []
    for name in (f for f in results.factors if f not in OPTION_FACTORS):
        own = results.table[name].to_numpy()
        if results.ordered(name) and len(results.levels(name)) > MOST_LEVELS:
            low, high = float(own[hit].min()), float(own[hit].max())
            levels: Any = (low, high) if results.grid else (_outwards(low, -1), _outwards(high, 1))
        else:
            there = set(own[hit].tolist())
            levels = [v for v in results.levels(name) if v in there]
        outside = among & ~meets(results, name, levels)
        if outside.sum() >= 0.1 * among.sum():
            by_loss.append((int(outside.sum()), name, levels))
    return [(name, levels) for _, name, levels in sorted(by_loss, key=lambda item: -item[0])[:3]]


def _outwards(value: float, way: int) -> float:
    """Round to three figures so that the value stays inside the bound."""
    if value == 0:
        return 0.0
    step = 10.0 ** (np.floor(np.log10(abs(value))) - 2)
    turned = (np.floor if way < 0 else np.ceil)(value / step + way * 1e-9) * step
    return float(f"{turned:.3g}")


def most_frequent(
    results: Results, hit: np.ndarray, among: np.ndarray
) -> tuple[str, tuple[Any, int, int], tuple[Any, int, int]] | None:
    """Return the factor whose levels differ most in the share of hits, and the levels of its largest and least share.

    Each level comes with its number of hits and its number of rows among `among`. The order of the two levels must be
    the same within every category, and no other factor may go with it.
    """
    best = None
    for name in (f for f in results.factors if f not in OPTION_FACTORS):
        levels = results.levels(name)
        if len(levels) > MOST_LEVELS:
            continue
        own = results.table[name].to_numpy()
        cells = [(v, int((hit & (own == v)).sum()), int((among & (own == v)).sum())) for v in levels]
        cells = [cell for cell in cells if cell[2]]
        if len(cells) < 2 or min(cell[2] for cell in cells) < FEW:  # of too few cases a share says nothing
            continue
        high, low = max(cells, key=lambda c: c[1] / c[2]), min(cells, key=lambda c: c[1] / c[2])
        if sum(c[1] * high[2] == high[1] * c[2] for c in cells) > 1:  # of ties none has the most
            continue
        gap = high[1] / high[2] - low[1] / low[2]
        noise = 3 * np.sqrt(sum(k * (n - k) / n**3 for _, k, n in (high, low)))
        larger = gap > max(noise, 0.1) and (best is None or gap > best[0])
        if larger and _shared(results, name, hit, among, (high, low)) and not confounded_with(results, name, among):
            best = gap, name, high, low
    return None if best is None else best[1:]


def _shared(results: Results, name: str, hit: np.ndarray, among: np.ndarray, two: tuple[Any, ...]) -> bool:
    """Return whether the order of two levels is the same within every category (otherwise: Simpson's paradox)."""
    own = results.table[name].to_numpy()
    for category in (c for c in results.categories if c != name):
        values = results.table[category].to_numpy()
        for level in results.levels(category):
            inside = among & (values == level)
            cells = [inside & (own == end[0]) for end in two]
            if all(c.any() for c in cells) and hit[cells[0]].mean() < hit[cells[1]].mean():
                return False
    return True
