"""Measure what each limit costs, and how its results converge with the elements of the patch.

    python -m validation.benchmarks.limits [--cases N] [--seed S] [--elements N ...] [--finest N]

Random designs with `kalker`. The cost is processor time beyond a complete case (forces, contact, four peaks, life) at
`standard`, over that of the complete case. An error is the relative change of a result from the elements of `standard`
to the finest number, the largest over contacts and bodies; the order is the slope of its median over the elements.
`verdict` has the cost of all limits with and without heat, and with the bounds that a study takes (`at_most`), beside
a complete case of `kalker` and of `sliding`.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

import trackroller as tr
from trackroller.damage import LIMITS
from trackroller.parameters import OPTIONS
from trackroller.parameters.accuracy import PRESETS
from validation.benchmarks.command import run
from validation.benchmarks.samples import random_designs
from validation.benchmarks.speed import COMPLETE, costs
from validation.tradeoff.errors import largest, observed_order, percentiles

# what the limits from forces alone and the bulk temperature ask for
GIVEN: dict[str, Any] = {
    "bearing": {
        **{"rows": 2, "row_distance": 8.0, "kind": "ball", "dynamic_rating": 4000.0, "static_rating": 2000.0},
        **{"e": 0.27, "X": 0.56, "Y": 1.6, "X0": 0.6, "Y0": 0.5},
    },
    "catalogue": {"radial_force": 800.0, "axial_force": 300.0, "moment": 4000.0, "basic_life": 100.0, "law": "dry"},
    "guide_overrollings_per_hour": 100.0,
    "heat_transfer_coefficient": 20.0,
    "cooled_area": 5000.0,
    "permissible_wear_depth": 0.05,
}
RESULTS = {
    "shakedown": ("elastic_utilisation", "shakedown_utilisation"),
    "heat": ("flash_temperature_rise", "heat_partition", "hysteresis_moment"),
    "wear": ("wear_depth_per_overrolling", "wear_volume_per_km"),
    "multiaxial": ("von_mises_amplitude", "findley_stress", "dang_van_stress"),
}


def cost(cases: list[tr.Case]) -> dict[str, float]:
    """Return the cost of each group of limits beyond a complete case, over that of the complete case."""
    groups = [limit.group for limit in LIMITS.values() if limit.group not in COMPLETE]
    settings = {group: {"contact_model": "kalker", "outputs": (*COMPLETE, group)} for group in dict.fromkeys(groups)}
    spent = costs(cases, {"complete": {"contact_model": "kalker"}} | settings)
    return {group: spent[group] / spent["complete"] - 1.0 for group in settings}


def cost_of_verdict(cases: list[tr.Case]) -> dict[str, dict[str, float]]:
    """Return the cost of all limits beyond a complete case with friction work, over that case, by contact model."""
    complete = (*COMPLETE, "friction_work")
    cold = [dataclasses.replace(case, heat_transfer_coefficient=None, cooled_area=None) for case in cases]
    bounded = {"at_most": tuple(OPTIONS["at_most"].values)}
    found = {}
    for model in ("kalker", "sliding"):
        given = {"contact_model": model, "outputs": complete}
        judged = given | {"outputs": (*complete, "limits")}
        spent = costs(cold, {"complete": given, "numbers": judged, "bounds": judged | bounded})
        spent |= {f"{name} with heat": time for name, time in costs(cases, {"bounds": judged | bounded}).items()}
        found[model] = {name: time / spent["complete"] - 1.0 for name, time in spent.items() if name != "complete"}
    return found


def convergence(cases: list[tr.Case], elements: tuple[int, ...], finest: int) -> dict[str, dict[str, float]]:
    """Return the errors at `standard` and the observed order of each result that rests on the elements."""
    counts = sorted({*elements, PRESETS["standard"].elements})

    def solved(count: int) -> Any:
        accuracy = dataclasses.replace(PRESETS["reference"], elements=count)
        return tr.solve(cases, ("forces", *RESULTS), contact_model="kalker", accuracy=accuracy)

    best, found = solved(finest), {count: solved(count) for count in counts}
    rolls = (best.regime.values == 0) & np.all([ds.regime.values == 0 for ds in found.values()], axis=0)
    out = {}
    for name in (name for names in RESULTS.values() for name in names):
        error = {n: largest(np.abs(ds[name].values / best[name].values - 1.0))[rolls] for n, ds in found.items()}
        middle, most = percentiles(error[PRESETS["standard"].elements], (50, 100))
        order, _ = observed_order(np.array(counts), np.array([np.nanmedian(error[n]) for n in counts]))
        out[name] = {"median": middle, "largest": most, "order": order}
    return out


def measure(
    cases: int = 10, seed: int = 5, elements: tuple[int, ...] = (14, 20, 28), finest: int = 56
) -> dict[str, Any]:
    """Return the cost by group of outputs, and errors and order of each result."""
    designs = [dataclasses.replace(case, **GIVEN) for case in random_designs(cases, seed)]
    return {
        "standard": PRESETS["standard"].elements,
        "cost": cost(designs),
        "verdict": cost_of_verdict(designs),
        "results": {group: list(names) for group, names in RESULTS.items()},
        "convergence": convergence(designs, elements, finest),
    }


if __name__ == "__main__":
    run(measure, __doc__)
