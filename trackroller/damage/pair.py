"""Find which body of a pair of roller and guide fails first."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from trackroller.numerics.variable import BODIES

FIRST_TO_FAIL = (*BODIES, "none", "unknown")

# relative difference of lives that rounding can cause: bodies that are alike must not change places
# by it
ALIKE = 1e-4


def first_failure(roller: ArrayLike, guide: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Return the life of a roller and its guide as a pair, and the body that fails first.

    Parameters
    ----------
    roller, guide : array_like
        Lives of the two bodies [h], shape (n,); NaN where a life is not known.

    Returns
    -------
    tuple of numpy.ndarray
        Life of the pair [h], shape (n,): the shorter life, or the roller's where the guide's is not
        known. Then the number in `FIRST_TO_FAIL` of the body that fails first, shape (n,): `none`
        where both lives are infinite, `unknown` where one of them is NaN. The roller comes first
        where both lives are equal up to ALIKE.
    """
    lives = np.asarray(roller, dtype=float), np.asarray(guide, dtype=float)
    pair = np.where(np.isnan(lives[1]), lives[0], np.minimum(*lives))
    first = np.where(
        lives[1] < (1.0 - ALIKE) * lives[0],
        FIRST_TO_FAIL.index("guide"),
        FIRST_TO_FAIL.index("roller"),
    )
    first = np.where(np.isposinf(pair), FIRST_TO_FAIL.index("none"), first)
    return pair, np.where(
        np.isnan(lives[0]) | np.isnan(lives[1]), FIRST_TO_FAIL.index("unknown"), first
    )
