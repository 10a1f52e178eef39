"""Designs that are the best for some wear coefficients, against all combinations of coefficients."""

import itertools
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from trackroller.analysis.unsure import COEFFICIENT, unbeaten

PAIRS = ["steel", "steel", "POM", "POM", "PA6"]


def designs(lives, varied=True):
    """Make designs (i) at levels of the coefficient (j) in two further conditions, the second twice as good."""
    rows = [(i, j, f * life) for i, own in enumerate(lives) for j, life in enumerate(own) for f in (2.0, 1.0)]
    place, level, life = (np.array(part) for part in zip(*rows, strict=True))
    view = SimpleNamespace(column=lambda name: life, table=pd.DataFrame({COEFFICIENT: 10.0**level}))
    return SimpleNamespace(
        view=view,
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
