"""The commands `trackroller fit`."""

from __future__ import annotations

import errno
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from trackroller.cli.main import app
from trackroller.errors import InputError
from trackroller.fit.examples import FILES
from trackroller.report import html

COUPONS = (
    "amplitude [MPa],cycles,failed\n900,90000,yes\n900,130000,yes\n800,200000,yes\n800,350000,yes\n700,800000,yes\n"
    "700,1000000,yes\n"
)
SN = ["fit", "sn", "coupons.csv", "--as", "hardened rail", "--load-type", "axial", "--stress-ratio", "-1"]


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "coupons.csv").write_text(COUPONS)
    return tmp_path


@pytest.mark.slow
def test_coupons_become_a_material_and_a_page(place):
    done = CliRunner().invoke(app, [*SN, "--like", "1.7225-normalised"])
    assert done.exit_code == 0, done.output
    assert "6 of 6 tests failed by fatigue: fatigue strength" in done.output
    page = (place / "fit-hardened-rail.html").read_text()
    assert "What the tests cannot tell" in page
    assert "extrapolated" in page
    assert "hardened rail" in (place / "config" / "materials.yaml").read_text()


def test_load_type_and_stress_ratio_are_asked_for(place):
    done = CliRunner().invoke(app, SN[:5])
    assert done.exit_code == 2


def test_a_wrong_row_is_told_by_file_and_line(place):
    (place / "coupons.csv").write_text(COUPONS.replace("yes", "perhaps", 1))
    done = CliRunner().invoke(app, SN)
    assert isinstance(done.exception, InputError)
    assert str(done.exception).startswith("coupons.csv, line 2: failed = 'perhaps'")


@pytest.mark.slow
def test_a_page_that_cannot_be_written_leaves_no_material_and_a_refused_material_no_page(place, monkeypatch):
    named = [*SN, "--like", "1.7225-normalised"]

    def full(*args, **more):
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(html, "write_page", full)
        assert CliRunner().invoke(app, named).exit_code != 0
    assert [path.name for path in place.rglob("*") if path.is_file()] == ["coupons.csv"]
    assert CliRunner().invoke(app, named).exit_code == 0
    before = {path: path.read_bytes() for path in place.rglob("*") if path.is_file()}
    assert len(before) == 4
    (place / "coupons.csv").write_text(COUPONS.replace("90000", "95000"))
    refused = CliRunner().invoke(app, named)
    assert isinstance(refused.exception, InputError)
    assert "--replace" in str(refused.exception)
    own = place / "coupons.csv"
    assert {path: path.read_bytes() for path in before if path != own} == {
        path: content for path, content in before.items() if path != own
    }
    assert CliRunner().invoke(app, [*named, "--replace"]).exit_code == 0
    assert all(path.read_bytes() != content for path, content in before.items())


PAGES = ("tests.md", "tutorial/from-bench-to-life.md")


def test_the_examples_are_the_files_that_the_pages_show(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["fit", "example", "new"])
    assert done.exit_code == 0, done.output
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == sorted(FILES)
    docs = Path(__file__).parents[2] / "docs"
    shown = [
        hit
        for page in PAGES
        for hit in re.findall(r"<!-- file: (\S+) -->\n```\w+\n(.*?)```", (docs / page).read_text(), re.S)
    ]
    assert len(shown) == 6
    for name, text in shown:
        assert (tmp_path / "new" / name).read_text() == text, name


def test_an_example_does_not_replace_a_file_of_the_user(tmp_path):
    (tmp_path / "rig.yaml").write_text("motor_force: 3\n")
    done = CliRunner().invoke(app, ["fit", "example", str(tmp_path)])
    assert isinstance(done.exception, InputError)
    assert "holds another rig.yaml" in str(done.exception)
    assert [path.name for path in tmp_path.iterdir()] == ["rig.yaml"]
