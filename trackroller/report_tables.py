"""What the report says in tables: factors, regimes and warnings with their causes, best and worst designs."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.parameters import MAPPING_FIELDS, PARAMETERS
from trackroller.plots import style
from trackroller.plots.study_view import StudyView, study_settings

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

SPREAD = 0.1  # a factor whose levels differ less than this in the share of cases is not named as a cause
FEWEST = 5  # rare events tell no cause
BEST = 5  # designs in the tables of best and worst
Table = list[dict[str, Any]]


def factor_table(view: StudyView) -> Table:
    """One row a factor: name, symbol, unit, values as set in the study file (or as found), number of them."""
    given = study_settings(view.attrs).get("factors", {})
    rows = []
    for name in view.factors:
        levels, p = view.levels(name), PARAMETERS.get(name)
        few = view.grid or len(levels) <= 12 or not view.numeric(name)
        if few:
            words = name in ("motor_force", "guide_curve_radius")
            values = ", ".join(style.level_text(name, v, unit=words) for v in levels)
        else:
            values = _range(levels)
        rows.append(
            {
                "name": style.capital(style.long_name(name)),
                "symbol": _symbol(p.symbol) if p else ("", ""),
                "unit": style.unit_text(p.unit) if p else "",
                "values": values,
                "count": len(levels),
                "spec": _spec(given.get(name)) if isinstance(given, Mapping) else "",
            }
        )
    return rows + _derived(view, given if isinstance(given, Mapping) else {})


def _derived(view: StudyView, given: Mapping[str, Any]) -> Table:
    """Rows of parameters that follow from the factors: their range and the expression."""
    rows = []
    for name, spec in given.items():
        if name in view.factors or name not in view.table or not _spec(spec).startswith("="):
            continue
        levels, p = view.levels(name), PARAMETERS.get(name)
        if not levels:
            continue
        rows.append(
            {
                "name": style.capital(style.long_name(name)),
                "symbol": _symbol(p.symbol) if p else ("", ""),
                "unit": style.unit_text(p.unit) if p else "",
                "values": _range(levels) if view.numeric(name) else ", ".join(map(str, levels[:6])),
                "count": len(levels),
                "spec": _spec(spec),
            }
        )
    return rows


def _range(levels: list[float]) -> str:
    return " … ".join(style.near(v, levels[-1] - levels[0]) for v in (levels[0], levels[-1]))


def _symbol(symbol: str) -> tuple[str, str]:
    """Letter and index: 'r_C,TR' as ('r', 'C,TR')."""
    letter, _, index = {"alpha": "α", "mu": "μ"}.get(symbol, symbol).partition("_")
    return letter, index


def _spec(spec: Any) -> str:
    """A factor of the study file in words: 'uniform 0.1, 0.3'."""
    if not isinstance(spec, Mapping):
        return ""
    for kind, value in spec.items():
        if kind in ("uniform", "loguniform", "normal", "truncnormal", "triangular", "linspace", "logspace"):
            return f"{kind} {', '.join(f'{v:g}' for v in value)}"
        if kind == "expression":
            return f"= {value}"
    return ""


def base_table(view: StudyView, ds: xr.Dataset) -> Table:
    """Parameters that are the same in all cases."""
    rows = []
    for name, p in PARAMETERS.items():
        if name in view.factors or name in view.table:
            continue
        value = view.base.get(name)
        if isinstance(value, (int, float)) and not np.isnan(value):
            rows.append(
                {
                    "name": style.capital(p.long_name),
                    "symbol": _symbol(p.symbol),
                    "value": style.number(float(value)),
                    "unit": style.unit_text(p.unit),
                }
            )
    if "material_pair" not in view.factors:
        for name in ("roller_material", "guide_material"):
            value = view.base.get(name)
            if name not in view.factors and value is not None:
                value = value.get("name", "inline") if isinstance(value, Mapping) else value
                rows.append(
                    {"name": style.capital(style.plain(name)), "symbol": ("", ""), "value": str(value), "unit": ""}
                )
    for name in MAPPING_FIELDS:
        if name not in view.table and view.base.get(name):
            text = style.level_text(name, str(view.base[name]))
            rows.append({"name": style.capital(style.plain(name)), "symbol": ("", ""), "value": text, "unit": ""})
    return rows


def causes(view: StudyView, hit: np.ndarray) -> list[str]:
    """The factor levels that an event goes with: up to three factors, the levels with the largest shares.

    Parameters
    ----------
    hit : does the event happen in this case? shape (n,)
    """
    from trackroller.plots.study_effects import groups

    total = float(hit.mean())
    if not 0 < total < 1:
        return ["all cases"] if total else []
    if hit.sum() < FEWEST and total < SPREAD:
        return []
    found = []
    for name in view.factors:
        labels, members = groups(view, name, view.table[name].to_numpy(), unit=True)
        shares = np.array([hit[m].mean() if m.any() else np.nan for m in members])
        if np.isfinite(shares).sum() > 1:
            found.append((float(np.nanmax(shares) - np.nanmin(shares)), name, labels, shares))
    said = []
    for spread, name, labels, shares in sorted(found, key=lambda item: -item[0])[:3]:
        if spread < min(SPREAD, total):
            continue
        above = [i for i in np.argsort(-np.nan_to_num(shares), kind="stable") if shares[i] > total][:3]
        levels = ", ".join(f"{labels[i]} ({_percent(shares[i])})" for i in sorted(above))
        said.append(f"{style.long_name(name)}: {levels}")
    return said or ["no single factor"]


def _percent(share: float) -> str:
    if 0 < share < 0.01:
        return "<\u00a01\u00a0%"
    return f"{100 * share if share == 1 else min(100 * share, 99.0):.0f}\u00a0%"


def regime_table(view: StudyView) -> Table:
    """Cases in each regime and the factor levels that go with it."""
    if "regime" not in view.table:
        return []
    regime = view.table["regime"].to_numpy()
    rows = []
    for code, name in enumerate(style.REGIME_LABELS):
        hit = regime == code
        rows.append(
            {
                "name": name,
                "count": int(hit.sum()),
                "share": _percent(float(hit.mean())) if len(hit) else "–",
                "causes": causes(view, hit) if code else [],
            }
        )
    return rows


def validity_table(view: StudyView, ds: xr.Dataset) -> Table:
    """Cases that carry each warning, what it means and the factor levels that go with it."""
    if "validity" not in view.table or "validity" not in ds:
        return []
    attrs = ds["validity"].attrs
    names = str(attrs.get("flag_meanings", "")).split()
    masks = np.atleast_1d(attrs.get("flag_masks", [1 << i for i in range(len(names))]))
    meanings = _meanings(str(attrs.get("comment", "")), names)
    bits = np.nan_to_num(view.table["validity"].to_numpy()).astype(np.int64)
    rows = []
    for name, mask in zip(names, masks, strict=False):
        hit = (bits & int(mask)) != 0
        rows.append(
            {
                "name": style.plain(name),
                "meaning": meanings.get(name, ""),
                "count": int(hit.sum()),
                "share": _percent(float(hit.mean())),
                "causes": causes(view, hit),
            }
        )
    return rows


def _meanings(comment: str, names: list[str]) -> dict[str, str]:
    """'static: R_m exceeded; yield: ...' taken apart at the flag names."""
    if not names:
        return {}
    parts = re.split(rf"(?:^|; )({'|'.join(map(re.escape, names))}): ", comment)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def reasons(ds: xr.Dataset) -> Table:
    """Why cases failed, the most frequent reason first."""
    if "reason" not in ds:
        return []
    texts, counts = np.unique(ds["reason"].values.astype(str), return_counts=True)
    rows = [{"reason": t, "count": int(c)} for t, c in zip(texts, counts, strict=True) if t]
    return sorted(rows, key=lambda r: -r["count"])[:5]


def ranked(view: StudyView) -> tuple[str, pd.DataFrame, pd.DataFrame] | None:
    """What designs are ranked by, the best (rolling ones only) and the worst; None when nothing ranks them."""
    table = view.table
    if view.life is not None:
        column, words, unit = view.life
        label, better = f"{words[0].lower()}{words[1:]} ({unit})", False
    else:
        column = next((c for c in ("peak_stress_roller", "peak_stress_guide") if view.has(c)), "")
        label, better = "peak von Mises stress (MPa)", True
    if not column:
        return None
    regime = table["regime"] if "regime" in table else 0
    known = table[table[column].notna() & (regime != 3)]
    keys, rising = [column], [better]
    if "peak_stress_roller" in table and column != "peak_stress_roller":
        keys, rising = [*keys, "peak_stress_roller"], [*rising, True]
    known = known.sort_values(keys, ascending=rising, kind="stable")
    rolling = known[known["regime"] == 0] if "regime" in known else known
    if known.empty:
        return None
    return label, rolling.head(BEST), known.iloc[::-1].head(BEST)


def design_rows(view: StudyView, designs: pd.DataFrame) -> list[tuple[str, list[str]]]:
    """Designs as columns: one row a factor or result, so that any number of factors fits a page."""
    rows = []
    for name in view.factors:
        parameter = PARAMETERS.get(name)
        words = style.capital(style.long_name(name))
        special = name in ("motor_force", "guide_curve_radius")
        unit = "" if special or parameter is None or parameter.unit == "-" else f" [{style.unit_text(parameter.unit)}]"
        rows.append((words + unit, [style.level_text(name, v, unit=special) for v in designs[name]]))
    results = [
        ("roller_life_hours", "Life of the roller [h]"),
        ("guide_life_hours", "Life of the guide [h]"),
        ("life_cycles_roller", "Overrollings of the roller"),
        ("life_cycles_guide", "Overrollings of the guide"),
        ("peak_stress_roller", "Peak stress, roller [MPa]"),
        ("peak_stress_guide", "Peak stress, guide [MPa]"),
    ]
    for column, words in results:
        if column in designs and designs[column].notna().any():
            rows.append((words, ["unlimited" if np.isposinf(v) else style.rounded(v, 4) for v in designs[column]]))
    if "at_surface_roller" in designs:
        places = {1.0: "at the surface", 0.0: "below the surface"}
        rows.append(("Peak stress of the roller", [places.get(v, "–") for v in designs["at_surface_roller"]]))
    if "regime" in designs:
        rows.append(("Regime", [style.REGIME_LABELS[int(v)] for v in designs["regime"]]))
    return rows


def materials_table(attrs: Mapping[str, Any]) -> Table:
    """Values of the materials used, as stored in the result."""
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
            row = {key: style.number(float(values[key])) for key, _ in columns if _is_number(values.get(key))}
            rows.append({"name": name, **row})
    return rows


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def record_table(attrs: Mapping[str, Any], skip: set[str]) -> list[tuple[str, str]]:
    """What is needed to repeat the result: every other global attribute, mappings taken apart."""
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
        rows.append((style.capital(style.plain(str(key))), text))
    return rows
