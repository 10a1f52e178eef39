"""Values that are allowed but unusual are asked about, with the unit that may have been meant."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.materials import load_database
from trackroller.roller.doubts import OF_FAMILY, doubts, doubts_of_case

STEEL = "1.7225-normalised"
BEARING = {"rows": 2, "row_distance": 8, "kind": "ball", "dynamic_rating": 3000, "static_rating": 1500}
BEARING |= {"e": 0.3, "X": 0.56, "Y": 1.5, "X0": 0.6, "Y0": 0.5}
ONE_ROW = BEARING | {"rows": 1}
CATALOGUE = {"radial_force": 800, "axial_force": 300, "moment": 2000, "basic_life": 100, "law": "dry"}
CURVE = {"like": STEEL, "fatigue_limit": 300, "cycles_at_fatigue_limit": 2e6}


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"roller_material": {"like": STEEL, "youngs_modulus": 200}}, "200 times below the usual 40000"),
        ({"roller_material": {"like": STEEL, "youngs_modulus": 200}}, "write '200 GPa' or 200000"),
        ({"guide_material": {"like": "POM", "tensile_strength": 0.07}}, "write '0.07 GPa' or 70."),
        ({"guide_material": {"like": "PA6", "density": 1.15}}, "write '1.15 g/cm3' or 1150"),
        ({"radial_force": -0.45}, "write '-0.45 kN' or -450"),
        ({"axial_force": 0.035}, "write '0.035 kN' or 35"),
        ({"motor_force": -0.02}, "write '-0.02 kN' or -20"),
        ({"contact_angle": 0.6}, "write '0.6 rad' or 34.3775"),
        ({"velocity": 0.25}, "write '0.25 m/s' or 15"),
        ({"friction_coefficient": 1.9}, "write '1.9 %' or 0.019"),
        ({"ambient_temperature": 293.15}, "write '293.15 K' or 20"),
        ({"cooled_area": 0.004}, "write '0.004 m2' or 4000"),
        ({"permissible_wear_depth": 50}, "write '50 um' or 0.05"),
        ({"permissible_radial_force": 1.2}, "if 1.2 kN is meant, write '1.2 kN' or 1200"),
        (
            {"bearing": BEARING | {"dynamic_rating": 3}},
            "bearing.dynamic_rating = 3 N .* if 3 kN is meant, write '3 kN' or 3000",
        ),
        ({"bearing": BEARING | {"static_rating": 1.5}}, "if 1.5 kN is meant, write '1.5 kN' or 1500"),
        ({"bearing": ONE_ROW | {"permissible_moment": 2}}, "if 2 Nm is meant, write '2 Nm' or 2000"),
        ({"catalogue": CATALOGUE | {"radial_force": 0.8}}, "if 0.8 kN is meant, write '0.8 kN' or 800"),
        ({"catalogue": CATALOGUE | {"axial_force": 0.3}}, "if 0.3 kN is meant, write '0.3 kN' or 300"),
        ({"catalogue": CATALOGUE | {"moment": 2}}, "if 2 Nm is meant, write '2 Nm' or 2000"),
        (
            {"catalogue": CATALOGUE | {"basic_life": 1e5}},
            r"catalogue.basic_life = 100000 km is 5 times above .* write '100000 m' or 100\.",
        ),
        ({"catalogue": CATALOGUE | {"basic_life": "174 m"}}, "catalogue.basic_life = 0.174 km is 57.5 times below"),
        (
            {"roller_material": CURVE | {"woehler_exponent": 0.085}},
            "woehler_exponent = 0.085 .* b is meant.* write 11.8",
        ),
        ({"guide_material": CURVE | {"woehler_exponent": 0.2}}, "write 5"),
        ({"guide_material": CURVE | {"second_exponent": 0.05}}, "second_exponent = 0.05 .* b is meant.* write 20"),
    ],
)
def test_a_wrong_unit_is_asked_about(given, words):
    (told,) = doubts_of_case(tr.Case(**given), load_database())
    assert re.search(words, told)


def test_usual_values_are_not_asked_about():
    for material in load_database().materials:
        case = tr.Case(roller_material=material, friction_coefficient="typical", guide_curve_radius=float("inf"))
        assert doubts_of_case(case, load_database()) == []
    assert doubts_of_case(tr.Case(roller_profile_radius=float("inf"), motor_force=0), load_database()) == []
    complete = {"bearing": ONE_ROW | {"permissible_moment": 3000}, "catalogue": CATALOGUE, "cooled_area": 8000}
    assert (
        doubts_of_case(tr.Case(**complete, ambient_temperature=-20, permissible_wear_depth=0.05), load_database()) == []
    )
    own = {"like": STEEL, "family": "rubber", "youngs_modulus": 8}
    assert doubts_of_case(tr.Case(roller_material=own), load_database()) == [], "an own family has no usual values"
    assert set(OF_FAMILY) <= set(load_database().families())


@pytest.mark.parametrize("noise", [5e-5, 4e-4, 3e-3])
def test_unsmoothed_points_are_asked_about_with_their_noise(noise):
    x = np.linspace(-5, 5, 401)
    z = np.sqrt(49 - x**2) + np.random.default_rng(4).normal(0, noise, x.size)
    profile = {"points": np.column_stack((x, z)).tolist()}
    (told,) = doubts({"guide_profile": profile})
    assert float(told.split("scatter by ")[1].split(" µm")[0]) == pytest.approx(1e3 * noise, rel=0.2)
    assert "smooth: auto" in told
    left = doubts({"guide_profile": profile | {"smooth": "auto"}})
    assert [" ".join(left).count("after smoothing"), len(left)] == [noise > 1e-3] * 2


@pytest.mark.parametrize("spacing", [0.01, 0.1, 0.5, 1.0])
def test_designed_points_are_not_taken_for_noisy_ones(spacing):
    x = np.arange(-5, 5 + spacing / 2, spacing)
    for z in (np.sqrt(49 - x**2), x**2 / -12, np.round(np.sqrt(49 - x**2), 8)):
        assert doubts({"guide_profile": {"points": np.column_stack((x, z)).tolist()}}) == []


def test_small_forces_beside_usual_ones_are_not_asked_about():
    assert doubts({"axial_force": np.linspace(0, 40, 4001), "motor_force": [0.0, -0.01, -25.0]}) == []


def test_solve_plan_and_run_ask(tmp_path):
    told = trackroller("plan", "--set", "velocity=0.2", "--set", "contact_model=sliding", cwd=tmp_path).stderr
    assert "doubtful: velocity = 0.2 m/min is 1.5 times below" in told
    text = "{name: d, base: {material_pair: [PA6, POM]}, outputs: [forces], contact_model: sliding, "
    text += "factors: {contact_angle: {values: [0.7, 30]}, velocity: {values: [0.1, 70]}}}"
    (tmp_path / "d.yaml").write_text(text)
    for command in (["plan", "d.yaml"], ["run", "d.yaml", "-q"]):
        told = trackroller(*command, cwd=tmp_path).stderr
        assert "0.7 deg" in told and "0.1 m/min" in told and "youngs" not in told


def test_a_study_and_a_spectrum_ask_about_ratings():
    study = {"name": "d", "outputs": ["bearing"], "base": {"bearing": BEARING | {"dynamic_rating": 3}}}
    study["factors"] = {"radial_force": {"values": [-200, -800]}}
    (told,) = tr.load_study(study).doubts()
    assert "beside the radial force of 200 N; if 3 kN is meant" in told
    heavy = study | {"base": {"bearing": BEARING}, "factors": {"radial_force": {"values": [-200, -8000]}}}
    assert tr.load_study(heavy).doubts() == [], "a design may be loaded above its rating"


def test_a_negative_exponent_of_basquin_is_refused_with_the_exponent_to_write():
    with pytest.raises(tr.InputError, match=r"k = -1/b: write 11.8"):
        load_database().material(CURVE | {"woehler_exponent": -0.085})


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"roller_profile_radius": 8.5}, "if a groove is meant, write -8.5"),
        ({"guide_profile_radius": 10, "axis_distance": 30, "roller_profile_radius": 19}, "1.9 times that of the guide"),
        ({"roller_profile": {"arc": 7}}, "if a groove is meant, write arc: -7"),
        ({"roller_profile": {"parabola": 7}}, "write parabola: -7"),
        ({"roller_profile": {"arcs": [{"radius": 7, "to": 0.2}, {"radius": 6.3}]}}, "write radius: -7"),
        (
            {"roller_profile": {"points": [[x, x * x / 14] for x in np.linspace(-1, 1, 21)], "frame": "contact"}},
            "sign of z",
        ),
    ],
)
def test_a_convex_roller_with_the_radius_of_a_groove_is_asked_about(given, words):
    (told,) = doubts_of_case(tr.Case(**given), load_database())
    assert "convex roller" in told and words in told


@pytest.mark.parametrize(
    "given", [{"roller_profile_radius": r} for r in (5, 40, math.inf, -8.5)] + [{"roller_profile": {"arc": -7}}]
)
def test_other_rollers_are_not_asked_about(given):
    assert doubts_of_case(tr.Case(**given), load_database()) == []


def test_convex_rollers_of_a_study_are_compared_with_their_own_guide():
    rows = {"guide_profile_radius": np.array([6.0, 20.0]), "roller_profile_radius": np.array([-8.0, 8.5])}
    assert not doubts(rows)
    assert "write -8.5" in doubts({"roller_profile_radius": np.array([-8.0, 8.5, 40.0])})[0]


@pytest.mark.parametrize("body", ["guide_profile", "roller_profile"])
def test_points_in_another_unit_are_asked_about(body):
    sign = 1.0 if body == "roller_profile" else -1.0
    points = [[x, sign * -x * x / 14] for x in np.linspace(-1.5, 1.5, 31)]
    for size, words in ((1.0, []), (1 / 25.4, ["0.118 mm wide"]), (1e3, ["3e+03 mm wide"])):
        profile = {"points": (size * np.array(points)).tolist(), "frame": "contact"}
        told = doubts_of_case(tr.Case(**{body: profile}), load_database())
        assert len(told) == len(words) and all(word in one for word, one in zip(words, told, strict=True))


def test_an_axle_inside_the_rail_is_asked_about():
    (told,) = doubts({"axis_distance": 5.8, "guide_profile_radius": 6.0})
    assert "the axle lies inside the rail" in told
    assert doubts({"axis_distance": 6.2, "guide_profile_radius": 6.0}) == []
    (told,) = doubts({"axis_distance": np.array([8.0, 8.0]), "guide_profile_radius": np.array([6.0, 9.0])})
    assert "axis_distance = 8 mm does not exceed guide_profile_radius = 9 mm" in told
