"""Quadrature rules."""

from __future__ import annotations

import functools

import numpy as np


@functools.lru_cache(maxsize=128)
def clustered_rule(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return Gauss-Legendre nodes and weights on (0, 1) after the substitution v -> 3v^2 - 2v^3.

    The substitution makes integrands with square roots at the end points smooth.

    Parameters
    ----------
    n : int
        Number of nodes.

    Returns
    -------
    tuple of numpy.ndarray, shape (n,)
        Nodes and weights.
    """
    v, w = np.polynomial.legendre.leggauss(n)
    v = (v + 1) / 2
    w = w / 2
    return v * v * (3 - 2 * v), w * 6 * v * (1 - v)
