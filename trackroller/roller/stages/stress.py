"""The stages of a solution that compute stresses: stop conditions, peaks and fields below the surface."""

from __future__ import annotations

import numpy as np

from trackroller.halfspace.stress import von_mises
from trackroller.roller.options import Options
from trackroller.roller.stages.ellipse_stresses import EllipseStresses
from trackroller.roller.stages.grid_stresses import GridStresses
from trackroller.roller.stages.patch_stresses import PatchStresses
from trackroller.roller.stages.scene import StageResults
from trackroller.roller.stop import PEAK, compared, holds, parse_condition

SECTION_SIDES = 1.5  # extent of the sections over the semi-axis
SECTION_DEPTH = 2.0  # depth of the sections over the smaller semi-axis


def stresses_of(results: StageResults, options: Options) -> PatchStresses:
    """Return the stresses below the patches of a block, for ellipses or for solved patches."""
    return (EllipseStresses if results.patch.is_hertzian else GridStresses)(results, options)


def stop(results: StageResults, options: Options) -> None:
    """Mark the cases for which the condition of `stop_if` already holds; the following stages leave them out."""
    if options.stop_if is None:
        return
    for comparison in sorted(parse_condition(options.stop_if), key=lambda part: compared(part) == PEAK):
        name = compared(comparison)
        if name == PEAK:  # the last ones, because its bound takes longest
            value = peak_bound(results, options)
        else:
            if name == "regime":
                value = results.regime.astype(float)
            else:
                value = results.in_mm(name)
        results.stopped |= holds(comparison, value, results.scene.table)


def peak_bound(results: StageResults, options: Options) -> np.ndarray:
    """Return a lower bound of the peak stress of each contact and body, (n, 2, 2) [MPa]."""
    searched = results.good & ~np.tile(results.stopped, 2)
    out = np.full((2 * results.scene.n, 2), np.nan)
    if searched.any():
        out[searched] = stresses_of(results, options).bounds(searched)
    if options.stress_bodies == "published":
        out[:, 1] = out[:, 0]
    return results.by_contact(out)


def peak_stress(results: StageResults, options: Options) -> None:
    """Add the peak von Mises stress of each contact and body, its place and its error estimate."""
    good = results.good & ~np.tile(results.stopped, 2)
    mirror = results.scene.mirror
    solved = mirror.to_solve(good)
    peak = stresses_of(results, options).peaks(solved)
    quantities = {
        "peak_stress": (peak.stress, 1.0),
        "peak_x": (peak.x, -1.0),
        "peak_y": (peak.y, 1.0),
        "peak_z": (peak.z, 1.0),
        "error_estimate": (peak.error + results.scene.model.peak_error * results.friction[solved][:, None], 1.0),
    }
    for name, (value, sign) in quantities.items():
        full = np.full((2 * results.scene.n, 2), np.nan)
        full[good] = mirror.spread(good, value, sign)
        full = results.by_contact(full)
        if options.stress_bodies == "published":
            full = np.repeat(full[:, :, :1], 2, axis=2)
        results.values[name] = full


def subsurface(results: StageResults, options: Options) -> None:
    """Add all stress components on the two section planes through each peak."""
    m = options.settings.section_points
    n = results.scene.n
    v = results.values
    depths = (m + 1) // 2
    sizes: dict[str, tuple[int, ...]] = {"xz_x": (m,), "xz_z": (depths,), "yz_y": (m,), "yz_z": (depths,)}
    sizes |= {"von_mises_xz": (depths, m), "von_mises_yz": (depths, m)}
    for name, size in sizes.items():
        v[name] = np.full((n, 2, 2, *size), np.nan)
    for name in ("stress_xz", "stress_yz"):
        v[name] = np.full((n, 6, 2, 2, depths, m), np.nan)
    stresses = stresses_of(results, options)
    for flat in np.flatnonzero(results.good).tolist():
        contact, case = divmod(flat, n)
        for body in (0, 1):
            _sections(results, options, stresses, flat, (case, contact, body))


def _sections(
    results: StageResults, options: Options, stresses: PatchStresses, flat: int, place: tuple[int, int, int]
) -> None:
    """Fill the two sections through the peak at `place`: number of the case, contact and body."""
    v = results.values
    patch = results.patch
    case, contact, body = place
    m = options.settings.section_points
    a, b = patch.semi_axis_lateral[flat], patch.semi_axis_rolling[flat]
    across = patch.centre[flat] + np.linspace(-SECTION_SIDES * a, SECTION_SIDES * a, m)
    along = np.linspace(-SECTION_SIDES * b, SECTION_SIDES * b, m)
    depth = np.linspace(0.0, 1.0, (m + 1) // 2) ** 1.5 * SECTION_DEPTH * min(a, b)
    sign = 1.0
    if body == 1 and options.stress_bodies == "both":
        sign = -1.0
    planes = {"xz": (across, np.full(m, v["peak_y"][place])), "yz": (np.full(m, v["peak_x"][place]), along)}
    for plane, (xs, ys) in planes.items():
        points = [np.tile(xs, depth.size), np.tile(ys, depth.size), np.repeat(depth, m)]
        stress = stresses.at(flat, np.stack(points, axis=1), body, sign)
        v[f"stress_{plane}"][case, :, contact, body] = stress.T.reshape(6, depth.size, m)
        v[f"von_mises_{plane}"][place] = von_mises(stress).reshape(depth.size, m)
        v[f"{plane}_z"][place] = depth
    v["xz_x"][place] = across
    v["yz_y"][place] = along
