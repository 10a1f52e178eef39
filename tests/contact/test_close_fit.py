"""Close fits: the told errors of Hertz's theory hold against both witnesses, and the flag says where they end."""

import csv
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import trackroller as tr
from trackroller.contact import close_fit
from trackroller.contact.hertz import exact_shape
from trackroller.contact.kalker import Creepage, KalkerSettings, solve_patch
from trackroller.contact.quantities import Elastic
from trackroller.contact.slip import Slip
from trackroller.parameters.validity import VALIDITY

ROOT = Path(__file__).parents[2]
ONE = np.ones(1)
MODULUS = 2.0 * 80e3 * 1.28


def grooves():
    """Return the rows of the conformal grooves as numbers."""
    with (ROOT / "validation" / "measured" / "close_grooves.csv").open(encoding="utf-8") as file:
        return [{name: float(v) for name, v in row.items() if name != "influence"} for row in csv.DictReader(file)]


def hertz(radius):
    """Return Hertz's ellipse of the wheel in a groove."""
    contact = MODULUS / 2.0 / (1.0 - 0.28**2)
    return exact_shape((0.1 - 1.0 / radius) * ONE, ONE / 420.0, contact * ONE).at(1e4 * ONE)


def pin_in_hole(angle, terms=4000, shapes=12):
    """Solve a pin in a hole of like material without friction by Fourier series (the problem of Persson 1964).

    Radius, E* and difference of the radii are 1. A pressure p_n cos(n theta) on disc and hole closes the gap by
    2 n/(n^2 - 1) p_n, one without n by p_0, which follows from Michell's solutions; n = 1 is a rigid displacement.

    Returns
    -------
    The largest pressure, the load, and the largest error of the gap in the contact, |theta| <= angle.
    """
    nodes = 2000
    u = (np.arange(nodes) + 0.5) * np.pi / nodes
    weight = np.pi / nodes * np.sin(u) ** 2  # of sqrt(1 - t^2) dt, t = cos(u)
    n = np.arange(terms)
    shape = np.cos(2.0 * np.arange(shapes)[:, None] * u) * weight
    coefficient = shape @ np.cos(n[:, None] * angle * np.cos(u)).T * angle / np.pi
    coefficient[:, 0] *= 0.5
    compliance = np.ones(terms)
    compliance[1] = 0.0
    compliance[2:] = 2.0 * n[2:] / (n[2:] ** 2 - 1.0)
    places = angle * np.cos((np.arange(4 * shapes) + 0.5) * np.pi / (8 * shapes))
    matrix = np.column_stack([(np.cos(n * places[:, None]) * compliance) @ coefficient.T, -np.cos(places)])
    found = np.linalg.lstsq(matrix, -np.ones(len(places)), rcond=None)[0]
    largest = found[:-1] @ np.cos(np.arange(shapes) * np.pi)
    return largest, np.pi * coefficient[:, 1] @ found[:-1], np.abs(matrix @ found + 1.0).max()


@pytest.mark.parametrize("degrees", [5.0, 15.0, 25.0, 33.0])
def test_the_told_error_of_the_pressure_holds_for_a_pin_in_a_hole(degrees):
    angle = np.deg2rad(degrees)
    largest, load, residual = pin_in_hole(angle)
    assert residual < 1e-5
    half = np.sqrt(4.0 * load / np.pi)  # Hertz's half width, over the radius
    excess = largest / (2.0 * load / (np.pi * half)) - 1.0
    told = float(close_fit.model_error(half * ONE, close_fit.PRESSURE)[0])
    assert 0.0 < excess <= told < 1.2 * excess + 1e-3
    assert 1.0 - angle / half <= close_fit.model_error(half * ONE, close_fit.WIDTH)[0]


@pytest.mark.parametrize("row", grooves(), ids=lambda row: str(row["groove_radius [mm]"]))
def test_the_told_errors_hold_for_wheels_in_grooves(row):
    ellipse = hertz(row["groove_radius [mm]"])
    a, b = float(ellipse.semi_axis_lateral[0]), float(ellipse.semi_axis_rolling[0])
    told = {name: float(close_fit.model_error(a / 10.0 * ONE, law)[0]) for name, law in close_fit.LAWS.items()}
    assert 0.0 < row["max_pressure [MPa]"] / ellipse.max_pressure[0] - 1.0 <= told["pressure_model_error"]
    narrow = row["arc_half [mm]"] - 0.125  # half an element less
    assert 0.0 < 1.0 - narrow / a <= told["semi_axis_model_error"]
    assert abs(row["length_half [mm]"] / b - 1.0) <= told["semi_axis_rolling_model_error"]


@pytest.mark.slow
@pytest.mark.parametrize("row", grooves(), ids=lambda row: str(row["groove_radius [mm]"]))
def test_the_told_error_of_the_slip_power_holds_for_wheels_in_grooves(row):
    """The wheel rolls freely, so that its creepage is where the driving force vanishes."""
    ellipse = hertz(row["groove_radius [mm]"])
    a = float(ellipse.semi_axis_lateral[0])
    elastic = Elastic(80e3 * ONE, 0.28 * ONE, 0.0 * ONE)

    def solution(creepage):
        slip = Slip(0.0 * ONE, ONE, 10.0 * ONE, 420.0 * ONE, creepage * 420.0 * ONE)
        creep = Creepage(creepage * ONE, 0.0 * ONE, 0.0 * ONE, slip)
        return solve_patch(ellipse, creep, 0.3 * ONE, elastic, KalkerSettings(40, tolerance=1e-8))

    span = a * a / 4200.0
    free = brentq(lambda creepage: solution(creepage).resultants.driving_force[0], -span, span, xtol=1e-9)
    power = solution(free).works.dissipated[0] * 0.42
    told = float(close_fit.model_error(a / 10.0 * ONE, close_fit.SLIP_POWER)[0])
    assert 0.0 < 1.0 - row["friction_power [W]"] / power <= told


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
