"""Points from files: where they are looked for, and how numbers may be written."""

from __future__ import annotations

import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.files import files_beside
from trackroller.roller.point_files import read_points

ROWS = [[0.25 * k, (36.0 - (0.25 * k) ** 2) ** 0.5] for k in range(-18, 19)]


def written(separator: str, comma: bool) -> str:
    lines = [separator.join(f"{v:.5f}".replace(".", "," if comma else ".") for v in row) for row in ROWS]
    return "\n".join([separator.join(["x", "z"]), *lines])


@pytest.mark.parametrize(
    ("separator", "comma"),
    [
        (";", True),
        ("; ", True),
        ("\t", True),
        ("   ", True),
        (";", False),
        (",", False),
        (", ", False),
        ("\t", False),
    ],
)
def test_decimal_commas_are_read_where_they_are_unambiguous(tmp_path, monkeypatch, separator, comma):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "c.csv").write_text(written(separator, comma), encoding="utf-8")
    assert read_points("c.csv", "guide_profile.file") == [[pytest.approx(v, abs=1e-5) for v in row] for row in ROWS]


def test_thousands_and_words_are_refused_with_the_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "c.csv").write_text(written(";", True) + "\n1.234,5;2,0\n", encoding="utf-8")
    with pytest.raises(tr.InputError, match=r"line 39.*decimal commas only"):
        read_points("c.csv", "guide_profile.file")


@pytest.mark.long
def test_files_lie_beside_the_case_or_below_the_working_directory(tmp_path):
    folder = tmp_path / "prof"
    folder.mkdir()
    (folder / "c.csv").write_text(written(";", True), encoding="utf-8")
    case = "guide_profile: {file: c.csv, frame: section}\nnormal: halfspace\naccuracy: preview\noutputs: [forces]\n"
    case += "contact_model: sliding\n"
    (folder / "c.yaml").write_text(case)
    (folder / "study.yaml").write_text(f"name: s\nbase: {{{case.splitlines()[0]}}}\nnormal: halfspace\n")
    trackroller("solve", "prof/c.yaml", cwd=tmp_path)
    trackroller("plan", "prof/study.yaml", cwd=tmp_path)
    (tmp_path / "c.yaml").write_text(case.replace("c.csv", "prof/c.csv"))
    trackroller("solve", "c.yaml", cwd=tmp_path)


def test_a_missing_file_is_told_where_to_put(tmp_path, monkeypatch):
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    monkeypatch.chdir(here)
    with files_beside(there / "case.yaml"), pytest.raises(tr.InputError) as told:
        read_points("c.csv", "guide_profile.file")
    assert f"below {there} or below {here}" in str(told.value)
    with pytest.raises(tr.InputError, match=r"without '..'"):
        read_points("../there/c.csv", "guide_profile.file")
    (tmp_path / "outside.csv").write_text(written(",", False))
    (there / "link.csv").symlink_to(tmp_path / "outside.csv")
    with files_beside(there / "case.yaml"), pytest.raises(tr.InputError, match="a file below"):
        read_points("link.csv", "guide_profile.file")
