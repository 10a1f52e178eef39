"""Wear of roller and guide: depth of one overrolling by Archard's law."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike


def wear_depth(pressure: np.ndarray, slip_speed: np.ndarray, spacing: np.ndarray, coefficient: ArrayLike) -> np.ndarray:
    """Return the depth that one overrolling wears off at each lateral place, by Archard's law.

    Parameters
    ----------
    pressure : numpy.ndarray
        p at the centres of elements, (n, contact, y, x) [MPa].
    slip_speed : numpy.ndarray
        Local slip |s| per distance travelled, (n, contact, y, x) [1].
    spacing : numpy.ndarray
        Length of an element along the rolling direction, (n, contact) [mm].
    coefficient : array_like
        Wear coefficient k of the body, (n, contact) or (n,) [mm3/(N m)].

    Returns
    -------
    numpy.ndarray
        delta(x) = 1e-3 k int p |s| dy, (n, contact, x) [mm].

    Notes
    -----
    The sum over the elements is exact for tractions that are constant in each element.

    References
    ----------
    Archard, J. F. (1953). Contact and rubbing of flat surfaces. Journal of Applied Physics 24, 981-988,
    doi:10.1063/1.1721448.

    Examples
    --------
    >>> pressure = np.full((1, 1, 4, 2), 100.0)
    >>> wear_depth(pressure, 0.01 + 0.0 * pressure, np.array([[0.25]]), 1e-5)
    array([[[1.e-08, 1.e-08]]])
    """
    worn = np.einsum("...yx,...yx->...x", pressure, slip_speed) * np.asarray(spacing)[..., None]
    k = np.asarray(coefficient, float)
    return np.asarray(1e-3 * k.reshape(k.shape + (1,) * (worn.ndim - k.ndim)) * worn)
