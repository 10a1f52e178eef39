"""The cases of a study as typed columns: factors, results, states, and the inputs that solve a case
again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.damage import LIMITS
from trackroller.parameters import (
    BODIES,
    MAPPING_FIELDS,
    MATERIAL_FIELDS,
    OPTIONS,
    PARAMETERS,
    REGIME_LABELS,
    REGIMES,
)
from trackroller.parameters.carriage_fields import parameter_of
from trackroller.parameters.validity import VALIDITY
from trackroller.report.numbers import BEYOND, capital, level_text, long_name, plain, unit_text
from trackroller.report.tables.inputs import stored_materials
from trackroller.results.case_columns import BODY_RESULTS, CONTACT_RESULTS, WHOLE_RESULTS
from trackroller.results.factor_levels import spaced_by_ratio
from trackroller.results.first_limits import first_limit
from trackroller.results.lives_by_tests import beyond_sn_data
from trackroller.results.results import Results
from trackroller.roller.duty import years
from trackroller.roller.output_names import body_of, declared, is_life
from trackroller.roller.stored_inputs import setting_text
from trackroller.study.design.levels import NAMED
from trackroller.study.file import goals
from trackroller.study.outputs import (
    OF_WORD,
    Output,
    constant,
    default_names,
    flat,
    outputs,
    parts_in,
)

# cases; a larger study shows only its factors and outputs, so that the file can be sent
MOST_DETAILED = 20_000
STATES = (
    "valid",
    "outside the model",
    "full slip",
    "lift-off",
    "failed",
    "not converged",
    "constraints not met",
)
DETAILS = (*CONTACT_RESULTS, *(n for n in BODY_RESULTS if n != "error_estimate"), *WHOLE_RESULTS)


@dataclass(frozen=True)
class ExplorerColumn:
    """One column of the explorer, a value for each case.

    Attributes
    ----------
    name : name as in study files
    label, unit : for people
    role : `factor`, `input` (follows from factors), `output`, `design` (of the design, over its
        conditions), `detail` (shown for a chosen case), `state`, or `remark` (of another column)
    values : numbers (n,), or positions (n,) in `levels`, -1 for none
    levels : values of a column of few values, in order; numbers or texts
    texts : the levels in words
    log : whether the axis is logarithmic
    """

    name: str
    label: str
    unit: str
    role: str
    values: np.ndarray
    levels: tuple[Any, ...] | None = None
    texts: tuple[str, ...] = ()
    log: bool = False


def collect(results: Results) -> list[ExplorerColumn]:
    """Return the columns of a gathered study.

    Parameters
    ----------
    results : the solved study

    Returns
    -------
    Columns of equal length. Outputs hold the numbers that `pareto` and the analyses use, in double
    precision; figures of single contacts hold single precision.
    """
    ds = results.data
    dims = results.dims
    columns = [_setting(results, name, "factor") for name in results.factors]
    columns += [_setting(results, name, "input") for name in results.derived]
    columns += [_good(results, name) for name in results.goods]
    columns += _results(ds, dims, results)
    columns += _beyond(results, columns)
    columns += _in_years(results, columns)
    columns += _states(ds, dims, results)
    if len(results.table) <= MOST_DETAILED:
        columns += _details(ds, dims, {column.name for column in columns}, results)
    return columns


def _setting(results: Results, name: str, role: str) -> ExplorerColumn:
    """Return the column of a factor or of an input that follows from factors."""
    values = results.table[name].to_numpy()
    parameter = parameter_of(name)
    unit = ""
    if parameter and name not in NAMED:
        unit = unit_text(parameter.unit)
    label = capital(long_name(name))
    few = not results.numeric(name) or results.grid or len(results.levels(name)) <= 12
    if not few or (role == "input" and results.numeric(name)):
        return ExplorerColumn(
            name,
            label,
            unit,
            role,
            values.astype(float),
            log=spaced_by_ratio(values.astype(float), 100.0),
        )
    return coded(
        name,
        label,
        role,
        values,
        [level_text(name, v, unit=name in NAMED) for v in results.levels(name)],
        unit,
    )


def _good(results: Results, name: str) -> ExplorerColumn:
    """Return a column of the user's own of a shelf, such as the price of a roller."""
    values = results.table[name].to_numpy()
    if values.dtype.kind == "f":
        return ExplorerColumn(
            name,
            capital(long_name(name)),
            str(results.data[name].attrs.get("units", "")),
            "input",
            values,
        )
    return coded(name, capital(long_name(name)), "input", values)


def coded(
    name: str,
    label: str,
    role: str,
    values: Sequence[Any] | np.ndarray,
    texts: Sequence[str] = (),
    unit: str = "",
) -> ExplorerColumn:
    """Return a column of few values as positions in the list of its values.

    Numbers are sorted, texts stay in order of appearance. Without `texts` the values stand for
    themselves.
    """
    array = np.asarray(values)
    number = array.dtype.kind in "fiu"
    codes, different = pd.factorize(array, sort=number)
    if number:
        levels = different.astype(float).tolist()
    else:
        levels = different.astype(str).tolist()
    return ExplorerColumn(
        name, label, unit, role, codes, tuple(levels), tuple(texts) or tuple(map(str, levels))
    )


def _results(ds: xr.Dataset, dims: tuple[str, ...], results: Results) -> list[ExplorerColumn]:
    """Return the usual outputs and those that the study file names as goals."""
    named = [
        n for text in results.config.constraints for n in goals.names_in(text) if n != "regime"
    ]
    named += [n for n in results.config.pareto if not goals.statistic(n)[0]]
    inputs = {*results.table, *PARAMETERS, *MATERIAL_FIELDS}
    names = dict.fromkeys([*default_names(ds, dims, dims), *(n for n in named if n not in inputs)])
    return [_output(one, "output", results) for one in _outputs(ds, dims, list(names))]


def _beyond(results: Results, columns: Sequence[ExplorerColumn]) -> list[ExplorerColumn]:
    """Mark the lives that lie beyond the S-N data: for each column with a life in it a column
    `NAME:beyond` of 0 and 1.

    A column that marks no life is left out.
    """
    remarks = []
    for column in (c for c in columns if c.role == "output" and is_life(c.name)):
        marks = beyond_sn_data(results, column.name) & ~np.isnan(column.values)
        if marks.any():
            name = f"{column.name}:beyond"
            remarks.append(
                ExplorerColumn(
                    name, BEYOND, "", "remark", marks.astype(int), (0.0, 1.0), ("", BEYOND)
                )
            )
    return remarks


def _in_years(results: Results, columns: Sequence[ExplorerColumn]) -> list[ExplorerColumn]:
    """Return the lives in years, for the card of a chosen case; none if the duty of the roller is
    not known.
    """
    duty = results.config.duty
    if duty is None:
        return []
    lives = [c for c in columns if c.unit == "h" and is_life(c.name)]
    return [
        ExplorerColumn(f"{c.name}:years", c.label, "years", "detail", years(c.values, duty))
        for c in lives
    ]


def _outputs(ds: xr.Dataset, dims: tuple[str, ...], names: list[str]) -> list[Output]:
    return outputs(ds, dims, names, REGIMES[:3], scale="natural", unlimited=True)


def _output(one: Output, role: str, results: Results) -> ExplorerColumn:
    # a roller that skids, and a body above its tensile strength, have no fatigue life
    if is_life(one.name):
        body = ""
        if results.by_body:
            body = body_of(one.name)
        one = replace(
            one,
            values=np.where(results.rolling & ~results.flagged("static", body), one.values, np.nan),
        )
    if role == "detail":
        values = one.values.astype(np.float32)
    else:
        values = one.values
    log = declared(one.name).scale == "log10"
    return ExplorerColumn(
        one.name, capital(one.long_name), unit_text(one.units), role, values, log=log
    )


def _details(
    ds: xr.Dataset, dims: tuple[str, ...], known: set[str], results: Results
) -> list[ExplorerColumn]:
    """Return figures of each contact and body, under names such as `peak_stress_roller_1`."""
    parts = parts_in(ds, [n for n in DETAILS if n in ds and set(ds[n].dims) >= set(dims)], dims)
    names = [
        p.name
        for p in parts.values()
        if p.name not in known and ("contact" in p.at or "contact" not in p.variable.dims)
    ]
    return [_output(one, "detail", results) for one in _outputs(ds, dims, names)]


def _states(ds: xr.Dataset, dims: tuple[str, ...], results: Results) -> list[ExplorerColumn]:
    """Return regime, state, validity flags (of each body where they are known), and reason of
    failure.
    """
    regime = np.clip(np.nan_to_num(results.regime, nan=3), 0, 3).astype(int)
    rolls = np.where(results.inside, 6, np.where(results.rolling, 1, 5))
    state = np.where(results.valid, 0, np.where(regime > 0, regime + 1, rolls))
    columns = [
        ExplorerColumn("regime", "Regime", "", "state", regime, REGIMES, REGIME_LABELS),
        ExplorerColumn("state", "State", "", "state", state, STATES, STATES),
    ]
    for name in ("validity", *(f"validity_{body}" for body in BODIES)):
        if name in results.table and results.flags:
            masks = np.nan_to_num(results.column(name, 0.0)).astype(int)
            texts_of_masks = [flag_text(int(mask), results.flags) for mask in np.unique(masks)]
            body = name.partition("_")[2]
            of_body = ""
            if body:
                of_body = f" of the {body}"
            columns.append(coded(name, f"Flags{of_body}", "state", masks, texts_of_masks))
    columns += _first_limits(results)
    if results.allowed is not None:
        met = ("met", "not met")
        columns.append(
            ExplorerColumn(
                "constraints",
                "Constraints of the study",
                "",
                "state",
                1 - results.allowed.astype(int),
                met,
                met,
            )
        )
    if "reason" in ds:
        if "regime" in ds:
            reason = ds["reason"].broadcast_like(ds["regime"]).transpose(*dims)
        else:
            reason = ds["reason"]
        texts = reason.values.astype(str).ravel()
        if (texts != "").any():
            columns.append(coded("reason", "Reason", "state", texts))
    return columns


def _first_limits(results: Results) -> list[ExplorerColumn]:
    """Return the limit that ends the pair first, and the first one of each body; nothing without
    limits.
    """
    if not results.limits:
        return []
    titles = {name: limit.title for name, limit in LIMITS.items()}
    words = np.array([titles.get(name, "not known") for name in results.limits])
    last = len(words) - 1
    columns = {
        "limiting_mechanism": [
            LIMITS[name].title if name else words[last] for name in first_limit(results)
        ]
    }
    for body in BODIES:
        numbers = np.nan_to_num(
            results.column(f"limiting_mechanism_{body}", np.nan), nan=last
        ).astype(int)
        columns[f"limiting_mechanism_{body}"] = words[numbers].tolist()
    labels = ("First limit of the pair", *(f"First limit of the {body}" for body in BODIES))
    pairs = zip(columns.items(), labels, strict=True)
    return [
        coded(name, label, "state", np.array(values, dtype=object))
        for (name, values), label in pairs
    ]


def flag_text(mask: int, flags: Sequence[str]) -> str:
    """Write the validity flags of a bit mask in words, 'none' without a flag."""
    words = [VALIDITY[flag].words for i, flag in enumerate(flags) if mask & (1 << i)]
    return "; ".join(words) or "none"


def solve_inputs(
    results: Results, known: dict[str, ExplorerColumn]
) -> tuple[list[list[Any]], list[ExplorerColumn]]:
    """Return what `trackroller solve --set` needs to repeat a case.

    Parameters
    ----------
    results : the solved study
    known : columns that the explorer has already, by name

    Returns
    -------
    settings : pairs of a key and its text, or of a key and a list with the name of its column if
        the text varies
    columns : further columns that the settings name
    """
    ds = results.data
    dims = results.dims
    settings = []
    columns = []
    for key in (*PARAMETERS, *MATERIAL_FIELDS, *MAPPING_FIELDS, *OPTIONS):
        name = key
        if f"{key}{OF_WORD}" in {*ds.variables, *ds.attrs}:
            name = f"{key}{OF_WORD}"
        if name in ds.variables and set(ds[name].dims) & set(dims):
            if name not in known:
                columns.append(_input(name, flat(ds, name, dims)))
            settings.append([key, [name]])
            continue
        text = setting_text(_fixed(ds, results, name))
        if text is not None and key != "shortcuts":
            settings.append([key, text])
    if results.config.duty:
        settings.append(["duty", setting_text(dict(results.config.duty)) or ""])
    return settings, columns


def _input(name: str, values: np.ndarray) -> ExplorerColumn:
    if values.dtype.kind in "fiu":
        return ExplorerColumn(name, plain(name), "", "input", values.astype(float))
    return coded(name, plain(name), "input", values.astype(str))


def _fixed(ds: xr.Dataset, results: Results, name: str) -> Any:
    """Return a setting that is the same in all cases, None if it is not given."""
    shared = constant(ds, name)
    if shared is not None:
        return shared
    if name in OPTIONS:
        stated = getattr(results.config, name, None)
        if stated is None:
            return ds.attrs.get(name)
        return stated
    return results.config.base.get(name, getattr(PARAMETERS.get(name), "default", None))


def strengths(ds: xr.Dataset) -> dict[str, list[float]]:
    """Return tensile strength and fatigue limit [MPa] of each material of the study, by name."""
    return {
        str(name): [
            values["tensile_strength"],
            values["tensile_strength"] * values["fatigue_strength_ratio"],
        ]
        for name, values in stored_materials(ds.attrs).items()
        if {"tensile_strength", "fatigue_strength_ratio"} <= set(values)
    }
