"""Two-factor interactions from any sample of independent factors, by a polynomial fitted to it: approximate.

The output is fitted with orthonormal functions of each factor (polynomials of its ranks, contrasts of categories) and
their products for each pair; the squares of the products' coefficients are the pair's part of the variance
(polynomial chaos: Sudret 2008, Reliab. Eng. Syst. Saf. 93, 964-979). What it cannot fit it cannot divide, so the share
of variance it predicts for rows left out of the fit stands beside, and below `TRUSTED` nothing is said.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from trackroller.analysis.indices import Estimates, Z, constant

TRUSTED = 0.8  # share of variance predicted from which on the pairs are told
DEGREES = ((8, 4), (6, 3), (4, 2), (3, 1), (2, 1))  # of a factor alone and in a product: the fit that predicts best
ROWS_PER_TERM = 2.5
MAX_ROWS = 4096
MAX_KINDS = 8  # categories of a factor
GROUPS = 20  # of the jackknife
NAMES = ("interaction_share", "interaction_share_low", "interaction_share_high")


def pairs(y: np.ndarray, unit: np.ndarray, ordered: np.ndarray, seed: int = 0) -> Estimates:
    """Share of the variance that two factors explain together beyond the sum of both.

    Parameters
    ----------
    y : output, shape (n,), NaN where unusable
    unit : quantiles or list indices of the factors, shape (n, k)
    ordered : for which factors more and less mean something, shape (k,)

    Returns
    -------
    interaction_share, interaction_share_low, interaction_share_high: shape (k, k), above the diagonal, NaN elsewhere
    and where no trusted fit is found; 95 % intervals by a grouped jackknife. fit_alone, shape (k,): share of each
    factor alone in the same fit. fit_share: share of variance that the fit predicts for rows left out of it (NaN
    without one).
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
    table, owner, predicted = max(fits, key=lambda fit: fit[2])
    out["fit_share"] = np.array(max(0.0, predicted))
    if predicted < TRUSTED:
        return out
    share = _shares(y, table, owner)
    part = np.random.default_rng(seed).permutation(len(y)) % GROUPS
    left = np.array([_shares(y[part != g], table[part != g], owner) for g in range(GROUPS)])
    half = Z * np.sqrt((GROUPS - 1) / GROUPS * ((left - left.mean(axis=0)) ** 2).sum(axis=0))
    out["fit_alone"] = share[:count]
    for (i, j), value, wide in zip(combinations(range(count), 2), share[count:], half[count:], strict=True):
        for name, number in zip(NAMES, (value, value - wide, value + wide), strict=True):
            out[name][i, j] = number
    return out


def _fit(
    y: np.ndarray, unit: np.ndarray, ordered: np.ndarray, degrees: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray, float] | None:
    """Columns, the factor or (after the factors) the pair each belongs to, and the predicted share of variance."""
    alone, joint = degrees
    found = [_functions(unit[:, j], bool(ordered[j]), alone) for j in range(unit.shape[1])]
    bases = [base for base in found if base is not None]
    if len(bases) < len(found):
        return None
    columns: list[np.ndarray]
    owner: list[int]
    columns, owner = [np.ones((len(y), 1)), *bases], [-1]
    for j, base in enumerate(bases):
        owner += [j] * base.shape[1]
    for number, (i, j) in enumerate(combinations(range(len(bases)), 2), start=len(bases)):
        few = [b if not ordered[p] else b[:, :joint] for p, b in ((i, bases[i]), (j, bases[j]))]
        both = (few[0][:, :, None] * few[1][:, None, :]).reshape(len(y), -1)
        columns.append(both)
        owner += [number] * both.shape[1]
    if len(y) < ROWS_PER_TERM * len(owner):
        return None
    table = np.concatenate(columns, axis=1)
    basis, triangle = np.linalg.qr(table)
    if np.abs(np.diag(triangle)).min() < 1e-8 * len(y) ** 0.5:
        return None
    lever = (basis**2).sum(axis=1)
    missed = (y - basis @ (basis.T @ y)) / np.maximum(1e-9, 1 - lever)
    return table, np.array(owner), float(1 - (missed**2).mean())


def _functions(x: np.ndarray, ordered: bool, degree: int) -> np.ndarray | None:
    """Functions of a factor with mean 0, mean square 1 and no correlation over the rows; None for too many kinds."""
    values, index = np.unique(x, return_inverse=True)
    if ordered:
        place = (np.cumsum(np.bincount(index)) - 0.5 * np.bincount(index)) / len(x)
        raw = np.polynomial.legendre.legvander(2 * place[index] - 1, min(degree, len(values) - 1))
    elif len(values) > MAX_KINDS:
        return None
    else:
        raw = np.column_stack([np.ones(len(x)), *(index == i for i in range(1, len(values)))]).astype(float)
    return np.asarray(np.linalg.qr(raw)[0][:, 1:] * len(x) ** 0.5)


def _shares(y: np.ndarray, table: np.ndarray, owner: np.ndarray) -> np.ndarray:
    """Share of variance of each factor and pair: squares of its coefficients less what the fit's scatter adds."""
    inverse = np.linalg.pinv(table.T @ table)
    found = inverse @ (table.T @ y)
    rest = float(((y - table @ found) ** 2).sum() / max(1, len(y) - len(owner)))
    squares = found**2 - rest * np.diag(inverse)
    return np.array([squares[owner == p].sum() for p in range(int(owner.max()) + 1)]) / y.var()
