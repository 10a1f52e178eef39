"""Limits of a user's own, `config/limits/NAME.py`: whether they are allowed, and how they are
loaded.

The files are programs, so they are loaded only where the user allows code: by `--allow-code` on the
command line, or by the environment variable TRACKROLLER_ALLOW_CODE with the folder, which worker
processes and the jobs of a workflow inherit.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import importlib.util
import os
import re
import sys
import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from trackroller.damage.limit import Limit
from trackroller.errors import InputError, raise_all, unknown_name

FOLDER = Path("config", "limits")
VARIABLE = "TRACKROLLER_ALLOW_CODE"  # the command line sets it for --allow-code
FUNCTIONS = ("evaluate", "use", "shared")  # of a limit, which a file of a user programs


def hint(name: Any) -> str:
    """Return how to load the file of the folder config/limits that declares a limit; an empty text
    if none does.
    """
    file = FOLDER / f"{name}.py"
    return _how(file) if file.is_file() else ""


def _how(file: Path) -> str:
    return f"{file} declares it: add --allow-code."


def unknown_field(
    kind: str, name: str, options: Iterable[str], elsewhere: Iterable[str] = ()
) -> InputError:
    """Return the error for a field of a case or a material that is not known, see `unknown_name`.

    A limit of a user declares fields, too. Where the text of a file that is not loaded holds the
    name, the remedy is to load it.
    """
    error = unknown_name(kind, name, options, elsewhere)
    files: list[Path] = []
    if VARIABLE not in os.environ:
        files = sorted(FOLDER.glob("*.py"))
    quoted = re.compile(rf"""["']{re.escape(name)}["']""")
    file = next(
        (
            file
            for file in files
            if quoted.search(file.read_text(encoding="utf-8", errors="replace"))
        ),
        None,
    )
    if file is None:
        return error
    return InputError(kind, name, error.allowed, _how(file), error.wrong)


def check_fields(kind: str, names: Iterable[object], options: Iterable[str]) -> None:
    """Raise the errors `unknown_field` for those of `names` that are not among `options`."""
    known = tuple(options)
    raise_all(unknown_field(kind, str(name), known) for name in names if name not in known)


@cache
def digests() -> dict[Path, str]:
    """Return the SHA-256 of each allowed file, sorted by name; the files are read once, before they
    are loaded.
    """
    folder = os.environ.get(VARIABLE)
    files: list[Path] = []
    if folder:
        files = sorted(Path(folder).resolve().glob("*.py"))
    return {path: hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def own_limits() -> dict[str, Limit]:
    """Return the limits of the allowed files by name.

    Raises
    ------
    InputError
        If a file cannot be loaded or declares no limit of its name, or if the folder has no file.
    """
    if VARIABLE not in os.environ:
        return {}
    if not digests():
        allowed = "a folder with limits, one file NAME.py each"
        raise InputError(
            "--allow-code", os.environ[VARIABLE], allowed, "Add a file, or leave out --allow-code."
        )
    return {path.stem: _load(path) for path in digests()}


def _load(path: Path) -> Limit:
    """Return the limit that a file declares."""
    spec = importlib.util.spec_from_file_location(f"own_limit_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # its prints must not stand among the results
    with _errors_of(path), contextlib.redirect_stdout(sys.stderr):
        spec.loader.exec_module(module)
    limit = getattr(module, "LIMIT", None)
    if not isinstance(limit, Limit) or limit.name != path.stem:
        declares = f"{path.name} must declare LIMIT = Limit(name='{path.stem}', ...)"
        raise InputError("limits", str(path), "a file that declares one LIMIT", declares)
    own: dict[str, Any] = {
        name: _guarded(getattr(limit, name), path)
        for name in FUNCTIONS
        if getattr(limit, name) is not None
    }
    return replace(limit, **own)


def _guarded(function: Callable[..., Any], path: Path) -> Callable[..., Any]:
    """Return a function of a file whose errors name the file and the line."""

    @functools.wraps(function)
    def call(*arguments: Any) -> Any:
        with _errors_of(path):
            return function(*arguments)

    return call


@contextmanager
def _errors_of(path: Path) -> Iterator[None]:
    """Raise an error of a file as an error of the user, with the file and its line.

    `sys.exit` in a file is an error as well: it would end a command as if its work were done.
    """
    try:
        yield
    except (InputError, KeyboardInterrupt, MemoryError):
        raise
    except BaseException as error:
        reason = f"{type(error).__name__}: {error}".rstrip(": ")
        wrong = f"stops with {reason}"
        remedy = "Correct this line, or leave out --allow-code."
        of_user = InputError("limits", path.name, "a program without errors", remedy, wrong)
        raise of_user.at(path, _line_of(error, path)) from error


def _line_of(error: BaseException, path: Path) -> int:
    """Return the line of a file in which an error began, 1 if the traceback does not name it."""
    if isinstance(error, SyntaxError) and error.filename == str(path):
        return error.lineno or 1
    lines = [
        one.lineno for one in traceback.extract_tb(error.__traceback__) if one.filename == str(path)
    ]
    return lines[-1] or 1 if lines else 1
