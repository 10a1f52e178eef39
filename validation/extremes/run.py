"""Run the catalogue of edge scenes and gather the findings in one record, ready for JSON."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from trackroller.parameters import REGIMES
from trackroller.roller.solver import solve
from validation.extremes.checks import FAILED, NEEDED, examine, missing, run_cases
from validation.extremes.kernels import KERNELS
from validation.extremes.random_cases import random_extremes
from validation.extremes.scenes import BASE, Scene, scaled

Record = dict[str, Any]
ACCURACIES = {"sliding": "standard", "kalker": "standard"}
RANDOM = {"sliding": 3000, "kalker": 600}
SEED = 7


def random_record(model: str, count: int, seed: int = SEED) -> Record:
    """Return the record of random extremes with one model.

    It holds regimes, undefined numbers, warnings, and the change of the results when the units change.
    """
    cases = random_extremes(count, seed)
    ds, warned = run_cases(cases, model, ACCURACIES[model])
    other = solve([scaled(c, 7.3, 0.37) for c in cases], "forces", contact_model=model, accuracy=ACCURACIES[model])
    mine = solve(cases, "forces", contact_model=model, accuracy=ACCURACIES[model])
    bad = np.array([missing(ds, name).any(axis=1) for name in NEEDED]).any(axis=0)
    both = (mine.regime.values < 2) & (other.regime.values == mine.regime.values)
    n, m = mine.normal_force.values[both], other.normal_force.values[both] / (7.3**2 * 0.37)
    return {
        "model": model,
        "count": count,
        "regimes": dict(Counter(REGIMES[i] for i in ds.regime.values)),
        "failed_small_patch": int(np.sum((ds.regime.values == FAILED) & _small(cases))),
        "undefined": int(bad.sum()),
        "warnings": warned,
        "other_regime": int(np.sum(mine.regime.values != other.regime.values)),
        "scaling": float(np.max(np.abs(n - m) / np.max(n, axis=1, keepdims=True), initial=0.0)),
    }


def _small(cases: list[Record]) -> np.ndarray:
    """Return the cases whose patch, judged without friction, stays below 0.3 of every radius."""
    plain = [c | {"friction_coefficient": 0.0, "motor_force": 0.0, "axial_force": 0.0} for c in cases]
    ds = solve(plain, ("forces", "contact"), contact_model="sliding")
    return (ds.validity.values & 1 == 0) & (ds.regime.values == 0)


def regime_map(points: int = 61) -> Record:
    """Return the regimes of the base case over axial force (share of lift-off) and friction, free and braked."""
    axial, friction = np.linspace(0.0, 1.3, points), np.geomspace(0.01, 2.0, points)
    maps = {}
    for name, share in (("free rolling", 0.0), ("driven, 20 N", -20.0)):
        cases = [
            BASE
            | {"axial_force": a * 200 * math.tan(math.radians(30)), "friction_coefficient": m, "motor_force": share}
            for m in friction
            for a in axial
        ]
        ds = solve(cases, "forces", contact_model="sliding")
        jam = ds.validity.values >> 4 & 1
        maps[name] = {
            "regime": ds.regime.values.reshape(points, points).tolist(),
            "jamming": jam.reshape(points, points).tolist(),
        }
    return {"axial": axial.tolist(), "friction": friction.tolist(), "maps": maps}


def run(catalogue: Sequence[Scene], random: dict[str, int] | None = None, points: int = 61) -> Record:
    """Run the scenes of a catalogue, the kernels, `random` cases of each contact model, and a map of regimes."""
    rows = []
    for scene in catalogue:
        for model in scene.models:
            solved, findings = examine(scene, model, ACCURACIES[model])
            regimes = "".join(str(r) for r in solved.regime())
            rows.append(
                {
                    "scene": scene.name,
                    "quantity": scene.quantity,
                    "values": [str(v) for v in scene.values],
                    "model": model,
                    "regimes": regimes,
                    "findings": [
                        {
                            "check": f.check,
                            "deviation": str(f.deviation),
                            "tolerance": f.tolerance,
                            "where": str(f.where),
                            "holds": f.holds,
                        }
                        for f in findings
                    ],
                }
            )
    kernels = [k() for k in KERNELS]
    return {
        "accuracies": ACCURACIES,
        "scenes": rows,
        "kernels": [
            {
                "name": k.name,
                "quantity": k.quantity,
                "values": list(k.values),
                "errors": list(k.errors),
                "tolerance": k.tolerance,
                "against": k.against,
                "holds": k.holds,
            }
            for k in kernels
        ],
        "random": [random_record(m, n) for m, n in (random or RANDOM).items()],
        "map": regime_map(points),
    }
