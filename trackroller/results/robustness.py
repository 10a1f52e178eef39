"""Robust design: the life at each design point if friction, fit and load scatter.

An inner/outer array design (`inner_outer`) has a grid of design points (outer array) and the same
sample of the scattering factors (inner array) at each of them. Differences between design points
are therefore not chance (common random numbers).
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from trackroller.damage.sn_curve import DEVIATES_10_TO_90, SNCurve
from trackroller.errors import InputError
from trackroller.methods import Design
from trackroller.methods.b10 import b10, quantile
from trackroller.methods.factor import readable
from trackroller.parameters import BODIES, MATERIAL_FIELDS, REGIMES
from trackroller.results.index_labels import output_labels
from trackroller.results.lives_by_tests import beyond_sn_data
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.targets import at_points, scattering_body
from trackroller.roller.output_names import body_of, is_life
from trackroller.study.design.levels import in_words
from trackroller.study.file.goals import statistic
from trackroller.study.outputs import (
    Output,
    constant,
    default_names,
    flat,
    of_first_limit,
    outputs,
    regimes,
)

PERCENTILES = (1.0, 5.0, 10.0, 50.0, 90.0, 95.0, 99.0)


def robustness(results: SolvedCases, log_life_scatter: Mapping[str, np.ndarray]) -> xr.Dataset:
    """Summarise every output and the probability of each regime at every design point.

    Parameters
    ----------
    results : SolvedCases
        Solved study with an inner/outer array design.
    log_life_scatter : mapping of str to numpy.ndarray
        For each body the standard deviation of log10 life of the material itself [1], shape (n,),
        besides the scatter of the study: see `material_deviations`.

    Returns
    -------
    xarray.Dataset
        Dimension `point`, with the factors of the outer array as coordinates. `percentile_value`
        (output, point, percentile); `mean` and `standard_deviation` (output, point) over the
        rolling cases. For each life `b10` with `b10_low` and `b10_high`, the life that 90 % of the
        rolling cases reach, and `b10_safe`, where every case in full slip, in lift-off or failed
        counts as life 0. A body above its tensile strength has the life 0 in both; `beyond_data`,
        the shortest life beyond the S-N data, NaN without one. `probability` (regime, point) with
        intervals. The key `requirement` adds the variables of
        `trackroller.results.targets.targets`.

    Raises
    ------
    InputError
        If the study has another design.
    """
    design = results.design
    if not design.method.points:
        allowed = "method inner_outer: lists as outer array, distributions as inner array"
        raise InputError("method", design.method.name, allowed)
    columns = _compared_columns(results)
    by_output = [_of_column(results, column, log_life_scatter) for column in columns]
    variables = _stacked(by_output) | _regime_probabilities(results)
    out = xr.Dataset(variables, coords=_coordinates(design, columns))
    largest = max((float(own.max()) for own in log_life_scatter.values()), default=0.0)
    least = min((float(own.min()) for own in log_life_scatter.values()), default=0.0)
    out.attrs = _attributes(design, largest) | {
        "study": results.study.merged(),
        "least_log_life_scatter": least,
        "outputs_named": int(results.config.analysis.outputs is not None),
    }
    return out


def _compared_columns(results: SolvedCases) -> list[Output]:
    """Return the outputs that are summarised: those that the study names, or the usual ones, and
    those of its goals.
    """
    config = results.config
    factors = results.design.factors
    names = list(config.analysis.outputs or default_names(results.data, factors, results.dims))
    for kind, output in map(statistic, config.pareto):
        if kind not in ("", "probability") and output not in names:
            names.append(output)
    return outputs(
        results.data, factors, names, scale="natural", unlimited=True, allowed=results.allowed
    )


def _of_column(
    results: SolvedCases, column: Output, log_life_scatter: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return the statistics of an output at each design point, and its shortest value beyond the
    S-N data.
    """
    design = results.design
    scatter = log_life_scatter.get(scattering_body(column.name), np.zeros(design.size))
    # a life that wear or the bearing ends has no scatter of an S-N line
    if of_first_limit(column.name):
        by_fatigue = results.ended_by_fatigue(body_of(column.name) or "roller")
        scatter = np.where(by_fatigue, scatter, 0.0)
    regime = regimes(results.data, results.dims)
    values = results.with_breaks(column)
    statistics = _statistics(values, regime, is_life(column.name), scatter, design.points)
    beyond = np.where(beyond_sn_data(results, column.name), column.values, np.nan)
    shortest = np.array([np.fmin.reduce(beyond[rows]) for rows in design.points])
    return statistics | {"beyond_data": shortest}


def _stacked(by_output: Sequence[Mapping[str, np.ndarray]]) -> dict[str, Any]:
    """Return the statistics of all outputs as variables of a data set."""
    variables: dict[str, Any] = {}
    for key in dict.fromkeys(key for one in by_output for key in one):
        axes: tuple[str, ...] = ("output", "point")
        if key == "percentile_value":
            axes = ("output", "point", "percentile")
        values = np.stack([one[key] for one in by_output])
        variables[key] = (axes, values, {"comment": "in the units of the output"})
    return variables


def _regime_probabilities(results: SolvedCases) -> dict[str, Any]:
    """Return the probability of each regime at each design point, and its interval, as
    variables.
    """
    regime = regimes(results.data, results.dims)
    events = np.stack([regime == i for i in range(len(REGIMES))], axis=1).astype(float)
    bounds = at_points(events, results.design)
    variables: dict[str, Any] = {}
    for end, value in zip(("", "_low", "_high"), bounds, strict=True):
        attrs = {"units": "1", "long_name": f"probability{end.replace('_', ' ')} of the regime"}
        variables[f"probability{end}"] = (("regime", "point"), value.T, attrs)
    return variables


def _attributes(design: Design, scatter: float) -> dict[str, str | int | float]:
    treatment = (
        "percentiles and the first B10 are those of the cases that roll, the second B10 counts "
        "every other case as life 0; a body above its tensile strength counts as life 0, and so "
        "does a case that exceeds a limit in the life to the first one; the same inner sample at "
        "every design point"
    )
    scatter_words = ""
    if scatter:
        scatter_words = ", the material's own scatter of life in B10"
    return {
        "method": design.method.name,
        "rows": design.size,
        "inner_samples": design.meta["inner_samples"],
        "interval": "95 %",
        "outer_factors": ", ".join(design.meta["outer"]),
        "inner_factors": ", ".join(design.meta["inner"]),
        "log_life_scatter": scatter,
        "treatment": treatment + scatter_words,
    }


def material_deviations(results: SolvedCases) -> dict[str, np.ndarray]:
    """Return the standard deviation of log10 life of each body's material in each case, lg(T_N) /
    2.563.

    Parameters
    ----------
    results : solved study, whose key `analysis.material_scatter` states what is wanted: true: T_N
        (or T_S to the power of k) of the materials in the attribute `materials`; a number: T_N
        itself; false: nothing

    Returns
    -------
    body -> array [1] of shape (n,), 0 for a material without scatter. Empty if not wanted.
    """
    ds = results.data
    dims = results.dims
    scatter_by_body = results.config.analysis.material_scatter
    if scatter_by_body is False:
        return {}
    known = json.loads(ds.attrs.get("materials", "{}"))
    out = {}
    for field, body in zip(MATERIAL_FIELDS, BODIES, strict=True):
        if scatter_by_body not in (True, "fitted"):
            out[body] = np.full(
                int(np.prod([ds.sizes[d] for d in dims])),
                math.log10(float(scatter_by_body)) / DEVIATES_10_TO_90,
            )
        elif field in ds.variables or constant(ds, field) is not None:
            names = flat(ds, field, dims)
            of = {
                str(n): float(SNCurve.of(known[str(n)]).log_life_deviation)
                for n in np.unique(names.astype(str))
            }
            out[body] = np.array([of[str(n)] for n in names])
    return out


def _coordinates(design: Design, columns: list[Output]) -> dict[str, Any]:
    """Return the coordinates of the outputs and of the design points, with the values of the outer
    factors there.
    """
    first = [rows.start for rows in design.points]
    outer = {
        name: ("point", readable(design.columns[name][first])) for name in design.meta["outer"]
    }
    point = [
        ", ".join(in_words(n, outer[n][1][i]) for n in outer) or "all" for i in range(len(first))
    ]
    return {
        **output_labels(columns),
        "percentile": np.array(PERCENTILES),
        "regime": np.array(REGIMES, dtype=object),
        "point": np.arange(len(first)),
        "point_samples": ("point", np.array([rows.stop - rows.start for rows in design.points])),
        "point_name": ("point", np.array(point, dtype=object)),
        **outer,
    }


def _statistics(
    values: np.ndarray, regime: np.ndarray, life: bool, scatter: np.ndarray, points: list[slice]
) -> dict[str, np.ndarray]:
    """Return statistics of one output, shape (n,), NaN where a value is not usable, at the rows of
    each point.
    """
    names = ("mean", "standard_deviation", "used_share", "b10", "b10_low", "b10_high", "b10_safe")
    out = {name: np.full(len(points), np.nan) for name in names}
    out["percentile_value"] = np.full((len(points), len(PERCENTILES)), np.nan)
    for p, rows in enumerate(points):
        own = values[rows]
        spread = scatter[rows]
        known = ~np.isnan(own)
        good = own[known]
        out["used_share"][p] = good.size / own.size
        if good.size < 2:
            continue
        out["percentile_value"][p] = quantile(good, np.array(PERCENTILES) / 100)
        # as in the table of candidates
        out["percentile_value"][p, PERCENTILES.index(50.0)] = np.median(good)
        if np.isfinite(good).all():
            out["mean"][p] = good.mean()
            out["standard_deviation"][p] = good.std(ddof=1)
        if life:
            out["b10"][p], out["b10_low"][p], out["b10_high"][p] = b10(good, spread[known])
            # a rolling case without a life (not converged) must not count as a long life
            safe = np.where(~known | (regime[rows] != 0), 0.0, own)
            out["b10_safe"][p] = b10(safe, spread)[0]
    return out
