"""Independent replicates of a sample, which take turns in its rows, and the intervals that follow
from their scatter.

A bootstrap of rows takes them as independent, so it misses the gain of a low-discrepancy sequence.
The replicates of a study with the key `until` are independent, whatever their rows have in common,
so their scatter gives the intervals: a jackknife that leaves out one replicate at a time [1]_, with
Student's t.

References
----------
.. [1] Owen (2013), Monte Carlo theory, methods and examples, chapters 2 and 17
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

# ASSUME: choosing the moment to stop by the width itself makes intervals too narrow by at most this
# factor; measured by validation/benchmarks/until_sure.py
WIDER = 1.15


def in_turn(draw: Callable[[int], np.ndarray], seed: int, copies: int) -> np.ndarray:
    """Draw independent samples that take turns: row i belongs to sample i % copies.

    The first rows are therefore the first rows of each sample, and a larger result begins with a
    smaller one.

    Parameters
    ----------
    draw : seed -> one sample, shape (n, ...)
    seed : the seeds of the samples follow from it; a single sample takes it as it is
    copies : number of samples

    Returns
    -------
    Shape (copies * n, ...).
    """
    if copies == 1:
        return draw(seed)
    seeds = [int(own.generate_state(1)[0]) for own in np.random.SeedSequence(seed).spawn(copies)]
    drawn = np.stack([draw(own) for own in seeds], axis=1)
    return drawn.reshape(-1, *drawn.shape[2:])


def wide(copies: int) -> float:
    """Return the factor on the standard error of a mean of replicates that gives the half width of
    its interval.
    """
    from scipy.stats import t  # heavy, and drawing does not need it

    return float(WIDER * t.ppf(0.975, copies - 1))


def jackknife(without_one: np.ndarray) -> np.ndarray:
    """Return the half width of the 95 % interval of a mean or a smooth function of means.

    Parameters
    ----------
    without_one : estimates without one replicate each, shape (replicates, ...)

    Returns
    -------
    Shape (...); NaN where an estimate is missing.

    Examples
    --------
    >>> values = np.arange(8.0)
    >>> left = (values.sum() - values) / 7
    >>> bool(np.isclose(jackknife(left), 1.15 * 2.3646 * values.std(ddof=1) / 8**0.5, rtol=1e-4))
    True
    """
    count = len(without_one)
    variance = (count - 1) / count * ((without_one - without_one.mean(axis=0)) ** 2).sum(axis=0)
    return np.asarray(wide(count) * np.sqrt(variance))


def left_out(member: np.ndarray, copies: int) -> np.ndarray:
    """Return weights 1 and 0 of rows without one replicate each, shape (copies, n)."""
    return np.asarray(member != np.arange(copies)[:, None], dtype=float)
