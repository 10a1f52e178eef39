"""The balance of both normal forces against radial and axial force, eqs (7), (9)."""

from __future__ import annotations

import numpy as np


def determinant(
    sine: np.ndarray, cosine: np.ndarray, one: np.ndarray, two: np.ndarray
) -> np.ndarray:
    """Return the determinant of eqs (7), (9) for the ratios F_T/F_N of contacts 1 (`one`) and 2
    (`two`), (n,).

    An error of F_T in one contact, divided by the determinant, is the error of F_N that it causes
    in the other contact.

    Examples
    --------
    >>> float(round(determinant(0.5, 0.75**0.5, 0.0, 0.0), 3))  # sin(2 alpha) without friction
    0.866
    """
    return 2.0 * sine * cosine * (1.0 + one * two) + (one - two) * (cosine - sine) * (cosine + sine)


def own_change(sine: np.ndarray, cosine: np.ndarray, beside: np.ndarray) -> np.ndarray:
    """Return the change of F_N with the own F_T of a contact, times the `determinant`, (n,).

    `beside` is F_T/F_N of the other contact; it and `sine` change their signs for contact 2.

    Examples
    --------
    >>> # at 45 degrees only by the friction of the other contact
    >>> float(round(own_change(0.5**0.5, 0.5**0.5, 0.2), 3))
    0.2
    """
    return np.abs((cosine - sine) * (cosine + sine) + 2.0 * sine * cosine * beside)
