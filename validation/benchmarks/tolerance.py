"""Count how many cases of a new sample `accuracy=TOLERANCE` keeps within its tolerance.

    python -m validation.benchmarks.tolerance [--cases N] [--seed S] [--model NAME] [--tolerances T ...]

Every quantity with a tolerance counts (F_N, F_T and F_A, M_R, peak stress; the worst of both contacts and
bodies), against the reference of the trade-off. The sample is drawn like the one the settings were measured on,
with another seed. Printed: share of cases within, share with the flag `tolerance_missed`, and percentiles of error over
tolerance. Kalker's reference takes seconds a case.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.errors import InputError
from trackroller.roller.accuracy import FORCE_QUANTITIES, accuracy_settings
from trackroller.roller.dataset import validity_bit
from trackroller.roller.solver import solve
from validation.benchmarks.command import run
from validation.tradeoff.errors import percentiles, relative_errors
from validation.tradeoff.measure import reference_solution
from validation.tradeoff.sample import sample

OUTPUTS = ("forces", "contact", "peak_stress", "life")
TOLERANCES = (3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4)
QUANTITIES = (*FORCE_QUANTITIES, "peak_stress")


def measure(
    cases: int = 500, seed: int = 987, model: str = "sliding", tolerances: tuple[float, ...] = TOLERANCES
) -> dict[str, Any]:
    """Return one record for each tolerance: its settings, the share of cases within it, and percentiles of errors."""
    drawn = sample(cases, seed)
    reference, _ = reference_solution(drawn, model, OUTPUTS)
    records = []
    for tolerance in tolerances:
        try:
            settings = accuracy_settings(tolerance, model, OUTPUTS)
        except InputError as refusal:
            records.append({"tolerance": tolerance, "refused": str(refusal)})
            continue
        result = solve(drawn, outputs=OUTPUTS, contact_model=model, accuracy=tolerance)
        errors = relative_errors(result, reference)
        worst = np.max([errors[name] for name in QUANTITIES], axis=0)
        missed = result.validity.values & validity_bit("tolerance_missed") != 0
        median, p95, p99 = (float(v) for v in percentiles(worst / tolerance))
        records.append(
            {
                "tolerance": tolerance,
                "within": float(np.mean(worst <= tolerance)),
                "missed": float(np.mean(missed)),
                "within_if_not_missed": float(np.mean(worst[~missed] <= tolerance)),
                "error_over_tolerance": {"median": median, "95": p95, "99": p99},
                "within_by_quantity": {name: float(np.mean(errors[name] <= tolerance)) for name in QUANTITIES},
                "elements": settings.elements if model != "sliding" else None,
                "force_nodes": settings.force_nodes,
                "peak": list(vars(settings.peak).values()),
                "worst": [int(i) for i in np.argsort(-worst)[:5]],
            }
        )
    return {"records": records}


if __name__ == "__main__":
    run(measure, __doc__)
