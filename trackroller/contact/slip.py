"""Where the slip of the sliding model vanishes, against where its empirical spin pole lies."""

from __future__ import annotations

import numpy as np


def pole_split(
    a: np.ndarray, sine: np.ndarray, cosine: np.ndarray, radius: np.ndarray, shift: np.ndarray
) -> np.ndarray:
    """Distance between the model's spin pole and where its slip vanishes, over a; shape (n,).

    The pole of eq. (22) lies where the tangent to the guide's profile has no slip, the slip of eq. (21) vanishes where
    the circle has none. Between them the empirical rule lets the shear turn askew, and the stress where the slip
    vanishes grows as a logarithm without bound. 0 where the pole lies outside the patch; inf for a second zero in it.

    Parameters
    ----------
    a : lateral semi-axis [mm]; sine, cosine : of the signed contact angle [1]; radius : r_C,G [mm]; shift : [mm]
    """
    with np.errstate(invalid="ignore"):
        pole = shift / sine
        product = 2.0 * radius * cosine * shift - shift * shift
        root = np.sqrt(radius * radius * sine * sine + product)
        reach = root + radius * np.abs(sine)
        zero, other = np.sign(sine) * product / reach / cosine, reach / cosine
        split = np.where((np.abs(pole) < a) & (np.abs(zero) < a), np.abs(zero - pole) / a, 0.0)
        return np.where(other < a, np.inf, split)
