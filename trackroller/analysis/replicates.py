"""Intervals from independent replicates of a design: whole Sobol sequences or Saltelli designs.

A bootstrap of rows takes them as independent, so it misses the gain of a low-discrepancy sequence. The replicates of a
study with the key `until` are independent, whatever their rows have in common, so their scatter gives the intervals:
a jackknife that leaves out one replicate at a time [1]_, with Student's t.

The first-order index of given data is the sum of squares of c_m = E[y phi_m(x)] over orthonormal functions phi_m. Its
estimate multiplies coefficients of different replicates only, which makes it free of bias (a U-statistic [2]_).

References
----------
.. [1] Owen (2013), Monte Carlo theory, methods and examples, chapters 2 and 17
.. [2] Hoeffding (1948), Ann. Math. Statist. 19, 293-325
"""

from __future__ import annotations

import numpy as np
from scipy.stats import norm, rankdata, t

from trackroller.analysis import indices
from trackroller.analysis.indices import Estimates, constant
from trackroller.analysis.probability import bounds
from trackroller.analysis.robustness import b10
from trackroller.analysis.sobol import closed_indices
from trackroller.study.design.sampling import SampledDesign

# ASSUME: choosing the moment to stop by the width itself makes intervals too narrow by at most this factor; measured by
# validation/benchmarks/until_sure.py
WIDER = 1.15
ROWS_PER_HARMONIC, HARMONICS = 32, (4, 64)  # fewest and most cosines of a factor
HEADLINES = {"saltelli": ("S1", "ST"), "morris": ("mu_star",), "sobol": ("first",)}


def jackknife(left: np.ndarray) -> np.ndarray:
    """Return the half width of the 95 % interval of a mean or a smooth function of means.

    Parameters
    ----------
    left : estimates without one replicate each, shape (replicates, ...)

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
    count = len(left)
    variance = (count - 1) / count * ((left - left.mean(axis=0)) ** 2).sum(axis=0)
    return np.asarray(WIDER * t.ppf(0.975, count - 1) * np.sqrt(variance))


def replicated(y: np.ndarray, design: SampledDesign, samples: int) -> Estimates:
    """Estimate the headline indices of the first samples of a design with intervals from its replicates.

    Parameters
    ----------
    y : output, shape (n,), NaN where unusable
    design : Saltelli, Morris or Sobol design with replicates
    samples : number of base samples, trajectories or rows, a multiple of the replicates

    Returns
    -------
    S1 and ST (saltelli), mu_star (morris) or first (sobol), each with _low and _high, shape (k,); NaN if too few
    rows are usable or the output is constant.
    """
    copies, count = int(design.meta["replicates"]), len(design.factors)
    rows = len(y) // design.samples
    y, unit = y[: samples * rows], design.places[: samples * rows]
    member = np.arange(samples) % copies
    if design.method == "saltelli":
        values, half = _saltelli(y.reshape(samples, rows), count, bool(design.meta["second_order"]), member, copies)
    elif design.method == "morris":
        values, half = _morris(y, unit, design.listed, member, copies)
    else:
        values, half = first_indices(y, unit, design.ordered, member, copies)
    out: Estimates = {}
    for i, name in enumerate(HEADLINES[design.method]):
        value, wide = (part[i * count : (i + 1) * count] for part in (values, half))
        out |= {name: value, f"{name}_low": value - wide, f"{name}_high": value + wide}
    return out


def _saltelli(
    block: np.ndarray, count: int, second: bool, member: np.ndarray, copies: int
) -> tuple[np.ndarray, np.ndarray]:
    good = np.isfinite(block).all(axis=1)
    keep = (member[good] != np.arange(copies)[:, None]).astype(float)
    whole, single = (1 << count) - 1, [1 << j for j in range(count)]
    with np.errstate(invalid="ignore", divide="ignore"):
        weights = keep / keep.sum(axis=1, keepdims=True)
    drawn = closed_indices(block[good], count, second, [*single, *(whole ^ j for j in single)], weights=weights)
    drawn[:, count:] = 1 - drawn[:, count:]
    return drawn[0], jackknife(drawn[1:])


def _morris(
    y: np.ndarray, unit: np.ndarray, listed: np.ndarray, member: np.ndarray, copies: int
) -> tuple[np.ndarray, np.ndarray]:
    if constant(y):
        return (np.full(unit.shape[1], np.nan),) * 2
    effect = np.abs(indices.elementary_effects(y, unit, listed))
    filled, good = np.nan_to_num(effect), np.isfinite(effect).astype(float)
    keep = (member != np.arange(copies)[:, None]).astype(float)
    with np.errstate(invalid="ignore", divide="ignore"):
        return filled.sum(axis=0) / good.sum(axis=0), jackknife((keep @ filled) / (keep @ good))


def first_indices(
    y: np.ndarray, unit: np.ndarray, ordered: np.ndarray, member: np.ndarray, copies: int
) -> tuple[np.ndarray, np.ndarray]:
    """Estimate the first-order share of variance of each factor from products of different replicates.

    Parameters
    ----------
    y : output, shape (n,), NaN where unusable
    unit : quantiles or list indices, shape (n, k)
    ordered : for which factors more and less mean something, shape (k,)
    member : replicate of each row, shape (n,)
    copies : number of replicates

    Returns
    -------
    Var(E[y | x_j]) / V and the half width of its 95 % interval, each of shape (k,). NaN for a factor that does not
    vary, and if a replicate has fewer than two usable rows.

    Notes
    -----
    The functions of a continuous factor are cosines of its rank, up to one for each `ROWS_PER_HARMONIC` rows; those of
    a list mark its values. The variance of the U-statistic is that of its projections (rows of the kernel) and of the
    remainder; a plain jackknife would count the remainder twice for an inert factor.
    """
    good = np.isfinite(y)
    y, unit, member = y[good], unit[good], member[good]
    value, half = np.full(unit.shape[1], np.nan), np.full(unit.shape[1], np.nan)
    size = np.bincount(member, minlength=copies).astype(float)
    if (size < 2).any() or constant(y):
        return value, half
    y = y - y.mean()
    spread = np.bincount(member, y * y, copies) / size
    whole = float(spread.mean())
    for j in np.flatnonzero(np.ptp(unit, axis=0) > 0):
        functions = _functions(unit[:, j], bool(ordered[j]))
        means = np.stack([np.bincount(member, y * phi, copies) for phi in functions], axis=1) / size[:, None]
        kernel = means @ means.T / whole
        value[j] = kernel[~np.eye(copies, dtype=bool)].mean()
        kernel -= value[j] * (spread[:, None] + spread) / (2 * whole)  # the variance is estimated, too
        half[j] = WIDER * t.ppf(0.975, copies - 1) * _deviation(kernel)
    return value, half


def _functions(x: np.ndarray, ordered: bool) -> np.ndarray:
    """Return orthonormal functions of a factor at its rows, shape (functions, n)."""
    values, group = np.unique(x, return_inverse=True)
    if not ordered or 2 * len(values) <= len(x):
        share = np.bincount(group) / len(x)
        marks = group == np.arange(len(values))[:, None]
        return np.asarray((marks - share[:, None]) / np.sqrt(share[:, None]))
    count = int(np.clip(len(x) // ROWS_PER_HARMONIC, *HARMONICS))
    place = (rankdata(x) - 0.5) / len(x)
    return np.asarray(np.sqrt(2) * np.cos(np.pi * np.arange(1, count + 1)[:, None] * place))


def _deviation(kernel: np.ndarray) -> float:
    """Return the standard deviation of the mean of a symmetric kernel over pairs of different replicates."""
    count = len(kernel)
    off = ~np.eye(count, dtype=bool)
    rows = np.where(off, kernel, 0.0).sum(axis=1) / (count - 1)
    effect = (count - 1) / (count - 2) * (rows - rows.mean())
    rest = (kernel - rows.mean() - effect[:, None] - effect)[off]
    remainder = (rest**2).sum() / (count * (count - 3))
    jackknifed = 4 * (count - 1) / (count * (count - 2) ** 2) * ((rows - rows.mean()) ** 2).sum()
    least = 2 * remainder / (count * (count - 1))
    return float(np.sqrt(max(jackknifed - 4 * remainder / (count * (count - 2)) + least, least)))


def share(hits: np.ndarray, member: np.ndarray, copies: int) -> tuple[float, float]:
    """Return a probability and the half width of its 95 % interval; `hits` 0 to 1 and `member` have the shape (n,).

    Few events (or few non-events) scatter too little among replicates. The half width is therefore at least that of
    Clopper and Pearson for the effective number of samples, see `trackroller.analysis.probability.probabilities`.
    """
    total, size = np.bincount(member, hits, copies), np.bincount(member, minlength=copies)
    count, value = len(hits), float(hits.mean())
    wide = float(jackknife((total.sum() - total) / (size.sum() - size)))
    variance = (wide / (WIDER * t.ppf(0.975, copies - 1))) ** 2
    gain = value * (1 - value) / max(count * variance, 1e-300)
    low, high = bounds(np.array(value), count * np.clip(gain, 1.0, max(1.0, count * min(value, 1 - value))))
    return value, max(wide, float(high) - value, value - float(low))


def log_b10(lives: np.ndarray, scatter: np.ndarray, member: np.ndarray, copies: int) -> tuple[float, float]:
    """Return log10 B10 and the half width of its 95 % interval.

    Parameters
    ----------
    lives : lives [any unit], shape (n,); NaN marks a life that does not count
    scatter : standard deviation of log10 life of the material itself [1], shape (n,)
    member : replicate of each life, shape (n,)
    copies : number of replicates

    Returns
    -------
    The half width is inf where the data do not bound B10, and 0 where B10 is not limited for sure.

    Notes
    -----
    The replicates give the interval 0.1 +- h of the share of lives up to B10, and the quantiles at both ends are the
    interval of B10 [1]_. A jackknife of the quantile itself jumps between order statistics.

    References
    ----------
    .. [1] Woodruff (1952), J. Am. Stat. Assoc. 47, 635-646
    """
    good = ~np.isnan(lives)
    lives, scatter, member = lives[good], scatter[good], member[good]
    if len(np.unique(member)) < copies:
        return np.nan, np.inf
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log10(lives)
        value = float(np.log10(b10(lives, scatter)[0]))
        failed = np.where(scatter > 0, norm.cdf((value - logs) / np.maximum(scatter, 1e-9)), logs <= value)
    wide = share(np.where(np.isinf(logs), 0.0, failed), member, copies)[1]
    if wide >= 0.1:
        return value, np.inf
    low, high = np.quantile(logs, [0.1 - wide, 0.1 + wide], method="inverted_cdf")
    middle = float(np.quantile(logs, 0.1, method="inverted_cdf"))
    return value, 0.0 if np.isinf(low) else float(max(high - middle, middle - low))
