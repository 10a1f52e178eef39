"""Fits that stand beside the user's materials file: lives with the interval by their tests."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError
from trackroller.fit.line import Interval, Line, Tests
from trackroller.fit.posterior import Posterior
from trackroller.fit.solved_rollers import DEFAULTS
from trackroller.materials.file import find_user_file, posterior_path
from trackroller.parameters import BODIES
from trackroller.roller.stored_inputs import materials_of

SAME = 1e-6  # relative difference of values of a material and of its fit that rounding may cause

HOLDS = "holds_for_"


@dataclass(frozen=True)
class StoredFit:
    """The line of fatigue of a material that `trackroller fit` wrote.

    Attributes
    ----------
    name : str
        Name of the material.
    line : Line
        The line with its tests.
    posterior : Posterior
        Posterior of its values.
    given : dict of str to str
        For what the values hold, such as `contact_model`.
    tested : tuple of float
        Least and largest stress tested [MPa], and cycles of the longest test [1].
    rows : int
        Number of tests.
    """

    name: str
    line: Line
    posterior: Posterior
    given: dict[str, str]
    tested: tuple[float, float, float]
    rows: int

    def cycles(self, stress: float, probability: float) -> Interval:
        """Return the 90 % interval of the cycles under a stress [MPa] at a failure probability."""
        interval = self.line.interval_of_life(math.log(stress), probability)
        return Interval(*(float(np.exp(end)) for end in interval))

    def extrapolates(self, stress: float | np.ndarray, cycles: float | np.ndarray) -> np.ndarray:
        """Return whether stresses [MPa] or lives lie beyond the tests, of the same shape."""
        low, high, longest = self.tested
        outside = (np.asarray(stress) < low * (1 - 1e-9)) | (np.asarray(stress) > high * (1 + 1e-9))
        return np.asarray(outside | (np.asarray(cycles) > longest))


def stored_fit(name: str, values: Mapping[str, Any], file: Path | None = None) -> StoredFit | None:
    """Return the fit of a material of the user's file; None for a material without one.

    Parameters
    ----------
    name : str
        Name of the material.
    values : mapping
        Its values, of which the strength must be that of the fit: a material changed by hand has no fit any more.
    file : Path, optional
        The materials file beside which the fit stands; by default the user's.

    Raises
    ------
    InputError
        If the file of the fit cannot be read.
    """
    file = find_user_file() if file is None else file
    if file is None:
        path = None
    else:
        path = posterior_path(file, name)
    if path is None or not path.is_file():
        return None
    try:
        stored = _read(path, name, path.stat().st_mtime_ns)
    except KeyError as missing:
        allowed = "a file that `trackroller fit` of this version wrote"
        raise InputError("fit", str(path), allowed, "Fit the tests again.", f"lacks {missing}") from None
    if stored is None:
        return None
    fit, strength = stored
    ratio = values.get("fatigue_strength_ratio")
    limit = values.get("fatigue_limit", math.nan)
    if "fatigue_limit" not in values and ratio is not None:
        limit = ratio * values["tensile_strength"]
    knee = values.get("cycles_at_fatigue_limit", math.nan)
    agrees = all(abs(a - b) <= SAME * abs(b) for a, b in zip((limit, knee), strength, strict=True))
    if agrees:
        return fit
    return None


def fits_of_case(ds: xr.Dataset) -> tuple[dict[str, StoredFit], dict[str, str]]:
    """Return the fits of the materials of a solved case by body, and why others do not hold for it, by material.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case.

    Returns
    -------
    tuple of dict
        Fits by body; and for a material whose fit had other options, these options in words.
    """
    fits = {}
    others = {}
    for body in BODIES:
        values = materials_of(ds)[f"{body}_material"]
        fit = stored_fit(str(values.get("name", "")), values)
        if fit is None or "life_cycles" not in ds:
            continue
        other = [f"{key} {fit.given[key]}" for key in DEFAULTS if fit.given.get(key, ds.attrs[key]) != ds.attrs[key]]
        if other:
            others[fit.name] = " and ".join(other)
        else:
            fits[body] = fit
    return fits, others


@functools.lru_cache(maxsize=16)
def _read(path: Path, name: str, changed: int) -> tuple[StoredFit, tuple[float, float]] | None:
    """Return the fit of a file, with strength and knee of its material; None for a fit without fatigue."""
    del changed  # a file that was written again is read again
    try:
        with xr.open_dataset(path) as opened:
            ds = opened.load()
    except (OSError, ValueError) as exc:
        remedy = "Fit the tests again."
        raise InputError(
            "fit", str(path), "a file that `trackroller fit` wrote", remedy, f"is not read ({exc})"
        ) from None
    if "fatigue_level" not in ds or "fatigue_limit" not in ds.attrs:
        return None
    try:
        return _fit_of(ds, name)
    except KeyError as missing:
        remedy = "Fit the tests again."
        wrong = f"is that of another version: it has no {missing.args[0]}"
        raise InputError("fit", str(path), "a file that this version wrote", remedy, wrong) from None


def _fit_of(ds: xr.Dataset, name: str) -> tuple[StoredFit, tuple[float, float]]:
    """Return the fit of a data set of this version, with strength and knee of its material."""
    constants = {key: ds.attrs.get(f"fatigue_held_{key}") for key in ("slope", "scatter")}
    tests = Tests(*(ds[f"fatigue_test_{part}"].values for part in ("stress", "low", "high")))
    line = Line(
        tests,
        slope=constants["slope"],
        scatter=constants["scatter"],
        knee=bool(ds.attrs["fatigue_knee"]),
        specimens=int(ds.attrs["fatigue_tests"]),
    )
    names = {n: n.removeprefix("fatigue_") for n in map(str, ds.data_vars) if n.startswith("fatigue_")}
    posterior = Posterior.from_dataset(ds[list(names)].rename(names))
    given = {key.removeprefix(HOLDS): str(value) for key, value in ds.attrs.items() if key.startswith(HOLDS)}
    tested = (*map(float, ds.attrs["tested_stress"]), float(ds.attrs["tested_cycles"]))
    fit = StoredFit(name, line, posterior, given, tested, int(ds.attrs["rows"]))  # type: ignore[arg-type]
    return fit, (float(ds.attrs["fatigue_limit"]), float(ds.attrs["cycles_at_fatigue_limit"]))
