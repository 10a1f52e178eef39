"""Classical designs in coded units: -1 and +1 are the ends of a factor's range, 0 its middle.

pyDOE gives the central composite designs and the Box-Behnken designs of 3 to 5 factors. This module has what pyDOE
lacks: for 6 and 7 factors the published Box-Behnken blocks (49 and 57 rows; pyDOE combines all pairs: 61 and 85), and
Plackett-Burman designs for each number of factors up to 47 (pyDOE fails for 24 to 27, 32 to 35 and 40 to 43).
"""

from __future__ import annotations

import itertools

import numpy as np
from pydoe import bbdesign, ccdesign
from scipy.linalg import hadamard

from trackroller.errors import InputError

# Box & Behnken (1960): the factors that vary together in one block
_BLOCKS: dict[int, tuple[tuple[int, int, int], ...]] = {
    6: ((0, 1, 3), (1, 2, 4), (2, 3, 5), (0, 3, 4), (1, 4, 5), (0, 2, 5)),
    7: ((3, 4, 5), (0, 5, 6), (1, 4, 6), (0, 1, 3), (2, 3, 6), (0, 2, 4), (1, 2, 5)),
}

_RANGE = "Give the factors ranges, such as {uniform: [low, high]}; a list of values is no numeric factor."


def central_composite(count: int) -> np.ndarray:
    """Return a face-centred central composite design: corners, face centres, centre.

    Parameters
    ----------
    count : number of factors, 1 to 8

    Returns
    -------
    Coded design, shape (2**count + 2 count + 1, count). A deterministic solver needs only one centre point.

    Raises
    ------
    InputError : another number of factors

    References
    ----------
    Box & Wilson (1951), J. R. Stat. Soc. B 13, 1-45.
    """
    if not 1 <= count <= 8:
        raise InputError(
            "design",
            f"central_composite with {count} numeric factors",
            "1 to 8 numeric factors",
            "Screen the factors first (morris or plackett_burman) and keep the influential ones." if count else _RANGE,
        )
    if count == 1:  # pyDOE needs two factors
        return np.array([[-1.0], [1.0], [-1.0], [1.0], [0.0]])
    return np.asarray(ccdesign(count, center=(0, 1), face="ccf"))


def box_behnken(count: int) -> np.ndarray:
    """Return a Box-Behnken design: three levels of each factor, no corner.

    Parameters
    ----------
    count : number of factors, 3 to 7

    Returns
    -------
    Coded design, shape (n, count), with one centre point.

    Raises
    ------
    InputError : another number of factors

    References
    ----------
    Box & Behnken (1960), Technometrics 2, 455-475.
    """
    if not 3 <= count <= 7:
        raise InputError(
            "design",
            f"box_behnken with {count} numeric factors",
            "3 to 7 numeric factors",
            "Use central_composite (up to 8 factors), or lhs." if count else _RANGE,
        )
    if count not in _BLOCKS:
        return np.asarray(bbdesign(count, center=1))
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    rows = np.zeros((len(_BLOCKS[count]) * len(signs) + 1, count))
    for number, block in enumerate(_BLOCKS[count]):
        rows[number * len(signs) : (number + 1) * len(signs), block] = signs
    return rows


def plackett_burman(count: int) -> np.ndarray:
    """Return a folded two-level screening design, whose main effects are clear of two-factor interactions.

    Parameters
    ----------
    count : number of factors, 1 to 47

    Returns
    -------
    Coded design, shape (2 m, count), m the smallest Hadamard order above `count`: a power of two (Sylvester)
    or q + 1 with a prime q = 3 mod 4 (Paley).

    Raises
    ------
    InputError : another number of factors

    References
    ----------
    Plackett & Burman (1946), Biometrika 33, 305-325; Box & Wilson (1951) for the fold-over.
    """
    if not 1 <= count <= 47:
        raise InputError("design", f"plackett_burman with {count} factors", "1 to 47 factors", "Use morris.")
    order = next(m for m in (2, 4, 8, 12, 16, 20, 24, 32, 44, 48) if m > count)
    matrix = hadamard(order, float) if order & (order - 1) == 0 else _paley(order)
    half = matrix[:, 1 : count + 1]
    return np.concatenate([half, -half])


def _paley(order: int) -> np.ndarray:
    """Return the Hadamard matrix of Paley's first construction, shape (order, order), first column +1."""
    q = order - 1
    squares = {i * i % q for i in range(1, q)}
    legendre = np.array([0.0] + [1.0 if i in squares else -1.0 for i in range(1, q)])
    matrix = np.ones((order, order))
    matrix[1:, 1:] = -(legendre[(np.arange(q)[:, None] - np.arange(q)) % q] + np.eye(q))
    return matrix
