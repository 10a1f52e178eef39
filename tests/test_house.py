"""The structure of the package: rooms in one order, no import circles, and unique names of files.

Each room of the package is a folder or a file at its top. A room imports from the rooms before it only, and no files
import each other in a circle, inside a room either. Imports inside functions and those for type checking count.
ruff limits complexity, the number of arguments and late imports. A line says one thing, and in the rooms
of `PLAIN` a call holds no choice.
"""

from __future__ import annotations

import ast
import graphlib
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from trackroller.study.store.program_digest import ROOMS, room_files

ROOT = Path(__file__).parents[1]
PACKAGE = "trackroller"
VAGUE = ("said", "held", "more", "rest", "found", "aside", "told", "made", "seen", "kept", "asked", "wanted", "taken")
FORMULAS = ("contact", "halfspace", "damage")  # there a choice may stand in a call
PLAIN = tuple(room for room in ROOMS if room not in FORMULAS)
ORDER = (*ROOMS, "__init__")  # the top of the package holds public names and may import all rooms


@dataclass
class House:
    """The imports of a package.

    Attributes
    ----------
    upward : list of str
        Imports from a later room, those for type checking and those inside functions included.
    imports : dict
        The modules of the package that each module imports.
    """

    upward: list[str] = field(default_factory=list)
    imports: dict[str, set[str]] = field(default_factory=dict)

    def circle(self) -> list[str]:
        """Return the modules of one import circle, an empty list if there is none."""
        try:
            graphlib.TopologicalSorter(self.imports).prepare()
        except graphlib.CycleError as error:
            return list(error.args[1])
        return []


def room_of(module: str) -> str:
    """Return the room of a module such as "trackroller.contact.hertz"; the top of the package is "__init__"."""
    parts = module.split(".")
    return parts[1] if len(parts) > 1 else "__init__"


def module_of(path: Path, root: Path) -> str:
    """Return the dotted name of a file."""
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported(tree: ast.AST, module: str, is_package: bool, known: set[str]) -> list[tuple[str, int]]:
    """Return the modules of the package that a file imports, each with its line; `__version__` is no module."""
    found: list[tuple[str, int]] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += [(alias.name, node.lineno) for alias in node.names if alias.name in known]
        elif isinstance(node, ast.ImportFrom):
            above = module.split(".")[: len(module.split(".")) - node.level + is_package] if node.level else []
            origin = ".".join([*above, *filter(None, [node.module])])
            for alias in (a for a in node.names if not a.name.startswith("__")):
                whole = f"{origin}.{alias.name}"
                found += [(name, node.lineno) for name in (whole, origin) if name in known][:1]
    return found


def survey(root: Path) -> House:
    """Read the imports of the package below a folder."""
    house = House()
    paths = {module_of(path, root): path for path in sorted((root / PACKAGE).rglob("*.py"))}
    for module, path in paths.items():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        place = ORDER.index(room_of(module))
        found = imported(tree, module, path.name == "__init__.py", set(paths))
        house.imports[module] = {other for other, _ in found} - {module}
        name = path.relative_to(root).as_posix()
        later = [(other, line) for other, line in found if ORDER.index(room_of(other)) > place]
        house.upward += [f"{name}:{line} imports {other}" for other, line in later]
    return house


@pytest.fixture(scope="module")
def house():
    return survey(ROOT)


@pytest.mark.slow
def test_no_room_imports_a_later_room(house):
    assert house.upward == []


def test_no_files_import_each_other_in_a_circle(house):
    assert house.circle() == []


def repeated(root: Path) -> dict[str, list[str]]:
    """Return the files of a room that have the same name.

    In `report` a name is a subject, and its folder says what is made of the subject: words, table, figure or page.
    """
    places: dict[tuple[str, str], list[str]] = {}
    for path in sorted((root / PACKAGE).rglob("*.py")):
        inside = path.relative_to(root / PACKAGE)
        room = inside.parent.as_posix() if inside.parts[0] == "report" else inside.parts[0]
        if len(inside.parts) > 1 and not path.name.startswith("__"):
            places.setdefault((room, path.name), []).append(inside.as_posix())
    return {name: found for (_, name), found in places.items() if len(found) > 1}


def test_a_name_of_a_file_is_there_once_in_its_room():
    assert repeated(ROOT) == {}


def classes_of_several_files(root: Path) -> dict[str, list[str]]:
    """Return the public classes whose name stands in several files of the package, with these files."""
    places: dict[str, list[str]] = {}
    for path in sorted((root / PACKAGE).rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        names = [node.name for node in tree.body if isinstance(node, ast.ClassDef)]
        for name in names:
            if not name.startswith("_"):
                places.setdefault(name, []).append(path.relative_to(root / PACKAGE).as_posix())
    return {name: files for name, files in places.items() if len(files) > 1}


def test_a_class_has_a_name_of_its_own():
    """One word, one meaning: no two files of the package name a public class alike."""
    assert classes_of_several_files(ROOT) == {}


def test_the_survey_finds_what_it_looks_for(tmp_path):
    """A made-up package breaks each rule once."""
    lower, upper = tmp_path / "trackroller" / "contact", tmp_path / "trackroller" / "roller"
    for room in (lower, upper):
        room.mkdir(parents=True)
        (room / "__init__.py").write_text('"""A room."""\n')
    (tmp_path / "trackroller" / "__init__.py").write_text("")
    (upper / "case.py").write_text("from ..contact import hertz\n")
    (upper / "options.py").write_text("from trackroller.roller import case\n")
    (lower / "hertz.py").write_text("def f(a):\n    from trackroller.roller.case import Case\n")
    house = survey(tmp_path)
    assert house.upward == ["trackroller/contact/hertz.py:2 imports trackroller.roller.case"]
    circle = {"trackroller.contact.hertz", "trackroller.roller.case"}
    assert set(house.circle()) == circle
    (upper / "stages").mkdir()
    (upper / "stages" / "case.py").write_text("")
    assert repeated(tmp_path) == {"case.py": ["roller/case.py", "roller/stages/case.py"]}
    (upper / "stages" / "case.py").write_text("class Load: pass\nclass _Load: pass\n")
    (lower / "load.py").write_text("class Load: pass\nclass _Load: pass\n")
    assert classes_of_several_files(tmp_path) == {"Load": ["contact/load.py", "roller/stages/case.py"]}


def crowded(tree: ast.AST) -> list[int]:
    """Return the lines that say several things at once.

    An assignment inside an expression, except in `while` and in the filter of a comprehension; a choice inside another
    choice; a text times a condition.
    """
    inside = {child: node for node in ast.walk(tree) for child in ast.iter_child_nodes(node)}

    def around(node: ast.AST) -> list[ast.AST]:
        """Return the expressions around a node, the statement last."""
        found = [node]
        while not isinstance(found[-1], ast.stmt) and found[-1] in inside:
            found.append(inside[found[-1]])
        return found[1:]

    lines = []
    for node in ast.walk(tree):
        places = around(node)
        if isinstance(node, ast.NamedExpr):
            steps = zip([node, *places], places, strict=False)
            filters = any(isinstance(place, ast.comprehension) and own in place.ifs for own, place in steps)
            if not filters and not isinstance(places[-1], ast.While):
                lines.append(node.lineno)
        if isinstance(node, ast.IfExp) and isinstance(inside[node], ast.IfExp):
            lines.append(node.lineno)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
            sides = (node.left, node.right)
            is_text = any(isinstance(s, ast.JoinedStr) or isinstance(getattr(s, "value", None), str) for s in sides)
            if is_text and any(is_condition(side) for side in sides):
                lines.append(node.lineno)
    return sorted(lines)


def is_condition(node: ast.expr) -> bool:
    """Return whether an expression is true or false by its form."""
    if isinstance(node, ast.Call):
        return getattr(node.func, "id", "") == "bool"
    return isinstance(node, (ast.Compare, ast.BoolOp)) or (
        isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
    )


def calls_with_choices(tree: ast.AST) -> list[int]:
    """Return the lines of calls that have a choice among their arguments, also inside an argument."""
    arguments = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            arguments += [*node.args, *node.keywords]
    choices = {part for argument in arguments for part in ast.walk(argument) if isinstance(part, ast.IfExp)}
    return sorted({choice.lineno for choice in choices})


def lines_of(rooms: tuple[str, ...], look: Callable[[ast.AST], list[int]]) -> list[str]:
    """Return file and line of what a look finds in the files of rooms."""
    paths = [path for path in room_files(ROOMS[-1]) if path.suffix == ".py"]
    lines = []
    for path in paths:
        inside = path.relative_to(ROOT / PACKAGE)
        if inside.parts[0].removesuffix(".py") in rooms:
            tree = ast.parse(path.read_text(encoding="utf-8"))
            lines += [f"{inside.as_posix()}:{line}" for line in look(tree)]
    return lines


def test_a_line_says_one_thing():
    assert lines_of(ROOMS, crowded) == []


def test_a_call_of_a_plain_room_holds_no_choice():
    assert lines_of(PLAIN, calls_with_choices) == []


def vague_names(tree: ast.AST) -> list[int]:
    """Return the lines that give a value or a function a name that is no noun of the domain."""
    lines = []
    for node in ast.walk(tree):
        name = ""
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            name = node.id
        elif isinstance(node, ast.arg):
            name = node.arg
        elif isinstance(node, ast.FunctionDef):
            name = node.name
        if name.strip("_") in VAGUE:
            lines.append(node.lineno)
    return sorted(lines)


def test_names_of_a_plain_room_are_nouns():
    assert lines_of(PLAIN, vague_names) == []


@pytest.mark.parametrize("text", ["found = 1", "def f(said): pass", "def _held(): pass", "for rest in a: pass"])
def test_a_vague_name_is_found(text):
    assert vague_names(ast.parse(text)) == [1]
    assert vague_names(ast.parse("f(found=1).told")) == []


@pytest.mark.parametrize("text", ["f(1 if a else 2)", "f(x=1 if a else 2)", "f(2 * (1 if a else 2))"])
def test_a_call_with_a_choice_is_found(text):
    assert calls_with_choices(ast.parse(text)) == [1]
    assert calls_with_choices(ast.parse("x = 1 if f(a) else f(2)")) == []


@pytest.mark.parametrize(
    "text",
    [
        "if (a := f()): g()",
        "x = 1 if a else (2 if b else 3)",
        "x = ', ' * bool(a)",
        "x = f'{a}' * (b > 1)",
        "f(a := 1)",
    ],
)
def test_a_crowded_line_is_found(text):
    assert crowded(ast.parse(text)) == [1]


@pytest.mark.parametrize(
    "text",
    ["while a := f(): g()", "x = [b for a in c if (b := f(a))]", "x = 1 if a else 2", "x = ' ' * n", "x = 2 * (a > b)"],
)
def test_a_plain_line_is_not_found(text):
    assert crowded(ast.parse(text)) == []


def test_the_recipes_have_lines_of_the_package():
    """The examples of CONTRIBUTING become files of the package, where ruff refuses a longer line."""
    recipes = re.findall(r"```python\n(.*?)```", (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"), re.DOTALL)
    assert len(recipes) == 3
    assert max(len(line) for recipe in recipes for line in recipe.splitlines()) <= 100
