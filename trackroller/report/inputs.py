"""What the report says of a study's inputs in tables: factors, what is the same in all cases, materials, record."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from trackroller.parameters import MAPPING_FIELDS, PARAMETERS
from trackroller.report.numbers import capital, level_text, long_name, near, number, plain, unit_text
from trackroller.report.view import StudyView

Table = list[dict[str, Any]]


def factor_table(view: StudyView) -> Table:
    """List the factors: name, symbol, unit, values as set or as found, number of levels."""
    found = view.study.get("factors", {})
    given = found if isinstance(found, Mapping) else {}
    rows = []
    for name in view.factors:
        levels = view.levels(name)
        if view.grid or len(levels) <= 12 or not view.numeric(name):
            words = name in ("motor_force", "guide_curve_radius")
            values = ", ".join(level_text(name, v, unit=words) for v in levels)
        else:
            values = _range(levels)
        rows.append(_row(name, levels, values, given.get(name)))
    for name, spec in given.items():  # parameters that follow from the factors, with their expression
        if name not in view.factors and name in view.table and _spec(spec).startswith("=") and view.levels(name):
            levels = view.levels(name)
            values = _range(levels) if view.numeric(name) else ", ".join(map(str, levels[:6]))
            rows.append(_row(name, levels, values, spec))
    return rows


def _row(name: str, levels: list[Any], values: str, spec: Any) -> dict[str, Any]:
    p = PARAMETERS.get(name)
    told = {"name": capital(long_name(name)), "symbol": _symbol(p.symbol) if p else ("", "")}
    told |= {"unit": unit_text(p.unit) if p else "", "values": values}
    return told | {"count": len(levels), "spec": _spec(spec)}


def _range(levels: list[float]) -> str:
    return " … ".join(near(v, levels[-1] - levels[0]) for v in (levels[0], levels[-1]))


def _symbol(symbol: str) -> tuple[str, str]:
    """Letter and index: 'r_C,TR' as ('r', 'C,TR')."""
    letter, _, index = {"alpha": "α", "mu": "μ"}.get(symbol, symbol).partition("_")
    return letter, index


def _spec(spec: Any) -> str:
    """A factor of the study file in words: 'uniform 0.1, 0.3'."""
    if not isinstance(spec, Mapping):
        return ""
    if "weights" in spec:
        return f"drawn with weights {', '.join(f'{v:g}' for v in spec['weights'])}"
    for kind, value in spec.items():
        if kind in ("uniform", "loguniform", "normal", "truncnormal", "triangular", "linspace", "logspace"):
            return f"{kind} {', '.join(f'{v:g}' for v in value)}"
        if kind == "expression":
            return f"= {value}"
    return ""


def correlation_row(view: StudyView) -> list[tuple[str, str]]:
    """Return the rank correlations of the study file as one row, if there are any."""
    said = [
        f"{long_name(one)} with {long_name(other)} {number(rho)}"
        for one, other, rho in view.study.get("rank_correlations", ())
    ]
    return [("Rank correlations", "; ".join(said))] if said else []


def base_table(view: StudyView, ds: xr.Dataset) -> Table:
    """List the parameters that are the same in all cases."""
    rows = []
    for name, p in PARAMETERS.items():
        if name in view.factors or name in view.table:
            continue
        value = view.base.get(name)
        if isinstance(value, (int, float)) and not np.isnan(value):
            rows.append(
                {
                    "name": capital(p.long_name),
                    "symbol": _symbol(p.symbol),
                    "value": number(float(value)),
                    "unit": unit_text(p.unit),
                }
            )
    if "material_pair" not in view.factors:
        for name in ("roller_material", "guide_material"):
            value = view.base.get(name)
            if name not in view.factors and value is not None:
                value = value.get("name", "inline") if isinstance(value, Mapping) else value
                rows.append({"name": capital(plain(name)), "symbol": ("", ""), "value": str(value), "unit": ""})
    for name in MAPPING_FIELDS:
        if name not in view.table and view.base.get(name):
            text = level_text(name, str(view.base[name]))
            rows.append({"name": capital(plain(name)), "symbol": ("", ""), "value": text, "unit": ""})
    return rows


def materials_table(attrs: Mapping[str, Any]) -> Table:
    """List the values of the materials used, as stored in the result."""
    try:
        stored = json.loads(str(attrs.get("materials", "{}")))
    except ValueError:
        return []
    columns = (
        ("youngs_modulus", 1),
        ("poisson_ratio", 1),
        ("tensile_strength", 1),
        ("fatigue_strength_ratio", 1),
        ("cycles_at_tensile_strength", 1),
        ("cycles_at_fatigue_limit", 1),
    )
    rows = []
    for name, values in stored.items() if isinstance(stored, Mapping) else ():
        if isinstance(values, Mapping):
            row = {key: number(float(values[key])) for key, _ in columns if _is_number(values.get(key))}
            rows.append({"name": name, "source": material_source(values), **row})
    return rows


def material_source(values: Mapping[str, Any]) -> str:
    """Return where the values of a material come from, and which of them are guesses."""
    source = "; ".join(dict.fromkeys(values.get("sources", {}).values())) or "not given"
    guesses = values.get("guesses", ())
    return f"{source}." + (f" Guesses without a source: {', '.join(map(plain, guesses))}." if guesses else "")


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def record_table(attrs: Mapping[str, Any], skip: set[str]) -> list[tuple[str, str]]:
    """List the global attributes that are needed to repeat the result.

    Mappings are taken apart.
    """
    rows = []
    for key, value in attrs.items():
        if key in skip:
            continue
        text = str(value)
        if text.startswith("{"):
            try:
                text = ", ".join(f"{k} {v}" for k, v in json.loads(text).items())
            except (ValueError, AttributeError):
                pass
        rows.append((capital(plain(str(key))), text))
    return rows
