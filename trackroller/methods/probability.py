"""Intervals of probabilities from stratified samples, and from one sample that several design
points share.
"""

from __future__ import annotations

import numpy as np
from scipy import stats

from trackroller.methods.interactions import held_out, orthonormal

# degrees of the polynomials of each factor; the one with the smallest residuals at held-out rows
# counts
DEGREES = (12, 8, 5, 3, 2, 1)


def probabilities(
    hits: np.ndarray, unit: np.ndarray | None = None, ordered: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Estimate the probabilities of events with their 95 % intervals.

    Parameters
    ----------
    hits : share of each event at each sample, 0 to 1, shape (n, m)
    unit : quantiles or list indices of a stratified sample (Latin hypercube, Sobol sequence), shape
        (n, k); not given for a plain random sample
    ordered : for which factors more and less mean something, shape (k,)

    Returns
    -------
    Probability, lower and upper bound [1], each of shape (m,).

    Notes
    -----
    The bounds are those of Clopper and Pearson for the effective number of samples p (1 - p) /
    var(p) [1]_.

    A stratified sample removes the part of the variance that is a sum of functions of the single
    factors [2]_. This function fits such a sum, and takes var(p) as the variance of the residuals
    at held-out rows, divided by n. A Sobol sample whose number of rows is no power of two has empty
    strata; their share of the removed part counts again. Few events (or few non-events) support a
    fit badly. The effective number of samples is therefore at most n times the smaller of the
    numbers of events and non-events. ``validation/benchmarks/probability_intervals.py`` measures
    the coverage.

    References
    ----------
    .. [1] Korn & Graubard (1998), Survey Methodology 24, 193-201
    .. [2] Stein (1987), Technometrics 29, 143-151; Owen (1997), Ann. Statist. 25, 1541-1562
    """
    n = len(hits)
    p = hits.mean(axis=0)
    missed = hits.var(axis=0)
    if unit is not None and ordered is not None:
        fitted = np.minimum(missed, _unexplained(hits, unit, ordered))
        missed = fitted + _empty(unit) * (missed - fitted)
    gain = p * (1 - p) / np.maximum(missed, 1e-300)
    low, high = bounds(p, n * np.clip(gain, 1.0, np.maximum(1.0, n * np.minimum(p, 1 - p))))
    return p, low, high


def bounds(share: np.ndarray, count: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Return the 95 % bounds of Clopper and Pearson.

    Parameters
    ----------
    share : observed shares [1], any shape
    count : number of samples behind each share, need not be whole

    Returns
    -------
    Low and high, shape of `share`.
    """
    hit = np.asarray(share, dtype=float) * count
    with np.errstate(invalid="ignore"):
        low = np.where(hit > 0, stats.beta.ppf(0.025, hit, count - hit + 1), 0.0)
        high = np.where(hit < count, stats.beta.ppf(0.975, hit + 1, count - hit), 1.0)
    return low, high


def _empty(unit: np.ndarray) -> float:
    """Return the largest share of the n strata of a factor without a sample; factors with a list do
    not count.
    """
    own = unit[:, (unit % 1 != 0).any(axis=0)]
    return max(
        (1 - len(np.unique((column * len(unit)).astype(int))) / len(unit) for column in own.T),
        default=0.0,
    )


def _unexplained(hits: np.ndarray, unit: np.ndarray, ordered: np.ndarray) -> np.ndarray:
    """Return the variance that a fitted sum of functions of each factor misses in held-out rows,
    shape (m,).
    """
    bases = [orthonormal(unit[:, j], bool(ordered[j]), max(DEGREES)) for j in range(unit.shape[1])]
    known = [(base, bool(ordered[j])) for j, base in enumerate(bases) if base is not None]
    degree = [
        np.arange(base.shape[1]) + 1 if rising else np.ones(base.shape[1]) for base, rising in known
    ]
    degrees = np.concatenate([np.zeros(1), *degree])
    order = np.argsort(degrees, kind="stable")
    table = np.concatenate([np.ones((len(hits), 1)), *(base for base, _ in known)], axis=1)[
        :, order
    ]
    missed = held_out(hits, table, [int((degrees <= limit).sum()) for limit in DEGREES])
    variances = [(residual**2).mean(axis=0) for residual in missed if residual is not None]
    return np.asarray(np.min([np.full(hits.shape[1], np.inf), *variances], axis=0))
