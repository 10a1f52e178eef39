"""The documentation says what is so: code blocks run, tables are those of the code, links lead somewhere."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = sorted((ROOT / "docs").rglob("*.md"))
PAGES = [p for p in (ROOT / "README.md", *DOCS) if p.is_file()]
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.M | re.S)
COMMENT = re.compile(r"<!--\s*(not run|file):[ \t]*([^\n]*?)[ \t]*-->\s*\Z")
PROMISE = re.compile(r"#\s*(cases \d+, \d+ of them solved already)")
FIGURES = "plot"  # drawing is proved elsewhere and takes its time
LARGEST_STUDY = 60


def blocks(page: Path) -> list[tuple[str, str, str, str]]:
    """Language, code, kind of the comment right before it ('not run', 'file' or '') and the comment's text."""
    text = page.read_text(encoding="utf-8")
    found = []
    for hit in BLOCK.finditer(text):
        mark = COMMENT.search(text[: hit.start()])
        found.append((hit[1], hit[2], mark[1] if mark else "", mark[2] if mark else ""))
    return found


def file_of(code: str, name: str) -> str:
    """Where a YAML block belongs: as its comment says, else by what it holds."""
    if name:
        return name
    if re.search(r"^(factors|design):", code, re.M):
        return "study.yaml"
    return "config/materials.yaml" if re.search(r"^(materials|friction):", code, re.M) else "case.yaml"


def small(code: str) -> str:
    """A study with fewer levels, so that a test can solve it."""
    return re.sub(r"(linspace: \[[^\],]+, [^\],]+, )\d+\]", r"\g<1>2]", code)


def commands(code: str) -> list[str]:
    lines = re.sub(r"\\\n", " ", code).splitlines()
    return [line for line in lines if line.startswith("trackroller ")]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_every_code_block_runs(page, tmp_path, monkeypatch):
    """In the order of the page, in an empty folder, as a reader would do it."""
    from typer.testing import CliRunner

    from trackroller.cli.main import app
    from trackroller.errors import InputError
    from trackroller.study.config import load_study

    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("TRACKROLLER_MATERIALS", raising=False)
    for language, code, mark, text in blocks(page):
        if mark == "not run":
            assert text, f"{page.name}: say why a block is not run"
        elif language == "yaml":
            path = tmp_path / file_of(code, text)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(small(code) if page.name == "README.md" else code, encoding="utf-8")
            if path.name == "study.yaml":
                assert load_study(path).design().sizes["case"] <= LARGEST_STUDY
        elif language == "csv":
            (tmp_path / text).write_text(code, encoding="utf-8")
        elif language == "python":
            exec(compile(code, f"{page.name}", "exec"), {"__name__": "__docs__"})
        elif language == "bash":
            for line in commands(code):
                words = shlex.split(line, comments=True)[1:]
                if words[0] == FIGURES:
                    continue
                done = CliRunner().invoke(app, words)
                failure = done.exception if isinstance(done.exception, InputError) else done.output
                assert done.exit_code == 0, f"{page.name}: {line}\n{failure}"
                promise = PROMISE.search(line)
                assert promise is None or promise[1] in re.sub(r"\s+", " ", done.output), done.output


def test_tables_are_those_of_the_code():
    """docs/parameters.md and the presets in docs/accuracy.md are what docs/generate.py makes."""
    words = [sys.executable, str(ROOT / "docs" / "generate.py"), "--check"]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0, f"run: python docs/generate.py\n{done.stderr}"


def test_links_between_pages_lead_to_files():
    """No relative link of a page is dead."""
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text(encoding="utf-8")):
            if "://" not in target:
                assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_the_command_is_installed():
    """The pages call it `trackroller`."""
    assert shutil.which("trackroller") or (Path(sys.executable).parent / "trackroller").exists()


def test_python_interface_is_that_of_the_code():
    done = subprocess.run([sys.executable, str(ROOT / "docs" / "api.py"), "--check"], check=False)
    assert done.returncode == 0, "run: python docs/api.py"


def test_errors_of_the_dimensionless_table_are_those_it_states():
    """Every kind of error that the table was measured for stands in the page, rounded."""
    from trackroller.contact import table

    stated = table.stored().errors
    text = (ROOT / "docs" / "contact-models.md").read_text(encoding="utf-8")
    rows = {
        "like_force": "bodies of one kind",
        "unlike_force": "unlike bodies, abs",
        "like_stick": "share of stick, K = 0",
        "unlike_stick": "share of stick, unlike",
    }
    assert {name.rsplit("_", 1)[0] for name in stated if "_" in name} == set(rows)
    for name, start in rows.items():
        (cells,) = re.findall(rf"\| {re.escape(start)}[^|]*\|([^|]*)\|([^|]*)\|([^|]*)\|", text)
        told = [float(cell.strip(" %")) / 100 for cell in cells]
        assert told == pytest.approx([stated[f"{name}_{what}"] for what in ("median", "p99", "worst")], rel=0.25)
