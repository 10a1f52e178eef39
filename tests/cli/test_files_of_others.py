"""No command writes over a file of somebody else, not even where `-o` names it: it may be the command's own input."""

from __future__ import annotations

import openpyxl
import pytest
import xarray as xr
from command_line import trackroller

ROLLER = "motor_force: 0\nfriction_coefficient: 0.2\ncontact_model: sliding\noutputs: [forces, contact]\n"
LOG = "time [s];radial_force [N];axial_force [N]\n0;-100;10\n1;-200;20\n2;-150;20\n"
STUDY = (
    "name: tab\nbase: {motor_force: 0}\ndesign: table\ntable: cases.csv\noutputs: [forces]\ncontact_model: sliding\n"
)
PAGE = "<!doctype html>\n<title>my notes on trackroller</title>\n"


@pytest.fixture
def folder(tmp_path):
    """Return a folder with the files of a user, in which commands run."""
    for name, text in {"roller.yaml": ROLLER, "log.csv": LOG, "study.yaml": STUDY, "notes.html": PAGE}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "cases.csv").write_text("radial_force\n-200\n-300\n")
    book = openpyxl.Workbook()
    book.active.append(["radial_force"])
    book.save(tmp_path / "cases.xlsx")
    xr.Dataset({"a": ("x", [1, 2])}).to_netcdf(tmp_path / "mine.nc")
    return tmp_path


@pytest.mark.parametrize(
    "command",
    [
        ["spectrum", "roller.yaml", "--from", "log.csv", "-o", "roller.yaml"],
        ["solve", "roller.yaml", "-o", "cases.xlsx"],
        ["solve", "roller.yaml", "-o", "mine.nc"],
        ["solve", "roller.yaml", "--report", "notes.html"],
        ["report", "tab", "-o", "cases.csv"],
        ["report", "tab", "-o", "cases.xlsx"],
    ],
)
def test_a_file_of_a_user_is_refused_and_stays(folder, command):
    if command[0] == "report":
        trackroller("run", "study.yaml", "-q", cwd=folder)
    before = (folder / command[-1]).read_bytes()
    done = trackroller(*command, cwd=folder, code=2)
    assert "is a file that trackroller did not write" in done.stderr
    assert "Give another name, or move the file away." in done.stderr
    assert (folder / command[-1]).read_bytes() == before


@pytest.mark.parametrize(
    "command",
    [
        ["spectrum", "roller.yaml", "--from", "log.csv", "-o", "shift.yaml"],
        ["solve", "roller.yaml", "-o", "new.xlsx"],
        ["solve", "roller.yaml", "-o", "new.nc"],
        pytest.param(["solve", "roller.yaml", "--report", "new.html"], marks=pytest.mark.slow),
        ["report", "tab", "-o", "new.csv"],
        ["report", "tab", "-o", "new.xlsx"],
        pytest.param(["report", "tab", "-o", "new.html"], marks=pytest.mark.slow),
        ["explore", "tab", "-o", "new.html"],
        ["best", "tab", "-o", "new.html"],
    ],
)
def test_what_a_command_wrote_it_replaces(folder, command):
    if "tab" in command:
        trackroller("run", "study.yaml", "-q", cwd=folder)
    for _ in range(2):
        trackroller(*command, cwd=folder)
    assert (folder / command[-1]).stat().st_size > 0
