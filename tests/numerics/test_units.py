"""Quantities with units are converted to the unit of their parameter, in every file, or refused by name."""

from __future__ import annotations

import math

import pytest
from command_line import trackroller
from hypothesis import given
from hypothesis import strategies as st

import trackroller as tr
from trackroller.damage import LIMITS
from trackroller.errors import InputError
from trackroller.materials import add_material, load_database
from trackroller.materials.properties import ALTERNATIVES, PROPERTIES
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.units import in_unit, split_quantity
from trackroller.parameters import PARAMETERS
from trackroller.study.spectrum.file import load_spectrum


@pytest.mark.parametrize(
    ("text", "unit", "number"),
    [
        ("0.83 kN", "N", 830.0),
        ("-1.7kN", "N", -1700.0),
        ("71 GPa", "MPa", 71000.0),
        ("4.2e8 Pa", "MPa", 420.0),
        ("1.2e3 N/mm^2", "MPa", 1200.0),
        ("206 kN/mm²", "MPa", 206000.0),
        ("35 deg", "deg", 35.0),
        ("0.5 rad", "deg", math.degrees(0.5)),
        ("41°", "deg", 41.0),
        ("1.5 m/s", "m/min", 90.0),
        ("9 km/h", "m/min", 150.0),
        ("0.5 kN*mm", "N mm", 500.0),
        ("3.5 Nm", "N mm", 3500.0),
        ("2 kNmm", "N mm", 2000.0),
        ("17 %", "-", 0.17),
        ("68 degF", "degC", 20.0),
        ("293.15 K", "degC", 20.0),
        ("1 ft", "mm", 304.8),
        ("-7000 µm", "mm", -7.0),
        ("4 1/min", "1/h", 240.0),
        ("4/min", "1/h", 240.0),
        ("0.9 kg/dm3", "kg/m3", 900.0),
        ("0.25 W/(m*K)", "W/(m K)", 0.25),
        ("3 a", "h", 3 * 365.25 * 24),
        ("300 HBW", "HB", 300.0),
        ("30 Msi", "MPa", 30e6 * 4.4482216152605 / 645.16),
        ("50 ksi", "MPa", 50e3 * 4.4482216152605 / 645.16),
        ("5 kp", "N", 49.03325),
        ("0.2 g", "m/s2", 1.96133),
        ("-2g", "m/s2", -19.6133),
    ],
)
def test_a_unit_is_converted(text, unit, number):
    value, own = split_quantity(text)
    assert in_unit(float(value), own, unit, "field") == pytest.approx(number, rel=1e-14)


@pytest.mark.parametrize("text", ["1e400 N", "1e400kN", "1e-400 N", "-1e400"])
def test_a_number_that_no_computer_holds_is_refused_by_name(text):
    with pytest.raises(InputError, match=r"axial_force = .* is too (large|small) for a number of the computer"):
        number_or_nan(text, "N", "axial_force")


def test_a_number_of_400_figures_is_not_shown_in_full():
    error = InputError("axial_force", "9" * 400, "a number")
    assert len(str(error)) < 250 and error.value == "9" * 400


def test_a_round_number_stays_round():
    """70 GPa and 70000 MPa must have one fingerprint."""
    for n in range(1, 400):
        assert in_unit(n / 10, "GPa", "MPa", "E") == n * 100.0
        assert in_unit(float(n), "m/s", "m/min", "v") == n * 60.0


def test_a_standard_deviation_has_no_offset():
    assert in_unit(4.0, "K", "degC", "theta", difference=True) == 4.0
    assert in_unit(9.0, "degF", "degC", "theta", difference=True) == pytest.approx(5.0)


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("70 kN", "MPa"),
        ("30 deg", "-"),
        ("600 rpm", "1/h"),  # pint counts in radians
        ("30 %", "deg"),
        ("5 kn", "N"),  # a knot
        ("70 Mpa", "MPa"),
        ("1 kNm", "N"),
        ("2 W/(m", "N"),
        ("3 HV", "HB"),
        ("0.2 g", "N"),  # neither a mass nor an acceleration is a force
    ],
)
def test_a_wrong_unit_is_refused_by_name(text, unit):
    value, own = split_quantity(text)
    with pytest.raises(InputError) as error:
        in_unit(float(value), own, unit, "the_field")
    assert error.value.field == "the_field" and error.value.value == own


@given(st.text(alphabet="kNmMPa/*^()23.- °%eE", max_size=12))
def test_any_unit_is_read_or_refused(unit):
    if parts := split_quantity(f"5 {unit}"):
        try:
            assert isinstance(in_unit(float(parts[0]), parts[1], "N", "field"), float)
        except InputError as error:
            assert error.field == "field"


def test_every_declared_unit_is_known():
    fields = [*PARAMETERS.values(), *PROPERTIES.values(), *ALTERNATIVES.values()]
    fields += [number for limit in LIMITS.values() for own in limit.mappings for number in own.numbers]
    for parameter in fields:
        if parameter.unit != "-":
            assert in_unit(2.0, f"{parameter.unit} ", parameter.unit, parameter.name) == 2.0


def test_a_case_and_its_mappings_take_units():
    case = tr.Case(
        radial_force="-0.21 kN",
        contact_angle="0.6 rad",
        velocity="1.2 m/s",
        friction_coefficient="12 %",
        friction_law={"kind": "exponential", "speed": "0.2 m/s", "lowest": "40 %"},
        guide_profile={"points": [[x / 2 - 5, -(x**2)] for x in range(20)], "smooth": "2 µm", "width": "1.2 cm"},
        bearing={"rows": 1, "kind": "ball", "dynamic_rating": "3 kN", "static_rating": "1.5 kN", "e": 0.3}
        | {"X": 0.56, "Y": 1.5, "X0": 0.6, "Y0": 0.5, "permissible_moment": "2 N*m"},
    )
    assert (case.radial_force, case.velocity, case.friction_coefficient) == (-210.0, 72.0, 0.12)
    assert case.contact_angle == pytest.approx(math.degrees(0.6), rel=1e-14)
    assert (case.friction_law["speed"], case.friction_law["lowest"]) == (200.0, 0.4)
    assert (case.guide_profile["smooth"], case.guide_profile["width"]) == (0.002, 12.0)
    assert (case.bearing["dynamic_rating"], case.bearing["permissible_moment"]) == (3000.0, 2000.0)
    with pytest.raises(InputError, match=r"axial_force = 'mm' .*\. Allowed: a unit that can be converted to N"):
        tr.Case(axial_force="30 mm")


def test_a_study_takes_units():
    study = tr.load_study(
        {
            "name": "u",
            "base": {"axis_distance": "2.2 cm", "radial_force": "-0.3 kN"},
            "factors": {
                "axial_force": {"values": ["0.01 kN", 20]},
                "velocity": {"linspace": ["0.5 m/s", "1.5 m/s", 3]},
                "ambient_temperature": {"values": ["68 degF"]},
            },
            "outputs": ["heat"],
        }
    )
    design = study.design()
    assert sorted(set(design["axial_force"].values)) == [10.0, 20.0]
    assert sorted(set(design["velocity"].values)) == [30.0, 60.0, 90.0]
    assert design["axis_distance"].values[0] == 22.0
    assert tr.load_study(study.as_dict()).merged() == study.merged()
    normal = {"ambient_temperature": {"truncnormal": ["20 °C", "5 K", "10 °C", "303.15 K"]}}
    drawn = tr.load_study({"name": "n", "factors": normal, "method": "lhs", "samples": 4, "outputs": ["heat"]})
    assert drawn.parsed["ambient_temperature"].numbers == pytest.approx((20.0, 5.0, 10.0, 30.0))
    with pytest.raises(InputError, match=r"factors\.velocity\.uniform = 'N'"):
        tr.load_study({"name": "w", "factors": {"velocity": {"uniform": ["5 N", "6 N"]}}, "method": "lhs"})


@pytest.mark.parametrize(
    "text",
    [
        "axial_force [kN],velocity\n0.012,1.5 m/s\n0.02,60 m/min\n",
        "axial_force [kN];velocity [m/s]\n0,012;1,5\n0,02;1\n",
        "axial_force\tvelocity [m/min]\n12\t90\n2,0e1\t60,0\n",
    ],
)
def test_a_table_takes_units_and_decimal_commas(tmp_path, text):
    (tmp_path / "cases.csv").write_text(text)
    (tmp_path / "t.yaml").write_text("{name: t, method: table, table: cases.csv, outputs: [forces]}")
    design = tr.load_study(tmp_path / "t.yaml").design()
    assert design["axial_force"].values.tolist() == [12.0, 20.0]
    assert design["velocity"].values.tolist() == [90.0, 60.0]
    (tmp_path / "cases.csv").write_text(text.replace("axial_force", "axial_force [mm]").replace("[mm] [kN]", "[mm]"))
    with pytest.raises(InputError, match="line 1: axial_force = 'mm'"):
        tr.load_study(tmp_path / "t.yaml").design()


def test_a_spectrum_takes_units(tmp_path):
    (tmp_path / "shift.csv").write_text("name;distance [km];radial_force [kN]\nfull;3,5;-0,3\nempty;1;-0,08\n")
    (tmp_path / "s.yaml").write_text("blocks: shift.csv\nbase: {guide_overrollings_per_hour: 2 1/min}\n")
    blocks = load_spectrum(tmp_path / "s.yaml").blocks
    assert [(b.distance, b.case.radial_force) for b in blocks] == [(3500.0, -300.0), (1000.0, -80.0)]
    assert blocks[0].case.guide_overrollings_per_hour == 120.0


def test_materials_take_units(tmp_path):
    path = tmp_path / "materials.yaml"
    add_material(path, "PA66", like="PA6", youngs_modulus="3.2 GPa", density="1.15 g/cm3", tensile_strength="80 N/mm2")
    assert "{value: 3.2, unit: GPa" in path.read_text()
    material = load_database(path).material("PA66")
    assert (material.youngs_modulus, material.density, material.tensile_strength) == (3200.0, 1150.0, 80.0)
    inline = {"like": "PA6", "youngs_modulus": "2.9 GPa"}
    assert load_database(path).material(inline).youngs_modulus == 2900.0
    with pytest.raises(InputError, match="youngs_modulus = 'kN'"):
        load_database(path).material({"like": "PA6", "youngs_modulus": "2.9 kN"})
    with pytest.raises(InputError, match="has its own"):
        load_database(path).material({"like": "PA6", "youngs_modulus": {"value": "2.9 GPa", "unit": "MPa"}})


def test_set_takes_units(tmp_path):
    words = ("--set", "radial_force=-0.25 kN", "--set", "contact_angle=32 deg", "--set", "contact_model=sliding")
    told = trackroller("solve", *words, "--set", "outputs=forces", "--json", cwd=tmp_path).stdout
    assert '"radial_force": {"value": -250.0' in told
    wrong = trackroller("solve", "--set", "axial_force=3 kPa", cwd=tmp_path, code=2).stderr
    assert "axial_force = 'kPa'" in wrong and "converted to N" in wrong
