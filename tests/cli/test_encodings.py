"""Every command prints on a console of every encoding; a sign that it lacks is written in plain letters."""

from __future__ import annotations

import codecs
import os
import subprocess
import sys

import pytest

from trackroller.cli.main import _plain

CASE = (
    "case.yaml",
    "contact_model: sliding\naccuracy: preview\nradial_force: -150\nduty: {hours_per_day: 8, days_per_year: 220}\n",
)
STUDY = (
    "größe.yaml",
    "name: small\ndescription: Größe µ ≤ 3 – „groß“\ncontact_model: sliding\naccuracy: preview\n"
    "outputs: [forces, life]\nfactors: {axial_force: {values: [0, 30]}}\n",
)
SPECTRUM = "shift.yaml", "description: Größe\nblocks: [{name: größer ≥ 3, distance: 3 km}]\ncontact_model: sliding\n"
COMMANDS = [
    ["--help"],
    ["solve", "--help"],
    ["solve", CASE[0]],
    ["solve", CASE[0], "--json"],
    ["solve", CASE[0], "--limits", "all"],
    ["plan", "--set", "contact_angle=µ"],
    ["spectrum", SPECTRUM[0]],
    ["materials", "list"],
    ["materials", "show", "PA6"],
    ["materials", "friction"],
    ["materials", "add", "größer", "--set", "like=PA6", "--set", "youngs_modulus=2 µm", "--file", "own.yaml"],
    ["plan", STUDY[0]],
    ["run", STUDY[0]],
    ["status", "small"],
]
ALL = [
    ["report", "small"],
    ["explore", "small"],
    ["plot", "small"],
    ["repeat", "small", "0"],
    ["verify", "small"],
    ["rerun", "small"],
]
MARK = "=== end of an encoding ==="
DRIVER = """
import os, sys
from trackroller.cli.main import main
for encoding in {encodings!r}:
    os.chdir(encoding)
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(encoding=encoding, errors="strict")
    for words in {commands!r}:
        sys.argv = ["trackroller", *words]
        try:
            main()
        except SystemExit as end:
            if end.code not in (0, 2):
                raise SystemExit(f"{{words}}: {{end.code}}")
    os.chdir("..")
    for stream in (sys.stdout, sys.stderr):
        print({mark!r}, file=stream, flush=True)
"""


def run(commands, encodings, folder):
    """Run commands on a console of each encoding, all in one process, and return what it printed by encoding."""
    for encoding in encodings:
        (folder / encoding).mkdir()
        for name, text in (CASE, STUDY, SPECTRUM):
            (folder / encoding / name).write_text(text, encoding="utf-8")
    words = [sys.executable, "-c", DRIVER.format(commands=commands, encodings=encodings, mark=MARK)]
    known = os.environ | {"PYTHONIOENCODING": encodings[0], "COLUMNS": "80"}
    done = subprocess.run(words, cwd=folder, env=known, capture_output=True, timeout=300)
    assert done.returncode == 0, done.stderr.decode(errors="replace")
    outs, errs = (text.split(MARK.encode())[:-1] for text in (done.stdout, done.stderr))
    for err, encoding in zip(errs, encodings, strict=True):
        assert "codec" not in err.decode(encoding) and "internal error" not in err.decode(encoding)
    return {encoding: out.decode(encoding) for out, encoding in zip(outs, encodings, strict=True)}


@pytest.mark.long
def test_commands_print_in_every_encoding(tmp_path):
    printed = run(COMMANDS, ["ascii", "cp1252", "cp437", "utf-8"], tmp_path)
    for encoding, out in printed.items():
        assert "MPa" in out and "1.7225-normalised" in out
        assert ("größer" in out) == (encoding != "ascii"), encoding
    assert "≤" in printed["utf-8"] or "≥" in printed["utf-8"]
    line = next(line for line in printed["ascii"].splitlines() if "motor force F_Motor" in line)
    assert " -30 " in line and "?" not in line


def test_units_and_exponents_are_read_without_utf_8():
    codecs.register_error("plain", _plain)
    text = "−3·10⁻⁵ µm, 2 mm², ±20 °C, größer → ≤ ∞"
    assert text.encode("ascii", "plain") == b"-3*10^-5 um, 2 mm^2, +-20 degC, gro?er -> <= inf"
    assert text.encode("cp437", "plain").decode("cp437") == "-3·10^-5 µm, 2 mm², ±20 °C, größer -> ≤ ∞"


@pytest.mark.long
def test_commands_on_a_solved_study_print_in_every_encoding(tmp_path):
    printed = run([["run", STUDY[0]], *ALL], ["ascii", "cp437"], tmp_path)
    assert all("report.html" in out for out in printed.values())
