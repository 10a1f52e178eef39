"""Compare results with each other against physical scales: a difference is what rounding cannot
explain.

Other processors add numbers in another order and fuse other products with sums, so that each
operation may differ in its last digit. A value that is zero by symmetry is then noise, and its
relative difference says nothing. A force is therefore compared with the load, a moment with the
load times the lever arm, a length with the semi-axis of the patch, and a stress with the largest
pressure.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from trackroller.roller.dataset import VARIABLES

if TYPE_CHECKING:
    import xarray as xr

    Scale = Callable[[xr.Dataset, str], xr.DataArray]

# Sums differ by 1e-15 of their terms. Iterations end at residuals up to 1e-7 and stop one step
# earlier or later, which changes their result by about as much. A changed formula, quadrature node
# or draw changes numbers by far more.
ROUNDING = 1e-6
# The search for a peak sums tractions in single precision (6e-8) and ends at a finite step, on a
# path that rounding may turn: between processors 2e-6 was measured, and 4e-5 at the edge of a flat.
# What is computed at the peak inherits it.
SEARCH = 1e-4
# A life is a power of the stress, with an exponent up to 30.
LIFE = 3e-3
# Around its maximum a stress is flat: a stress that is right to SEARCH has its place to about the
# square root of SEARCH, and 6e-3 of a semi-axis was measured between processors. The stress
# sections pass through this place, and stress components change by half the pressure over a
# semi-axis.
PLACE = 1e-2
SECTION = 3e-3
# An estimated error is the difference of nearly equal numbers plus the gain of the last step of a
# search.
ESTIMATE = 1e-3


# groups of results whose numbers are sums in double precision; limits start from tractions in
# single precision
SOLVED = ("forces", "contact", "friction_work", "tractions", "subsurface", "status")


class Difference(NamedTuple):
    """How far a variable of two data sets is apart.

    `apart` is the largest difference over its scale [1], `allowed` is what rounding may change, and
    `scale` names the scale. `apart` is inf where the second data set lacks the variable, a value or
    a word, and NaN where the first one lacks the variable.
    """

    apart: float
    allowed: float
    scale: str

    @property
    def exceeds_rounding(self) -> bool:
        """Return whether rounding cannot explain the difference."""
        return self.apart > self.allowed


def compare(one: xr.Dataset, two: xr.Dataset) -> dict[str, Difference]:
    """Return the difference of each variable of two data sets of results.

    Parameters
    ----------
    one, two : xarray.Dataset
        Results of the same cases. The first one gives the scales: with the parameters of the cases
        as variables or coordinates, forces are compared with the applied loads.

    Returns
    -------
    dict of str to Difference
        By variable, in alphabetical order.
    """
    names = sorted({*one.variables, *two.variables}, key=str)
    return {str(name): _difference(one, two, str(name)) for name in names}


def _difference(one: xr.Dataset, two: xr.Dataset, name: str) -> Difference:
    if name not in one.variables:
        return Difference(np.nan, 0.0, "")
    if name not in two.variables or one[name].shape != two[name].shape:
        return Difference(np.inf, 0.0, "")
    old = one[name].values
    new = two[name].values
    if old.dtype.kind not in "fc":
        if np.array_equal(_words(old), _words(new)):
            return Difference(0.0, 0.0, "")
        return Difference(np.inf, 0.0, "")
    return Difference(apart(old, new, scale(one, name)), allowed(name), _kind(name)[1])


def apart(old: np.ndarray, new: np.ndarray, against: np.ndarray) -> float:
    """Return the largest difference of two arrays over a scale (same shape) [1]; inf where only one
    is NaN or inf.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        same = (old == new) | (np.isnan(old) & np.isnan(new))
        over = np.where(same, 0.0, np.abs(old - new) / against)
    return float(np.max(np.where(np.isnan(over), np.inf, over), initial=0.0))


def _words(values: np.ndarray) -> np.ndarray:
    """Return texts without the residuals in them, which are what rounding leaves; other values as
    they are.
    """
    if values.dtype.kind not in "OSU":
        return values
    return np.array(
        [re.sub(r"residual [\d.e+-]+", "residual", str(text)) for text in values.ravel()]
    )


def allowed(name: str) -> float:
    """Return the difference over the scale that rounding can cause in a variable [1]."""
    return _kind(name)[0]


def scale(ds: xr.Dataset, name: str) -> np.ndarray:
    """Return the scale of each value of a variable, in its shape and unit; the value itself is the
    least scale.
    """
    own = abs(ds[name])
    return _larger(own, _kind(name)[2](ds, name)).transpose(*own.dims).values


def _larger(one: xr.DataArray, two: xr.DataArray) -> xr.DataArray:
    """Return the larger value of two arrays; a NaN counts as no value."""
    larger: Any = np.fmax  # its stubs do not know labelled arrays
    values: xr.DataArray = larger(one, two)
    return values


def _inside(ds: xr.Dataset, name: str, dims: tuple[str, ...]) -> xr.DataArray:
    """Return the largest magnitude of a variable in each case, and in each contact if this is one
    of `dims`.
    """
    values = abs(ds[name])
    keep = {"contact"} & {*dims}
    return values.max(
        [dim for dim in values.dims if dim in VARIABLES[name].dims and dim not in keep]
    )


def _dims(name: str) -> tuple[str, ...]:
    if name in VARIABLES:
        return VARIABLES[name].dims
    return ()


def _own(ds: xr.Dataset, name: str) -> xr.DataArray:
    return abs(ds[name])


def _one(ds: xr.Dataset, name: str) -> xr.DataArray:
    return 1.0 + 0.0 * abs(ds[name])


def _load(ds: xr.Dataset, name: str) -> xr.DataArray:
    """Return the applied forces, and those that the contacts carry [N]: a flat contact angle
    multiplies the loads.
    """
    loads: list[Any] = [
        _parameter(ds, load)
        for load in ("radial_force", "axial_force", "motor_force")
        if load in ds.variables or load in ds.attrs
    ]
    if "normal_force" in ds.variables:
        loads.append(ds["normal_force"].sum("contact"))
    return sum(loads, 0.0 * abs(ds[name]).fillna(0.0))


def _axis(ds: xr.Dataset) -> xr.DataArray | float:
    """Return the distance of the roller's axis [mm], NaN if the data set does not hold the
    parameters.
    """
    return _parameter(ds, "axis_distance")


def _parameter(ds: xr.Dataset, name: str) -> xr.DataArray | float:
    """Return the magnitude of a parameter, which is an attribute if all cases of a study share it;
    NaN if the data set does not hold it.
    """
    if name in ds.variables:
        return abs(ds[name])
    return abs(float(ds.attrs.get(name, np.nan)))


def _moment(ds: xr.Dataset, name: str) -> xr.DataArray:
    return _load(ds, name) * _axis(ds)


def _patch(ds: xr.Dataset, name: str, *along: str) -> xr.DataArray:
    """Return the semi-axis of the patch along a length, the larger one for depths [mm].

    It is about a hundredth of the distance of the roller's axis if the data set does not hold the
    patches.
    """
    sides = [f"semi_axis_{axis}" for axis in along or ("lateral", "rolling")]
    if not all(side in ds.variables for side in sides):
        return 0.01 * _axis(ds) + 0.0 * abs(ds[name]).fillna(0.0)
    lengths = [_inside(ds, side, _dims(name)) for side in sides]
    if len(lengths) == 1:
        return lengths[0]
    return _larger(*lengths)


def _lateral(ds: xr.Dataset, name: str) -> xr.DataArray:
    return _patch(ds, name, "lateral")


def _rolling(ds: xr.Dataset, name: str) -> xr.DataArray:
    return _patch(ds, name, "rolling")


def _creepage(ds: xr.Dataset, name: str) -> xr.DataArray:
    """Return by how much the creepage differs in the patch [1], about its semi-axis over the
    roller's radius.
    """
    if name == "slip":
        return _patch(ds, name) / _axis(ds)
    return _larger(
        *(_inside(ds, field, ("contact",)) for field in ("slip_lateral", "slip_rolling"))
    )


def _stress(ds: xr.Dataset, name: str) -> xr.DataArray:
    """Return the largest pressure of the contact [MPa], or the largest stress in it that the data
    set holds.
    """
    known = [
        stress
        for stress in ("max_pressure", "pressure", "peak_stress", name)
        if stress in ds.variables
    ]
    return _inside(ds, known[0], _dims(name))


def _field(ds: xr.Dataset, name: str) -> xr.DataArray:
    return _inside(ds, name, ("contact",))


Kind = tuple[float, str, "Scale"]
_OWN: Kind = ROUNDING, "the value", _own
_OF_SEARCH: Kind = SEARCH, "the value", _own
_OF_LIFE: Kind = LIFE, "the value", _own
_OF_ONE: Kind = ROUNDING, "1", _one
_ESTIMATED: Kind = ESTIMATE, "1", _one
_LENGTH, _LATERAL, _ROLLING = (
    (ROUNDING, "the semi-axis of the patch", own) for own in (_patch, _lateral, _rolling)
)
_PLACED, _PLACED_LATERAL, _PLACED_ROLLING = (
    (PLACE, "the semi-axis of the patch", own) for own in (_patch, _lateral, _rolling)
)
_CREEPAGE: Kind = ROUNDING, "the creepage in the patch", _creepage
_STRESS: Kind = ROUNDING, "the largest pressure", _stress
_SECTIONED: Kind = SECTION, "the largest pressure", _stress

_BY_UNIT: dict[str, Kind] = {
    "N": (ROUNDING, "the load", _load),
    "N mm": (ROUNDING, "the load times axis_distance", _moment),
    "h": _OF_LIFE,
}
_BY_NAME: dict[str, Kind] = {
    **dict.fromkeys(("rolling_radius_shift", "pressure_centre"), _LENGTH),
    **dict.fromkeys(("spin_pole_lateral", "patch_x"), _LATERAL),
    **dict.fromkeys(("spin_pole_rolling", "patch_y"), _ROLLING),
    **dict.fromkeys(("slip", "slip_lateral", "slip_rolling"), _CREEPAGE),
    **dict.fromkeys(("pressure", "shear_lateral", "shear_rolling", "max_shear"), _STRESS),
    # zero in adhesion
    "friction_energy_density": (ROUNDING, "the largest value in the patch", _field),
    **dict.fromkeys(
        ("residual", "energy_residual", "stick_area_fraction", "heat_partition"), _OF_ONE
    ),
    **dict.fromkeys(("surface_fatigue_index", "surface_fatigue_index_local"), _OF_ONE),
    "peak_stress": _OF_SEARCH,
    **dict.fromkeys(("peak_z", "wear_place", "xz_z", "yz_z"), _PLACED),
    **dict.fromkeys(("peak_x", "xz_x"), _PLACED_LATERAL),
    **dict.fromkeys(("peak_y", "yz_y"), _PLACED_ROLLING),
    **dict.fromkeys(("von_mises_xz", "von_mises_yz", "stress_xz", "stress_yz"), _SECTIONED),
    **dict.fromkeys(("life_cycles", "catalogue_life_km"), _OF_LIFE),
    "hysteresis_moment": _OF_SEARCH,  # no lever arm: far smaller than the moments of forces
}


def _kind(name: str) -> Kind:
    """Return tolerance, words for the scale, and scale of a variable: by its name, its unit, or its
    group.
    """
    if name in _BY_NAME or name not in VARIABLES:
        return _BY_NAME.get(name, _OWN)
    if VARIABLES[name].estimate:
        return _ESTIMATED
    by_group = _OF_SEARCH
    if VARIABLES[name].group in SOLVED:
        by_group = _OWN
    return _BY_UNIT.get(VARIABLES[name].units, by_group)
