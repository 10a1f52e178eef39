"""Sentences on the life of a case whose material was fitted to tests: its interval, and whether it is extrapolated."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from trackroller.fit.bench import DEFAULTS
from trackroller.fit.stored import StoredFit, stored_fit
from trackroller.parameters import BODIES
from trackroller.report.numbers import rounded
from trackroller.roller.record import materials_of

PROBABILITIES = (0.5, 0.1)


def by_tests(ds: xr.Dataset) -> list[str]:
    """Return what tests say of the lives by fatigue of a solved case; [] for materials that were not fitted.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case.
    """
    said, stored = [], materials_of(ds)
    for body in BODIES:
        values = stored[f"{body}_material"]
        fit = stored_fit(str(values.get("name", "")), values)
        if fit is None or "life_cycles" not in ds:
            continue
        other = [f"{key} {fit.given[key]}" for key in DEFAULTS if fit.given.get(key, ds.attrs[key]) != ds.attrs[key]]
        if other:
            said.append(
                f"The values of {fit.name} hold for {' and '.join(other)} alone: solve with it, or fit the tests anew."
            )
            continue
        said += _of_body(ds, body, fit)
    return said


def _of_body(ds: xr.Dataset, body: str, fit: StoredFit) -> list[str]:
    """Return the interval of the life of one body."""
    own = ds["fatigue_stress" if "fatigue_stress" in ds else "peak_stress"].sel(body=body)
    stress, cycles = float(own.max("contact")), float(ds["life_cycles"].sel(body=body).min("contact"))
    if not (math.isfinite(stress) and math.isfinite(cycles) and cycles > 0):
        return []
    hours = float(ds["life_hours"].sel(body=body).min("contact")) / cycles
    scale, unit = (1.0, "overrollings") if math.isnan(hours) else (hours, "h")
    parts = []
    for probability in PROBABILITIES:
        low, high = (scale * end for end in fit.cycles(stress, probability))
        upper = f"to {rounded(high, 2)} {unit}" if np.isfinite(high) and high < 1e15 else f"{unit} or more"
        parts.append(f"B{100 * probability:.0f} {rounded(low, 2)} {upper}")
    said = [f"Life of the {body} by the {fit.rows} tests of {fit.name}: {' and '.join(parts)} (90 % intervals)."]
    if fit.extrapolates(stress, cycles):
        low, high, longest = fit.tested
        said.append(
            f"This life is an extrapolation: tested were {rounded(low)} to {rounded(high)} MPa and up to "
            f"{rounded(longest, 2)} cycles, and the {body} has {rounded(stress)} MPa and {rounded(cycles, 2)} cycles."
        )
    return said
