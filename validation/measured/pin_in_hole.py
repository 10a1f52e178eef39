"""A pin in a hole of like material without friction, the problem of Persson (1964), by Fourier series."""

from __future__ import annotations

import numpy as np


def solve(angle: float, terms: int = 4000, shapes: int = 12) -> tuple[float, float, float]:
    """Solve a pin in a hole whose contact ends at an angle.

    Radius, E* and difference of the radii are 1. A pressure p_n cos(n theta) on disc and hole closes the gap by
    2 n/(n^2 - 1) p_n, one without n by p_0, which follows from Michell's solutions; n = 1 is a rigid displacement.

    Parameters
    ----------
    angle : float
        Half the angle of the contact [rad].
    terms, shapes : int
        Terms of the Fourier series, and polynomials for the pressure.

    Returns
    -------
    tuple of float
        The largest pressure, the load, and the largest error of the gap in the contact, |theta| <= angle.
    """
    nodes = 2000
    u = (np.arange(nodes) + 0.5) * np.pi / nodes
    weight = np.pi / nodes * np.sin(u) ** 2  # of sqrt(1 - t^2) dt, t = cos(u)
    n = np.arange(terms)
    shape = np.cos(2.0 * np.arange(shapes)[:, None] * u) * weight
    coefficient = shape @ np.cos(n[:, None] * angle * np.cos(u)).T * angle / np.pi
    coefficient[:, 0] *= 0.5
    compliance = np.ones(terms)
    compliance[1] = 0.0
    compliance[2:] = 2.0 * n[2:] / (n[2:] ** 2 - 1.0)
    places = angle * np.cos((np.arange(4 * shapes) + 0.5) * np.pi / (8 * shapes))
    matrix = np.column_stack([(np.cos(n * places[:, None]) * compliance) @ coefficient.T, -np.cos(places)])
    solution = np.linalg.lstsq(matrix, -np.ones(len(places)), rcond=None)[0]
    largest = solution[:-1] @ np.cos(np.arange(shapes) * np.pi)
    residual = np.abs(matrix @ solution + 1.0).max()
    return float(largest), float(np.pi * coefficient[:, 1] @ solution[:-1]), float(residual)


def beside_hertz(angle: float) -> tuple[float, float, float]:
    """Return Hertz's half width over the radius, and the true pressure and half width over Hertz's.

    Parameters
    ----------
    angle : float
        Half the angle of the contact [rad].
    """
    largest, load, _ = solve(angle)
    half = float(np.sqrt(4.0 * load / np.pi))
    return half, largest / (2.0 * load / (np.pi * half)), angle / half
