"""`trackroller shelf` shows the rows of a shelf and checks them; the shelves of the repository pass."""

from __future__ import annotations

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
