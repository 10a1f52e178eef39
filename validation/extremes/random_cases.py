"""Random extreme cases: log-uniform over all parameters at once, far beyond built rollers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from trackroller.errors import InputError
from trackroller.roller.case import Case


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _material(rng: np.random.Generator) -> dict[str, Any]:
    nu = (0.0, 0.5, 0.3, rng.uniform(0, 0.5), 0.5 - _log(rng, 1e-12, 0.1))[rng.integers(5)]
    return {
        "name": "any",
        "youngs_modulus": _log(rng, 1e-3, 3e5),
        "poisson_ratio": float(nu),
        "tensile_strength": _log(rng, 0.1, 4e4),
        "fatigue_strength_ratio": float(rng.uniform(0.05, 0.95)),
        "cycles_at_tensile_strength": 1e4,
        "cycles_at_fatigue_limit": 5e6,
    }


def _draw(rng: np.random.Generator) -> dict[str, Any]:
    alpha = (0.01, 89.99, rng.uniform(0.01, 89.99), _log(rng, 0.01, 45), 90 - _log(rng, 0.01, 45))[rng.integers(5)]
    cosine, tangent = math.cos(math.radians(alpha)), math.tan(math.radians(alpha))
    guide = _log(rng, 1e-3, 1e4)
    radius = guide * cosine * _log(rng, 1e-3, 1e3)
    groove = (-guide * (1 + _log(rng, 1e-6, 1e2)), guide * _log(rng, 1e-3, 1e3), math.inf)[rng.integers(3)]
    curve = (math.inf, -math.inf, radius * _log(rng, 1e-3, 1e4), -radius * (1 + _log(rng, 1e-6, 1e4)))[rng.integers(4)]
    force, sign = _log(rng, 1e-3, 1e6), float(rng.choice([-1, 1]))
    axial = (0.0, sign * force * _log(rng, 1e-9, 1e1), force * tangent * rng.uniform(-1.1, 1.1))[rng.integers(3)]
    mu = (0.0, _log(rng, 1e-12, 2), rng.uniform(0, 1))[rng.integers(3)]
    motor = (0.0, sign * force * _log(rng, 1e-9, 1e1), force * mu * rng.uniform(-1.2, 1.2))[rng.integers(3)]
    return {
        "axis_distance": radius + guide * cosine,
        "guide_profile_radius": guide,
        "roller_profile_radius": groove,
        "guide_curve_radius": curve,
        "contact_angle": float(alpha),
        "radial_force": -force,
        "axial_force": float(axial),
        "motor_force": float(motor),
        "friction_coefficient": float(mu),
        "velocity": _log(rng, 1e-3, 1e4),
        "guide_overrollings_per_hour": _log(rng, 1e-2, 1e4),
        "roller_material": _material(rng),
        "guide_material": _material(rng),
    }


def random_extremes(count: int, seed: int) -> list[dict[str, Any]]:
    """Return `count` valid cases; cases whose surfaces conform or interlock are drawn again."""
    rng = np.random.default_rng(seed)
    found: list[dict[str, Any]] = []
    while len(found) < count:
        case = _draw(rng)
        try:
            Case.from_dict(case)
        except InputError:
            continue
        found.append(case)
    return found
