"""Measure what a digit of the worn depth costs: three rollers at three resolutions, with processor times."""

from __future__ import annotations

import time

import trackroller as tr
from validation.benchmarks.command import run

ROLLERS = {
    "free": {"motor_force": 0.0, "axial_force": 0.0},
    "driven": {"motor_force": -20.0, "axial_force": 0.0},
    "axial": {"motor_force": 0.0, "axial_force": 30.0},
}
ACCURACIES = ("preview", "standard", "reference")


def measure(travel: float = 50.0, coefficient: float = 1e-5) -> dict:
    """Return depth, pressure, estimated error and processor time of each roller and accuracy.

    Parameters
    ----------
    travel : float
        Travel [km].
    coefficient : float
        Wear coefficient of both bodies [mm3/(N m)].
    """
    steel = {"like": "1.7225-quenched-tempered", "wear_coefficient": coefficient}
    out: dict = {}
    for name, loads in ROLLERS.items():
        case = tr.Case(friction_coefficient=0.2, roller_material=steel, guide_material=steel, **loads)
        out[name] = {}
        for accuracy in ACCURACIES:
            tr.wear(case, 0.01, contact_model="kalker", accuracy=accuracy)  # compile and load
            start = time.process_time()
            ds = tr.wear(case, travel, contact_model="kalker", accuracy=accuracy)
            last = ds.isel(travel=-1)
            out[name][accuracy] = {
                "seconds": time.process_time() - start,
                "states": ds.sizes["travel"],
                "end": str(ds.attrs["end"]),
                "depth_um": 1e3 * float(last["groove_depth"].max()),
                "error_um": 1e3 * float(last["groove_depth_error"]),
                "pressure_MPa": float(last["max_pressure"].max()),
            }
    return out


if __name__ == "__main__":
    run(measure, __doc__)
