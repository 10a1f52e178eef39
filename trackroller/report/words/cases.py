"""Sentences on the cases of a study: which are valid, where events occur, the best design, stresses, known errors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from trackroller.analysis.table import BODIES, MOST_LEVELS, OUTSIDE, StudyView
from trackroller.parameters import REGIME_LABELS
from trackroller.report.numbers import count, level_text, listing, long_name, number, quantity, setting, share
from trackroller.report.words.flags import OF_BODY, of_body, words_of
from trackroller.report.words.sentence import Sentence

FEW = 20  # fewer events are named one by one, without a cause
CONDITIONS = ("radial_force", "axial_force", "motor_force", "friction_coefficient", "velocity", "guide_curve_radius")


def valid_designs(view: StudyView) -> Sentence:
    """Say how many designs roll, stay inside the model and meet the constraints, and why the others do not."""
    total, rolls, inside, valid = len(view.table), *(int(m.sum()) for m in (view.rolling, view.inside, view.valid))
    lost = {REGIME_LABELS[c]: int((view.regime == c).sum()) for c in (1, 2, 3)}
    lost["not converged"] = int(((view.regime == 0) & ~view.rolling).sum())
    why = ", ".join(f"{count(n)} {words}" for words, n in lost.items() if n)
    text = f"{count(rolls)} of {count(total)} designs roll{f' (the others: {why})' if why else ''}"
    reasons = [(flag, body, int(hit.sum())) for flag, body, hit in _outside(view) if hit.any()]
    if not rolls:
        text += "."
    elif not view.flags:
        text += "; the data set carries no validity flags."
    elif inside == rolls:
        text += "; all of them lie inside the model."
    else:
        kept = f"{count(inside)} of them stay" if inside else "none of them stays"
        text += f"; {kept} inside the model: elsewhere {_reason_words(reasons)}."
    if inside and view.met is not None:
        told = listing([f"`{limit}`" for limit in view.study["constraints"]])
        text += f" {count(valid) if valid else 'None'} of the {count(inside)} meet {told}."
    if valid and valid < rolls:
        text += f" Statements on life and stress use the {count(valid)} unless they name another set"
        text += "; sensitivity indices also count the designs outside the model." if inside < rolls else "."
    values = {"total": total, "rolling": rolls, "inside": inside, "valid": valid, "lost": lost, "reasons": reasons}
    return Sentence("valid", text, values, np.ones(total, dtype=bool))


def _outside(view: StudyView) -> list[tuple[str, str, np.ndarray]]:
    """Return the rolling cases outside the model by flag, and by body if the data set has flags of bodies."""
    found = []
    for flag in (f for f in OUTSIDE if f in view.flags):
        for body in BODIES if view.by_body and flag in OF_BODY else ("",):
            found.append((flag, body, view.flagged(flag, body) & view.rolling))
    return found


def _reason_words(reasons: Sequence[tuple[str, str, int]]) -> str:
    said: dict[str, list[str]] = {}
    for flag, body, cases in reasons:
        said.setdefault(flag, []).append(f"{of_body(flag, body)} ({count(cases)})".lstrip())
    return listing([f"{words_of(flag)} {' or '.join(where)}" for flag, where in said.items()], "or")


def occurrence(view: StudyView, hit: np.ndarray, what: str, among: np.ndarray | None = None) -> Sentence | None:
    """Say how often an event occurs and at which levels of the factors.

    None if it never does.

    Parameters
    ----------
    hit : whether the event occurs, shape (n,) bool
    what : the event as the subject of the sentence, 'Full slip'
    among : the cases that are looked at, shape (n,) bool; all if not given
    """
    among = np.ones(len(hit), dtype=bool) if among is None else among
    hit, whole, cases = hit & among, int(among.sum()), int((hit & among).sum())
    if not cases:
        return None
    values: dict[str, Any] = {"count": cases, "of": whole}
    if cases == whole:
        return Sentence("everywhere", f"{what} occurs in all {count(whole)} designs.", values, among)
    if cases < FEW:
        named = [int(i) for i in np.flatnonzero(hit)]
        text = f"{what} occurs in {cases} of {count(whole)} designs: case{'s' * (cases > 1)} "
        return Sentence("cases", f"{text}{listing([str(i) for i in named])}.", values | {"cases": named}, among)
    head = f"{what} occurs in {count(cases)} of {count(whole)} designs ({share(cases, whole)})"
    only = _confined(view, hit, among)
    if only:
        inside = among.copy()
        for name, levels in only:
            inside &= meets(view, name, levels)
        met = int(inside.sum())
        places = listing([f"at {_levels_words(view, name, levels)}" for name, levels in only])
        there = "all" if met == cases else f"{count(cases)} of the {count(met)}"
        text = f"{head}, only {places}: in {there} designs there."
        return Sentence("only", text, values | {"conditions": only, "inside": met}, among)
    most = _most_frequent(view, hit, among)
    if most is None:
        return Sentence("share", f"{head}.", values, among)
    name, high, low = most
    told = [f"{setting(name, level)} ({count(k)} of {count(n)} designs)" for level, k, n in (high, low)]
    text = f"{head}, most often at {told[0]} and least at {told[1]}."
    return Sentence("frequent", text, values | {"factor": name, "most": high, "least": low}, among)


def meets(view: StudyView, name: str, levels: Any) -> np.ndarray:
    """Mark the cases at one of the levels (a list), or within the bounds (a pair), shape (n,) bool."""
    column = view.table[name]
    if isinstance(levels, tuple):
        return ((column >= levels[0]) & (column <= levels[1])).to_numpy()
    return column.isin(levels).to_numpy()


def _confined(view: StudyView, hit: np.ndarray, among: np.ndarray) -> list[tuple[str, Any]]:
    """Return at most three factors whose levels confine an event, sorted by the cases that they leave out."""
    found = []
    for name in view.factors:
        own = view.table[name].to_numpy()
        if view.ordered(name) and len(view.levels(name)) > MOST_LEVELS:
            low, high = float(own[hit].min()), float(own[hit].max())
            levels: Any = (_outwards(low, -1), _outwards(high, 1))
        else:
            there = set(own[hit].tolist())
            levels = [v for v in view.levels(name) if v in there]
        outside = among & ~meets(view, name, levels)
        if outside.sum() >= 0.1 * among.sum():
            found.append((int(outside.sum()), name, levels))
    return [(name, levels) for _, name, levels in sorted(found, key=lambda item: -item[0])[:3]]


def _outwards(value: float, way: int) -> float:
    """Round to three figures so that the value stays inside the bound."""
    if value == 0:
        return 0.0
    step = 10.0 ** (np.floor(np.log10(abs(value))) - 2)
    turned = (np.floor if way < 0 else np.ceil)(value / step + way * 1e-9) * step
    return float(f"{turned:.3g}")


def _levels_words(view: StudyView, name: str, levels: Any) -> str:
    if isinstance(levels, tuple):
        own = view.table[name]
        low, high = levels
        if low <= own.min():
            return f"{long_name(name)} up to {level_text(name, high, words=False)}"
        if high >= own.max():
            return f"{long_name(name)} from {level_text(name, low, words=False)} up"
        return f"{long_name(name)} {number(low)} to {level_text(name, high, words=False)}"
    first = setting(name, levels[0])
    return listing([first, *(level_text(name, v) for v in levels[1:])], "or")


def _most_frequent(
    view: StudyView, hit: np.ndarray, among: np.ndarray
) -> tuple[str, tuple[Any, int, int], tuple[Any, int, int]] | None:
    """Return the factor whose levels differ most in the share of hits, and the levels of its largest and least share.

    Each level comes with its number of hits and its number of rows among `among`. The order of the two levels must be
    the same within every category.
    """
    best = None
    for name in view.factors:
        levels = view.levels(name)
        if len(levels) > MOST_LEVELS:
            continue
        own = view.table[name].to_numpy()
        cells = [(v, int((hit & (own == v)).sum()), int((among & (own == v)).sum())) for v in levels]
        cells = [cell for cell in cells if cell[2] >= FEW]
        if len(cells) < 2:
            continue
        high, low = max(cells, key=lambda c: c[1] / c[2]), min(cells, key=lambda c: c[1] / c[2])
        gap = high[1] / high[2] - low[1] / low[2]
        noise = 3 * np.sqrt(sum(k * (n - k) / n**3 for _, k, n in (high, low)))
        if gap > max(noise, 0.1) and (best is None or gap > best[0]) and _shared(view, name, hit, among, (high, low)):
            best = gap, name, high, low
    return None if best is None else best[1:]


def _shared(view: StudyView, name: str, hit: np.ndarray, among: np.ndarray, ends: tuple) -> bool:
    """Return whether the order of two levels is the same within every category (otherwise: Simpson's paradox)."""
    own = view.table[name].to_numpy()
    for category in (c for c in view.categories if c != name):
        values = view.table[category].to_numpy()
        for level in view.levels(category):
            inside = among & (values == level)
            cells = [inside & (own == end[0]) for end in ends]
            if all(c.any() for c in cells) and hit[cells[0]].mean() < hit[cells[1]].mean():
                return False
    return True


def best_design(view: StudyView) -> Sentence | None:
    """Name the valid design with the longest life, and its life under the worst conditions."""
    found = ranked(view)
    if found is None or not view.life:
        return None
    column, words, unit = view.life
    life, best = view.column(column), int(found[0])
    ties = int((life[found] == life[best]).sum())
    design = [f for f in view.factors if f not in CONDITIONS and f != "contact_model"]
    use = [f for f in view.factors if f in CONDITIONS]
    where = ", ".join(setting(f, view.table[f].iloc[best]) for f in (*design, *use))
    place = f"case {best}" + (f", one of {count(ties)} with this life" if ties > 1 else "")
    text = f"Longest valid {words}: {quantity(life[best], unit)}{f' with {where}' if where else ''} ({place})."
    values: dict[str, Any] = {"case": best, "life": float(life[best]), "ties": ties, "column": column}
    if design and use:
        same = np.isin(np.arange(len(life)), found)
        for name in design:
            same &= (view.table[name] == view.table[name].iloc[best]).to_numpy()
        worst = int(np.flatnonzero(same)[np.argmin(life[same])])
        if life[worst] < life[best]:
            there = ", ".join(
                setting(f, view.table[f].iloc[worst])
                for f in use
                if view.table[f].iloc[worst] != view.table[f].iloc[best]
            )
            text += f" With {there} the same roller lasts {quantity(life[worst], unit)} (case {worst})."
            values |= {"worst": worst, "worst_life": float(life[worst]), "design": design}
    return Sentence("best", text, values, np.isin(np.arange(len(life)), found))


def ranked(view: StudyView) -> np.ndarray | None:
    """Return the valid cases by falling life (else by rising peak stress), or None when nothing ranks them.

    Of a study with several contact models only the cases of the most exact model rank, because a model is not a design
    choice. The cases of an inner/outer design do not rank, because scattering values cannot be chosen: B10 ranks its
    design points.
    """
    if view.study.get("design") == "inner_outer":
        return None
    rows, columns = view.valid.copy(), [f"peak_stress_{b}" for b in BODIES if view.has(f"peak_stress_{b}")]
    if "contact_model" in view.factors:
        rows &= (view.table["contact_model"] == view.held_level("contact_model")).to_numpy()
    keys = [-view.column(view.life[0])] if view.life else []
    keys += [view.column(c) for c in columns]
    if not keys:
        return None
    rows &= ~np.isnan(keys[0])
    if not rows.any():
        return None
    index = np.flatnonzero(rows)
    return index[np.lexsort([np.nan_to_num(k[index], posinf=np.inf, neginf=-np.inf) for k in keys[::-1]])]


def extremes(view: StudyView, column: str, words: str, unit: str, shown: Sequence[str], rows: np.ndarray) -> Sentence:
    """Name the shortest and the longest life of the cases shown, and where they are."""
    values = view.column(column)
    good = np.flatnonzero(rows & np.isfinite(values))
    if not good.size:
        return Sentence("none", "No valid design shown here has a finite life.", {}, rows)
    low, high = int(good[np.argmin(values[good])]), int(good[np.argmax(values[good])])
    at = [listing([setting(f, view.table[f].iloc[i]) for f in shown]) for i in (low, high)]
    ends = [f"{quantity(values[i], unit)} at {place}" for i, place in zip((low, high), at, strict=True)]
    text = f"The {words} of the valid designs shown lies between {' and '.join(ends)}."
    if good.size == 1:
        text = f"One valid design shown here has a finite {words}: {ends[0]}."
    endless = int((rows & np.isposinf(values)).sum())
    text += f" {count(endless)} more designs have an unlimited life." if endless else ""
    told = {"column": column, "low": low, "high": high, "unlimited": endless}
    return Sentence("extremes", text, told, rows)


def surface(view: StudyView, body: str, rows: np.ndarray) -> Sentence | None:
    """Say in how many designs the peak stress of a body lies at the surface."""
    flags = view.column(f"at_surface_{body}")
    known, hit = int((rows & ~np.isnan(flags)).sum()), int((rows & (flags == 1)).sum())
    if not known:
        return None
    where = f"at the surface in {count(hit)} of {count(known)} valid designs ({share(hit, known)})"
    if hit in (0, known):
        where = f"{'at' if hit else 'below'} the surface in all {count(known)} valid designs"
    text = f"The peak stress of the {body} lies {where}."
    return Sentence("surface", text, {"body": body, "count": hit, "of": known}, rows)


def strength(body: str, stress: np.ndarray, limit: np.ndarray, most: np.ndarray, rows: np.ndarray) -> Sentence | None:
    """Say how many rolling designs stay below the fatigue limit of a body and how many exceed its tensile strength.

    Parameters
    ----------
    stress, limit, most : peak stress, fatigue limit and tensile strength [MPa], shape (n,)
    rows : rolling cases, shape (n,) bool
    """
    rows = rows & np.isfinite(stress) & np.isfinite(limit)
    of, below, above = (int(part.sum()) for part in (rows, rows & (stress < limit), rows & (stress > most)))
    if not of:
        return None
    first = f"{share(below, of)} of the {count(of)} rolling designs stay" if below else "No rolling design stays"
    text = f"{first} below the fatigue limit of the {body}"
    text += f"; {share(above, of)} exceed its tensile strength and have no fatigue life" if above else ""
    return Sentence("strength", f"{text}.", {"body": body, "of": of, "below": below, "above": above}, rows)


def lift_off(view: StudyView) -> Sentence | None:
    """Say how many designs lift off and from which axial force on."""
    lifted = view.regime == 2
    axial = np.abs(view.column("axial_force"))
    if not lifted.any() or np.isnan(axial[lifted]).any():
        return None
    cases, least = int(lifted.sum()), float(axial[lifted].min())
    text = f"{count(cases)} of {count(len(lifted))} designs lift off; the smallest axial force among them is "
    values = {"count": cases, "least": least}
    return Sentence("lift_off", f"{text}{number(least)} N.", values, np.ones(len(lifted), dtype=bool))
