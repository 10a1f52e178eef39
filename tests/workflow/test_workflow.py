"""The workflow as users start it: runs what is missing and nothing else, and survives being killed."""

from __future__ import annotations

import functools
import json
import os
import re
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import pytest
import xarray as xr
from workflow_place import ROOT, command, copy_program, environment, lay_study, snakemake, snakemake_process, started

from trackroller.cli.workflow import workflow_config, workflow_ledger
from trackroller.errors import InputError
from trackroller.study.store.crate import damaged_files, read_crate
from trackroller.study.store.folder import StudyFolder


@pytest.fixture
def place(tmp_path):
    """Return a folder with a study, outside the folder of the workflow."""
    return lay_study(tmp_path)


def replace_in(path: Path, old: str, new: str) -> None:
    """Replace the first occurrence of a text in a file."""
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def kill_when_solved(folder: Path, chunks: int, snakefile: Path) -> dict[str, int]:
    """Start the workflow, kill it when some chunks are solved, and return the inodes of the solved chunks."""
    process = subprocess.Popen(
        command(snakefile=snakefile),
        cwd=folder,
        env=environment(snakefile),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    place = folder / "results" / "tiny" / "chunks"
    while len(list(place.glob("*.nc"))) < chunks and process.poll() is None:
        time.sleep(0.05)
    assert process.poll() is None, "the run ended before it could be killed"
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    return {path.name: path.stat().st_ino for path in place.glob("*.nc")}


def captions_in_the_archive(path: Path, out: Path) -> None:
    """Check that the archive of `--report` holds all figures and their captions, and the report."""
    with zipfile.ZipFile(path) as archive:
        held = {Path(name).name for name in archive.namelist()}
        page = archive.read(f"{path.stem}/report.html").decode()
        told = " ".join(
            archive.read(name).decode(errors="replace") for name in archive.namelist() if name.endswith(".js")
        )
    assert {p.name for p in (out / "figures").glob("*.svg")} < held and "can be sent by mail" in page + told
    captions = [item["caption"] for item in json.loads((out / "figures" / "index.json").read_text(encoding="utf-8"))]
    assert captions and all(text.split(".")[0][:40] in page + told for text in captions)


@pytest.mark.long
def test_killed_study_goes_on_to_its_report_and_after_a_change_runs_only_what_depends_on_it(place, tmp_path_factory):
    program = tmp_path_factory.mktemp("program")
    snakefile = copy_program(program)
    run = functools.partial(snakemake, place, snakefile=snakefile)
    lay_study(place, levels=6)
    out = place / "results" / "tiny"
    before = kill_when_solved(place, 2, snakefile)
    assert 2 <= len(before) <= 3, "12 cases, 4 in a chunk"
    told = snakemake_process(place, "--quiet", "progress", "host", snakefile=snakefile)
    assert not any(word in told for word in ("unlock", "Select jobs", "Execute", "rule solve"))
    assert "12 of 12 cases solved (100 %)" in told
    assert "Report: results/tiny/report.html, made in" in told
    assert all((out / "chunks" / name).stat().st_ino == inode for name, inode in before.items())
    run("--report", "everything.zip")
    captions_in_the_archive(place / "everything.zip", out)
    assert {"design.nc", "study.nc", "sensitivity.nc", "report.html"} <= set(read_crate(out))
    assert damaged_files(out) == {}
    assert list((out / "figures").glob("*.svg")) and list((out / "figures").glob("*.png"))
    time.sleep(1.1)
    replace_in(program / "trackroller" / "report" / "pages" / "study.py", '"""', '"""Other words. ')
    again = started(run("-n"))
    assert not {"solve", "gather", "sensitivity"} & {*again} and "report" in again
    run()
    told = run("--quiet", "progress", "host")
    assert "Nothing to be done. Report: results/tiny/report.html" in told and "Building" not in told
    replace_in(place / "tiny.yaml", "a small study", "other words")
    again = started(run("-n"))
    assert "solve" not in again and "gather" in again and "report" in again
    lay_study(place, levels=11)  # the six old levels, and five new ones between them
    assert started(run("results/tiny/study.nc")).count("solve") == 3, "10 new cases, 4 in a chunk"
    with xr.open_dataset(out / "study.nc") as ds:
        assert ds.sizes["axial_force"] == 11 and int((ds["regime"] < 3).sum()) == int(ds["converged"].sum()) == 22
    replace_in(program / "trackroller" / "roller" / "geometry.py", "1.0 / np.asarray(", "1.001 / np.asarray(")
    assert started(run("-n", "results/tiny/study.nc")).count("solve") == 6, "all 22 cases, 4 in a chunk"


def test_wrong_configuration_is_told_without_a_traceback(place):
    told = snakemake(place, "-n", "--config", "stduy=x.yaml", code=1)
    assert "study" in told and "Traceback" not in told


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"stduy": "x.yaml"}, "study"),
        ({"study": "nowhere.yaml"}, "nowhere.yaml"),
        ({"study": [1]}, "study"),
        ({"results": 3}, "results"),
        ({"results": "out{x}"}, "results = .out.x..* without braces"),
        ({"study": "a{b}/tiny.yaml"}, "study = .* without braces"),
    ],
)
def test_wrong_configuration_names_its_key(place, monkeypatch, wrong, named):
    monkeypatch.chdir(place)
    with pytest.raises(InputError, match=named):
        workflow_ledger(workflow_config({"study": "tiny.yaml"} | wrong, ROOT), main=True)


@pytest.mark.slow
@pytest.mark.parametrize(("error", "lines"), [("WorkError('the disk is full')", 1), ("KeyError('a mistake')", 3)])
def test_a_script_tells_an_error_of_the_work_in_one_line(tmp_path, error, lines):
    # on standard input: a traceback has two lines a frame there in every version of Python
    code = (
        "import sys\nfrom trackroller.cli.workflow import WorkError, log_to\nprint(*sys.modules)\nlog_to('rule.log')\n"
    )
    done = subprocess.run(
        [sys.executable], input=f"{code}raise {error}\n", cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 1 and len(done.stderr.splitlines()) == lines, done.stderr
    assert not {"numba", "scipy.stats", "SALib", "dask"} & set(done.stdout.split()), "each job would load them"


@pytest.mark.slow
def test_an_empty_folder_gets_the_default_study(tmp_path):
    told = snakemake(tmp_path, "-n")
    assert {"design", "solve", "gather", "sensitivity", "report"} == set(started(told)) - {
        "all",
        "study",
    }
    assert (tmp_path / "results" / "default" / "plan.json").is_file()
    assert "loads" in snakemake(tmp_path, "-n", "--config", "study=config/studies/loads.yaml", quiet=())


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("notes.txt", "and holds notes.txt"),
        ("figures/mine.png", "figures/mine.png"),
        ("report.html", "report.html"),
        ("logs/gather.log", "logs/gather.log"),
        ("inputs -> outside", "is a link"),
    ],
)
def test_files_of_somebody_else_stop_the_workflow_before_it_deletes_them(place, name, said):
    root, outside = place / "results" / "tiny", place / "outside"
    outside.mkdir()
    (outside / "study.yaml").write_text("somebody's")
    if name != "notes.txt":
        StudyFolder(root).create()
    path = root / name.partition(" -> ")[0]
    path.parent.mkdir(parents=True, exist_ok=True)
    if " -> " in name:
        path.symlink_to(outside)
    else:
        path.write_text("somebody's")
    told = snakemake(place, code=1)
    assert said in told and "Traceback" not in told, told
    assert (outside if path.is_symlink() else path.parent).is_dir()
    assert (outside / "study.yaml").read_text() == "somebody's"
    assert path.is_symlink() or path.read_text() == "somebody's"


FOREIGN = """
configfile: "config/config.yaml"

module roller:
    snakefile: "{root}/{snakefile}"
    {config}

use rule * from roller as roller_*

rule mine:
    default_target: True
    input: "results/tiny/study.nc"
    output: "mine.txt"
    shell: "echo {{config[samples]}} > {{output}}"
"""


@pytest.mark.long
@pytest.mark.parametrize(
    ("snakefile", "config", "own", "words"),
    [
        ("Snakefile", "", "samples: 3\n", ["--config", "study=tiny.yaml"]),
        pytest.param(
            *("workflow/Snakefile", 'config: config["roller"]', "samples: 3\nroller: {study: tiny.yaml}\n", []),
            marks=pytest.mark.slow,
        ),
    ],
)
def test_another_workflow_imports_this_one(place, snakefile, config, own, words):
    lay_study(place, size=12)
    (place / "config" / "config.yaml").write_text(own)
    (place / "Snakefile").write_text(FOREIGN.format(root=ROOT, snakefile=snakefile, config=config))
    told = started(snakemake(place, *words, snakefile=place / "Snakefile"))
    assert told == ["mine", "roller_design", "roller_gather", "roller_solve"]
    assert (place / "mine.txt").read_text() == "3\n"
    with xr.open_dataset(place / "results" / "tiny" / "study.nc") as ds:
        assert int(ds["converged"].sum()) == 12


def test_a_wrong_key_for_an_imported_workflow_is_refused(place):
    (place / "config" / "config.yaml").write_text("samples: 3\nroller: {stduy: tiny.yaml}\n")
    (place / "Snakefile").write_text(
        FOREIGN.format(root=ROOT, snakefile="Snakefile", config='config: config["roller"]')
    )
    assert "stduy" in snakemake(place, "-n", code=1, snakefile=place / "Snakefile")


@pytest.mark.parametrize("target", [(), ("contact_models",)])
def test_the_comparison_of_contact_models_is_a_study_like_any_other(place, target):
    if target:
        told = snakemake(place, "-n", *target, snakefile=ROOT / "validation" / "Snakefile")
        assert started(told) == ["contact_models"]
    else:
        study = ROOT / "validation" / "config" / "contact_models.yaml"
        assert {"sensitivity", "report"} <= set(started(snakemake(place, "-n", "--config", f"study={study}")))


def test_a_users_run_holds_no_rule_of_the_validation(place):
    rules = set(snakemake(place, "--list-rules").split())
    assert not rules & {"extremes", "tradeoff", "paper", "contact_models", "benchmark"}
    assert {"design", "solve", "gather", "sensitivity", "report"} <= rules


def test_gathering_and_the_report_ask_a_cluster_for_the_memory_that_the_study_takes(tmp_path):
    """4,000 cases of forces, 520 bytes each, 2.5 times: 5 MB above the program. Chunks take what the profile gives."""
    lay_study(tmp_path, levels=2000, size=2000)
    told = snakemake(tmp_path, "-n")
    asked = {
        rule: re.findall(r"mem_mb=(\d+)", text)
        for rule, text in re.findall(r"rule (\w+):(.*?resources:[^\n]*)", told, re.S)
    }
    assert asked["gather"] == asked["sensitivity"] == asked["report"] == ["1005"] and asked["solve"] == []
