"""Counts, ends and intervals that pages state, against raw rows by other code."""

import numpy as np
import pytest

import trackroller as tr
from trackroller.report.figures.maps import life_map
from trackroller.report.numbers import percent
from trackroller.results.roller_answer import answer_of_roller

FIRST = "pair_life_to_first_limit_hours"
FAST = {"contact_model": "sliding", "accuracy": "preview"}
BASE = {"guide_curve_radius": "inf", "guide_overrollings_per_hour": 200, "motor_force": 0, "axial_force": 8}


def run(**keys):
    return tr.run({"name": "counted"} | FAST | keys, progress=False)


@pytest.mark.parametrize("drive", [-6.0, 6.0])
def test_a_drive_at_the_limit_of_friction_skids_in_both_directions(drive):
    """The drive needs 12 N * cos 60 deg, and friction transmits 0.05 * 120 N, which is the same: the roller skids."""
    case = {"contact_angle": 60, "radial_force": -120, "friction_coefficient": 0.05, "motor_force": 2 * drive}
    case |= BASE | {"motor_force": 2 * drive}
    assert int(tr.solve(case, **FAST)["regime"]) == 1
    assert int(tr.solve(case | {"motor_force": 1.999 * drive}, **FAST)["regime"]) == 0


@pytest.mark.parametrize(
    ("value", "low", "high", "text"),
    [(1, 0.982, 1, "100 % (98 to 100 %)"), (0, 0, 0.028, "0 % (0 to 3 %)"), (0.5, 0.4, 0.6, "50 ± 10 %")],
)
def test_an_interval_on_one_side_is_written_with_both_ends(value, low, high, text):
    assert percent(value, low, high) == text


@pytest.fixture(scope="module")
def search():
    """A search for the smallest roller whose life, a range by the wear coefficients, is long enough for certain."""
    base = {"guide_curve_radius": "inf", "guide_overrollings_per_hour": 200, "motor_force": 0, "axial_force": 3}
    base |= {"guide_material": "C45", "permissible_wear_depth": 0.1, "roller_material": "PA66-moist"}
    factors = {"axis_distance": {"uniform": [12, 24]}, "roller_profile_radius": {"uniform": [-7, -6.3]}}
    factors |= {"radial_force": {"values": [-30, -15]}, "friction_coefficient": {"values": [0.15, 0.3]}}
    keys = {"method": "optimise", "goals": {"axis_distance": "min"}, "budget": {"designs": 48}}
    return run(base=base, factors=factors, constraints=["pair_life_hours > 200"], **keys)


@pytest.mark.slow
def test_a_constraint_on_a_life_in_a_range_counts_its_low_end(search):
    low = search.quantity(f"{FIRST}_low")[0]
    assert np.array_equal(search.valid & (low > 200), search.valid) and (low <= 200).any()
    assert (search.column(FIRST)[~search.valid & search.inside] > 200).any()  # longer at the values of the placeholders


@pytest.mark.slow
def test_a_design_that_was_solved_twice_counts_once(search):
    front = search.pareto()
    names = search.design.meta["outer"]
    rows = np.stack([front[name].values for name in names], axis=1)
    assert len(np.unique(rows, axis=0)) == len(rows)


def test_what_would_end_the_other_body_stands_in_its_row():
    """Wear ends the roller first, and fatigue the guide before the roller."""
    case = {"axis_distance": 34, "guide_profile_radius": 9, "roller_profile_radius": -9.6, "contact_angle": 42}
    case |= {"guide_curve_radius": np.inf, "radial_force": -650, "axial_force": 90, "motor_force": -12, "velocity": 75}
    case |= {"roller_material": "42CrMo4+QT-40", "guide_material": "C45", "friction_coefficient": 0.16}
    solved = tr.solve(case | {"guide_overrollings_per_hour": 220, "permissible_wear_depth": 0.12}, **FAST)
    hours = solved["life_hours_by_limit"].sel(limit="fatigue")
    assert hours.sel(body="guide") < hours.sel(body="roller")
    rows = answer_of_roller(solved).table
    ending = rows[rows["low"].notna() & (rows["model"] == "")]
    pairs = list(zip(ending["name"], ending["body"], strict=True))
    assert pairs[0] == ("wear", "roller") and pairs.index(("fatigue", "guide")) < pairs.index(("fatigue", "roller"))


def test_a_map_of_lives_is_left_out_where_every_body_breaks(tmp_path):
    """Heavy loads: all lives are 0 h, and the report is written."""
    base = {"axis_distance": 42, "guide_profile_radius": 12, "contact_angle": 42, "guide_curve_radius": "inf"}
    base |= {"motor_force": 0, "guide_overrollings_per_hour": 90, "guide_material": "C45", "roller_material": "C45"}
    factors = {"radial_force": {"values": [-60000, -90000]}, "friction_coefficient": {"values": [0.15, 0.3]}}
    results = run(base=base | {"axial_force": 0, "roller_profile_radius": -13.5}, factors=factors)
    assert (results.column(FIRST)[results.rolling] == 0).all() and results.rolling.any()
    assert life_map(results) is None
    assert results.report(tmp_path / "report.html").is_file()


@pytest.mark.slow
def test_a_pareto_set_keeps_a_constraint_as_the_study_does(search):
    """Of a life in a range both compare the low end, which is shorter than the value in some rows."""
    low, value = (search.quantity(f"{FIRST}{end}")[0] for end in ("_low", ""))
    front = search.pareto({"axis_distance": "min", FIRST: "max"}, [f"{FIRST} > 200"])
    assert ((low <= 200) & (value > 200) & search.inside).any()
    assert np.array_equal(front["row"].values, np.flatnonzero((low > 200) & search.rolling & ~np.isnan(value)))
