"""The published example computed anew: every table and figure of Wenzel et al. 2022 that a computation yields.

Numbers that the paper's program and CONTACT print are those of `tests/data`, which the tests use too.
"""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.contact.quantities import Ellipse
from trackroller.contact.slip import Slip, spin_model_index
from trackroller.halfspace.ellipse import patch_rows, stress_parts
from trackroller.halfspace.stress import von_mises
from trackroller.materials import load_database
from trackroller.roller.case import Case
from trackroller.roller.geometry import rolling_radius
from trackroller.roller.solver import solve
from validation.paper.table_2 import paper_table

if TYPE_CHECKING:
    import xarray as xr

ROOT = Path(__file__).resolve().parents[2]
STORED = ROOT / "docs" / "data" / "paper.json"  # the run that the documentation shows
# the paper's figures: 7 frictionless and with friction, free; 6 and 8 to 11 with friction, driven
SCENES = {
    "frictionless": {"friction_coefficient": 1e-4, "motor_force": 0.0},
    "free": {"friction_coefficient": 0.3, "motor_force": 0.0},
    "driven": {"friction_coefficient": 0.3, "motor_force": -30.0},
}
PRINTED = ("published_program", "contact")
SCENES_AT = {"frictionless": 0, "free": 2, "driven": 3}  # places in tests/data/published_program.json
LIMITS = {"axes swapped": 17, "axes swapped, heavier": 14, "nearly circular": 18}
CONTACT_AT = {"free": "mu0.3_FM0_rC220_Fax30", "driven": "mu0.3_FM-30_rC220_Fax30"}
MODELS = ("sliding", "kalker")
QUANTITIES = ("normal_force", "lateral_force", "driving_force", "spin_moment", "max_pressure", "rolling_radius_shift")
_FIELDS = ("forces", "contact", "friction_work", "peak_stress", "life", "tractions", "subsurface")


@lru_cache(maxsize=1)
def reference() -> dict[str, Any]:
    """Return what the published program and CONTACT print for each of `SCENES` and `LIMITS`.

    Returns
    -------
    dict
        By name: `case`, `published` (at the program's standard 40 points) and, where CONTACT was run, `contact`
        (release 2025, Hertzian pressures, 60x60 and 40x40 elements extrapolated to first order, peak stresses on the
        40x40 elements).
    """
    data = {name: json.loads((ROOT / "tests" / "data" / f"{name}.json").read_text()) for name in PRINTED}
    known = {name: data["published_program"]["cases"][number] for name, number in (SCENES_AT | LIMITS).items()}
    runs = {run["name"]: run for run in data["contact"]["cases"]}
    return known | {scene: known[scene] | {"contact": _extrapolated(runs[name])} for scene, name in CONTACT_AT.items()}


def _extrapolated(run: dict[str, Any]) -> dict[str, Any]:
    fine, coarse = run["grid_60x60"], run["grid_40x40"]
    found = {name: (3 * np.array(fine[name]) - 2 * np.array(coarse[name])).tolist() for name in fine}
    peak = {key: entry["global_max"]["sigma_vm_MPa"] for key, entry in run["subsurface"].items()}
    return found | {"peak_stress": [[peak[f"c{i}_{body}"] for body in ("roller", "guide")] for i in (1, 2)]}


def stored() -> dict[str, Any]:
    """Return the numbers of `results` that the documentation holds."""
    return json.loads(STORED.read_text(encoding="utf-8"))


def case_of(scene: str) -> Case:
    """Return the paper's example in one of `SCENES`."""
    return Case(**SCENES[scene])  # type: ignore[arg-type]


@lru_cache(maxsize=8)
def solved(scene: str, model: str, accuracy: str = "standard") -> xr.Dataset:
    """Return all results of a scene with a contact model."""
    return solve(case_of(scene), outputs=_FIELDS, contact_model=model, accuracy=accuracy)


def as_published(case: Case) -> xr.Dataset:
    """Solve with the published model: its own Hertz table and one body of mean Poisson's ratio."""
    return solve(
        case,
        outputs=("forces", "contact", "peak_stress", "life"),
        contact_model="sliding",
        hertz="published",
        stress_bodies="published",
    )


def stress_at(scene: str, points: list[list[float]]) -> list[float]:
    """Return the von Mises stress [MPa] of `sliding` on the roller, at one point (x, y, z) [mm] below each contact."""

    ds, case = solved(scene, "sliding"), case_of(scene)
    alpha = np.deg2rad(case.contact_angle) * np.array([1.0, -1.0])
    full = lambda v: np.full(2, float(v))  # noqa: E731
    r_a = rolling_radius(full(case.axis_distance), full(case.guide_profile_radius), alpha)
    ellipse = Ellipse(*(ds[n].values for n in ("semi_axis_lateral", "semi_axis_rolling", "max_pressure")))
    slip = Slip(np.sin(alpha), np.cos(alpha), full(case.guide_profile_radius), r_a, full(ds.rolling_radius_shift))
    rows = patch_rows(ellipse, slip, full(case.friction_coefficient), spin_model_index("skewed"))
    nu, found = load_database().material(case.roller_material).poisson_ratio, []
    for row, point, pressure in zip(rows, points, ellipse.max_pressure, strict=True):
        parts = stress_parts(row, np.array([point]), 48, 48)
        found.append(float(von_mises(parts[:, 0] + nu * parts[:, 1] + parts[:, 2] + nu * parts[:, 3])[0] * pressure))
    return found


def _values(ds: xr.Dataset, names: tuple[str, ...]) -> dict[str, Any]:
    return {name: np.round(ds[name].values.astype(float), 7).tolist() for name in names if name in ds}


def results() -> dict[str, Any]:
    """Return all numbers of the page: ours by scene and model, and scenes that the published program cannot treat.

    Keys: `ours` scene -> model -> quantities; `as_published` scene -> quantities with the published table;
    `inner` scene -> our stress at the published place of the peak; `limits` name -> our solution; `table_2` its rows.
    """
    told = (
        *QUANTITIES,
        "peak_stress",
        "peak_z",
        "life_cycles",
        "friction_energy_per_distance",
        "friction_energy_balance",
        "energy_residual",
        "transmitted_force",
        "stick_area_fraction",
    )
    known = reference()
    out: dict[str, Any] = {"ours": {}, "as_published": {}, "inner": {}, "limits": {}}
    for scene in SCENES:
        out["ours"][scene] = {model: _values(solved(scene, model), told) for model in MODELS}
        places = known[scene]["published"]["peak_position"]
        out["inner"][scene] = [round(v, 3) for v in stress_at(scene, places)]
        out["as_published"][scene] = _values(as_published(case_of(scene)), (*QUANTITIES, "peak_stress"))
    for name in LIMITS:
        case = Case.from_dict({k: float(v) if v == "inf" else v for k, v in known[name]["case"].items()})
        ds = solve(case, contact_model="sliding")
        out["limits"][name] = _values(
            ds, (*QUANTITIES, "semi_axis_lateral", "semi_axis_rolling", "peak_stress", "life_cycles")
        )
    return out | {"table_2": paper_table()}
