"""Fitted effects of samples: against closed forms and pairs solved anew; left out where a fit predicts little."""

import numpy as np
import pytest
import xarray as xr
import yaml
from synthetic_results import results_of

import trackroller as tr
from trackroller.results.effects import fitted_effects
from trackroller.results.findings import effect_of, strongest_effects, why

STUDY = {
    "name": "fits", "design": "lhs", "samples": 100, "contact_model": "sliding", "accuracy": "preview",
    "outputs": ["forces", "peak_stress", "life"],
    "base": {"axial_force": 5, "guide_curve_radius": "inf", "friction_coefficient": 0.2},
    "factors": {
        "radial_force": {"uniform": [-260, -80]}, "axis_distance": {"uniform": [16, 30]},
        "roller_profile_radius": {"uniform": [-7.4, -6.4]},
        "roller_material": {"values": ["1.7225-normalised", "1.7225-quenched-tempered"]},
    },
}  # fmt: skip
LIFE = "roller_life_hours"


def sample(life, **columns):
    n = len(life)
    ds = xr.Dataset({LIFE: ("case", life)}, {name: ("case", own) for name, own in columns.items()})
    ds.attrs["study"] = yaml.safe_dump({"design": "table", "name": "t", "factors": {name: {} for name in columns}})
    return results_of(ds.assign_coords(case=np.arange(n)))


def test_a_power_law_is_found_again():
    """Life x^-3 times 5 for the hard material: the ratio between the values at a tenth from both ends, and 5."""
    rng = np.random.default_rng(3)
    x, hard = rng.uniform(20, 90, 200), rng.random(200) < 0.4
    life = 1e9 * x**-3.0 * np.where(hard, 5.0, 1.0)
    results = sample(life, axial_force=x, roller_material=np.where(hard, "hard", "soft"), velocity=rng.random(200))
    share, found = fitted_effects(results, LIFE, results.valid)
    load, material, speed = found
    low, high = np.sort(x)[[20, 179]]
    assert share > 0.995 and (load.low, load.high) == (low, high)
    assert load.ratio == pytest.approx((high / low) ** -3.0, rel=0.03)
    assert (material.low, material.high) == ("soft", "hard") and material.ratio == pytest.approx(5, rel=0.02)
    assert speed.ratio == pytest.approx(1, rel=0.02) and effect_of(results, LIFE, "velocity") is None


def test_factors_that_go_together_have_no_effect_of_their_own():
    """Two loads with a correlation of 0.9: the life follows one of them, and the cases do not tell which."""
    rng = np.random.default_rng(5)
    x, noise = rng.uniform(1, 2, (2, 300))
    results = sample(1e5 * x**-4.0, axial_force=x, motor_force=x + 0.4 * noise)
    assert fitted_effects(results, LIFE, results.valid)[1] == []
    results = sample(1e5 * x**-4.0, axial_force=x, motor_force=noise)
    one, other = fitted_effects(results, LIFE, results.valid)[1]
    assert one.ratio == pytest.approx((one.high / one.low) ** -4.0, rel=0.05) and other.ratio == pytest.approx(
        1, abs=0.05
    )


def test_noise_carries_no_effect():
    rng = np.random.default_rng(1)
    x = rng.uniform(0, 50, 300)
    results = sample(10 ** (3 - x / 50 + rng.normal(0, 0.3, 300)), axial_force=x)
    assert np.isnan(fitted_effects(results, LIFE, results.valid)[0]) and effect_of(results, LIFE, "axial_force") is None


@pytest.mark.slow
def test_pairs_solved_anew_give_the_told_effects():
    """Each told effect against the median of 40 pairs that differ in this factor only, solved for this test."""
    results = tr.run(STUDY, progress=False)
    found = strongest_effects(results, LIFE)
    assert {one.kind for one in found} == {"fitted"} and len(found) == 3
    table = results.table[results.valid].iloc[:40]
    for effect in (one.values["effect"] for one in found):
        cases = [STUDY["base"] | row[list(STUDY["factors"])].to_dict() for _, row in table.iterrows()]
        both = [
            np.array([_life(case | {effect.factor: level}) for case in cases]) for level in (effect.low, effect.high)
        ]
        assert effect.ratio == pytest.approx(10 ** np.nanmean(np.log10(both[1] / both[0])), rel=0.1)


def _life(case):
    return float(tr.solve(case, contact_model="sliding", accuracy="preview")[LIFE])


def test_a_fit_takes_the_place_of_the_index_of_a_sample():
    results = tr.run(STUDY | {"samples": 64}, progress=False)
    kinds = [one.kind for one in why(results)]
    assert kinds == ["fitted"] * 3


def test_a_factor_that_is_even_in_its_logarithm_is_fitted_so():
    """Hours go as one over the speed, over 60 times the smallest speed; an even sample from near 0 is no such one."""
    rng = np.random.default_rng(7)
    speed, load = 5 * 60 ** rng.random(256), 20 * rng.random(256)
    results = sample(1e5 / speed * np.exp(-load / 10), velocity=speed, axial_force=load)
    found = {one.factor: one for one in fitted_effects(results, LIFE, results.valid)[1]}
    fast, heavy = found["velocity"], found["axial_force"]
    assert fast.ratio == pytest.approx(fast.low / fast.high, rel=0.01)
    assert heavy.ratio == pytest.approx(np.exp((heavy.low - heavy.high) / 10), rel=0.01)


def test_a_kink_is_followed():
    """A life that falls five-fold beyond a friction of 0.28 and hardly before."""
    rng = np.random.default_rng(8)
    friction, speed = rng.uniform(0.08, 0.35, 512), rng.uniform(1, 2, 512)
    bend = lambda x: -0.1 * (x - 0.08) / 0.2 - 0.7 * np.maximum(0, x - 0.28) / 0.07  # noqa: E731
    results = sample(10 ** (3 + bend(friction)) / speed, friction_coefficient=friction, velocity=speed)
    effect = next(e for e in fitted_effects(results, LIFE, results.valid)[1] if e.factor == "friction_coefficient")
    assert effect.ratio == pytest.approx(10 ** (bend(effect.high) - bend(effect.low)), rel=0.1)


def test_an_output_that_is_asked_for_has_its_largest_effect_told():
    """Friction power at equal other values is in proportion to the speed, which changes most: 4-fold."""
    factors = {"velocity": {"values": [20, 80]}, "radial_force": {"values": [-100, -120, -150]}}
    keys = {"design": "grid", "outputs": ["forces", "friction_work", "peak_stress", "life"], "factors": factors}
    asked = {"analysis": {"outputs": [LIFE, "friction_power"]}}
    base = STUDY["base"] | {"axis_distance": 22, "contact_angle": 35, "motor_force": 0}
    results = tr.run({**STUDY, **keys, **asked, "base": base}, progress=False)
    power = results.data["friction_power"].sum("contact").transpose("velocity", ...).values
    last = why(results)[-1].values
    assert (last["column"], last["effect"].factor) == ("friction_power", "velocity")
    assert last["effect"].ratio == pytest.approx(np.median(power[1] / power[0])) == pytest.approx(4, rel=0.01)
