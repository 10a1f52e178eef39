"""The requirement of the live page: its answer is that of `trackroller.size`."""

from __future__ import annotations

from pathlib import Path

import pytest

import trackroller as tr
from trackroller.app.carriage import carriage_files
from trackroller.app.requirement import sized
from trackroller.carriage.example import EXAMPLE
from trackroller.errors import InputError

SHELF = """name;axis_distance;roller_profile_radius;roller_material;price [EUR]
mid;30;-8.4;1.7225-quenched-tempered;3
large;40;-8.2;1.7225-quenched-tempered;5
no price;40;-8.2;1.7225-quenched-tempered;
"""
ROLLER = {"radial_force": "-300 N", "axial_force": 20, "motor_force": 0, "guide_profile_radius": 8}
ROLLER |= {"roller_profile_radius": -9, "guide_overrollings_per_hour": 60, "contact_model": "sliding"}
ROLLER |= {"guide_material": "1.7225-quenched-tempered", "duty": "{hours_per_day: 8, days_per_year: 200}"}
ASKED = {"life": "3 years", "failures": "", "safety": "1.5", "least": "price"}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("rollers.csv").write_text(SHELF)


def test_the_page_says_what_size_says():
    shown = sized(ROLLER, "", "rollers.csv", ASKED, "preview")
    case = {**ROLLER, "duty": {"hours_per_day": 8, "days_per_year": 200}, "accuracy": "preview"}
    found = tr.size(case, "rollers.csv", life="3 years", safety=1.5, least="price")
    assert shown["least"] == found.least == "mid" and shown["lead"].startswith("mid is the least of")
    rows = shown["tables"][0]
    assert [row[0] for row in rows["rows"]] == found.table["roller"].tolist()
    place = rows["heads"].index("life hours [h]")
    lives = [float(row[place].replace(",", "")) for row in rows["rows"]]
    assert lives == pytest.approx(found.table["life_hours"].tolist(), rel=5e-4)
    assert "no price: no price" in shown["notes"][0] and shown["states"][0] == "kept"
    ratios = shown["tables"][1]
    assert ratios["heads"][0] == "roller" and "shakedown" in ratios["heads"]
    assert list(map(float, ratios["rows"][0][1:])) == pytest.approx(found.ratios.table.loc["mid"].tolist(), rel=5e-4)


def test_the_duty_may_be_in_strokes_as_in_a_file():
    """400 strokes of 2 m at 30 m/min are 4/9 hours a day; two rollers pass each point 800 times a day."""
    values = {name: value for name, value in ROLLER.items() if name != "guide_overrollings_per_hour"}
    strokes = "{strokes_per_day: 400, stroke: 2 m, rollers_on_rail: 2}"
    shown = sized(values | {"velocity": 30, "duty": strokes}, "", "rollers.csv", ASKED, "preview")
    hours = values | {"velocity": 30, "duty": f"{{hours_per_day: {4 / 9}}}", "guide_overrollings_per_hour": 1800}
    same = sized(hours, "", "rollers.csv", ASKED, "preview")
    assert shown["tables"] == same["tables"] and shown["lead"] == same["lead"]


def test_a_carriage_takes_the_place_of_the_roller_on_the_screen():
    text = EXAMPLE.replace("motor_force: 0\n", "motor_force: 0\n      contact_model: sliding\n")
    Path("shuttle.yaml").write_text(text)
    assert carriage_files()["files"] == ["shuttle.yaml"] and carriage_files()["tables"] == ["rollers.csv"]
    shown = sized({}, "shuttle.yaml", "rollers.csv", ASKED | {"life": "4000"}, "preview")
    assert shown["least"] == tr.size("shuttle.yaml", "rollers.csv", life=4000, safety=1.5, least="price").least


@pytest.mark.parametrize(
    ("carriage", "shelf", "message"),
    [
        ("", "", "Choose a file of this folder"),
        ("", "../rollers.csv", "in this folder"),
        ("", "/etc/passwd", "in this folder"),
        ("rollers.yaml", "rollers.csv", "carriage"),
        ("", "none.csv", "none.csv"),
        ("", "folder/rollers.csv", "'folder/rollers.csv' is no file"),
        ("", f"{'a' * 300}.csv", "is no file"),
        (f"{'a' * 300}.yaml", "rollers.csv", "is too long"),
    ],
)
def test_other_files_are_refused(carriage, shelf, message):
    Path("rollers.yaml").write_text("radial_force: -20\n")
    with pytest.raises(InputError, match=message):
        sized(ROLLER, carriage, shelf, ASKED, "preview")


@pytest.mark.parametrize("name", ["results", "each", "progress"])
def test_the_page_asks_for_nothing_but_a_requirement(name, tmp_path):
    """`results` would name a folder to write into, also outside the folder of the page."""
    with pytest.raises(InputError, match=f"requirement = '{name}' is not known"):
        sized(ROLLER, "", "rollers.csv", ASKED | {name: str(tmp_path / "elsewhere")}, "preview")
    assert not (tmp_path / "elsewhere").exists()


def test_a_shelf_that_is_a_link_is_refused(tmp_path):
    Path("link.csv").symlink_to(tmp_path / "rollers.csv")
    with pytest.raises(InputError, match="is a link"):
        sized(ROLLER, "", "link.csv", ASKED, "preview")
    assert carriage_files()["tables"] == ["rollers.csv"]
