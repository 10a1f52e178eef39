"""The documentation is true: code blocks run and print what they show, tables match the code, links are alive."""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import inspect
import io
import json
import re
import shlex
import shutil
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from test_docstrings import exported_names

ROOT = Path(__file__).parents[2]
DOCS = sorted((ROOT / "docs").rglob("*.md"))
PAGES = [p for p in (ROOT / "README.md", *DOCS) if p.is_file()]
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.M | re.S)
OUTPUT = re.compile(r"\A\n```text\n(.*?)^```", re.M | re.S)  # right after a Python block: what it prints
COMMENT = re.compile(r"<!--\s*(not run|file):[ \t]*([^\n]*?)[ \t]*-->\s*\Z")
PROMISE = re.compile(r"#\s*(cases \d+, \d+ of them solved already)")
FIGURES = "plot"  # drawing is proved elsewhere and takes its time
LARGEST_STUDY = 60


def blocks(page: Path) -> list[tuple[str, str, str, str, str]]:
    """Return of each block: language, code, kind and text of the comment before it, and the output shown after it.

    The kind is 'not run', 'file' or ''.
    """
    text = page.read_text(encoding="utf-8")
    found = []
    for hit in BLOCK.finditer(text):
        mark = COMMENT.search(text[: hit.start()])
        output = OUTPUT.match(text[hit.end() + 1 :])
        shown = output[1] if output and hit[1] == "python" else ""
        found.append((hit[1], hit[2], mark[1] if mark else "", mark[2] if mark else "", shown))
    return found


def file_of(code: str, name: str) -> str:
    """Return the file of a YAML block: as its comment says, otherwise by its keys."""
    if name:
        return name
    if re.search(r"^(factors|design):", code, re.M):
        return "study.yaml"
    return "config/materials.yaml" if re.search(r"^(materials|friction):", code, re.M) else "case.yaml"


def small(code: str) -> str:
    """Return a study with fewer levels at `preview`, so that a test can solve it."""
    return re.sub(r"(linspace: \[[^\],]+, [^\],]+, )\d+\]", r"\g<1>2]", code) + "accuracy: preview\n"


def commands(code: str) -> list[str]:
    lines = re.sub(r"\\\n", " ", code).splitlines()
    return [line for line in lines if line.startswith("trackroller ")]


@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.relative_to(ROOT).as_posix())
def test_every_code_block_runs(page, tmp_path, monkeypatch):
    """In the order of the page, in an empty folder, as a reader would do it."""
    from typer.testing import CliRunner

    from trackroller.cli.main import app
    from trackroller.errors import InputError
    from trackroller.study.file.load import load_study

    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("TRACKROLLER_MATERIALS", raising=False)
    names = {"__name__": "__docs__"}  # the blocks of a page share their names
    for language, code, mark, text, shown in blocks(page):
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
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                exec(compile(code, f"{page.name}", "exec"), names)
            assert not shown or printed.getvalue() == shown, f"{page.name} prints\n{printed.getvalue()}"
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


def program_of_the_docs(name: str) -> Any:
    """Return the module docs/NAME.py, which is in no package."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_tables_are_those_of_the_code():
    """The generated pages of parameters and of validation are up to date."""
    for page, text in program_of_the_docs("generate").pages().items():
        assert page.read_text(encoding="utf-8") == text, f"{page.name}: run python docs/generate.py"


def test_links_between_pages_lead_to_files():
    """No relative link of a page is dead."""
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text(encoding="utf-8")):
            if "://" not in target:
                assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_the_command_is_installed():
    """The pages call the command `trackroller`."""
    assert shutil.which("trackroller") or (Path(sys.executable).parent / "trackroller").exists()


def resolved(dotted: str) -> object:
    """Return the object that a dotted name of the reference page stands for."""
    parts = dotted.split(".")
    end = max(n for n in range(1, len(parts)) if is_module(".".join(parts[:n])))
    thing: object = importlib.import_module(".".join(parts[:end]))
    for part in parts[end:]:
        thing = getattr(thing, part)
    return thing


def is_module(name: str) -> bool:
    try:
        return importlib.util.find_spec(name) is not None
    except ModuleNotFoundError:  # its parent is no package
        return False


def test_the_reference_shows_every_public_name():
    """Every name of the package and public functions of every room stand in the reference, each with a docstring."""
    shown = re.findall(r"^::: (\S+)$", (ROOT / "docs" / "reference.md").read_text(encoding="utf-8"), re.M)
    assert len(shown) == len(set(shown))
    assert {*exported_names()} <= {*shown}
    things = {name: resolved(name) for name in shown}
    assert all(len(inspect.getdoc(thing) or "") > 40 for thing in things.values())
    rooms = {getattr(thing, "__module__", "trackroller.study").split(".")[1] for thing in things.values()}
    assert rooms >= {"errors", "materials", "halfspace", "contact", "damage", "roller", "study", "results", "report"}


def test_the_site_has_every_page_once():
    """The navigation of the site lists each page of docs/ exactly once."""
    named = re.findall(r"([\w/-]+\.md)$", (ROOT / "mkdocs.yml").read_text(encoding="utf-8"), re.M)
    assert sorted(named) == sorted(page.relative_to(ROOT / "docs").as_posix() for page in DOCS)


@pytest.mark.parametrize("word", ["spectrum", "wear", "uncertainty", "limits", "slurm"])
def test_what_a_designer_looks_for_stands_at_home_and_in_the_sidebar(word):
    """Each word leads on from the home page and from the sidebar, whose entries have titles."""
    nav = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("\nnav:")[2]
    assert re.search(rf"- .*{word}.*: \S+\.md$", nav, re.M | re.I)
    home = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    assert [line for line in home.splitlines() if word in line.lower() and re.search(r"\(\S+\.md\S*\)", line)]
    generated = [page for page in DOCS if not page.read_text(encoding="utf-8").startswith("# ")]
    for page in generated:  # its first line is no head, so that the site would take the name of the file
        assert re.search(rf"- \S.*: {page.relative_to(ROOT / 'docs').as_posix()}$", nav, re.M), page


@pytest.mark.parametrize("name", ["scene", "patch", "sn_curve"])
def test_the_drawings_are_those_of_the_program(tmp_path, name):
    """The figures that introduce terms are what docs/drawing.py draws, and the theory shows them."""
    drawing = program_of_the_docs("drawing")
    kept = (drawing.FOLDER / f"{name}.svg").read_text(encoding="utf-8")
    assert drawing.draw(name, tmp_path).read_text(encoding="utf-8") == kept, "run: python docs/drawing.py"
    assert f"(figures/{name}.svg)" in (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")


def test_formulas_are_typeset_and_name_the_file_that_computes_them():
    """Each line of a block of formulas gives MathML, and each file that it names is there."""
    formulas = pytest.importorskip("latex2mathml") and program_of_the_docs("formulas")
    theory = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```math\n(.*?)```", theory, re.S)
    lines = [line for block in blocks for line in block.splitlines() if line.strip()]
    others = re.sub(r"```math\n.*?```", "", theory, flags=re.S)
    assert len(lines) > 30 and not re.search(r"^    \w.*=", others, re.M), "a formula stands in a block of code"
    numbers = set()
    for one in map(formulas.formula, lines):
        assert one.file and (ROOT / "trackroller" / one.file).is_file(), one
        for display in ("block", "inline"):
            shown = ElementTree.fromstring(formulas.mathml(one.latex, display))
            assert shown.get("display") == display and "merror" not in formulas.mathml(one.latex, display)
        numbers |= set(re.findall(r"\d+", one.number))
    assert {"6", "10", "11", "12", "13", "14", "20", "21", "22", "24", "30"} <= numbers


def test_a_line_without_a_formula_stops_the_build():
    pytest.importorskip("latex2mathml")
    formulas = program_of_the_docs("formulas")
    assert formulas.formula("a = b  % (3) words | roller/case.py") == ("a = b", "(3)", "words", "roller/case.py")
    assert formulas.formula("a = b") == ("a = b", "", "", "")
    with pytest.raises(Exception, match="no formula"):
        formulas.formula("% (3) words")


def test_the_map_of_formulas_names_files_and_functions_that_exist():
    table = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8").split("## Where the formulas are")[1]
    places = re.findall(r"`([\w/]+\.py)(?::(\w+))?`", table.split("\n## ")[0])
    assert len(places) > 20
    for path, name in places:
        file = ROOT / ("" if path.startswith("validation/") else "trackroller") / path
        assert file.is_file(), path
        assert not name or re.search(rf"^(?:def|class) {name}\b", file.read_text(encoding="utf-8"), re.M), (path, name)


def test_the_readme_fits_on_two_screens():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").split()) <= 600


def test_files_that_the_pages_name_exist():
    """Paths of the repository and modules of `python -m` that a page names are there."""
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        for path in re.findall(r"[` ]((?:trackroller|validation|tests|docs|workflow|profiles)/[\w./-]+\.\w+)\b", text):
            assert (ROOT / path).exists(), f"{page.name}: {path}"
        for module in re.findall(r"python -m ([\w.]+)", text):
            assert is_module(module), f"{page.name}: {module}"


def test_the_table_of_exact_solutions_states_its_measured_errors():
    """The errors in the table's file are those of the data file, from which the page takes them."""
    from trackroller.contact import table

    measured = json.loads((ROOT / "docs" / "data" / "kalker_table.json").read_text(encoding="utf-8"))
    assert measured["patches"] == pytest.approx(table.stored().errors) and measured["range"]["outside"] <= 0.02
