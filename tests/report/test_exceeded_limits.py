"""A case that exceeds a limit does not hold: in the verdict, in tables, probabilities, B10 and searches alike."""

import numpy as np
import pytest

import trackroller as tr
from trackroller.results.search_fitness import judge

BASE = {"guide_curve_radius": "inf", "guide_overrollings_per_hour": 300, "motor_force": -8, "axial_force": 10}
BASE |= {"roller_material": "C45", "guide_material": "100Cr6"}
STUDY = {"name": "yielding", "base": BASE, "contact_model": "sliding", "accuracy": "preview"}
STUDY |= {"not_checked": ["pressure_line"]}  # with it a life is a range, whose worse end is compared


def held_rows(ds):
    """Return the rows that roll inside the model and exceed no limit, from the raw data set, flattened."""
    dims = ds["regime"].dims
    words = ds["limit_state"].attrs["flag_meanings"].split()
    state = ds["limit_state"].sel(limit=["static", "shakedown"]) == words.index("exceeded")
    bits = ds["validity"].attrs["flag_meanings"].split()
    outside = sum(1 << bits.index(flag) for flag in ("static", "half_space", "conformal", "steep_friction"))
    rolls = (ds["regime"] == 0) & ((ds["validity"].astype(int) & outside) == 0)
    return (rolls & ~state.any(["limit", "body"])).transpose(*dims).values.ravel(), rolls.transpose(
        *dims
    ).values.ravel()


@pytest.fixture(scope="module")
def grid():
    factors = {"roller_profile_radius": {"values": [-6.4, -7]}, "radial_force": {"values": [-80, -160, -260]}}
    factors |= {"friction_coefficient": {"values": [0.1, 0.25, 0.4]}}
    return tr.run(STUDY | {"factors": factors, "analysis": {"target": {"min": 1}}}, progress=False)


def test_probabilities_and_b10_count_what_the_verdict_counts():
    """Of a sample, too: the share of the target, and the life of nine of ten conditions."""
    factors = {"roller_profile_radius": {"values": [-6.4, -7]}, "radial_force": {"uniform": [-260, -80]}}
    factors |= {"friction_coefficient": {"uniform": [0.1, 0.4]}}
    keys = {"factors": factors, "method": "inner_outer", "samples": 64, "analysis": {"target": {"min": 1}}}
    results = tr.run(STUDY | keys, progress=False)
    held, rolls = held_rows(results.data)
    lives = results.column("pair_life_to_first_limit_hours")
    share = (held & (lives >= 1)).reshape(2, 64).mean(axis=1)
    assert held.sum() < rolls.sum()
    np.testing.assert_allclose(results.analysis["target_probability"].values.ravel(), share)
    nine = np.sort(np.where(held, lives, 0.0).reshape(2, 64), axis=1)[:, 6]  # the seventh of 64
    b10 = results.analysis["b10"].sel(output="pair_life_to_first_limit_hours").values
    broken = results.flagged("half_space").any() or (results.regime != 0).any()
    assert not broken
    np.testing.assert_allclose(b10, nine)


@pytest.mark.slow
def test_a_search_does_not_recommend_what_exceeds_a_limit():
    keys = {"factors": {"roller_profile_radius": {"values": [-6.2, -6.4, -6.7, -7, -7.4]}}, "method": "optimise"}
    keys["factors"] |= {"radial_force": {"values": [-80, -200]}, "friction_coefficient": {"values": [0.1, 0.3]}}
    keys |= {"goals": {"max_pressure": "max"}, "budget": {"designs": 5}}
    results = tr.run(STUDY | keys, progress=False)
    held = held_rows(results.data)[0].reshape(-1, 4)
    np.testing.assert_allclose(judge(results).violation, 1 - held.mean(axis=1))
    assert 0 < held.mean() < 1
