"""The mark of a study's folder: `plan.json`, which fits its own digest and says that trackroller
made the folder.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from trackroller.files import STUDY_MARK, open_here

MARK = STUDY_MARK
LIST = "plan/files.jsonl"  # the manifest of a study
# raise it when a file of the store gets another meaning; other formats are refused by name
STORE_FORMAT = 1
OURS = {"store_format": STORE_FORMAT, "made_by": "trackroller", "manifest": LIST}  # the mark
MAPPINGS = ("inputs", "chunks")  # keys of the plan that hold an entry for each name


def signed(record: Mapping[str, Any]) -> str:
    """Return the text of a plan with our mark and its digest."""
    marked = {**OURS, **record}
    return json.dumps({**marked, "digest": _digest_of(marked)}) + "\n"


def _digest_of(record: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(record, sort_keys=True).encode()).hexdigest()


def read_mark(root: Path) -> dict[str, Any]:
    """Return what `plan.json` of a folder says, of any version; {} if there is none, or it does not
    fit its digest.
    """
    path = root / MARK
    try:
        state = os.lstat(path)
        return dict(
            _parsed_mark(path, (state.st_ino, state.st_mtime_ns, state.st_size, state.st_mode))
        )
    except OSError:
        return {}


# each written file asks for it, and the plan of a large study has megabytes
@functools.lru_cache(64)
def _parsed_mark(path: Path, state: tuple[int, ...]) -> dict[str, Any]:
    try:
        with open_here(path, "rb") as stream:
            record: dict[str, Any] = json.load(stream)
        if record.pop("digest") != _digest_of(record):
            return {}
        if all(isinstance(record.get(key, {}), dict) for key in MAPPINGS):
            return record
        return {}
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return {}


def is_study(root: Path) -> bool:
    """Return whether a folder bears our mark."""
    return OURS.items() <= read_mark(root).items()
