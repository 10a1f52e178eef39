"""Robustness of design points: what life does when friction, fit and load scatter.

A nested study has a grid of design points outside and the same sample of scattering factors inside each, so
differences between design points are not differences of luck (common random numbers).
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping

import numpy as np
import xarray as xr

from trackroller.damage.fatigue import DECADES, scatter_ranges, woehler_exponent
from trackroller.errors import InputError
from trackroller.parameters import MATERIAL_FIELDS, REGIMES
from trackroller.study.design.factors import label
from trackroller.study.design.levels import in_words
from trackroller.study.design.sampling import SampledDesign
from trackroller.study.outputs import case_dims, default_names, flat, outputs, read_study, regimes

PERCENTILES = (1.0, 5.0, 10.0, 50.0, 90.0, 95.0, 99.0)


def robustness(
    ds: xr.Dataset,
    design: SampledDesign,
    names: Iterable[str] | None = None,
    log_life_scatter: float | Mapping[str, np.ndarray] = 0.0,
) -> xr.Dataset:
    """Distribution of every output and probability of each regime at every design point.

    Parameters
    ----------
    ds : solved nested study, dimension `case`
    design : its design (`trackroller.analysis.restore.design_of`)
    names : outputs, see `trackroller.study.outputs.outputs`
    log_life_scatter : standard deviation of log10 life of the material itself [1], on top of the scatter of
        the study; lg(T_N) / 2.563 for the scatter range T_N between 10 and 90 % failure. One number, or for
        each body an array of shape (n,), see `material_deviations`

    Returns
    -------
    Dataset over `point` with the outer factors as coordinates: percentile (output, point, percentile),
    mean, standard_deviation (output, point) over the rows that roll; for each life `b10`, b10_low, b10_high:
    the life that 90 % of rollers reach, once over the rows that roll and once (`b10_safe`) with every row in
    full slip, lift-off or failed counted as life 0; probability (regime, point) with Wilson intervals.

    Raises
    ------
    InputError : not a nested study
    """
    if design.method != "nested":
        raise InputError("design", design.method, "a nested study: lists outside, distributions inside")
    shape = (design.meta["design_points"], design.meta["inner_samples"])
    dims = case_dims(ds, design.factors)
    regime = regimes(ds, dims).reshape(shape)
    wanted = list(names) if names is not None else default_names(ds, design.factors, dims)
    columns = outputs(ds, design.factors, wanted, natural=wanted, unlimited=True)
    out = xr.Dataset(coords=_coordinates(design, shape, columns))
    lists: dict[str, list[np.ndarray]] = {}
    for column in columns:
        values = column.values.reshape(shape)
        body = "guide" if "guide" in column.name else "roller"
        own = log_life_scatter.get(body, 0.0) if isinstance(log_life_scatter, Mapping) else log_life_scatter
        scatter = np.broadcast_to(np.asarray(own, dtype=float), (design.size,)).reshape(shape)
        for key, value in _statistics(values, regime, "life" in column.name, scatter).items():
            lists.setdefault(key, []).append(value)
    for key, found in lists.items():
        axes = ("output", "point", "percentile") if key == "percentile_value" else ("output", "point")
        out[key] = (axes, np.stack(found), {"comment": "in the units of the output"})
    share: np.ndarray = np.stack([np.mean(regime == i, axis=1) for i in range(len(REGIMES))])
    low, high = wilson(share, shape[1])
    for key, value in (("probability", share), ("probability_low", low), ("probability_high", high)):
        out[key] = (("regime", "point"), value, {"units": "1", "long_name": key.replace("_", " ") + " of the regime"})
    out.attrs = {
        "method": "nested",
        "rows": int(np.prod(shape)),
        "inner_samples": shape[1],
        "interval": "95 %",
        "outer_factors": ", ".join(design.meta["outer"]),
        "inner_factors": ", ".join(design.meta["inner"]),
        "log_life_scatter": _largest(log_life_scatter),
        "study": ds.attrs.get("study", ""),
        "treatment": "percentiles and the first B10 are those of the cases that roll, the second B10 counts every "
        "other case as life 0; the same inner sample at every design point"
        + (", the material's own scatter of life in B10" if _largest(log_life_scatter) else ""),
    }
    return out


def _largest(scatter: float | Mapping[str, np.ndarray]) -> float:
    parts = list(scatter.values()) if isinstance(scatter, Mapping) else [np.asarray(scatter)]
    return max((float(np.max(part)) for part in parts), default=0.0)


def material_deviations(ds: xr.Dataset, wanted: bool | float) -> dict[str, np.ndarray]:
    """Standard deviation of log10 life of each body's material in each case, lg(T_N) / 2.563.

    Parameters
    ----------
    ds : gathered study with the values of its materials as attribute `materials`
    wanted : true: T_N (or T_S to the power of k) of the materials; a number: T_N itself; false: none

    Returns
    -------
    body -> array [1] of shape (n,); empty if not wanted. 0 for a material without scatter.
    """
    if wanted is False or wanted is None:
        return {}
    study = read_study(ds)
    dims = case_dims(ds, study.get("factors", {}))
    known = json.loads(ds.attrs.get("materials", "{}"))
    out = {}
    for field, body in zip(MATERIAL_FIELDS, ("roller", "guide"), strict=True):
        if wanted is not True:
            out[body] = np.full(int(np.prod([ds.sizes[d] for d in dims])), math.log10(float(wanted)) / DECADES)
        elif field in ds.variables:
            names = flat(ds, field, dims) if ds[field].ndim else np.full(regimes(ds, dims).size, ds[field].item())
            of = {str(n): deviation(known.get(str(n), {})) for n in np.unique(names.astype(str))}
            out[body] = np.array([of[str(n)] for n in names])
    return out


def deviation(material: Mapping[str, float]) -> float:
    """Standard deviation of log10 life of a material (a mapping with its values), 0 without scatter."""
    t_n, t_s = material.get("scatter_in_cycles"), material.get("scatter_in_stress")
    if t_n is None and t_s is None:
        return 0.0
    strength = material["tensile_strength"]
    limit = material["fatigue_strength_ratio"] * strength
    k = woehler_exponent(strength, limit, material["cycles_at_tensile_strength"], material["cycles_at_fatigue_limit"])
    return float(np.log10(scatter_ranges(k, t_n, t_s)[0]) / DECADES)


def _coordinates(design: SampledDesign, shape: tuple[int, int], columns: list) -> dict:
    first = np.arange(shape[0]) * shape[1]
    outer = {}
    for name in design.meta["outer"]:
        values = design.columns[name][first]
        if values.dtype == object:
            values = np.array([label(v) for v in values], dtype=object)
        outer[name] = ("point", values)
    point = [", ".join(in_words(n, outer[n][1][i]) for n in outer) or "all" for i in range(shape[0])]
    return {
        "output": np.array([c.name for c in columns], dtype=object),
        "output_units": ("output", np.array([c.units for c in columns], dtype=object)),
        "output_name": ("output", np.array([c.long_name for c in columns], dtype=object)),
        "percentile": np.array(PERCENTILES),
        "regime": np.array(REGIMES, dtype=object),
        "point": np.arange(shape[0]),
        "point_name": ("point", np.array(point, dtype=object)),
        **outer,
    }


def _statistics(values: np.ndarray, regime: np.ndarray, life: bool, scatter: np.ndarray) -> dict[str, np.ndarray]:
    """Statistics of one output, shapes (points, samples), NaN where not usable."""
    points = len(values)
    out = {
        k: np.full(points, np.nan)
        for k in ("mean", "standard_deviation", "used_share", "b10", "b10_low", "b10_high", "b10_safe")
    }
    out["percentile_value"] = np.full((points, len(PERCENTILES)), np.nan)
    for p in range(points):
        good = values[p][~np.isnan(values[p])]
        out["used_share"][p] = good.size / values.shape[1]
        if good.size < 2:
            continue
        out["percentile_value"][p] = _quantile(good, np.array(PERCENTILES) / 100)
        if np.isfinite(good).all():
            out["mean"][p], out["standard_deviation"][p] = good.mean(), good.std(ddof=1)
        if life:
            known = ~np.isnan(values[p])
            out["b10"][p], out["b10_low"][p], out["b10_high"][p] = b10(good, scatter[p][known])
            # a row that rolls but has no life (not converged) is no evidence of a long one either
            safe = np.where(np.isnan(values[p]) | (regime[p] != 0), 0.0, values[p])
            out["b10_safe"][p] = b10(safe, scatter[p])[0]
    return out


def _quantile(values: np.ndarray, share: np.ndarray | float) -> np.ndarray:
    """Quantiles by order statistics, without arithmetic between finite and infinite neighbours."""
    ranked = np.sort(values)
    at = np.ceil(np.asarray(share) * len(ranked)).astype(int) - 1
    return ranked[np.clip(at, 0, len(ranked) - 1)]


def b10(lives: np.ndarray, log_life_scatter: float | np.ndarray = 0.0) -> tuple[float, float, float]:
    """Life that 90 % reach, with its 95 % interval.

    Parameters
    ----------
    lives : median lives at the sampled conditions [any unit], shape (n,); 0 and inf are allowed
    log_life_scatter : standard deviation of log10 life of the material itself [1], one or of shape (n,)

    Returns
    -------
    B10, lower, upper in the unit of `lives`. Without material scatter the 10 % order statistic and its
    distribution-free (binomial) interval; with it the root of mean_i Phi((lg t - lg N_i) / s) = 0.1, and the
    interval moved by the same ratio.
    """
    from scipy import stats
    from scipy.optimize import brentq

    ranked = np.sort(lives)
    count = len(ranked)
    value = float(_quantile(ranked, 0.1))
    low = ranked[max(0, int(stats.binom.ppf(0.025, count, 0.1)) - 1)]
    high = ranked[min(count - 1, int(stats.binom.ppf(0.975, count, 0.1)))]
    deviations = np.broadcast_to(np.asarray(log_life_scatter, dtype=float), lives.shape)[np.argsort(lives)]
    if not (deviations > 0).any() or not np.isfinite(ranked).any() or value in (0.0, np.inf):
        return value, float(low), float(high)
    with np.errstate(divide="ignore"):
        logs = np.log10(ranked)

    def miss(t: float) -> float:
        return float(stats.norm.cdf((t - logs) / np.maximum(deviations, 1e-9)).mean()) - 0.1

    finite = logs[np.isfinite(logs)]
    wide = 6 * float(deviations.max())
    scattered = 10 ** brentq(miss, finite.min() - wide, finite.max() + wide)
    return float(scattered), float(low * scattered / value), float(high * scattered / value)


def wilson(share: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Wilson's 95 % interval of a probability seen as `share` of `count` samples; shapes as `share`."""
    z2 = 1.959964**2
    middle = (share + z2 / (2 * count)) / (1 + z2 / count)
    half = np.sqrt(z2 * (share * (1 - share) / count + z2 / (4 * count**2))) / (1 + z2 / count)
    return np.clip(middle - half, 0, 1), np.clip(middle + half, 0, 1)
