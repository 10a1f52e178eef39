"""Forces and moments that a load case puts on a carriage, without those of the rollers.

A wrench holds Fx, Fy, Fz [N] and the moments Mx, My, Mz about the origin [N mm].
"""

from __future__ import annotations

from collections.abc import Iterator
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
        Its motion. A curve is level: it accelerates each mass horizontally by omega^2 times its own
        horizontal radius, omega = v/R at the origin. On a canted track this acceleration has a part
        along z.
    """
    up = case.gradient
    tilt = case.cant
    weight = GRAVITY * np.array(
        [-np.sin(up), np.sin(tilt) * np.cos(up), -np.cos(tilt) * np.cos(up)]
    )
    across = np.array([0.0, np.cos(tilt), np.sin(tilt)])  # horizontal, to the left of the track
    inward = 0.0
    if np.isfinite(case.curve_radius) and case.speed is not None:
        inward = (
            case.speed**2 * (case.curve_radius - mass.at @ across) / case.curve_radius**2 * 1e3
        )  # m/s2, radii in mm
    return mass.value * (weight - np.array([case.acceleration, 0.0, 0.0]) - inward * across)


@dataclass(frozen=True)
class Wrenches:
    """Wrenches (6,) of a load case [N, N mm] and its drive [N]: one of the payloads, and one of
    everything else, each with its part of the drive.
    """

    payload: np.ndarray
    other: np.ndarray
    drive: float

    @property
    def all(self) -> np.ndarray:
        """Return the wrench of all loads, (6,)."""
        return self.payload + self.other


def _all_forces(
    carriage: Carriage, case: LoadCase
) -> Iterator[tuple[bool, np.ndarray, np.ndarray]]:
    """Yield whether a force is of a payload, each force (3,) [N] but the drive, and its point (3,)
    [mm].
    """
    for one in carriage.payloads:
        yield True, case.payload * force_on(one, case), one.at
    yield False, force_on(carriage.mass, case), carriage.mass.at
    for force, at in case.forces:
        yield False, force, at


def swing_of(carriage: Carriage, case: LoadCase, hinge: np.ndarray) -> float | None:
    """Return the angle about the x axis [rad] to which a load case swings a carriage that hangs on
    one line.

    Parameters
    ----------
    carriage : Carriage
        The carriage.
    case : LoadCase
        The load case.
    hinge : numpy.ndarray, shape (2,)
        Place of the line along y and z [mm].

    Returns
    -------
    float or None
        Angle, > 0 if the left side goes up; None if the carriage would fall to the other side of
        the line.

    Notes
    -----
    The forces keep their directions, and their points r swing about the line. Their moment is A
    cos(phi) - B sin(phi) with A the sum of r_y F_z - r_z F_y and B that of r_y F_y + r_z F_z, so
    that tan(phi) = A/B. The carriage is stable where the moment falls with the angle: within 90 deg
    if B > 0, that is, if the loads pull away from the line.

    ASSUME: the swing does not change the radius of a mass in a curve.
    """
    across = [(at[1:] - hinge, force[1:]) for _, force, at in _all_forces(carriage, case)]
    turning = sum(r[0] * f[1] - r[1] * f[0] for r, f in across)
    holding = sum(float(r @ f) for r, f in across)
    size = sum(float(np.linalg.norm(r) * np.linalg.norm(f)) for r, f in across)
    if holding <= NEGLIGIBLE * size:
        return None
    return float(np.arctan(turning / holding))


def _turned(force: np.ndarray, angle: float) -> np.ndarray:
    """Return a force (3,) as a carriage sees it that has swung by an angle about the x axis
    [rad].
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array(
        [force[0], cosine * force[1] + sine * force[2], cosine * force[2] - sine * force[1]]
    )


def wrenches_of(carriage: Carriage, case: LoadCase, swing: float = 0.0) -> Wrenches:
    """Return the wrenches of a load case, balanced along the track by the drive.

    Parameters
    ----------
    carriage : Carriage
        The carriage.
    case : LoadCase
        The load case.
    swing : float
        Angle by which the carriage has swung about its line of rollers [rad], see `swing_of`. The
        loads are those that the carriage sees, so that they turn by the opposite angle.

    Raises
    ------
    InputError
        If a force along the track needs a drive, and the carriage has none.
    """
    payload = np.zeros(6)
    other = np.zeros(6)
    for of_payload, force, at in _all_forces(carriage, case):
        if swing != 0:
            force = _turned(force, swing)
        wrench = wrench_at(force, at)
        if of_payload:
            payload = payload + wrench
        else:
            other = other + wrench
    drive = float(-(payload + other)[0])
    if carriage.drive is None:
        if abs(drive) > NEGLIGIBLE:
            allowed = f"the point at which the drive pulls with {drive:.4g} N in case '{case.name}'"
            raise InputError("drive.at", None, allowed, "Add drive: {at: [0, 0, -20]}.")
        return Wrenches(payload, other, 0.0)
    payload, other = (
        part - wrench_at(np.array([part[0], 0.0, 0.0]), carriage.drive) for part in (payload, other)
    )
    return Wrenches(payload, other, drive)
