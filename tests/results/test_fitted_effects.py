"""Curves of effects in samples: against closed forms; none where a fit predicts little."""

import numpy as np
import pytest
import xarray as xr
import yaml
from synthetic_results import results_of

from trackroller.results.case_ranges import CaseRanges
from trackroller.results.effect_curves import Effects

LIFE = "roller_life_hours"


def effects(life, **columns):
    """Return the effects of columns on a life, all of whose cases count."""
    ds = xr.Dataset({LIFE: ("case", life)}, {name: ("case", own) for name, own in columns.items()})
    ds.attrs["study"] = yaml.safe_dump({"method": "table", "name": "t", "factors": {name: {} for name in columns}})
    results = results_of(ds.assign_coords(case=np.arange(len(life))))
    return Effects.of(CaseRanges(results, (LIFE, "life of the roller", "h"), True))


def curves(life, **columns):
    return {curve.factor: curve for curve in effects(life, **columns).curves()}


def test_a_power_law_is_found_again():
    """Life x^-3 times 5 for the hard material: the ratio between the ends of the curve, and 5."""
    rng = np.random.default_rng(3)
    x, hard = rng.uniform(20, 90, 200), rng.random(200) < 0.4
    life = 1e9 * x**-3.0 * np.where(hard, 5.0, 1.0)
    found = curves(life, axial_force=x, roller_material=np.where(hard, "hard", "soft"), velocity=rng.random(200))
    load = found["axial_force"]
    expected = (load.levels[-1] / load.levels[0]) ** -3.0
    assert load.middle[-1] / load.middle[0] == pytest.approx(expected, rel=0.03)
    assert load.shape == "fall"
    assert found["roller_material"].height == pytest.approx(5, rel=0.02)
    assert found["velocity"].shape == "flat"


def test_noise_is_not_fitted():
    rng = np.random.default_rng(1)
    x = rng.uniform(0, 50, 300)
    assert effects(10 ** (3 - x / 50 + rng.normal(0, 0.3, 300)), axial_force=x).fit is None


def test_a_factor_that_is_even_in_its_logarithm_is_fitted_so():
    """Hours go as one over the speed, over 60 times the smallest speed; an even sample from near 0 is no such one."""
    rng = np.random.default_rng(7)
    speed, load = 5 * 60 ** rng.random(256), 20 * rng.random(256)
    found = curves(1e5 / speed * np.exp(-load / 10), velocity=speed, axial_force=load)
    fast, heavy = found["velocity"], found["axial_force"]
    assert fast.height == pytest.approx(fast.levels[-1] / fast.levels[0], rel=0.02)
    assert heavy.height == pytest.approx(np.exp((heavy.levels[-1] - heavy.levels[0]) / 10), rel=0.02)


def test_a_kink_is_followed():
    """A life that falls five-fold beyond a friction of 0.28 and hardly before."""
    rng = np.random.default_rng(8)
    friction, speed = rng.uniform(0.08, 0.35, 512), rng.uniform(1, 2, 512)

    def bend(x):
        return -0.1 * (x - 0.08) / 0.2 - 0.7 * np.maximum(0, x - 0.28) / 0.07

    curve = curves(10 ** (3 + bend(friction)) / speed, friction_coefficient=friction, velocity=speed)[
        "friction_coefficient"
    ]
    low, high = curve.levels[0], curve.levels[-1]
    assert curve.middle[-1] / curve.middle[0] == pytest.approx(10 ** (bend(high) - bend(low)), rel=0.1)


def test_a_hump_and_a_cliff_have_their_word():
    x = np.repeat([0.0, 1.0, 2.0, 3.0, 4.0], 40)
    other = np.tile(np.arange(40.0), 5)
    hump = 1e4 * np.exp(-((x - 2.0) ** 2)) * (1 + other)
    cliff = np.where(x < 2.5, 1e4, 1e2) * (1 - 0.01 * x) * (1 + other)
    assert curves(hump, axial_force=x, velocity=other)["axial_force"].shape == "hump"
    assert curves(cliff, axial_force=x, velocity=other)["axial_force"].shape == "cliff"


def test_two_groups_have_their_word():
    """Ten pairs rise six-fold and ten twelve-fold: the median of all is an effect that no pair has."""
    x = np.tile([0.0, 1.0], 20)
    pair = np.repeat(np.arange(20.0), 2)
    step = np.where(pair < 10, 6.0, 12.0) * (1 + 0.01 * pair)
    life = 100.0 * (1 + pair) * np.where(x > 0, step, 1.0)
    assert curves(life, axial_force=x, velocity=pair)["axial_force"].shape == "groups"
