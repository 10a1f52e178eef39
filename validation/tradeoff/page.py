"""The numbers of the page on error against cost."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from trackroller.contact.kalker import correction
from trackroller.errors import InputError
from trackroller.parameters.contact_models import DECLARED
from trackroller.roller.accuracy import (
    ELEMENTS,
    PROMISES,
    accuracy_settings,
    rounded_up,
)
from trackroller.roller.stages import ellipse_stresses
from trackroller.study.cost import rate
from validation.benchmarks.trade import COMPLETE, QUANTITIES

PLANNED = ("preview", 0.1, 0.03, 0.01, 0.003, "standard", "reference")
MODELS = ("sliding", "kalker")
TOLERANCES = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5)


def facts(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the template `tradeoff.md` shows.

    Parameters
    ----------
    data : mapping
        With `validation.tradeoff.summary.summary` under `tradeoff`, the index of its figures, and `trade`.

    Returns
    -------
    dict
        `tolerances` and others, rows of tables; `counts`, `promises` and `limits` in words; `life`; `cost_figures`.
    """
    summary = data["tradeoff"]
    sample = summary["sample"]
    return _trade(data["trade"]) | {
        "counts": ", ".join(f"{sample[f'designs_{m}']:,} for `{m}`" for m in MODELS if f"designs_{m}" in sample),
        "tolerances": [(f"{t:g}", *(_settings(t, model) for model in MODELS)) for t in TOLERANCES],
        "promises": ". ".join(
            f"`{name}` allows {peak:g} of the peak and {force:g} of the forces, "
            f"with {ELEMENTS[name]} elements in `kalker`"
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
        hit = re.search(
            r"reaches here is ([\d.e-]+)|= [\d.e-]+ is not usable. Allowed: ([\d.e-]+) or more", str(refusal)
        )
        return "refused: " + (f"reaches {hit[1] or hit[2]}" if hit else "out of reach")
    if DECLARED[model].by_case:
        return f"{s.elements} to {2**s.doublings * s.elements} elements, by patch"
    p = s.peak
    size = f"{s.force_nodes} nodes" if model == "sliding" else f"{s.elements} elements"
    return f"{size}, {p.scan}/{p.climb}/{p.polish}/{p.summit}, {p.seeds} seeds"


def _trade(measured: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables of `validation.benchmarks.trade`, and what `plan` expects by its costs."""
    rows = [
        (
            f"`{row['model']}`",
            f"`{row['accuracy']}`",
            f"{row['complete']:.2g}",
            f"{row['forces']:.2g}",
            *(_error(float(row["errors"][name][2])) for name in QUANTITIES),
            f"{100 * row['missed']:.2g} %",
        )
        for row in measured["rows"]
    ]
    columns = [*next(iter(measured["by_sample"].values()))]
    samples = [(name, *(f"{own[word]:.2g}" for word in columns)) for name, own in measured["by_sample"].items()]
    parts = [(name, *(f"{part['0.01']:.2g}" for part in own)) for name, own in measured["by_part"].items()]
    plan = []
    for model in dict.fromkeys(row["model"] for row in measured["rows"]):
        served = [row["accuracy"] for row in measured["rows"] if row["model"] == model]
        expected = {a: 1e5 / 3600 / rate({"contact_model": model, "accuracy": a, "outputs": COMPLETE}) for a in served}
        plan.append((f"`{model}`", *(f"{expected[a]:.2g}" if a in expected else "refused" for a in PLANNED)))
    return {
        "trade_rows": rows,
        "columns": ["what varies", *(f"`{word}`" for word in columns)],
        "sample_rows": samples,
        "part_rows": parts,
        "plan_columns": ["model", *(f"`{accuracy}`" for accuracy in PLANNED)],
        "plan_rows": plan,
    }


def _error(value: float) -> str:
    return "< 1e-15" if value < 1e-15 else f"{rounded_up(value):.1e}"
