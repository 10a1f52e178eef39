"""Measure non-Hertzian patches and the published equations as ratios to one yardstick, all in one run.

    python -m validation.benchmarks.speed [--cases N] [--seed S] [--slow N]

The yardstick is a complete case (forces, contact, four peaks, life) in full sliding at accuracy `standard`, on
random rollers with different curvatures, in processor time of one thread. Rows with boundary elements take only
`--slow` of the rollers. The published equations are those of `published_transcription`, on the paper's roller.
`trade` measures contact models and accuracies. CONTACT is not run.
"""

from __future__ import annotations

import os
import time
from typing import Any

os.environ["NUMBA_NUM_THREADS"] = "1"

import trackroller as tr
from validation.benchmarks.command import run
from validation.benchmarks.published_transcription import STYLES, contacts_of_case, time_transcription
from validation.benchmarks.samples import geometry_study

COMPLETE = ("forces", "contact", "peak_stress", "life")
YARDSTICK: dict[str, dict[str, Any]] = {"sliding": {"contact_model": "sliding"}}
SLOW: dict[str, dict[str, Any]] = {
    "sliding, non-Hertzian": {"contact_model": "sliding", "normal": "halfspace"},
    "kalker, non-Hertzian": {"contact_model": "kalker", "normal": "halfspace"},
}


def costs(cases: list[Any], settings: dict[str, dict[str, Any]], repeats: int = 5) -> dict[str, float]:
    """Return the processor time of a complete case [s] with each of the settings, the least of `repeats`.

    The settings take turns, so that other work on the machine delays all of them alike.
    """
    times: dict[str, list[float]] = {name: [] for name in settings}
    given = {name: {"outputs": COMPLETE} | options for name, options in settings.items()}
    for options in given.values():
        tr.solve(cases[:2], **options)  # compiled and loaded before the clock runs
    for _ in range(repeats):
        for name, options in given.items():
            start = time.process_time()
            tr.solve(cases, **options)
            times[name].append(time.process_time() - start)
    return {name: min(spent) / len(cases) for name, spent in times.items()}


def measure(cases: int = 100, seed: int = 1, slow: int = 8) -> dict[str, Any]:
    """Return the yardstick [ms], and the ratios of all rows to it."""
    rollers = geometry_study(cases, seed)
    yardstick = costs(rollers, YARDSTICK)["sliding"]
    few = costs(rollers[:slow], YARDSTICK | SLOW, repeats=1)
    found = {name: few[name] / few["sliding"] for name in SLOW}
    for style in STYLES:
        published = time_transcription(contacts_of_case(tr.Case(motor_force=0)), style=style)["seconds"]
        found[f"published equations, {style}"] = published / yardstick
    return {"yardstick_ms": 1e3 * yardstick, "ratios": found}


if __name__ == "__main__":
    run(measure, __doc__)
