"""Declare the numbers that describe one contact by itself, for `trackroller.patch` and its file."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from trackroller.numerics.parameter import Parameter
from trackroller.parameters.numbers import PARAMETERS

_SMALL = 1e-9
_LARGE = 1e9
_CREEPAGE: dict[str, Any] = {"lower": -1.0, "upper": 1.0}
_ALL = (
    Parameter("normal_force", "F_N", "N", math.nan, "presses the bodies together", _SMALL, 1e12),
    Parameter(
        "curvature_rolling",
        "k_y",
        "1/mm",
        math.nan,
        "relative curvature in the rolling plane: the sum of 1/radius of both bodies",
        _SMALL,
        _LARGE,
    ),
    Parameter(
        "curvature_lateral",
        "k_x",
        "1/mm",
        math.nan,
        "relative curvature in the lateral plane; 0 for two discs, which need a width",
        0.0,
        _LARGE,
    ),
    Parameter("semi_axis_lateral", "a", "mm", math.nan, "semi-axis across the rolling direction", _SMALL, _LARGE),
    Parameter("semi_axis_rolling", "b", "mm", math.nan, "semi-axis in the rolling direction", _SMALL, _LARGE),
    Parameter("width", "w", "mm", math.nan, "width of two discs", _SMALL, _LARGE),
    Parameter(
        "longitudinal_creepage", "xi", "-", 0.0, "creepage in the rolling direction, > 0 braking body 1", **_CREEPAGE
    ),
    Parameter("lateral_creepage", "eta", "-", 0.0, "creepage across the rolling direction", **_CREEPAGE),
    Parameter("spin", "phi", "1/mm", 0.0, "spin creepage about the contact normal", -_LARGE, _LARGE),
    Parameter("friction_coefficient", "mu", "-", math.nan, "Coulomb coefficient, at rest", 0.0, 2.0),
    PARAMETERS["layer_flexibility"],
    replace(PARAMETERS["velocity"], meaning="for friction power and friction laws only"),
)
PATCH_FIELDS: dict[str, Parameter] = {own.name: own for own in _ALL}
CREEPAGES = ("longitudinal_creepage", "lateral_creepage", "spin")
