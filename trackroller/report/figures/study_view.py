"""A gathered study as one table of cases, with what the figures ask of it: factors, levels, what to hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.parameters import EXACTNESS, PARAMETERS
from trackroller.report.figures.style import level_text, long_name, number

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

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
)
BODY_RESULTS = ("peak_stress", "peak_z", "life_cycles")
PLAIN_RESULTS = ("regime", "validity", "converged", "roller_life_hours", "guide_life_hours", "slip", "stopped")
SURFACE_SHARE = 0.01  # a peak above 1 % of the smaller semi-axis counts as lying on the surface


@dataclass(frozen=True)
class StudyView:
    """A study as a table.

    `table` has one row a case; columns are the factors, `contact`- and `body`-resolved results with the
    suffixes `_1`, `_2`, `_roller`, `_guide` (the worse contact), and plain results. `grid` tells that every
    combination of levels is there. `derived` names the factors that other parameters follow from. `base` holds
    the values of the parameters that are no factors.
    """

    table: pd.DataFrame
    factors: tuple[str, ...]
    base: Mapping[str, Any]
    grid: bool
    attrs: Mapping[str, Any]
    derived: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @classmethod
    def of(cls, ds: xr.Dataset) -> StudyView:
        """The table of a gathered study (grid dimensions or one dimension `case`)."""
        dims = [str(d) for d in ds.dims if d not in INNER and ds[_any_with(ds, str(d))].ndim]
        dims = [d for d in dims if d == "case" or d in ds.coords or d in PARAMETERS]
        columns = _case_columns(ds, dims)
        import pandas as pd

        table = pd.DataFrame(columns)
        names = _factor_names(ds, dims, table)
        base = dict(_base_values(ds.attrs))
        for name in (*PARAMETERS, *CATEGORIES):
            if name in ds.variables and ds[name].ndim == 0:
                base[name] = ds[name].item()
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
        return cls(table, tuple(names), base, grid, dict(ds.attrs), derived)

    def levels(self, name: str, table: pd.DataFrame | None = None) -> list[Any]:
        """The values a factor takes: numbers in rising order, categories in order of appearance."""
        values = (self.table if table is None else table)[name].dropna().unique()
        return sorted(values.tolist()) if self.numeric(name) else list(values)

    def numeric(self, name: str) -> bool:
        """Is the factor a number?"""
        return bool(np.issubdtype(np.asarray(self.table[name]).dtype, np.number))

    def behind(self, name: str) -> tuple[str, ...]:
        """The factors that decide a parameter: itself, those it is computed from, or none when it is fixed."""
        return (name,) if name in self.factors else self.derived.get(name, ())

    def held_level(self, name: str) -> Any:
        """The level at which a factor is held when others are shown: that of the base case, else the middle.

        Of contact models the most exact one.
        """
        levels = self.levels(name)
        if name == "contact_model":
            return next((model for model in EXACTNESS if model in levels), levels[0])
        base = self.base.get(name)
        if base is not None and base in levels:
            return base
        return levels[len(levels) // 2] if self.numeric(name) else levels[0]

    def hold(self, shown: tuple[str, ...]) -> tuple[pd.DataFrame, str]:
        """Rows with every factor outside `shown` at its held level, and the sentence that says so.

        A sampled study has no such rows: there the whole table comes back.
        """
        others = [f for f in self.factors if f not in shown]
        if not self.grid:
            return self.table, f"All {len(self.table)} cases of the sample." if others else ""
        rows, said = self.table, []
        for name in others:
            level = self.held_level(name)
            rows = rows[rows[name] == level]
            said.append(_say(name, level))
        return rows, f"Held: {'; '.join(said)}." if said else ""

    @cached_property
    def life(self) -> tuple[str, str, str] | None:
        """Column, wording and unit of the life to show, or None when the study has no life."""
        for column, words, unit in (
            ("roller_life_hours", "Life of the roller", "h"),
            ("guide_life_hours", "Life of the guide", "h"),
            ("life_cycles_roller", "Life of the roller", "overrollings"),
            ("life_cycles_guide", "Life of the guide", "overrollings"),
        ):
            if column in self.table and (self.table[column] > 0).any():
                return column, words, unit
        return None

    def has(self, *columns: str) -> bool:
        """Are these columns there with at least one number in each?"""
        return all(c in self.table and np.isfinite(self.table[c]).any() for c in columns)


def _say(name: str, level: Any) -> str:
    if name == "material_pair":
        return level_text(name, level)
    if name in ("motor_force", "guide_curve_radius"):
        return level_text(name, level)
    return f"{long_name(name)} {level_text(name, level)}"


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
    columns |= _body_columns(ds, flat)
    return columns


def _body_columns(ds: xr.Dataset, flat: Any) -> dict[str, np.ndarray]:
    """Peak (with its depth and contact) and life of the worse contact of each body; fit and where it peaks."""
    columns: dict[str, np.ndarray] = {}
    if "body" not in ds.dims or "contact" not in ds.dims:
        return columns
    for i, body in enumerate(map(str, ds["body"].values)):
        parts = {
            n: np.stack([flat(ds[n].isel(body=i, contact=c)) for c in range(ds.sizes["contact"])])
            for n in BODY_RESULTS
            if n in ds
        }
        if "peak_stress" in parts:
            peak = parts["peak_stress"]
            worse = np.argmax(np.where(np.isnan(peak), -np.inf, peak), axis=0)[None]
            columns[f"peak_stress_{body}"] = np.take_along_axis(peak, worse, 0)[0]
            columns[f"peak_contact_{body}"] = worse[0] + 1.0
            if "peak_z" in parts:
                depth = np.take_along_axis(parts["peak_z"], worse, 0)[0]
                columns[f"peak_z_{body}"] = depth
                columns[f"at_surface_{body}"] = _at_surface(ds, flat, worse, depth)
        if "life_cycles" in parts:
            life = parts["life_cycles"]
            lowest = np.where(np.isnan(life), np.inf, life).min(axis=0)
            columns[f"life_cycles_{body}"] = np.where(np.isnan(life).all(axis=0), np.nan, lowest)
    return columns


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
    given = study_settings(ds.attrs).get("factors")
    if isinstance(given, Mapping):  # what is computed from other factors is no factor of its own
        free = [str(n) for n, spec in given.items() if not (isinstance(spec, Mapping) and "expression" in spec)]
        varying = [n for n in free if n in varying] or varying
    if "material_pair" in varying:
        varying = [n for n in varying if n not in ("roller_material", "guide_material")]
    return names + varying


def _base_values(attrs: Mapping[str, Any]) -> dict[str, Any]:
    study = study_settings(attrs)
    base = study.get("base")
    values = dict(base) if isinstance(base, Mapping) else {}
    for name, parameter in PARAMETERS.items():
        values.setdefault(name, parameter.default)
    return values


def study_settings(attrs: Mapping[str, Any]) -> dict[str, Any]:
    """The merged study file that a result carries in its attributes (YAML or JSON text), or nothing."""
    import yaml

    for key in ("study", "study_file", "study_yaml", "config"):
        text = attrs.get(key)
        if isinstance(text, str):
            try:
                found = yaml.safe_load(text)
            except yaml.YAMLError:
                continue
            if isinstance(found, Mapping):
                return dict(found)
    return {}


def factor_of(low: float, high: float) -> str:
    """'by a factor of 3.2' in words."""
    return f"by a factor of {number(high / low)}"
