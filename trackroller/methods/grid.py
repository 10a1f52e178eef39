"""Full grids of listed values: every combination once, with exact shares of variance (functional
ANOVA).

SALib has no counterpart for the shares of a grid.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from trackroller.errors import InputError
from trackroller.methods.intervals import constant
from trackroller.methods.method import (
    Design,
    Drawn,
    Estimated,
    Estimates,
    Factors,
    Index,
    Method,
    Settings,
    spread,
)
from trackroller.methods.sample import GIVEN_DATA

MAX_ROWS = 50_000_000  # a larger number is a typing error


class Grid(Method):
    """Every combination of the listed values."""

    name = "grid"
    weighted = crossed = quick = True
    indices = {
        "main_share": Index("first-order index", of_factor=True),
        "interaction_share": Index("share of variance of interaction"),
        "higher_share": Index("share of variance of interactions of three and more factors"),
        **GIVEN_DATA,
    }
    headline = "main_share"
    judged = ()
    needs = "a full grid, every level weighing the same"
    unit = "cells"
    whole = "cases of the grid"

    def check(self, free: Factors) -> None:
        """Refuse distributions."""
        for name, factor in free.items():
            if not factor.discrete and factor.kind != "expression":
                remedy = "Or choose a sampled design (lhs, sobol, saltelli, morris)."
                raise InputError(
                    f"factors.{name}",
                    factor.kind,
                    "values, linspace or logspace, with method grid",
                    remedy,
                )

    def draw(self, free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
        """Return the index of each listed value, the last factor fastest."""
        self.check(free)
        shape = tuple(len(f.levels) for f in free.values())
        if np.prod([float(s) for s in shape]) > MAX_ROWS:
            size = f"grid of {' x '.join(map(str, shape))}"
            raise InputError(
                "method", size, f"at most {MAX_ROWS} rows", "Take fewer levels or a sampled design."
            )
        return cells(shape), {"shape": shape}

    def estimate(self, y: np.ndarray, design: Design) -> Estimated:
        """Return the shares of variance and the measures of given data."""
        from trackroller.methods.given_data import given_data  # heavy: SALib and scipy.stats

        out = grid_shares(y.reshape(design.meta["shape"]))
        out |= given_data(y, design.unit, design.ordered)
        return Estimated(out, int(out.pop("cells_used")), int(out.pop("cells")))

    def group_indices(
        self, y: np.ndarray, design: Design, groups: Mapping[str, Sequence[str]]
    ) -> Estimates:
        """Return the exact indices of groups of factors."""
        names = list(design.factors)
        places = [tuple(names.index(name) for name in members) for members in groups.values()]
        first, total, _ = closed_shares(y.reshape(design.meta["shape"]), places)
        return {"group_S1": first, "group_ST": total}

    def level_indices(
        self, y: np.ndarray, design: Design, place: int, inside: np.ndarray
    ) -> Estimates:
        """Return the exact indices within a level."""
        shape = tuple(size for j, size in enumerate(design.meta["shape"]) if j != place)
        table = y[inside].reshape(shape)  # the other factors keep their order
        first, total, used = closed_shares(table, [(j,) for j in range(len(shape))])
        none = np.full(len(shape) + 1, np.nan)
        out: Estimates = {"conditional_rows": np.array(used)}
        for name, values in (("conditional_S1", first), ("conditional_ST", total)):
            out |= {name: spread(values, place), f"{name}_low": none, f"{name}_high": none}
        return out


def cells(shape: Sequence[int]) -> np.ndarray:
    """Return the index of the level of each factor in each cell of a grid, shape (cells, factors),
    the last fastest.
    """
    return np.indices(shape).reshape(len(shape), int(np.prod(shape))).T.astype(float)


def complete_part(y: np.ndarray) -> list[np.ndarray]:
    """Find the levels of a grid that span a part without unusable cells, dropping as few cells as
    possible.

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
            if not bad.any():
                return keep
            return [np.arange(0) for _ in keep]
        shares = [
            bad.mean(axis=tuple(a for a in range(bad.ndim) if a != axis))
            for axis in range(bad.ndim)
        ]
        # drop the level richest in unusable cells; of equal levels the one that costs the fewest
        # cells
        axis = max(range(bad.ndim), key=lambda a: (round(float(shares[a].max()), 12), bad.shape[a]))
        keep[axis] = np.delete(keep[axis], int(shares[axis].argmax()))


def variance_share(part: np.ndarray, axes: tuple[int, ...]) -> float:
    """Return the share of variance of the means over all other axes, the closed index of some
    factors.

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
    return float(
        part.mean(axis=tuple(a for a in range(part.ndim) if a not in axes)).var() / part.var()
    )


def closed_shares(
    table: np.ndarray, groups: Sequence[tuple[int, ...]]
) -> tuple[np.ndarray, np.ndarray, int]:
    """Return first-order and total indices of groups of a grid's axes, and the number of cells
    behind them.
    """
    part = table[np.ix_(*complete_part(table))]
    complements = [tuple(j for j in range(table.ndim) if j not in group) for group in groups]
    first, others = (
        np.array([variance_share(part, axes) for axes in which]) for which in (groups, complements)
    )
    return first, 1 - others, part.size


def grid_shares(y: np.ndarray) -> Estimates:
    """Divide the variance over a full grid into main effects and two-factor interactions
    (functional ANOVA).

    Parameters
    ----------
    y : output over the grid, shape (levels of factor 1, ..., levels of factor k). A cell with NaN
        costs a level (`complete_part`), because means over an incomplete grid mix the effects

    Returns
    -------
    main_share (k,), interaction_share (k, k) above the diagonal, higher_share (), cells_used (),
    cells ().

    Notes
    -----
    V_i = Var(E[y | x_i]), V_ij = Var(E[y | x_i, x_j]) - V_i - V_j; every level has the same weight.
    """
    count = y.ndim
    keep = complete_part(y)
    part = y[np.ix_(*keep)]
    out: Estimates = {"cells": np.array(y.size), "cells_used": np.array(part.size)}
    main = np.full(count, np.nan)
    pair = np.full((count, count), np.nan)
    if constant(part):
        return out | {
            "main_share": main,
            "interaction_share": pair,
            "higher_share": np.array(np.nan),
        }
    for i in range(count):
        if part.shape[i] > 1:
            main[i] = variance_share(part, (i,))
        else:
            main[i] = np.nan
    for i in range(count):
        for j in range(i + 1, count):
            if part.shape[i] > 1 and part.shape[j] > 1:
                pair[i, j] = max(0.0, variance_share(part, (i, j)) - main[i] - main[j])
    higher = max(0.0, 1.0 - np.nansum(main) - np.nansum(pair))
    return out | {"main_share": main, "interaction_share": pair, "higher_share": np.array(higher)}
