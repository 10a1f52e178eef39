"""Kill a study with SIGKILL again and again; it must end like an undisturbed one, with no case solved twice.

    python -m validation.benchmarks.survive [--seed S] [--kills N]

Eleven kills of all kinds, for the workflow, for `trackroller run` and for its dask workers: everything, Snakemake
alone, one worker alone; while chunks are being solved, gathered, drawn and reported. A case counts as solved twice when
solving it begins after it was kept on the disk. Prints a line a kill; exit code 0 when nothing was lost.
"""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from trackroller.study.store import chunks
from trackroller.study.store.folder import StudyFolder
from validation.benchmarks.command import run

ROOT = Path(__file__).resolve().parents[2]
TOOLS = Path(sys.executable).parent
STUDY = """
name: survive
factors:
  axial_force: {linspace: [0, 60, 40]}
  friction_coefficient: {linspace: [0.05, 0.4, 8]}
  roller_profile_radius: {values: [-6.4, -7, -8]}
  motor_force: {values: [0, -20]}
outputs: [forces, contact, life]
contact_model: sliding
chunk_size: 140
"""
# Loaded by every process below: writes down which cases it begins to solve (S) and has kept (W).
SPY = """
import os
if os.environ.get("SURVIVE_LOG"):
    import trackroller.study.solve as solve
    import trackroller.study.store.chunks as chunks
    def told(mark, cases):
        with open(os.environ["SURVIVE_LOG"], "ab", buffering=0) as stream:
            stream.write(b"".join(mark + case + b"\\n" for case in cases.tolist()))
    def batch(cases, *more, inner=solve.solve_cases, **named):
        told(b"S", cases["case"].values)
        return inner(cases, *more, **named)
    def write(path, block, packed=False, inner=chunks.write):
        inner(path, block, packed)
        if packed:  # a chunk, not a case list
            told(b"W", block["case"].values)
    solve.solve_cases, chunks.write = batch, write
"""
FLOW, RUN, DASK = "snakemake", "run", "run --scheduler local"
ALL, HEAD, WORKER = "everything", "the main process", "one worker"
KILLS = [
    (FLOW, ALL, "solving"),
    (RUN, ALL, "solving"),
    (FLOW, HEAD, "solving"),
    (FLOW, WORKER, "solving"),
    (DASK, ALL, "solving"),
    (RUN, ALL, "solving"),
    (DASK, WORKER, "solving"),
    (RUN, ALL, "gathering"),
    (FLOW, ALL, "gathering"),
    (FLOW, ALL, "drawing"),
    (FLOW, ALL, "reporting"),
]


def start(place: Path, how: str) -> subprocess.Popen:
    """Start a run in a session of its own."""
    words = (
        [TOOLS / "snakemake", "--cores", "2", "--nocolor"]
        if how == FLOW
        else [TOOLS / "trackroller", *how.replace("run", "run study.yaml -q", 1).split()]
    )
    paths = f"{place / 'spy'}:{os.environ.get('PYTHONPATH', '')}"
    env = os.environ | {"SURVIVE_LOG": str(place / "solved.log"), "PYTHONPATH": paths}
    with open(place / "told.txt", "a") as told:
        return subprocess.Popen(
            [str(w) for w in words], cwd=place, env=env, start_new_session=True, stdout=told, stderr=subprocess.STDOUT
        )


def members(session: int) -> dict[int, str]:
    """Return the living processes of a session: number and command line."""
    found = subprocess.run(["ps", "-s", str(session), "-o", "pid=,stat=,args="], capture_output=True, text=True).stdout
    lines = [line.split(None, 2) for line in found.splitlines()]
    return {int(pid): words for pid, state, words in lines if not state.startswith("Z")}


def workers(session: int) -> list[int]:
    """Return the jobs of the workflow, or dask's worker processes."""
    return [
        pid
        for pid, words in members(session).items()
        if ".snakemake/scripts/" in words or "--multiprocessing-fork" in words
    ]


def results(place: Path) -> Path:
    """Return the folder of the study."""
    return place / "results" / "survive"


def finished(place: Path) -> set[bytes]:
    """Return the fingerprints of the finished cases."""

    found: set[bytes] = set()
    for path in StudyFolder(results(place)).solved_files():
        try:
            found |= set(chunks.check(path).tolist())
        except FileNotFoundError:  # a process that is still alive has moved it
            continue
    return found


def moment(place: Path, phase: str, before: int) -> Callable[[], bool]:
    """Return True while the wanted work is going on."""
    if phase == "solving":  # more chunks are there than at the start
        return lambda: marks(place, b"W") > before
    pattern = {"gathering": ".study.nc.*.tmp", "drawing": ".figures.*.tmp/new/*", "reporting": "logs/report.log"}[phase]
    return lambda: any(results(place).glob(pattern))


def marks(place: Path, mark: bytes) -> int:
    """Count the cases that were begun (S) or kept (W) so far."""
    log = place / "solved.log"
    return log.read_bytes().count(b"\n" + mark) if log.is_file() else 0


def solved_again(place: Path) -> int:
    """Return the cases that were begun after they had been kept."""
    kept: set[bytes] = set()
    again = 0
    for line in (place / "solved.log").read_bytes().split():
        if line[:1] == b"W":
            kept.add(line[1:])
        else:
            again += line[1:] in kept
    return again


def prepare(study: str = STUDY) -> Path:
    """Make a folder with the workflow and the study."""
    place = Path(tempfile.mkdtemp(prefix="survive-"))
    for part in ("workflow", "profiles", "config"):
        shutil.copytree(ROOT / part, place / part)
    shutil.copy(ROOT / "Snakefile", place)
    for folder, name, text in (
        ("config", "config.yaml", "study: study.yaml\nresults: results\n"),
        (".", "study.yaml", study),
        ("spy", "sitecustomize.py", SPY),
    ):
        (place / folder).mkdir(exist_ok=True)
        (place / folder / name).write_text(text)
    return place


def kill(place: Path, how: str, whom: str, phase: str, chance: random.Random) -> str:
    """Start a run, kill it at a random moment of a phase; returns what happened."""
    if phase == "gathering":
        (results(place) / "study.nc").unlink(missing_ok=True)
    before = finished(place) if results(place).exists() else set()
    process = start(place, how)
    now = moment(place, phase, marks(place, b"W"))
    until = time.monotonic() + 300
    while not now() and process.poll() is None and time.monotonic() < until:
        time.sleep(0.002)
    if process.poll() is not None:
        return f"had ended before ({process.returncode})"
    time.sleep(chance.uniform(0, 0.6) if phase in ("solving", "drawing") else chance.uniform(0, 0.02))
    if whom == ALL:
        os.killpg(process.pid, signal.SIGKILL)
    else:
        for victim in [process.pid] if whom == HEAD else workers(process.pid)[:1]:
            os.kill(victim, signal.SIGKILL)
        if how == FLOW and whom == WORKER:  # the others would go on to the end: nothing would be left to kill
            time.sleep(0.5)
            os.killpg(process.pid, signal.SIGKILL)
    try:
        code = process.wait(timeout=600)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        return "hangs"
    lost = len(before - finished(place))
    return f"exit {code}, {len(finished(place))} cases kept, {lost} lost"


def ride(kills: list[tuple[str, str, str]], seed: int = 1, study: str = STUDY) -> list[str]:
    """Run the kills one after the other and then to the end; return the errors found."""
    calm, rough = prepare(study), prepare(study)
    chance = random.Random(seed)
    wrong = []
    try:
        for number, (how, whom, phase) in enumerate(kills, start=1):
            told = kill(rough, how, whom, phase, chance)
            print(f"kill {number}: {how}, {whom} while {phase}: {told}", flush=True)
            if "0 lost" not in told:
                wrong.append(f"kill {number}: {told}")
        for place, how in ((rough, FLOW), (calm, RUN)):
            if start(place, how).wait(timeout=1200):
                wrong.append((place / "told.txt").read_text()[-3000:])
        sets = [xr.load_dataset(results(place) / "study.nc") for place in (calm, rough)]
        differ = [n for n in sets[0].variables if not _same(sets[0][n].values, sets[1][n].values)]
        again = solved_again(rough)
        print(
            f"{len(kills)} kills, {sets[0]['regime'].size} cases; begun {marks(rough, b'S')}, kept before and begun "
            f"again {again}; differing variables: {differ or 'none'}"
        )
        wrong += [f"{again} finished cases solved again"] * bool(again) + [f"different: {differ}"] * bool(differ)
        if not (results(rough) / "report.html").is_file():
            wrong.append("no report")
    finally:
        if not wrong:
            for place in (calm, rough):
                shutil.rmtree(place, ignore_errors=True)
    return wrong


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    return a.dtype == b.dtype and np.array_equal(a, b, equal_nan=a.dtype.kind == "f")


def measure(seed: int = 1, kills: int = len(KILLS)) -> dict[str, Any]:
    """Return the number of kills that a study survived; exit with 1 and say what was lost otherwise."""
    wrong = ride(KILLS[:kills], seed)
    if wrong:
        raise SystemExit("\n".join(wrong))
    return {"kills": kills}


if __name__ == "__main__":
    run(measure, __doc__)
