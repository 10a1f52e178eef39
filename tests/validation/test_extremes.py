"""Edge scenes: the quick part of the catalogue holds, kernels keep digits, random extremes are finite or flagged."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from validation.extremes.checks import examine, missing, run_cases
from validation.extremes.kernels import KERNELS
from validation.extremes.random_cases import random_extremes
from validation.extremes.scenes import scenes, thinned


def marked(scene):
    """Mark the scene slow that takes as long as all others."""
    return pytest.param(scene, id=scene.name, marks=[pytest.mark.slow] * (scene.name == "spin pole on the edge"))


@pytest.mark.long
@pytest.mark.parametrize("scene", [marked(scene) for scene in scenes()])
def test_claims_on_a_scene_hold(scene):
    broken = [f for f in examine(scene, "sliding", "preview")[1] if not f.holds]
    assert not broken


@pytest.mark.parametrize("model", ["kalker"])
def test_rolling_contact_holds_on_a_thinned_scene(model):
    scene = next(s for s in scenes() if s.name == "loads")
    broken = [f for f in examine(thinned(scene, 4), model, "preview")[1] if not f.holds]
    assert not broken


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda k: k.__name__)
def test_a_kernel_keeps_its_digits(kernel):
    assert kernel().holds


@pytest.mark.slow
@settings(max_examples=6, deadline=None, derandomize=True)
@given(st.integers(0, 2**31))
def test_random_extremes_are_finite_or_flagged_and_quiet(seed):
    ds, warned = run_cases(random_extremes(40, seed), "sliding", "preview")
    carries = ds.regime.values < 2
    assert warned == 0
    for name in ("normal_force", "lateral_force", "driving_force", "max_pressure", "peak_stress", "life_cycles"):
        assert not missing(ds, name).any()
        assert np.isnan(ds[name].values[~carries]).all()
    assert (ds.regime.values == 3).mean() < 0.1
