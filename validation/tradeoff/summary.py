"""From the measured errors to numbers one can read: percentiles, orders of convergence, ladders of settings."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import xarray as xr

from trackroller.analysis.pareto import pareto_mask
from trackroller.parameters import ACCURACIES
from trackroller.roller.accuracy import ELEMENTS, FORCE_QUANTITIES, preset_rungs, read_ladders
from validation.tradeoff.errors import QUANTITIES, observed_order, percentiles, tolerance_bound
from validation.tradeoff.settings import REFERENCE_ELEMENTS

MOST_RUNGS = 10
LADDERS = {
    ("equilibrium", "sliding"): "forces",
    ("peak", "sliding"): "peak",
    ("elements", "kalker"): "kalker",
}
_JUDGED_BY = {
    "forces": (FORCE_QUANTITIES,),
    "peak": (("peak_stress",),),
    "kalker": (FORCE_QUANTITIES, ("peak_stress",)),
}
REFERENCE_ORDER = 1.8  # ASSUME: of element models towards their reference, as observed
_FLOOR = 1e-15  # rounding: no bound is promised below
Record = dict[str, Any]


def summary(ds: xr.Dataset) -> dict[str, Any]:
    """Return all data of page, figures and accuracy tables, ready for JSON."""
    records = [_record(ds.isel(setting=i)) for i in range(ds.sizes["setting"])]
    whole = {k: ds.attrs[k] for k in sorted(ds.attrs) if k.startswith(("designs_", "reference_cost_"))}
    chosen = {name: ladder(records, *key) for key, name in LADDERS.items()}
    return {
        "sample": {"seed": int(ds.attrs["seed"]), **{k: _plain(v) for k, v in whole.items()}},
        "versions": json.loads(ds.attrs["versions"]),
        "settings": records,
        "orders": orders(records),
        "life": life_against_peak(ds),
        "paper_table": json.loads(ds.attrs["paper_table"]),
        "ladders": chosen,
        "presets": presets(chosen),
    }


def presets(chosen: dict[str, list[Record]]) -> dict[str, Record]:
    """Return the settings that each preset takes from the ladders `forces` and `peak`, and its elements by model."""
    if not all(chosen.values()):
        return {}
    measured = read_ladders(chosen)
    return {
        name: {
            part: dict(rung.settings)
            for part, rung in zip(("forces", "peak"), preset_rungs(name, measured), strict=True)
        }
        | {"kalker": {"elements": ELEMENTS[name]}}
        for name in ACCURACIES
    }


def _plain(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value


def _record(one: xr.Dataset) -> Record:
    out: Record = {name: str(one[name].values) for name in ("stage", "model", "method", "label")}
    out["points"] = _number(float(one["points"]))
    out["cost"] = float(f"{float(one['cost']):.4g}")
    out["ladder"] = json.loads(str(one["ladder"].values))
    out["errors"] = {}
    finest = REFERENCE_ELEMENTS.get(out["model"]) if out["stage"] == "elements" else None
    # The reference errs in the same direction. The observed order gives its error, which is added.
    scale = 1.0 / (1.0 - (out["points"] / finest) ** REFERENCE_ORDER) if finest else 1.0
    for name in QUANTITIES:
        errors = scale * one["error"].sel(quantity=name).values.astype(float)
        if not np.isnan(errors).all():
            known = errors[~np.isnan(errors)]
            levels = [*percentiles(errors), tolerance_bound(errors), known.max()]
            out["errors"][name] = [_number(float(f"{v:.3g}")) for v in levels]
            out["designs"], out["other"] = int(known.size), int(np.isinf(known).sum())
    return out


def _number(value: float) -> float | None:
    """Return the number, or None where JSON has no such number."""
    return value if math.isfinite(value) else None


def levels(record: Record, quantity: str) -> tuple[float, float, float, float]:
    """Return the median, 95th and 99th percentile and bound of a record; inf where the regime is another."""
    return tuple(math.inf if v is None else v for v in record["errors"][quantity][:4])  # type: ignore[return-value]


def orders(records: list[Record]) -> list[Record]:
    """Return the observed order of convergence of each refinement and quantity, by the median over the designs.

    Those with points per length; searches for the peak have none, their effort is no length.
    """
    groups: dict[tuple[str, str, str], list[Record]] = {}
    for record in records:
        if record["points"] is not None and record["method"] not in ("search",):
            groups.setdefault((record["stage"], record["model"], record["method"]), []).append(record)
    out = []
    for (stage, model, method), group in groups.items():
        for quantity in QUANTITIES:
            found = [r for r in group if quantity in r["errors"]]
            if len(found) < 3:
                continue
            points = np.array([r["points"] for r in found])
            median = np.array([levels(r, quantity)[0] for r in found])
            order, fit = observed_order(points, median)
            if math.isfinite(order):
                out.append(
                    {
                        "stage": stage,
                        "model": model,
                        "method": method,
                        "quantity": quantity,
                        "from": float(points.min()),
                        "to": float(points.max()),
                        "order": round(order, 2),
                        "fit": round(fit, 3),
                        "coarsest": float(median[np.argmin(points)]),
                        "finest": float(median[np.argmax(points)]),
                    }
                )
    return out


def ladder(records: list[Record], stage: str, model: str) -> list[Record]:
    """Return at most ten settings, evenly spread, that no other setting beats in cost and 99 % error."""
    name = LADDERS[stage, model]
    judged_by = {q for group in _JUDGED_BY[name] for q in group}
    found = [
        r
        for r in records
        if (r["stage"], r["model"]) == (stage, model) and r["ladder"] and judged_by <= set(r["errors"])
    ]
    if not found:
        return []
    judged = [[r["cost"], *(max(levels(r, q)[3] for q in group) for group in _JUDGED_BY[name])] for r in found]
    table = np.array(judged, float)
    keep = pareto_mask(np.where(np.isfinite(table), table, np.nan), ("min",) * table.shape[1])
    rows = sorted(np.flatnonzero(keep), key=lambda i: table[i, 0])
    return [
        {
            "settings": found[i]["ladder"],
            "cost": found[i]["cost"],
            "errors": {q: [max(v, _FLOOR) for v in levels(found[i], q)] for q in found[i]["errors"]},
        }
        for i in _thinned(rows, table)
    ]


def _thinned(rows: list[Any], table: np.ndarray) -> list[Any]:
    """Return at most MOST_RUNGS rows: rows that gain least over their neighbours are dropped, the ends stay."""
    rows = list(rows)
    while len(rows) > MOST_RUNGS:
        error = np.log(np.maximum(table[rows, 1], _FLOOR))
        gap = np.minimum(np.abs(np.diff(error))[:-1], np.abs(np.diff(error))[1:])
        rows.pop(int(np.argmin(gap)) + 1)
    return rows


def life_against_peak(ds: xr.Dataset) -> dict[str, float]:
    """Return the ratio of the errors of life to those of the peak stress in the searches.

    For small errors it is the exponent of the S-N curve.
    """
    search = ds.where((ds["stage"] == "peak") & (ds["method"] == "search"), drop=True)
    peak = search["error"].sel(quantity="peak_stress").values
    life = search["error"].sel(quantity="life").values
    small = np.isfinite(peak) & np.isfinite(life) & (peak > 1e-6) & (peak < 1e-2)
    if not small.any():
        return {}
    low, middle, high = np.percentile(life[small] / peak[small], (5, 50, 95))
    return {"low": round(float(low), 2), "median": round(float(middle), 2), "high": round(float(high), 2)}


def yardstick(ladders: dict[str, list[Record]]) -> float:
    """Return the processor time [s] of a complete case of `sliding` with the peak search of `standard`."""
    return preset_rungs("standard", read_ladders(ladders))[1].cost
