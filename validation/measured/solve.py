"""Solve with this program what others have measured or computed; `page.py` lays both side by side."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.signal import fftconvolve

import trackroller as tr
from trackroller.contact import close_fit
from trackroller.damage.moving_source import cell_temperature
from trackroller.materials import builtin_database
from validation.measured import grooves, pin_in_hole
from validation.measured.facts import column, read

# the locomotive: CONTACT's inputs for it, see README.md
STEEL_OF_RAIL = {"youngs_modulus": 2.0 * 82e3 * 1.28, "poisson_ratio": 0.28}
LOCOMOTIVE: dict[str, Any] = {
    "normal_force": 106700.0,
    "semi_axes": (12.61, 6.304),
    "materials": STEEL_OF_RAIL,
    "friction_coefficient": 0.33,
    "velocity": "10 m/s",
}
# fitted by CONTACT's authors to the locomotive, so that this curve checks code and not the model
FILM: dict[str, Any] = {
    "layer_flexibility": 1.25 / 8200.0,
    "friction_law": {"kind": "exponential", "speed": 1250.0 / np.log(2.0), "lowest": 0.14 / 0.33},
}
DISC_RADIUS, DISC_WIDTH, DISC_SPEED = 23.5, 10.0, 0.984  # of the twin disc: [mm], [mm], [m/s]
DISC_FORCE = 7338.0  # [N], 1500 MPa
FULL_SLIP = 3.0  # creepage [%] from which the discs slide as a whole
DISCS: dict[str, Any] = {
    "normal_force": DISC_FORCE,
    "curvature_rolling": 2.0 / DISC_RADIUS,
    "curvature_lateral": 0.0,
    "width": DISC_WIDTH,
    "materials": {"youngs_modulus": 206e3, "poisson_ratio": 0.3},
    "velocity": f"{DISC_SPEED} m/s",
}
SPIN: dict[str, Any] = {
    "normal_force": 82000.0,
    "semi_axes": (4.0, 8.0),
    "materials": STEEL_OF_RAIL,
    "friction_coefficient": 0.3,
    "velocity": "30 m/s",
}
# [1], [1/mm]; CONTACT's x is our y, so that its spin and its moment have the opposite sign
LATERAL_CREEPAGE, SPIN_CREEPAGE = -6.25e-4, -6.25e-4
ANGLES = (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 33.0)  # half the contact of a pin in a hole [deg]
LOADS = (100.0, 200.0, 400.0)  # of the roller whose lives give exponents [N]
ROLLER_STEEL = "1.7225-quenched-tempered"
HEAT_STEEL = "C45"  # whose thermal values stand for wheel and rail steel
STRIPS = 5, 256  # elements of the discs' heat across and along the contact


def results(accuracy: str = "standard") -> dict[str, Any]:
    """Return our numbers by the sets of this folder.

    Parameters
    ----------
    accuracy : str
        Rung of all solutions.
    """
    return {
        "locomotive": locomotive(accuracy),
        "twin_disc": twin_disc(accuracy),
        "grooves": [close_groove(row["groove_radius"], accuracy) for row in read("close_grooves")],
        "pins": [pin(angle) for angle in ANGLES],
        "spin": spin(accuracy),
        "lives": lives(accuracy),
    }


def locomotive(accuracy: str) -> dict[str, Any]:
    """Return the traction coefficients of a bare half-space, and of a film with falling friction."""
    creepage = 0.01 * column(read("locomotive_creep"), "longitudinal_creepage")
    curves = {}
    for name, more in (("half_space", {}), ("film", FILM)):
        ds = tr.patch(**LOCOMOTIVE, **more, longitudinal_creepage=creepage, accuracy=accuracy)
        curves[name] = -ds["driving_force"].values / LOCOMOTIVE["normal_force"]
    return {"longitudinal_creepage": creepage, **curves}


def measured_traction() -> np.ndarray:
    """Return the traction coefficients of the twin disc, heat over force, speed and creepage, (n,)."""
    rows = read("twin_disc")
    creepage = 0.01 * column(rows, "longitudinal_creepage")
    return np.asarray(column(rows, "heat") / (DISC_FORCE * DISC_SPEED * creepage))


def disc_friction() -> float:
    """Return the friction coefficient of the twin disc: its traction where the discs slide as a whole."""
    sliding = column(read("twin_disc"), "longitudinal_creepage") >= FULL_SLIP
    return float(measured_traction()[sliding].mean())


def twin_disc(accuracy: str) -> dict[str, Any]:
    """Return traction coefficients of the discs, and the flash temperatures that their heat gives."""
    rows = read("twin_disc")
    creepage = 0.01 * column(rows, "longitudinal_creepage")
    friction = disc_friction()
    ds = tr.patch(**DISCS, friction_coefficient=friction, longitudinal_creepage=creepage, accuracy=accuracy)
    mean, largest = flash_per_watt(float(ds["semi_axis_rolling"][0]))
    heat = column(rows, "heat")
    return {
        "friction": friction,
        "traction": -ds["driving_force"].values / DISC_FORCE,
        "flash_mean": mean * heat,
        "flash_largest": largest * heat,
    }


def flash_per_watt(half_length: float) -> tuple[float, float]:
    """Return mean and largest flash temperature of like discs for each watt of friction [K/W].

    The heat has the shape of Hertz's pressure, and each disc takes a half. The mean holds for the middle of the width.

    Parameters
    ----------
    half_length : float
        Half length of the contact [mm].
    """
    steel = builtin_database().material(HEAT_STEEL)
    conductivity = 1e-3 * steel.thermal_conductivity
    diffusivity = 1e6 * steel.thermal_conductivity / (steel.density * steel.heat_capacity)
    nx, ny = STRIPS
    steps = DISC_WIDTH / nx, 2.0 * half_length / ny
    place = (2.0 * np.arange(ny) + 1.0) / ny - 1.0
    shape = np.repeat(np.sqrt(1.0 - place**2)[:, None], nx, axis=1)
    density = 0.5 * shape / (shape.sum() * steps[0] * steps[1])
    kernel = cell_temperature(steps, (nx, ny), 1e3 * DISC_SPEED / (4.0 * diffusivity))
    rise = fftconvolve(density, kernel)[ny - 1 : 2 * ny - 1, nx - 1 : 2 * nx - 1] / conductivity
    return float(rise[:, nx // 2].mean()), float(rise.max())


def close_groove(radius: float, accuracy: str) -> dict[str, Any]:
    """Return the freely rolling wheel in a groove [mm], with a/R and the errors that are told."""
    elements = {"preview": 20, "standard": 40, "reference": 60}[accuracy]
    own = grooves.rolls_freely(radius, elements)
    ratio = own["half_width"] / grooves.LATERAL_RADIUS
    told = {name: float(close_fit.model_error(np.array(ratio), law)) for name, law in close_fit.LAWS.items()}
    return own | {"conformity": ratio, "told": told}


def pin(angle: float) -> dict[str, float]:
    """Return a/R of a pin in a hole, true pressure and width over Hertz's, and what is told of both."""
    ratio, pressure, width = pin_in_hole.beside_hertz(np.deg2rad(angle))
    return {
        "conformity": ratio,
        "pressure": pressure,
        "width": width,
        "told_pressure": float(close_fit.model_error(np.array(ratio), close_fit.PRESSURE)),
        "told_width": float(close_fit.model_error(np.array(ratio), close_fit.WIDTH)),
    }


def spin(accuracy: str) -> dict[str, float]:
    """Return force, moment and friction power at lateral creepage and spin, in our frame."""
    ds = tr.patch(**SPIN, lateral_creepage=LATERAL_CREEPAGE, spin=SPIN_CREEPAGE, accuracy=accuracy)
    names = "lateral_force", "spin_moment", "friction_power", "force_error_estimate"
    return {name: float(ds[name]) for name in names}


def lives(accuracy: str) -> dict[str, Any]:
    """Return the exponents of our lives on the load, by fatigue and by wear, of a roller that rolls freely.

    `half_length` is that of its patch under the least load [mm].
    """
    case = {"motor_force": 0.0, "axial_force": 0.0, "friction_coefficient": 0.2, "permissible_wear_depth": 0.05}
    case |= {"roller_material": ROLLER_STEEL, "guide_material": ROLLER_STEEL}
    cases = [tr.Case(**case, radial_force=-load) for load in LOADS]
    ds = tr.solve(cases, ("forces", "contact", "life", "wear", "limits"), accuracy=accuracy)
    hours = ds["life_hours_by_limit"].sel(body="roller")
    exponents = {}
    for limit in ("fatigue", "wear"):
        own = np.log(hours.sel(limit=limit).values)
        exponents[limit] = float((own[-1] - own[0]) / np.log(LOADS[-1] / LOADS[0]))
    half_length = float(ds["semi_axis_rolling"][0].max())
    return {"loads": LOADS, "exponents": exponents, "half_length": half_length}
