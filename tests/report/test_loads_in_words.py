"""Loads by their weight: a sign is a direction, so that "up" and "from" may mean less load."""

import itertools

import numpy as np
import pytest
import xarray as xr
import yaml
from synthetic_results import results_of
from told import effect_of, occurrence

from trackroller.report.words.levels import at_least, at_most


@pytest.mark.parametrize(
    ("name", "low", "high", "unit"),
    [
        ("radial_force", -300.0, -10.0, "N"),
        ("axial_force", 0.0, 60.0, "N"),
        ("axial_force", -60.0, 0.0, "N"),
        ("motor_force", -30.0, -1.0, "N"),
        ("motor_force", 2.0, 20.0, "N"),
    ],
)
def test_the_heavier_part_of_a_range_has_the_larger_forces(name, low, high, unit):
    """Against the sizes of the forces on both sides of a bound in the middle."""
    bound = (low + high) / 2
    below, above = np.linspace(low, bound, 9), np.linspace(bound, high, 9)
    heavier = np.abs(below).mean() > np.abs(above).mean()
    words = ("heavier", "lighter") if heavier else ("lighter", "heavier")
    for told, word in zip((at_most(name, bound, low), at_least(name, bound, high)), words, strict=True):
        assert told.endswith(f"of {bound:g} {unit} or {word}".replace("-", "−"))


def test_a_range_of_both_directions_is_neither_heavier_nor_lighter():
    """A motor force from -20 to 5 N drives and brakes: the sentence gives both ends."""
    assert at_most("motor_force", 5.0, -20.0) == "motor force −20 to 5 N"
    assert at_least("motor_force", -5.0, 20.0) == "motor force −5 to 20 N"
    assert at_most("motor_force", -5.0, -20.0) == "motor force of −5 N or heavier"
    assert at_most("contact_angle", 30.0, 20.0) == "contact angle up to 30°"
    assert at_least("contact_angle", 30.0, 40.0) == "contact angle from 30° up"


def sample(name, values, **results):
    ds = xr.Dataset({k: ("case", v) for k, v in results.items()}, {name: ("case", values)})
    ds.attrs["study"] = yaml.safe_dump({"design": "lhs", "factors": {name: {"uniform": [-1.0, 1.0]}}})
    return results_of(ds.assign_coords(case=np.arange(len(values))))


@pytest.mark.parametrize("name", ["radial_force", "axial_force", "motor_force"])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_sentences_on_a_load_name_its_weight(name, sign):
    """Life falls with the size of a force, whatever its sign: below 0 a rising number lengthens it."""
    if name == "radial_force" and sign > 0:
        return
    size = np.random.default_rng(4).uniform(1, 90, 300)
    results = sample(name, sign * size, roller_life_hours=1e6 / size**3)
    said = effect_of(results, "roller_life_hours", name, results.valid)
    assert ("lengthens" in said.text) == (sign < 0) == (said.values["effect"].ratio > 1)
    assert "−" in said.text if sign < 0 else "−" not in said.text
    lifted = occurrence(results, size > 60, "Lift-off").text
    assert f"{name.replace('_', ' ')} of {'−' if sign < 0 else ''}60" in lifted and "or heavier" in lifted


def test_a_design_that_lasts_longer_where_it_rolls_and_slips_elsewhere_is_not_built():
    """It is neither built nor the next best."""
    from trackroller.report.words.verdict import verdict_sentences

    friction, radius, axial = np.array(list(itertools.product([0.1, 0.3], [-8.0, -6.5], [0.0, 30.0]))).T
    columns = {"friction_coefficient": friction, "roller_profile_radius": radius, "axial_force": axial}
    ds = xr.Dataset(
        {
            "roller_life_hours": ("case", np.where(radius == -8, 100.0, 999.0)),
            "regime": ("case", np.where((radius == -6.5) & (axial == 30), 1, 0).astype("i1")),
        },
        {k: ("case", v) for k, v in columns.items()} | {"case": np.arange(8)},
    )
    ds.attrs["study"] = yaml.safe_dump({"design": "table", "factors": {k: {} for k in columns}})
    results = results_of(ds)
    (best,) = results.verdict.best
    assert results.verdict.kind == "build" and best.choices == {"roller_profile_radius": -8.0} and best.low == 100
    assert "next" not in {s.kind for s in verdict_sentences(results)}
