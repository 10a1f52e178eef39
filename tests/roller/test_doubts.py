"""Values that are allowed but unusual are asked about, with the unit that may have been meant."""

from __future__ import annotations

import numpy as np
import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.materials import load_database
from trackroller.roller.doubts import OF_FAMILY, doubts, doubts_of_case

STEEL = "1.7225-normalised"


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
    ],
)
def test_a_wrong_unit_is_asked_about(given, words):
    (told,) = doubts_of_case(tr.Case(**given), load_database())
    assert words in told


def test_usual_values_are_not_asked_about():
    for material in load_database().materials:
        case = tr.Case(roller_material=material, friction_coefficient="typical", guide_curve_radius=float("inf"))
        assert doubts_of_case(case, load_database()) == []
    assert doubts_of_case(tr.Case(roller_profile_radius=float("inf"), motor_force=0), load_database()) == []
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
    assert doubts({"guide_profile": profile | {"smooth": "auto"}}) == []


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
