"""Designs that are the best for some wear coefficients, against all combinations of coefficients."""

import itertools
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

import trackroller as tr
from trackroller.report.numbers import factor_label
from trackroller.report.words.limits import best_whatever, whichever_first
from trackroller.results.first_limits import reached_hours
from trackroller.results.unsure import COEFFICIENT, settled, unbeaten
from trackroller.study.file.load import parse_study

PAIRS = ["steel", "steel", "POM", "POM", "PA6"]


def designs(lives, varied=True):
    """Make designs (i) at levels of the coefficient (j) in two further conditions, the second twice as good."""
    rows = [(i, j, f * life) for i, own in enumerate(lives) for j, life in enumerate(own) for f in (2.0, 1.0)]
    place, level, life = (np.array(part) for part in zip(*rows, strict=True))
    results = SimpleNamespace(column=lambda name: life, table=pd.DataFrame({COEFFICIENT: 10.0**level}))
    return SimpleNamespace(
        results=results,
        conditions=(COEFFICIENT,) if varied else (),
        choices=("material_pair",),
        rising=True,
        matched=True,
        goal=("pair_life_hours", "", "h"),
        usable=np.isfinite(life),
        place=place,
        size=np.bincount(place),
        table=pd.DataFrame({"material_pair": PAIRS[: len(lives)]})[::-1],
    )


@pytest.mark.parametrize("seed", range(8))
def test_unbeaten_designs_are_those_that_some_coefficients_make_the_best(seed):
    lives = np.sort(10 ** np.random.default_rng(seed).uniform(0, 2, (5, 3)), axis=1)[:, ::-1]
    best = set()
    for levels in itertools.product(range(3), repeat=3):  # each pair of materials has its own coefficient
        of_pair = dict(zip(["steel", "POM", "PA6"], levels, strict=True))
        now = [lives[i, of_pair[pair]] for i, pair in enumerate(PAIRS)]
        best.add(int(np.argmax(now)))
    found = unbeaten(designs(lives))
    assert best <= set(found.tolist())
    for lost in set(range(5)) - set(found.tolist()):
        others = [i for i in range(5) if i != lost]
        assert any(
            (lives[i] >= lives[lost]).all() if PAIRS[i] == PAIRS[lost] else lives[i].min() > lives[lost].max()
            for i in others
        )


def test_one_design_that_is_the_best_whatever_the_coefficients_are():
    assert unbeaten(designs(np.array([[900, 500], [90, 50], [40, 4], [30, 3], [8, 2]]))).tolist() == [0]


def test_a_study_that_does_not_vary_the_coefficient_gets_no_answer():
    assert unbeaten(designs(np.ones((5, 2)), varied=False)) is None


STUDY = {
    "name": "unsure",
    "base": {"radial_force": -60, "axial_force": 5, "guide_overrollings_per_hour": 600, "motor_force": 0},
    "factors": {
        "material_pair": {"values": [["1.7225-normalised"] * 2, ["EN AW-7075", "1.7225-normalised"]]},
        "velocity": {"values": [20, 120]},
        "friction_coefficient": {"values": [0.05, 0.2, 0.4]},
        "placeholder_position": {"values": [-1, 0, 1]},
    },
    "contact_model": "sliding",
    "accuracy": "preview",
    "outputs": ["forces", "contact", "peak_stress", "life", "rating", "limits"],
}


def test_conclusions_that_hold_for_all_combinations_of_the_ranges_are_counted():
    """Count by trying every combination of the places of each limit, which differ independently."""
    solved = tr.run(parse_study(STUDY), progress=False)
    reached = reached_hours(solved).reshape(2, 2, 3, 3, -1)  # pair, speed, friction, place, limit
    certain = ends = 0
    for own in reached.reshape(-1, 3, reached.shape[-1]):
        firsts = set()
        for places in itertools.product(range(3), repeat=own.shape[1]):
            hours = own[places, range(own.shape[1])]
            firsts |= {int(np.argmin(hours))} if np.isfinite(hours).any() else set()
        ends += bool(firsts)
        certain += len(firsts) == 1
    found = solved.candidates()
    assert settled(found) == (certain, ends) and 0 < certain < ends
    said = whichever_first(solved)
    assert f"in {certain} of {ends} combinations" in said.text and "placeholders of materials" in said.text
    assert best_whatever(solved).text.startswith("Whatever the placeholders of materials are")
    fixed = STUDY | {"factors": {n: f for n, f in STUDY["factors"].items() if n != "placeholder_position"}}
    assert whichever_first(tr.run(parse_study(fixed), progress=False)) is None


def test_factors_with_and_without_a_symbol_have_a_label_that_figures_can_draw():
    assert factor_label("required_travel").startswith("Travel that") and "$" not in factor_label("required_travel")
    assert "$f_\\mathrm{P}$" in factor_label("placeholder_position")
