"""PDF and workbooks: a name decides the format, a missing browser ends in a sentence, cases keep their numbers."""

from __future__ import annotations

import re
import zipfile

import numpy as np
import pandas as pd
import pytest
from browser import CHROMIUM
from typer.testing import CliRunner

from trackroller.cli.main import app, run_app
from trackroller.errors import InputError, WorkError
from trackroller.report import html
from trackroller.report.workbook import write_cases


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="needs chromium")
def test_a_name_in_pdf_holds_a_pdf(tmp_path):
    made = html.write_page(tmp_path / "page.pdf", "<!doctype html><title>t</title><p>one page</p>")
    content = made.read_bytes()
    assert content.startswith(b"%PDF-") and len(re.findall(rb"/Type\s*/Page\b", content)) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["page.pdf"]


def test_without_a_browser_nothing_is_written_and_one_sentence_says_why(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(html.shutil, "which", lambda name: None)
    with pytest.raises(WorkError, match=r"none of them was found. Install one of them, or write a page"):
        html.write_page(tmp_path / "page.pdf", "text")
    assert run_app(lambda: app(["solve", "--report", str(tmp_path / "x.pdf")])) == 1
    told = capsys.readouterr()
    assert told.out == "" and len(told.err.splitlines()) == 1 and not list(tmp_path.iterdir())


def test_a_browser_that_fails_leaves_no_file(tmp_path, monkeypatch):
    monkeypatch.setattr(html, "_browser", lambda: "false")
    with pytest.raises(WorkError, match="does not print"):
        html.write_page(tmp_path / "page.pdf", "text")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", [["solve"], ["spectrum", "any.yaml"]])
def test_other_formats_are_refused_before_anything_is_solved(command, tmp_path, capsys):
    assert run_app(lambda: app([*command, "--report", str(tmp_path / "x.docx")])) == 2
    assert "ends in .html or .pdf" in capsys.readouterr().err


def test_a_workbook_of_cases_holds_every_number(tmp_path):
    table = pd.DataFrame(
        {"friction_coefficient": [0.1, 1 / 3], "material_pair": ["a / b", "=1+1"], "life": [np.inf, 2.0]}
    )
    with zipfile.ZipFile(write_cases(table, tmp_path / "cases.xlsx")) as book:
        sheet = book.read("xl/worksheets/sheet1.xml").decode()
    assert [float(v) for v in re.findall(r"<v>([^<]+)</v>", sheet)] == [0.1, 1 / 3, 2.0]
    assert sheet.count("<row>") == 4 and "material_pair" in sheet and "<f>" not in sheet
    again = pd.read_csv(write_cases(table, tmp_path / "cases.csv"))
    pd.testing.assert_frame_equal(again, table.replace("=1+1", "'=1+1"))  # a spreadsheet would run it
    with pytest.raises(InputError, match=r"\.xlsx or \.csv"):
        write_cases(table, tmp_path / "cases.ods")


def test_the_report_command_names_the_formats():
    assert "cases as .xlsx" in " ".join(CliRunner().invoke(app, ["report", "--help"]).output.split())
