"""How long Kalker's theory takes for a patch, and what a start near the solution saves.

    python -m validation.benchmarks.kalker_starts [--random 250] [--patches 60] [--cases 24]

First random patches on 40x40 elements: axis ratios 0.05 to 20, friction 0.03 to 0.6, from full sliding to full stick.
Then starts: CPU time of a patch from nothing (by the grid of half the elements) and from the tractions of a neighbour
whose friction and creepage differ by 2 to 20 %. Then equilibria: CPU time and patches solved when the rough search is
done by the table of the exact theory, which is a grid of neighbours solved once and for all, and when it is done by
half the elements. Last a batch of cases on one thread and on all. Ratios hold on a busy machine, times do not.
"""

from __future__ import annotations

import argparse
import os
import time

import numpy as np

from trackroller.contact.common import Elastic, Ellipse
from trackroller.contact.kalker import Creepage, KalkerSettings, solve_patch
from trackroller.contact.kalker.law import KalkerLaw
from trackroller.roller import equilibrium as eq
from trackroller.roller.case import Case, to_table
from trackroller.roller.options import Options
from trackroller.roller.solver import solve
from trackroller.roller.stages import mechanics as stages

STEEL = Elastic.of_pair(210e3, 0.33, 210e3, 0.33)
STEPS = (0.02, 0.05, 0.1, 0.2)


class Counting(KalkerLaw):
    """Counts fine calls; `rough` tells whether the table or half the elements serve for the rough ones."""

    def __init__(self, elastic: Elastic, rough: str) -> None:
        super().__init__(elastic, KalkerSettings(tolerance=1e-8))
        self.rough, self.fine = rough, 0

    def __call__(self, ellipse, slip, friction, rows, fine=True):
        self.fine += fine * len(rows)
        if fine or self.rough == "table":
            return super().__call__(ellipse, slip, friction, rows, fine)
        return self.solve(ellipse, slip, friction, rows, False).resultants


def timed(ellipse: Ellipse, creep: float, spin: float, friction: float, start=None) -> tuple[float, np.ndarray]:
    """CPU time [s] and tractions of one patch."""
    one, begin = np.ones(1), time.process_time()
    slips = Creepage(creep * one, 0.0 * one, spin * one)
    found = solve_patch(ellipse, slips, friction, STEEL, KalkerSettings(tolerance=1e-8), start)
    return time.process_time() - begin, found.traction


def at_random(count: int) -> None:
    rng, one = np.random.default_rng(3), np.ones(1)
    spent, products, sticks = np.empty(count), np.empty(count), np.empty(count)
    for i in range(count):
        b = np.sqrt(0.08 * 10 ** rng.uniform(-1.3, 1.3)) * one
        creep = 10 ** rng.uniform(-5, -2) * rng.choice([-1, 1])
        turn = 10 ** rng.uniform(-5, -1.8) * rng.choice([0, 1, 1])
        slips = Creepage(creep * one, 0.0 * one, turn / np.sqrt(0.08) * one)
        begin = time.process_time()
        found = solve_patch(Ellipse(0.08 / b, b, 900.0 * one), slips, 10 ** rng.uniform(-1.5, -0.2), STEEL)
        spent[i], products[i], sticks[i] = time.process_time() - begin, found.products[0], found.stick_fraction[0]
        if not found.converged.all():
            raise SystemExit(f"patch {i} did not converge")
    for name, v in (("ms, influence functions and coarse grid counted", 1e3 * spent), ("products", products)):
        print(
            f"{name}: median {np.median(v):.0f}, 90 % {np.quantile(v, 0.9):.0f}, 99 % {np.quantile(v, 0.99):.0f}, "
            f"most {v.max():.0f}"
        )
    print(f"stick {sticks.min():.2f} to {sticks.max():.2f}, a tenth above {np.quantile(sticks, 0.9):.2f}")


def patches(count: int) -> None:
    rng, one = np.random.default_rng(5), np.ones(1)
    alone, near = 0.0, dict.fromkeys(STEPS, 0.0)
    for _ in range(count):
        b = np.sqrt(0.08 * 10 ** rng.uniform(-0.6, 0.6)) * one
        ellipse, friction = Ellipse(0.08 / b, b, 900.0 * one), 10 ** rng.uniform(-1.3, -0.3)
        spin = 10 ** rng.uniform(-2.5, -1.9)
        creep, per_length = spin * rng.uniform(-0.5, 0.5), spin / np.sqrt(0.08)
        timed(ellipse, creep, per_length, friction)  # its influence functions are kept from now on
        spent, neighbour = timed(ellipse, creep, per_length, friction)
        alone += spent
        for step in STEPS:
            near[step] += timed(ellipse, creep * (1 + step), per_length, friction * (1 + step), neighbour)[0]
    print(f"a patch from nothing: {1e3 * alone / count:.1f} ms")
    for step in STEPS:
        print(f"from a neighbour {100 * step:.0f} % away: {near[step] / alone:.2f} of that")


def equilibria(count: int) -> None:
    frictions = np.linspace(0.05, 0.5, count // 2).tolist()
    grid = [Case(friction_coefficient=m, motor_force=force) for m in frictions for force in (0.0, -15.0)]
    for rough in ("half the elements", "table"):
        fine, begin = 0, time.process_time()
        for case in grid:
            scene = stages.prepare(to_table([case], None), Options(outputs=("forces",), contact_model="kalker"))
            law = Counting(Elastic(*(np.full(1, float(v)) for v in (STEEL.shear_modulus, 0.33, 0.0))), rough)
            eq.solve_equilibrium(scene.loads, law)
            fine += law.fine
        spent = (time.process_time() - begin) / len(grid)
        print(f"an equilibrium, rough search by {rough}: {1e3 * spent:.0f} ms, {fine / len(grid):.1f} fine patches")


def batch(count: int) -> None:
    rng = np.random.default_rng(7)
    cases = [
        Case(friction_coefficient=float(mu), motor_force=float(force))
        for mu, force in zip(rng.uniform(0.05, 0.5, count), rng.choice([0.0, -10.0, 10.0], count), strict=True)
    ]
    spent, kept = {}, os.environ.get("NUMBA_NUM_THREADS")
    for threads in (1, os.cpu_count() or 1):
        os.environ["NUMBA_NUM_THREADS"] = str(threads)
        solve(cases[:2], contact_model="kalker")
        begin = time.perf_counter()
        solve(cases, contact_model="kalker")
        spent[threads] = (time.perf_counter() - begin) / count
        print(f"complete cases on {threads} threads: {1e3 * spent[threads]:.0f} ms each")
    print(f"faster by {spent[1] / spent[threads]:.2f}")
    os.environ.pop("NUMBA_NUM_THREADS")
    if kept is not None:
        os.environ["NUMBA_NUM_THREADS"] = kept


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--random", type=int, default=250)
    parser.add_argument("--patches", type=int, default=60)
    parser.add_argument("--cases", type=int, default=24)
    given = parser.parse_args()
    equilibria(2)  # compiles
    batch(4)
    at_random(60)
    print("(that was to compile)")
    at_random(given.random)
    patches(given.patches)
    equilibria(given.cases)
    batch(2 * given.cases)


if __name__ == "__main__":
    main()
