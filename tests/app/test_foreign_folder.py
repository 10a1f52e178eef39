"""The page in a folder that somebody else filled: no link is followed out of it, and no Python file of it runs."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from live_page import STUDY, LivePage

import trackroller as tr

pytest.importorskip("tornado")
ROOT = Path(__file__).parents[2]
LINKED = {
    "studies/x.yaml": "/etc/passwd",
    "studies": "outside",
    "results": "outside",
    "results/x": "outside",
    "results/x/chunks": "outside",
    "results/x/inputs": "outside",
    "results/x/page.log": "outside/precious",
    "results/x/.page.json": "outside/precious",
    "results/x/report.html": "outside/precious",
    "config/materials.yaml": "/etc/passwd",
    "points.csv": "outside/points.csv",
    ".trackroller": "outside",
}
POINTS = {"roller_profile": "{file: points.csv}", "normal": "halfspace"}


@pytest.mark.slow
@pytest.mark.parametrize("link", LINKED)
def test_links_out_of_the_folder_are_not_followed(tmp_path, link):
    """Nothing behind a link is shown, listed, changed or deleted."""
    outside, folder = tmp_path / "outside", tmp_path / "folder"
    outside.mkdir()
    (outside / "precious").write_text("kind: 4711 secret\n")
    (outside / "x.yaml").write_text("name: x\ndescription: 4711 secret\n")
    (outside / "points.csv").write_text("4711;secret\n")
    (outside / "more.csv").write_text("0;0\n")
    (folder / link).parent.mkdir(parents=True)
    (folder / link).symlink_to(tmp_path / LINKED[link])
    before = {path: path.read_bytes() for path in outside.iterdir()}
    page = LivePage(folder)
    if link == ".trackroller":
        assert page.process.wait(60) == 2 and "link" in page.process.stderr.read()
        told = []
    else:
        told = [page.ask(question, name="x") for question in ("text_of", "pause", "resume")]
        told += [
            page.ask("delete", name="x", confirm="x"),
            page.ask("text_of", name="x"),
            page.ask("headlines", name="x"),
            page.get("results/x/report.html"),
        ]
        told += [page.ask("start", text=STUDY.replace("small", "x")), page.ask("picture", values={})]
        told += [page.ask("picture", values=POINTS), page.ask("all_fields"), page.ask("listing")]
        if link.startswith("results/x/"):
            entry = page.entry("x")
            assert entry["state"] == "stopped" and "link" in entry["error"]
        page.stop()
    assert all(status in (200, 404, 409, 422) for status, *_ in told), told
    assert not any(word in str(told) for word in ("4711", "root:", "more.csv"))
    assert {path: path.read_bytes() for path in outside.iterdir()} == before


def poison(folder, mark):
    """Write Python files that note that they were imported, named as the modules that this program imports."""
    text = f"import pathlib\npathlib.Path({str(mark)!r}).touch()\nraise ImportError('from the working folder')\n"
    for name in ("portalocker", "numpy", "tornado", "trackroller", "xarray", "typer", "decimal", "pickle", "selectors"):
        (folder / f"{name}.py").write_text(text)


WAYS = [pytest.param(way, marks=pytest.mark.long) for way in ("allow code", "notebook", "empty path")]


@pytest.mark.slow
@pytest.mark.parametrize("way", ["another folder", *WAYS])
def test_no_python_file_of_the_folder_is_executed(tmp_path, monkeypatch, way):
    mark, folder = tmp_path / "executed", tmp_path / "folder"
    folder.mkdir()
    poison(folder, mark)
    if way == "allow code":
        (folder / "config" / "limits").mkdir(parents=True)
        recipe = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("## Add a damage limit")[2]
        lines = recipe.partition("```python\n")[2].partition("```")[0]
        (folder / "config" / "limits" / "lining.py").write_text(lines, encoding="utf-8")
        page = LivePage(Path(), "--allow-code", cwd=folder)
    elif way == "notebook":
        monkeypatch.chdir(folder)
        shown = tr.app(folder=folder)
        page = LivePage.__new__(LivePage)
        page.address = shown.address
    else:
        empty = {"PYTHONPATH": f"{os.environ.get('PYTHONPATH', '')}{os.pathsep}"} if way == "empty path" else {}
        page = LivePage(folder, env=empty)
    status, found = page.ask("start", text=STUDY)
    assert status == 200, found
    assert page.until("small", "done", "stopped")["state"] == "done", (folder / "results/small/page.log").read_text()
    shown.close() if way == "notebook" else page.stop()
    assert not mark.exists()
