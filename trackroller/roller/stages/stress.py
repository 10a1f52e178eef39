"""The stages of a solution that look for stresses: stop conditions, peaks and fields below the surface."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trackroller.contact import sliding
from trackroller.contact.common import Slip
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.models import traction_share
from trackroller.halfspace.bounds import lower_bounds
from trackroller.halfspace.ellipse import NO_FIELD, patch_rows, stress_parts
from trackroller.halfspace.peak import Peak, find_peaks
from trackroller.halfspace.stress import von_mises
from trackroller.roller.options import Options
from trackroller.roller.requirements import distinct_rows, normalised_patches
from trackroller.roller.stages import grid as stages_grid
from trackroller.roller.stages.scene import Results, surface_tractions
from trackroller.roller.stop import PEAK, holds, parse_condition


def _patches(results: Results, options: Options, slip: Slip | None = None) -> np.ndarray:
    good = results.good
    slip = results.slip if slip is None else slip
    return patch_rows(
        results.ellipse.take(good),
        slip.take(good),
        results.friction[good],
        sliding.spin_model_index(options.spin_model),
        results.slides_along[good],
    )


def _poisson(results: Results, options: Options) -> np.ndarray:
    table = results.scene.table
    nu = np.stack([table.roller.poisson_ratio, table.guide.poisson_ratio], axis=1)
    if options.stress_bodies == "published":
        nu = np.repeat(nu.mean(axis=1, keepdims=True), 2, axis=1)
    return np.concatenate([nu, nu])


def _traction_fields(results: Results) -> np.ndarray | None:
    """Traction over its bound on the grid of each existing patch; None where full sliding needs no grid."""
    if results.scene.model.full_sliding or results.scene.frictionless:
        return None
    if results.share is None:
        results.share = traction_share(surface_tractions(results), results.friction[results.good])
    return results.share


def stop(results: Results, options: Options) -> None:
    """Marks the cases for which the condition of `stop_if` holds already: what follows leaves them out."""
    if options.stop_if is None:
        return
    table, v = results.scene.table, results.values
    bounded = []
    for comparison in parse_condition(options.stop_if):
        if comparison.name == PEAK:
            bounded.append(comparison)
            continue
        value = results.regime.astype(float) if comparison.name == "regime" else v[comparison.name]
        results.stopped |= holds(comparison, value, table)
    if bounded:
        lower = _peak_bound(results, options)
        for comparison in bounded:
            results.stopped |= holds(comparison, lower, table)


def _peak_bound(results: Results, options: Options) -> np.ndarray:
    """Lower bound of the peak stress, shape (n, 2, 2): the largest of a few points of each patch."""
    wanted = results.good & ~np.tile(results.stopped, 2)
    out = np.full((2 * results.scene.n, 2), np.nan)
    if wanted.any():
        among, fields = wanted[results.good], _traction_fields(results)
        patches, ratios = _patches(results, options)[among], _poisson(results, options)[wanted]
        bound = lower_bounds(patches, ratios, None if fields is None else fields[among])
        out[wanted] = bound * results.ellipse.max_pressure[wanted][:, None]
    if options.stress_bodies == "published":
        out[:, 1] = out[:, 0]
    return results.by_contact(out)


def peak_stress(results: Results, options: Options) -> None:
    """Peak von Mises stress of each contact and body, its place and error estimate."""
    good = results.good & ~np.tile(results.stopped, 2)
    mirror = results.scene.mirror
    asked = mirror.asked(good)
    if isinstance(results.ellipse, GridPatch):
        peak, scale, side = stages_grid.peaks(results, asked, _poisson(results, options), options), 1.0, 1.0
    else:
        peak, scale, side = _ellipse_peaks(results, options, asked)
    error = peak.error + results.scene.model.peak_error * results.friction[asked][:, None]
    found = {
        "peak_stress": (peak.stress * scale, 1.0),
        "peak_x": (side * peak.x, -1.0),
        "peak_y": (peak.y, 1.0),
        "peak_z": (peak.z, 1.0),
        "error_estimate": (error, 1.0),
    }
    for name, (value, sign) in found.items():
        full = np.full((2 * results.scene.n, 2), np.nan)
        full[good] = mirror.spread(good, value, sign)
        full = results.by_contact(full)
        if options.stress_bodies == "published":
            full = np.repeat(full[:, :, :1], 2, axis=2)
        results.values[name] = full


def _ellipse_peaks(results: Results, options: Options, asked: np.ndarray):
    """Peaks under the ellipses `asked` (2 n,) over p_max; p_max, and the sign that their x needs."""
    among = asked[results.good]  # of the existing patches
    # contact 2 is searched as its mirror image, so that mirrored scenes have the same numbers
    second = np.repeat([False, True], results.scene.n)
    seen = replace(results.slip, sine=np.abs(results.slip.sine))
    fields = _traction_fields(results)
    if fields is not None:
        fields = fields[among]
        fields[second[asked]] = fields[second[asked]][..., ::-1] * np.array([-1.0, 1.0])[:, None, None]
    peak = _peaks(_patches(results, options, seen)[among], _poisson(results, options)[asked], fields, options)
    scale = results.ellipse.max_pressure[asked][:, None]
    side = np.where(second[asked], -1.0, 1.0)[:, None]
    return peak, scale, side


def _peaks(patches: np.ndarray, ratios: np.ndarray, fields: np.ndarray | None, options: Options) -> Peak:
    """Peaks of patches; patches without a slip field of their own are searched once for each ellipticity."""
    if fields is not None:
        return find_peaks(patches, ratios, options.settings.peak, fields)
    patches, length = normalised_patches(patches)
    first = number = np.arange(len(patches))
    if options.shortcuts:
        first, number = distinct_rows(np.hstack([patches, ratios]))
    peak = find_peaks(patches[first], ratios[first], options.settings.peak)
    scale = length[:, None]
    return Peak(
        peak.stress[number], peak.x[number] * scale, peak.y[number] * scale, peak.z[number] * scale, peak.error[number]
    )


def subsurface(results: Results, options: Options) -> None:
    """All stress components on the two section planes through each peak."""
    m, n = options.settings.section_points, results.scene.n
    depth_points = (m + 1) // 2
    shape_xz = (n, 2, 2, depth_points, m)
    v = results.values
    for name in ("von_mises_xz", "von_mises_yz"):
        v[name] = np.full(shape_xz, np.nan)
    for name in ("stress_xz", "stress_yz"):
        v[name] = np.full((n, 6, *shape_xz[1:]), np.nan)
    for name, count in (("xz_x", m), ("xz_z", depth_points), ("yz_y", m), ("yz_z", depth_points)):
        v[name] = np.full((n, 2, 2, count), np.nan)
    grid = isinstance(results.ellipse, GridPatch)
    rows, fields = (None, None) if grid else (_patches(results, options), _traction_fields(results))
    centre = results.ellipse.centre if isinstance(results.ellipse, GridPatch) else np.zeros(2 * n)
    nu = _poisson(results, options)
    order = max(options.settings.peak.polish, 24)  # the rim is met exactly, where quadrature is hardest
    for row, flat in enumerate(np.flatnonzero(results.good)):
        j, i = divmod(flat, n)
        e = results.ellipse
        a, b, p = e.semi_axis_lateral[flat], e.semi_axis_rolling[flat], e.max_pressure[flat]
        across, along = centre[flat] + np.linspace(-1.5 * a, 1.5 * a, m), np.linspace(-1.5 * b, 1.5 * b, m)
        depth = np.linspace(0.0, 1.0, depth_points) ** 1.5 * 2.0 * min(a, b)
        for body in (0, 1):
            x0, y0 = v["peak_x"][i, j, body], v["peak_y"][i, j, body]
            sign = -1.0 if body == 1 and options.stress_bodies == "both" else 1.0
            planes = (("xz", across, np.full(m, y0)), ("yz", np.full(m, x0), along))
            for plane, xs, ys in planes:
                points = np.stack([np.tile(xs, depth_points), np.tile(ys, depth_points), np.repeat(depth, m)], axis=1)
                if rows is None:
                    s = stages_grid.section(results, row, points, nu[flat, body], sign)
                else:
                    one = NO_FIELD if fields is None else fields[row]
                    parts = stress_parts(rows[row], points, order, order, one)
                    s = p * (
                        parts[:, 0] + nu[flat, body] * parts[:, 1] + sign * (parts[:, 2] + nu[flat, body] * parts[:, 3])
                    )
                v[f"stress_{plane}"][i, :, j, body] = s.T.reshape(6, depth_points, m)
                v[f"von_mises_{plane}"][i, j, body] = von_mises(s).reshape(depth_points, m)
            v["xz_x"][i, j, body], v["yz_y"][i, j, body] = across, along
            v["xz_z"][i, j, body] = v["yz_z"][i, j, body] = depth
