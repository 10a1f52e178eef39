"""Count what the rules of the code limit: rooms, arrows between them, lines, long functions, late imports.

`python -m validation.house [FOLDER]` prints the counts of a checkout, by default of the one this file lies in.
`tests/test_house.py` holds the limits. A line of code is a line that is no docstring, comment or blank.
"""

from __future__ import annotations

import ast
import io
import re
import sys
import tokenize
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = "trackroller"
# a room imports only from the rooms before it; the top of the package holds public names and may import all of them
ORDER = (
    "errors",
    "files",
    "yaml_file",
    "parameters",
    "numerics",
    "materials",
    "halfspace",
    "contact",
    "damage",
    "roller",
    "study",
    "analysis",
    "report",
    "solved",
    "cli",
    "__init__",
)
MOST_LINES, LONGEST_FUNCTION, MOST_ARGUMENTS = 320, 50, 8
_NO_CODE = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


@dataclass
class House:
    """Counts of a package.

    Attributes
    ----------
    entries : list of str
        Files and folders at the top of the package.
    arrows : Counter
        Imports by (importing room, imported room), those for type checking and those inside functions included.
    upward : list of str
        Imports from a later room.
    code : dict
        Lines of code by file, relative to the checkout.
    lines : dict
        All lines by file.
    functions : dict
        Lines of code by "file:function".
    arguments : dict
        Number of arguments by "file:function", where there are more than `MOST_ARGUMENTS`.
    late : list of str
        Imports inside functions, as "file:line".
    skipped : list of str
        Uses of `fmt: skip` and `fmt: off`, as "file:line".
    """

    entries: list[str] = field(default_factory=list)
    arrows: Counter[tuple[str, str]] = field(default_factory=Counter)
    upward: list[str] = field(default_factory=list)
    code: dict[str, int] = field(default_factory=dict)
    lines: dict[str, int] = field(default_factory=dict)
    functions: dict[str, int] = field(default_factory=dict)
    arguments: dict[str, int] = field(default_factory=dict)
    late: list[str] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)

    def long_files(self) -> dict[str, int]:
        """Return the files with more than `MOST_LINES` lines."""
        return {name: count for name, count in self.lines.items() if count > MOST_LINES}

    def long_functions(self) -> dict[str, int]:
        """Return the functions with more than `LONGEST_FUNCTION` lines of code."""
        return {name: count for name, count in self.functions.items() if count > LONGEST_FUNCTION}

    def circles(self) -> list[tuple[str, ...]]:
        """Return the groups of rooms that import each other, directly or through other rooms."""
        reach = {room: {b for a, b in self.arrows if a == room} for room in {a for pair in self.arrows for a in pair}}
        for _ in reach:
            for found in reach.values():
                found |= {c for b in found for c in reach.get(b, ())}
        groups = {tuple(sorted(b for b in reach[a] if a in reach[b])) for a in reach if a in reach[a]}
        return sorted(groups)


def room_of(module: str) -> str:
    """Return the room of a module such as "trackroller.contact.hertz"; the top of the package is "__init__"."""
    parts = module.split(".")
    return parts[1] if len(parts) > 1 else "__init__"


def module_of(path: Path, root: Path) -> str:
    """Return the dotted name of a file."""
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported(tree: ast.AST, module: str, is_package: bool, known: set[str]) -> list[tuple[str, int]]:
    """Return the modules of the package that a file imports, each with its line; `__version__` is no module.

    Parameters
    ----------
    tree : ast.AST
        The parsed file.
    module : str
        Its dotted name.
    is_package : bool
        Whether the file is an `__init__.py`.
    known : set of str
        All modules of the package.
    """
    found: list[tuple[str, int]] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found += [(alias.name, node.lineno) for alias in node.names if alias.name in known]
        elif isinstance(node, ast.ImportFrom):
            above = module.split(".")[: len(module.split(".")) - node.level + is_package] if node.level else []
            origin = ".".join([*above, *filter(None, [node.module])])
            for alias in (a for a in node.names if not a.name.startswith("__")):  # metadata such as the version
                whole = f"{origin}.{alias.name}"
                found += [(name, node.lineno) for name in (whole, origin) if name in known][:1]
    return found


def code_lines(source: str, tree: ast.AST) -> set[int]:
    """Return the numbers of the lines that hold code."""
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in _NO_CODE:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, *_FUNCTIONS)) and ast.get_docstring(node) is not None:
            lines.difference_update(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
    return lines


def survey(root: Path = ROOT) -> House:
    """Count everything in the package of a checkout.

    Parameters
    ----------
    root : pathlib.Path
        Folder that holds `trackroller/`.

    Returns
    -------
    House
        The counts.
    """
    package = root / PACKAGE
    house = House(entries=sorted(p.name for p in package.iterdir() if p.name != "__pycache__"))
    paths = {module_of(path, root): path for path in sorted(package.rglob("*.py"))}
    for module, path in paths.items():
        source, name = path.read_text(encoding="utf-8"), path.relative_to(root).as_posix()
        tree = ast.parse(source)
        lines = code_lines(source, tree)
        house.code[name], house.lines[name] = len(lines), len(source.splitlines())
        house.skipped += [f"{name}:{i}" for i, line in enumerate(source.splitlines(), 1) if re.search(r"# fmt: ", line)]
        _count_imports(house, name, imported(tree, module, path.name == "__init__.py", set(paths)), module)
        for node in ast.walk(tree):
            if isinstance(node, _FUNCTIONS):
                _count_function(house, name, node, lines)
    house.late = sorted(set(house.late))
    return house


def _count_imports(house: House, name: str, found: list[tuple[str, int]], module: str) -> None:
    here = room_of(module)
    for other, line in found:
        there = room_of(other)
        if there != here:
            house.arrows[here, there] += 1
            if ORDER.index(there) > ORDER.index(here):
                house.upward.append(f"{name}:{line} imports {other}")


def _count_function(house: House, name: str, node: ast.FunctionDef | ast.AsyncFunctionDef, lines: set[int]) -> None:
    label = f"{name}:{node.name}"
    house.functions[label] = len(lines.intersection(range(node.lineno, (node.end_lineno or 0) + 1)))
    count = len(node.args.posonlyargs + node.args.args + node.args.kwonlyargs)
    if count > MOST_ARGUMENTS:
        house.arguments[label] = count
    house.late += [f"{name}:{n.lineno}" for n in ast.walk(node) if isinstance(n, (ast.Import, ast.ImportFrom))]


def told(house: House) -> str:
    """Return the counts as text, one finding a line."""
    rooms: Counter[str] = Counter()
    for name, count in house.code.items():
        rooms[name.split("/")[1]] += count
    parts = [
        f"entries at the top of the package: {len(house.entries)} ({', '.join(house.entries)})",
        f"lines of code: {sum(house.code.values())} ({', '.join(f'{room} {n}' for room, n in rooms.most_common())})",
        f"arrows between rooms: {len(house.arrows)}, imports {sum(house.arrows.values())}",
        *_listed("upward imports", house.upward),
        *_listed("circles between rooms", [" <-> ".join(group) for group in house.circles()]),
        *_listed(f"files over {MOST_LINES} lines", [f"{n} {c}" for n, c in house.long_files().items()]),
        *_listed(
            f"functions over {LONGEST_FUNCTION} lines of code", [f"{n} {c}" for n, c in house.long_functions().items()]
        ),
        *_listed(f"functions with over {MOST_ARGUMENTS} arguments", [f"{n} {c}" for n, c in house.arguments.items()]),
        *_listed("late imports", house.late),
        *_listed("fmt: skip", house.skipped),
    ]
    return "\n".join(parts)


def _listed(title: str, found: list[str]) -> list[str]:
    return [f"{title}: {len(found)}", *(f"  {line}" for line in found)]


if __name__ == "__main__":
    print(told(survey(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT)))
