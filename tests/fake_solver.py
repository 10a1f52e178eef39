"""A solver for tests of the machinery: quick, exact, and it can be told to count, to raise or to kill itself."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import numpy as np
import xarray as xr


def solve(design: xr.Dataset, database=None, **options) -> xr.Dataset:
    """Return forces that depend on every parameter; append one line a case to the file $FAKE_SOLVED."""
    load = design["axial_force"].values
    if (load == 13.0).any():
        raise ArithmeticError("thirteen cannot be solved")
    if told := os.environ.get("FAKE_SOLVED"):
        with open(told, "a", encoding="ascii") as stream:
            for axial, friction in zip(load, design["friction_coefficient"].values, strict=True):
                stream.write(f"{float(axial)!r} {float(friction)!r}\n")
    kill = os.environ.get("FAKE_KILL")
    if kill and len(Path(os.environ["FAKE_SOLVED"]).read_text().splitlines()) >= int(kill):
        os.kill(os.getpid(), signal.SIGKILL)
    force = np.sin(load)[:, None] + design["friction_coefficient"].values[:, None] * np.array([1.0, 2.0])
    return xr.Dataset(
        {
            "normal_force": (("case", "contact"), force, {"units": "N", "long_name": "normal force", "symbol": "F_N"}),
            "residual": ("case", np.where(load == 7.0, 1.0, 0.0), {"units": "1", "long_name": "residual"}),
            "regime": (
                "case",
                np.where(load == 7.0, 3, 0).astype("i1"),
                {
                    "flag_values": np.arange(4, dtype="i1"),
                    "flag_meanings": "rolling full_slip lift_off failed",
                    "units": "1",
                    "long_name": "regime",
                },
            ),
            "converged": ("case", (load != 7.0).astype("i1"), {"units": "1", "long_name": "converged"}),
        },
        {"contact": ("contact", np.array([1, 2]), {"long_name": "contact"})},
    )
