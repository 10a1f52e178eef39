"""Strength and wear coefficient come back from rollers that `accuracy: reference` solved."""

from __future__ import annotations

import math

import numpy as np
import pytest

import trackroller as tr

RIG = {"motor_force": 0, "friction_coefficient": 0.1, "axial_force": 20, "accuracy": "reference"}
LOADS = [-120.0, -140.0, -160.0, -180.0, -200.0, -220.0]
STRENGTH, KNEE, SLOPE, SCATTER = 360.0, 5e6, 9.0, 0.15  # the last one as deviation of ln N
COEFFICIENT, DEPTH = 3e-6, 0.02
METRES_A_MINUTE = 60.0


@pytest.fixture(scope="module")
def solved():
    """Return the largest stress of the rollers [MPa], and the overrollings of a travel of 1 km."""
    cases = [{n: v for n, v in RIG.items() if n != "accuracy"} | {"radial_force": force} for force in LOADS]
    ds = tr.solve(cases, accuracy="reference", outputs=("forces", "peak_stress", "life"))
    per_hour = (ds["life_cycles"] / ds["life_hours"]).sel(body="roller").max("contact").values
    return ds["peak_stress"].sel(body="roller").max("contact").values, per_hour / (60.0 * METRES_A_MINUTE / 1000.0)


@pytest.mark.slow
def test_strength_slope_and_scatter_come_back_from_rollers_of_reference(solved):
    stress, per_km = solved
    normal = np.random.default_rng(4).normal(size=len(LOADS))
    cycles = KNEE * (stress / STRENGTH) ** -SLOPE * np.exp(SCATTER * normal)
    km = cycles / per_km
    bench = {"radial_force": LOADS, "travel_from": km, "travel_to": km, "end": ["fatigue roller"] * len(LOADS)}
    fit = tr.fit_bench(bench, base=RIG)
    assert fit.given["accuracy"] == "reference"
    strength, slope = fit.estimate("fatigue_strength"), fit.estimate("slope")
    assert strength == pytest.approx(STRENGTH, rel=0.02)
    for name, truth in (("fatigue_strength", STRENGTH), ("slope", SLOPE)):
        low, high = fit.interval(name)
        assert low < truth < high
    # by regression: the line is that of ln N over ln S
    own = np.polyfit(np.log(stress), np.log(cycles), 1)
    assert slope == pytest.approx(-own[0], rel=1e-4)
    assert math.log(strength) == pytest.approx((own[1] - math.log(KNEE)) / -own[0], rel=1e-5)


@pytest.mark.slow
def test_the_wear_coefficient_comes_back_from_rollers_of_reference():
    worn = tr.load_database().material("1.7225-normalised").as_dict() | {"wear_coefficient": COEFFICIENT}
    base = {n: v for n, v in RIG.items() if n != "accuracy"} | {"roller_material": worn}
    cases = [base | {"radial_force": force, "permissible_wear_depth": DEPTH} for force in LOADS[:4]]
    ds = tr.solve(cases, accuracy="reference", outputs=("forces", "wear"))
    km = ds["wear_life_hours"].sel(body="roller").min("contact").values * 60.0 * METRES_A_MINUTE / 1000.0
    rows = {
        "radial_force": LOADS[:4],
        "travel_from": km * [1.1, 0.9, 1.05, 0.95],
        "end": [f"wear roller {DEPTH} mm"] * 4,
    }
    fit = tr.fit_bench(rows | {"travel_to": rows["travel_from"]}, "wear_coefficient", base=RIG)
    expected = COEFFICIENT / float(np.exp(np.mean(np.log([1.1, 0.9, 1.05, 0.95]))))
    assert fit.estimate("wear_coefficient") == pytest.approx(expected, rel=0.02)
    low, high = fit.interval("wear_coefficient")
    assert low < COEFFICIENT < high
