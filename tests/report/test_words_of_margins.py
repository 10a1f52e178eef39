"""The rows of limits: bounds that a case gives, lives that do not exist, ranges in years, values given in vain."""

import json

import numpy as np
import pytest
from limit_rows import headline, limit_row

import trackroller as tr
from trackroller.report.numbers import between, on_duty
from trackroller.results.roller_answer import answer_of_roller

FREE = {"motor_force": 0, "friction_coefficient": 0.1}


def answer_to(options=None, **values):
    case = tr.Case(**FREE | values)
    return answer_of_roller(tr.solve(case, contact_model="sliding", accuracy="preview", **options or {}))


def test_a_row_of_wear_names_the_permissible_depth_that_was_given():
    answer = answer_to(permissible_wear_depth=0.1, guide_overrollings_per_hour=60)
    for body in ("roller", "guide"):
        row = limit_row(answer, "wear", body)
        assert (row["permitted"], row["units"]) == (0.1, "mm") and np.isnan(row["value"])
        assert row["bound"] == "permissible wear depth of roller and guide"


def test_a_body_that_breaks_at_once_has_no_fatigue_life():
    answer = answer_to(radial_force=-900, roller_profile_radius=8.5)
    for body in ("roller", "guide"):
        static, fatigue = (limit_row(answer, name, body) for name in ("static", "fatigue"))
        assert static["state"] == "exceeded" and static["low"] == static["high"] == 0.0
        assert fatigue["state"] == "none" and np.isnan(fatigue["low"])


def test_a_range_of_years_whose_ends_read_alike_is_one_number():
    with on_duty({"hours_per_day": 16, "days_per_year": 250}):
        assert between(15_100, 15_300) == "15,100 to 15,300 h (3.8 years)"
        assert between(90, 6900) == "90 to 6900 h (up to 1.7 years)"


def test_a_value_that_was_given_for_limits_that_are_not_checked_is_named():
    assert answer_to(required_travel=40).not_used == {"required_travel": "needed by wear"}
    left_out = answer_to({"not_checked": ("wear",)}, permissible_wear_depth=0.1)
    assert left_out.not_used == {"permissible_wear_depth": "needed by wear"}
    assert "wear (left out)" in left_out.not_checked["roller"]
    assert not answer_to(permissible_wear_depth=0.1).not_used
    assert not answer_to(guide_overrollings_per_hour=60).not_used


def test_the_limit_that_the_headline_names_leads_the_table():
    """The standard rating is a second model of fatigue; it is reached earlier here, and ends nothing by itself."""
    steel = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
    case = tr.Case(**FREE | steel, roller_profile_radius=-6.4)
    answer = answer_of_roller(tr.solve(case, accuracy="preview"))
    rating = limit_row(answer, "rating", "roller")
    assert answer.table["name"].iloc[0] == "fatigue" and rating["low"] < answer.table["hours"].iloc[0]
    assert rating["model"] == "second" and "fatigue of the roller" in headline(answer)


def test_a_required_life_and_a_required_stress_are_judged():
    """The example lasts some hours; the requirement of a stress has a row with its use."""
    ds = tr.solve(tr.Case(**FREE), contact_model="sliding", accuracy="preview", not_checked=("pressure_line",))
    hours = float(ds["pair_life_to_first_limit_hours_low"])
    stress = float(ds["peak_stress"].sel(body="roller").max())
    for factor, state in ((0.9, "met"), (1.1, "missed")):
        required = {"pair_life_hours": {"min": factor * hours}, "peak_stress_roller": {"max": stress / factor}}
        answer = answer_of_roller(ds.assign_attrs(requirement=json.dumps(required)))
        assert answer.headline["state"] == state and headline(answer).endswith(f"{state}.")
        row = limit_row(answer, "peak_stress_roller", "roller")
        assert row["used_low"] == pytest.approx(factor, rel=1e-12) and row["state"] == (
            "kept" if factor < 1 else "exceeded"
        )


def test_full_slip_and_lift_off_are_told_as_causes_and_not_as_missing_inputs():
    for values, words in (({"motor_force": -300}, "the roller skids"), ({"axial_force": 300}, "a contact lifts off")):
        answer = answer_of_roller(tr.solve(tr.Case(**values), contact_model="sliding", accuracy="preview"))
        told = [text for body in ("roller", "guide") for text in answer.not_checked[body]]
        assert any(words in text for text in told)
        assert not any("guide_overrollings_per_hour" in text for text in told)
