"""Measure time and memory of the solver against the number of cases and against accuracy.

    python -m validation.benchmarks.scaling [--largest N] [--figure [FOLDER]]

Every row is measured in a process of its own, so that memory is that of this row alone: the peak of the whole process
with interpreter, libraries and the list of cases. `grown by` is what came on top of the warmed-up process before the
cases were made. `CPU` is processor time over all threads, which other work on the machine disturbs least; the figure
and the exponents show it. Loading or compiling the kernels and making the cases are not in the time. Friction, loads
and material vary, the curvatures are fixed (`load_study` of speed.py).
"""

from __future__ import annotations

# Only the standard library up here: on Linux the peak memory of a process starts with that of the process it was
# started from, so the one that starts the others must stay small.
import argparse
import json
import math
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import trackroller as tr
from trackroller.numerics.threads import thread_count
from trackroller.report.figures import style
from validation.benchmarks.speed import load_study

HERE = Path(__file__).resolve().parent
OUTPUTS = {
    "forces and contact": ("forces", "contact"),
    "complete": ("forces", "contact", "peak_stress", "life"),
}
ACCURACIES = ("preview", "standard", "reference")
ACCURACY_CASES = 1000  # at which accuracies are compared


def peak_memory() -> float:
    """Largest resident memory of this process so far [MB]."""

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
        "seconds": min(times),
        "cpu_seconds": min(cpu),
        "runs": len(times),
        "peak_megabytes": peak,
        "grown_by_megabytes": peak - warm,
        "result_megabytes": ds.nbytes / 1e6,
        "failed": int((ds.regime == 3).sum()),
        "threads": thread_count(),
    }


def measure(n: int, outputs: str, accuracy: str) -> dict[str, Any]:
    """Measure in a fresh process."""
    task = json.dumps({"n": n, "outputs": outputs, "accuracy": accuracy})
    done = subprocess.run(
        [sys.executable, str(Path(__file__).resolve()), "--one", task], stdout=subprocess.PIPE, text=True, check=True
    )
    return json.loads(done.stdout)


def sizes(largest: int) -> list[int]:
    """10, 30, 100, 300, ... and `largest` itself."""
    steps = [m * 10**k for k in range(1, 10) for m in (1, 3)]
    return [*(n for n in steps if n < largest), largest]


def exponent(rows: list[dict[str, Any]]) -> float:
    """Slope of log CPU time over log cases by least squares, from 100 cases on; 1 is linear, NaN for too few sizes."""
    points = [(math.log(r["cases"]), math.log(r["cpu_seconds"])) for r in rows if r["cases"] >= 100]
    if len(points) < 2:
        return math.nan
    x0, y0 = (sum(c) / len(points) for c in zip(*points, strict=True))
    return sum((x - x0) * (y - y0) for x, y in points) / sum((x - x0) ** 2 for x, _ in points)


def show(rows: list[dict[str, Any]]) -> None:
    """Header for an empty list, else one line a row."""
    if not rows:
        print(
            f"{'outputs':<20}{'accuracy':<11}{'cases':>8}{'time [s]':>11}{'CPU [s]':>10}{'CPU/case':>10}"
            f"{'peak [MB]':>11}{'grown by':>10}{'failed':>8}"
        )
    for r in rows:
        print(
            f"{r['outputs']:<20}{r['accuracy']:<11}{r['cases']:>8}{r['seconds']:>11.4f}"
            f"{r['cpu_seconds']:>10.4f}{1e3 * r['cpu_seconds'] / r['cases']:>7.3f} ms"
            f"{r['peak_megabytes']:>11.0f}{r['grown_by_megabytes']:>10.1f}"
            f"{r['failed']:>8}",
            flush=True,
        )


def draw(by_size: list[dict[str, Any]], by_accuracy: list[dict[str, Any]], folder: Path) -> tuple[Path, Path]:
    """scaling.svg and scaling.png: CPU time and memory over cases, CPU time of a case over accuracy."""

    with style.look():
        figure = style.new_figure(66, 2 * style.COLUMN_MM)
        left, middle, right = figure.subplots(1, 3)
        for outputs, colour, mark, line in zip(OUTPUTS, style.palette(2), style.MARKERS, style.LINES, strict=False):
            rows = [r for r in by_size if r["outputs"] == outputs]
            n, look = [r["cases"] for r in rows], {"color": colour, "marker": mark, "linestyle": line, "label": outputs}
            left.loglog(n, [r["cpu_seconds"] for r in rows], **look)
            middle.semilogx(n, [r["peak_megabytes"] for r in rows], **look)
            rows = [r for r in by_accuracy if r["outputs"] == outputs]
            right.semilogy([r["accuracy"] for r in rows], [1e3 * r["cpu_seconds"] / r["cases"] for r in rows], **look)
        last = [r for r in by_size if r["outputs"] == "complete"][-1]
        ends = [by_size[0]["cases"], last["cases"]]
        left.loglog(ends, [last["cpu_seconds"] * n / ends[1] for n in ends], color="0.6", linewidth=0.7, label="linear")
        left.set(xlabel="Cases [–]", ylabel="CPU time [s]")
        middle.set(xlabel="Cases [–]", ylabel="Peak memory of the process [MB]")
        middle.set_ylim(0, 1.15 * max(r["peak_megabytes"] for r in by_size))
        right.set(xlabel="Accuracy", ylabel="CPU time of a case [ms]")
        right.margins(x=0.15)
        left.legend()
        style.head(
            figure,
            "Time grows linearly with the number of cases" if linear(by_size) else "Time and memory",
            f"{last['threads']} thread{'s' if last['threads'] > 1 else ''}; left and middle at standard "
            f"accuracy, right with {by_accuracy[0]['cases']} cases",
        )
        style.finish(figure)
        return style.save(figure, folder, "scaling")


def linear(by_size: list[dict[str, Any]]) -> bool:
    """Return True if the exponent of the complete cases is 1 within 0.1."""
    return abs(exponent([r for r in by_size if r["outputs"] == "complete"]) - 1) <= 0.1


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--largest", type=int, default=10_000, help="largest number of cases, such as 100000")
    parser.add_argument(
        "--figure",
        nargs="?",
        type=Path,
        const=HERE.parents[1] / "docs" / "figures",
        metavar="FOLDER",
        help="write scaling.svg and scaling.png, to docs/figures if no folder is given",
    )
    parser.add_argument("--one", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.one:
        print(json.dumps(measure_here(**json.loads(args.one))))
        return
    if args.largest < 10:
        parser.error("--largest must be at least 10")
    measure(2, "complete", "standard")  # compiles what is not yet, whose memory belongs to no row
    show([])
    by_size, by_accuracy = [], []
    for outputs in OUTPUTS:
        for n in sizes(args.largest):
            by_size.append(measure(n, outputs, "standard"))
            show(by_size[-1:])
    for outputs in OUTPUTS:
        for accuracy in ACCURACIES:
            by_accuracy.append(measure(min(args.largest, ACCURACY_CASES), outputs, accuracy))
            show(by_accuracy[-1:])
    for outputs in OUTPUTS:
        slope = exponent([r for r in by_size if r["outputs"] == outputs])
        print(f"{outputs}: time ~ cases^{slope:.2f} from 100 cases on")
    print(f"threads: {by_size[-1]['threads']}")
    if args.figure:
        print(*draw(by_size, by_accuracy, args.figure), sep="\n")


if __name__ == "__main__":
    main()
