"""Placeholders of materials at any place in their ranges."""

import numpy as np
import pytest

import trackroller as tr
from trackroller.damage import groups_of
from trackroller.errors import InputError
from trackroller.materials import builtin_database
from trackroller.materials.properties import OF_LIMITS

DB = builtin_database()
GIVEN = {"heat_transfer_coefficient": 20, "cooled_area": 5000, "permissible_wear_depth": 0.1, "required_travel": 1e3}
GIVEN |= {"radial_force": -60, "axial_force": 5, "motor_force": 0, "guide_overrollings_per_hour": 60}


@pytest.mark.parametrize("name", DB.names())
def test_the_ends_of_the_ranges_and_the_values_are_reached(name):
    material = DB.material(name)
    worse, same, better, between = (material.moved(p) for p in (-1.0, 0.0, 1.0, -0.25))
    assert same == material
    moved = 0
    for key, record in material.records.items():
        values = [getattr(own, key) for own in (worse, same, better, between)]
        if record.range is None or not record.placeholder or key not in OF_LIMITS:
            assert len(set(values)) == 1
            continue
        moved += 1
        ends = record.range if key != "loss_fraction" else record.range[::-1]
        assert (values[0], values[2]) == tuple(ends) and values[1] == record.value
        assert values[3] == pytest.approx(record.value + 0.25 * (ends[0] - record.value))
    assert moved >= 3 and worse.youngs_modulus == material.youngs_modulus


@pytest.mark.parametrize("roller", DB.names())
def test_every_limit_is_worse_at_the_worse_end_and_better_at_the_better_one(roller):
    cases = [
        tr.Case(**GIVEN, roller_material=roller, guide_material="1.7225-normalised", placeholder_position=p)
        for p in np.linspace(-1, 1, 5)
    ]
    ds = tr.solve(cases, groups_of("limits", ["all"]), contact_model="sliding")
    used, hours = ds.utilisation.values, ds.life_hours_by_limit.values
    assert (np.diff(used, axis=0)[~np.isnan(used[1:])] <= 1e-12).all()
    with np.errstate(invalid="ignore"):
        assert not (hours[1:] < hours[:-1] * (1 - 1e-12)).any()
    moved = used[0] > used[-1] * (1 + 1e-9)
    records = DB.material(roller).records
    for limit, value in (("shakedown", "yield_strength"), ("heat", "loss_fraction"), ("wear", "")):
        rests = value not in records or records[value].placeholder  # a published yield strength does not move
        known = limit != "shakedown" or value in records
        assert moved[ds.limit.values.tolist().index(limit), 0] == (rests and known), limit
    assert ds.utilisation.sel(limit="static").values.std(axis=0) == pytest.approx(0.0)


def test_a_measured_value_stays():
    mine = {"like": "POM", "yield_strength": 65.0}
    cases = [tr.Case(**GIVEN, roller_material=mine, placeholder_position=p) for p in (-1, 1)]
    used = tr.solve(cases, "shakedown", contact_model="sliding").shakedown_utilisation.sel(body="roller").values
    assert used[0] == pytest.approx(used[1], rel=1e-12)
    with pytest.raises(InputError, match="placeholder_position"):
        tr.Case(placeholder_position=1.5)
