"""Sentences on the life of a case by a fitted material: what is extrapolated, and fits that do not hold."""

from __future__ import annotations

import math

import xarray as xr

from trackroller.fit.stored import StoredFit, fits_of_case
from trackroller.report.numbers import rounded


def by_tests(ds: xr.Dataset) -> list[str]:
    """Return what tests do not tell of the lives by fatigue of a solved case; [] for materials that were not fitted.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case.
    """
    found, others = fits_of_case(ds)
    said = [
        f"The values of {name} hold for {options} alone: solve with it, or fit the tests anew."
        for name, options in others.items()
    ]
    return [*said, *filter(None, (_extrapolation(ds, body, fit) for body, fit in found.items()))]


def worst(ds: xr.Dataset, body: str, fit: StoredFit) -> tuple[float, float]:
    """Return the stress of a body that enters its line [MPa], and its overrollings to failure, at its worse contact.

    A result without stresses gives the stress by the line of the fit, from which its overrollings follow.
    """
    cycles = float(ds["life_cycles"].sel(body=body).min("contact"))
    for name in ("fatigue_stress", "peak_stress"):
        if name in ds:
            return float(ds[name].sel(body=body).max("contact")), cycles
    best = fit.line.best
    return math.exp(fit.line.reference + float((best.level - math.log(cycles)) / best.slope)), cycles


def _extrapolation(ds: xr.Dataset, body: str, fit: StoredFit) -> str:
    """Say that the life of a body lies beyond the tests; '' where it does not."""
    stress, cycles = worst(ds, body, fit)
    if not (stress > 0 and fit.extrapolates(stress, cycles)):
        return ""
    low, high, longest = fit.tested
    return (
        f"The life of the {body} is an extrapolation: {rounded(low)} to {rounded(high)} MPa and up to "
        f"{rounded(longest, 2)} cycles were tested, and the {body} has {rounded(stress)} MPa and {rounded(cycles, 2)} "
        "cycles."
    )
