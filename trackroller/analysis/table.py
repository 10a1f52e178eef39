"""A gathered study as one table of cases: factors, levels, valid cases, and what is held in a slice."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.analysis.columns import base_values, case_columns, factor_names
from trackroller.analysis.limits import Column, meeting, quantity_of
from trackroller.analysis.lives import FIRST_LIMIT, LIVES, body_lives, past_data
from trackroller.damage.pair import first_failure
from trackroller.methods import Design
from trackroller.parameters import BODIES, EXACTNESS, FIRST_TO_FAIL, PARAMETERS
from trackroller.study.design.levels import NAMED
from trackroller.study.file.config import StudyFile
from trackroller.study.file.goals import names_in
from trackroller.study.file.study import Study
from trackroller.study.outputs import Output, case_dims, of_fatigue

MOST_LEVELS = 12  # a factor with more levels is divided into classes
OUTSIDE = ("half_space", "yield", "static", "conformal", "steep_friction")  # flags of designs outside the model


@dataclass(frozen=True, eq=False)
class StudyResults:
    """A solved study, which analysis and report take.

    Parameters
    ----------
    study : Study
        The checked study.
    design : Design
        Its design, with the places of the rows and the groups of factors.
    data : xarray.Dataset
        The results, over the factors of a grid or along `case`.
    """

    study: Study
    design: Design
    data: xr.Dataset

    @property
    def config(self) -> StudyFile:
        """Return what the study file says."""
        return self.study.config

    @cached_property
    def dims(self) -> tuple[str, ...]:
        """Return the dimensions that count cases: `case`, or the factors of a grid in the order of the study file."""
        return case_dims(self.data, self.study.factors)

    @cached_property
    def allowed(self) -> np.ndarray | None:
        """Return the cases that meet the constraints of the study, shape (n,); None without constraints."""
        texts = self.config.constraints
        if not texts:
            return None
        values = {name: self.quantity(name)[0] for name in sorted({name for text in texts for name in names_in(text)})}
        rows = int(np.prod([self.data.sizes[d] for d in self.dims]))
        return np.asarray(np.all(list(meeting(texts, values, rows).values()), axis=0))

    def quantity(self, name: str) -> Column:
        """Return values (n,), units and words of a factor, parameter or output; see `limits.quantity_of`."""
        return quantity_of(self.data, self.dims, name, self.config.base, self.design.columns)

    def meets(self, target: str) -> np.ndarray:
        """Return the cases that meet a target of the study, shape (n,), whether they are valid or not."""
        values, ends = self.quantity(target)[0].astype(float), self.config.analysis.target[target]
        return np.asarray((values >= ends.get("min", -np.inf)) & (values <= ends.get("max", np.inf)))

    @property
    def unfinished(self) -> bool:
        """Return whether some cases of the study are not solved yet."""
        return "missing_cases" in self.data.attrs

    @cached_property
    def view(self) -> StudyView:
        """Return the table of cases, from which figures, sentences and the explorer are made."""
        return StudyView.of(self)


@dataclass(frozen=True)
class StudyView:
    """A study as a table.

    Attributes
    ----------
    table : one row a case; columns are the factors, `contact`- and `body`-resolved results with the suffixes `_1`,
        `_2`, `_roller`, `_guide` (the worse contact), and plain results
    factors : names of the factors
    base : values of the parameters that are no factors
    grid : whether every combination of levels is there
    attrs : attributes of the data set
    flags : names of the validity flags in the order of the bits of the columns `validity*`
    derived : factors that other parameters follow from
    study : the study file with its defaults
    met : cases that meet the constraints of the study, shape (n,) bool; None without constraints
    results : the solved study that the table was made from
    analysis : its sensitivity analysis, None without one
    """

    table: pd.DataFrame
    factors: tuple[str, ...]
    base: Mapping[str, Any]
    grid: bool
    attrs: Mapping[str, Any]
    flags: tuple[str, ...] = ()
    derived: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    study: Mapping[str, Any] = field(default_factory=dict)
    met: np.ndarray | None = None
    results: StudyResults | None = None
    analysis: xr.Dataset | None = None

    @classmethod
    def of(cls, results: StudyResults, analysis: xr.Dataset | None = None) -> StudyView:
        """Make the table of a solved study; an analysis without variables counts as no analysis."""
        ds, dims = results.data, list(results.dims)
        table = pd.DataFrame(case_columns(ds, dims))
        names = factor_names(ds, dims, results.design, table)
        base = base_values(ds, results.config.base)
        full = int(np.prod([table[f].nunique(dropna=False) for f in names], dtype=float)) if names else 1
        grid = full == len(table) and not (len(names) == 1 and dims == ["case"] and len(table) > 60)
        for name in dims:  # a dimension of one level is held by itself
            if name not in names and name in table and len(table):
                base[name] = table[name].iloc[0]
        derived = {
            p: tuple(d for d in map(str, ds[p].dims) if d in names or d == "case")
            for p in PARAMETERS
            if p in ds.variables and p in table and p not in names and table[p].nunique() > 1
        }
        flags = tuple(str(ds["validity"].attrs.get("flag_meanings", "")).split()) if "validity" in ds else ()
        described = dict(ds.attrs), flags, derived, results.study.as_dict(), results.allowed, results
        return cls(table, tuple(names), base, grid, *described).analysed(analysis)

    def analysed(self, analysis: xr.Dataset | None) -> StudyView:
        """Return the table with its analysis."""
        return replace(self, analysis=analysis if analysis is not None and analysis.data_vars else None)

    @property
    def solved(self) -> StudyResults:
        """Return the solved study that the table was made from; a table of a comparison has none."""
        if self.results is None:
            raise ValueError("this table was not made from a solved study")
        return self.results

    @property
    def data(self) -> xr.Dataset:
        """Return the data of the study."""
        return self.solved.data

    @property
    def dims(self) -> tuple[str, ...]:
        """Return the dimensions of the data that count cases."""
        return self.solved.dims

    def levels(self, name: str) -> list[Any]:
        """List the values of a factor.

        Numbers in rising order, categories in order of appearance.
        """
        if name not in self._levels:  # a page asks a dozen times for the levels of each factor
            values = self.table[name].dropna().unique()
            self._levels[name] = sorted(values.tolist()) if self.numeric(name) else list(values)
        return list(self._levels[name])

    @cached_property
    def _levels(self) -> dict[str, list[Any]]:
        return {}

    def numeric(self, name: str) -> bool:
        """Say whether the factor is a number."""
        return bool(np.issubdtype(np.asarray(self.table[name]).dtype, np.number))

    def ordered(self, name: str) -> bool:
        """Return whether the levels of a factor have an order.

        Materials, few drives and few curves have no order.
        """
        spoken = name in NAMED and len(self.levels(name)) <= MOST_LEVELS
        return self.numeric(name) and not spoken and bool(np.isfinite(self.table[name]).all())

    @cached_property
    def categories(self) -> tuple[str, ...]:
        """Return the factors without an order; every pooled statement must hold within each of their levels."""
        return tuple(f for f in self.factors if not self.ordered(f) and len(self.levels(f)) <= MOST_LEVELS)

    def behind(self, name: str) -> tuple[str, ...]:
        """Return the factors that decide a parameter.

        These are the parameter itself or the factors that it is computed from. A fixed parameter has no such factor.
        """
        return (name,) if name in self.factors else self.derived.get(name, ())

    def held_level(self, name: str) -> Any:
        """Return the level at which a factor is held.

        It is the level of the base case, or the middle level if the base case has none. Contact models are held at the
        most exact model.
        """
        levels = self.levels(name)
        if name == "contact_model":
            return next((model for model in EXACTNESS if model in levels), levels[0])
        base = self.base.get(name)
        if base is not None and base in levels:
            return base
        return levels[len(levels) // 2] if self.numeric(name) else levels[0]

    def hold(self, shown: tuple[str, ...]) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Return the rows with every factor outside `shown` at its held level, and these levels by factor.

        A sampled study has no such rows: there the whole table comes back, and no factor is held.
        """
        held = {f: self.held_level(f) for f in self.factors if f not in shown} if self.grid else {}
        rows = self.table
        for name, level in held.items():
            rows = rows[rows[name] == level]
        return rows, held

    @cached_property
    def life(self) -> tuple[str, str, str] | None:
        """Return the column, wording and unit of the life to show, or None when the study has no life.

        It is the life to the first limit if the study asks for limits. Otherwise it is the life of the pair where the
        hours of the guide are known in a case, and that of the roller where they are not.
        """
        for column, words, unit in (FIRST_LIMIT, *self.fatigue_lives):
            if column in self.table and (self.table[column] > 0).any():
                return column, words, unit
        return None

    @property
    def fatigue_lives(self) -> tuple[tuple[str, str, str], ...]:
        """Return columns, wordings and units of lives by the S-N curve; the pair needs the hours of the guide."""
        return LIVES[0 if self.has("guide_life_hours") else 1 :]

    @cached_property
    def limits(self) -> tuple[str, ...]:
        """Return the names of the limits by their numbers in the columns `limiting_mechanism_`."""
        known = self.results is not None and "limiting_mechanism" in self.data
        return tuple(self.data["limiting_mechanism"].attrs["flag_meanings"].split()) if known else ()

    @cached_property
    def regime(self) -> np.ndarray:
        """Return the regime of every case, shape (n,); 0 (rolling) where the data set has none."""
        return self.column("regime", 0.0)

    def column(self, name: str, missing: float = np.nan) -> np.ndarray:
        """Return a column of numbers, shape (n,).

        `missing` everywhere if the study has no such result.
        """
        if name not in self.table:
            return np.full(len(self.table), missing)
        return self.table[name].to_numpy(dtype=float)

    def material(self, body: str) -> np.ndarray:
        """Return the name of the material of a body in every case, shape (n,)."""
        if "material_pair" in self.table:
            return self.table["material_pair"].str.split(" / ").str[BODIES.index(body)].to_numpy(dtype=str)
        name = f"{body}_material"
        given = self.table.get(name, pd.Series(str(self.base.get(name, "")), self.table.index))
        return given.to_numpy(dtype=str)

    def flagged(self, flag: str, body: str = "") -> np.ndarray:
        """Mark the cases that carry a validity flag, shape (n,).

        With `body` only where it holds for this body. No case carries a flag that the data set does not know.
        """
        if flag not in self.flags:
            return np.zeros(len(self.table), dtype=bool)
        name = f"validity_{body}" if body else "validity"
        bit = 1 << self.flags.index(flag)
        return np.asarray((np.nan_to_num(self.column(name, 0.0)).astype(np.int64) & bit) != 0)

    @property
    def by_body(self) -> bool:
        """Return whether the flags are known for each body."""
        return all(f"validity_{body}" in self.table for body in BODIES)

    @cached_property
    def rolling(self) -> np.ndarray:
        """Return the cases that roll and converged, shape (n,)."""
        return np.asarray((self.regime == 0) & (self.column("converged", 1.0) == 1))

    @cached_property
    def inside(self) -> np.ndarray:
        """Return the cases that roll, converged, and carry no flag of a design outside the model, shape (n,)."""
        return np.asarray(self.rolling & ~np.any([self.flagged(flag) for flag in OUTSIDE], axis=0))

    @cached_property
    def valid(self) -> np.ndarray:
        """Return the cases inside the model that meet the constraints of the study, shape (n,)."""
        return self.inside if self.met is None else self.inside & self.met

    def first_failing(self, goal: str) -> np.ndarray:
        """Return the number in `FIRST_TO_FAIL` of the body that fails first in every case, shape (n,).

        Parameters
        ----------
        goal : a life of the pair: by the S-N curve, or to the first limit
        """
        if goal != FIRST_LIMIT[0]:
            return self.column("first_to_fail", FIRST_TO_FAIL.index("unknown"))
        return first_failure(*(self.column(name) for name in body_lives(goal).values()))[1]

    def beyond_data(self, column: str) -> np.ndarray:
        """Mark the cases in which a life lies beyond the S-N data, shape (n,); no case for another quantity.

        The body stays below its fatigue limit, or lasts more than `DATA_END` overrollings. For the pair the body that
        fails first counts, or the roller where no body is known to fail first.

        Parameters
        ----------
        column : a life, such as `pair_life_hours` or `life_cycles_guide`
        """
        if "life" not in column or "wear" in column:
            return np.zeros(len(self.table), dtype=bool)
        if not any(body in column for body in BODIES):
            guide = self.first_failing(column) == FIRST_TO_FAIL.index("guide")
            own = body_lives(column)
            return np.where(guide, *(self.beyond_data(own[body]) for body in ("guide", "roller")))
        body = "guide" if "guide" in column else "roller"
        if "first_limit" in column:
            fatigue = self.column(f"limiting_mechanism_{body}") == self.limits.index("fatigue")
            rate = self.column(f"life_cycles_{body}") / self.column(f"{body}_life_hours")  # overrollings an hour
            by_fatigue = fatigue & self.beyond_data(f"{body}_life_hours")
            return np.asarray(by_fatigue | past_data(self.column(column) * rate))
        names = pd.Series(self.material(body))
        stored = json.loads(str(self.attrs.get("materials", "{}")))
        knees = {n: float(stored.get(n, {}).get("cycles_at_fatigue_limit", np.inf)) for n in names.unique()}
        endless = np.isposinf(self.column(f"{body}_life_hours"))
        return past_data(self.column(f"life_cycles_{body}"), names.map(knees).to_numpy(dtype=float)) | endless

    def with_breaks(self, column: Output) -> np.ndarray:
        """Return the values of an output, shape (n,); a fatigue life of a body above its tensile strength counts as 0.

        The results state no life there. A statistic over the cases must not leave out those that fail at once.
        """
        if not of_fatigue(column.name):
            return column.values
        body = next((body for body in BODIES if body in column.name and self.by_body), "")
        counted = self.rolling if self.met is None else self.rolling & self.met
        return np.where(counted & self.flagged("static", body), 0.0, column.values)

    def has(self, *columns: str) -> bool:
        """Say whether these columns are there with at least one number in each."""
        return all(c in self.table and np.isfinite(self.table[c]).any() for c in columns)
