"""Calibrate the told errors of each rung on ordinary designs, and hold them against the true ones on other designs.

Errors are factors: a result of error e lies between the true one over 1 + e and the true one times 1 + e. The true
result is that of the finest settings, of `kalker` for the contact models that approximate it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any
from unittest import mock

import numpy as np
import xarray as xr

import trackroller as tr
from trackroller.parameters.accuracy import RUNGS, Accuracy
from trackroller.parameters.contact_models import DECLARED
from trackroller.roller import solver
from trackroller.roller.told_errors import FORCES, PEAKS, raw_errors
from validation.benchmarks.samples import ordinary_designs

OUTPUTS = ("forces", "contact", "friction_work", "peak_stress", "life")
TRUE_MODEL = {"sliding": "sliding", "kalker_table": "kalker", "kalker": "kalker"}
SEEDS = (7, 8)  # of the designs that calibrate, and of those that check
DESIGNS = 80  # of each sample
COVERED = 0.965  # share of the values that calibrate whose error is told
SHARE_OF_RATIO = 0.95
# Smaller errors count as this one: it is rounding, and no estimate follows it.
ROUNDING = 1e-9
KINDS = {"friction_force": FORCES, "peak_stress": PEAKS, "life": PEAKS}


def neighbours(cases: list[tr.Case]) -> list[tr.Case]:
    """Return another choice for each design: a groove half as open again, or a contact angle 5 degrees flatter."""
    found = []
    for k, case in enumerate(cases):
        gap = -case.roller_profile_radius - case.guide_profile_radius
        wider = replace(case, roller_profile_radius=case.roller_profile_radius - 0.5 * gap)
        found.append(replace(case, contact_angle=case.contact_angle - 5.0) if k % 2 else wider)
    return found


def solved(cases: list[tr.Case], model: str, accuracy: str | Accuracy) -> xr.Dataset:
    """Return the results of designs with errors that are not calibrated."""
    with mock.patch.object(solver, "calibrate", lambda *_: None):
        return tr.solve(cases, OUTPUTS, contact_model=model, accuracy=accuracy)


def true_errors(cases: list[tr.Case], ds: xr.Dataset, best: xr.Dataset) -> dict[str, np.ndarray]:
    """Return the logarithms of the true errors as factors by quantity, (n, contact) or (n, contact, body).

    Errors of friction forces are relative to mu F_N, and no factors. Designs that do not roll in both are NaN.
    """
    mu = np.array([case.friction_coefficient for case in cases])[:, None]
    apart = [(ds[name] - best[name]).values for name in ("lateral_force", "driving_force")]
    found = {"friction_force": np.hypot(*apart) / (mu * best.normal_force.values)}
    for quantity, name in (
        ("normal_force", "normal_force"),
        ("friction_energy", "friction_energy_per_distance"),
        ("peak_stress", "peak_stress"),
        ("life", "life_cycles"),
    ):
        with np.errstate(divide="ignore", invalid="ignore"):
            found[quantity] = np.abs(np.log(ds[name].values / best[name].values))
    rolls = (ds.regime.values == 0) & (best.regime.values == 0)
    return {
        quantity: np.where(rolls.reshape(-1, *(1,) * (error.ndim - 1)), error, np.nan)
        for quantity, error in found.items()
    }


def weights_of(errors: Mapping[str, np.ndarray], ds: xr.Dataset, raw: Mapping[str, np.ndarray]) -> dict[str, float]:
    """Return the factors on the raw errors with which the share COVERED of the values is covered."""
    surface = ds.peak_z.values == 0.0
    asked = {name: (errors[name], raw[name], None) for name in FORCES}
    asked |= {name: (errors["peak_stress"], raw["peak_stress"], surface == (name == "at_surface")) for name in PEAKS}
    found = {}
    for name, (error, told, rows) in asked.items():
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(told > 0.0, np.maximum(error, ROUNDING) / told, np.nan)
        known = share[np.isfinite(share) & (True if rows is None else rows)]
        found[name] = float(np.percentile(known, 100 * COVERED, method="higher")) if known.size else 1.0
    return found


def told_logs(weights: Mapping[str, float], ds: xr.Dataset, raw: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the logarithms of the told errors as factors; those of friction forces are relative to mu F_N."""
    found = {name: raw[name] * weights[name] for name in FORCES}
    surface = ds.peak_z.values == 0.0
    peak = raw["peak_stress"] * np.where(surface, weights["at_surface"], weights["below_surface"])
    with np.errstate(divide="ignore", invalid="ignore"):
        exponent = np.log1p(ds.life_error_estimate.values) / np.log1p(ds.error_estimate.values)
        found = {name: told if name == "friction_force" else np.log1p(told) for name, told in found.items()}
        return found | {"peak_stress": np.log1p(peak), "life": exponent * np.log1p(peak)}


def row_of(error: np.ndarray, told: np.ndarray) -> dict[str, Any]:
    """Return medians of true and told errors as factors less 1, the share that is covered, and of the medians."""
    known = np.isfinite(error) & np.isfinite(told)
    true, said = np.maximum(error[known], ROUNDING), told[known]
    if not true.size:
        return {"true": np.nan, "true_95": np.nan, "told": np.nan, "covered": np.nan, "over": np.nan}
    return {
        "true": float(np.expm1(np.median(true))),
        "true_95": float(np.expm1(np.percentile(true, 95, method="higher"))),
        "told": float(np.expm1(np.median(said))),
        "covered": float(np.mean(true <= said)),
        "over": float(np.median(said) / np.median(true)),
    }


def ratio_errors(ds: xr.Dataset, other: xr.Dataset, best: xr.Dataset, best_other: xr.Dataset) -> dict[str, float]:
    """Return the error that the share SHARE_OF_RATIO of the ratios of two neighbours keeps, as a factor less 1."""
    found = {}
    for quantity, name, of_contacts in (("peak_stress", "peak_stress", "max"), ("life", "life_cycles", "min")):
        one, two, fine, fine_two = (
            np.log(getattr(own[name], of_contacts)("contact")).values for own in (ds, other, best, best_other)
        )
        rolls = np.all([own.regime.values == 0 for own in (ds, other, best, best_other)], axis=0)
        apart = np.abs((one - two) - (fine - fine_two))[rolls]
        apart = apart[np.isfinite(apart)]
        level = np.percentile(apart, 100 * SHARE_OF_RATIO, method="higher") if apart.size else np.nan
        found[quantity] = float(np.expm1(level))
    return found


def agreement(one: tuple[np.ndarray, np.ndarray], other: tuple[np.ndarray, np.ndarray]) -> float:
    """Return the share of peaks of two rungs that agree; each rung has peaks and logarithms of its told errors."""
    apart = np.abs(np.log(one[0] / other[0]))
    known = np.isfinite(apart)
    return float(np.mean((apart <= one[1] + other[1])[known]))


def measure_told(few: int = 0, finest: str | Accuracy = "reference") -> list[dict[str, Any]]:
    """Return weights, rows of the table and errors of a ratio for each contact model and rung.

    Parameters
    ----------
    few : int
        Take so many designs of each sample only.
    finest : Accuracy
        Settings of the true results.
    """
    ordinary, check = (ordinary_designs(few or DESIGNS, seed) for seed in SEEDS)
    samples = ordinary, neighbours(ordinary), check
    best = {model: [solved(cases, model, finest) for cases in samples] for model in {*TRUE_MODEL.values()}}
    rows = []
    for model, true_model in TRUE_MODEL.items():
        peaks = {}
        for rung in RUNGS:
            found = [solved(cases, model, rung) for cases in samples]
            # `kalker` takes the table at `preview`, with its error
            served = (DECLARED[model].cheaper or model) if rung == RUNGS[0] else model
            raws = [raw_errors(ds, cases, served) for ds, cases in zip(found, samples, strict=True)]
            errors = [
                true_errors(cases, ds, own) for cases, ds, own in zip(samples, found, best[true_model], strict=True)
            ]
            both = {name: np.concatenate([errors[0][name], errors[1][name]]) for name in errors[0]}
            raw = {name: np.concatenate([raws[0][name], raws[1][name]]) for name in raws[0]}
            weights = weights_of(both, xr.concat([part[["peak_z"]] for part in found[:2]], "case"), raw)
            told = told_logs(weights, found[2], raws[2])
            peaks[rung] = found[2].peak_stress.values, told["peak_stress"]
            rows.append(
                {
                    "model": model,
                    "accuracy": rung,
                    "weights": weights,
                    "checked": {name: row_of(errors[2][name], told[name]) for name in told},
                    "ratio": ratio_errors(found[0], found[1], *best[true_model][:2]),
                }
            )
        for row in rows[-len(RUNGS) :]:
            row["agrees"] = agreement(peaks[row["accuracy"]], peaks["reference"])
    return rows
