"""Select the outputs of a solved study that an analysis uses, as plain columns, and the rows it may
use.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import xarray as xr

from trackroller.damage import first_limit
from trackroller.errors import InputError, unknown_name
from trackroller.parameters import (
    BODIES,
    LIMITS,
    REGIME_LABELS,
    REGIMES,
)
from trackroller.roller.dataset import FLAGS, VARIABLES
from trackroller.roller.output_names import PARTS, Part, declared, parts_of
from trackroller.study.design.factor_names import CASE_FIELDS

BOOKKEEPING = {  # variables that describe how a case was solved; an analysis compares other results
    *(*FLAGS, "validity", "validity_body", "reason", "material_pair", "residual"),
    *(name for name, variable in VARIABLES.items() if variable.estimate),
}
FIELDS = {"x", "y", "z", "grid"}
OF_WORD = "_value"  # ends the name of the number beside a friction that is given as a word
OF_UNITS = "_units"  # ends the name of the attribute with the unit of a constant

USUAL = (  # outputs that are analysed by default, as far as the study has them
    "pair_life_to_first_limit_hours",
    "pair_life_hours",
    "roller_life_hours",
    "guide_life_hours",
    "run_in_distance",
    "wear_life_hours_roller",
    "wear_life_hours_guide",
    "life_cycles_roller",
    "life_cycles_guide",
    "peak_stress_roller",
    "peak_stress_guide",
    "max_pressure",
    "friction_power",
    "friction_energy_per_distance",
    "normal_force_1",
    "normal_force_2",
    "drilling_torque",
    "slip",
)


@dataclass(frozen=True)
class Output:
    """One analysed output: `values` (n,) on `scale`; `excluded` counts the NaN values by their
    reason.
    """

    name: str
    values: np.ndarray
    units: str
    long_name: str
    scale: str
    excluded: dict[str, int] = field(default_factory=dict)


def of_fatigue(name: str) -> bool:
    """Return whether an output of an analysis is a life by the S-N curve."""
    part = PARTS.get(name)
    if part is None:
        return False
    by_curve = part.variable.group == "life" and part.variable.life
    return by_curve or (
        part.variable.name == "life_hours_by_limit" and part.at.get("limit") == "fatigue"
    )


def of_first_limit(name: str) -> bool:
    """Return whether a result is a life to the first limit that is reached."""
    variable = declared(name)
    return variable.group == first_limit.GROUP and variable.life and "limit" not in variable.dims


def case_dims(ds: xr.Dataset, factors: Iterable[str]) -> tuple[str, ...]:
    """Return the dimensions that count cases: `case`, or the factors of an unstacked grid in their
    order.
    """
    if "case" in ds.dims:
        return ("case",)
    return tuple(name for name in factors if name in ds.dims)


def constant(ds: xr.Dataset, name: str) -> float | str | None:
    """Return an input that all cases of a study share, NaN if no case gives it, None if it varies.

    Parameters
    ----------
    ds : xarray.Dataset
        A gathered study. A constant is an attribute, with its unit in the attribute `NAME_units`.
        A factor of which somebody selected one level is a coordinate without a dimension.
    name : str
        Name of the input, such as `axis_distance` [mm].
    """
    value: float | str | None = None
    if name in ds.variables:
        if not ds[name].ndim:
            value = ds[name].item()
    elif is_constant_field(name):
        value = ds.attrs.get(name)
        if isinstance(value, np.generic):  # as a file holds it
            value = value.item()
    return value


def is_constant_field(name: str) -> bool:
    """Return whether an input of this name is an attribute if all cases share it.

    These are the fields of a case, and the number of a friction that is given as a word. A name
    that the user chose stays a coordinate: it may be that of another attribute.
    """
    return name.removesuffix(OF_WORD) in CASE_FIELDS


def flat(ds: xr.Dataset, name: str, dims: tuple[str, ...]) -> np.ndarray:
    """Return a variable, or a constant of the study, as an array (rows, ...), with the case
    dimensions joined in their order.
    """
    shared = constant(ds, name)
    if name in ds.variables or shared is None:
        var = ds[name]
    else:
        var = xr.DataArray(shared)
    missing = [d for d in dims if d not in var.dims]
    if missing:
        var = var.expand_dims({d: ds.sizes[d] for d in missing})
    inner = [d for d in var.dims if d not in dims]
    values = var.transpose(*dims, *inner).values
    return values.reshape(int(np.prod([ds.sizes[d] for d in dims])), *values.shape[len(dims) :])


def available(ds: xr.Dataset, factors: Iterable[str], dims: tuple[str, ...]) -> list[str]:
    """Return the variables that hold results with one number a case, or a contact, body or limit of
    it.
    """
    known = set(factors) | set(CASE_FIELDS) | BOOKKEEPING
    return [
        str(name)
        for name, var in ds.data_vars.items()
        if name not in known
        and set(dims) & set(var.dims)
        and var.dtype.kind in "fiu"
        and not (set(var.dims) - set(dims)) & FIELDS - set(factors)
    ]


def parts_in(ds: xr.Dataset, names: Iterable[str], dims: tuple[str, ...]) -> dict[str, Part]:
    """Return the parts with one number a case of variables; a variable that is not declared takes
    its attributes.
    """
    parts: dict[str, Part] = {}
    for name in names:
        var = ds[name]
        inner = tuple(str(dim) for dim in var.dims if dim not in dims)
        words = str(var.attrs.get("long_name", name))
        own = declared(name)
        if name not in VARIABLES:  # of another solver
            own = replace(own, units=str(var.attrs.get("units", "1")), long_name=words)
        limits = []
        if "limit" in inner:
            names_of_limits = set(map(str, ds["limit"].values))
            limits = [limit for name, limit in LIMITS.items() if name in names_of_limits]
        parts |= {part.name: part for part in parts_of(replace(own, dims=inner), limits)}
    return parts


def every_name(ds: xr.Dataset, factors: Iterable[str], dims: tuple[str, ...]) -> list[str]:
    """Return the names of all outputs, those that are analysed by default first."""
    free = available(ds, factors, dims)
    known = parts_in(ds, free, dims)
    return list(dict.fromkeys([*_usual(ds, free, known, dims), *known]))


def default_names(ds: xr.Dataset, factors: Iterable[str], dims: tuple[str, ...]) -> list[str]:
    """Return the outputs that are analysed by default: those of `USUAL`, otherwise every scalar
    result.
    """
    free = available(ds, factors, dims)
    return _usual(ds, free, parts_in(ds, free, dims), dims)


def _usual(
    ds: xr.Dataset, free: Sequence[str], known: Mapping[str, Part], dims: tuple[str, ...]
) -> list[str]:
    """Return the outputs that are analysed by default among the variables `free`, whose parts are
    `known`.
    """
    names = [
        name for name in USUAL if name in known and np.isfinite(ds[known[name].variable.name]).any()
    ]
    # Hours and cycles of one body are proportional, so only the hours are kept.
    for body in BODIES:
        if f"{body}_life_hours" in names and f"life_cycles_{body}" in names:
            names.remove(f"life_cycles_{body}")
    if "pair_life_hours" in names and "guide_life_hours" not in names:
        # Without hours of the guide it repeats the life of the roller.
        names.remove("pair_life_hours")
    if not names or not {"peak_stress", "normal_force"} & set(free):
        used = {known[name].variable.name for name in names}
        names += [n for n in free if n not in used and set(ds[n].dims) <= set(dims)]
    return names


def regimes(ds: xr.Dataset, dims: tuple[str, ...]) -> np.ndarray:
    """Return the index into `REGIMES` of each row, (n,); a row without a known regime counts as
    failed.

    Rows of a result without the variable `regime`, from another solver, count as rolling.
    """
    rows = int(np.prod([ds.sizes[d] for d in dims]))
    if "regime" not in ds:
        return np.zeros(rows, dtype=int)
    values = flat(ds, "regime", dims).astype(float)
    bad = ~np.isin(values, range(len(REGIMES)))
    return np.where(bad, REGIMES.index("failed"), np.where(bad, 0, values)).astype(int)


def _usable(
    ds: xr.Dataset,
    dims: tuple[str, ...],
    regime: np.ndarray,
    keep: tuple[str, ...],
    allowed: np.ndarray | None,
) -> tuple[np.ndarray, dict[str, int]]:
    """Return True for converged, allowed rows of the regimes to keep, and the number of other rows
    by reason.
    """
    usable = np.isin(regime, [REGIMES.index(name) for name in keep])
    lost = {
        REGIME_LABELS[i]: int((regime == i).sum())
        for i, name in enumerate(REGIMES)
        if name not in keep
    }
    converged = None
    if "converged" in ds:
        converged = flat(ds, "converged", dims) != 0
    for why, good in (("not converged", converged), ("outside the constraints", allowed)):
        if good is not None:
            lost[why] = int((usable & ~good).sum())
            usable = usable & good
    return usable, {why: count for why, count in lost.items() if count}


def _countable(
    values: np.ndarray, usable: np.ndarray, stopped: np.ndarray, unlimited: bool, scale: str
) -> tuple[np.ndarray, dict[str, int]]:
    """Return values on their scale, NaN where they are unusable, and the number of rows lost by
    reason.
    """
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


def _check_number(ds: xr.Dataset, part: Part) -> None:
    """Refuse a utilisation that a bound stands for in some cases: it is no number to compare."""
    if part.variable.name != "utilisation" or first_limit.AT_MOST not in ds:
        return
    count = int(replace(part, variable=VARIABLES[first_limit.AT_MOST]).values(ds).notnull().sum())
    if count:
        group = LIMITS[part.at["limit"]].group
        raise InputError(
            "analysis.outputs",
            part.name,
            "an output with its number in every case",
            f"Add {group} to outputs of the study, and run it again.",
            f"is known as a bound alone, which is below 1, in {count:,} cases",
        )


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
        Names, see `trackroller.roller.output_names`. Default: `default_names`.
    keep : iterable of str
        Regimes whose rows are used. Rows of other regimes become NaN and are counted.
    unlimited : bool
        Keep infinite lives, for ranking, instead of counting them as unusable.
    scale : str or mapping
        "natural" or "log10", for all outputs or by output.
    allowed : numpy.ndarray, optional
        Rows that meet the constraints of the study, shape (n,). Other rows become NaN and are
        counted.

    Returns
    -------
    list of Output
        The columns. Unless `unlimited` is True, one indicator (1 where it occurs) is added for each
        of the regimes `full_slip`, `lift_off` and `failed` that occurs, so that the causes of a
        regime can be analysed.

    Raises
    ------
    InputError
        If a name is unknown, or if it is that of a utilisation of which some cases know a bound
        alone, see the option `at_most`.
    """
    factors = list(factors)
    dims = case_dims(ds, factors)
    if not dims:
        raise InputError("study", list(ds.sizes), "a dimension `case`, or one dimension a factor")
    keep = tuple(keep)
    regime = regimes(ds, dims)
    usable, lost = _usable(ds, dims, regime, keep, allowed)
    if "stopped" in ds:
        stopped = flat(ds, "stopped", dims) == 1
    else:
        stopped = np.zeros(len(regime), dtype=bool)
    free = available(ds, factors, dims)
    known = parts_in(ds, free, dims)
    columns = []
    for name in list(names) if names is not None else _usual(ds, free, known, dims):
        if name not in known:
            raise unknown_name("analysis.outputs", name, known)
        part = known[name]
        _check_number(ds, part)
        single = part.values(ds).to_dataset(name=name)
        units = str(ds[part.variable.name].attrs.get("units", "1"))
        on = (scale if isinstance(scale, str) else scale.get(name, "")) or part.variable.scale
        values, why = _countable(
            flat(single, name, dims).astype(float), usable, stopped, unlimited, on
        )
        columns.append(Output(name, values, units, part.words, on, lost | why))
    for i, name in enumerate(REGIMES):
        if i and (regime == i).any() and not unlimited:
            words = f"occurrence of {REGIME_LABELS[i].replace('failed', 'failure')}"
            columns.append(Output(name, (regime == i).astype(float), "1", words, "natural"))
    return columns
