"""Workbooks of Excel are read as tables of cases and of blocks."""

from __future__ import annotations

import datetime
import sys
import zipfile

import pandas as pd
import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.errors import Collector
from trackroller.report.workbook import write_cases
from trackroller.study.file.csv import column_names, read_rows
from trackroller.study.spectrum.file import load_spectrum

openpyxl = pytest.importorskip("openpyxl")
STUDY = "name: x\ndesign: table\ntable: cases.xlsx\noutputs: [forces]\n"


def save(path, **sheets):
    """Write a workbook with a list of rows for each sheet."""
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    book.save(path)


def test_a_design_is_read_from_a_workbook(tmp_path):
    """Numbers, texts with units, decimal commas of texts and empty rows are those of a CSV."""
    rows = [["radial_force [kN]", "mu", "roller_material", None], [], [-0.2, "0,15", "PA6"], ["-300 N", 0.25, "POM"]]
    save(tmp_path / "cases.xlsx", Tabelle1=rows)
    (tmp_path / "s.yaml").write_text(STUDY)
    design = tr.load_study(tmp_path / "s.yaml").design()
    assert design.radial_force.values.tolist() == [-200.0, -300.0]
    assert design.friction_coefficient.values.tolist() == [0.15, 0.25]
    assert design.roller_material.values.tolist() == ["PA6", "POM"]
    assert column_names(tmp_path / "cases.xlsx", "table") == ["radial_force", "friction_coefficient", "roller_material"]


def test_blocks_are_read_from_a_workbook(tmp_path):
    save(tmp_path / "b.xlsx", notes=[["of 2026"]], blocks=[["name", "distance [km]", "velocity"], ["a", 1.5, None]])
    (tmp_path / "s.yaml").write_text("blocks: b.xlsx\n")
    (block,) = load_spectrum(tmp_path / "s.yaml").blocks
    assert block.distance == 1500.0 and block.case.velocity == 60.0


def test_cases_that_the_program_wrote_are_read_again(tmp_path):
    table = pd.DataFrame({"axial_force": [0.1, 1e-3], "roller_material": ["PA6", "POM"]})
    write_cases(table, tmp_path / "out.xlsx")
    names, head, lines = read_rows(tmp_path / "out.xlsx", "table", "case", Collector())
    assert names == [*table.columns] and head == 1
    assert [[float(a), b] for a, b in lines.values()] == table.to_numpy().tolist()


def test_errors_name_the_row_of_the_sheet(tmp_path):
    save(tmp_path / "cases.xlsx", a=[["axial_force"], [3], [], ["x"], [None, 4]])
    (tmp_path / "s.yaml").write_text(STUDY)
    told = trackroller("plan", "s.yaml", cwd=tmp_path, code=2).stderr.splitlines()
    assert [line.partition(" is not")[0] for line in told] == [
        "trackroller: cases.xlsx, line 4: axial_force = 'x'",
        "trackroller: cases.xlsx, line 5: table = ', 4'",
    ]


@pytest.mark.parametrize(
    ("sheets", "named"),
    [
        ({"a": [["mu"], [1]], "b": [["mu"], [1]]}, "a, b.*Name the sheet that is meant 'cases'"),
        ({"a": [["mu"], [datetime.date(2026, 2, 1)]]}, "line 2: .*the sheet holds a date"),
        ({"a": [["mu"]]}, "at least one case"),
    ],
)
def test_a_workbook_that_is_not_clear_is_refused(sheets, named, tmp_path):
    save(tmp_path / "cases.xlsx", **sheets)
    (tmp_path / "s.yaml").write_text(STUDY)
    with pytest.raises(tr.InputError, match=named):
        tr.load_study(tmp_path / "s.yaml")


def test_a_file_that_is_no_workbook_is_refused(tmp_path):
    (tmp_path / "s.yaml").write_text(STUDY)
    for content in (b"mu\n0.1\n", b"PK\x03\x04"):
        (tmp_path / "cases.xlsx").write_bytes(content)
        with pytest.raises(tr.InputError, match="a readable workbook"):
            tr.load_study(tmp_path / "s.yaml")
    with zipfile.ZipFile(tmp_path / "cases.xlsx", "w") as file:
        file.writestr("a.txt", "b")
    with pytest.raises(tr.InputError, match="a readable workbook"):
        tr.load_study(tmp_path / "s.yaml")


def test_without_openpyxl_the_message_says_what_to_install(tmp_path, monkeypatch):
    save(tmp_path / "cases.xlsx", a=[["mu"], [0.1]])
    (tmp_path / "s.yaml").write_text(STUDY)
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    told = trackroller("plan", "s.yaml", cwd=tmp_path, code=2).stderr
    assert "Install it with `pip install openpyxl`, or save the table as CSV." in told
