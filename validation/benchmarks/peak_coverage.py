"""Compare peaks at `standard` with peaks at `reference`, and count how often `error_estimate` covers the difference.

    python -m validation.benchmarks.peak_coverage [--cases N] [--seed S]

A random sample over friction, angles, radii, curves, loads, materials and drive, wider than for built rollers. A case
counts by its worst peak of up to four (two contacts, two bodies). A peak that only one of the two accuracies finds, or
whose estimate is missing, counts as neither within tolerance nor covered. `reference` is the same method with finer
settings, so errors that both share do not show here; the tests hold the method itself against closed forms.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import trackroller as tr
from trackroller.roller.dataset import VALIDITY_BITS, validity_bit
from validation.benchmarks.command import run

TOLERANCE = 2e-3
CONFORMAL = validity_bit("conformal")
DATABASE = ("1.7225-normalised", "1.7225-quenched-tempered", "EN AW-7075", "PA6", "POM")
LEVELS = (50, 90, 95, 99, 99.9, 100)


def random_material(rng: np.random.Generator) -> Any:
    """Return a material of the database or, one time in three, one with random stiffness and Poisson's ratio."""
    if rng.random() < 2 / 3:
        return str(rng.choice(DATABASE))
    return {"like": DATABASE[0], "youngs_modulus": 10 ** rng.uniform(3.3, 5.4), "poisson_ratio": rng.uniform(0.0, 0.5)}


def random_case(rng: np.random.Generator) -> tr.Case:
    """Return one case; raise `InputError` where the drawn surfaces conform or interlock."""
    load, guide, alpha = 10 ** rng.uniform(0, 3), 10 ** rng.uniform(0.3, 1.3), rng.uniform(10, 80)
    rolling = 10 ** rng.uniform(0.7, 1.7)
    groove = -guide * (1 + 10 ** rng.uniform(-2, 0.5))
    profile = groove if rng.random() < 0.85 else float(rng.choice([math.inf, guide, 5 * guide]))
    curve = float(rng.choice([math.inf, 1, -1])) * 10 ** rng.uniform(1.3, 3)
    drive = int(rng.integers(-1, 2))  # driven, free, braked
    return tr.Case(
        radial_force=-load,
        axial_force=load * rng.uniform(-0.4, 0.4),
        motor_force=drive * load * 10 ** rng.uniform(-2, -0.3),
        friction_coefficient=rng.uniform(0, 1),
        contact_angle=alpha,
        guide_profile_radius=guide,
        roller_profile_radius=profile,
        guide_curve_radius=curve,
        axis_distance=rolling + guide * math.cos(math.radians(alpha)),
        roller_material=random_material(rng),
        guide_material=random_material(rng),
    )


def sample(n: int, seed: int) -> list[tr.Case]:
    """Return `n` cases; draws without point contact are drawn again."""
    rng = np.random.default_rng(seed)
    cases: list[tr.Case] = []
    while len(cases) < n:
        try:
            cases.append(random_case(rng))
        except tr.InputError:
            continue
    return cases


def compare(standard: Any, reference: Any) -> dict[str, np.ndarray]:
    """Return arrays (n, contact, body) by name: `error` (signed), `estimate`, `slack` of the reference, `present`.

    `present` are peaks found by either; one found by only one of them has an infinite error.
    """
    a, b = standard.peak_stress.values, reference.peak_stress.values
    found = np.isfinite(a), np.isfinite(b)
    error = np.where(found[0] & found[1], a / np.where(found[1], b, 1.0) - 1.0, np.inf)
    return {
        "error": error,
        "present": found[0] | found[1],
        "estimate": np.nan_to_num(standard.error_estimate.values, nan=-1.0, posinf=np.inf),
        "slack": np.nan_to_num(reference.error_estimate.values, nan=0.0, posinf=0.0),
    }


def summary(peaks: dict[str, np.ndarray], keep: np.ndarray) -> dict[str, Any]:
    """Return shares and percentiles over the cases `keep` (n,) that have a peak."""
    present = peaks["present"] & keep[:, None, None]
    rows = present.any(axis=(1, 2))
    if not rows.any():
        return {"cases": 0}
    error, estimate, slack = np.abs(peaks["error"]), peaks["estimate"], peaks["slack"]

    def share(good: np.ndarray) -> dict[str, float]:
        return {
            "of_cases": float(np.mean((good | ~present).all(axis=(1, 2))[rows])),
            "of_peaks": float(np.mean(good[present])),
        }

    worst = np.where(present, error, 0.0).max(axis=(1, 2))[rows]
    return {
        "cases": int(rows.sum()),
        "peaks": int(present.sum()),
        "worst_error_of_a_case_percentiles": percentiles(worst),
        "error_of_a_peak_percentiles": percentiles(error[present]),
        "estimate_of_a_peak_percentiles": percentiles(estimate[present]),
        "within_0.2_percent": share(error <= TOLERANCE),
        "covered": share(error <= estimate),
        # the comparison cannot decide differences below the estimated error of `reference`
        "covered_with_slack_of_reference": share(error <= estimate + slack),
        "standard_above_reference_by_0.2_percent": int(np.sum(peaks["error"][present] > TOLERANCE)),
        "found_by_one_only": int(np.sum(~np.isfinite(error[present]))),
        "estimate_above_10_percent": float(np.mean(estimate[present] > 0.1)),
    }


def percentiles(values: np.ndarray) -> dict[str, float]:
    """Return percentiles that are values of the sample, so that an infinite value changes no other percentile."""
    return {f"{p:g}": float(v) for p, v in zip(LEVELS, np.percentile(values, LEVELS, method="higher"), strict=True)}


def worst_cases(
    cases: list[tr.Case], peaks: dict[str, np.ndarray], validity: np.ndarray, keep: np.ndarray, count: int = 5
) -> list[dict[str, Any]]:
    """Return the cases of `keep` with the largest error of a peak, with all inputs to solve them again."""
    error = np.where(peaks["present"] & keep[:, None, None], np.abs(peaks["error"]), -1.0).reshape(len(cases), -1)
    rows = np.argsort(-error.max(axis=1), kind="stable")[:count]
    listed = []
    for i in (int(r) for r in rows if error[r].max() >= 0):
        contact, body = np.unravel_index(int(error[i].argmax()), (2, 2))
        listed.append(
            {
                "index": i,
                "error": float(peaks["error"][i, contact, body]),
                "estimate": float(peaks["estimate"][i, contact, body]),
                "estimate_of_reference": float(peaks["slack"][i, contact, body]),
                "contact": int(contact) + 1,
                "body": ("roller", "guide")[body],
                "validity": [name for k, name in enumerate(VALIDITY_BITS) if validity[i] >> k & 1],
                "case": cases[i].as_dict(),
            }
        )
    return listed


def measure(cases: int = 2000, seed: int = 1) -> dict[str, Any]:
    """Solve the sample twice and compare."""
    drawn, solved, n = sample(cases, seed), {}, cases
    for accuracy in ("standard", "reference"):
        solved[accuracy] = tr.solve(
            drawn, outputs=("contact", "peak_stress"), contact_model="sliding", accuracy=accuracy
        )
    standard, reference = solved["standard"], solved["reference"]
    peaks, validity = compare(standard, reference), standard.validity.values
    conformal = (validity & CONFORMAL) != 0
    ratio = (reference.semi_axis_lateral / reference.semi_axis_rolling).values
    regimes = standard.regime.attrs["flag_meanings"].split()
    return {
        "conformal_cases": int(conformal.sum()),
        "regimes": {name: int(np.sum(standard.regime.values == k)) for k, name in enumerate(regimes)},
        "regimes_that_differ": int(np.sum(standard.regime.values != reference.regime.values)),
        "ellipticity_from_to": [float(np.nanmin(ratio)), float(np.nanmax(ratio))],
        "all": summary(peaks, np.ones(n, dtype=bool)),
        "without_conformal": summary(peaks, ~conformal),
        "worst": worst_cases(drawn, peaks, validity, np.ones(n, dtype=bool)),
        "worst_without_conformal": worst_cases(drawn, peaks, validity, ~conformal),
    }


if __name__ == "__main__":
    run(measure, __doc__)
