"""Sentences on a load spectrum: the life of each body, the track that fails first and the worst block."""

from __future__ import annotations

import json

import numpy as np
import xarray as xr

from trackroller.analysis.lives import past_data
from trackroller.damage import LIMITS
from trackroller.parameters import BODIES, REGIME_LABELS
from trackroller.report.numbers import BEYOND, chance, life, life_unit, listing, rounded
from trackroller.report.words.sentence import Sentence

UNITS = (("shifts", "shifts"), ("km", "km"), ("hours", "h"))


def known_damage(ds: xr.Dataset, body: str) -> tuple[int, np.ndarray]:
    """Return the contact whose track takes more damage in the blocks with known damage, and the damage of each block.

    The damage has the shape (blocks,), NaN where it is not known.
    """
    damage = ds["damage"].sel(body=body).transpose("block", "contact").values
    most = int(np.argmax(np.nansum(damage, axis=0)))
    return int(ds["contact"].values[most]), damage[:, most]


def sentences(ds: xr.Dataset) -> list[Sentence]:
    """Return one sentence for each body: its life, the track that fails first, and the block with the most damage.

    For a spectrum with limits a second sentence for each body names its first limit and the decisive block.
    """
    first = [_first_limit(ds, body) for body in BODIES] if "limiting_mechanism" in ds else []
    return [_sentence(ds, body) for body in BODIES] + first


def _first_limit(ds: xr.Dataset, body: str) -> Sentence:
    own, names = ds.sel(body=body), str(ds["limiting_mechanism"].attrs["flag_meanings"]).split()
    name, shifts = names[int(own["limiting_mechanism"])], float(own["life_to_first_limit_shifts"])
    if name not in LIMITS:
        return Sentence("spectrum_no_limit", f"No limit of the {body} is known.", {"body": body})
    own, title = own.sel(limit=name), LIMITS[name].title
    used = f"{rounded(100.0 * float(own['utilisation']))} % of it is used"
    values = {"body": body, "limit": name, "shifts": shifts}
    if np.isnan(own["life_shifts_by_limit"]) or shifts == 0.0:
        when = "exceeds" if shifts == 0.0 else "comes closest to"
        return Sentence("spectrum_limit", f"The {body} {when} {title}: in the worst block {used}.", values)
    damage = own["damage_by_limit"].values
    worst = int(np.nanargmax(damage))
    text = (
        f"The first limit of the {body} is {title}, after {_life(shifts)} shifts; "
        f"{chance(float(damage[worst] / damage.sum()))} of its sum comes from '{ds['block'].values[worst]}'."
    )
    return Sentence("spectrum_limit", text, values | {"block": str(ds["block"].values[worst])})


def _sentence(ds: xr.Dataset, body: str) -> Sentence:
    shifts = ds["life_shifts"].sel(body=body)
    if bool(shifts.isnull().any()):
        text = f"The life of the {body} is not known: {_undefined_blocks(ds, body)}{_at_most(ds, body)}."
        return Sentence("spectrum_unknown", text, {"body": body})
    if bool(np.isinf(shifts).all()):
        return Sentence("spectrum_unlimited", f"The {body} takes no damage in this spectrum.", {"body": body})
    contact, damage = known_damage(ds, body)
    part = damage / damage.sum()
    worst = int(np.argmax(part))
    lives = {name: float(ds[f"{body}_life_{name}"]) for name, _ in UNITS}
    lengths = listing([f"{_life(lives[name])} {life_unit(unit, lives[name])}" for name, unit in UNITS[1:]], "or")
    lengths += f", {BEYOND}" if _beyond(ds, body, lives["shifts"]) else ""
    text = (
        f"The {body} lasts {_life(lives['shifts'])} shifts ({lengths}); contact {contact} fails first, and "
        f"{chance(float(part[worst]))} of its damage comes from '{ds['block'].values[worst]}'."
    )
    values = {"body": body, "contact": contact, "block": str(ds["block"].values[worst]), "share": float(part[worst])}
    return Sentence("spectrum", text, values | lives)


def _beyond(ds: xr.Dataset, body: str, shifts: float) -> bool:
    """Say whether a body lasts more overrollings than its fatigue limit or the S-N data reach."""
    material = json.loads(str(ds.attrs.get("materials", "{}"))).get(f"{body}_material", {})
    cycles = shifts * float(ds["overrollings"].sel(body=body).sum())
    return bool(past_data(cycles, float(material.get("cycles_at_fatigue_limit", np.inf))))


def _at_most(ds: xr.Dataset, body: str) -> str:
    """Return an upper bound of the life from the known blocks; an empty text if these blocks do no damage."""
    contact, damage = known_damage(ds, body)
    known = float(np.nansum(damage))
    life_at_most = _life(ds.attrs["critical_damage"] / known) if known > 0 else ""
    return f"; at most {life_at_most} shifts by the other blocks (contact {contact})" if known > 0 else ""


def _undefined_blocks(ds: xr.Dataset, body: str) -> str:
    unknown = ds["damage"].sel(body=body).isnull().any("contact").values
    if np.isnan(ds["overrollings"].sel(body=body).values[unknown]).all():
        return "give guide_overrollings_per_hour, or guide_overrollings of each block"
    blocks = zip(ds["block"].values[unknown], ds["regime"].values[unknown], strict=True)
    listed = [f"'{name}' ({REGIME_LABELS[int(code)]})" for name, code in blocks]
    return f"no stress in {listing(listed)}"


def _life(value: float) -> str:
    return "unknown" if np.isnan(value) else life(value)
