"""The comparison of estimators with libraries runs, and its reasons for keeping our own estimators hold."""

import numpy as np
import pytest

from validation.benchmarks import index_estimators as tool
from validation.benchmarks.known_indices import functions


def measured(kind: str, name: str, seeds: int) -> dict[str, dict[str, float]]:
    """Return the numbers of both estimators in the comparison whose name starts with `name`."""
    data, truth = next((d, t) for k, n, d, t in tool.cases() if k == kind and n.startswith(name))
    return {who: tool.numbers(one, data, truth, seeds) for who, one in tool.ESTIMATORS[kind].items()}


def test_closed_forms_agree_with_brute_force():
    """Variance of conditional means over 200 000 rows, each function."""
    for name, function in functions().items():
        unit = np.random.default_rng(0).random((200_000, len(function.first)))
        y = function.evaluate(unit)
        for j, exact in enumerate(function.first):
            group = (unit[:, j] * 100).astype(int)
            mean = np.bincount(group, y) / np.bincount(group)
            assert mean.var() / y.var() == pytest.approx(exact, abs=0.01), (name, j)


@pytest.mark.parametrize("name", list(functions()))
def test_sobol_by_correlations_has_smaller_errors_than_salib_and_covers_as_often(name):
    found = measured("sobol", f"Sobol indices, {name}", 16)
    ours, theirs = found["ours"], found["SALib sobol"]
    assert ours["rmse"] < 0.8 * theirs["rmse"] and ours["half_width"] < 0.8 * theirs["half_width"]
    assert ours["coverage"] > max(0.9, theirs["coverage"] - 0.05)


@pytest.mark.slow
def test_first_order_indices_use_rbd_fast_for_numbers_and_groups_for_categories():
    """The same values as SALib for numbers; a category is unbiased, where RBD-FAST alone is not."""
    numbers = measured("first", "first-order index, Ishigami, 256 rows", 12)
    assert numbers["ours"]["rmse"] == pytest.approx(numbers["SALib rbd_fast"]["rmse"])
    assert numbers["ours"]["bias"] < 0.03 and numbers["ours"]["coverage"] > 0.9
    kinds = measured("first", "first-order index, number and category", 12)
    assert kinds["ours"]["bias"] < 0.02 and kinds["SALib rbd_fast"]["bias"] > 0.05


@pytest.mark.parametrize("correlation", [0.0, 0.99])
def test_delta_has_smaller_errors_than_salib(correlation):
    found = measured("delta", f"delta, normal pair r = {correlation}, 400 rows", 8)
    assert found["ours"]["rmse"] < 0.5 * found["SALib delta"]["rmse"] and found["ours"]["coverage"] > 0.8


def test_interactions_have_smaller_errors_than_salib():
    found = measured("pairs", "interactions, Ishigami, 400 rows", 3)
    assert found["ours"]["rmse"] < found["SALib hdmr"]["rmse"]


def test_the_program_compares_each_estimator_and_design():
    found = tool.measure(seeds=4, only=("pairs",))
    assert set(found["estimators"]["interactions, Ishigami, 400 rows"]) == {"ours", "SALib hdmr"}
    assert found["designs"]["box_behnken"] == {"the same rows": [3, 4, 5], "pyDOE has more rows": [6, 7]}
    assert found["designs"]["plackett_burman"]["pyDOE fails"][:5] == [24, 25, 26, 27, 32]
