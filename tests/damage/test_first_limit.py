"""The checked limits: which one comes first, and when."""

import re

import numpy as np
import pytest
from limit_rows import headline, limit_row
from typer.testing import CliRunner

import trackroller as tr
from trackroller.cli.case import groups_of
from trackroller.cli.main import app
from trackroller.damage import LIMITS, checked_limits, limits_of, others
from trackroller.damage.first_limit import ENDS, STATES, limit_uses, states
from trackroller.damage.limit import Limit, LimitUse, SolvedRollers
from trackroller.damage.sn_curve import TYPICAL_SCATTER
from trackroller.errors import InputError
from trackroller.parameters import BODIES, FIRST_TO_FAIL, REGIMES
from trackroller.report.numbers import rounded
from trackroller.results.roller_answer import answer_of_roller

NAMES = list(LIMITS)
STEEL = "1.7225-quenched-tempered"
STRONG = {"like": STEEL, "tensile_strength": 3000.0, "fatigue_limit": 1000.0}


def limit(name, used, hours, **more):
    """A limit with a given utilisation and hours of roller and guide."""
    shaped = [None if v is None else np.array([v], dtype=float) for v in (used, hours)]
    return Limit(name, name, name, lambda solved: {}, lambda solved, results: LimitUse(*shaped), **more)


def judged(*limits):
    solved = SolvedRollers({}, {}, {}, np.ones(1))
    found = limit_uses([solved], limits, range(len(limits)), len(limits))
    return [found[name][0].tolist() for name in ("limiting_mechanism", "life_to_first_limit_hours")]


def test_the_shortest_life_comes_first():
    assert judged(limit("a", [0.5, 0.5], [100, 7]), limit("b", [0.9, 0.1], [20, 9])) == [[1, 0], [20, 7]]


def test_a_limit_without_hours_ends_no_life():
    """It is kept or exceeded; alone it leaves the life unknown."""
    kept, timed = limit("a", [1.2, 0.9], None), limit("b", None, [20, 30])
    assert judged(kept, timed) == [[1, 1], [20, 30]]
    found = limit_uses([SolvedRollers({}, {}, {}, np.ones(1))], [kept, timed], range(2), 2)
    words = [[STATES[i] for i in row] for row in found["limit_state"][0]]
    assert words == [["exceeded", "kept"], ["kept", "kept"]]
    which, hours = judged(kept)
    assert which == [1, 1] and np.isnan(hours).all()  # 1 stands for an unknown limit


def test_a_second_model_of_an_end_stands_beside_it():
    assert judged(limit("a", [0.5, 0.5], [3, 3], beside=True), limit("b", [0.5, 0.5], [20, 30])) == [[1, 1], [20, 30]]


def test_limits_that_are_never_reached_are_ranked_by_utilisation():
    never = [np.inf, np.inf]
    which, hours = judged(limit("a", [0.3, 0.8], never), limit("b", [0.6, 0.1], never))
    assert which == [1, 0] and hours == never


def test_a_utilisation_above_one_exceeds_a_limit_only_where_the_limit_is_bounded():
    for bounded, state in ((False, "kept"), (True, "exceeded")):
        own = limit("a", [1.5, 1.5], [50, 60], bounded=bounded)
        found = limit_uses([SolvedRollers({}, {}, {}, np.ones(1))], [own], [0], 1)
        assert found["life_to_first_limit_hours"].tolist() == [[50, 60]]
        assert {STATES[i] for i in found["limit_state"].ravel()} == {state}


def test_an_unknown_limit_is_left_out_but_not_hidden():
    """A finite life stands as it is; "never" would be wrong where another limit is unknown."""
    which, hours = judged(limit("a", None, [np.nan, 5]), limit("b", [0.5, 0.5], [40, np.inf]))
    assert which == [1, 0] and hours == [40, 5]
    which, hours = judged(limit("a", None, [5, np.nan]), limit("b", [0.5, 0.5], [40, np.inf]))
    assert which == [0, 1] and hours[0] == 5 and np.isnan(hours[1])


def test_a_limit_of_the_roller_does_not_concern_the_guide():
    which, hours = judged(limit("a", [0.5, 0.5], [3, 3], bodies=("roller",)), limit("b", [0.2, 0.2], [9, np.inf]))
    assert which == [0, 1] and hours == [3, np.inf]


@pytest.mark.parametrize(
    ("used", "state"),
    [((0.9, 1.2, 0.8), "open"), ((1.1, 1.3, 0.9), "open"), ((1.2, 1.4, 1.1), "exceeded"), ((0.5, 0.9, 0.2), "kept")],
)
def test_a_limit_that_a_placeholder_decides_is_open(used, state):
    """The utilisation at the value, at the worse and at the better end of the range."""
    life = np.full((1, 1, 2), np.nan)
    shaped = np.array(used)[:, None, None, None] * np.ones((1, 1, 1, 2))
    assert STATES[states(shaped, life, np.zeros((1, 1, 2), dtype=bool), [limit("a", [1, 1], None)])[0, 0, 0]] == state


def test_asked_limits_follow_from_the_groups():
    everything = [name for name in NAMES if name != "multiaxial"]  # which is not checked
    for outputs in (("forces", "limits"), ("forces", "life", "limits")):
        assert [own.name for own in limits_of(outputs)] == everything
    assert [own.name for own in limits_of(("forces", "limits"), others(["static", "wear"]))] == ["static", "wear"]
    assert [own.name for own in limits_of(("multiaxial", "limits"))] == list(LIMITS)
    assert [own.name for own in limits_of(("life",))] == ["fatigue"] and checked_limits(("life",)) == ()
    assert limits_of(("forces", "contact")) == ()


def test_a_life_that_rests_on_a_placeholder_has_the_lives_at_both_ends_of_its_range():
    """Each end is the life of a case that gives the end of the range as its value; a given factor has no range."""
    given = {"motor_force": 0, "guide_overrollings_per_hour": 60, "permissible_wear_depth": 0.05}
    cases = [tr.Case(**given, **more) for more in ({}, *({"placeholder_position": p} for p in (-1, 0, 1)))]
    ds = tr.solve(cases, ("life", "wear", "limits"), contact_model="sliding")
    for name in (
        "life_hours_by_limit",
        "wear_life_hours",
        "life_to_first_limit_hours",
        "pair_life_to_first_limit_hours",
    ):
        value, low, high = (ds[name + end][0].values for end in ENDS)
        assert np.allclose(value, ds[name][2].values, rtol=1e-12, equal_nan=True), name
        assert np.allclose(low, ds[f"{name}_low"][1].values, rtol=1e-12, equal_nan=True), name
        assert np.allclose(high, ds[f"{name}_high"][3].values, rtol=1e-12, equal_nan=True), name
    wear = ds.sel(limit="wear")
    assert (wear.life_hours_by_limit_low[0] < 0.5 * wear.life_hours_by_limit_low[2]).all()
    held = tr.solve(tr.Case(**given, wear_coefficient_factor=1.0), ("wear", "limits"), contact_model="sliding")
    assert np.array_equal(held.wear_life_hours_low, ds.wear_life_hours_low[2])
    assert (ds.life_hours_by_limit_low.sel(limit="fatigue") == ds.life_hours_by_limit.sel(limit="fatigue")).all()


def test_the_data_set_tells_the_first_limit_in_flags():
    case = tr.Case(motor_force=0, guide_overrollings_per_hour=500)
    left_out = others(["static", "fatigue"])
    wanted = {"outputs": ("peak_stress", "life", "limits"), "contact_model": "sliding", "not_checked": left_out}
    ds = tr.solve([case, case], **wanted)
    assert ds.utilisation.dims == ("case", "limit", "body") and ds.limit.values.tolist() == ["static", "fatigue"]
    flags = ds.limiting_mechanism
    assert flags.dims == ("case", "body")
    words = flags.attrs["flag_meanings"].split()
    assert words == [*NAMES, "unknown"] and words[int(flags[0, 0])] == "fatigue"
    hours = ds.life_hours_by_limit.sel(limit="fatigue", body="roller").values
    assert hours == pytest.approx(ds.roller_life_hours.values) and ds.attrs["limits_notes"] == ""


def test_another_failure_probability_takes_the_scatter_of_the_material_or_the_typical_one():
    case = {"motor_force": 0, "guide_overrollings_per_hour": 500}
    scattered = {"like": "1.7225-normalised", "scatter_in_cycles": 4.0}
    options = {"outputs": ("life", "limits"), "contact_model": "sliding", "failure_probability": 0.1}
    ds = tr.solve(tr.Case(**case, roller_material=scattered), **options)
    ends = [ds[f"life_hours_by_limit{end}"].sel(limit="fatigue") for end in ("", "_low", "_high")]
    for hours in ends:  # a known scatter gives one life
        assert hours.sel(body="roller") == pytest.approx(float(ds.roller_life_hours) / 2.0, rel=1e-12)  # 4^-1/2
    for hours, scatter in zip(ends, (10.0, 16.1, 5.2), strict=True):
        assert hours.sel(body="guide") == pytest.approx(float(ds.guide_life_hours) / scatter**0.5, rel=1e-12)
    told = "placeholders of material '1.7225-normalised': scatter_in_cycles (typical of S-N tests and of bearings"
    assert told in ds.attrs["limits_notes"] and "expected from 5.2 to 16.1" in ds.attrs["limits_notes"]
    # the stress that the fatigue limit allows falls with the scatter of the strength, T_N^(1/k)
    k = tr.load_database().material("1.7225-normalised").woehler_exponent
    used = float(ds.utilisation.sel(limit="fatigue", body="guide"))
    median = tr.solve(tr.Case(**case, roller_material=scattered), **options | {"failure_probability": 0.5})
    assert used == pytest.approx(float(median.utilisation.sel(limit="fatigue", body="guide")) * 10 ** (0.5 / k))
    assert (
        median.life_hours_by_limit_low.sel(limit="fatigue") == median.life_hours_by_limit.sel(limit="fatigue")
    ).all()
    assert "scatter_in_cycles" not in median.attrs["limits_notes"]


@pytest.mark.parametrize(("probability", "worse", "better"), [(0.05, 16.1, 5.2), (0.9, 5.2, 16.1)])
def test_the_typical_scatter_moves_with_the_placeholders(probability, worse, better):
    """A given place of the placeholders gives one life; without it the life has the range between both ends."""
    from scipy.stats import norm

    case = {"motor_force": 0, "guide_overrollings_per_hour": 500}
    options = {"outputs": ("life", "limits"), "contact_model": "sliding", "failure_probability": probability}
    places = {-1.0: worse, 0.0: 10.0, 0.5: 10 + 0.5 * (better - 10), 1.0: better}
    deviates = norm.ppf(probability) / (norm.ppf(0.9) - norm.ppf(0.1))
    for place, scatter in places.items():
        ds = tr.solve(tr.Case(**case, placeholder_position=place), **options)
        lives = [ds[f"life_hours_by_limit{end}"].sel(limit="fatigue") for end in ("", "_low", "_high")]
        expected = float(ds.roller_life_hours) * scatter**deviates
        assert [float(one.sel(body="roller")) for one in lives] == pytest.approx([expected] * 3, rel=1e-9)
    free = tr.solve(tr.Case(**case), **options)
    low, high = (
        float(free[f"life_hours_by_limit{end}"].sel(limit="fatigue", body="roller")) for end in ("_low", "_high")
    )
    median = float(free.roller_life_hours)
    assert [low / median, high / median] == pytest.approx([worse**deviates, better**deviates], rel=1e-9)


def test_the_typical_scatter_is_that_of_its_sources():
    least, value, most = TYPICAL_SCATTER
    assert most == pytest.approx((np.log(10) / np.log(10 / 9)) ** (1 / (10 / 9)), rel=3e-3)  # Weibull slope 10/9
    assert value == pytest.approx(np.median([5.2, 6.8, 10.0, 10.8, most])) and least == 5.2


def test_nothing_is_computed_that_was_not_asked_for():
    ds = tr.solve(tr.Case(motor_force=0), outputs=("forces", "contact"), contact_model="sliding")
    assert not {"utilisation", "rating_life_hours", "life_cycles", "limiting_mechanism"} & set(ds.data_vars)


def test_the_command_line_prints_one_table():
    ran = CliRunner().invoke(app, ["solve", "--limits", "static,rating", "--set", "contact_model=sliding"])
    told = " ".join(ran.output.split())
    assert ran.exit_code == 0 and "│ static strength" in told and "│ rating" in told
    assert "hours of rating (give guide_overrollings_per_hour)" in told
    others = [limit.word for limit in checked_limits() if limit.name not in ("static", "rating")]
    assert all(f"{word} (left out)" in told for word in others)
    assert "Contact 1" not in told  # one table
    assert groups_of("all")[-1] == "limits" and "multiaxial" not in groups_of("all")
    with pytest.raises(InputError, match="Did you mean 'rating'"):
        groups_of("ratings")


@pytest.mark.parametrize("limits", ["fatigue", "heat,fatigue"])
def test_the_table_of_single_limits_marks_guesses_of_the_own_body(limits):
    """The roller's values are given; the guide's stay placeholders. The peak stress is no result here."""
    given = "roller_material={like: 1.7225-normalised, hardness: 220, fatigue_limit_torsion: 210}"
    options = ["contact_model=sliding", "guide_overrollings_per_hour=60", "life_criterion=findley", given]
    ran = CliRunner().invoke(app, ["solve", "--limits", limits, *(word for o in options for word in ("--set", o))])
    assert ran.exit_code == 0
    marked = {"roller": False, "guide": True}
    rows = [line for line in ran.output.splitlines() if re.match(r"│ fatigue +│", line)]
    assert {body: "yes" in line for line in rows for body in marked if f"│ {body} " in line} == marked


@pytest.mark.parametrize("outputs", ["life", "life,limits,heat"])
def test_a_life_is_told_without_peaks_and_forces(outputs):
    scattered = "roller_material={like: 1.7225-normalised, scatter_in_cycles: 4}"
    words = ["solve", "--set", f"outputs={outputs}", "--set", "contact_model=sliding", "--set", scattered]
    ran = CliRunner().invoke(app, words)
    told = " ".join(ran.output.split())
    assert ran.exit_code == 0 and re.match(
        r"[\d.]+( to [\d.]+)? h( \(placeholders\))?, then fatigue of the roller", told
    )
    lives = [line for line in ran.output.splitlines() if line.startswith("│ roller │")]
    assert len(lives) >= 1


@pytest.mark.parametrize(
    ("case", "regime"),
    [
        ({"motor_force": -60, "friction_coefficient": 0.1, "axial_force": 0}, "full_slip"),
        ({"motor_force": 0, "radial_force": -4000}, "rolling"),  # both bodies exceed R_m
        ({"motor_force": 0, "radial_force": -1500, "guide_material": STRONG}, "rolling"),  # the roller alone
    ],
)
@pytest.mark.parametrize("outputs", [("peak_stress", "life"), ("peak_stress", "life", "multiaxial")])
def test_a_roller_that_skids_and_a_body_above_its_strength_have_no_fatigue_life(case, regime, outputs):
    given = tr.Case(guide_overrollings_per_hour=600, **case)
    options = {"life_criterion": "von_mises_amplitude"} if "multiaxial" in outputs else {}
    ds = tr.solve(given, outputs, contact_model="sliding", accuracy="preview", **options)
    assert REGIMES[int(ds.regime)] == regime
    lifeless = ["roller"] if "guide_material" in case else ["roller", "guide"]
    for body in BODIES:
        lives = [ds.life_cycles.sel(body=body), ds.life_hours.sel(body=body), ds[f"{body}_life_hours"]]
        lives.append(ds.life_error_estimate.sel(body=body) if not options else lives[0])
        assert all(bool(one.isnull().all() if body in lifeless else one.notnull().all()) for one in lives)
    assert np.isnan(ds.pair_life_hours) and FIRST_TO_FAIL[int(ds.first_to_fail)] == "unknown"
    swapped = tr.Case(**{**case, "guide_material": given.roller_material, "roller_material": given.guide_material})
    other = tr.solve(swapped, outputs, contact_model="sliding", accuracy="preview", **options)
    assert np.isnan(other.pair_life_hours), "the guide has no life, though its hours are not known"


@pytest.mark.parametrize(
    ("outputs", "mechanism"),
    [
        (("peak_stress", "life", "limits"), "static"),
        (("life", "wear", "limits"), "static"),
        (("life", "limits"), "fatigue"),
    ],
)
def test_a_body_above_its_strength_reaches_its_first_limit_at_once(outputs, mechanism):
    worn = {"like": STEEL, "wear_coefficient": 1e-6}
    case = tr.Case(motor_force=0, radial_force=-4000, roller_material=worn, permissible_wear_depth=0.1)
    left_out = () if mechanism == "static" else ("static",)
    ds = tr.solve(case, outputs, contact_model="sliding", accuracy="preview", not_checked=left_out)
    assert ds.life_to_first_limit_hours.values.tolist() == [0.0, 0.0] and ds.pair_life_to_first_limit_hours == 0.0
    words = ds.limiting_mechanism.attrs["flag_meanings"].split()
    assert [words[i] for i in ds.limiting_mechanism.values] == [mechanism] * 2
    assert np.isnan(ds.life_hours_by_limit.sel(limit="fatigue")).all()
    answer = answer_of_roller(ds)
    assert answer.kind == "breaks" and answer.headline["low"] == answer.headline["high"] == 0.0
    assert {one["limit"] for one in answer.headline["broken"]} == {LIMITS[mechanism].word}


def test_a_skidding_roller_keeps_the_lives_of_its_other_limits():
    worn = {"like": STEEL, "wear_coefficient": 1e-6}
    case = tr.Case(motor_force=60, friction_coefficient=0.1, axial_force=0, roller_material=worn, guide_material=worn)
    case = tr.Case(**case.as_dict() | {"permissible_wear_depth": 0.1, "guide_overrollings_per_hour": 600})
    ds = tr.solve(case, ("life", "rating", "wear", "limits"), contact_model="sliding", accuracy="preview")
    assert REGIMES[int(ds.regime)] == "full_slip"
    assert np.isnan(ds.life_hours_by_limit.sel(limit=["fatigue", "rating"])).all()
    guide = ds.life_hours_by_limit.sel(limit="wear", body="guide")
    assert np.isfinite(guide) and ds.life_to_first_limit_hours.sel(body="guide") == guide


@pytest.mark.slow
def test_the_head_of_a_sheet_names_each_limit_that_may_come_first():
    """Fatigue lies within the range of the wear life here; a measured coefficient tells which one it is."""
    given = {"permissible_wear_depth": 0.1, "radial_force": -90, "axial_force": 5, "guide_overrollings_per_hour": 500}
    one_line = {"contact_model": "sliding", "not_checked": ("pressure_line",)}
    ds = tr.solve(tr.Case(**given), **one_line)
    hours = ds.sel(body="roller").life_hours_by_limit.sel(limit="fatigue").item()
    low, high = (float(ds[f"pair_life_to_first_limit_hours{end}"]) for end in ("_low", "_high"))
    assert low < hours == high
    head = answer_of_roller(ds).headline
    assert (head["low"], head["high"]) == (low, high) and head["ends"] == ["wear", "fatigue"] and head["guessed"]
    measured = {"like": "1.7225-normalised", "wear_coefficient": 1e-6}
    known = tr.solve(tr.Case(**given, roller_material=measured, guide_material=measured), **one_line)
    answer = answer_of_roller(known)
    assert answer.headline["ends"] == ["fatigue"] and not answer.headline["guessed"]
    assert answer.headline["low"] == answer.headline["high"] == hours
    assert headline(answer).startswith(f"{rounded(hours)} h, then fatigue of the roller")
    assert hours < limit_row(answer, "wear", "roller")["low"]


def test_a_solved_roller_is_told_its_headline_once():
    ran = CliRunner().invoke(app, ["solve", "--set", "contact_model=sliding", "--set", "accuracy=preview"])
    assert ran.exit_code == 0 and ran.output.count("then fatigue of the roller") == 1
    assert "│ fatigue " in ran.output and "not checked, roller" in ran.output, "the limits stand at the end"
