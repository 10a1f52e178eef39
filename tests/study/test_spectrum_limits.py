"""Sums of a load spectrum by limit: Miner's sum where a limit has a life, the worst block where it has none."""

import numpy as np
import pytest

from trackroller.damage.verdict import ENDS, STATES
from trackroller.errors import InputError
from trackroller.report.numbers import rounded
from trackroller.report.pages.spectrum import limit_table
from trackroller.report.words.spectrum import sentences
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
    head, other = sentences(ds)[:2]
    hours = shifts.min("limit") * float(ds["duration"].sum())
    assert (head.kind, head.values["body"]) == ("spectrum_pair", str(hours.body.values[int(hours.values.argmin())]))
    assert head.values["hours"].startswith(f"{rounded(float(ds.pair_life_to_first_limit_hours_low))}")
    assert other.kind == "spectrum_limit" and other.values["body"] != head.values["body"]
    assert [row[0].split()[0] for row in limit_table(ds).rows] == ["static", "rolling-contact", "wear"]


def test_a_limit_without_a_life_is_exceeded_at_once_by_the_worst_block():
    jerk = LOADED | {"name": "jerk", "distance": 1, "radial_force": -9e4}
    ds = solved(EMPTY, jerk, limits=("static",))
    assert (ds.life_to_first_limit_shifts == 0).all() and (ds.utilisation > 1).all()
    assert sentences(ds)[2].text.startswith("The roller exceeds static failure")
    assert (ds.limit_state == STATES.index("exceeded")).all()
    still = solved(EMPTY, jerk | {"distance": 0, "guide_overrollings": 0}, limits=("static",))
    assert (still.utilisation < 1).all() and np.isnan(still.life_to_first_limit_shifts).all()  # no limit has a life
    assert (still.limit_state == STATES.index("kept")).all()


def test_names_of_limits_are_checked():
    with pytest.raises(InputError, match=r"limits.*'fatige'.*fatigue"):
        solved(LOADED, limits=["fatige"])
    with pytest.raises(InputError, match="limits"):
        Spectrum.from_dict({"blocks": [LOADED], "limits": 3})


def test_every_limit_is_checked_whose_inputs_are_given():
    """Without the key `limits`; the ends of the range are those of the wear coefficient."""
    ds = solve_spectrum(Spectrum.from_dict({"blocks": [LOADED], "base": BASE, "contact_model": "sliding"}))
    known = [name for name in ds.limit.values if (ds.limit_state.sel(limit=name) > 0).any()]
    assert known == ["static", "fatigue", "rating", "shakedown", "wear"]
    value, low, high = (ds[f"life_shifts_by_limit{end}"].sel(limit="wear").values for end in ENDS)
    assert (low < 0.5 * value).all() and (2.0 * value < high).all()
    assert float(ds.pair_life_to_first_limit_shifts_low) <= float(ds.pair_life_to_first_limit_shifts)
