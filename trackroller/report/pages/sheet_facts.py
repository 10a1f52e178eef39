"""Collect the facts of one solved roller: verdict, inputs, results by contact and body, limits, flags."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.analysis.columns import at_surface
from trackroller.parameters import BODIES, CONTACT_MODELS, FIRST_TO_FAIL, OF_LIMITS, OPTIONS, REGIMES
from trackroller.parameters.example import not_given_text
from trackroller.report.numbers import BEYOND, listing, number, plain, rounded, unit_text
from trackroller.report.tables.inputs import Row, as_material, input_row, is_told, material_rows, material_source
from trackroller.report.tables.limits import (
    GUESSED,
    Margin,
    at_temperature,
    first_limits,
    margins,
    not_checked,
    placeholders,
)
from trackroller.report.tables.lives import life_rows
from trackroller.report.words.assumptions import (
    assumptions,
    friction_sentence,
    material_warnings,
    standards,
    strength_sentences,
)
from trackroller.report.words.flags import Flag, flags_of
from trackroller.roller.dataset import VARIABLES, shown
from trackroller.roller.limits import limits
from trackroller.roller.record import (
    case_of_result,
    doubts_of,
    inputs_of,
    is_default,
    materials_of,
    not_given_of,
    solve_command,
)
from trackroller.study.store.provenance import versions

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.materials import Material
    from trackroller.roller.limits import Limits


ROUNDING = 1e-9  # N, mm, MPa, 1: results below are rounding errors of a zero, as the drive torque of a free roller


@dataclass(frozen=True)
class BodyFacts:
    """Stress of one body in one contact."""

    body: str
    peak: float
    depth: float
    of_strength: float


@dataclass(frozen=True)
class ContactFacts:
    """Forces, patch and bodies of one contact; `carries` is False for a contact that has lifted."""

    number: int
    carries: bool
    rows: list[Row]
    bodies: list[BodyFacts]


def side_by_side(contacts: list[ContactFacts]) -> list[list[str]]:
    """Return a line for each quantity of the contacts: its words, its value in each contact, and its unit."""
    lines = [
        [own[0].words, *(row.value for row in own), own[0].unit]
        for own in zip(*(contact.rows for contact in contacts), strict=True)
    ]
    for own in zip(*(contact.bodies for contact in contacts), strict=True):
        lines.append([f"peak stress of the {own[0].body} (von Mises)", *(number(b.peak) for b in own), "MPa"])
        lines.append([f"depth of the peak in the {own[0].body}", *(number(b.depth) for b in own), "mm"])
    return lines


@dataclass(frozen=True)
class Facts:
    """All statements of a sheet on one roller."""

    verdict: str
    reason: str
    inputs: list[Row]
    not_given: str
    doubts: list[str]
    materials: list[tuple[str, list[Row], str]]
    contacts: list[ContactFacts]
    whole: list[Row]
    lives: list[Row]
    margins: list[Margin]
    first: list[str]
    not_checked: list[str]
    flags: list[Flag]
    assumptions: list[str]
    standards: str
    data: list[str]
    guesses: list[str]
    options: str
    command: str
    versions: str


def collect(ds: xr.Dataset, ranges: Limits | None = None) -> Facts:
    """Return the facts of a solved case.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case.
    ranges : Limits, optional
        Ranges of forces and friction in which the roller rolls; searched if not given.

    Raises
    ------
    InputError
        If `ds` is not the result of one case.
    """
    inputs, stored, given = inputs_of(ds), materials_of(ds), not_given_of(ds)
    materials = {body: as_material(stored[f"{body}_material"]) for body in BODIES}
    regime = REGIMES[int(ds["regime"])]
    ranges = ranges or limits(case_of_result(ds), str(ds.attrs["contact_model"]))
    needed = {*shown("contact"), "peak_stress", "peak_z"}
    stated = ds[["contact", *(name for name in ds if name in needed)]]  # a selection takes its time by variable
    if "peak_stress" in stated:
        stated = stated.assign(at_surface=at_surface(stated))
    contacts = [_contact(stated, number, materials) for number in ds["contact"].values.tolist()]
    lifeless = {body: _no_life(regime, body, contacts) for body in BODIES}
    lives, own = life_rows(ds, inputs, materials, lifeless), margins(ds, ranges, inputs, materials, lifeless)
    said = filter(None, [friction_sentence(ds), *strength_sentences(materials), *material_warnings(stored, materials)])
    return Facts(
        verdict=_verdict(regime, ds, lives, lifeless, ranges, inputs, own),
        reason=str(ds["reason"].item()) if "reason" in ds else "",
        inputs=[
            replace(input_row(name, value), default=name in given or (is_default(name, value) and name in OF_LIMITS))
            for name, value in inputs.items()
            if is_told(name, value)
        ],
        not_given=not_given_text(given),
        doubts=doubts_of(ds),
        materials=body_materials(stored),
        contacts=contacts,
        whole=quantity_rows(ds, shown()),
        lives=lives,
        margins=own,
        first=first_limits(own),
        not_checked=not_checked(ds),
        flags=flags_of(ds),
        assumptions=assumptions(ds),
        standards=standards(ds),
        data=list(said),
        guesses=[*placeholders(ds), *at_temperature(ds)],
        options=", ".join(f"{plain(name)} {ds.attrs[name]}{_used(ds, name)}" for name in OPTIONS if ds.attrs.get(name)),
        command=command_of(ds),
        versions=versions_text(),
    )


def _used(ds: xr.Dataset, option: str) -> str:
    """Name the contact model that solved the case if it is not the chosen one; an empty text for other options."""
    used = CONTACT_MODELS[int(ds["contact_model_used"])]
    return f" (solved by {used})" if option == "contact_model" and used != ds.attrs[option] else ""


def versions_text() -> str:
    """Return the versions of the programs that a result depends on."""
    return ", ".join(f"{name} {version}" for name, version in versions().items())


def body_materials(materials: Mapping[str, Mapping[str, Any]]) -> list[tuple[str, list[Row], str]]:
    """Return head, values and source of each material, once if both bodies are of the same."""
    roller, guide = (materials[f"{body}_material"] for body in BODIES)
    by_body = [("roller and guide", roller)] if roller == guide else [("roller", roller), ("guide", guide)]
    return [(head, material_rows(as_material(values)), material_source(values)) for head, values in by_body]


def command_of(ds: xr.Dataset) -> str:
    """Return the command that solves the case of a result again."""
    given = {name: value for name, value in inputs_of(ds).items() if not is_default(name, value)}
    plain = {n: v if v is None or isinstance(v, Mapping) else str(v).removesuffix(".0") for n, v in given.items()}
    named = ("contact_model", "spin_model", "accuracy", "normal", "life_rule")
    return solve_command(plain | {name: ds.attrs.get(name) for name in named})


def _contact(ds: xr.Dataset, which: int, materials: Mapping[str, Material]) -> ContactFacts:
    own = ds.sel(contact=which)
    rows = quantity_rows(own, shown("contact"))
    bodies = []
    if "peak_stress" in own:
        bodies = [_body(own.sel(body=body), body, materials[body]) for body in BODIES]
    carries = "normal_force" not in own or bool(np.isfinite(float(own["normal_force"])))
    return ContactFacts(which, carries, rows, [b for b in bodies if math.isfinite(b.peak)])


def _body(own: xr.Dataset, body: str, material: Material) -> BodyFacts:
    peak, depth = float(own["peak_stress"]), 0.0 if own["at_surface"] == 1 else float(own["peak_z"])
    return BodyFacts(body, peak, depth, peak / material.tensile_strength)


def _no_life(regime: str, body: str, contacts: list[ContactFacts]) -> str:
    """Say why a body has no fatigue life: overload or a skidding roller; an empty text if it has one."""
    over = max((b.of_strength for contact in contacts for b in contact.bodies if b.body == body), default=0.0)
    if over > 1:
        return f"the peak stress is {rounded(over, 2)} times its tensile strength"
    return "the roller skids: friction heat and wear decide" if regime == "full_slip" else ""


def _verdict(
    regime: str,
    ds: xr.Dataset,
    lives: list[Row],
    lifeless: Mapping[str, str],
    ranges: Limits,
    inputs: Mapping[str, Any],
    own: list[Margin],
) -> str:
    """Return the summary of the sheet: what rules (lift-off, overload, skidding, life) and the distance to lift-off."""
    if regime == "failed":
        return f"No solution: {ds['reason'].item()}"
    if regime == "lift_off":
        low, high = ranges.axial_force
        if math.isnan(low):
            return "A contact lifts off."
        return (
            f"A contact lifts off. Both contacts carry load for axial forces from {rounded(low)} to {rounded(high)} N."
        )
    over = [f"at the {body} {why}" for body, why in lifeless.items() if "tensile strength" in why]
    parts = [f"Overloaded: {listing(over)}."] if over else []
    if regime == "full_slip":
        parts.append("Skids: the motor force exceeds what friction transmits.")
    elif not over:
        parts.append("Rolls.")
        passed: dict[str, list[str]] = {}
        for margin in (m for m in own if m.reached == 0.0):
            passed.setdefault(f"{margin.title}{GUESSED * margin.guessed}", []).append(margin.body)
        words = [f"{title} ({listing(bodies)})" for title, bodies in passed.items()]
        parts += [f"Exceeded: {listing(words)}."] if words else []
    of_roller = [row for row in lives if row.words.startswith(("roller, until", "roller, median"))]
    if of_roller and not any(lifeless.values()) and math.isfinite(float(ds["roller_life_hours"])):
        parts.append(f"The roller lasts {', '.join(map(_hours, of_roller[:2]))}; contact {_weakest(ds)} decides.")
        if FIRST_TO_FAIL[int(ds["first_to_fail"])] == "guide":
            parts.append(f"The guide fails first, after {_hours(lives[-1])}.")
    axial = inputs["axial_force"]
    reserve = min(ranges.axial_force[1] - axial, axial - ranges.axial_force[0])
    if math.isfinite(reserve):
        toward = "more" if ranges.axial_force[1] - axial <= axial - ranges.axial_force[0] else "less"
        parts.append(f"A contact lifts off with {rounded(reserve, 2)} N {toward} axial force.")
    return " ".join(parts)


def _hours(row: Row) -> str:
    """Return the hours of a life with its failure probability, and whether it lies beyond the S-N data."""
    remarks = [row.words.partition("until ")[2].partition(" have")[0] or "median"]
    return f"{row.value.partition(';')[0]} ({', '.join(remarks + [BEYOND] * (BEYOND in row.value))})"


def _weakest(ds: xr.Dataset) -> int:
    hours = ds["life_hours"].sel(body="roller")
    return int(ds["contact"].values[int(np.nanargmin(hours.values))])


def quantity_rows(ds: xr.Dataset, names: Iterable[str]) -> list[Row]:
    """Return the finite ones of some results, each with its symbol and unit."""
    return [
        Row(_words(name), number(value if abs(value) > ROUNDING else 0.0), unit_text(units).replace("–", ""))
        for name, value, units in ((n, float(ds.variables[n].values), VARIABLES[n].units) for n in names if n in ds)
        if np.isfinite(value)
    ]


def _words(name: str) -> str:
    """Return the name of a result without remarks, and its symbol if that is no formula."""
    words, _, _ = VARIABLES[name].long_name.partition(",")
    symbol = VARIABLES[name].symbol
    return f"{words} {symbol}" if symbol.replace("_", "").isalnum() else words
