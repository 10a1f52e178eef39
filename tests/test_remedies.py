"""A remedy that a message names is tried: what the message says is done, and there is a result."""

from __future__ import annotations

import contextlib
import re
import shlex
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
import yaml
from command_line import trackroller, trackroller_process
from distributed import LocalCluster

import trackroller as tr
from trackroller.app import studies
from trackroller.errors import WorkError
from trackroller.report import html
from trackroller.roller.settings import checked_case
from trackroller.study import cluster
from trackroller.study.spectrum.file import Spectrum

QUICK = {"contact_model": "sliding", "accuracy": "preview"}
STEEL = "1.7225-normalised"
CIRCLE = [[x, (36 - x * x) ** 0.5 - 6] for x in np.linspace(-4.5, 4.5, 41).tolist()]
HOT = {"like": "POM", "temperature_dependence": {"temperature": [20, 100, 60], "youngs_modulus": [4000, 500, 2000]}}
COLD = {"like": "POM", "temperature_dependence": {"temperature": [20, 60, 100], "youngs_modulus": [4000, 2000, 500]}}
GROUPS = {"groups": {"a": ["axial_force"], "b": ["radial_force"]}}
GOALS = {"slip": "min", "max_pressure_1": "min"}
SLIP = {"half_width": 0.1, "of": ["slip"]}
FORCE = {"axial_force": {"values": [0, 10]}}
RANGE = {"axial_force": {"uniform": [0, 10]}, "radial_force": {"uniform": [-300, -200]}}
TABLE = "axial_force,radial_force\n0,-200\n10,-200\n"


def study(**keys: Any) -> xr.Dataset:
    """Return the cases of a study."""
    return tr.load_study({"name": "x", "factors": FORCE} | keys).design()


def case(**keys: Any) -> xr.Dataset:
    """Return the solution of a case file."""
    own, options, _ = checked_case(keys)
    return tr.solve(own, **QUICK | options)


def spectrum(**keys: Any) -> Spectrum:
    return Spectrum.from_dict({"name": "x"} | keys)


BLOCK = {"name": "a", "distance": 10}
# what is done, what is given, what the message says to do, and the entries after it was done
REMEDIES: dict[str, tuple[Any, dict[str, Any], str, dict[str, Any]]] = {
    "nearest spelling of a field": (case, {"axial_forse": 5}, "Did you mean 'axial_force'?", {"axial_force": 5}),
    "similar meaning": (case, {"thrust": 5}, "Names with a similar meaning: axial_force", {"axial_force": 5}),
    "nearest spelling of a word": (
        case,
        {"contact_model": "slidng"},
        "Did you mean 'sliding'?",
        {"contact_model": "sliding"},
    ),
    "nearest spelling of a material": (
        case,
        {"roller_material": "1.7225-normalized"},
        "1.7225-normalised",
        {"roller_material": STEEL},
    ),
    "the other sign": (case, {"radial_force": 200}, "Write -200.", {"radial_force": -200}),
    "inf for a straight one": (case, {"guide_curve_radius": "straight"}, "Write inf", {"guide_curve_radius": "inf"}),
    "a plain number": (case, {"axial_force": "1,5"}, "Write 1.5.", {"axial_force": 1.5}),
    "another unit": (case, {"axial_force": "5 mm"}, "such as '5 N'", {"axial_force": "5 N"}),
    "0 for a number that is too small": (case, {"axial_force": "1e-400"}, "Write 0", {"axial_force": 0}),
    "a smaller number for one that is too large": (
        case,
        {"guide_curve_radius": "1e400"},
        "Write a smaller number",
        {"guide_curve_radius": "1e6"},
    ),
    "add limits to outputs": (
        case,
        {"permissible_wear_depth": 0.1, "outputs": ["forces"]},
        "Add limits to outputs, or remove permissible_wear_depth.",
        {"permissible_wear_depth": 0.1, "outputs": ["forces", "limits"]},
    ),
    "remove a field": (
        case,
        {"permissible_wear_depth": 0.1, "outputs": ["forces"]},
        "or remove",
        {"outputs": ["forces"]},
    ),
    "add life to the outputs": (
        case,
        {"accuracy": {"life": 0.1}, "outputs": ["forces"]},
        "add peak_stress or life to outputs",
        {"accuracy": {"life": 0.1}, "outputs": ["forces", "life"]},
    ),
    "no axis distance beside both radii": (
        case,
        {"outer_radius": 20, "axis_distance": 22},
        "Remove outer_radius, or axis_distance.",
        {"axis_distance": 22},
    ),
    "another model of contact": (
        case,
        {"friction_law": {"kind": "exponential", "lowest": 0.5, "speed": 100}, "contact_model": "kalker_table"},
        "Take contact_model: kalker, or leave friction_law out.",
        {"friction_law": {"kind": "exponential", "lowest": 0.5, "speed": 100}, "contact_model": "kalker"},
    ),
    "halfspace for drawn profiles": (
        case,
        {"guide_profile": {"parabola": 6}, "normal": "hertz"},
        "Set normal to halfspace, or remove guide_profile.",
        {"guide_profile": {"parabola": 6}, "normal": "halfspace"},
    ),
    "smooth: auto": (
        case,
        {
            "guide_profile": {
                "points": CIRCLE,
                "smooth": "much",
            },
            "normal": "halfspace",
        },
        "'auto'",
        {
            "guide_profile": {
                "points": CIRCLE,
                "smooth": "auto",
            },
            "normal": "halfspace",
        },
    ),
    "the exponent of the S-N line": (
        case,
        {"roller_material": {"like": STEEL, "woehler_exponent": -0.1}},
        "write 10",
        {"roller_material": {"like": STEEL, "woehler_exponent": 10}},
    ),
    "sort the rows": (case, {"roller_material": HOT}, "Sort the rows.", {"roller_material": COLD}),
    "0.1 for 10 %": (case, {"failure_probability": 10}, "0.1", {"failure_probability": 0.1}),
    "a study for a probability": (
        study,
        {"requirement": {"pair_life_hours": {"min": 100, "probability": 95}}},
        "0.95",
        {"requirement": {"pair_life_hours": {"min": 100, "probability": 0.95}}},
    ),
    "several values as a factor": (
        study,
        {"base": {"motor_force": [0, 5]}},
        "Give several values under factors: {motor_force: {values: [0, 5]}}.",
        {"factors": {"motor_force": {"values": [0, 5]}}},
    ),
    "a key on a line of its own": (
        study,
        {"base": {"contact_model": "sliding"}},
        "Write contact_model: sliding on a line of its own",
        {"contact_model": "sliding"},
    ),
    "an example of a factor": (
        study,
        {"factors": {"friction_coefficient": {"unifrom": [0.1, 0.3]}}},
        "Did you mean 'uniform'?",
        {"factors": {"friction_coefficient": {"uniform": [0.1, 0.3]}}, "method": "lhs", "samples": 8},
    ),
    "first, last, number of values": (
        study,
        {"factors": {"axial_force": {"linspace": [0, 10]}}},
        "Write [first, last, number of values].",
        {"factors": {"axial_force": {"linspace": [0, 10, 3]}}},
    ),
    "a repeated value": (
        study,
        {"factors": {"axial_force": {"values": [0, 10, 10]}}},
        "Remove the repeated value.",
        {},
    ),
    "a sampled design": (
        study,
        {"factors": RANGE},
        "sampled design",
        {"factors": RANGE, "method": "lhs", "samples": 8},
    ),
    "saltelli for groups": (
        study,
        {
            "factors": RANGE,
            "method": "lhs",
            "samples": 8,
            "analysis": {"groups": {"a": ["axial_force"], "b": ["radial_force"]}},
        },
        "Take method: saltelli.",
        {
            "factors": RANGE,
            "method": "saltelli",
            "samples": 8,
            "analysis": {"groups": {"a": ["axial_force"], "b": ["radial_force"]}},
        },
    ),
    "a distribution for inner_outer": (
        study,
        {"factors": FORCE, "method": "inner_outer", "samples": 8},
        "such as {normal: [0.1, 0.02]}",
        {"factors": FORCE | {"friction_coefficient": {"normal": [0.1, 0.02]}}, "method": "inner_outer", "samples": 8},
    ),
    "weights want a drawn design": (
        study,
        {"factors": {"axial_force": {"values": [0, 10], "weights": [1, 2]}}},
        "Remove the weights, or choose method: lhs.",
        {"factors": {"axial_force": {"values": [0, 10], "weights": [1, 2]}}, "method": "lhs", "samples": 8},
    ),
    "a design that grows": (
        study,
        {"factors": RANGE, "method": "lhs", "samples": 16, "until": {"half_width": 0.1, "of": ["max_pressure_1"]}},
        "Write method: sobol, or remove until.",
        {"factors": RANGE, "method": "sobol", "samples": 16, "until": {"half_width": 0.1, "of": ["max_pressure_1"]}},
    ),
    "raise at_most": (
        study,
        {
            "factors": RANGE,
            "method": "sobol",
            "samples": 32,
            "until": SLIP | {"at_most": 8},
        },
        "Write at_most: 128",
        {
            "factors": RANGE,
            "method": "sobol",
            "samples": 32,
            "until": SLIP | {"at_most": 128},
        },
    ),
    "samples of the first look": (
        study,
        {"factors": RANGE, "method": "sobol", "samples": 100, "until": SLIP},
        "Write samples: 128",
        {"factors": RANGE, "method": "sobol", "samples": 128, "until": SLIP},
    ),
    "goals in a search": (
        study,
        {"factors": RANGE, "method": "optimise", "pareto": GOALS},
        "Rename the key to goals.",
        {
            "factors": {"axial_force": {"uniform": [0, 10]}},
            "method": "optimise",
            "goals": {"slip": "min"},
            "roles": {"axial_force": "choice"},
        },
    ),
    "a search for the best": (
        study,
        {"question": "best"},
        "or question: decide",
        {"question": "decide"},
    ),
    "add a group to the outputs": (
        study,
        {"outputs": ["forces"], "analysis": {"outputs": ["max_pressure_1"]}},
        "Add contact to outputs.",
        {"outputs": ["forces", "contact"], "analysis": {"outputs": ["max_pressure_1"]}},
    ),
    "a name of both": (
        study,
        {"factors": FORCE | {"motor_force": {"expression": "ratio * 2"}, "ration": {"values": [1, 2]}}},
        "give both the same name",
        {"factors": FORCE | {"motor_force": {"expression": "ratio * 2"}, "ratio": {"values": [1, 2]}}},
    ),
    "radians of degrees": (
        study,
        {"factors": {"contact_angle": {"values": [30, 35]}, "axial_force": {"expression": "9 * sin(contact_angle)"}}},
        "radians(",
        {
            "factors": {
                "contact_angle": {"values": [30, 35]},
                "axial_force": {"expression": "9 * sin(radians(contact_angle))"},
            }
        },
    ),
    "method: table": (
        study,
        {"table": "cases.csv", "factors": {}},
        "Write 'method: table' too.",
        {"table": "cases.csv", "factors": {}, "method": "table"},
    ),
    "an expression beside a table": (
        study,
        {"table": "cases.csv", "method": "table", "factors": {"motor_force": {"values": [0, 1]}}},
        "Only expressions and shelves may stand beside a table.",
        {"table": "cases.csv", "method": "table", "factors": {"motor_force": {"expression": "0.1 * axial_force"}}},
    ),
    "a column without a blank in its name": (
        study,
        {"table": "blank.csv", "method": "table", "factors": {}, "constraints": ["load case != 'b' and slip < 0.1"]},
        "Write load_case: a column is known by this name, too.",
        {"table": "blank.csv", "method": "table", "factors": {}, "constraints": ["load_case != 'b' and slip < 0.1"]},
    ),
    "a column of numbers without a blank in its name": (
        study,
        {"table": "number.csv", "method": "table", "factors": {}, "constraints": ["load case < 3"]},
        "Write load_case: a column is known by this name, too.",
        {"table": "number.csv", "method": "table", "factors": {}, "constraints": ["load_case < 3"]},
    ),
    "a column without a blank, which was written as a text": (
        study,
        {"table": "run.csv", "method": "table", "factors": {}, "constraints": ["'run no' < 3"]},
        "Write run_no: a column is known by this name, too.",
        {"table": "run.csv", "method": "table", "factors": {}, "constraints": ["run_no < 3"]},
    ),
    "and in small letters": (
        study,
        {"constraints": ["slip < 0.1 AND max_pressure_1 < 900"]},
        "Write and, or, not in small letters.",
        {"constraints": ["slip < 0.1 and max_pressure_1 < 900"]},
    ),
    "write the parameter's name": (
        study,
        {"table": "wrong.csv", "method": "table", "factors": {}},
        "write this name",
        {"table": "cases.csv", "method": "table", "factors": {}},
    ),
    "add one of distance, hours and share": (
        spectrum,
        {"blocks": [{"name": "a"}]},
        "Add one of distance, hours and share to the block.",
        {"blocks": [{"name": "a", "hours": 1}]},
    ),
    "rename a block": (
        spectrum,
        {"blocks": [BLOCK, BLOCK]},
        "Rename one of the blocks.",
        {"blocks": [BLOCK, BLOCK | {"name": "b"}]},
    ),
    "shares as parts of 1": (
        spectrum,
        {"blocks": [{"name": "a", "share": 20}, {"name": "b", "share": 80}]},
        "Write 0.2 or 20 %",
        {"blocks": [{"name": "a", "share": 0.2}, {"name": "b", "share": "80 %"}]},
    ),
    "a field under base": (
        spectrum,
        {"blocks": [BLOCK | {"guide_profile_radius": 6}]},
        "Give this field under `base`.",
        {"blocks": [BLOCK], "base": {"guide_profile_radius": 6}},
    ),
}


@pytest.mark.parametrize("name", REMEDIES)
def test_what_the_message_says_gives_a_result(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("cases.csv").write_text(TABLE)
    Path("wrong.csv").write_text(TABLE.replace("axial_force", "axial load"))
    Path("blank.csv").write_text("load case,axial_force\na,0\nb,10\n")
    Path("run.csv").write_text("run no,axial_force\n1,0\n4,10\n")
    Path("number.csv").write_text("load case,axial_force\n1,0\n4,10\n")
    do, wrong, remedy, mended = REMEDIES[name]
    with pytest.raises(tr.InputError) as caught:
        do(**wrong)
    assert remedy in str(caught.value)
    assert do(**mended) is not None


# the command that is refused, what the message says, and the commands that do it
COMMANDS: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "replace a material": (
        "materials add own --file m.yaml --set like=1.7225-normalised --set tensile_strength=800",
        "ask for a change of this material (--replace)",
        ("materials add own --file m.yaml --set like=1.7225-normalised --set tensile_strength=800 --replace",),
    ),
    "another name of a file": (
        "solve --set contact_model=sliding --set outputs=[forces] -o result.txt",
        "Write result.nc.",
        ("solve --set contact_model=sliding --set outputs=[forces] -o result.nc",),
    ),
    "create a folder": (
        "solve --set contact_model=sliding --set outputs=[forces] -o new/result.nc",
        "Create the folder ",
        ("MKDIR new", "solve --set contact_model=sliding --set outputs=[forces] -o new/result.nc"),
    ),
    "a key of its own": (
        "solve --set axial_force=5 --set axial_force=6",
        "Remove one of the two.",
        ("solve --set axial_force=6 --set contact_model=sliding",),
    ),
}


@pytest.mark.parametrize("name", COMMANDS)
def test_what_the_message_of_a_command_says_gives_a_result(name, tmp_path):
    (tmp_path / "m.yaml").write_text("materials:\n  own: {like: 1.7225-normalised, tensile_strength: 750}\n")
    wrong, remedy, mended = COMMANDS[name]
    assert remedy in trackroller(*wrong.split(), cwd=tmp_path, code=2).stderr
    for line in mended:
        first, *words = line.split()
        if first == "MKDIR":
            (tmp_path / words[0]).mkdir()
        else:
            assert trackroller(first, *words, cwd=tmp_path) is not None


ROOT = Path(__file__).parents[1]
SMALL = {"name": "small", "outputs": ["forces"], "factors": {"axial_force": {"values": [0, 20, 40]}}} | QUICK
OTHER = SMALL | {"factors": {"axial_force": {"values": [0, 20, 50]}}}


def written(folder: Path, name: str, study: dict[str, Any]) -> None:
    (folder / name).write_text(yaml.safe_dump(study))


def solved(folder: Path, name: str = "small") -> int:
    """Return the number of cases that a run has left."""
    return int(xr.load_dataset(folder / "results" / name / "study.nc").sizes["axial_force"])


@pytest.mark.parametrize("missing", ["distributed", "dask"])
def test_a_missing_package_of_the_cluster_is_named_and_this_process_solves(missing, tmp_path, monkeypatch):
    written(tmp_path, "s.yaml", SMALL)
    with monkeypatch.context() as without:
        without.setitem(sys.modules, missing, None)  # as if it were not installed
        without.setattr(cluster, "take_in", lambda package: None)
        told = trackroller("run", "s.yaml", "-q", "--scheduler", "local", cwd=tmp_path, code=2).stderr
    assert "pip install 'trackroller[cluster]'" in told and "Without --scheduler, this process solves." in told
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert {"dask", "distributed"} <= {*project["dependencies"], *project["optional-dependencies"]["cluster"]}
    trackroller("run", "s.yaml", "-q", cwd=tmp_path)
    assert solved(tmp_path) == 3


@pytest.mark.parametrize("address", ["localhost:9", "tcp://localhost", "tcp://", "tcp://localhost:x", "Local", ""])
def test_a_wrong_address_of_a_scheduler_is_refused_at_once(address, tmp_path):
    written(tmp_path, "s.yaml", SMALL)
    told = trackroller("run", "s.yaml", "-q", f"--scheduler={address}", cwd=tmp_path, code=2).stderr
    remedy = f"tcp://{address}" if address == "localhost:9" else "local"
    assert f"Write --scheduler {remedy}" in told and "tcp://host:port" in told


@pytest.mark.parametrize("address", ["tcp://localhost:9", "tls://localhost:9"])
def test_a_scheduler_that_does_not_answer_is_told(address, tmp_path, monkeypatch):
    written(tmp_path, "s.yaml", SMALL)
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    told = trackroller("run", "s.yaml", "-q", "--scheduler", address, cwd=tmp_path, code=2).stderr
    assert "does not answer as a dask scheduler" in told and "Start one: dask scheduler, then dask worker" in told


def test_the_address_that_a_message_writes_reaches_the_scheduler(tmp_path):
    written(tmp_path, "s.yaml", SMALL)
    with LocalCluster(n_workers=1, processes=False, protocol="tcp", dashboard_address=None) as running:
        words = ("run", "s.yaml", "-q", "--scheduler")
        told = trackroller(*words, running.scheduler_address.removeprefix("tcp://"), cwd=tmp_path, code=2).stderr
        address = re.search(r"Write --scheduler (\S+)\.", told)[1]
        trackroller(*words, address, cwd=tmp_path)
    assert solved(tmp_path) == 3


@contextlib.contextmanager
def started(line: str, log: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Start a line of a message as a process whose output stands in a file, and end it afterwards."""
    with open(log, "wb") as stream:
        process = subprocess.Popen([sys.executable, "-m", *line.split()], stdout=stream, stderr=stream, cwd=log.parent)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def awaited(log: Path, pattern: str) -> str:
    """Return the first group of a pattern as soon as a file holds it."""
    for _ in range(1200):
        found = re.search(pattern, log.read_text()) if log.is_file() else None
        if found:
            return found[1]
        time.sleep(0.1)
    raise AssertionError(f"waited in vain for {pattern}")


@pytest.mark.long
def test_a_lost_scheduler_is_started_as_the_message_says_and_the_run_goes_on(tmp_path):
    """No worker is told; a scheduler that ends is told; the lines of the messages, as they stand, end in a result."""
    written(tmp_path, "s.yaml", SMALL)
    words = ["-m", "trackroller.cli", "run", "s.yaml", "-q", "--scheduler"]
    with started("dask scheduler --host 127.0.0.1 --port 0 --no-dashboard", tmp_path / "s.log") as scheduler:
        address = awaited(tmp_path / "s.log", r"Scheduler at:\s+(\S+)")
        with open(tmp_path / "run.log", "wb") as log:
            run = subprocess.Popen([sys.executable, *words, address], cwd=tmp_path, stdout=log, stderr=log)
        worker = awaited(tmp_path / "run.log", r"has no worker yet; the run waits for one: (dask worker \S+)")
        scheduler.kill()
        assert run.wait(120) == 1
    told = (tmp_path / "run.log").read_text()
    assert "Traceback" not in told and "the dask scheduler does not answer any more. Start one: dask scheduler" in told
    with started("dask scheduler --host 127.0.0.1 --port 0 --no-dashboard", tmp_path / "again.log"):
        again = awaited(tmp_path / "again.log", r"Scheduler at:\s+(\S+)")
        with started(worker.replace(address, again), tmp_path / "w.log"):
            trackroller_process("run", "s.yaml", "-q", "--scheduler", again, cwd=tmp_path)
    assert solved(tmp_path) == 3


PAGES = (
    "solve --set contact_model=sliding --set accuracy=preview --report page.pdf",
    "spectrum load.yaml --report page.pdf",
    "wear case.yaml --to 1km -q --report page.pdf",
    "report small --out page.pdf",
    "best small --out page.pdf",
)
BROWSER = """#!{python}
import sys
import time
made = [word.split("=", 1)[1] for word in sys.argv if word.startswith("--print-to-pdf=")]
open(made[0], "wb").write(b"%PDF-1.4 printed")
"""


@pytest.mark.slow
@pytest.mark.parametrize("line", PAGES)
def test_a_pdf_without_a_browser_becomes_a_page_or_a_pdf_after_one_was_installed(line, tmp_path, monkeypatch):
    written(tmp_path, "load.yaml", QUICK | {"name": "load", "blocks": [{"name": "a", "distance": 1}]})
    written(tmp_path, "case.yaml", QUICK | {"roller_material": "POM"})
    if "small" in line:
        written(tmp_path, "s.yaml", SMALL)
        trackroller("run", "s.yaml", "-q", cwd=tmp_path)
    monkeypatch.setattr(html.shutil, "which", lambda name: None)
    before = sorted(tmp_path.rglob("*"))
    told = trackroller(*shlex.split(line), cwd=tmp_path, code=1).stderr
    assert "Install one of them, or write a page: give a name that ends in .html." in told
    assert sorted(tmp_path.rglob("*")) == before
    trackroller(*shlex.split(line.replace(".pdf", ".html")), cwd=tmp_path)
    assert (tmp_path / "page.html").read_text().startswith("<!doctype html>")
    browser = tmp_path / "chromium"
    browser.write_text(BROWSER.format(python=sys.executable))
    browser.chmod(0o755)
    monkeypatch.setattr(html.shutil, "which", lambda name: str(browser) if name == "chromium" else None)
    trackroller(*shlex.split(line), cwd=tmp_path)
    assert (tmp_path / "page.pdf").read_bytes() == b"%PDF-1.4 printed"


@pytest.mark.slow
def test_a_browser_that_prints_nothing_is_told_and_a_page_is_written(tmp_path, monkeypatch):
    monkeypatch.setattr(html, "_browser", lambda: "false")
    line = PAGES[0].split()
    told = trackroller(*line, cwd=tmp_path, code=1).stderr
    assert "does not print the page" in told and "Give a name that ends in .html." in told
    trackroller(*line[:-1], "page.html", cwd=tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]


HOLD = """
import sys, portalocker
stream = open(sys.argv[1], "ab")
portalocker.lock(stream, portalocker.LockFlags.SHARED)
print("held", flush=True)
sys.stdin.read()
"""


@contextlib.contextmanager
def held(lock: Path) -> Iterator[None]:
    """Hold the lock of a file as a run holds it, in another process."""
    words = [sys.executable, "-c", HOLD, str(lock)]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "held\n"
        yield
        process.stdin.close()


def test_a_folder_that_another_run_holds_is_free_under_another_name_or_after_its_end(tmp_path):
    written(tmp_path, "s.yaml", SMALL)
    trackroller("run", "s.yaml", "-q", cwd=tmp_path)
    written(tmp_path, "s.yaml", OTHER)
    files = {path: path.stat().st_mtime_ns for path in (tmp_path / "results").rglob("*") if path.is_file()}
    with held(tmp_path / "results/small/plan/.lock"):
        told = trackroller("run", "s.yaml", "-q", cwd=tmp_path, code=1).stderr
        assert "another process is solving it, from another version of the study file" in told
        assert "Wait until that process ends" in told and "give this one another name." in told
        assert files == {path: path.stat().st_mtime_ns for path in (tmp_path / "results").rglob("*") if path.is_file()}
        written(tmp_path, "other.yaml", OTHER | {"name": "other"})
        trackroller("run", "other.yaml", "-q", cwd=tmp_path)
        assert solved(tmp_path, "other") == 3
    trackroller("run", "s.yaml", "-q", cwd=tmp_path)
    assert solved(tmp_path) == 3


def test_failed_cases_are_solved_again_after_the_other_run(tmp_path):
    written(tmp_path, "s.yaml", SMALL)
    trackroller("run", "s.yaml", "-q", cwd=tmp_path)
    with held(tmp_path / "results/small/plan/.lock"):
        told = trackroller("run", "s.yaml", "-q", "--rerun-failed", cwd=tmp_path, code=1).stderr
        assert "another process is solving it, and failed cases are not removed under it. Wait until" in told
        assert "another version" not in told, "the study file is the same"
        trackroller("run", "s.yaml", "-q", cwd=tmp_path)  # the same version goes on beside it
    trackroller("run", "s.yaml", "-q", "--rerun-failed", cwd=tmp_path)


def test_the_page_says_of_a_study_that_runs_elsewhere_how_to_end_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("studies").mkdir()
    written(tmp_path, "studies/small.yaml", SMALL)
    trackroller("run", "studies/small.yaml", "-q", cwd=tmp_path)
    begun: list[Any] = []
    folder = Path("results/small")
    with held(folder / "plan/.lock"):
        monkeypatch.setattr(studies.subprocess, "Popen", lambda *words, **how: begun.append(words))
        for act in (lambda: studies.start(yaml.safe_dump(OTHER)), lambda: studies.delete("small", "small")):
            with pytest.raises(WorkError, match=r"runs on the command line\. Wait until it ends, or stop it there"):
                act()
        with pytest.raises(WorkError, match="does not run from this page, so the page cannot pause it"):
            studies.pause("small")
        studies.start(yaml.safe_dump(OTHER | {"name": "other"}))  # another name, as the message says
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    (folder / studies.LOCK).touch()
    with held(folder / studies.LOCK):
        with pytest.raises(WorkError, match=r"runs already\. Pause it first"):
            studies.delete("small", "small")
        studies.pause("small")
        assert (folder / studies.PAUSE).is_file(), "the process of the page ends then"
    studies.delete("small", "small")
    assert len(begun) == 1 and not folder.exists()
