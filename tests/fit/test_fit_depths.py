"""The wear coefficient from depths of one groove."""

from __future__ import annotations

import numpy as np
import pytest

import trackroller as tr
from trackroller.fit import depths
from trackroller.fit.bench import UNIT_WEAR

TABLE = {"travel": [100.0, 220.0, 400.0], "wear_depth": [0.01, 0.02, 0.03]}


def test_a_known_coefficient_is_recovered(monkeypatch):
    """The travels belong to the coefficient 2e-5, by a model whose depth grows with the root of the travel."""
    depth = np.array([0.01, 0.02, 0.04])
    monkeypatch.setattr(depths, "followed", lambda values, options, body, given: 1e7 * given**2)
    travel = 1e7 * depth**2 * UNIT_WEAR / 2e-5
    fit = depths.fit_wear({"travel": travel * [1.02, 0.99, 1.0], "wear_depth": depth})
    assert fit.estimate("wear_coefficient") == pytest.approx(2e-5, rel=0.02)
    low, high = fit.interval("wear_coefficient")
    assert low < 2e-5 < high < 1.3 * low


@pytest.mark.long
def test_the_depths_of_a_followed_groove_return_its_coefficient():
    """A roller that is followed with the coefficient 3e-5 gives depths, and these give the coefficient back."""
    base = {"motor_force": 0, "radial_force": -160, "axial_force": 20, "accuracy": "preview"}
    database = tr.load_database()
    worn = database.material("1.7225-normalised").as_dict() | {"wear_coefficient": 3e-5}
    ds = tr.wear(
        {k: v for k, v in base.items() if k != "accuracy"} | {"roller_material": worn, "permissible_wear_depth": 0.004},
        "1e6km", accuracy="preview", outputs=("forces",),
    )  # fmt: skip
    deep = ds.groove_depth.sel(body="roller").max("contact").values
    rows = np.flatnonzero(deep > 1e-4)
    fit = depths.fit_wear({"travel": ds.travel.values[rows], "wear_depth": deep[rows]}, base)
    assert fit.estimate("wear_coefficient") == pytest.approx(3e-5, rel=0.05)


@pytest.mark.long
def test_a_depth_that_no_profile_reaches_is_told_with_its_row():
    with pytest.raises(tr.InputError, match=r"row 3, wear_depth = 30.0.*it is mm"):
        depths.fit_wear(TABLE | {"wear_depth": [0.01, 0.02, 30.0]}, {"motor_force": 0, "accuracy": "preview"})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"wear_depth": [0.01, 0.005, 0.03]}, r"row 2, wear_depth = 0.005.*at least that after less travel, 0.01"),
        ({"travel": [100.0, 100.0, 400.0]}, r"row 2, travel = 100.0 stands in another row"),
        ({"travel": [-1.0, 100.0, 400.0]}, r"row 1, travel = -1.0.*above 0"),
    ],
)
def test_bad_depths_are_told_with_their_row(change, message):
    with pytest.raises(tr.InputError, match=message):
        depths.fit_wear(TABLE | change)
