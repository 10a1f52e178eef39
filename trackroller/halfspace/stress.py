"""Stresses in an elastic half-space under any tractions, and the stress measures of the whole
package.

Frame: x lateral, y in the rolling direction, z into the body. Kalker and CONTACT use x for the
rolling direction. Tractions act on the body: `pressure` > 0 presses (sigma_z = -p at the surface),
`shear_lateral` acts along +x and `shear_rolling` along +y (tau_xz = -q_x, tau_yz = -q_y at the
surface). Stresses have a last axis of six in the order of COMPONENTS. They do not depend on Young's
modulus.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trackroller.errors import InputError
from trackroller.halfspace import influence
from trackroller.halfspace.arrays import check_depth, components, grid_axis, grid_tractions
from trackroller.halfspace.hats import planes_below
from trackroller.numerics.compiled import fast, inner
from trackroller.numerics.numbers import number_in, read_array
from trackroller.numerics.threads import share_rows

Array = NDArray[np.float64]
# of the shear on roller and guide, which is opposite on the two bodies
FRICTION_SIGNS = (1.0, -1.0)
_CHUNK = 16384  # points in a piece of work; this bounds the memory to a few MB for each thread


def stress_from_tractions(
    x: ArrayLike,
    y: ArrayLike,
    pressure: ArrayLike,
    shear_lateral: ArrayLike,
    shear_rolling: ArrayLike,
    points: ArrayLike,
    poisson_ratio: float = 0.3,
) -> Array:
    """Compute stresses at any points under tractions sampled on a regular grid.

    Exact half-space solution (Boussinesq-Cerruti potentials, eqs. (1)-(5)) for tractions that are
    bilinear between the nodes and fall to zero within one spacing outside the grid, including z = 0
    and the edge of the patch. All stresses are continuous and finite.

    Parameters
    ----------
    x, y : array_like, shapes (nx,) and (ny,)
        Equidistant node coordinates in the lateral and the rolling direction [mm].
    pressure : array_like, shape (ny, nx) or ()
        Pressure on the body [MPa].
    shear_lateral, shear_rolling : array_like, shape (ny, nx) or ()
        Shear tractions on the body along x and y [MPa].
    points : array_like, shape (..., 3)
        Coordinates x, y, z with z >= 0 [mm].
    poisson_ratio : float
        Poisson's ratio of the body, 0 to 0.5 [1].

    Returns
    -------
    numpy.ndarray, shape (..., 6)
        Stresses in the order of `COMPONENTS` [MPa].

    Raises
    ------
    InputError
        If axes are uneven, shapes do not match, a value is NaN, or z < 0.

    Notes
    -----
    Valid for any tractions. The error against a smooth field is that of the interpolation, O(h^1.5)
    for a Hertzian edge. The cost grows with the number of points times the number of loaded nodes;
    `stress_on_grid` is far cheaper for whole planes.

    References
    ----------
    Love, A. E. H. (1929). Phil. Trans. R. Soc. A 228, 377-420.
    Kalker, J. J. (1990). Three-Dimensional Elastic Bodies in Rolling Contact. Kluwer.

    Examples
    --------
    >>> middle = stress_from_tractions([-1, 0, 1], [-1, 0, 1], 200.0, 0.0, 0.0, points=[0, 0, 0])
    >>> round(float(middle[2]), 6)
    -200.0
    """
    xa, ya = grid_axis("x", x), grid_axis("y", y)
    q = grid_tractions(xa, ya, pressure, shear_lateral, shear_rolling)
    at = read_array(points, "points", "points have shape (..., 3)")
    if at.shape[-1:] != (3,) or not np.all(np.isfinite(at)):
        raise InputError(
            "points", at if at.shape[-1:] == (3,) else at.shape, "finite points of shape (..., 3)"
        )
    check_depth("points", at[..., 2])
    poisson_ratio = number_in(poisson_ratio, "poisson_ratio", "0 <= poisson_ratio <= 0.5", 0.0, 0.5)
    loads = influence.corner_loads(xa, ya, q)
    flat = np.ascontiguousarray(at.reshape(-1, 3))
    out = np.empty((flat.shape[0], 6))

    def work(start: int, stop: int) -> None:
        out[start:stop] = body_stress(
            influence.stress_parts(loads, flat[start:stop]), poisson_ratio, 1.0
        )

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
    """Compute stresses below every node of the grid of the tractions, by fast convolution.

    Parameters
    ----------
    x, y : array_like, shapes (nx,) and (ny,)
        Equidistant node coordinates in the lateral and the rolling direction [mm].
    pressure : array_like, shape (ny, nx) or ()
        Pressure on the body [MPa].
    shear_lateral, shear_rolling : array_like, shape (ny, nx) or ()
        Shear tractions on the body along x and y [MPa].
    depths : array_like, shape (nz,)
        Depths z >= 0 [mm].
    poisson_ratio : float
        Poisson's ratio of the body, 0 to 0.5 [1].

    Returns
    -------
    numpy.ndarray, shape (nz, ny, nx, 6)
        Stresses in the order of `COMPONENTS` [MPa].

    Raises
    ------
    InputError
        If axes are uneven, shapes do not match, a value is NaN, or z < 0.

    Notes
    -----
    The field is that of `stress_from_tractions`. It is a discrete convolution of the tractions with
    the influence of one node's hat load; zero padding prevents periodic images. The computation
    needs about 3 kB of memory per node of one plane besides the result. Rounding errors grow with
    (patch / spacing)^2: 1e-11 of the tractions at 200 nodes.

    References
    ----------
    Liu, S. & Wang, Q. (2002). J. Tribology 124, 36-45.

    Examples
    --------
    >>> stress = stress_on_grid([-1, 0, 1], [-1, 0, 1, 2], 200.0, 0.0, 0.0, depths=[0.0, 0.5])
    >>> stress.shape, round(float(stress[0, 1, 1, 2]), 6)
    ((2, 4, 3, 6), -200.0)
    """
    xa, ya = grid_axis("x", x), grid_axis("y", y)
    q = grid_tractions(xa, ya, pressure, shear_lateral, shear_rolling)
    z = np.atleast_1d(read_array(depths, "depths", "depths are numbers >= 0 [mm]"))
    if z.ndim != 1:
        raise InputError("depths", z.shape, "depths of shape (nz,)")
    check_depth("depths", z)
    poisson_ratio = number_in(poisson_ratio, "poisson_ratio", "0 <= poisson_ratio <= 0.5", 0.0, 0.5)
    steps = (xa[-1] - xa[0]) / (xa.size - 1), (ya[-1] - ya[0]) / (ya.size - 1)
    stress = planes_below(np.moveaxis(q, -1, 0), steps, z, [poisson_ratio], [1.0])
    return np.moveaxis(stress[0], 1, -1)


def body_stress(parts: Array, poisson_ratio: ArrayLike, sign: ArrayLike) -> Array:
    """Return the stress of one body from the stress parts that serve both bodies.

    Parameters
    ----------
    parts : numpy.ndarray, shape (..., 4, 6)
        Stresses A_p, B_p of the pressure and A_q, B_q of the shear.
    poisson_ratio : array_like, shape (...) or ()
        Poisson's ratio nu of the body [1].
    sign : array_like, shape (...) or ()
        +1 if the shear acts on the body as given (roller), -1 if it acts in the opposite direction
        (guide).

    Returns
    -------
    numpy.ndarray, shape (..., 6)
        Stresses A_p + nu B_p + sign (A_q + nu B_q).
    """
    nu, s = (np.asarray(v, dtype=float)[..., None] for v in (poisson_ratio, sign))
    pressed, pressed_nu, sheared, sheared_nu = np.moveaxis(parts, -2, 0)
    return pressed + nu * pressed_nu + s * (sheared + nu * sheared_nu)


def von_mises(stress: ArrayLike) -> Array:
    """Return the equivalent stress of eq. (6), sqrt(3 J2).

    Parameters
    ----------
    stress : array_like, shape (..., 6)
        Stress components in the order of `COMPONENTS` [MPa].

    Returns
    -------
    numpy.ndarray, shape (...)
        Equivalent stress [MPa].

    Examples
    --------
    >>> float(von_mises([-300.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    300.0
    """
    with np.errstate(invalid="ignore"):  # infinite components
        return _equivalent.py_func(*np.moveaxis(components(stress), -1, 0))


@inner
def _equivalent(sx, sy, sz, txy, tyz, txz):
    """Return sqrt(3 J2) of the components of stresses: numbers, or arrays of one shape."""
    a, b, c = sx - sy, sz - sx, sy - sz
    normal = a * a + b * b + c * c
    return np.sqrt(0.5 * normal + 3.0 * (txy * txy + tyz * tyz + txz * txz))


@inner
def _of_body(parts, poisson_ratio, sign, k):
    """Return component k of `body_stress`."""
    return (
        parts[0, k]
        + poisson_ratio * parts[1, k]
        + sign * (parts[2, k] + poisson_ratio * parts[3, k])
    )


@fast
def von_mises_of_parts(parts, poisson_ratio, sign):
    """Return the von Mises stress of `body_stress`, from stress parts (4, 6)."""
    nu = poisson_ratio
    sx, sy, sz = (
        _of_body(parts, nu, sign, 0),
        _of_body(parts, nu, sign, 1),
        _of_body(parts, nu, sign, 2),
    )
    txy, tyz, txz = (
        _of_body(parts, nu, sign, 3),
        _of_body(parts, nu, sign, 4),
        _of_body(parts, nu, sign, 5),
    )
    return _equivalent(sx, sy, sz, txy, tyz, txz)


def principal_stresses(stress: ArrayLike) -> Array:
    """Return the principal stresses, largest first.

    Parameters
    ----------
    stress : array_like, shape (..., 6)
        Stress components in the order of `COMPONENTS` [MPa].

    Returns
    -------
    numpy.ndarray, shape (..., 3)
        Principal stresses in descending order [MPa]; NaN where a component is not finite.

    Examples
    --------
    >>> principal_stresses([-300.0, 0.0, 100.0, 0.0, 0.0, 0.0]).tolist()
    [100.0, 0.0, -300.0]
    """
    s = components(stress)
    known = np.all(np.isfinite(s), axis=-1, keepdims=True)
    tensor = np.where(known, s, 0.0)[..., [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    return np.where(known, np.linalg.eigvalsh(tensor)[..., ::-1], np.nan)


def max_shear(stress: ArrayLike) -> Array:
    """Return the largest shear stress, half of the largest less the smallest principal stress.

    Parameters
    ----------
    stress : array_like, shape (..., 6)
        Stress components in the order of `COMPONENTS` [MPa].

    Returns
    -------
    numpy.ndarray, shape (...)
        Largest shear stress [MPa].

    Examples
    --------
    >>> float(max_shear([-300.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    150.0
    """
    principal = principal_stresses(stress)
    return 0.5 * (principal[..., 0] - principal[..., 2])
