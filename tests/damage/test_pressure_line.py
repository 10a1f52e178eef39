"""The line of tests in rolling contact: pressure by hardness, life by pressure, and its ranges."""

import numpy as np
import pytest
from scipy.stats import norm

import trackroller as tr
from trackroller.damage.pressure_line import pressure_of_hardness
from trackroller.materials import builtin_database
from trackroller.materials.pressure_line import BY_HARDNESS

OUTPUTS = ("contact", "life", "limits")
CASE = {"motor_force": 0, "guide_overrollings_per_hour": 500}
LINE = {"rolling_pressure": 900.0, "rolling_cycles": 2e6, "rolling_exponent": 12.0}
DB = builtin_database()


def solved(roller=None, **options):
    case = CASE | ({"roller_material": roller} if roller else {})
    return tr.solve(tr.Case(**case), OUTPUTS, contact_model="sliding", accuracy="preview", **options)


@pytest.mark.parametrize(("hardness", "pressure"), [(270, 675), (350, 896), (170, 399)])
def test_the_pressure_of_rollers_is_that_of_the_book_at_1e8(hardness, pressure):
    """Examples of the formula, moved from 1e7 to 1e8 by N^-1/18."""
    rollers, _ = pressure_of_hardness(hardness)
    assert rollers * 0.1 ** (1 / 18) == pytest.approx(pressure, abs=0.6)


def test_the_pressure_of_gear_flanks_is_that_of_1_in_100():
    """At 1e7 and 1 % failures 0.327 HB + 26 kpsi; the life of 1 in 100 is the median one times T_N^(u/2.563)."""
    for hardness in (200.0, 300.0):
        _, flanks = pressure_of_hardness(hardness)
        kpsi = 6.894757
        shorter = 10.0 ** (norm.ppf(0.01) / (norm.ppf(0.9) - norm.ppf(0.1)))
        assert flanks * shorter ** (1 / 18) == pytest.approx((0.327 * hardness + 26) * kpsi, rel=1e-3)


def test_both_kinds_of_tests_agree_with_the_level_of_tempered_steel():
    """Steel quenched and tempered bears some 1,000 MPa for 5e6 overrollings."""
    for name in ("1.7225-quenched-tempered", "42CrMo4+QT-16"):
        material = DB.material(name)
        ends = np.array(material.records["rolling_pressure"].range)
        at_5e6 = ends * (material.rolling_cycles / 5e6) ** (1 / material.rolling_exponent)
        assert (at_5e6 > 800).all() and (at_5e6 < 1200).all()


def test_the_life_is_that_of_the_line_by_hand():
    ds = solved({"like": "1.7225-normalised", **LINE})
    p = ds.max_pressure.values
    rate = 60e3 * 60 / (2 * np.pi * (21.75 - 6 * np.cos(np.deg2rad(30))))
    hours = 2e6 * (p / 900.0) ** -12.0 / rate
    assert ds.life_hours_by_limit.sel(limit="pressure_line", body="roller") == pytest.approx(hours.min(), rel=1e-9)
    assert ds.utilisation.sel(limit="pressure_line", body="roller") == pytest.approx(p.max() / 900.0, rel=1e-12)
    assert "material '1.7225-normalised': rolling_pressure (by hardness" in ds.attrs["limits_notes"]  # of the guide
    ends = [ds[f"life_hours_by_limit_{end}"].sel(limit="pressure_line") for end in ("low", "high")]
    assert ends[0].sel(body="roller") == ends[1].sel(body="roller")  # the line was given
    low, high = DB.material("1.7225-normalised").records["rolling_pressure"].range
    assert ends[1].sel(body="guide") / ends[0].sel(body="guide") == pytest.approx((high / low) ** 18, rel=1e-9)


def test_it_is_a_second_model_that_ends_nothing():
    weak = solved({"like": "1.7225-normalised", **LINE | {"rolling_pressure": 50.0}})
    usual = solved()
    assert weak.life_hours_by_limit.sel(limit="pressure_line", body="roller") < 1
    assert weak.life_to_first_limit_hours.sel(body="roller") == usual.life_to_first_limit_hours.sel(body="roller")


def test_the_life_at_a_failure_probability_takes_the_scatter():
    deviates = norm.ppf(0.05) / (norm.ppf(0.9) - norm.ppf(0.1))
    for own, scatters in (({}, (10.0, 16.1, 5.2)), ({"scatter_in_cycles": 4.0}, (4.0,) * 3)):
        roller = {"like": "1.7225-normalised", **LINE, **own}
        median = float(solved(roller).life_hours_by_limit.sel(limit="pressure_line", body="roller"))
        ds = solved(roller, failure_probability=0.05)
        for end, scatter in zip(("", "_low", "_high"), scatters, strict=True):
            hours = float(ds[f"life_hours_by_limit{end}"].sel(limit="pressure_line", body="roller"))
            assert hours == pytest.approx(median * scatter**deviates, rel=1e-9)


def test_steel_of_a_known_hardness_has_a_line_and_others_need_one():
    steel = DB.material({"like": "C45", "hardness": 250})
    assert steel.records["rolling_pressure"].range == pytest.approx(tuple(np.sort(pressure_of_hardness(250.0))))
    assert steel.rolling_pressure > DB.material("C45").rolling_pressure  # computed anew
    own = DB.material({"like": "C45", "hardness": 250, **LINE})
    assert (own.rolling_pressure, own.rolling_cycles, own.rolling_exponent) == tuple(LINE.values())
    for other in ({"like": "C45", "hardness": 600}, {"like": "C45", "surface_hardened": 1}, "EN AW-7075", "100Cr6"):
        assert DB.material(other).rolling_pressure is None
    with pytest.raises(tr.InputError, match="lacks rolling_cycles and rolling_exponent"):
        DB.material({"like": "100Cr6", "rolling_pressure": 2000})
    hard = DB.material("C45-induction-hardened")
    assert hard.rolling_pressure * 10 ** (-1 / hard.rolling_exponent) == pytest.approx(1648, rel=2e-3)  # at 1e8
    by_hardness = [name for name in DB.names() if DB.material(name).records.get("rolling_pressure")]
    assert {"1.7225-normalised", "42CrMo4+QT-40", "1.4301-annealed"} <= set(by_hardness)
    assert DB.material("42CrMo4+QT-40").records["rolling_pressure"].source == BY_HARDNESS
    ds = solved("EN AW-7075")
    assert "pressure_line: material 'EN AW-7075' has no rolling_pressure." in ds.attrs["limits_notes"]
    assert np.isnan(ds.life_hours_by_limit.sel(limit="pressure_line", body="roller"))
