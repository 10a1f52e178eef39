"""Run a large study through the real workflow, each step in a separate process: CPU time and peak of memory.

    python -m validation.benchmarks.million [BASE_SAMPLES] [real] [keep=FOLDER]

A Saltelli sample of six factors without second order: 8 BASE_SAMPLES cases of forces, contact and life (131072: just
over a million). Without `real`, results of a few thousand solved cases are handed out again and again in place of
solving, so that everything else is measured alone: planning, Snakemake's graph of jobs, gathering, analysis,
figures, report. With `real`, every case is solved (3-4 ms of CPU each) by `snakemake --cores all`, which goes on
where it stopped when the same command is given again with the same `keep` folder.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import yaml

from trackroller.study import store
from trackroller.study.caselists import load_list
from trackroller.study.config import load_study
from trackroller.study.design.build import MAX_CASES
from trackroller.study.plan import working_plan
from trackroller.study.solve import solve_rows

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
    "design": "saltelli",
    "second_order": False,
    "seed": 1,
    "outputs": ["forces", "contact", "life"],
    "contact_model": "sliding",
    "accuracy": "preview",
}


def plan() -> None:
    """Write the case lists."""

    with working_plan(load_study("study.yaml"), "results"):
        pass


def hand_out() -> None:
    """Fill every chunk with the results of the first one, over and over."""

    with working_plan(load_study("study.yaml"), "results") as made:
        pass
    solved = None
    for name in made.chunks:
        cases = load_list(made.folder, name)
        if solved is None:
            solved = solve_rows(cases, np.arange(min(2048, len(cases.cases))), made.study.materials)
        block = solved.take(np.arange(len(cases.cases)) % len(solved.cases))
        block.cases = cases.cases
        store.write(made.folder.chunk(name), block)


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


def main() -> None:
    """Run all steps and print one line for each."""
    words = sys.argv[1:]
    if words[:1] == ["step"]:
        return {"plan": plan, "hand_out": hand_out}[words[1]]()
    number = next((int(w) for w in words if w.isdigit()), 131072)
    keep = next((w[5:] for w in words if w.startswith("keep=")), "")
    place = Path(keep or tempfile.mkdtemp(prefix="million-")).resolve()
    place.mkdir(exist_ok=True, parents=True)
    prepare(place, number)
    me, snakemake = [sys.executable, __file__], str(Path(sys.executable).parent / "snakemake")
    run = [snakemake, "--cores", "all", "--quiet", "all", "--"]
    steps = [("plan", [*me, "step", "plan"]), ("graph", [snakemake, "-n", "--quiet", "all"])]
    steps += (
        [("solve", [*run, "results/million/study.nc"])]
        if "real" in words
        else [("hand out", [*me, "step", "hand_out"]), ("gather", [*run, "results/million/study.nc"])]
    )
    steps += [
        (rule, [*run, f"results/million/{file}"])
        for rule, file in (("analysis", "sensitivity.nc"), ("figures", "figures"), ("report", "report.html"))
    ]
    minute = 0.0
    for step, command in steps:
        wall, cpu, memory = measured(command, place)
        print(f"{step:10}{wall:8.1f} s {cpu:8.1f} s CPU {memory:6.2f} GB", flush=True)
        if step == "plan":
            minute = cpu * MAX_CASES / (8 * number)
            print(
                f"{'':10}{minute:8.1f} s CPU for the {MAX_CASES:,} cases that a study may have, at this rate",
                flush=True,
            )
    size = (place / "results" / "million" / "study.nc").stat().st_size
    print(f"study.nc {size / 1e6:.0f} MB in {place}")
    if minute > 60 and number > 100_000:
        raise SystemExit("the limit is more than can be planned in a minute: change MAX_CASES")


if __name__ == "__main__":
    main()
