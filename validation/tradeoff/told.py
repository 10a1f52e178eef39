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
from validation.benchmarks.samples import PUBLISHED, ordinary_designs

OUTPUTS = ("forces", "contact", "friction_work", "peak_stress", "life")
TRUE_MODEL = {"sliding": "sliding", "kalker_table": "kalker", "kalker": "kalker"}
SEEDS = (7, 8)  # of the designs that calibrate, and of those that check
DESIGNS = 400  # of each sample; each has a neighbour besides
COVERED = 0.964  # share of the values that calibrate whose error is told
SHARE_OF_RATIO = 0.95
# Smaller errors count as this one: it is rounding, and no estimate follows it.
ROUNDING = 1e-9


def neighbour(number: int, case: tr.Case) -> tr.Case:
    """Return another choice for a design: of the groove, the contact angle, the size or the material, in turn.

    The groove is half as open again, the angle 5 degrees flatter, or the axis distance a fifth larger.
    """
    if number % 4 == 0:
        gap = -case.roller_profile_radius - case.guide_profile_radius
        return replace(case, roller_profile_radius=case.roller_profile_radius - 0.5 * gap)
    if number % 4 == 1:
        return replace(case, contact_angle=case.contact_angle - 5.0)
    if number % 4 == 2:
        return replace(case, axis_distance=1.2 * case.axis_distance)
    place = PUBLISHED.index(str(case.roller_material))
    return replace(case, roller_material=PUBLISHED[place - 1])


def sample(number: int, seed: int) -> list[tr.Case]:
    """Return `number` ordinary designs and then their neighbours."""
    designs = ordinary_designs(number, seed)
    return designs + [neighbour(k, case) for k, case in enumerate(designs)]


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


def ratio_errors(ds: xr.Dataset, best: xr.Dataset) -> dict[str, np.ndarray]:
    """Return the logarithms of the errors of the ratios of designs and their neighbours by quantity, (n, body).

    The ratios are those of the larger peak and of the shorter life of both contacts. The second half of the 2 n rows
    are the neighbours of the first half. Pairs that do not roll in all four solutions are NaN.
    """
    rolls = ((ds.regime.values == 0) & (best.regime.values == 0)).reshape(2, -1).all(axis=0)
    found = {}
    for quantity, name, of_contacts in (("peak_stress", "peak_stress", "max"), ("life", "life_cycles", "min")):
        errors = np.log(getattr(ds[name], of_contacts)("contact")) - np.log(getattr(best[name], of_contacts)("contact"))
        one, other = np.split(errors.values, 2)
        found[quantity] = np.where(rolls[:, None], np.abs(one - other), np.nan)
    return found


def level_of(errors: np.ndarray) -> float:
    """Return the error that the share SHARE_OF_RATIO of the known errors keeps; NaN if none is known."""
    known = errors[np.isfinite(errors)]
    return float(np.percentile(known, 100 * SHARE_OF_RATIO, method="higher")) if known.size else np.nan


def share_within(errors: np.ndarray, level: float) -> float:
    """Return the share of the known errors that are at most a level; NaN if none is known."""
    known = errors[np.isfinite(errors)]
    return float(np.mean(known <= level)) if known.size else np.nan


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
    ordinary, check = (sample(few or DESIGNS, seed) for seed in SEEDS)
    best = {model: [solved(cases, model, finest) for cases in (ordinary, check)] for model in {*TRUE_MODEL.values()}}
    rows = []
    for model, true_model in TRUE_MODEL.items():
        peaks = {}
        for rung in RUNGS:
            found = [solved(cases, model, rung) for cases in (ordinary, check)]
            # `kalker` takes the table at `preview`, with its error
            served = (DECLARED[model].cheaper or model) if rung == RUNGS[0] else model
            errors, others = (
                true_errors(cases, ds, own)
                for cases, ds, own in zip((ordinary, check), found, best[true_model], strict=True)
            )
            weights = weights_of(errors, found[0], raw_errors(found[0], ordinary, served))
            told = told_logs(weights, found[1], raw_errors(found[1], check, served))
            peaks[rung] = found[1].peak_stress.values, told["peak_stress"]
            ratios, other_ratios = (ratio_errors(ds, own) for ds, own in zip(found, best[true_model], strict=True))
            level = {name: level_of(error) for name, error in ratios.items()}
            rows.append(
                {
                    "model": model,
                    "accuracy": rung,
                    "designs": len(check),
                    "weights": weights,
                    "checked": {name: row_of(others[name], told[name]) for name in told},
                    "ratio": {name: float(np.expm1(own)) for name, own in level.items()},
                    "ratio_covered": {name: share_within(other_ratios[name], own) for name, own in level.items()},
                }
            )
        for row in rows[-len(RUNGS) :]:
            row["agrees"] = agreement(peaks[row["accuracy"]], peaks["reference"])
    return rows
