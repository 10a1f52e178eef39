"""Errors of results against a converged reference, one number a design and quantity."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import binom

if TYPE_CHECKING:
    import xarray as xr

# quantity -> what its error is relative to, and what is compared
QUANTITIES = {
    "semi_axes": ("itself", "semi-axes of the ellipse"),
    "max_pressure": ("itself", "largest pressure"),
    "normal_force": ("itself", "normal force F_N"),
    "friction_force": ("mu F_N", "friction force (F_T, F_A)"),
    "spin_moment": ("mu F_N sqrt(a b)", "spin moment M_R"),
    "friction_energy": ("itself", "friction energy per distance"),
    "stress": ("the largest at the points", "von Mises stress at given points"),
    "peak_stress": ("itself", "peak von Mises stress"),
    "life": ("itself", "life in overrollings"),
}


def relative_errors(result: xr.Dataset, reference: xr.Dataset) -> dict[str, np.ndarray]:
    """Return the largest error over contacts and bodies by quantity, shape (n,), of two solutions of the same cases.

    A row whose regime differs counts as infinite, one that neither has as NaN.
    """
    out = {}
    n_ref = reference["normal_force"].values
    # the friction force scale comes with the case: without friction there is nothing to compare
    friction = reference["friction"].values[:, None] * n_ref
    with np.errstate(divide="ignore", invalid="ignore"):
        out["normal_force"] = largest(np.abs(result["normal_force"].values / n_ref - 1.0))
        apart = np.hypot(*(result[q].values - reference[q].values for q in ("lateral_force", "driving_force")))
        out["friction_force"] = largest(apart / friction)
        if "semi_axis_lateral" in result:
            axes = [
                np.abs(result[q].values / reference[q].values - 1.0) for q in ("semi_axis_lateral", "semi_axis_rolling")
            ]
            out["semi_axes"] = largest(np.maximum(*axes))
            out["max_pressure"] = largest(np.abs(result["max_pressure"].values / reference["max_pressure"].values - 1))
        size = np.sqrt(reference["semi_axis_lateral"].values * reference["semi_axis_rolling"].values)
        apart = np.abs(result["spin_moment"].values - reference["spin_moment"].values)
        out["spin_moment"] = largest(apart / (friction * size))
        for quantity, name in (
            ("friction_energy", "friction_energy_per_distance"),
            ("peak_stress", "peak_stress"),
            ("life", "life_cycles"),
        ):
            if name in result and name in reference:
                out[quantity] = largest(np.abs(result[name].values / reference[name].values - 1.0))
    other = result["regime"].values != reference["regime"].values
    return {name: np.where(other, np.inf, value) for name, value in out.items()}


def largest(values: np.ndarray) -> np.ndarray:
    """Return the largest known value of each case, (n,); NaN where none is known."""
    flat = values.reshape(len(values), -1)
    known = ~np.isnan(flat)
    return np.where(known.any(axis=1), np.max(np.where(known, flat, -np.inf), axis=1), np.nan)


def percentiles(errors: np.ndarray, levels: tuple[float, ...] = (50, 95, 99)) -> np.ndarray:
    """Return percentiles of the known errors that are values of the sample, so that inf changes no other one."""
    known = errors[~np.isnan(errors)]
    if known.size == 0:
        return np.full(len(levels), np.nan)
    return np.percentile(known, levels, method="higher")


def tolerance_bound(errors: np.ndarray, share: float = 0.99, confidence: float = 0.95) -> float:
    """Return the error that `share` of all cases keep, with `confidence`, where the sample is large enough for that.

    Distribution-free (Wilks 1941): the k-th largest with k as large as the binomial law allows. A sample below
    log(1 - confidence)/log(share) (299 designs) cannot say so much: ASSUME then half as much again as its 95th
    percentile, which is a promise for about 95 % of the cases.
    """

    known = np.sort(errors[~np.isnan(errors)])[::-1]
    if known.size == 0:
        return float("nan")
    beyond = int(binom.ppf(1 - confidence, known.size, 1 - share))  # P(count <= beyond) >= 1 - confidence
    while beyond >= 0 and binom.cdf(beyond, known.size, 1 - share) > 1 - confidence:
        beyond -= 1
    return float(known[beyond]) if beyond >= 0 else 1.5 * float(percentiles(errors, (95,))[0])


def observed_order(points: np.ndarray, errors: np.ndarray) -> tuple[float, float]:
    """Return the slope of log error over log 1/points by least squares, and R^2; NaN with fewer than 3 usable points.

    Errors at the floor of rounding (below 1e-12) are left out.
    """
    x, y = np.asarray(points, float), np.asarray(errors, float)
    good = np.isfinite(y) & (y > 1e-12) & np.isfinite(x)
    if good.sum() < 3:
        return float("nan"), float("nan")
    u, v = np.log(x[good]), np.log(y[good])
    slope, offset = np.polyfit(u, v, 1)
    rest = v - (slope * u + offset)
    total = np.sum((v - v.mean()) ** 2)
    return float(-slope), float(1.0 - np.sum(rest**2) / total) if total > 0 else float("nan")
