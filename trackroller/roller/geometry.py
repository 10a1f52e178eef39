"""Geometry of the roller on its guideway (Wenzel et al. 2022, section 2.2 and eqs (13)-(14)).

Lengths in mm, angles in rad, arrays of shape (n,) throughout.
"""

from __future__ import annotations

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


def lever_arms(axis_distance, guide_profile_radius, contact_angle) -> tuple[np.ndarray, np.ndarray]:
    """Lever arms h_N = A_T sin(alpha) and h_T = A_T cos(alpha) - r_C,G [mm], eqs (13)-(14)."""
    h_normal = np.asarray(axis_distance * np.sin(contact_angle))
    h_tangential = np.asarray(axis_distance * np.cos(contact_angle) - guide_profile_radius)
    return h_normal, h_tangential
