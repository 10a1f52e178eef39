"""Measure what the additional slip terms change for the paper's roller, on its guide and on a small one.

    python -m validation.benchmarks.slip_terms [--model NAME]

Changes are relative to the solution without additional slip terms; the largest over both contacts counts.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import trackroller as tr
from validation.benchmarks.command import run

CURVES, DRIVES = (220.0, 39.5), {"driven": -30.0, "free": 0.0}  # mm; N
TERMS = {"profile": ("profile",), "curve": ("curve",), "both": ("profile", "curve")}
OUTPUTS = ("forces", "friction_work", "peak_stress")
CHANGES = {
    "normal_force": "normal_force",
    "lateral_force": "lateral_force",
    "spin_moment": "spin_moment",
    "friction_work": "friction_energy_per_distance",
    "peak_stress": "peak_stress",
}


def measure(model: str = "kalker") -> dict[str, Any]:
    """Return the largest relative changes by guide, drive and slip terms."""
    found = {}
    for curve in CURVES:
        for drive, force in DRIVES.items():
            case = tr.Case(guide_curve_radius=curve, motor_force=force)
            plain = tr.solve(case, OUTPUTS, contact_model=model)
            for name, terms in TERMS.items():
                changed = tr.solve(case, OUTPUTS, contact_model=model, slip_terms=terms)
                found[f"{curve:g} mm, {drive}, {name}"] = {
                    told: float(np.abs(changed[q] / plain[q] - 1.0).max()) for told, q in CHANGES.items()
                }
    return {"changes": found}


if __name__ == "__main__":
    run(measure, __doc__)
