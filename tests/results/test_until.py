"""A sample grows by doublings until its intervals are narrow, and goes on where it was stopped."""

import itertools
import json
import os
import re
import signal

import fake_solver
import numpy as np
import pytest
import xarray as xr
from scipy import stats
from workflow_place import snakemake, started

import trackroller as tr
from trackroller.errors import InputError
from trackroller.methods.b10 import log_b10, share
from trackroller.methods.given_data import first_indices
from trackroller.methods.replicates import jackknife
from trackroller.results.interim_looks import looks_of
from trackroller.results.sample_growth import grow_study
from trackroller.results.solved_cases import OUTSIDE
from trackroller.study.design.growth import doubled
from trackroller.study.design.sampling import sample
from trackroller.study.file.load import load_study
from trackroller.study.status import status_of
from trackroller.study.store.ledger import study_folder

STUDY = {
    "name": "sure",
    "factors": {
        "axial_force": {"uniform": [20, 50]},
        "friction_coefficient": {"uniform": [0.1, 0.3]},
        "motor_force": {"values": [0, -5, -10]},
    },
    "method": "sobol",
    "outputs": ["forces"],
    "contact_model": "sliding",
    "until": {"half_width": 0.05, "of": ["normal_force_1"], "at_most": 4096},
}
NORMAL = {
    "axial_force": {"normal": [30, 3]},
    "friction_coefficient": {"normal": [0.2, 0.01]},
    "motor_force": {"values": [0, -9]},
}
UNEQUAL = {  # friction 1.5 lifts the force above 0 for sure, friction 0.2 in half of the cases
    **STUDY,
    "factors": {
        "friction_coefficient": {"values": [0.2, 1.5]},
        "motor_force": {"values": [0, -9]},
        "axial_force": {"normal": [30, 3]},
    },
    "method": "inner_outer",
    "analysis": {"target": {"normal_force_1": {"min": 0.0}}},
    "until": {"half_width": 0.02, "of": ["probability(normal_force_1)"]},
}
DESIGNS = ["sobol", "saltelli", "morris", "inner_outer"]


def study_of(design="sobol", **until):
    data = {**STUDY, "method": design, "until": {**STUDY["until"], **until}}
    if design == "inner_outer":
        data |= {"factors": NORMAL, "until": {**data["until"], "of": ["probability(normal_force_1)"]}}
        data["analysis"] = {"target": {"normal_force_1": {"min": 0.0}}}
    return load_study(data)


def grow(study, place, **how):
    return tr.open_study(grow_study(study, place, **({"solver": fake_solver.solve} | how)).folder.root)


def killed(study, place, monkeypatch, after):
    """Kill a run of a study after each of these numbers of solved cases."""
    for kill in after:
        monkeypatch.setenv("FAKE_KILL", str(int(kill)))
        child = os.fork()
        if child == 0:
            grow(study, place)
            os._exit(0)
        assert os.WTERMSIG(os.waitpid(child, 0)[1]) == signal.SIGKILL
    monkeypatch.delenv("FAKE_KILL")


@pytest.mark.parametrize("design", DESIGNS)
def test_a_doubled_sample_begins_with_the_smaller_one_and_has_independent_replicates(design):
    study = study_of(design)
    small, large = study.drawn, doubled(doubled(study)).drawn
    points = small.meta.get("design_points", 1)
    for name, values in small.columns.items():
        wanted = large.columns[name].reshape(points, -1)[:, : small.size // points]
        assert np.array_equal(values.reshape(points, -1), wanted)
    assert large.size == 4 * small.size and large.meta["replicates"] == 16
    rows = {"saltelli": large.size // large.meta.get("base_samples", 1), "morris": 4}.get(design, 1)
    own = large.unit[: large.size // points].reshape(-1, 16, rows, 3)[:, :, 0, 0]
    assert len(np.unique(own[0])) == (16 if design != "morris" else len(np.unique(own[0])))
    if design not in ("morris", "saltelli"):  # one row in each stratum of every replicate
        assert all(np.array_equal(np.sort((one * len(own)).astype(int)), np.arange(len(own))) for one in own.T)


@pytest.mark.long
def test_only_the_design_points_with_wide_intervals_grow(tmp_path, monkeypatch):
    study = load_study(UNEQUAL)
    whole = grow(study, tmp_path / "whole")
    design, found = whole.design, looks_of(whole)
    sizes = [rows.stop - rows.start for rows in design.points]
    assert sizes[:2] == [sizes[0]] * 2 and sizes[2:] == [256, 256] and sizes[0] == 512
    assert found["looks"][-1]["unsure"] == [] and found["looks"][1]["unsure"] == [0, 1]
    assert [look["cases"] for look in found["looks"][:3]] == [512, 1024, 1536]
    inner = [design.columns["axial_force"][rows] for rows in design.points]
    assert all(np.array_equal(inner[0][: len(own)], own) for own in inner)
    part = whole.indices().sel(target="normal_force_1")
    hits = whole.data["normal_force"].sel(contact=1).values >= 0
    shares = [hits[rows].mean() for rows in design.points]
    assert part["target_probability"].values == pytest.approx(shares) and part["point_samples"].values.tolist() == sizes
    level = (part["level_factor"] == "motor_force") & (part["level_low"] == 0.0)
    points = [0, 2]  # motor force 0 at both frictions
    for end in ("", "_low", "_high"):
        wanted = part[f"target_probability{end}"].values[points].mean()
        assert float(part[f"level_probability{end}"][level].item()) == pytest.approx(wanted)
    told = [one.where for one in whole.answer.warnings if one.code == "unlike"]
    assert told == [f"sample sizes: {', '.join(map(str, sorted(set(sizes))))} conditions"]
    monkeypatch.setenv("FAKE_SOLVED", str(tmp_path / "solved.txt"))
    killed(study, tmp_path / "parts", monkeypatch, (600, 1300))
    parts = grow(study, tmp_path / "parts")
    assert parts.data.drop_attrs().identical(whole.data.drop_attrs()) and looks_of(parts) == found
    assert status_of(study, study_folder(study.name, tmp_path / "parts")).total == design.size == sum(sizes)


@pytest.mark.slow
def test_a_sample_grows_only_until_its_shares_are_clear_of_the_wanted_one(tmp_path):
    """One half and all of the conditions are told from 90 % by few cases; both need thousands for ± 0.02."""
    keys = {key: value for key, value in UNEQUAL.items() if key != "analysis"}
    wanted = {"normal_force_1": {"min": 0.0, "probability": 0.9}}

    results = grow(load_study({**keys, "requirement": wanted}), tmp_path)
    found = looks_of(results)
    assert found["stopped"] == "every share is clear of the share that the requirement wants"
    shares = [(results.column("normal_force_1")[rows] >= 0).mean() for rows in results.design.points]
    for rows, value in zip(results.design.points, shares, strict=True):
        count = rows.stop - rows.start
        ends = stats.binomtest(round(value * count), count).proportion_ci(0.95)
        assert not ends.low <= 0.9 <= ends.high
    free = grow(load_study({**UNEQUAL, "name": "free"}), tmp_path)
    assert results.design.size < 0.5 * free.design.size


def test_a_sample_without_a_valid_case_does_not_grow(tmp_path):
    def outside(cases, **how):
        ds = fake_solver.solve(cases, **how)
        return ds.assign(converged=0 * ds["converged"])

    def flagged(cases, **how):
        valid = fake_solver.solve(cases, **how)
        return valid.assign(validity=valid["converged"].astype("u4").assign_attrs(flag_meanings=OUTSIDE[0]))

    for study, solver in itertools.product((study_of(), load_study(UNEQUAL)), (outside, flagged)):
        found = looks_of(grow(study, tmp_path / solver.__name__ / study.config.method_name, solver=solver))
        assert len(found["looks"]) == 1 and found["stopped"].endswith("to decide")
        assert set(found["looks"][0]["half_width"].values()) == {None}


@pytest.mark.slow
def test_every_solved_case_is_used_again(tmp_path, monkeypatch):
    solved = tmp_path / "solved.txt"
    monkeypatch.setenv("FAKE_SOLVED", str(solved))
    data = grow(study_of(half_width=0.03), tmp_path).data
    assert len(solved.read_text().splitlines()) == data.sizes["case"] > 128


@pytest.mark.slow
def test_the_number_of_cases_ends_the_growth(tmp_path):
    found = looks_of(grow(study_of(half_width=1e-6, at_most=300), tmp_path))
    assert re.findall(r"\d+", found["stopped"]) == ["512", "300"]
    more = looks_of(grow(study_of(half_width=1e-6, at_most=600), tmp_path))
    assert more["looks"][:2] == found["looks"] and len(more["looks"]) == 3


def test_hours_add_up_over_runs_and_end_the_growth(tmp_path):
    tight, told = study_of(half_width=1e-6, hours=1e-9), []
    first = looks_of(grow(tight, tmp_path))
    assert len(first["looks"]) == 1 and "1e-09 h" in first["stopped"]
    again = looks_of(grow(tight, tmp_path, tell=told.append))
    assert again["looks"] == first["looks"] and not any("solved in" in line for line in told)


def test_an_output_that_does_not_vary_ends_the_growth(tmp_path):
    def still(cases, **how):
        ds = fake_solver.solve(cases, **how)
        return ds.assign(normal_force=ds["normal_force"].copy(data=np.ones_like(ds["normal_force"])))

    found = looks_of(grow(study_of(), tmp_path, solver=still))
    assert found["stopped"].startswith("normal_force_1 does not vary") and len(found["looks"]) == 1


# inner_outer: in the test of unequal design points
@pytest.mark.long
@pytest.mark.parametrize(("design", "first"), [("sobol", 128), ("saltelli", 1024)])
def test_a_killed_run_goes_on_to_the_same_bits(design, first, tmp_path, monkeypatch):
    study = study_of(design, half_width=1e-6, at_most=4 * first)
    whole = grow(study, tmp_path / "whole")
    monkeypatch.setenv("FAKE_SOLVED", str(tmp_path / "solved.txt"))
    killed(study, tmp_path / "parts", monkeypatch, (0.8 * first, 2.4 * first))
    parts = grow(study, tmp_path / "parts")
    assert parts.data.drop_attrs().identical(whole.data.drop_attrs()) and looks_of(parts) == looks_of(whole)
    assert status_of(study, study_folder(study.name, tmp_path / "parts")).total == whole.data.sizes["case"]


@pytest.mark.long
def test_a_study_in_memory_grows_too_and_its_report_shows_each_look(tmp_path):
    solved = tr.run({**STUDY, "until": {**STUDY["until"], "half_width": 0.04}}, progress=False)
    page = solved.report(tmp_path / "report.html").read_text(encoding="utf-8")
    looks = looks_of(solved)["looks"]
    assert len(looks) > 1 and all(str(look["cases"]) in page for look in looks)
    assert "looks [" not in page  # the record does not print the looks as code


@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ({"until": [1]}, "until = .*half_width, of, at_most"),
        ({"until": {"half_width": 0.03}}, "until.of.*every study needs|until.of"),
        ({"until": {"half_width": 0, "of": ["normal_force_1"]}}, "until.half_width = 0"),
        ({"until": {"half_width": 0.1, "of": 3}}, "until.of = 3 .*a list of at least one output"),
        ({"until": {"half_width": 0.1, "of": []}}, "a list of at least one output"),
        ({"until": {"halfwidth": 0.1, "of": ["normal_force_1"]}}, "until = 'halfwidth'.*half_width"),
        ({"until": {"half_width": 0.1, "of": ["normal_forse_1"]}}, "normal_force_1"),
        ({"until": {"half_width": 0.1, "of": ["pair_life_hours"]}}, "group life is not among"),
        ({"until": {"half_width": 0.1, "of": ["normal_force_1"], "replicates": 4}}, "until.replicates = 4"),
        ({"until": {"half_width": 0.1, "of": ["normal_force_1"], "hours": -1}}, "until.hours = -1"),
        ({"until": {"half_width": 0.1, "of": ["normal_force_1"], "at_most": 100}}, "at least the 128 cases"),
        ({"method": "lhs"}, "method = 'lhs'.*sobol.*Write method: sobol, or remove until"),
        ({**UNEQUAL, "inner": "lhs"}, "inner = 'lhs'.*Write inner: sobol, or remove until"),
        ({"until": {"half_width": 0.1, "of": ["b10(normal_force_1)"]}}, "with method sobol: results"),
        ({**UNEQUAL, "until": {"half_width": 0.1, "of": ["median(normal_force_1)"]}}, "b10 or probability of one"),
        ({"samples": 100}, "samples = 100 .*16 replicates times a power of two.*Write samples: 128"),
        ({"method": "grid", "factors": {"axial_force": {"values": [1, 2]}}}, "method = 'grid'.*remove until"),
        ({"method": "inner_outer", "factors": NORMAL}, "a life, whose log10 B10 counts"),
    ],
)
def test_wrong_input_is_one_clear_sentence(keys, named):
    with pytest.raises(InputError, match=named):
        load_study({**STUDY, **keys})


def test_the_jackknife_of_a_mean_is_student_s_interval_and_events_that_never_occur_keep_one():
    values = np.random.default_rng(1).random(16)
    left = (values.sum() - values) / 15
    assert jackknife(left) == pytest.approx(1.15 * 2.1314 * values.std(ddof=1) / 4, rel=1e-4)
    member = np.arange(64) % 16
    assert share(np.zeros(64), member, 16) == (0.0, pytest.approx(1 - 0.025 ** (1 / 64)))
    once = share(np.arange(256) == 9.0, np.arange(256) % 16, 16)  # one event: the bound of Clopper and Pearson
    assert once == (1 / 256, pytest.approx(stats.beta.ppf(0.975, 2, 255) - 1 / 256))
    assert log_b10(np.full(64, np.inf), np.zeros(64), member, 16) == (np.inf, 0.0)
    assert log_b10(np.full(64, np.nan), np.zeros(64), member, 16)[1] == np.inf


def test_first_order_indices_of_replicates_are_free_of_bias():
    found = []
    for seed in range(60):
        factors = {"x": {"uniform": [0, 1]}, "y": {"uniform": [0, 1]}, "kind": {"values": ["a", "b"]}}
        design = sample(factors, "sobol", 256, seed, replicates=16)
        x, y, kind = design.places.T
        found.append(first_indices(x + 2 * y * kind, design.places, design.ordered, np.arange(256) % 16, 16)[0])
    parts = np.array([1 / 12, 1 / 12, 1 / 4])  # 2 y kind: y and kind have means 1/2
    truth = parts / (parts.sum() + 1 / 12)
    error = np.std(found, axis=0) / 60**0.5
    assert (np.abs(np.mean(found, axis=0) - truth) < 4 * error + 0.002).all()


@pytest.mark.long
def test_the_workflow_grows_by_checkpoints_and_then_has_nothing_to_do(tmp_path):
    study = {**STUDY, "until": {"half_width": 0.04, "of": ["normal_force_1"]}}
    (tmp_path / "config").mkdir()
    (tmp_path / "study.yaml").write_text(json.dumps(study))
    (tmp_path / "config" / "config.yaml").write_text("study: study.yaml\n")
    snakemake(tmp_path, "results/sure/study.nc")
    out = tmp_path / "results" / "sure"
    with xr.open_dataset(out / "study.nc") as ds:
        found = json.loads(ds.attrs["until"])
        same = tr.run(study, progress=False).data
        assert ds["normal_force"].values.tobytes() == same["normal_force"].values.tobytes()
    assert len(list((out / "looks").glob("*.json"))) == len(found["looks"]) + 1 > 2
    assert started(snakemake(tmp_path, "results/sure/study.nc")) == []
