"""Borders that decide: classes, targets met, words for signs. `validation/mutants.py` turns each of them round."""

from __future__ import annotations

import itertools
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from trackroller.errors import WorkError
from trackroller.report.explorer.pack import RARE, _numbers, sample_rows
from trackroller.report.numbers import level_text
from trackroller.results.candidates import FEWEST, Candidates, lift_off_margin
from trackroller.results.factor_levels import classes
from trackroller.results.targets import _all, hits_of
from trackroller.roller.requirement import Requirement
from trackroller.study import cost
from trackroller.study.file.load import parse_study
from trackroller.study.outputs import _countable
from trackroller.study.store.gather import gather
from trackroller.study.store.ledger import working_ledger


def test_a_value_on_an_edge_belongs_to_the_class_above():
    """100 values in four classes: none overlap, each begins at its quantile, and the largest is in the last."""
    values = np.random.default_rng(1).permutation(100).astype(float)
    table = pd.DataFrame({"axial_force": values})
    index, ends = classes(table, "axial_force", np.ones(100, dtype=bool), 4)
    edges = np.quantile(values, [0, 0.25, 0.5, 0.75], method="nearest")
    assert [low for low, _ in ends] == edges.tolist()
    assert all(high < low for (_, high), (low, _) in itertools.pairwise(ends))
    assert ends[-1][1] == 99.0 and np.bincount(index).min() >= 24


def test_a_target_is_met_at_its_limits():
    values = SimpleNamespace(values=np.array([9.9, 10.0, 15.0, 20.0, 20.1, np.nan]))
    assert hits_of(values, Requirement(10.0, 20.0), None).tolist() == [0, 1, 1, 1, 0, 0]


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


def test_zero_has_no_logarithm_and_is_counted():
    """0 and negative values are lost on a logarithmic scale, with their reason."""
    everything = np.ones(4, dtype=bool)
    values, why = _countable(np.array([10.0, 0.0, -1.0, 100.0]), everything, ~everything, False, "log10")
    assert why == {"not positive": 2}
    np.testing.assert_array_equal(values, [1.0, np.nan, np.nan, 2.0])


@pytest.mark.parametrize("levels", [254, 255, 256, 65_535, 65_536])
def test_positions_of_all_levels_are_told_apart(levels):
    """A column of so many levels has a number for each of them, and 0 for no value."""
    column = SimpleNamespace(levels=range(levels), values=np.arange(-1, levels))
    assert _numbers(column).tolist() == list(range(levels + 1))


def test_a_state_of_just_so_many_cases_counts_as_rare():
    """States of `RARE` cases and fewer keep all of their cases; a common one keeps its share."""
    state = np.repeat([0, 1, 2], [RARE, RARE - 1, 20 * RARE])
    rows = sample_rows(state, np.zeros(len(state), dtype=bool), most=5 * RARE)
    assert np.bincount(state[rows]).tolist() == [RARE, RARE - 1, 3 * RARE + 1]


def test_the_rate_of_several_models_is_that_of_their_times_together(monkeypatch):
    """A study with a quick and a slow model takes the time of both: the rate is the harmonic mean."""
    models = {"contact_model": {"values": ["sliding", "kalker"]}}
    study = SimpleNamespace(factors=models, options={}, friction_laws=[None])
    monkeypatch.setattr(cost, "rate", lambda options, law: {"sliding": 100.0, "kalker": 1.0}[options["contact_model"]])
    assert cost.study_rate(study) == pytest.approx(2 / (1 / 100 + 1 / 1))


@pytest.mark.parametrize(("sizes", "comparable"), [((FEWEST, 90), True), ((FEWEST - 1, 90), False)])
def test_each_design_needs_a_sample_of_its_conditions(sizes, comparable):
    candidates = SimpleNamespace(conditions=("axial_force",), matched=False, size=np.array(sizes), weighted=True)
    assert Candidates.comparable.fget(candidates) is comparable


def test_the_margin_to_lift_off_is_the_light_contact_over_the_heavy_one():
    loads = {"normal_force_1": np.array([30.0, 80.0]), "normal_force_2": np.array([120.0, 20.0])}
    assert lift_off_margin(SimpleNamespace(column=loads.get, regime=np.zeros(2, dtype=int))).tolist() == [0.25, 0.25]


def test_a_study_with_unsolved_cases_is_not_gathered(tmp_path):
    study = parse_study({"name": "two", "factors": {"friction_coefficient": {"values": [0.1, 0.2]}}})
    with working_ledger(study, tmp_path) as ledger, pytest.raises(WorkError, match=r"^2 of 2 cases are not solved"):
        gather(ledger)
