"""The recorder repeats itself, and the comparison finds what was changed."""

from __future__ import annotations

import json

import numpy as np
import pytest

import trackroller as tr
from trackroller.parameters import CONTACT_MODELS
from validation.same_numbers.__main__ import main
from validation.same_numbers.archive import load, save, text
from validation.same_numbers.cases import record_cases
from validation.same_numbers.compare import compare
from validation.same_numbers.groups import Group, groups
from validation.same_numbers.signatures import python_names
from validation.same_numbers.study_files import drawn_designs, small_studies

QUICK = {"contact_model": "sliding", "accuracy": "preview"}
THREE = Group("three", [{}, {"motor_force": 0.0}, {"motor_force": -500.0}], QUICK)


@pytest.fixture
def files(tmp_path):
    """Return two recordings of the same three cases, solved twice."""
    paths = tmp_path / "before.npz", tmp_path / "after.npz"
    for path in paths:
        save(path, record_cases([THREE]))
    return paths


def changed(path, key, change):
    """Write a recording anew with one array changed."""
    archive = load(path)
    archive[key] = change(archive[key].copy())
    save(path, archive)


def scaled(index, factor):
    """Return a change that multiplies one value."""

    def change(values):
        values[index] *= factor
        return values

    return change


def test_two_recordings_are_equal(files, capsys):
    """Three cases that are solved twice agree in every bit, and all variables are recorded."""
    assert main(["compare", *map(str, files)]) == 0
    assert "physics     same" in capsys.readouterr().out
    recorded = {key.rpartition("/")[2] for key in load(files[0])}
    assert set(tr.solve(THREE.cases, **THREE.options).variables) <= recorded


@pytest.mark.parametrize("index", [(0, 0), (2, 1)])
def test_one_altered_value_is_found(files, capsys, index):
    """A force that is altered by 1e-9 fails without tolerance and passes with 1e-8."""
    changed(files[1], "cases/three/normal_force", scaled(index, 1 + 1e-9))
    assert main(["compare", *map(str, files)]) == 1
    printed = capsys.readouterr().out
    assert "normal_force" in printed and "physics     DIFFERENT" in printed and " 1 of " in printed
    assert main(["compare", *map(str, files), "--tolerance", "1e-8"]) == 0
    assert main(["compare", *map(str, files), "--tolerance", "1e-10"]) == 1


def test_a_value_that_becomes_nan_is_found(files):
    """NaN in place of a number is beyond every tolerance."""
    changed(files[1], "cases/three/peak_stress", scaled((0, 0, 0), np.nan))
    assert main(["compare", *map(str, files), "--tolerance", "1"]) == 1


def test_flags_are_compared_by_their_words(files):
    """Another regime is a difference; the model name `kalker_table` stands for `kalker`."""
    before = load(files[0])
    assert before["cases/three/regime"].tolist() == ["rolling", "rolling", "full_slip"]
    other = before | {"cases/three/regime": np.array(["rolling", "rolling", "failed"])}
    assert not compare(before, other, 1.0)[0].passed
    used = "cases/three/contact_model_used"
    exact, table = before | {used: np.array(["kalker"] * 3)}, before | {used: np.array(["kalker_table"] * 3)}
    assert compare(exact, table)[0].passed
    assert not compare(before, exact)[0].passed


def test_missing_results_and_units_are_problems_and_sentences_are_not(files):
    """A lost variable and a changed unit fail; a rewritten long name is a remark."""
    before = load(files[0])
    lost = {key: value for key, value in before.items() if key != "cases/three/life_hours"}
    assert not compare(before, lost)[0].passed
    assert compare(lost, before)[0].passed
    key = "cases/three/labels.json"
    for attribute, passes in (("long_name", True), ("units", False)):
        labels = json.loads(str(before[key]))
        labels["variables"]["normal_force"][attribute] = "changed"
        verdict = compare(before, before | {key: np.array(json.dumps(labels))})[0]
        assert verdict.passed is passes and len(verdict.remarks) == passes


def test_a_changed_default_is_found():
    """A public parameter with another default fails; a new parameter passes."""
    names = python_names()
    key = "signatures/python.json"

    def recorded(changes):
        told = names | {"solve": names["solve"] | changes}
        return {key: np.array(json.dumps(told))}

    assert compare(recorded({}), recorded({"new": "keyword-only, default None"}))[3].passed
    assert not compare(recorded({}), recorded({"normal": "keyword-only, default 'halfspace'"}))[3].passed
    assert not compare(recorded({"old": "keyword-only, default None"}), recorded({}))[3].passed


def test_the_recorded_cases_cover_what_can_be_chosen():
    """At least 400 cases over all contact models, normal problems, slip terms, output groups and friction laws."""
    found = groups()
    cases = [case for group in found for case in group.cases]
    assert len(cases) >= 400
    assert len({group.name for group in found}) == len(found)

    def chosen(option, default):
        return {json.dumps(group.options.get(option, default)) for group in found}

    assert {json.loads(text) for text in chosen("contact_model", "sliding")} == set(CONTACT_MODELS)
    assert {json.loads(text) for text in chosen("normal", "hertz")} == {"hertz", "halfspace"}
    assert {json.loads(text) for text in chosen("life_rule", "elementary")} == {"elementary", "haibach", "unlimited"}
    assert len(chosen("slip_terms", [])) == 4 and len(chosen("spin_model", "skewed")) == 3
    kinds = {case["friction_law"]["kind"] for case in cases if "friction_law" in case}
    assert kinds == {"constant", "linear", "exponential", "table"}


def test_every_design_is_recorded(tmp_path):
    """Every design of a study file is drawn, solved and analysed once."""
    solved = {study["design"] for study in small_studies(tmp_path)}
    assert len(solved) == 10
    drawn = [study["name"] for study in drawn_designs(tmp_path)]
    assert len(set(drawn)) == len(drawn) > 50


def test_wrong_input_is_refused(files, capsys):
    """A file that does not exist and a negative tolerance end with exit 2 and say what to do."""
    for arguments in (["compare", "nowhere.npz", str(files[1])], ["compare", *map(str, files), "--tolerance", "-1"]):
        with pytest.raises(SystemExit) as refused:
            main(arguments)
        assert refused.value.code == 2
    assert "nowhere.npz does not exist" in capsys.readouterr().err


def test_version_and_date_of_a_result_are_no_difference():
    """Two runs of one version have other dates; another attribute that changes is a problem."""
    told = {"date_created": "today", "git_commit": "a", "solver_digest": "b", "hertz": "exact"}
    before = {"studies/lhs/labels.json": text({"variables": {}, "global": told})}
    later = {**told, "date_created": "tomorrow", "git_commit": "c", "solver_digest": "d"}
    after = {"studies/lhs/labels.json": text({"variables": {}, "global": later})}
    assert all(verdict.passed for verdict in compare(before, after))
    other = {"studies/lhs/labels.json": text({"variables": {}, "global": {**later, "hertz": "published"}})}
    assert not compare(before, other)[0].passed
