"""Inner/outer array designs: distribution of life and probability of each regime at every design point."""

import numpy as np
import pytest
from scipy import stats
from synthetic_results import results_of

import trackroller as tr
from trackroller.errors import InputError
from trackroller.methods.b10 import b10, log_b10
from trackroller.results.robustness import robustness
from trackroller.results.sensitivity import analyse
from trackroller.study.file.load import parse_study

INNER_OUTER = {
    "name": "robust",
    "method": "inner_outer",
    "samples": 2000,
    "factors": {
        "velocity": {"values": [30.0, 60.0]},
        "friction_coefficient": {"uniform": [0.1, 0.3]},
        "axial_force": {"normal": [0.0, 1.0]},
    },
}


def solved(fake, path=None, data=INNER_OUTER):
    study = parse_study(data)
    ds = study.design()
    for name, values in fake(ds).items():
        ds[name] = ("case", values, {"units": "h"} if "life" in name else {})
    if path is not None:
        ds.to_netcdf(path)
    return ds


def lognormal(ds):
    """Return the life 10**(3 + 0.2 z) at 30 m/min, ten times that at 60; full slip above a friction of 0.28 (10 %)."""
    slip = ds["friction_coefficient"].values > 0.28
    life = 10 ** (3 + 0.2 * ds["axial_force"].values) * np.where(ds["velocity"].values > 45, 10.0, 1.0)
    return {"roller_life_hours": np.where(slip, 1e-3, life), "regime": slip.astype(np.int8)}


def test_percentiles_b10_and_probabilities_match_the_closed_forms(tmp_path):
    """Lognormal life through files: B10 = 10**(3 - 1.2816 * 0.2), median, and a slip probability of 10 %."""
    solved(lognormal, tmp_path / "study.nc")
    out = analyse(results_of(tmp_path / "study.nc"))
    np.testing.assert_array_equal(out["velocity"], [30, 60])
    life = out.sel(output="roller_life_hours")
    exact = 10 ** (3 - stats.norm.ppf(0.9) * 0.2) * np.array([1, 10])
    np.testing.assert_allclose(life["b10"], exact, rtol=0.02)
    assert (life["b10_low"] <= exact).all() and (exact <= life["b10_high"]).all()
    np.testing.assert_allclose(life["percentile_value"].sel(percentile=50), [1e3, 1e4], rtol=0.03)
    slip = out["probability"].sel(regime="full_slip")
    np.testing.assert_allclose(slip, 0.1, atol=1e-3)
    assert (out["probability_low"] <= out["probability"]).all()
    # 10 % slip count as life 0 in the safe figure, so that it falls to the shortest lives
    assert (life["b10_safe"] < 0.4 * life["b10"]).all()


def test_unlimited_lives_are_ranked_and_not_dropped():
    """Half of the lives unlimited: the median is the longest finite or unlimited, B10 stays finite."""

    def fake(ds):
        life = 10 ** (3 + 0.2 * ds["axial_force"].values)
        return {"roller_life_hours": np.where(ds["axial_force"].values > 0, np.inf, life)}

    ds = solved(fake)
    life = robustness(results_of(ds), {}).sel(output="roller_life_hours")
    np.testing.assert_allclose(life["b10"], 10 ** (3 - stats.norm.ppf(0.9) * 0.2), rtol=0.02)
    assert np.isposinf(life["percentile_value"].sel(percentile=90)).all()
    np.testing.assert_allclose(life["used_share"], 1.0)


def test_failed_rows_never_lengthen_the_safe_life():
    """Rows without a result and rows not rolling count as life 0 in b10_safe."""

    def fake(ds):
        regime = np.where(ds["friction_coefficient"].values > 0.25, 3, 0).astype(np.int8)  # a quarter failed
        life = 10 ** (3 + 0.2 * ds["axial_force"].values)
        return {"roller_life_hours": np.where(regime == 3, np.nan, life), "regime": regime}

    ds = solved(fake)
    out = robustness(results_of(ds), {})
    life = out.sel(output="roller_life_hours")
    assert (life["b10_safe"] == 0).all() and (life["b10"] > 400).all()
    np.testing.assert_allclose(out["probability"].sel(regime="failed"), 0.25, atol=1e-3)
    np.testing.assert_allclose(life["used_share"], 0.75, atol=1e-3)


def test_material_scatter_widens_the_distribution_as_two_lognormals_do():
    """Scatter of the study 0.2 and of the material 0.15: B10 at 10**(3 - 1.2816 sqrt(0.2^2 + 0.15^2))."""
    z = stats.norm.ppf((np.arange(4000) + 0.5) / 4000)
    value, low, high = b10(10 ** (3 + 0.2 * z), 0.15)
    assert value == pytest.approx(10 ** (3 - stats.norm.ppf(0.9) * 0.25), rel=2e-3)
    assert low < value < high


def test_b10_interval_covers_the_truth():
    """Distribution-free interval: covers in at least 94 % of 2000 samples of 100."""
    rng = np.random.default_rng(0)
    exact = 10 ** (-stats.norm.ppf(0.9) * 0.3)
    found = [b10(10 ** (0.3 * rng.normal(size=100))) for _ in range(2000)]
    assert np.mean([low <= exact <= high for _, low, high in found]) > 0.94


def test_robustness_refuses_another_design():
    """Another design is refused by name."""
    data = {"name": "flat", "method": "lhs", "samples": 50, "factors": INNER_OUTER["factors"]}
    ds = solved(lognormal, data=data)
    with pytest.raises(InputError, match="inner_outer"):
        robustness(results_of(ds), {})


def test_a_body_above_its_strength_counts_as_life_0():
    """In 20 % of the cases the roller breaks at once: its B10 is 0, and not that of the other cases."""

    def fake(ds):
        breaks = (ds["friction_coefficient"].values > 0.26) & (ds["velocity"].values < 45)  # a quarter, at one point
        life = np.where(breaks, np.nan, 10 ** (3 + 0.2 * ds["axial_force"].values))
        return {
            "roller_life_hours": life,
            "regime": np.zeros(len(life), np.int8),
            "validity": 4 * breaks.astype(np.int32),
        }

    ds = solved(fake)
    ds["validity"].attrs["flag_meanings"] = "half_space yield static"
    life = robustness(results_of(ds), {}).sel(output="roller_life_hours")
    assert life["b10"].values[0] == life["b10_safe"].values[0] == life["b10_high"].values[0] == 0.0
    assert life["percentile_value"].sel(percentile=10).values[0] == 0.0
    np.testing.assert_allclose(life["b10"][1], 10 ** (3 - stats.norm.ppf(0.9) * 0.2), rtol=0.02)
    np.testing.assert_allclose(life["used_share"], 1.0)


@pytest.mark.parametrize("scatter", [0.0, 0.1])
def test_the_interval_of_a_b10_of_0_is_known_or_unbounded(scatter):
    member, deviations = np.arange(400) % 4, np.full(400, scatter)
    lives = 10 ** np.random.default_rng(3).normal(3, 0.2, 400)
    assert log_b10(np.where(np.arange(400) % 5 == 0, 0.0, lives), deviations, member, 4) == (-np.inf, 0.0)
    value, wide = log_b10(np.where(np.arange(400) % 12 == 0, 0.0, lives), deviations, member, 4)
    assert np.isfinite(value) and wide == np.inf


def test_the_median_of_a_design_point_is_that_of_its_candidate():
    """Of an even number of samples both take the middle between the two lives in the middle."""
    study = {
        "name": "middle",
        "base": {"motor_force": 0, "axial_force": 5, "contact_angle": 40},
        "factors": {
            "roller_profile_radius": {"values": [-6.5, -7]},
            "radial_force": {"uniform": [-200, -60]},
        },
        "method": "inner_outer",
        "samples": 20,
        "contact_model": "sliding",
    }
    results = tr.run(study, progress=False)
    name = results.life[0]
    medians = results.robustness()["percentile_value"].sel(output=name, percentile=50).values
    by_hand = [np.median(results.column(name)[rows]) for rows in results.design.points]
    np.testing.assert_allclose(medians, by_hand, rtol=1e-12)
    np.testing.assert_allclose(sorted(results.candidates().table["median"]), sorted(medians), rtol=1e-12)


def test_the_scatter_of_a_material_is_not_that_of_a_life_by_wear():
    """T_N widens the lives that fatigue ends; the bearing and wear have no S-N line."""
    study = {
        "name": "worn",
        "base": {"motor_force": 0, "axial_force": 5, "contact_angle": 40, "guide_overrollings_per_hour": 60},
        "factors": {
            "roller_profile_radius": {"values": [-6.3, -8]},
            "radial_force": {"uniform": [-200, -100]},
        },
        "method": "inner_outer",
        "samples": 20,
        "contact_model": "sliding",
        "analysis": {"material_scatter": 5, "target": {"min": 100}},
    }
    study["base"]["permissible_wear_depth"] = 0.01
    results = tr.run(study, progress=False)
    name, ends = results.life[0], results.ended_by_fatigue()
    found = results.robustness()
    assert not ends.all()
    for place, rows in enumerate(results.design.points):
        lives = results.column(name)[rows]
        scatter = np.where(ends[rows], np.log10(5) / (2 * stats.norm.ppf(0.9)), 0.0)
        np.testing.assert_allclose(found["b10"].sel(output=name).values[place], b10(lives, scatter)[0], rtol=1e-9)
        if not ends[rows].any():
            assert (
                found["target_probability"].values[0, place]
                == (results.judged_targets["pair_life_hours"][rows] >= 100).mean()
            )
