"""A wheel that rolls freely in a straight groove, by Hertz's patch and the slip of its curved surface (Heathcote)."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import brentq

from trackroller.contact.hertz import exact_shape
from trackroller.contact.kalker import Creepage, KalkerSettings, solve_patch
from trackroller.contact.kalker.problem import PatchSolution
from trackroller.contact.quantities import Elastic, Ellipse
from trackroller.contact.slip import Slip

ONE = np.ones(1)
ROLLING_RADIUS, LATERAL_RADIUS = 420.0, 10.0  # of the wheel [mm]
NORMAL_FORCE, FRICTION, SPEED = 1e4, 0.3, 420.0  # [N], [1], [mm/s]
SHEAR_MODULUS, POISSON_RATIO = 80e3, 0.28


def hertz(groove_radius: float) -> Ellipse:
    """Return Hertz's ellipse of the wheel in a groove of this radius [mm]."""
    modulus = SHEAR_MODULUS / (1.0 - POISSON_RATIO)  # E*, of like bodies G/(1 - nu)
    curvature = 1.0 / LATERAL_RADIUS - 1.0 / groove_radius
    return exact_shape(curvature * ONE, ONE / ROLLING_RADIUS, modulus * ONE).at(NORMAL_FORCE * ONE)


def solved(ellipse: Ellipse, creepage: float, elements: int = 40) -> PatchSolution:
    """Return the solution of the wheel at a longitudinal creepage, with the slip of its curved surface."""
    across = creepage * ROLLING_RADIUS * ONE
    slip = Slip(0.0 * ONE, ONE, LATERAL_RADIUS * ONE, ROLLING_RADIUS * ONE, across)
    creep = Creepage(creepage * ONE, 0.0 * ONE, 0.0 * ONE, slip)
    elastic = Elastic(SHEAR_MODULUS * ONE, POISSON_RATIO * ONE, 0.0 * ONE)
    return solve_patch(ellipse, creep, FRICTION * ONE, elastic, KalkerSettings(elements, tolerance=1e-8))


def rolls_freely(groove_radius: float, elements: int = 40) -> dict[str, Any]:
    """Return sizes, pressure, creepage and friction power of the wheel where its driving force vanishes.

    Parameters
    ----------
    groove_radius : float
        Radius of the groove [mm].
    elements : int
        Elements across the patch.

    Returns
    -------
    dict
        `half_width`, `half_length` [mm], `max_pressure` [MPa], `creepage` [1], `friction_power` [W],
        `rolling_resistance` [N], which is the friction power over the speed.
    """
    ellipse = hertz(groove_radius)
    a = float(ellipse.semi_axis_lateral[0])
    span = a * a / (LATERAL_RADIUS * ROLLING_RADIUS)

    def force(creepage: float) -> float:
        return float(solved(ellipse, creepage, elements).resultants.driving_force[0])

    free = brentq(force, -span, span, xtol=1e-9)
    resistance = float(solved(ellipse, free, elements).works.dissipated[0])
    return {
        "half_width": a,
        "half_length": float(ellipse.semi_axis_rolling[0]),
        "max_pressure": float(ellipse.max_pressure[0]),
        "creepage": float(free),
        "friction_power": resistance * SPEED * 1e-3,
        "rolling_resistance": resistance,
    }
