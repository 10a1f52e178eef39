"""The errors of Hertz's theory in close fits, where the groove follows the guide over a part of its circle.

Two witnesses, of which the more cautious one counts. A pin in a hole of like material without friction (Persson 1964)
is plane, and its largest pressure exceeds Hertz's by 3.7, 8.1 and 15 % at a/R = 0.31, 0.46 and 0.63. Bodies of wheel
and groove with their true curvature (CONTACT, after Li 2002 and Blanco-Lorenzo; `validation/measured`) exceed it by
0.6, 1.6 and 3.4 % at 0.30, 0.47 and 0.64, on elements of 0.25 mm. a is Hertz's lateral semi-axis, and R the smaller
lateral radius of both bodies.
"""

from __future__ import annotations

import numpy as np

CLOSEST = 0.65  # largest a/R of the witnesses
PLAIN = 0.3  # largest a/R of any pair of bodies, and largest b over a radius, for half-spaces
# Each error is a factor times (a/R)^2, as both witnesses approach Hertz's theory, up to a largest value.
PRESSURE = 0.4, np.inf  # by the pin in the hole: Hertz's pressure is too low
WIDTH = 1.0, 0.11  # by the grooves, half an element included: Hertz's patch is too wide
LENGTH = 0.2, 0.03  # by the grooves: Hertz's patch is too short
SLIP_POWER = 2.4, 0.26  # by the grooves: Hertz's patch slips too much in free rolling
LAWS = {  # by the result whose relative error it is
    "pressure_model_error": PRESSURE,
    "peak_stress_model_error": PRESSURE,  # stresses are in proportion to the pressure
    "semi_axis_model_error": WIDTH,
    "semi_axis_rolling_model_error": LENGTH,
    "friction_power_model_error": SLIP_POWER,
}


def conformity(semi_axis_lateral, radius_1, radius_2) -> np.ndarray:
    """Return a over the smaller lateral radius of both bodies.

    Parameters
    ----------
    semi_axis_lateral : ndarray, shape (n, 2)
        Hertz's semi-axis across the rolling direction in both contacts [mm].
    radius_1, radius_2 : ndarray, shape (n,)
        Lateral radii of both bodies [mm], of any sign; inf if straight.

    Returns
    -------
    numpy.ndarray, shape (n, 2)
        a/R [1].
    """
    smaller = np.minimum(np.abs(radius_1), np.abs(radius_2))
    return np.asarray(semi_axis_lateral / smaller[:, None])


def model_error(ratio: np.ndarray, law: tuple[float, float]) -> np.ndarray:
    """Return the relative error of Hertz's theory at a/R; NaN beyond the witnesses.

    Parameters
    ----------
    ratio : ndarray
        a/R [1], see `conformity`.
    law : tuple of float
        Factor and largest value: `PRESSURE`, `WIDTH`, `LENGTH` or `SLIP_POWER`.
    """
    factor, largest = law
    with np.errstate(invalid="ignore"):
        return np.where(ratio <= CLOSEST, np.minimum(factor * ratio**2, largest), np.nan)


def widest(roller_radius: np.ndarray) -> np.ndarray:
    """Return the largest a/R that is judged, (n,): `CLOSEST` for a groove, whose radius is < 0, and `PLAIN` else."""
    return np.where(roller_radius < 0.0, CLOSEST, PLAIN)
