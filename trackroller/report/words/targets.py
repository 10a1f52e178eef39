"""Sentences on the targets of a study: how probable it is that a case meets each of them."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.analysis.ranking import estimate
from trackroller.analysis.targets import most_apart
from trackroller.report.numbers import chance, level_text, long_name, number, quantity, setting
from trackroller.report.words.sentence import Sentence, phrase, say

SAME = 1e-6  # probabilities that differ by less are called the same
INTERVAL = "95 % interval "
WHOLE = {"grid": "cases of the grid", "table": "cases of the table"}  # designs of experiments without an interval


def target_words(table: xr.Dataset, target: int) -> str:
    """Name a target: 'life of the roller of at least 500 h', 'slip from 0.1 to 0.2', 'all targets'."""
    part = table.isel(target=target)
    name, unit = str(part["target_name"].item()), str(part["target_units"].item())
    low, high = float(part["target_min"]), float(part["target_max"])
    if np.isfinite(low) and np.isfinite(high):
        return f"{name} from {quantity(low, unit)} to {quantity(high, unit)}"
    if np.isfinite(low):
        return f"{name} of at least {quantity(low, unit)}"
    return f"{name} of at most {quantity(high, unit)}" if np.isfinite(high) else name


def target(table: xr.Dataset, number: int) -> Sentence:
    """State how probable it is to meet a target at the best and the worst design point, or in all cases.

    Then name the factor whose levels differ most, where their intervals lie apart.

    Parameters
    ----------
    table : analysis with the variables of `trackroller.analysis.targets.targets`
    number : of the target
    """
    part = table.isel(target=number)
    share, low, high = np.atleast_2d(estimate(part, "target_probability").T).T
    order = [int(np.argmax(share)), int(np.argmin(share))]
    robust = "point" in part["target_probability"].dims
    most = most_apart(part)
    return say(
        "targets",
        "target",
        what=target_words(table, number),
        whole="" if robust or np.isfinite(low).all() else WHOLE.get(str(table.attrs.get("method")), "cases"),
        many=len(share) if robust else None,
        same=bool(np.ptp(share) < SAME),
        chances=[chance(share[i], low[i], high[i], INTERVAL) for i in order],
        points=[point_words(table, i) for i in order] if robust else [],
        changes=long_name(str(part["level_factor"][most[0]].item())) if most else "",
        ends=[f"{_cell(part, 'level', i)} at {_level_words(part, i)}" for i in most or ()],
    )


def _cell(part: xr.Dataset, kind: str, place: int | None) -> str:
    estimates = estimate(part, f"{kind}_probability")
    return chance(*(estimates if place is None else estimates[:, place]))


def _level_words(part: xr.Dataset, level: int) -> str:
    """Name a level, or the range of a class: 'friction coefficient 0.1 to 0.15'."""
    name, text = str(part["level_factor"][level].item()), str(part["level_text"][level].item())
    low, high = float(part["level_low"][level]), float(part["level_high"][level])
    if text or low == high:
        return setting(name, text or low)
    return f"{long_name(name)} {number(low)} to {level_text(name, high, words=False)}"


def samples_of_points(table: xr.Dataset) -> str:
    """Say how many samples the design points have."""
    low, high = (int(end(table["point_samples"])) for end in (np.min, np.max))
    return phrase("targets", "samples_of_points", low=low, high=high)


def point_words(table: xr.Dataset, point: int) -> str:
    """Name a design point: 'profile ratio 1.1, contact angle 30°'."""
    names = [n for n in str(table.attrs.get("outer_factors", "")).split(", ") if n]
    values = [table[name].values[point] for name in names]
    said = [setting(n, v if isinstance(v, str) else float(v)) for n, v in zip(names, values, strict=True)]
    return ", ".join(said) or "the one design point"
