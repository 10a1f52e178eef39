"""Measure what a digit of the worn depth costs: three rollers at three resolutions, with processor times."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import trackroller as tr
from trackroller.report.figures import style
from validation.benchmarks.command import run

ROLLERS = {
    "free": {"motor_force": 0.0, "axial_force": 0.0},
    "driven": {"motor_force": -20.0, "axial_force": 0.0},
    "axial": {"motor_force": 0.0, "axial_force": 30.0},
}
ACCURACIES = ("preview", "standard", "reference")


def measure(travel: float = 50.0, coefficient: float = 1e-5, accuracies: tuple[str, ...] = ACCURACIES) -> dict:
    """Return depth, pressure, estimated error and processor time of each roller and accuracy.

    Parameters
    ----------
    travel : float
        Travel [km].
    coefficient : float
        Wear coefficient of both bodies [mm3/(N m)].
    accuracies : tuple of str
        Resolutions that are measured.
    """
    steel = {"like": "1.7225-quenched-tempered", "wear_coefficient": coefficient}
    out: dict = {}
    for name, loads in ROLLERS.items():
        case = tr.Case(friction_coefficient=0.2, roller_material=steel, guide_material=steel, **loads)
        out[name] = {}
        for accuracy in accuracies:
            tr.wear(case, 0.01, contact_model="kalker", accuracy=accuracy)  # compile and load
            start = time.process_time()
            ds = tr.wear(case, travel, contact_model="kalker", accuracy=accuracy)
            last = ds.isel(travel=-1)
            out[name][accuracy] = {
                "travel_km": ds["travel"].values,
                "depths_um": 1e3 * ds["groove_depth"].max(("contact", "body")).values,
                "pressures_MPa": ds["max_pressure"].max("contact").values,
                "seconds": time.process_time() - start,
                "states": ds.sizes["travel"],
                "end": str(ds.attrs["end"]),
                "depth_um": 1e3 * float(last["groove_depth"].max()),
                "error_um": 1e3 * float(last["groove_depth_error"]),
                "pressure_MPa": float(last["max_pressure"].max()),
            }
    return out


def draw(measured: dict[str, Any], folder: Path) -> None:
    """Draw depth and largest pressure over the travel of each roller at each resolution, `groove.png` in a folder."""
    with style.look():
        figure = style.new_figure(80, 2 * style.COLUMN_MM)
        panels = figure.subplots(2, len(ROLLERS), sharex=True, sharey="row")
        for column, name in enumerate(ROLLERS):
            for accuracy, colour, line in zip(ACCURACIES, style.palette(3), style.LINES, strict=False):
                own = measured[name][accuracy]
                for axes, what in zip(panels[:, column], ("depths_um", "pressures_MPa"), strict=True):
                    axes.plot(own["travel_km"], own[what], color=colour, ls=line, marker=".", label=accuracy)
            panels[0, column].set_title(name)
            panels[1, column].set_xlabel("travel [km]")
        for axes, words in zip(panels[:, 0], ("depth [µm]", "largest pressure [MPa]"), strict=True):
            axes.set_ylabel(words)
            axes.set_ylim(bottom=0)
        panels[0, 0].legend(frameon=False)
        style.head(figure, "Three rollers while they wear, at three resolutions")
        style.save(figure, folder, "groove")
        (folder / "groove.svg").unlink()  # the page shows the PNG


if __name__ == "__main__":
    run(measure, __doc__)
