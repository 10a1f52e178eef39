"""The recorded studies: one small study of every design, and designs that are drawn without being solved."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import yaml

import trackroller as tr

Study = dict[str, Any]
STEEL, ALUMINIUM = "1.7225-normalised", "EN AW-7075"
NESTED = ("inner_outer", "nested")  # names of one design, the new name first
RANGES = {
    "friction_coefficient": {"uniform": [0.05, 0.3]},
    "axial_force": {"uniform": [0, 60]},
    "contact_angle": {"uniform": [28, 45]},
    "motor_force": {"uniform": [-25, 0]},
}
LISTS = {
    "friction_coefficient": {"values": [0.05, 0.1, 0.2, 0.3]},
    "axial_force": {"linspace": [0, 60, 4]},
    "material_pair": {"values": [[STEEL, STEEL], [ALUMINIUM, STEEL]]},
    "motor_force": {"values": [0, -20]},
}
MIXED = {
    "friction_coefficient": {"truncnormal": [0.19, 0.04, 0.08, 0.32]},
    "radial_force": {"loguniform": [-400, -100]},
    "fit": {"triangular": [1.08, 1.15, 1.3]},
    "roller_profile_radius": {"expression": "-fit * 6"},
    "axial_force": {"normal": [25, 5]},
    "guide_curve_radius": {"values": [220, float("inf"), -220]},
    "material_pair": LISTS["material_pair"],
}
OUTER = {"contact_angle": {"values": [30, 40]}, "roller_profile_radius": {"linspace": [-6.4, -8, 3]}}


def small_studies(folder: Path) -> list[Study]:
    """Return the studies that are solved and analysed.

    Parameters
    ----------
    folder : Path
        Existing folder, in which the CSV of the table design is written.

    Returns
    -------
    list of dict
        Study files as mappings, each with tens to a few hundred rows.
    """
    inner = {"friction_coefficient": RANGES["friction_coefficient"], "axial_force": {"truncnormal": [25, 8, 0, 50]}}
    _write_table(folder / "rows.csv")
    return [
        _study("grid", LISTS, base={"guide_overrollings_per_hour": 600}),
        _study("grid", {k: LISTS[k] for k in ("axial_force",)}, "grid-models", contact_model=["sliding", "fastsim"]),
        _study("lhs", RANGES, samples=128),
        _study("lhs", MIXED, "lhs-mixed", samples=160, analysis={"resamples": 100}),
        _study("sobol", RANGES, samples=128),
        _study("morris", RANGES, samples=12),
        _study("saltelli", RANGES, samples=32),
        _study("saltelli", RANGES, "saltelli-first", samples=32, second_order=False),
        _study(_nested_name(folder), OUTER | inner, "inner-outer", samples=24),
        _study("central_composite", RANGES),
        _study("box_behnken", RANGES),
        _study("plackett_burman", RANGES),
        _study("table", {}, table="rows.csv"),
    ]


def drawn_designs(folder: Path) -> list[Study]:
    """Return the studies whose designs are drawn only: every design with several seeds, sizes and kinds of factors.

    Parameters
    ----------
    folder : Path
        Existing folder for a trial of the name of the inner/outer design.

    Returns
    -------
    list of dict
        Study files as mappings.
    """
    names = list(RANGES)
    found = []
    for seed in (0, 1, 7):
        for method, samples in (("lhs", 37), ("sobol", 64), ("morris", 9), ("saltelli", 16)):
            for kind, factors in (("ranges", RANGES), ("mixed", MIXED), ("lists", LISTS)):
                name = f"{method}-{kind}-{seed}"
                found.append(_study(method, factors, name, samples=samples, seed=seed))
        for inner in ("lhs", "sobol"):
            name, nested = f"inner-outer-{inner}-{seed}", _nested_name(folder)
            factors = OUTER | {
                "friction_coefficient": MIXED["friction_coefficient"],
                "axial_force": {"normal": [25, 5]},
            }
            found.append(_study(nested, factors, name, samples=16, seed=seed, inner=inner))
    found.append(_study("morris", RANGES, "morris-levels", samples=6, levels=8))
    found.append(_study("lhs", RANGES, "lhs-grown", samples=48, grown_from=[16, 32]))
    for method in ("central_composite", "box_behnken", "plackett_burman"):
        several = {**RANGES, "radial_force": {"uniform": [-300, -100]}, "axis_distance": {"uniform": [20, 24]}}
        for count in range(3, len(several) + 1):
            chosen = dict(list(several.items())[:count])
            found.append(_study(method, chosen, f"{method}-{count}"))
    two_levels = {name: MIXED[name] for name in MIXED if name != "guide_curve_radius"}
    found.append(_study("plackett_burman", two_levels, "plackett_burman-mixed"))
    found.append(_study("central_composite", two_levels, "central_composite-mixed"))
    found.append(_study("grid", {names[0]: {"logspace": [0.02, 0.4, 5]}, names[1]: LISTS[names[1]]}, "grid-spaces"))
    return found


def _study(design: str, factors: Study, name: str = "", **more: Any) -> Study:
    common = {"name": name or design.replace("_", "-"), "design": design, "factors": factors}
    common |= {"contact_model": "sliding", "accuracy": "preview"}
    return {**common, "outputs": ["forces", "contact", "friction_work", "peak_stress", "life"], **more}


def _nested_name(folder: Path) -> str:
    """Return the name of the inner/outer design that this version accepts."""
    factors = {"contact_angle": {"values": [30, 40]}, "friction_coefficient": {"uniform": [0.1, 0.2]}}
    for name in NESTED:
        try:
            tr.load_study(write_study(_study(name, factors, "trial", samples=2), folder))
        except tr.InputError:
            continue
        return name
    raise ValueError(f"no inner/outer design: none of {', '.join(NESTED)} is accepted by this trackroller")


def _write_table(path: Path) -> None:
    rng = np.random.default_rng(5)
    rows = rng.uniform([0.05, 0.0, 28.0], [0.3, 50.0, 45.0], size=(96, 3)).round(6)
    lines = ["friction_coefficient,axial_force,contact_angle", *(",".join(map(str, row)) for row in rows.tolist())]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def write_study(study: Study, folder: Path) -> Path:
    """Write a study file.

    Parameters
    ----------
    study : dict
        The study as a mapping.
    folder : Path
        Existing folder.

    Returns
    -------
    Path
        `folder/NAME.yaml`.
    """
    path = folder / f"{study['name']}.yaml"
    path.write_text(yaml.safe_dump(study, sort_keys=False), encoding="utf-8")
    return path
