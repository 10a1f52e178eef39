"""Table 2 of Wenzel et al. 2022, discretisation against duration and accuracy, beside the same from this software."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import minimize

from trackroller.halfspace.ellipse import stress_parts
from trackroller.halfspace.stress import von_mises
from trackroller.parameters import ACCURACIES
from trackroller.roller.case import Case
from trackroller.roller.solver import solve
from validation.tradeoff.measure import cpu
from validation.tradeoff.settings import REFERENCE_SEARCHES, accuracy_of
from validation.tradeoff.stages import PUBLISHED_START, Patches, grid_peak, patches_of

CASE = Case(motor_force=0.0, friction_coefficient=0.3, radial_force=-200.0, axial_force=30.0, guide_curve_radius=220.0)
# setting, points across the surface, points across the volume, depths, minutes, peak [MPa]: as printed
PRINTED = (("high", 120, 120, 31, 40.0, 389.7), ("low", 40, 20, 12, 2.0, 389.8))
REPEATS = 10


def paper_table() -> list[dict[str, Any]]:
    """Return the rows of the table: settings with their CPU time and peak stresses of contact 1 on the roller.

    Keys: `what`, `discretisation`, `seconds`, and `inner` and `peak` [MPa].

    `inner` is the highest point of the published kind of search, from 1.5 grid steps below the surface on, and `peak`
    the highest with the surface. ASSUME: the paper does not tell its range of depths; here 1.5 times the smaller
    semi-axis in as many steps as it prints.
    """
    rows: list[dict[str, Any]] = []
    for name, surface, volume, depths, minutes, value in PRINTED:
        rows.append(
            {
                "what": f"paper, {name}",
                "discretisation": f"{surface} on the surface, {volume} x {depths}",
                "seconds": 60.0 * minutes,
                "inner": value,
                "peak": None,
            }
        )
    patches = patches_of([CASE])
    for name, surface, volume, depths, _, _ in PRINTED:
        inner, seconds = cpu(grid_peak, patches, 0, surface, depths, PUBLISHED_START, surface // volume)
        peak = grid_peak(patches, 0, surface, depths, 0.0, surface // volume)
        rows.append(
            {
                "what": f"its search, our kernels, {name}",
                "seconds": seconds,
                "inner": inner,
                "peak": peak,
                "discretisation": f"{surface} on the surface, {volume} x {depths}",
            }
        )
    for name in ACCURACIES:
        ds = solve(CASE, contact_model="sliding", accuracy=name)
        _, seconds = cpu(lambda n=name: [solve(CASE, contact_model="sliding", accuracy=n) for _ in range(REPEATS)])
        rows.append(
            {
                "what": f"`{name}`",
                "discretisation": "see above",
                "seconds": seconds / REPEATS,
                "inner": None,
                "peak": float(ds.peak_stress.values[0, 0]),
            }
        )
    rows.append(
        {
            "what": "converged",
            "discretisation": "",
            "seconds": None,
            "inner": _inner(patches),
            "peak": float(
                solve(CASE, contact_model="sliding", accuracy=accuracy_of(48, 8, REFERENCE_SEARCHES[0])).peak_stress[
                    0, 0
                ]
            ),
        }
    )
    return rows


def _inner(patches: Patches) -> float:
    """Return the highest local maximum below the surface in contact 1 of the roller [MPa]."""

    e, nu = patches.ellipse, float(patches.poisson[0])
    size = np.array(
        [e.semi_axis_lateral[0], e.semi_axis_rolling[0], min(e.semi_axis_lateral[0], e.semi_axis_rolling[0])]
    )

    def value(u: np.ndarray) -> float:
        parts = stress_parts(patches.rows[0], (u * size)[None], 48, 48)[0]
        return -float(von_mises(parts[0] + nu * parts[1] + parts[2] + nu * parts[3])) * float(e.max_pressure[0])

    grid = [np.array([x, y, z]) for x in (-0.4, 0.0, 0.4) for y in (-0.4, 0.0, 0.4) for z in (0.3, 0.5)]
    start = min(grid, key=value)
    bounds = [(-1.0, 1.0), (-1.0, 1.0), (0.1, 1.5)]
    found = minimize(value, start, method="Nelder-Mead", bounds=bounds, options={"xatol": 1e-5, "fatol": 1e-6})
    return -float(found.fun)
