"""Count how many random designs with friction that falls with the slip speed find a balance, and which one.

    python -m validation.benchmarks.falling_friction [--cases N] [--seed S] [--runs MODEL:PRESET ...] [--only]

The designs of `peak_coverage`, under laws of every kind that fall to 0.3 to 0.9 of the value at rest, with
characteristic speeds of 0.01 to 100 times the spin slip at the rim of the patch. Per model and accuracy:
regimes, how many converged, residuals, and where the balance that was taken lies against two others:

- the one followed from constant friction by raising the velocity from nothing. Where it ends on the way, the followed
  roller slips suddenly, and nothing is compared;
- those at a velocity 1 % smaller and larger: a case that differs from both while these agree took another balance.
"""

from __future__ import annotations

import json
import math
import time
from dataclasses import replace
from typing import Any

import numpy as np

import trackroller as tr
from trackroller.parameters import REGIMES
from trackroller.roller.case import CaseTable, to_table
from trackroller.roller.dataset import validity_bit
from trackroller.roller.equilibrium import ROLLING, solve_equilibrium
from trackroller.roller.equilibrium.newton import Bounds, newton_polish
from trackroller.roller.equilibrium.roller import LAST_SLIP, Roller
from trackroller.roller.options import Options
from trackroller.roller.stages import mechanics as stages
from validation.benchmarks.command import run
from validation.benchmarks.peak_coverage import random_case

RUNS = ("sliding:standard", "fastsim:standard", "kalker:preview", "kalker:standard")
SPEED = 100.0  # characteristic slip speed of every law [mm/s]; the travel velocity sets the slip speed over it
STEPS = 16  # steps in which the velocity grows from nothing to its value
APART = 0.02  # balances whose w differ by more count as two


def laws() -> list[dict[str, Any]]:
    """Return laws of every kind that fall to 0.3 to 0.9, some with a plateau or with a rise before the fall."""
    found: list[dict[str, Any]] = []
    for lowest in (0.3, 0.5, 0.7, 0.9):
        middle = 0.5 * (1.0 + lowest)
        found += [
            {"kind": "linear", "speed": SPEED, "lowest": lowest},
            {"kind": "exponential", "speed": SPEED, "lowest": lowest},
            {"kind": "table", "speed": [0.0, 0.5 * SPEED, SPEED, 3 * SPEED], "friction": [1.0, 1.0, middle, lowest]},
            {"kind": "table", "speed": [0.0, 0.2 * SPEED, 2 * SPEED], "friction": [1.0, 1.1, lowest]},
        ]
    return found


def sample(n: int, seed: int) -> list[tr.Case]:
    """Return `n` cases that roll or slip under constant friction; cases that lift off are drawn again."""
    rng = np.random.default_rng(seed)
    cases: list[tr.Case] = []
    while len(cases) < n:
        drawn = []
        while len(drawn) < n:
            try:
                drawn.append(random_case(rng))
            except tr.InputError:
                continue
        plain = tr.solve(drawn, outputs=("forces", "contact"), contact_model="sliding", accuracy="preview")
        rim = np.sqrt(plain.semi_axis_lateral * plain.semi_axis_rolling).max("contact").values
        for case, size, regime in zip(drawn, rim, plain.regime.values, strict=True):
            law, over = laws()[rng.integers(len(laws()))], 10 ** rng.uniform(-2, 2)
            if regime < 2 and len(cases) < n:
                angle = math.radians(case.contact_angle)
                radius = case.axis_distance - case.guide_profile_radius * math.cos(angle)
                speed = SPEED * over / (size * math.sin(angle) / radius)  # mm/s
                cases.append(replace(case, friction_law=law, velocity=speed * 60.0 / 1000.0))
    return cases


def followed(cases: list[tr.Case], model: str, accuracy: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the slip measure w (n,) followed from constant friction, and the share of the velocity reached.

    w is NaN where the path ended.
    """
    w_end, reached = np.full(len(cases), np.nan), np.full(len(cases), np.nan)
    groups: dict[str, list[int]] = {}
    for i, case in enumerate(cases):
        groups.setdefault(json.dumps(case.friction_law), []).append(i)
    for rows in groups.values():
        w_end[rows], reached[rows] = _followed_group(to_table([cases[i] for i in rows], None), model, accuracy)
    return w_end, reached


def _followed_group(table: CaseTable, model: str, accuracy: str) -> tuple[np.ndarray, np.ndarray]:
    options = Options(contact_model=model, accuracy=accuracy, outputs=("forces",))
    none = np.full_like(np.asarray(table.friction_law), "")
    plain = stages.prepare(replace(table, friction_law=none), options)
    start = solve_equilibrium(plain.loads, plain.model.law)
    rows = np.flatnonzero(start.regime == ROLLING)
    w, reached = np.full(len(table), np.nan), np.full(len(table), np.nan)
    at, normal = Roller(plain.loads, plain.model.law, rows).w_of(start.shift[rows]), start.normal_force[rows].T
    share = 0.0
    for share in np.concatenate([np.logspace(-3, 0, STEPS)]):
        scene = stages.prepare(replace(table, velocity=share * table.velocity), options)
        roller = Roller(scene.loads, scene.model.law, rows)
        low, high = roller.w_of(-roller.radius), np.full(rows.size, LAST_SLIP)
        found = newton_polish(roller, at.copy(), normal.copy(), Bounds(low, high))
        best, at, normal = found.residual, found.w, found.normal
        goes_on = best <= 1e-4
        rows, at, normal = rows[goes_on], at[goes_on], normal[:, goes_on]
        reached[rows] = share
    w[rows] = at
    return w, reached


def measured(cases: list[tr.Case], model: str, accuracy: str, compare: bool) -> dict[str, Any]:
    """Return the numbers of one model at one accuracy."""
    options: dict[str, Any] = {"contact_model": model, "accuracy": accuracy, "outputs": ("forces", "friction_work")}
    start = time.process_time()
    ds = tr.solve(cases, **options)
    spent = time.process_time() - start
    regime, rolls = ds.regime.values, ds.regime.values == ROLLING
    residual = ds.residual.values
    unmet = np.flatnonzero(rolls & (ds.converged.values == 0))
    told: dict[str, Any] = {
        "cases": len(cases),
        "cpu_seconds_per_case": round(spent / len(cases), 4),
        "regimes": {name: int(np.sum(regime == k)) for k, name in enumerate(REGIMES)},
        "rolling_not_converged": len(unmet),
        "failed_cases": np.flatnonzero(regime == 3).tolist(),
        "not_converged_cases": unmet.tolist(),
        "their_residuals": residual[unmet].tolist(),
        "residual_percentiles": dict(
            zip(("50", "90", "99", "100"), np.percentile(residual[rolls], (50, 90, 99, 100)), strict=True)
        ),
        "energy_residual_percentiles": dict(
            zip(
                ("50", "90", "99", "100"),
                np.percentile(np.abs(ds.energy_residual.values[rolls]), (50, 90, 99, 100)),
                strict=True,
            )
        ),
    }
    if compare:
        told |= compared(cases, ds, model, accuracy)
    return told


def compared(cases: list[tr.Case], ds: Any, model: str, accuracy: str) -> dict[str, Any]:
    """Count balances other than the one followed from constant friction, and other than those of the neighbours."""
    options: dict[str, Any] = {"contact_model": model, "accuracy": accuracy, "outputs": ("forces",)}
    w = measures(cases, ds.rolling_radius_shift.values)
    rolls = ds.regime.values == ROLLING
    line, reached = followed(cases, model, accuracy)
    known = np.isfinite(line)
    other = known & ~(rolls & (np.abs(w - line) <= APART))
    sides = [tr.solve([replace(c, velocity=f * c.velocity) for c in cases], **options) for f in (0.99, 1.01)]
    below, above = (_told(cases, s) for s in sides)
    own = _told(cases, ds)
    apart = (np.abs(below - above) <= APART) & (np.abs(own - 0.5 * (below + above)) > APART)
    return {
        "followed_from_constant_friction": int(known.sum()),
        "ended_on_the_way": int(np.sum(np.isfinite(reached) & ~known)),
        "other_than_followed": {str(i): [REGIMES[ds.regime.values[i]], w[i], line[i]] for i in np.flatnonzero(other)},
        "other_than_both_neighbours": {str(i): [own[i], below[i], above[i]] for i in np.flatnonzero(apart)},
        "differs_from_one_neighbour": int(np.sum(np.abs(below - above) > APART)),
    }


def _told(cases: list[tr.Case], ds: Any) -> np.ndarray:
    """Return the slip measure of rolling cases, and for the other regimes a number outside its range."""
    regime = ds.regime.values
    return np.where(regime == ROLLING, measures(cases, ds.rolling_radius_shift.values), 9.0 + regime)


def measures(cases: list[tr.Case], shift: np.ndarray) -> np.ndarray:
    """Return slips as w in (-1, 1), in which the torque is nearly linear."""
    scene = stages.prepare(to_table(cases, None), Options(outputs=("forces",), contact_model="sliding"))
    return Roller(scene.loads, scene.model.law, np.arange(len(cases))).w_of(shift)


def steep_friction(cases: list[tr.Case]) -> np.ndarray:
    """Return which cases have friction that falls too steeply for the theory (validity bit `steep_friction`), (n,)."""
    ds = tr.solve(cases, outputs=("forces",), contact_model="kalker", accuracy="preview")
    return (ds.validity.values & validity_bit("steep_friction")) != 0


def measure(cases: int = 64, seed: int = 1, runs: tuple[str, ...] = RUNS, only: bool = False) -> dict[str, Any]:
    """Return the numbers of each run, MODEL:PRESET; `only` leaves out the comparison of balances."""
    drawn = sample(cases, seed)
    found = {word: measured(drawn, *word.split(":"), compare=not only) for word in runs}
    return {"steep_cases": np.flatnonzero(steep_friction(drawn)), "runs": found}


if __name__ == "__main__":
    run(measure, __doc__)
