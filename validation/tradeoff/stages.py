"""Single stages on given inputs: traction grids, stress at points, peak as the highest point of a grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from trackroller.contact import sliding
from trackroller.contact.common import Ellipse
from trackroller.contact.slip import Slip, spin_model_index
from trackroller.halfspace.ellipse import patch_rows, stress_parts
from trackroller.halfspace.stress import stress_from_tractions, stress_on_grid, von_mises
from trackroller.roller.case import Case, to_table
from trackroller.roller.geometry import rolling_radius
from trackroller.roller.solver import solve
from validation.tradeoff.errors import QUANTITIES
from validation.tradeoff.measure import cpu, labelled
from validation.tradeoff.settings import ALL, REFERENCE_SEARCHES, Setting, accuracy_of

GRID_POINTS = (11, 21, 41, 61, 81, 121)
WAVES = (4, 6, 8, 12, 16, 24, 32)
STRESS_ELEMENTS = (10, 20, 40, 80)
SCAN_POINTS = (10, 20, 40, 80)
PUBLISHED_START = 1.5  # grid steps below the surface at which the published search begins
Found = tuple[Setting, str, np.ndarray, float]  # setting, quantity, errors (n,), CPU seconds a case


@dataclass(frozen=True)
class Patches:
    """Contact 1 of n rolling designs: arrays (n,), rows for the stress kernels, and the whole solution."""

    ellipse: Ellipse
    slip: Slip
    friction: np.ndarray
    poisson: np.ndarray
    rows: np.ndarray
    solution: xr.Dataset

    def __len__(self) -> int:
        return len(self.friction)


def patches_of(cases: Sequence[Case]) -> Patches:
    """Return the patches of contact 1 of those designs that roll."""
    ds = solve(list(cases), outputs=ALL, contact_model="sliding", accuracy=accuracy_of(48, 8, REFERENCE_SEARCHES[1]))
    rolls = np.flatnonzero(ds.regime.values == 0)
    ds, table = ds.isel(case=rolls), to_table([cases[int(i)] for i in rolls])
    alpha = np.deg2rad(table.contact_angle)
    radius = rolling_radius(table.axis_distance, table.guide_profile_radius, alpha)
    first = ds.isel(contact=0)
    ellipse = Ellipse(*(first[q].values for q in ("semi_axis_lateral", "semi_axis_rolling", "max_pressure")))
    slip = Slip(np.sin(alpha), np.cos(alpha), table.guide_profile_radius, radius, ds["rolling_radius_shift"].values)
    rows = patch_rows(ellipse, slip, table.friction_coefficient, spin_model_index("skewed"))
    return Patches(ellipse, slip, table.friction_coefficient, table.roller.poisson_ratio, rows, ds)


def measure_stages(cases: Sequence[Case]) -> xr.Dataset:
    """Measure all single stages: errors (setting, quantity, design) and CPU time of a patch or case."""
    patches = patches_of(cases)
    sliding.tractions(patches.ellipse, patches.slip, patches.friction, points=5)  # compiled before the clock runs
    found = [*traction_stage(patches), *stress_stage(patches), *grid_search_stage(patches)]
    names, width = list(QUANTITIES), max(errors.size for _, _, errors, _ in found)
    errors = np.full((len(found), len(names), width), np.nan)
    for i, (_, quantity, values, _) in enumerate(found):
        errors[i, names.index(quantity), : values.size] = values
    return labelled([f[0] for f in found], errors, np.array([f[3] for f in found]), {})


def traction_stage(patches: Patches) -> list[Found]:
    """Measure friction force and energy summed over a grid of tractions against the integrals."""
    exact, power = vars(sliding.integrals(patches.ellipse, patches.slip, patches.friction, nodes=64)).values()
    power = power / patches.slip.rolling_radius
    bound = patches.friction * patches.ellipse.normal_force
    out: list[Found] = []
    for points in GRID_POINTS:
        t, seconds = cpu(sliding.tractions, patches.ellipse, patches.slip, patches.friction, points=points)
        area = (t.x[:, 1] - t.x[:, 0]) * (t.y[:, 1] - t.y[:, 0])
        lateral, rolling = (area * s.sum(axis=(1, 2)) for s in (t.shear_lateral, t.shear_rolling))
        work = -area * (t.shear_lateral * t.slip_lateral + t.shear_rolling * t.slip_rolling).sum(axis=(1, 2))
        force = np.hypot(lateral - exact.lateral_force, rolling - exact.driving_force) / bound
        setting = Setting("tractions", "sliding", "grid", str(points), points)
        out.append((setting, "friction_force", force, seconds / len(patches)))
        out.append((setting, "friction_energy", np.abs(work / power - 1.0), seconds / len(patches)))
    return out


def stress_points() -> np.ndarray:
    """Return places in normalised coordinates, on the surface inside the patch and below it, shape (m, 3)."""
    angle = 2.0 * np.pi * np.arange(8) / 8 + 0.2
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    flat = np.concatenate([[[0.03, 0.02]], 0.4 * ring, 0.8 * ring])
    return np.concatenate([np.column_stack([flat, np.full(len(flat), depth)]) for depth in (0.0, 0.1, 0.4, 1.0)])


def stress_stage(patches: Patches, element_patches: int = 12) -> list[Found]:
    """Compare stresses at given points by plane waves and chords with those by elements with bilinear tractions."""
    unit, e = stress_points(), patches.ellipse
    depth = np.minimum(e.semi_axis_lateral, e.semi_axis_rolling)
    scale = np.stack([e.semi_axis_lateral, e.semi_axis_rolling, depth], axis=1)
    points = unit[None] * scale[:, None]
    exact = _waves(patches, points, 96)
    out: list[Found] = []
    for order in WAVES:
        found, seconds = cpu(_waves, patches, points, order)
        setting = Setting("stress", "sliding", "plane waves", str(order), order)
        out.append((setting, "stress", _largest(found, exact), seconds / len(patches)))
    few = min(element_patches, len(patches))
    for count in STRESS_ELEMENTS:
        found, seconds = cpu(_elements, patches, points, count, few)
        setting = Setting("stress", "sliding", "bilinear elements", str(count), count)
        out.append((setting, "stress", _largest(found, exact[:few]), seconds / few))
    return out


def _largest(found: np.ndarray, exact: np.ndarray) -> np.ndarray:
    return np.max(np.abs(found - exact), axis=1) / np.max(exact, axis=1)


def _waves(patches: Patches, points: np.ndarray, order: int) -> np.ndarray:
    """Return the von Mises stress over p_max of the roller at points (n, m, 3), shape (n, m)."""
    out = np.empty(points.shape[:2])
    for i, row in enumerate(patches.rows):
        parts, nu = stress_parts(row, points[i], order, order), patches.poisson[i]
        out[i] = von_mises(parts[:, 0] + nu * parts[:, 1] + parts[:, 2] + nu * parts[:, 3])
    return out


def _elements(patches: Patches, points: np.ndarray, count: int, few: int) -> np.ndarray:
    rows = np.arange(few)
    t = sliding.tractions(patches.ellipse.take(rows), patches.slip.take(rows), patches.friction[rows], points=count + 1)
    out = np.empty((few, points.shape[1]))
    for i in range(few):
        stress = stress_from_tractions(
            t.x[i],
            t.y[i],
            t.pressure[i],
            t.shear_lateral[i],
            t.shear_rolling[i],
            points[i],
            float(patches.poisson[i]),
        )
        out[i] = von_mises(stress) / patches.ellipse.max_pressure[i]
    return out


def grid_search_stage(patches: Patches, few: int = 10) -> list[Found]:
    """Measure the highest point of a regular grid as the peak.

    The grid begins at the surface or, as published, 1.5 steps below it.
    """
    few = min(few, len(patches))
    exact = patches.solution["peak_stress"].isel(contact=0, body=0).values[:few]
    out: list[Found] = []
    for start, name in ((0.0, "grid"), (PUBLISHED_START, "grid below the surface")):
        for count in SCAN_POINTS:
            found, seconds = cpu(_grid_peaks, patches, count, few, start)
            setting = Setting("peak", "sliding", name, str(count), count)
            out.append((setting, "peak_stress", np.abs(found / exact - 1.0), 4.0 * seconds / few))
    return out


def _grid_peaks(patches: Patches, count: int, few: int, start: float) -> np.ndarray:
    return np.array([grid_peak(patches, i, count, max(count // 3, 4), start) for i in range(few)])


def grid_peak(patches: Patches, i: int, count: int, depths: int, start: float, stride: int = 1) -> float:
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
