"""Pareto set of a study: the designs that no other design beats in every goal, under constraints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr

from trackroller.analysis.limits import Column, meeting
from trackroller.analysis.table import StudyResults
from trackroller.errors import InputError
from trackroller.methods import Design
from trackroller.methods.factor import readable
from trackroller.parameters import EXACTNESS, PARAMETERS, REGIME_LABELS, REGIMES
from trackroller.study.file.goals import names_in, statistic
from trackroller.study.outputs import regimes

SAFE_B10 = "B10 of {}, other cases as life 0"  # other cases: those that do not roll, or have no known life


def pareto_mask(objectives: np.ndarray, directions: Iterable[str]) -> np.ndarray:
    """Mark the rows that no other row beats in every objective.

    Parameters
    ----------
    objectives : shape (n, m); a row with a NaN is not a candidate
    directions : `min` or `max` for each of the m objectives

    Returns
    -------
    Mask, shape (n,). Of equal rows, all are in the set.

    Raises
    ------
    InputError : a direction is neither `min` nor `max`

    Notes
    -----
    Cost: n times the size of the set.
    """
    signs = []
    for direction in directions:
        if direction not in ("min", "max"):
            raise InputError("objectives", direction, "min or max")
        signs.append(1.0 if direction == "min" else -1.0)
    costs = np.asarray(objectives, dtype=float) * np.array(signs)
    rows = np.flatnonzero(~np.isnan(costs).any(axis=1))
    # in lexicographic order only an earlier row can beat a row
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
    results: StudyResults,
    objectives: Mapping[str, str],
    constraints: Iterable[str] = (),
) -> xr.Dataset:
    """Find the Pareto set of a solved study.

    Parameters
    ----------
    results : StudyResults
        A solved study.
    objectives : mapping of str to str
        Output, numeric factor or parameter, and `min` or `max` for each, such as {"roller_life_hours": "max",
        "friction_power": "min"}.
    constraints : iterable of str
        Comparisons over outputs, factors, parameters and `regime`, such as "max_pressure < 1200", "regime != full_slip"
        or "slip < 0.1 or slip > 0.2". A row with an undefined value does not meet them. Only rolling rows are
        allowed, unless a constraint names `regime`.

    Returns
    -------
    xarray.Dataset
        Dimension `row`: all rows that meet regime and constraints. Variables: the factors, the objectives, the
        constrained outputs, and `optimal`, which is 1 for the rows of the Pareto set. The attribute `excluded` counts
        the rows that each constraint excluded. In a study with several contact models, only the rows of the most exact
        model are compared (attribute `model`).

    Raises
    ------
    InputError
        If a name is unknown, a constraint is not a comparison, or there are fewer than two objectives.
    """
    if len(objectives) < 2:
        raise InputError("pareto", dict(objectives), "at least two outputs, each with min or max")
    constraints = list(constraints)
    wanted = {name for text in constraints for name in names_in(text)}
    keep = REGIMES[:3] if "regime" in wanted else ("rolling",)
    ds, design, dims = results.data, results.design, results.dims
    regime = regimes(ds, dims)
    names = dict.fromkeys([*objectives, *sorted(wanted)])
    columns = {name: results.quantity(name) for name in names}
    values = {name: own[0] for name, own in columns.items()}
    own, model = _own_rows(design)
    kept = np.isin(regime, [REGIMES.index(name) for name in keep])
    undefined = np.isnan(np.stack([values[name].astype(float) for name in objectives])).any(axis=0)
    allowed, excluded = _allowed(undefined, values, constraints, own, kept)
    shown = {n: readable(c)[allowed] for n, c in design.columns.items() if not (model and n == "contact_model")}
    attrs: dict[str, Any] = {
        "constraints": "; ".join(constraints),
        "factors": ", ".join(n for n in design.factors if n in shown),
        "rows": int(own.sum()),
        "model": model,
        "not_rolling": int((own & (regime != 0)).sum()),
        "study": results.study.merged(),
    }
    left = "; ".join(f"{n} by {why}" for why, n in excluded.items() if n)
    kept_columns = {name: (value[allowed], units, words) for name, (value, units, words) in columns.items()}
    return front_of(shown, kept_columns, objectives, np.flatnonzero(allowed), left, **attrs)


def front_of(
    factors: Mapping[str, np.ndarray],
    columns: Mapping[str, Column],
    objectives: Mapping[str, str],
    row: np.ndarray,
    excluded: str,
    /,
    *,
    further: Mapping[str, str] | None = None,
    **attrs: Any,
) -> xr.Dataset:
    """Return the allowed designs with their factors, goals and `optimal`, see `pareto`.

    Parameters
    ----------
    factors, columns : values of the n allowed designs by name; the columns hold the goals
    objectives : goals, each `min` or `max`
    row : number of each design, shape (n,)
    excluded : how many designs each reason excluded, in words; '' for none
    further : columns that a design must also be beaten in to be left out, each `min` or `max`
    attrs : further attributes of the result
    """
    wanted = {**objectives, **(further or {})}
    goals = np.stack([np.asarray(columns[name][0], dtype=float) for name in wanted], axis=1)
    data: dict[str, Any] = {name: ("row", values) for name, values in factors.items()}
    for name, (values, units, long_name) in columns.items():
        data[name] = ("row", values, {"units": units, "long_name": long_name})
    optimal = pareto_mask(goals, wanted.values()).astype(np.int8)
    data["optimal"] = ("row", optimal, {"long_name": "in the Pareto set"})
    described = {"objectives": ", ".join(f"{name} {way}" for name, way in objectives.items())}
    described |= {"factors": ", ".join(factors), "constraints": "", "model": "", "excluded": excluded or "nothing"}
    return xr.Dataset(data, {"row": row}, described | attrs)


def _allowed(
    undefined: np.ndarray, values: Mapping[str, Any], constraints: list[str], own: np.ndarray, kept: np.ndarray
) -> tuple[np.ndarray, dict[str, int]]:
    """Return the mask of allowed rows and the number of rows that each reason excluded."""
    allowed = own.copy()
    excluded = {}
    # constraints come first, so that a row without a value counts for them
    checks = {"regime": kept}
    checks |= meeting(constraints, values, own.size)
    checks["an undefined goal"] = ~undefined
    for reason, good in checks.items():
        excluded[reason] = int((allowed & ~good).sum())
        allowed &= good
    return allowed, excluded


def _own_rows(design: Design) -> tuple[np.ndarray, str]:
    """Return the rows of the most exact of several contact models and its name; without several models, all rows."""
    column = design.columns.get("contact_model")
    named = np.full(design.size, "") if column is None else column.astype(str)
    models = [m for m in EXACTNESS if (named == m).any()]
    return (named == models[0], models[0]) if len(models) > 1 else (np.ones(design.size, bool), "")


def pareto_of_points(table: xr.Dataset, objectives: Mapping[str, str]) -> xr.Dataset:
    """Find the Pareto set of the design points of an inner/outer design.

    Parameters
    ----------
    table : result of `trackroller.analysis.sensitivity.analyse` for an inner/outer design
    objectives : statistic such as `b10(roller_life_hours)` or outer factor -> `max` or `min`

    Returns
    -------
    As `pareto`; `row` is the number of the design point.

    Raises
    ------
    InputError : a statistic is not in the analysis
    """
    columns = {name: _of_points(table, name) for name in objectives}
    known = ~np.isnan(np.stack([column[0].astype(float) for column in columns.values()])).any(axis=0)
    outer = [name for name in str(table.attrs["outer_factors"]).split(", ") if name]
    left = f"{(~known).sum()} by an undefined goal" if not known.all() else ""
    attrs: dict[str, Any] = {"rows": len(known), "kind": "design point", "study": table.attrs.get("study", "")}
    kept = {name: (values[known], units, words) for name, (values, units, words) in columns.items()}
    factors = {name: readable(table[name].values)[known] for name in outer}
    return front_of(factors, kept, objectives, np.flatnonzero(known), left, **attrs)


def _of_points(table: xr.Dataset, name: str) -> Column:
    """Return a statistic or an outer factor at each design point, with units and long name."""
    kind, output = statistic(name)
    if not kind:
        known = PARAMETERS.get(name)
        return table[name].values, known.units if known else "", known.long_name if known else name
    if kind == "probability" and output in REGIMES:
        estimates, words, units = table["probability"].sel(regime=output), REGIME_LABELS[REGIMES.index(output)], "1"
    elif kind == "probability":
        if output not in table["target"].values:
            raise InputError("pareto", name, f"a target: {', '.join(table['target'].values)}")
        part = table.isel(target=int(np.argmax(table["target"].values == output)))
        estimates, units = part["target_probability"], "1"
        words = f"meeting the target for {part['target_name'].item()}"
    else:
        if output not in table["output"].values or kind not in table:
            raise InputError("pareto", name, f"an analysed output: {', '.join(map(str, table['output'].values))}")
        part = table.sel(output=output)
        estimates, words, units = part[kind], str(part["output_name"].item()), str(part["output_units"].item())
    named = {"b10": "B10 of {}", "b10_safe": SAFE_B10}.get(kind, f"{kind} of {{}}".replace("_", " "))
    return estimates.values, units, named.format(words)


def default_objectives(ds: xr.Dataset) -> dict[str, str]:
    """Return the usual goals: longest life of the pair, and lowest friction power, friction energy or contact pressure.

    Parameters
    ----------
    ds : gathered study

    Returns
    -------
    Output -> `max` or `min`; empty if the study lacks one of the two goals.
    """
    goals: dict[str, str] = {}
    known = "guide_life_hours" in ds and not bool(ds["guide_life_hours"].isnull().all())
    # of the pair where the guide's hours are known
    lives = ["pair_life_to_first_limit_hours", *["pair_life_hours"] * known, "roller_life_hours"]
    lives = [n for n in lives if n in ds and np.isfinite(ds[n]).any()]
    if lives:
        goals[lives[0]] = "max"
    elif "life_cycles" in ds:
        goals["life_cycles_roller"] = "max"
    for name in ("friction_power", "friction_energy_per_distance", "max_pressure"):
        if name in ds and len(goals) == 1:
            goals[name] = "min"
    return goals if len(goals) == 2 else {}


def goals_of(front: xr.Dataset) -> list[tuple[str, str]]:
    """List the goals of a Pareto set: (name, 'min' or 'max')."""
    return [tuple(item.split(" ")) for item in front.attrs["objectives"].split(", ")]


def end_places(front: xr.Dataset) -> list[int]:
    """Return for each goal the place of the optimal design that is best in it, shape (goals,)."""
    best = np.flatnonzero(front["optimal"].values == 1)
    signs = [(front[name].values[best].astype(float), -1.0 if way == "max" else 1.0) for name, way in goals_of(front)]
    return [int(best[np.argmin(sign * values)]) for values, sign in signs]
