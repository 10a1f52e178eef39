"""Compare `normal="halfspace"` with `normal="hertz"` on parabolas, for which Hertz's theory is exact.

    python -m validation.benchmarks.solved_patches [--cases N] [--seed S] [--accuracy PRESET] [--model NAME] [--circles]

The random designs of `peak_coverage.py`; patches that reach an edge of guide or groove are left out, because
Hertzian theory has no edges. `--circles` takes circles instead of parabolas; the numbers then hold the change of shape.
Found are median and 95th percentile of the relative differences: forces over mu F_N, the moment over
mu F_N sqrt(a b), r_Delta0 over a, other results relative; and how often a peak is within its two error estimates.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

import trackroller as tr
from trackroller.roller.dataset import validity_bit
from validation.benchmarks.command import run
from validation.benchmarks.peak_coverage import sample

CONFORMAL = validity_bit("conformal")
BINS = (0.0, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 10.0, np.inf)
OUTPUTS = ("forces", "contact", "peak_stress", "friction_work")


def as_parabolas(case: tr.Case) -> tr.Case:
    """Return the same case with Hertz's approximation of both circles."""
    drawn = {name: {"parabola": getattr(case, f"{name}_radius")} for name in ("guide_profile", "roller_profile")}
    return tr.Case(**{**case.as_dict(), **drawn})


def differences(hertz, grid, friction: np.ndarray) -> dict[str, np.ndarray]:
    """Return the relative differences (cases, 2) by quantity, and for the peaks (cases, 2, 2)."""
    limit = friction[:, None] * hertz.normal_force.values
    arm = np.sqrt(hertz.semi_axis_lateral * hertz.semi_axis_rolling).values
    shift = (grid.rolling_radius_shift - hertz.rolling_radius_shift).values[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        found = {
            name: (grid[name] / hertz[name] - 1).values
            for name in (
                "normal_force",
                "max_pressure",
                "semi_axis_lateral",
                "semi_axis_rolling",
                "patch_area",
                "friction_energy_per_distance",
                "peak_stress",
            )
        }
        for name in ("lateral_force", "driving_force"):
            found[name] = (grid[name] - hertz[name]).values / limit
        found["spin_moment"] = (grid.spin_moment - hertz.spin_moment).values / (limit * arm)
        found["rolling_radius_shift"] = shift / hertz.semi_axis_lateral.values
    return found


def levels(found: dict[str, np.ndarray], chosen: np.ndarray) -> dict[str, Any]:
    """Return median, 95th percentile and largest difference of every quantity over the chosen patches (cases, 2)."""
    told: dict[str, Any] = {"patches": int(chosen.sum())}
    for name, value in found.items():
        part = np.abs(value[chosen[:, : value.shape[1]]]).ravel()
        part = part[np.isfinite(part)]
        if part.size:
            told[name] = {"median": np.median(part), "95": np.quantile(part, 0.95), "largest": part.max()}
    return told


def measure(
    cases: int = 200, seed: int = 1, accuracy: str = "standard", model: str = "sliding", circles: bool = False
) -> dict[str, Any]:
    """Return the differences of all patches and by axis ratio, and how many peaks lie within their estimates."""
    drawn = sample(cases, seed)
    hertz = tr.solve(drawn, OUTPUTS, accuracy="reference", contact_model=model)
    grids = drawn if circles else [as_parabolas(case) for case in drawn]
    grid = tr.solve(grids, OUTPUTS, accuracy=accuracy, contact_model=model, normal="halfspace")
    found = differences(hertz, grid, np.array([case.friction_coefficient for case in drawn]))
    inside = ((hertz.validity.values | grid.validity.values) & CONFORMAL) == 0
    ratio = (hertz.semi_axis_lateral / hertz.semi_axis_rolling).values
    known = inside[:, None] & np.isfinite(grid.normal_force.values)
    covered = np.abs(found["peak_stress"]) <= (grid.error_estimate + hertz.error_estimate).values
    return {
        "other_regime": int(np.sum(hertz.regime.values != grid.regime.values)),
        "covered_of_peaks": float(covered[known].mean()),
        "all": levels(found, known),
        "by_axis_ratio": {
            f"{low:g} to {high:g}": levels(found, known & (ratio >= low) & (ratio < high))
            for low, high in itertools.pairwise(BINS)
        },
    }


if __name__ == "__main__":
    run(measure, __doc__)
