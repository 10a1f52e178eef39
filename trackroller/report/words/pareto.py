"""Sentences on choices: the Pareto set of a study and the design points of an inner/outer design."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from trackroller.analysis.ranking import estimate
from trackroller.analysis.table import StudyView
from trackroller.parameters import PARAMETERS
from trackroller.report.numbers import capital, count, listing, long_name, quantity, rounded, setting, share, with_unit
from trackroller.report.words.sentence import Sentence


def goals_of(front: xr.Dataset) -> list[tuple[str, str]]:
    """List the goals of a Pareto set: (name, 'min' or 'max')."""
    return [tuple(item.split(" ")) for item in front.attrs["objectives"].split(", ")]  # type: ignore[misc]


def pareto(front: xr.Dataset, view: StudyView | None = None) -> Sentence:
    """State the size and the ends of a Pareto set, and how many of its designs lie outside the model.

    Parameters
    ----------
    front : dataset of `trackroller.analysis.pareto.pareto`
    view : the study, for the validity of the designs
    """
    best = np.flatnonzero(front["optimal"].values == 1)
    goals, left = goals_of(front), f"Left out: {front.attrs['excluded']}."
    model = f" The designs are those solved with {front.attrs['model']}." if front.attrs.get("model") else ""
    allowed, kind = count(front.sizes["row"]), str(front.attrs.get("kind", "design"))
    values = {"count": len(best), "of": front.sizes["row"], "ends": []}
    if not len(best):
        return Sentence("pareto", f"No {kind} is left. {left}{model}", values)
    ends = []
    for name, way in goals:
        table = front[name].values[best].astype(float)
        at = int(best[np.argmax(table) if way == "max" else np.argmin(table)])
        ends.append((name, int(front["row"][at]), {g: float(front[g].values[at]) for g, _ in goals}))
    if len(best) == 1:
        told = [f"{goal_words(front, n)} {_goal_value(front, n, ends[0][2][n])}" for n, _ in goals]
        text = f"One of {allowed} allowed {kind}s is best in everything: {listing(told)}."
    else:
        one, two = ends[0], ends[1]
        first = listing([f"{_goal_value(front, g, one[2][g])} {goal_words(front, g)}" for g, _ in goals])
        last = listing([_goal_value(front, g, two[2][g]) for g, _ in goals])
        span = f"from {first} to {last}" if one[2] != two[2] else f"all with {first}"
        text = f"{count(len(best))} of {allowed} allowed {kind}s are Pareto-optimal: {span}."
    if view is not None and kind == "design":
        outside = int((~view.valid[front["row"].values[best]]).sum())
        values["outside"] = outside
        text += f" {count(outside)} of the set lie outside the model." if outside else ""
    return Sentence("pareto", f"{text} {left}{model}", values | {"ends": ends})


def goal_words(front: xr.Dataset, name: str) -> str:
    """Name a goal or a factor of a Pareto set."""
    return str(front[name].attrs.get("long_name") or long_name(name))


def heading(front: xr.Dataset, name: str) -> str:
    """Return the words and the unit of a goal or factor of a Pareto set, as the head of a column."""
    units = str(front[name].attrs.get("units", "")) or (PARAMETERS[name].unit if name in PARAMETERS else "")
    text = capital(goal_words(front, name))
    return with_unit(text, units) if units and units not in ("1", "-") else text


def _goal_value(front: xr.Dataset, name: str, value: float) -> str:
    return quantity(value, str(front[name].attrs.get("units", "1") or "1"))


def robustness(table: xr.Dataset, output: str) -> Sentence:
    """Name the best design point by B10 and how often designs slip or lift off there."""
    part = table.sel(output=output)
    words, safe = str(part["output_name"].item()), part["b10_safe"].values
    if not (np.isfinite(safe) | np.isposinf(safe)).any():
        return Sentence("no_b10", f"No B10 can be given for {words}.", {"output": output})
    b10s = np.nan_to_num(part["b10"].values, nan=-1.0)
    key = np.lexsort((-b10s, -np.nan_to_num(safe, nan=-1.0)))
    best = int(key[0])
    slip, lift = (table["probability"].sel(regime=r).values for r in ("full_slip", "lift_off"))
    b10, low, high = map(float, estimate(part, "b10")[:, best])
    unit = "overrollings" if words.endswith("overrollings") else str(part["output_units"].item())
    limited = bool(table.attrs.get("constrained", 0))
    still = float(table["probability"].sel(regime="rolling").values[best]) == 1.0 and not limited
    kind = "rolling cases that meet the constraints" if limited else "cases" if still else "rolling cases"
    text = (
        f"Best B10 of the {words}: at {point_words(table, best)} nine of ten {kind} "
        f"reach {quantity(b10, unit)} (95 % interval {rounded(low)} to {rounded(high)})"
    )
    if not still and safe[best] > 0:
        text += f"; with every other case counted as life 0 it is {quantity(float(safe[best]), unit)}"
    elif not still:
        missed = " or miss a constraint" if limited else ""
        text += (
            f"; one in ten or more of all cases do not roll{missed}, and with these counted as life 0 there is no B10"
        )
    text += f"; full slip there in {chance(slip[best])} and lift-off in {chance(lift[best])} of the cases"
    values = {"output": output, "point": best, "b10": b10, "safe": float(safe[best])}
    worst = int(np.argmax(slip + lift))
    if slip[worst] + lift[worst] > slip[best] + lift[best]:
        text += f", at most in {chance(slip[worst] + lift[worst])} ({point_words(table, worst)})"
        values["worst"] = worst
    return Sentence("robust", f"{text}.", values)


def chance(value: float, low: float = math.nan, high: float = math.nan, words: str = "") -> str:
    """Write a probability: '97 %' or '97 % (95 % to 98 %)', with more figures near 0 (never) and 100 % (always)."""
    whole = 10**9
    if math.isnan(value):
        return "–"
    text, *ends = (share(round(v * whole), whole) for v in (value, low, high) if math.isfinite(v))
    return f"{text} ({words}{' to '.join(ends)})" if ends else text


def point_words(table: xr.Dataset, point: int) -> str:
    """Name a design point: 'profile ratio 1.1, contact angle 30°'."""
    names = [n for n in str(table.attrs.get("outer_factors", "")).split(", ") if n]
    values = [table[name].values[point] for name in names]
    said = [setting(n, v if isinstance(v, str) else float(v)) for n, v in zip(names, values, strict=True)]
    return ", ".join(said) or "the one design point"
