"""Read the files of users, find the files that they name, and write files whole: one way for the whole program.

A YAML text is YAML 1.2 (core schema). A scalar without quotes that YAML 1.1 reads differently, such as `030`, `1:30`,
`3_0` or `yes`, is refused; the message says what to write instead. Values are counted while they are composed, aliases
in full, so that a small file cannot grow into millions of values. ruamel.yaml parses and writes; its own composer reads
these scalars without a word, ends the process at deep nesting, and takes twice as long.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import io
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.representer import SafeRepresenter

from trackroller.errors import InputError, WorkError
from trackroller.yaml_composer import TAG, Composer, plain_scalar

MAX_BYTES = 5_000_000  # bytes; a larger table of cases belongs into a CSV file
_beside: ContextVar[Path | None] = ContextVar("beside", default=None)


def read_text(path: Path | str, what: str, most: float = MAX_BYTES) -> str:
    """Return the text of a user's file.

    Parameters
    ----------
    path : Path or str
        The file.
    what : str
        Kind of file, for messages.
    most : float
        Largest size [bytes].

    Returns
    -------
    str
        The text, without a byte-order mark.

    Raises
    ------
    InputError
        If the file is missing, no regular file, too large, unreadable or not UTF-8.
    """
    path = Path(path)
    try:
        if path.is_dir():
            raise InputError(what, str(path), "a file; this is a folder", "Give the path of a file.")
        if path.exists() and not path.is_file():
            raise InputError(what, str(path), "a regular file; this is a device or a pipe", "Give the path of a file.")
        if path.stat().st_size > most:
            raise InputError(
                what,
                str(path),
                f"a file of at most {MAX_BYTES // 1_000_000} MB",
                "Put many cases into a CSV file and use design: table.",
            )
        return path.read_bytes().decode("utf-8-sig")
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(what, str(path), "a file that exists", "Check the path.") from None
    except UnicodeDecodeError as exc:
        remedy = "Save the file as UTF-8."
        raise InputError(what, str(path), f"UTF-8 text (byte {exc.start} is not)", remedy) from None
    except (OSError, ValueError) as exc:
        raise InputError(what, str(path), f"a readable file ({exc})", "Check path and rights.") from None


def parse_yaml(text: str, what: str) -> Any:
    """Return the plain data of a YAML text.

    Parameters
    ----------
    text : str
        One YAML document.
    what : str
        Kind of text, for messages.

    Returns
    -------
    dict, list, str, int, float, bool or None

    Raises
    ------
    InputError
        With the line, if the text is not YAML, is ambiguous, holds a key twice, an unknown tag, too many values or
        too deep a nesting.
    """
    try:
        return Composer(YAML(typ="safe").parse(io.StringIO(text)), what).document()
    except InputError:
        raise
    except MarkedYAMLError as exc:
        mark = exc.problem_mark or exc.context_mark
        where = f"line {mark.line + 1}" if mark else "the file"
        reason = " ".join(str(exc.problem or exc).split())
        raise InputError(
            what, where, f"YAML; this is not YAML: {reason}", "Mend the line; texts with ': ' or ' #' need quotes."
        ) from None
    except (YAMLError, ValueError, RecursionError) as exc:
        reason = " ".join(str(exc).split())[:200]
        raise InputError(what, "the file", f"YAML: {reason}", "Save it as plain UTF-8 text.") from None


def parse_mapping(text: str, what: str) -> dict[str, Any]:
    """Return the mapping of a YAML text; see `parse_yaml`.

    Raises
    ------
    InputError
        Also if the top level is not a mapping from texts.
    """
    data = parse_yaml(text, what)
    if not isinstance(data, dict):
        raise InputError(
            what, type(data).__name__, "a mapping of keys to values", "Write lines of the form 'key: value'."
        )
    for key in data:
        if not isinstance(key, str):
            raise InputError(what, key, "keys that are texts", "Put the key in quotes.")
    return data


def read_mapping(path: Path | str, what: str = "file") -> dict[str, Any]:
    """Return the mapping of a user's YAML file; see `read_text` and `parse_mapping`."""
    return parse_mapping(read_text(path, what), what)


def write_yaml(data: Mapping[str, Any]) -> str:
    """Return plain data as YAML text that `parse_yaml` reads as the same data."""
    writer = YAML(typ="safe", pure=True)
    writer.Representer = _Representer
    writer.default_flow_style = False
    writer.sort_base_mapping_type_on_output = False  # type: ignore[assignment]  # the library types its default, None
    writer.allow_unicode = True
    out = io.StringIO()
    writer.dump(dict(data), out)
    return out.getvalue()


def needs_quotes(text: str) -> bool:
    """Return whether a text without quotes would be refused or read as something else."""
    try:
        return plain_scalar(text) != text
    except ValueError:
        return True


class _Representer(SafeRepresenter):
    """Writes texts in quotes wherever the reader would not take them as texts."""

    def represent_text(self, text: str) -> Any:
        """Return the node of a text."""
        return self.represent_scalar(f"{TAG}str", text, style='"' if needs_quotes(text) else None)


_Representer.add_representer(str, _Representer.represent_text)


@contextmanager
def files_beside(path: Path | str | None) -> Iterator[None]:
    """Look for files in the folder of the case or study file `path` first, while that file is read."""
    token = _beside.set(None if path is None else Path(path).parent)
    try:
        yield
    finally:
        _beside.reset(token)


def find_beside(name: Any, field: str) -> Path:
    """Return the path of a file that a case, study or spectrum file names: the one rule for every such path.

    Parameters
    ----------
    name : str
        Path from the folder of the file that names it, or from the working directory.
    field : str
        The key that names it, for messages.

    Raises
    ------
    InputError
        If the path is absolute, holds '..', leads out of both folders, or names no file.
    """
    folders = [folder for folder in (_beside.get(), Path.cwd()) if folder is not None]
    where = " or ".join(dict.fromkeys(f"below {folder.resolve()}" for folder in folders))
    remedy = f"Put the file {where} and give its path from there."
    path = Path(str(name))
    if not isinstance(name, (str, Path)) or path.is_absolute() or ".." in path.parts or not str(name).strip():
        raise InputError(field, str(name), "a relative path without '..'", remedy)
    for folder in folders:
        here = folder / path
        if here.is_file() and here.resolve().is_relative_to(folder.resolve()):
            return here
    raise InputError(field, str(name), f"a file {where}", "Check its name, or put it there.")


def disk_error(exc: OSError, path: Path) -> WorkError:
    """Return the message for a failed write, with the remedy."""
    if exc.errno in (errno.ENOSPC, errno.EDQUOT):
        what, remedy = "the disk is full", "Free some space"
    elif exc.errno in (errno.EROFS, errno.EACCES, errno.EPERM):
        what, remedy = f"it cannot be written ({exc.strerror})", "Change its permissions (or choose another --results)"
    else:
        what, remedy = f"writing failed ({exc.strerror or exc})", "Repair the folder or the disk"
    return WorkError(f"{path}: {what}. {remedy}, then start again: every finished case is kept.")


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Write a file under a temporary name, flush it to the disk and rename it.

    A failure leaves no file behind, and a killed process leaves the previous file unchanged.

    Parameters
    ----------
    path : pathlib.Path
        The file to write.
    write : callable
        Writes the content; it receives the temporary path.

    Raises
    ------
    WorkError
        If the operating system or the netCDF library cannot write.
    """
    beside = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(beside)
        with open(beside, "rb+") as stream:
            os.fsync(stream.fileno())
        os.replace(beside, path)
        _sync_folder(path.parent)
    except WorkError:
        raise
    except (OSError, RuntimeError) as exc:
        if isinstance(exc, OSError) and (exc.errno or 0) > 0:
            raise disk_error(exc, path) from exc
        free = os.statvfs(path.parent)  # the netCDF library hides the operating system's error
        code = errno.ENOSPC if free.f_bavail * free.f_frsize < 16_000_000 else errno.EIO
        raise disk_error(OSError(code, str(exc)), path) from exc
    finally:
        with contextlib.suppress(OSError):
            beside.unlink()


def write_text(path: Path, text: str) -> None:
    """Write a text file whole or not at all; see `write_whole`."""
    write_whole(path, lambda beside: beside.write_text(text, encoding="utf-8"))


def _sync_folder(folder: Path) -> None:
    with contextlib.suppress(OSError):  # some file systems cannot flush a folder
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file, in hexadecimal digits."""
    with open(path, "rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
