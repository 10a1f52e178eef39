"""Sentences on a load spectrum: the life of each body, the track that fails first and the worst block."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS
from trackroller.parameters import BODIES, REGIME_LABELS, REGIMES
from trackroller.report.numbers import between, life_range
from trackroller.report.words.sentence import Sentence, say
from trackroller.results.lives import past_data
from trackroller.roller.dataset import validity_bit

UNITS = (("hours", "h"), ("km", "km"), ("shifts", "shifts"))


def known_damage(ds: xr.Dataset, body: str) -> tuple[int, np.ndarray]:
    """Return the contact whose track takes more damage in the blocks with known damage, and the damage of each block.

    The damage has the shape (blocks,), NaN where it is not known.
    """
    damage = ds["damage"].sel(body=body).transpose("block", "contact").values
    most = int(np.argmax(np.nansum(damage, axis=0)))
    return int(ds["contact"].values[most]), damage[:, most]


def sentences(ds: xr.Dataset) -> list[Sentence]:
    """Return what a spectrum says of roller and guide, the life of the pair to its first limit at the head.

    Then follow the first limit of the other body, and for each body its life by fatigue, the track that fails first and
    the block with the most damage. Without limits only fatigue is known.
    """
    by_fatigue = [_sentence(ds, body) for body in BODIES]
    if "limiting_mechanism" not in ds:
        return by_fatigue
    lives = {body: float(ds["life_to_first_limit_hours_low"].sel(body=body)) for body in BODIES}
    sooner, later = sorted(BODIES, key=lambda body: (np.isnan(lives[body]), lives[body]))
    head = _first_limit(ds, sooner, of_pair=True, unknown=later if np.isnan(lives[later]) else "")
    if head.kind != "spectrum_pair":  # why no life is known or left stands in the sentences on fatigue
        return [*by_fatigue, *(_first_limit(ds, body) for body in BODIES)]
    return [head, _first_limit(ds, later), *by_fatigue]


def _first_limit(ds: xr.Dataset, body: str, of_pair: bool = False, unknown: str = "") -> Sentence:
    """Return the first limit of a body, as that of the pair if it is; the hours of the body `unknown` are not known."""
    own, names = ds.sel(body=body), str(ds["limiting_mechanism"].attrs["flag_meanings"]).split()
    name, shifts = names[int(own["limiting_mechanism"])], float(own["life_to_first_limit_shifts"])
    if name not in LIMITS:
        return say("spectrum", "spectrum_no_limit", body=body)
    own = own.sel(limit=name)
    values = {"body": body, "limit": name, "title": LIMITS[name].title, "shifts": shifts, "block": ""}
    low, high = (float(own[f"life_to_first_limit_hours{end}"]) for end in ("_low", "_high"))
    km = float(ds["distance"].sum() / ds["duration"].sum()) / 1e3
    values |= {"hours": between(low, high), "km": life_range(low * km, high * km)}
    if np.isnan(own["life_shifts_by_limit"]) or shifts == 0.0:
        return say("spectrum", "spectrum_limit", **values, used=100.0 * float(own["utilisation"]))
    damage = own["damage_by_limit"].values
    worst = int(np.nanargmax(damage))
    values |= {"block": str(ds["block"].values[worst]), "share": float(damage[worst] / damage.sum())}
    if of_pair:
        beyond = name == "fatigue" and _beyond(ds, body, shifts)
        return say("spectrum", "spectrum_pair", **values, beyond=beyond, unknown=unknown)
    return say("spectrum", "spectrum_limit", **values)


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
