"""The numbers of the page "Against measurements": each set with its scatter, ours beside it, and what it means."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from trackroller.damage.sn_curve import SNCurve
from trackroller.materials import Material, builtin_database
from trackroller.materials.properties import Value
from trackroller.report.numbers import rounded
from validation.measured.benchmark.table import HEADS as HEADS_OF_ERRORS
from validation.measured.benchmark.table import QUANTITIES, all_programs, error_rows
from validation.measured.facts import column, read
from validation.measured.solve import FULL_SLIP, HEAT_STEEL, measured_traction

HEADS = ("what", "others", "ours", "ours over theirs")
AGREES = 0.1  # relative difference that counts as agreement where a source states no scatter
DISC_ERROR = 0.05  # of the traction of the twin disc, because the size of the discs is assumed
HALF_ELEMENT = 0.125  # of the grooves [mm], which count in full at the edge
REFERENCE_ERROR = 0.02  # of CONTACT on 40 x 40 elements, over mu F_N
SHOWN_CREEPAGES = (0.55, 0.94, 2.27, 4.69, 11.89, 20.27)  # of the locomotive [%]
DEVIATIONS = 2.0  # standard deviations of the measured points that count as their scatter
LINE_STRESS = 0.557  # largest von Mises stress of a line contact over p_0, without friction, nu 0.3
WEAR_SOURCE = "Lewis"  # in the source of a wear coefficient that was taken from the twin disc
ROUNDING = 0.02  # of ranges that stand with two digits
WEAR_FRICTION = 0.46  # of the twin disc whose wear was measured
STEEL_DENSITY = 7850.0  # [kg/m3]
WHEEL_STEEL = "42CrMo4+QT-100"  # 270 HB; the wheel steel has about 260 HB
HARDER_STEEL = "1.7225-quenched-tempered"


@dataclass(frozen=True)
class Row:
    """A number of others beside ours; `agrees` is None where others have no single number."""

    quantity: str
    others: str
    ours: str
    ratio: str
    agrees: bool | None


@dataclass(frozen=True)
class Comparison:
    """A set of numbers of others beside ours.

    Parameters
    ----------
    title, source : str
        What was measured, and where the numbers come from.
    rows : sequence of Row
        Their numbers beside ours.
    meaning : str
        What it means for a design.
    """

    title: str
    source: str
    rows: Sequence[Row]
    meaning: str

    @property
    def outside(self) -> bool:
        """Return whether a number of ours lies outside the scatter of the set."""
        return any(row.agrees is not None and not row.agrees for row in self.rows)

    @property
    def verdict(self) -> str:
        """Return in words how many numbers lie outside."""
        judged = [row for row in self.rows if row.agrees is not None]
        apart = sum(not row.agrees for row in judged)
        if not judged:
            return "not judged"
        if not apart:
            return "inside"
        return f"outside in {apart} of {len(judged)}"

    @property
    def cells(self) -> list[tuple[str, ...]]:
        """Return the rows of the table in the order of `HEADS`."""
        return [(row.quantity, row.others, row.ours, row.ratio) for row in self.rows]


def facts(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the template `measured.md` shows.

    Parameters
    ----------
    data : mapping
        With `validation.measured.solve.results` under `measured`. Values of materials come from the database.
    """
    own = data["measured"]
    sets = [
        wear_of_twin_discs(),
        locomotive(own["locomotive"]),
        twin_disc(own["twin_disc"]),
        rolling_contact(),
        friction(),
        makers(own["lives"]),
        rolling_resistance(own["lives"]),
        flash(own["twin_disc"]),
        grooves(own["grooves"]),
        pins(own["pins"]),
        spin(own["spin"]),
        sliding_wear(),
    ]
    return {
        "outside": [one for one in sets if one.outside],
        "inside": [one for one in sets if not one.outside],
        "heads": HEADS,
        "agrees": AGREES,
        "film_rows": film_rows(own["locomotive"]),
        "exponent_rows": exponent_rows(own["lives"]),
        "loads": [f"{load:g}" for load in own["lives"]["loads"]],
    }


def benchmark_facts(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the template `benchmark.md` shows; `data` is not used, because programs stand in files."""
    entries = all_programs()
    return {
        "error_heads": HEADS_OF_ERRORS,
        "error_rows": error_rows(entries),
        "entries": [(f"`{one.name}`", one.remark) for one in entries],
        "quantities": [(f"`{name}`", unit) for name, unit in QUANTITIES.items()],
    }


def locomotive(own: Mapping[str, Any]) -> Comparison:
    """Return the creep curve of a locomotive beside the exact theory of a bare half-space."""
    rows = [_traction_row(point, ours) for point, ours in _shown_points(own["half_space"])]
    first = rows[0]
    meaning = (
        f"Below full slip the exact theory of bare bodies transmits {first.ratio} times the measured force at the "
        "same creepage, because a used surface yields: a roller needs more creepage for its drive than we say. "
        "Above it, friction falls with the slip speed, which only a friction law of the case shows."
    )
    return Comparison("Creep curve of a locomotive", "locomotive_creep.csv", rows, meaning)


def film_rows(own: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """Return the same points beside the curve with a film and falling friction, which was fitted to them."""
    shown = [_traction_row(point, ours) for point, ours in _shown_points(own["film"])]
    return [(row.quantity, row.others, row.ours, row.ratio) for row in shown]


def _shown_points(curve: Sequence[float]) -> list[tuple[dict[str, Any], float]]:
    points = zip(read("locomotive_creep"), curve, strict=True)
    return [(point, ours) for point, ours in points if point["longitudinal_creepage"] in SHOWN_CREEPAGES]


def _traction_row(point: Mapping[str, Any], ours: float) -> Row:
    """Return a mean of measured traction coefficients beside ours."""
    mean, deviation = point["traction_mean"], point["traction_deviation"]
    quantity = f"F/F_N at {point['longitudinal_creepage']:g} % creepage, {point['points']:g} points"
    others = f"{mean:.3f} ± {deviation:.3f}"
    return Row(quantity, others, f"{ours:.3f}", _ratio(ours / mean), abs(ours - mean) <= DEVIATIONS * deviation)


def twin_disc(own: Mapping[str, Any]) -> Comparison:
    """Return the creep curve of a dry twin disc below full slip beside Carter's."""
    creepage = column(read("twin_disc"), "longitudinal_creepage")
    rows = []
    for at, theirs, ours in zip(creepage, measured_traction(), own["traction"], strict=True):
        if at < FULL_SLIP:
            agrees = abs(ours / theirs - 1.0) <= DISC_ERROR
            rows.append(
                Row(f"F/F_N at {at:g} % creepage", f"{theirs:.3f}", f"{ours:.3f}", _ratio(ours / theirs), agrees)
            )
    meaning = (
        f"With μ = {own['friction']:.2f}, the mean of the same discs from {FULL_SLIP:g} % creepage on, bare elastic "
        "discs rise faster than measured ones. The friction level is taken from this set and is no prediction of ours. "
        "A bench test at small creepage does not give μ; read it from full slip."
    )
    source = "twin_disc.csv; force from heat, ± 5 % because the size of the discs is assumed"
    return Comparison("Creep curve of dry twin discs", source, rows, meaning)


def flash(own: Mapping[str, Any]) -> Comparison:
    """Return the flash temperatures of the twin disc beside the calculation of its authors."""
    table = read("twin_disc")
    rows = []
    for part, name in (("largest", "flash_largest"), ("mean", "flash_mean")):
        theirs, ours = column(table, name)[-1], own[name][-1]
        at = table[-1]["longitudinal_creepage"]
        row = Row(
            f"{part} flash at {at:g} % creepage [K]",
            f"{theirs:.1f}",
            f"{ours:.1f}",
            _ratio(ours / theirs),
            abs(ours / theirs - 1.0) <= AGREES,
        )
        rows.append(row)
    meaning = (
        "Their numbers are a calculation with thermal values that the source seen does not state. Ours take those of "
        f"the database of {HEAT_STEEL} and are the hotter ones, so that a temperature limit errs on the safe side."
    )
    return Comparison("Flash temperature of dry twin discs", "twin_disc.csv", rows, meaning)


def wear_of_twin_discs() -> Comparison:
    """Return the wear of dry twin discs by regime beside the coefficients of the database."""
    rows = []
    factors = []
    for steel, words in ((WHEEL_STEEL, "steel of like hardness"), (HARDER_STEEL, "quenched and tempered, 350 HB")):
        own = wear_value(steel)
        low, high = own.range or (own.value, own.value)
        for regime in read("twin_disc_wear"):
            work = regime["work_to"]
            theirs = measured_wear(regime, work)
            factors.append(theirs / own.value)
            row = Row(
                f"k, {regime['regime']}, at {work:g} N/mm²; {words}",
                f"{theirs:.2g}",
                f"{own.value:.2g} ({low:.2g} to {high:.2g})",
                _ratio(own.value / theirs),
                _unless_taken(WEAR_SOURCE, own, low * (1.0 - ROUNDING) <= theirs <= high * (1.0 + ROUNDING)),
            )
            rows.append(row)
    speed = f"Dry steel wore {rounded(min(factors), 2)} to {rounded(max(factors), 2)} times as fast as the value of "
    speed += "the database says. "
    if all(row.agrees is None for row in rows):
        meaning = speed + (
            "The ranges of the database were taken from these discs, so that the rows prove nothing but that they "
            "were read rightly; the regime decides, and a life by wear states both ends of the range."
        )
    elif any(row.agrees is False for row in rows):
        meaning = speed + (
            "A life by wear of dry steel on steel is a guess on the long side: measure the pair, or give the wear "
            "coefficient of a test."
        )
    else:
        meaning = speed + "The range of the database holds these discs; a life by wear states both ends of it."
    source = "twin_disc_wear.csv; k [mm³/(N m)] with μ 0.46 and 7850 kg/m³"
    return Comparison("Wear of dry twin discs", source, rows, meaning)


def _unless_taken(source: str, own: Value, agrees: bool) -> bool | None:
    """Return whether a value of the database agrees with a set; None where it was taken from this set."""
    if source in own.source:
        return None
    return agrees


def measured_wear(regime: Mapping[str, Any], work: float) -> float:
    """Return the wear coefficient that a regime of the twin disc gives at a work rate.

    Parameters
    ----------
    regime : mapping
        Row of `twin_disc_wear.csv`.
    work : float
        T gamma/A [N/mm2].

    Returns
    -------
    float
        k = mu w/(rho T gamma/A) [mm3/(N m)], for the loss w [ug/(m mm2)].
    """
    loss = regime["constant"] + regime["slope"] * work
    return float(WEAR_FRICTION * loss / (STEEL_DENSITY * work))  # 1 ug of this density has 1/7850 mm3


def wear_value(steel: str) -> Value:
    """Return the wear coefficient of a steel on itself [mm3/(N m)], with its range and source."""
    return builtin_database().on(steel, steel).records["wear_coefficient"]


def sliding_wear() -> Comparison:
    """Return wear coefficients of pins on rings, which are quoted beside and judge nothing."""
    rows = []
    for one in read("sliding_wear"):
        k = 1e3 * one["wear_number"] / one["hardness"]  # 1e3 mm/m
        rows.append(Row(f"k of {one['worn_material']}, dry, pin on ring", f"{k:.2g}", "–", "–", None))
    meaning = (
        "Hardness alone does not order these materials, and pins slide where rollers roll: the numbers stand beside "
        "the ranges of the database and are no part of them."
    )
    source = "sliding_wear.csv; K over hardness [mm³/(N m)]"
    return Comparison("Wear of pins on rings", source, rows, meaning)


def rolling_contact() -> Comparison:
    """Return pressures that rolling contacts bear beside those of the S-N curves of the database."""
    rows = []
    ratios = []
    for one in read("flank_limits"):
        material = builtin_database().material(_in_database(one["material"]))
        ours = rolling_pressure(material, one["cycles"])
        ratio = ours / one["pressure"]
        ratios.append(ratio)
        quantity = f"p_0 [MPa] at {one['cycles']:.0e} cycles, {one['evidence']}"
        grade = " (weak source)" if one["grade"] == "weak" else ""
        others = f"{one['pressure']:g}{grade}"
        agrees = abs(ratio - 1.0) <= AGREES
        rows.append(Row(quantity, others, f"{ours:.0f} ({material.name})", _ratio(ratio), agrees))
    meaning = (
        "The S-N curves of the database are bending tests. Read as pressures of a line contact, they give "
        f"{rounded(min(ratios), 2)} to {rounded(max(ratios), 2)} times the pressures of rolling tests, and a life goes "
        "with a high power of that: take a rolling-contact line where the material has one, or fit one to tests."
    )
    return Comparison("Pressure that rolling contacts bear", "flank_limits.csv", rows, meaning)


def _in_database(name: str) -> str:
    """Return the name of the material of the database that stands for a tested one."""
    return {"PA66": "PA66-dry", "POM": "POM-H"}.get(name, name)


def rolling_pressure(material: Material, cycles: float) -> float:
    """Return the pressure p_0 of a line contact without friction that the S-N curve allows [MPa]."""
    stress = np.ravel(SNCurve.of(material).allowable_stress(cycles))[0]
    return float(stress / LINE_STRESS)


def friction() -> Comparison:
    """Return friction coefficients of dry tests beside the typical ones of the database."""
    rows = []
    for one in read("friction"):
        first, second = one["ours"].split()
        own = builtin_database().friction(first, second)
        ours = own.value
        low, high = one["least"], one["largest"]
        others = f"{low:g}" if low == high else f"{low:g} to {high:g}"
        middle = math.sqrt(low * high)
        agrees = _unless_taken(one["taken_from"], own, low * (1.0 - AGREES) <= ours <= high * (1.0 + AGREES))
        rows.append(
            Row(f"μ, {one['pair']}, {one['test']}", others, f"{ours:g} (typical)", _ratio(ours / middle), agrees)
        )
    meaning = (
        "Typical coefficients of the database are none of dry surfaces: for dry steel they lie far below the tests, "
        "so that forces of friction, heat and wear come out too small. State friction_coefficient, or take the level "
        "`dry`."
    )
    return Comparison("Friction of dry pairs", "friction.csv", rows, meaning)


def makers(own: Mapping[str, Any]) -> Comparison:
    """Return exponents of makers' lives on the load beside those of our limits."""
    rows = []
    exponents = own["exponents"]
    for words, limit, power in (("dry", "wear", 2.0), ("lubricated", "fatigue", 3.0)):
        ours = -exponents[limit]
        agrees = abs(ours / power - 1.0) <= AGREES
        rows.append(
            Row(
                f"life over load, {words}; ours by {limit}",
                f"F^-{power:g}",
                f"F^-{ours:.2f}",
                _ratio(ours / power),
                agrees,
            )
        )
    lives = read("makers_lives")
    dry, lubricated = column(lives, "life_dry"), column(lives, "life_lubricated")
    share = dry / lubricated
    rows.append(Row("life dry over lubricated, 18 bearings", f"{share.min():.2f} to {share.max():.2f}", "–", "–", None))
    meaning = (
        "Our life by wear falls less steeply with the load than a maker's dry life: scaled from a small load to a "
        "large one, ours is the longer one. Our life by fatigue falls as lubricated lives do."
    )
    return Comparison("Makers' lives", "makers_rules.csv, makers_lives.csv", rows, meaning)


def exponent_rows(own: Mapping[str, Any]) -> list[tuple[str, ...]]:
    """Return the rules of makers beside our limits: who, what, and exponent of the life on the load."""
    rows = [
        (one["maker"], one["what it rates"], f"-{one['exponent']:g}", f"{one['offset']:g}")
        for one in read("makers_rules")
    ]
    for limit, words in (("wear", "life by wear"), ("fatigue", "life by fatigue")):
        rows.append(("ours", f"{words}, a roller that rolls freely", f"{own['exponents'][limit]:.2f}", "0"))
    return rows


def rolling_resistance(own: Mapping[str, Any]) -> Comparison:
    """Return lever arms of rolling resistance of handbooks beside our hysteresis, 3 alpha b/16."""
    rows = []
    for one in read("rolling_resistance"):
        material = builtin_database().material(one["ours"])
        ours = 3.0 / 16.0 * material.loss_fraction * own["half_length"]
        theirs = one["lever_arm"]
        quantity = f"lever arm [mm], {one['pair']}, {one['kind']}"
        rows.append(
            Row(quantity, f"{theirs:g}", f"{ours:.2g}", _ratio(ours / theirs), abs(ours / theirs - 1.0) <= AGREES)
        )
    meaning = (
        "A handbook's lever arm holds bearing, seals, roughness and dirt, and ours is the hysteresis of the contact "
        "alone: neither it nor the friction power is an estimate of the force that moves a carriage."
    )
    source = (
        f"rolling_resistance.csv; ours for a steel roller under {own['loads'][0]:g} N, b {own['half_length']:.2f} mm"
    )
    return Comparison("Rolling resistance", source, rows, meaning)


def grooves(own: Sequence[Mapping[str, Any]]) -> Comparison:
    """Return a wheel in close grooves beside conformal bodies."""
    rows = []
    for theirs, ours in zip(read("close_grooves"), own, strict=True):
        told = ours["told"]
        fit = f"a/R {ours['conformity']:.2f}"
        pairs = (
            ("largest pressure [MPa]", theirs["max_pressure"], ours["max_pressure"], told["pressure_model_error"]),
            ("half width [mm]", theirs["arc_half"] - HALF_ELEMENT, ours["half_width"], told["semi_axis_model_error"]),
            ("half length [mm]", theirs["length_half"], ours["half_length"], told["semi_axis_rolling_model_error"]),
            (
                "friction power [W]",
                theirs["friction_power"],
                ours["friction_power"],
                told["friction_power_model_error"],
            ),
        )
        for words, true, value, error in pairs:
            agrees = None
            if value == ours["max_pressure"]:
                agrees = abs(true / value - 1.0) <= error
            cell = f"{value:.4g} (told {rounded(100 * error, 2)} %)"
            rows.append(Row(f"{words}, {fit}", f"{true:.4g}", cell, _ratio(value / true), agrees))
    meaning = (
        "Hertz's pressure is too low in close grooves, by less than `pressure_model_error`, which comes from the pin "
        "in a hole: add it to pressures and stresses. Hertz's slip power is too high, and its patch too wide and too "
        "short. Those told errors come from these grooves, so that the rows prove none of them but the pressure's."
    )
    source = "close_grooves.csv: a program with the true curvature, no measurement; width less half an element"
    return Comparison("Wheel in close grooves, differential slip", source, rows, meaning)


def pins(own: Sequence[Mapping[str, float]]) -> Comparison:
    """Return Hertz's line contact beside a pin in a hole."""
    rows = []
    for one in own:
        fit = f"a/R {one['conformity']:.2f}"
        pairs = (
            ("largest pressure over Hertz's", one["pressure"], one["told_pressure"], None),
            ("width over Hertz's", one["width"], one["told_width"], 1.0 - one["width"] <= one["told_width"]),
        )
        for words, true, error, agrees in pairs:
            cell = f"1 (told {rounded(100 * error, 2)} %)"
            rows.append(Row(f"{words}, {fit}", f"{true:.3f}", cell, _ratio(1.0 / true), agrees))
    meaning = (
        "The told error of the pressure comes from this plane problem, which is the more cautious witness, and that of "
        "the width comes from the grooves: each set proves what the other one gave."
    )
    source = "Persson (1964), solved anew by `pin_in_hole.py`"
    return Comparison("Pin in a hole", source, rows, meaning)


def spin(own: Mapping[str, float]) -> Comparison:
    """Return force and moment at lateral creepage and spin beside CONTACT and the simplified theories."""
    rows = []
    bound = 0.3 * 82000.0
    scales = {"lateral_force": ("F_T [N]", bound), "spin_moment": ("M_R [N mm]", bound * math.sqrt(32.0))}
    for one in read("spin"):
        for name, (symbol, scale) in scales.items():
            theirs, ours = one[name], own[name]
            agrees = None
            if one["program"] == "CONTACT":
                agrees = abs(ours - theirs) <= REFERENCE_ERROR * scale
            quantity = f"{symbol}, {one['program']}, {one['elements']} elements"
            rows.append(Row(quantity, f"{theirs:.0f}", f"{ours:.0f}", _ratio(ours / theirs), agrees))
    coarse = next(one for one in read("spin") if one["program"] == "FASTSIM parabolic")
    short = 1.0 - coarse["spin_moment"] / own["spin_moment"]
    meaning = (
        "At the spin of an inclined contact the exact programs agree within the error of a grid of 40 elements. "
        f"FASTSIM with its usual parabolic bound misses {rounded(100 * short, 2)} % of the moment, from which most "
        "of the friction work follows: do not take it for wear."
    )
    return Comparison("Lateral creepage with spin", "spin.csv: programs, no measurement", rows, meaning)


def _ratio(value: float) -> str:
    return rounded(value, 3)
