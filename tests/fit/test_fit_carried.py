"""What tests leave open reaches B10, targets and verdict of a study: against own code on raw rows and the posterior."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import norm

import trackroller as tr
from trackroller.roller.requirement import checked_requirement
from trackroller.study.file.load import parse_study

STEEL = "1.7225-normalised"
BASE = {"motor_force": 0, "axial_force": 20, "friction_coefficient": 0.1, "guide_overrollings_per_hour": 100}


def posterior_of(fit):
    """Return weights, and functions of a stress that give ln N in the median and its deviation at each point."""
    ds = fit.data
    level, slope, spread = (ds[f"fatigue_{n}"].values for n in ("level", "slope", "log_scatter"))
    x0 = fit.groups[0].line.reference
    return ds["fatigue_weight"].values, lambda s: level - slope * (np.log(s) - x0), np.exp(spread)


def weighted(values, weight, at):
    order = np.argsort(values)
    return np.interp(at, np.cumsum(weight[order]) - 0.5 * weight[order], values[order])


def solved(**more):
    given = {"name": "own", "base": BASE, "outputs": ["peak_stress", "life"], "contact_model": "sliding"} | more
    return tr.run(parse_study(given | {"accuracy": "standard"}), progress=False)


def b10_by_hand(log_lives, deviation):
    def miss(t):
        return norm.cdf((t - log_lives) / deviation).mean() - 0.1

    return brentq(miss, log_lives.min() - 10 * deviation, log_lives.max() + 10 * deviation)


def band_by_hand(results, rows, fit, name="roller_life_hours"):
    """Return the 90 % band of B10 of some cases from each point of the posterior."""
    weight, line, spread = posterior_of(fit)
    ds = results.data
    stress = ds["peak_stress"].sel(body="roller").max("contact").values.ravel()[rows]
    hours = (
        ds["roller_life_hours"].values.ravel()[rows]
        / ds["life_cycles"].sel(body="roller").min("contact").values.ravel()[rows]
    )
    lives = np.array([line(s) for s in stress]) + np.log(hours)[:, None]
    some = np.random.default_rng(3).permutation(len(weight))[:4000]
    found = np.array([b10_by_hand(lives[:, i], spread[i]) for i in some])
    return np.exp(weighted(found, weight[some] / weight[some].sum(), (0.05, 0.95)))


@pytest.mark.slow
@pytest.mark.parametrize("design", ["inner_outer", "sobol"])
def test_b10_of_scattering_designs_lies_in_a_band_by_the_tests(rig, design):
    factors = {"radial_force": {"normal": [-160, 8]}, "friction_coefficient": {"uniform": [0.05, 0.2]}}
    factors |= {"roller_profile_radius": {"values": [-7.0, -6.6]}} if design == "inner_outer" else {}
    base = {n: v for n, v in BASE.items() if n not in factors} | {"roller_material": "rig steel"}
    results = solved(base=base, factors=factors, design=design, samples=32, analysis={"material_scatter": "fitted"})
    sens = results.indices().sel(life="roller_life_hours")
    points = results.design.points if design == "inner_outer" else [slice(None)]
    low, high, middle = (np.atleast_1d(sens[f"b10_tests{end}"].values) for end in ("_low", "_high", ""))
    for p, rows in enumerate(points):
        expected = band_by_hand(results, rows, rig)
        assert [low[p], high[p]] == pytest.approx(expected, rel=0.06)
        assert low[p] < middle[p] < high[p]
    assert sens["b10_tests_low"].attrs["tests"] == "6"


@pytest.fixture
def pairs(rig):
    """Return a study of two roller materials on the same guide, one of them fitted, under two loads."""

    def made(strong=STEEL, loads=(-150, -140), **more):
        factors = {"material_pair": {"values": [["rig steel", STEEL], [strong, STEEL]]}}
        factors |= {"radial_force": {"values": list(loads)}}
        return solved(factors=factors, design="grid", roles={"radial_force": "condition"}, **more)

    return made


@pytest.mark.slow
def test_between_materials_a_life_by_tests_is_a_range(rig, pairs):
    results = pairs()
    table = results.answer.table
    fitted = table["material_pair"].str.startswith("rig steel")
    own, other = table[fitted].iloc[0], table[~fitted].iloc[0]
    ds = results.data
    stress = float(ds["peak_stress"].sel(body="roller").max("contact").values[0].max())
    weight, line, _ = posterior_of(rig)
    per_hour = float((ds["life_cycles"] / ds["life_hours"]).sel(body="roller").max())
    expected = np.exp(weighted(line(stress), weight, [0.05, 0.95])) / per_hour
    assert [own["low"], own["high"]] == pytest.approx(expected, rel=0.03)
    assert other["low"] == other["high"]


def with_target(results, hours):
    wanted = checked_requirement({"pair_life_hours": {"min": hours}})
    config = results.config.model_copy(update={"requirement": wanted})
    return dataclasses.replace(results, study=dataclasses.replace(results.study, config=config))


@pytest.mark.slow
def test_candidates_of_the_same_fitted_material_are_compared_at_equal_positions(rig):
    factors = {"roller_profile_radius": {"values": [-7.0, -6.95]}, "radial_force": {"values": [-150, -140]}}
    base = BASE | {"roller_material": "rig steel"}
    found = solved(base=base, factors=factors, design="grid", roles={"radial_force": "condition"}).answer
    first, second = (row for _, row in found.table.iterrows())
    assert found.kind == "build"
    assert first["roller_profile_radius"] == -6.95
    assert second["high"] > first["low"]  # the ranges overlap, and yet the order is the same at each position


@pytest.mark.slow
def test_a_study_without_stresses_has_the_same_ranges(pairs):
    whole, lives = pairs(), pairs(outputs=["life"])
    assert "peak_stress" not in lives.data
    for name in ("low", "high"):
        assert whole.answer.table[name].to_numpy() == pytest.approx(lives.answer.table[name].to_numpy(), rel=1e-6)


@pytest.mark.slow
def test_a_fit_for_another_contact_model_does_not_count(pairs):
    results = pairs(contact_model="kalker_table")
    assert results.by_tests is None
    assert (results.answer.table["low"] == results.answer.table["high"]).all()
