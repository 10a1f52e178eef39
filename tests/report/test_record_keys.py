"""The record of an answer: its keys are documented, and JSON, workbook, live page and page hold the same one."""

import dataclasses
import json
import math
import re
from pathlib import Path

import openpyxl
import pytest
from command_line import trackroller
from golden_pages import visible
from limit_rows import headline, limit_row, part_of

import trackroller as tr
from trackroller.app.picture import picture
from trackroller.report.headlines import TEMPLATES, WARNING_HEADS
from trackroller.report.pages.sheet import as_json, render
from trackroller.report.workbook import write_roller
from trackroller.results.answer import VERSION, WARNINGS, Caution, Column, Required
from trackroller.results.answer_of_data import answer_of_data
from trackroller.study.file.config import QUESTIONS

DOCS = Path(__file__).parents[2] / "docs" / "report.md"
CASE = {"motor_force": 0, "friction_coefficient": 0.1, "permissible_wear_depth": 0.1, "contact_model": "sliding"}


def documented(head):
    """Return the first column of a table of docs/report.md and its rows, by the head of this column."""
    text = DOCS.read_text(encoding="utf-8")
    block = text[text.index(f"| {head} |") :].split("\n\n")[0].splitlines()[2:]
    return {cells[1].strip().strip("`"): line for line in block if (cells := line.split("|"))}


@pytest.fixture(scope="module")
def solved():
    case = {key: value for key, value in CASE.items() if key != "contact_model"}
    return tr.solve(
        tr.Case(**case), ("forces", "contact", "peak_stress", "life", "wear", "limits"), contact_model="sliding"
    )


def test_each_key_of_the_record_is_documented_and_each_documented_key_is_there(solved):
    record = answer_of_data(solved).to_dict()
    rows = documented("key")
    assert set(rows) == set(record) and record["version"] == VERSION
    assert f"it is {VERSION}." in DOCS.read_text(encoding="utf-8")
    for key, kind in (("columns", Column), ("required", Required), ("warnings", Caution)):
        named = set(re.findall(r"`(\w+)`", rows[key])) - {key}
        assert {field.name for field in dataclasses.fields(kind)} == named


def test_each_question_has_a_template_and_each_warning_a_head_and_a_line_of_documentation():
    assert set(TEMPLATES) == {*QUESTIONS, "roller", "spectrum", "wear", "carriage"}
    assert set(WARNINGS) == set(WARNING_HEADS)
    assert set(documented("warning")) == set(WARNING_HEADS.values())


def test_json_workbook_live_page_and_page_hold_one_record(solved, tmp_path):
    answer = answer_of_data(solved)
    record = json.loads(json.dumps(answer.to_dict()))
    assert json.loads(as_json(solved))["answer"] == record
    shown = picture({key: str(value) for key, value in CASE.items()}, "standard", complete=True)
    assert shown["answer"]["columns"] == record["columns"] and shown["headline"]["lead"] in headline(answer)
    assert [row["name"] for row in shown["answer"]["rows"]] != []
    book = openpyxl.load_workbook(write_roller(solved, tmp_path / "roller.xlsx"))
    heads, *rows = book["limits"].values
    for written, own in zip(rows, record["rows"], strict=True):
        for name, cell in zip(heads, written, strict=True):
            expected = own[name]
            if isinstance(expected, float) and not isinstance(cell, str):
                assert cell == pytest.approx(expected, rel=1e-15)
            elif isinstance(expected, str) and expected not in ("inf", "-inf"):
                assert (cell or "") == expected
    assert dict(list(book["headline"].values)[1:])["headline"] == headline(answer)
    assert any(headline(answer) in " ".join(line.split()) for line in visible(render(solved)))


def test_ranges_of_uses_and_lives_stand_in_the_record_with_both_ends(solved):
    """Wear with a required travel: the use is the travel over the life, at both ends of the wear coefficient."""
    case = {key: value for key, value in CASE.items() if key != "contact_model"} | {"required_travel": 40}
    answer = answer_of_data(tr.solve(tr.Case(**case), contact_model="sliding"))
    row = limit_row(answer, "wear", "roller")
    hours = 40 / 3.6  # at 60 m/min
    assert row["used_low"] == pytest.approx(hours / row["high"]) and row["used_high"] == pytest.approx(
        hours / row["low"]
    )
    assert answer.required[-1].least == pytest.approx(hours)
    values = part_of(answer, "placeholders")
    assert math.isfinite(values[values["value"] == "wear_coefficient"]["low"].iloc[0])


def test_the_terminal_names_the_example_only_where_values_of_it_are_used(tmp_path):
    options = ["--set", "contact_model=sliding", "--set", "accuracy=preview"]
    told = trackroller("solve", *options, cwd=tmp_path).stdout
    assert "Values from 'example' were not given" in told
    every = {**tr.Case().as_dict(), "roller_material": "C45", "guide_material": "C45"}
    given = {name: value for name, value in every.items() if isinstance(value, (int, float, str))}
    words = [word for name, value in given.items() for word in ("--set", f"{name}={value}")]
    assert "Values from 'example' were not given" not in trackroller("solve", *options, *words, cwd=tmp_path).stdout
