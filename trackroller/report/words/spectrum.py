"""Sentences on a load spectrum: the life of each body, the track that fails first and the worst block."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS
from trackroller.damage.verdict import STATES
from trackroller.parameters import BODIES, REGIME_LABELS, REGIMES
from trackroller.report.numbers import between, life_range, listing, rounded
from trackroller.report.words.accuracy import not_judged
from trackroller.report.words.sentence import Sentence, say
from trackroller.results.lives import past_data
from trackroller.roller.dataset import validity_bit
from trackroller.roller.limit_notes import placeholders_of

UNITS = (("hours", "h"), ("km", "km"), ("shifts", "shifts"))
TIED = 1e-9  # relative difference of lives that count as equal


def known_damage(ds: xr.Dataset, body: str) -> tuple[int, np.ndarray]:
    """Return the contact whose track takes more damage in the blocks with known damage, and the damage of each block.

    The damage has the shape (blocks,), NaN where it is not known.
    """
    damage = ds["damage"].sel(body=body).transpose("block", "contact").values
    most = int(np.argmax(np.nansum(damage, axis=0)))
    return int(ds["contact"].values[most]), damage[:, most]


def sentences(ds: xr.Dataset) -> list[Sentence]:
    """Return what a spectrum says of roller and guide, the life of the pair to its first limit at the head.

    Blocks that the model does not judge stand before it. Limits that are exceeded or open stand behind it, or before
    all lives where a body breaks. Then follow the first limit of the other body, and for each body its life by fatigue,
    the track that fails first and the block with the most damage. Without limits only fatigue is known.
    """
    by_fatigue = [_sentence(ds, body) for body in BODIES]
    outside = _outside(ds)
    if "limiting_mechanism" not in ds:
        return [*outside, *by_fatigue]
    lives = {body: float(ds["life_to_first_limit_hours_low"].sel(body=body)) for body in BODIES}
    sooner, later = sorted(BODIES, key=lambda body: (np.isnan(lives[body]), lives[body]))
    head = _first_limit(ds, sooner, of_pair=True, unknown=later if np.isnan(lives[later]) else "")
    if head.kind != "spectrum_pair":  # why no life is known or left stands in the sentences on fatigue
        states, listed = _states(ds), ds["limit"].values.tolist()
        state = ds["limit_state"]
        breaks = "static" in listed and bool((state.sel(limit="static") == STATES.index("exceeded")).any())
        first, after = (states, []) if breaks else ([], states)
        return [*outside, *first, *by_fatigue, *after, *(_first_limit(ds, body) for body in BODIES)]
    return [*outside, head, *_states(ds), _first_limit(ds, later), *by_fatigue]


def _outside(ds: xr.Dataset) -> list[Sentence]:
    """Name the blocks that the model does not judge, and why."""
    blocks: dict[str, list[str]] = {}
    for i, name in enumerate(ds["block"].values):
        if float(ds["distance"][i]) > 0:
            for reason in not_judged(ds.isel(block=i)):
                blocks.setdefault(reason, []).append(f"'{name}'")
    return [say("spectrum", "spectrum_outside", blocks=blocks)] if blocks else []


def _states(ds: xr.Dataset) -> list[Sentence]:
    """Name the limits without hours that are exceeded or open, the most that a block uses, and the blocks."""
    travelled = ds["distance"].values > 0
    flags = {body: np.zeros(len(travelled), dtype=int) for body in BODIES}
    if "validity_body" in ds:
        flags = {body: np.where(travelled, ds["validity_body"].sel(body=body).values, 0) for body in BODIES}
    found: dict[str, list[str]] = {"exceeded": [], "open": []}
    for body in BODIES:
        for limit in (LIMITS[name] for name in ds["limit"].values.tolist()):
            own = ds[["limit_state", "limit_state_of_block", "utilisation"]].sel(limit=limit.name, body=body)
            worst, used = STATES[int(own["limit_state"])], 100.0 * float(own["utilisation"])
            if limit.bounded and not limit.beside and worst in found:
                words = f"{limit.title.partition(' (')[0]} of the {body}"
                words += "" if np.isnan(used) else f", {rounded(used)} %"  # of an unsolved block it is not known
                here = own["limit_state_of_block"].values == STATES.index(worst)
                found[worst].append(f"{words} in {_blocks(ds, here)}")
        yields = (flags[body] & validity_bit("yield")) != 0
        if yields.any():
            found["exceeded"].append(f"pressure limit of the {body} in {_blocks(ds, yields)}")
    return [say("spectrum", "spectrum_states", **found)] if any(found.values()) else []


def _blocks(ds: xr.Dataset, here: np.ndarray) -> str:
    return listing([f"'{name}'" for name in ds["block"].values[here]])


def _first_limit(ds: xr.Dataset, body: str, of_pair: bool = False, unknown: str = "") -> Sentence:
    """Return the first limit of a body, as that of the pair if it is; the hours of the body `unknown` are not known."""
    own, names = ds.sel(body=body), str(ds["limiting_mechanism"].attrs["flag_meanings"]).split()
    name, shifts = names[int(own["limiting_mechanism"])], float(own["life_to_first_limit_shifts"])
    if name not in LIMITS:
        return say("spectrum", "spectrum_no_limit", body=body)
    own = own.sel(limit=name)
    values = {"body": body, "limit": name, "title": LIMITS[name].title, "shifts": shifts, "block": ""}
    first = "pair_life_to_first_limit_hours" if of_pair and not unknown else "life_to_first_limit_hours"
    ends = (ds[f"{first}{end}"] for end in ("_low", "_high"))
    low, high = (float(end.sel(body=body) if "body" in end.dims else end) for end in ends)
    km = float(ds["distance"].sum() / ds["duration"].sum()) / 1e3
    values |= {"hours": between(low, high), "km": life_range(low * km, high * km)}
    if np.isnan(own["life_shifts_by_limit"]) or shifts == 0.0:
        return say("spectrum", "spectrum_limit", **values, used=100.0 * float(own["utilisation"]))
    damage = own["damage_by_limit"].values
    worst = int(np.nanargmax(damage))
    values |= {"block": str(ds["block"].values[worst]), "share": float(damage[worst] / damage.sum())}
    others = _within(ds, BODIES if of_pair else (body,), high, (name, body)) if low < high * (1.0 - TIED) else []
    guesses = {one.limit for one in placeholders_of(ds)}
    values["guessed"] = low < high * (1.0 - TIED) and not guesses.isdisjoint({name, *(limit for limit, _ in others)})
    lives = ds["life_shifts_by_limit"]
    values["beyond"] = any(
        limit == "fatigue" and _beyond(ds, b, float(lives.sel(limit=limit, body=b)))
        for limit, b in ((name, body), *others)
    )
    values["others"] = [(LIMITS[limit].title, b) for limit, b in others]
    if of_pair:
        return say("spectrum", "spectrum_pair", **values, unknown=unknown)
    return say("spectrum", "spectrum_limit", **values)


def _within(ds: xr.Dataset, bodies: tuple[str, ...], high: float, but: tuple[str, str]) -> list[tuple[str, str]]:
    """Return the limits and bodies, except one, whose life may end by `high` [h] within its range."""
    low = ds["life_hours_by_limit_low"]
    low = low.where(np.isfinite(low))  # a limit that is never reached ends no life
    pairs = ((name, body) for body in bodies for name in ds["limit"].values.tolist() if not LIMITS[name].beside)
    return [p for p in pairs if p != but and float(low.sel(limit=p[0], body=p[1])) <= high * (1.0 + TIED)]


def _sentence(ds: xr.Dataset, body: str) -> Sentence:
    shifts, (contact, damage) = ds["life_shifts"].sel(body=body), known_damage(ds, body)
    values = {"body": body, "contact": contact}
    if bool(shifts.isnull().any()):
        return say("spectrum", "spectrum_unknown", **values, **_unknown(ds, body, damage))
    if bool(np.isinf(shifts).all()):
        return say("spectrum", "spectrum_unlimited", body=body)
    worst = int(np.argmax(damage))
    lives = {name: float(ds[f"{body}_life_{name}"]) for name, _ in UNITS}
    values |= {"block": str(ds["block"].values[worst]), "share": float(damage[worst] / damage.sum())}
    return say("spectrum", "spectrum", **values, **lives, beyond=_beyond(ds, body, lives["shifts"]))


def _unknown(ds: xr.Dataset, body: str, damage: np.ndarray) -> dict[str, Any]:
    """Return why a body has no known life, and the longest life that the damage of the other blocks allows.

    `at_most` is this life [h]; it is 0 if the known blocks do no damage and so set no bound.
    """
    unknown, known = ds["damage"].sel(body=body).isnull().any("contact").values, float(np.nansum(damage))
    names, regime = ds["block"].values.astype(str)[unknown], ds["regime"].values.astype(int)[unknown]
    skids, breaks = regime == REGIMES.index("full_slip"), np.zeros(len(names), dtype=bool)
    if "validity_body" in ds:
        breaks = (ds["validity_body"].sel(body=body).values[unknown] & validity_bit("static")) != 0
    unsolved = np.isnan(ds["peak_stress"].sel(body=body).transpose("block", "contact").values[unknown]).any(axis=1)
    return {
        "unmoved": not (skids | breaks | unsolved).any(),
        "unsolved": [f"'{n}' ({REGIME_LABELS[r]})" for n, r in zip(names[unsolved], regime[unsolved], strict=True)],
        "breaks": [f"'{name}'" for name in names[breaks]],
        "skids": [f"'{name}'" for name in names[skids & ~breaks]],
        "at_most": ds.attrs["critical_damage"] / known * float(ds["duration"].sum()) if known > 0 else 0.0,
    }


def _beyond(ds: xr.Dataset, body: str, shifts: float) -> bool:
    """Say whether a body lasts more overrollings than its fatigue limit or the S-N data reach."""
    material = json.loads(str(ds.attrs.get("materials", "{}"))).get(f"{body}_material", {})
    cycles = shifts * float(ds["overrollings"].sel(body=body).sum())
    return bool(past_data(cycles, float(material.get("cycles_at_fatigue_limit", np.inf))))
