"""What the estimators compute in one pass equals the same computed step by step, and thinned intervals stay as wide."""

import numpy as np
import pytest
from SALib.analyze import rbd_fast

from trackroller.methods.given_data import firsts
from trackroller.methods.interactions import GROUPS, held_out, pairs
from validation.benchmarks.known_indices import functions, random_rows


def test_held_out_residuals_of_nested_fits_equal_fits_without_the_row():
    rng = np.random.default_rng(1)
    table, y = rng.normal(size=(40, 9)), rng.normal(size=(40, 2))
    for width, found in zip((4, 9, 3), held_out(y, table, (4, 9, 3)), strict=True):
        for row in (0, 17, 39):
            kept = np.arange(40) != row
            fit = np.linalg.lstsq(table[kept, :width], y[kept], rcond=None)[0]
            np.testing.assert_allclose(found[row], y[row] - table[row, :width] @ fit, rtol=1e-9)


def test_held_out_gives_nothing_for_too_few_rows_or_dependent_columns():
    table = np.random.default_rng(2).normal(size=(20, 9))
    table[:, 5] = table[:, 0]
    assert [one is None for one in held_out(np.ones(20), table, (5, 6, 9))] == [False, True, True]


def test_interval_of_an_interaction_equals_a_jackknife_of_twenty_fits():
    """Two factors of two values: the polynomial is 1, a, b and ab, and its shares are known from three contrasts."""
    rng = np.random.default_rng(3)
    unit = rng.integers(0, 2, (300, 2))
    y = unit[:, 0] + 2.0 * unit[:, 0] * unit[:, 1] + 0.1 * rng.normal(size=300)
    found = pairs(y, unit.astype(float), np.array([True, True]), seed=5)
    signs = (unit - unit.mean(axis=0)) / unit.std(axis=0)
    table = np.column_stack([np.ones(300), signs, signs.prod(axis=1)])
    part = np.random.default_rng(5).permutation(300) % GROUPS

    def share(rows):
        fit, rest = np.linalg.lstsq(table[rows], y[rows], rcond=None)[:2]
        error = np.linalg.inv(table[rows].T @ table[rows])[3, 3] * rest[0] / (rows.sum() - 4)
        return (fit[3] ** 2 - error) / y[rows].var()

    left = np.array([share(part != g) for g in range(GROUPS)])
    half = 1.959964 * np.sqrt((GROUPS - 1) / GROUPS * ((left - left.mean()) ** 2).sum())
    assert found["interaction_share"][0, 1] == pytest.approx(share(part >= 0), rel=1e-9)
    assert found["interaction_share_high"][0, 1] == pytest.approx(share(part >= 0) + half, rel=1e-9)


@pytest.mark.parametrize("name", ["Ishigami", "g-function"])
def test_interval_of_a_long_sample_covers_the_index_and_is_as_wide_as_that_of_all_rows(name):
    f = functions()[name]
    unit, y = random_rows(f, 20_000, 7)
    found = firsts(y, unit, np.ones(unit.shape[1], bool))
    assert np.all(np.abs(found["first"] - f.first) <= 1.5 * (found["first_high"] - found["first"]))
    strong = int(np.argmax(f.first))
    spread = rbd_fast.bootstrap(unit[:, strong], y, 10, 100, 0.95, np.random.default_rng(8)) * 0.5**0.5
    assert found["first_high"][strong] - found["first"][strong] == pytest.approx(spread, rel=0.35)


def test_a_rare_event_in_a_long_sample_has_an_interval():
    rng = np.random.default_rng(9)
    x = rng.random((50_000, 2))
    found = firsts((x[:, 0] < 4e-4).astype(float), x, np.ones(2, bool))
    assert np.all(found["first_high"] > found["first"])
