"""Samples that grow: the cases of the smaller sample stay, so that only new ones are solved.

Rows of `sobol`, `saltelli` and `morris` designs follow one another, so more samples only append. A Latin hypercube
is a new draw for each size; here a grown one keeps the rows it had and fills the empty strata of the larger size.
Doubling gives a full Latin hypercube again; between, some strata stay empty (no sample can be one for every size).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np

from trackroller.errors import InputError


def grown_lhs(count: int, sizes: Sequence[int], seed: int) -> np.ndarray:
    """A Latin hypercube of sizes[0] rows, grown to each further size.

    Parameters
    ----------
    count : number of factors
    sizes : rising numbers of rows
    seed : of the draw

    Returns
    -------
    Quantiles in the unit cube, shape (sizes[-1], count); the first sizes[i] rows are those of the sample of that size.
    """
    from scipy.stats import qmc

    unit: np.ndarray = qmc.LatinHypercube(d=count, rng=np.random.default_rng(seed)).random(sizes[0])
    for size in sizes[1:]:
        unit = np.concatenate([unit, _fill(unit, size, np.random.default_rng([seed, size]))])
    return unit


def _fill(unit: np.ndarray, size: int, rng: np.random.Generator) -> np.ndarray:
    """Rows that bring a sample to `size`, in strata of 1/size that are still empty in each factor."""
    new = size - len(unit)
    columns = []
    for values in unit.T:
        empty = np.setdiff1d(np.arange(size), np.minimum((values * size).astype(int), size - 1))
        columns.append((rng.permutation(empty)[:new] + rng.random(new)) / size)
    return np.stack(columns, axis=1) if columns else np.empty((new, 0))


def check_sizes(earlier: Any, samples: int) -> tuple[int, ...]:
    """The sizes a sample had before, as rising whole numbers below `samples`; raises `InputError`."""
    sizes = [earlier] if isinstance(earlier, int) else list(earlier or ())
    whole = all(isinstance(s, int) and not isinstance(s, bool) and s > 0 for s in sizes)
    if not whole or any(a >= b for a, b in itertools.pairwise([*sizes, samples])):
        raise InputError("grown_from", sizes, f"rising whole numbers below samples ({samples})")
    return tuple(sizes)
