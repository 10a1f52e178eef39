"""Run a large study through the workflow and measure processor time and peak memory of every step.

    python -m validation.benchmarks.million [--base-samples N] [--real] [--keep FOLDER]

A Saltelli sample of six factors without second order has 8 cases for each base sample (131072: just over a million
cases), with forces, contact and life. Without `--real`, the results of a few thousand solved cases are repeated
instead of solving, so that only the other steps are measured: planning, Snakemake's graph of jobs, gathering,
analysis, figures, report. With `--real`, every case is solved by `snakemake --cores all`, which goes on where it
stopped when the same command is given again with the same `--keep` folder.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from trackroller.study.design.build import MAX_CASES
from trackroller.study.file.load import load_study
from trackroller.study.solve_chunk import load_cases, solve_cases
from trackroller.study.store import chunks
from trackroller.study.store.ledger import working_ledger
from validation.benchmarks.command import run

ROOT = Path(__file__).resolve().parents[2]
STUDY = {
    "name": "million",
    "base": {"axis_distance": 21.75, "guide_curve_radius": 220, "velocity": 60},
    "factors": {
        "friction_coefficient": {"uniform": [0.1, 0.3]},
        "profile_ratio": {"uniform": [1.1, 1.4]},
        "roller_profile_radius": {"expression": "-profile_ratio * 6"},
        "contact_angle": {"uniform": [28, 40]},
        "radial_force": {"uniform": [-250, -150]},
        "axial_load_ratio": {"uniform": [0, 0.25]},
        "axial_force": {"expression": "axial_load_ratio * abs(radial_force)"},
        "drive_share": {"uniform": [0, 0.5]},
        "motor_force": {"expression": "-drive_share * friction_coefficient * abs(radial_force)"},
    },
    "method": "saltelli",
    "second_order": False,
    "seed": 1,
    "outputs": ["forces", "contact", "life"],
    "contact_model": "sliding",
    "accuracy": "preview",
}


def plan() -> None:
    """Write the case lists."""

    with working_ledger(load_study("study.yaml"), "results"):
        pass


def hand_out() -> None:
    """Fill every chunk with the results of the first one, over and over."""

    with working_ledger(load_study("study.yaml"), "results") as made:
        pass
    solved = None
    for name in made.chunks:
        cases = load_cases(made.folder, name)
        if solved is None:
            solved = solve_cases(cases.isel(case=slice(2048)), made.study.materials)
        block = solved.isel(case=np.arange(cases.sizes["case"]) % solved.sizes["case"])
        chunks.write(made.folder.chunk(name), block.assign_coords(case=cases["case"]), packed=True)


def measured(words: list[str], place: Path) -> tuple[float, float, float]:
    """Run a command; returns seconds, CPU seconds (children of it included) and the peak of memory [GB] of one
    process."""
    begun = time.perf_counter()
    with open(place / "told.txt", "w+", encoding="utf-8") as told:
        process = subprocess.Popen(words, cwd=place, stdout=told, stderr=subprocess.STDOUT)
        _, code, used = os.wait4(process.pid, 0)
        if code:
            told.seek(0)
            raise SystemExit(f"{' '.join(words)} failed:\n{told.read()[-3000:]}")
    return time.perf_counter() - begun, used.ru_utime + used.ru_stime, used.ru_maxrss / 1e6


def prepare(place: Path, base_samples: int) -> None:
    """Put the workflow and the study into a folder."""

    for part in ("workflow", "profiles", "config"):
        shutil.copytree(ROOT / part, place / part, dirs_exist_ok=True)
    shutil.copy(ROOT / "Snakefile", place)
    (place / "config").mkdir(exist_ok=True)
    (place / "config" / "config.yaml").write_text("study: study.yaml\nresults: results\n")
    (place / "study.yaml").write_text(yaml.safe_dump({**STUDY, "samples": base_samples}, sort_keys=False))


def measure(base_samples: int = 131072, real: bool = False, keep: str = "") -> dict[str, Any]:
    """Return time, processor time [s] and peak of memory [GB] of every step; `real` solves all cases."""
    place = Path(keep or tempfile.mkdtemp(prefix="million-")).resolve()
    place.mkdir(exist_ok=True, parents=True)
    prepare(place, base_samples)
    me, snakemake = [sys.executable, __file__], str(Path(sys.executable).parent / "snakemake")
    flow = [snakemake, "--cores", "all", "--quiet", "all", "--"]
    steps = [("plan", [*me, "plan"]), ("graph", [snakemake, "-n", "--quiet", "all"])]
    if not real:
        steps.append(("hand out", [*me, "hand_out"]))
    steps += [
        (rule, [*flow, f"results/million/{file}"])
        for rule, file in (
            ("solve and gather" if real else "gather", "study.nc"),
            ("analysis", "sensitivity.nc"),
            ("figures", "figures"),
            ("report", "report.html"),
        )
    ]
    found = {}
    for step, command in steps:
        numbers = measured(command, place)
        found[step] = dict(zip(("seconds", "processor_seconds", "gigabytes"), numbers, strict=True))
        print(f"{step}: {numbers[0]:.1f} s", file=sys.stderr, flush=True)
    longest_plan = found["plan"]["processor_seconds"] * MAX_CASES / (8 * base_samples)
    if longest_plan > 60 and base_samples > 100_000:
        raise SystemExit("a study of MAX_CASES takes more than a minute to plan: change MAX_CASES")
    return {"cases": 8 * base_samples, "steps": found, "seconds_to_plan_the_largest_study": longest_plan}


if __name__ == "__main__":
    if sys.argv[1:] in (["plan"], ["hand_out"]):  # a step in a process of its own
        {"plan": plan, "hand_out": hand_out}[sys.argv[1]]()
    else:
        run(measure, __doc__)
