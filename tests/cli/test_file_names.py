"""Names that are not UTF-8 are refused in one line; what is wrong with a file comes first in every message."""

from __future__ import annotations

import os

import pytest
from command_line import trackroller, trackroller_process

import trackroller as tr
from trackroller.app.fields import all_fields
from trackroller.app.studies import listing
from trackroller.errors import InputError, unknown_name
from trackroller.files import check_utf_8, read_text, write_text
from trackroller.study.store.folder import StudyFolder

BAD = os.fsdecode(b"caf\xe9")
STUDY = "name: tiny\nfactors: {friction_coefficient: {values: [0.1, 0.2]}}\ncontact_model: sliding\noutputs: [forces]\n"
COMMANDS = (
    ("solve", f"{BAD}.yaml"),
    ("run", "study.yaml", "--results", BAD),
    ("status", BAD),
    ("verify", BAD),
    ("solve", "--set", f"roller_material={BAD}"),
    ("app", BAD, "--no-browser"),
)


def named(path):
    """Skip on a system whose file names are always Unicode."""
    try:
        path.mkdir()
    except OSError:
        pytest.skip("this file system takes names in UTF-8 only")
    return path


@pytest.mark.parametrize("words", COMMANDS, ids=lambda words: words[0])
def test_a_name_on_the_command_line_is_refused_in_one_line(tmp_path, words):
    named(tmp_path / BAD)
    (tmp_path / f"{BAD}.yaml").write_text("axial_force: 10\n")
    (tmp_path / "study.yaml").write_text(STUDY)
    line = trackroller_process(*words, cwd=tmp_path, code=2).stderr
    assert "not UTF-8" in line and "Rename" in line and "caf\ufffd" in line and len(line.splitlines()) == 1


def test_a_working_folder_with_such_a_name_is_refused_where_something_is_written(tmp_path):
    place = named(tmp_path / BAD)
    (place / "study.yaml").write_text(STUDY)
    (place / "case.yaml").write_text("axial_force: 10\ncontact_model: sliding\noutputs: [forces]\n")
    for words in (("run", "study.yaml", "-q"), ("solve", "case.yaml", "-o", "x.nc"), ("app", ".", "--no-browser")):
        line = trackroller(*words, cwd=place, code=2).stderr.splitlines()[-1]
        assert "not UTF-8" in line and "Rename" in line
    assert "tiny" in trackroller("plan", "study.yaml", cwd=place).stdout


def test_files_of_a_folder_with_such_names_are_left_out_of_the_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    named(tmp_path / BAD)
    (tmp_path / "results" / BAD).mkdir(parents=True)
    (tmp_path / "results" / BAD / "study.nc").write_bytes(b"")
    (tmp_path / BAD / "points.csv").write_text("0;0\n")
    (tmp_path / f"{BAD}.csv").write_text("0;0\n")
    (tmp_path / "points.csv").write_text("0;0\n")
    assert listing() == [] and all_fields()["files"] == ["points.csv"]


def test_python_refuses_such_names(tmp_path):
    for call in (
        lambda: check_utf_8(BAD, "file"),
        lambda: read_text(BAD, "file"),
        lambda: write_text(tmp_path / BAD, ""),
        lambda: StudyFolder(tmp_path / BAD).create(),
        lambda: tr.load_study(BAD),
        lambda: tr.Case(roller_profile={"file": BAD}),
    ):
        with pytest.raises(InputError) as caught:
            call()
        str(caught.value).encode()
    check_utf_8("größe µ 日本", "file")


def test_a_message_says_first_what_is_wrong(tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "latin").write_bytes("größe".encode("latin-1"))
    (tmp_path / "zero").write_bytes(b"a\0b")
    for name, wrong in {
        "nothing": "does not exist. Allowed: the path of a file. Check the path.",
        "folder": "is a folder. Allowed: a file. Give the path of a file.",
        "latin": "is not UTF-8 text at byte 2. Allowed: text in UTF-8",
        "zero": "holds zero bytes, so it is no text. Allowed: a text.",
    }.items():
        with pytest.raises(InputError) as caught:
            read_text(tmp_path / name, "case file")
        assert f"{tmp_path / name}' {wrong}" in str(caught.value)
    assert str(InputError("slip", None, "a number")) == "slip is missing or empty. Needed: a number"
    assert str(unknown_name("colour", "gren", ("green", "red"))).endswith(
        "is not known. Allowed: green, red. Did you mean 'green'?"
    )


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("solve", "gone.yaml"), "case file = 'gone.yaml' does not exist."),
        (("run", "gone.yaml"), "'gone.yaml' does not exist."),
        (("status", "gone"), "study = 'gone' is not there."),
        (("verify", "gone"), "folder = 'gone' exists neither here nor in results"),
        (("explore", "gone"), "holds no results."),
        (("app", "gone"), "folder = 'gone' does not exist."),
        (("solve", "-o", "gone/x.nc"), "stands in a folder that does not exist."),
        (("solve", "--set", "roller_profile={file: gone.csv}"), "'gone.csv' is not there."),
        (("spectrum", "gone.yaml"), "'gone.yaml' does not exist."),
        (("materials", "add", "x", "--set", "like=PA6", "--file", "/proc/x.yaml"), ""),
    ],
)
def test_a_missing_file_is_said_to_be_missing(tmp_path, words, told):
    line = trackroller(*words, cwd=tmp_path, code=2).stderr
    assert told in line and "is not usable" not in line and len(line.splitlines()) == 1


def test_a_home_that_is_not_known_is_no_folder(tmp_path):
    words = (
        "materials",
        "add",
        "x",
        "--set",
        "like=PA6",
        "--set",
        "tensile_strength=70",
        "--file",
        "~nobody-here/x.yaml",
    )
    line = trackroller(*words, cwd=tmp_path, code=2).stderr
    assert "names a home that this machine does not know" in line and not list(tmp_path.iterdir())


LONG = "n" * 300


@pytest.mark.parametrize(
    "words",
    [
        ("solve", f"{LONG}.yaml"),
        ("solve", "--set", "contact_model=sliding", "--set", "outputs=[forces]", "-o", f"{LONG}.nc"),
        ("report", LONG),
        ("status", LONG),
        ("verify", LONG),
        ("explore", LONG),
        ("rerun", LONG),
    ],
)
def test_a_name_that_is_too_long_is_named_as_such(tmp_path, words):
    line = trackroller(*words, cwd=tmp_path, code=2).stderr
    assert len(line.splitlines()) == 1, line
    assert "is too long: a name in it has 30" in line and "Give a shorter name." in line
