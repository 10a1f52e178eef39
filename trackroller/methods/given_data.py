"""Sensitivity measures from given data: valid for any sample of independent factors, also where cases failed.

First-order shares of variance, delta with the level that chance alone reaches, partial rank correlations. Of a sample
with independent replicates, the first-order index is the sum of squares of c_m = E[y phi_m(x)] over orthonormal
functions phi_m. Its estimate multiplies coefficients of different replicates only, which makes it free of bias (a
U-statistic, Hoeffding (1948), Ann. Math. Statist. 19, 293-325).
"""

from __future__ import annotations

import numpy as np
from SALib.analyze import rbd_fast
from scipy.stats import rankdata

from trackroller.methods import convergence
from trackroller.methods.delta import delta
from trackroller.methods.interactions import pairs
from trackroller.methods.intervals import Z, constant
from trackroller.methods.method import Design, Estimated, Estimates, spread
from trackroller.methods.replicates import wide

MIN_ROWS = 30
GROUPS = 20  # of the grouped jackknife
HARMONICS = 10  # of RBD-FAST: SALib's number
ROWS_PER_HARMONIC = 16  # fewer harmonics for small samples
ROWS_PER_LEVEL = 10  # of a column whose means are taken out before RBD-FAST: fewer would take much of the rest out
DEPENDENT = 0.05  # share of the variance of a factor between the levels of a column, from which on the two depend
ROUNDING = 1e-12  # share of variance
FAST_RESAMPLES = 32  # of the bootstrap
FAST_ROWS = 4096
RARE_ROWS = 40  # rows of the bootstrap with a rare value
ROWS_PER_COSINE = 32  # of a factor, for replicates
COSINES = (4, 64)  # fewest and most of them
MEASURES = {
    "first": ("first", "first_low", "first_high"),
    "delta": ("delta", "delta_low", "delta_high", "delta_noise"),
    "prcc": ("prcc", "prcc_low", "prcc_high"),
}


def given_data(y: np.ndarray, unit: np.ndarray, ordered: np.ndarray, seed: int = 0) -> Estimates:
    """Estimate the given-data measures of one output.

    Parameters
    ----------
    y : output, shape (n,), NaN where unusable: such rows are left out
    unit : quantiles or list indices of the factors, shape (n, k)
    ordered : for which factors more and less mean something, shape (k,); the others have no rank correlation
    seed : of all random numbers

    Returns
    -------
    first (share of variance Var(E[y|x]) / V), delta and prcc, each with _low and _high, shape (k,); delta_noise, the
    value below which an inert factor stays in 95 % of cases; rows_used, shape (). NaN for a
    factor that does not vary, and everywhere if fewer than 30 rows are usable.

    Notes
    -----
    If rows are left out, every measure describes the remaining rows only.
    """
    good = np.isfinite(y)
    y = y[good]
    unit = unit[good]
    out: Estimates = {name: np.full(unit.shape[1], np.nan) for names in MEASURES.values() for name in names}
    out["rows_used"] = np.array(len(y))
    if len(y) < MIN_ROWS or constant(y):
        return out
    out |= firsts(y, unit, ordered, seed)
    out |= dict(zip(MEASURES["prcc"], prcc(y, unit, ordered), strict=True))
    for j in np.flatnonzero(np.ptp(unit, axis=0) > 0):
        for name, value in zip(MEASURES["delta"], delta(y, unit[:, j], bool(ordered[j]), seed), strict=True):
            out[name][j] = value
    return out


def firsts(y: np.ndarray, unit: np.ndarray, ordered: np.ndarray, seed: int = 0) -> Estimates:
    """Estimate the first-order share of variance of each factor.

    Parameters
    ----------
    y, unit, ordered, seed : as in `given_data`

    Returns
    -------
    first, first_low, first_high, each shape (k,). NaN as in `given_data`.

    Notes
    -----
    Continuous factors: RBD-FAST of SALib [1]_ with the bias correction of Tissot & Prieur, on the output without the
    means of the categories: in a Sobol sequence a column of few levels may repeat at a frequency of the estimator, and
    its effect would count for the factor. SALib's bootstrap draws half of the rows, so its half width is scaled by
    sqrt(1/2) (m out of n bootstrap [2]_). The bootstrap of a long sample takes 4096 of its rows, more for a rare event,
    and its half width is scaled by one over the root of the rows. For an inert factor the true half width falls faster,
    as one over the rows; the interval is then too wide.
    Categories and columns whose values repeat: `first_order` of the groups, because RBD-FAST orders equal values by
    their rows. It is biased for a category (0.88 for a share of 0.96), and in a table with the rows of a grid it
    takes other factors for this one (0.63 for a share of 0.004).
    ``validation/benchmarks/index_estimators.py`` compares both.

    References
    ----------
    .. [1] Tarantola, Gatelli & Mara (2006), Reliab. Eng. Syst. Saf. 91, 717-727; Plischke (2010), Reliab. Eng. Syst.
       Saf. 95, 354-360
    .. [2] Bickel, Goetze & van Zwet (1997), Statistica Sinica 7, 1-31
    """
    good = np.isfinite(y)
    y = y[good]
    unit = unit[good]
    count = unit.shape[1]
    out = {name: np.full(count, np.nan) for name in MEASURES["first"]}
    if len(y) < MIN_ROWS or constant(y):
        return out
    unlike = int((y != np.median(y)).sum())  # few if the output is 1 where a rare event occurs
    most = max(FAST_ROWS, RARE_ROWS * len(y) // max(1, unlike))
    some = np.linspace(0, len(y) - 1, min(len(y), most)).astype(int)
    varied = [(j, *np.unique(unit[:, j], return_inverse=True)) for j in np.flatnonzero(np.ptp(unit, axis=0) > 0)]
    categories = [group for _, values, group in varied if ROWS_PER_LEVEL * len(values) <= len(y)]
    for j, values, group in varied:
        x = unit[:, j]
        if ordered[j] and 2 * len(values) > len(x):
            remainder, share, error = _without(y, categories, x)
            if share < ROUNDING:
                out["first"][j] = out["first_low"][j] = out["first_high"][j] = 0.0
                continue
            harmonics = max(2, min(HARMONICS, len(y) // ROWS_PER_HARMONIC))
            plain = rbd_fast.compute_first_order(rbd_fast.permute_outputs(x, remainder), harmonics)
            value = share * float(rbd_fast.unskew_S1(plain, harmonics, len(y)))
            rng = np.random.default_rng(seed)
            with np.errstate(invalid="ignore"):  # a resample may miss a rare event altogether
                spread = rbd_fast.bootstrap(x[some], remainder[some], harmonics, FAST_RESAMPLES, 0.95, rng)
            half = np.hypot(share * float(spread) * (0.5 * len(some) / len(y)) ** 0.5, Z * error * value / share)
        else:
            value, error = first_order(y, group, seed)
            half = Z * error
        out["first"][j] = value
        out["first_low"][j] = value - half
        out["first_high"][j] = value + half
    return out


def _without(y: np.ndarray, categories: list[np.ndarray], x: np.ndarray) -> tuple[np.ndarray, float, float]:
    """Return an output without the means of categories, and the share of the variance that is left, with its error.

    The means of a category that depends on the factor x stay: they hold influence of the factor.
    """
    remainder = y
    lost = 0
    error = 0.0
    for group in categories:
        count = np.bincount(group)
        if first_order(x, group)[0] < DEPENDENT:
            remainder = remainder - (np.bincount(group, remainder) / count)[group]
            lost = lost + len(count) - 1
            error = np.hypot(error, first_order(y, group)[1])
    return remainder, float(remainder.var() / y.var() * len(y) / (len(y) - lost)), float(error)


def first_order(y: np.ndarray, group: np.ndarray, seed: int = 0) -> tuple[float, float]:
    """Estimate the share of variance between groups.

    Parameters
    ----------
    y : output, shape (n,), finite
    group : group of each row, shape (n,)
    seed : of the jackknife's parts

    Returns
    -------
    Epsilon squared (Kelley 1935, Proc. Natl. Acad. Sci. 21, 554-559), which is free of the bias of the plain ratio,
    and its standard error by a grouped jackknife; NaN where each group is one row.
    """
    count = int(group.max()) + 1
    part = np.random.default_rng(seed).permutation(len(y)) % GROUPS
    y = (y - y.mean()) / y.std()
    cell = part * count + group
    sums = np.stack([np.bincount(cell, w, GROUPS * count).reshape(GROUPS, count) for w in (np.ones_like(y), y)])
    square = np.bincount(part, y**2, GROUPS)
    total = sums.sum(axis=1)
    total_square = square.sum()
    value = _epsilon(total, np.asarray(total_square))
    without_one = _epsilon(total[:, None, :] - sums, total_square - square)
    error = np.sqrt((GROUPS - 1) / GROUPS * ((without_one - without_one.mean()) ** 2).sum())
    return float(value), float(error)


def _epsilon(sums: np.ndarray, square: np.ndarray) -> np.ndarray:
    """Return epsilon squared from counts and sums of groups, shape (2, ..., groups), and sums of squares (...)."""
    number, total = sums
    rows = number.sum(axis=-1)
    filled = (number > 0).sum(axis=-1)
    mean = total.sum(axis=-1) / rows
    whole = square - rows * mean**2
    between = (total**2 / np.maximum(number, 1)).sum(axis=-1) - rows * mean**2
    free = np.where(rows > filled, rows - filled, np.nan)  # groups of one row each tell nothing of the rest
    return np.asarray(1 - (whole - between) / free * (rows - 1) / whole)


def prcc(y: np.ndarray, unit: np.ndarray, ordered: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Estimate partial rank correlation coefficients.

    Parameters
    ----------
    y, unit, ordered : as in `given_data`, without unusable rows

    Returns
    -------
    Value, low and high (Fisher's interval), each shape (k,). NaN for a factor without an order; its influence is
    still taken out of the other coefficients.

    Notes
    -----
    Valid for monotonic influence. SALib has no such measure.
    """
    count = unit.shape[1]
    columns = []
    factor = []
    for j in range(count):
        if np.ptp(unit[:, j]) == 0:
            continue
        if ordered[j]:
            columns.append(rankdata(unit[:, j]))
            factor.append(j)
        else:
            levels = np.unique(unit[:, j])[1:]
            columns += [(unit[:, j] == level).astype(float) for level in levels]
            factor += [-1] * len(levels)
    table = np.stack([*columns, rankdata(y)], axis=1)
    table = (table - table.mean(axis=0)) / table.std(axis=0)
    precision = np.linalg.pinv(table.T @ table / len(y))
    value, low, high = (np.full(count, np.nan) for _ in range(3))
    for p, j in enumerate(factor):
        if j < 0:
            continue
        root = np.sqrt(abs(precision[p, p] * precision[-1, -1]))
        if root > 0:
            value[j] = np.clip(-precision[p, -1] / root, -1, 1)
        else:
            value[j] = np.nan
        half = Z / np.sqrt(max(1, len(y) - len(columns) - 2))
        middle = np.arctanh(np.clip(value[j], -1 + 1e-12, 1 - 1e-12))
        low[j], high[j] = np.tanh(middle - half), np.tanh(middle + half)
    return value, low, high


def measures(y: np.ndarray, design: Design, tied: bool) -> Estimated:
    """Return the measures of a sample, the course of its first-order shares, and its interactions.

    Parameters
    ----------
    y : output, shape (n,), NaN where unusable
    design : the rows
    tied : whether factors are correlated, so that no interactions can be given
    """
    ordered = design.ordered
    places = design.places
    out = given_data(y, places, ordered)
    if len(design.factors) > 1 and not tied:
        out |= pairs(y, places, ordered)
    at = convergence.sizes(len(y), smallest=64)

    def part(n: int) -> Estimates:
        every = max(1, len(y) // n)  # the first rows of a table may be sorted, so take every so many rows
        return firsts(y[::every], places[::every], ordered)

    out |= convergence.course(part, at, out, ("first",))
    return Estimated(out, int(out.pop("rows_used")), len(y), at)


def firsts_within(y: np.ndarray, design: Design, place: int, inside: np.ndarray) -> Estimates:
    """Return the first-order shares of all other factors among the rows `inside` a level of a category."""
    rows = inside & np.isfinite(y)
    shares = firsts(y[rows], np.delete(design.places[rows], place, axis=1), np.delete(design.ordered, place))
    out: Estimates = {"conditional_rows": np.array(rows.sum())}
    return out | {f"conditional_S1{end}": spread(shares[f"first{end}"], place) for end in ("", "_low", "_high")}


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
    The functions of a continuous factor are cosines of its rank, up to one for each `ROWS_PER_COSINE` rows; those of
    a list mark its values. The variance of the U-statistic is that of its projections (rows of the kernel) and of the
    remainder; a plain jackknife would count the remainder twice for an inert factor.
    """
    good = np.isfinite(y)
    y = y[good]
    unit = unit[good]
    member = member[good]
    value = np.full(unit.shape[1], np.nan)
    half = np.full(unit.shape[1], np.nan)
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
        half[j] = wide(copies) * _deviation(kernel)
    return value, half


def _functions(x: np.ndarray, ordered: bool) -> np.ndarray:
    """Return orthonormal functions of a factor at its rows, shape (functions, n)."""
    values, group = np.unique(x, return_inverse=True)
    if not ordered or 2 * len(values) <= len(x):
        share = np.bincount(group) / len(x)
        marks = group == np.arange(len(values))[:, None]
        return np.asarray((marks - share[:, None]) / np.sqrt(share[:, None]))
    count = int(np.clip(len(x) // ROWS_PER_COSINE, *COSINES))
    place = (rankdata(x) - 0.5) / len(x)
    return np.asarray(np.sqrt(2) * np.cos(np.pi * np.arange(1, count + 1)[:, None] * place))


def _deviation(kernel: np.ndarray) -> float:
    """Return the standard deviation of a U-statistic: the mean of a symmetric kernel over pairs of replicates.

    By Hoeffding's decomposition, an entry is the mean, plus an effect of each of both replicates, plus a rest without
    effects. `jackknifed` is the variance by the effects, which holds the rest twice; `least` is that by the rest alone.

    References
    ----------
    Efron and Stein (1981): The jackknife estimate of variance. Ann. Statist. 9, 586–596.
    """
    count = len(kernel)
    off = ~np.eye(count, dtype=bool)
    rows = np.where(off, kernel, 0.0).sum(axis=1) / (count - 1)
    effect = (count - 1) / (count - 2) * (rows - rows.mean())
    residuals = (kernel - rows.mean() - effect[:, None] - effect)[off]
    remainder = (residuals**2).sum() / (count * (count - 3))
    jackknifed = 4 * (count - 1) / (count * (count - 2) ** 2) * ((rows - rows.mean()) ** 2).sum()
    least = 2 * remainder / (count * (count - 1))
    return float(np.sqrt(max(jackknifed - 4 * remainder / (count * (count - 2)) + least, least)))
