"""Solve the cases of the benchmark with this program, and write its results as any other program would."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

import trackroller as tr
from trackroller.files import write_text
from validation.measured import grooves
from validation.measured.benchmark.table import QUANTITIES, read_cases

OURS = "trackroller"  # name of this program in the table
ELEMENTS = {"preview": 20, "standard": 40, "reference": 60}  # of wheels in grooves
REMARK = "exact theory, accuracy {}, Hertz's patches"


def write_entry(path: Path, accuracy: str = "standard") -> None:
    """Write the results of this program as a file of the benchmark.

    Parameters
    ----------
    path : Path
        The CSV file.
    accuracy : str
        Rung of the solutions.
    """
    text = io.StringIO()
    text.write(f"# {REMARK.format(accuracy)}\n")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["case", *(f"{name} [{unit}]" for name, unit in QUANTITIES.items())])
    for case, inputs in read_cases().items():
        own = groove(inputs, accuracy) if inputs["set"] == "groove" else patch(inputs, accuracy)
        writer.writerow([case, *(f"{own[name]:.6g}" if name in own else "" for name in QUANTITIES)])
    write_text(path, text.getvalue())


def patch(inputs: Mapping[str, float | str], accuracy: str) -> dict[str, float]:
    """Return the results of a case with given semi-axes and creepages by their names in `QUANTITIES`."""
    number = {name: float(value) for name, value in inputs.items() if name != "set"}
    modulus = 2.0 * number["shear_modulus"] * (1.0 + number["poisson_ratio"])
    law = None
    if number["friction_lowest"] != number["friction_at_rest"]:
        share = number["friction_lowest"] / number["friction_at_rest"]
        law = {"kind": "exponential", "speed": number["half_value_speed"] / math.log(2.0), "lowest": share}
    ds = tr.patch(
        number["normal_force"],
        semi_axes=(number["semi_axis_lateral"], number["semi_axis_rolling"]),
        materials={"youngs_modulus": modulus, "poisson_ratio": number["poisson_ratio"]},
        friction_coefficient=number["friction_at_rest"],
        friction_law=law,
        layer_flexibility=number["layer_flexibility"],
        velocity=60.0 * number["velocity"],
        accuracy=accuracy,
        **{name: number[name] for name in ("longitudinal_creepage", "lateral_creepage", "spin")},
    )
    names = "lateral_force", "driving_force", "spin_moment", "max_pressure", "friction_power"
    return {name: float(ds[name]) for name in names}


def groove(inputs: Mapping[str, float | str], accuracy: str) -> dict[str, float]:
    """Return the results of a wheel that rolls freely in a groove by their names in `QUANTITIES`."""
    own = grooves.rolls_freely(float(inputs["groove_radius"]), ELEMENTS[accuracy])
    return {name: float(np.asarray(own[name])) for name in QUANTITIES if name in own}
