"""Select the outputs of a solved study that an analysis uses, as plain columns, and the rows it may use."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError, unknown_name
from trackroller.parameters import BODIES, MAPPING_FIELDS, MATERIAL_FIELDS, PARAMETERS, REGIME_LABELS, REGIMES
from trackroller.roller.dataset import FLAGS, VARIABLES

BOOKKEEPING = {  # variables that describe how a case was solved; an analysis compares other results
    *(*FLAGS, "validity", "validity_body", "reason", "material_pair", "residual"),
    *(name for name in VARIABLES if "error_" in name),
}
FIELDS = {"x", "y", "z", "grid"}

# Outputs that are analysed by default: name -> (variable, selection, how contacts are joined, scale, words).
DEFAULTS: dict[str, tuple[str, dict[str, Any], str, str, str]] = {
    "pair_life_to_first_limit_hours": (
        "pair_life_to_first_limit_hours",
        {},
        "min",
        "log10",
        "life to the first limit",
    ),
    "pair_life_hours": ("pair_life_hours", {}, "min", "log10", "life of the pair"),
    "roller_life_hours": ("roller_life_hours", {}, "min", "log10", "life of the roller"),
    "guide_life_hours": ("guide_life_hours", {}, "min", "log10", "life of the guide"),
    "run_in_distance": ("run_in_distance", {}, "min", "log10", "run-in distance"),
    "roller_wear_life_hours": ("wear_life_hours", {"body": "roller"}, "min", "log10", "wear life of the roller"),
    "guide_wear_life_hours": ("wear_life_hours", {"body": "guide"}, "min", "log10", "wear life of the guide"),
    "roller_life_cycles": ("life_cycles", {"body": "roller"}, "min", "log10", "life of the roller in overrollings"),
    "guide_life_cycles": ("life_cycles", {"body": "guide"}, "min", "log10", "life of the guide in overrollings"),
    "roller_peak_stress": ("peak_stress", {"body": "roller"}, "max", "natural", "peak stress in the roller"),
    "guide_peak_stress": ("peak_stress", {"body": "guide"}, "max", "natural", "peak stress in the guide"),
    "max_pressure": ("max_pressure", {}, "max", "natural", "highest contact pressure"),
    "friction_power": ("friction_power", {}, "sum", "natural", "friction power of both contacts"),
    "friction_energy": ("friction_energy_per_distance", {}, "sum", "natural", "friction work per distance"),
    "normal_force_1": ("normal_force", {"contact": 1}, "sum", "natural", "normal force in contact 1"),
    "normal_force_2": ("normal_force", {"contact": 2}, "sum", "natural", "normal force in contact 2"),
    "drilling_torque": ("drilling_torque", {}, "sum", "natural", "drilling torque"),
    "slip": ("slip", {}, "sum", "natural", "longitudinal creepage"),
}
_JOIN: dict[str, Any] = {"min": np.nanmin, "max": np.nanmax, "sum": np.nansum}


@dataclass(frozen=True)
class Output:
    """One analysed output: `values` (n,) on `scale`; `excluded` counts the NaN values by their reason."""

    name: str
    values: np.ndarray
    units: str
    long_name: str
    scale: str
    excluded: dict[str, int] = field(default_factory=dict)


def of_fatigue(name: str) -> bool:
    """Return whether an output of an analysis is a life by the S-N curve."""
    variable = DEFAULTS[name][0] if name in DEFAULTS else name.partition("[")[0]
    by_curve = variable in VARIABLES and VARIABLES[variable].group == "life" and "error" not in variable
    return (by_curve and "life" in variable) or name.startswith("life_hours_by_limit[fatigue")


def case_dims(ds: xr.Dataset, factors: Iterable[str]) -> tuple[str, ...]:
    """Return the dimensions that count cases: `case`, or the factors of an unstacked grid in their order."""
    if "case" in ds.dims:
        return ("case",)
    return tuple(name for name in factors if name in ds.dims)


def flat(ds: xr.Dataset, name: str, dims: tuple[str, ...]) -> np.ndarray:
    """Return a variable as an array (rows, ...), with the case dimensions joined in their order."""
    var = ds[name]
    missing = [d for d in dims if d not in var.dims]
    if missing:
        var = var.expand_dims({d: ds.sizes[d] for d in missing})
    rest = [d for d in var.dims if d not in dims]
    values = var.transpose(*dims, *rest).values
    return values.reshape(int(np.prod([ds.sizes[d] for d in dims])), *values.shape[len(dims) :])


def available(ds: xr.Dataset, factors: Iterable[str], dims: tuple[str, ...]) -> list[str]:
    """Return the variables that hold results with one number a case, or a contact, body or limit of it."""
    known = set(factors) | set(PARAMETERS) | set(MATERIAL_FIELDS) | set(MAPPING_FIELDS) | BOOKKEEPING
    return [
        str(name)
        for name, var in ds.data_vars.items()
        if name not in known
        and set(dims) & set(var.dims)
        and var.dtype.kind in "fiu"
        and not (set(var.dims) - set(dims)) & FIELDS - set(factors)
    ]


def every_name(ds: xr.Dataset, factors: Iterable[str], dims: tuple[str, ...]) -> list[str]:
    """Return the names of all outputs, those that are analysed by default first."""
    factors = list(factors)
    names = default_names(ds, factors, dims)
    for name in available(ds, factors, dims):
        places = itertools.product(*(map(str, ds[dim].values.tolist()) for dim in ds[name].dims if dim not in dims))
        names += [f"{name}[{','.join(place)}]" if place else name for place in places]
    return list(dict.fromkeys(names))


def default_names(ds: xr.Dataset, factors: Iterable[str], dims: tuple[str, ...]) -> list[str]:
    """Return the outputs that are analysed by default: those of `DEFAULTS`, otherwise every scalar result."""
    free = available(ds, factors, dims)
    names = [n for n, (var, *_) in DEFAULTS.items() if var in free and np.isfinite(ds[var]).any()]
    for body in BODIES:  # Hours and cycles of one body are proportional, so only the hours are kept.
        if f"{body}_life_hours" in names and f"{body}_life_cycles" in names:
            names.remove(f"{body}_life_cycles")
    if "pair_life_hours" in names and "guide_life_hours" not in names:
        names.remove("pair_life_hours")  # Without hours of the guide it repeats the life of the roller.
    if not names or not {"peak_stress", "normal_force"} & set(free):
        used = {DEFAULTS[n][0] for n in names}
        names += [n for n in free if n not in used and set(ds[n].dims) <= set(dims)]
    return names


def _raw(ds: xr.Dataset, name: str, dims: tuple[str, ...], options: list[str]) -> tuple[np.ndarray, str, str, str]:
    """Return values (n,), units, words and scale of a default output, a variable, or `variable[contact,body]`."""
    if name in DEFAULTS and DEFAULTS[name][0] in ds:
        variable, choice, join, scale, words = DEFAULTS[name]
    else:
        match = re.fullmatch(r"(\w+)(?:\[([^\]]+)\])?", name)
        if not match or match[1] not in options:
            raise unknown_name("analysis.outputs", name, [*options, *(n for n in DEFAULTS if DEFAULTS[n][0] in ds)])
        variable, join = match[1], ""
        keys = [key.strip() for key in (match[2] or "").split(",") if key.strip()]
        choice = dict((("contact", int(k)) if k.isdigit() else ("body" if k in BODIES else "limit", k)) for k in keys)
        scale = "log10" if "life" in variable else "natural"
        words = str(ds[variable].attrs.get("long_name", variable)) + (f" ({match[2]})" if match[2] else "")
    try:
        part = ds.sel({k: v for k, v in choice.items() if k in ds[variable].dims})
    except KeyError:
        raise InputError("analysis.outputs", name, "contact 1 or 2, body roller or guide, a limit asked for") from None
    values = flat(part, variable, dims).astype(float)
    if values.ndim > 1 and not join:
        raise InputError(
            "analysis.outputs",
            name,
            "an output with one number for each case",
            f"Choose a contact and body, such as {variable}[1,roller].",
        )
    if values.ndim > 1:
        values = values.reshape(len(values), -1)
        empty = np.isnan(values).all(axis=1)
        values = np.where(empty, np.nan, _JOIN[join](np.where(empty[:, None], 0.0, values), axis=1))
    return values, str(ds[variable].attrs.get("units", "1")), words, scale


def regimes(ds: xr.Dataset, dims: tuple[str, ...]) -> np.ndarray:
    """Return the index into `REGIMES` of each row, (n,); a row without a known regime counts as failed.

    Rows of a result without the variable `regime`, from another solver, count as rolling.
    """
    rows = int(np.prod([ds.sizes[d] for d in dims]))
    if "regime" not in ds:
        return np.zeros(rows, dtype=int)
    values = flat(ds, "regime", dims).astype(float)
    bad = ~np.isin(values, range(len(REGIMES)))
    return np.where(bad, REGIMES.index("failed"), np.where(bad, 0, values)).astype(int)


def _usable(
    ds: xr.Dataset, dims: tuple[str, ...], regime: np.ndarray, keep: tuple[str, ...], allowed: np.ndarray | None
) -> tuple[np.ndarray, dict[str, int]]:
    """Return True for converged, allowed rows of the regimes to keep, and the number of other rows by reason."""
    usable = np.isin(regime, [REGIMES.index(name) for name in keep])
    lost = {REGIME_LABELS[i]: int((regime == i).sum()) for i, name in enumerate(REGIMES) if name not in keep}
    converged = flat(ds, "converged", dims) != 0 if "converged" in ds else None
    for why, good in (("not converged", converged), ("outside the constraints", allowed)):
        if good is not None:
            lost[why] = int((usable & ~good).sum())
            usable = usable & good
    return usable, {why: count for why, count in lost.items() if count}


def _countable(
    values: np.ndarray, usable: np.ndarray, stopped: np.ndarray, unlimited: bool, scale: str
) -> tuple[np.ndarray, dict[str, int]]:
    """Return values on their scale, NaN where they are unusable, and the number of rows lost by reason."""
    values = np.where(usable, values, np.nan)
    empty = usable & np.isnan(values)
    why = {
        "unlimited": 0 if unlimited else int((usable & np.isinf(values)).sum()),
        "stopped by stop_if": int((empty & stopped).sum()),
        "undefined": int((empty & ~stopped).sum()),
    }
    values = np.where(np.isfinite(values) | (unlimited & np.isposinf(values)), values, np.nan)
    if scale == "log10":
        why["not positive"] = int((values <= 0).sum())
        values = np.log10(np.where(values > 0, values, np.nan))
    return values, {reason: count for reason, count in why.items() if count}


def outputs(
    ds: xr.Dataset,
    factors: Iterable[str],
    names: Iterable[str] | None = None,
    keep: Iterable[str] = ("rolling",),
    unlimited: bool = False,
    scale: str | Mapping[str, str] = "",
    allowed: np.ndarray | None = None,
) -> list[Output]:
    """Return the columns to analyse.

    Parameters
    ----------
    ds : xarray.Dataset
        A gathered study, along `case` or unstacked.
    factors : iterable of str
        Names of the study's factors in their order.
    names : iterable of str, optional
        Names of `DEFAULTS`, scalar variables, or `variable[contact,body]`. Default: `default_names`.
    keep : iterable of str
        Regimes whose rows are used. Rows of other regimes become NaN and are counted.
    unlimited : bool
        Keep infinite lives, for ranking, instead of counting them as unusable.
    scale : str or mapping
        "natural" or "log10", for all outputs or by output.
    allowed : numpy.ndarray, optional
        Rows that meet the constraints of the study, shape (n,). Other rows become NaN and are counted.

    Returns
    -------
    list of Output
        The columns. Unless `unlimited` is True, one indicator (1 where it occurs) is added for each of the regimes
        `full_slip`, `lift_off` and `failed` that occurs, so that the causes of a regime can be analysed.

    Raises
    ------
    InputError
        If a name is unknown, or an output has more than one number for a case.
    """
    factors = list(factors)
    dims = case_dims(ds, factors)
    if not dims:
        raise InputError("study", list(ds.sizes), "a dimension `case`, or one dimension a factor")
    keep = tuple(keep)
    regime = regimes(ds, dims)
    usable, lost = _usable(ds, dims, regime, keep, allowed)
    stopped = flat(ds, "stopped", dims) == 1 if "stopped" in ds else np.zeros(len(regime), dtype=bool)
    options = available(ds, factors, dims)
    columns = []
    for name in list(names) if names is not None else default_names(ds, factors, dims):
        values, units, words, usual = _raw(ds, name, dims, options)
        on = (scale if isinstance(scale, str) else scale.get(name, "")) or usual
        values, why = _countable(values, usable, stopped, unlimited, on)
        columns.append(Output(name, values, units, words, on, lost | why))
    for i, name in enumerate(REGIMES):
        if i and (regime == i).any() and not unlimited:
            words = f"occurrence of {REGIME_LABELS[i].replace('failed', 'failure')}"
            columns.append(Output(name, (regime == i).astype(float), "1", words, "natural"))
    return columns
