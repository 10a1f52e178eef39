"""Why a case has no solution, or misses its tolerance, and what to do about it, in words."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from trackroller.roller.dataset import validity_bit
from trackroller.roller.equilibrium import FAILED, ROLLING
from trackroller.roller.geometry import contact_geometry

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.roller.case import CaseTable
    from trackroller.roller.options import Options

STEEP = validity_bit("steep_friction")


def with_reasons(ds: xr.Dataset, table: CaseTable, options: Options) -> xr.Dataset:
    """The results, with a text `reason` where a case failed or missed its tolerance ('' for the others)."""
    regime, converged = (np.atleast_1d(ds[name].values) for name in ("regime", "converged"))
    failed, loose = regime == FAILED, (regime == ROLLING) & (converged == 0)
    if not (failed | loose).any():
        return ds
    residual, bits = (np.atleast_1d(ds[name].values) for name in ("residual", "validity"))
    told = np.full(len(regime), "", dtype=object)
    for i in np.flatnonzero(failed | loose).tolist():
        words = "no convergence" if failed[i] else "it rolls, but its solution misses the tolerance"
        if np.isfinite(residual[i]):  # one digit, so that cases of a kind are counted together
            words += f", residual {residual[i]:.0e}"
        told[i] = ". ".join([words, *_hints(table, options, i, bool(bits[i] & STEEP))])
    attrs = {"long_name": "why a case failed or misses its tolerance"}
    return ds.assign(reason=(ds["regime"].dims, told if ds["regime"].dims else told[0], attrs))


def _hints(table: CaseTable, options: Options, i: int, steep: bool) -> list[str]:
    hints = []
    if steep:
        hints.append(
            "Friction falls faster with the slip speed than elastic surfaces follow (steep_friction): "
            "the roller may not roll steadily; a friction_law that falls less steeply, or contact_model: "
            "sliding, has a solution more often"
        )
    rough = [name for name in ("guide_profile", "roller_profile") if _goes_through_points(str(getattr(table, name)[i]))]
    if rough and options.normal == "halfspace":
        hints.append(
            f"The {' and the '.join(rough)} goes through every point, and measuring noise counts as shape: "
            "give `smooth`, the standard deviation of the noise in mm, or 'auto'"
        )
    if options.contact_model == "fastsim" and options.normal == "hertz" and _is_slender(table, i):
        hints.append("The patches are too slender for fastsim: contact_model: kalker goes further")
    if "curve" in options.slip_terms and table.guide_curve_radius[i] < 0:
        hints.append("With slip_terms: curve the contacts must not lie beyond the axis of an inner curve")
    return hints


def _is_slender(table: CaseTable, i: int) -> bool:
    """Is the ellipse more slender than the coefficients of fastsim reach?"""
    from trackroller.contact.hertz import shape
    from trackroller.contact.linear import LARGEST_RATIO

    one = table.take(np.array([i]))
    geometry = contact_geometry(vars(one))
    ellipse = shape(geometry.curvature_lateral, geometry.curvature_rolling, np.ones(1))
    ratio = float(ellipse.lateral[0] / ellipse.rolling[0])
    return max(ratio, 1.0 / ratio) > 0.99 * LARGEST_RATIO


@lru_cache(maxsize=256)
def _goes_through_points(text: str) -> bool:
    """Is this a profile of points that is not smoothed?"""
    told = json.loads(text) if text else {}
    return "points" in told and not told.get("smooth")
