"""Sentences on a carriage: the worst roller and its life, lifted rollers, margins, and the catalogue beside them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from trackroller.parameters import REGIME_LABELS, REGIMES
from trackroller.parameters.validity import VALIDITY
from trackroller.report.numbers import lasting
from trackroller.report.words.sentence import Sentence, say
from trackroller.results.solved_cases import SAME_ENDS as SAME
from trackroller.roller.dataset import validity_bit

MARGINS = (("payload", "The payload"), ("loads", "All loads"))
ROLLING = REGIMES.index("rolling")


def worst_place(ds: xr.Dataset) -> tuple[str, str]:
    """Return the worst roller and the load case with most of its damage, or those of the largest radial force."""
    worst = ds.attrs.get("worst_roller")
    if worst:
        damage = ds["damage_per_km"].sel(roller=worst).values
        return str(worst), str(ds["load_case"].values[int(np.argmax(damage))])
    pressed = np.nan_to_num(ds["radial_force"].values, nan=0.0)
    i, j = np.unravel_index(int(np.argmin(pressed)), pressed.shape)
    return str(ds["roller"].values[j]), str(ds["load_case"].values[i])


def sentences(ds: xr.Dataset) -> list[Sentence]:
    """Return what a user asks first: the worst roller and its life, what lifts, margins, and the catalogue.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.carriage`.
    """
    return [
        _worst(ds),
        *_without_life(ds),
        *_unsettled(ds),
        *_lifted(ds),
        *_one_contact(ds),
        *_margins(ds),
        *_catalogue(ds),
        *_flags(ds),
    ]


def _worst(ds: xr.Dataset) -> Sentence:
    roller, case = worst_place(ds)
    if not ds.attrs.get("worst_roller"):
        force = -float(ds["radial_force"].sel(roller=roller, load_case=case))
        return say("carriage", "carriage_largest", roller=roller, case=case, force=force)
    km, hours = (float(ds[name].sel(roller=roller)) for name in ("life_km", "life_hours"))
    unknown = ds["roller"].values[np.isnan(ds["life_km"].values)].tolist()
    low, high = (float(ds[f"life_hours{end}"].sel(roller=roller)) for end in ("_low", "_high"))
    span = [lasting(low, "h"), lasting(high, "h")] if high > low * (1 + SAME) else []
    life = lasting(hours, "h")
    damage = ds["damage_per_km"].sel(roller=roller)
    part = float(damage.sel(load_case=case) / damage.sum())
    values = {"roller": roller, "case": case, "km": km, "life": life, "span": span, "unknown": unknown, "part": part}
    return say("carriage", "carriage_worst", **values)


def _without_life(ds: xr.Dataset) -> Iterator[Sentence]:
    if ds.attrs.get("without_case"):
        yield say("carriage", "carriage_without_case", rollers=ds.attrs["without_case"].split(", "))
    elif "life_km" in ds and not ds.attrs.get("worst_roller"):
        unloaded = bool((ds["radial_force"] == 0).all())
        yield say("carriage", "carriage_no_life", endless=unloaded or not np.isnan(ds["life_km"].values).any())


def _unsettled(ds: xr.Dataset) -> Iterator[Sentence]:
    cases = ds["load_case"].values[~ds["converged"].values].tolist()
    if cases:
        yield say("carriage", "carriage_unsettled", cases=cases)


def _lifted(ds: xr.Dataset) -> Iterator[Sentence]:
    for roller in ds["roller"].values:
        lifted = (ds["radial_force"].sel(roller=roller) == 0).values
        gap = -float(ds["approach"].sel(roller=roller).max())
        if lifted[ds["converged"].values].all() and lifted.any():
            play = str(roller) in ds.attrs.get("with_play", "").split(", ")
            yield say("carriage", "carriage_unloaded", roller=str(roller), gap=max(gap, 0.0), play=play)
        elif lifted.any():
            share, names = float(ds["share"].values[lifted].sum()), ds["load_case"].values[lifted].tolist()
            yield say("carriage", "carriage_lifted", roller=str(roller), cases=names, share=share)


def _one_contact(ds: xr.Dataset) -> Iterator[Sentence]:
    if "roller_regime" not in ds:
        return
    alike: dict[tuple[int, ...], list[str]] = {}  # rollers by their load cases in a regime, which come first
    for roller in ds["roller"].values:
        own = ds["roller_regime"].sel(roller=roller).values
        for regime in sorted({*own.tolist()} - {-1, ROLLING}):
            alike.setdefault((regime, *np.flatnonzero(own == regime).tolist()), []).append(str(roller))
    for (regime, *cases), rollers in alike.items():
        names, label = ds["load_case"].values[cases].tolist(), REGIME_LABELS[regime]
        yield say("carriage", "carriage_one_contact", rollers=rollers, cases=names, regime=label)


def _margins(ds: xr.Dataset) -> Iterator[Sentence]:
    for name, what in MARGINS:
        if f"{name}_to_lift_off" not in ds:  # the forces alone
            continue
        contact = ds[f"{name}_to_one_contact"].values
        before = contact < ds[f"{name}_to_lift_off"].values
        if before.any():
            i = int(np.nanargmin(np.where(before, contact, np.nan)))
            case = str(ds["load_case"].values[i])
            yield say("carriage", "carriage_contact", what=what, multiplier=float(contact[i]), case=case)
        first = np.where(before, np.nan, ds[f"{name}_to_lift_off"].values)  # beyond one contact the model has ended
        if np.isfinite(first).any():
            i = int(np.nanargmin(first))
            tipping = float(ds[f"{name}_to_tipping"].values[i])
            case = str(ds["load_case"].values[i])
            yield say("carriage", "carriage_margin", what=what, lift_off=float(first[i]), tipping=tipping, case=case)


def _catalogue(ds: xr.Dataset) -> Iterator[Sentence]:
    if "load_factor" not in ds:
        return
    factor, life = ds["load_factor"].values, ds["catalogue_life_km"].values
    if np.isnan(factor).all() or np.isnan(life).all():
        return
    i, j = np.unravel_index(int(np.nanargmax(factor)), factor.shape)
    names, k = ds["roller"].values, int(np.nanargmin(life))
    more = {"shortest": str(names[k]), "km": float(life[k]), "case": str(ds["load_case"].values[i])}
    yield say("carriage", "carriage_catalogue", roller=str(names[j]), factor=float(factor[i, j]), **more)


def _flags(ds: xr.Dataset) -> Iterator[Sentence]:
    """Say what limits the lives: each validity flag with its remedy, the rollers and their load cases."""
    if "roller_validity" not in ds:
        return
    for name, flag in VALIDITY.items():
        here = (ds["roller_validity"].values & validity_bit(name)) != 0
        if here.any():
            rollers, cases = ds["roller"].values[here.any(axis=0)], ds["load_case"].values[here.any(axis=1)]
            more = {"rollers": rollers.tolist(), "cases": cases.tolist(), "remedy": flag.remedy}
            yield say("carriage", "carriage_flag", words=flag.words[:1].upper() + flag.words[1:], **more)
