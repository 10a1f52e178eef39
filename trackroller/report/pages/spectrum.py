"""The facts of a load spectrum, for the terminal and for its page: lives, damage by block, and sentences on both."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trackroller.parameters import PARAMETERS, REGIME_LABELS, REGIMES
from trackroller.report.numbers import capital, life, listing, long_name, unit_text, with_unit
from trackroller.report.tables.cases import Table, cell
from trackroller.report.tables.inputs import Row
from trackroller.report.words.flags import flags_of
from trackroller.report.words.pareto import chance
from trackroller.report.words.sentence import Sentence
from trackroller.study.spectrum.file import LOAD_FIELDS
from trackroller.study.spectrum.solve import BODIES

if TYPE_CHECKING:
    import xarray as xr

UNITS = (("shifts", "shifts"), ("km", "km"), ("hours", "h"))


def life_rows(ds: xr.Dataset, body: str) -> list[Row]:
    """Return the life of a body in shifts, km and hours, and at each failure probability if its material scatters."""
    rows = [Row(f"life in {name}", _life(float(ds[f"{body}_life_{name}"])), unit) for name, unit in UNITS]
    if "life_shifts_at_probability" in ds:
        lives = ds["life_shifts_at_probability"].sel(body=body)
        per_shift = [1.0, float(ds["distance"].sum()) / 1e3, float(ds["duration"].sum())]
        for p in ds["probability"].values if not bool(lives.isnull().all()) else ():
            shifts = float(lives.sel(probability=p).min(skipna=False))
            told = [f"{_life(shifts * scale)} {unit}" for scale, (_, unit) in zip(per_shift, UNITS, strict=True)]
            rows.append(Row(f"until {100 * float(p):g} % have failed", ", ".join(told)))
    return rows


def block_table(ds: xr.Dataset) -> Table:
    """List the blocks of a shift: distance, the loads that differ, regime, stress and damage with its share."""
    loads = [n for n in LOAD_FIELDS if len(np.unique(ds[n].values[~np.isnan(ds[n].values)])) > 1]
    differ = [with_unit(capital(long_name(name)), PARAMETERS[name].unit) for name in loads]
    heads = ["Block", "Distance [m]", "Duration [h]", *differ, "Regime"]
    for body in BODIES:
        heads += [f"{capital(body)} peak [MPa]", f"{capital(body)} damage [–]", "Share"]
    rows = []
    for i, name in enumerate(ds["block"].values):
        cells = [str(name), *(cell(float(ds[n][i])) for n in ("distance", "duration", *loads))]
        cells.append(REGIME_LABELS[int(ds["regime"][i])])
        for body in BODIES:
            part = ds[["peak_stress", "damage", "damage_sum"]].sel(body=body, contact=track(ds, body))
            done, whole = float(part["damage"][i]), float(part["damage_sum"])
            of_all = chance(done / whole) if whole > 0 else "–"
            cells += [cell(float(part["peak_stress"][i])), cell(done), of_all]
        rows.append(cells)
    sums = ["Sum of a shift", *(cell(float(ds[n].sum())) for n in ("distance", "duration")), *[""] * (len(loads) + 1)]
    for body in BODIES:
        sums += ["", cell(float(ds["damage_sum"].sel(body=body, contact=track(ds, body)))), ""]
    rows.append(sums)
    same = [n for n in LOAD_FIELDS if n not in loads and np.isfinite(ds[n].values).all()]
    told = [f"{PARAMETERS[n].long_name} {cell(float(ds[n][0]))} {unit_text(PARAMETERS[n].unit)}" for n in same]
    note = f"Stress and damage are those of the track that fails first. Same in all blocks: {'; '.join(told)}."
    return Table("spectrum", "Blocks of a shift", heads, rows, note.replace(" –;", ";").replace(" –.", "."))


def warnings(ds: xr.Dataset) -> list[str]:
    """Return each validity flag in words, with its remedy and the blocks that carry it."""
    found: dict[str, list[str]] = {}
    for i, name in enumerate(ds["block"].values if "validity" in ds else ()):
        for flag in flags_of(ds.isel(block=i)):
            found.setdefault(f"{flag.sentence} {flag.remedy}", []).append(f"'{name}'")
    return [f"{text} Blocks: {listing(blocks)}." for text, blocks in found.items()]


def track(ds: xr.Dataset, body: str) -> int:
    """Return the contact whose track fails first; of unknown lives the other one."""
    shifts = ds["life_shifts"].sel(body=body).values
    return int(ds["contact"].values[int(np.argmin(np.where(np.isnan(shifts), np.inf, shifts)))])


def sentences(ds: xr.Dataset) -> list[Sentence]:
    """Return one sentence for each body: its life, the track that fails first, and the block with the most damage."""
    return [_sentence(ds, body) for body in BODIES]


def _sentence(ds: xr.Dataset, body: str) -> Sentence:
    shifts = ds["life_shifts"].sel(body=body)
    if bool(shifts.isnull().any()):
        text = f"The life of the {body} is not known: {_undefined_blocks(ds, body)}{_at_most(ds, body)}."
        return Sentence("spectrum_unknown", text, {"body": body})
    if bool(np.isinf(shifts).all()):
        return Sentence("spectrum_unlimited", f"The {body} takes no damage in this spectrum.", {"body": body})
    contact = track(ds, body)
    part = ds["damage"].sel(body=body, contact=contact).values / float(ds["damage_sum"].sel(body=body, contact=contact))
    worst = int(np.argmax(part))
    lives = {name: float(ds[f"{body}_life_{name}"]) for name, _ in UNITS}
    told = listing([f"{_life(lives[name])} {unit}" for name, unit in UNITS[1:]], "or")
    text = (
        f"The {body} lasts {_life(lives['shifts'])} shifts ({told}); contact {contact} fails first, and "
        f"{chance(float(part[worst]))} of its damage comes from '{ds['block'].values[worst]}'."
    )
    values = {"body": body, "contact": contact, "block": str(ds["block"].values[worst]), "share": float(part[worst])}
    return Sentence("spectrum", text, values | lives)


def _at_most(ds: xr.Dataset, body: str) -> str:
    """Return an upper bound of the life from the known blocks; an empty text if these blocks do no damage."""
    known = float(ds["damage"].sel(body=body).sum("block").max())  # skips the unknown ones
    return f"; at most {_life(ds.attrs['critical_damage'] / known)} shifts by the other blocks" if known > 0 else ""


def _undefined_blocks(ds: xr.Dataset, body: str) -> str:
    unknown = ds["damage"].sel(body=body).isnull().any("contact").values
    names = ds["block"].values
    if np.isnan(ds["overrollings"].sel(body=body).values[unknown]).all():
        return "give guide_overrollings_per_hour, or guide_overrollings of each block"
    listed = ", ".join(
        f"'{name}' ({REGIMES[int(r)]})" for name, r in zip(names[unknown], ds["regime"].values[unknown], strict=True)
    )
    return f"no stress in {listed}"


def _life(value: float) -> str:
    return "unknown" if np.isnan(value) else life(value)
