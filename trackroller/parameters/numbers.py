"""Declare the numbers that describe a case, in the units that a user writes: degrees, m/min and
hours.
"""

from __future__ import annotations

import math
from typing import Any

from trackroller.damage import LIMITS, first_limit, with_limits
from trackroller.numerics.parameter import Parameter

POSITIVE: dict[str, Any] = {"lower": 0.0, "open_lower": True}
# Bounds far outside of what is built. Beyond them the digits of a double do not carry the balance
# of forces.
_LENGTH: dict[str, Any] = {"lower": 1e-6, "upper": 1e8}
_RATE: dict[str, Any] = {"lower": 1e-9, "upper": 1e9}
_FORCE: dict[str, Any] = {"lower": -1e12, "upper": 1e12}
_USE: dict[str, Any] = {"role": "condition"}
_ALL = (
    Parameter(
        "axis_distance",
        "A_T",
        "mm",
        21.75,
        "roller axis to the centre of the guide contour",
        **_LENGTH,
    ),
    Parameter(
        "guide_profile_radius", "r_C,G", "mm", 6.0, "radius of the convex guide contour", **_LENGTH
    ),
    Parameter(
        "roller_profile_radius",
        "r_C,TR",
        "mm",
        -7.0,
        "< 0 concave groove, > 0 convex, inf straight",
        allow_infinite=True,
        nonzero=True,
    ),
    Parameter(
        "guide_curve_radius",
        "r_Curve",
        "mm",
        220.0,
        "curvature of the track: inf straight, > 0 convex towards the roller (outer wheel), < 0 "
        "concave (inner wheel)",
        allow_infinite=True,
        nonzero=True,
        **_USE,
    ),
    Parameter(
        "contact_angle",
        "alpha",
        "deg",
        30.0,
        "inclination of the contact normals",
        lower=1e-6,
        upper=90.0,
        open_upper=True,
    ),
    Parameter(
        "radial_force",
        "F_rad",
        "N",
        -200.0,
        "< 0 presses the roller on the guide",
        lower=-1e12,
        upper=0.0,
        open_upper=True,
        **_USE,
    ),
    Parameter("axial_force", "F_ax", "N", 30.0, "along +x_R", **_FORCE, **_USE),
    Parameter(
        "motor_force",
        "F_Motor",
        "N",
        -30.0,
        "< 0 driving, 0 free rolling, > 0 braking",
        **_FORCE,
        **_USE,
    ),
    Parameter(
        "friction_coefficient",
        "mu",
        "-",
        0.3,
        "Coulomb coefficient of both contacts, at rest; null: from the friction database; left "
        "out beside a "
        "friction_law of kind table: the first of the table",
        0.0,
        2.0,
        allow_missing=True,
        words=("typical", "upper", "lower", "dry", "lubricated"),
        **_USE,
    ),
    Parameter(
        "layer_flexibility",
        "h/G_3",
        "mm3/N",
        0.0,
        "thickness over shear modulus of a film between the bodies, such as wear debris; 0 is no "
        "film",
        0.0,
        1e3,
        label="flexibility of a film",
        **_USE,
    ),
    Parameter(
        "velocity",
        "v",
        "m/min",
        60.0,
        "for friction power, life in hours and friction laws only",
        label="mean travel speed",
        afterwards=True,
        **_RATE,
        **_USE,
    ),
    Parameter(
        "guide_overrollings_per_hour",
        "n_G",
        "1/h",
        math.nan,
        "decides the life of the guide in hours; not given: hours are NaN",
        allow_missing=True,
        label="overrollings of a guide point per hour",
        afterwards=True,
        **_RATE,
        **_USE,
    ),
)

# They change lives and utilisations; forces and stresses do not depend on them.
OF_LIMITS: dict[str, Parameter] = {
    own.name: own
    for own in (
        *(own for limit in LIMITS.values() for own in limit.parameters),
        first_limit.POSITION,
    )
}
PARAMETERS: dict[str, Parameter] = with_limits(
    {p.name: p for p in _ALL}, OF_LIMITS.values(), "a parameter"
)
