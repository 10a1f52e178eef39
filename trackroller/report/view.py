"""A gathered study as one table of cases: factors, levels, valid cases, and what is held in a slice."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.parameters import EXACTNESS, PARAMETERS
from trackroller.report.numbers import SPOKEN, setting
from trackroller.study.outputs import read_study

INNER = ("contact", "body", "y", "x", "n", "section_x", "section_y", "section_z", "component")
CATEGORIES = ("material_pair", "roller_material", "guide_material")
CONTACT_RESULTS = (
    "normal_force",
    "lateral_force",
    "driving_force",
    "spin_moment",
    "max_pressure",
    "semi_axis_lateral",
    "semi_axis_rolling",
    "friction_power",
    "friction_energy_per_distance",
)
BODY_RESULTS = ("peak_stress", "peak_z", "life_cycles", "error_estimate")
PLAIN_RESULTS = (
    "regime",
    "validity",
    "converged",
    "roller_life_hours",
    "guide_life_hours",
    "slip",
    "stopped",
    "energy_residual",
    "contact_model_used",
)
LIVES = (
    ("roller_life_hours", "life of the roller", "h"),
    ("guide_life_hours", "life of the guide", "h"),
    ("life_cycles_roller", "life of the roller", "overrollings"),
    ("life_cycles_guide", "life of the guide", "overrollings"),
)
BODIES = ("roller", "guide")
SURFACE_SHARE = 0.01  # a peak above 1 % of the smaller semi-axis counts as lying at the surface
MOST_LEVELS = 12  # a factor with more levels is looked at in classes
OUTSIDE = ("half_space", "yield", "static", "conformal", "steep_friction")  # flags of designs outside the model


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
    flags : meaning of each validity flag; the order gives the bits of the columns `validity*`
    derived : factors that other parameters follow from
    study : the study file with its defaults
    """

    table: pd.DataFrame
    factors: tuple[str, ...]
    base: Mapping[str, Any]
    grid: bool
    attrs: Mapping[str, Any]
    flags: Mapping[str, str] = field(default_factory=dict)
    derived: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    study: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, ds: xr.Dataset) -> StudyView:
        """Make the table of a gathered study (grid dimensions or one dimension `case`)."""
        dims = [str(d) for d in ds.dims if d not in INNER and ds[_any_with(ds, str(d))].ndim]
        dims = [d for d in dims if d == "case" or d in ds.coords or d in PARAMETERS]
        table = pd.DataFrame(_case_columns(ds, dims))
        names = _factor_names(ds, dims, table)
        base = _base_values(ds)
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
        return cls(table, tuple(names), base, grid, dict(ds.attrs), _flags(ds), derived, read_study(ds))

    def levels(self, name: str, table: pd.DataFrame | None = None) -> list[Any]:
        """List the values of a factor.

        Numbers in rising order, categories in order of appearance.
        """
        values = (self.table if table is None else table)[name].dropna().unique()
        return sorted(values.tolist()) if self.numeric(name) else list(values)

    def numeric(self, name: str) -> bool:
        """Say whether the factor is a number."""
        return bool(np.issubdtype(np.asarray(self.table[name]).dtype, np.number))

    def ordered(self, name: str) -> bool:
        """Say whether more of the factor means something.

        Not for materials, nor for a few drives or curves.
        """
        spoken = name in SPOKEN and len(self.levels(name)) <= MOST_LEVELS
        return self.numeric(name) and not spoken and bool(np.isfinite(self.table[name]).all())

    @cached_property
    def categories(self) -> tuple[str, ...]:
        """Factors without an order, by whose levels alone every pooled statement must hold as well."""
        return tuple(f for f in self.factors if not self.ordered(f) and len(self.levels(f)) <= MOST_LEVELS)

    def behind(self, name: str) -> tuple[str, ...]:
        """Name the factors that decide a parameter.

        Itself, those it is computed from, or none when it is fixed.
        """
        return (name,) if name in self.factors else self.derived.get(name, ())

    def held_level(self, name: str) -> Any:
        """Return the level at which a factor is held.

        That of the base case, else the middle one.

        Of contact models it is the most exact one.
        """
        levels = self.levels(name)
        if name == "contact_model":
            return next((model for model in EXACTNESS if model in levels), levels[0])
        base = self.base.get(name)
        if base is not None and base in levels:
            return base
        return levels[len(levels) // 2] if self.numeric(name) else levels[0]

    def hold(self, shown: tuple[str, ...]) -> tuple[pd.DataFrame, str]:
        """Return the rows with every factor outside `shown` at its held level, and the sentence that says so.

        A sampled study has no such rows: there the whole table comes back.
        """
        others = [f for f in self.factors if f not in shown]
        if not self.grid:
            return self.table, ""
        rows, said = self.table, []
        for name in others:
            level = self.held_level(name)
            rows = rows[rows[name] == level]
            said.append(setting(name, level))
        return rows, f"Held: {'; '.join(said)}." if said else ""

    @cached_property
    def life(self) -> tuple[str, str, str] | None:
        """Column, wording and unit of the life to show, or None when the study has no life."""
        for column, words, unit in LIVES:
            if column in self.table and (self.table[column] > 0).any():
                return column, words, unit
        return None

    @cached_property
    def regime(self) -> np.ndarray:
        """Regime of every case, shape (n,); 0 (rolling) where the data set has none."""
        return self.column("regime", 0.0)

    def column(self, name: str, missing: float = np.nan) -> np.ndarray:
        """Return a column of numbers, shape (n,).

        `missing` everywhere if the study has no such result.
        """
        if name not in self.table:
            return np.full(len(self.table), missing)
        return self.table[name].to_numpy(dtype=float)

    def flagged(self, flag: str, body: str = "") -> np.ndarray:
        """Mark the cases that carry a validity flag, shape (n,).

        With `body` only where it holds for this body.
        """
        name = f"validity_{body}" if body else "validity"
        bit = 1 << list(self.flags).index(flag)
        return (np.nan_to_num(self.column(name, 0.0)).astype(np.int64) & bit) != 0

    @property
    def by_body(self) -> bool:
        """Whether the flags are known for each body."""
        return all(f"validity_{body}" in self.table for body in BODIES)

    @cached_property
    def rolling(self) -> np.ndarray:
        """Cases that roll and converged, shape (n,)."""
        return (self.regime == 0) & (self.column("converged", 1.0) == 1)

    @cached_property
    def valid(self) -> np.ndarray:
        """Cases that roll, converged, and carry no flag of a design outside the model, shape (n,)."""
        outside = np.zeros(len(self.table), dtype=bool)
        for flag in OUTSIDE:
            if flag in self.flags:
                outside |= self.flagged(flag)
        return self.rolling & ~outside

    def has(self, *columns: str) -> bool:
        """Say whether these columns are there with at least one number in each."""
        return all(c in self.table and np.isfinite(self.table[c]).any() for c in columns)


def _flags(ds: xr.Dataset) -> dict[str, str]:
    """Names of the validity flags with their meanings; a name that the comment does not explain has none."""
    if "validity" not in ds:
        return {}
    attrs = ds["validity"].attrs
    names, comment = str(attrs.get("flag_meanings", "")).split(), str(attrs.get("comment", ""))
    starts = sorted((at, n) for n in names if (at := f"; {comment}".find(f"; {n}: ")) >= 0)
    ends = [*(at for at, _ in starts[1:]), len(comment) + 2]
    found = {n: f"; {comment}"[at + len(n) + 4 : end] for (at, n), end in zip(starts, ends, strict=False)}
    return {n: found.get(n, "") for n in names}


def _any_with(ds: xr.Dataset, dim: str) -> str:
    return next(str(n) for n, v in ds.variables.items() if dim in v.dims)


def _case_columns(ds: xr.Dataset, dims: list[str]) -> dict[str, np.ndarray]:
    """Every wanted quantity flattened over `dims` in one common order."""
    columns: dict[str, np.ndarray] = {}
    sizes = tuple(ds.sizes[d] for d in dims)

    def flat(da: xr.DataArray) -> np.ndarray:
        missing = [d for d in dims if d not in da.dims]
        values = da.expand_dims({d: ds.sizes[d] for d in missing}).transpose(*dims).values
        values = np.broadcast_to(values, sizes).reshape(-1)
        return values.astype(str) if values.dtype.kind in "OSU" else values.astype(float)

    case_names = [
        n
        for n, v in ds.variables.items()
        if v.dims == ("case",) and n not in ("case", "reason") and n not in ds.data_vars
    ]
    wanted = [*(d for d in dims if d != "case"), *case_names, *PARAMETERS, *CATEGORIES, *PLAIN_RESULTS]
    for name in dict.fromkeys(map(str, wanted)):
        if name in ds.variables and ds[name].ndim and set(ds[name].dims) <= set(dims):
            columns[name] = flat(ds[name])
    for name in CONTACT_RESULTS:
        if name in ds and "contact" in ds[name].dims:
            for i in range(ds.sizes["contact"]):
                columns[f"{name}_{i + 1}"] = flat(ds[name].isel(contact=i))
    if "validity_body" in ds:
        for i, body in enumerate(map(str, ds["body"].values)):
            columns[f"validity_{body}"] = flat(ds["validity_body"].isel(body=i))
    return columns | dict(_body_columns(ds, flat))


def _body_columns(ds: xr.Dataset, flat: Any) -> Iterator[tuple[str, np.ndarray]]:
    """Peak (with its depth and contact) and life of the worse contact of each body; fit and where it peaks."""
    if "body" not in ds.dims or "contact" not in ds.dims:
        return
    for i, body in enumerate(map(str, ds["body"].values)):
        parts = {
            n: np.stack([flat(ds[n].isel(body=i, contact=c)) for c in range(ds.sizes["contact"])])
            for n in BODY_RESULTS
            if n in ds and {"contact", "body"} <= set(ds[n].dims)
        }
        if "peak_stress" in parts:
            peak = parts["peak_stress"]
            worse = np.argmax(np.where(np.isnan(peak), -np.inf, peak), axis=0)[None]
            yield f"peak_stress_{body}", np.take_along_axis(peak, worse, 0)[0]
            yield f"peak_contact_{body}", worse[0] + 1.0
            if "error_estimate" in parts:
                yield f"error_estimate_{body}", np.take_along_axis(parts["error_estimate"], worse, 0)[0]
            if "peak_z" in parts:
                depth = np.take_along_axis(parts["peak_z"], worse, 0)[0]
                yield f"at_surface_{body}", _at_surface(ds, flat, worse, depth)
        if "life_cycles" in parts:
            lives = parts["life_cycles"]
            lowest = np.where(np.isnan(lives), np.inf, lives).min(axis=0)
            yield f"life_cycles_{body}", np.where(np.isnan(lives).all(axis=0), np.nan, lowest)


def _at_surface(ds: xr.Dataset, flat: Any, worse: np.ndarray, depth: np.ndarray) -> np.ndarray:
    limit = np.full(depth.shape, 1e-3)  # mm, when the study has no semi-axes
    if "semi_axis_lateral" in ds and "semi_axis_rolling" in ds:
        smaller = np.stack(
            [
                np.minimum(*(flat(ds[f"semi_axis_{n}"].isel(contact=c)) for n in ("lateral", "rolling")))
                for c in range(ds.sizes["contact"])
            ]
        )
        limit = SURFACE_SHARE * np.take_along_axis(smaller, worse, 0)[0]
    return np.where(np.isnan(depth), np.nan, (depth <= limit).astype(float))


def _factor_names(ds: xr.Dataset, dims: list[str], table: pd.DataFrame) -> list[str]:
    names = [d for d in dims if d != "case" and ds.sizes[d] > 1]
    if "case" not in dims:
        return names
    listed = [
        str(n)
        for n, v in ds.variables.items()
        if v.dims == ("case",) and n in table and n not in PLAIN_RESULTS and n != "case"
    ]
    varying = [n for n in listed if table[n].nunique(dropna=False) > 1]
    given = read_study(ds).get("factors")
    if isinstance(given, Mapping):  # a quantity that an expression gives is no factor of its own
        free = [str(n) for n, spec in given.items() if not (isinstance(spec, Mapping) and "expression" in spec)]
        varying = [n for n in free if n in varying] or varying
    if "material_pair" in varying:
        varying = [n for n in varying if n not in ("roller_material", "guide_material")]
    return names + varying


def _base_values(ds: xr.Dataset) -> dict[str, Any]:
    base = read_study(ds).get("base")
    values = {name: parameter.default for name, parameter in PARAMETERS.items()}
    values |= dict(base) if isinstance(base, Mapping) else {}
    for name in (*PARAMETERS, *CATEGORIES):
        if name in ds.variables and ds[name].ndim == 0:
            values[name] = ds[name].item()
    return values
