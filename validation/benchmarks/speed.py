"""Measure processor times of settings and contact models as ratios to one yardstick, all in one run.

    python -m validation.benchmarks.speed [--cases N] [--seed S] [--slow N]

The yardstick is a complete case (forces, contact, four peaks, life) in full sliding at accuracy `standard`, on
random rollers with different curvatures, in processor time of one thread. Rows with boundary elements take only
`--slow` of the rollers. The published equations are those of `published_transcription`, on the paper's roller. The cost
of the exact theory is measured on three samples, each over the yardstick on the same rollers. CONTACT is not run.
"""

from __future__ import annotations

import os
import time
from typing import Any

os.environ["NUMBA_NUM_THREADS"] = "1"

import trackroller as tr
from validation.benchmarks.command import run
from validation.benchmarks.published_transcription import STYLES, contacts_of_case, time_transcription
from validation.benchmarks.samples import geometry_study, load_study, random_designs

FORCES, COMPLETE = ("forces", "contact"), ("forces", "contact", "peak_stress", "life")
YARDSTICK: dict[str, dict[str, Any]] = {"sliding": {"contact_model": "sliding"}}
EXACT: dict[str, dict[str, Any]] = {
    "kalker, preview": {"contact_model": "kalker", "accuracy": "preview"},
    "kalker, standard": {"contact_model": "kalker"},
}
QUICK: dict[str, dict[str, Any]] = {
    "sliding, forces": {"contact_model": "sliding", "outputs": FORCES},
    "sliding, preview": {"contact_model": "sliding", "accuracy": "preview"},
    "sliding, reference": {"contact_model": "sliding", "accuracy": "reference"},
    "kalker_table, forces": {"contact_model": "kalker_table", "outputs": FORCES},
    "kalker_table, preview": {"contact_model": "kalker_table", "accuracy": "preview"},
    "kalker, forces": {"contact_model": "kalker", "outputs": FORCES},
    **EXACT,
}
SLOW: dict[str, dict[str, Any]] = {
    "kalker, reference": {"contact_model": "kalker", "accuracy": "reference"},
    "fastsim, standard": {"contact_model": "fastsim"},
    "sliding, non-Hertzian": {"contact_model": "sliding", "normal": "halfspace"},
    "kalker, non-Hertzian": {"contact_model": "kalker", "normal": "halfspace"},
}
SAMPLES = {
    "loads, frictions and materials vary": load_study,
    "curvatures vary": geometry_study,
    "everything varies": random_designs,
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


def over_sliding(cases: list[Any], settings: dict[str, dict[str, Any]], repeats: int = 5) -> dict[str, float]:
    """Return the costs of settings over that of the yardstick on the same rollers."""
    spent = costs(cases, YARDSTICK | settings, repeats)
    return {name: spent[name] / spent["sliding"] for name in settings}


def measure(cases: int = 100, seed: int = 1, slow: int = 8) -> dict[str, Any]:
    """Return the yardstick [ms], the ratios of all rows to it, and those of the exact theory by sample."""
    rollers = geometry_study(cases, seed)
    spent = costs(rollers, YARDSTICK | QUICK)
    yardstick = spent["sliding"]
    found = {name: spent[name] / yardstick for name in QUICK} | over_sliding(rollers[:slow], SLOW, repeats=1)
    for style in STYLES:
        published = time_transcription(contacts_of_case(tr.Case(motor_force=0)), style=style)["seconds"]
        found[f"published equations, {style}"] = published / yardstick
    by_sample = {name: over_sliding(make(cases, seed), EXACT) for name, make in SAMPLES.items()}
    return {"yardstick_ms": 1e3 * yardstick, "ratios": found, "by_sample": by_sample}


if __name__ == "__main__":
    run(measure, __doc__)
