"""Pareto set of designs, each judged at the worst of the conditions in which it is valid."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from trackroller.analysis.designs import Designs
from trackroller.analysis.judging import pareto_of_search
from trackroller.analysis.pareto import default_objectives, front_of, pareto, pareto_of_points
from trackroller.analysis.table import StudyView


def study_pareto(view: StudyView) -> xr.Dataset | None:
    """Find the Pareto set for the keys `pareto` and `constraints` of a study.

    Parameters
    ----------
    view : StudyView
        The study. The design points of an inner/outer design need its analysis.

    Returns
    -------
    xarray.Dataset or None
        Without the key `pareto` the goals are those of `default_objectives`. Designs that share their conditions:
        see `pareto_of_designs`. An inner/outer design with the key: see `pareto_of_points`, and without it None.
        Otherwise see `pareto`; rows that differ in conditions have the attribute `kind` = `case`, and there is no set
        without the key, because the conditions cannot be chosen.
    """
    config = view.solved.config
    given = config.pareto
    if config.method.proposes:
        return pareto_of_search(view.solved)
    if config.method.points:
        return pareto_of_points(view.analysis, given) if view.analysis is not None and given else None
    goals = given or default_objectives(view.data)
    if not goals:
        return None
    designs = Designs.of(view, tuple(name for name in goals if name in view.factors))
    if designs is not None and designs.conditions and designs.comparable:
        return pareto_of_designs(designs, goals)
    mixed = designs is not None and bool(designs.conditions)
    if mixed and not given:
        return None
    front = pareto(view.solved, goals, config.constraints)
    front = front.assign(_beyond(view, dict.fromkeys(goals, front["row"].values)))
    return front.assign_attrs(kind="case" if mixed else "design")


def pareto_of_designs(designs: Designs, objectives: Mapping[str, str]) -> xr.Dataset:
    """Find the designs that no other design beats in every goal and in the number of conditions that it holds.

    Parameters
    ----------
    designs : Designs
        The designs of a study. A condition that is a goal counts as a choice.
    objectives : mapping of str to str
        Output, numeric factor or parameter, and `min` or `max` for each.

    Returns
    -------
    xarray.Dataset
        Dimension `row`, the case with the worst first goal of each design that is valid in a condition. Variables: the
        choices; each goal at the worst of the design's valid cases; `valid_in`, the number of these cases; `optimal`;
        `beyond_` and the name of a life, 1 where it lies beyond the S-N data.
    """
    view = designs.view
    columns = {name: view.solved.quantity(name) for name in objectives}
    worst = {name: designs.worst_cases(columns[name][0].astype(float), way) for name, way in objectives.items()}
    held = designs.table["valid"].sort_index().to_numpy()
    kept = np.flatnonzero(np.all([cases >= 0 for cases in worst.values()], axis=0) & (held > 0))
    row = next(iter(worst.values()))[kept]
    factors = {name: view.table[name].to_numpy()[row] for name in designs.choices}
    goals = {name: (values[worst[name][kept]], units, words) for name, (values, units, words) in columns.items()}
    goals["valid_in"] = (held[kept].astype(float), "1", "conditions in which it is valid")
    left = len(held) - len(kept)
    excluded = f"{left} that are valid in no condition" if left else ""
    attrs = {
        "constraints": "; ".join(view.solved.config.constraints),
        "rows": len(held),
        "model": str(view.held_level("contact_model")) if "contact_model" in view.factors else "",
        "judged": "each goal at the worst of the conditions in which the design is valid",
        "study": view.attrs.get("study", ""),
    }
    front = front_of(factors, goals, objectives, row, excluded, further={"valid_in": "max"}, **attrs)
    return front.assign(_beyond(view, {name: cases[kept] for name, cases in worst.items()}))


def _beyond(view: StudyView, cases: Mapping[str, np.ndarray]) -> dict[str, tuple[str, np.ndarray]]:
    """Return for each life among the goals whether it lies beyond the S-N data in the cases that are compared."""
    lives = {name: rows for name, rows in cases.items() if "life" in name}
    return {f"beyond_{n}": ("row", view.beyond_data(n)[rows].astype(np.int8)) for n, rows in lives.items()}
