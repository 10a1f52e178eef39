"""The terminal at 80 and 120 columns: no cell is cut, no line is too long, wide tables are parted."""

from __future__ import annotations

import re

import pytest
from typer.testing import CliRunner

from trackroller.cli.main import app
from trackroller.report.terminal import print_table, print_text

SPECTRUM = """name: shift
base: {motor_force: 0, guide_overrollings_per_hour: 100, friction_coefficient: 0.2}
contact_model: sliding
blocks:
  - {name: loaded travel, distance: 900, axial_force: 30, radial_force: -200}
  - {name: empty, distance: 1200, axial_force: 4, radial_force: -60}
"""
COMMANDS = {
    "solve": ["solve", "--set", "contact_model=sliding", "--set", "guide_overrollings_per_hour=100"],
    "limits": ["solve", "--set", "contact_model=sliding", "--limits", "static,fatigue,rating,bearing,catalogue"],
    "materials": ["materials", "list"],
    "material": ["materials", "show", "PA6"],
    "friction": ["materials", "friction"],
    "spectrum": ["spectrum", "shift.yaml"],
    "plan": ["plan", "study.yaml"],
    "explain": ["plan", "--explain", "--set", "contact_model=sliding"],
}


def words_of(text: str) -> list[str]:
    """Return the words of a printed text without its frames."""
    return re.sub(r"[┃│┏┓┗┛┳┻┡┩╇━─┌┐└┘┴┬├┤┼]+", " ", text).split()


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_nothing_is_cut_at_80_and_120_columns(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "shift.yaml").write_text(SPECTRUM)
    (tmp_path / "study.yaml").write_text("{name: s, factors: {axial_force: {values: [0, 9]}}, contact_model: sliding}")
    said = {}
    for columns in ("80", "120", "400"):
        done = CliRunner().invoke(app, COMMANDS[name], env={"COLUMNS": columns})
        assert done.exit_code == 0, done.output
        lines = done.output.splitlines()
        assert max(len(line.rstrip()) for line in lines) <= int(columns) and "…" not in done.output
        assert all(line.rstrip()[-1] in "│┃┩┓┘┛┤" for line in lines if line[:1] in ("│", "┃"))
        said[columns] = set(words_of(done.output))
    assert said["80"] == said["120"] == said["400"]


@pytest.mark.slow
def test_solve_ends_with_the_margins_and_what_was_not_checked():
    done = CliRunner().invoke(app, COMMANDS["solve"], env={"COLUMNS": "120"})
    lines = [line.strip() for line in done.output.splitlines()]
    margins = next(i for i, line in enumerate(lines) if line.startswith("┃ Limit"))
    assert all("┃ input" not in line and "Contact 1" not in line for line in lines[margins:])
    last = " ".join(lines[margins:])
    assert "not checked, roller:" in last
    assert " ".join(lines).count(lines[0]) == 1  # the headline stands at the head alone
    assert "heat (give heat_transfer_coefficient, give cooled_area)" in last


def test_a_wide_table_is_parted_and_repeats_its_first_column(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    heads, rows = ["name", "first value", "second value", "third value"], [["steel", "1", "2", "3"]]
    print_table(heads, rows)
    told = capsys.readouterr().out
    assert told.count("steel") == 2 and max(map(len, told.splitlines())) <= 40
    print_text("a sentence that is longer than one line of forty columns", "life")
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("life     a sentence") and lines[1].startswith(" " * 9) and max(map(len, lines)) <= 40


@pytest.mark.parametrize("name", ["COLUMNS", "FORCE_COLOR", "TTY_COMPATIBLE"])
def test_a_pipe_has_lines_of_any_length(name, capsys, monkeypatch):
    monkeypatch.setenv(name, "" if name == "COLUMNS" else "1")
    print_text("word " * 100)
    print_table(["name", "text"], [["a", "word " * 100]])
    assert len(capsys.readouterr().out.splitlines()) == 6
