"""Curves of factors by changes between like cases: screening designs and tables of unlike rows, by other code."""

from __future__ import annotations

import numpy as np
import pytest

import trackroller as tr
from trackroller.report.headlines import headline_of
from trackroller.report.pictures.curves import caption
from trackroller.results.like_changes import effect_of_changes


def trajectories(rng, count, factors):
    """Return rows of a screening design: steps of two of four levels, one factor after the other."""
    rows = []
    for _ in range(count):
        row = rng.integers(0, 4, factors)
        rows.append(row.copy())
        for factor in rng.permutation(factors):
            row[factor] += 2 if row[factor] < 2 else -2
            rows.append(row.copy())
    return np.array(rows)


def groups_beside(rows, factor):
    return np.unique(np.delete(rows, factor, axis=1), axis=0, return_inverse=True)[1].ravel()


def test_a_parabola_is_found_where_steps_skip_levels():
    rows = trajectories(np.random.default_rng(5), 8, 5)
    levels = np.array([1.0, 2.0, 3.0, 4.0])
    own = 3.0 * levels - 0.4 * levels**2
    y = own[rows[:, 0]] + 7.0 * rows[:, 1] + np.sin(rows[:, 2]) - rows[:, 3] * rows[:, 4]
    effect, _ = effect_of_changes(y, rows[:, 0], groups_beside(rows, 0), levels)
    assert effect - effect[0] == pytest.approx(own - own[0], abs=1e-9)


def test_each_level_has_its_own_effect_where_changes_connect_them():
    rng = np.random.default_rng(6)
    own = np.array([0.0, 5.0, -2.0])
    group = np.repeat(np.arange(12), 2)  # each group has two of three levels
    place = np.concatenate([rng.permutation(3)[:2] for _ in range(12)])
    beside = rng.normal(0, 100, 12)
    effect, found = effect_of_changes(own[place] + beside[group], place, group, None)
    assert effect - effect[0] == pytest.approx(own - own[0], abs=1e-9)
    assert found + effect[0] == pytest.approx(beside + own[0], abs=1e-9)


def test_unlike_cases_and_names_apart_give_no_effect():
    y = np.arange(6.0)
    place = np.array([0, 1, 2, 0, 1, 2])
    assert effect_of_changes(y, place, np.arange(6), np.array([1.0, 2.0, 3.0])) is None
    apart = np.array([0, 1, 0, 1, 0, 1, 2, 3, 2, 3, 2, 3])  # no change leads from the first to the last names
    assert effect_of_changes(np.arange(12.0), apart, np.repeat(np.arange(6), 2), None) is None


@pytest.fixture(scope="module")
def screened(tmp_path_factory):
    """A screening of an output of both signs, which the travel speed cannot change."""
    place = tmp_path_factory.mktemp("screen")
    study = {
        "name": "screen",
        "base": {"guide_curve_radius": float("inf"), "motor_force": 0},
        "factors": {
            "axial_force": {"uniform": [-45, 45]},
            "radial_force": {"uniform": [-380, -150]},
            "roller_profile_radius": {"uniform": [-9, -6.4]},
            "contact_angle": {"uniform": [40, 55]},
            "velocity": {"uniform": [20, 90]},
        },
        "own": {"imbalance": "(normal_force_1 - normal_force_2) / abs(radial_force)"},
        "method": "morris",
        "samples": 8,
        "seed": 3,
        "outputs": ["forces", "friction_work"],
        "analysis": {"outputs": ["imbalance"]},
        "contact_model": "sliding",
        "accuracy": "preview",
    }
    return tr.run(study, results=place, progress=False)


def elementary_effects(results):
    """Return the mean of the absolute changes of the imbalance over the whole range of each factor, by a plain loop."""
    table, factors = results.table, list(results.factors)
    first, second = results.data["normal_force"].values.T
    y = (first - second) / -table["radial_force"].to_numpy()
    rows = table[factors].to_numpy(dtype=float)
    width = rows.max(axis=0) - rows.min(axis=0)
    found = {name: [] for name in factors}
    for one in range(len(rows) - 1):
        changed = np.flatnonzero(rows[one] != rows[one + 1])
        if len(changed) == 1:
            step = (rows[one + 1] - rows[one])[changed[0]] / width[changed[0]]
            found[factors[changed[0]]].append(abs((y[one + 1] - y[one]) / step))
    return {name: np.mean(steps) for name, steps in found.items()}


def test_a_screening_names_the_factors_with_the_largest_effects(screened):
    effects = elementary_effects(screened)
    answer = screened.answer
    named = [factor["name"] for factor in answer.headline["factors"]]
    assert named == sorted(effects, key=effects.get, reverse=True)[:2]
    assert {curve.by for curve in answer.curves} <= {"changes", "like cases"}
    heights = {curve.factor: curve.height for curve in answer.curves}
    assert effects["velocity"] == pytest.approx(0, abs=1e-12)
    assert heights["velocity"] == pytest.approx(0, abs=1e-12)
    for name, height in heights.items():
        assert height <= 1.6 * effects[name] + 1e-9, f"{name} acts by {effects[name]}"
    assert "axial force" in headline_of(answer).text.lower()
    assert "changes between cases that differ in this factor alone" in caption(answer)


def test_factors_that_go_together_in_a_table_have_no_curve(tmp_path):
    """Three named loads, in which the friction goes with the load, for two materials."""
    lines = ["drawing,load case,roller_material,radial_force,friction_coefficient"]
    for drawing, material in (("A", "1.7225-normalised"), ("B", "C45"), ("C", "POM")):
        for case, load, friction in (("run", -60, 0.1), ("stop", -120, 0.2), ("kick", -200, 0.15)):
            lines.append(f"{drawing},{case},{material},{load},{friction}")
    (tmp_path / "loads.csv").write_text("\n".join(lines), encoding="utf-8")
    base = {"motor_force": 0, "axial_force": 5, "guide_curve_radius": float("inf")}
    study = {
        "name": "together",
        "base": base | {"guide_overrollings_per_hour": 60, "roller_profile_radius": -6.5},
        "method": "table",
        "table": str(tmp_path / "loads.csv"),
        "contact_model": "sliding",
        "accuracy": "preview",
    }
    results = tr.run(study, results=tmp_path / "results", progress=False)
    curves = {curve.factor: curve for curve in results.answer.curves}
    assert set(curves) == {"roller_material"}, "neither load nor friction changes alone"
    life = results.table.groupby("roller_material", sort=False)["pair_life_to_first_limit_hours"].median()
    (curve,) = curves.values()
    assert curve.middle == pytest.approx([life[level] for level in curve.levels])
