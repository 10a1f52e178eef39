"""Lives stand in years beside hours where the duty of the roller is known."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import openpyxl
import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.app.picture import texts
from trackroller.report.explorer.rows import collect, solve_inputs
from trackroller.report.numbers import hour_unit, lasting, on_duty, quantity, rounded
from trackroller.roller.duty import checked_duty, duty_of, years
from trackroller.study.repeat import Repeat

DUTY = {"hours_per_day": 8, "days_per_year": 220}


def test_a_year_of_travel_at_all_hours_is_a_year():
    assert years(24 * 365, checked_duty({"hours_per_day": 24, "days_per_year": "365"})) == 1.0
    assert checked_duty({"hours_per_day": 16}) == {"hours_per_day": 16.0, "days_per_year": 365.0}
    assert years(4400, checked_duty(DUTY)) == 2.5


def test_hours_have_their_years_only_where_a_duty_is_known():
    assert lasting(3520, "h") == "3520 h" == quantity(3520, "h")
    with on_duty(checked_duty(DUTY)):
        assert lasting(3520, "h") == "3520 h (2 years)" == quantity(3520, "h")
        assert lasting(3520, "km") == "3520 km" and hour_unit(math.inf) == "h" == hour_unit(math.nan)
    assert hour_unit(3520) == "h"


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ({"hours_per_day": 25, "days_per_year": 200}, "duty.hours_per_day = 25"),
        ({"days_per_year": 16}, "duty.hours_per_day is missing"),
        ({"hours_per_day": 16, "days_per_yaer": 3}, "days_per_year"),
        (16, "duty = 16"),
    ],
)
def test_a_wrong_duty_is_refused_by_name(value, words):
    for refused in (lambda: checked_duty(value), lambda: tr.load_study({"name": "d", "duty": value})):
        with pytest.raises(tr.InputError, match=words):
            refused()


@pytest.mark.slow
def test_solve_and_plan_take_the_duty(tmp_path):
    (tmp_path / "case.yaml").write_text("duty: {hours_per_day: 8, days_per_year: 220}\ncontact_model: sliding\n")
    told = trackroller("solve", "case.yaml", "--set", "accuracy=preview", cwd=tmp_path).stdout
    life = told.partition(", then fatigue of the roller")[0]
    assert life.partition(" (")[0].endswith(" h") and "year" not in life  # it lasts less than one
    study = tr.load_study({"name": "d", "duty": DUTY, "outputs": ["forces", "life"]})
    assert tr.load_study(study.as_dict()).config.duty == {"hours_per_day": 8.0, "days_per_year": 220.0}


def test_the_workbook_of_one_roller_has_inputs_results_and_limits(tmp_path):
    (tmp_path / "case.yaml").write_text("duty: {hours_per_day: 8, days_per_year: 220}\naxial_force: 40\n")
    words = ("--set", "contact_model=sliding", "--set", "accuracy=preview")
    assert trackroller("solve", "case.yaml", *words, "-o", "roller.xlsx", cwd=tmp_path).stdout == ""
    book = openpyxl.load_workbook(tmp_path / "roller.xlsx")
    inputs, results, limits = (list(book[name].values) for name in ("inputs", "results", "limits"))
    further = ["headline", "columns", "contacts", "whole", "lives", "placeholders", "warnings"]
    assert book.sheetnames == ["inputs", "results", "limits", *further]
    assert all(sheet.freeze_panes == "A2" for sheet in book)
    assert ("axial_force", "axial force", 40, "N", "given") in inputs
    assert ("radial_force", "radial force", -200, "N", "example") in inputs
    ds = tr.solve(tr.Case(axial_force=40), contact_model="sliding", accuracy="preview")
    found = {name: (value, unit) for name, _, value, unit in results}
    assert found["normal_force_2"] == (float(ds.normal_force.sel(contact=2)), "N")
    hours = next(dict(zip(limits[0], row, strict=True)) for row in limits if row[:2] == ("fatigue", "roller"))
    assert hours["hours"] == pytest.approx(float(ds.roller_life_hours)) and hours["state"] == "finite"
    assert hours["years_low"] == pytest.approx(hours["low"] / 1760)


SPECTRUM = """\
base: {friction_coefficient: 0.2, guide_overrollings_per_hour: 120, velocity: 0.25}
blocks: [{distance: 9 km, radial_force: -200, motor_force: 0}, {distance: 2 km, radial_force: -150}]
contact_model: sliding
"""


@pytest.mark.slow
def test_a_spectrum_has_years_doubts_and_what_was_not_given_everywhere(tmp_path):
    (tmp_path / "a.yaml").write_text(SPECTRUM.replace("velocity: 0.25", "velocity: 25"))
    plain = trackroller("spectrum", "a.yaml", cwd=tmp_path)
    assert "years" not in plain.stdout and "doubtful" not in plain.stderr
    assert "motor force −30 N" in plain.stdout
    assert "radial force" not in plain.stdout.split("Not given")[1], "each block names its own"
    (tmp_path / "b.yaml").write_text(SPECTRUM + "duty: {hours_per_day: 8, days_per_year: 220}\n")
    told = trackroller("spectrum", "b.yaml", "--report", "b.html", cwd=tmp_path)
    found = json.loads(trackroller("spectrum", "b.yaml", "--json", cwd=tmp_path).stdout)
    life = found["roller_life_hours"]
    assert life["years"] == pytest.approx(life["value"] / 1760)
    page = (tmp_path / "b.html").read_text(encoding="utf-8")
    longest = found["pair_life_to_first_limit_hours_high"]
    assert longest["years"] == pytest.approx(longest["value"] / 1760)
    for text in (told.stdout, page):
        assert f"(up to {rounded(longest['years'], 2)} years" in " ".join(text.split())
        assert "motor force −30 N" in " ".join(text.split())
    (doubt,) = found["doubts"]
    assert "write '0.25 m/s' or 15" in doubt and doubt in told.stderr and doubt.replace("'", "&#39;") in page


@pytest.mark.slow
def test_a_sheet_and_json_ask_about_doubtful_values(tmp_path):
    words = ["solve", "--set", "contact_model=sliding", "--set", "accuracy=preview", "--set", "velocity=0.25"]
    told = trackroller(*words, "--json", cwd=tmp_path)
    (doubt,) = json.loads(told.stdout)["doubts"]
    assert doubt in told.stderr and "write '0.25 m/s' or 15" in doubt
    ds = tr.solve({"velocity": 0.25}, contact_model="sliding", accuracy="preview")
    page = tr.report(ds, tmp_path / "a.html").read_text(encoding="utf-8")
    assert "Doubtful" in page and doubt.replace("'", "&#39;") in page
    usual = tr.solve({"velocity": 25, "motor_force": 0}, contact_model="sliding", accuracy="preview")
    assert "Doubtful" not in tr.report(usual, tmp_path / "b.html").read_text(encoding="utf-8")


def test_lives_of_a_case_have_years_in_json(tmp_path):
    words = ["--set", "contact_model=sliding", "--set", "duty={hours_per_day: 8, days_per_year: 220}", "--json"]
    found = json.loads(trackroller("solve", *words, cwd=tmp_path).stdout)
    assert found["roller_life_hours"]["years"] == pytest.approx(found["roller_life_hours"]["value"] / 1760)
    assert np.array(found["life_hours"]["years"], dtype=float).shape == (2, 2)
    assert "years" not in found["life_cycles"]


@pytest.mark.slow
def test_a_study_has_years_in_tables_axes_explorer_and_cells(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = "{name: d, base: {motor_force: 0, friction_coefficient: 0.1}, outputs: [peak_stress, life], "
    text += "contact_model: sliding, factors: {roller_profile_radius: {values: [-6.4, -7]}}%s}"
    Path("d.yaml").write_text(text % ", duty: {hours_per_day: 8, days_per_year: 220}")
    Path("e.yaml").write_text((text % "").replace("name: d", "name: e"))
    solved = tr.run("d.yaml", progress=False)
    table = solved.to_table()
    for body in ("roller", "pair"):
        assert table[f"{body}_life_years"].tolist() == pytest.approx((table[f"{body}_life_hours"] / 1760).tolist())
    columns = {c.name: c for c in collect(solved)}
    years_ = columns["roller_life_hours:years"]
    assert (years_.label, years_.unit) == (columns["roller_life_hours"].label, "years")
    assert years_.values.tolist() == pytest.approx((columns["roller_life_hours"].values / 1760).tolist())
    page = solved.report("d.html").read_text(encoding="utf-8")
    assert "1,760 h are 1 year" in page
    plain = tr.run("e.yaml", progress=False)
    assert "are 1 year" not in plain.report("e.html").read_text(encoding="utf-8")
    assert not any("years" in name for name in (*plain.to_table(), *(c.name for c in collect(plain))))


def test_a_duty_among_the_values_of_the_roller_is_sent_to_its_place():
    with pytest.raises(tr.InputError, match=r"base\.duty = .* Write duty: .* on a line of its own"):
        tr.load_study({"name": "d", "base": {"duty": DUTY}, "factors": {"axial_force": {"values": [0, 30]}}})


def test_the_duty_travels_with_each_command_that_repeats_a_case():
    """`trackroller repeat`, the explorer's command and the lines of Python of the page hold the duty."""
    duty = {"hours_per_day": 16.0, "days_per_year": 250.0}
    assert "--set 'duty={" in Repeat({"axial_force": 3.0}, {}, {}, duty).command()
    assert "duty" not in Repeat({"axial_force": 3.0}, {}, {}).command()
    study = {
        "name": "d", "base": {"motor_force": 0}, "factors": {"axial_force": {"values": [0, 9]}}, "duty": duty,
        "contact_model": "sliding", "accuracy": "preview", "outputs": ["forces", "life"],
    }  # fmt: skip
    assert json.loads(dict(solve_inputs(tr.run(study, progress=False), {})[0])["duty"]) == duty
    told: dict = {}
    lines = texts({"motor_force": 0, "contact_model": "sliding", "accuracy": "preview", "duty": duty})["Python"]
    exec(lines, told)
    assert duty_of(told["ds"]) == duty
