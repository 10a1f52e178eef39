"""The designs of the trade-off, with their forces and peaks of the exact theory: `tests/data/ladder_truth.csv`."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.roller.case import Case

FINEST_SEARCH = PeakSettings(24, 32, 48, 96, 32, 24, 3e-4, 0.0)  # of peaks that count as the truth

FILE = Path(__file__).resolve().parents[2] / "tests" / "data" / "ladder_truth.csv"
SAMPLES = ("ordinary", "wide")
_INPUTS = (
    "radial_force",
    "friction_coefficient",
    "contact_angle",
    "roller_profile_radius",
    "axial_force",
    "motor_force",
)
FORCES = ("normal_force", "lateral_force", "driving_force")


@dataclass(frozen=True)
class Truth:
    """Designs with known forces and peaks.

    Attributes
    ----------
    cases : list of Case
        The n designs.
    sample : numpy.ndarray of str, shape (n,)
        "ordinary" (friction 0.05 to 0.4, angles 25 to 50 degrees) or "wide" (friction to 1, 15 to 70 degrees).
    forces : dict of str to numpy.ndarray, shape (n, 2)
        F_N, F_T and F_A [N]; NaN beside a lifted contact.
    peak_stress : numpy.ndarray, shape (n, 2, 2)
        By contact and body [MPa].
    force_error, peak_error : numpy.ndarray, shape (n,)
        Errors that the solution of the truth told.
    """

    cases: list[Case]
    sample: np.ndarray
    forces: dict[str, np.ndarray]
    peak_stress: np.ndarray
    force_error: np.ndarray
    peak_error: np.ndarray

    @classmethod
    def read(cls) -> Truth:
        """Return all designs."""
        with FILE.open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))

        def column(name: str) -> np.ndarray:
            return np.array([float(row[name] or "nan") for row in rows])

        bodies = [np.stack([column(f"peak_stress_{body}_{c}") for c in (1, 2)], axis=1) for body in ("roller", "guide")]
        return cls(
            [Case(**{name: float(row[name]) for name in _INPUTS}) for row in rows],
            np.array([row["sample"] for row in rows]),
            {name: np.stack([column(f"{name}_{c}") for c in (1, 2)], axis=1) for name in FORCES},
            np.stack(bodies, axis=2),
            column("force_error"),
            column("peak_error"),
        )

    def take(self, rows: np.ndarray) -> Truth:
        """Return the designs `rows`."""
        forces = {name: values[rows] for name, values in self.forces.items()}
        arrays = (self.peak_stress[rows], self.force_error[rows], self.peak_error[rows])
        return Truth([self.cases[i] for i in rows], self.sample[rows], forces, *arrays)

    def few(self, number: int) -> Truth:
        """Return the first `number` designs of each sample."""
        return self.take(np.concatenate([np.flatnonzero(self.sample == name)[:number] for name in SAMPLES]))

    def errors(self, ds: xr.Dataset) -> dict[str, np.ndarray]:
        """Return errors of results by contact (and body), over themselves, or over mu F_N for friction forces.

        Designs that do not roll with both contacts are NaN.
        """
        capacity = np.array([case.friction_coefficient for case in self.cases])[:, None] * self.forces["normal_force"]
        apart = {name: np.abs(ds[name].values - self.forces[name]) for name in FORCES}
        found = {
            "normal_force": apart["normal_force"] / self.forces["normal_force"],
            "friction_force": np.maximum(apart["lateral_force"], apart["driving_force"]) / capacity,
        }
        if "peak_stress" in ds:
            found["peak_stress"] = np.abs(ds.peak_stress.values / self.peak_stress - 1.0)
        rolls = (ds.regime.values == 0) & np.isfinite(self.peak_stress).all(axis=(1, 2))
        return {name: np.where(rolls.reshape(-1, *(1,) * (v.ndim - 1)), v, np.nan) for name, v in found.items()}

    def exceeded(self, ds: xr.Dataset) -> dict[str, np.ndarray]:
        """Return whether an error exceeds the told one by more than the error of the truth, (n,) of 0, 1 and NaN."""
        told = {
            "normal_force": ("normal_force_error_estimate", self.force_error),
            "friction_force": ("force_error_estimate", self.force_error),
            "peak_stress": ("error_estimate", self.peak_error),
        }
        out = {}
        for name, error in self.errors(ds).items():
            estimate, own = told[name]
            excess = error - ds[estimate].values - own.reshape(-1, *(1,) * (error.ndim - 1))
            over = (excess > 0.0).reshape(len(excess), -1).any(axis=1)
            out[name] = np.where(np.isfinite(error.reshape(len(error), -1)).all(axis=1), over, np.nan)
        return out
