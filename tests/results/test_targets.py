"""Probability to meet a target: closed forms at design points and levels, and intervals that cover the truth."""

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc
from synthetic_results import results_of

from trackroller.errors import InputError
from trackroller.methods.probability import bounds, probabilities
from trackroller.results.sensitivity import analyse
from trackroller.study.file.load import parse_study

POINTS = {
    "name": "t",
    "method": "inner_outer",
    "samples": 1000,
    "outputs": ["forces", "friction_work", "life"],
    "factors": {
        "velocity": {"values": [30.0, 60.0]},
        "contact_angle": {"values": [30.0, 36.0, 40.0]},
        "axial_force": {"normal": [0.0, 1.0]},
        "friction_coefficient": {"uniform": [0.1, 0.3]},
    },
    "analysis": {"target": {"roller_life_hours": {"min": 500}, "friction_power": {"max": 8}}},
}
Z = {30.0: 0.0, 36.0: 1.0, 40.0: 2.0}


def solved(data, path=None):
    """Return a study with life 500 * 10**(0.2 (z + shift)), full slip above mu 0.28, power 10 (mu over 0.25)."""
    study = parse_study(data)
    ds = study.design()
    shift = np.array([Z[a] for a in ds["contact_angle"].values]) - (ds["velocity"].values > 45)
    ds["roller_life_hours"] = ("case", 500 * 10 ** (0.2 * (ds["axial_force"].values + shift)), {"units": "h"})
    ds["friction_power"] = ("case", 32 * ds["friction_coefficient"].values, {"units": "W"})
    ds["regime"] = ("case", (ds["friction_coefficient"].values > 0.28).astype("i1"))
    if path is not None:
        ds.to_netcdf(path)
    return ds


def test_probabilities_of_points_and_levels_match_the_closed_forms(tmp_path):
    """Through files: P(z > -shift) times 0.9 that roll; power below 8 W in three of four; the mean at each level."""
    solved(POINTS, tmp_path / "study.nc")
    out = analyse(results_of(tmp_path / "study.nc"))
    life = stats.norm.cdf(np.array([[0, 1, 2], [-1, 0, 1]])) * 0.9
    found = out["target_probability"].sel(target=out["target"] == "roller_life_hours").values.ravel()
    np.testing.assert_allclose(found, life.ravel(), atol=0.015)
    exact = {"roller_life_hours": life, "friction_power": np.full((2, 3), 0.75), "all": life / 0.9 * 0.75}
    for i, name in enumerate(out["target"].values):
        whole = exact[str(name)]
        levels = np.concatenate([whole.mean(axis=1), whole.mean(axis=0)])
        for part, truth in (("target", whole.ravel()), ("level", levels)):
            value, low, high = (out[f"{part}_probability{end}"].values[i] for end in ("", "_low", "_high"))
            assert (low <= value).all() and (value <= high).all()
            assert (low <= truth).all() and (truth <= high).all()
    assert out["level_factor"].values.tolist() == ["velocity"] * 2 + ["contact_angle"] * 3
    assert out["level_low"].values.tolist() == [30, 60, 30, 36, 40]


def test_a_life_counts_the_scatter_of_its_material():
    """Scatter 0.2 of the study and s of the material: P = 0.9 Phi(shift 0.2 / hypot(0.2, s))."""
    data = POINTS | {"analysis": {"target": {"roller_life_hours": {"min": 500}}, "material_scatter": 9}}
    own = np.log10(9) / 2.5631
    found = analyse(results_of(solved(data)))["target_probability"].values[0]
    exact = 0.9 * stats.norm.cdf(0.2 * np.array([0, 1, 2, -1, 0, 1]) / np.hypot(0.2, own))
    np.testing.assert_allclose(found, exact, atol=0.01)


@pytest.mark.parametrize("design", ["lhs", "saltelli", "grid"])
def test_levels_of_other_designs_have_a_probability(design):
    """Friction below 0.25 decides: probability 0.75 over all, 1 or 0 at its levels; a grid gives shares only."""
    listed = {"friction_coefficient": {"values": [0.2, 0.22, 0.24, 0.26]}, "axial_force": {"linspace": [-2, 2, 5]}}
    spread = {"friction_coefficient": {"uniform": [0.1, 0.3]}, "axial_force": {"normal": [0.0, 1.0]}}
    factors = {"contact_angle": {"values": [30.0, 40.0]}, **(listed if design == "grid" else spread)}
    data = POINTS | {"method": design, "samples": 256, "factors": factors, "base": {"velocity": 30.0}}
    data |= {"analysis": {"target": {"friction_power": {"max": 8}}, "conditional_on": "contact_angle"}}
    out = analyse(results_of(solved(data)))
    assert out.sizes["level"] == 2 < out.sizes["target_level"], "the levels of both keys stand side by side"
    assert float(out["target_probability"][0]) == pytest.approx(0.75, abs=0.005)
    own = (out["level_factor"] == "friction_coefficient").values
    np.testing.assert_allclose(out["level_probability"].values[0][own], [1, 1, 1, 0], atol=0.01)
    assert np.isfinite(out["level_probability_low"].values).all() == (design != "grid")


def test_cases_that_miss_a_constraint_miss_the_target():
    out = analyse(results_of(solved(POINTS | {"constraints": ["friction_coefficient < 0.2"]})))
    power = out["target_probability"].sel(target=out["target"] == "friction_power").values
    np.testing.assert_allclose(power, 0.5, atol=0.005)
    assert (out["b10_safe"].sel(output="roller_life_hours") == 0).all()  # half of the cases count as life 0


EVENTS = {
    "one factor": lambda u: u[:, 0] < 0.7,
    "sum": lambda u: u.sum(axis=1) < 1.4,
    "product": lambda u: (u[:, 0] - 0.5) * (u[:, 1] - 0.5) > 0.01,
    "rare": lambda u: u.sum(axis=1) < 1.9,
    "mean of four points": lambda u: np.mean([u.sum(axis=1) < t for t in (0.8, 1.0, 1.2, 1.4)], axis=0),
}


def test_the_interval_covers_the_truth_and_uses_the_strata():
    """Latin hypercubes and Sobol samples of 60: coverage of 95 % within chance; narrower than for random samples."""
    grid = np.stack(np.meshgrid(*[(np.arange(1000) + 0.5) / 1000] * 2), axis=-1).reshape(-1, 2)
    truth = np.array([event(grid).mean() for event in EVENTS.values()])
    held, width, plain = np.zeros((3, len(EVENTS)))
    for seed in range(250):
        rng = np.random.default_rng(seed)
        unit = qmc.Sobol(2, rng=rng).random(60) if seed % 2 else qmc.LatinHypercube(2, rng=rng).random(60)
        hits = np.stack([event(unit) for event in EVENTS.values()], axis=1).astype(float)
        p, low, high = probabilities(hits, unit, np.ones(2, bool))
        held += (low <= truth) & (truth <= high)
        width += high - low
        plain += np.subtract(*bounds(p, 60)[::-1])
    assert (held >= 0.92 * 250).all() and (width <= 1.001 * plain).all()
    saved = dict(zip(EVENTS, width / plain, strict=True))
    assert saved["one factor"] < 0.6 and saved["mean of four points"] < 0.6


def test_bounds_are_sound_at_the_ends():
    """None of 100: upper bound 3.6 %; the bounds of a random sample are those of Clopper and Pearson."""
    low, high = bounds(np.array([0.0, 1.0, 0.5]), 100)
    exact = stats.binomtest(50, 100).proportion_ci(method="exact")
    assert low[0] == 0 and high[0] == pytest.approx(0.0362, abs=1e-4) and high[1] == 1
    assert (low[2], high[2]) == pytest.approx((exact.low, exact.high))


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        ({"analysis": {"target": {"roller_life_hour": {"min": 5}}}}, ["analysis.target", "roller_life_hours"]),
        ({"analysis": {"target": {"roller_life_hours": 500}}}, ["analysis.target.roller_life_hours", "min: 500"]),
        ({"analysis": {"target": {"roller_life_hours": {"least": 5}}}}, ["analysis.target", "min, max"]),
        ({"analysis": {"target": {"slip": {"min": 2, "max": 1}}}}, ["min below max"]),
        ({"analysis": {"target": {"roller_life_hours": {"min": 0}}}}, ["life above 0"]),
        (
            {"method": "morris", "analysis": {"target": {"slip": {"max": 1, "probability": 0.9}}}},
            ["morris", "Remove probability", "inner_outer"],
        ),
    ],
)
def test_wrong_targets_are_refused_with_field_and_remedy(change, parts):
    factors = {"axial_force": {"normal": [0.0, 1.0]}, "friction_coefficient": {"uniform": [0.1, 0.3]}}
    with pytest.raises(InputError) as error:
        parse_study(POINTS | {"factors": factors} | change)
    assert all(part in str(error.value) for part in parts), error.value


def test_a_design_without_weights_takes_a_requirement_without_a_probability():
    """As the message says: without the probability morris draws the requirement beside its effects."""
    factors = {"axial_force": {"normal": [0.0, 1.0]}, "friction_coefficient": {"uniform": [0.1, 0.3]}}
    change = {"factors": factors, "method": "morris", "requirement": {"slip": {"max": 1}}}
    study = parse_study({key: own for key, own in POINTS.items() if key != "analysis"} | change)
    assert study.config.requirement["slip"].most == 1
