"""The 95 % interval of an elementary effect holds the mean effect of a factor in 95 of 100 studies."""

import numpy as np
import pytest

from trackroller.methods.morris import morris


@pytest.mark.parametrize("count", [8, 12, 20])
def test_the_interval_holds_the_mean_effect(count):
    """Two factors, one step each: effects are drawn, so the mean effect is known."""
    rng = np.random.default_rng(count)
    held = []
    for _ in range(500):
        effect = rng.normal(1.0, 0.2, (count, 2))
        unit = np.tile([[0.0, 0.0], [2 / 3, 0.0], [2 / 3, 2 / 3]], (count, 1))
        y = np.concatenate([np.zeros((count, 1)), np.cumsum(effect * 2 / 3, axis=1)], axis=1).ravel()
        found = morris(y, unit, np.zeros(2, dtype=bool))
        np.testing.assert_allclose(found["mu_star"], effect.mean(axis=0))
        held.append((found["mu_star_low"] <= 1.0) & (found["mu_star_high"] >= 1.0))
    share = float(np.mean(held))
    assert 0.93 <= share <= 0.97
