"""Measure processor times of settings and contact models as ratios to one yardstick, all in one run.

    python -m validation.benchmarks.speed [--cases N] [--seed S] [--slow N]

The yardstick is a complete case (forces, contact, four peaks, life) in full sliding at accuracy `standard`, on
random rollers with different curvatures, in processor time of one thread. Rows with boundary elements take only
`--slow` of the rollers. The published equations are those of `published_transcription`, on the paper's roller.
CONTACT is not run.
"""

from __future__ import annotations

import os
from typing import Any

os.environ["NUMBA_NUM_THREADS"] = "1"

import trackroller as tr
from validation.benchmarks.command import run
from validation.benchmarks.kalker_cost import OUTPUTS, costs
from validation.benchmarks.published_transcription import STYLES, contacts_of_case, time_transcription
from validation.benchmarks.samples import geometry_study

FORCES = ("forces", "contact")
YARDSTICK: dict[str, dict[str, Any]] = {"sliding": {"contact_model": "sliding"}}
QUICK: dict[str, dict[str, Any]] = {
    "sliding, forces": {"contact_model": "sliding", "outputs": FORCES},
    "sliding, preview": {"contact_model": "sliding", "accuracy": "preview"},
    "sliding, reference": {"contact_model": "sliding", "accuracy": "reference"},
    "kalker_table, forces": {"contact_model": "kalker_table", "outputs": FORCES},
    "kalker_table, preview": {"contact_model": "kalker_table", "accuracy": "preview"},
    "kalker, forces": {"contact_model": "kalker", "outputs": FORCES},
    "kalker, preview": {"contact_model": "kalker", "accuracy": "preview"},
    "kalker, standard": {"contact_model": "kalker"},
}
SLOW: dict[str, dict[str, Any]] = {
    "kalker, reference": {"contact_model": "kalker", "accuracy": "reference"},
    "fastsim, standard": {"contact_model": "fastsim"},
    "sliding, non-Hertzian": {"contact_model": "sliding", "normal": "halfspace"},
    "kalker, non-Hertzian": {"contact_model": "kalker", "normal": "halfspace"},
}


def measure(cases: int = 100, seed: int = 1, slow: int = 8) -> dict[str, Any]:
    """Return the yardstick [ms] and the ratios of all rows to it."""
    sample = geometry_study(cases, seed)
    spent = costs(sample, YARDSTICK | QUICK)
    yardstick, few = spent["sliding"], sample[: min(slow, cases)]
    own = costs(few, YARDSTICK)["sliding"]
    found = {name: spent[name] / yardstick for name in QUICK}
    found |= {name: value / own for name, value in costs(few, SLOW, repeats=1).items()}
    for style in STYLES:
        published = time_transcription(contacts_of_case(tr.Case(motor_force=0)), style=style)["seconds"]
        found[f"published equations, {style}"] = published / yardstick
    return {"yardstick_ms": 1e3 * yardstick, "outputs": OUTPUTS, "ratios": found}


if __name__ == "__main__":
    run(measure, __doc__)
