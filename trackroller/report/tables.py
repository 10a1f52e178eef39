"""What the report says of results in tables: regimes and warnings with their causes, best and worst designs."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.parameters import PARAMETERS
from trackroller.report.figures import style
from trackroller.report.figures.study_view import StudyView

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

SPREAD = 0.1  # a factor whose levels differ less than this in the share of cases is not named as a cause
FEWEST = 5  # rare events tell no cause
BEST = 5  # designs in the tables of best and worst
Table = list[dict[str, Any]]


def causes(view: StudyView, hit: np.ndarray) -> list[str]:
    """The factor levels that an event goes with: up to three factors, the levels with the largest shares.

    Parameters
    ----------
    hit : does the event happen in this case? shape (n,)
    """
    from trackroller.report.figures.study_effects import groups

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
    """Why cases failed or miss their tolerance, the most frequent reason first."""
    if "reason" not in ds:
        return []
    texts, counts = np.unique(ds["reason"].values.astype(str), return_counts=True)
    rows = [{"reason": t, "count": int(c)} for t, c in zip(texts, counts, strict=True) if t]
    return sorted(rows, key=lambda r: -r["count"])[:5]


def ranked(view: StudyView) -> tuple[str, pd.DataFrame, pd.DataFrame] | None:
    """What designs are ranked by, the best (rolling ones only) and the worst; None when nothing ranks them.

    Of a study with several contact models only the most exact one ranks: the models are no designs.
    """
    model = only_model(view)
    table = view.table if model is None else view.table[view.table["contact_model"] == model]
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


def only_model(view: StudyView) -> str | None:
    """The contact model by which designs are ranked, where a study has several."""
    return str(view.held_level("contact_model")) if "contact_model" in view.factors else None


def design_rows(view: StudyView, designs: pd.DataFrame) -> list[tuple[str, list[str]]]:
    """Designs as columns: one row a factor or result, so that any number of factors fits a page."""
    rows = []
    for name in (n for n in view.factors if n != "contact_model"):
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
