"""Measure the stated error of worn grooves on random rollers, and their volume against the friction energy."""

from __future__ import annotations

import math
from typing import Any
from unittest.mock import patch

import numpy as np

import trackroller as tr
from trackroller.errors import InputError
from trackroller.roller import wearing
from validation.benchmarks.command import run

OUTPUTS = ("forces", "contact", "friction_work")
FINER = {"sliding": 16.0, "kalker": 4.0}  # divide the error that a step of the finer run may have
STATES = 400  # limit of the finer run
PENCIL = {"motor_force": 60.0, "guide_overrollings_per_hour": 100.0}


def rollers(count: int, seed: int) -> list[dict[str, Any]]:
    """Return random rollers that roll: groove, angle, loads, friction, and the share of the guide in the wear."""
    rng, found = np.random.default_rng(seed), []
    while len(found) < count:
        force, mu, angle = rng.uniform(-400.0, -50.0), rng.uniform(0.05, 0.4), rng.uniform(20.0, 50.0)
        k = 10.0 ** rng.uniform(-6.0, -4.0)
        steel = {"like": "1.7225-quenched-tempered"}
        case = {
            "radial_force": force,
            "axial_force": rng.uniform(-0.3, 0.3) * abs(force) * rng.integers(2),
            "motor_force": rng.uniform(-0.5, 0.2) * mu * abs(force),
            "friction_coefficient": mu,
            "contact_angle": angle,
            "guide_profile_radius": 6.0,
            "roller_profile_radius": -6.0 * (1.0 + rng.uniform(0.03, 0.3)),
            "guide_overrollings_per_hour": 10.0 ** rng.uniform(2.0, 4.0),
            "roller_material": steel | {"wear_coefficient": k},
            "guide_material": steel | {"wear_coefficient": k * 10.0 ** rng.uniform(-1.0, 1.0)},
        }
        try:
            ds = tr.solve(case, OUTPUTS[:1], contact_model="sliding", accuracy="preview")
        except InputError:
            continue
        if ds.converged and int(ds.regime) == 0:
            found.append(case)
    return found


def goal(case: dict[str, Any], elastic: float) -> float:
    """Return the travel [km] to a depth of about so many elastic approaches, from the first rate and approach."""
    new = tr.solve(case, (*OUTPUTS, "wear"), contact_model="sliding", normal="halfspace", accuracy="preview")
    approach = float((new.semi_axis_rolling**2).max()) / 60.0  # a scale is enough: 30 mm rolling diameter
    return elastic * approach / float(new.wear_depth_per_km.max())


def of_error(case: dict[str, Any], travel: float, model: str, accuracy: str, finer: str) -> dict[str, Any]:
    """Return stated and true error of the deepest depth [um] of one roller, and of the pressure of its states [1]."""
    options = {"contact_model": model, "accuracy": accuracy}
    ds = tr.wear(case, travel, OUTPUTS, **options)
    reached, part = float(ds.travel[-1]), FINER[model]
    with patch.multiple(
        wearing, TOLERANCE=wearing.TOLERANCE / part, SHARE=wearing.SHARE / part, STEPS=STATES, FIRST=0.01
    ):
        true = tr.wear(case, reached, OUTPUTS, **options | {"accuracy": finer})
    one, two = (float(run.groove_depth.isel(travel=-1).max()) for run in (ds, true))
    common = ds.sel(travel=slice(1e-12, float(true.travel[-1])))
    pressure = true.max_pressure.interp(travel=common.travel)
    return {
        "end": str(ds.attrs["end"]),
        "finer_end": str(true.attrs["end"]),
        "travel_km": reached,
        "states": [ds.sizes["travel"], true.sizes["travel"]],
        "depth_um": 1e3 * one,
        "stated_um": 1e3 * float(ds.groove_depth_error.isel(travel=-1)),
        "of_steps_um": 1e3 * float(ds.groove_step_error.isel(travel=-1)),
        "true_um": 1e3 * abs(one - two) if float(true.travel[-1]) == reached else math.nan,
        "pressure_stated": common.pressure_error.values.ravel(),
        "pressure_true": np.abs(common.max_pressure / pressure - 1.0).values.ravel(),
    }


def coverage(errors: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the share of rollers and of states whose true errors the stated ones cover, and their quantiles."""
    known = [e for e in errors if math.isfinite(e["true_um"]) and e["depth_um"] > 0.0]
    ratios = np.array([e["true_um"] / e["stated_um"] for e in known])
    stated, true = (np.concatenate([e[f"pressure_{name}"] for e in known]) for name in ("stated", "true"))
    return {
        "rollers": errors,
        "compared": len(known),
        "covered": float(np.mean(ratios <= 1.0)),
        "ratio": np.quantile(ratios, [0.5, 0.9, 0.95, 1.0]),
        "states": len(true),
        "pressure_covered": float(np.mean(true <= stated)),
        "pressure_true": np.quantile(true, [0.5, 0.95, 1.0]),
        "pressure_stated": np.quantile(stated, [0.5, 0.95, 1.0]),
    }


def of_volume(case: dict[str, Any], travel: float) -> dict[str, Any]:
    """Return how far volume and friction energy of one roller differ: at each state, a step at most, and in all."""
    only = {**case, "guide_material": {"like": "1.7225-quenched-tempered", "wear_coefficient": 0.0}}
    ds = tr.wear(only, travel, (*OUTPUTS, "wear"), contact_model="sliding", accuracy="preview")
    k, mu = case["roller_material"]["wear_coefficient"], case["friction_coefficient"]
    rate = 1e3 * k / mu * ds.friction_energy_per_distance.values
    given = ds.wear_volume_per_km.sel(body="roller").values
    spent = 0.5 * (rate[1:] + rate[:-1]) * np.diff(ds.travel.values)[:, None]
    worn = np.diff(ds.groove_volume.sel(body="roller").values, axis=0)
    return {
        "states": ds.sizes["travel"],
        "rate": float(np.abs(given / rate - 1.0).max()),
        "step": float(np.abs(worn / spent - 1.0).max()) if len(worn) else 0.0,
        "total": float(np.abs(worn.sum() / spent.sum() - 1.0)) if len(worn) else 0.0,
    }


def of_pencil() -> dict[str, float]:
    """Return how far a braked roller's wear of the guide differs from that of a pencil pressed by Hertz's pressure."""
    steel = {"like": "1.7225-quenched-tempered", "wear_coefficient": 1e-5}
    case = {"friction_coefficient": 0.2, "roller_material": steel, "guide_material": steel, **PENCIL}
    ds = tr.solve(case, (*OUTPUTS, "wear"), contact_model="sliding", accuracy="standard")
    deepest = 1e-3 * 1e-5 * 0.5 * math.pi * ds.max_pressure * ds.semi_axis_rolling
    volume = 1e3 * 1e-5 * ds.normal_force
    guide = ds.sel(body="guide")
    return {
        "depth": float(np.abs(guide.wear_depth_per_overrolling / deepest - 1.0).max()),
        "volume": float(np.abs(guide.wear_volume_per_km / volume - 1.0).max()),
        "regime": int(ds.regime),
    }


def measure(
    cases: int = 20, exact: int = 6, balanced: int = 10, seed: int = 27, accuracy: str = "preview"
) -> dict[str, Any]:
    """Return errors, conservation and the pencil.

    Parameters
    ----------
    cases, exact : int
        Random rollers whose stated errors are compared with finer runs: of full sliding, and of `kalker`.
    balanced : int
        Random rollers whose volume is compared with the friction energy.
    seed : int
        Seed of the random rollers.
    accuracy : str
        Accuracy of the runs under test.
    """
    rng = np.random.default_rng(seed)
    drawn = [(case, goal(case, float(rng.uniform(0.3, 4.0)))) for case in rollers(max(cases, balanced), seed)]
    return {
        "sliding": coverage([of_error(*pair, "sliding", accuracy, "standard") for pair in drawn[:cases]]),
        "kalker": coverage([of_error(*pair, "kalker", accuracy, "reference") for pair in drawn[:exact]]),
        "volumes": [of_volume(*pair) for pair in drawn[:balanced]],
        "pencil": of_pencil(),
    }


if __name__ == "__main__":
    run(measure, __doc__)
