"""Random samples of rollers that several benchmarks share."""

from __future__ import annotations

import math

import numpy as np

import trackroller as tr

PUBLISHED = ("1.7225-normalised", "1.7225-quenched-tempered", "EN AW-7075", "PA6", "POM")  # materials of the paper


def load_study(n: int, seed: int = 1) -> list[tr.Case]:
    """Return cases with varying load, friction and material, and fixed curvatures."""
    rng = np.random.default_rng(seed)
    steel = "1.7225-normalised"
    materials = (steel, "PA6", "POM", "EN AW-7075")
    return [
        tr.Case(
            friction_coefficient=rng.uniform(0.02, 0.4),
            axial_force=rng.uniform(-30, 30),
            motor_force=rng.uniform(-20, 20),
            radial_force=-rng.uniform(100, 300),
            roller_material=str(rng.choice(materials)),
            guide_material=steel,
        )
        for _ in range(n)
    ]


def geometry_study(n: int, seed: int = 2) -> list[tr.Case]:
    """Return cases in which every curvature is new."""
    rng = np.random.default_rng(seed)
    return [
        tr.Case(
            friction_coefficient=rng.uniform(0.02, 0.4),
            axial_force=rng.uniform(-30, 30),
            motor_force=rng.uniform(-20, 20),
            contact_angle=rng.uniform(20, 60),
            axis_distance=rng.uniform(15, 40),
            roller_profile_radius=-rng.uniform(6.2, 12),
            guide_curve_radius=float(rng.choice([np.inf, 220, 60, -300])),
        )
        for _ in range(n)
    ]


def random_designs(n: int, seed: int) -> list[tr.Case]:
    """Return n random rollers of all shapes, tracks and frictions, and of all pairs of the paper's materials."""
    rng = np.random.default_rng(seed)
    names = PUBLISHED  # a material that is added changes no design
    found = []
    for _ in range(n):
        angle, contour = rng.uniform(10.0, 75.0), 10.0 ** rng.uniform(0.3, 1.3)
        radius = contour * 10.0 ** rng.uniform(-0.1, 1.0)
        outer = 10.0 ** rng.uniform(math.log10(20.0), 3.5)
        inner = -radius * 10.0 ** rng.uniform(math.log10(1.2), 2.0)
        friction, radial = 10.0 ** rng.uniform(-2.0, 0.0), -contour * rng.uniform(5.0, 60.0)
        found.append(
            tr.Case(
                axis_distance=radius + contour * math.cos(math.radians(angle)),
                guide_profile_radius=contour,
                roller_profile_radius=-contour * 1.02 * (2.0 / 1.02) ** rng.uniform(),
                guide_curve_radius=float(rng.choice([math.inf, outer, inner])),
                contact_angle=angle,
                radial_force=radial,
                axial_force=radial * rng.uniform(-0.5, 0.5) * math.tan(math.radians(angle)),
                motor_force=rng.choice([0.0, rng.uniform(-0.8, 0.8) * friction * radial]),
                friction_coefficient=friction,
                roller_material=str(rng.choice(names)),
                guide_material=str(rng.choice(names)),
            )
        )
    return found


def ordinary_designs(n: int, seed: int) -> list[tr.Case]:
    """Return n random rollers as they are built: friction 0.05 to 0.4, contact angles 25 to 60 degrees, small offsets.

    Loads follow the square of the size. Materials are those of the paper, metals for the guide.
    """
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(n):
        angle, contour, friction = rng.uniform(25.0, 60.0), rng.uniform(3.0, 10.0), rng.uniform(0.05, 0.4)
        radial = -rng.uniform(30.0, 900.0) * (contour / 6.0) ** 2
        found.append(
            tr.Case(
                axis_distance=rng.uniform(12.0, 40.0),
                guide_profile_radius=contour,
                roller_profile_radius=-contour * (1.0 + 10.0 ** rng.uniform(-1.6, -0.1)),
                guide_curve_radius=float(rng.choice([math.inf, math.inf, 220.0, -300.0, 100.0])),
                contact_angle=angle,
                radial_force=radial,
                axial_force=-radial * rng.uniform(0.0, 0.3) * math.tan(math.radians(angle)),
                motor_force=float(rng.choice([0.0, rng.uniform(-0.3, 0.3) * friction * radial])),
                friction_coefficient=friction,
                roller_material=str(rng.choice(PUBLISHED)),
                guide_material=str(rng.choice(PUBLISHED[:3])),
            )
        )
    return found
