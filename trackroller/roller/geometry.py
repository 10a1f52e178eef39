"""Geometry of the roller on its guideway (Wenzel et al. 2022, section 2.2 and eqs (13)-(14)).

Lengths are in mm and angles in rad unless a name says otherwise; arrays have shape (n,).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from trackroller.errors import InputError


def rolling_radius(axis_distance, guide_profile_radius, contact_angle) -> np.ndarray:
    """Return the nominal rolling radius r_A = A_T - r_C,G cos(alpha).

    Parameters
    ----------
    axis_distance, guide_profile_radius, contact_angle : numpy.ndarray
        A_T [mm], r_C,G [mm] and alpha [rad], shape (n,).

    Returns
    -------
    numpy.ndarray
        r_A [mm], shape (n,).
    """
    return np.asarray(axis_distance - guide_profile_radius * np.cos(contact_angle))


def curvatures(
    roller_profile_radius, guide_profile_radius, guide_curve_radius, rolling_radius, contact_angle
) -> tuple[np.ndarray, np.ndarray]:
    """Return the relative curvatures of the surfaces, both > 0 for a point contact.

    Parameters
    ----------
    roller_profile_radius, guide_profile_radius, guide_curve_radius, rolling_radius : numpy.ndarray
        r_C,TR, r_C,G, r_Curve and r_A [mm], shape (n,); inf for a straight guide or profile.
    contact_angle : numpy.ndarray
        alpha [rad], shape (n,).

    Returns
    -------
    tuple of numpy.ndarray
        k_x = 1/r_C,TR + 1/r_C,G in the lateral plane and k_y = cos(alpha)/r_A + cos(alpha)/r_Curve
        in the rolling plane [1/mm], shape (n,) each.
    """
    k_x = 1.0 / np.asarray(roller_profile_radius) + 1.0 / np.asarray(guide_profile_radius)
    k_y = np.cos(contact_angle) * (
        1.0 / np.asarray(rolling_radius) + 1.0 / np.asarray(guide_curve_radius)
    )
    return k_x, k_y


def lever_arms(axis_distance, guide_profile_radius, contact_angle) -> tuple[np.ndarray, np.ndarray]:
    """Return the lever arms of normal and lateral force about the roller's centre, eqs (13)-(14).

    Parameters
    ----------
    axis_distance, guide_profile_radius, contact_angle : numpy.ndarray
        A_T [mm], r_C,G [mm] and alpha [rad], shape (n,).

    Returns
    -------
    tuple of numpy.ndarray
        h_N = A_T sin(alpha) and h_T = A_T cos(alpha) - r_C,G [mm], shape (n,) each.
    """
    h_normal = np.asarray(axis_distance * np.sin(contact_angle))
    h_tangential = np.asarray(axis_distance * np.cos(contact_angle) - guide_profile_radius)
    return h_normal, h_tangential


class ContactGeometry(NamedTuple):
    """Contact angle [rad], r_A [mm], and the relative curvatures k_x and k_y [1/mm] of n rollers,
    each (n,).
    """

    contact_angle: np.ndarray
    rolling_radius: np.ndarray
    curvature_lateral: np.ndarray
    curvature_rolling: np.ndarray


def contact_geometry(columns: Mapping[str, np.ndarray]) -> ContactGeometry:
    """Return rolling radius and relative curvatures from the parameters of n cases.

    Parameters
    ----------
    columns : mapping of str to numpy.ndarray
        Radii and axis distance [mm] and the contact angle [deg] by parameter name, shape (n,);
        `vars(table)` of a `CaseTable` is such a mapping.

    Returns
    -------
    ContactGeometry
        Arrays of shape (n,).

    Examples
    --------
    >>> columns = dict(axis_distance=21.75, guide_profile_radius=6.0, roller_profile_radius=-7.0,
    ...                guide_curve_radius=220.0, contact_angle=30.0)
    >>> round(float(contact_geometry(columns).rolling_radius), 3)
    16.554
    """
    alpha = np.deg2rad(columns["contact_angle"])
    radius = rolling_radius(columns["axis_distance"], columns["guide_profile_radius"], alpha)
    profiles = (
        columns["roller_profile_radius"],
        columns["guide_profile_radius"],
        columns["guide_curve_radius"],
    )
    return ContactGeometry(alpha, radius, *curvatures(*profiles, radius, alpha))


def geometry_problem(columns: Mapping[str, Any]) -> InputError | None:
    """Return the first physical contradiction among the geometry of cases, or None.

    Parameters
    ----------
    columns : mapping of str to array_like
        The radii, the axis distance [mm] and the contact angle [deg] of n cases by their names in
        `PARAMETERS`; shapes that broadcast to (n,).

    Returns
    -------
    InputError or None
        An error that names the field to change: if the rolling radius is not positive, or if a
        relative curvature is not positive, so that the surfaces conform or interlock and there is
        no point contact.
    """
    return next((problem for _, problem in geometry_problems(columns)), None)


def geometry_problems(columns: Mapping[str, Any]) -> Iterator[tuple[int, InputError]]:
    """Yield the number of each case whose geometry contradicts itself, with the error; see
    `geometry_problem`.
    """
    names = (
        "axis_distance",
        "guide_profile_radius",
        "roller_profile_radius",
        "guide_curve_radius",
        "contact_angle",
    )
    full = np.broadcast_arrays(
        *(np.atleast_1d(np.asarray(columns[name], dtype=float)) for name in names)
    )
    get = dict(zip(names, full, strict=True))
    with np.errstate(divide="ignore"):
        geometry = contact_geometry(get)
    sound = np.ones(len(full[0]), dtype=bool)
    for name, value, allowed, remedy in (
        ("axis_distance", geometry.rolling_radius, *_AXIS),
        ("roller_profile_radius", geometry.curvature_lateral, *_GROOVE),
        ("guide_curve_radius", geometry.curvature_rolling, *_CURVE),
    ):
        bad = np.flatnonzero(sound & ~(value > 0))
        sound[bad] = False
        for i in bad.tolist():
            groove = get["guide_profile_radius"][i]
            radius = geometry.rolling_radius[i]
            limit = groove * np.cos(geometry.contact_angle[i])
            words = {"value": value[i], "groove": -groove, "radius": -radius, "limit": limit}
            yield (
                i,
                InputError(
                    name, float(get[name][i]), allowed.format(**words), remedy.format(**words)
                ),
            )


_AXIS = (
    "the rolling radius A_T - r_C,G cos(alpha) = {value:.6g} mm must be > 0",
    "Use an axis_distance above {limit:.6g} mm.",
)
_GROOVE = (
    "the surfaces conform or interlock: 1/r_C,TR + 1/r_C,G = {value:.6g} 1/mm must be > 0",
    "Use a groove wider than the guide (roller_profile_radius below {groove:.6g} mm) or a "
    "convex roller (> 0).",
)
_CURVE = (
    "the surfaces conform or interlock: cos(alpha)/r_A + cos(alpha)/r_Curve = {value:.6g} "
    "1/mm must be > 0",
    "Use an inner curve wider than the roller (guide_curve_radius below {radius:.6g} mm), a "
    "straight (inf) or an "
    "outer curve (> 0).",
)
