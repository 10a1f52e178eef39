"""Compare `normal="halfspace"` with `normal="hertz"` on parabolas, for which Hertz's theory is exact.

    python -m validation.benchmarks.solved_patches [--cases N] [--seed S] [--accuracy PRESET] [--model NAME]

The wide designs of the trade-off; patches that reach an edge of guide or groove are left out, because Hertzian theory
has no edges. Found are median and 95th percentile of the relative differences: forces over mu F_N, the moment over
mu F_N sqrt(a b), other results relative.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import trackroller as tr
from trackroller.roller.dataset import validity_bit
from validation.benchmarks.command import run
from validation.tradeoff.sample import wide_designs

CONFORMAL = validity_bit("conformal")
OUTPUTS = ("forces", "contact", "peak_stress")


def as_parabolas(case: tr.Case) -> tr.Case:
    """Return the same case with Hertz's approximation of both circles."""
    drawn = {name: {"parabola": getattr(case, f"{name}_radius")} for name in ("guide_profile", "roller_profile")}
    return tr.Case(**{**case.as_dict(), **drawn})


def differences(hertz: Any, grid: Any, friction: np.ndarray) -> dict[str, np.ndarray]:
    """Return the relative differences (cases, 2) by quantity, and for the peaks (cases, 2, 2)."""
    limit = friction[:, None] * hertz.normal_force
    scales = {
        "normal_force": hertz.normal_force,
        "lateral_force": limit,
        "spin_moment": limit * np.sqrt(hertz.semi_axis_lateral * hertz.semi_axis_rolling),
        "max_pressure": hertz.max_pressure,
        "peak_stress": hertz.peak_stress,
    }
    return {name: np.abs((grid[name] - hertz[name]) / scale).values for name, scale in scales.items()}


def measure(cases: int = 200, seed: int = 1, accuracy: str = "standard", model: str = "sliding") -> dict[str, Any]:
    """Return median, 95th percentile and largest difference of each quantity."""
    drawn = wide_designs(cases, seed)
    hertz = tr.solve(drawn, OUTPUTS, accuracy="reference", contact_model=model)
    grid = tr.solve(
        [as_parabolas(c) for c in drawn], OUTPUTS, accuracy=accuracy, contact_model=model, normal="halfspace"
    )
    inside = ((hertz.validity.values | grid.validity.values) & CONFORMAL) == 0
    known = inside[:, None] & np.isfinite(grid.normal_force.values) & np.isfinite(hertz.normal_force.values)
    found: dict[str, Any] = {"patches": int(known.sum())}
    for name, value in differences(hertz, grid, np.array([case.friction_coefficient for case in drawn])).items():
        part = value[known][np.isfinite(value[known])]
        found[name] = {"median": np.median(part), "95": np.quantile(part, 0.95), "largest": part.max()}
    return {"all": found}


if __name__ == "__main__":
    run(measure, __doc__)
