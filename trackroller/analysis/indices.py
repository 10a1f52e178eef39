"""Estimators of sensitivity on plain arrays: Morris, full grids, response surfaces.

Every estimator takes one output `y`, shape (n,), with NaN where a row is not usable. It never fills such a row and
returns how many rows, blocks or effects it used. Intervals are 95 %. The indices of a constant output are NaN.

SALib has no counterpart for the shares of a grid and for the fit of a response surface with lists.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import stats

Z = 1.959964  # 97.5 % quantile of the normal distribution
Estimates = dict[str, np.ndarray]
Terms = list[tuple[Any, ...]]


def constant(y: np.ndarray) -> bool:
    """Return whether an output varies by no more than rounding errors.

    Parameters
    ----------
    y : output, any shape; NaN is ignored

    Returns
    -------
    True also for an output without any finite value.
    """
    y = y[np.isfinite(y)]
    return y.size == 0 or float(np.ptp(y)) <= 1e-12 * float(np.max(np.abs(y), initial=0.0))


def morris(y: np.ndarray, unit: np.ndarray, listed: np.ndarray, seed: int = 0, resamples: int = 300) -> Estimates:
    """Estimate the elementary effects of Morris trajectories.

    Parameters
    ----------
    y : output, shape (trajectories * (k + 1),)
    unit : quantiles or list indices, shape (trajectories * (k + 1), k)
    listed : which factors are lists, shape (k,)
    seed : of the bootstrap
    resamples : bootstrap resamples of trajectories

    Returns
    -------
    mu, mu_star (with _low and _high), sigma, effects_used, each shape (k,).

    Notes
    -----
    An effect is the change of the output divided by the step in units of the factor's range (quantiles 0 to 1). For
    a list it is the whole change between two of its values. An unusable row costs the two effects that need it.
    SALib's `morris` gives the same numbers on complete data. It returns no index at all if one value is NaN; without
    incomplete trajectories, 5 % unusable rows would cost 43 % instead of 10 % of the effects of ten factors.

    References
    ----------
    Morris (1991), Technometrics 33, 161-174; Campolongo et al. (2007), Environ. Model. Softw. 22, 1509-1518.
    """
    count, effect = unit.shape[1], elementary_effects(y, unit, listed)
    good = np.isfinite(effect)
    used = good.sum(axis=0)
    out: Estimates = {"effects_used": used}
    if constant(y):
        return out | {n: np.full(count, np.nan) for n in ("mu", "mu_star", "mu_star_low", "mu_star_high", "sigma")}
    picks = np.random.default_rng(seed).integers(0, len(effect), (resamples, len(effect)))
    with np.errstate(invalid="ignore", divide="ignore"):
        filled = np.nan_to_num(np.abs(effect))
        drawn = filled[picks].sum(axis=1) / good[picks].sum(axis=1)
        out["mu"] = np.nan_to_num(effect).sum(axis=0) / used
        out["mu_star"] = filled.sum(axis=0) / used
        spread = np.where(good, (effect - out["mu"]) ** 2, 0.0).sum(axis=0) / (used - 1)
    out["sigma"] = np.sqrt(np.where(used > 1, spread, np.nan))
    low, high = percentile_bounds(drawn)
    return out | {"mu_star_low": low, "mu_star_high": high}


def elementary_effects(y: np.ndarray, unit: np.ndarray, listed: np.ndarray) -> np.ndarray:
    """Return the elementary effects of Morris trajectories, shape (trajectories, k); NaN where a row is unusable.

    Parameters
    ----------
    y, unit, listed : as in `morris`
    """
    count = unit.shape[1]
    step = np.diff(unit.reshape(-1, count + 1, count), axis=1)
    moved = np.argmax(np.abs(step), axis=2)
    size = np.take_along_axis(step, moved[:, :, None], axis=2)[:, :, 0]
    size = np.where(listed[moved], np.sign(size), size)
    effect = np.full((len(step), count), np.nan)
    np.put_along_axis(effect, moved, np.diff(y.reshape(-1, count + 1), axis=1) / size, axis=1)
    return effect


def percentile_bounds(drawn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the 95 % bounds over resamples.

    Parameters
    ----------
    drawn : estimates, shape (resamples, ...)

    Returns
    -------
    Low and high, shape (...); NaN where fewer than half of the resamples have a value.
    """
    good = np.isfinite(drawn)
    enough = good.mean(axis=0) > 0.5
    drawn = np.where(good | ~enough, drawn, np.nan)
    low, high = np.nanpercentile(np.where(enough, drawn, 0.0), [2.5, 97.5], axis=0)
    return np.where(enough, low, np.nan), np.where(enough, high, np.nan)


def complete_part(y: np.ndarray) -> list[np.ndarray]:
    """Find the levels of a grid that span a part without unusable cells, dropping as few cells as possible.

    Parameters
    ----------
    y : output over the grid, shape (levels of factor 1, ..., levels of factor k)

    Returns
    -------
    Indices of the kept levels of each factor; may be empty.
    """
    keep = [np.arange(size) for size in y.shape]
    while True:
        bad = ~np.isfinite(y[np.ix_(*keep)])
        if not bad.any() or bad.all():
            return keep if not bad.any() else [np.arange(0) for _ in keep]
        shares = [bad.mean(axis=tuple(a for a in range(bad.ndim) if a != axis)) for axis in range(bad.ndim)]
        # drop the level richest in unusable cells; of equal levels the one that costs the fewest cells
        axis = max(range(bad.ndim), key=lambda a: (round(float(shares[a].max()), 12), bad.shape[a]))
        keep[axis] = np.delete(keep[axis], int(shares[axis].argmax()))


def variance_share(part: np.ndarray, axes: tuple[int, ...]) -> float:
    """Return the share of variance of the means over all other axes, the closed index of some factors.

    Parameters
    ----------
    part : output over a full grid, shape (levels of factor 1, ..., levels of factor k), finite
    axes : the factors

    Returns
    -------
    Var(E[y | factors]) / V; NaN for a constant output.
    """
    if constant(part):
        return float("nan")
    return float(part.mean(axis=tuple(a for a in range(part.ndim) if a not in axes)).var() / part.var())


def grid_shares(y: np.ndarray) -> Estimates:
    """Divide the variance over a full grid into main effects and two-factor interactions (functional ANOVA).

    Parameters
    ----------
    y : output over the grid, shape (levels of factor 1, ..., levels of factor k). A cell with NaN costs a level
        (`complete_part`), because means over an incomplete grid mix the effects

    Returns
    -------
    main_share (k,), interaction_share (k, k) above the diagonal, higher_share (), cells_used (), cells ().

    Notes
    -----
    V_i = Var(E[y | x_i]), V_ij = Var(E[y | x_i, x_j]) - V_i - V_j; every level has the same weight.
    """
    count = y.ndim
    keep = complete_part(y)
    part = y[np.ix_(*keep)]
    out: Estimates = {"cells": np.array(y.size), "cells_used": np.array(part.size)}
    main, pair = np.full(count, np.nan), np.full((count, count), np.nan)
    if constant(part):
        return out | {"main_share": main, "interaction_share": pair, "higher_share": np.array(np.nan)}
    for i in range(count):
        main[i] = variance_share(part, (i,)) if part.shape[i] > 1 else np.nan
    for i in range(count):
        for j in range(i + 1, count):
            if part.shape[i] > 1 and part.shape[j] > 1:
                pair[i, j] = max(0.0, variance_share(part, (i, j)) - main[i] - main[j])
    higher = max(0.0, 1.0 - np.nansum(main) - np.nansum(pair))
    return out | {"main_share": main, "interaction_share": pair, "higher_share": np.array(higher)}


def effects(y: np.ndarray, coded: np.ndarray, listed: np.ndarray, quadratic: bool) -> Estimates:
    """Fit the effects of a two- or three-level design by least squares.

    Parameters
    ----------
    y : output, shape (n,); unusable rows are left out of the fit
    coded : design, shape (n, k): -1..1, or list indices
    listed : which factors are lists, shape (k,)
    quadratic : whether to fit curvature and interactions too, if there are enough rows

    Returns
    -------
    effect, effect_low, effect_high (k,), curvature (k,), interaction (k, k), r_squared (), rows_used ().

    Notes
    -----
    y = c + sum b_i x_i (+ sum b_ij x_i x_j + sum b_ii x_i^2), x in [-1, 1]. The effect of a factor is 2 b_i, the
    change of the output over its range. A list enters by its values; its effect is the largest less the smallest
    mean. Intervals come from the residuals (Student t). The solver has no noise, so they show lack of fit.
    """
    good = np.isfinite(y)
    y, coded, count = y[good], coded[good], coded.shape[1]
    out: Estimates = {name: np.full(count, np.nan) for name in ("effect", "effect_low", "effect_high", "curvature")}
    out |= {"interaction": np.full((count, count), np.nan), "r_squared": np.array(np.nan)}
    out["rows_used"] = np.array(good.sum())
    terms, matrix = _terms(coded, listed, quadratic)
    if quadratic and np.linalg.matrix_rank(matrix) < matrix.shape[1]:
        terms, matrix = _terms(coded, listed, False)
    if constant(y) or np.linalg.matrix_rank(matrix) < matrix.shape[1]:
        return out
    beta, *_ = np.linalg.lstsq(matrix, y, rcond=None)
    residual = y - matrix @ beta
    free = len(residual) - matrix.shape[1]
    covariance = np.linalg.inv(matrix.T @ matrix) * (residual @ residual / free if free > 0 else np.nan)
    wide = stats.t.ppf(0.975, free) if free > 0 else np.nan
    out["r_squared"] = np.array(1 - (residual @ residual) / ((y - y.mean()) ** 2).sum())
    for i in range(count):
        contrast = _contrast(i, bool(listed[i]), terms, beta)
        size, half = contrast @ beta, wide * np.sqrt(contrast @ covariance @ contrast)
        out["effect"][i], out["effect_low"][i], out["effect_high"][i] = size, size - half, size + half
    for p, term in enumerate(terms):
        if term[0] == "square":
            out["curvature"][term[1]] = beta[p]
        elif term[0] == "product":
            out["interaction"][term[1], term[2]] = 2 * beta[p]
    return out


def _contrast(factor: int, listed: bool, terms: Terms, beta: np.ndarray) -> np.ndarray:
    """Return the weights of the coefficients whose sum is the effect of a factor."""
    contrast = np.zeros(len(terms))
    if not listed:
        contrast[terms.index(("line", factor))] = 2.0
        return contrast
    levels = [p for p, term in enumerate(terms) if term[:2] == ("level", factor)]
    means = np.append(beta[levels], 0.0)  # the last value of the list is the reference
    for level, sign in ((int(means.argmax()), 1.0), (int(means.argmin()), -1.0)):
        if level < len(levels):
            contrast[levels[level]] = sign
    return contrast


def _terms(coded: np.ndarray, listed: np.ndarray, quadratic: bool) -> tuple[Terms, np.ndarray]:
    """Return the terms of the fitted polynomial and their columns, shape (n, terms)."""
    terms: Terms = [("one",)]
    columns = [np.ones(len(coded))]
    numeric = [i for i in range(coded.shape[1]) if not listed[i]]
    for i in range(coded.shape[1]):
        if listed[i]:
            for level in np.unique(coded[:, i])[:-1]:
                terms.append(("level", i, level))
                columns.append((coded[:, i] == level).astype(float))
        else:
            terms.append(("line", i))
            columns.append(coded[:, i])
    if quadratic:
        terms += [("square", i) for i in numeric]
        columns += [coded[:, i] ** 2 for i in numeric]
        pairs = [(i, j) for i in numeric for j in numeric if i < j]
        terms += [("product", i, j) for i, j in pairs]
        columns += [coded[:, i] * coded[:, j] for i, j in pairs]
    return terms, np.stack(columns, axis=1)
