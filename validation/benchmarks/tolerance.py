"""Does a numeric tolerance hold? On a fresh sample: the share of cases that `accuracy=TOLERANCE` keeps within it.

    python -m validation.benchmarks.tolerance [--cases N] [--seed S] [--model sliding] [--tolerances 1e-2 1e-3]

Every quantity that the tolerance speaks of counts (F_N, F_T and F_A, M_R, peak stress; the worst of both contacts and
bodies), against the reference of the trade-off. The sample is drawn like the one the settings were measured on,
with another seed. Printed: share of cases within, and percentiles of error over tolerance. Kalker's reference takes
seconds a case.
"""

from __future__ import annotations

import argparse
import json
from typing import Any

import numpy as np

from trackroller.errors import InputError
from trackroller.roller.accuracy import FORCE_QUANTITIES, accuracy_settings
from trackroller.roller.solver import solve
from validation.tradeoff.errors import percentiles, relative_errors
from validation.tradeoff.measure import cpu, reference_solution
from validation.tradeoff.sample import sample

OUTPUTS = ("forces", "contact", "peak_stress", "life")
QUANTITIES = (*FORCE_QUANTITIES, "peak_stress")


def check(tolerances: list[float], count: int, seed: int, model: str) -> list[dict[str, Any]]:
    """Return one record for each tolerance: settings, share of cases within it and CPU time of a case."""
    cases = sample(count, seed)
    reference, _ = reference_solution(cases, model, OUTPUTS)
    records = []
    for tolerance in tolerances:
        try:
            settings = accuracy_settings(tolerance, model, OUTPUTS)
        except InputError as refusal:
            records.append({"tolerance": tolerance, "refused": str(refusal)})
            continue
        result, seconds = cpu(solve, cases, outputs=OUTPUTS, contact_model=model, accuracy=tolerance)
        errors = relative_errors(result, reference)
        worst = np.max([errors[name] for name in QUANTITIES], axis=0)
        median, p95, p99 = (float(v) for v in percentiles(worst / tolerance))
        records.append(
            {
                "tolerance": tolerance,
                "cases": len(cases),
                "within": float(np.mean(worst <= tolerance)),
                "error_over_tolerance": {"median": median, "95": p95, "99": p99},
                "within_by_quantity": {name: float(np.mean(errors[name] <= tolerance)) for name in QUANTITIES},
                "cpu_ms": round(1e3 * seconds / len(cases), 3),
                "elements": settings.elements if model != "sliding" else None,
                "force_nodes": settings.force_nodes,
                "peak": list(vars(settings.peak).values()),
                "worst": [int(i) for i in np.argsort(-worst)[:5]],
            }
        )
    return records


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=500)
    parser.add_argument("--seed", type=int, default=987)
    parser.add_argument("--model", choices=("sliding", "fastsim", "kalker"), default="sliding")
    parser.add_argument("--tolerances", type=float, nargs="+", default=[3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4])
    args = parser.parse_args()
    if args.cases < 1:
        parser.error("--cases must be at least 1")
    print(json.dumps(check(args.tolerances, args.cases, args.seed, args.model), indent=2))


if __name__ == "__main__":
    main()
