"""Fits of coupons: the material that is made, its file, and every bad table in one sentence."""

from __future__ import annotations

import math
from importlib.resources import files

import numpy as np
import pytest
import xarray as xr

import trackroller as tr
from trackroller.damage.sn_curve import SNCurve
from trackroller.materials import load_database
from trackroller.materials.file import posterior_path

HEAD = "amplitude [MPa],cycles,failed\n"
GOOD = "900,90000,yes\n900,130000,yes\n800,200000,yes\n800,350000,yes\n700,800000,yes\n700,1000000,yes\n"
UNDER = {"load_type": "axial", "stress_ratio": -1}


def table(tmp_path, text, head=HEAD):
    path = tmp_path / "tests.csv"
    path.write_text(head + text)
    return path


def drawn(n=40, seed=3):
    """Return coupons with a random fatigue limit, as a mapping of columns."""
    rng = np.random.default_rng(seed)
    stress = np.repeat(np.linspace(320, 460, 5), n // 5)
    limit = 340 * np.exp(0.06 * rng.normal(size=n))
    cycles = 5e5 * (stress / 340) ** -7.0 * np.exp(0.5 * rng.normal(size=n))
    fails = (stress > limit) & (cycles < 1e7)
    return {"amplitude": stress, "cycles": np.where(fails, np.round(cycles), 1e7), "failed": fails}


def test_the_material_holds_the_line(tmp_path):
    fit = tr.fit_sn(table(tmp_path, GOOD), name="rail", like="1.7225-normalised", **UNDER)
    material = load_database().material(fit.material, "roller_material")
    for amplitude in (900.0, 750.0):
        expected = fit.estimate("cycles", amplitude=amplitude)
        assert float(SNCurve.of(material).life_cycles(amplitude)) == pytest.approx(expected, rel=1e-6)


def test_the_scatter_of_the_material_is_that_of_the_line(tmp_path):
    fit = tr.fit_sn(table(tmp_path, GOOD), name="rail", like="1.7225-normalised", **UNDER)
    curve = SNCurve.of(load_database().material(fit.material, "roller_material")).changed(failure_probability=0.1)
    expected = fit.estimate("cycles", amplitude=800.0, failure_probability=0.1)
    assert float(curve.life_cycles(800.0)) == pytest.approx(expected, rel=1e-6)


def test_gigapascals_are_converted(tmp_path):
    text = GOOD.replace("900,", "0.9,").replace("800,", "0.8,").replace("700,", "0.7,")
    one = tr.fit_sn(table(tmp_path, text, "amplitude [GPa],cycles,failed\n"), **UNDER)
    two = tr.fit_sn(table(tmp_path, GOOD), **UNDER)
    assert one.material["fatigue_limit"] == pytest.approx(two.material["fatigue_limit"], rel=1e-6)


def test_torsion_enters_as_von_mises_stress(tmp_path):
    axial, torsion = (
        tr.fit_sn(table(tmp_path, GOOD), load_type=kind, stress_ratio=-1).material for kind in ("axial", "torsion")
    )
    assert torsion["fatigue_limit"] == pytest.approx(math.sqrt(3) * axial["fatigue_limit"], rel=1e-6)


def test_run_outs_give_a_fatigue_limit_with_its_scatter():
    fit = tr.fit_sn(drawn(200), **UNDER)
    low, high = fit.interval("fatigue_strength")
    assert low < 340 < high
    assert fit.material["scatter_in_stress"] == pytest.approx(math.exp(2.563 * 0.06), rel=0.1)
    low, high = fit.interval("slope")
    assert low < 7 < high


def test_a_held_slope_is_the_slope_of_the_material(tmp_path):
    fit = tr.fit_sn(table(tmp_path, GOOD), slope=8, **UNDER)
    assert fit.material["woehler_exponent"] == 8
    assert "woehler_exponent" not in fit.data["value"].values


def test_one_group_of_several_is_fitted(tmp_path):
    text = "".join(f"{line},A\n{line.replace('0000', '1000')},B\n" for line in GOOD.split())
    path = table(tmp_path, text, "amplitude,cycles,failed,group\n")
    assert len(tr.fit_sn(path, group="A", **UNDER).tests) == 6
    with pytest.raises(tr.InputError, match=r"line 3: group = 'B' .*mixes 'A' and 'B'.*--group"):
        tr.fit_sn(path, **UNDER)


def test_the_file_holds_material_and_posterior(tmp_path):
    fit = tr.fit_sn(table(tmp_path, GOOD), name="Hardened rail", like="1.7225-normalised", **UNDER)
    file = tmp_path / "materials.yaml"
    material = fit.write(file)
    assert material.woehler_exponent == pytest.approx(fit.material["woehler_exponent"], rel=1e-6)
    assert fit.tests.digest[:16] in file.read_text()
    with xr.open_dataset(posterior_path(file, "Hardened rail")) as stored:
        assert float(stored["fatigue_weight"].sum()) == pytest.approx(1.0)
        assert stored.attrs["sha256"] == fit.tests.digest


def test_few_failures_give_a_wide_interval_and_no_refusal(tmp_path):
    text = "900,90000,yes\n900,130000,yes\n800,350000,yes\n800,400000,no\n"
    low, high = tr.fit_sn(table(tmp_path, text), **UNDER).interval("cycles", amplitude=700, failure_probability=0.1)
    assert high / low > 100


def test_all_run_outs_give_a_bound_with_held_values(tmp_path):
    path = table(tmp_path, GOOD.replace("yes", "no"))
    fit = tr.fit_sn(path, slope=8, scatter_in_cycles=5, **UNDER)
    low, high = fit.interval("cycles", amplitude=800)
    assert low > 0
    assert high == math.inf
    assert "fatigue_limit" not in fit.material


@pytest.mark.parametrize("more", [{"slope": 0.09}, {"slope": -0.09}, {"prior": {"slope": (0.09, 0.01)}}])
def test_basquins_exponent_is_no_slope(tmp_path, more):
    with pytest.raises(tr.InputError, match=r"slope = -?0\.09 .*at least 1.*k = 1/b: write 11\.1"):
        tr.fit_sn(table(tmp_path, GOOD), **more, **UNDER)


@pytest.mark.parametrize(
    ("text", "head", "message"),
    [
        (
            GOOD.replace("800,", "900,").replace("700,", "900,"),
            HEAD,
            r"line 7: amplitude = '900 MPa'.*second level.*--slope",
        ),
        (
            GOOD.replace("yes", "no"),
            HEAD,
            r"line 7: failed = 'no'.*all specimens ran out.*Hold the slope",
        ),
        (GOOD, "amplitude [MPa],cycles [km],failed\n", r"line 1: cycles = 'km'"),
        (GOOD.replace("90000,", "38.25,"), HEAD, r"line 2: cycles = '38.25'.*whole number.*fit bench"),
        (GOOD.replace("0000,", ","), HEAD, r"cycles.*at least 1000 cycles in one row.*travel in km"),
        (GOOD.replace("1000000,yes", "inf,no"), HEAD, r"line 7: cycles = 'inf'.*finite.*was stopped"),
        (
            GOOD.replace("900,9", "inf,9"),
            HEAD,
            r"line 2: amplitude = 'inf MPa'.*a finite number from 0\.001 to",
        ),
        (GOOD + "700,1000000,yes\n", HEAD, r"line 8: cycles = '1000000' stands in row 7 as well"),
        (GOOD, "amplitde [MPa],cycles,failed\n", r"amplitde.*is not known.*'amplitude'"),
        (GOOD, "amplitude [MPa],cycles,outcome_code\n", r"outcome_code.*is not known.*amplitude, cycles, failed"),
        (GOOD.replace("yes", "maybe", 1), HEAD, r"line 2: failed = 'maybe'.*yes or no"),
        (GOOD.replace("900,9", "-900,9"), HEAD, r"line 2: amplitude = '-900 MPa'.*from 0.001 to 100000 MPa"),
        (
            "700,90000,yes\n700,130000,yes\n800,200000,yes\n800,350000,yes\n900,800000,yes\n900,1000000,yes\n",
            HEAD,
            r"line 7: cycles.*lives that fall with the stress.*negative slope",
        ),
        ("900,90000,yes\n800,200000,yes\n700,900000,yes\n", HEAD, r"tests = 3 .*more rows than fitted values"),
    ],
)
def test_a_bad_table_is_told_in_one_sentence_with_its_place(tmp_path, text, head, message):
    with pytest.raises(tr.InputError, match=message):
        tr.fit_sn(table(tmp_path, text, head), **UNDER)


@pytest.mark.parametrize(
    ("held", "message"),
    [
        ({"slope": -4}, "slope = -4 .*from 1 to 60"),
        ({"scatter_in_cycles": 0.5}, "scatter = 0.5 .*Give T_N"),
    ],
)
def test_a_held_value_outside_its_bounds_is_refused(tmp_path, held, message):
    with pytest.raises(tr.InputError, match=message):
        tr.fit_sn(table(tmp_path, GOOD), **UNDER, **held)


def test_a_material_without_like_and_a_name_that_shares_a_file_are_refused(tmp_path):
    file = tmp_path / "materials.yaml"
    with pytest.raises(tr.InputError, match=r"like is missing.*--like"):
        tr.fit_sn(table(tmp_path, GOOD), name="rail", **UNDER).write(file)
    like = UNDER | {"like": "1.7225-normalised"}
    tr.fit_sn(table(tmp_path, GOOD), name="rail", **like).write(file)
    with pytest.raises(tr.InputError, match=r"name = 'Rail' has its posterior in rail.nc"):
        tr.fit_sn(table(tmp_path, GOOD), name="Rail", **like).write(file)


@pytest.mark.slow
def test_the_prior_stands_beside_the_posterior(tmp_path):
    fit = tr.fit_sn(table(tmp_path, GOOD), prior={"slope": [6, 0.2]}, **UNDER)
    low, _, high = fit.groups[0].band("woehler_exponent")
    assert 5.6 < low < high < 6.6
    fit.report(tmp_path / "fit.html")
    assert "6 ± 0.2" in (tmp_path / "fit.html").read_text()


@pytest.mark.slow
def test_below_a_fatigue_limit_the_interval_reaches_from_finite_lives_to_none(tmp_path):
    """The posterior tells which ends are finite: both hold lines whose limit lies below the stress, and above it."""
    fit = tr.fit_sn(files("trackroller.fit.examples") / "coupons-synthetic.csv", **UNDER)
    own = fit.groups[0]
    assert own.line.knee
    for stress in (430.0, 380.0, 365.0, 355.0, 345.0):
        low, high = fit.interval("cycles", amplitude=stress)
        lives = own.line.log_life(own.posterior.values, math.log(stress), 0.5)
        below, above = np.exp(own.posterior.quantile(lives, np.array([0.05, 0.95])))
        assert low == pytest.approx(below, rel=0.2)
        assert math.isinf(high) == math.isinf(above)
        assert math.isinf(high) or high == pytest.approx(above, rel=0.2)
