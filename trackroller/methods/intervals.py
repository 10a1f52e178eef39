"""Confidence intervals of 95 %, on plain arrays: bootstrap, shares, medians, and whether an output varies at all."""

from __future__ import annotations

import numpy as np

Z = 1.959964  # 97.5 % quantile of the normal distribution


def constant(y: np.ndarray) -> bool:
    """Return whether an output varies by no more than rounding errors.

    Parameters
    ----------
    y : output, any shape; NaN is ignored

    Returns
    -------
    True also for an output without any finite value.
    """
    y = y[np.isfinite(y)]
    return y.size == 0 or float(np.ptp(y)) <= 1e-12 * float(np.max(np.abs(y), initial=0.0))


def percentile_bounds(drawn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the 95 % bounds over resamples.

    Parameters
    ----------
    drawn : estimates, shape (resamples, ...)

    Returns
    -------
    Low and high, shape (...); NaN where fewer than half of the resamples have a value.
    """
    good = np.isfinite(drawn)
    enough = good.mean(axis=0) > 0.5
    drawn = np.where(good | ~enough, drawn, np.nan)
    low, high = np.nanpercentile(np.where(enough, drawn, 0.0), [2.5, 97.5], axis=0)
    return np.where(enough, low, np.nan), np.where(enough, high, np.nan)


def median_interval(values: np.ndarray) -> tuple[float, float]:
    """Return a distribution-free interval of the median with a coverage of at least 95 %.

    Parameters
    ----------
    values : independent draws, shape (n,), n >= 6

    Notes
    -----
    The order statistics k and n - k + 1 enclose the median with probability 1 - 2 P(B < k), B binomial (n, 1/2).
    """
    from scipy.stats import binom  # heavy, and drawing does not need it

    values = np.sort(values)
    k = int(binom.ppf(0.025, len(values), 0.5))
    return float(values[max(k - 1, 0)]), float(values[min(len(values) - k, len(values) - 1)])


def difference_of_medians(first: np.ndarray, second: np.ndarray) -> tuple[float, float, float]:
    """Return the difference of two medians, second minus first, with its 95 % interval.

    Notes
    -----
    The interval joins the distribution-free intervals of both medians by the method of variance estimates recovery.

    References
    ----------
    Zou, Donner (2008): Construction of confidence limits about effect measures. Statistics in Medicine 27, 1693-1702.
    """
    a, b = float(np.median(first)), float(np.median(second))
    (low_a, high_a), (low_b, high_b) = median_interval(first), median_interval(second)
    low = b - a - np.hypot(b - low_b, high_a - a)
    return b - a, float(low), float(b - a + np.hypot(high_b - b, a - low_a))
