"""The numbers of the page on error against cost."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from trackroller.contact.kalker import correction
from trackroller.errors import InputError
from trackroller.parameters.contact_models import DECLARED
from trackroller.roller.accuracy import (
    BY_CASE_ELEMENTS,
    ELEMENTS,
    GRID_ELEMENTS,
    PROMISES,
    accuracy_settings,
    preset_rungs,
    read_ladders,
    rounded_up,
)
from trackroller.roller.stages import ellipse_stresses
from validation.tradeoff.summary import yardstick

MODELS = ("sliding", "fastsim", "kalker")
TOLERANCES = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5)


def facts(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the template `tradeoff.md` shows.

    Parameters
    ----------
    data : mapping
        With `validation.tradeoff.summary.summary` under `tradeoff`, and the index of its figures.

    Returns
    -------
    dict
        `tolerances` and `preset_rows`, rows of tables; `counts`, `promises` and `limits` in words; `life`;
        `cost_figures`.
    """
    summary = data["tradeoff"]
    sample = summary["sample"]
    return {
        "counts": ", ".join(f"{sample[f'designs_{m}']:,} for `{m}`" for m in MODELS if f"designs_{m}" in sample),
        "tolerances": [(f"{t:g}", *(_settings(t, model) for model in MODELS)) for t in TOLERANCES],
        "preset_rows": _presets(summary),
        "promises": ". ".join(
            f"`{name}` allows {peak:g} of the peak and {force:g} of the forces, with {ELEMENTS[name]} elements in "
            f"`kalker` and {GRID_ELEMENTS[name]} in `fastsim`"
            for name, (peak, force) in PROMISES.items()
        ),
        "limits": ", ".join(
            f"at `{name}` {100 * ellipse_stresses.refined_above(ELEMENTS[name]):.2g} % of the peak or "
            f"{100 * correction.refined_above(ELEMENTS[name]):.2g} % of mu F_N in the friction force"
            for name in ("standard", "reference")
        ),
        "life": summary["life"],
        "cost_figures": [f for f in data["tradeoff_figures"] if "convergence" not in f["name"]],
    }


def _settings(tolerance: float, model: str) -> str:
    """Return the settings that a tolerance takes, or the smallest tolerance that the model keeps."""
    try:
        s = accuracy_settings(tolerance, model)
    except InputError as refusal:
        hit = re.search(r"reaches here is ([\d.e-]+)|= [\d.e-]+ is not usable: ([\d.e-]+) or more", str(refusal))
        return "refused: " + (f"reaches {hit[1] or hit[2]}" if hit else "out of reach")
    if DECLARED[model].by_case:
        return f"{BY_CASE_ELEMENTS[0]} to {BY_CASE_ELEMENTS[-1]} elements, by case"
    p = s.peak
    size = f"{s.force_nodes} nodes" if model == "sliding" else f"{s.elements} elements"
    return f"{size}, {p.scan}/{p.climb}/{p.polish}/{p.summit}, {p.seeds} seeds"


def _presets(summary: dict[str, Any]) -> list[tuple[str, ...]]:
    measured, rows, one = read_ladders(summary["ladders"]), [], yardstick(summary["ladders"])
    for name in summary["presets"]:
        forces, peak = preset_rungs(name, measured)
        pairs = {"sliding": (peak, forces)}
        for model in ("fastsim", "kalker"):
            own = [r for r in measured[model] if r.settings == summary["presets"][name][model]]
            pairs |= {model: (own[0], own[0])} if own else {}
        for model, (whole, part) in pairs.items():
            p, f, n = whole.errors["peak_stress"], part.errors["friction_force"], whole.errors["life"]
            errors = map(_error, (p.median, p.p95, p.p99, f.median, f.p99, n.p99))
            rows.append((f"`{name}`", f"`{model}`", f"{whole.cost / one:.2g}", *errors))
    return rows


def _error(value: float) -> str:
    return "< 1e-15" if value < 1e-15 else f"{rounded_up(value):.1e}"
