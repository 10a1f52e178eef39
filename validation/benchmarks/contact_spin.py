"""Measure the error of full sliding against the exact theory over friction, drive, contact angle and size.

    python -m validation.benchmarks.contact_spin [--accuracy PRESET]

540 rollers on a straight guide: friction 0.02 to 0.5, contact angle 12 to 75 deg, axis distance 15 to 1000 mm, pressed
by 200 N, free, with 30 N of axial force, and driven by 6 N. Spin is phi rho (`spin`).
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

import trackroller as tr
from trackroller.parameters import PARAMETERS
from trackroller.roller.geometry import contact_geometry
from validation.benchmarks.command import run
from validation.contact_models.product import model_errors, spread

STUDY: dict[str, Any] = {
    "name": "contact-spin",
    "base": {"radial_force": -200.0, "guide_curve_radius": np.inf},
    "factors": {
        "friction_coefficient": {"values": [0.02, 0.05, 0.1, 0.2, 0.3, 0.5]},
        "contact_angle": {"values": [12, 20, 30, 45, 60, 75]},
        "axis_distance": {"values": [15, 21.75, 60, 200, 1000]},
    },
    "outputs": ["forces", "contact", "friction_work", "peak_stress"],
    "contact_model": ["sliding", "kalker"],
}
LOADS = {
    "free": {"axial_force": 0.0, "motor_force": 0.0},
    "free, 30 N axial": {"axial_force": 30.0, "motor_force": 0.0},
    "driven by 6 N": {"axial_force": 0.0, "motor_force": -6.0},
}
LEANS = (0.0, 0.05, 0.1, 0.2, 0.5, 2.0)
SPINS = (0.0, 0.2, 0.5, 10.0)


def spin(inputs: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the dimensionless spin of designs, phi rho with phi = sin(alpha)/r_A and 4/rho = k_x + k_y.

    Parameters
    ----------
    inputs : mapping of str to numpy.ndarray
        Columns of `geometry.contact_geometry`, shape (n,).

    Returns
    -------
    numpy.ndarray
        phi rho [1], shape (n,).

    Notes
    -----
    phi [1/mm] is the spin creepage and rho [mm] is the radius of curvature of Kalker (1990), "Three-Dimensional Elastic
    Bodies in Rolling Contact". Their product over the friction coefficient says how close the patch is to full sliding.
    It does not depend on load and stiffness.
    """
    geometry = contact_geometry(inputs)
    curvature = geometry.curvature_lateral + geometry.curvature_rolling
    return np.asarray(np.sin(geometry.contact_angle) / geometry.rolling_radius * 4.0 / curvature)


def errors_of(base: Mapping[str, float], accuracy: str) -> xr.Dataset:
    """Return the errors of full sliding for one load, with `spin`, and with `lean`, which is mu tan(alpha)."""
    solved = tr.run(STUDY | {"base": STUDY["base"] | base, "accuracy": accuracy}, progress=False)
    ds = model_errors(solved).sel(contact_model="sliding")
    values = {name: p.default for name, p in PARAMETERS.items()} | STUDY["base"] | base
    inputs = {n: ds[n].values if n in ds.coords else np.full(ds.sizes["design"], v, float) for n, v in values.items()}
    lean = inputs["friction_coefficient"] * np.tan(np.deg2rad(inputs["contact_angle"]))
    return ds.assign_coords(spin=("design", spin(inputs)), lean=("design", lean))


def by_step(error: np.ndarray, over: np.ndarray, limits: tuple[float, ...]) -> dict[str, dict[str, float]]:
    """Return the spread of the errors in each interval between neighbouring limits."""
    return {
        f"{low:g} to {high:g}": spread(error[(over >= low) & (over < high)]) for low, high in itertools.pairwise(limits)
    }


def measure(accuracy: str = "standard") -> dict[str, Any]:
    """Return the errors of full sliding: of all rollers, by mu tan(alpha) and load, and by friction and spin."""
    loads = {name: errors_of(load, accuracy) for name, load in LOADS.items()}

    def joined(name: str) -> np.ndarray:
        return np.concatenate([ds[name].values for ds in loads.values()])

    mu, flat = joined("friction_coefficient"), joined("contact_angle") <= 60
    peak, spin = joined("peak_stress"), joined("spin")
    return {
        "rollers": mu.size,
        "all": {str(name): spread(joined(str(name))) for name in loads["free"].data_vars},
        "normal_force_by_lean": {
            name: by_step(ds.normal_force.values, ds.lean.values, LEANS) for name, ds in loads.items()
        },
        "peak_stress_by_spin": {
            f"{m:g}": by_step(peak[(mu == m) & flat], spin[(mu == m) & flat], SPINS)
            for m in STUDY["factors"]["friction_coefficient"]["values"]
        },
    }


if __name__ == "__main__":
    run(measure, __doc__)
