"""Measure time and memory of the solver against the number of cases and against accuracy.

    python -m validation.benchmarks.scaling [--largest N]

Every row is measured in a process of its own, so that no other row adds to its memory: the peak of the whole process
with interpreter, libraries and the list of cases. Times are processor times of all threads, which other work on the
machine disturbs least. They are ratios to the yardstick: a complete case in full sliding at `standard`, one of 1,000.
Loading or compiling the kernels and making the cases are not in the time. Friction, loads and material vary, the
curvatures are fixed (`load_study` of samples.py).
"""

from __future__ import annotations

import json
import math
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

import trackroller as tr
from trackroller.numerics.threads import thread_count
from trackroller.report.figures import style
from validation.benchmarks.command import run
from validation.benchmarks.samples import load_study

OUTPUTS = {
    "forces and contact": ("forces", "contact"),
    "complete": ("forces", "contact", "peak_stress", "life"),
}
ACCURACIES = ("preview", "standard", "reference")
ACCURACY_CASES = 1000  # number of cases that compare the accuracies and give the yardstick


def peak_memory() -> float:
    """Return the largest resident memory of this process so far [MB]."""

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == "darwin" else peak * 1024 / 1e6


def measure_here(n: int, outputs: str, accuracy: str) -> dict[str, Any]:
    """Solve `n` cases in this process, small batches best of several runs."""

    tr.solve(load_study(2), outputs=OUTPUTS[outputs], contact_model="sliding", accuracy=accuracy)
    warm = peak_memory()
    cases = load_study(n)
    times: list[float] = []
    cpu: list[float] = []
    while not times or (sum(times) < 1.0 and len(times) < 5):
        start, start_cpu = time.perf_counter(), time.process_time()
        ds = tr.solve(cases, outputs=OUTPUTS[outputs], contact_model="sliding", accuracy=accuracy)
        times.append(time.perf_counter() - start)
        cpu.append(time.process_time() - start_cpu)
    peak = peak_memory()
    return {
        "outputs": outputs,
        "accuracy": accuracy,
        "cases": n,
        "per_case": min(cpu) / n,
        "peak_megabytes": peak,
        "grown_by_megabytes": peak - warm,
        "result_megabytes": ds.nbytes / 1e6,
        "failed": int((ds.regime == 3).sum()),
    }


def measure_apart(n: int, outputs: str, accuracy: str) -> dict[str, Any]:
    """Measure as `measure_here` does, in a fresh process."""
    task = json.dumps({"n": n, "outputs": outputs, "accuracy": accuracy})
    done = subprocess.run(
        [sys.executable, str(Path(__file__).resolve()), "--one", task], stdout=subprocess.PIPE, text=True, check=True
    )
    return json.loads(done.stdout)


def sizes(largest: int) -> list[int]:
    """Return 10, 30, 100, 300, ... and `largest` itself."""
    steps = [m * 10**k for k in range(1, 10) for m in (1, 3)]
    return [*(n for n in steps if n < largest), largest]


def exponent(rows: list[dict[str, Any]]) -> float:
    """Return the slope of log time over log cases by least squares, from 100 cases on; NaN for too few sizes.

    A slope of 1 is linear growth.
    """
    points = np.log([(r["cases"], r["over_yardstick"] * r["cases"]) for r in rows if r["cases"] >= 100])
    return float(np.polyfit(*points.T, 1)[0]) if len(points) > 1 else math.nan


def draw(by_size: list[dict[str, Any]], by_accuracy: list[dict[str, Any]], folder: Path) -> tuple[Path, Path]:
    """Draw scaling.svg and scaling.png: time and memory over the number of cases, time of a case over accuracy."""

    with style.look():
        figure = style.new_figure(66, 2 * style.COLUMN_MM)
        left, middle, right = figure.subplots(1, 3)
        for outputs, colour, mark, line in zip(OUTPUTS, style.palette(2), style.MARKERS, style.LINES, strict=False):
            rows = [r for r in by_size if r["outputs"] == outputs]
            n, look = [r["cases"] for r in rows], {"color": colour, "marker": mark, "linestyle": line, "label": outputs}
            left.loglog(n, [r["over_yardstick"] * r["cases"] for r in rows], **look)
            middle.semilogx(n, [r["peak_megabytes"] for r in rows], **look)
            rows = [r for r in by_accuracy if r["outputs"] == outputs]
            right.semilogy([r["accuracy"] for r in rows], [r["over_yardstick"] for r in rows], **look)
        last = [r for r in by_size if r["outputs"] == "complete"][-1]
        ends = [by_size[0]["cases"], last["cases"]]
        left.loglog(ends, [last["over_yardstick"] * n for n in ends], color="0.6", linewidth=0.7, label="linear")
        left.set(xlabel="Cases [–]", ylabel="Time over one case at standard [–]")
        middle.set(xlabel="Cases [–]", ylabel="Peak memory of the process [MB]")
        middle.set_ylim(0, 1.15 * max(r["peak_megabytes"] for r in by_size))
        right.set(xlabel="Accuracy", ylabel="Time of a case over that at standard [–]")
        right.margins(x=0.15)
        left.legend()
        style.head(
            figure,
            "Time grows linearly with the number of cases" if linear(by_size) else "Time and memory",
            f"contact model sliding, processor time; left and middle at accuracy standard, right with "
            f"{by_accuracy[0]['cases']} cases",
        )
        return style.save(figure, folder, "scaling")


def linear(by_size: list[dict[str, Any]]) -> bool:
    """Return True if the time of complete cases grows with a power of their number from 0.9 to 1.1."""
    return abs(exponent([r for r in by_size if r["outputs"] == "complete"]) - 1) <= 0.1


def measure(largest: int = 10_000) -> dict[str, Any]:
    """Return all rows, the yardstick [ms] and the growth of the time with the number of cases."""
    measure_apart(2, "complete", "standard")  # compiles the kernels, so that no row counts the memory of the compiler
    by_size = [measure_apart(n, outputs, "standard") for outputs in OUTPUTS for n in sizes(largest)]
    few = min(largest, ACCURACY_CASES)
    by_accuracy = [measure_apart(few, outputs, accuracy) for outputs in OUTPUTS for accuracy in ACCURACIES]
    one = next(r["per_case"] for r in by_accuracy if (r["outputs"], r["accuracy"]) == ("complete", "standard"))
    for row in (*by_size, *by_accuracy):
        row["over_yardstick"] = row.pop("per_case") / one
    return {
        "yardstick_ms": 1e3 * one,
        "threads": thread_count(),
        "by_size": by_size,
        "by_accuracy": by_accuracy,
        "exponents": {outputs: exponent([r for r in by_size if r["outputs"] == outputs]) for outputs in OUTPUTS},
    }


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:  # a row in a process of its own
        print(json.dumps(measure_here(**json.loads(sys.argv[2]))))
    else:
        run(measure, __doc__)
