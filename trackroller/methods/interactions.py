"""Two-factor interactions from any sample of independent factors, by a fitted polynomial (approximate).

The output is fitted with orthonormal functions of each factor (polynomials of its ranks, contrasts of categories) and
their products for each pair. The squared coefficients of the products are the share of variance of the interaction
(polynomial chaos [1]_). The variance that the fit misses cannot be divided. The share that the fit predicts for
held-out rows therefore stands beside the result, and below `TRUSTED` there is no result.

SALib's `hdmr` was measured beside this fit by ``validation/benchmarks/index_estimators.py``: its error is two times
larger, it finds 0.01 to 0.05 where there is no interaction, it needs 300 rows and it takes no categories.

References
----------
.. [1] Sudret (2008), Reliab. Eng. Syst. Saf. 93, 964-979
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from scipy.linalg import lapack

from trackroller.methods.intervals import Z, constant
from trackroller.methods.method import Estimates

TRUSTED = 0.8  # share of variance that a fit must predict
# Degrees of a factor alone and in a product. Each pair contains the next one; the best prediction wins.
DEGREES = ((8, 4), (6, 3), (4, 2), (3, 1), (2, 1))
ROWS_PER_TERM = 2.5
MAX_ROWS = 4096
MAX_KINDS = 8  # categories of a factor
GROUPS = 20  # of the jackknife
NAMES = ("interaction_share", "interaction_share_low", "interaction_share_high")


def pairs(y: np.ndarray, unit: np.ndarray, ordered: np.ndarray, seed: int = 0) -> Estimates:
    """Estimate the share of variance of each two-factor interaction.

    Parameters
    ----------
    y : output, shape (n,), NaN where unusable
    unit : quantiles or list indices of the factors, shape (n, k)
    ordered : for which factors more and less mean something, shape (k,)
    seed : of the jackknife's parts

    Returns
    -------
    interaction_share with _low and _high (95 %, grouped jackknife): shape (k, k), above the diagonal, NaN elsewhere
    and without a trusted fit. fit_alone, shape (k,): share of each factor alone in the same fit. fit_share, shape ():
    share of variance that the fit predicts for held-out rows, NaN without a fit.
    """
    count = unit.shape[1]
    out: Estimates = {name: np.full((count, count), np.nan) for name in NAMES} | {"fit_share": np.array(np.nan)}
    out["fit_alone"] = np.full(count, np.nan)
    good = np.flatnonzero(np.isfinite(y))
    if len(good) > MAX_ROWS:
        good = good[np.linspace(0, len(good) - 1, MAX_ROWS).astype(int)]
    y = y[good]
    unit = unit[good]
    if count < 2 or len(y) < 30 or constant(y):
        return out
    y = (y - y.mean()) / y.std()
    fit = best_fit(y, unit, ordered)
    if fit is None:
        return out
    out["fit_share"] = np.array(max(0.0, fit.share))
    if fit.share < TRUSTED:
        return out
    share, half = _jackknife(y, fit.table, fit.term, seed)
    out["fit_alone"] = share[:count]
    for (i, j), value, wide in zip(combinations(range(count), 2), share[count:], half[count:], strict=True):
        for name, number in zip(NAMES, (value, value - wide, value + wide), strict=True):
            out[name][i, j] = number
    return out


class FittedPolynomial(NamedTuple):
    """The columns of a fitted polynomial, and what it predicts.

    Attributes
    ----------
    share : share of the variance that it predicts for rows that were held out of the fit
    table : columns, shape (n, columns); the first one is the constant
    term : number of the factor or (after the factors) of the pair of each column; -1 for the constant
    """

    share: float
    table: np.ndarray
    term: np.ndarray


def best_fit(
    y: np.ndarray,
    unit: np.ndarray,
    ordered: np.ndarray,
    degrees: Sequence[tuple[int, int]] = DEGREES,
    *,
    ranked: bool = True,
) -> FittedPolynomial | None:
    """Return the polynomial that predicts held-out rows best.

    Parameters
    ----------
    y : output that varies, shape (n,)
    unit : values of the factors, shape (n, k)
    ordered : for which factors more and less mean something, shape (k,)
    degrees : of a factor alone and in a product; each pair contains the next one
    ranked : whether the polynomials are those of the ranks of a factor, not of its values

    Returns
    -------
    None for too few rows, too many categories, or columns that depend on each other.
    """
    columns = _columns(unit, ordered, degrees, ranked)
    if columns is None:
        return None
    missed = held_out(y, columns.table, columns.widths)
    scores = [-np.inf if one is None else float(1 - (one**2).mean() / y.var()) for one in missed]
    best = int(np.argmax(scores))
    if scores[best] == -np.inf:
        return None
    width = columns.widths[best]
    return FittedPolynomial(scores[best], columns.table[:, :width], columns.term[:width])


class _Columns(NamedTuple):
    table: np.ndarray  # shape (n, columns): the columns of the simplest polynomial first
    term: np.ndarray  # number of the factor or (after the factors) of the pair of each column; -1 for the constant
    widths: list[int]  # number of columns of each polynomial of `DEGREES`


def _columns(
    unit: np.ndarray, ordered: np.ndarray, degrees: Sequence[tuple[int, int]], ranked: bool
) -> _Columns | None:
    """Return the columns of the largest polynomial; None if a factor has too many categories."""
    rows, count = unit.shape
    alone, joint = degrees[0]
    polynomials = [orthonormal(unit[:, j], bool(ordered[j]), alone, ranked) for j in range(count)]
    bases = [base for base in polynomials if base is not None]
    if len(bases) < count:
        return None
    degree: list[np.ndarray] = [np.ones(base.shape[1]) for base in bases]
    for place in np.flatnonzero(ordered):
        degree[place] = np.arange(bases[place].shape[1]) + 1
    parts = [(np.ones((rows, 1)), np.zeros(1)), *zip(bases, degree, strict=True)]
    highest = [joint if rising else None for rising in ordered]  # a category has no degrees
    for i, j in combinations(range(count), 2):
        one, other = slice(highest[i]), slice(highest[j])
        product = (bases[i][:, one, None] * bases[j][:, None, other]).reshape(rows, -1)
        parts.append((product, np.maximum.outer(degree[i][one], degree[j][other]).ravel()))
    term = np.repeat(np.arange(len(parts)) - 1, [len(own) for _, own in parts])
    limits = np.array(degrees)[:, (term >= count).astype(int)]
    member = np.concatenate([own for _, own in parts]) <= limits  # shape (polynomials, columns)
    order = np.argsort(-member.sum(axis=0), kind="stable")
    table = np.concatenate([columns for columns, _ in parts], axis=1)
    return _Columns(table[:, order], term[order], [int(columns.sum()) for columns in member])


def held_out(y: np.ndarray, table: np.ndarray, widths: Sequence[int]) -> list[np.ndarray | None]:
    """Return the residuals of linear fits at each row that was held out of the fit.

    Parameters
    ----------
    y : shape (n,) or (n, m)
    table : columns, shape (n, columns)
    widths : each fit takes so many columns, from the first on

    Returns
    -------
    For each width residuals of the shape of `y`; None if the rows are too few or the columns depend on each other.

    Notes
    -----
    One QR decomposition serves every fit, because its first columns are that of the first columns of the table.
    """
    rows = len(y)
    widest = max((width for width in widths if rows >= ROWS_PER_TERM * width), default=0)
    basis, triangle = np.linalg.qr(table[:, :widest])
    dependent = np.abs(np.diag(triangle)) < 1e-8 * rows**0.5
    projected = basis.T @ y

    def residual(width: int) -> np.ndarray | None:
        if width > widest or dependent[:width].any():
            return None
        part = basis[:, :width]
        lever = np.einsum("ij,ij->i", part, part).reshape(-1, *[1] * (y.ndim - 1))
        return np.asarray((y - part @ projected[:width]) / np.maximum(1e-9, 1 - lever))

    return [residual(width) for width in widths]


def orthonormal(x: np.ndarray, ordered: bool, degree: int, ranked: bool = True) -> np.ndarray | None:
    """Return functions of a factor with mean 0, mean square 1 and no correlation; None for too many categories.

    They are polynomials of the ranks of the factor, or of its values.
    """
    values, index = np.unique(x, return_inverse=True)
    if ordered:
        place = (np.cumsum(np.bincount(index)) - 0.5 * np.bincount(index)) / len(x)
        if not ranked:
            place = (values - values[0]) / np.ptp(values)
        raw = np.polynomial.legendre.legvander(2 * place[index] - 1, min(degree, len(values) - 1))
    elif len(values) > MAX_KINDS:
        return None
    else:
        raw = np.column_stack([np.ones(len(x)), *(index == i for i in range(1, len(values)))]).astype(float)
    return np.asarray(np.linalg.qr(raw)[0][:, 1:] * len(x) ** 0.5)


def _jackknife(y: np.ndarray, table: np.ndarray, term: np.ndarray, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the share of variance of each term and its half width (95 %) by a grouped jackknife.

    The normal equations of all rows less those of a group are the normal equations without the group.
    """
    part = np.random.default_rng(seed).permutation(len(y)) % GROUPS
    gram = np.zeros((GROUPS, *[table.shape[1]] * 2))
    moment = np.zeros((GROUPS, table.shape[1]))
    for g in range(GROUPS):
        group = table[part == g]
        gram[g] = group.T @ group
        moment[g] = group.T @ y[part == g]
    square = np.bincount(part, y**2, GROUPS)
    rows = np.bincount(part, minlength=GROUPS)
    whole = gram.sum(axis=0), moment.sum(axis=0), square.sum(), rows.sum()
    share = _shares(*whole, term=term)
    sums = (gram, moment, square, rows)
    without_one = np.array(
        [_shares(*(a - b[g] for a, b in zip(whole, sums, strict=True)), term=term) for g in range(GROUPS)]
    )
    without_one = without_one[np.isfinite(without_one).all(axis=1)]
    if len(without_one) > 1:
        spread = ((without_one - without_one.mean(axis=0)) ** 2).sum(axis=0)
    else:
        spread = np.full_like(share, np.nan)
    return share, Z * np.sqrt((len(without_one) - 1) / max(1, len(without_one)) * spread)


def _shares(gram: np.ndarray, moment: np.ndarray, square: float, rows: int, *, term: np.ndarray) -> np.ndarray:
    """Return the share of variance of each term: its squared coefficients less their expected sampling error.

    `gram`, `moment` and `square` are the products of the columns with each other, of the columns with y and of y with
    itself. NaN if the columns depend on each other.
    """
    factor, failed = lapack.dpotrf(gram)
    if failed or np.diag(factor).min() < 1e-6 * rows**0.5:
        return np.full(int(term.max()) + 1, np.nan)
    coefficient = lapack.dpotrs(factor, moment)[0]
    error = np.diag(lapack.dpotri(factor)[0]) * (square - moment @ coefficient) / max(1, rows - len(term))
    variance = square / rows - (moment[0] / rows) ** 2  # the first column is the constant
    return np.asarray(np.bincount(term + 1, coefficient**2 - error)[1:] / variance)
