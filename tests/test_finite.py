"""Every number of a user passes one check: inf and NaN are refused at each door, unless a declaration allows them."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import openpyxl
import pytest
import xarray as xr
import yaml

import trackroller as tr
from trackroller.app.picture import read
from trackroller.cli.case import case_of
from trackroller.materials import add_material
from trackroller.materials.properties import ALTERNATIVES, PROPERTIES
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
    return tr.load_study({"name": "x", "design": "table", "table": "cases.csv"})


def of_workbook(name: str, value: float) -> tr.Study:
    """Return the study of a workbook; a cell holds inf and NaN as text only."""
    book = openpyxl.Workbook()
    for cell in (name, 1.0, str(value)):
        book.active.append([cell])
    book.save("cases.xlsx")
    return tr.load_study({"name": "x", "design": "table", "table": "cases.xlsx"})


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
    "design": "sobol",
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
    "design": "optimise",
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
FILES = {
    "case": (CASE, lambda values: to_table(checked_case(values)[0])),  # the table has the values of the materials
    "study": (STUDY, lambda values: tr.load_study(values)),
    "search": (SEARCH, lambda values: tr.load_study(values)),
    "spectrum": (SPECTRUM, lambda values: Spectrum.from_dict(values)),
}


def leaves(value: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the places of all numbers in nested mappings and lists."""
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, entry in entries:
        yield from leaves(entry, (*place, key))
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        yield place


def changed(given: dict[str, Any], place: tuple[Any, ...], value: float) -> dict[str, Any]:
    """Return nested values with another one at a place."""
    out = copy.deepcopy(given)
    inside: Any = out
    for key in place[:-1]:
        inside = inside[key]
    inside[place[-1]] = value
    return out


@pytest.mark.parametrize("kind", FILES)
def test_no_number_of_a_file_is_infinite_or_nan_wherever_it_stands(kind):
    given, check = FILES[kind]
    check(copy.deepcopy(given))
    taken = []
    for place in leaves(given):
        straight = {"parabola", "roller_profile_radius"} & set(place)  # of infinite radius
        for value in BAD:
            if straight and math.isinf(value) and "uniform" not in place:
                continue
            try:
                check(changed(given, place, value))
            except tr.InputError:
                continue
            taken.append((place, value))
    assert not taken
