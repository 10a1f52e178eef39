"""Which source and data files a result depends on, and a digest of what these files say.

The import graph is read from the source text, so that no list of files is kept by hand. Late imports inside functions
count; imports for type checking do not. A data file belongs to every module that names it, as `expected_errors.json`
belongs to `roller/expected_errors.py`. The digest leaves out comments, docstrings and blank lines: a better sentence in
a docstring changes no result, so it must not cause one to be computed again. Data files count by their bytes.

The solver's digest is part of each case's fingerprint (`solver_digest`). Rules of the workflow depend on a digest file
instead of on source files, because a source file gets a new date when only its comments change::

    from trackroller.study.store.sources import digest_file

    rule sensitivity:
        input:
            study=f"{RESULTS}/study.nc",
            code=digest_file(f"{RESULTS}/code", "trackroller.analysis.sensitivity"),

`digest_file` returns a path. It writes this file when the workflow is read, and only if the digest has changed.
`source_files` returns the list of files itself, and `code_digest` the digest as text, for `params:`.

Examples
--------
>>> from trackroller.study.store.sources import code_digest, source_files
>>> [path.name for path in source_files("trackroller.roller.geometry")]
['errors.py', '__init__.py', 'geometry.py']
>>> len(code_digest("trackroller.roller.geometry"))
16
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from trackroller.damage.own import digests
from trackroller.study.store.ownership import write_text

PACKAGE = Path(__file__).resolve().parents[2]
SOLVER = "trackroller.roller.solver"
# The values of materials stand in each fingerprint, so the file of materials need not count as well.
BY_VALUE = ("materials.yaml",)

_STRING = (
    r'"""[^"\\]*(?:(?:\\.|"(?!""))[^"\\]*)*"""'
    r"|'''[^'\\]*(?:(?:\\.|'(?!''))[^'\\]*)*'''"
    r'|"[^"\\\n]*(?:\\.[^"\\\n]*)*"'
    r"|'[^'\\\n]*(?:\\.[^'\\\n]*)*'"
)
_WORDS = re.compile(rf"[rRuU]?(?P<string>{_STRING})(?P<end>[ \t]*(?=\n|\Z|#))?|(?P<comment>#[^\n]*)", re.DOTALL)
_TYPE_CHECKING = re.compile(r"^if TYPE_CHECKING:\n(?:[ \t]+[^\n]*\n|\n)*", re.MULTILINE)
_IMPORT = re.compile(
    r"^[ \t]*(?:from[ \t]+(\.*[\w.]*)[ \t]+import[ \t]+(\([^)]*\)|[^\n]*)|import[ \t]+([^\n]*))", re.MULTILINE
)
_DOTTED = re.compile(r"\w+(?:\.\w+)+")
_FILE_NAME = re.compile(r"[\w-]+(?:\.\w+)+")


def source_files(modules: str | Iterable[str]) -> list[Path]:
    """Return the files of modules and of everything they import within their packages.

    Parameters
    ----------
    modules : str or iterable of str
        Dotted names, such as "trackroller.analysis.sensitivity". A package stands for its `__init__.py` and what
        that file imports. Modules of a package that lies beside `trackroller` ("validation.paper") are followed too.

    Returns
    -------
    list of pathlib.Path
        Source and data files, sorted. The top `trackroller/__init__.py` is left out: it holds public names and the
        version only.

    Raises
    ------
    ModuleNotFoundError
        If a name stands for no file.
    """
    return list(_closure((modules,) if isinstance(modules, str) else tuple(modules)))


def code_digest(modules: str | Iterable[str], leave_out: Iterable[str] = ()) -> str:
    """Return a digest of what the files of modules say, comments and docstrings left out.

    Parameters
    ----------
    modules : str or iterable of str
        Dotted names; see `source_files`.
    leave_out : iterable of str
        Names of data files that do not count.

    Returns
    -------
    str
        16 hexadecimal digits. Two copies of the same package have the same digest, wherever they lie.
    """
    ignored = set(leave_out)
    digest = hashlib.sha256()
    for path in source_files(modules):
        if path.name not in ignored:
            digest.update(path.relative_to(PACKAGE.parent).as_posix().encode() + b"\0" + _content(path) + b"\0")
    return digest.hexdigest()[:16]


@cache
def solver_digest() -> str:
    """Return the digest of all that `trackroller.solve` depends on except the values in a fingerprint."""
    digest, own = code_digest(SOLVER, BY_VALUE), {path.stem: sha for path, sha in digests().items()}
    return hashlib.sha256(f"{digest} {sorted(own.items())}".encode()).hexdigest()[:16] if own else digest


def digest_file(folder: str | Path, *modules: str) -> str:
    """Write the digest of modules into a folder if it has changed, and return the path of the file.

    Parameters
    ----------
    folder : str or pathlib.Path
        Where digests are kept; it is created.
    *modules : str
        Dotted names; see `source_files`.

    Returns
    -------
    str
        Path of the file. The file keeps its date while the code does the same, so that it can be an input of a rule.
    """
    path = Path(folder) / f"{modules[0].removeprefix('trackroller.')}.txt"
    digest = code_digest(modules) + "\n"
    if not path.is_file() or path.read_text(encoding="utf-8") != digest:
        write_text(path, digest)
    return str(path)


def _split(source: str, docstring: str = "") -> tuple[str, list[str]]:
    """Return the code with replaced docstrings and without comments and blank lines, and the strings of the code."""
    kept: list[str] = []
    strings: list[str] = []
    last = 0
    for match in _WORDS.finditer(source):
        start = match.start()
        kept.append(source[last:start])
        last = match.end()
        if match["comment"]:
            continue
        own_line = match["end"] is not None and not source[source.rfind("\n", 0, start) + 1 : start].strip()
        if own_line and "".join(kept[-9:]).rstrip()[-1:] in ("", ":"):
            kept.append(docstring)
            continue
        kept.append(match[0].replace("\\\n", "").replace("\n", "\\n"))  # keeps blank lines of a text
        strings.append(match["string"].strip("\"'"))
    kept.append(source[last:])
    lines = (line.rstrip() for line in "".join(kept).splitlines())
    return "\n".join(line for line in lines if line), strings


@cache
def _closure(modules: tuple[str, ...]) -> tuple[Path, ...]:
    for name in modules:
        if _file_of(name) is None:
            raise ModuleNotFoundError(f"no module {name!r} in {PACKAGE.parent}", name=name)
    roots = {PACKAGE.name, *(name.partition(".")[0] for name in modules)}
    found: set[Path] = set()
    pending, seen = list(modules), {PACKAGE.name}
    while pending:
        name = pending.pop()
        path = _file_of(name) if name not in seen and name.partition(".")[0] in roots else None
        seen.add(name)
        if path is not None:
            found |= {path, *_data_of(path)}
            pending += [name.rpartition(".")[0], *_names(path, name)]  # the package above counts as well
    return tuple(sorted(found))


@cache
def _file_of(name: str) -> Path | None:
    """Return the file of a module or package beside this package, or None."""
    base = PACKAGE.parent.joinpath(*name.split("."))
    for path in (base.with_name(base.name + ".py"), base / "__init__.py"):
        if path.is_file():
            return path
    return None


def _names(path: Path, module: str) -> Iterator[str]:
    """Yield the dotted names that a module may mean by its imports and by texts like "trackroller.roller.solver"."""
    code, strings = _read(path)
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    for origin, names, plain in _IMPORT.findall(_TYPE_CHECKING.sub("", code + "\n")):
        if plain:
            yield from (part.split(" as ")[0].strip() for part in plain.split(","))
            continue
        dots = len(origin) - len(origin.lstrip("."))
        if dots:
            above = package.split(".")[: len(package.split(".")) - dots + 1]
            origin = ".".join([*above, *filter(None, [origin[dots:]])])
        yield origin
        yield from (
            f"{origin}.{part.split(' as ')[0].strip()}" for part in names.strip("()").split(",") if part.strip()
        )
    yield from (text for text in strings if _DOTTED.fullmatch(text))


def _data_of(path: Path) -> Iterator[Path]:
    """Yield the data files named in a module, and the files named in templates among these data files."""
    known = _data_files(path.parents[len(path.relative_to(PACKAGE.parent).parts) - 2])
    pending = [data for text in _read(path)[1] for data in known.get(text.rpartition("/")[2], ())]
    seen = set()
    while pending:
        data = pending.pop()
        if data in seen:
            continue
        seen.add(data)
        yield data
        if data.suffix in (".j2", ".html", ".css", ".js"):
            text = data.read_text(encoding="utf-8")
            pending += [other for name in _FILE_NAME.findall(text) for other in known.get(name, ())]


@cache
def _data_files(root: Path) -> dict[str, list[Path]]:
    """Return the data files of a package by their names.

    A module may also name a folder that holds nothing but data files. The name of this folder stands for all of them.
    """
    found: dict[str, list[Path]] = {}
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(set(folders) - {"__pycache__"})
        data = [name for name in sorted(names) if "." in name and not name.endswith((".py", ".pyc"))]
        for name in data:
            found.setdefault(name, []).append(Path(folder, name))
        if data == sorted(names) and not folders:
            found.setdefault(Path(folder).name, []).extend(Path(folder, name) for name in data)
    return found


@cache
def _read(path: Path) -> tuple[str, list[str]]:
    return _split(path.read_text(encoding="utf-8"))


def _content(path: Path) -> bytes:
    return _read(path)[0].encode() if path.suffix == ".py" else path.read_bytes()
