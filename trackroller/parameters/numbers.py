"""Declare the numbers that describe a case, in the units that a user writes: degrees, m/min and hours."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from trackroller.parameters.declared import declared

if TYPE_CHECKING:
    import numpy as np

SMALLEST = 1e-6  # least size of a number that must not be 0


@dataclass(frozen=True)
class Parameter:
    """A number that describes a case or a material.

    Parameters
    ----------
    name, symbol, unit : str
        Name in Python and in files, symbol of the publication, unit ("-" for none).
    default : float
        Value of a case that does not give it; NaN if there is none.
    meaning : str
        Explanation for the documentation.
    lower, upper : float
        Bounds, which are allowed values themselves unless `open_lower` or `open_upper` is True.
    allow_infinite, allow_missing, nonzero : bool
        Whether +-inf is allowed, whether the value may be left out (None or NaN), and whether 0 is refused, with all
        numbers that are smaller than `SMALLEST`.
    label : str
        Name for figures and reports, if it differs from `name`.
    role : str
        Who sets the value: the designer (`choice`) or the use of the roller (`condition`).
    """

    name: str
    symbol: str
    unit: str
    default: float
    meaning: str
    lower: float = -math.inf
    upper: float = math.inf
    open_lower: bool = False
    open_upper: bool = False
    allow_infinite: bool = False
    allow_missing: bool = False
    nonzero: bool = False
    label: str = ""
    role: str = "choice"

    @property
    def long_name(self) -> str:
        """Return the name for figures and reports."""
        return self.label or self.name.replace("_", " ")

    @property
    def units(self) -> str:
        """Return the unit as the CF conventions write it."""
        return {"deg": "degree", "-": "1", "m/min": "m min-1", "1/h": "h-1"}.get(self.unit, self.unit)

    def allowed(self) -> str:
        """Return what is allowed, in words."""
        unit = "" if self.unit == "-" else f" {self.unit}"
        parts = []
        if math.isfinite(self.lower):
            parts.append(f"{'>' if self.open_lower else '>='} {self.lower:g}{unit}")
        if math.isfinite(self.upper):
            parts.append(f"{'<' if self.open_upper else '<='} {self.upper:g}{unit}")
        if self.nonzero:
            parts.append(f"not 0 (at least {SMALLEST:g}{unit} in size)")
        parts.append("finite or inf" if self.allow_infinite else "finite")
        return f"{self.long_name} [{self.unit}] must be a number, " + ", ".join(parts)

    def remedy(self, value: float) -> str:
        """Return what to write instead of a value that only has the wrong sign; '' for any other value."""
        if not math.isfinite(value) or not self.accepts(-value):
            return ""
        return f"Write {-value:g}." + (f" The sign means: {self.meaning}." if "0 " in self.meaning else "")

    def accepts(self, value: np.ndarray | float) -> Any:
        """Return which values are allowed, elementwise, a bool array of the shape of `value`; a bool for a number."""
        if isinstance(value, (float, int)):  # arrays of one number would take most of the time of a case's checks
            return self._allows(value, math.isnan(value), not math.isinf(value))
        import numpy as np  # noqa: PLC0415 - the help of the command line needs no arrays and starts faster without

        v = np.asarray(value, dtype=float)
        return self._allows(v, np.isnan(v), ~np.isinf(v))

    def _allows(self, v: Any, missing: Any, bounded: Any) -> Any:
        """Return whether a number, or which of an array of numbers, is allowed; see `accepts`."""
        good = (v > self.lower) if self.open_lower else (v >= self.lower)
        good = good & ((v < self.upper) if self.open_upper else (v <= self.upper))
        if self.nonzero:
            good = good & (abs(v) >= SMALLEST)
        if not self.allow_infinite:
            good = good & bounded
        return good | missing if self.allow_missing else good


POSITIVE: dict[str, Any] = {"lower": 0.0, "open_lower": True}
# Bounds far outside of what is built. Beyond them the digits of a double do not carry the balance of forces.
_LENGTH: dict[str, Any] = {"lower": 1e-6, "upper": 1e8}
_RATE: dict[str, Any] = {"lower": 1e-9, "upper": 1e9}
_FORCE: dict[str, Any] = {"lower": -1e12, "upper": 1e12}
_USE: dict[str, Any] = {"role": "condition"}
_ALL = (
    Parameter("axis_distance", "A_T", "mm", 21.75, "roller axis to the centre of the guide contour", **_LENGTH),
    Parameter("guide_profile_radius", "r_C,G", "mm", 6.0, "radius of the convex guide contour", **_LENGTH),
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
        "curvature of the track: inf straight, > 0 convex towards the roller (outer wheel), < 0 concave (inner wheel)",
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
    Parameter("motor_force", "F_Motor", "N", -30.0, "< 0 driving, 0 free rolling, > 0 braking", **_FORCE, **_USE),
    Parameter(
        "friction_coefficient",
        "mu",
        "-",
        0.3,
        "Coulomb coefficient of both contacts, at rest; null: from the friction database; left out beside a "
        "friction_law of kind table: the first of the table",
        0.0,
        2.0,
        allow_missing=True,
        **_USE,
    ),
    Parameter(
        "velocity",
        "v",
        "m/min",
        60.0,
        "for friction power, life in hours and friction laws only",
        label="mean travel speed",
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
        **_RATE,
        **_USE,
    ),
)

# They change lives and utilisations; forces and stresses do not depend on them.
OF_LIMITS: dict[str, Parameter] = {row["name"]: Parameter(**row) for row in declared()["parameters"]}
PARAMETERS: dict[str, Parameter] = {p.name: p for p in _ALL} | OF_LIMITS
