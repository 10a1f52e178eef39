"""Count how many cases of a new sample `accuracy=TOLERANCE` keeps within its tolerance.

    python -m validation.benchmarks.tolerance [--cases N] [--seed S] [--model NAME] [--ordinary] [--tolerances T ...]

Every quantity with a tolerance counts (F_N, F_T and F_A, M_R, friction work, peak stress; the worst of both contacts
and bodies). The sample is drawn like the one the settings were measured on, with another seed, or from `ordinary`
rollers. The reference is that of the trade-off. A model that meets tolerances case by case is compared with 80 elements
and with windows that are finer than any tolerance asks for: elements alone miss peaks at small adhesion areas by up to
13 %.
Printed: share of cases within, share with the flag `tolerance_missed`, and percentiles of error over tolerance.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from trackroller.errors import InputError
from trackroller.parameters.contact_models import DECLARED
from trackroller.roller.accuracy import FORCE_QUANTITIES, PRESETS, accuracy_settings
from trackroller.roller.dataset import validity_bit
from trackroller.roller.solver import solve
from validation.benchmarks.command import run
from validation.benchmarks.samples import random_designs
from validation.tradeoff.errors import percentiles, relative_errors
from validation.tradeoff.measure import reference_solution
from validation.tradeoff.sample import sample

OUTPUTS = ("forces", "contact", "friction_work", "peak_stress", "life")
TOLERANCES = (3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4)
QUANTITIES = (*FORCE_QUANTITIES, "friction_energy", "peak_stress")


def _reference(cases: list[Any], model: str) -> Any:
    """Return the solution that results are compared with."""
    if not DECLARED[model].by_case:
        return reference_solution(cases, model, OUTPUTS)[0]
    finest = replace(PRESETS["reference"], elements=80, peak_goal=1e-3)
    best = solve(cases, outputs=OUTPUTS, contact_model=model, accuracy=finest)
    return best.assign(friction=("case", [case.friction_coefficient for case in cases]))


def measure(
    cases: int = 500,
    seed: int = 987,
    model: str = "sliding",
    ordinary: bool = False,
    tolerances: tuple[float, ...] = TOLERANCES,
) -> dict[str, Any]:
    """Return one record for each tolerance: its settings, the share of cases within it, and percentiles of errors."""
    drawn = random_designs(cases, seed) if ordinary else sample(cases, seed)
    reference = _reference(drawn, model)
    rolls = (reference.regime.values <= 1) & (reference.converged.values == 1)
    records = []
    for tolerance in tolerances:
        try:
            settings = accuracy_settings(tolerance, model, OUTPUTS)
        except InputError as refusal:
            records.append({"tolerance": tolerance, "refused": str(refusal)})
            continue
        result = solve(drawn, outputs=OUTPUTS, contact_model=model, accuracy=tolerance)
        errors = relative_errors(result, reference)
        by_quantity = {name: np.nan_to_num(errors[name][rolls]) for name in QUANTITIES}  # NaN: no friction
        worst = np.max(list(by_quantity.values()), axis=0)
        missed = (result.validity.values & validity_bit("tolerance_missed") != 0)[rolls]
        median, p95, p99 = (float(v) for v in percentiles(worst / tolerance))
        records.append(
            {
                "tolerance": tolerance,
                "within": float(np.mean(worst <= tolerance)),
                "missed": float(np.mean(missed)),
                "within_if_not_missed": float(np.mean(worst[~missed] <= tolerance)),
                "error_over_tolerance": {"median": median, "95": p95, "99": p99},
                "within_by_quantity": {name: float(np.mean(off <= tolerance)) for name, off in by_quantity.items()},
                "elements": settings.elements if model != "sliding" else None,
                "force_nodes": settings.force_nodes,
                "peak": list(vars(settings.peak).values()),
                "worst": [int(i) for i in np.flatnonzero(rolls)[np.argsort(-worst)[:5]]],
            }
        )
    return {"records": records}


if __name__ == "__main__":
    run(measure, __doc__)
