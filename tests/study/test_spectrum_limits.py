"""Sums of a load spectrum by limit: Miner's sum where a limit has a life, the worst block where it has none."""

import numpy as np
import pytest
from limit_rows import headline, limit_row

from trackroller.damage.first_limit import ENDS, STATES
from trackroller.errors import InputError
from trackroller.results.spectrum_answer import answer_of_spectrum
from trackroller.study.spectrum.file import Spectrum
from trackroller.study.spectrum.solve import solve_spectrum

BASE = {"motor_force": 0, "friction_coefficient": 0.2, "permissible_wear_depth": 0.1, "axial_force": 0}
LOADED = {"name": "loaded", "distance": 9000, "radial_force": -60, "guide_overrollings": 40}
EMPTY = {"name": "empty", "distance": 3000, "radial_force": -20, "guide_overrollings": 10, "velocity": 20}


def solved(*blocks, limits=("static", "fatigue", "wear"), **more):
    given = {"blocks": list(blocks), "base": BASE, "contact_model": "sliding", "limits": list(limits)} | more
    return solve_spectrum(Spectrum.from_dict(given))


def test_rates_of_every_limit_add_up():
    both, one, other = (solved(*blocks, critical_damage=0.5) for blocks in ((LOADED, EMPTY), (LOADED,), (EMPTY,)))
    rates = [1.0 / ds["life_shifts_by_limit"].sel(limit=["fatigue", "wear"]).values for ds in (both, one, other)]
    assert rates[0] == pytest.approx(rates[1] + rates[2], rel=1e-9)
    assert both.life_shifts_by_limit.sel(limit="fatigue").values == pytest.approx(
        both.life_shifts.min("contact").values
    )
    assert both.damage_sum_by_limit.sel(limit="wear").values == pytest.approx(rates[0][1])
    assert both.utilisation.sel(limit="static").values == pytest.approx(one.utilisation.sel(limit="static").values)
    assert np.isnan(both.life_shifts_by_limit.sel(limit="static")).all()


def test_hours_of_the_wear_limit_are_those_of_the_blocks():
    """One block: shifts times hours of a shift are the hours of the solved case, for roller and guide."""
    ds = solved(EMPTY)
    spectrum = Spectrum.from_dict(
        {
            "blocks": [EMPTY | {"guide_overrollings": None, "guide_overrollings_per_hour": 4}],
            "base": BASE,
            "limits": "all",
            "contact_model": "sliding",
        }
    )
    other = solve_spectrum(spectrum)  # 10 overrollings of the guide in 2.5 h are 4 an hour
    assert other.life_shifts_by_limit.sel(limit="wear").values == pytest.approx(
        ds.life_shifts_by_limit.sel(limit="wear").values
    )
    assert spectrum.groups[-1] == "limits"


def test_the_first_limit_is_the_one_that_comes_first():
    ds = solved(LOADED, EMPTY)
    words = ds.limiting_mechanism.attrs["flag_meanings"].split()
    shifts = ds.life_shifts_by_limit
    for body in ("roller", "guide"):
        first = shifts.sel(body=body).min()
        assert float(ds.life_to_first_limit_shifts.sel(body=body)) == float(first)
        assert words[int(ds.limiting_mechanism.sel(body=body))] == str(
            shifts.limit[int(shifts.sel(body=body).fillna(np.inf).values.argmin())].values
        )
    assert float(ds.pair_life_to_first_limit_shifts) == float(shifts.min())
    answer = answer_of_spectrum(ds)
    hours = shifts.min("limit") * float(ds["duration"].sum())
    assert answer.headline["body"] == str(hours.body.values[int(hours.values.argmin())])
    assert answer.headline["low"] == float(ds.pair_life_to_first_limit_hours_low)
    assert answer.headline["high"] == float(ds.pair_life_to_first_limit_hours_high)
    assert set(answer.table["name"]) == {"static", "fatigue", "wear"}
    for row in answer.table.itertuples():
        own = ds.sel(limit=row.name, body=row.body)
        np.testing.assert_array_equal(row.low, float(own["life_hours_by_limit_low"]))
        np.testing.assert_array_equal(row.used_low, float(own["utilisation"]))


def test_a_limit_without_a_life_is_exceeded_at_once_by_the_worst_block():
    jerk = LOADED | {"name": "jerk", "distance": 1, "radial_force": -9e4}
    ds = solved(EMPTY, jerk, limits=("static",))
    assert (ds.life_to_first_limit_shifts == 0).all() and (ds.utilisation > 1).all()
    answer = answer_of_spectrum(ds)
    assert answer.kind == "breaks" and {one["body"] for one in answer.headline["broken"]} == {"roller", "guide"}
    assert all(one["blocks"] == ["jerk"] for one in answer.headline["broken"])
    assert headline(answer).startswith("The roller and guide break at once in jerk")
    assert (ds.limit_state == STATES.index("exceeded")).all()
    still = solved(EMPTY, jerk | {"distance": 0, "guide_overrollings": 0}, limits=("static",))
    assert (still.utilisation < 1).all() and np.isnan(still.life_to_first_limit_shifts).all()  # no limit has a life
    assert (still.limit_state == STATES.index("kept")).all()


def palletiser():
    """Solve three blocks, of which the last one exceeds the shakedown limit of the guide."""
    base = {"friction_coefficient": 0.18, "motor_force": 0, "axis_distance": 26, "guide_profile_radius": 7}
    base |= {"roller_profile_radius": -7.5, "contact_angle": 40, "guide_curve_radius": np.inf, "velocity": 50}
    base |= {"guide_overrollings_per_hour": 200, "permissible_wear_depth": 2}
    base |= {"roller_material": "42CrMo4+QT-40", "guide_material": "C45"}
    blocks = [
        {"name": "loaded", "share": 0.45, "radial_force": -420, "axial_force": 40},
        {"name": "return", "share": 0.5, "radial_force": -120, "axial_force": 5, "velocity": 90},
        {"name": "bump", "share": 0.05, "radial_force": -900, "axial_force": 90, "velocity": 10},
    ]
    given = {"blocks": blocks, "base": base, "limits": "all", "contact_model": "sliding", "accuracy": "preview"}
    return solve_spectrum(Spectrum.from_dict(given))


def test_the_headline_names_ranges_and_limits_that_a_block_exceeds():
    ds = palletiser()
    answer = answer_of_spectrum(ds)
    low, high = (ds[f"life_hours_by_limit{end}"] for end in ("_low", "_high"))
    both = ["fatigue", "pressure_line"]  # lines of one end: the life reaches from the shorter to the longer one
    lowest = min(float(low.sel(limit=both).min()), float(low.sel(limit="wear").min()))
    highest = min(float(high.sel(limit=both).max("limit").min()), float(high.sel(limit="wear").min()))
    head = answer.headline
    assert (head["low"], head["high"]) == (lowest, highest) and head["guessed"]
    assert float(low.sel(limit="pressure_line").min()) == lowest
    assert head["line_low"] == "rolling-contact line"
    assert set(head["ends"]) == {"wear", "fatigue"}
    used = float(ds["utilisation"].sel(limit="shakedown", body="guide"))
    assert used > 1.0 > float(ds["utilisation"].sel(limit="shakedown", body="roller"))
    (over,) = head["exceeded"]
    assert (over["limit"], over["body"], over["use"], over["blocks"]) == ("shakedown", "guide", used, ["bump"])
    assert "shakedown of the guide exceeded" in headline(answer) and "in bump" in headline(answer)


def test_a_limit_that_a_placeholder_decides_is_open_in_its_blocks():
    """The use of the shakedown limit is inversely proportional to the yield strength, which is a placeholder."""
    low, high = 400.0, 550.0  # MPa; the value is 450 MPa
    one = solved(LOADED, EMPTY, limits=("fatigue", "shakedown"))
    used = float(one.utilisation.sel(limit="shakedown", body="roller"))
    # the pressure of an elliptic contact rises with the third root of the force
    force = LOADED["radial_force"] * (0.99 / used) ** 3
    near = solved(LOADED | {"radial_force": force}, EMPTY, limits=("fatigue", "shakedown"))
    used = float(near.utilisation.sel(limit="shakedown", body="roller"))
    assert used * 450 / high < 1 < used * 450 / low
    answer = answer_of_spectrum(near)
    assert {"limit": "shakedown", "body": "roller"} in answer.headline["open"]
    row = limit_row(answer, "shakedown", "roller")
    assert (row["state"], row["used_low"], row["blocks"]) == ("open", used, "loaded")


def test_a_block_outside_the_half_space_is_named_before_any_life():
    blocks = [LOADED | {"radial_force": -300, "axial_force": 70}, EMPTY | {"axial_force": 0}]
    base = BASE | {"roller_material": "POM-C", "guide_material": "C45", "roller_profile_radius": -6.1}
    ds = solved(*blocks, base=base | {"contact_angle": 45}, limits=("fatigue",))
    wide = ds["validity"].values & 1  # the first flag: half_space
    assert wide.tolist() == [1, 0]
    answer = answer_of_spectrum(ds)
    assert answer.headline["not_judged"] == ["outside the half-space"] and "not judged" in headline(answer)
    assert next(caution.where for caution in answer.warnings if caution.code == "not_judged").endswith(": loaded")
    assert answer_of_spectrum(solved(LOADED, EMPTY)).headline["not_judged"] == []


def test_the_life_of_the_other_body_says_that_it_lies_beyond_the_data():
    ds = solved(LOADED | {"radial_force": -30}, EMPTY | {"radial_force": -10}, limits=("fatigue",))
    turns = {
        b: float(ds["life_shifts"].sel(body=b).min() * ds["overrollings"].sel(body=b).sum()) for b in ds.body.values
    }
    assert min(turns.values()) > 5e6  # the last cycles of the S-N data
    assert (answer_of_spectrum(ds).table["extrapolated"] == "yes").all()


def test_names_of_limits_are_checked():
    with pytest.raises(InputError, match=r"limits.*'fatige'.*fatigue"):
        solved(LOADED, limits=["fatige"])
    with pytest.raises(InputError, match="limits"):
        Spectrum.from_dict({"blocks": [LOADED], "limits": 3})


def test_every_limit_is_checked_whose_inputs_are_given():
    """Without the key `limits`; the ends of the range are those of the wear coefficient."""
    ds = solve_spectrum(Spectrum.from_dict({"blocks": [LOADED], "base": BASE, "contact_model": "sliding"}))
    known = [name for name in ds.limit.values if (ds.limit_state.sel(limit=name) > 0).any()]
    assert known == ["static", "fatigue", "pressure_line", "rating", "shakedown", "wear"]
    value, low, high = (ds[f"life_shifts_by_limit{end}"].sel(limit="wear").values for end in ENDS)
    assert (low < 0.5 * value).all() and (2.0 * value < high).all()
    assert float(ds.pair_life_to_first_limit_shifts_low) <= float(ds.pair_life_to_first_limit_shifts)


def test_a_limit_is_not_kept_in_a_block_without_a_result_and_its_known_damage_is_that_of_the_worse_track():
    kick = {"name": "kick", "distance": 5, "radial_force": -30, "axial_force": 90, "guide_overrollings": 1}
    loaded = LOADED | {"axial_force": 20}
    ds = solved(loaded, EMPTY, kick, limits=("static", "fatigue", "shakedown"))
    assert np.isnan(ds["peak_stress"].sel(block="kick")).any()
    answer = answer_of_spectrum(ds)
    assert answer.kind == "unknown" and {*answer.table["state"]} == {"unknown"} and len(answer.table) == 6
    for body in ("roller", "guide"):
        tracks = ds["damage"].sel(body=body).sum("block")
        assert float(tracks[1]) > float(tracks[0])  # contact 2 carries the axial force
        by_limit = ds["damage_by_limit"].sel(limit="fatigue", body=body)
        known = ds["damage"].sel(body=body, contact=2)
        np.testing.assert_array_equal(by_limit.transpose("block").values, known.transpose("block").values)
        share = float(known.sel(block="loaded") / known.sum())
        own = limit_row(answer, "fatigue", body)
        assert own["share"] == pytest.approx(share) and own["block"] == f"loaded, {100 * share:.0f} %"
    still = solved(loaded, EMPTY, kick | {"distance": 0, "guide_overrollings": 0}, limits=("static", "fatigue"))
    assert "unknown" not in {*answer_of_spectrum(still).table["state"]}  # a block without travel does not count


def test_failures_is_the_other_name_of_the_failure_probability():
    steel = {"like": "1.7225-quenched-tempered", "scatter_in_cycles": 4.0}
    base = {"roller_material": steel, "guide_material": steel, "motor_force": 0, "guide_overrollings_per_hour": 60}
    keys = {"base": base, "blocks": [{"distance": 4000, "radial_force": -300, "axial_force": 20}]}
    keys |= {"contact_model": "sliding", "accuracy": "preview"}
    name = "life_to_first_limit_hours"
    by_name = solve_spectrum(Spectrum.from_dict(keys | {"failures": "10%"}))[name]
    assert np.array_equal(by_name, solve_spectrum(Spectrum.from_dict(keys | {"failure_probability": 0.1}))[name])
    median = solve_spectrum(Spectrum.from_dict(keys))[name]
    assert np.allclose(median, 2.0 * by_name, rtol=1e-9)  # T_N = N_90/N_10 = 4
    with pytest.raises(InputError, match="another name of it"):
        Spectrum.from_dict(keys | {"failures": "10%", "failure_probability": 0.1})
