"""Estimators of sensitivity on plain arrays. No files, no labels.

Every estimator takes one output `y`, shape (n,), NaN where a row is not usable, never fills such a row and
returns how many rows, blocks or effects it used. Intervals are 95 %. A constant output has no sensitivity:
its indices are NaN, never 0.
"""

from __future__ import annotations

import numpy as np

Z = 1.959964  # 97.5 % quantile of the normal distribution
Estimates = dict[str, np.ndarray]


def constant(y: np.ndarray) -> bool:
    """Does the output not vary, but for rounding?"""
    y = y[np.isfinite(y)]
    return y.size == 0 or float(np.ptp(y)) <= 1e-12 * float(np.max(np.abs(y), initial=0.0))


def morris(y: np.ndarray, unit: np.ndarray, listed: np.ndarray, seed: int = 0, resamples: int = 300) -> Estimates:
    """Elementary effects of Morris trajectories.

    An effect is the change of the output divided by the step in units of the factor's range (quantiles 0
    to 1); for a listed factor it is the whole change between two of its values, in the order of the list.

    Parameters
    ----------
    y : output, shape (trajectories * (k + 1),)
    unit : quantiles or list indices, shape (trajectories * (k + 1), k)
    listed : which factors are lists, shape (k,)

    Returns
    -------
    mu, mu_star (with _low, _high by bootstrap over trajectories), sigma, effects_used, each shape (k,).
    An effect needs its two rows only; an unusable row costs the two effects it takes part in.

    References
    ----------
    Morris (1991), Technometrics 33, 161-174; Campolongo et al. (2007), Environ. Model. Softw. 22, 1509-1518.
    """
    count = unit.shape[1]
    value = y.reshape(-1, count + 1)
    step = np.diff(unit.reshape(-1, count + 1, count), axis=1)
    moved = np.argmax(np.abs(step), axis=2)
    size = np.take_along_axis(step, moved[:, :, None], axis=2)[:, :, 0]
    size = np.where(listed[moved], np.sign(size), size)
    effect = np.full((len(value), count), np.nan)
    np.put_along_axis(effect, moved, np.diff(value, axis=1) / size, axis=1)
    out: Estimates = {"effects_used": np.isfinite(effect).sum(axis=0)}
    if constant(y):
        return out | {n: np.full(count, np.nan) for n in ("mu", "mu_star", "mu_star_low", "mu_star_high", "sigma")}
    picks = np.random.default_rng(seed).integers(0, len(value), (resamples, len(value)))
    with np.errstate(invalid="ignore", divide="ignore"):
        filled, good = np.nan_to_num(np.abs(effect)), np.isfinite(effect)
        drawn = filled[picks].sum(axis=1) / good[picks].sum(axis=1)
        out["mu"] = np.nan_to_num(effect).sum(axis=0) / good.sum(axis=0)
        out["mu_star"] = filled.sum(axis=0) / good.sum(axis=0)
        spread = np.where(good, (effect - out["mu"]) ** 2, 0.0).sum(axis=0) / (good.sum(axis=0) - 1)
    out["sigma"] = np.sqrt(np.where(good.sum(axis=0) > 1, spread, np.nan))
    low, high = percentile_bounds(drawn)
    return out | {"mu_star_low": low, "mu_star_high": high}


def percentile_bounds(drawn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """95 % bounds over resamples (first axis); NaN where fewer than half of them have a value."""
    good = np.isfinite(drawn)
    enough = good.mean(axis=0) > 0.5
    drawn = np.where(good | ~enough, drawn, np.nan)
    low, high = np.nanpercentile(np.where(enough, drawn, 0.0), [2.5, 97.5], axis=0)
    return np.where(enough, low, np.nan), np.where(enough, high, np.nan)


def complete_part(y: np.ndarray) -> list[np.ndarray]:
    """Levels of a grid that are left when those with unusable cells go, the fewest cells first.

    Parameters
    ----------
    y : output over the grid, shape (levels of factor 1, ..., levels of factor k)

    Returns
    -------
    Indices of the kept levels of each factor; the part they span has no NaN. May be empty.
    """
    keep = [np.arange(size) for size in y.shape]
    while True:
        bad = ~np.isfinite(y[np.ix_(*keep)])
        if not bad.any() or bad.all():
            return keep if not bad.any() else [np.arange(0) for _ in keep]
        shares = [bad.mean(axis=tuple(a for a in range(bad.ndim) if a != axis)) for axis in range(bad.ndim)]
        # the level richest in unusable cells; of equals the one whose loss costs the fewest cells
        axis = max(range(bad.ndim), key=lambda a: (round(float(shares[a].max()), 12), bad.shape[a]))
        keep[axis] = np.delete(keep[axis], int(shares[axis].argmax()))


def grid_shares(y: np.ndarray) -> Estimates:
    """Shares of variance of main effects and two-factor interactions on a full grid (functional ANOVA).

    V_i = Var(E[y | x_i]), V_ij = Var(E[y | x_i, x_j]) - V_i - V_j, every level weighing the same.

    Parameters
    ----------
    y : output over the grid, shape (levels of factor 1, ..., levels of factor k); cells with NaN cost levels
        (`complete_part`), because means over an incomplete grid mix effects

    Returns
    -------
    main_share (k,), interaction_share (k, k) above the diagonal, higher_share (), cells_used, cells.
    """
    count = y.ndim
    keep = complete_part(y)
    part = y[np.ix_(*keep)]
    out: Estimates = {"cells": np.array(y.size), "cells_used": np.array(part.size)}
    main, pair = np.full(count, np.nan), np.full((count, count), np.nan)
    if constant(part):
        return out | {"main_share": main, "interaction_share": pair, "higher_share": np.array(np.nan)}
    part = part - part.mean()
    variance = (part**2).mean()

    def of(axes: tuple[int, ...]) -> float:
        rest = tuple(a for a in range(count) if a not in axes)
        return float((part.mean(axis=rest) ** 2).mean() / variance)

    for i in range(count):
        main[i] = of((i,)) if part.shape[i] > 1 else np.nan
    for i in range(count):
        for j in range(i + 1, count):
            if part.shape[i] > 1 and part.shape[j] > 1:
                pair[i, j] = max(0.0, of((i, j)) - main[i] - main[j])
    rest = max(0.0, 1.0 - np.nansum(main) - np.nansum(pair))
    return out | {"main_share": main, "interaction_share": pair, "higher_share": np.array(rest)}


def effects(y: np.ndarray, coded: np.ndarray, listed: np.ndarray, quadratic: bool) -> Estimates:
    """Effects of a two- or three-level design by least squares.

    y = c + sum b_i x_i (+ sum b_ij x_i x_j + sum b_ii x_i^2), x in [-1, 1]; the effect of a factor is
    2 b_i, the change of the output over its range. A listed factor enters by its values; its effect is the
    largest less the smallest mean.

    Parameters
    ----------
    y : output, shape (n,); unusable rows are left out of the fit
    coded : design, shape (n, k): -1..1, or list indices
    listed : which factors are lists, shape (k,)
    quadratic : fit curvature and interactions too, if there are rows enough

    Returns
    -------
    effect, effect_low, effect_high (k,), curvature (k,), interaction (k, k), r_squared (), rows_used ().
    Intervals come from the misfit (Student t): the solver has no noise, so they show lack of fit.
    """
    from scipy import stats

    good = np.isfinite(y)
    count = coded.shape[1]
    nan = np.full(count, np.nan)
    out: Estimates = {
        "effect": nan,
        "effect_low": nan,
        "effect_high": nan,
        "curvature": nan,
        "interaction": np.full((count, count), np.nan),
        "r_squared": np.array(np.nan),
        "rows_used": np.array(good.sum()),
    }
    names, matrix = _terms(coded[good], listed, quadratic)
    if quadratic and np.linalg.matrix_rank(matrix) < matrix.shape[1]:
        names, matrix = _terms(coded[good], listed, False)
    if constant(y[good]) or np.linalg.matrix_rank(matrix) < matrix.shape[1]:
        return out
    beta, *_ = np.linalg.lstsq(matrix, y[good], rcond=None)
    rest = y[good] - matrix @ beta
    free = len(rest) - matrix.shape[1]
    covariance = np.linalg.inv(matrix.T @ matrix) * (rest @ rest / free if free > 0 else np.nan)
    wide = stats.t.ppf(0.975, free) if free > 0 else np.nan
    out |= {k: v.copy() for k, v in out.items()}
    out["r_squared"] = np.array(1 - (rest @ rest) / ((y[good] - y[good].mean()) ** 2).sum())
    for i in range(count):
        direction = np.zeros(len(names))
        if listed[i]:
            own = [p for p, name in enumerate(names) if name[:2] == ("level", i)]
            at = np.append(beta[own], 0.0)  # the last value is the reference
            for level, sign in ((int(at.argmax()), 1.0), (int(at.argmin()), -1.0)):
                if level < len(own):
                    direction[own[level]] = sign
        else:
            direction[names.index(("line", i))] = 2.0
        size, wide_by = direction @ beta, wide * np.sqrt(direction @ covariance @ direction)
        out["effect"][i], out["effect_low"][i], out["effect_high"][i] = size, size - wide_by, size + wide_by
    for p, name in enumerate(names):
        if name[0] == "square":
            out["curvature"][name[1]] = beta[p]
        elif name[0] == "product":
            out["interaction"][name[1], name[2]] = 2 * beta[p]
    return out


def _terms(coded: np.ndarray, listed: np.ndarray, quadratic: bool) -> tuple[list[tuple], np.ndarray]:
    names: list[tuple] = [("one",)]
    columns = [np.ones(len(coded))]
    numeric = [i for i in range(coded.shape[1]) if not listed[i]]
    for i in range(coded.shape[1]):
        if listed[i]:
            for level in np.unique(coded[:, i])[:-1]:
                names.append(("level", i, level))
                columns.append((coded[:, i] == level).astype(float))
        else:
            names.append(("line", i))
            columns.append(coded[:, i])
    if quadratic:
        names += [("square", i) for i in numeric]
        columns += [coded[:, i] ** 2 for i in numeric]
        pairs = [(i, j) for i in numeric for j in numeric if i < j]
        names += [("product", i, j) for i, j in pairs]
        columns += [coded[:, i] * coded[:, j] for i, j in pairs]
    return names, np.stack(columns, axis=1)
