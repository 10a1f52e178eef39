"""Made-up results with the shape of a gathered study, for tests of figures and report.

The formulas only have the right tendencies (Hertz exponents, S-N curves, Coulomb limits).
"""

from __future__ import annotations

import dataclasses
import itertools
import json

import numpy as np
import xarray as xr
import yaml

from trackroller.methods import METHODS, Design
from trackroller.methods.factor import parse
from trackroller.results.results import Results
from trackroller.results.stored_study import open_study
from trackroller.study.file.config import StudyFile
from trackroller.study.file.goals import Analysis
from trackroller.study.file.study import Study
from trackroller.study.outputs import case_dims, flat

PAIRS = (
    "1.7225-normalised / 1.7225-normalised",
    "1.7225-quenched-tempered / 1.7225-normalised",
    "EN AW-7075 / 1.7225-normalised",
    "PA6 / 1.7225-normalised",
    "POM / POM",
)
STRENGTH = {
    "1.7225-normalised": (210e3, 720, 0.5),
    "1.7225-quenched-tempered": (210e3, 1200, 0.5),
    "EN AW-7075": (70e3, 540, 0.5),
    "PA6": (5e3, 60, 0.3),
    "POM": (3e3, 80, 0.4),
}
MADE_UP = "abcdef0"  # commit of made-up results
BASE = {
    "roller_profile_radius": -7.0,
    "guide_profile_radius": 6.0,
    "guide_curve_radius": 220.0,
    "friction_coefficient": 0.3,
    "motor_force": -30.0,
    "axial_force": 30.0,
    "radial_force": -200.0,
    "contact_angle": 30.0,
    "axis_distance": 21.75,
    "velocity": 60.0,
}
DEFAULT_FACTORS = {
    "friction_coefficient": [0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4],
    "roller_profile_radius": [-10.0, -8.0, -7.0, -6.6, -6.4],
    "material_pair": list(PAIRS),
    "motor_force": [-30.0, 0.0, 30.0],
    "guide_curve_radius": [220.0, float("inf"), -100.0],
    "axial_force": [0.0, 30.0, 130.0],
}
UNITS = {
    "friction_coefficient": "1",
    "roller_profile_radius": "mm",
    "guide_curve_radius": "mm",
    "axial_force": "N",
    "motor_force": "N",
    "radial_force": "N",
    "contact_angle": "degree",
    "guide_profile_radius": "mm",
}


def results(columns: dict[str, np.ndarray], unlimited: bool = False) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    """Return made-up results of cases by name: the dimensions after `case`, and the values."""
    n = len(next(iter(columns.values())))
    get = {k: np.broadcast_to(columns.get(k, v), (n,)) for k, v in {**BASE, "material_pair": PAIRS[0]}.items()}
    alpha = np.deg2rad(get["contact_angle"].astype(float))
    half = -get["radial_force"] / (2 * np.cos(alpha))
    tilt = get["axial_force"] / (2 * np.sin(alpha))
    force = np.stack([half - tilt, half + tilt], -1).astype(float)
    k_x = 1 / get["roller_profile_radius"] + 1 / get["guide_profile_radius"]
    k_y = np.cos(alpha) * (1 / 16.5 + 1 / get["guide_curve_radius"])
    pairs = [p.split(" / ") for p in get["material_pair"]]
    values = np.array([[STRENGTH[m] for m in p] for p in pairs], dtype=float)  # case, body, (E, Rm, ratio)
    modulus = 1 / (0.91 / values[:, 0, 0] + 0.91 / values[:, 1, 0])
    mu = get["friction_coefficient"].astype(float)
    lift = force[:, 0] <= 0
    slip = ~lift & (np.abs(get["motor_force"]) > mu * force.sum(-1))
    shown = np.where(lift[:, None] & (np.arange(2) == 0), np.nan, force)
    with np.errstate(invalid="ignore"):
        p_max = 0.39 * (shown * (modulus**2 * k_x * k_y)[:, None]) ** (1 / 3)
        grip = np.where(slip[:, None], 1.2, 1.0) * (1 + 0.1 * np.sign(get["motor_force"]))[:, None]
        surface = np.sqrt(0.2**2 + 3 * (mu[:, None] * grip * 1.02) ** 2)
        share = np.maximum(0.6, surface)
        peak = (p_max * share)[..., None] * np.array([1.0, 0.97])
        axis = 0.9 * (shown / modulus[:, None]) ** (1 / 3)
        depth = np.where(surface > 0.6, 0.0, 0.45 * axis)[..., None] * np.ones(2)
        limit = values[:, :, 1] * values[:, :, 2]
        slope = np.log(500) / np.log(1 / values[:, :, 2])
        life = 5e6 * (peak / limit[:, None, :]) ** -slope[:, None, :]
    if unlimited:
        life = np.where(peak < limit[:, None, :], np.inf, life)
    hours = np.nanmin(life[:, :, 0], axis=1) * 2 * np.pi * 16.5e-3 / 3600.0
    per_contact, per_body = ("contact",), ("contact", "body")
    return {
        "normal_force": (per_contact, shown),
        "lateral_force": (per_contact, shown * mu[:, None] * np.array([0.4, -0.3])),
        "driving_force": (per_contact, np.where(np.isnan(shown), np.nan, -get["motor_force"][:, None] / 2)),
        "semi_axis_lateral": (per_contact, 1.6 * axis),
        "semi_axis_rolling": (per_contact, axis),
        "peak_stress": (per_body, peak),
        "peak_z": (per_body, depth),
        "life_cycles": (per_body, life),
        "roller_life_hours": ((), hours),
        "guide_life_hours": ((), np.full(n, np.nan)),
        "regime": ((), np.where(lift, 2, np.where(slip, 1, 0)).astype(np.int8)),
        "converged": ((), np.ones(n, np.int8)),
        "validity": ((), ((peak.max((1, 2)) > values[:, 0, 1]) * 4 + (k_x < 0.015) * 8).astype(np.int32)),
    }


def _finish(ds: xr.Dataset, factors: dict, design: str) -> xr.Dataset:
    ds = ds.assign_coords(contact=[1, 2], body=["roller", "guide"])
    units = {
        "normal_force": "N",
        "lateral_force": "N",
        "driving_force": "N",
        "peak_stress": "MPa",
        "peak_z": "mm",
        "life_cycles": "1",
        "roller_life_hours": "h",
        "guide_life_hours": "h",
        **UNITS,
    }
    for name, unit in units.items():
        if name in ds.variables:
            ds[name].attrs["units"] = unit
    ds["regime"].attrs |= {
        "flag_values": np.arange(4, dtype=np.int8),
        "flag_meanings": "rolling full_slip lift_off failed",
    }
    ds["validity"].attrs |= {
        "flag_masks": np.array([1, 2, 4, 8], np.int32),
        "flag_meanings": "half_space yield static conformal",
    }
    study = {
        "name": "friction-and-fit",
        "description": "Life of a steel roller over friction & fit <five pairs>.",
        "base": BASE,
        "factors": factors,
        "method": design,
        "seed": 1,
        "accuracy": "standard",
        "outputs": ["forces", "contact", "peak_stress", "life"],
    }
    ds.attrs |= {
        "study": yaml.safe_dump(study, sort_keys=False),  # factors in the order of the dimensions, as `gather` has them
        "trackroller_version": "0.1.0",
        "commit": MADE_UP,
        "design": design,
        "design_meta": json.dumps({"columns": list(factors), "size": ds["regime"].size, "shape": ds["regime"].shape}),
        "seed": 1,
        "accuracy": "standard",
        "date_created": "2026-01-02T03:04:05+00:00",
    }
    return ds


def grid_study(factors: dict | None = None, only: tuple[str, ...] = (), **options) -> xr.Dataset:
    """Return a gathered grid study; `only` keeps just these result variables (and the regime)."""
    factors = DEFAULT_FACTORS if factors is None else factors
    rows = list(itertools.product(*factors.values()))
    columns = {
        n: np.array([r[i] for r in rows], dtype=object if n == "material_pair" else float)
        for i, n in enumerate(factors)
    }
    sizes = [len(v) for v in factors.values()]
    variables = {
        n: ((*factors, *dims), v.reshape(*sizes, *v.shape[1:]))
        for n, (dims, v) in results(columns, **options).items()
        if not only or n in (*only, "regime", "validity", "converged")
    }
    ds = xr.Dataset(variables, coords={n: (n, list(v)) for n, v in factors.items()})
    return _finish(
        ds, {n: {"values": [x if isinstance(x, str) else float(x) for x in v]} for n, v in factors.items()}, "grid"
    )


def sampled_study(n: int = 400, seed: int = 3, **options) -> xr.Dataset:
    """Return a gathered Latin hypercube study over four numbers and the material pair."""
    rng = np.random.default_rng(seed)
    columns = {
        "friction_coefficient": rng.uniform(0.02, 0.4, n),
        "roller_profile_radius": rng.uniform(-9, -6.3, n),
        "axial_force": rng.uniform(0, 140, n),
        "motor_force": rng.choice([-30.0, 0.0], n),
        "material_pair": rng.choice(np.array(PAIRS[:3], dtype=object), n),
    }
    ds = xr.Dataset({k: (("case", *dims), v) for k, (dims, v) in results(columns, **options).items()})
    ds = ds.assign_coords({k: ("case", v.astype(str) if k == "material_pair" else v) for k, v in columns.items()})
    ds = ds.assign_coords(case=np.arange(n))
    factors = {
        "friction_coefficient": {"uniform": [0.02, 0.4]},
        "roller_profile_radius": {"uniform": [-9, -6.3]},
        "axial_force": {"uniform": [0, 140]},
        "motor_force": {"values": [-30.0, 0.0]},
        "material_pair": {"values": [p.split(" / ") for p in PAIRS[:3]]},
    }
    return _finish(ds, factors, "lhs")


def results_of(ds, indices: xr.Dataset | None = None) -> Results:
    """Return the results in a data set, with these indices or without any.

    Made-up data may have an unchecked study file, and have no design.
    """
    return dataclasses.replace(_results_of(ds), known_indices=xr.Dataset() if indices is None else indices)


def _results_of(ds) -> Results:
    if isinstance(ds, Results):
        return ds
    ds = ds if isinstance(ds, xr.Dataset) else xr.load_dataset(ds)
    if "design_meta" in ds.attrs and ds.attrs.get("commit") != MADE_UP:
        return open_study(ds)
    told = yaml.safe_load(ds.attrs.get("study", "")) or {}
    told = {key: tuple(value) if isinstance(value, list) else value for key, value in told.items()}
    told["analysis"] = Analysis.model_validate(told.get("analysis", {}))
    given = told.get("factors", {})
    names = [str(n) for n in ds.dims if n in ds.coords and n not in ("contact", "body", "case")] if not given else given
    free = [str(n) for n, v in ds.variables.items() if v.dims == ("case",) and n in ds.coords and n != "case"]
    specs = {n: given.get(n) or {"values": np.unique(ds[n].values).tolist()} for n in names or free}
    study = Study(StudyFile.model_construct(**{"name": "made-up"} | told | {"factors": specs}))
    vars(study)["parsed"] = {n: parse(n, spec) for n, spec in given.items() if spec}  # others have no kind of values
    dims = case_dims(ds, specs)
    columns = {n: flat(ds, n, dims) for n in specs if n in ds.variables}
    factors = {n: factor for n in columns if (factor := parse(n, specs[n])).varies}
    unit = [np.unique(columns[n], return_inverse=True)[1] for n in factors]
    method, meta = told.get("method", "grid"), {"shape": tuple(ds.sizes[d] for d in dims), "rank_correlations": ()}
    return Results(study, Design(columns, factors, METHODS[method], np.array(unit, float).T, meta), ds)
