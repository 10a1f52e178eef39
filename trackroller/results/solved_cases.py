"""The solved cases of a study: their data, one row a case, and which of them are valid."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.damage.pair import first_failure
from trackroller.methods import Design
from trackroller.parameters import (
    BODIES,
    EXACTNESS,
    FIRST_TO_FAIL,
    PARAMETERS,
    ROLE_OF,
    expressions,
)
from trackroller.results.case_columns import base_values, case_columns, codes, factor_names
from trackroller.results.constraints import Column, meeting, quantity_of
from trackroller.results.factor_levels import MOST_LEVELS, levels, numeric, ordered
from trackroller.results.life_columns import BESIDE, FIRST_LIMIT, LIVES, OF_PAIR, body_lives
from trackroller.results.own_outputs import with_own_outputs
from trackroller.roller.output_names import body_of
from trackroller.study.design.factor_names import CASE_FIELDS, OPTION_FACTORS
from trackroller.study.design.roles import roles_of
from trackroller.study.file.config import StudyFile
from trackroller.study.file.goals import names_in
from trackroller.study.file.study import Study
from trackroller.study.outputs import Output, case_dims, flat, of_fatigue, of_first_limit

Made = TypeVar("Made")
SAME_ENDS = 1e-6  # relative difference of the two ends of a life below which it is one number
# flags of designs outside the model
OUTSIDE = ("half_space", "yield", "static", "conformal", "steep_friction")


@dataclass(frozen=True, eq=False)
class SolvedCases:
    """The solved cases of a study: their data, one row a case, and which of them are valid.

    Every analysis takes them. A user holds `trackroller.results.results.Results`, which adds the
    analyses.

    Parameters
    ----------
    study : Study
        The checked study; `config` is what its file says.
    design : Design
        The rows of the design with their places and the groups of factors, as they were drawn.
    data : xarray.Dataset
        The results, over the factors of a grid or along `case`. An input that varies is a
        coordinate; one that all cases share is an attribute, such as `axis_distance`, with its unit
        beside it (`axis_distance_units`), NaN where no case gives it.
    known_indices : xarray.Dataset, optional
        Sensitivity indices that were computed before. A data set without variables stands for a
        study that has none. By default they are computed when they are needed.
    materials_file : Path, optional
        Materials file of the study as its folder keeps it, with the fits of its materials beside
        it. By default the user's.
    """

    study: Study
    design: Design
    data: xr.Dataset
    known_indices: xr.Dataset | None = field(default=None, repr=False)
    materials_file: Path | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        """Add the study's own outputs to the data."""
        if self.config.own:
            object.__setattr__(self, "data", with_own_outputs(self.study, self.data))

    @property
    def config(self) -> StudyFile:
        """Return what the study file says."""
        return self.study.config

    @property
    def unfinished(self) -> bool:
        """Return whether some cases of the study are not solved yet."""
        return "missing_cases" in self.data.attrs

    @cached_property
    def by_function(self) -> dict[Any, Any]:
        """Return what functions with `made_once` made of these cases, by the function and its
        further arguments.
        """
        return {}

    @cached_property
    def dims(self) -> tuple[str, ...]:
        """Return the dimensions that count cases: `case`, or the factors of a grid in the order of
        the study file.
        """
        return case_dims(self.data, self.study.factors)

    @cached_property
    def table(self) -> pd.DataFrame:
        """Return one row a case: factors, inputs that vary, and results.

        Results by contact and body have the suffixes `_1`, `_2`, `_roller`, `_guide`; a body counts
        at its worse contact.
        """
        own = {name: flat(self.data, name, self.dims) for name in self.config.own}
        return pd.DataFrame(case_columns(self.data, self.dims) | own)

    @cached_property
    def factors(self) -> tuple[str, ...]:
        """Return the names of the factors that vary."""
        return tuple(factor_names(self.data, self.dims, self.design, self.table))

    @cached_property
    def roles(self) -> dict[str, str]:
        """Return the role of each factor that varies: `choice` of the designer, or `condition` of
        the use.

        A label of its own for each row of several designs, such as the number of a drawing, has no
        role.
        """
        given = self.config.roles
        roles = roles_of(self.factors, self.study.parsed, given, self.config.method.name)
        labels = [n for n in self.labels if n not in given]
        known = {
            role: [n for n in roles if n not in labels and roles[n] == role]
            for role in ("choice", "condition")
        }
        of_label = {n: _role_of_label(self.table, n, known) for n in labels}
        return {n: role for n in roles if (role := of_label.get(n, roles[n]))}

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """Return the columns of a table that change no case: they are no parameter, and no
        expression uses them.
        """
        if not self.config.method.observed:
            return ()
        texts = [own.text for own in self.study.parsed.values() if own.text]
        used = {name for text in texts for name in expressions.names(text, "factors")}
        return tuple(
            n
            for n in self.factors
            if n not in ROLE_OF and n not in OPTION_FACTORS and n not in used
        )

    @cached_property
    def goods(self) -> tuple[str, ...]:
        """Return the columns of the user's own in the shelves of the study, such as the price of a
        roller.
        """
        return tuple(
            n for n in self.study.columns_of_shelves if n not in CASE_FIELDS and n in self.table
        )

    @cached_property
    def grid(self) -> bool:
        """Return whether every combination of levels is there."""
        names = self.factors
        rows = len(self.table)
        full = 1
        if names:
            full = int(np.prod([self.table[f].nunique(dropna=False) for f in names], dtype=float))
        return full == rows and not (len(names) == 1 and self.dims == ("case",) and rows > 60)

    @cached_property
    def base(self) -> dict[str, Any]:
        """Return the values of the parameters that are no factors."""
        base = base_values(self.data, self.config.base)
        for name in self.dims:  # a dimension of one level is held by itself
            if name not in self.factors and name in self.table and len(self.table):
                base[name] = self.table[name].iloc[0]
        return base

    @cached_property
    def derived(self) -> dict[str, tuple[str, ...]]:
        """Return the parameters that are computed from factors, each with these factors."""
        ds = self.data
        table = self.table
        return {
            p: tuple(d for d in map(str, ds[p].dims) if d in self.factors or d == "case")
            for p in PARAMETERS
            if p in ds.variables and p in table and p not in self.factors and table[p].nunique() > 1
        }

    @cached_property
    def flags(self) -> tuple[str, ...]:
        """Return the names of the validity flags in the order of the bits of the columns
        `validity`.
        """
        known = "validity" in self.data
        if known:
            return tuple(str(self.data["validity"].attrs.get("flag_meanings", "")).split())
        return ()

    @cached_property
    def limits(self) -> tuple[str, ...]:
        """Return the names of the limits by their numbers in the columns `limiting_mechanism_`."""
        known = "limiting_mechanism" in self.data
        if known:
            return tuple(self.data["limiting_mechanism"].attrs["flag_meanings"].split())
        return ()

    @cached_property
    def goals(self) -> dict[str, str]:
        """Return the goals of the key `pareto`, each `min` or `max`, otherwise the usual ones.

        A single goal ranks what meets the requirement, see `trackroller.results.decide`; it has no
        front.

        The usual goals are the longest life of the pair, and the lowest friction power, friction
        energy or contact pressure. The mapping is empty if the study lacks one of the two.
        """
        given = dict(self.config.pareto)
        if len(given) > 1:
            return given
        return _usual_goals(self.data)

    def quantity(self, name: str) -> Column:
        """Return values (n,), units and words of a factor, parameter or output; see
        `constraints.quantity_of`.
        """
        return quantity_of(self.data, self.dims, name, self.config.base, self.design.columns)

    def levels(self, name: str) -> list[Any]:
        """List the values of a factor.

        Numbers in rising order, categories in order of appearance.
        """
        if name not in self._levels:  # a page asks a dozen times for the levels of each factor
            self._levels[name] = levels(self.table[name])
        return list(self._levels[name])

    @cached_property
    def _levels(self) -> dict[str, list[Any]]:
        return {}

    def numeric(self, name: str) -> bool:
        """Say whether the factor is a number."""
        return numeric(self.table[name])

    def ordered(self, name: str) -> bool:
        """Return whether the levels of a factor have an order.

        Materials, few drives and few curves have no order.
        """
        return ordered(self.table[name])

    @cached_property
    def categories(self) -> tuple[str, ...]:
        """Return the factors without an order; every pooled statement must hold within each of
        their levels.
        """
        return tuple(
            f for f in self.factors if not self.ordered(f) and len(self.levels(f)) <= MOST_LEVELS
        )

    def behind(self, name: str) -> tuple[str, ...]:
        """Return the factors that decide a parameter.

        These are the parameter itself or the factors that it is computed from. A fixed parameter
        has no such factor.
        """
        if name in self.factors:
            return (name,)
        return self.derived.get(name, ())

    def of_one_model(self, rows: np.ndarray | None = None) -> np.ndarray:
        """Return some rows, or all, without those of another level of an option than `held_level`,
        shape (n,) bool.
        """
        if rows is None:
            counted = np.ones(len(self.table), dtype=bool)
        else:
            counted = rows.copy()
        for option in (n for n in self.factors if n in OPTION_FACTORS):
            counted &= (self.table[option] == self.held_level(option)).to_numpy()
        return counted

    def held_level(self, name: str) -> Any:
        """Return the level at which a factor is held.

        It is the level of the base case, or the middle level if the base case has none. Contact
        models are held at the most exact model.
        """
        levels = self.levels(name)
        if name == "contact_model":
            return next((model for model in EXACTNESS if model in levels), levels[0])
        base = self.base.get(name)
        if base is not None and base in levels:
            return base
        if self.numeric(name):
            return levels[len(levels) // 2]
        return levels[0]

    def hold(self, shown: tuple[str, ...]) -> tuple[pd.DataFrame, dict[str, Any]]:
        """Return the rows with every factor outside `shown` at its held level, and these levels by
        factor.

        A sampled study has no such rows: there only the options of the calculation are held, such
        as the contact model.
        """
        names = self.factors
        if not self.grid:
            names = tuple(f for f in self.factors if f in OPTION_FACTORS)
        levels = {f: self.held_level(f) for f in names if f not in shown}
        rows = self.table
        for name, level in levels.items():
            rows = rows[rows[name] == level]
        return rows, levels

    @cached_property
    def life(self) -> tuple[str, str, str] | None:
        """Return the column, wording and unit of the life to show, or None when the study has no
        life.

        It is the life to the first limit if the study asks for limits. Otherwise it is the life of
        the pair where the hours of the guide are known in a case, and that of the roller where they
        are not.
        """
        for column, words, unit in (FIRST_LIMIT, *self.fatigue_lives):
            if column in self.table and (self.table[column] > 0).any():
                return column, words, unit
        return None

    @property
    def fatigue_lives(self) -> tuple[tuple[str, str, str], ...]:
        """Return columns, wordings and units of lives by the S-N curve; the pair needs the hours of
        the guide.
        """
        if self.knows("guide_life_hours"):
            return LIVES
        return LIVES[1:]

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
            # a study has few pairs in many cases
            number, pairs = pd.factorize(self.table["material_pair"], use_na_sentinel=False)
            names = pd.Series(pairs).str.split(" / ").str[BODIES.index(body)]
            return names.to_numpy(dtype=str)[number]
        name = f"{body}_material"
        given = self.table.get(name, pd.Series(str(self.base.get(name, "")), self.table.index))
        return given.to_numpy(dtype=str)

    def flagged(self, flag: str, body: str = "") -> np.ndarray:
        """Mark the cases that carry a validity flag, shape (n,).

        With `body` only where it holds for this body. No case carries a flag that the data set does
        not know.
        """
        if flag not in self.flags:
            return np.zeros(len(self.table), dtype=bool)
        name = "validity"
        if body and self.by_body:
            name = f"validity_{body}"
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
        """Return the cases that roll, converged, and carry no flag of a design outside the model,
        shape (n,).
        """
        return np.asarray(self.rolling & ~np.any([self.flagged(flag) for flag in OUTSIDE], axis=0))

    @cached_property
    def allowed(self) -> np.ndarray | None:
        """Return the cases that meet the constraints of the study, shape (n,); None without
        constraints.
        """
        texts = self.config.constraints
        if not texts:
            return None
        values = {
            name: self.constrained(name)
            for name in sorted({name for text in texts for name in names_in(text)})
        }
        rows = int(np.prod([self.data.sizes[d] for d in self.dims]))
        return np.asarray(np.all(list(meeting(texts, values, rows).values()), axis=0))

    def constrained(self, name: str) -> np.ndarray:
        """Return the values of a quantity that a constraint compares, shape (n,): of a life in a
        range the low end.
        """
        if name != FIRST_LIMIT[0] or name not in self.data:
            return self.quantity(name)[0]
        return self.sure_life

    @cached_property
    def counted(self) -> np.ndarray:
        """Return the cases that roll, converged, and meet the constraints of the study, shape
        (n,).
        """
        counted: np.ndarray = self.rolling
        if self.allowed is not None:
            counted = counted & self.allowed
        return counted

    @cached_property
    def without_fatigue(self) -> np.ndarray:
        """Return the cases without a life by fatigue that other materials have for the same body,
        shape (n,).

        Their life to the first limit is one by fewer limits, and compares with no other.
        """
        out = np.zeros(len(self.table), dtype=bool)
        if FIRST_LIMIT[0] not in self.table or "fatigue" not in self.data["limit"].values:
            return out
        # (n, body)
        known = ~np.isnan(flat(self.data.sel(limit="fatigue"), "life_hours_by_limit", self.dims))
        for i, body in enumerate(BODIES):
            of = self.material(body)
            rows = self.inside
            if known[rows, i].any():
                never = [
                    name for name in np.unique(of[rows]) if not known[rows & (of == name), i].any()
                ]
                out |= rows & np.isin(of, never)
        return out

    @cached_property
    def valid(self) -> np.ndarray:
        """Return the cases inside the model that meet the constraints of the study, shape (n,).

        Cases whose life by fatigue is not known where that of other materials is are left out.
        """
        return np.asarray(self.inside & self.counted & ~self.without_fatigue)

    def limits_in(self, state: str) -> dict[str, np.ndarray]:
        """Return the cases in which each checked limit is `exceeded` or `open`, shape (n,)
        by limit.

        Limits that are second models of an end which another limit has are left out.
        """
        if "limit_state" not in self.data:
            return {}
        words = str(self.data["limit_state"].attrs["flag_meanings"]).split()
        # of (n, limit, body)
        hit = (flat(self.data, "limit_state", self.dims) == words.index(state)).any(axis=2)
        return {
            name: hit[:, i]
            for i, name in enumerate(self.data["limit"].values.tolist())
            if name not in BESIDE
        }

    def any_limit_in(self, state: str) -> np.ndarray:
        """Return the cases in which any of these limits is `exceeded` or `open`, shape (n,)."""
        return np.asarray(
            np.any([np.zeros(len(self.table), dtype=bool), *self.limits_in(state).values()], axis=0)
        )

    @cached_property
    def holds(self) -> np.ndarray:
        """Return the valid cases that exceed no limit on values that were given, shape (n,)."""
        return np.asarray(self.valid & ~self.any_limit_in("exceeded"))

    def meets(self, target: str) -> np.ndarray:
        """Return the cases that meet a target of the study, shape (n,), whether they are valid or
        not.

        A life that is a range has to meet it with its low end.
        """
        judged = self.judged_targets
        if target in judged:
            values = judged[target]
        else:
            values = self.quantity(target)[0].astype(float)
        return self.config.requirement[target].meets(values)

    @cached_property
    def judged_targets(self) -> dict[str, np.ndarray]:
        """Return the life that judges a target on the life of a pair, shape (n,) each [h].

        It is the low end of the life to the first limit, as in the answer: a longer life by one
        limit is of no use if another limit comes first. Other targets are judged by the result that
        they name, and so are all of a study without the life to the first limit.
        """
        if self.life != FIRST_LIMIT:
            return {}
        named = [
            n for n, ends in self.config.requirement.items() if n in OF_PAIR and ends.only_least
        ]
        return dict.fromkeys(named, self.sure_life)

    @cached_property
    def sure_life(self) -> np.ndarray:
        """Return the low end of the life to the first limit, shape (n,) [h]; the life itself where
        it has no range.
        """
        name = FIRST_LIMIT[0]
        value = self.column(name)
        low = value
        if f"{name}_low" in self.data:
            low = self.quantity(f"{name}_low")[0].astype(float)
        return np.where(np.isnan(low), value, low)

    def ended_by_fatigue(self, body: str = "roller") -> np.ndarray:
        """Return the cases in which fatigue is the first limit of a body, shape (n,), so that its
        material scatters.
        """
        name = f"limiting_mechanism_{body}"
        if name not in self.table:
            return np.asarray(True)
        return np.asarray(self.column(name) == self.limits.index("fatigue"))

    @cached_property
    def ranged(self) -> bool:
        """Return whether a life to the first limit of a valid case is a range, by placeholders or
        bounds of wear.
        """
        ends = [f"{FIRST_LIMIT[0]}{end}" for end in ("_low", "_high")]
        if self.life != FIRST_LIMIT or not all(end in self.data for end in ends):
            return False
        low, high = (self.quantity(end)[0].astype(float) for end in ends)
        return bool((self.valid & (high > low * (1 + SAME_ENDS))).any())

    def first_failing(self, goal: str) -> np.ndarray:
        """Return the number in `FIRST_TO_FAIL` of the body that fails first in every case, shape
        (n,).

        Parameters
        ----------
        goal : a life of the pair: by the S-N curve, or to the first limit
        """
        if goal != FIRST_LIMIT[0]:
            return self.column("first_to_fail", FIRST_TO_FAIL.index("unknown"))
        return first_failure(*(self.column(name) for name in body_lives(goal).values()))[1]

    def with_breaks(self, column: Output) -> np.ndarray:
        """Return the values of an output, shape (n,), with 0 for a life that does not hold.

        A fatigue life of a body above its tensile strength, of which the results state no life, and
        the life of a case that exceeds a limit. A statistic over the cases must not leave out those
        that fail at once.
        """
        if of_first_limit(column.name):
            return np.where(self.valid & ~self.holds, 0.0, column.values)
        if not of_fatigue(column.name):
            return column.values
        body = ""
        if self.by_body:
            body = body_of(column.name)
        return np.where(self.counted & self.flagged("static", body), 0.0, column.values)

    def knows(self, column: str) -> bool:
        """Say whether a column is there with at least one number, or a life without an end."""
        return bool(column in self.table and self.table[column].notna().any())

    def has(self, *columns: str) -> bool:
        """Say whether these columns are there with at least one number in each."""
        return all(c in self.table and np.isfinite(self.table[c]).any() for c in columns)


def made_once(function: Callable[..., Made]) -> Callable[..., Made]:
    """Keep what a function makes of solved cases beside them, because a page asks for it several
    times.

    Parameters
    ----------
    function : callable
        Takes `SolvedCases`, and further arguments that can be keys of a dictionary.
    """

    @functools.wraps(function)
    def once(results: SolvedCases, *arguments: Any) -> Made:
        key = (function, *arguments)
        if key not in results.by_function:
            results.by_function[key] = function(results, *arguments)
        result: Made = results.by_function[key]
        return result

    return once


def _role_of_label(table: pd.DataFrame, label: str, known: Mapping[str, list[str]]) -> str:
    """Return the role of a column of a table that changes no case; '' for the number of each row of
    several designs.

    It names conditions, such as the block of a measured load, if all rows are of one design, or if
    rows of the same conditions share their label and rows of the same design do not. Otherwise it
    names designs.

    Parameters
    ----------
    table : one row a case
    label : name of the column
    known : names of the other columns by their role
    """
    places = {role: codes(table, names) for role, names in known.items()}
    if table[label].nunique() == len(table):
        if not places["choice"].any():
            return "condition"
        return ""
    decides = {
        role: table.groupby(place)[label].nunique().max() == 1 for role, place in places.items()
    }
    if decides["condition"] and not decides["choice"]:
        return "condition"
    return "choice"


def _usual_goals(ds: xr.Dataset) -> dict[str, str]:
    """Return the longest life and the lowest friction or pressure, each `max` or `min`; empty if
    one is missing.
    """
    goals: dict[str, str] = {}
    known = "guide_life_hours" in ds and not bool(ds["guide_life_hours"].isnull().all())
    # of the pair where the guide's hours are known
    lives = ["pair_life_to_first_limit_hours", "roller_life_hours"]
    if known:
        lives.insert(1, "pair_life_hours")
    lives = [n for n in lives if n in ds and np.isfinite(ds[n]).any()]
    if lives:
        goals[lives[0]] = "max"
    elif "life_cycles" in ds:
        goals["life_cycles_roller"] = "max"
    for name in ("friction_power", "friction_energy_per_distance", "max_pressure"):
        if name in ds and len(goals) == 1:
            goals[name] = "min"
    if len(goals) == 2:
        return goals
    return {}
