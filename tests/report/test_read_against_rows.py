"""Sentences that a reader took for false: what they count and name, against the raw rows."""

import json
from pathlib import Path

import numpy as np
import pytest

import trackroller as tr
from trackroller.contact.profiles import canonical
from trackroller.report.numbers import between, lasting, on_duty
from trackroller.report.pages.study import contents
from trackroller.report.words.designs import best_table, unanswered
from trackroller.report.words.optimum import optimum_sentences
from trackroller.report.words.pareto import pareto_sentence
from trackroller.report.words.verdict import verdict_sentences
from trackroller.study.design.levels import short

LIFE = "pair_life_to_first_limit_hours"
STEEL = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
BASE = {"axial_force": 8, "motor_force": 0, "guide_curve_radius": np.inf, "guide_overrollings_per_hour": 150, **STEEL}
LOADS = {"radial_force": {"values": [-150, -70]}, "friction_coefficient": {"values": [0.1, 0.2]}}


def run(factors, base=None, **keys):
    study = {"name": "read", "base": BASE | (base or {}), "factors": factors}
    return tr.run(study | {"contact_model": "sliding", "accuracy": "preview"} | keys, progress=False)


def search(goals, **keys):
    factors = {"axis_distance": {"uniform": [15, 28]}, "profile_ratio": {"uniform": [1.05, 1.3]}}
    factors["roller_profile_radius"] = {"expression": "-profile_ratio * guide_profile_radius"}
    return run(factors | LOADS, design="optimise", goals=goals, budget={"designs": 24}, **keys)


def test_the_cases_of_a_saltelli_design_are_not_all_designs_of_their_own():
    factors = {"roller_profile_radius": {"uniform": [-7.5, -6.3]}, "radial_force": {"uniform": [-150, -70]}}
    results = run(factors, design="saltelli", samples=8)
    said = unanswered(results.candidates()).text
    rows = results.data["roller_profile_radius"].values
    assert len(np.unique(rows)) == 16 < len(rows)  # mixtures repeat the designs of both samples
    assert f"Of the {len(rows)} cases 16 are independent" in said
    assert "roller profile radius as a list and radial force as a distribution with" in said


def test_a_design_that_lasts_too_short_somewhere_is_not_told_to_last_there():
    results = run({"roller_profile_radius": {"values": [-7.5, -6.3]}, "radial_force": LOADS["radial_force"]})
    lives = results.data[LIFE].transpose("roller_profile_radius", ...).values
    least = float(np.sqrt(lives[0].min() * lives[0].max()))  # the worse design meets it in one of two conditions
    assert lives[1].min() > least
    factors = {"roller_profile_radius": {"values": [-7.5, -6.3]}, "radial_force": LOADS["radial_force"]}
    results = run(factors, analysis={"target": {"min": least}})
    said = " ".join(one.text for one in verdict_sentences(results))
    assert ", enough in 1 of 2 conditions." in said


def test_a_constraint_on_a_goal_is_a_requirement():
    goals = {"max_pressure": "min", "axis_distance": "min"}
    free = optimum_sentences(search(goals))[0].text
    results = search(goals, constraints=["max_pressure < 600"])
    said = optimum_sentences(results)[0].text
    assert free.startswith("Give a requirement.") and said.startswith("Recommended: ")
    pressure = results.data["max_pressure"].max("contact").values.reshape(-1, 4).max(axis=1)
    size = results.data["axis_distance"].values.reshape(-1, 4)[:, 0]
    cost = np.stack([pressure, size], axis=1)[pressure < 600]
    beaten = [((cost <= own).all(axis=1) & (cost < own).any(axis=1)).any() for own in cost]
    assert f"Of {len(cost) - sum(beaten)} Pareto-optimal designs it is nearest" in said


def test_a_set_of_lives_that_are_ranges_says_which_number_it_takes():
    results = search({LIFE: "max"}, base={"permissible_wear_depth": 0.02})
    low, high = (results.data[f"{LIFE}_{end}"].values.reshape(-1, 4).min(axis=1) for end in ("low", "high"))
    middle = results.data[LIFE].values.reshape(-1, 4).min(axis=1)
    assert (high > 1.01 * low).all()
    told = pareto_sentence(results.pareto(), results).text
    assert f"{lasting(middle.max(), 'h')}" in told and "the wear life at the mean of its bounds." in told


def test_the_table_says_that_conditions_which_no_design_meets_are_left_out():
    factors = {"contact_angle": {"values": [30, 42]}, "radial_force": {"values": [-30, -120]}}
    for axial, lifts in ((25, True), (4, False)):
        results = run(factors, base={"axial_force": axial})
        regime = results.data["regime"].transpose("radial_force", ...).values
        assert bool((regime[1] == 2).all() or (regime[0] == 2).all()) == lifts
        assert ("Conditions that no candidate meets are left out." in best_table(results).note) == lifts


def test_a_measured_profile_has_the_name_of_its_file(tmp_path, monkeypatch):
    """The name stays where only the points are stored, and a smoothed profile has another name than the raw one."""
    monkeypatch.chdir(tmp_path)
    x = np.linspace(-4.0, 4.0, 81)
    z = np.sqrt(6.8**2 - x**2) - 6.8
    Path("worn.csv").write_text("\n".join(f"{a:.4f}; {b:.6f}" for a, b in zip(x, z, strict=True)), encoding="utf-8")
    levels = [{"arc": -6.8}, {"file": "worn.csv"}, {"file": "worn.csv", "smooth": "auto"}]
    results = run({"roller_profile": {"values": levels}, "radial_force": {"values": [-60, -120]}}, normal="halfspace")
    names = [short("roller_profile", value) for value in results.data["roller_profile"].values]
    assert names[:2] == ["arc −6.8 mm", "worn.csv, 81 points"] and names[2].startswith("worn.csv ")
    assert len(set(names)) == 3
    lives = results.data["roller_life_hours"].transpose("roller_profile", ...).values
    np.testing.assert_allclose(lives[1], lives[0], rtol=0.05)
    stored = canonical(json.loads(str(results.data["roller_profile"].values[1])))  # without the file
    assert stored["name"] == "worn.csv" and len(stored["points"]) == 81
    named = canonical({"points": stored["points"], "name": "Rig 3, after 40 km"})
    assert short("roller_profile", named) == "Rig 3, after 40 km, 81 points"
    with pytest.raises(tr.InputError, match="exactly one of"):
        canonical({"points": stored["points"], "file": "worn.csv"})
    with pytest.raises(tr.InputError, match="at most 80"):
        canonical({"points": stored["points"], "name": "a\nb"})


def test_the_page_names_what_was_not_checked_once():
    """A table of options said that nothing was left out, beside a verdict that names limits without inputs."""
    results = run(LOADS)
    said = " ".join(one.text for one in verdict_sentences(results))
    checked = results.data["life_hours_by_limit"].notnull().any(LOADS).sel(body="roller")
    assert "Not checked:" in said and not bool(checked.sel(limit="wear"))
    assert "Not checked" not in [row.words for row in contents(results)["options"]]


def test_one_year_is_singular():
    with on_duty({"hours_per_day": 8, "days_per_year": 220}):
        assert lasting(1760.0, "h") == "1760 h (1 year)"
        assert between(1760.0, 1761.0).endswith("(1 year)") and between(1760.0, 3520.0).endswith("(1 to 2 years)")
