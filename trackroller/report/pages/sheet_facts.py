"""Collect the facts of one solved roller: verdict, inputs, results by contact and body, limits, flags."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.analysis.columns import at_surface
from trackroller.analysis.table import BODIES
from trackroller.damage.limit import roller_overrollings
from trackroller.damage.sn_curve import PROBABILITIES, SNCurve
from trackroller.parameters import CONTACT_MODELS, OPTIONS, REGIMES
from trackroller.report.numbers import life, listing, number, plain, rounded, unit_text
from trackroller.report.tables.inputs import Row, as_material, input_row, is_told, material_rows, material_source
from trackroller.report.words.flags import Flag, flags_of
from trackroller.roller.geometry import rolling_radius
from trackroller.roller.limits import Limits, limits
from trackroller.roller.record import case_of_result, inputs_of, is_default, materials_of, solve_command
from trackroller.study.store.provenance import versions

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.materials import Material

CONTACT_ROWS = (  # variable, words
    ("normal_force", "normal force F_N"),
    ("lateral_force", "lateral friction force F_T"),
    ("driving_force", "friction force along the track F_A"),
    ("spin_moment", "spin moment M_R"),
    ("semi_axis_lateral", "semi-axis a, lateral"),
    ("semi_axis_rolling", "semi-axis b, rolling direction"),
    ("max_pressure", "largest pressure"),
    ("max_shear", "largest surface shear"),
    ("stick_area_fraction", "adhesion (stick) area, share of the patch"),
    ("friction_power", "friction power"),
)
WHOLE_ROWS = (
    ("slip", "longitudinal creepage"),
    ("transmitted_force", "force transmitted along the track"),
    ("drilling_torque", "roller torque about the track normal (drilling torque)"),
    ("rolling_radius_shift", "rolling radius shift"),
)


@dataclass(frozen=True)
class BodyFacts:
    """Stress and life of one body in one contact."""

    body: str
    peak: float
    place: str
    of_strength: float
    of_fatigue_limit: float
    cycles: float
    hours: float


@dataclass(frozen=True)
class ContactFacts:
    """Forces, patch and bodies of one contact; `carries` is False for a contact that has lifted."""

    number: int
    carries: bool
    rows: list[Row]
    bodies: list[BodyFacts]


@dataclass(frozen=True)
class Facts:
    """All statements of a sheet on one roller."""

    verdict: str
    reason: str
    inputs: list[Row]
    materials: list[tuple[str, list[Row], str]]
    contacts: list[ContactFacts]
    whole: list[Row]
    lives: list[Row]
    limits: list[Row]
    flags: list[Flag]
    options: str
    command: str
    versions: str


def collect(ds: xr.Dataset) -> Facts:
    """Return the facts of a solved case.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case.

    Raises
    ------
    InputError
        If `ds` is not the result of one case.
    """
    inputs, stored = inputs_of(ds), materials_of(ds)
    materials = {body: as_material(stored[f"{body}_material"]) for body in BODIES}
    regime = REGIMES[int(ds["regime"])]
    found = limits(case_of_result(ds), str(ds.attrs["contact_model"]))
    contacts = [_contact(ds, number, materials) for number in ds["contact"].values.tolist()]
    lifeless = {body: _no_life(regime, body, contacts) for body in BODIES}
    contacts = [_without_life(contact, lifeless) for contact in contacts]
    lives = _lives(ds, inputs, materials, lifeless)
    return Facts(
        verdict=_verdict(regime, ds, lives, lifeless, found, inputs),
        reason=str(ds["reason"].item()) if "reason" in ds else "",
        inputs=[input_row(name, value) for name, value in inputs.items() if is_told(name, value)],
        materials=body_materials(stored),
        contacts=contacts,
        whole=quantity_rows(ds, WHOLE_ROWS),
        lives=lives,
        limits=limit_rows(found, inputs),
        flags=flags_of(ds),
        options=", ".join(f"{plain(name)} {ds.attrs[name]}{_used(ds, name)}" for name in OPTIONS if ds.attrs.get(name)),
        command=command_of(ds),
        versions=versions_text(),
    )


def _used(ds: xr.Dataset, option: str) -> str:
    """Name the contact model that solved the case if it is not the one asked for; an empty text for other options."""
    used = CONTACT_MODELS[int(ds["contact_model_used"])]
    return f" (solved by {used})" if option == "contact_model" and used != ds.attrs[option] else ""


def versions_text() -> str:
    """Return the versions of the programs that a result depends on."""
    return ", ".join(f"{name} {version}" for name, version in versions().items())


def body_materials(materials: Mapping[str, Mapping[str, Any]]) -> list[tuple[str, list[Row], str]]:
    """Return head, values and source of each material, once if both bodies are of the same."""
    roller, guide = (materials[f"{body}_material"] for body in BODIES)
    told = [("roller and guide", roller)] if roller == guide else [("roller", roller), ("guide", guide)]
    return [(head, material_rows(as_material(values)), material_source(values)) for head, values in told]


def command_of(ds: xr.Dataset) -> str:
    """Return the command that solves the case of a result again."""
    given = {name: value for name, value in inputs_of(ds).items() if not is_default(name, value)}
    plain = {n: v if v is None or isinstance(v, Mapping) else str(v).removesuffix(".0") for n, v in given.items()}
    named = ("contact_model", "spin_model", "accuracy", "normal", "life_rule")
    return solve_command(plain | {name: ds.attrs.get(name) for name in named})


def _contact(ds: xr.Dataset, which: int, materials: Mapping[str, Material]) -> ContactFacts:
    own = ds.sel(contact=which)
    rows = quantity_rows(own, CONTACT_ROWS)
    bodies = []
    if "peak_stress" in own:
        bodies = [_body(own.sel(body=body), body, materials[body]) for body in BODIES]
    carries = "normal_force" not in own or bool(np.isfinite(float(own["normal_force"])))
    return ContactFacts(which, carries, rows, [b for b in bodies if math.isfinite(b.peak)])


def _body(own: xr.Dataset, body: str, material: Material) -> BodyFacts:
    x, y, z = (float(own[f"peak_{axis}"]) for axis in "xyz")
    depth = "at the surface" if at_surface(own) == 1 else f"{rounded(z, 2)} mm below the surface"
    place = f"{depth}, x = {rounded(x, 2)} mm, y = {rounded(y, 2)} mm"
    peak, cycles, hours = (float(own.get(n, math.nan)) for n in ("peak_stress", "life_cycles", "life_hours"))
    return BodyFacts(body, peak, place, peak / material.tensile_strength, peak / material.fatigue_limit, cycles, hours)


def _no_life(regime: str, body: str, contacts: list[ContactFacts]) -> str:
    """Say why a body has no fatigue life: overload or a skidding roller; an empty text if it has one."""
    over = max((b.of_strength for contact in contacts for b in contact.bodies if b.body == body), default=0.0)
    if over > 1:
        return f"the peak stress is {rounded(over, 2)} times its tensile strength"
    return "the roller skids: friction heat and wear decide" if regime == "full_slip" else ""


def _without_life(contact: ContactFacts, lifeless: Mapping[str, str]) -> ContactFacts:
    """Drop the lives of the bodies that have no fatigue life."""
    kept = [replace(b, cycles=math.nan, hours=math.nan) if lifeless[b.body] else b for b in contact.bodies]
    return replace(contact, bodies=kept)


def _lives(
    ds: xr.Dataset, inputs: Mapping[str, Any], materials: Mapping[str, Material], lifeless: Mapping[str, str]
) -> list[Row]:
    """Return the life of each body, at 10, 50 and 90 % failure probability where its material has scatter."""
    rows = []
    unknown = {"guide": "not known: give guide_overrollings_per_hour", "roller": "not defined in this regime"}
    for body in (b for b in BODIES if f"{b}_life_hours" in ds):
        hours, material = float(ds[f"{body}_life_hours"]), materials[body]
        if lifeless[body]:
            rows.append(Row(f"{body}, no fatigue life", lifeless[body]))
        elif material.scatter_in_cycles or material.scatter_in_stress:
            for p in PROBABILITIES:
                text = life(_hours_at(ds, body, inputs, material, p))
                rows.append(Row(f"{body}, until {100 * p:.0f} % have failed", text, "h"))
        elif math.isnan(hours):
            rows.append(Row(f"{body}, median life", unknown[body]))
        else:
            rows.append(Row(f"{body}, median life (no scatter of its material is known)", life(hours), "h"))
    return rows


def _hours_at(ds: xr.Dataset, body: str, inputs: Mapping, material: Material, probability: float) -> float:
    curve = SNCurve.of(material, str(ds.attrs["life_rule"])).changed(failure_probability=probability)
    rate = inputs.get("guide_overrollings_per_hour")
    if body == "roller":
        alpha = math.radians(inputs["contact_angle"])
        radius = rolling_radius(inputs["axis_distance"], inputs["guide_profile_radius"], alpha)
        rate = roller_overrollings(inputs["velocity"], radius)
    stress = ds["fatigue_stress" if "fatigue_stress" in ds else "peak_stress"]
    cycles = curve.life_cycles(stress.sel(body=body).values)
    return float(np.min(cycles / (math.nan if rate is None else rate)))


def _verdict(
    regime: str,
    ds: xr.Dataset,
    lives: list[Row],
    lifeless: Mapping[str, str],
    found: Limits,
    inputs: Mapping[str, Any],
) -> str:
    """Return the summary of the sheet: what rules (lift-off, overload, skidding, life) and the distance to lift-off."""
    if regime == "failed":
        return f"No solution: {ds['reason'].item()}"
    if regime == "lift_off":
        low, high = found.axial_force
        return (
            f"A contact lifts off. Both contacts carry load for axial forces from {rounded(low)} to {rounded(high)} N."
        )
    over = [f"at the {body} {why}" for body, why in lifeless.items() if "tensile strength" in why]
    parts = [f"Overloaded: {listing(over)}."] if over else []
    if regime == "full_slip":
        parts.append("Skids: the motor force exceeds what friction transmits.")
    elif not over:
        parts.append("Rolls.")
    if not any(lifeless.values()) and "roller_life_hours" in ds and math.isfinite(float(ds["roller_life_hours"])):
        own = [row for row in lives if row.words.startswith("roller")]
        hours = ", ".join(f"{row.value} h ({_probability(row.words)})" for row in own[:2])
        parts.append(f"The roller lasts {hours}; contact {_weakest(ds)} decides.")
    axial = inputs["axial_force"]
    reserve = min(found.axial_force[1] - axial, axial - found.axial_force[0])
    if math.isfinite(reserve):
        toward = "more" if found.axial_force[1] - axial <= axial - found.axial_force[0] else "less"
        parts.append(f"A contact lifts off with {rounded(reserve, 2)} N {toward} axial force.")
    return " ".join(parts)


def _probability(words: str) -> str:
    return words.partition("until ")[2].partition(" have")[0] or "median"


def _weakest(ds: xr.Dataset) -> int:
    hours = ds["life_hours"].sel(body="roller")
    return int(ds["contact"].values[int(np.nanargmin(hours.values))])


def quantity_rows(ds: xr.Dataset, names: tuple[tuple[str, str], ...]) -> list[Row]:
    """Return the finite ones of some results, each with its unit."""
    return [
        Row(words, number(float(ds[name])), unit_text(ds[name].attrs.get("units", "1")).replace("–", ""))
        for name, words in names
        if name in ds and np.isfinite(float(ds[name]))
    ]


def limit_rows(found: Limits, inputs: Mapping[str, Any]) -> list[Row]:
    """Return the limits of a roller in words."""
    low, high = map(rounded, found.axial_force)
    rows = [Row("lift-off: both contacts carry load for axial forces", f"{low} to {high}", "N")]
    if any(map(math.isnan, found.axial_force)):
        rows = [Row(rows[0].words, "not defined: no state with two loaded contacts was found")]
    if any(map(math.isfinite, found.motor_force)):
        drive, brake = map(rounded, found.motor_force)
        rows.append(Row("full slip: the roller does not skid for motor forces", f"{drive} to {brake}", "N"))
    lock, lifts, now = found.self_locking_friction, found.lift_off_friction, number(inputs["friction_coefficient"])
    special = "none up to 2" if math.isinf(lock) else "not defined: a contact has lifted"
    locks = f"from {rounded(lock)} (now {now})" if math.isfinite(lock) else special
    rows.append(Row("self-locking: friction alone carries the lateral load for friction coefficients", locks))
    if math.isfinite(lifts):
        rows.append(Row("lift-off: a contact lifts for friction coefficients", f"from {rounded(lifts)} (now {now})"))
    return rows
