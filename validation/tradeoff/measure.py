"""Measure error and cost of the three rungs of accuracy, of tolerances and of the contact models.

The designs are 230 ordinary and 230 wide ones, with forces and peaks of the exact theory (`truth`). Costs are processor
times over a complete case (forces, contact, friction work, four peaks, life) of `sliding` at `standard` on the same
designs; the settings take turns in one process.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any
from unittest import mock

import numpy as np
import xarray as xr

import trackroller as tr
from trackroller.parameters import OPTIONS
from trackroller.parameters.accuracy import PRESETS, RUNGS
from trackroller.parameters.contact_models import DECLARED
from trackroller.roller import solver
from trackroller.roller.dataset import validity_bit
from validation.benchmarks import falling_friction
from validation.tradeoff.errors import largest, percentiles, relative_errors, tolerance_bound
from validation.tradeoff.sample import sample
from validation.tradeoff.told import measure_told
from validation.tradeoff.truth import FINEST_SEARCH, SAMPLES, Truth

MODELS = ("sliding", "kalker_table", "kalker")
TOLERANCES = (0.1, 0.03, 0.01)
WALKED = {"forces": (0.1, 0.03, 0.01, 3e-3, 1e-3), "peak": TOLERANCES}  # of the shares of rungs
FORCES, COMPLETE = ("forces", "contact"), ("forces", "contact", "friction_work", "peak_stress", "life")
YARDSTICK = ("sliding", "standard")
CHEAP = 1024  # designs for the errors of discretisation of `sliding`
FINEST = replace(
    PRESETS["reference"],
    name="finest",
    force_nodes=48,
    elements=112,
    peak=FINEST_SEARCH,
)
LEVELS = (50, 99)  # percentiles of the page
FILM = 1e-5  # mm3/N, layer of 10 um with a shear modulus of 1 GPa
HEATED = {"heat_transfer_coefficient": 20.0, "cooled_area": 3000.0}  # W/(m2 K) and mm2, what the limit of heat needs
WORN = {"guide_overrollings_per_hour": 100.0, "permissible_wear_depth": 0.05}  # 1/h and mm, for the limit of wear
PATCH_LIMITS = ("shakedown", "heat", "multiaxial")  # limits that take time


def seconds(
    cases: list[tr.Case], asked: Sequence[tuple[str, Any]], outputs: tuple[str, ...], repeats: int
) -> list[float]:
    """Return the processor time of a case [s] by contact model and accuracy, the least of `repeats`."""
    spent = np.empty((repeats, len(asked)))
    for model, accuracy in asked:
        tr.solve(cases[:2], outputs=outputs, contact_model=model, accuracy=accuracy)  # compiled and loaded
    for turn in spent:
        for k, (model, accuracy) in enumerate(asked):
            start = time.process_time()
            tr.solve(cases, outputs=outputs, contact_model=model, accuracy=accuracy)
            turn[k] = time.process_time() - start
    return list(spent.min(axis=0) / max(len(cases), 1))


def costs(truth: Truth, repeats: int) -> dict[str, list[dict[str, Any]]]:
    """Return the costs of rungs and tolerances over the yardstick, by sample."""
    asked = [YARDSTICK, *((model, rung) for model in MODELS for rung in RUNGS), *(("kalker", t) for t in TOLERANCES)]
    found = {}
    for name in SAMPLES:
        cases = [case for case, own in zip(truth.cases, truth.sample, strict=True) if own == name]
        complete, forces = (seconds(cases, asked, outputs, repeats) for outputs in (COMPLETE, FORCES))
        one = complete[0]
        rows = zip(asked[1:], complete[1:], forces[1:], strict=True)
        found[name] = [
            {"model": model, "accuracy": accuracy, "complete": whole / one, "forces": part / one}
            for (model, accuracy), whole, part in rows
        ]
    return found


def falling_costs(truth: Truth, repeats: int, seed: int = 3) -> list[dict[str, Any]]:
    """Return the costs under random laws of falling friction over the yardstick under constant friction.

    Some of the rollers slip. A roller that nearly slips takes ten times longer than one that rolls.
    """
    cases = falling_friction.sample(len(truth.cases), seed)
    one = min(seconds(truth.cases, [YARDSTICK], COMPLETE, repeats))
    asked = [(model, rung) for model in MODELS if DECLARED[model].friction_laws for rung in RUNGS]
    spent = (seconds(cases, asked, outputs, repeats) for outputs in (COMPLETE, FORCES))
    return [
        {"model": model, "accuracy": rung, "complete": whole / one, "forces": part / one}
        for (model, rung), whole, part in zip(asked, *spent, strict=True)
    ]


def film_costs(cases: list[tr.Case], repeats: int) -> list[dict[str, Any]]:
    """Return the costs of ordinary designs with a film between the bodies over the yardstick without one."""
    films = [replace(case, **{"layer_flexibility": FILM}) for case in cases]
    one = min(seconds(cases, [YARDSTICK], COMPLETE, repeats))
    asked = [(model, rung) for model in MODELS if DECLARED[model].films for rung in RUNGS]
    spent = (seconds(films, asked, outputs, repeats) for outputs in (COMPLETE, FORCES))
    return [
        {"model": model, "accuracy": rung, "complete": whole / one, "forces": part / one}
        for (model, rung), whole, part in zip(asked, *spent, strict=True)
    ]


def limit_costs(cases: list[tr.Case], repeats: int) -> dict[str, float]:
    """Return the costs of groups of limits in addition to complete ordinary designs, over the yardstick.

    The group `limits` has whatever the materials of a design allow, wear, and bounds where a study takes them. `limits
    with heat` has heat as well, which needs fields that few cases give. All settings take turns, and each repetition
    counts by its difference from the complete cases beside it, because a small cost is the difference of larger ones.
    """
    worn = [replace(case, **WORN) for case in cases]
    heated = [replace(case, **HEATED, **WORN) for case in cases]
    bounds = {"at_most": tuple(OPTIONS["at_most"].values)}
    given = {"contact_model": "kalker", "accuracy": "standard"}
    asked: dict[str, tuple[list[tr.Case], dict[str, Any]]] = {
        "yardstick": (cases, {"outputs": COMPLETE, "contact_model": YARDSTICK[0], "accuracy": YARDSTICK[1]}),
        "complete": (cases, given | {"outputs": COMPLETE}),
        "limits": (worn, given | {"outputs": (*COMPLETE, "limits")} | bounds),
        "limits with heat": (heated, given | {"outputs": (*COMPLETE, "limits")} | bounds),
    }
    asked |= {name: (heated, given | {"outputs": (*COMPLETE, name)}) for name in PATCH_LIMITS}
    spent = processor_times(asked, repeats)
    return {
        name: max(float(np.median(spent[name] - spent["complete"])), 0.0) / float(np.min(spent["yardstick"]))
        for name in list(asked)[2:]
    }


def processor_times(asked: dict[str, tuple[list[tr.Case], dict[str, Any]]], repeats: int) -> dict[str, np.ndarray]:
    """Return the processor times of all cases by setting, (repeats,) each [s]; the settings take turns."""
    for cases, options in asked.values():
        tr.solve(cases[:2], **options)  # compiled and loaded
    spent = {name: np.empty(repeats) for name in asked}
    for turn in range(repeats):
        for name, (cases, options) in asked.items():
            start = time.process_time()
            tr.solve(cases, **options)
            spent[name][turn] = time.process_time() - start
    return spent


def all_costs(truth: Truth, few: int, repeats: int) -> dict[str, Any]:
    """Return the numbers of `plan`: costs of rungs, of falling friction, of films and of limits."""
    ordinary = [case for case, own in zip(truth.cases, truth.sample, strict=True) if own == "ordinary"]
    return {
        "costs": costs(truth, repeats),
        "falling": falling_costs(truth.few(min(few or 10, 10)), 1),
        "films": film_costs(ordinary[: few or 60], 1),
        "limits": limit_costs(ordinary, repeats),
    }


def _of_sample(truth: Truth, name: str, values: np.ndarray) -> np.ndarray:
    own = values[truth.sample == name]
    return np.asarray(own[~np.isnan(own)])


def against_truth(truth: Truth, ds: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return by sample the errors against the exact theory, and how the told errors of the peaks hold."""
    errors = {quantity: largest(values) for quantity, values in truth.errors(ds).items()}
    told = np.where(np.isnan(errors["peak_stress"]), np.nan, largest(ds.error_estimate.values))
    exceeded = {f"{quantity}_exceeded": values for quantity, values in truth.exceeded(ds).items()}
    found = {}
    for name in SAMPLES:
        own = {quantity: percentiles(_of_sample(truth, name, e), LEVELS).tolist() for quantity, e in errors.items()}
        shares = {quantity: float(np.mean(_of_sample(truth, name, e))) for quantity, e in exceeded.items()}
        found[name] = own | shares | {"told_1_percent": float(np.mean(_of_sample(truth, name, told) <= 0.01))}
    return found


def rungs(truth: Truth, part: Truth, sliding: list[tr.Case]) -> list[dict[str, Any]]:
    """Return errors of each contact model on each rung: against the exact theory, and of discretisation.

    Errors of discretisation are those against the finest settings: for `sliding` on a wider sample of designs, for
    `kalker` on a part of them and, where the exact theory is known, against that. A peak that is too low by e is
    expected to err the life by (1 - e)^-k - 1.
    """
    rows = []
    for model in MODELS:
        cases = {"sliding": sliding, "kalker_table": truth.cases, "kalker": part.cases}[model]
        friction = ("case", [case.friction_coefficient for case in cases])
        best = tr.solve(cases, COMPLETE, contact_model=model, accuracy=FINEST).assign(friction=friction)
        for rung in RUNGS:
            ds = tr.solve(truth.cases, COMPLETE, contact_model=model, accuracy=rung)
            errors = relative_errors(tr.solve(cases, COMPLETE, contact_model=model, accuracy=rung), best)
            if model == "kalker":  # elements miss peaks at small adhesion areas, whatever their number
                errors |= {quantity: largest(values) for quantity, values in truth.errors(ds).items()}
                exponent = float((np.log1p(ds.life_error_estimate) / np.log1p(ds.error_estimate)).max())
                errors["life"] = (1.0 - errors["peak_stress"]) ** -exponent - 1.0
            levels = {name: [*percentiles(e).tolist(), tolerance_bound(e)] for name, e in errors.items()}
            rows.append({"model": model, "accuracy": rung, "levels": levels, "exact": against_truth(truth, ds)})
    return rows


def tolerances(truth: Truth) -> list[dict[str, Any]]:
    """Return by sample what tolerances of `kalker` keep, flag and take from each rung."""
    rows = []
    for tolerance in TOLERANCES:
        ds = tr.solve(truth.cases, COMPLETE, contact_model="kalker", accuracy=tolerance)
        missed = (ds.validity.values & validity_bit("tolerance_missed")) != 0
        errors = {quantity: largest(values) for quantity, values in truth.errors(ds).items()}
        worst = np.max(list(errors.values()), axis=0)
        keeps = np.where(np.isnan(worst), np.nan, worst <= tolerance + truth.peak_error)
        used = ds.accuracy_used.values
        by_sample = {
            name: {
                "missed": float(np.mean(missed[own])),
                "kept": float(np.nanmean(keeps[own & ~missed])),
                "missed_though_kept": float(np.nansum(keeps[own & missed]) / max(np.sum(own & missed), 1)),
                "served": [float(np.mean(used[own] == k)) for k in range(len(RUNGS))],
            }
            for name in SAMPLES
            if (own := truth.sample == name).any()
        }
        rows.append({"tolerance": tolerance, **by_sample})
    return rows


def shares(cases: list[tr.Case], model: str, quantity: str, tolerance: float) -> list[float]:
    """Return the shares of the cases that a tolerance solves on each rung."""
    counts, plain = dict.fromkeys(RUNGS, 0), solver._solve_block

    def counted(table: Any, options: Any) -> Any:
        counts[options.accuracy] += len(table)
        return plain(table, options)

    outputs = FORCES if quantity == "forces" else ("peak_stress",)
    with mock.patch.object(solver, "_solve_block", counted):
        tr.solve(cases, outputs, contact_model=model, accuracy={quantity: tolerance})
    return [count / len(cases) for count in counts.values()]


def measure(few: int = 0, repeats: int = 2) -> dict[str, Any]:
    """Return all numbers of the page on cost and error; `few` takes so many designs of each sample only."""
    truth = Truth.read().few(few or 230)
    part = truth.few(min(few or 60, 60))
    walked = {
        model: {
            quantity: {f"{t:g}": shares(part.cases, model, quantity, t) for t in own}
            for quantity, own in WALKED.items()
        }
        for model in MODELS
    }
    return {
        "designs": {name: int(np.sum(truth.sample == name)) for name in SAMPLES} | {"sliding": few or CHEAP},
        **all_costs(truth, few, repeats),
        "rungs": rungs(truth, part, sample(few or CHEAP)),
        "tolerances": tolerances(truth),
        "told": measure_told(few, FINEST),
        "shares": walked,
    }
