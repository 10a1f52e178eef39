"""Close fits: the told errors of Hertz's theory hold against both witnesses, and the flag says where they end."""

import numpy as np
import pytest

import trackroller as tr
from trackroller.contact import close_fit
from trackroller.parameters.validity import VALIDITY
from validation.measured import grooves, pin_in_hole
from validation.measured.facts import read

ONE = np.ones(1)
GROOVES = read("close_grooves")


@pytest.mark.parametrize("degrees", [5.0, 15.0, 25.0, 33.0])
def test_the_told_error_of_the_pressure_holds_for_a_pin_in_a_hole(degrees):
    angle = np.deg2rad(degrees)
    largest, load, residual = pin_in_hole.solve(angle)
    assert residual < 1e-5
    half = np.sqrt(4.0 * load / np.pi)  # Hertz's half width, over the radius
    excess = largest / (2.0 * load / (np.pi * half)) - 1.0
    told = float(close_fit.model_error(half * ONE, close_fit.PRESSURE)[0])
    assert 0.0 < excess <= told < 1.2 * excess + 1e-3
    assert 1.0 - angle / half <= close_fit.model_error(half * ONE, close_fit.WIDTH)[0]


@pytest.mark.parametrize("row", GROOVES, ids=lambda row: str(row["groove_radius"]))
def test_the_told_errors_hold_for_wheels_in_grooves(row):
    ellipse = grooves.hertz(row["groove_radius"])
    a, b = float(ellipse.semi_axis_lateral[0]), float(ellipse.semi_axis_rolling[0])
    told = {name: float(close_fit.model_error(a / 10.0 * ONE, law)[0]) for name, law in close_fit.LAWS.items()}
    assert 0.0 < row["max_pressure"] / ellipse.max_pressure[0] - 1.0 <= told["pressure_model_error"]
    narrow = row["arc_half"] - 0.125  # half an element less
    assert 0.0 < 1.0 - narrow / a <= told["semi_axis_model_error"]
    assert abs(row["length_half"] / b - 1.0) <= told["semi_axis_rolling_model_error"]


@pytest.mark.slow
@pytest.mark.parametrize("row", GROOVES, ids=lambda row: str(row["groove_radius"]))
def test_the_told_error_of_the_slip_power_holds_for_wheels_in_grooves(row):
    """The wheel rolls freely, so that its creepage is where the driving force vanishes."""
    own = grooves.rolls_freely(row["groove_radius"])
    ratio = own["half_width"] / 10.0 * ONE
    told = float(close_fit.model_error(ratio, close_fit.SLIP_POWER)[0])
    assert 0.0 < 1.0 - row["friction_power"] / own["friction_power"] <= told
    resistance = row["friction_power"] / 0.42  # at 0.42 m/s: 0.205, 0.767 and 1.68 N at 10 kN
    assert 0.0 < 1.0 - resistance / own["rolling_resistance"] <= told


def test_an_error_ends_with_the_witnesses():
    ratio = np.array([[0.1, 0.65], [0.66, np.nan]])
    told = close_fit.model_error(ratio, close_fit.WIDTH)
    np.testing.assert_allclose(told, [[0.01, 0.11], [np.nan, np.nan]])


def flags(**values):
    ds = tr.solve(tr.Case(friction_coefficient=0.1, motor_force=0.0, **values), contact_model="sliding")
    words = {name for i, name in enumerate(VALIDITY) if int(ds["validity"]) & (1 << i)}
    return ds, words & {"half_space", "close_fit"}


def test_the_flags_follow_the_fit():
    """The closer the groove, the wider the patch: no flag, a told error, and no judgement."""
    found = []
    for groove in (-7.0, -6.05, -6.001):
        ds, words = flags(roller_profile_radius=groove, radial_force=-1000.0)
        ratio = float(ds["conformity"].max())
        np.testing.assert_allclose(ratio, float(ds["semi_axis_lateral"].max()) / 6.0)
        found.append(words)
        assert words == ({"half_space"} if ratio > 0.65 else {"close_fit"} if ratio > 0.3 else set())
        assert np.isnan(ds["pressure_model_error"]).any() == (ratio > 0.65)
    assert found == [set(), {"close_fit"}, {"half_space"}]


def test_a_long_patch_keeps_its_limit():
    """b above 0.3 of the smallest radius, as on soft rollers, is not judged."""
    ds, words = flags(radial_force=-3000.0, roller_material="POM", guide_material="POM")
    assert float(ds["semi_axis_rolling"].max()) > 0.3 * 6.0 and words == {"half_space"}


def test_drawn_profiles_keep_their_limit():
    case = tr.Case(friction_coefficient=0.1, motor_force=0.0, roller_profile_radius=-6.05, radial_force=-1000.0)
    ds = tr.solve(case, contact_model="sliding", normal="halfspace", outputs=("forces", "contact"), accuracy="preview")
    assert int(ds["validity"]) & 1 and np.isnan(ds["pressure_model_error"]).all()
