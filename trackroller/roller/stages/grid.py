"""What the stages do otherwise where patch and pressure are solved on a grid (`normal="halfspace"`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact.common import Elastic
from trackroller.contact.drawn_profiles import gap, treats_sides_alike
from trackroller.contact.friction_laws import FrictionLaw
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.hertz import contact_modulus
from trackroller.contact.normal.models import GridModel, grid_model
from trackroller.contact.normal.patches import Patches
from trackroller.halfspace.grid_peak import GridLoad, body_stress, find_grid_peaks, stress_parts
from trackroller.halfspace.stress import von_mises
from trackroller.numerics.threads import share_rows
from trackroller.roller import equilibrium as eq
from trackroller.roller.stages.scene import Results, surface_tractions

if TYPE_CHECKING:
    from trackroller.halfspace.peak import Peak
    from trackroller.roller.case import CaseTable
    from trackroller.roller.options import Options

REFINED_ERROR, FINEST_ERROR = 4.0, 5e-3  # estimated error of a peak, over the tolerance and at least, to refine above
REFINEMENTS = 2, 4  # times the elements
LARGEST_GRID = 160  # elements across that are refined to
RESOLVED = 0.95  # of the largest pressure that means over 2 x 2 elements keep
NEAR = 4.0  # elements of depth down to which subsurface fields need the full grid


def halfspace_model(
    table: CaseTable, options: Options, rolling_radius: np.ndarray, law: FrictionLaw, travel_speed: np.ndarray
) -> GridModel:
    """The contact model on solved patches for the cases of `table`; r_A [mm], travel speed [mm/s], (n,)."""
    columns = np.stack(
        [
            table.guide_profile_radius,
            table.roller_profile_radius,
            np.deg2rad(table.contact_angle),
            rolling_radius,
            table.guide_curve_radius,
        ],
        axis=1,
    ).tolist()

    def gaps(row: int, side: int):
        guide, roller = str(table.guide_profile[row]), str(table.roller_profile[row])
        if treats_sides_alike(guide) and treats_sides_alike(roller):
            side = 1
        key = (guide, roller, *columns[row], side)
        return key, lambda: gap(*key)

    bodies = (
        table.roller.youngs_modulus,
        table.roller.poisson_ratio,
        table.guide.youngs_modulus,
        table.guide.poisson_ratio,
    )
    elements = 2 * -(-options.settings.elements // 2)
    patches = Patches(gaps, contact_modulus(*bodies), elements)
    return grid_model(
        options.contact_model,
        patches,
        Elastic.of_pair(*bodies),
        options.spin_model,
        law,
        travel_speed,
        "profile" in options.slip_terms,
    )


def contact(results: Results, patch: GridPatch, conformal: int) -> None:
    """Extents, area and centre of pressure; `conformal` is the bit of patches that reach an edge."""
    half = patch.half_extents
    results.values["semi_axis_lateral"], results.values["semi_axis_rolling"] = (results.by_contact(v) for v in half)
    results.values["patch_area"] = results.by_contact(patch.area)
    with np.errstate(invalid="ignore"):
        results.values["pressure_centre"] = results.by_contact(patch.pressure_centre)
    edge = results.by_contact(patch.reaches_edge).any(axis=1)
    results.bits |= np.where(edge, conformal, 0).astype(np.int32)


def shift_of_pressure(results: Results, patch: GridPatch) -> None:
    """What the place of the pressure adds to moments: to the tilting moment, and to the spin moment in full slip."""
    v = results.values
    with np.errstate(invalid="ignore"):
        offset = results.by_contact(patch.pressure_centre)
    v["tilting_moment"] = v["tilting_moment"] + (v["normal_force"] * offset).sum(axis=1)
    slides = (results.regime == eq.FULL_SLIP)[:, None]
    v["spin_moment"] = np.where(slides, offset * v["driving_force"], v["spin_moment"])


def _load(results: Results, row: int) -> GridLoad:
    """Tractions of the existing patch number `row`."""
    t = surface_tractions(results)
    fields = np.stack([t.shear_lateral[row], t.shear_rolling[row], t.pressure[row]], axis=-1)
    return GridLoad(t.x[row], t.y[row], fields)


def peaks(results: Results, asked: np.ndarray, poisson_ratio: np.ndarray, options: Options) -> Peak:
    """Peaks of the patches `asked` (2 n,) in MPa; poisson_ratio (2 n, 2).

    Where the slip turns within an element (its pole in a slender patch), the tractions of models that know them
    anywhere are taken on finer elements, until the estimated error is that of other patches.
    """
    loads = [_load(results, row) for row in np.flatnonzero(asked[results.good]).tolist()]
    ratios, seeds = poisson_ratio[asked], max(2, options.settings.peak.finalists)
    peak = find_grid_peaks(loads, ratios, seeds)
    patches, model = results.ellipse, results.scene.model
    if not isinstance(patches, GridPatch) or not model.refines:
        return peak
    flat = np.flatnonzero(asked)
    # a pressure that is singular, or on ridges too narrow for its elements, stays what it is
    allowed = (results.slides_along[flat] == 0) & ~patches.reaches_edge[flat] & (results.friction[flat] > 0)
    allowed &= [load.coarse.tractions[:, :, 2].max() > RESOLVED * load.tractions[:, :, 2].max() for load in loads]
    goal = max(REFINED_ERROR * options.settings.tolerance, FINEST_ERROR)
    for times in REFINEMENTS:
        rows = np.flatnonzero(allowed & (peak.error.max(axis=1) > goal))
        if times * patches.shape[1] > LARGEST_GRID or not rows.size:
            break
        finer = find_grid_peaks([_refined(results, int(flat[i]), times) for i in rows], ratios[rows], seeds)
        for name in ("stress", "x", "y", "z", "error"):
            getattr(peak, name)[rows] = getattr(finer, name)
    return peak


def _refined(results: Results, flat: int, times: int) -> GridLoad:
    """Tractions of the patch `flat` of 2 n on finer elements; along the rolling direction too if that is the longer."""
    one = np.array([flat])
    patch = results.ellipse.take(one)
    long = bool(patch.semi_axis_rolling[0] * patch.shape[1] > patch.semi_axis_lateral[0] * patch.shape[0])
    t = results.scene.model.surface(
        patch.refined(times if long else 1, times), results.slip.take(one), results.friction[one], results.rows[one]
    )
    return GridLoad(t.x[0], t.y[0], np.stack([t.shear_lateral[0], t.shear_rolling[0], t.pressure[0]], axis=-1))


def lower_bounds(results: Results, wanted: np.ndarray, poisson_ratio: np.ndarray) -> np.ndarray:
    """von Mises stress of both bodies in a few points of each patch `wanted` (2 n,), the largest; (m, 2) [MPa]."""
    out = []
    for row, nu in zip(np.flatnonzero(wanted[results.good]).tolist(), poisson_ratio[wanted], strict=True):
        load = _load(results, row)
        a, b = load.size
        centre = np.array([load.x.mean(), load.y.mean(), 0.0])
        unit = np.array([(0, 0, 0.45), (0.4, 0, 0), (-0.4, 0, 0), (0, 0.9, 0), (0, -0.9, 0), (0, 0, 0.3)])
        parts = stress_parts(load.coarse, centre + unit * np.array([a, b, min(a, b)]))
        out.append([von_mises(body_stress(parts, nu[k], sign)).max() for k, sign in ((0, 1.0), (1, -1.0))])
    return np.array(out).reshape(-1, 2)


def section(results: Results, row: int, points: np.ndarray, poisson_ratio: float, sign: float) -> np.ndarray:
    """Stress (m, 6) [MPa] of one body at points (m, 3) below the existing patch number `row`."""
    load = _load(results, row)
    coarse = load.coarse
    deep = points[:, 2] > NEAR * max(load.x[1] - load.x[0], load.y[1] - load.y[0])
    out = np.empty((len(points), 6))
    for rows, grid in ((np.flatnonzero(deep), coarse), (np.flatnonzero(~deep), load)):

        def work(first: int, last: int, rows=rows, grid=grid) -> None:
            part = rows[first:last]
            out[part] = body_stress(stress_parts(grid, points[part]), poisson_ratio, sign)

        share_rows(work, rows.size, 32)
    return out
