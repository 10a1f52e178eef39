"""The expected cost of a study counts friction laws; `validation.tradeoff` measures it."""

from __future__ import annotations

import pytest

from trackroller.numerics.numbers import rounded_up
from trackroller.parameters.contact_models import DECLARED, LEVELS, measured_costs
from trackroller.roller.measured_errors import errors_of_rung
from trackroller.study.cost import SHARED, START, duration, megabytes_of_report, rate, seconds_on, study_rate
from trackroller.study.file.load import parse_study
from trackroller.study.status import plan_rows, status_of
from trackroller.study.store.ledger import study_folder

MEASURED_PEAKS = {9_600: 435, 96_000: 895, 998_400: 4040}
FALLING = {"kind": "exponential", "speed": 200.0, "lowest": 0.4}


@pytest.mark.parametrize("contact_model", ["sliding", "kalker"])
def test_a_falling_law_costs_more_than_a_constant_one(contact_model):
    options = {"contact_model": contact_model, "outputs": ("forces",)}
    assert rate(options, FALLING) < 0.5 * rate(options)
    assert rate(options, {"kind": "constant"}) == rate(options, "") == rate(options)


def test_a_study_takes_the_time_of_each_friction_law():
    """A law for all cases, and a law as a factor beside constant friction."""
    study = {"name": "laws", "factors": {"axial_force": {"values": [0, 30]}}}
    options = parse_study(study).options
    slow, quick = rate(options, FALLING), rate(options)
    assert study_rate(parse_study(study)) == pytest.approx(quick)
    assert study_rate(parse_study(study | {"base": {"friction_law": FALLING}})) == pytest.approx(slow)
    both = study | {"factors": {"friction_law": {"values": [{"kind": "constant"}, FALLING]}}}
    assert study_rate(parse_study(both)) == pytest.approx(2 / (1 / slow + 1 / quick))


def test_films_and_heat_cost_what_was_measured():
    """A film takes its own cost; heat counts where a case gives its fields, and only if it is checked."""
    complete = {"outputs": ("forces", "contact", "peak_stress", "life")}
    cost = DECLARED["kalker"].film
    assert rate(complete, fields={"layer_flexibility"}) == pytest.approx(1.0 / sum(cost.at("standard")))
    limits = {"outputs": (*complete["outputs"], "limits")}
    heated = {"heat_transfer_coefficient", "cooled_area"}
    spent = [
        1.0 / rate(limits | {"not_checked": not_checked}, fields=fields)
        for not_checked, fields in (((), ()), ((), heated), (("heat",), heated), (("shakedown",), ()))
    ]
    assert spent[0] < spent[1] and spent[2] == spent[0] and spent[3] == 1.0 / rate(complete)


def test_a_study_takes_the_time_of_its_films():
    study = {"name": "films", "factors": {"axial_force": {"values": [0, 30]}}}
    options = parse_study(study).options
    quick, slow = rate(options), rate(options, fields={"layer_flexibility"})
    assert study_rate(parse_study(study | {"base": {"layer_flexibility": 1e-5}})) == pytest.approx(slow)
    both = study | {"factors": {"layer_flexibility": {"values": [0, 1e-5]}}}
    assert study_rate(parse_study(both)) == pytest.approx(2 / (1 / slow + 1 / quick))


def test_threads_share_a_part_of_the_work():
    assert seconds_on(1, 10.0) == 10.0
    assert seconds_on(2, 10.0) == pytest.approx(10.0 * (1 - SHARED / 2))
    assert seconds_on(10**9, 10.0) == pytest.approx(10.0 * (1 - SHARED))


def test_a_plan_states_time_and_error_of_each_rung(tmp_path, monkeypatch):
    """They are the measured ones: those of 95 % of the designs, and the rates of the same study on other rungs."""
    monkeypatch.setenv("NUMBA_NUM_THREADS", "2")
    study = parse_study({"name": "rungs", "factors": {"friction_coefficient": {"linspace": [0.05, 0.3, 2000]}}})
    rows = plan_rows(study, status_of(study, study_folder("rungs", tmp_path)))
    told = [text for name, text in rows if name == "accuracy"]
    for rung, text in zip(LEVELS, told, strict=True):
        time = duration(2000 / study_rate(study, rung) + START)
        error = 100 * rounded_up(errors_of_rung("kalker", rung)["peak_stress"].p95)
        assert text.startswith(f"{rung}: {time} on one core") and f"peak stress {error:.2g} %" in text
        assert (", this study" in text) == (rung == "standard")
    seconds = 2000 / study_rate(study) + START
    whole = dict(rows)["time"]
    assert f"{duration(seconds_on(2, seconds))} by trackroller run with 2 threads" in whole
    assert f"{duration(seconds / 2)} by snakemake --cores 2" in whole and "tolerance" not in dict(rows)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({}, []),
        (
            {"base": {"layer_flexibility": 1e-5}},
            ["for 3 of 3 cases with a film (layer_flexibility): those above are of"],
        ),
        ({"base": {"friction_law": FALLING}}, ["with friction that falls with the slip speed"]),
        ({"normal": "halfspace"}, ["with normal: halfspace"]),
        ({"contact_model": "kalker", "slip_terms": ["profile", "curve"]}, ["with slip_terms: profile, curve"]),
        (
            {"factors": {"friction_coefficient": {"values": [0.4, 0.41, 0.6]}}},
            ["for 2 of 3 cases with friction above 0.4: those above are of friction up to 0.4 without a film"],
        ),
        (
            {"factors": {"contact_model": {"values": ["sliding", "kalker"]}, "axial_force": {"values": [0, 30]}}},
            ["for studies that vary contact_model"],
        ),
    ],
)
def test_a_plan_says_for_which_cases_no_errors_were_measured(given, expected, tmp_path):
    study = parse_study({"name": "surfaces", "factors": {"axial_force": {"values": [0, 10, 30]}}} | given)
    rows = plan_rows(study, status_of(study, study_folder("surfaces", tmp_path)))
    told = [text.removeprefix("not measured ") for name, text in rows if text.startswith("not measured ")]
    assert len(told) == len(expected) and all(map(str.startswith, told, expected))
    shown = any("peak stress" in text for name, text in rows if name == "accuracy")
    assert shown == (not expected or "those above" in expected[0])


def test_a_plan_says_which_designs_miss_a_tolerance(tmp_path):
    study = parse_study({"name": "fine", "accuracy": 0.01, "factors": {"axial_force": {"values": [0, 30]}}})
    text = dict(plan_rows(study, status_of(study, study_folder("fine", tmp_path))))["tolerance"]
    missed = measured_costs()["missed"]["0.01"]
    assert f"at 0.01, {missed:.0%} of designs" in text and missed > 0.1
    assert text.startswith(f"takes {study_rate(study, 'standard') / study_rate(study):.2g} times standard")


def test_the_memory_of_a_report_covers_the_measured_peaks():
    """Peaks [MB] of a grid with every limit; the docs show them, and a cluster ends a job above its memory."""
    outputs = ("forces", "contact", "peak_stress", "life", "limits")
    for cases, peak in MEASURED_PEAKS.items():
        assert peak < megabytes_of_report(outputs, cases) < 3 * peak
