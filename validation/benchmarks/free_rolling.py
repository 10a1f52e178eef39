"""How well the rolling radius shift of free rolling is known: CONTACT's cases on ever finer grids of our own.

    python -m validation.benchmarks.free_rolling [--elements 160] [--every 1] [--output limit.json]

Rolling freely, r_Delta0 is below a thousandth of a millimetre and hangs on the few elements about the point where the
slip vanishes: a grid that does not resolve the stick area there is wrong by some per cent, and by no power of the size
of its elements. Prints r_Delta0 [1e-3 mm] of CONTACT with 40 and 60 elements and extrapolated, of `standard`, and of
one fine grid without extrapolation, whose stick area has a hundred elements; then the largest differences from it.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np

import trackroller as tr
from trackroller.contact.common import Elastic
from trackroller.contact.kalker import KalkerSettings
from trackroller.contact.kalker.law import KalkerLaw
from trackroller.roller import equilibrium as eq
from trackroller.roller.case import to_table
from trackroller.roller.options import Options
from trackroller.roller.stages import mechanics as stages

ABOUT = (
    "r_Delta0 [mm] of the free-rolling cases of contact.json on one grid of the exact theory without extrapolation, "
    "which resolves the stick area where the slip vanishes; written by validation/benchmarks/free_rolling.py --output"
)
DATA = Path(__file__).resolve().parents[2] / "tests" / "data" / "contact.json"


def on_one_grid(case: dict, elements: int) -> float:
    """r_Delta0 [mm] of a case on one grid, without extrapolation."""
    scene = stages.prepare(to_table([case], None), Options(outputs=("forces",), contact_model="kalker"))
    steel = Elastic.of_pair(210e3, 0.33, 210e3, 0.33)
    elastic = Elastic(*(np.full(1, float(v)) for v in (steel.shear_modulus, steel.poisson_ratio, 0.0)))
    law = KalkerLaw(elastic, KalkerSettings(elements=elements, extrapolate=False, tolerance=1e-8))
    found = eq.solve_equilibrium(scene.loads, law)
    if not found.converged.all():
        raise SystemExit(f"no balance: {case}")
    return float(found.shift[0])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, default=160, help="along each axis of the fine grid")
    parser.add_argument("--every", type=int, default=1, help="take every n-th case only")
    parser.add_argument("--output", type=Path, help="write r_Delta0 [mm] of the fine grid by case")
    given = parser.parse_args()
    records = [r for r in json.loads(DATA.read_text(encoding="utf-8"))["cases"] if r["case"]["motor_force"] == 0]
    rows, limits = [], {}
    print(f"{'case':26s} {'C 40':>8s} {'C 60':>8s} {'C extra':>8s} {'standard':>8s} {given.elements:>8d}")
    for record in records[:: given.every]:
        start, case = time.process_time(), record["case"]
        coarse, fine = (record[f"grid_{n}x{n}"]["rolling_radius_shift"] for n in (40, 60))
        own = float(tr.solve([case], outputs=("forces",), contact_model="kalker").rolling_radius_shift[0])
        limit = on_one_grid(case, given.elements)
        rows.append((coarse, fine, fine + 2 * (fine - coarse), own, limit))
        limits[record["name"]] = float(f"{limit:.6g}")
        print(
            f"{record['name']:26s} "
            + " ".join(f"{1e3 * v:8.4f}" for v in rows[-1])
            + f"   {time.process_time() - start:.0f} s",
            flush=True,
        )
        if given.output:
            stored = {"about": ABOUT, "elements": given.elements, "rolling_radius_shift": limits}
            given.output.write_text(json.dumps(stored, indent=1), encoding="utf-8")
    error = np.abs(np.array(rows)[:, :4] / np.array(rows)[:, 4:] - 1.0)
    for name, e in zip(("CONTACT 40x40", "CONTACT 60x60", "CONTACT extrapolated", "standard"), error.T, strict=True):
        print(f"{name:22s} from the fine grid: median {100 * np.median(e):.1f} %, largest {100 * e.max():.1f} %")


if __name__ == "__main__":
    main()
