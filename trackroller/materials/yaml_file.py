"""Reading users' YAML: data only, and every way it can be wrong told in one line."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml

from trackroller.errors import InputError

MAX_BYTES = 5_000_000  # a study file larger than this is a table and belongs into a CSV
MAX_NODES = 500_000


class _Loader(yaml.SafeLoader):
    """Safe loader that refuses keys written twice and reads 1e4 and inf as the numbers they are."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen = set()
        for key_node, _ in node.value:
            key = key_node.value if isinstance(key_node, yaml.ScalarNode) else None
            if key is not None and key in seen:
                line = key_node.start_mark.line + 1
                raise InputError(str(key), f"line {line}", "each key may stand once", "Remove one of them.")
            seen.add(key)
        return super().construct_mapping(node, deep)


_Loader.yaml_implicit_resolvers = {k: list(v) for k, v in yaml.SafeLoader.yaml_implicit_resolvers.items()}
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?(?:[0-9]+(?:\.[0-9]*)?[eE][-+]?[0-9]+|\.[0-9]+[eE][-+]?[0-9]+)$"),
    list("-+0123456789."),
)


def read_text(path: Path | str, what: str) -> str:
    """Text of a user's file; raises `InputError` for a file that is missing, too large or not UTF-8."""
    path = Path(path)
    try:
        if path.is_dir():
            raise InputError(what, str(path), "a file is wanted, this is a folder")
        data = path.read_bytes()
    except FileNotFoundError:
        raise InputError(what, str(path), "the file does not exist", "Check the path.") from None
    except (OSError, ValueError) as exc:
        raise InputError(what, str(path), f"the file cannot be read ({exc})") from None
    if len(data) > MAX_BYTES:
        raise InputError(what, str(path), f"at most {MAX_BYTES // 1_000_000} MB")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as exc:
        raise InputError(what, str(path), f"the file is not UTF-8 text (byte {exc.start})") from None


def parse_mapping(text: str, what: str) -> dict[str, Any]:
    """A mapping from YAML text; raises `InputError` with the line for text that is none."""
    try:
        data = yaml.load(text, Loader=_Loader)  # a SafeLoader
    except InputError:
        raise
    except yaml.MarkedYAMLError as exc:
        where = f"line {exc.problem_mark.line + 1}" if exc.problem_mark else "the file"
        raise InputError(what, where, f"this is not YAML: {exc.problem or exc}") from None
    except (yaml.YAMLError, ValueError, TypeError, OverflowError) as exc:
        raise InputError(what, "the file", f"this is not YAML: {str(exc).splitlines()[0]}") from None
    except RecursionError:
        raise InputError(what, "the file", "this is nested too deeply") from None
    if not isinstance(data, dict):
        raise InputError(what, type(data).__name__, "a mapping of keys to values is wanted")
    _refuse_bombs(data, what)
    for key in data:
        if not isinstance(key, str):
            raise InputError(what, key, "keys are texts")
    return data


def read_mapping(path: Path | str, what: str = "file") -> dict[str, Any]:
    """A mapping from a user's YAML file (see `read_text` and `parse_mapping`)."""
    return parse_mapping(read_text(path, what), what)


def _refuse_bombs(data: Any, what: str) -> None:
    """Aliases may repeat a value, but not blow a small file up to millions of values, nor hold themselves."""
    sizes: dict[int, int] = {}
    open_nodes: set[int] = set()

    def size(node: Any) -> int:
        if not isinstance(node, (dict, list, tuple, set)):
            return 1
        if id(node) in open_nodes:
            raise InputError(what, "alias", "a value may not contain itself")
        if id(node) not in sizes:
            open_nodes.add(id(node))
            children = [*node.keys(), *node.values()] if isinstance(node, dict) else list(node)
            sizes[id(node)] = 1 + sum(size(child) for child in children)
            open_nodes.discard(id(node))
        return sizes[id(node)]

    try:
        total = size(data)
    except RecursionError:
        raise InputError(what, "the file", "this is nested too deeply") from None
    if total > MAX_NODES:
        raise InputError(what, f"{total} values", f"at most {MAX_NODES} values (aliases counted in full)")
