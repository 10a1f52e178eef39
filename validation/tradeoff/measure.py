"""Solves the sample with each setting and the reference: errors by design, CPU time a case."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from trackroller.roller.case import Case
from trackroller.roller.solver import solve
from validation.tradeoff.errors import QUANTITIES, relative_errors
from validation.tradeoff.settings import ALL, Setting, references

Patch = dict[str, Any]


def cpu(work: Any, *arguments: Any, **options: Any) -> tuple[Any, float]:
    """Return the result and CPU time [s] of a call, over all threads of the process."""
    start = time.process_time()
    result = work(*arguments, **options)
    return result, time.process_time() - start


def reference_solution(cases: Sequence[Case], model: str, outputs: tuple[str, ...] = ALL) -> tuple[xr.Dataset, float]:
    """Return the best known solution with its friction coefficients, and its CPU time [s] a case."""
    solved, spent = [], 0.0
    for accuracy in references(model):
        ds, seconds = cpu(solve, list(cases), outputs=outputs, contact_model=model, accuracy=accuracy)
        solved.append(ds)
        spent += seconds
    best = solved[0]
    for other in solved[1:]:
        if "peak_stress" in best:
            larger = (other["peak_stress"] > best["peak_stress"]).values
            for name in ("peak_stress", "life_cycles"):
                best[name] = best[name].copy(data=np.where(larger, other[name].values, best[name].values))
    best["friction"] = ("case", np.array([c.friction_coefficient for c in cases], float))
    return best, spent / max(len(cases), 1)


def measure(settings: Sequence[Setting], cases: Sequence[Case], model: str, block: int = 256) -> xr.Dataset:
    """Measure errors (setting, quantity, design) and cost (setting) of complete solutions.

    Settings take turns block by block, so that a busy machine troubles all alike.
    """
    errors = np.full((len(settings), len(QUANTITIES), len(cases)), np.nan)
    spent, reference_cost = np.zeros(len(settings)), 0.0
    for setting in settings:  # compiled and loaded before the clock runs
        _solve(setting, cases[:1], model)
    for first in range(0, len(cases), block):
        part = list(cases[first : first + block])
        reference, seconds = reference_solution(part, model)
        reference_cost += seconds * len(part)
        for i, setting in enumerate(settings):
            result, seconds = cpu(_solve, setting, part, model)
            spent[i] += seconds
            found = relative_errors(result, reference)
            for j, name in enumerate(QUANTITIES):
                if name in found:
                    errors[i, j, first : first + len(part)] = found[name]
    return labelled(settings, errors, spent / len(cases), {"reference_cost": reference_cost / len(cases)})


def _solve(setting: Setting, cases: Sequence[Case], model: str) -> xr.Dataset:
    assert setting.accuracy is not None
    return solve(
        list(cases), outputs=setting.outputs, contact_model=model, accuracy=setting.accuracy, **setting.options
    )


def labelled(settings: Sequence[Setting], errors: np.ndarray, cost: np.ndarray, attrs: dict[str, Any]) -> xr.Dataset:
    """Return one part of the measurement as a data set over setting, quantity and design."""

    def text(values: list[str]) -> tuple[str, np.ndarray]:
        return "setting", np.array(values, dtype=object)

    return xr.Dataset(
        {
            "error": (
                ("setting", "quantity", "design"),
                errors.astype(np.float32),
                {
                    "long_name": "relative error against the converged reference",
                    "units": "1",
                    "comment": "largest over contacts and bodies; inf: other regime; NaN: not of this stage",
                },
            ),
            "cost": ("setting", np.asarray(cost, float), {"long_name": "CPU time a case", "units": "s"}),
            "points": (
                "setting",
                np.array([s.points for s in settings], float),
                {"long_name": "points or elements per length", "units": "1"},
            ),
            "stage": text([s.stage for s in settings]),
            "model": text([s.model for s in settings]),
            "method": text([s.method for s in settings]),
            "label": text([s.label for s in settings]),
            "ladder": text([json.dumps(s.ladder) for s in settings]),
        },
        coords={"quantity": np.array(list(QUANTITIES), dtype=object), "design": np.arange(errors.shape[2])},
        attrs=attrs,
    )
