"""Count how many random designs with friction that falls with the slip speed find a balance.

    python -m validation.benchmarks.falling_friction [--cases N] [--seed S] [--runs MODEL:PRESET ...]

Random designs under laws of every kind that fall to 0.3 to 0.9 of the value at rest, with characteristic speeds of 0.01
to 100 times the spin slip at the rim of the patch.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

import trackroller as tr
from trackroller.parameters import REGIMES
from trackroller.roller.dataset import validity_bit
from validation.benchmarks.command import run
from validation.tradeoff.sample import wide_designs

RUNS = ("sliding:standard", "kalker:preview", "kalker:standard")
SPEED = 100.0  # characteristic slip speed of every law [mm/s]; the travel velocity sets the slip speed over it


def laws() -> list[dict[str, Any]]:
    """Return laws of every kind that fall to 0.3 to 0.9, some with a plateau or with a rise before the fall."""
    found: list[dict[str, Any]] = []
    for lowest in (0.3, 0.5, 0.7, 0.9):
        middle = 0.5 * (1.0 + lowest)
        found += [
            {"kind": "linear", "speed": SPEED, "lowest": lowest},
            {"kind": "exponential", "speed": SPEED, "lowest": lowest},
            {"kind": "table", "speed": [0.0, 0.5 * SPEED, SPEED, 3 * SPEED], "friction": [1.0, 1.0, middle, lowest]},
            {"kind": "table", "speed": [0.0, 0.2 * SPEED, 2 * SPEED], "friction": [1.0, 1.1, lowest]},
        ]
    return found


def sample(n: int, seed: int) -> list[tr.Case]:
    """Return `n` cases that roll or slip under constant friction; cases that lift off are left out."""
    drawn = wide_designs(3 * n, seed)
    plain = tr.solve(drawn, outputs=("forces", "contact"), contact_model="sliding", accuracy="preview")
    rim = np.sqrt(plain.semi_axis_lateral * plain.semi_axis_rolling).max("contact").values
    rng, cases = np.random.default_rng(seed), []
    for i in np.flatnonzero(plain.regime.values < 2)[:n]:
        law, over, case = laws()[rng.integers(len(laws()))], 10 ** rng.uniform(-2, 2), drawn[i]
        angle = math.radians(case.contact_angle)
        radius = case.axis_distance - case.guide_profile_radius * math.cos(angle)
        speed = SPEED * over / (rim[i] * math.sin(angle) / radius)  # mm/s
        cases.append(replace(case, friction_law=law, velocity=speed * 60.0 / 1000.0))
    return cases


def measured(cases: list[tr.Case], model: str, accuracy: str) -> dict[str, Any]:
    """Return the regimes, and which cases failed or did not converge, of one model at one accuracy."""
    ds = tr.solve(cases, outputs=("forces",), contact_model=model, accuracy=accuracy)
    regime = ds.regime.values
    return {
        "cases": len(cases),
        "regimes": {name: int(np.sum(regime == k)) for k, name in enumerate(REGIMES)},
        "failed_cases": np.flatnonzero(regime == 3),
        "not_converged_cases": np.flatnonzero((regime == 0) & (ds.converged.values == 0)),
    }


def steep_friction(cases: list[tr.Case]) -> np.ndarray:
    """Return which cases have friction that falls too steeply for the theory (validity bit `steep_friction`), (n,)."""
    ds = tr.solve(cases, outputs=("forces",), contact_model="kalker", accuracy="preview")
    return (ds.validity.values & validity_bit("steep_friction")) != 0


def measure(cases: int = 64, seed: int = 1, runs: tuple[str, ...] = RUNS) -> dict[str, Any]:
    """Return the counts of each run, MODEL:PRESET."""
    drawn = sample(cases, seed)
    found = {word: measured(drawn, *word.split(":")) for word in runs}
    return {"steep_cases": np.flatnonzero(steep_friction(drawn)), "runs": found}


if __name__ == "__main__":
    run(measure, __doc__)
