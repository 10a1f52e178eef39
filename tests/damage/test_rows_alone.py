"""A row of a block has the bits that it has alone, whichever limits its neighbours give inputs for."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
import xarray as xr

import trackroller as tr
from trackroller.damage import LIMITS, checked_limits
from trackroller.parameters import OPTIONS
from validation.benchmarks.samples import random_designs

OUTPUTS = ("forces", "peak_stress", "life", "limits")
BEARING = {
    **{"rows": 2, "row_distance": 8.0, "kind": "ball", "dynamic_rating": 4000.0, "static_rating": 2000.0},
    **{"e": 0.27, "X": 0.56, "Y": 1.6, "X0": 0.6, "Y0": 0.5},
}
CATALOGUE = {"radial_force": 800.0, "axial_force": 300.0, "basic_life": 100.0, "law": "dry"}
STUD = {"length": 20.0, "diameter": 12.0, "yield_strength": 600.0}
WEAR_TABLE = {"work_rate": [0, 10.4, 77.2], "roller": [0, 55, 55], "guide": [0, 55, 55]}
SOFT = {"like": "PA6", "yield_strength": None}
HOT = {
    "like": "PA6",
    "youngs_modulus": 2800,
    "temperature_dependence": {"temperature": [20, 80], "youngs_modulus": [2800, 900]},
}
# what a row gives or leaves out, so that each limit has rows with all, with some and with none of its inputs
INPUTS: dict[str, tuple[Any, ...]] = {
    "guide_overrollings_per_hour": (None, 100.0),
    "permissible_wear_depth": (None, 0.05),
    "required_travel": (None, 50.0),
    "bearing": (None, BEARING),
    "catalogue": (None, CATALOGUE),
    "permissible_radial_force": (None, 900.0),
    "heat_transfer_coefficient": (None, 20.0),
    "cooled_area": (None, 5000.0),
    "stud": (None, STUD),
    "placeholder_position": (None, None, 0.0, -1.0),
    "wear_coefficient_factor": (None, None, 2.0),
    "wear_table": (None, WEAR_TABLE),
}


def mixed_rows(n: int, seed: int) -> list[tr.Case]:
    """Return random rollers of which each gives the inputs of other limits; some share their mechanics."""
    rng = np.random.default_rng(seed)
    rows: list[tr.Case] = []
    for case in random_designs(n, seed):
        own = case
        if rows and rng.random() < 0.3:
            own = rows[-1]
        elif rng.random() < 0.2:
            own = dataclasses.replace(case, friction_coefficient=0.0)
        given = {name: values[rng.integers(len(values))] for name, values in INPUTS.items()}
        if rng.random() < 0.2:
            given["roller_material"] = [SOFT, HOT][rng.integers(2)]
        rows.append(dataclasses.replace(own, **given))
    return rows


def assert_row(block: xr.Dataset, row: int, alone: xr.Dataset) -> None:
    """Require the bits of the only row of `alone`; what `alone` does not hold is unknown in the block."""
    for name, values in block.data_vars.items():
        own = values.isel(case=row).values
        if name in alone:
            np.testing.assert_array_equal(own, alone[name].isel(case=0).values, err_msg=f"{name} of row {row}")
        elif name != "reason":
            assert np.isnan(own).all(), f"{name} of row {row}"
    assert set(alone.data_vars) <= set(block.data_vars)


@pytest.mark.parametrize(
    ("model", "given"),
    [
        ("sliding", {}),
        ("sliding", {"at_most": tuple(OPTIONS["at_most"].values)}),
        ("sliding", {"wear_law": "energy", "failure_probability": 0.1}),
        ("kalker_table", {"accuracy": "preview"}),
    ],
)
@pytest.mark.parametrize("seed", range(2))
def test_a_row_of_mixed_limits_is_the_same_alone(model, given, seed):
    rows = mixed_rows(9, 60 + seed)
    settings = {"outputs": OUTPUTS, "contact_model": model} | given
    block = tr.solve(rows, **settings)
    turned = tr.solve(rows[::-1], **settings).isel(case=slice(None, None, -1))
    for i, row in enumerate(rows):
        assert_row(block, i, tr.solve([row], **settings))
        assert_row(block, i, turned.isel(case=[i]))


def test_to_leave_out_every_limit_is_refused():
    every = [own.name for own in checked_limits()]
    with pytest.raises(tr.InputError, match=r"leaves out every limit.*Name fewer limits, or remove limits"):
        tr.solve([tr.Case()], OUTPUTS, not_checked=every)
    fewer = tr.solve([tr.Case()], OUTPUTS, not_checked=every[1:], contact_model="sliding")
    assert np.isfinite(fewer.utilisation.sel(limit=every[0])).all()
    without = tr.solve([tr.Case()], OUTPUTS[:-1], not_checked=every, contact_model="sliding")
    assert "utilisation" not in without


def test_the_rows_serve_and_lack_every_limit():
    """The sample is one that can fail: of each limit, some rows have a number and others have none."""
    ds = tr.solve(mixed_rows(40, 60), OUTPUTS, contact_model="sliding")
    known = (np.isfinite(ds.utilisation) | np.isfinite(ds.life_hours_by_limit)).any("body")
    always = {limit.name for limit in checked_limits() if not limit.requires}
    for name in {own.name for own in LIMITS.values() if own.use is not None} - always:
        own = known.sel(limit=name).values
        assert own.any() and not own.all(), name
