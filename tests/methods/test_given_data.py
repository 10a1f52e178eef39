"""Measures from given data against values known in closed form or by brute force."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm, qmc

from trackroller.methods.delta import delta
from trackroller.methods.given_data import firsts
from trackroller.methods.interactions import pairs


def ishigami(u: np.ndarray) -> np.ndarray:
    x = (2 * u - 1) * np.pi
    return np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def exact_delta(correlation: float) -> float:
    """Return the delta of a normal pair: mean total variation of N(r x, 1 - r^2) from N(0, 1)."""
    x = norm.ppf((np.arange(1000) + 0.5) / 1000)[:, None]
    y = np.linspace(-8, 8, 2001)
    apart = np.abs(norm.pdf(y, correlation * x, np.sqrt(1 - correlation**2)) - norm.pdf(y))
    return float(apart.sum(axis=1).mean() * (y[1] - y[0]) / 2)


@pytest.mark.parametrize("correlation", [0.1, 0.3, 0.7, 0.95, 0.99])
def test_delta_of_a_normal_pair_is_within_three_hundredths_of_its_closed_form(correlation):
    rng = np.random.default_rng(4)
    x, noise = rng.standard_normal((2, 4096))
    y = np.exp(correlation * x + np.sqrt(1 - correlation**2) * noise)  # a monotonic function changes nothing
    value, low, high, _ = delta(y, x)
    assert value == pytest.approx(exact_delta(correlation), abs=0.03)
    assert low <= exact_delta(correlation) <= high


def test_delta_of_the_ishigami_function_is_within_three_hundredths():
    """Truth by histograms of 4 million rows."""
    u = np.random.default_rng(1).random((4096, 3))
    found = [delta(ishigami(u), u[:, j])[0] for j in range(3)]
    np.testing.assert_allclose(found, [0.262, 0.425, 0.210], atol=0.03)


def test_delta_of_inert_factors_stays_within_chance():
    below = 0
    for seed in range(30):
        rng = np.random.default_rng(seed)
        value, low, _, noise = delta(rng.random(400), rng.integers(0, 4, 400), ordered=False)
        below += value <= noise
        assert low == 0.0 or value > noise
    assert below >= 27


def test_first_order_index_of_ordered_rows_of_a_grid():
    """Rows in the order of a grid repeat the pattern of the other factors: only the own share may count."""
    grid = np.indices((4, 50, 5)).reshape(3, -1).T.astype(float)
    part = np.array([0.2, 3.0, 1.0])
    y = ((grid - grid.mean(axis=0)) / grid.std(axis=0)) @ part
    found = firsts(y, grid, np.ones(3, dtype=bool))
    np.testing.assert_allclose(found["first"], part**2 / (part**2).sum(), atol=0.02)


@pytest.mark.parametrize("rows", [128, 256, 512])
def test_a_category_of_a_sobol_sequence_lends_no_share_to_an_inert_factor(rows):
    """A category of two levels makes 0.95 of the variance; without its means taken out, inert factors reach 0.3."""
    share = np.array([1 / 12, 2.6**2 * 0.21, *[0.0] * 8])
    share /= share.sum()
    for seed in range(12):
        unit = qmc.Sobol(10, seed=seed).random(rows)
        unit[:, 1] = unit[:, 1] > 0.7
        found = firsts(2.6 * unit[:, 1] + unit[:, 0], unit, np.arange(10) != 1)
        np.testing.assert_allclose(found["first"], share, atol=0.045)
        assert found["first_low"][0] <= share[0] <= found["first_high"][0]


def test_a_factor_that_depends_on_a_category_keeps_the_influence_that_they_share():
    """y = x with x = category + noise: Var(E[y|x])/V is 1, although the category alone gives most of it."""
    rng = np.random.default_rng(3)
    kind = rng.integers(0, 2, 400).astype(float)
    x = kind + 0.1 * rng.random(400)
    found = firsts(x, np.column_stack([x, kind]), np.array([True, False]))
    np.testing.assert_allclose(found["first"], 1.0, atol=0.05)  # ten harmonics do not follow a step fully


def test_interactions_of_the_ishigami_function_from_a_plain_sample():
    u = np.random.default_rng(2).random((1024, 3))
    found = pairs(ishigami(u), u, np.array([True] * 3))
    assert found["fit_share"] > 0.95
    share = found["interaction_share"]
    assert share[0, 2] == pytest.approx(0.244, abs=0.03)
    np.testing.assert_allclose(found["fit_alone"], [0.314, 0.442, 0.0], atol=0.04)
    assert abs(share[0, 1]) < 0.02 and abs(share[1, 2]) < 0.02 and np.isnan(share[2, 0])
    assert found["interaction_share_low"][0, 2] < 0.244 < found["interaction_share_high"][0, 2]


def test_interaction_of_a_number_with_a_category():
    rng = np.random.default_rng(3)
    x, kind = rng.random((400, 2)), rng.integers(0, 3, 400)
    y = x[:, 0] + np.array([0, 0.5, -0.3])[kind] + 2 * (x[:, 1] - 0.5) * np.array([1, -1, 0])[kind]
    joint = 4 / 12 * 2 / 3
    truth = joint / (1 / 12 + np.var([0, 0.5, -0.3]) + joint)
    found = pairs(y, np.column_stack([x, kind]), np.array([True, True, False]))
    assert found["interaction_share"][1, 2] == pytest.approx(truth, abs=0.06)


def test_no_interaction_is_told_where_no_polynomial_predicts():
    rng = np.random.default_rng(5)
    u = rng.random((300, 2))
    found = pairs(np.sin(90 * u[:, 0]) * np.sin(70 * u[:, 1]), u, np.array([True, True]))
    assert np.isnan(found["interaction_share"]).all() and found["fit_share"] < 0.5
