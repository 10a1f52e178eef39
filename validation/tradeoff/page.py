"""The numbers of the page on error against cost."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from trackroller.contact.kalker import correction
from trackroller.numerics.numbers import rounded_up
from trackroller.parameters.accuracy import PRESETS, RUNGS
from trackroller.roller.stages import ellipse_stresses
from trackroller.study.cost import rate
from validation.tradeoff.measure import COMPLETE, MODELS, TOLERANCES
from validation.tradeoff.truth import SAMPLES

QUANTITIES = ("normal_force", "friction_force", "peak_stress")
RATIOS = ("peak_stress", "life")
AIM, MOST_OVER = (0.95, 0.99), 5.0  # share of the true errors that told ones cover, and largest ratio of their medians
OUTPUTS = {
    "friction_force": "F_T, F_A over μ F_N",
    "normal_force": "F_N",
    "friction_energy": "friction energy",
    "peak_stress": "peak stress",
    "life": "life",
}


def facts(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the template `tradeoff.md` shows: the rows of its tables, and the limits of the doublings in words.

    Parameters
    ----------
    data : mapping
        With `validation.tradeoff.measure.measure` under `tradeoff`.
    """
    found = data["tradeoff"]
    spent = {(name, r["model"], str(r["accuracy"])): r for name, own in found["costs"].items() for r in own}
    rungs, tolerances, plan = [], [], []
    for row in found["rungs"]:
        for name in SAMPLES:
            exact, cost = row["exact"][name], spent[name, row["model"], row["accuracy"]]
            rungs.append(
                (
                    f"`{row['model']}`",
                    f"`{row['accuracy']}`",
                    name,
                    f"{cost['complete']:.2g}",
                    f"{cost['forces']:.2g}",
                    *(_levels(exact[quantity]) for quantity in QUANTITIES),
                )
            )
    for row in found["tolerances"]:
        for name in SAMPLES:
            own, cost = row[name], spent[name, "kalker", str(row["tolerance"])]
            served = " / ".join(_share(share) for share in own["served"])
            tolerances.append(
                (
                    f"`{row['tolerance']:g}`",
                    name,
                    f"{cost['complete']:.2g}",
                    served,
                    _share(own["missed"]),
                    _share(own["missed_though_kept"]) if own["missed"] else "-",
                    _share(own["kept"]),
                )
            )
    for model in MODELS:
        options = {"contact_model": model, "outputs": COMPLETE}
        plan.append(
            (f"`{model}`", *(f"{1e5 / 3600 / rate(options | {'accuracy': a}):.2g}" for a in (*RUNGS, *TOLERANCES)))
        )
    limits = (
        f"at `{name}` {100 * ellipse_stresses.refined_above(PRESETS[name].elements):.2g} % of the peak or "
        f"{100 * correction.refined_above(PRESETS[name].elements):.2g} % of μ F_N in the friction force"
        for name in ("standard", "reference")
    )
    return {
        "rung_rows": rungs,
        "told_rows": _told_rows(found["told"]),
        "told_beyond": ", ".join(_beyond(found["told"])) or "none",
        "told_designs": found["told"][0]["designs"],
        "ratio_rows": [_ratio_row(row) for row in found["told"]],
        "tolerance_rows": tolerances,
        "plan_columns": ["model", *(f"`{a}`" for a in (*RUNGS, *TOLERANCES))],
        "plan_rows": plan,
        "limits": ", ".join(limits),
    }


def _told_rows(told: Iterable[Mapping[str, Any]]) -> list[tuple[str, ...]]:
    """Return the rows of the table of told against true errors, by contact model, rung and output."""
    return [
        (
            f"`{row['model']}`",
            f"`{row['accuracy']}`",
            OUTPUTS[name],
            *(f"{rounded_up(float(own[level])):.1e}" for level in ("true", "true_95", "told")),
            _share(own["covered"]),
            f"{own['over']:.1f}",
        )
        for row in told
        for name, own in row["checked"].items()
    ]


def _beyond(told: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return the cells that miss the aim: the share that told errors cover, or their median over the true one."""
    return [
        f"{OUTPUTS[name]} of `{row['model']}` at `{row['accuracy']}`"
        for row in told
        for name, own in row["checked"].items()
        if own["over"] > MOST_OVER or not AIM[0] <= own["covered"] <= AIM[1]
    ]


def _ratio_row(row: Mapping[str, Any]) -> tuple[str, ...]:
    errors = (f"{rounded_up(row['ratio'][name]):.1e}" for name in RATIOS)
    covered = (_share(row["ratio_covered"][name]) for name in RATIOS)
    return f"`{row['model']}`", f"`{row['accuracy']}`", *errors, *covered, _share(row["agrees"])


def _share(value: float) -> str:
    return f"{100 * value:.2g} %" if value < 0.995 else f"{100 * value:.4g} %"


def _levels(values: list[float]) -> str:
    return ", ".join("0" if value < 1e-15 else f"{rounded_up(value):.1e}" for value in map(float, values))
