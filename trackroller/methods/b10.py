"""The life that 90 % reach, B10, with the interval of one sample, or of independent replicates like
a probability.
"""

from __future__ import annotations

import numpy as np
from scipy import stats
from scipy.optimize import brentq

from trackroller.methods.probability import bounds
from trackroller.methods.replicates import jackknife, wide


def b10(
    lives: np.ndarray, log_life_scatter: float | np.ndarray = 0.0
) -> tuple[float, float, float]:
    """Estimate the life that 90 % reach, with its 95 % interval.

    Parameters
    ----------
    lives : median lives at the sampled conditions [any unit], shape (n,); 0 and inf are allowed
    log_life_scatter : standard deviation of log10 life of the material itself [1], one or of shape
        (n,)

    Returns
    -------
    B10, lower and upper bound in the unit of `lives`.

    Notes
    -----
    Without scatter of the material: the 10 % order statistic and its distribution-free (binomial)
    interval. With it: the root of mean_i Phi((lg t - lg N_i) / s) = 0.1, and the same interval
    moved by the ratio of both.
    """
    ranked = np.sort(lives)
    count = len(ranked)
    value = float(quantile(ranked, 0.1))
    low = ranked[max(0, int(stats.binom.ppf(0.025, count, 0.1)) - 1)]
    high = ranked[min(count - 1, int(stats.binom.ppf(0.975, count, 0.1)))]
    deviations = np.broadcast_to(np.asarray(log_life_scatter, dtype=float), lives.shape)[
        np.argsort(lives)
    ]
    if not (deviations > 0).any() or not np.isfinite(ranked).any() or value in (0.0, np.inf):
        return value, float(low), float(high)
    with np.errstate(divide="ignore"):
        logs = np.log10(ranked)

    def miss(t: float) -> float:
        return float(stats.norm.cdf((t - logs) / np.maximum(deviations, 1e-9)).mean()) - 0.1

    finite = logs[np.isfinite(logs)]
    wide = 6 * float(deviations.max())
    scattered = 10 ** brentq(miss, finite.min() - wide, finite.max() + wide)
    return float(scattered), float(low * scattered / value), float(high * scattered / value)


def quantile(values: np.ndarray, share: np.ndarray | float) -> np.ndarray:
    """Return order statistics, so that no arithmetic mixes finite and infinite lives."""
    return np.asarray(np.quantile(values, share, method="inverted_cdf"))


def share(hits: np.ndarray, member: np.ndarray, copies: int) -> tuple[float, float]:
    """Return a probability and the half width of its 95 % interval; `hits` 0 to 1 and `member` have
    the shape (n,).

    Few events (or few non-events) scatter too little among replicates. The half width is therefore
    at least that of Clopper and Pearson for the effective number of samples, see
    `trackroller.methods.probability.probabilities`.
    """
    total = np.bincount(member, hits, copies)
    size = np.bincount(member, minlength=copies)
    count = len(hits)
    value = float(hits.mean())
    half = float(jackknife((total.sum() - total) / (size.sum() - size)))
    variance = (half / wide(copies)) ** 2
    gain = value * (1 - value) / max(count * variance, 1e-300)
    low, high = bounds(
        np.array(value), count * np.clip(gain, 1.0, max(1.0, count * min(value, 1 - value)))
    )
    return value, max(half, float(high) - value, value - float(low))


def log_b10(
    lives: np.ndarray, scatter: np.ndarray, member: np.ndarray, copies: int
) -> tuple[float, float]:
    """Return log10 B10 and the half width of its 95 % interval.

    Parameters
    ----------
    lives : lives [any unit], shape (n,); NaN marks a life that does not count, 0 is a body that
        fails at once
    scatter : standard deviation of log10 life of the material itself [1], shape (n,)
    member : replicate of each life, shape (n,)
    copies : number of replicates

    Returns
    -------
    The half width is inf where the data do not bound B10, and 0 where B10 is not limited, or 0, for
    sure.

    Notes
    -----
    The replicates give the interval 0.1 +- h of the share of lives up to B10, and the quantiles at
    both ends are the interval of B10 [1]_. A jackknife of the quantile itself jumps between order
    statistics.

    References
    ----------
    .. [1] Woodruff (1952), J. Am. Stat. Assoc. 47, 635-646
    """
    good = ~np.isnan(lives)
    lives = lives[good]
    scatter = scatter[good]
    member = member[good]
    if len(np.unique(member)) < copies:
        return np.nan, np.inf
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log10(lives)
        value = float(np.log10(b10(lives, scatter)[0]))
        failed = np.where(
            scatter > 0, stats.norm.cdf((value - logs) / np.maximum(scatter, 1e-9)), logs <= value
        )
    failed = np.where(np.isneginf(logs), 1.0, np.where(np.isposinf(logs), 0.0, failed))
    half = share(failed, member, copies)[1]
    if half >= 0.1:
        return value, np.inf
    low, high = np.quantile(logs, [0.1 - half, 0.1 + half], method="inverted_cdf")
    middle = float(np.quantile(logs, 0.1, method="inverted_cdf"))
    if np.isposinf(low) or np.isneginf(high):  # not limited, or 0
        return value, 0.0
    return value, np.inf if np.isneginf(low) else float(max(high - middle, middle - low))
