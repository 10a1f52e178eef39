"""The benchmark takes a program by one CSV file, and tells bad files by their line."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from trackroller.errors import InputError
from validation.measured.benchmark import table
from validation.measured.benchmark.entry import OURS, write_entry
from validation.pages import render

ROOT = Path(__file__).parents[2]


def written(folder, text, name="made-up"):
    path = folder / f"{name}.csv"
    path.write_text(text, encoding="utf-8")
    return path


def rows_of(path):
    return [row for row in table.error_rows(table.all_programs([path])) if row[0] == path.stem]


def test_a_made_up_program_joins_by_one_file(tmp_path):
    """At the truth but for 10 % of mu F_N in one of two cases, so that its median is 5 %."""
    head = "# of nobody\ncase,driving_force [kN],half_width [mm]\n"
    text = head + "creep-0.04%,-9.112,\ncreep-0.08%,-13.1789,\ngroove-10.25,,2.75\n"
    path = written(tmp_path, text)
    rows = rows_of(path)
    assert [row[1:6] for row in rows] == [
        ("creep", "driving_force", "2 of 7", "5 %", "10 %"),
        ("groove", "half_width", "1 of 3", "0 %", "0 %"),
    ]
    assert table.read_program(path).remark == "of nobody"


def test_a_file_in_the_folder_stands_on_the_page(tmp_path, monkeypatch):
    shutil.copytree(table.PROGRAMS, tmp_path / "programs")
    written(tmp_path / "programs", "case,spin_moment [N mm]\nspin-lateral,48210\n", "exactly-contact")
    assert "exactly-contact" not in render("benchmark.md")
    monkeypatch.setattr(table, "PROGRAMS", tmp_path / "programs")
    assert "| exactly-contact | spin | spin_moment | 1 of 1 | 0 % | 0 % | 2 % |" in render("benchmark.md")


BAD = (
    ("case,spin_moment [N mm]\ncreep-0.05%,1\n", 2, "case = 'creep-0.05%'"),
    ("case,driving_force [N]\ncreep-0.04%,-9000\ncreep-0.08%,-9000\ncreep-0.04%,-9000\n", 4, "line 2 has it already"),
    ("case,driving_force [N]\ncreep-0.04%,about 9 kN\n", 2, "driving_force"),
    ("case,driving_force [mm]\ncreep-0.04%,-9000\n", 1, "mm"),
    ("case,drag [N]\ncreep-0.04%,-9000\n", 1, "drag"),
    ("program,driving_force [N]\ncreep-0.04%,-9000\n", 1, "program"),
    ("driving_force [N]\n-9000\n", 1, "column case"),
    ("case,driving_force [N]\nspin-lateral,0\n", 1, "has a truth"),
)


@pytest.mark.parametrize(("text", "line", "words"), BAD, ids=[words for _, _, words in BAD])
def test_a_bad_file_is_told_by_its_line(tmp_path, text, line, words):
    path = written(tmp_path, text)
    with pytest.raises(InputError) as error:
        table.read_program(path)
    assert error.value.shown[0].startswith(f"{path}, line {line}: ") and words in error.value.shown[0]


def test_two_bad_lines_are_told_together(tmp_path):
    path = written(tmp_path, "case,driving_force [N]\nno,1\ncreep-0.04%,-9000\nnobody,1\n")
    with pytest.raises(InputError) as error:
        table.read_program(path)
    assert ["line 2" in error.value.shown[0], "line 4" in error.value.shown[1]] == [True, True]


def test_every_truth_has_a_case_and_a_scale():
    cases = table.read_cases()
    for (case, quantity), truth in table.read_truths().items():
        assert case in cases and quantity in table.QUANTITIES and abs(truth.scale) > 0, (case, quantity)
    assert {case for case, _ in table.read_truths()} == set(cases)


def test_the_example_of_the_page_is_printed_by_the_command(tmp_path):
    text = (ROOT / "docs" / "validation" / "benchmark.md").read_text(encoding="utf-8")
    example = re.search(r"<!-- file: (\S+) -->\n```csv\n(.*?)```", text, re.S)
    path = tmp_path / example[1]
    path.write_text(example[2], encoding="utf-8")
    command = [sys.executable, "-m", "validation.measured.benchmark", str(path)]
    place = os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "200"}
    said = subprocess.run(command, cwd=ROOT, env=place, capture_output=True, text=True, check=True).stdout
    assert "my-program" in said and "FaStrip" in said
    path.write_text("case,driving_force [N]\nnobody,1\n", encoding="utf-8")
    refused = subprocess.run(command, cwd=ROOT, env=place, capture_output=True, text=True, check=False)
    assert refused.returncode == 2 and "line 2" in refused.stderr and "Traceback" not in refused.stderr


@pytest.mark.slow
def test_our_entry_is_what_the_program_computes(tmp_path):
    write_entry(tmp_path / f"{OURS}.csv")
    fresh = table.read_program(tmp_path / f"{OURS}.csv")
    kept = table.read_program(table.PROGRAMS / f"{OURS}.csv")
    truths = table.read_truths()
    for key, truth in truths.items():
        assert fresh.results[key] == pytest.approx(kept.results[key], abs=1e-4 * abs(truth.scale))
