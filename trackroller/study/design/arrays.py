"""Classical designs in coded units: -1 and +1 are the ends of a factor's range, 0 its middle."""

from __future__ import annotations

import itertools

import numpy as np

from trackroller.errors import InputError

# Box & Behnken (1960): which factors vary together in one block, for designs that are not all pairs
_BLOCKS: dict[int, list[tuple[int, ...]]] = {
    6: [(0, 1, 3), (1, 2, 4), (2, 3, 5), (0, 3, 4), (1, 4, 5), (0, 2, 5)],
    7: [(3, 4, 5), (0, 5, 6), (1, 4, 6), (0, 1, 3), (2, 3, 6), (0, 2, 4), (1, 2, 5)],
}


def central_composite(count: int) -> np.ndarray:
    """Face-centred central composite design: corners, face centres, centre.

    Parameters
    ----------
    count : number of factors, 1 to 8

    Returns
    -------
    Coded design, shape (2**count + 2 count + 1, count). A deterministic solver needs one centre point only.

    References
    ----------
    Box & Wilson (1951), J. R. Stat. Soc. B 13, 1-45.
    """
    if not 1 <= count <= 8:
        raise InputError(
            "design",
            f"central_composite with {count} numeric factors",
            "1 to 8 are possible",
            "Screen first (morris or plackett_burman) and keep what matters.",
        )
    corners = np.array(list(itertools.product((-1.0, 1.0), repeat=count)))
    faces = np.concatenate([sign * np.eye(count)[[i]] for i in range(count) for sign in (-1.0, 1.0)])
    return np.concatenate([corners, faces, np.zeros((1, count))])


def box_behnken(count: int) -> np.ndarray:
    """Box-Behnken design: no corner is visited, all factors have three levels.

    Parameters
    ----------
    count : number of factors, 3 to 7

    Returns
    -------
    Coded design, shape (n, count), one centre point.

    References
    ----------
    Box & Behnken (1960), Technometrics 2, 455-475.
    """
    if not 3 <= count <= 7:
        raise InputError(
            "design",
            f"box_behnken with {count} numeric factors",
            "3 to 7 are possible",
            "Take central_composite (up to 8), or lhs.",
        )
    blocks = _BLOCKS.get(count) or list(itertools.combinations(range(count), 2))
    rows = []
    for block in blocks:
        for signs in itertools.product((-1.0, 1.0), repeat=len(block)):
            row = np.zeros(count)
            row[list(block)] = signs
            rows.append(row)
    return np.array([*rows, np.zeros(count)])


def plackett_burman(count: int) -> np.ndarray:
    """Two-level screening design folded over, so that main effects are clear of two-factor interactions.

    Parameters
    ----------
    count : number of factors, 1 to 47

    Returns
    -------
    Coded design, shape (2 m, count), m the smallest Hadamard order above `count`: a power of two (Sylvester)
    or q + 1 with a prime q = 3 mod 4 (Paley).

    References
    ----------
    Plackett & Burman (1946), Biometrika 33, 305-325; Box & Wilson (1951) for the fold-over.
    """
    if not 1 <= count <= 47:
        raise InputError("design", f"plackett_burman with {count} factors", "1 to 47 are possible")
    order = next(m for m in (2, 4, 8, 12, 16, 20, 24, 32, 44, 48) if m > count)
    half = _hadamard(order)[:, 1 : count + 1]
    return np.concatenate([half, -half])


def _hadamard(order: int) -> np.ndarray:
    """A Hadamard matrix whose first column is constant, shape (order, order)."""
    if order & (order - 1) == 0:
        matrix = np.ones((1, 1))
        while len(matrix) < order:
            matrix = np.block([[matrix, matrix], [matrix, -matrix]])
        return matrix
    q = order - 1
    squares = {i * i % q for i in range(1, q)}
    legendre = np.array([0.0] + [1.0 if i in squares else -1.0 for i in range(1, q)])
    skew = legendre[(np.arange(q)[:, None] - np.arange(q)[None, :]) % q]
    matrix = np.ones((order, order))
    matrix[1:, 1:] = skew + np.eye(q)
    matrix[0, 1:] = 1.0
    matrix[1:, 0] = -1.0
    matrix[1:] *= -1.0  # first column to +1 (rows may change their sign)
    return matrix
