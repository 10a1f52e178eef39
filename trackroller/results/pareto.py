"""Pareto set of a study: the candidates that no other candidate beats in every goal, under
constraints.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError
from trackroller.methods import Design
from trackroller.methods.factor import readable
from trackroller.parameters import EXACTNESS, REGIME_LABELS, REGIMES
from trackroller.parameters.carriage_fields import parameter_of
from trackroller.results.candidates import Candidates, candidates_of
from trackroller.results.case_columns import codes
from trackroller.results.constraints import Column, meeting
from trackroller.results.lives_by_tests import beyond_sn_data
from trackroller.results.search_fitness import (
    SAFE_B10,
    beyond_data,
    goal_column,
    goals_of_search,
    judge,
)
from trackroller.results.sensitivity import analysis_of
from trackroller.results.solved_cases import SolvedCases, made_once
from trackroller.roller.output_names import is_life
from trackroller.study.file.goals import names_in, statistic
from trackroller.study.file.search import judged_by
from trackroller.study.outputs import regimes


def given_pareto(results: SolvedCases) -> xr.Dataset | None:
    """Return the Pareto set for the goals that a study or a search gives; None without goals of its
    own.
    """
    if goals_of_front(results) or results.config.method.proposes:
        return study_pareto(results)
    return None


def goals_of_front(results: SolvedCases) -> dict[str, str]:
    """Return the goals of the key `pareto`; {} for a single goal, which ranks what meets the
    requirement.
    """
    given = dict(results.config.pareto)
    if len(given) > 1:
        return given
    return {}


@made_once
def study_pareto(results: SolvedCases) -> xr.Dataset | None:
    """Find the Pareto set for the keys `pareto` and `constraints` of a study.

    Parameters
    ----------
    results : SolvedCases
        A solved study.

    Returns
    -------
    xarray.Dataset or None
        Without the key `pareto` the goals are those of `SolvedCases.goals`. Candidates that share
        their conditions: see `pareto_of_candidates`. An inner/outer design with the key: see
        `pareto_of_points`, and without it None. Otherwise see `pareto`; rows that differ in
        conditions have the attribute `kind` = `case`, and there is no set without the key, because
        the conditions cannot be chosen.
    """
    config = results.config
    given = goals_of_front(results)
    if config.method.proposes:
        return pareto_of_search(results)
    if config.method.points:
        analysis = analysis_of(results)
        if analysis is not None and given:
            return pareto_of_points(analysis, given)
        return None
    goals = results.goals
    if not goals:
        return None
    candidates = candidates_of(results, tuple(name for name in goals if name in results.factors))
    if candidates is not None and candidates.conditions and candidates.comparable:
        return pareto_of_candidates(candidates, goals)
    mixed = candidates is not None and bool(candidates.conditions)
    if mixed and not given:
        return None
    front = pareto(results, goals, config.constraints)
    front = front.assign(_beyond(results, dict.fromkeys(goals, front["row"].values)))
    kind = "design"
    if mixed:
        kind = "case"
    return front.assign_attrs(kind=kind)


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
        if direction == "min":
            sign = 1.0
        else:
            sign = -1.0
        signs.append(sign)
    costs = np.asarray(objectives, dtype=float) * np.array(signs)
    rows = np.flatnonzero(~np.isnan(costs).any(axis=1))
    # in lexicographic order only an earlier row can beat a row
    rows = rows[np.lexsort(costs[rows].T[::-1])]
    front: list[int] = []
    front_costs = np.empty((0, costs.shape[1]))
    for row in rows:
        worse = (front_costs <= costs[row]).all(axis=1) & (front_costs < costs[row]).any(axis=1)
        if not worse.any():
            front.append(int(row))
            front_costs = costs[front]
    mask = np.zeros(len(costs), dtype=bool)
    mask[front] = True
    return mask


def pareto(
    results: SolvedCases, objectives: Mapping[str, str], constraints: Iterable[str] = ()
) -> xr.Dataset:
    """Find the Pareto set of a solved study.

    Parameters
    ----------
    results : SolvedCases
        A solved study.
    objectives : mapping of str to str
        Output, numeric factor or parameter, and `min` or `max` for each, such as
        {"roller_life_hours": "max", "friction_power": "min"}.
    constraints : iterable of str
        Comparisons over outputs, factors, parameters and `regime`, such as "max_pressure < 1200",
        "regime != full_slip" or "slip < 0.1 or slip > 0.2". A row with an undefined value does not
        meet them. Only rolling rows are allowed, unless a constraint names `regime`.

    Returns
    -------
    xarray.Dataset
        Dimension `row`: all rows that meet regime and constraints. Variables: the factors, the
        objectives, the constrained outputs, and `optimal`, which is 1 for the rows of the Pareto
        set. The attribute `excluded` counts the rows that each constraint excluded. In a study with
        several contact models, only the rows of the most exact model are compared (attribute
        `model`).

    Raises
    ------
    InputError
        If a name is unknown, a constraint is not a comparison, or there are fewer than two
        objectives.
    """
    if len(objectives) < 2:
        raise InputError("pareto", dict(objectives), "at least two outputs, each with min or max")
    design = results.design
    constraints = list(constraints)
    limited_names = {name for text in constraints for name in names_in(text)}
    names = dict.fromkeys([*objectives, *sorted(limited_names)])
    columns = {name: results.quantity(name) for name in names}
    limited = {name: results.constrained(name) for name in limited_names}
    regime = regimes(results.data, results.dims)
    keep: tuple[str, ...] = ("rolling",)
    if "regime" in limited_names:
        keep = REGIMES[:3]
    counted = np.isin(regime, [REGIMES.index(name) for name in keep])
    own, model = _own_rows(design)
    goals = np.stack([columns[name][0].astype(float) for name in objectives])
    undefined = np.isnan(goals).any(axis=0)
    allowed, excluded = _allowed(undefined, limited, constraints, own, counted)
    shown = {}
    for name, values in design.columns.items():
        if not (model and name == "contact_model"):
            shown[name] = readable(values)[allowed]
    attrs: dict[str, Any] = {
        "constraints": "; ".join(constraints),
        "factors": ", ".join(n for n in design.factors if n in shown),
        "rows": int(own.sum()),
        "model": model,
        "not_rolling": int((own & (regime != 0)).sum()),
        "study": results.study.merged(),
    }
    attrs["excluded"] = "; ".join(f"{n} by {why}" for why, n in excluded.items() if n) or "nothing"
    kept_columns = {
        name: (value[allowed], units, words) for name, (value, units, words) in columns.items()
    }
    return front_of(shown, kept_columns, objectives, np.flatnonzero(allowed), **attrs)


def front_of(
    factors: Mapping[str, np.ndarray],
    columns: Mapping[str, Column],
    objectives: Mapping[str, str],
    row: np.ndarray,
    /,
    *,
    further: Mapping[str, str] | None = None,
    **attrs: Any,
) -> xr.Dataset:
    """Return the allowed candidates with their factors, goals and `optimal`, see `pareto`.

    Parameters
    ----------
    factors, columns : values of the n allowed candidates by name; the columns hold the goals
    objectives : goals, each `min` or `max`
    row : number of each candidate, shape (n,)
    further : columns that a candidate must also be beaten in to be left out, each `min` or `max`
    attrs : further attributes of the result
    """
    directions = {**objectives, **(further or {})}
    goals = np.stack([np.asarray(columns[name][0], dtype=float) for name in directions], axis=1)
    data: dict[str, Any] = {name: ("row", values) for name, values in factors.items()}
    for name, (values, units, long_name) in columns.items():
        data[name] = ("row", values, {"units": units, "long_name": long_name})
    optimal = pareto_mask(goals, directions.values()).astype(np.int8)
    data["optimal"] = ("row", optimal, {"long_name": "in the Pareto set"})
    described = {"objectives": ", ".join(f"{name} {way}" for name, way in objectives.items())}
    described |= {"factors": ", ".join(factors), "constraints": "", "model": ""}
    return xr.Dataset(data, {"row": row}, described | attrs)


def _allowed(
    undefined: np.ndarray,
    values: Mapping[str, Any],
    constraints: list[str],
    own: np.ndarray,
    counted: np.ndarray,
) -> tuple[np.ndarray, dict[str, int]]:
    """Return the mask of allowed rows and the number of rows that each reason excluded."""
    allowed = own.copy()
    excluded = {}
    # constraints come first, so that a row without a value counts for them
    checks = {"regime": counted}
    checks |= meeting(constraints, values, own.size)
    checks["an undefined goal"] = ~undefined
    for reason, good in checks.items():
        excluded[reason] = int((allowed & ~good).sum())
        allowed &= good
    return allowed, excluded


def _own_rows(design: Design) -> tuple[np.ndarray, str]:
    """Return the rows of the most exact of several contact models and its name; without several
    models, all rows.
    """
    column = design.columns.get("contact_model")
    if column is None:
        named = np.full(design.size, "")
    else:
        named = column.astype(str)
    models = [m for m in EXACTNESS if (named == m).any()]
    if len(models) > 1:
        return named == models[0], models[0]
    return np.ones(design.size, bool), ""


def pareto_of_points(table: xr.Dataset, objectives: Mapping[str, str]) -> xr.Dataset:
    """Find the Pareto set of the design points of an inner/outer design.

    Parameters
    ----------
    table : result of `trackroller.results.sensitivity.analyse` for an inner/outer design
    objectives : statistic such as `b10(roller_life_hours)` or outer factor -> `max` or `min`

    Returns
    -------
    As `pareto`; `row` is the number of the design point.

    Raises
    ------
    InputError : a statistic is not in the analysis
    """
    columns = {name: _of_points(table, name) for name in objectives}
    known = ~np.isnan(np.stack([column[0].astype(float) for column in columns.values()])).any(
        axis=0
    )
    outer = [name for name in str(table.attrs["outer_factors"]).split(", ") if name]
    attrs: dict[str, Any] = {
        "rows": len(known),
        "kind": "design point",
        "study": table.attrs.get("study", ""),
    }
    known_columns = {
        name: (values[known], units, words) for name, (values, units, words) in columns.items()
    }
    factors = {name: readable(table[name].values)[known] for name in outer}
    return front_of(factors, known_columns, objectives, np.flatnonzero(known), **attrs)


def _of_points(table: xr.Dataset, name: str) -> Column:
    """Return a statistic or an outer factor at each design point, with units and long name."""
    kind, output = statistic(name)
    if not kind:
        known = parameter_of(name)
        return table[name].values, known.units if known else "", known.long_name if known else name
    if kind == "probability" and output in REGIMES:
        estimates = table["probability"].sel(regime=output)
        words = REGIME_LABELS[REGIMES.index(output)]
        units = "1"
    elif kind == "probability":
        if output not in table["target"].values:
            raise InputError("pareto", name, f"a target: {', '.join(table['target'].values)}")
        part = table.isel(target=int(np.argmax(table["target"].values == output)))
        estimates = part["target_probability"]
        units = "1"
        words = f"meeting the target for {part['target_name'].item()}"
    else:
        if output not in table["output"].values or kind not in table:
            raise InputError(
                "pareto", name, f"an analysed output: {', '.join(map(str, table['output'].values))}"
            )
        part = table.sel(output=output)
        estimates = part[kind]
        words = str(part["output_name"].item())
        units = str(part["output_units"].item())
    named = {"b10": "B10 of {}", "b10_safe": SAFE_B10}.get(
        kind, f"{kind} of {{}}".replace("_", " ")
    )
    return estimates.values, units, named.format(words)


def pareto_of_candidates(candidates: Candidates, objectives: Mapping[str, str]) -> xr.Dataset:
    """Find the candidates that no other candidate beats in every goal and in the number of
    conditions that it holds.

    Parameters
    ----------
    candidates : Candidates
        The candidates of a study. A condition that is a goal counts as a choice.
    objectives : mapping of str to str
        Output, numeric factor or parameter, and `min` or `max` for each.

    Returns
    -------
    xarray.Dataset
        Dimension `row`, the case with the worst first goal of each candidate that is valid in a
        condition. Variables: the choices; each goal at the worst of the candidate's valid cases;
        `valid_in`, the number of these cases; `optimal`; `beyond_` and the name of a life, 1 where
        it lies beyond the S-N data.
    """
    results = candidates.results
    columns = {name: results.quantity(name) for name in objectives}
    worst = {
        name: candidates.worst_cases(columns[name][0].astype(float), way)
        for name, way in objectives.items()
    }
    valid = candidates.valid_in
    judged = np.flatnonzero(np.all([cases >= 0 for cases in worst.values()], axis=0) & (valid > 0))
    row = next(iter(worst.values()))[judged]
    factors = {name: results.table[name].to_numpy()[row] for name in candidates.choices}
    goals = {
        name: (values[worst[name][judged]], units, words)
        for name, (values, units, words) in columns.items()
    }
    goals["valid_in"] = (valid[judged].astype(float), "1", "conditions in which it is valid")
    model = ""
    if "contact_model" in results.factors:
        model = str(results.held_level("contact_model"))
    attrs = {
        "constraints": "; ".join(results.config.constraints),
        "rows": len(valid),
        "conditions": candidates.possible,
        "model": model,
        "judged": "each goal at the worst of the conditions in which the design is valid",
        "study": results.data.attrs.get("study", ""),
    }
    front = front_of(factors, goals, objectives, row, further={"valid_in": "max"}, **attrs)
    return front.assign(_beyond(results, {name: cases[judged] for name, cases in worst.items()}))


def _beyond(
    results: SolvedCases, cases: Mapping[str, np.ndarray]
) -> dict[str, tuple[str, np.ndarray]]:
    """Return for each life among the goals whether it lies beyond the S-N data in the cases that
    are compared.
    """
    lives = {name: rows for name, rows in cases.items() if is_life(name)}
    return {
        f"beyond_{n}": ("row", beyond_sn_data(results, n)[rows].astype(np.int8))
        for n, rows in lives.items()
    }


def pareto_of_search(results: SolvedCases) -> xr.Dataset:
    """Return the Pareto set of the gathered candidates of a search, see `pareto`.

    The dimension `row` numbers the candidates. Only the candidates are compared that are valid in
    the most conditions, and that meet the target of the study if any of them does.
    """
    judged = judge(results)
    goals = goals_of_search(results)
    design = results.design
    least = judged.violation.min()
    if (judged.missed == 0).any():
        missed = judged.missed
    else:
        missed = judged.violation
    nearest = np.flatnonzero((missed == least) & (least < 1))
    tried = codes(results.table.iloc[:: design.meta["inner_samples"]], design.meta["outer"])
    # a candidate that was solved twice counts once
    nearest = nearest[np.unique(tried[nearest], return_index=True)[1]]
    first = nearest * design.meta["inner_samples"]
    factors = {name: readable(design.columns[name][first]) for name in design.meta["outer"]}
    columns = {
        n: (values[nearest], units, words)
        for n in goals
        for values, units, words in [goal_column(results, n)]
    }
    attrs: dict[str, Any] = {
        "rows": int(tried.max()) + 1,
        "kind": "design point",
        "study": results.study.merged(),
    }
    attrs["constraints"] = "; ".join(results.config.constraints)
    lives = [
        name
        for name in goals
        if is_life(judged_by(name)[1]) and judged_by(name)[0] != "probability"
    ]
    beyond = {
        f"beyond_{name}": ("row", beyond_data(results, name)[nearest].astype(np.int8))
        for name in lives
    }
    return front_of(factors, columns, goals, nearest, **attrs).assign(beyond)


def goals_of(front: xr.Dataset) -> list[tuple[str, str]]:
    """List the goals of a Pareto set: (name, 'min' or 'max')."""
    return [tuple(item.split(" ")) for item in front.attrs["objectives"].split(", ")]
