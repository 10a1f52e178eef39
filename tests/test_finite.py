"""Every number of a user passes one check: inf and NaN are refused at each door, unless a declaration allows them."""

from __future__ import annotations

import contextlib
import copy
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import openpyxl
import pandas as pd
import pytest
import xarray as xr
import yaml

import trackroller as tr
from trackroller.app.picture import read
from trackroller.carriage.file import load_carriage
from trackroller.cli.case import case_of
from trackroller.damage.bearing import FIELD as BEARING
from trackroller.damage.catalogue import FIELD as CATALOGUE
from trackroller.materials import add_material
from trackroller.materials.properties import ALTERNATIVES, PROPERTIES
from trackroller.numerics.units import split_quantity
from trackroller.one_patch.inputs import checked_patch
from trackroller.parameters import PARAMETERS
from trackroller.parameters.sizes import SIZES
from trackroller.roller.case import to_table
from trackroller.roller.settings import checked_case
from trackroller.study.spectrum.file import Spectrum

BAD = (math.inf, -math.inf, math.nan)
QUICK = {"contact_model": "sliding", "accuracy": "preview"}
STEEL = "1.7225-normalised"


def of_factor(name: str, spec: dict[str, Any], **keys: Any) -> tr.Study:
    """Return a study with one factor."""
    return tr.load_study({"name": "x", "factors": {name: spec}} | keys)


def of_csv(name: str, value: float) -> tr.Study:
    Path("cases.csv").write_text(f"{name}\n1\n{value}\n")
    return tr.load_study({"name": "x", "method": "table", "table": "cases.csv"})


def of_workbook(name: str, value: float) -> tr.Study:
    """Return the study of a workbook; a cell holds inf and NaN as text only."""
    book = openpyxl.Workbook()
    for cell in (name, 1.0, str(value)):
        book.active.append([cell])
    book.save("cases.xlsx")
    return tr.load_study({"name": "x", "method": "table", "table": "cases.xlsx"})


def of_file(name: str, value: float) -> Any:
    Path("case.yaml").write_text(yaml.safe_dump({name: value}))
    return case_of(Path("case.yaml"), None)


DOORS = {
    "Case": lambda name, value: tr.Case(**{name: value}),
    "Case.from_dict": lambda name, value: tr.Case.from_dict({name: value}),
    "solve": lambda name, value: tr.solve({name: value}, ("forces",), **QUICK),
    "case file": of_file,
    "--set": lambda name, value: case_of(None, [f"{name}={value}"]),
    "page": lambda name, value: read({name: value}),
    "text of the page": lambda name, value: read({name: str(value)}),
    "base": lambda name, value: tr.load_study({"name": "x", "base": {name: value}}),
    "values": lambda name, value: of_factor(name, {"values": [1, value]}),
    "linspace": lambda name, value: of_factor(name, {"linspace": [1, value, 3]}),
    "uniform": lambda name, value: of_factor(name, {"uniform": [1, value]}, design="lhs"),
    "mean": lambda name, value: of_factor(name, {"normal": [value, 1]}, design="lhs"),
    "spread": lambda name, value: of_factor(name, {"normal": [1, value]}, design="lhs"),
    "weights": lambda name, value: of_factor(name, {"values": [1, 2], "weights": [1, value]}, design="lhs"),
    "table": of_csv,
    "workbook": of_workbook,
    "spectrum": lambda name, value: Spectrum.from_dict(
        {"base": {name: value}, "blocks": [{"name": "a", "distance": 1}]}
    ),
    "block": lambda name, value: Spectrum.from_dict({"blocks": [{"name": "a", "distance": 1, name: value}]}),
    "data frame": lambda name, value: tr.solve(pd.DataFrame({name: [1, value]}), ("forces",), **QUICK),
    "row of a data frame": lambda name, value: tr.Case(**pd.DataFrame({name: [1, value]}).iloc[1]),
    "column of a data frame": lambda name, value: of_factor(name, {"values": pd.Series([1, value])}),
    "data frame of blocks": lambda name, value: Spectrum.from_dict(
        {"blocks": pd.DataFrame({"name": ["a", "b"], "distance": [1, 1], name: [1, value]})}
    ),
    "between": lambda name, value: tr.find({"motor_force": 0}, name, "max_pressure < 900", between=(1, value), **QUICK),
}


@pytest.mark.parametrize("door", DOORS)
def test_no_parameter_is_infinite_or_nan_at_any_door(door, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    taken = []
    for name, parameter in (*PARAMETERS.items(), *SIZES.items()):
        for value in BAD:
            if parameter.allow_infinite and math.isinf(value):
                continue
            try:
                DOORS[door](name, value)
            except tr.InputError:
                continue
            taken.append((name, value))
    assert not taken


@pytest.mark.parametrize("name", [name for name, one in PARAMETERS.items() if one.allow_infinite])
def test_a_straight_profile_stays(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for door in ("Case", "Case.from_dict", "solve", "case file", "--set", "page", "text of the page", "base", "values"):
        DOORS[door](name, math.inf)
    for door in ("table", "workbook", "spectrum"):
        DOORS[door](name, math.inf)


def test_an_infinite_number_of_an_array_is_refused_and_nan_is_a_value_that_is_not_given():
    for name, parameter in PARAMETERS.items():
        for value in BAD:
            if (parameter.allow_infinite and math.isinf(value)) or (parameter.allow_missing and math.isnan(value)):
                continue
            with pytest.raises(tr.InputError, match=name):
                tr.solve(xr.Dataset({name: ("case", [1.0, value])}), ("forces",), **QUICK)


@pytest.mark.parametrize("name", [*PROPERTIES, *ALTERNATIVES])
def test_no_value_of_a_material_is_infinite_or_nan(name, tmp_path):
    for value in BAD:
        with pytest.raises(tr.InputError, match=name):
            tr.solve({"roller_material": {"like": STEEL, name: value}}, ("forces",), **QUICK)
        with pytest.raises(tr.InputError, match=name):
            add_material(tmp_path / "m.yaml", "own", like=STEEL, **{name: value})
        with pytest.raises(tr.InputError, match=name):
            guess = {"value": 1, "range": [0.5, value], "placeholder": True}
            add_material(tmp_path / "m.yaml", "own", like=STEEL, **{name: guess})
    assert not list(tmp_path.iterdir())


CASE = {
    "radial_force": -200.0,
    "friction_law": {"kind": "exponential", "lowest": 0.5, "speed": 100.0},
    "guide_profile": {"parabola": 6.0},
    "roller_profile": {"points": [[-2.0, 0.3], [-1.0, 0.08], [0.0, 0.0], [1.0, 0.08], [2.0, 0.3]], "smooth": 0.01},
    "bearing": {
        "rows": 2,
        "row_distance": 8.0,
        "kind": "ball",
        "dynamic_rating": 3000.0,
        "static_rating": 1500.0,
        "e": 0.3,
        "X": 0.56,
        "Y": 1.5,
        "X0": 0.6,
        "Y0": 0.5,
        "permissible_moment": 900.0,
    },
    "catalogue": {
        "radial_force": 800.0,
        "axial_force": 300.0,
        "basic_life": 100.0,
        "moment": 900.0,
        "law": "dry",
        "offset": 0.03,
    },
    "wear_table": {"work_rate": [0.0, 1.0], "roller": [0.0, 1.0], "guide": [0.0, 1.0]},
    "roller_material": {"like": STEEL, "sn_points": [[700.0, 1e4], [500.0, 1e6]]},
    "duty": {"hours_per_day": 16.0, "days_per_year": 250.0},
    "requirement": {"pair_life_hours": {"min": 100.0}},
    "failure_probability": 0.1,
    "accuracy": 0.02,
}
STUDY = {
    "name": "x",
    "seed": 1,
    "samples": 16,
    "method": "sobol",
    "chunk_size": 4,
    "base": {"radial_force": -200.0},
    "factors": {
        "axial_force": {"uniform": [0.0, 20.0]},
        "friction_coefficient": {"truncnormal": [0.1, 0.02, 0.01, 0.3]},
        "guide_profile_radius": {"triangular": [5.8, 6.0, 6.2]},
        "roller_profile_radius": {"values": [-7.0, -8.0], "weights": [1.0, 2.0]},
    },
    "rank_correlations": [["axial_force", "guide_profile_radius", 0.5]],
    "requirement": {"pair_life_hours": {"min": 100.0, "probability": 0.9}},
    "duty": {"hours_per_day": 16.0, "days_per_year": 250.0},
    "constraints": ["max_pressure_1 < 900"],
    "until": {"of": ["max_pressure_1"], "half_width": 0.1, "at_most": 64, "hours": 1.0},
    "failure_probability": 0.1,
}
SEARCH = {
    "name": "x",
    "method": "optimise",
    "factors": {"roller_profile_radius": {"uniform": [-9.0, -6.5]}, "axial_force": {"normal": [10.0, 1.0]}},
    "samples": 8,
    "goals": {"pair_life_hours": "max"},
    "budget": {"designs": 16, "population": 4, "hours": 2.0},
    "requirement": {"pair_life_hours": {"min": "100 h", "probability": 0.9}, "max_pressure_1": {"max": 900.0}},
}
SPECTRUM = {
    "base": {"radial_force": -200.0},
    "blocks": [{"name": "a", "distance": 1.0, "radial_force": -100.0}, {"name": "b", "distance": 2.0}],
    "duty": {"hours_per_day": 16.0, "days_per_year": 250.0},
}
_ROLLER = {"pushes": [0.0, 0.0, -1.0], "x_R": [0.0, 1.0, 0.0]}
CARRIAGE = {
    "mass": {"value": 40.0, "at": [0.0, 0.0, 60.0]},
    "payloads": [{"value": 60.0, "at": [80.0, 0.0, 150.0]}],
    "drive": {"at": [0.0, 0.0, -20.0]},
    "rollers": {
        "FL": _ROLLER | {"at": [150.0, 40.0, 0.0], "stiffness": {"radial": 1e4, "axial": 1e3}},
        "FR": _ROLLER | {"at": [150.0, -40.0, 0.0], "bearing": {"radial": 1e4, "axial": 1e3}, "stiffness": 1e4},
        "RL": _ROLLER | {"at": [-150.0, 40.0, 0.0], "structure": {"radial": 1e4, "axial": 1e3}, "stiffness": 1e4},
        "RR": _ROLLER | {"at": [-150.0, -40.0, 0.0], "catalogue": CASE["catalogue"], "stiffness": 1e4},
        "lower": _ROLLER
        | {"at": [150.0, 40.0, -9.0], "pushes": [0.0, 0.0, 1.0], "roller": {"bearing": CASE["bearing"]}},
    },
    "preload": [{"pair": ["FL", "lower"], "force": 100.0}],
    "cases": [
        {
            "name": "a",
            "share": 0.4,
            "acceleration": 2.0,
            "speed": 1.0,
            "gradient": "2 %",
            "cant": "1 deg",
            "payload": 0.5,
            "forces": [{"force": [0.0, 50.0, 0.0], "at": [0.0, 0.0, 200.0]}],
        },
        {"name": "b", "share": 0.6, "speed": 1.0, "curve_radius": 2000.0},
    ],
    "distance": 1000.0,
    "duty": {"strokes_per_day": 400.0, "stroke": 0.8, "days_per_year": 250.0},
}
PATCH = {
    "normal_force": 1000.0,
    "curvature_rolling": "0.02 1/mm",
    "curvature_lateral": 0.01,
    "materials": {"youngs_modulus": "210 GPa", "poisson_ratio": 0.3},
    "friction_coefficient": 0.3,
    "longitudinal_creepage": [0.001, "0.2 %"],
    "lateral_creepage": 0.0,
    "spin": 0.001,
    "velocity": 60.0,
    "layer_flexibility": 1e-6,
}
DISCS = {key: value for key, value in PATCH.items() if key != "spin"} | {"curvature_lateral": 0.0, "width": 5.0}
AXES = {key: value for key, value in PATCH.items() if not key.startswith("curvature")} | {"semi_axes": [1.0, "2 mm"]}
FILES = {
    "carriage": (CARRIAGE, load_carriage),
    "case": (CASE, lambda values: to_table(checked_case(values)[0])),  # the table has the values of the materials
    "study": (STUDY, lambda values: tr.load_study(values)),
    "search": (SEARCH, lambda values: tr.load_study(values)),
    "spectrum": (SPECTRUM, lambda values: Spectrum.from_dict(values)),
    "patch": (PATCH, lambda values: checked_patch(values)),
    "discs": (DISCS, lambda values: checked_patch(values)),
    "axes": (AXES, lambda values: checked_patch(values)),
}


def leaves(value: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the places of all numbers in nested mappings and lists, those with a unit too."""
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, entry in entries:
        yield from leaves(entry, (*place, key))
    if (isinstance(value, (int, float)) and not isinstance(value, bool)) or split_quantity(value):
        yield place


def changed(given: dict[str, Any], place: tuple[Any, ...], value: float) -> dict[str, Any]:
    """Return nested values with another one at a place."""
    out = copy.deepcopy(given)
    inside: Any = out
    for key in place[:-1]:
        inside = inside[key]
    quantity = split_quantity(inside[place[-1]])
    inside[place[-1]] = value if quantity is None else f"{value} {quantity[1]}"
    return out


@pytest.mark.parametrize("kind", FILES)
def test_no_number_of_a_file_is_infinite_or_nan_wherever_it_stands(kind):
    given, check = FILES[kind]
    check(copy.deepcopy(given))
    taken = []
    for place in leaves(given):
        straight = {"parabola", "roller_profile_radius", "curve_radius"} & set(place)  # of infinite radius
        for value in BAD:
            if straight and math.isinf(value) and "uniform" not in place:
                continue
            try:
                check(changed(given, place, value))
            except tr.InputError:
                continue
            taken.append((place, value))
    assert not taken


@pytest.mark.parametrize("kind", FILES)
def test_a_number_out_of_all_proportion_is_taken_or_refused_wherever_it_stands(kind):
    given, check = FILES[kind]
    for place in leaves(given):
        for value in (1e300, -1e300, 1e-300, 0.0):
            with contextlib.suppress(tr.InputError):  # another error fails the test
                check(changed(given, place, value))


UNDER = {"load_type": "axial", "stress_ratio": -1.0, "like": STEEL}
COUPONS = {"amplitude": [900.0, 900, 800, 800, 700, 700], "cycles": [9e4, 1.3e5, 2e5, 3.5e5, 8e5, 1e6]}
BENCH = {
    "radial_force": [-120.0, -150, -150, -180, -180, -210],
    "travel_from": [130.0, 100, 50, 41.5, 25, 43.4],
    "travel_to": [130.0, 150, 75, 41.5, 50, 43.4],
    "end": ["fatigue roller"] * 6,
}
RIG = {"motor_force": 0.0, "friction_coefficient": 0.1, "axial_force": 20.0, "contact_model": "sliding"}
TABLES = {
    "S-N tests": (COUPONS | {"failed": [True] * 6}, lambda table: tr.fit_sn(table, **UNDER)),
    "bench": (BENCH, lambda table: tr.fit_bench(table, "fatigue_strength", base=RIG)),
}


@pytest.mark.parametrize("kind", TABLES)
@pytest.mark.parametrize("made", [pd.DataFrame, dict], ids=["data frame", "columns"])
def test_no_number_of_a_table_of_tests_is_infinite_or_nan(kind, made):
    given, fit = TABLES[kind]
    taken = []
    for place in leaves(given):
        for value in BAD:
            try:
                fit(made(changed(given, place, value)))
            except tr.InputError:
                continue
            taken.append((place, value))
    assert not taken


def test_no_argument_of_a_fit_is_infinite_or_nan():
    fit = tr.fit_sn(COUPONS | {"failed": [True] * 6}, **UNDER)
    plan = ([RIG], RIG)
    doors = {
        "stress_ratio": lambda value: tr.fit_sn(COUPONS, **UNDER | {"stress_ratio": value}),
        "slope": lambda value: tr.fit_sn(COUPONS, **UNDER, slope=value),
        "scatter_in_cycles": lambda value: tr.fit_sn(COUPONS, **UNDER, scatter_in_cycles=value),
        "prior": lambda value: tr.fit_sn(COUPONS, **UNDER, prior={"slope": [8, value]}),
        "slope of a bench": lambda value: tr.fit_bench(BENCH, "fatigue_strength", base=RIG, slope=value),
        "base of a bench": lambda value: tr.fit_bench(BENCH, "fatigue_strength", base=RIG | {"axial_force": value}),
        "amplitude": lambda value: fit.interval("cycles", amplitude=value),
        "cycles": lambda value: fit.interval("amplitude", cycles=value),
        "confidence": lambda value: fit.interval("slope", confidence=value),
        "failure_probability": lambda value: fit.interval("cycles", amplitude=700, failure_probability=value),
        "life": lambda value: fit.life_hours(RIG, failure_probability=value),
        "design of a life": lambda value: fit.life_hours(RIG | {"axial_force": value}),
        "tests": lambda value: tr.next_tests(fit, *plan, tests=value),
        "seed": lambda value: tr.next_tests(fit, *plan, seed=value),
        "candidates": lambda value: tr.next_tests(fit, [RIG | {"axial_force": value}], RIG),
        "end of wear": lambda value: tr.wear({"roller_material": "POM"}, to=value, **QUICK),
    }
    taken = []
    for door, act in doors.items():
        for value in BAD:
            try:
                act(value)
            except tr.InputError:
                continue
            taken.append((door, value))
    assert not taken


FIELDS = [(field, number) for field in (BEARING, CATALOGUE) for number in field.numbers]


@pytest.mark.parametrize(("field", "number"), FIELDS, ids=[f"{field.name}.{one.name}" for field, one in FIELDS])
def test_no_value_of_a_bearing_or_catalogue_is_infinite_or_nan_at_any_door(field, number, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for value in BAD:
        given = CASE[field.name] | {number.name: value}
        Path("case.yaml").write_text(yaml.safe_dump({field.name: given}))
        doors = {
            "Case": lambda given=given: tr.Case(**{field.name: given}),
            "solve": lambda given=given: tr.solve({field.name: given}, ("forces",), **QUICK),
            "row": lambda given=given: tr.Case(**{field.name: pd.DataFrame([given]).iloc[0]}),
            "file": lambda: case_of(Path("case.yaml"), None),
            "--set": lambda given=given: case_of(
                None, [f"{field.name}={yaml.safe_dump(given, default_flow_style=True)}"]
            ),
            "page": lambda given=given: read({field.name: given}),
            "base": lambda given=given: tr.load_study({"name": "x", "base": {field.name: given}}),
            "level": lambda given=given: of_factor(field.name, {"values": [CASE[field.name], given]}),
            "spectrum": lambda given=given: Spectrum.from_dict({"base": {field.name: given}, **BLOCKS}),
        }
        for door, act in doors.items():
            with pytest.raises(tr.InputError, match=number.name):
                pytest.fail(f"{door} takes {value}: {act()}")


BLOCKS = {"blocks": [{"name": "a", "distance": 1.0}]}
