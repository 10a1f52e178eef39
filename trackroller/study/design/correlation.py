"""Correlated factors of a random sample: a Gaussian copula from Spearman rank correlations.

The copula changes which values meet in a row. The distribution of each factor stays as it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri

from trackroller.errors import InputError, listing, unknown_name
from trackroller.study.design.factors import Factor
from trackroller.study.design.kinds import those_that_take

KEY = "rank_correlations"
SMALLEST = 1e-6  # eigenvalue of the correlation matrix below which it does not count as positive definite
Entry = tuple[str, str, float]
TAKE = "Take design lhs: first and delta allow correlation."
REFUSALS = {
    "saltelli": f"Sobol indices need independent factors. {TAKE}",
    "morris": f"Elementary effects change one factor at a time. {TAKE}",
    "table": "Remove the key: the rows of the table have their own correlation.",
}
REFUSAL = "This design has fixed combinations of values. Take design lhs."


def check_entries(value: Any) -> tuple[Entry, ...]:
    """Check the key `rank_correlations` of a study file.

    Parameters
    ----------
    value : list of [factor, factor, rank correlation]

    Returns
    -------
    The entries, each (factor, factor, rank correlation [1]).

    Raises
    ------
    InputError : an entry has another form, or a pair stands twice
    """
    example = "For example [[radial_force, axial_force, 0.6]]."
    if not isinstance(value, (list, tuple)):
        raise InputError(KEY, value, "a list of [factor, factor, rank correlation]", example)
    entries: dict[frozenset[str], Entry] = {}
    for entry in value:
        good = isinstance(entry, (list, tuple)) and len(entry) == 3 and all(isinstance(n, str) for n in entry[:2])
        if not good or entry[0] == entry[1]:
            raise InputError(KEY, entry, "[factor, factor, rank correlation] with two different factors", example)
        rho = entry[2]
        if isinstance(rho, bool) or not isinstance(rho, (int, float)) or not -1 < rho < 1:
            raise InputError(KEY, list(entry), "a rank correlation (Spearman) above -1 and below 1")
        if frozenset(entry[:2]) in entries:
            raise InputError(KEY, list(entry), "each pair of factors once", "Remove one of the entries.")
        entries[frozenset(entry[:2])] = (entry[0], entry[1], float(rho))
    return tuple(entries.values())


def check_design(entries: Sequence[Entry], method: str) -> None:
    """Refuse rank correlations in a design that cannot have them; the message says what to take instead."""
    having = those_that_take(KEY)
    if entries and method not in having:
        allowed = f"design {listing(having, 'or')}, not {method}"
        raise InputError(KEY, [list(e) for e in entries], allowed, REFUSALS.get(method, REFUSAL))


def copula(entries: Sequence[Entry], factors: Mapping[str, Factor]) -> np.ndarray | None:
    """Return the lower triangular root of the correlation matrix of the Gaussian copula.

    Parameters
    ----------
    entries : see `check_entries`; a pair that is not listed has no correlation
    factors : the factors of the random sample by name

    Returns
    -------
    Matrix L, shape (k, k), with L L^T = R and R_ij = 2 sin(pi rho_ij / 6), or None without entries.

    Raises
    ------
    InputError : a name that is no factor with a distribution, or a matrix that is not positive definite

    References
    ----------
    Pearson (1907), Drapers' Company Research Memoirs, Biometric Series 4.
    """
    if not entries:
        return None
    names = list(factors)
    for name in (name for entry in entries for name in entry[:2]):
        if name not in factors:
            raise unknown_name(KEY, name, [n for n, f in factors.items() if not f.discrete])
        if factors[name].discrete:
            remedy = "Give a distribution such as {uniform: [low, high]}: equal values have no rank."
            raise InputError(KEY, name, "factors with a distribution, not with a list of values", remedy)
    rho = np.eye(len(names))
    for one, other, value in entries:
        i, j = names.index(one), names.index(other)
        rho[i, j] = rho[j, i] = value
    if not _is_definite(rho):
        raise InputError(KEY, [list(e) for e in entries], "rank correlations that can hold together", _remedy(rho))
    return np.linalg.cholesky(normal_correlation(rho))


def normal_correlation(rho: np.ndarray) -> np.ndarray:
    """Return the correlation of normal variables with a rank correlation, r = 2 sin(pi rho / 6) [1], any shape."""
    return np.where(np.asarray(rho) == 1.0, 1.0, 2 * np.sin(np.pi * np.asarray(rho) / 6))  # 2 sin(pi/6) rounds below 1


def _is_definite(rho: np.ndarray) -> bool:
    return bool(np.linalg.eigvalsh(normal_correlation(rho))[0] > SMALLEST)


def _remedy(rho: np.ndarray) -> str:
    """Say by which factor all correlations must shrink until the matrix is positive definite."""
    shares = np.round(np.arange(0.99, -0.01, -0.01), 2)
    share = next(s for s in shares if _is_definite(np.where(rho < 1, s * rho, 1.0)))
    return f"Multiply all values by {share:g} or less."


def correlate(unit: np.ndarray, root: np.ndarray | None, strata: bool) -> np.ndarray:
    """Correlate the columns of a sample.

    Parameters
    ----------
    unit : quantiles of independent factors [1], shape (n, k)
    root : see `copula`
    strata : whether each column keeps its values and changes their order, so that a Latin hypercube stays one;
        otherwise each row is correlated by itself and depends on no other row

    Returns
    -------
    Quantiles, shape (n, k), whose ranks are those of correlated normal variables. Columns of factors without
    correlation are the same as before.

    Notes
    -----
    With strata, the chance correlation of the sample is taken out first, where it has more rows than twice its factors.

    References
    ----------
    Iman & Conover (1982), Commun. Stat. Simul. Comput. 11, 311-334; Stein (1987), Technometrics 29, 143-151.
    """
    if root is None:
        return unit
    own = root != np.eye(len(root))
    if not strata:
        return np.where(own.any(axis=1), ndtr(_normal(unit) @ root.T), unit)
    moved = np.flatnonzero(own.any(axis=0) | own.any(axis=1))
    scores = _normal(unit[:, moved])
    if len(unit) > 2 * len(moved):
        scores = np.linalg.solve(np.linalg.cholesky(np.cov(scores, rowvar=False)), scores.T).T
    rank = (scores @ root[np.ix_(moved, moved)].T).argsort(axis=0).argsort(axis=0)
    out = unit.copy()
    out[:, moved] = np.take_along_axis(np.sort(unit[:, moved], axis=0), rank, axis=0)
    return out


def _normal(unit: np.ndarray) -> np.ndarray:
    return np.asarray(ndtri(np.clip(unit, 1e-15, 1 - 1e-15)))
