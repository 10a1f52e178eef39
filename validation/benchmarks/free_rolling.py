"""Compare the rolling radius shift in free rolling with that on a very fine grid, for CONTACT and for this package.

    python -m validation.benchmarks.free_rolling [--elements N] [--every N] [--limits FILE]

Rolling freely, r_Delta0 is below a thousandth of a millimetre and hangs on the few elements about the point where the
slip vanishes: a grid that does not resolve the stick area there is wrong by some per cent, and by no power of the size
of its elements. Compared are CONTACT with 40 and 60 elements and extrapolated, `standard` and `reference` with one fine
grid without extrapolation, whose stick area has a hundred elements. `--limits` keeps the shifts of the fine grid, which
the tests read.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

import trackroller as tr
from trackroller.contact.kalker import KalkerSettings
from trackroller.contact.kalker.law import KalkerLaw
from trackroller.contact.quantities import Elastic
from trackroller.roller import equilibrium as eq
from trackroller.roller.case import to_table
from trackroller.roller.options import Options
from trackroller.roller.stages import mechanics as stages
from validation.benchmarks.command import run

ABOUT = (
    "r_Delta0 [mm] of the free-rolling cases of contact.json on one grid of the exact theory without extrapolation, "
    "which resolves the stick area where the slip vanishes; written by validation/benchmarks/free_rolling.py --limits"
)
DATA = Path(__file__).resolve().parents[2] / "tests" / "data" / "contact.json"


def on_one_grid(case: dict, elements: int) -> float:
    """Return r_Delta0 [mm] of a case on one grid, without extrapolation."""
    scene = stages.prepare(to_table([case], None), Options(outputs=("forces",), contact_model="kalker"))
    steel = Elastic.of_pair(210e3, 0.33, 210e3, 0.33)
    elastic = Elastic(*(np.full(1, float(v)) for v in (steel.shear_modulus, steel.poisson_ratio, 0.0)))
    law = KalkerLaw(elastic, KalkerSettings(elements=elements, extrapolate=False, tolerance=1e-8))
    found = eq.solve_equilibrium(scene.loads, law)
    if not found.converged.all():
        raise SystemExit(f"no balance: {case}")
    return float(found.shift[0])


def shifts(record: dict, elements: int) -> dict[str, float]:
    """Return r_Delta0 [mm] of a recorded case by CONTACT, by the presets and on the fine grid."""
    coarse, fine = (record[f"grid_{n}x{n}"]["rolling_radius_shift"] for n in (40, 60))
    own = {
        f"kalker, {accuracy}": float(
            tr.solve(
                [record["case"]], outputs=("forces",), contact_model="kalker", accuracy=accuracy
            ).rolling_radius_shift[0]
        )
        for accuracy in ("standard", "reference")
    }
    return {
        "CONTACT, 40x40": coarse,
        "CONTACT, 60x60": fine,
        "CONTACT, extrapolated": fine + 2 * (fine - coarse),
        **own,
        "limit": on_one_grid(record["case"], elements),
    }


def measure(elements: int = 160, every: int = 1, limits: str = "") -> dict[str, Any]:
    """Return the errors of r_Delta0 against a grid of `elements` squared, for every n-th recorded case."""
    records = [r for r in json.loads(DATA.read_text(encoding="utf-8"))["cases"] if r["case"]["motor_force"] == 0]
    found = {record["name"]: shifts(record, elements) for record in records[::every]}
    if limits:
        kept = {name: float(f"{each['limit']:.6g}") for name, each in found.items()}
        stored = {"about": ABOUT, "elements": elements, "rolling_radius_shift": kept}
        Path(limits).write_text(json.dumps(stored, indent=1), encoding="utf-8")
    errors = {
        name: [abs(each[name] / each["limit"] - 1.0) for each in found.values()]
        for name in next(iter(found.values()))
        if name != "limit"
    }
    told = {name: {"median": np.median(e), "largest": np.max(e)} for name, e in errors.items()}
    return {"shifts": found, "errors": told}


if __name__ == "__main__":
    run(measure, __doc__)
