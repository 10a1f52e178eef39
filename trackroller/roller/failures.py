"""State why a case has no solution, or misses its tolerance, and what the user can do."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact.slip import turning_of
from trackroller.roller.case_table import CaseTable
from trackroller.roller.dataset import validity_bit
from trackroller.roller.equilibrium import FAILED, ROLLING
from trackroller.roller.geometry import contact_geometry
from trackroller.roller.options import Options

if TYPE_CHECKING:
    import xarray as xr

STEEP = validity_bit("steep_friction")
PROFILES = ("guide_profile", "roller_profile")


def with_reasons(
    ds: xr.Dataset, table: CaseTable, options: Options, lost: Mapping[int, str] | None = None
) -> xr.Dataset:
    """Return results with a text `reason` where a case failed or missed its tolerance.

    Parameters
    ----------
    ds : xarray.Dataset
        Results with the dimension `case`, or of a single case.
    table : CaseTable
        The n cases.
    options : Options
        Options of the solution.
    lost : mapping, optional
        Known reasons by row.

    Returns
    -------
    xarray.Dataset
        The same results; `reason` is "" for solved cases, and missing if all cases are solved.
    """
    regime, converged = (np.atleast_1d(ds.variables[name].values) for name in ("regime", "converged"))
    failed = regime == FAILED
    loose = (regime == ROLLING) & (converged == 0)
    if not (failed | loose).any():
        return ds
    residual, bits = (np.atleast_1d(ds[name].values) for name in ("residual", "validity"))
    reasons = np.full(len(regime), "", dtype=object)
    for i in np.flatnonzero(failed | loose).tolist():
        if lost and i in lost:
            reasons[i] = lost[i]
            continue
        words = "it rolls, but its solution misses the tolerance"
        if failed[i]:
            words = "no convergence"
        if np.isfinite(residual[i]):  # one digit, so that cases of one kind are counted together
            words += f", residual {residual[i]:.0e}"
        case = table.take(np.array([i]))
        reasons[i] = ". ".join([words, *_hints(case, options, bool(bits[i] & STEEP))])
    attrs = {"long_name": "why a case failed or misses its tolerance"}
    if not ds["regime"].dims:
        return ds.assign(reason=((), reasons[0], attrs))
    return ds.assign(reason=(ds["regime"].dims, reasons, attrs))


def _hints(case: CaseTable, options: Options, steep: bool) -> list[str]:
    """Return why a single case has no solution, as far as known, and what to do about it."""
    if "curve" in options.slip_terms and _beyond_the_axis(case):
        return [
            "With slip_terms: curve the contacts must not lie beyond the axis of the inner curve, "
            "where guide_curve_radius + guide_profile_radius cos(contact_angle) > 0: leave 'curve' out"
        ]
    hints = []
    if steep:
        hints.append(
            "Friction falls faster with the slip speed than elastic surfaces follow (steep_friction): "
            "the roller may not roll steadily; a friction_law that falls less steeply, or contact_model: "
            "sliding, has a solution more often"
        )
    rough = [name for name in PROFILES if _goes_through_points(str(getattr(case, name)[0]))]
    if rough and options.normal == "halfspace":
        hints.append(
            f"The {' and the '.join(rough)} goes through every point, and measuring noise counts as shape: "
            "give smooth: auto"
        )
    return hints


def _beyond_the_axis(case: CaseTable) -> bool:
    """Return True if the contacts lie beyond the axis of a concave guide, where the turning is not defined."""
    cosine = np.cos(contact_geometry(vars(case)).contact_angle)
    return bool(np.isnan(turning_of(case.guide_curve_radius, case.guide_profile_radius, cosine)[0]))


@lru_cache(maxsize=256)
def _goes_through_points(text: str) -> bool:
    """Return True if a profile is given by points without smoothing."""
    profile = json.loads(text) if text else {}
    return "points" in profile and not profile.get("smooth")
