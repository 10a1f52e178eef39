"""Confidence intervals of 95 %, on plain arrays: bootstrap and shares, and whether an output varies at all."""

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


def percentile_bounds(resamples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the 95 % bounds over resamples.

    Parameters
    ----------
    resamples : estimates, shape (resamples, ...)

    Returns
    -------
    Low and high, shape (...); NaN where fewer than half of the resamples have a value.
    """
    good = np.isfinite(resamples)
    enough = good.mean(axis=0) > 0.5
    resamples = np.where(good | ~enough, resamples, np.nan)
    low, high = np.nanpercentile(np.where(enough, resamples, 0.0), [2.5, 97.5], axis=0)
    return np.where(enough, low, np.nan), np.where(enough, high, np.nan)
