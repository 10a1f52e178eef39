"""`trackroller materials add` takes an S-N curve from a table."""

import hashlib

import pytest
from command_line import trackroller

from trackroller.materials import load_database


@pytest.mark.parametrize(
    "text",
    [
        "amplitude [MPa],cycles\n500,1e5\n400,5e6\n700,2e4\n",
        "cycles;amplitude [GPa]\n1e5;0,5\n5e6;0,4\n2e4;0,7\n",
    ],
)
def test_a_table_gives_the_points_and_its_digest(tmp_path, text):
    (tmp_path / "line.csv").write_text(text)
    words = ("--set", "like=1.7225-normalised", "--set", "sn_points=line.csv", "--set", "fatigue_limit_torsion=250")
    trackroller("materials", "add", "own", *words, "--file", "m.yaml", cwd=tmp_path)
    own = load_database(tmp_path / "m.yaml").material("own")
    assert [list(point) for point in own.sn_points] == [[pytest.approx(700), 2e4], [500, 1e5], [400, 5e6]]
    source = own.records["fatigue_strength_ratio"].source
    assert source == f"line.csv, SHA-256 {hashlib.sha256(text.encode()).hexdigest()}"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("amplitude [MPa],cycles\n500,1e5\n400,many\n", ("line 3", "cycles", "many", "a finite number")),
        ("stress,cycles\n500,1e5\n400,5e6\n", ("line 1", "amplitude [MPa] and cycles")),
        ("amplitude [km],cycles\n500,1e5\n400,5e6\n", ("line 1", "amplitude", "km")),
        ("amplitude [MPa],cycles\n500,1e5\n", ("at least two points",)),
    ],
)
def test_a_wrong_table_is_refused_with_its_line(tmp_path, text, words):
    (tmp_path / "line.csv").write_text(text)
    given = ("--set", "like=1.7225-normalised", "--set", "sn_points=line.csv", "--file", "m.yaml")
    told = trackroller("materials", "add", "own", *given, cwd=tmp_path, code=2).stderr
    assert all(word in told for word in words), told
    assert not (tmp_path / "m.yaml").exists()
