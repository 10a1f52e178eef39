"""How indices settle as the sample grows, and how many more samples they would take."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from trackroller.analysis.indices import Estimates

HALF_WIDTH = 0.05  # half width of the 95 % interval of a share of variance that counts as converged
HALF_WIDTH_MORRIS = 0.15  # the same for mu*, relative to the largest mu*


def sizes(total: int, smallest: int = 16, points: int = 7) -> np.ndarray:
    """Sample sizes at which the course is taken: halves of the whole, down to `smallest`; increasing."""
    found = [total]
    while len(found) < points and found[-1] // 2 >= smallest:
        found.append(found[-1] // 2)
    return np.array(found[::-1])


def course(estimate: Callable[[int], Estimates], at: Sequence[int] | np.ndarray, names: Sequence[str]) -> Estimates:
    """Estimates and their intervals from the first samples of a design.

    Parameters
    ----------
    estimate : number of samples -> estimates, each shape (k,)
    at : sample sizes, shape (m,)
    names : which estimates, each with its _low and _high

    Returns
    -------
    name_course, name_course_low, name_course_high, each shape (m, k).
    """
    rows = [estimate(int(size)) for size in at]
    return {
        f"{name}_course{end}": np.stack([row[name + end] for row in rows])
        for name in names
        for end in ("", "_low", "_high")
    }


def take_times(low: np.ndarray, high: np.ndarray, target: float) -> float:
    """How many times the samples are needed for the widest interval to reach `target` (half width).

    Half widths fall as one over the root of the samples (the rule for random samples; a Sobol sequence does
    better, so this is on the safe side). 1 means converged; else a power of two; NaN if nothing is known.
    """
    half = (np.asarray(high) - np.asarray(low)) / 2
    half = half[np.isfinite(half)]
    if half.size == 0 or not target > 0:
        return math.nan
    times = float((half.max() / target) ** 2)
    return 1.0 if times <= 1.0 else float(2 ** math.ceil(math.log2(times) - 1e-9))


def advice(times: float) -> str:
    """Words for `take_times`."""
    if math.isnan(times):
        return "too few usable samples to judge convergence"
    return "converged" if times <= 1 else f"not converged: take {times:.0f}x more samples"
