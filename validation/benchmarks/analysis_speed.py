"""Processor time of the analysis of a large study, by part, on made-up results.

    OPENBLAS_NUM_THREADS=1 python -m validation.benchmarks.analysis_speed [--rows N] [--output FILE]

A Latin hypercube of eight factors, one of them a list, with the results of `tests/synthetic_results.py` instead of
solved ones. The parts are the functions below `analyse`; a part that calls another one includes it. The
goal is 45 s for 100,000 rows.
"""

from __future__ import annotations

import cProfile
import pstats
import sys
import time
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.analysis.sensitivity import analyse
from trackroller.analysis.stored_study import read_results
from trackroller.analysis.table import StudyResults
from trackroller.study.file.load import parse_study
from validation.benchmarks.command import run

TESTS = Path(__file__).resolve().parents[2] / "tests"
STUDY: dict[str, Any] = {
    "name": "analysis-speed",
    "design": "lhs",
    "seed": 1,
    "factors": {
        "friction_coefficient": {"uniform": [0.02, 0.4]},
        "roller_profile_radius": {"uniform": [-9, -6.3]},
        "guide_curve_radius": {"loguniform": [100, 1000]},
        "axial_force": {"uniform": [0, 100]},
        "radial_force": {"uniform": [-300, -150]},
        "motor_force": {"uniform": [-30, 0]},
        "contact_angle": {"uniform": [28, 40]},
        "material_pair": {"values": [["1.7225-normalised"] * 2, ["EN AW-7075", "1.7225-normalised"]]},
    },
    "outputs": ["forces", "contact", "peak_stress", "life"],
}
PARTS = ("outputs", "firsts", "prcc", "delta", "pawn", "pawn_interval", "pairs", "course")


def made_up(rows: int) -> StudyResults:
    """Return a solved study with made-up results.

    Parameters
    ----------
    rows : number of cases

    Returns
    -------
    StudyResults with data along `case`.
    """
    sys.path.insert(0, str(TESTS))
    study = parse_study(STUDY | {"samples": rows})
    ds = study.design()
    columns = {name: ds[name].values for name in STUDY["factors"] if name in ds}
    columns["material_pair"] = np.array(
        [" / ".join(pair) for pair in zip(ds["roller_material"].values, ds["guide_material"].values, strict=True)],
        object,
    )
    results = import_module("synthetic_results").results(columns)
    ds = ds.assign({name: (("case", *dims), values) for name, (dims, values) in results.items()})
    ds["max_pressure"] = ds["peak_stress"].max("body") / (0.6 + 0.1 * ds["friction_coefficient"])
    ds["drilling_torque"] = (ds["normal_force"] * ds["semi_axis_rolling"]).sum("contact") * ds["friction_coefficient"]
    ds["slip"] = 1e-3 * ds["motor_force"] / ds["normal_force"].sum("contact") / ds["semi_axis_lateral"].max("contact")
    return read_results(ds.assign_coords(contact=[1, 2], body=["roller", "guide"]))


def measure(rows: int = 100_000) -> dict[str, Any]:
    """Return the processor time of the analysis and of its parts [s], and how many outputs it had."""
    analyse(made_up(500))  # imports and caches
    results = made_up(rows)
    start = time.process_time()
    result = analyse(results)
    whole = time.process_time() - start
    profile = cProfile.Profile(time.process_time)
    profile.runcall(analyse, results)
    parts = dict.fromkeys(PARTS, 0.0)
    for (file, _, name), numbers in pstats.Stats(profile).stats.items():  # type: ignore[attr-defined]
        if name in parts and "trackroller" in file:
            parts[name] += numbers[3]
    return {"rows": rows, "outputs": result.sizes["output"], "seconds": whole, "parts": parts}


if __name__ == "__main__":
    run(measure, __doc__)
