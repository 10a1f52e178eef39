"""Geometry of the roller on its guideway (Wenzel et al. 2022, section 2.2 and eqs (13)-(14)).

Lengths in mm, angles in rad, arrays of shape (n,) throughout.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np


def rolling_radius(axis_distance, guide_profile_radius, contact_angle) -> np.ndarray:
    """Nominal rolling radius r_A = A_T - r_C,G cos(alpha) [mm], shape (n,)."""
    return np.asarray(axis_distance - guide_profile_radius * np.cos(contact_angle))


def curvatures(
    roller_profile_radius, guide_profile_radius, guide_curve_radius, rolling_radius, contact_angle
) -> tuple[np.ndarray, np.ndarray]:
    """Relative curvatures k_x (lateral plane) and k_y (rolling plane) [1/mm], each of shape (n,).

    k_x = 1/r_C,TR + 1/r_C,G and k_y = cos(alpha)/r_A + cos(alpha)/r_Curve. Both must be > 0 for a
    point contact; a straight guide or profile has an infinite radius.
    """
    k_x = 1.0 / np.asarray(roller_profile_radius) + 1.0 / np.asarray(guide_profile_radius)
    k_y = np.cos(contact_angle) * (1.0 / np.asarray(rolling_radius) + 1.0 / np.asarray(guide_curve_radius))
    return k_x, k_y


class ContactGeometry(NamedTuple):
    """Contact angle [rad], r_A [mm], and the relative curvatures k_x and k_y [1/mm] of n rollers, each (n,)."""

    contact_angle: np.ndarray
    rolling_radius: np.ndarray
    curvature_lateral: np.ndarray
    curvature_rolling: np.ndarray


def contact_geometry(columns: Mapping[str, np.ndarray]) -> ContactGeometry:
    """Compute rolling radius and relative curvatures from the parameters of n cases.

    Parameters
    ----------
    columns : arrays (n,) by parameter name, with the contact angle in degrees; `vars(table)` of a `CaseTable` is such
        a mapping

    Examples
    --------
    >>> columns = dict(axis_distance=21.75, guide_profile_radius=6.0, roller_profile_radius=-7.0,
    ...                guide_curve_radius=220.0, contact_angle=30.0)
    >>> round(float(contact_geometry(columns).rolling_radius), 3)
    16.554
    """
    alpha = np.deg2rad(columns["contact_angle"])
    radius = rolling_radius(columns["axis_distance"], columns["guide_profile_radius"], alpha)
    profiles = columns["roller_profile_radius"], columns["guide_profile_radius"], columns["guide_curve_radius"]
    return ContactGeometry(alpha, radius, *curvatures(*profiles, radius, alpha))


def lever_arms(axis_distance, guide_profile_radius, contact_angle) -> tuple[np.ndarray, np.ndarray]:
    """Lever arms h_N = A_T sin(alpha) and h_T = A_T cos(alpha) - r_C,G [mm], eqs (13)-(14)."""
    h_normal = np.asarray(axis_distance * np.sin(contact_angle))
    h_tangential = np.asarray(axis_distance * np.cos(contact_angle) - guide_profile_radius)
    return h_normal, h_tangential
