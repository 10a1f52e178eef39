"""Read and write the YAML files of users: one guarded loader for every such file of the program.

The text is YAML 1.2 (core schema). A scalar without quotes that YAML 1.1 reads differently, such as `030`, `1:30`,
`3_0` or `yes`, is refused; the message says what to write instead. Values are counted while they are composed, aliases
in full, so that a small file cannot grow into millions of values. ruamel.yaml parses and writes; its own composer reads
these scalars without a word, ends the process at deep nesting, and takes twice as long.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.representer import SafeRepresenter

from trackroller.errors import InputError
from trackroller.materials.yaml_composer import TAG, Composer, plain_scalar

MAX_BYTES = 5_000_000  # bytes; a larger table of cases belongs into a CSV file


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
