"""Sentences of the first screen of studies whose designs cannot be compared, or that only some values decide."""

import re

import numpy as np
import pytest

import trackroller as tr
from trackroller.parameters.example import used_of
from trackroller.report.numbers import quantity, rounded
from trackroller.report.pages.study import contents
from trackroller.report.words.designs import unanswered
from trackroller.report.words.findings import sentence_of
from trackroller.report.words.verdict import verdict_sentences
from trackroller.results.findings import why
from trackroller.study.design.levels import short

LIFE = "pair_life_to_first_limit_hours"
STEEL = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
BASE = {"axial_force": 8, "motor_force": 0, "guide_curve_radius": np.inf, "guide_overrollings_per_hour": 150, **STEEL}


def run(factors, base=None, **keys):
    given = {name: value for name, value in (BASE | (base or {})).items() if name not in factors}
    study = {"name": "screen", "base": given, "factors": factors}
    return tr.run(study | {"contact_model": "sliding", "accuracy": "preview"} | keys, progress=False)


def test_designs_without_the_same_conditions_are_told_so():
    """The corners of a central composite design share theirs; its stars have the centre."""
    factors = {"contact_angle": {"uniform": [30, 40]}, "roller_profile_radius": {"uniform": [-9, -7]}}
    factors |= {"radial_force": {"uniform": [-150, -70]}, "friction_coefficient": {"uniform": [0.05, 0.2]}}
    results = run(factors, design="central_composite")
    rows = {}
    for row in results.table.itertuples():
        design = row.contact_angle, row.roller_profile_radius
        rows.setdefault(design, set()).add((row.radial_force, row.friction_coefficient))
    sizes = sorted(map(len, rows.values()))
    said = unanswered(results.candidates()).text
    found = re.match(
        r"The (\d+) designs have (\d) to (\d) conditions each, not the same for all; they are no random", said
    )
    assert [int(text) for text in found.groups()] == [len(rows), sizes[0], sizes[-1]]
    assert len(set(map(frozenset, rows.values()))) > 1 and "needs" not in said


POLYMER = {"roller_material": "POM-C", "guide_material": "C45"}
TRAVEL = {"axis_distance": {"uniform": [16, 28]}, "velocity": {"uniform": [20, 120]}}


def test_a_study_without_target_states_its_lives_and_what_ends_them():
    results = run(TRAVEL, {"radial_force": -45, **POLYMER}, design="morris", samples=6)
    lives = results.data[LIFE].values
    ends = np.unique(results.data["limiting_mechanism"].values)  # of roller and guide
    assert (results.data["limiting_mechanism"].attrs["flag_meanings"].split()[ends[0]]) == "fatigue" and len(ends) == 1
    said = {one.kind: one.text for one in verdict_sentences(results)}
    text = f"Fatigue ends the roller in each of the {lives.size} cases, after {rounded(lives.min())} to "
    assert said["lives"].startswith(text + f"{rounded(lives.max())} h")


def test_a_target_that_every_case_meets_is_told_where_designs_cannot_be_compared():
    kinds = {}
    factors = {"roller_profile_radius": {"uniform": [-7.5, -6.3]}, "radial_force": {"uniform": [-150, -70]}}
    for least in (1.0, 1e12):
        results = run(factors, design="saltelli", samples=8, analysis={"target": {"min": least}})
        kinds[least] = {one.kind: one.text for one in verdict_sentences(results)}
    lives = results.data[LIFE].values
    assert 1.0 < lives.min() and lives.min() < 1e12
    assert f"Each of the {lives.size} cases meets the target of 1 h" in kinds[1.0]["all_meet"]
    assert "all_meet" not in kinds[1e12]


def test_no_measurement_is_asked_for_where_the_best_end_misses_the_target():
    base = {"permissible_wear_depth": 0.1, "axis_distance": 25, "guide_profile_radius": 8, "contact_angle": 40}
    base |= {"axial_force": 4, "roller_material": "PA66-dry", "guide_material": "C45", "friction_coefficient": 0.15}
    factors = {"roller_profile_radius": {"values": [-8.3]}, "radial_force": {"values": [-20, -50]}}
    for least, asked in ((21e6, False), (5e3, True)):
        results = run(factors, base, analysis={"target": {"min": least}})
        high = float(results.data[f"{LIFE}_high"].min())
        said = " ".join(one.text for one in verdict_sentences(results))
        assert (high >= least) == asked == ("Measure the wear coefficient" in said)
        assert "measure it" not in said


def test_a_wear_coefficient_that_decides_is_named_with_the_target_as_given():
    """Solved again with a coefficient on either side of the value that the verdict names."""
    base = {"axis_distance": 30, "guide_profile_radius": 10, "contact_angle": 42, "velocity": 100, "axial_force": 6}
    base |= {"permissible_wear_depth": 0.15, "guide_material": "C45", "roller_material": "C45-induction-hardened"}
    base |= {"friction_coefficient": 0.12, "roller_profile_radius": -10.5}
    factors = {"radial_force": {"values": [-160, -80]}}
    results = run(factors, base, analysis={"target": {"min": 1333}})
    said = " ".join(one.text for one in verdict_sentences(results))
    assert results.verdict.kind == "measure" and "target 1333 h" in said and "lasts long enough" not in said
    turn = results.verdict.turns[0]
    assert f"Above {quantity(turn.until, turn.units)} it lasts too short" in said
    worst = BASE | base | {"radial_force": -160}
    for coefficient, end, reached in (
        (0.99 * turn.until, "high", True),
        (1.01 * turn.until, "high", False),
        (turn.low, "low", False),
    ):
        given = {"like": "C45-induction-hardened", "wear_coefficient": coefficient}
        case = tr.Case(**(worst | {"roller_material": given}))
        ds = tr.solve(case, ("life", "limits"), contact_model="sliding", accuracy="preview")
        assert (float(ds[f"{LIFE}_{end}"]) >= 1333.0) == reached


def test_a_drawn_profile_replaces_the_radius_of_the_example_and_its_arcs_are_named():
    arcs = [{"radius": -7.5, "to": -0.2}, {"radius": -6.3, "to": 0.2}, {"radius": -7.5}]
    factors = {"roller_profile": {"values": [{"arc": -6.5}, {"arcs": arcs}]}}
    keys = {"outputs": ["forces", "peak_stress", "life"], "normal": "halfspace"}
    results = run(factors, {"radial_force": -70, "friction_coefficient": 0.2}, **keys)
    page = contents(results)
    assert "guide_profile_radius 6 mm" in page["not_given"] and "roller_profile_radius" not in page["not_given"]
    names = [short("roller_profile", text) for text in results.levels("roller_profile")]
    assert sorted(names) == ["arc −6.5 mm", "arcs −7.5 to −0.2, −6.3 to 0.2, −7.5 mm"]
    inner = [[{"radius": r, "to": 0.1 * i} for i, r in enumerate((-7, -8, end))] for end in (-6, -9)]
    more = [{"arcs": [*own, {"radius": -7}]} for own in inner]
    first, second = (short("roller_profile", one) for one in more)
    assert first.startswith("4 arcs −7/…/−7 mm ") and first != second
    radius = {"roller_profile_radius": -7.0}
    assert used_of(radius | {"roller_profile": {"values": ["", {"arc": -6.5}]}}, radius) == radius


def test_the_effect_of_a_material_says_from_which_level_to_which():
    """The effect of a two-level design is the difference of the mean logarithms of the lives at both levels."""
    materials = ["1.7225-quenched-tempered", "100Cr6"]
    factors = {"axis_distance": {"uniform": [20, 24]}, "roller_profile_radius": {"uniform": [-9, -7]}}
    for listed in (materials, materials[::-1]):
        own = factors | {"roller_material": {"values": listed}, "friction_coefficient": {"uniform": [0.05, 0.2]}}
        results = run(own, {"radial_force": -90}, design="plackett_burman")
        table, lives = results.table, np.log10(results.data[LIFE].values)
        means = [lives[(table["roller_material"] == name).to_numpy()].mean() for name in listed]
        said = next(sentence_of(results, one).text for one in why(results) if one.kind == "index")
        found = re.search(r"roller material \(from (\S+) to (\S+)\).*? by ([−\d.]+)", said)
        effect = float(found[3].replace("−", "-"))
        assert {*found.groups()[:2]} == {*materials}
        assert effect == pytest.approx((means[1] - means[0]) * (1 if found[1] == listed[0] else -1), abs=0.006)
