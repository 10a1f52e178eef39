"""Count what the rules of the code limit and ruff does not: rooms and their order, lines of code, long functions.

`python -m validation.house [FOLDER]` prints the counts of a checkout, by default of the one this file lies in.
`tests/test_house.py` holds the limits. A line of code is a line that is no docstring, comment or blank.
"""

from __future__ import annotations

import ast
import io
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
    "numerics",
    "parameters",
    "materials",
    "halfspace",
    "contact",
    "damage",
    "roller",
    "study",
    "analysis",
    "report",
    "solved",
    "app",
    "cli",
    "__init__",
)
MOST_LINES, LONGEST_FUNCTION = 320, 50
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
    upward : list of str
        Imports from a later room, those for type checking and those inside functions included.
    code : dict
        Lines of code by file, relative to the checkout.
    lines : dict
        All lines by file.
    functions : dict
        Lines of code by "file:function".
    """

    entries: list[str] = field(default_factory=list)
    upward: list[str] = field(default_factory=list)
    code: dict[str, int] = field(default_factory=dict)
    lines: dict[str, int] = field(default_factory=dict)
    functions: dict[str, int] = field(default_factory=dict)

    def long_files(self) -> dict[str, int]:
        """Return the files with more than `MOST_LINES` lines."""
        return {name: count for name, count in self.lines.items() if count > MOST_LINES}

    def long_functions(self) -> dict[str, int]:
        """Return the functions with more than `LONGEST_FUNCTION` lines of code."""
        return {name: count for name, count in self.functions.items() if count > LONGEST_FUNCTION}


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
        place = ORDER.index(room_of(module))
        for other, line in imported(tree, module, path.name == "__init__.py", set(paths)):
            if ORDER.index(room_of(other)) > place:
                house.upward.append(f"{name}:{line} imports {other}")
        for node in ast.walk(tree):
            if isinstance(node, _FUNCTIONS):
                own = lines.intersection(range(node.lineno, (node.end_lineno or 0) + 1))
                house.functions[f"{name}:{node.name}"] = len(own)
    return house


def told(house: House) -> str:
    """Return the counts as text, one finding a line."""
    rooms: Counter[str] = Counter()
    for name, count in house.code.items():
        rooms[name.split("/")[1]] += count
    listed = {
        "entries at the top of the package": house.entries,
        f"lines of code {sum(house.code.values())}; rooms and files": [f"{n} {c}" for n, c in rooms.most_common()],
        "upward imports": house.upward,
        f"files over {MOST_LINES} lines": [f"{n} {c}" for n, c in house.long_files().items()],
        f"functions over {LONGEST_FUNCTION} lines of code": [f"{n} {c}" for n, c in house.long_functions().items()],
    }
    return "\n".join(f"{title}: {len(found)} ({', '.join(found)})" for title, found in listed.items())


if __name__ == "__main__":
    print(told(survey(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT)))
