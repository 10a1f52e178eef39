"""Check the arrays that users give to the stress functions."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trackroller.errors import InputError
from trackroller.numerics.numbers import read_array

Array = NDArray[np.float64]
COMPONENTS = ("sigma_x", "sigma_y", "sigma_z", "tau_xy", "tau_yz", "tau_xz")


def grid_axis(field: str, values: ArrayLike) -> Array:
    """Return the coordinates of a grid that a user gave; refuse uneven steps."""
    allowed = "a 1-D array of at least two finite coordinates"
    a = read_array(values, field, allowed)
    if a.ndim != 1 or a.size < 2 or not np.all(np.isfinite(a)):
        raise InputError(field, a, allowed)
    steps = np.diff(a)
    if steps.min() <= 0 or np.ptp(steps) > 1e-6 * steps.mean():
        raise InputError(
            field, a, "coordinates that increase in equal steps", "Resample the tractions."
        )
    return a


def grid_tractions(
    x: Array, y: Array, pressure: ArrayLike, lateral: ArrayLike, rolling: ArrayLike
) -> Array:
    """Return shear and pressure on a grid, (ny, nx, 3)."""
    fields = []
    for name, values in (
        ("shear_lateral", lateral),
        ("shear_rolling", rolling),
        ("pressure", pressure),
    ):
        a = read_array(values, name, "tractions are arrays of numbers [MPa]")
        if a.ndim != 0 and a.shape != (y.size, x.size):
            raise InputError(name, a.shape, f"tractions of shape (ny, nx) = {(y.size, x.size)}")
        if not np.all(np.isfinite(a)):
            raise InputError(
                name, "NaN or infinite", "finite tractions everywhere", "Put 0 outside the patch."
            )
        fields.append(np.broadcast_to(a, (y.size, x.size)))
    return np.stack(fields, axis=-1)


def check_depth(field: str, depth: Array) -> None:
    """Refuse depths above the surface."""
    if not np.all(depth >= 0.0) or not np.all(np.isfinite(depth)):
        wrong = depth[~((depth >= 0.0) & np.isfinite(depth))]
        raise InputError(field, float(wrong[0]), "finite depths >= 0 (z points into the body)")


def components(stress: ArrayLike) -> Array:
    """Return stresses as an array of floats, (..., 6)."""
    allowed = f"stresses of shape (..., 6), the components {', '.join(COMPONENTS)}"
    s = read_array(stress, "stress", allowed)
    if s.shape[-1:] != (len(COMPONENTS),):
        raise InputError("stress", s.shape, allowed)
    return s
