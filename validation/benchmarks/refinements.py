"""Measure what additional slip terms, and pressures that shear moves, change for the paper's roller.

    python -m validation.benchmarks.refinements

Changes are relative to the solution without the refinement; the largest over both contacts counts. Shear moves the
pressure of unlike materials; without this the normal problem is solved once, before the shear is known.
"""

from __future__ import annotations

from typing import Any
from unittest import mock

import numpy as np
import xarray as xr

import trackroller as tr
from trackroller.contact.normal import models as normal_models
from validation.benchmarks.command import run

OUTPUTS = ("forces", "contact", "friction_work", "peak_stress")
QUANTITIES = {
    "F_N": "normal_force",
    "F_T": "lateral_force",
    "M_R": "spin_moment",
    "friction work": "friction_energy_per_distance",
    "p_max": "max_pressure",
    "peak stress": "peak_stress",
}
CURVES, DRIVES = (220.0, 39.5), {"driven": -30.0, "free": 0.0}  # mm; N
TERMS = {"profile": ("profile",), "curve": ("curve",), "both": ("profile", "curve")}
FRICTIONS = (0.3, 0.5)


def changes(with_it: xr.Dataset, without: xr.Dataset) -> dict[str, float]:
    """Return the largest relative change of each quantity."""
    return {told: float(np.abs(with_it[name] / without[name] - 1.0).max()) for told, name in QUANTITIES.items()}


def slip_terms() -> dict[str, dict[str, float]]:
    """Return the changes by guide, drive and slip terms."""
    found = {}
    for curve in CURVES:
        for drive, force in DRIVES.items():
            case = tr.Case(guide_curve_radius=curve, motor_force=force)
            plain = tr.solve(case, OUTPUTS, contact_model="kalker")
            for name, terms in TERMS.items():
                changed = tr.solve(case, OUTPUTS, contact_model="kalker", slip_terms=terms)
                found[f"{curve:g} mm, {drive}, {name}"] = changes(changed, plain)
    return found


def shear_on_pressure() -> dict[str, dict[str, float]]:
    """Return the changes for polyamide on steel by friction and drive."""
    names = [(friction, drive) for friction in FRICTIONS for drive in DRIVES]
    cases = [tr.Case(roller_material="PA6", friction_coefficient=mu, motor_force=DRIVES[drive]) for mu, drive in names]

    def solved() -> xr.Dataset:
        return tr.solve(cases, OUTPUTS, contact_model="kalker", normal="halfspace")

    def once(self: Any, ellipse: Any, slip: Any, friction: Any, rows: Any) -> Any:
        return self.patch(ellipse, slip, rows)

    with mock.patch.object(normal_models.GridKalkerModel, "settled", once):
        without = solved()
    with_it = solved()
    return {
        f"{drive}, μ = {mu:g}": changes(with_it.isel(case=[i]), without.isel(case=[i]))
        for i, (mu, drive) in enumerate(names)
    }


def measure() -> dict[str, Any]:
    """Return the changes by both refinements."""
    return {"slip_terms": slip_terms(), "shear_on_pressure": shear_on_pressure()}


if __name__ == "__main__":
    run(measure, __doc__)
