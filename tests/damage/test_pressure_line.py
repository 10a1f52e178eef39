"""The line of tests in rolling contact: pressure by hardness, life by pressure, and its ranges."""

import json

import numpy as np
import pytest
from scipy.stats import norm

import trackroller as tr
from trackroller.damage.pressure_line import pressure_of_hardness
from trackroller.materials import builtin_database
from trackroller.materials.pressure_line import BY_HARDNESS
from trackroller.report.headlines import headline_of
from trackroller.results.roller_answer import answer_of_roller
from trackroller.roller.requirement import KEY
from trackroller.study.spectrum.file import Spectrum
from trackroller.study.spectrum.solve import solve_spectrum

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


@pytest.mark.parametrize(("pressure", "lines"), [
    (50.0, ("rolling-contact line", "bending line")),
    (5000.0, ("bending line", "rolling-contact line")),
])  # fmt: skip
def test_life_is_a_range_whose_ends_are_both_lines(pressure, lines):
    """The value stays that of the S-N curve; the ends are the lives by each line, and each names its line."""
    ds = solved({"like": "1.7225-normalised", **LINE | {"rolling_pressure": pressure}})
    roller = ds.sel(body="roller")
    by_curve = float(ds.roller_life_hours)
    by_pressure = float(roller.life_hours_by_limit.sel(limit="pressure_line"))
    assert roller.life_to_first_limit_hours == roller.life_hours_by_limit.sel(limit="fatigue") == by_curve
    ends = [float(roller[f"life_to_first_limit_hours_{end}"]) for end in ("low", "high")]
    assert ends == sorted([by_curve, by_pressure])
    for end in ("low", "high"):  # each line keeps its own life
        assert roller[f"life_hours_by_limit_{end}"].sel(limit="fatigue") == by_curve
    answer = answer_of_roller(ds)
    row = answer.table.set_index(["limit", "body"]).loc[("fatigue", "roller")]
    assert row["line"] == " to ".join(lines)
    assert (row["low"], row["high"], row["hours"]) == (*ends, by_curve)
    assert (answer.headline["line_low"], answer.headline["line_high"]) == lines
    assert f"({lines[0]} to {lines[1]})" in headline_of(answer).text
    ends = [float(ds[f"pair_life_to_first_limit_hours_{end}"]) for end in ("low", "high")]
    middle = np.sqrt(ends[0] * ends[1])
    for wanted, state in ((0.9 * ends[0], "met"), (middle, "open"), (1.1 * ends[1], "missed")):
        stated = json.dumps({"pair_life_hours": {"min": wanted}})
        required = answer_of_roller(ds.assign_attrs({KEY: stated}))
        assert required.headline["state"] == state


def test_a_material_of_bending_alone_says_so():
    ds = solved("EN AW-7075")
    answer = answer_of_roller(ds)
    row = answer.table.set_index(["limit", "body"]).loc[("fatigue", "roller")]
    assert row["line"] == "bending line alone"
    assert row["low"] == row["high"] == float(ds.roller_life_hours)
    assert answer.headline["line_low"] == answer.headline["line_high"] == ""
    assert "line" not in headline_of(answer).text


def test_an_sn_curve_of_rolling_tests_takes_no_line_of_its_hardness():
    ds = solved({"like": "1.7225-normalised", "sn_in_rolling": 1})
    assert np.isnan(ds.life_hours_by_limit.sel(limit="pressure_line", body="roller"))
    assert ds.life_to_first_limit_hours_low.sel(body="roller") == ds.life_to_first_limit_hours_high.sel(body="roller")
    table = answer_of_roller(ds).table.set_index(["limit", "body"])
    assert table.loc[("fatigue", "roller"), "line"] == "S-N line of rolling tests alone"
    with pytest.raises(tr.InputError, match=r"sn_in_rolling.*0 or 1"):
        DB.material({"like": "C45", "sn_in_rolling": 0.5})


def test_the_ends_at_a_failure_probability_are_the_outer_ones_of_both_scatters():
    """Each line has the typical scatter of its own material; the outer ends count."""
    ds = solved(failure_probability=0.05).sel(body="roller")
    ends = {
        end: ds[f"life_hours_by_limit_{end}"].sel(limit=["fatigue", "pressure_line"]).values for end in ("low", "high")
    }
    assert ds.life_to_first_limit_hours_low == ends["low"].min()
    assert ds.life_to_first_limit_hours_high == ends["high"].max()


def test_a_spectrum_adds_up_each_line_by_itself():
    """Damage sums of both lines by hand; no block mixes them."""
    blocks = [
        {"name": "light", "distance": 900, "radial_force": -60},
        {"name": "heavy", "distance": 100, "radial_force": -300},
    ]
    base = {"motor_force": 0, "axial_force": 0, "friction_coefficient": 0.2}
    given = {"blocks": blocks, "base": base, "contact_model": "sliding", "limits": ["fatigue", "pressure_line"]}
    ds = solve_spectrum(Spectrum.from_dict(given))
    own: dict[tuple[str, str], float] = {}
    for block in blocks:
        case = base | {"radial_force": block["radial_force"]}
        one = tr.solve(case, OUTPUTS, contact_model="sliding").sel(body="roller")
        for name in ("fatigue", "pressure_line"):
            for end in ("low", "high"):
                life = float(one[f"life_hours_by_limit_{end}"].sel(limit=name))
                own[name, end] = own.get((name, end), 0.0) + block["distance"] / 1000 / life
    low = min(1 / own[name, "low"] for name in ("fatigue", "pressure_line"))
    high = max(1 / own[name, "high"] for name in ("fatigue", "pressure_line"))
    assert float(ds.life_to_first_limit_hours_low.sel(body="roller")) == pytest.approx(low, rel=1e-6)
    assert float(ds.life_to_first_limit_hours_high.sel(body="roller")) == pytest.approx(high, rel=1e-6)


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
