"""A leaf that hangs on rollers in one line: a pendulum, by hand statics; refused where it would fall."""

from __future__ import annotations

import numpy as np
import pytest
from carts import ROLLER
from scipy.optimize import minimize_scalar

import trackroller as tr
from trackroller.carriage.loads import GRAVITY
from trackroller.errors import InputError
from trackroller.results.carriage_answer import answer_of_carriage

G, MASS = GRAVITY, 40.0


def leaf(at=(0, 0, -400), line=(0, 0), **changed):
    """Return a leaf of 40 kg on two rollers in one line along x, 300 mm apart."""
    way = {"pushes": [0, 0, -1], "x_R": [0, 1, 0], "roller": ROLLER}
    rollers = {"F": {"at": [150, *line], **way}, "R": {"at": [-150, *line], **way}}
    cases = [{"name": "run", "speed": "1 m/s"}]
    mass = {"value": MASS, "at": list(at)}
    return {"name": "leaf", "mass": mass, "rollers": rollers, "drive": {"at": [0, 0, 0]}, "cases": cases} | changed


def solved(values, **more):
    return tr.carriage(values, lives=False, **more)


def test_a_centre_of_mass_below_the_line():
    ds = solved(leaf(at=(30, 0, -400)))
    assert float(ds.swing[0]) == pytest.approx(0.0, abs=1e-12)
    assert ds.radial_force.values[0] == pytest.approx([-MASS * G * 180 / 300, -MASS * G * 120 / 300], rel=1e-9)
    assert ds.axial_force.values[0] == pytest.approx([0, 0], abs=1e-9)
    assert bool(ds.converged.all())


@pytest.mark.parametrize("line", [(0, 0), (70, -20)])
def test_a_centre_of_mass_beside_the_line_swings_below_it(line):
    """20 mm to the left and 400 mm below: the left side goes down by atan(20/400); forces stand in these axes."""
    ds = solved(leaf(at=(30, line[0] + 20, line[1] - 400), line=line))
    angle = np.arctan(20 / 400)
    assert float(ds.swing[0]) == pytest.approx(-np.degrees(angle), rel=1e-9)
    shares = np.array([0.6, 0.4])  # the centre of mass is 30 mm in front of the middle of 300 mm
    assert ds.radial_force.values[0] == pytest.approx(-MASS * G * np.cos(angle) * shares, rel=1e-9)
    assert ds.axial_force.values[0] == pytest.approx(MASS * G * np.sin(angle) * shares, rel=1e-9)


def test_a_curve_swings_the_leaf_outwards_without_axial_force():
    """A left curve: the resultant of weight and inertia passes through the line and the centre of mass."""
    case = {"name": "curve", "speed": "2 m/s", "curve_radius": "10 m"}
    ds = solved(leaf(cases=[case]))
    assert float(ds.swing[0]) == pytest.approx(-np.degrees(np.arctan(0.4 / G)), rel=1e-9)  # v^2/R = 0.4 m/s2
    assert ds.radial_force.values[0] == pytest.approx([-MASS * np.hypot(G, 0.4) / 2] * 2, rel=1e-9)
    assert ds.axial_force.values[0] == pytest.approx([0, 0], abs=1e-6)


def test_a_canted_track_swings_the_leaf_back_to_the_vertical():
    ds = solved(leaf(cases=[{"name": "cant", "cant": "5 deg"}]))
    assert abs(float(ds.swing[0])) == pytest.approx(5.0, rel=1e-9)
    assert ds.radial_force.values[0].sum() == pytest.approx(-MASS * G, rel=1e-9)
    assert ds.axial_force.values[0] == pytest.approx([0, 0], abs=1e-9)


def test_the_angle_is_that_of_the_least_potential_energy():
    force, at = np.array([0.0, 55.0, -20.0]), np.array([0.0, 30.0, -800.0])
    ds = solved(leaf(at=(0, 15, -400), cases=[{"name": "push", "forces": [{"force": force, "at": at}]}]))

    def energy(angle):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        places = turn @ [15, -400], turn @ at[1:]
        return -(places[0] @ [0, -MASS * G] + places[1] @ force[1:])

    least = minimize_scalar(energy, bounds=(-np.pi / 2, np.pi / 2), method="bounded", options={"xatol": 1e-9})
    assert float(ds.swing[0]) == pytest.approx(np.degrees(least.x), rel=1e-5)
    whole = np.array([0.0, -MASS * G]) + force[1:]
    sums = np.hypot(ds.radial_force.values[0].sum(), ds.axial_force.values[0].sum())
    assert sums == pytest.approx(np.hypot(*whole), rel=1e-9)  # swinging turns the resultant and keeps its size


def test_rollers_with_and_without_stiffness_agree():
    given = leaf(at=(30, 20, -400))
    for one in given["rollers"].values():
        one["stiffness"] = 1e4
        del one["roller"]
    assert solved(given).radial_force.values == pytest.approx(solved(leaf(at=(30, 20, -400))).radial_force.values)


def test_the_pendulum_is_said_and_margins_of_a_payload_that_swings_it_are_not_given():
    values = leaf(payloads=[{"value": 5, "at": [0, 100, -400]}])
    ds = solved(values)
    said = " ".join(one.where for one in answer_of_carriage(ds).warnings)
    assert "a pendulum: the rollers stand in one line" in said and "it swings by" in said
    assert "margins of the payload are not known" in said
    assert np.isnan(ds.payload_to_tipping.values).all() and np.isinf(ds.loads_to_tipping.values).all()
    below = solved(leaf(payloads=[{"value": 5, "at": [0, 0, -400]}]))
    assert np.isinf(below.payload_to_tipping.values).all()
    assert "margins of the payload" not in " ".join(one.where for one in answer_of_carriage(below).warnings)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (leaf(at=(0, 0, 400)), "rolls about the x axis without any resistance, and falls in case 'run'"),
        (leaf(at=(0, 0, 0)), "falls in case 'run'"),
        (leaf(at=(0, 20, 0)), "falls in case 'run'"),
        (leaf(at=(400, 0, -400)), "case = 'run' tips the carriage"),
    ],
)
def test_a_leaf_that_would_fall_is_refused(values, words):
    with pytest.raises(InputError, match=words):
        solved(values)


def test_a_second_free_motion_is_refused():
    values = leaf()
    values["rollers"]["R"]["kind"] = "floating"
    with pytest.raises(InputError, match=r"leave the carriage free: it .* without any resistance"):
        solved(values)


@pytest.mark.slow
def test_the_lives_of_a_leaf():
    ds = tr.carriage(leaf(at=(0, 0, -400), duty={"hours_per_day": 8}))
    assert ds.attrs["worst_roller"] in ("F", "R") and np.isfinite(ds.life_years.values).all()
