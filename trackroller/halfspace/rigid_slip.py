"""Rigid slip of a roller on its guide in full sliding: the formulas of eqs (20)-(25), each once.

Other rooms import these formulas from `trackroller.contact.slip`. They stand here because the
stress kernels of this room need them as well, and a room imports only from the rooms below it.
Every function takes floats in compiled code and floats or arrays in plain Python, with the same
digits.

Frame: x_C lateral, y_C in the rolling direction (Kalker and CONTACT use x for rolling). Slip is the
velocity of the roller relative to the guide over the angular speed omega, in mm.

References
----------
Wenzel, Bienefeld, Kretschmer, Kirchner (2022): Introducing an open-source simulation model for
track rollers considering friction. Applied Mechanics 3, 692-704, eqs (20)-(25).
doi:10.3390/applmech3020041
"""

from __future__ import annotations

import numpy as np

from trackroller.numerics.compiled import fast_formula, formula

_TINY = 1e-300  # keeps the slopes of a pole outside the patch finite


@formula
def profile_slip(x, sine, cosine, radius):
    """Return the rolling slip v_y/omega of the circular guide profile, eq. (20) [mm].

    Eq. (20) reads sqrt(r^2 - (x cos(alpha) + r sin(alpha))^2) - r cos(alpha). The form below does
    not cancel at small x. ASSUME: beyond the equator of the profile the slip keeps the value that
    it has at the equator.

    Parameters
    ----------
    x : float or ndarray
        Lateral position x_C [mm].
    sine, cosine : float or ndarray
        Of the signed contact angle, +alpha in contact 1 and -alpha in contact 2.
    radius : float or ndarray
        Guide profile radius r_C,G [mm].

    Returns
    -------
    float or ndarray
        Slip over omega [mm].
    """
    deep = x * cosine * (2.0 * radius * sine + x * cosine)
    deepest = radius * radius * cosine * cosine
    return -np.minimum(deep, deepest) / (np.sqrt(np.maximum(deepest - deep, 0.0)) + radius * cosine)


@formula
def rolling_slip(x, sine, cosine, radius, shift):
    """Return the rolling slip v_y/omega, eq. (21) [mm]: eq. (20) and the rolling radius shift
    x_spin sin(alpha).

    The paper misprints r_C,G sin(alpha) under the root as r_C,G - sin(alpha).

    Parameters
    ----------
    x, sine, cosine, radius : float or ndarray
        See `profile_slip`.
    shift : float or ndarray
        Rolling radius shift r_Delta0 [mm].

    Returns
    -------
    float or ndarray
        Slip over omega [mm].
    """
    return shift + profile_slip(x, sine, cosine, radius)


@fast_formula
def rolling_slip_without_division(x, sine, cosine, radius, shift):
    """Return `rolling_slip` as eq. (21) writes it; the stress kernels take it at millions of
    points.

    The division of `rolling_slip` makes these kernels 15 % slower. This form cancels at small x:
    its absolute error is 1e-16 r cos(alpha).
    """
    flat = radius * cosine
    deep = np.minimum(x * cosine * (2.0 * radius * sine + x * cosine), flat * flat)
    return (shift - flat) + np.sqrt(flat * flat - deep)


@formula
def slip_zeros(sine, cosine, radius, shift):
    """Return the two lateral positions where the rolling slip of eq. (21) vanishes [mm]; NaN where
    it does not.

    The first one lies near the spin pole, the second one on the other side of the guide's crest.
    """
    product = 2.0 * radius * cosine * shift - shift * shift
    # a shift below the equator has no zero: the root of its negative distance makes the result NaN
    above_equator = 0.0 * np.sqrt(radius * cosine - shift)
    reach = np.sqrt(radius * radius * sine * sine + product) + radius * np.abs(sine) + above_equator
    return np.sign(sine) * product / reach / cosine, -np.sign(sine) * reach / cosine


@formula
def pole_lateral(shift, sine):
    """Return the lateral position x_spin of the spin pole, eq. (23) [mm].

    Parameters
    ----------
    shift : float or ndarray
        Rolling radius shift r_Delta0 [mm].
    sine : float or ndarray
        Of the signed contact angle.
    """
    return shift / sine


@formula
def pole_rolling(x_spin, a, b):
    """Return y_spin of a spin pole on the trailing edge, eq. (22) [mm]; 0 for a pole outside the
    patch.

    Parameters
    ----------
    x_spin : float or ndarray
        Lateral position of the pole from the middle of the patch [mm].
    a, b : float or ndarray
        Lateral and rolling semi-axis [mm].
    """
    return 0.0 - b * np.sqrt(np.maximum(1.0 - (x_spin / a) ** 2, 0.0))


@formula
def pole_line(a, x_spin, y_spin, model):
    """Return the coefficients of the line of poles y_delta(x), see `pole_offset`.

    `model` is the paper's assumption: 0 concentric, 1 pole on the edge, eq. (22), 2 skewed, eq.
    (25).
    """
    if model == 0:
        return 0.0 * y_spin, 0.0 * y_spin, 0.0 * y_spin
    if model == 1:
        return y_spin, 0.0 * y_spin, 0.0 * y_spin
    return (
        0.0 * y_spin,
        y_spin / np.maximum(x_spin + a, _TINY),
        y_spin / np.minimum(x_spin - a, -_TINY),
    )


@formula
def pole_offset(x, a, k0, k1, k2):
    """Return y_delta(x), where the lateral slip vanishes, eq. (25) [mm].

    Eq. (25) rises from 0 at the edges x = -a and x = a to y_spin at the pole. As y_spin <= 0, its
    branch is the larger one of both lines.
    """
    return k0 + np.maximum(k1 * (x + a), k2 * (x - a))


@formula
def lateral_slip(y, offset, sine):
    """Return the lateral slip v_x/omega, eq. (24) [mm], with the `offset` y_delta of
    `pole_offset`.
    """
    return sine * (y - offset)
