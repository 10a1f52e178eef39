"""Make the fixed sample of designs for errors and costs: low-discrepancy, seeded, wider than real designs.

Loads over three decades, contact angles 10 to 80 deg, friction 0 to 1, drawn-in to flat grooves and convex rollers,
straight, outer and inner curves, driven, free and braked, materials of the database and others of any stiffness and
Poisson's ratio.
"""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.stats import qmc

from trackroller.errors import InputError
from trackroller.roller.case import Case
from trackroller.roller.dataset import validity_bit
from trackroller.roller.solver import solve

SEED = 20260
MATERIALS = ("1.7225-normalised", "1.7225-quenched-tempered", "EN AW-7075", "PA6", "POM")
DIMENSIONS = 15
SINGULAR = sum(validity_bit(name) for name in ("conformal", "split_pole"))


def _material(which: float, stiffness: float, ratio: float) -> Any:
    if which < 2 / 3:
        return MATERIALS[int(which * 1.5 * len(MATERIALS))]
    return {"like": MATERIALS[0], "youngs_modulus": 10 ** (3.3 + 2.1 * stiffness), "poisson_ratio": 0.5 * ratio}


def design_at(u: np.ndarray) -> Case:
    """Return the design at a point of the unit cube, shape (15,); refuse surfaces that conform or interlock."""
    load, guide, alpha = 10 ** (3 * u[0]), 10 ** (0.3 + u[1]), 10 + 70 * u[2]
    rolling = 10 ** (0.7 + u[3])
    kind, fit = u[4], u[5]
    if kind < 0.85:
        profile = -guide * (1 + 10 ** (-2 + 2.5 * fit))
    else:
        profile = (math.inf, guide, 5 * guide)[min(int((kind - 0.85) / 0.05), 2)]
    bend = min(int(3 * u[6]), 2)
    curve = math.inf if bend == 0 else (1.0 if bend == 1 else -1.0) * 10 ** (1.3 + 1.7 * u[7])
    drive = min(int(3 * u[8]), 2) - 1
    return Case(
        radial_force=-load,
        axial_force=load * (0.8 * u[9] - 0.4),
        motor_force=drive * load * 10 ** (-2 + 1.7 * u[10]),
        friction_coefficient=u[11],
        contact_angle=alpha,
        guide_profile_radius=guide,
        roller_profile_radius=profile,
        guide_curve_radius=curve,
        axis_distance=rolling + guide * math.cos(math.radians(alpha)),
        roller_material=_material(u[12], u[13], u[14]),
        guide_material=_material(1 - u[12], u[14], u[13]),
    )


def _blocks(seed: int) -> Iterator[list[Case]]:
    """Yield the designs of 256 points after 256 points of a scrambled Sobol sequence, without refused designs."""
    sequence = qmc.Sobol(DIMENSIONS, scramble=True, seed=seed)
    while True:
        drawn = []
        for point in sequence.random(256):
            with contextlib.suppress(InputError):
                drawn.append(design_at(point))
        yield drawn


def wide_designs(count: int, seed: int) -> list[Case]:
    """Return the first `count` designs with point contact."""
    return list(itertools.islice(itertools.chain.from_iterable(_blocks(seed)), count))


def sample(count: int, seed: int = SEED) -> list[Case]:
    """Return the first `count` usable designs: they roll or slide on both contacts within the groove.

    Left out: surfaces without point contact, lift-off, self-locking without a solution, and patches in which the slip
    of the sliding model makes the stress itself infinite (bits `conformal` and `split_pole`).
    """
    kept: list[Case] = []
    for drawn in _blocks(seed):
        kept += [case for case, good in zip(drawn, _usable(drawn), strict=True) if good]
        if len(kept) >= count:
            break
    return kept[:count]


def _usable(cases: list[Case]) -> np.ndarray:
    ds = solve(cases, outputs=("forces", "contact"), contact_model="sliding", accuracy="standard")
    return np.asarray((ds.regime.values <= 1) & ((ds.validity.values & SINGULAR) == 0) & (ds.converged.values == 1))
