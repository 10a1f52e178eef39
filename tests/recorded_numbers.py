"""The cases and studies whose numbers `tests/data/recorded_numbers.npz` keeps, and the command that records them.

    python tests/recorded_numbers.py            record everything anew
    python tests/recorded_numbers.py lhs laws   record these groups anew and keep the others

Record only what a change alters on purpose, and say in the commit why the numbers differ.
"""

from __future__ import annotations

import contextlib
import io
import math
import os
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

if __name__ == "__main__":  # one thread makes the order of every sum repeatable; tests have their own setting
    for _name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(_name, "1")

import numpy as np
import xarray as xr
import yaml

import trackroller as tr
from trackroller.cli.main import app, run_app
from trackroller.parameters import OPTIONS
from trackroller.roller.case import to_table
from trackroller.roller.differences import ROUNDING, SEARCH, allowed, scale

FILE = Path(__file__).parent / "data" / "recorded_numbers.npz"
MOST = 100  # values kept of one variable, evenly spaced: a wrong field is wrong at more than one point
FORCES = ["forces", "contact", "friction_work"]
COMPLETE = [*FORCES, "peak_stress", "life"]
FIELDS = ["tractions", "subsurface"]
LIMITS = [name for name in OPTIONS["outputs"].values if name not in (*COMPLETE, *FIELDS)]
STEEL, HARD, ALUMINIUM = "1.7225-normalised", "1.7225-quenched-tempered", "EN AW-7075"
LOADS = ("radial_force", "axial_force", "motor_force", "axis_distance")  # give the scales of forces and moments
Cases = list[dict[str, Any]]
Arrays = dict[str, np.ndarray]


class Numbers(NamedTuple):
    """Values of a variable (m,), their scale (m,), and the difference over it that rounding may cause [1].

    Texts have no scale.
    """

    values: np.ndarray
    scale: np.ndarray | None = None
    allowed: float = 0.0


Computed = dict[str, Numbers]

# rollers as they are built: free, driven and braked, straight and curved, concave and convex profiles
ORDINARY: Cases = [
    {},
    {"motor_force": 0.0, "guide_curve_radius": math.inf, "contact_angle": 35.0, "axial_force": 0.0},
    {"motor_force": 25.0, "friction_coefficient": 0.12, "roller_profile_radius": -8.0, "roller_material": HARD},
    {"guide_curve_radius": -400.0, "radial_force": -900.0, "roller_material": ALUMINIUM, "axial_force": 80.0},
    {"roller_profile_radius": 40.0, "roller_material": "PA6", "radial_force": -60.0, "axial_force": -9.0},
    {"roller_material": "POM", "guide_material": "PA6", "contact_angle": 55.0, "guide_overrollings_per_hour": 600.0},
]
# around the borders of rolling, full slip, lift-off and self-locking
REGIMES: Cases = [
    {"friction_coefficient": mu, "motor_force": drive, "axial_force": axial}
    for mu, drive, axial in (
        (0.0, 0.0, 30.0),
        (0.0, -30.0, 30.0),
        (0.02, -500.0, 0.0),
        (0.02, 30.0, -30.0),
        (0.3, -500.0, 30.0),
        (0.3, 30.0, 140.0),
        (0.3, 0.0, 140.0),
        (1.2, -30.0, -30.0),
        (1.2, 0.0, 140.0),
    )
]
# far beyond what is built
EXTREME: Cases = [
    {"contact_angle": 0.01, "axial_force": 0.0},
    {"contact_angle": 89.0, "radial_force": -1e-3, "axial_force": 0.0, "motor_force": 0.0},
    {"roller_profile_radius": -6.001, "guide_curve_radius": math.inf, "motor_force": 0.0},
    {"radial_force": -1e6, "axial_force": 1e3, "motor_force": -1e4, "friction_coefficient": 1.9},
    {"axis_distance": 3e4, "guide_profile_radius": 1e-2, "roller_profile_radius": math.inf, "axial_force": 0.0},
]
LAWS: Cases = [
    {"friction_law": law, "velocity": velocity, "motor_force": -20.0}
    for law in (
        {"kind": "linear", "speed": 40.0, "lowest": 0.5},
        {"kind": "exponential", "speed": 25.0, "lowest": 0.4},
        {"kind": "table", "speed": [0.0, 10.0, 60.0, 400.0], "friction": [0.28, 0.3, 0.2, 0.12]},
    )
    for velocity in (6.0, 120.0)
]
CURVED: Cases = [
    {"guide_curve_radius": 60.0, "roller_profile_radius": -6.4, "motor_force": -20.0},
    {"guide_curve_radius": -60.0, "roller_profile_radius": -6.4, "motor_force": 0.0},
]
BEARING = {"rows": 2, "row_distance": 8, "kind": "ball", "dynamic_rating": 3000, "static_rating": 1500}
BEARING |= {"e": 0.3, "X": 0.56, "Y": 1.5, "X0": 0.6, "Y0": 0.5}
WEARING = {"permissible_wear_depth": 0.05, "wear_table": {"work_rate": [0, 5], "roller": [0, 9], "guide": [0, 4]}}
_X = np.linspace(-5.4, 5.4, 61)
PROFILES: Cases = [
    {"guide_profile": {"parabola": 6.0}, "roller_profile": {"parabola": -7.0}},
    {"guide_profile": {"points": np.stack([_X, np.sqrt(36.0 - _X**2)], axis=1).round(6).tolist()}},
    {"roller_profile": {"arc": -7.0, "edge": {"inner": 0.35, "outer": 0.5, "chamfer": 0.1}}},
]
# flats on a flat: all their places touch first, and rounding must not choose among them; at -300 N the search for the
# peak ends at one of two places whose stresses differ by 2e-4, and rounding chooses
FLATS: Cases = [
    {"roller_profile": {"arcs": [{"radius": 0.5, "to": -0.2}, {"radius": math.inf, "to": 0.2}, {"radius": 0.5}]}}
    | {"guide_profile": {"arc": math.inf}, "radial_force": load, "axial_force": 0.0, "motor_force": 0.0}
    for load in (-40.0, -60.0, -85.8, -120.0, -200.0)
]


def groups() -> dict[str, tuple[Cases, dict[str, Any]]]:
    """Return cases and options of `tr.solve` by the name of the group."""
    sliding = {"contact_model": "sliding", "outputs": COMPLETE}
    preview = sliding | {"accuracy": "preview"}
    found: dict[str, tuple[Cases, dict[str, Any]]] = {
        f"sliding_{accuracy}": (ORDINARY, sliding | {"accuracy": accuracy})
        for accuracy in ("preview", "standard", "reference", 1e-2)
    }
    found |= {f"sliding_{spin}": (ORDINARY[:4], preview | {"spin_model": spin}) for spin in ("concentric", "edge")}
    found |= {f"life_{rule}": (ORDINARY, preview | {"life_rule": rule}) for rule in ("haibach", "unlimited")}
    for criterion in ("von_mises_amplitude", "goodman", "findley", "dang_van"):
        own = {"life_criterion": criterion, "credit_pressure": False, "outputs": ("peak_stress", "life")}
        found[f"limits_{criterion}"] = (ORDINARY[:2], preview | own)
    published = {"hertz": "published", "stress_bodies": "published"}
    stop = "max_pressure > 900 or regime == full_slip"
    found |= {
        "regimes": (REGIMES, preview),
        "extreme": (EXTREME, preview),
        "laws": (LAWS, preview),
        "published": (ORDINARY, preview | published),
        "slip_profile": (CURVED, preview | {"slip_terms": ["profile"]}),
        "no_shortcuts": (REGIMES[:4], preview | {"shortcuts": False}),
        "stop": ([*ORDINARY, *REGIMES[3:5]], preview | {"stop_if": stop}),
        "limits": ([case | WEARING | {"bearing": BEARING} for case in ORDINARY[:3]], preview | {"outputs": LIMITS}),
        "wear_energy": (
            [case | WEARING for case in ORDINARY[:3]],
            preview | {"outputs": ["wear"], "wear_law": "energy"},
        ),
        "fields": ([ORDINARY[2]], preview | {"outputs": FIELDS}),
        "halfspace": ([*ORDINARY[1:4], REGIMES[4]], preview | {"normal": "halfspace"}),
        "halfspace_profiles": (PROFILES, preview | {"normal": "halfspace"}),
        "halfspace_flats": (
            FLATS,
            sliding | {"normal": "halfspace", "outputs": ("forces", "contact", "peak_stress", "life")},
        ),
        "halfspace_fields": ([PROFILES[2]], preview | {"normal": "halfspace", "outputs": FIELDS}),
        "halfspace_kalker": ([PROFILES[0]], preview | {"normal": "halfspace", "contact_model": "kalker"}),
    }
    for model in ("kalker_table", "kalker"):
        rolling = preview | {"contact_model": model}
        found |= {
            model: (ORDINARY, rolling),
            f"{model}_standard": (ORDINARY[:3], rolling | {"accuracy": "standard"}),
            f"{model}_regimes": (REGIMES[1::2], rolling),
            f"{model}_laws": (LAWS[1::2], rolling),
            f"{model}_slip_terms": (CURVED, rolling | {"slip_terms": ["curve", "profile"]}),
            f"{model}_fields": ([ORDINARY[2]], rolling | {"outputs": FIELDS}),
        }
    for name in ("laws", "slip_terms"):  # the table holds constant friction and the slip of the tangent plane only
        del found[f"kalker_table_{name}"]
    return found


def studies() -> dict[str, dict[str, Any]]:
    """Return study files by name: one of each kind of design that draws random numbers, and a grid."""
    ranges = {
        "friction_coefficient": {"uniform": [0.05, 0.3]},
        "axial_force": {"uniform": [0, 60]},
        "contact_angle": {"uniform": [28, 45]},
    }
    mixed = {
        "friction_coefficient": {"truncnormal": [0.19, 0.04, 0.08, 0.32]},
        "radial_force": {"loguniform": [-400, -100]},
        "fit": {"triangular": [1.08, 1.15, 1.3]},
        "roller_profile_radius": {"expression": "-fit * 6"},
        "guide_curve_radius": {"values": [220, math.inf, -220]},
        "material_pair": {"values": [[STEEL, STEEL], [ALUMINIUM, STEEL]]},
    }
    levels = {
        "friction_coefficient": {"values": [0.05, 0.1, 0.3]},
        "axial_force": {"linspace": [0, 60, 3]},
        "material_pair": mixed["material_pair"],
    }
    outer = {"contact_angle": {"values": [30, 40]}, "roller_profile_radius": {"linspace": [-6.4, -8, 3]}}
    found = {
        "grid": {"factors": levels},
        "lhs": {"factors": mixed, "samples": 64},
        "sobol": {"factors": ranges, "samples": 64},
        "morris": {"factors": ranges, "samples": 8},
        "saltelli": {"factors": ranges, "samples": 32},
        "inner_outer": {
            "factors": outer | {"friction_coefficient": ranges["friction_coefficient"]},
            "samples": 16,
            "inner": "lhs",
        },
        "central_composite": {"factors": ranges},
    }
    common = {"contact_model": "sliding", "accuracy": "preview", "outputs": ["forces", "peak_stress", "life"]}
    return {name: common | {"name": f"recorded-{name}", "method": name} | study for name, study in found.items()}


def names() -> list[str]:
    """Return the names of all groups of recorded numbers."""
    return [*groups(), "user_tractions", *studies()]


def compute(name: str) -> Computed:
    """Return the numbers of one group by variable, computed by the version that Python imports.

    Parameters
    ----------
    name : str
        One of `names()`.

    Returns
    -------
    dict of str to Numbers
        One-dimensional arrays of at most `MOST` values. Flags and texts stand as words.
    """
    if name in studies():
        return _study(name)
    if name == "user_tractions":
        return _user_tractions()
    cases, options = groups()[name]
    table = to_table(cases)
    return _results(
        tr.solve(cases, **options).assign_coords({load: ("case", getattr(table, load)) for load in LOADS}), name
    )


def _study(name: str) -> Computed:
    """Run a study and analyse it: the numbers of its design, its results and its indices."""
    study = studies()[name]
    with tempfile.TemporaryDirectory() as place, contextlib.chdir(place):
        Path("study.yaml").write_text(yaml.safe_dump(study, sort_keys=False), encoding="utf-8")
        found = _results(tr.load_study("study.yaml").design(), f"{name}/design")
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            assert run_app(lambda: app(["run", "study.yaml", "-q"])) == 0
        gathered = Path("results") / study["name"] / "study.nc"
        with xr.open_dataset(gathered) as results:
            found |= _results(results.load(), f"{name}/results")
        return found | _indices(tr.open_study(gathered).indices(), f"{name}/indices")


def _user_tractions() -> Computed:
    """Return stresses under tractions that a user gives, by the public functions; their scale is the pressure."""
    axis = np.linspace(-1.0, 1.0, 15)
    height = np.sqrt(np.clip(1.0 - axis[:, None] ** 2 / 0.8 - axis[None, :] ** 2 / 0.6, 0.0, None))
    given = (axis, axis, 900.0 * height, 80.0 * height * axis, 120.0 * height**2)
    points = np.stack(np.meshgrid([-0.5, 0.0, 0.31], [-0.4, 0.2], [0.0, 0.07, 0.5], indexing="ij"), axis=-1)
    found: Arrays = {}
    for nu in (0.0, 0.3, 0.5):
        found[f"user_tractions/grid_{nu}"] = tr.stress_on_grid(*given, [0.0, 0.1, 0.6], nu)
        stress = tr.stress_from_tractions(*given, points, nu)
        found[f"user_tractions/bilinear_{nu}"] = stress
        for function in (tr.von_mises, tr.principal_stresses, tr.max_shear):
            found[f"user_tractions/{function.__name__}_bilinear_{nu}"] = function(stress)
    return {key: _numbers(stress, np.full(stress.shape, 900.0), ROUNDING) for key, stress in found.items()}


def _results(ds: xr.Dataset, where: str) -> Computed:
    """Return the variables of a design or of results, with the scales that the program itself compares them by."""
    return {
        f"{where}/{name}": _numbers(_words(ds[name]), scale(ds, name), allowed(name))
        if ds[name].dtype.kind == "f"
        else Numbers(_thin(_words(ds[name])))
        for name in map(str, ds.variables)
        if name != "reason" and (name not in LOADS or where.count("/"))
    }


def _indices(ds: xr.Dataset, where: str) -> Computed:
    """Return the variables of an analysis.

    Shares and powers of ten are compared with 1, other effects with the largest effect on the same output.
    """
    found = {}
    for name, array in ds.variables.items():
        if array.dtype.kind != "f":
            found[f"{where}/{name}"] = Numbers(_thin(_words(ds[name])))
            continue
        size = np.abs(ds[name])
        against = size.max([dim for dim in size.dims if dim != "output"])
        for units in ({"output_units", "scale"} & {*ds.coords}) if "output" in size.dims else ():
            against = xr.where(ds[units].isin(["1", "log10"]), np.fmax(against, 1.0), against)
        if array.attrs.get("units") == "1":
            against = np.fmax(against, 1.0)
        found[f"{where}/{name}"] = _numbers(
            array.values, against.broadcast_like(size).transpose(*size.dims).values, SEARCH
        )
    return found


def _numbers(values: np.ndarray, scales: np.ndarray, most: float) -> Numbers:
    return Numbers(_thin(values), _thin(scales), most)


def _words(array: xr.DataArray) -> np.ndarray:
    """Return values with the words of flags in place of their numbers: a new flag may change the numbering."""
    values, words = np.asarray(array.values), str(array.attrs.get("flag_meanings", "")).split()
    if "flag_masks" in array.attrs:
        masks = np.atleast_1d(array.attrs["flag_masks"]).tolist()
        return np.array([" ".join(w for w, m in zip(words, masks, strict=True) if int(v) & m) for v in values.flat])
    if "flag_values" in array.attrs:
        known = dict(zip(np.atleast_1d(array.attrs["flag_values"]).tolist(), words, strict=True))
        return np.array([known[v] for v in values.ravel().tolist()])
    return values.astype(str) if values.dtype.kind in "OSU" else values


def _thin(values: np.ndarray) -> np.ndarray:
    """Return at most `MOST` evenly spaced values in one dimension; the stride is odd, so that it crosses all axes."""
    stride = -(-values.size // MOST)
    return values.ravel()[:: stride | 1 if stride > 1 else 1]


def load() -> Arrays:
    """Return the recorded arrays by `GROUP/VARIABLE`."""
    with np.load(FILE, allow_pickle=False) as file:
        pools = {"U": file["texts"], "f": file["numbers"]}
        found, used = {}, {"U": 0, "f": 0}
        for key, kind, size in zip(file["keys"].tolist(), file["kinds"].tolist(), file["sizes"].tolist(), strict=True):
            found[key] = pools[kind][used[kind] : used[kind] + size]
            used[kind] += size
    return found


def save(arrays: Arrays) -> None:
    """Write arrays: all numbers in one array and all texts in another, because 2,000 small ones take twice the room."""
    texts = [values for values in arrays.values() if values.dtype.kind == "U"]
    numbers = [values.astype(float) for values in arrays.values() if values.dtype.kind != "U"]
    np.savez_compressed(
        FILE,
        keys=np.array(list(arrays)),
        kinds=np.array(["U" if values.dtype.kind == "U" else "f" for values in arrays.values()]),
        sizes=np.array([values.size for values in arrays.values()]),
        texts=np.concatenate(texts),
        numbers=np.concatenate(numbers),
    )


def main(wanted: list[str]) -> None:
    """Record groups anew, all of them if none is named."""
    unknown = set(wanted) - set(names())
    if unknown:
        sys.exit(f"{', '.join(sorted(unknown))}: no such group; choose from {', '.join(names())}")
    kept: Arrays = {}
    if wanted:
        kept = {key: values for key, values in load().items() if key.partition("/")[0] not in wanted}
    recorded = [compute(name) for name in wanted or names()]
    arrays = kept | {key: numbers.values for found in recorded for key, numbers in found.items()}
    save(arrays)
    print(f"{FILE.name}: {len(arrays)} arrays, {FILE.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
