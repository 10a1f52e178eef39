"""Two-factor interactions from any sample of independent factors, by a fitted polynomial (approximate).

The output is fitted with orthonormal functions of each factor (polynomials of its ranks, contrasts of categories) and
their products for each pair. The squared coefficients of the products are the share of variance of the interaction
(polynomial chaos [1]_). The variance that the fit misses cannot be divided. The share that the fit predicts for
held-out rows therefore stands beside the result, and below `TRUSTED` there is no result.

SALib's `hdmr` was measured beside this fit by ``validation/index_estimators.py``: its error is two times larger, it
finds 0.01 to 0.05 where there is no interaction, it needs 300 rows and it takes no categories.

References
----------
.. [1] Sudret (2008), Reliab. Eng. Syst. Saf. 93, 964-979
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from trackroller.analysis.indices import Estimates, Z, constant

TRUSTED = 0.8  # share of variance that a fit must predict
DEGREES = ((8, 4), (6, 3), (4, 2), (3, 1), (2, 1))  # of a factor alone and in a product; the best prediction wins
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
    y, unit = y[good], unit[good]
    if count < 2 or len(y) < 30 or constant(y):
        return out
    y = (y - y.mean()) / y.std()
    fits = [fit for degrees in DEGREES if (fit := _fit(y, unit, ordered, degrees)) is not None]
    if not fits:
        return out
    best = max(fits, key=lambda fit: fit.predicted)
    out["fit_share"] = np.array(max(0.0, best.predicted))
    if best.predicted < TRUSTED:
        return out
    share = _shares(y, best.columns, best.term)
    part = np.random.default_rng(seed).permutation(len(y)) % GROUPS
    left = np.array([_shares(y[part != g], best.columns[part != g], best.term) for g in range(GROUPS)])
    half = Z * np.sqrt((GROUPS - 1) / GROUPS * ((left - left.mean(axis=0)) ** 2).sum(axis=0))
    out["fit_alone"] = share[:count]
    for (i, j), value, wide in zip(combinations(range(count), 2), share[count:], half[count:], strict=True):
        for name, number in zip(NAMES, (value, value - wide, value + wide), strict=True):
            out[name][i, j] = number
    return out


class _Fit(NamedTuple):
    columns: np.ndarray  # shape (n, columns)
    term: np.ndarray  # number of the factor or (after the factors) of the pair of each column; -1 for the constant
    predicted: float  # share of variance of held-out rows


def _fit(y: np.ndarray, unit: np.ndarray, ordered: np.ndarray, degrees: tuple[int, int]) -> _Fit | None:
    """Fit the polynomial; None if the sample is too small or a factor has too many categories."""
    alone, joint = degrees
    found = [orthonormal(unit[:, j], bool(ordered[j]), alone) for j in range(unit.shape[1])]
    bases = [base for base in found if base is not None]
    if len(bases) < len(found):
        return None
    columns = [np.ones((len(y), 1)), *bases]
    for i, j in combinations(range(len(bases)), 2):
        one, other = (bases[p][:, :joint] if ordered[p] else bases[p] for p in (i, j))
        columns.append((one[:, :, None] * other[:, None, :]).reshape(len(y), -1))
    term = np.repeat(np.arange(len(columns)) - 1, [part.shape[1] for part in columns])
    table = np.concatenate(columns, axis=1)
    missed = held_out(y, table)
    return None if missed is None else _Fit(table, term, float(1 - (missed**2).mean()))


def held_out(y: np.ndarray, table: np.ndarray) -> np.ndarray | None:
    """Return the residual of a linear fit at each row that was held out of the fit.

    Parameters
    ----------
    y : shape (n,) or (n, m)
    table : columns of the fit, shape (n, columns)

    Returns
    -------
    Residuals of the shape of `y`; None if the rows are too few or the columns depend on each other.
    """
    if len(y) < ROWS_PER_TERM * table.shape[1]:
        return None
    basis, triangle = np.linalg.qr(table)
    if np.abs(np.diag(triangle)).min() < 1e-8 * len(y) ** 0.5:
        return None
    lever = (basis**2).sum(axis=1).reshape(-1, *[1] * (y.ndim - 1))
    return np.asarray((y - basis @ (basis.T @ y)) / np.maximum(1e-9, 1 - lever))


def orthonormal(x: np.ndarray, ordered: bool, degree: int) -> np.ndarray | None:
    """Return functions of a factor with mean 0, mean square 1 and no correlation; None for too many categories."""
    values, index = np.unique(x, return_inverse=True)
    if ordered:
        place = (np.cumsum(np.bincount(index)) - 0.5 * np.bincount(index)) / len(x)
        raw = np.polynomial.legendre.legvander(2 * place[index] - 1, min(degree, len(values) - 1))
    elif len(values) > MAX_KINDS:
        return None
    else:
        raw = np.column_stack([np.ones(len(x)), *(index == i for i in range(1, len(values)))]).astype(float)
    return np.asarray(np.linalg.qr(raw)[0][:, 1:] * len(x) ** 0.5)


def _shares(y: np.ndarray, table: np.ndarray, term: np.ndarray) -> np.ndarray:
    """Return the share of variance of each term: its squared coefficients less their expected sampling error."""
    inverse = np.linalg.pinv(table.T @ table)
    found = inverse @ (table.T @ y)
    rest = float(((y - table @ found) ** 2).sum() / max(1, len(y) - len(term)))
    squares = found**2 - rest * np.diag(inverse)
    return np.array([squares[term == p].sum() for p in range(int(term.max()) + 1)]) / y.var()
