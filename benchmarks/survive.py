"""The default study, killed with SIGKILL again and again, must end bit for bit like an undisturbed run.

    python benchmarks/survive.py [KILLS] [STUDY]

Prints how often it was killed, how many cases were solved more than once, and what differs.
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
from pathlib import Path

import numpy as np
import xarray as xr

ROOT = Path(__file__).resolve().parent.parent
TOOLS = Path(sys.executable).parent


def start(place: Path, turn: int) -> subprocess.Popen:
    """By turns the command and the workflow: both go on where the other stopped."""
    if turn % 2:
        words = [TOOLS / "trackroller", "run", "study.yaml", "-q"]
    else:
        words = [TOOLS / "snakemake", "--cores", "2", "--quiet", "all", "--", f"results/{name(place)}/study.nc"]
    return subprocess.Popen([str(w) for w in words], cwd=place, start_new_session=True, stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)  # fmt: skip


def name(place: Path) -> str:
    """Name of the study."""
    from trackroller.study.config import load_study

    return load_study(place / "study.yaml").name


def finished(place: Path) -> set[bytes]:
    """Fingerprints of the cases that are kept."""
    from trackroller.study import store

    found: set[bytes] = set()
    root = place / "results" / name(place) / "store"
    for path in [*root.glob("*.nc"), *root.glob("*.parts/*.nc")]:
        try:
            found |= set(store.read(path).cases.tolist())
        except FileNotFoundError:
            continue
    return found


def prepare(study: Path) -> Path:
    """A folder with the workflow and the study."""
    place = Path(tempfile.mkdtemp(prefix="survive-"))
    for part in ("workflow", "profiles"):
        shutil.copytree(ROOT / part, place / part)
    shutil.copy(ROOT / "Snakefile", place)
    (place / "config").mkdir()
    (place / "config" / "config.yaml").write_text("study: study.yaml\nresults: results\n")
    shutil.copy(study, place / "study.yaml")
    return place


def main() -> int:
    """Run the comparison; exit 0 when both runs agree."""
    kills = int(sys.argv[1]) if len(sys.argv) > 1 else 10
    study = Path(sys.argv[2]) if len(sys.argv) > 2 else ROOT / "config" / "studies" / "default.yaml"
    calm, rough = prepare(study), prepare(study)
    begun = time.perf_counter()
    assert start(calm, 0).wait() == 0
    alone = time.perf_counter() - begun
    chance = random.Random(1)
    lost = 0
    for turn in range(kills):
        process = start(rough, turn)
        time.sleep(chance.uniform(2.0, max(3.0, alone / 3)))
        before = finished(rough) if (rough / "results").exists() else set()
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        after = finished(rough) if (rough / "results").exists() else set()
        lost += len(before - after)
        print(f"kill {turn + 1}: {len(after)} cases kept, {len(before - after)} lost")
    assert start(rough, kills).wait() == 0
    sets = [xr.load_dataset(place / "results" / name(place) / "study.nc") for place in (calm, rough)]
    differ = [n for n in sets[0].variables if not _same(sets[0][n].values, sets[1][n].values)]
    print(f"undisturbed {alone:.0f} s; {kills} kills; {lost} finished cases lost; differing: {differ or 'nothing'}")
    for place in (calm, rough):
        shutil.rmtree(place)
    return int(bool(differ or lost))


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    return np.array_equal(a, b, equal_nan=a.dtype.kind == "f")


if __name__ == "__main__":
    raise SystemExit(main())
