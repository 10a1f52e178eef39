"""Forces and moments that a load case puts on a carriage, without those of the rollers.

A wrench holds Fx, Fy, Fz [N] and the moments Mx, My, Mz about the origin [N mm].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trackroller.carriage.file import Carriage, LoadCase, PointMass
from trackroller.errors import InputError

GRAVITY = 9.80665  # m/s2
NEGLIGIBLE = 1e-9  # N along the track that needs no drive


def wrench_at(force: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the wrench (6,) of a force (3,) [N] at a point (3,) [mm]."""
    return np.concatenate([force, np.cross(at, force)])


def force_on(mass: PointMass, case: LoadCase) -> np.ndarray:
    """Return weight and force of inertia (3,) [N] of a mass.

    Parameters
    ----------
    mass : PointMass
        The mass.
    case : LoadCase
        Its motion. A curve is level: it accelerates each mass horizontally by omega^2 times its own horizontal
        radius, omega = v/R at the origin. On a canted track this acceleration has a part along z.
    """
    up, tilt = case.gradient, case.cant
    weight = GRAVITY * np.array([-np.sin(up), np.sin(tilt) * np.cos(up), -np.cos(tilt) * np.cos(up)])
    left = np.array([0.0, np.cos(tilt), np.sin(tilt)])  # horizontal, across the track
    inward = 0.0
    if np.isfinite(case.curve_radius) and case.speed is not None:
        inward = case.speed**2 * (case.curve_radius - mass.at @ left) / case.curve_radius**2 * 1e3  # m/s2, radii in mm
    return mass.value * (weight - np.array([case.acceleration, 0.0, 0.0]) - inward * left)


@dataclass(frozen=True)
class Loads:
    """Wrenches (6,) of a load case, each with its drive: of the payloads, and of everything else; and the drive [N]."""

    payload: np.ndarray
    other: np.ndarray
    drive: float

    @property
    def all(self) -> np.ndarray:
        """Return the wrench of all loads, (6,)."""
        return self.payload + self.other


def loads_of(carriage: Carriage, case: LoadCase) -> Loads:
    """Return the loads of a load case, balanced along the track by the drive.

    Raises
    ------
    InputError
        If a force along the track needs a drive, and the carriage has none.
    """
    none = np.zeros(6)
    payload = sum((case.payload * wrench_at(force_on(one, case), one.at) for one in carriage.payloads), none)
    other = wrench_at(force_on(carriage.mass, case), carriage.mass.at)
    other = sum((wrench_at(force, at) for force, at in case.forces), other)
    drive = float(-(payload + other)[0])
    if carriage.drive is None:
        if abs(drive) > NEGLIGIBLE:
            allowed = f"the point at which the drive pulls with {drive:.4g} N in case '{case.name}'"
            raise InputError("drive.at", None, allowed, "Add drive: {at: [0, 0, -20]}.")
        return Loads(payload, other, 0.0)
    payload, other = (part - wrench_at(np.array([part[0], 0.0, 0.0]), carriage.drive) for part in (payload, other))
    return Loads(payload, other, drive)
