"""Correlated factors of a random sample: a Gaussian copula from Spearman rank correlations.

The copula changes which values meet in a row. The distribution of each factor stays as it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.special import ndtr, ndtri

from trackroller.errors import InputError, unknown_name
from trackroller.methods.factor import Factor
from trackroller.methods.method import Design

KEY = "rank_correlations"
# eigenvalue of the correlation matrix below which it does not count as positive definite
SMALLEST = 1e-6
Entry = tuple[str, str, float]
CORRELATED = 0.5  # rank correlation of two columns of a table above which the result warns


def copula(entries: Sequence[Entry], factors: Mapping[str, Factor]) -> np.ndarray | None:
    """Return the lower triangular root of the correlation matrix of the Gaussian copula.

    Parameters
    ----------
    entries : (factor, factor, Spearman rank correlation [1]); a pair that is not listed has no
        correlation
    factors : the factors of the random sample by name

    Returns
    -------
    Matrix L, shape (k, k), with L L^T = R and R_ij = 2 sin(pi rho_ij / 6), or None without entries.

    Raises
    ------
    InputError : a name that is no factor with a distribution, or a matrix that is not positive
        definite

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
            remedy = (
                "Give a distribution such as {uniform: [low, high]}: equal values have no rank."
            )
            raise InputError(
                KEY, name, "factors with a distribution, not with a list of values", remedy
            )
    rho = np.eye(len(names))
    for one, other, value in entries:
        i, j = names.index(one), names.index(other)
        rho[i, j] = rho[j, i] = value
    if not _is_definite(rho):
        raise InputError(
            KEY,
            [list(e) for e in entries],
            "rank correlations that can hold together",
            _remedy(rho),
        )
    return np.linalg.cholesky(normal_correlation(rho))


def normal_correlation(rho: np.ndarray) -> np.ndarray:
    """Return the correlation of normal variables with a rank correlation, r = 2 sin(pi rho / 6)
    [1], any shape.
    """
    # 2 sin(pi/6) rounds below 1
    return np.where(np.asarray(rho) == 1.0, 1.0, 2 * np.sin(np.pi * np.asarray(rho) / 6))


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
    strata : whether each column keeps its values and changes their order, so that a Latin hypercube
        stays one; otherwise each row is correlated by itself and depends on no other row

    Returns
    -------
    Quantiles, shape (n, k), whose ranks are those of correlated normal variables. Columns of
    factors without correlation are the same as before.

    Notes
    -----
    With strata, the chance correlation of the sample is taken out first, where it has more rows
    than twice its factors.

    References
    ----------
    Iman & Conover (1982), Commun. Stat. Simul. Comput. 11, 311-334; Stein (1987), Technometrics 29,
    143-151.
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


def correlated_pairs(design: Design) -> list[tuple[str, str, float]]:
    """Return the pairs of factors that are correlated.

    Parameters
    ----------
    design : the design

    Returns
    -------
    (factor, factor, rank correlation [1]): the pairs of the study file, or the pair of columns of a
    table with the largest correlation above 0.5. The factors of every other design are independent.
    """
    if not design.method.observed or len(design.factors) < 2:
        return [
            (one, other, rho) for one, other, rho in design.meta.get("rank_correlations", ()) if rho
        ]
    from scipy.stats import rankdata  # heavy, and drawing does not need it

    names = list(design.factors)
    table = np.atleast_2d(np.corrcoef(rankdata(design.unit, axis=0), rowvar=False))
    pairs = [(names[j], names[i], float(table[i, j])) for i in range(len(names)) for j in range(i)]
    strongest = max(pairs, key=lambda pair: abs(pair[2]))
    if abs(strongest[2]) >= CORRELATED:
        return [strongest]
    return []
