"""Compare this package with the published program, CONTACT, Kalker's printed table and pyLife.

    python -m validation.benchmarks.peers

Reference numbers lie in `tests/data`; pyLife is run. Each comparison gives deviations over all its cases, without
choosing cases: a case that is left out is counted and its reason is stated.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pylife.materiallaws.woehlercurve  # noqa: F401  registers the accessor `.woehler`

import trackroller as tr
from trackroller.contact.linear import creepage_coefficients
from trackroller.damage.sn_curve import SNCurve
from trackroller.parameters import LIFE_RULES
from validation.benchmarks.command import run

DATA = Path(__file__).resolve().parents[2] / "tests" / "data"
REFERENCES = ("published_program.json", "contact.json", "kalker_coefficients.csv")
FORCES = ("normal_force", "lateral_force", "driving_force", "spin_moment", "rolling_radius_shift")
# Of one equilibrium by CONTACT [s], as recorded with its results on another machine; CONTACT is not run here.
CONTACT_SECONDS = {"40x40": 2.5, "60x60": 4.7}
ON_SURFACE = 0.1  # of the smaller semi-axis; a peak that lies higher counts as one on the surface
PATCHES = ("semi_axis_lateral", "semi_axis_rolling", "max_pressure")
Row = dict[str, Any]


def case_of(record: Mapping[str, Any]) -> tr.Case:
    """Return the case of a record; JSON has no infinity, so infinity stands there as text."""
    return tr.Case.from_dict({k: float(v) if v == "inf" else v for k, v in record["case"].items()})


def row(quantity: str, against: str, ours: Sequence[Any], theirs: Sequence[Any], scales: Sequence[Any]) -> Row:
    """Return the median and the largest deviation of one quantity over all cases, each over its scale.

    Parameters
    ----------
    quantity, against : str
        Names for the page.
    ours, theirs, scales : sequence of array_like
        One entry a case. The deviation of a case is its largest one over both contacts.
    """
    deviations = [
        float(np.max(np.abs(np.asarray(a, float) - np.asarray(b, float)) / np.asarray(s, float)))
        for a, b, s in zip(ours, theirs, scales, strict=True)
    ]
    return {
        "quantity": quantity,
        "against": against,
        "cases": len(deviations),
        "median": float(np.median(deviations)),
        "largest": float(np.max(deviations)),
    }


def _scale(name: str, theirs: Mapping[str, Any], friction: float) -> Any:
    """Return the divisor of a deviation; friction forces may vanish, so their divisor is mu F_N."""
    load = max(theirs["normal_force"])
    if name in ("lateral_force", "driving_force"):
        return friction * load
    if name == "spin_moment":
        return max(abs(v) for v in theirs[name])
    return np.max(np.abs(theirs[name]))


def published_program() -> tuple[list[Row], dict[str, int]]:
    """Compare with the published program and with an independent quadrature of the same equations."""
    records = json.loads((DATA / REFERENCES[0]).read_text(encoding="utf-8"))["cases"]
    exact = [r for r in records if r.get("exact")]
    printed = [r for r in exact if r.get("published") and not r["axes_swapped_in_published_program"]]
    rows = []
    for label, key, kept, options in (
        ("independent quadrature of the same equations", "exact", exact, {}),
        ("published program, with its table of ellipses", "published", printed, {"hertz": "published"}),
    ):
        ds = tr.solve([case_of(r) for r in kept], outputs=("forces", "contact"), contact_model="sliding", **options)
        for name in (*FORCES, *PATCHES):
            known = [i for i, r in enumerate(kept) if name in r[key]]
            theirs = [kept[i][key][name] for i in known]
            scales = [_scale(name, kept[i][key], kept[i]["case"]["friction_coefficient"]) for i in known]
            if known:
                rows.append(row(name, label, [ds[name].values[i] for i in known], theirs, scales))
    left_out = {
        "cases in which the published program stops or has no rolling solution": len(records)
        - sum(1 for r in records if r.get("published")),
        "cases in which the published program turns its ellipse": sum(
            1 for r in records if r.get("axes_swapped_in_published_program")
        ),
    }
    return rows, left_out


def contact_program() -> list[Row]:
    """Compare the exact theory with CONTACT in the roller's equilibrium, its two grids extrapolated to first order."""
    records = json.loads((DATA / REFERENCES[1]).read_text(encoding="utf-8"))["cases"]
    kept = [r for r in records if "grid_60x60" in r and "grid_40x40" in r]
    rows = []
    driven = [i for i, r in enumerate(kept) if r["case"]["motor_force"] != 0]
    for model in ("kalker", "sliding"):
        ds = tr.solve([case_of(r) for r in kept], outputs=("forces", "contact", "peak_stress"), contact_model=model)
        for name in FORCES[:4]:
            theirs = [3 * np.array(r["grid_60x60"][name]) - 2 * np.array(r["grid_40x40"][name]) for r in kept]
            scales = [_scale(name, r["grid_60x60"], r["case"]["friction_coefficient"]) for r in kept]
            rows.append(row(name, f"CONTACT, our `{model}`", list(ds[name].values), theirs, scales))
        name, shift = "rolling_radius_shift, driven or braked", ds.rolling_radius_shift.values
        theirs = [
            3 * r["grid_60x60"]["rolling_radius_shift"] - 2 * r["grid_40x40"]["rolling_radius_shift"] for r in kept
        ]
        pick = [theirs[i] for i in driven]
        rows.append(row(name, f"CONTACT, our `{model}`", [shift[i] for i in driven], pick, np.abs(pick)))
        rows += peaks(kept, ds, f"CONTACT, our `{model}`")
    return rows


def peaks(records: Sequence[Any], ds: Any, against: str) -> list[Row]:
    """Compare peak stresses with the largest ones under CONTACT's tractions, apart on the surface and below.

    A peak counts as one on the surface if either program finds it there: an element grid misses narrow ridges.
    """
    size = np.minimum(ds.semi_axis_lateral.values, ds.semi_axis_rolling.values)
    deep = ds.peak_z.values > ON_SURFACE * size[..., None]  # (cases, contact, body)
    found: dict[str, list[tuple[float, float]]] = {"on the surface": [], "below the surface": []}
    for i, record in enumerate(records):
        for key, values in record.get("subsurface", {}).items():
            top, contact, body = values["global_max"], int(key[1]) - 1, ("roller", "guide").index(values["body"])
            at = i, contact, body
            below = deep[at] and top["depth_over_min_semiaxis"] > ON_SURFACE
            stresses = float(ds.peak_stress.values[at]), top["sigma_vm_MPa"]
            found["below the surface" if below else "on the surface"].append(stresses)
    return [
        row(f"peak_stress, {place}", against, *zip(*pairs, strict=True), [theirs for _, theirs in pairs])
        for place, pairs in found.items()
        if pairs
    ]


def linear_theory() -> list[Row]:
    """Compare creepage coefficients with Kalker's table E.3, which is printed with three digits."""
    table = np.loadtxt(DATA / REFERENCES[2], delimiter=",", skiprows=2)
    ours = creepage_coefficients(table[:, 0], table[:, 1])
    columns = {"C11": ours.c11, "C22": ours.c22, "C23": ours.c23}
    return [
        row(name, "Kalker (1990), table E.3", list(values), list(table[:, 2 + i]), list(table[:, 2 + i]))
        for i, (name, values) in enumerate(columns.items())
    ]


def pylife_lives() -> list[Row]:
    """Compare lives on the S-N curve with pyLife, for each rule below the fatigue limit."""
    strength, limit, first, knee = 720.0, 360.0, 1e4, 5e6  # MPa, MPa, cycles, cycles
    exponent = np.log(knee / first) / np.log(strength / limit)
    stress = np.array([120.0, 250.0, 345.0, 380.0, 500.0, 700.0])
    below = {"elementary": exponent, "haibach": 2 * exponent - 1, "unlimited": np.inf}
    rows = []
    for rule in LIFE_RULES:
        curve = pd.Series({"SD": limit, "ND": knee, "k_1": exponent, "k_2": below[rule]}).woehler
        theirs = curve.cycles(stress)
        ours = SNCurve(strength, limit, first, knee, rule).life_cycles(stress)
        finite = np.isfinite(theirs)
        assert (np.isfinite(ours) == finite).all(), rule
        rows.append(row(f"life_cycles, {rule}", "pyLife", ours[finite], theirs[finite], theirs[finite]))
    return rows


def measure() -> dict[str, Any]:
    """Return all comparisons, the cases left out, and the recorded times of CONTACT."""
    published, left_out = published_program()
    return {
        "rows": [*published, *contact_program(), *linear_theory(), *pylife_lives()],
        "left_out": left_out,
        "contact_seconds": CONTACT_SECONDS,
    }


if __name__ == "__main__":
    run(measure, __doc__)
