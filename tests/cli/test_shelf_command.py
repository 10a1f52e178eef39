"""`trackroller shelf` shows the rows of a shelf and checks them; the shelves of the repository pass."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

import trackroller as tr
from trackroller.cli.main import app
from trackroller.errors import InputError
from trackroller.study.file.load import parse_study

SHELVES = Path(__file__).parents[2] / "config" / "shelves"


def run(*words):
    """Return what the command prints; raise its input error."""
    done = CliRunner().invoke(app, ["shelf", *map(str, words)])
    if isinstance(done.exception, InputError):
        raise done.exception
    assert done.exit_code == 0, done.output
    return done.output


def test_the_example_shows_all_values():
    text = run(SHELVES / "rollers.csv")
    assert "rows: 10" in text and "E22-close" in text and "price [EUR]" in text and "26.9" in text


def test_rows_are_put_to_the_rail_of_a_case(tmp_path):
    case = tmp_path / "case.yaml"
    case.write_text("guide_profile_radius: 6.6\nradial_force: -100\n")
    with pytest.raises(InputError, match=r"rollers\.csv, line 5: roller_profile_radius .*interlock"):
        run(SHELVES / "rollers.csv", "--case", case)
    assert "rows: 10" in run(SHELVES / "rollers.csv", "--case", case, "--set", "guide_profile_radius=6")


def test_a_case_gives_what_cells_leave_out(tmp_path):
    file = tmp_path / "some.csv"
    file.write_text("name;axis_distance;contact_angle\na;20;\nb;22;25\n")
    with pytest.raises(InputError, match=r"some\.csv, line 2: contact_angle .*is missing"):
        run(file)
    assert "28" in run(file, "--set", "contact_angle=28", "--set", "axis_distance=30")


@pytest.mark.parametrize(("mark", "shown"), [("\x1b[31m", r"\x1b[31m"), ("\u202e", r"\u202e")])
def test_the_name_of_a_file_reaches_the_terminal_escaped(mark, shown, tmp_path):
    file = tmp_path / f"a{mark}.csv"
    file.write_text((SHELVES / "rollers.csv").read_text())
    text = run(file)
    assert mark not in text and f"file: a{shown}.csv" in text


def test_an_unknown_kind_of_shelf_is_refused():
    with pytest.raises(InputError, match="--of"):
        run(SHELVES / "rollers.csv", "--of", "axle")


def test_the_v_roller_has_the_life_of_its_catalogue(monkeypatch):
    """Worked example of the maker: 300 lbf axial, 100 lbf radial, load factor 0.38, 124.7e6 inch."""
    monkeypatch.chdir(SHELVES)
    lbf = 4.4482216
    base = {"radial_force": -100 * lbf, "axial_force": 300 * lbf, "motor_force": 0}
    keys = {"name": "v", "base": base, "factors": {"roller": {"file": "v_rollers.csv"}}, "accuracy": "preview"}
    study = parse_study(keys | {"contact_model": "sliding", "outputs": ["forces", "bearing"]})
    found = tr.solve(study.design()).isel(case=0)
    assert found["catalogue_load_factor"].item() == pytest.approx(300 / 900 + 100 / 2181, rel=2e-4)
    assert found["catalogue_life_km"].item() == pytest.approx(173.7 / (300 / 900 + 100 / 2181) ** 3, rel=1e-3)
    assert 6.84e6 * 0.0254e-3 == pytest.approx(173.7, rel=1e-3)
    assert 173.7 / 0.38**3 == pytest.approx(124.7e6 * 0.0254e-3, rel=1e-3)


def test_the_example_is_written_shown_and_sized(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = CliRunner().invoke
    assert run(app, ["shelf", "--example", "rollers.csv"]).exit_code == 0
    assert run(app, ["shelf", "--example"]).stdout == Path("rollers.csv").read_text()
    with pytest.raises(InputError, match="is there already"):
        run(app, ["shelf", "--example", "rollers.csv"], catch_exceptions=False)
    shown = run(app, ["shelf", "rollers.csv"])
    assert shown.exit_code == 0 and "rows: 3" in shown.output
    with pytest.raises(InputError, match=r"does not exist.*trackroller shelf --example"):
        run(app, ["shelf", "other.csv"], catch_exceptions=False)
    text = "radial_force: -100\nmotor_force: 0\ncontact_model: sliding\naccuracy: preview\n"
    Path("case.yaml").write_text(text)
    done = run(app, ["size", "case.yaml", "--shelf", "rollers.csv", "--life", "100", "--least", "price", "-q"])
    assert done.exit_code == 0 and "small is the least of" in done.output


HEADS = "name;axis_distance [mm];roller_profile_radius [mm];roller_material;bearing_outer_diameter [mm]"
RATED = "catalogue_radial_force [N];catalogue_axial_force [N];catalogue_basic_life [km];price [EUR]"
MISTAKES = {  # row, column, wrong cell, message
    5: (0, "R4", "line 7: name = 'R4' stands in line 6 too"),
    11: (1, "25 um mm", "line 13: axis_distance"),
    20: (2, "6,5", "line 22: roller_profile_radius = '6,5'.* one decimal sign"),
    26: (8, "12 USD", "line 28: price"),
    30: (4, "80", "line 32: bearing_outer_diameter = 80.0 .*less than the rolling diameter"),
    33: (3, "1.7225-quenched", "line 35: roller_material .*1.7225-quenched-tempered"),
    41: (5, "swapped", "line 43: catalogue_axial_force = '800 N' is larger than the permissible radial force"),
    50: (2, "-5.5", "line 52: roller_profile_radius = -5.5 .*conform or interlock"),
}


def shelf_of_60(path, mistakes):
    lines = [f"{HEADS};{RATED}"]
    for i in range(60):
        cells = [f"R{i}", f"{18 + i / 2}", "-6.5", "1.7225-quenched-tempered", "22", "800", "300", "100", f"{8 + i}.5"]
        if i in mistakes:
            column, cell, _ = MISTAKES[i]
            cells[column] = cell
            if cell == "swapped":
                cells[5:7] = "300", "800"
        lines.append(";".join(cells))
    path.write_text("\n".join(lines) + "\n")
    return path


def test_all_mistakes_of_a_shelf_are_told_at_once_by_row_and_column(tmp_path):
    path = shelf_of_60(tmp_path / "rollers.csv", MISTAKES)
    with pytest.raises(InputError) as refused:
        run(path)
    errors = list(refused.value.errors)
    assert [error.line for error in errors] == [i + 2 for i in MISTAKES]
    for error, (_, _, message) in zip(errors, MISTAKES.values(), strict=True):
        assert re.search(message, str(error)), str(error)
    assert "rows: 60" in run(shelf_of_60(path, {}))  # corrected
    for i in MISTAKES:  # each alone
        with pytest.raises(InputError, match=MISTAKES[i][2]) as alone:
            run(shelf_of_60(path, {i}))
        assert len(list(alone.value.errors)) == 1


def test_a_size_tells_the_mistakes_of_its_shelf_too(tmp_path):
    path = shelf_of_60(tmp_path / "rollers.csv", MISTAKES)
    case = {"radial_force": -100, "motor_force": 0}
    with pytest.raises(InputError) as refused:
        tr.size(case, path, life=100)
    assert [error.line for error in refused.value.errors] == [i + 2 for i in MISTAKES]


def test_requirements_that_nothing_meets_name_what_excludes_each_roller(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shelf_of_60(tmp_path / "rollers.csv", {})
    text = (tmp_path / "rollers.csv").read_text().splitlines()
    (tmp_path / "rollers.csv").write_text("\n".join(text[:4]) + "\n")
    case = {"radial_force": -100, "motor_force": 0, "contact_model": "sliding", "accuracy": "preview"}
    for required, words in (
        ({"life": 1e9}, "life: fatigue after"),
        ({"safety": 1e4}, "overload: "),
        ({"life": 1e9, "failures": "1%"}, "life: fatigue after"),
    ):
        found = tr.size(case, "rollers.csv", **required)
        assert found.least == "" and found.table["excluded_by"].str.contains(words).all()


def test_a_door_is_sized_from_an_empty_folder_by_what_the_messages_say(tmp_path, monkeypatch):
    """400 strokes a day of 2 m at 30 m/min, 365 days a year for 3 years are 486.7 h of travel."""
    monkeypatch.chdir(tmp_path)
    call = CliRunner().invoke
    with pytest.raises(InputError, match="trackroller size --example door.yaml".replace(".", r"\.")):
        call(app, ["size", "door.yaml", "--shelf", "rollers.csv"], catch_exceptions=False)
    assert call(app, ["size", "--example", "door.yaml"]).exit_code == 0
    with pytest.raises(InputError, match=r"trackroller shelf --example rollers\.csv"):
        call(app, ["size", "door.yaml", "--life", "3 years"], catch_exceptions=False)
    assert call(app, ["shelf", "--example", "rollers.csv"]).exit_code == 0
    words = ["size", "door.yaml", "--shelf", "rollers.csv", "--life", "3 years", "--least", "price", "-q"]
    done = call(app, [*words, "--json"], catch_exceptions=False)
    record = json.loads(done.stdout)
    assert done.exit_code == 0 and record["least"] == "small"
    for row in record["rollers"]:
        assert row["life_hours"] / row["life_ratio"] == pytest.approx(3 * 365 * 400 * 2 / (30 * 60), rel=1e-12)
    assert not {"radial_force", "motor_force", "friction_coefficient"} & {*record["not_given"]}


def test_values_that_nobody_gave_are_said(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert CliRunner().invoke(app, ["shelf", "--example", "rollers.csv"]).exit_code == 0
    Path("case.yaml").write_text("radial_force: -100\ncontact_model: sliding\naccuracy: preview\n")
    done = CliRunner().invoke(app, ["size", "case.yaml", "--shelf", "rollers.csv", "--life", "9", "-q"])
    assert "taken from the paper's example: " in done.output and "motor_force -30 N" in done.output


def test_each_bearing_of_the_repository_states_its_page_and_the_ratings_of_a_row():
    """A pair of 6000: C = 4.55 kN and C_0 = 1.96 kN each, the outer diameter 26 mm."""
    text = run(SHELVES / "bearings.csv", "--of", "bearing", "--set", "axis_distance=60")
    assert "rows: 21" in text
    lines = [line.split(";") for line in (SHELVES / "bearings.csv").read_text().splitlines() if line[0] != "#"]
    rows = {line[0]: dict(zip(lines[0], line, strict=True)) for line in lines[1:]}
    own = rows["2 x 6000"]
    values = (own["dynamic_rating [N]"], own["static_rating [N]"], own["outer_diameter [mm]"])
    assert values == ("4550", "1960", "26")
    assert {row["bore [mm]"] for row in rows.values()} == {"5", "6", "7", "8", "10", "12", "15", "17", "20", "25"}
    for row in rows.values():
        assert row["page"].startswith("https://") and row["rows"] == "2"
        assert float(row["static_rating [N]"]) < float(row["dynamic_rating [N]"])
