"""Compare `normal="halfspace"` with `normal="hertz"` where Hertz's theory is exact: parabolas, by ellipticity.

    python -m validation.benchmarks.solved_patches [--cases N] [--seed S] [--accuracy A] [--model M] [--circles]

The random designs of `peak_coverage.py`; patches that reach an edge of guide or groove are left out, for Hertz knows
none. `--circles` takes the circles instead of parabolas: then the difference of their shapes is in the numbers too.
Prints median and 95th percentile of the relative differences, in per cent: forces over mu F_N, the moment over
mu F_N sqrt(a b), r_Delta0 over a, the rest over itself; and how often a peak is within its two error estimates.
"""

from __future__ import annotations

import argparse
import itertools
import time

import numpy as np

import trackroller as tr
from trackroller.roller.dataset import validity_bit
from validation.benchmarks.peak_coverage import sample

CONFORMAL = validity_bit("conformal")
BINS = (0.0, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 10.0, np.inf)
OUTPUTS = ("forces", "contact", "peak_stress", "friction_work")


def as_parabolas(case: tr.Case) -> tr.Case:
    """Return the same case with Hertz's approximation of both circles."""
    drawn = {name: {"parabola": getattr(case, f"{name}_radius")} for name in ("guide_profile", "roller_profile")}
    return tr.Case(**{**case.as_dict(), **drawn})


def differences(hertz, grid, friction: np.ndarray) -> dict[str, np.ndarray]:
    """Relative differences (cases, 2) by quantity, and for the peaks (cases, 2, 2)."""
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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--accuracy", default="standard")
    parser.add_argument("--model", default="sliding", choices=("sliding", "fastsim", "kalker"))
    parser.add_argument("--circles", action="store_true")
    args = parser.parse_args()
    cases = sample(args.cases, args.seed)
    hertz = tr.solve(cases, OUTPUTS, accuracy="reference", contact_model=args.model)
    start = time.process_time()
    drawn = cases if args.circles else [as_parabolas(case) for case in cases]
    grid = tr.solve(drawn, OUTPUTS, accuracy=args.accuracy, contact_model=args.model, normal="halfspace")
    print(
        f"{(time.process_time() - start) / len(cases):.2f} s of processor time a case; regimes that differ:",
        int(np.sum(hertz.regime.values != grid.regime.values)),
    )
    found = differences(hertz, grid, np.array([case.friction_coefficient for case in cases]))
    inside = ((hertz.validity.values | grid.validity.values) & CONFORMAL) == 0
    ratio = (hertz.semi_axis_lateral / hertz.semi_axis_rolling).values
    covered = np.abs(found["peak_stress"]) <= (grid.error_estimate + hertz.error_estimate).values
    for low, high in itertools.pairwise(BINS):
        chosen = inside[:, None] & (ratio >= low) & (ratio < high) & np.isfinite(grid.normal_force.values)
        if not chosen.any():
            continue
        print(f"a/b {low:g} to {high:g}: {int(chosen.sum())} patches")
        for name, value in found.items():
            part = 100 * np.abs(value[chosen]).ravel()
            part = part[np.isfinite(part)]
            if part.size:
                print(f"    {name:30s} {np.median(part):.3f}  {np.quantile(part, 0.95):.3f}  largest {part.max():.2f}")
        print(
            f"    peaks covered {100 * covered[chosen].mean():.1f} %, "
            f"within 1 % {100 * np.mean(np.abs(found['peak_stress'][chosen]) < 0.01):.1f} %"
        )


if __name__ == "__main__":
    main()
