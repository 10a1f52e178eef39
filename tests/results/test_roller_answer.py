"""The record of one roller: requirements one by one, what is not known, and the line that repeats it."""

import json
import shlex

import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.cli.case import solve_case
from trackroller.report.headlines import headline_of
from trackroller.report.pages.record import command_of
from trackroller.report.pages.sheet import print_facts
from trackroller.results.roller_answer import answer_of_roller
from trackroller.roller.settings import checked_case

BASE = {"guide_curve_radius": "inf", "motor_force": 0, "friction_coefficient": 0.15, "guide_overrollings_per_hour": 60}
BASE |= {"contact_model": "sliding", "accuracy": "preview"}


def solved(**values):
    """Return the result of a case file with these values."""
    case, options, beside = checked_case(BASE | values)
    return solve_case(case, options, beside)


def headline(ds):
    return headline_of(answer_of_roller(ds)).text


def test_each_requirement_has_a_state_of_its_own():
    ds = solved()
    low, high = (float(ds[f"pair_life_to_first_limit_hours_{end}"]) for end in ("low", "high"))
    stress = float(ds.peak_stress.sel(body="roller").max())
    for life, most, states in (
        (0.9 * low, 1.1 * stress, ["met", "met"]),
        (0.9 * low, 0.9 * stress, ["met", "missed"]),
        (1.1 * low, 1.1 * stress, ["open", "met"]),
        (1.1 * high, 1.1 * stress, ["missed", "met"]),
    ):
        wanted = {"pair_life_to_first_limit_hours": {"min": life}, "peak_stress_roller": {"max": most}}
        own = solved(requirement=wanted)
        head = answer_of_roller(own).headline
        assert head["states"] == states
        assert head["state"] == next(state for state in ("missed", "open", "met") if state in states)
        ends = {words.rpartition(": ")[2].rstrip(".") for words in headline(own).split("; ") if "required" in words}
        assert ends == set(states)


def test_a_largest_life_counts_as_well():
    ds = solved()
    low, high = (float(ds[f"pair_life_to_first_limit_hours_{end}"]) for end in ("low", "high"))
    for most, state in ((1.1 * high, "met"), (1.1 * low, "open"), (0.9 * low, "missed")):
        ds = solved(requirement={"pair_life_to_first_limit_hours": {"min": 1, "max": most}})
        assert answer_of_roller(ds).headline["state"] == state


def test_a_life_without_its_scatter_is_a_range_by_the_typical_one():
    """At 10 % failed the fatigue of a material without scatter lies between the ends of the typical scatter."""
    steel = {"like": "1.7225-quenched-tempered", "name": "with scatter", "scatter_in_cycles": 5.0}
    wanted = {"pair_life_to_first_limit_hours": {"min": 1}}
    case = {"roller_material": "1.7225-quenched-tempered", "guide_material": steel, "permissible_wear_depth": 0.5}
    ds = solved(**case, failure_probability=0.1, requirement=wanted)
    low, high = (ds[f"life_hours_by_limit_{end}"].sel(limit="fatigue") for end in ("low", "high"))
    assert low.sel(body="guide") == high.sel(body="guide")
    assert high.sel(body="roller") / low.sel(body="roller") == pytest.approx((16.1 / 5.2) ** 0.5)
    answer = answer_of_roller(ds)
    (guesses,) = (part.table for part in answer.parts if part.name == "placeholders")
    (row,) = guesses[guesses["value"] == "scatter_in_cycles"].to_dict("records")
    assert (row["material"], row["limit"], row["low"], row["high"]) == (
        "1.7225-quenched-tempered",
        "fatigue",
        5.2,
        16.1,
    )
    assert answer.headline["low"] > 1 and answer.headline["state"] == "met"


def test_a_travel_that_wear_does_not_allow_is_a_requirement_that_is_missed():
    """The use of wear is the required travel over its life, which ends the roller, and not a check beside its life."""
    hours = float(solved(permissible_wear_depth=0.01).life_hours_by_limit_high.sel(limit="wear").min())
    travel = 2 * hours * 60 * 0.06
    ds = solved(permissible_wear_depth=0.01, required_travel=travel)
    assert float(ds.utilisation.sel(limit="wear", body="roller")) > 1
    head = answer_of_roller(ds).headline
    assert head["state"] == "missed" and head["high"] < 2 * hours
    assert "wear" not in {one["limit"] for one in head["exceeded"]} and "therwise" not in headline(ds)


def test_a_roller_that_skids_has_no_hours_of_limits_without_a_life_and_nothing_to_extrapolate():
    ds = solved(motor_force=-300, radial_force=-60, axial_force=5)
    assert int(ds.regime) == 1
    answer = answer_of_roller(ds)
    hours = [one for one in answer.not_checked["roller"] if one.startswith("hours of")]
    words = ("fatigue", "pressure line", "rating")
    assert hours == [f"hours of {word} (the roller skids)" for word in words]
    assert "extrapolated" not in {caution.code for caution in answer.warnings}


def test_a_second_model_without_a_first_life_is_told_with_one_number_for_equal_ends():
    steel = {"like": "1.7225-normalised", "hardness": 220.0, "yield_strength": 480.0}
    ds = solved(roller_material=steel, guide_material=steel, not_checked=["fatigue"])
    answer = answer_of_roller(ds)
    told = [caution.where for caution in answer.warnings if caution.code == "second_model"]
    hours = float(ds.life_hours_by_limit.sel(limit="rating", body="roller"))
    assert answer.kind == "no_life" and len(told) == 4
    told = [text for text in told if text.startswith("rating")]
    number = next(text.rpartition(", ")[2].removesuffix(" h") for text in told if "of the roller" in text)
    assert float(number.replace(",", "")) == pytest.approx(hours, rel=5e-3)


def test_a_friction_that_locks_nothing_is_kept():
    ds = solved()
    rows = answer_of_roller(ds).table.set_index("name")
    for name in ("self_locking", "lift_off_friction"):
        if "none up to" in rows["bound"][name]:
            assert rows["state"][name] == "kept"


def test_the_command_repeats_the_record(tmp_path):
    """Given values that equal a default, requirements and options included."""
    steel = {"like": "1.7225-normalised", "scatter_in_cycles": 4.0}
    wanted = {"pair_life_hours": {"min": "2 years"}, "max_pressure": {"max": 900}}
    case = {"roller_material": steel, "guide_material": steel, "axial_force": 30, "requirement": wanted}
    case |= {"failure_probability": 0.1, "life_rule": "haibach", "not_checked": ["rating", "shakedown"]}
    ds = solved(**case, duty={"hours_per_day": 8, "days_per_year": 200})
    words = shlex.split(command_of(ds))
    again = json.loads(trackroller(*words[1:], "--json", cwd=tmp_path).stdout)["answer"]
    own = json.loads(json.dumps(answer_of_roller(ds).to_dict()))
    assert again == own and own["headline"]["states"]
    assert "axial_force" not in own["not_given"]


def test_friction_of_the_database_is_no_value_of_the_example(capsys):
    case = {key: value for key, value in BASE.items() if key != "friction_coefficient"}
    given, options, beside = checked_case(case | {"friction_coefficient": None})
    print_facts(solve_case(given, options, beside))
    printed = capsys.readouterr().out
    (row,) = (line for line in printed.splitlines() if "friction coefficient mu" in line)
    assert row.split("│")[-2].strip() == "database"


def test_a_life_without_scatter_stands_among_the_limits_as_a_range():
    """The guide has a scatter and the roller has none: its life at 5 % is a range by the typical scatter."""
    steel = {"like": "1.7225-quenched-tempered", "scatter_in_cycles": 5}
    case = tr.Case(
        motor_force=0,
        guide_curve_radius=float("inf"),
        guide_overrollings_per_hour=60,
        roller_material="1.7225-quenched-tempered",
        guide_material=steel,
        friction_coefficient=0.2,
    )
    groups = ("forces", "contact", "peak_stress", "life", "limits")
    options = {"contact_model": "sliding", "accuracy": "preview", "not_checked": ("pressure_line",)}
    answer = answer_of_roller(tr.solve(case, groups, failure_probability=0.05, **options))
    fatigue = answer.table[answer.table["limit"] == "fatigue"].set_index("body")
    assert 0 < fatigue.loc["roller", "low"] < fatigue.loc["roller", "high"]
    assert 0 < fatigue.loc["guide", "low"] == fatigue.loc["guide", "high"]
