"""Findings: their rows, levels and models, and what the rows cannot carry and is not found."""

import numpy as np
import pytest
import xarray as xr
import yaml
from synthetic_results import grid_study, results_of

from trackroller.results.findings import confounded_with, effect_of, occurrence, slip_law, strongest_effects
from trackroller.study.file.load import parse_study

LIFE = "roller_life_hours"
CALM = {
    "friction_coefficient": [0.2, 0.3, 0.4],
    "roller_profile_radius": [-9.0, -8.0, -7.0],
    "axial_force": [0.0, 20.0],
}


def sample(life, regime=None, **asked):
    """Return a study of 300 random rows with a made-up life."""
    factors = {name: {"uniform": [0.0, 1.0]} for name in ("velocity", "axial_force")}
    factors["velocity"] = {"uniform": [10.0, 60.0]}
    study = parse_study(
        {"name": "s", "design": "lhs", "samples": 300, "factors": factors, "outputs": ["life"], **asked}
    )
    ds = study.design()
    ds[LIFE] = ("case", life(ds["velocity"].values, ds["axial_force"].values), {"units": "h"})
    ds["regime"] = ("case", np.zeros(300, "i1") if regime is None else regime(ds).values.astype("i1"))
    ds.attrs["study"] = study.merged()
    return results_of(ds)


def table(velocity, force, life):
    """Return a study of a table with two columns."""
    columns = {"velocity": velocity, "axial_force": force}
    ds = xr.Dataset(
        {LIFE: ("case", life)}, {name: ("case", own) for name, own in columns.items()} | {"case": np.arange(len(life))}
    )
    factors = {name: {"values": sorted({float(v) for v in own})} for name, own in columns.items()}
    ds.attrs["study"] = yaml.safe_dump({"name": "t", "factors": factors})
    return results_of(ds)


def test_a_finding_names_its_rows_their_levels_and_the_contact_model():
    results = results_of(grid_study(CALM))
    found = effect_of(results, LIFE, "friction_coefficient")
    assert found.among == "valid" and np.array_equal(found.rows, results.valid) and found.models == ("kalker",)
    for name, levels in CALM.items():
        assert found.spans[name] == tuple(sorted(set(results.table[name][results.valid])))
        assert set(found.spans[name]) <= set(levels)


def test_factors_that_confounded_with_have_no_effect_of_their_own():
    rng = np.random.default_rng(1)
    force = rng.permutation(np.arange(100.0))
    for speed, together in ((2 * force, True), (force + rng.normal(0, 20, 100), True), (rng.permutation(force), False)):
        results = table(speed, force, np.exp(force / 20))
        assert bool(confounded_with(results, "axial_force", np.ones(100, bool))) == together
        assert (effect_of(results, LIFE, "axial_force") is None) == together


def test_constraints_that_cut_unevenly_carry_no_fitted_effect():
    """Slow cases with a short life are cut away: what is left is no comparison of all speeds."""
    life = lambda v, x: 500.0 * (v / 35) ** 4 * (1 + x)  # noqa: E731
    free, cut = sample(life), sample(life, constraints=[f"{LIFE} > 700"])
    assert cut.allowed.sum() < 300 and effect_of(free, LIFE, "velocity") is not None
    assert effect_of(cut, LIFE, "velocity") is None and effect_of(cut, LIFE, "axial_force") is not None


def test_a_sample_says_only_at_if_one_factor_decides_all_cases():
    law = sample(lambda v, x: v, lambda ds: 2 * (ds["axial_force"] > 0.7))
    found = occurrence(law, law.regime == 2, "lift_off")
    assert found.kind == "only" and found.values["inside"] == found.values["count"] == (law.regime == 2).sum()
    chance = sample(lambda v, x: v, lambda ds: 2 * ((ds["axial_force"] > 0.7) & (ds["velocity"] > 20)))
    assert occurrence(chance, chance.regime == 2, "lift_off").kind in ("share", "frequent")


def test_two_factors_that_confine_an_event_are_told_by_their_combinations():
    """All 130 N at 25 degrees, half of 60 N at 25 degrees and a part of 130 N at 35 degrees, as an engineer counts."""
    levels = {"axial_force": [10.0, 60.0, 130.0], "contact_angle": [25.0, 35.0, 50.0]}
    ds = grid_study(levels | {"friction_coefficient": [0.1, 0.2, 0.3, 0.4], "velocity": [10.0, 20.0]})
    lifts = (ds["axial_force"] == 130) & (ds["contact_angle"] == 25)
    lifts = lifts | (ds["axial_force"] == 60) & (ds["contact_angle"] == 25) & (ds["friction_coefficient"] > 0.25)
    lifts = lifts | (ds["axial_force"] == 130) & (ds["contact_angle"] == 35) & (ds["friction_coefficient"] > 0.35)
    ds["regime"] = xr.where(lifts, 2, 0).broadcast_like(ds["regime"]).transpose(*ds["regime"].dims)
    results = results_of(ds)
    found = occurrence(results, results.regime == 2, "lift_off")
    assert found.kind == "crossed" and found.values["count"] == 14
    told = [({n: v[0] for n, v in one.levels.items()}, one.count, one.of) for one in found.values["products"]]
    wanted = [(130.0, 25.0, 8, 8), (60.0, 25.0, 4, 8), (130.0, 35.0, 2, 8)]
    assert told == [({"axial_force": a, "contact_angle": c}, n, of) for a, c, n, of in wanted]


def test_levels_of_several_factors_are_not_told_together_where_a_combination_has_no_event():
    """Two of three forces with two of three angles, in a ring of combinations that no three products cover."""
    ds = grid_study(
        {"axial_force": [10.0, 60.0, 130.0, 190.0], "contact_angle": [25.0, 35.0, 45.0, 50.0]}
        | {"friction_coefficient": [0.1, 0.2, 0.3, 0.4], "velocity": [10.0, 20.0]}
    )
    place = {name: xr.DataArray(np.arange(4), dims=name) for name in ("axial_force", "contact_angle")}
    some = (place["axial_force"] == place["contact_angle"]) & (place["axial_force"] > 0)
    some = (some | (place["axial_force"] == 1) & (place["contact_angle"] == 2)) & (ds["friction_coefficient"] > 0.15)
    ds["regime"] = xr.where(some, 2, 0).broadcast_like(ds["regime"]).transpose(*ds["regime"].dims)
    results = results_of(ds)
    found = occurrence(results, results.regime == 2, "lift_off")
    assert found.kind != "only" or len(found.values["conditions"]) == 1


def test_the_one_row_of_a_table_that_lifts_off_is_told_by_its_label_and_its_design():
    block = np.tile(["start", "curve", "stop"], 4)[:-1]  # the last row of the grid is not there
    angle = np.repeat([30.0, 42.0, 45.0, 50.0], 3)[:-1]
    columns = {"block": ("case", block), "contact_angle": ("case", angle)}
    hit = (block == "stop") & (angle == 30)
    ds = xr.Dataset({LIFE: ("case", np.ones(11)), "regime": ("case", 2 * hit)}, columns | {"case": np.arange(11)})
    factors = {"block": {"values": ["start", "curve", "stop"]}, "contact_angle": {"values": [30, 42, 45, 50]}}
    ds.attrs["study"] = yaml.safe_dump({"name": "t", "factors": factors, "design": "table", "table": "t.csv"})
    (one,) = occurrence(results_of(ds), hit, "lift_off").values["products"]
    assert (dict(one.levels), one.count, one.of) == ({"block": ("stop",), "contact_angle": (30.0,)}, 1, 1)


def test_choices_stand_before_conditions_and_the_speed_last():
    """Lives that change 2-fold with a groove, 10-fold with friction and 60-fold with the speed."""
    ds = grid_study(
        {"velocity": [1.0, 60.0], "friction_coefficient": [0.1, 0.3], "roller_profile_radius": [-8.0, -7.0]}
    )
    life = (
        1e4
        / ds["velocity"]
        * (0.1 + 0.9 * (ds["friction_coefficient"] < 0.2))
        * (1 + (ds["roller_profile_radius"] > -7.5))
    )
    ds[LIFE] = life.transpose(*ds[LIFE].dims).assign_attrs(ds[LIFE].attrs)
    ds["regime"][:], ds["validity"][:] = 0, 0
    found = strongest_effects(results_of(ds), LIFE)
    assert [one.values["effect"].factor for one in found] == [
        "roller_profile_radius",
        "friction_coefficient",
        "velocity",
    ]


@pytest.mark.parametrize("lifts", [False, True])
def test_full_slip_follows_the_law_of_the_drive_or_is_not_told_so(lifts):
    base = {"radial_force": -90.0, "contact_angle": 30.0, "motor_force": -20.0, "axial_force": 0.0}
    ds = grid_study({"friction_coefficient": [0.1, 0.19, 0.2, 0.3], "velocity": [10.0, 20.0]})
    study = yaml.safe_load(ds.attrs["study"]) | {"base": base}
    ds.attrs["study"] = yaml.safe_dump(study)
    limit = 20 * np.cos(np.pi / 6) / 90  # friction at which the drive is just transmitted
    slips = (ds["friction_coefficient"] < limit).broadcast_like(ds["regime"])
    ds["regime"] = xr.where(slips, 1, 0).transpose(*ds["regime"].dims)
    if lifts:
        ds["regime"][{"friction_coefficient": 0, "velocity": 0}] = 2
    found = slip_law(results_of(ds))
    assert found.values["count"] == 4 - lifts and found.values["lifted"] == lifts
    ds["regime"][{"friction_coefficient": 3}] = 1  # more friction than the drive needs, and slip all the same
    assert slip_law(results_of(ds)) is None
