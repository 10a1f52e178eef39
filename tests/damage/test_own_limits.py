"""A limit of a user's own in config/limits: only with --allow-code, and with its digest in all that it touched."""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CASE = "{motor_force: 0, roller_material: {like: 1.7225-normalised, permissible_pressure: 500}}\n"
MATERIALS = "materials:\n  lined: {like: 1.7225-normalised, permissible_pressure: 500}\n"
STUDY = """name: own
base: {motor_force: 0, roller_material: lined}
factors: {friction_coefficient: {values: [0.1, 0.3]}}
outputs: [forces, contact, lining, peak_stress, life]
contact_model: sliding
accuracy: preview
"""


@pytest.fixture
def place(tmp_path):
    recipe = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("## Add a damage limit")[2]
    (tmp_path / "config" / "limits").mkdir(parents=True)
    lines = re.search(r"```python\n(.*?)```", recipe, re.DOTALL)[1]
    (tmp_path / "config" / "limits" / "lining.py").write_text(lines, encoding="utf-8")
    (tmp_path / "config" / "materials.yaml").write_text(MATERIALS, encoding="utf-8")
    (tmp_path / "case.yaml").write_text(CASE, encoding="utf-8")
    (tmp_path / "study.yaml").write_text(STUDY, encoding="utf-8")
    return tmp_path


def command(place, *words, code=0):
    line = [sys.executable, "-m", "trackroller.cli", *words]
    done = subprocess.run(line, cwd=place, capture_output=True, text=True)
    assert done.returncode == code and "Traceback" not in done.stderr, done.stderr
    return done.stdout + done.stderr


def solve(place, *more, code=0, outputs="contact,lining"):
    quick = [w for key in (f"outputs={outputs}", "contact_model=sliding") for w in ("--set", key)]
    return command(place, "solve", "case.yaml", "--json", *quick, *more, code=code)


@pytest.mark.slow
def test_code_runs_only_where_it_is_allowed(place):
    (place / "config" / "limits" / "lining.py").write_text("print('ran')\n")
    (place / "config" / "materials.yaml").unlink()  # values of a material are known with their limit only
    (place / "case.yaml").write_text("motor_force: 0\n")
    said = solve(place, code=2)
    assert "lining.py declares it: add --allow-code" in said and "ran" not in said
    assert "lining.py declares it: add --allow-code" in command(place, "solve", "--limits", "lining", code=2)
    said = solve(place, "--allow-code", code=2)
    assert "must declare LIMIT = Limit(name='lining', ...)" in said
    assert len(said.splitlines()) == 2 and said.startswith("ran")


@pytest.mark.slow
def test_a_limit_of_the_user_stands_in_the_results(place):
    found = json.loads(solve(place, "--allow-code"))
    used, pressure = found["lining_utilisation"]["value"], found["max_pressure"]["value"]
    assert [row[0] for row in used] == pytest.approx([p / 500.0 for p in pressure], rel=1e-12)


@pytest.mark.long
def test_a_study_names_the_digest_and_an_edited_limit_solves_anew(place):
    file = place / "config" / "limits" / "lining.py"
    assert "2 cases" in command(place, "run", "study.yaml", "--allow-code")
    command(place, "report", "own", "--allow-code")
    crate = (place / "results" / "own" / "ro-crate-metadata.json").read_text(encoding="utf-8")
    assert "config/limits/lining.py" in crate and hashlib.sha256(file.read_bytes()).hexdigest() in crate
    assert "limits that are loaded, here lining" in command(place, "report", "own", code=2)  # nothing is half read
    assert "2 of them solved already" in command(place, "plan", "study.yaml", "--allow-code")
    file.write_text(file.read_text(encoding="utf-8").replace("pressure / solved", "2.0 * pressure / solved"))
    assert "0 of them solved already" in command(place, "plan", "study.yaml", "--allow-code")


def test_names_that_exist_and_empty_folders_are_refused(place):
    file = place / "config" / "limits" / "lining.py"
    declared = re.compile(r'Parameter\(\s*"permissible_pressure"')
    file.write_text(declared.sub('Parameter("density"', file.read_text(encoding="utf-8")))
    assert "density' is a value of a material" in solve(place, "--allow-code", code=2)
    file.unlink()
    assert "a folder with limits" in solve(place, "--allow-code", code=2)


@pytest.mark.long
def test_the_file_of_a_limit_is_an_input_of_a_study(place):
    file = place / "config" / "limits" / "lining.py"
    used = file.read_bytes()
    (place / "edit.py").write_text(
        "import sys\nfrom pathlib import Path\nfrom trackroller.study.file.load import load_study\n"
        "from trackroller.study.run import run_study\nstudy = load_study('study.yaml')\n"
        "def told(line):\n    Path('config/limits/lining.py').open('a').write('# later\\n')\n"
        "try:\n    run_study(study, tell=told)\nexcept Exception as exc:\n    sys.exit(str(exc))\n"
    )
    (place / "study.yaml").write_text(STUDY + "chunk_size: 1\n")
    allowed = os.environ | {"TRACKROLLER_ALLOW_CODE": "config/limits"}
    words = [sys.executable, "edit.py"]
    done = subprocess.run(words, cwd=place, env=allowed, capture_output=True, text=True)
    assert done.returncode == 1 and re.search("lining.py was edited.*SHA-256 was .* and is", done.stderr), done.stderr
    assert (place / "results" / "own" / "inputs" / "limits" / "lining.py").read_bytes() == used
    assert len(list((place / "results" / "own" / "chunks").iterdir())) == 1


@pytest.mark.slow
def test_a_file_may_import_parameters_from_the_catalogue_and_must_not_take_a_name(place):
    """`parameters` loads the files while it is imported itself, and it has `Parameter` by then."""
    file = place / "config" / "limits" / "lining.py"
    lines = file.read_text(encoding="utf-8")
    file.write_text(lines.replace("trackroller.numerics.parameter import", "trackroller.parameters import"))
    assert json.loads(solve(place, "--allow-code"))["lining_utilisation"]["value"]
    file.write_text(lines.replace('"permissible_pressure"', '"hardness"'))
    said = solve(place, "--allow-code", code=2)
    assert "'hardness' is a value of a material already" in said


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ("def evaluate", "import sys; sys.exit(0)\ndef evaluate", "stops with SystemExit: 0"),
        ("def evaluate", "raise SystemExit\ndef evaluate", "stops with SystemExit"),
        ("def evaluate", "def evaluate(:", "stops with SyntaxError"),
        ("def evaluate", "1 / 0\ndef evaluate", "stops with ZeroDivisionError"),
        ('"max_pressure"', '"max_presure"', "stops with KeyError: 'max_presure'"),
        ("    pressure = solved", "    raise SystemExit(0)\n    pressure = solved", "stops with SystemExit: 0"),
        ('worst(results["lining_utilisation"])', 'worst(results["lining"])', "stops with KeyError: 'lining'"),
    ],
)
def test_an_error_of_a_file_names_the_file_and_its_line(place, old, new, why):
    file = place / "config" / "limits" / "lining.py"
    lines = file.read_text(encoding="utf-8").replace(old, new)
    file.write_text(lines)
    said = solve(place, "--allow-code", code=2, outputs="contact,lining,limits")
    row = lines[: lines.index(new)].count("\n") + 1
    assert re.search(rf"lining\.py, line {row}: limits = 'lining\.py' {why}", said), said
    assert "internal error" not in said


def test_a_file_that_exits_does_not_vouch_for_a_damaged_folder(place):
    (place / "config" / "limits" / "lining.py").write_text("import sys\nsys.exit(0)\n")
    (place / "results" / "own").mkdir(parents=True)
    assert "lining.py, line 2" in command(place, "verify", "results/own", "--allow-code", code=2)
    assert command(place, "verify", "results/own", code=2)


UNKNOWN = "lining.py declares it: add --allow-code"


def test_every_command_that_meets_a_value_of_a_limit_names_how_to_load_it(place):
    assert UNKNOWN in solve(place, code=2)
    values = ("--set", "like=1.7225-normalised", "--set", "permissible_pressure=500")
    assert UNKNOWN in command(place, "materials", "add", "other", *values, code=2)
    assert UNKNOWN in command(place, "materials", "list", code=2)
    command(place, "materials", "add", "other", *values, "--allow-code")
    assert "permissible_pressure" in (place / "config" / "materials.yaml").read_text().partition("other")[2]


@pytest.mark.long
def test_a_solved_study_says_which_limit_it_needs_and_the_remedy_works(place):
    command(place, "run", "study.yaml", "--allow-code")
    for words in (("best", "own"), ("status", "own"), ("report", "own"), ("repeat", "own", "1"), ("rerun", "own")):
        assert UNKNOWN in command(place, *words, code=2), words
    command(place, "best", "own", "--allow-code")
    elsewhere = place / "elsewhere"
    shutil.copytree(place / "results" / "own", elsewhere / "own")
    said = command(elsewhere, "rerun", "own", code=2)
    assert "here lining. Read own/inputs/limits/lining.py, copy it to config/limits, and add --allow-code." in said
    (elsewhere / "config" / "limits").mkdir(parents=True)
    shutil.copy(elsewhere / "own" / "inputs" / "limits" / "lining.py", elsewhere / "config" / "limits")
    assert "have the same values" in command(elsewhere, "rerun", "own", "--allow-code")
