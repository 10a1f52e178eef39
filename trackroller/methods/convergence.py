"""How indices settle as the sample grows, and how many more samples they need."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from trackroller.methods.method import Estimates


def sizes(total: int, smallest: int = 16, points: int = 7) -> np.ndarray:
    """Return the sample sizes of a course: halves of the whole sample, down to `smallest`.

    Parameters
    ----------
    total : number of samples
    smallest : smallest size
    points : largest number of sizes

    Returns
    -------
    Increasing sizes, shape (m,).
    """
    falling = [total]
    while len(falling) < points and falling[-1] // 2 >= smallest:
        falling.append(falling[-1] // 2)
    return np.array(falling[::-1])


def course(
    estimate: Callable[[int], Estimates],
    at: Sequence[int] | np.ndarray,
    whole: Estimates,
    names: Sequence[str],
) -> Estimates:
    """Estimate indices and their intervals from the first samples of a design.

    Parameters
    ----------
    estimate : number of samples -> estimates, each shape (k,)
    at : sample sizes, shape (m,), the last one that of the design
    whole : estimates of the whole design
    names : indices, each with its _low and _high

    Returns
    -------
    name_course, name_course_low, name_course_high, each shape (m, k).
    """
    rows = [*(estimate(int(size)) for size in at[:-1]), whole]
    keys = [(name, end) for name in names for end in ("", "_low", "_high")]
    return {
        f"{name}_course{end}": np.stack([row[name + end] for row in rows]) for name, end in keys
    }


def half_width(low: np.ndarray, high: np.ndarray) -> float:
    """Return the half width of the widest interval; NaN if none is known."""
    half = (np.asarray(high) - np.asarray(low)) / 2
    half = half[np.isfinite(half)]
    return float(half.max()) if half.size else math.nan


def take_times(low: np.ndarray, high: np.ndarray, target: float) -> float:
    """Return the factor on the sample size that brings the widest interval to a target.

    Parameters
    ----------
    low, high : bounds of the intervals, same shape; NaN is ignored
    target : half width wanted

    Returns
    -------
    1 if the target is met, otherwise a power of two; NaN if no interval is known.

    Notes
    -----
    The half width falls as one over the root of the samples. A Sobol sequence does better, so the
    factor is conservative.
    """
    if target > 0:
        times = (half_width(low, high) / target) ** 2
    else:
        times = math.nan
    if math.isnan(times):
        return math.nan
    if times <= 1.0:
        return 1.0
    return float(2 ** math.ceil(math.log2(times) - 1e-9))
