"""The designs that no other beats: Pareto set of a study under constraints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.analysis.restore import design_of
from trackroller.errors import InputError, nearest
from trackroller.numerics.expressions import condition
from trackroller.parameters import EXACTNESS, MATERIAL_FIELDS, PARAMETERS, REGIMES
from trackroller.study.design.factors import label
from trackroller.study.goals import aliased, names_in
from trackroller.study.outputs import case_dims, flat, outputs, read_study, regimes

if TYPE_CHECKING:
    from trackroller.study.design.sampling import SampledDesign


def pareto_mask(objectives: np.ndarray, directions: Iterable[str], allowed: np.ndarray | None = None) -> np.ndarray:
    """Rows that no allowed row beats in every objective.

    Parameters
    ----------
    objectives : shape (n, m); a row with a NaN is no candidate
    directions : `min` or `max` for each objective, m of them
    allowed : rows within the constraints, shape (n,)

    Returns
    -------
    Mask, shape (n,). Equal rows all stay. Cost: n times the size of the set.
    """
    signs = []
    for direction in directions:
        if direction not in ("min", "max"):
            raise InputError("objectives", direction, "min or max")
        signs.append(1.0 if direction == "min" else -1.0)
    costs = np.asarray(objectives, dtype=float) * np.array(signs)
    candidate = ~np.isnan(costs).any(axis=1)
    if allowed is not None:
        candidate &= allowed
    rows = np.flatnonzero(candidate)
    # in lexicographic order a row can be beaten by earlier ones only
    rows = rows[np.lexsort(costs[rows].T[::-1])]
    front: list[int] = []
    held = np.empty((0, costs.shape[1]))
    for row in rows:
        worse = (held <= costs[row]).all(axis=1) & (held < costs[row]).any(axis=1)
        if not worse.any():
            front.append(int(row))
            held = costs[front]
    mask = np.zeros(len(costs), dtype=bool)
    mask[front] = True
    return mask


def pareto(
    ds: xr.Dataset, objectives: Mapping[str, str], constraints: Iterable[str] = (), keep: Iterable[str] | None = None
) -> xr.Dataset:
    """Pareto set of a solved study.

    Parameters
    ----------
    ds : gathered study with its study file as attribute
    objectives : output, numeric factor or parameter -> `min` or `max`, e.g. {"roller_life_hours": "max",
        "friction_power": "min"}
    constraints : comparisons such as "max_pressure < 1200", "regime != full_slip", "slip < 0.1 or slip > 0.2" over
        outputs, factors, parameters and `regime`; a row in which one of its values is not defined does not pass
    keep : regimes that are allowed; rolling alone if not given, or any solved one if a constraint speaks of `regime`

    Returns
    -------
    Dataset over `row` (all rows that are allowed, by regime and constraints): the factors, the objectives, the
    constrained outputs, and `optimal` (1 in the set). Attributes count what each constraint excluded. Of several
    contact models only the rows of the most exact one are designs (attribute `model`).

    Raises
    ------
    InputError : unknown names, a constraint that cannot be read, fewer than two objectives
    """
    if len(objectives) < 2:
        raise InputError("pareto", dict(objectives), "at least two outputs, each with min or max")
    constraints = list(constraints)
    wanted = {name for text in constraints for name in names_in(text)}
    if keep is None:
        keep = REGIMES[:3] if "regime" in wanted else ("rolling",)
    design = design_of(ds)
    dims = case_dims(ds, design.factors)
    regime = regimes(ds, dims)
    columns = {name: _column(ds, design, name, dims) for name in dict.fromkeys([*objectives, *sorted(wanted)])}
    allowed = np.isin(regime, [REGIMES.index(name) for name in keep])
    own, model = _own_rows(design)
    excluded = {"regime": int((own & ~allowed).sum())}
    allowed &= own
    table = np.stack([np.asarray(columns[n][0], dtype=float) for n in objectives], axis=1)
    for text in constraints:  # first what the user asked for, then what has no number
        good = np.broadcast_to(_meets(text, columns), allowed.shape)
        excluded[text] = int((allowed & ~good).sum())
        allowed &= good
    defined = ~np.isnan(table).any(axis=1)
    excluded["an undefined goal"] = int((allowed & ~defined).sum())
    allowed &= defined
    optimal = pareto_mask(table, objectives.values(), allowed)
    data: dict[str, Any] = {
        name: ("row", values[0][allowed], {"units": values[1], "long_name": values[2]})
        for name, values in columns.items()
    }
    for name, value in design.columns.items():
        if name not in data and not (model and name == "contact_model"):
            shown = np.array([label(v) for v in value], dtype=object) if value.dtype == object else value
            data[name] = ("row", shown[allowed])
    data["optimal"] = ("row", optimal[allowed].astype(np.int8), {"long_name": "in the Pareto set"})
    out = xr.Dataset(data, coords={"row": np.flatnonzero(allowed)})
    factors = [n for n in design.factors if not (model and n == "contact_model")]
    out.attrs = {
        "objectives": ", ".join(f"{n} {d}" for n, d in objectives.items()),
        "constraints": "; ".join(constraints),
        "factors": ", ".join(factors),
        "rows": int(own.sum()),
        "model": model,
        "excluded": "; ".join(f"{n} by {why}" for why, n in excluded.items() if n) or "nothing",
        "not_rolling": int((own & (regime != 0)).sum()),
        "study": ds.attrs.get("study", ""),
    }
    return out


def _own_rows(design: SampledDesign) -> tuple[np.ndarray, str]:
    """Rows of the most exact contact model, and its name where there are several; all rows else."""
    column = design.columns.get("contact_model")
    named = np.full(design.size, "") if column is None else column.astype(str)
    found = [m for m in EXACTNESS if (named == m).any()]
    return (named == found[0], found[0]) if len(found) > 1 else (np.ones(design.size, bool), "")


def study_pareto(ds: xr.Dataset) -> xr.Dataset | None:
    """Pareto set for the keys `pareto` and `constraints` of the study; for two usual goals where it names none.

    None where there is nothing to choose: a nested study, or results without life and friction power or pressure.
    """
    study = read_study(ds)
    if str(study.get("design", ds.attrs.get("design", ""))) == "nested":
        return None  # a scattered quantity is no one's to choose: the best of chance is no design
    goals = study.get("pareto") or default_objectives(ds)
    if not goals:
        return None
    return pareto(ds, goals, study.get("constraints") or ())


def default_objectives(ds: xr.Dataset) -> dict[str, str]:
    """Life up, and friction power (else the contact pressure) down, where a study has them."""
    found: dict[str, str] = {}
    if "roller_life_hours" in ds and np.isfinite(ds["roller_life_hours"]).any():
        found["roller_life_hours"] = "max"
    elif "life_cycles" in ds:
        found["roller_life_cycles"] = "max"
    for name, variable in (
        ("friction_power", "friction_power"),
        ("friction_energy", "friction_energy_per_distance"),
        ("max_pressure", "max_pressure"),
    ):
        if variable in ds and len(found) == 1:
            found[name] = "min"
    return found if len(found) == 2 else {}


def _column(ds: xr.Dataset, design: SampledDesign, name: str, dims: tuple[str, ...]) -> tuple[np.ndarray, str, str]:
    """Values (n,), units and words of a factor, a parameter, the regime or an output (whatever its regime)."""
    if name == "regime":
        return np.array(REGIMES, dtype=object)[regimes(ds, dims)], "", "regime"
    if name in design.columns:
        values = design.columns[name]
        if values.dtype == object:
            values = np.array([label(v) for v in values], dtype=object)
    elif name in PARAMETERS or name in MATERIAL_FIELDS:
        values = flat(ds, name, dims) if name in ds.variables and ds[name].ndim else _constant(ds, name, design.size)
    else:
        try:
            found = outputs(ds, design.factors, [name], REGIMES[:3], natural=[name], unlimited=True)[0]
        except InputError as error:
            close = nearest(name, REGIMES)
            remedy = f"Did you mean '{close}'?" if close else error.remedy
            raise InputError("pareto or constraints", name, error.allowed, remedy) from None
        return found.values, found.units, found.long_name
    known = PARAMETERS.get(name)
    return values, known.units if known else "", known.long_name if known else name.replace("_", " ")


def _constant(ds: xr.Dataset, name: str, rows: int) -> np.ndarray:
    """A parameter that is the same in all cases: from the result itself, else from its study file."""
    if name in ds.variables:
        return np.full(rows, ds[name].item())
    base = read_study(ds).get("base", {})
    value = base.get(name, PARAMETERS[name].default if name in PARAMETERS else "")
    return np.full(rows, np.nan if value is None else value)


def _meets(text: str, columns: Mapping[str, tuple[np.ndarray, str, str]]) -> np.ndarray:
    plain, parts = aliased(text)
    known: dict[str, Any] = {name: column[0] for name, column in columns.items()}
    known |= {alias: columns[name][0] for alias, name in parts.items()} | {name: name for name in REGIMES}
    return condition(plain, known)
