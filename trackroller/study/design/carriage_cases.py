"""The cases of a study of a carriage: each loaded roller in each load case; and the results of its
worst roller.

A row of such a design is a carriage. Statics gives the loads of its rollers, and each loaded roller
in each load case is a case of its own, which is solved as any other. The results of a row are those
of the worst roller, whose life to the first limit is the shortest; its damage adds up over the load
cases, see `trackroller.carriage.lives`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.carriage.fields import changed
from trackroller.carriage.file import OF_LOADS, MountedRoller
from trackroller.carriage.lives import Lives, hours_per_km
from trackroller.carriage.solve import forces_of
from trackroller.carriage.strokes import passes_per_km
from trackroller.errors import InputError
from trackroller.parameters import MATERIAL_FIELDS, PARAMETERS, REGIMES
from trackroller.parameters.carriage_fields import field_of
from trackroller.roller.duty import OVERROLLINGS, overrollings_per_hour
from trackroller.roller.settings import LOADS
from trackroller.study.design.build import build, columns_of, dataset_of, marked
from trackroller.study.design.factor_names import GEOMETRY

if TYPE_CHECKING:
    from trackroller.carriage.file import Carriage
    from trackroller.materials import MaterialDatabase
    from trackroller.methods import Design
    from trackroller.roller.case import Case
    from trackroller.study.file.config import StudyFile

ROW = "design_row"
ROLLER = "carriage_roller"
LOAD_CASE = "load_case"
SHARE = "share"
HOURS = "hours_per_km"
# attribute: JSON, why the rollers do not hold the carriage, by the number of its row
REASONS = "carriage_reasons"
STIFF = (*GEOMETRY, *MATERIAL_FIELDS)  # on these parameters the stiffness of the contacts depends
# of a force: the last digits depend on the processor, and a case is known by its numbers
DIGITS = 8


def given_by(whole: Carriage) -> tuple[str, ...]:
    """Return the parameters of a roller that a carriage gives, so that no study may."""
    if np.isfinite(whole.stroke):
        return (*OF_LOADS, OVERROLLINGS)
    if any(case.speed is not None for case in whole.cases):
        return OF_LOADS
    return LOADS


def common_values(whole: Carriage) -> dict[str, Any]:
    """Return the parameters that all rollers of a carriage share, without their loads."""
    stated = [roller.case.as_dict() for roller in whole.rollers if roller.case is not None]
    shared = {
        name: value
        for name, value in stated[0].items()
        if all(other[name] == value for other in stated[1:])
    }
    return {
        name: value
        for name, value in shared.items()
        if name not in given_by(whole) and value not in (None, "")
    }


def expanded(
    config: StudyFile, design: Design, materials: MaterialDatabase, whole: Carriage
) -> xr.Dataset:
    """Return the cases of a study of a carriage.

    Parameters
    ----------
    config : StudyFile
        What the study file says.
    design : Design
        Its design, a row for each carriage.
    materials : MaterialDatabase
        The materials.
    whole : Carriage
        The carriage of the study file.

    Returns
    -------
    xarray.Dataset
        As `trackroller.study.design.build.build` returns it, a case for each loaded roller in each
        load case. Coordinates along `case`: row of the design, names of roller and load case, share
        of the travel, and hours that the whole carriage travels for a km. The attribute `REASONS`
        says why a row has no cases.
    """
    loads, reasons = _loads(design, whole)
    parts = []
    order = []
    for j, roller in enumerate(whole.rollers):
        own = np.flatnonzero(loads["roller"] == j)
        if len(own) and roller.case is not None:
            own_loads = {name: values[own] for name, values in loads.items()}
            parts.append(_cases_of_roller(config, design, materials, whole, roller.case, own_loads))
            order.append(own)
    if not parts:
        allowed = "a carriage that its rollers hold in a row of the design"
        first = next(iter(reasons.values()), "no roller carries load")
        raise InputError("carriage", whole.name, allowed, "", first)
    sort = np.argsort(np.concatenate(order))
    cases = xr.concat(parts, "case", combine_attrs="override").isel(case=sort)
    coords = _places_of_cases(whole, loads) | {HOURS: cases[HOURS].variable}
    attrs = {"study_name": config.name, "seed": config.seed, REASONS: json.dumps(reasons)}
    cases = cases.drop_vars(HOURS).assign_coords(coords).assign_attrs(attrs)
    return marked(cases, config)


def _cases_of_roller(
    config: StudyFile,
    design: Design,
    materials: MaterialDatabase,
    whole: Carriage,
    case: Case,
    loads: Mapping[str, np.ndarray],
) -> xr.Dataset:
    """Return the cases of one roller under its loads in all rows, without their numbers."""
    base = {
        name: v for name, v in case.as_dict().items() if v is not None and v != ""
    } | config.base
    given = {name: values[loads["row"]] for name, values in design.columns.items()}
    columns, friction = columns_of(base, given, len(loads["row"]), materials)
    for name in LOADS:
        columns[name] = loads[name]
    shares = np.array([case.share for case in whole.cases])
    velocity = columns["velocity"].astype(float)
    hours = hours_per_km(shares, loads["speeds"], velocity)
    columns["velocity"] = np.where(np.isnan(loads["speed"]), velocity, 60 * loads["speed"])
    if np.isfinite(whole.stroke):
        columns[OVERROLLINGS] = overrollings_per_hour(loads["passes"], columns["velocity"])
    cases = dataset_of(columns, given.get("material_pair"), {}, friction).drop_vars("case")
    words = {"long_name": "hours of travel for a km", "units": "h km-1"}
    return cases.assign_coords({HOURS: ("case", hours, words)})


def _places_of_cases(whole: Carriage, loads: Mapping[str, np.ndarray]) -> dict[str, Any]:
    """Return number, row, roller, load case and share of the travel of all cases."""
    rollers = _names([roller.name for roller in whole.rollers], loads["roller"])
    load_cases = _names([case.name for case in whole.cases], loads["load_case"])
    shares = np.array([case.share for case in whole.cases])[loads["load_case"]]
    numbers = np.arange(len(shares))
    return {
        "case": ("case", numbers, {"long_name": "case number", "units": "1"}),
        ROW: ("case", loads["row"], {"long_name": "row of the design", "units": "1"}),
        ROLLER: ("case", rollers, {"long_name": "roller of the carriage"}),
        LOAD_CASE: ("case", load_cases, {"long_name": "load case of the carriage"}),
        SHARE: ("case", shares, {"long_name": "share of the travel", "units": "1"}),
    }


def _names(names: list[str], numbers: np.ndarray) -> np.ndarray:
    named: np.ndarray = np.array(names, dtype=object)[numbers]
    return named


def _loads(design: Design, whole: Carriage) -> tuple[dict[str, np.ndarray], dict[int, str]]:
    """Return row, load case, roller, forces and speeds of each case, and why rows have none."""
    fields = [name for name in design.columns if field_of(name)]
    stiff = [name for name in design.columns if name in (*STIFF, "material_pair")]
    loads: dict[tuple[Any, ...], Any] = {}
    columns: dict[str, list[np.ndarray]] = {}
    reasons: dict[int, str] = {}
    for row in range(design.size):
        key = tuple(design.columns[name][row] for name in (*fields, *stiff))
        if key not in loads:
            given = dict(zip((*fields, *stiff), key, strict=True))
            loads[key] = _statics(
                whole, *({name: given[name] for name in names} for names in (fields, stiff))
            )
        if isinstance(loads[key], str):
            reasons[row] = loads[key]
            continue
        for name, values in loads[key].items():
            columns.setdefault(name, []).append(values)
        columns.setdefault("row", []).append(np.full(len(loads[key]["roller"]), row))
    return {name: np.concatenate(values) for name, values in columns.items()} or {
        "roller": np.empty(0, int)
    }, reasons


def _statics(
    whole: Carriage, fields: Mapping[str, float], stiff: Mapping[str, Any]
) -> dict[str, np.ndarray] | str:
    """Return the loads of the loaded rollers of one carriage, or why its rollers do not hold it."""
    given = {name: value for name, value in stiff.items() if name != "material_pair"}
    given |= dict(zip(MATERIAL_FIELDS, stiff.get("material_pair", ()), strict=False))
    try:
        rollers = tuple(_with_values(roller, given) for roller in whole.rollers)
        own = changed(replace(whole, rollers=rollers), fields)
        ds = forces_of(own)
    except InputError as error:
        if error.wrong:
            return f"{error.field} {error.value}: {error.wrong}"
        return str(error)
    unsettled = ds["load_case"].values[~ds["converged"].values]
    if unsettled.size:
        return (
            f"case {', '.join(unsettled)}: no forces of the rollers fulfil all conditions of "
            "an equilibrium"
        )
    i, j = np.nonzero(ds["radial_force"].values < 0)
    speeds = ds["speed"].values
    forces = {name: _rounded(ds[name].values[i, j]) for name in LOADS} | {
        "passes": passes_per_km(own)[j]
    }
    return {
        "load_case": i,
        "roller": j,
        "speed": speeds[i],
        "speeds": np.tile(speeds, (len(i), 1)),
        **forces,
    }


def _with_values(roller: MountedRoller, values: Mapping[str, Any]) -> MountedRoller:
    """Return a roller of the carriage with other values of its case."""
    if roller.case is None:
        return roller
    return replace(roller, case=replace(roller.case, **values))


def _rounded(values: np.ndarray) -> np.ndarray:
    """Return numbers with `DIGITS` digits, forces that are rounding beside the largest one as 0."""
    largest = np.abs(values).max(initial=0.0)
    without_rounding = np.where(np.abs(values) < 1e-9 * largest, 0.0, values)
    return np.array([float(f"{value:.{DIGITS - 1}e}") for value in without_rounding.tolist()])


def of_worst_rollers(
    config: StudyFile,
    design: Design,
    materials: MaterialDatabase,
    cases: xr.Dataset,
    solved: xr.Dataset,
) -> tuple[xr.Dataset, xr.Dataset]:
    """Return a row for each carriage: its parameters and results are those of its worst roller.

    Parameters
    ----------
    config, design, materials
        As for `expanded`.
    cases : xarray.Dataset
        The cases, as `expanded` returns them.
    solved : xarray.Dataset
        Their results along `case`.

    Returns
    -------
    tuple of xarray.Dataset
        Cases and results along `case`, a row for each row of the design. Lives add up the damage of
        all load cases of the worst roller. Its other results, and its loads, are those of the load
        case that uses most of its life; utilisations are the largest ones. `case` is the number of
        this case, -1 for a row without one. A roller that does not roll in a load case is the worst
        one. A row that the rollers do not hold has the regime lift-off, and its `reason` says why.
    """
    lives = _lives_of_rollers(cases, solved)
    row = cases[ROW].values[lives.first]
    order = np.lexsort((lives.rank, row))
    worst = order[np.unique(row[order], return_index=True)[1]]  # the first one of each row
    worst_case = np.full(design.size, -1)
    worst_case[row[worst]] = lives.ruling[worst]
    shown = lives.solved.isel(case=np.maximum(worst_case, 0)).copy(deep=True)
    for name, values in lives.summed.items():
        full = shown[name].values
        full[row[worst]] = values[worst]
        shown[name].values = full
    reasons = {int(i): text for i, text in json.loads(cases.attrs.get(REASONS, "{}")).items()}
    _without_results(shown, worst_case < 0, [reasons.get(i, "") for i in range(design.size)])
    plain = _with_worst_loads(build(config, design, materials), cases, worst_case)
    return plain.assign_coords(case=worst_case), shown.assign_coords(case=worst_case)


def _lives_of_rollers(cases: xr.Dataset, solved: xr.Dataset) -> Lives:
    """Return the lives of all rollers of all rows over their load cases."""
    names, rollers = np.unique(cases[ROLLER].values.astype(str), return_inverse=True)
    group = cases[ROW].values * len(names) + rollers
    kmh = 0.06 * cases["velocity"].values
    return Lives(group, cases[SHARE].values, kmh, cases[HOURS].values, solved)


def _with_worst_loads(plain: xr.Dataset, cases: xr.Dataset, worst_case: np.ndarray) -> xr.Dataset:
    """Return the rows of a design with the parameters of the worst case of each row, and the names
    of its roller and load case; -1 stands for a row without one.
    """
    has_worst = worst_case >= 0
    for name in (*PARAMETERS, *MATERIAL_FIELDS):
        if name in cases and not np.array_equal(cases[name].values, plain[name].values):
            values = cases[name].values[np.maximum(worst_case, 0)]
            missing: Any = plain[name].values
            if values.dtype.kind == "f":
                missing = np.nan
            plain[name] = ("case", np.where(has_worst, values, missing), plain[name].attrs)
    for name, label in (
        (ROLLER, "worst roller"),
        (LOAD_CASE, "load case that uses most of its life"),
    ):
        values = np.where(has_worst, cases[name].values[np.maximum(worst_case, 0)], "")
        plain = plain.assign_coords(
            {f"worst_{name.removeprefix('carriage_')}": ("case", values, {"long_name": label})}
        )
    return plain


def _without_results(shown: xr.Dataset, rows: np.ndarray, reasons: list[str]) -> None:
    """Make the rows without a case rows of a lift-off without results, each with its reason."""
    for variable in shown.data_vars.values():
        values = variable.values
        if values.dtype.kind == "f":
            values[rows] = np.nan
        elif values.dtype.kind in "OUT":
            values[rows] = ""
        else:
            values[rows] = 0
        variable.values = values
    shown["regime"][rows] = REGIMES.index("lift_off")
    if "reason" in shown:
        shown["reason"].values = np.where(
            rows, np.array(reasons, dtype=object), shown["reason"].values
        )
