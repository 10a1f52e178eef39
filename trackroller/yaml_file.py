"""Read and write the YAML files of users: one guarded loader for every such file of the program.

ruamel.yaml reads the text as YAML 1.2 with the rules of `_Resolver`. A scalar without quotes that YAML 1.1 reads
differently, such as `030`, `1:30`, `3_0` or `yes`, is refused; the message says what to write instead. Nesting and
aliases are counted on the events of the parser first, so that a small file can neither grow into millions of values nor
end the process.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from itertools import pairwise
from pathlib import Path
from typing import Any, ClassVar

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.constructor import DuplicateKeyError, SafeConstructor
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import AliasEvent, CollectionEndEvent, CollectionStartEvent, ScalarEvent
from ruamel.yaml.nodes import MappingNode, ScalarNode, SequenceNode
from ruamel.yaml.representer import SafeRepresenter
from ruamel.yaml.resolver import BaseResolver
from ruamel.yaml.scalarstring import DoubleQuotedScalarString

from trackroller.errors import InputError, checked_text, raise_all
from trackroller.files import read_text

MAX_VALUES = 200_000  # with aliases counted in full
MAX_DEPTH = 60
TAG = "tag:yaml.org,2002:"
AMBIGUOUS = f"{TAG}ambiguous"
_INFINITY = r"[-+]?\.(?:inf|Inf|INF)"
_PLAIN = {  # what a scalar without quotes is, in the order in which the patterns are tried
    "null": r"null|Null|NULL|~|",
    "bool": r"true|True|TRUE|false|False|FALSE",
    "merge": r"<<",
    "int": r"[-+]?(?:0|[1-9][0-9]{0,39})",
    "ambiguous": r"[-+]?0[0-9]+|[-+]?0[xob][0-9a-fA-F_]+|[-+]?[0-9]{41,}"  # octal, other bases, too long
    r"|[-+]?[0-9][0-9_]*(?::[0-5]?[0-9])+(?:\.[0-9_]*)?"  # a number to base 60 in YAML 1.1
    r"|[-+]?[0-9][0-9_]*_[0-9_.]*(?:[eE][-+]?[0-9]+)?"  # a number in YAML 1.1 and a text in YAML 1.2
    r"|yes|Yes|YES|no|No|NO|on|On|ON|off|Off|OFF"  # a truth value in YAML 1.1 and a text in YAML 1.2
    r"|(?=.*[^\x00-\x7f])[-+]?[\d.]+(?:[eE][-+]?\d+)?",  # digits of another script
    "float": rf"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|{_INFINITY}|\.(?:nan|NaN|NAN)",
}


class _Resolver(BaseResolver):
    """Says what a scalar without quotes is: YAML 1.2, and nothing that YAML 1.1 reads differently."""

    def __init__(self, version: Any = None, loadumper: Any = None) -> None:
        super().__init__(loadumper)  # without the patterns of a version, which `YAML` would add


for _name, _pattern in _PLAIN.items():
    _Resolver.add_implicit_resolver_base(f"{TAG}{_name}", re.compile(rf"(?:{_pattern})\Z"), None)


class _Constructor(SafeConstructor):
    """Makes plain data; a tag other than those of plain data is an error of the library."""

    yaml_constructors: ClassVar[dict[Any, Any]] = {}  # type: ignore[misc]

    def number(self, node: Any) -> float:
        """Return a number with a fraction, an exponent, or no end."""
        text = node.value.lower().replace(".inf", "inf").replace(".nan", "nan")
        value = float(text)
        if math.isinf(value) and "inf" not in text:
            raise self.refused(node)
        return value

    def text(self, node: Any) -> str:
        """Return a text without control characters."""
        return checked_text(str(self.construct_scalar(node)), f"line {node.start_mark.line + 1}", lines=True)

    def refused(self, node: Any) -> InputError:
        """Return the error for an ambiguous scalar, or one that no number can hold."""
        if len(node.value) <= 60:
            shown = node.value
        else:
            shown = f"{node.value[:57]}..."
        allowed = "an unambiguous value; YAML 1.1 and YAML 1.2 differ here, or the number is too large"
        remedy = "Write a plain decimal number, true or false; or put a text in quotes."
        return InputError(f"line {node.start_mark.line + 1}", shown, allowed, remedy)

    def ambiguous(self, node: Any) -> Any:
        """Refuse an ambiguous scalar."""
        raise self.refused(node)

    def construct_mapping(self, node: Any, deep: bool = False) -> Any:
        """Return a mapping; a key is a text, whatever YAML 1.1 made of it."""
        for key, _ in node.value:
            if isinstance(key, ScalarNode) and key.tag == AMBIGUOUS and key.value.isalpha():
                key.tag = f"{TAG}str"
        return super().construct_mapping(node, deep)


for _tag in (None, *(f"{TAG}{_name}" for _name in ("null", "bool", "seq", "map"))):  # None refuses other tags
    _Constructor.add_constructor(_tag, SafeConstructor.yaml_constructors[_tag])
_Constructor.add_constructor(f"{TAG}str", _Constructor.text)
_Constructor.add_constructor(f"{TAG}int", lambda self, node: int(node.value))
_Constructor.add_constructor(f"{TAG}float", _Constructor.number)
_Constructor.add_constructor(AMBIGUOUS, _Constructor.ambiguous)


def _check_size(text: str, what: str) -> None:
    """Refuse nesting that is too deep, more values than `MAX_VALUES`, and an alias of a value that contains it."""
    open_sizes = [0]
    names = [None]
    anchors: dict[str | None, int] = {}
    for event in YAML(typ="safe").parse(io.StringIO(text)):
        size = 0
        if isinstance(event, CollectionStartEvent):
            open_sizes.append(1)
            names.append(event.anchor)
        elif isinstance(event, CollectionEndEvent):
            size = open_sizes.pop()
            name = names.pop()
            anchors[name] = size
        elif isinstance(event, ScalarEvent):
            size = anchors[event.anchor] = 1
        elif isinstance(event, AliasEvent):
            if event.anchor in names:
                where = f"{what}, line {event.start_mark.line + 1}"
                raise InputError(where, f"*{event.anchor}", "a value that does not contain itself", "Remove the alias.")
            size = anchors.get(event.anchor, 0)
        open_sizes[-1] += size
        if len(open_sizes) > MAX_DEPTH or open_sizes[-1] > MAX_VALUES:
            allowed = f"YAML of at most {MAX_DEPTH} levels and {MAX_VALUES} values, aliases counted in full"
            remedy = "Put many cases into a CSV file, and nest lists and mappings less deeply."
            raise InputError(f"{what}, line {event.start_mark.line + 1}", "too much", allowed, remedy)


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
    loader = YAML(typ="safe")
    loader.Resolver = _Resolver
    loader.Constructor = _Constructor
    try:
        _check_size(text, what)
        return loader.load(io.StringIO(text))
    except InputError as exc:
        if exc.field.startswith("line"):
            raise exc.named(f"{what}, {exc.field}") from None
        raise
    except MarkedYAMLError as exc:
        mark = exc.problem_mark or exc.context_mark
        where = f"line {mark.line + 1}" if mark else "the file"
        reason = " ".join(str(exc.problem or exc).split())
        if isinstance(exc, DuplicateKeyError):
            raise InputError(
                f"{what}, {where}", reason, "each key once", "Remove one of the two lines.", "holds a key twice"
            ) from None
        allowed = "one document of plain YAML, without tags"
        remedy = "Mend the line; texts with ': ' or ' #' need quotes."
        raise InputError(f"{what}, {where}", None, allowed, remedy, f"is not YAML: {reason}") from None
    except (YAMLError, ValueError, RecursionError) as exc:
        reason = " ".join(str(exc).split())[:200]
        raise InputError(what, None, "YAML", "Save it as plain UTF-8 text.", f"is not YAML: {reason}") from None


def lines_of(text: str) -> dict[tuple[str, ...], int]:
    """Return the line of each key of a YAML text by its path, the first line being 1; entries of lists have numbers."""
    lines: dict[tuple[str, ...], int] = {}

    def visit(node: Any, path: tuple[str, ...]) -> None:
        lines.setdefault(path, node.start_mark.line + 1)
        if isinstance(node, MappingNode):
            for key, value in node.value:
                lines[*path, str(key.value)] = key.start_mark.line + 1
                visit(value, (*path, str(key.value)))
        elif isinstance(node, SequenceNode):
            for i, value in enumerate(node.value):
                visit(value, (*path, str(i)))

    root = YAML(typ="safe", pure=True).compose(io.StringIO(text))
    if root is not None:
        visit(root, ())
    return lines


@contextmanager
def errors_by_line(
    text: str, elsewhere: Collection[str] = (), file: str | None = None, aliases: Mapping[str, str] | None = None
) -> Iterator[None]:
    """Give the input errors of a file their lines in the text, and raise them in this order.

    Parameters
    ----------
    text : str
        Text of the file.
    elsewhere : collection of str
        Keys whose values come from elsewhere, such as the command line.
    file : str, optional
        Name of the file for the messages, if the user did not name it on the command line.
    aliases : mapping, optional
        Names in messages by the other names that the file may use for them.
    """
    try:
        yield
    except InputError as error:
        lines: dict[tuple[str, ...], int] = {}
        with suppress(YAMLError):  # the two parsers of ruamel.yaml differ in odd texts
            lines = {_parts(".".join(path)): line for path, line in lines_of(text).items()}
        known = aliases or {}
        named = {path: (*path[:-1], known[path[-1]]) for path in lines if path and path[-1] in known}
        lines |= {other: lines[path] for path, other in named.items() if other not in lines}
        for one in error.errors:
            if one.file is None:  # an error of another file has its line already
                one.file, one.line = file, _line_of(one, lines, elsewhere)
        raise_all(sorted(error.errors, key=lambda one: (one.file or "", one.line or 0)))


def _parts(text: str) -> tuple[str, ...]:
    return tuple(part for part in re.split(r"[.\[\]\s:]+", text) if part)


def _line_of(error: InputError, lines: Mapping[tuple[str, ...], int], elsewhere: Collection[str]) -> int | None:
    """Return the line of the entry of an error: the longest part of its field, or of its value, that is a key there."""
    parts = _parts(error.field)
    value = _parts(str(error.value)[:200])
    slices = [parts[i : i + n] for n in range(len(parts), -1, -1) for i in range(len(parts) - n + 1)]
    before = _parts(".".join(error.path))
    paths = [(*before, *some, *own) for some in slices for own in (value, ())]
    own = (path for path in paths if path and path in lines and path[0] not in elsewhere)
    named = (line for path, line in lines.items() if path and parts and path[-1] == parts[-1] != path[0])
    return next((lines[path] for path in own), next(named, None))


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


def change_yaml(text: str, changes: Iterable[tuple[Sequence[str | int], str | None]], what: str) -> str:
    r"""Return a YAML text with some values changed; its comments and its other lines stay.

    Parameters
    ----------
    text : str
        One YAML document, a mapping.
    changes : iterable of (path, value)
        Keys and numbers of list entries that lead to a value, and the value as it is typed; None removes the entry. A
        mapping that is not there is added, and a number one behind the last entry of a list adds an entry.
    what : str
        Kind of text, for messages.

    Raises
    ------
    InputError
        If the text is no YAML mapping, or if a path leads nowhere.

    Examples
    --------
    >>> change_yaml("mass: {at: [0, 0, 60]} # empty\n", [(["mass", "at", 2], "70"), (["name"], "cart")], "file")
    'mass: {at: [0, 0, 70]} # empty\nname: cart\n'
    """
    parse_mapping(text, what)
    editor = YAML(typ="rt")
    editor.width = 10_000  # a long line stays one
    editor.preserve_quotes = True  # type: ignore[assignment]  # the library types its default, None
    editor.indent(mapping=2, sequence=4, offset=2)
    whole = editor.load(text)
    for path, value in changes:
        place = whole
        try:
            for key, after in pairwise(path):
                if isinstance(place, CommentedMap) and place.get(key) is None:
                    if isinstance(after, int):
                        place[key] = CommentedSeq()
                    else:
                        place[key] = CommentedMap()
                    place[key].fa.set_flow_style()
                place = place[key]
            if value is None:
                del place[path[-1]]
            elif isinstance(place, CommentedSeq) and path[-1] == len(place):
                place.append(_typed(editor, value, what))
            else:
                place[path[-1]] = _typed(editor, value, what)
        except (KeyError, IndexError, TypeError, AttributeError):
            where = ".".join(map(str, path))
            raise InputError(
                where, value, f"an entry of the {what}", "Change the text instead.", "is not there"
            ) from None
    out = io.StringIO()
    editor.dump(whole, out)
    return out.getvalue()


def _typed(editor: YAML, value: str, what: str) -> Any:
    """Return a value as it is typed: what YAML reads, and a text if it is no YAML."""
    try:
        parse_yaml(value, what)
    except InputError:
        if needs_quotes(value):
            return DoubleQuotedScalarString(value)
        return value
    return editor.load(value)


def needs_quotes(text: str) -> bool:
    """Return whether a text without quotes would be refused or read as something else."""
    return any(re.fullmatch(pattern, text) for pattern in _PLAIN.values())


class _Representer(SafeRepresenter):
    """Writes texts in quotes wherever the reader would not take them as texts."""

    def represent_text(self, text: str) -> Any:
        """Return the node of a text."""
        style = None
        if needs_quotes(text):
            style = '"'
        return self.represent_scalar(f"{TAG}str", text, style=style)


_Representer.add_representer(str, _Representer.represent_text)
