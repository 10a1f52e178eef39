"""Bad input ends with exit code 2 and one line that names it; valid input is accepted."""

from __future__ import annotations

import math
import os
import re
from pathlib import Path

import pytest
from examples import EXAMPLES
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import trackroller as tr
from trackroller.cli.main import app, run_app
from trackroller.errors import InputError
from trackroller.numerics.units import split_quantity
from trackroller.parameters import PARAMETERS
from trackroller.roller.case import Case
from trackroller.yaml_file import parse_mapping

GRID = "name: t\nfactors: {axial_force: {values: [0, 10]}}\n"
SAMPLE = "name: t\nfactors: {axial_force: {uniform: [0, 10]}}\ndesign: lhs\n"
TABLE = "name: t\ndesign: table\ntable: cases.csv\n"
EXPRESSION = "name: t\nfactors: {axial_force: {values: [0, 10]}, motor_force: {expression: '%s'}}\n"

STUDIES = {
    "a table that is not UTF-8": (TABLE, "axial_force,höhe\n1,2\n".encode("latin-1"), "table"),
    "nan in a table": (TABLE, b"axial_force\nnan\n3\n", "axial_force"),
    "a huge cell": (TABLE, b"axial_force,note\n1," + b"x" * 140_000 + b"\n2,b\n", "table"),
    "digits of another script in a table": (TABLE, "axial_force\n３\n4\n".encode(), "axial_force"),
    "an underscore in a table": (TABLE, b"axial_force\n3_0\n4\n", "axial_force"),
    "a number too small for the computer": (
        TABLE,
        b"axial_force\n1e-400\n4\n",
        "line 2: axial_force = '1e-400' is too small",
    ),
    "a number too large for the computer": (
        TABLE,
        b"axial_force\n1e400\n4\n",
        "line 2: axial_force = '1e400' is too large",
    ),
    "a file that is no YAML": ("name: [t\n", b"", "study or case file"),
    "a table named by its whole path": (TABLE.replace("cases.csv", "/etc/hostname"), b"", "table"),
    "a table above the folder": (TABLE.replace("cases.csv", "../cases.csv"), b"", "table"),
    "400 signs in an expression": (EXPRESSION % ("-" * 400 + "axial_force"), b"", "motor_force"),
    "400 brackets in an expression": (EXPRESSION % ("(" * 400 + "axial_force" + ")" * 400), b"", "motor_force"),
    "a tower of powers": (EXPRESSION % "9**9**9**9", b"", "motor_force"),
    "the tangent of degrees": (EXPRESSION % "tan(contact_angle)", b"", "radians"),
    "true for samples": (SAMPLE + "samples: true\n", b"", "samples"),
    "true for the seed": (SAMPLE + "seed: true\n", b"", "seed"),
    "true for the chunk size": (SAMPLE + "chunk_size: true\n", b"", "chunk_size"),
    "a text for samples": (SAMPLE + 'samples: "30"\n', b"", "samples"),
    "an octal number": (SAMPLE + "samples: 030\n", b"", "030"),
    "a number to base 60": (GRID + "base:\n  motor_force: 1:30\n", b"", "1:30"),
    "more rows than can be planned": (SAMPLE + "samples: 99999999999\n", b"", "samples"),
    "a number as a condition": (GRID + "stop_if: 3\n", b"", "stop_if"),
    "a mapping as an accuracy": (GRID + "accuracy: {a: 1}\n", b"", "accuracy"),
    "a number as outputs": (GRID + "outputs: 3\n", b"", "outputs"),
    "a list in the outputs": (GRID + "outputs: [[forces]]\n", b"", "outputs"),
}


def _refused(capsys, *words: str) -> str:
    """Run a command that must end with exit code 2 and return its one line."""
    assert run_app(lambda: app(list(words))) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1 and lines[0].startswith("trackroller: ")
    return lines[0]


@pytest.mark.parametrize("name", STUDIES)
def test_a_bad_study_is_refused_in_one_line(name, tmp_path, monkeypatch, capsys):
    text, table, named = STUDIES[name]
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(text, encoding="utf-8")
    Path("cases.csv").write_bytes(table)
    assert named in _refused(capsys, "plan", "study.yaml")


@pytest.mark.parametrize(
    "name", ["case", "contact", "body", "regime", "converged", "reason", "validity", "normal_force"]
)
def test_a_factor_cannot_have_a_name_of_the_results(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(
        f"name: t\nfactors: {{{name}: {{values: [1, 2]}}, axial_force: {{expression: '{name} * 2'}}}}\n"
    )
    assert f"factors.{name}" in _refused(capsys, "plan", "study.yaml")
    Path("cases.csv").write_text(f"axial_force,{name}\n1,5\n2,6\n")
    Path("study.yaml").write_text(TABLE)
    assert name in _refused(capsys, "plan", "study.yaml")


@pytest.mark.parametrize(
    "word",
    [
        "friction_law={kind: {a: 1}}",
        "friction_law={kind: table, speed: [0, 1, 2], friction: [0.3, 0.2]}",
        "friction_law={kind: table, speed: [[0], 1], friction: [0.3, 0.2]}",
        "accuracy=[standard]",
        "accuracy={a: 1}",
        "outputs={forces: 1}",
        "stop_if=[1]",
        "slip_terms=3",
        "contact_model=3",
        "shortcuts=3",
        "axial_force=" + "9" * 400,
        'axial_force="3_0"',
        'axial_force="３0"',
        "axial_force=1\nmotor_force: 2",
        "roller_profile={points: [[0, 0], [1]]}",
    ],
)
def test_a_bad_setting_is_refused_in_one_line(word, capsys):
    assert word.partition("=")[0] in _refused(capsys, "solve", "--set", word)


@pytest.mark.parametrize("name", ["x.csv", "x", "x.xlsx", "x.json", "x.nc.gz", ".nc"])
def test_a_file_is_what_its_name_says(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("shift.yaml").write_text("blocks: [{distance: 10, radial_force: -200}]\n")
    solve = [] if name == "x.xlsx" else [["solve"]]  # one roller may be a workbook
    for words in (*solve, ["spectrum", "shift.yaml"], ["wear"]):
        assert "ends in .nc" in _refused(capsys, *words, "-o", name)
    assert "ends in .html" in _refused(capsys, "explore", "study", "-o", name)
    assert os.listdir() == ["shift.yaml"]


def test_wear_does_not_go_on_from_another_file(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("notes.nc").write_text("no netCDF")
    assert "Give another name" in _refused(capsys, "wear", "-o", "notes.nc")
    assert Path("notes.nc").read_text() == "no netCDF"


@pytest.mark.parametrize("path", [".", "/dev/null", "missing/out.nc"])
def test_only_a_regular_file_is_written(path, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert "--out" in _refused(capsys, "solve", "-o", path)
    assert Path("/dev/null").is_char_device()


def test_a_symbolic_link_is_followed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("out.nc").symlink_to("target.nc")
    assert run_app(lambda: app(["solve", "-o", "out.nc"])) == 0
    assert Path("out.nc").is_symlink() and Path("target.nc").stat().st_size > 0


def test_a_device_is_not_read(capsys):
    assert "/dev/zero" in _refused(capsys, "plan", "/dev/zero")


def test_an_error_of_the_program_is_one_line_with_a_log(capsys):
    def broken():
        raise ZeroDivisionError("not thought of")

    assert run_app(broken) == 3
    told = capsys.readouterr().err
    log = re.search(r"log (\S+)", told)
    assert log is not None and len(told.splitlines()) == 1
    assert "not thought of" in Path(log[1]).read_text(encoding="utf-8")


# valid and invalid texts that a user may write for a number
digits = st.integers(0, 10**6).map(str)
sense = st.one_of(
    st.integers(-(10**6), 10**6).map(str),
    st.floats(-1e6, 1e6, allow_nan=False).map(lambda v: f"{v:.6g}"),
    st.floats(-1e3, 1e3, allow_nan=False).map(lambda v: f"'{v:.4f}'"),
    st.tuples(digits, st.integers(-3, 3)).map(lambda p: f"{p[0]}e{p[1]}"),
)
nonsense = st.one_of(
    st.booleans().map(str),
    st.sampled_from(
        ["yes", "off", ".nan", "nan", "'nan'", "0x10", "0o17", "1e400", "'1e400'", "~x", "--3", "1,5", "3 N"]
    ),
    digits.map(lambda v: f"0{v}"),
    digits.map(lambda v: f"{v}_0"),
    digits.map(lambda v: f"'{v}_0'"),
    digits.map(lambda v: f"{v}:30"),
    digits.map(lambda v: v.translate(str.maketrans("0123456789", "０１２３４５６７８９"))),
    digits.map(lambda v: f"[{v}]"),
    digits.map(lambda v: f"{{a: {v}}}"),
)


def _means(text: str) -> float | None:
    """Return the number that a text means, None where it means none, by rules independent of the package."""
    bare = text[1:-1] if text[:1] == text[-1:] == "'" else text
    if not re.fullmatch(r"[-+]?\d+(\.\d*)?([eE][-+]?\d+)?", bare, re.ASCII):
        return None
    if bare is text and re.fullmatch(r"[-+]?0\d+", bare):
        return None
    return float(bare)


@settings(max_examples=EXAMPLES, derandomize=EXAMPLES <= 1000)
@given(st.sampled_from(["radial_force", "velocity", "contact_angle", "axial_force", "motor_force"]), sense | nonsense)
def test_a_number_is_taken_exactly_if_it_means_one_inside_its_bounds(name, text):
    assume(not split_quantity(text.strip("'")))  # tests/numerics/test_units.py
    parameter, number = PARAMETERS[name], _means(text)
    inside = number is not None and math.isfinite(number) and parameter.lower <= number <= parameter.upper
    if inside and (
        (parameter.open_lower and number == parameter.lower) or (parameter.open_upper and number == parameter.upper)
    ):
        inside = False
    try:
        case = Case.from_dict(parse_mapping(f"{name}: {text}", "case file"))
    except InputError as exc:
        assert not inside or exc.field != name, f"{name}: {text} is refused: {exc}"
        return
    assert inside, f"{name}: {text} is accepted as {getattr(case, name)}"
    assert getattr(case, name) == number


@pytest.mark.parametrize(
    ("word", "remedy"),
    [
        ("radial_force=120", "Write -120. The sign means: < 0 presses the roller on the guide."),
        ("axis_distance=-20", "Write 20."),
        ("outer_radius=16", "Add the other one, or give axis_distance."),
        ("outer_raduis=16", "Did you mean 'outer_radius'?"),
        ("reliability=0.9", "similar meaning: failure_probability."),
        ("friction=0.1", "similar meaning: friction_coefficient, friction_law."),
        ("angle=30", "Did you mean 'contact_angle'?"),
        ("velocty=30", "Did you mean 'velocity'?"),
    ],
)
def test_a_remedy_is_named_only_where_it_is_meant(word, remedy, capsys):
    assert run_app(lambda: app(["solve", "--set", word])) == 2
    assert remedy in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [["solve", "--nonsense", "3"], ["frobnicate"], ["report"], ["run", "s.yaml", "--cores", "x"], ["solve", "--set"]],
)
def test_a_usage_error_is_one_line_that_names_the_help(words, capsys):
    assert "--help`." in _refused(capsys, *words)


def test_several_wrong_keys_of_a_mapping_are_named_together():
    study = {
        "name": "t",
        "base": {"bearing": {"rowz": 1, "row_distanze": 8}},
        "factors": {"axial_force": {"values": [1]}},
    }
    with pytest.raises(tr.InputError) as refused:
        tr.load_study(study)
    assert "base.bearing: key = 'rowz'" in str(refused.value)
    assert "base.bearing: key = 'row_distanze'" in str(refused.value)
