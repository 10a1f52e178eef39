"""A study that is not solved to its end: report, explorer and figures show the solved cases and say so."""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import numpy as np
import pytest
from test_edits import command, draw_one

import trackroller as tr
from trackroller.roller.solver import solve
from trackroller.study.file.load import load_study, parse_study
from trackroller.study.progress import progress_bar
from trackroller.study.run import run_study
from trackroller.study.store.fingerprint import StudyCases
from trackroller.study.store.manifest import digests_of

NUMBERS = {"axial_force": {"uniform": [20, 50]}, "friction_coefficient": {"uniform": [0.1, 0.3]}}
LISTS = {"axial_force": {"values": [20, 30, 40]}, "friction_coefficient": {"values": [0.1, 0.2, 0.3, 0.4]}}
PAIRS = {"material_pair": {"values": [["PA6", "POM"], ["POM", "PA6"]]}}
DESIGNS = {
    "grid": ({}, PAIRS | LISTS),
    "lhs": ({"samples": 24}, NUMBERS | PAIRS),
    "sobol": ({"samples": 32}, NUMBERS),
    "saltelli": ({"samples": 4}, NUMBERS),
    "morris": ({"samples": 6}, NUMBERS),
    "inner_outer": (
        {"samples": 8, "pareto": {"mean(friction_power)": "min", "b10(roller_life_hours)": "max"}},
        {"axial_force": {"values": [20, 30, 40]}, "friction_coefficient": {"normal": [0.2, 0.01]}} | PAIRS,
    ),
    "box_behnken": ({}, NUMBERS | {"motor_force": {"uniform": [-30, -10]}}),
}


class Stopped(BaseException):
    """Ends a run as Ctrl-C does."""


def stopped_study(design, chunks=2):
    """Solve some chunks of a study in the working folder; return the study and the cases that are solved."""
    more, factors = DESIGNS[design]
    basis = {"name": "stopped", "method": design, "chunk_size": 5, "contact_model": "sliding", "accuracy": "preview"}
    study = parse_study(basis | {"outputs": ["forces", "friction_work", "life"], "factors": factors} | more)
    done = []

    def solver(cases, **options):
        if len(done) == chunks:
            raise Stopped
        done.append(cases)
        return solve(cases, **options)

    with pytest.raises(Stopped):
        run_study(study, solver=solver)
    return study, sum(cases.sizes["case"] for cases in done)


@pytest.mark.slow
@pytest.mark.parametrize("design", DESIGNS)
def test_solved_cases_are_those_of_the_whole_design(tmp_path, monkeypatch, design):
    monkeypatch.chdir(tmp_path)
    study, count = stopped_study(design)
    with pytest.warns(UserWarning, match=rf"Unfinished study: \d+ of {study.drawn.size} cases are solved"):
        solved = tr.open_study("results/stopped")
    numbers, whole = solved.data["case"].values, study.design()
    repeated = study.drawn.size - len(np.unique(StudyCases(study).fingerprints))  # trajectories and blocks share cases
    assert solved.unfinished and count <= len(numbers) <= count + repeated and len(numbers) == solved.design.size
    for name in study.factors:
        if name in solved.data.variables and name in whole.variables:
            np.testing.assert_array_equal(solved.data[name].values, whole[name].values[numbers])
    assert len(solved.to_table()) == len(numbers)
    indices = solved.indices()
    assert indices.attrs["method"] == (design if design in ("lhs", "sobol") else "table")


@pytest.mark.long
@pytest.mark.parametrize("design", ["grid", pytest.param("inner_outer", marks=pytest.mark.slow)])
def test_commands_show_the_solved_cases_and_seal_nothing(tmp_path, monkeypatch, design):
    monkeypatch.chdir(tmp_path)
    study, count = stopped_study(design)
    root, said = Path("results/stopped"), f"Unfinished study: {count} of {study.drawn.size} cases are solved"
    for words, made in (
        (("report", "stopped"), "report.html"),
        (("explore", "results/stopped"), "explorer.html"),
        (("plot", "stopped"), "figures/index.json"),
        (("status", "stopped", "--figures"), "figures/index.json"),
    ):
        with pytest.MonkeyPatch.context() as quick, pytest.warns(UserWarning, match=said):
            if made == "report.html":
                quick.setattr("trackroller.report.figures.study.draw_all", draw_one)
            code, out, err = command(words)
        assert code == 0, err
        assert str(root / "unfinished") in out and (root / "unfinished" / made).is_file()
        assert made.endswith(".json") or said in (root / "unfinished" / made).read_text()
    for name in ("report.html", "figures", "sensitivity.nc", "ro-crate-metadata.json"):
        assert not (root / name).exists() and not digests_of(root / name)
    run_study(study)
    monkeypatch.setattr("trackroller.report.figures.study.draw_all", draw_one)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert command(("report", "stopped"))[0] == 0
    assert not (root / "unfinished").exists() and "Unfinished study" not in (root / "report.html").read_text()
    assert command(("verify", "results/stopped"))[0] == 0


@pytest.mark.slow
def test_a_study_without_a_solved_case_or_without_its_gathered_file_says_so(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study, _ = stopped_study("lhs", chunks=0)
    code, _, err = command(("report", "stopped"))
    assert code == 2 and "has no solved case yet" in err
    run_study(study).folder.gathered.unlink()
    code, _, err = command(("report", "stopped"))
    assert code == 2 and "not gathered into study.nc" in err


def test_a_study_that_grows_is_unfinished_until_it_is_gathered_again(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    base = {"name": "stopped", "contact_model": "sliding", "accuracy": "preview", "outputs": ["forces"]}
    run_study(parse_study(base | {"factors": LISTS}))
    grown = parse_study(base | {"factors": LISTS | {"axial_force": {"values": [20, 30, 40, 50]}}})

    def solver(cases, **options):
        raise Stopped

    with pytest.raises(Stopped):
        run_study(grown, solver=solver)
    code, said, _ = command(("status", "stopped"))
    assert code == 0 and "next      chunk 1 of 2, axial_force 50, friction_coefficient 0.1 to 0.2" in said
    with pytest.warns(UserWarning, match="12 of 16 cases are solved"):
        assert tr.open_study("results/stopped").data.sizes["case"] == 12
    assert tr.open_study("results/stopped/study.nc").data["regime"].size == 12


def test_chunks_name_their_levels(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lines = []
    study = {"name": "named", "contact_model": "sliding", "accuracy": "preview", "outputs": ["forces"], "chunk_size": 6}
    run_study(parse_study(study | {"factors": PAIRS | LISTS}), tell=lines.append)
    told = [line.split(": ")[0] for line in lines if line.startswith("chunk")]
    assert told[0] == "chunk 1 of 4, material_pair PA6 / POM, axial_force 20 to 30"
    assert told[3] == "chunk 4 of 4, material_pair POM / PA6, axial_force 30 to 40"


@pytest.mark.slow
@pytest.mark.parametrize(("design", "said"), [("lhs", "lhs design with another factor is drawn anew"), ("grid", None)])
def test_plan_and_run_say_before_solving_what_a_new_factor_costs(tmp_path, monkeypatch, design, said):
    monkeypatch.chdir(tmp_path)
    base = {"name": "grown", "contact_model": "sliding", "accuracy": "preview", "outputs": ["forces"], "method": design}
    more, factors = {"samples": 6} if design == "lhs" else {}, NUMBERS if design == "lhs" else LISTS
    run_study(parse_study(base | more | {"factors": factors}))
    lines: list[str] = []
    new = {"motor_force": {"values": [-30, 0]}}
    Path("grown.yaml").write_text(json.dumps(base | more | {"factors": factors | new}))
    monkeypatch.setenv("COLUMNS", "80")
    code, out, err = command(("plan", "grown.yaml"))
    assert code == 0, err
    assert max(map(len, out.splitlines())) <= 80
    out = " ".join(out.split())
    if said is None:  # the old value is one of the levels
        assert "unused" not in out and "12 of them solved" in out
        return
    assert "0 of them solved" in out and said in out and "motor_force became a factor" in out
    run_study(load_study("grown.yaml"), tell=lines.append)
    assert said in lines[0], "before the first chunk"


def test_a_bar_counts_the_cases_beyond_the_budget_of_a_search_into_its_total():
    with progress_bar("search", shown=False) as bar:
        bar.started(64, 0)
        bar.advanced(60, 1)
        bar.advanced(6, 0)
        assert (bar.shown.tasks[0].completed, bar.shown.tasks[0].total, bar.failed) == (66, 66, 1)
