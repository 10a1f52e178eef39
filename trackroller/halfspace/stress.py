"""Stresses in an elastic half-space under any tractions: the public entry of the half-space part.

Convention: z points into the body; tractions act ON the body, `pressure` > 0 presses (sigma_z = -p at the surface),
`shear_lateral` along +x and `shear_rolling` along +y (tau_xz = -q_x, tau_yz = -q_y at the surface).
Stresses come as a last axis of six in the order of COMPONENTS. Young's modulus does not matter.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trackroller.errors import InputError
from trackroller.halfspace import influence
from trackroller.numerics.threads import share_rows

Array = NDArray[np.float64]
COMPONENTS = ("sigma_x", "sigma_y", "sigma_z", "tau_xy", "tau_yz", "tau_xz")
INTERPOLATIONS = ("bilinear", "constant")
_CHUNK = 16384  # points per piece of work: a few MB each, whatever the number of points


def _axis(field: str, values: ArrayLike) -> Array:
    a = np.asarray(values, dtype=float)
    if a.ndim != 1 or a.size < 2 or not np.all(np.isfinite(a)):
        raise InputError(field, a, "a grid axis is a 1-D array of at least two finite coordinates")
    steps = np.diff(a)
    if steps.min() <= 0 or np.ptp(steps) > 1e-6 * steps.mean():
        raise InputError(field, a, "a grid axis increases in equal steps", "Resample the tractions.")
    return a


def _tractions(x: Array, y: Array, pressure: ArrayLike, lateral: ArrayLike, rolling: ArrayLike) -> Array:
    fields = []
    for name, values in (("shear_lateral", lateral), ("shear_rolling", rolling), ("pressure", pressure)):
        a = np.asarray(values, dtype=float)
        if a.ndim != 0 and a.shape != (y.size, x.size):
            raise InputError(name, a.shape, f"tractions on this grid have shape (ny, nx) = {(y.size, x.size)}")
        if not np.all(np.isfinite(a)):
            raise InputError(name, "NaN or infinite", "tractions are finite everywhere", "Put 0 outside the patch.")
        fields.append(np.broadcast_to(a, (y.size, x.size)))
    return np.stack(fields, axis=-1)


def _check_depth(field: str, depth: Array) -> None:
    if not np.all(depth >= 0.0) or not np.all(np.isfinite(depth)):
        raise InputError(field, float(np.min(depth)), "depths are finite and >= 0 (z points into the body)")


def _check_poisson(poisson_ratio: float) -> None:
    if not 0.0 <= poisson_ratio <= 0.5:
        raise InputError("poisson_ratio", poisson_ratio, "0 <= poisson_ratio <= 0.5")


def stress_from_tractions(
    x: ArrayLike,
    y: ArrayLike,
    pressure: ArrayLike,
    shear_lateral: ArrayLike,
    shear_rolling: ArrayLike,
    points: ArrayLike,
    poisson_ratio: float = 0.3,
    interpolation: str = "bilinear",
) -> Array:
    """Stresses at any points under tractions sampled on a regular grid.

    Exact half-space solution (Boussinesq-Cerruti potentials, eqs. (1)-(5); Love 1929, Kalker 1990) for tractions
    interpolated between the nodes, right up to z = 0 and the edge of the patch. Cost: about 0.2 microseconds per
    point and loaded node and thread; `stress_on_grid` is far cheaper for whole planes.

    Parameters
    ----------
    x, y : (nx,), (ny,) equidistant node coordinates [mm]
    pressure, shear_lateral, shear_rolling : (ny, nx) or scalar tractions on the body [MPa]
    points : (..., 3) coordinates x, y, z with z >= 0 [mm]
    poisson_ratio : of the body [-], 0 to 0.5
    interpolation : "bilinear" between nodes, falling to zero within one spacing outside the grid (all stresses
        are continuous and finite); "constant" in cells centred on the nodes (on the very edge of a cell the
        in-plane stresses grow without bound; there the logarithm stops at 1e-10 spacings)

    Returns
    -------
    (..., 6) stresses in the order of COMPONENTS [MPa]

    Raises
    ------
    InputError : uneven axes, wrong shapes, NaN, z < 0, unknown interpolation

    Valid for any tractions; the error against a smooth field is that of the interpolation, O(h^1.5) for a Hertzian
    edge.
    """
    xa, ya = _axis("x", x), _axis("y", y)
    q = _tractions(xa, ya, pressure, shear_lateral, shear_rolling)
    at = np.asarray(points, dtype=float)
    if at.shape[-1:] != (3,):
        raise InputError("points", at.shape, "points have shape (..., 3)")
    _check_depth("points", at[..., 2])
    _check_poisson(poisson_ratio)
    if interpolation not in INTERPOLATIONS:
        raise InputError("interpolation", interpolation, "one of " + ", ".join(INTERPOLATIONS))
    loads = influence.corner_loads(xa, ya, q, interpolation == "bilinear")
    flat = np.ascontiguousarray(at.reshape(-1, 3))
    out = np.empty((flat.shape[0], 6))

    def work(start: int, stop: int) -> None:
        parts = influence.stress_parts(loads, flat[start:stop])
        out[start:stop] = parts[:, 0] + poisson_ratio * parts[:, 1]

    share_rows(work, flat.shape[0], 64, _CHUNK)
    return out.reshape((*at.shape[:-1], 6))


def stress_on_grid(
    x: ArrayLike,
    y: ArrayLike,
    pressure: ArrayLike,
    shear_lateral: ArrayLike,
    shear_rolling: ArrayLike,
    depths: ArrayLike,
    poisson_ratio: float = 0.3,
) -> Array:
    """Stresses below every node of the tractions' own grid, by fast convolution.

    The same field as `stress_from_tractions` (bilinear) at z = `depths` under the nodes, as a discrete convolution
    with the influence of one node's hat load (zero-padded FFT, so not periodic; cf. Liu & Wang 2002).

    Parameters as there; depths : (nz,) [mm]. Returns (nz, ny, nx, 6) [MPa].
    Memory: about 3 kB per node of one plane besides the result (500 x 500 nodes stay under 1 GB); time about 10
    microseconds per node and plane. Rounding grows with (patch / spacing)^2: 1e-11 of the tractions at 200 nodes.
    """
    from scipy import fft

    xa, ya = _axis("x", x), _axis("y", y)
    q = _tractions(xa, ya, pressure, shear_lateral, shear_rolling)
    z = np.atleast_1d(np.asarray(depths, dtype=float))
    _check_depth("depths", z)
    _check_poisson(poisson_ratio)
    ny, nx = ya.size, xa.size
    shape = (fft.next_fast_len(3 * ny - 2, real=True), fft.next_fast_len(3 * nx - 2, real=True))
    loads = fft.rfft2(np.moveaxis(q, -1, 0), shape)
    steps = (xa[-1] - xa[0]) / (nx - 1), (ya[-1] - ya[0]) / (ny - 1)
    out = np.empty((z.size, ny, nx, 6))
    for i, depth in enumerate(z):
        spectrum = np.zeros((6, *loads.shape[1:]), dtype=complex)
        for load, kernel in zip(
            loads, influence.hat_influence(*steps, nx, ny, float(depth), poisson_ratio), strict=True
        ):
            if load.any():
                spectrum += load * fft.rfft2(kernel, shape)
        field = fft.irfft2(spectrum, shape)[:, ny - 1 : 2 * ny - 1, nx - 1 : 2 * nx - 1]
        out[i] = np.moveaxis(field, 0, -1)
    return out


def von_mises(stress: ArrayLike) -> Array:
    """Equivalent stress of eq. (6), sqrt(3 J2). stress (..., 6) [MPa]; returns (...) [MPa]."""
    sx, sy, sz, txy, tyz, txz = np.moveaxis(np.asarray(stress, dtype=float), -1, 0)
    normal = (sx - sy) ** 2 + (sz - sx) ** 2 + (sy - sz) ** 2
    return np.sqrt(0.5 * normal + 3.0 * (txy**2 + txz**2 + tyz**2))


def principal_stresses(stress: ArrayLike) -> Array:
    """Principal stresses, largest first. stress (..., 6) [MPa]; returns (..., 3) [MPa]."""
    s = np.asarray(stress, dtype=float)
    tensor = s[..., [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    return np.linalg.eigvalsh(tensor)[..., ::-1]


def max_shear(stress: ArrayLike) -> Array:
    """Largest shear stress, half the largest minus the smallest principal stress. (..., 6) -> (...) [MPa]."""
    principal = principal_stresses(stress)
    return 0.5 * (principal[..., 0] - principal[..., 2])
