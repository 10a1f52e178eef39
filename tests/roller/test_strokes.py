"""A duty in strokes: hours, travel and overrollings of the guide by hand arithmetic, wherever a duty is taken."""

from __future__ import annotations

import html
import json
import re

import numpy as np
import openpyxl
import pytest
from carriage.carts import ROLLER, SIDES
from command_line import trackroller

import trackroller as tr
from trackroller.app.picture import texts
from trackroller.carriage.file import load_carriage
from trackroller.carriage.files import spectrum_of, study_of
from trackroller.carriage.solve import cases_of, forces_of
from trackroller.carriage.strokes import passes_per_km
from trackroller.errors import InputError
from trackroller.roller.duty import checked_duty, in_hours
from trackroller.roller.settings import checked_case
from trackroller.study.spectrum.file import Spectrum, overrollings_per_shift
from trackroller.yaml_file import parse_mapping, write_yaml

# 400 strokes of 0.9 m are 360 m a day, which take 0.1 h at 60 m/min
DUTY = {"strokes_per_day": 400, "stroke": "0.9 m", "days_per_year": 300}
PER_HOUR = 4000.0  # strokes in an hour of travel: 400 in 0.1 h; each roller passes a point once in each of them


def cart(stroke="0.9 m", speeds=("1 m/s",), places=SIDES, **more):
    down = {"pushes": [0, 0, -1], "x_R": [0, 1, 0], "roller": ROLLER}
    rollers = {name: {"at": [*at, 0], **down} for name, at in places.items()}
    cases = [{"name": f"run {i}", "speed": speed} for i, speed in enumerate(speeds)]
    duty = DUTY | {"stroke": stroke}
    return {"mass": {"value": 40, "at": [0, 0, 60]}, "rollers": rollers, "cases": cases, "duty": duty} | more


@pytest.mark.parametrize(("rollers", "passes"), [({}, 1), ({"rollers_on_rail": 3}, 3)])
def test_a_case(rollers, passes):
    case, _, beside = checked_case({"velocity": "1 m/s", "duty": DUTY | rollers})
    assert beside["duty"] == pytest.approx({"hours_per_day": 0.1, "days_per_year": 300}, rel=1e-12)
    assert case.guide_overrollings_per_hour == pytest.approx(passes * PER_HOUR, rel=1e-12)
    again = checked_case({"velocity": 60, "duty": beside["duty"], "guide_overrollings_per_hour": passes * PER_HOUR})
    assert again[0].guide_overrollings_per_hour == pytest.approx(case.guide_overrollings_per_hour, rel=1e-12)


def test_years_of_the_guide_do_not_depend_on_the_velocity():
    """N overrollings of a point that is passed 400 times a day last N/400 days, whatever the velocity is."""
    years = []
    for velocity in (30, 60):
        case, options, beside = checked_case({**ROLLER, "velocity": velocity, "duty": DUTY, "radial_force": -900})
        ds = tr.solve(case, ("forces", "life"), **options)
        cycles = float(ds.life_cycles.sel(body="guide").min())
        assert np.isfinite(cycles)
        years.append(float(ds.guide_life_hours) / (beside["duty"]["hours_per_day"] * 300))
        assert years[-1] == pytest.approx(cycles / 400 / 300, rel=1e-9)
    assert years[0] == pytest.approx(years[1], rel=1e-9)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"hours_per_day": 8}, "stands beside strokes"),
        ({"stroke": None}, "stroke is missing"),
        ({"strokes_per_day": None}, "strokes_per_day is missing"),
        ({"stroke": 0}, "duty.stroke = 0"),
        ({"stroke": "0.8 s"}, "duty.stroke = 's'"),
        ({"rollers_on_rail": 1.5}, "a whole number"),
        ({"rollers_on_rail": 0}, "rollers_on_rail = 0"),
        ({"strokes_per_day": 1e6}, "at most 96,000 strokes, which take 24 hours"),
    ],
)
def test_wrong_strokes_are_refused(values, words):
    duty = {key: value for key, value in (DUTY | values).items() if value is not None}
    with pytest.raises(InputError, match=words):
        checked_case({"velocity": 60, "duty": duty})


def test_what_the_message_allows_is_taken():
    assert in_hours(checked_duty(DUTY | {"strokes_per_day": 96_000}), 1 / 3.6)["hours_per_day"] == pytest.approx(24)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"velocity": 60, "guide_overrollings_per_hour": 60}, "stands beside the strokes of the duty, which give it"),
        ({}, "velocity is missing"),
    ],
)
def test_values_that_strokes_contradict_or_need(values, words):
    with pytest.raises(InputError, match=words):
        checked_case({**values, "duty": DUTY})
    with pytest.raises(InputError, match=words):
        tr.load_study({"name": "s", "base": values, "factors": {"axial_force": {"values": [0, 9]}}, "duty": DUTY})
    with pytest.raises(InputError, match=words):
        Spectrum.from_dict({"base": values, "blocks": [{"distance": 900, "radial_force": -200}], "duty": DUTY})


def test_a_spectrum():
    """Half of the travel at 1 m/s, half at 0.5 m/s: 360 m take 180 s + 360 s, 0.15 h."""
    blocks = [{"distance": 1800, "velocity": v, "radial_force": -200} for v in (60, 30)]
    spectrum = Spectrum.from_dict({"blocks": blocks, "duty": DUTY | {"rollers_on_rail": 2}})
    assert spectrum.duty == pytest.approx({"hours_per_day": 0.15, "days_per_year": 300}, rel=1e-12)
    assert overrollings_per_shift(spectrum)[:, 1] == pytest.approx([4000, 4000], rel=1e-12)  # 2000 strokes, 2 rollers


def test_a_study():
    study = {"name": "s", "base": {"velocity": 60}, "duty": DUTY, "outputs": ["forces", "life"]}
    loaded = tr.load_study(study | {"factors": {"axial_force": {"values": [0, 9]}}})
    assert loaded.config.duty == pytest.approx({"hours_per_day": 0.1, "days_per_year": 300}, rel=1e-12)
    assert loaded.design().guide_overrollings_per_hour.values == pytest.approx([PER_HOUR] * 2, rel=1e-12)
    again = tr.load_study(loaded.as_dict())
    assert again.config.duty == loaded.config.duty
    with pytest.raises(InputError, match="varies beside the strokes"):
        tr.load_study(study | {"factors": {"velocity": {"values": [60, 70]}}})


@pytest.mark.parametrize(("stroke", "count"), [("200 mm", 1), ("300 mm", 2), ("0.9 m", 2)])
def test_rollers_of_one_rail_pass_a_point_of_the_middle(stroke, count):
    """Two rollers of a rail are 300 mm apart: both pass a point if the stroke is as long."""
    passes = passes_per_km(load_carriage(cart(stroke)))
    metres = {"200 mm": 0.2, "300 mm": 0.3, "0.9 m": 0.9}[stroke]
    assert passes == pytest.approx([count * 1000 / metres] * 4, rel=1e-12)


def test_three_rollers_of_a_rail_of_which_two_lie_within_a_stroke():
    places = {"A": (0, 40), "B": (100, 40), "C": (400, 40), "D": (0, -40), "E": (400, -40)}
    counts = passes_per_km(load_carriage(cart("0.2 m", places=places, mass={"value": 9, "at": [150, 0, 0]}))) * 0.2e-3
    assert counts == pytest.approx([2, 2, 2, 1, 1], rel=1e-12)


def test_a_carriage():
    """Half of the travel at 1 m/s, half at 0.5 m/s, as in the spectrum; two rollers on each rail."""
    whole = load_carriage(cart(speeds=("1 m/s", "0.5 m/s")))
    assert whole.duty == pytest.approx({"hours_per_day": 0.15, "days_per_year": 300}, rel=1e-12)
    ds = forces_of(whole)
    rates = {i: case.guide_overrollings_per_hour for (i, _), case in cases_of(whole, ds).items()}
    assert rates == pytest.approx({0: 2 * PER_HOUR, 1: 2 * PER_HOUR / 2}, rel=1e-12)  # half as many strokes an hour
    spectrum = Spectrum.from_dict(spectrum_of(whole, ds, "FL"))
    assert spectrum.duty == pytest.approx(whole.duty, rel=1e-12)
    assert overrollings_per_shift(spectrum)[:, 1] == pytest.approx([2 * 500 / 0.9] * 2, rel=1e-9)


def test_the_study_of_a_carriage_has_its_overrollings(tmp_path):
    whole = load_carriage(cart(speeds=("1 m/s", "0.5 m/s")))
    study, rows = study_of(whole, forces_of(whole), "s.csv")
    (tmp_path / "s.csv").write_text(rows)
    (tmp_path / "s.yaml").write_text(write_yaml(study))
    design = tr.load_study(tmp_path / "s.yaml").design()
    assert design.guide_overrollings_per_hour.values == pytest.approx(PER_HOUR / 30 * design.velocity.values, rel=1e-9)


def test_a_study_on_a_carriage_counts_the_rollers_of_each_design():
    """A stroke of 0.35 m: both rollers of a rail pass a point at a wheelbase of 300 mm, one of them at 400 mm."""
    keys = {"name": "s", "carriage": cart("0.35 m"), "outputs": ["forces", "life"], "contact_model": "sliding"}
    loaded = tr.load_study(keys | {"factors": {"carriage_wheelbase": {"values": [300, 400]}}})
    strokes = 3600 / 0.35  # of an hour at 1 m/s
    design = loaded.design()
    per_row = dict(zip(design.design_row.values.tolist(), design.guide_overrollings_per_hour.values, strict=True))
    assert per_row == pytest.approx({0: 2 * strokes, 1: strokes}, rel=1e-12)
    with pytest.raises(InputError, match="varies beside strokes"):
        tr.load_study(keys | {"factors": {"carriage_speed": {"values": [1, 2]}}})


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"cases": [{"name": "run"}]}, "speed is missing"),
        ({"duty": DUTY | {"rollers_on_rail": 2}}, "follows from the places of its rollers"),
    ],
)
def test_a_carriage_that_strokes_do_not_fit_is_refused(change, words):
    with pytest.raises(InputError, match=words):
        load_carriage(cart(**change))


def test_overrollings_of_a_roller_beside_strokes_are_refused():
    values = cart()
    values["rollers"]["FL"]["roller"] = ROLLER | {"guide_overrollings_per_hour": 60}
    with pytest.raises(InputError, match=r"rollers\.FL\.roller\.guide_overrollings_per_hour = 60"):
        load_carriage(values)


# 400 strokes of 0.9 m: 0.36 km a day, 0.1 h at 1 m/s
WORDS = "400 strokes of 0.9 m a day, 300 days a year: 0.1 h and 0.36 km a day"
FAST = {"contact_model": "sliding", "accuracy": "preview"}


def seen(folder, *words):
    """Return what the terminal shows of a command with its tables unfolded, and the text of its page."""
    told = trackroller(*words, "--report", "page.html", cwd=folder).stdout
    page = html.unescape(re.sub(r"<[^>]+>", " ", (folder / "page.html").read_text()))
    return " ".join(re.sub("[\u2500-\u257f]", " ", told).split()), " ".join(page.split())


@pytest.mark.slow
@pytest.mark.parametrize("hours", [False, True])
def test_page_and_terminal_show_the_duty_as_it_was_given(tmp_path, monkeypatch, hours):
    monkeypatch.setenv("COLUMNS", "300")
    duty = {"hours_per_day": 0.1, "days_per_year": 300} if hours else DUTY
    words = "0.1 h a day, 300 days a year" if hours else WORDS
    base = {"velocity": 60, "motor_force": 0, "axial_force": 20}
    (tmp_path / "case.yaml").write_text(write_yaml(FAST | base | {"duty": duty}))
    blocks = [{"name": "a", "distance": 900, "radial_force": -200}]
    (tmp_path / "load.yaml").write_text(write_yaml(FAST | {"base": base, "blocks": blocks, "duty": duty}))
    (tmp_path / "cart.yaml").write_text(write_yaml(cart() | {"duty": duty}))
    for shown in seen(tmp_path, "solve", "case.yaml"):
        assert words in shown
        assert "overrollings of a guide point per hour n_G" not in shown, "nobody gave it"
    for command in (("spectrum", "load.yaml"), ("carriage", "cart.yaml")):
        for shown in seen(tmp_path, *command):
            assert (f"Duty: {WORDS}." in shown) is not hours


def test_the_record_and_the_workbook_keep_the_strokes(tmp_path):
    (tmp_path / "case.yaml").write_text(write_yaml(FAST | {"velocity": 60, "duty": DUTY | {"rollers_on_rail": 2}}))
    told = json.loads(trackroller("solve", "case.yaml", "--json", cwd=tmp_path).stdout)["answer"]["facts"]
    assert told["strokes"] == {"strokes_per_day": 400.0, "stroke": 0.9, "rollers_on_rail": 2.0}
    assert told["duty"] == pytest.approx({"hours_per_day": 0.1, "days_per_year": 300})
    trackroller("solve", "case.yaml", "-o", "roller.xlsx", cwd=tmp_path)
    rows = {row[0]: row[2:] for row in openpyxl.load_workbook(tmp_path / "roller.xlsx")["inputs"].values}
    assert rows["stroke"] == (0.9, "m", "given") and rows["strokes_per_day"] == (400, "-", "given")
    assert rows["hours_per_day"] == (pytest.approx(0.1), "-", "strokes")
    assert rows["guide_overrollings_per_hour"] == (pytest.approx(2 * PER_HOUR), "1/h", "strokes")


def test_the_live_page_gives_a_file_that_is_taken():
    values = FAST | {"velocity": 60, "duty": DUTY}
    again, _, beside = checked_case(parse_mapping(texts(values)["YAML"], "case file"))
    assert beside == {"duty": pytest.approx({"hours_per_day": 0.1, "days_per_year": 300})}
    assert again.guide_overrollings_per_hour == pytest.approx(PER_HOUR)
