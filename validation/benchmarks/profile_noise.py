"""Measure how the noise of a measured profile changes the largest pressure: a circle with errors, solved as drawn.

    python -m validation.benchmarks.profile_noise [--noise MM] [--seeds N]

The guide of the paper's roller is drawn as points on its circle over 9 mm of width, with normal errors in height. Found
is the largest pressure over that of the circle without errors, for several numbers of points and settings of `smooth`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import trackroller as tr
from validation.benchmarks.command import run

RADIUS, WIDTH, POINTS = 6.0, 9.0, (61, 91, 361)
SMOOTH: dict[str, Any] = {"auto": "auto", "0.001": 0.001}


def drawn(points: int, noise: float, seed: int) -> list[list[float]]:
    """Return points (points, 2) [mm] of the circle, with errors of standard deviation `noise` [mm] in height."""
    x = np.linspace(-WIDTH / 2, WIDTH / 2, points)
    height = np.sqrt(RADIUS**2 - x**2) + np.random.default_rng(seed).normal(0.0, noise, points)
    return np.stack([x, height], axis=1).tolist()


def pressures(cases: list[tr.Case]) -> np.ndarray:
    """Return the largest pressure of each case [MPa], NaN without a solution."""
    ds = tr.solve(cases, ("contact",), contact_model="sliding", normal="halfspace", accuracy="preview")
    return ds.max_pressure.max("contact").values


def measure(noise: float = 0.001, seeds: int = 20) -> dict[str, Any]:
    """Return median, smallest and largest p_max over that of the exact circle."""
    exact = pressures([tr.Case(guide_profile={"arc": RADIUS})])[0]
    found = {}
    for points in POINTS:
        for name, smooth in SMOOTH.items():
            shapes = [{"points": drawn(points, noise, seed), "smooth": smooth} for seed in range(seeds)]
            ratio = pressures([tr.Case(guide_profile=shape) for shape in shapes]) / exact
            known = ratio[np.isfinite(ratio)]
            found[f"{points} points, smooth {name}"] = {
                "solved": known.size,
                "median": np.median(known),
                "smallest": known.min(),
                "largest": known.max(),
            }
    return {"ratios": found}


if __name__ == "__main__":
    run(measure, __doc__)
