"""Table 2 of Wenzel et al. 2022, discretisation against duration and accuracy, beside the same from this software."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import minimize

from trackroller.contact import sliding
from trackroller.contact.quantities import Ellipse
from trackroller.contact.slip import Slip, spin_model_index
from trackroller.halfspace.ellipse import patch_rows, stress_parts
from trackroller.halfspace.stress import stress_on_grid, von_mises
from trackroller.parameters import ACCURACIES
from trackroller.parameters.accuracy import PRESETS
from trackroller.roller.case import Case, to_table
from trackroller.roller.geometry import rolling_radius
from trackroller.roller.solver import solve
from validation.tradeoff.truth import FINEST_SEARCH

OUTPUTS = ("forces", "contact", "friction_work", "peak_stress", "life")
FINEST = replace(
    PRESETS["reference"],
    name="finest",
    force_nodes=48,
    coarse_nodes=8,
    peak=FINEST_SEARCH,
)
PUBLISHED_START = 1.5  # grid steps below the surface at which the published search begins
CASE = Case(motor_force=0.0, friction_coefficient=0.3, radial_force=-200.0, axial_force=30.0, guide_curve_radius=220.0)
# setting, points across the surface, points across the volume, depths, minutes, peak [MPa]: as printed
PRINTED = (("high", 120, 120, 31, 40.0, 389.7), ("low", 40, 20, 12, 2.0, 389.8))
REPEATS = 10


def cpu(work: Any, *arguments: Any, **options: Any) -> tuple[Any, float]:
    """Return the result and CPU time [s] of a call, over all threads of the process."""
    start = time.process_time()
    result = work(*arguments, **options)
    return result, time.process_time() - start


@dataclass(frozen=True)
class RollingPatches:
    """Contact 1 of n rolling designs: arrays (n,), rows for the stress kernels, and the whole solution."""

    ellipse: Ellipse
    slip: Slip
    friction: np.ndarray
    poisson: np.ndarray
    rows: np.ndarray
    solution: xr.Dataset

    def __len__(self) -> int:
        return len(self.friction)


def patches_of(cases: Sequence[Case]) -> RollingPatches:
    """Return the patches of contact 1 of those designs that roll."""
    ds = solve(list(cases), outputs=OUTPUTS, contact_model="sliding", accuracy=FINEST)
    rolls = np.flatnonzero(ds.regime.values == 0)
    ds, table = ds.isel(case=rolls), to_table([cases[int(i)] for i in rolls])
    alpha = np.deg2rad(table.contact_angle)
    radius = rolling_radius(table.axis_distance, table.guide_profile_radius, alpha)
    first = ds.isel(contact=0)
    ellipse = Ellipse(*(first[q].values for q in ("semi_axis_lateral", "semi_axis_rolling", "max_pressure")))
    slip = Slip(np.sin(alpha), np.cos(alpha), table.guide_profile_radius, radius, ds["rolling_radius_shift"].values)
    rows = patch_rows(ellipse, slip, table.friction_coefficient, spin_model_index("skewed"))
    return RollingPatches(ellipse, slip, table.friction_coefficient, table.roller.poisson_ratio, rows, ds)


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
            "peak": float(solve(CASE, contact_model="sliding", accuracy=FINEST).peak_stress[0, 0]),
        }
    )
    return rows


def _inner(patches: RollingPatches) -> float:
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


def grid_peak(patches: RollingPatches, i: int, count: int, depths: int, start: float, stride: int = 1) -> float:
    """Return the largest von Mises stress [MPa] of the roller over some depths of a grid.

    Of count x count points on the surface every `stride`-th is taken.

    From `start` steps below the surface down to 1.5 times the smaller semi-axis; bilinear tractions on the same grid.
    """
    row = np.array([i])
    t = sliding.tractions(patches.ellipse.take(row), patches.slip.take(row), patches.friction[row], points=count + 1)
    deepest = 1.5 * float(min(t.x[0, -1], t.y[0, -1]))
    z = np.linspace(0.0, deepest, depths)
    z = z[1:] + (start - 1.0) * z[1] if start > 0 else z
    stress = stress_on_grid(
        t.x[0], t.y[0], t.pressure[0], t.shear_lateral[0], t.shear_rolling[0], z, float(patches.poisson[i])
    )
    return float(von_mises(stress[:, ::stride, ::stride]).max())
