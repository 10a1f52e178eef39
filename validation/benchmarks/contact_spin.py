"""Measure the error of full sliding against the exact theory over friction, drive, contact angle and size.

    python -m validation.benchmarks.contact_spin [--accuracy PRESET]

540 rollers on a straight guide: friction 0.02 to 0.5, contact angle 12 to 75 deg, axis distance 15 to 1000 mm, pressed
by 200 N, free, with 30 N of axial force, and driven by 6 N. Spin is phi rho (`analysis.contact_models.spin`).
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import xarray as xr

import trackroller as tr
from trackroller.analysis import contact_models as ladder
from trackroller.analysis.table import StudyResults
from trackroller.study.design.draws import of_columns
from trackroller.study.design.sampling import SampledDesign
from trackroller.study.file.load import checked_keys
from trackroller.study.file.study import Study
from validation.benchmarks.command import run
from validation.contact_models.product import spread

FRICTIONS = (0.02, 0.05, 0.1, 0.2, 0.3, 0.5)
ANGLES = (12.0, 20.0, 30.0, 45.0, 60.0, 75.0)
DISTANCES = (15.0, 21.75, 60.0, 200.0, 1000.0)
LOADS = {"free": (0.0, 0.0), "free, 30 N axial": (30.0, 0.0), "driven by 6 N": (0.0, -6.0)}
LEANS = (0.0, 0.05, 0.1, 0.2, 0.5, 2.0)
OUTPUTS = ("forces", "contact", "friction_work", "peak_stress")
SPINS = (0.0, 0.2, 0.5, 10.0)


def solved(accuracy: str) -> StudyResults:
    """Solve all rollers with both models and gather them as a study does."""
    rows = list(itertools.product(FRICTIONS, ANGLES, DISTANCES, LOADS))
    inputs = {
        "friction_coefficient": [r[0] for r in rows],
        "contact_angle": [r[1] for r in rows],
        "axis_distance": [r[2] for r in rows],
        "axial_force": [LOADS[r[3]][0] for r in rows],
        "motor_force": [LOADS[r[3]][1] for r in rows],
    }
    cases = [
        tr.Case(radial_force=-200.0, guide_curve_radius=np.inf, **dict(zip(inputs, v, strict=True)))
        for v in zip(*inputs.values(), strict=True)
    ]
    parts = []
    for model in ("sliding", "kalker"):
        ds = tr.solve(cases, outputs=OUTPUTS, contact_model=model, accuracy=accuracy)
        labels: dict = {name: ("case", values) for name, values in inputs.items()}
        labels |= {"contact_model": ("case", [model] * len(rows)), "guide_curve_radius": np.inf}
        parts.append(ds.assign_coords(labels))
    data = xr.concat(parts, "case", combine_attrs="drop_conflicts")
    columns = {name: data[name].values for name in (*inputs, "contact_model")}
    free, unit = of_columns(columns)
    study = Study(checked_keys({"name": "contact-spin", "base": {"guide_curve_radius": np.inf}}))
    return StudyResults(study, SampledDesign(columns, free, "table", unit, {}), data)


def steps(limits: tuple[float, ...]) -> list[tuple[str, float, float]]:
    """Return name, lower and upper limit of each interval between neighbouring limits."""
    return [(f"{low:g} to {high:g}", low, high) for low, high in itertools.pairwise(limits)]


def measure(accuracy: str = "standard") -> dict[str, Any]:
    """Return the errors of full sliding: of all rollers, by mu tan(alpha) and load, and by friction and spin."""
    paired = ladder.pairs(solved(accuracy).view)
    errors = {str(name): e.values for name, e in ladder.errors(paired).sel(contact_model="sliding").data_vars.items()}
    mu, lean, spin = (paired[n].values for n in ("friction_coefficient", "lean", "spin"))
    flat = paired["contact_angle"].values <= 60
    loads = {
        name: (paired["axial_force"] == axial).values & (paired["motor_force"] == drive).values
        for name, (axial, drive) in LOADS.items()
    }
    normal, peak = errors["normal_force"], errors["peak_stress"]
    return {
        "rollers": int(mu.size),
        "all": {name: spread(e) for name, e in errors.items()},
        "normal_force_by_lean": {
            load: {name: spread(normal[own & (lean >= low) & (lean < high)]) for name, low, high in steps(LEANS)}
            for load, own in loads.items()
        },
        "peak_stress_by_spin": {
            f"{m:g}": {
                name: spread(peak[(mu == m) & flat & (spin >= low) & (spin < high)]) for name, low, high in steps(SPINS)
            }
            for m in FRICTIONS
        },
    }


if __name__ == "__main__":
    run(measure, __doc__)
