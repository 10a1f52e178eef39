"""How far all forces of a case may grow until each limit is reached.

A contact grows with its load, so that a pressure follows about the third root of the forces, and
one solution does not tell the ratio: it is sought.

ASSUME: of the conditions of a roller, the one that uses most of a limit reaches it first.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.damage import LIMITS, limit_word, wear
from trackroller.damage.limit import worst
from trackroller.materials import MaterialDatabase
from trackroller.parameters import BODIES, REGIMES
from trackroller.results.margins import YIELD
from trackroller.roller.case import Case
from trackroller.roller.settings import LOADS
from trackroller.roller.solver import solve
from trackroller.study.file.study import Study
from trackroller.study.solve_chunk import solve_cases
from trackroller.study.store.fingerprint import StudyCases

FORCES = (*LOADS, "motor_force")  # all forces of a case
PRESSURE = "pressure"  # at which a body yields below its surface; no limit of the room `damage`
EXACT = 1e-4  # relative difference of a utilisation from 1 at which the search ends
STEPS = 12  # solutions of a pair at most
LARGEST_STEP = 8.0  # of the forces from one solution to the next
FARTHEST = 1e3  # ratio at which the search ends; a larger one is infinite
POWER = 1 / 3  # of the forces that a pressure follows, for the first step


@dataclass(frozen=True)
class LoadRatios:
    """What all forces may be multiplied by until each limit of a roller is reached.

    Parameters
    ----------
    table : pandas.DataFrame
        A row for each roller, a column for each limit by its name, and `pressure`: the ratio [1];
        inf beyond `FARTHEST`, NaN if it is not known.
    bodies : pandas.DataFrame
        The body that reaches the limit, in the same places.
    """

    table: pd.DataFrame
    bodies: pd.DataFrame

    @property
    def least(self) -> pd.Series:
        """Return the least ratio of each roller [1]; NaN if none is known."""
        return self.table.min(axis=1)

    def times(self, factor: float) -> LoadRatios:
        """Return the ratios of forces that are smaller by a factor [1]."""
        return LoadRatios(self.table * factor, self.bodies)

    @property
    def first(self) -> pd.Series:
        """Return limit and body that each roller reaches first, in words; '' if none is known."""
        words = []
        for place in range(len(self.table)):
            row = self.table.iloc[place].to_numpy()
            if np.isnan(row).all():
                words.append("")
                continue
            column = int(np.nanargmin(row))
            limit = limit_word(str(self.table.columns[column]))
            body = str(self.bodies.iloc[place, column])
            words.append(f"{limit} of the {body}")
        return pd.Series(words, self.table.index, dtype=object)


def load_ratios(study: Study, factor: str) -> LoadRatios:
    """Return the load ratios of the levels of a factor, such as the rollers of a shelf.

    Parameters
    ----------
    study : Study
        The study. A limit counts if it has a utilisation in all cases of a level, bounds the load
        and is no matter of travel.
    factor : str
        Name of the factor whose levels are told apart; the worst condition of each counts.

    Returns
    -------
    LoadRatios
        Exact to 1e-4 of a utilisation.
    """
    cases = StudyCases(study)
    options, group = cases.options
    options = [one | {"at_most": ()} for one in options]  # a bound is no number to bring to 100 %
    labels = study.drawn.columns[factor][cases.rows]
    solver = _OfStudy(cases.design, options, group, study.materials)
    return _ratios(solver, labels, list(study.parsed[factor].levels), factor)


def load_ratios_of_cases(
    cases: Sequence[Case],
    labels: Sequence[str],
    options: Mapping[str, Any],
    materials: MaterialDatabase,
) -> LoadRatios:
    """Return the load ratios of cases that belong to no study, such as the blocks of a spectrum.

    Parameters
    ----------
    cases : sequence of Case
        The cases.
    labels : sequence of str
        Name of what each case is a condition of; the worst case of each name counts.
    options : mapping
        Options of the solver.
    materials : MaterialDatabase
        The materials.
    """
    solver = _OfCases(list(cases), options, materials)
    levels = list(dict.fromkeys(labels))
    return _ratios(solver, np.array(labels, dtype=object), levels, "roller")


def _ratios(solver: _Solver, labels: np.ndarray, levels: list[Any], name: str) -> LoadRatios:
    """Return the load ratios of the worst case of each level; `labels` says of which level a case
    is, (n,).
    """
    names, used, bodies = solver.uses(np.arange(len(labels)), np.ones(len(labels)))
    starts = []
    pairs = []
    for place, level in enumerate(levels):
        own = np.flatnonzero(labels == level)
        for column in range(len(names)):
            if len(own) and np.isfinite(used[own, column]).all():
                starts.append(int(own[np.argmax(used[own, column])]))
                pairs.append((place, column))
    rows = np.array(starts, dtype=int)
    columns = np.array([column for _, column in pairs], dtype=int)
    sought = solver.sought(rows, columns, names, used[rows, columns])
    table = pd.DataFrame(np.nan, pd.Index(levels, name=name), names)
    of_bodies = pd.DataFrame("", pd.Index(levels, name=name), names)
    for (place, column), row, ratio in zip(pairs, rows, sought, strict=True):
        table.iloc[place, column] = ratio
        of_bodies.iloc[place, column] = bodies[row, column]
    known = table.notna().any()
    return LoadRatios(table.loc[:, known], of_bodies.loc[:, known])


class _Solver:
    """Solve rows with all forces times a ratio."""

    database: MaterialDatabase

    def solved(
        self, rows: np.ndarray, ratios: np.ndarray
    ) -> Iterator[tuple[np.ndarray, xr.Dataset]]:
        """Yield places in `rows` with the results there, along `case`."""
        raise NotImplementedError

    def material(self, body: str, row: int) -> Any:
        """Return the material of a body in a row, as a case has it."""
        raise NotImplementedError

    def uses(
        self, rows: np.ndarray, ratios: np.ndarray
    ) -> tuple[list[str], np.ndarray, np.ndarray]:
        """Return the names of the limits, and the utilisation by each with the body that has it,
        (n, limit).

        A utilisation is NaN where it is not known, and in a case that failed.
        """
        frames = []
        for places, solved in self.solved(rows, ratios):
            values, bodies = self._of_solved(solved, rows[places])
            index = pd.Index(places)
            frames.append((values.set_axis(index), bodies.set_axis(index)))
        used, worse = (pd.concat(parts).sort_index() for parts in zip(*frames, strict=True))
        return list(used.columns), used.to_numpy(dtype=float), worse.to_numpy()

    def _of_solved(self, solved: xr.Dataset, rows: np.ndarray) -> tuple[pd.DataFrame, pd.DataFrame]:
        """Return the utilisation by each limit of some rows, and the body that has it."""
        by_body: dict[str, np.ndarray] = {}
        for name in solved["limit"].values.tolist() if "utilisation" in solved else ():
            if LIMITS[name].bounded and name != wear.LIMIT.name:
                by_body[name] = solved["utilisation"].sel(limit=name).values
        if "max_pressure" in solved:
            strengths = [self._strengths(body, rows) for body in BODIES]
            pressure = worst(solved["max_pressure"].values)
            by_body[PRESSURE] = pressure[:, None] / (YIELD * np.stack(strengths, axis=1))
        failed = solved["regime"].values == REGIMES.index("failed")
        used = {}
        bodies = {}
        for name, values in by_body.items():
            most = np.where(np.isnan(values), -np.inf, values)
            used[name] = np.where(failed | np.isinf(most).all(axis=1), np.nan, most.max(axis=1))
            bodies[name] = np.array(BODIES)[np.argmax(most, axis=1)]
        return pd.DataFrame(used), pd.DataFrame(bodies)

    def _strengths(self, body: str, rows: np.ndarray) -> np.ndarray:
        """Return the tensile strength of a body in some rows, (n,) [MPa]."""
        materials = [self.database.material(self.material(body, row)) for row in rows.tolist()]
        return np.array([material.tensile_strength for material in materials])

    def sought(
        self, rows: np.ndarray, columns: np.ndarray, names: list[str], used: np.ndarray
    ) -> np.ndarray:
        """Return the ratio at which each pair of a row and a limit has the utilisation 1, (n,).

        Parameters
        ----------
        rows, columns : numpy.ndarray of int
            Row of the design, and place of the limit in `names`, of each pair.
        names : list of str
            Names of the limits.
        used : numpy.ndarray
            Utilisation of each pair at the ratio 1 [1].
        """
        with np.errstate(divide="ignore"):
            height = np.log(used)
        at = np.zeros(len(rows))  # logarithm of the ratio
        power = np.full(len(rows), POWER)
        out = np.where(used > 0, np.nan, np.inf)
        is_open = (used > 0) & (np.abs(height) > EXACT)
        out = np.where((used > 0) & ~is_open, 1.0, out)
        for _ in range(STEPS):
            own = np.flatnonzero(is_open)
            if not len(own):
                break
            furthest = np.log(LARGEST_STEP)
            step = np.clip(-height[own] / power[own], -furthest, furthest)
            at[own] += step
            known, values, _ = self.uses(rows[own], np.exp(at[own]))
            places = [known.index(names[column]) for column in columns[own]]
            with np.errstate(divide="ignore", invalid="ignore"):
                new = np.log(values[np.arange(len(own)), places])
                slope = (new - height[own]) / step
            power[own] = np.where(slope > POWER / 8, slope, power[own])
            height[own] = new
            done = np.abs(new) <= EXACT
            far = (at[own] > np.log(FARTHEST)) & (new < 0)
            out[own[done]] = np.exp(at[own[done]])
            out[own[far]] = np.inf
            is_open[own[done | far | np.isnan(new)]] = False
        return out


class _OfStudy(_Solver):
    """Solve rows of the design of a study."""

    def __init__(
        self,
        design: xr.Dataset,
        options: list[dict[str, Any]],
        group: np.ndarray,
        database: MaterialDatabase,
    ) -> None:
        bare = design.drop_vars(list(design.coords)).drop_attrs()
        self.cases = bare.assign_coords(case=np.arange(len(group)))
        self.options = options
        self.group = group
        self.database = database

    def solved(
        self, rows: np.ndarray, ratios: np.ndarray
    ) -> Iterator[tuple[np.ndarray, xr.Dataset]]:
        """Yield the results for each set of options."""
        for number, settings in enumerate(self.options):
            places = np.flatnonzero(self.group[rows] == number)
            if not len(places):
                continue
            part = self.cases.isel(case=rows[places])
            loaded = {name: part[name] * ratios[places] for name in FORCES}
            part = part.assign(loaded).assign_coords(case=np.arange(len(places)))
            part = part.assign_attrs(options=json.dumps(settings))
            yield places, solve_cases(part, self.database)

    def material(self, body: str, row: int) -> Any:
        """Return the name of the material of a body in a row."""
        return self.cases[f"{body}_material"].values[row]


class _OfCases(_Solver):
    """Solve cases that share their options."""

    def __init__(
        self, cases: list[Case], options: Mapping[str, Any], database: MaterialDatabase
    ) -> None:
        self.cases = cases
        self.options = options
        self.database = database

    def solved(
        self, rows: np.ndarray, ratios: np.ndarray
    ) -> Iterator[tuple[np.ndarray, xr.Dataset]]:
        """Yield all results at once."""
        loaded = []
        for row, ratio in zip(rows.tolist(), ratios.tolist(), strict=True):
            case = self.cases[row]
            forces = {name: ratio * float(getattr(case, name)) for name in FORCES}
            loaded.append(replace(case, **forces))
        yield np.arange(len(rows)), solve(loaded, database=self.database, **self.options)

    def material(self, body: str, row: int) -> Any:
        """Return the material of a body in a row."""
        return getattr(self.cases[row], f"{body}_material")
