"""Borders that decide: classes, targets met, words for signs. `validation/mutants.py` turns each of them round."""

from __future__ import annotations

import itertools
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from trackroller.analysis.groups import classes
from trackroller.analysis.targets import _all, _hits
from trackroller.report.numbers import level_text


def test_a_value_on_an_edge_belongs_to_the_class_above():
    """100 values in four classes: none overlap, each begins at its quantile, and the largest is in the last."""
    values = np.random.default_rng(1).permutation(100).astype(float)
    view = SimpleNamespace(
        table=pd.DataFrame({"axial_force": values}), levels=lambda name: sorted(values), numeric=lambda name: True
    )
    index, ends = classes(view, "axial_force", np.ones(100, dtype=bool), 4)
    edges = np.quantile(values, [0, 0.25, 0.5, 0.75], method="nearest")
    assert [low for low, _ in ends] == edges.tolist()
    assert all(high < low for (_, high), (low, _) in itertools.pairwise(ends))
    assert ends[-1][1] == 99.0 and np.bincount(index).min() >= 24


def test_a_target_is_met_at_its_limits():
    values = SimpleNamespace(values=np.array([9.9, 10.0, 15.0, 20.0, 20.1, np.nan]))
    assert _hits(values, {"min": 10.0, "max": 20.0}, None).tolist() == [0, 1, 1, 1, 0, 0]


def test_all_targets_of_a_body_are_met_with_the_least_of_their_probabilities():
    """Lives of one body fail together, those of two bodies independently, and another output counts for itself."""
    hits = np.array([[0.9, 0.6, 0.5, 1.0], [0.2, 0.7, 1.0, 0.0]])
    names = ["roller_life_hours", "life_cycles_roller", "guide_life_hours", "max_pressure"]
    assert _all(hits, names).tolist() == pytest.approx([0.6 * 0.5, 0.0])


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("guide_curve_radius", 220.0, "outer curve 220 mm"),
        ("guide_curve_radius", -220.0, "inner curve 220 mm"),
        ("guide_curve_radius", np.inf, "straight"),
        ("motor_force", -30.0, "driven −30 N"),
        ("motor_force", 30.0, "braked 30 N"),
        ("motor_force", 0.0, "free rolling"),
    ],
)
def test_signs_in_words(name, value, words):
    assert level_text(name, value) == words
