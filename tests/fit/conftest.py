"""A fitted material in the user's file, for tests of what its posterior carries into lives."""

from __future__ import annotations

import pytest

import trackroller as tr

RIG = {"motor_force": 0, "friction_coefficient": 0.1, "axial_force": 20}
LOADS = (-200, -200, -180, -160, -160, -130)
KM = (12.0, 15.0, 30.0, 38.0, 50.0, 90.0)


@pytest.fixture
def rig(tmp_path, monkeypatch):
    """Return a fit of rollers whose material `rig steel` stands in the user's file."""
    file = tmp_path / "materials.yaml"
    columns = {"radial_force": LOADS, "travel_from": KM, "travel_to": KM, "end": ["fatigue roller"] * len(KM)}
    fit = tr.fit_bench(columns, base=RIG | {"contact_model": "sliding"}, name="rig steel")
    fit.write(file)
    monkeypatch.setenv("TRACKROLLER_MATERIALS", str(file))
    return fit
