"""Read what the RO-Crate of a folder says of its files; `crate.py` writes it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from trackroller.files import open_here

CRATE = "ro-crate-metadata.json"


def crate_graph(root: Path) -> list[dict[str, Any]]:
    """Return the entries of the crate of a folder, [] if there is no crate."""
    try:
        with open_here(root / CRATE, "rb") as stream:
            return [entry for entry in json.load(stream)["@graph"] if isinstance(entry, dict)]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return []


def digests_of_crate(root: Path) -> dict[str, str]:
    """Return the digests of the files that the crate of a folder lists, {} if there is no crate."""
    return {
        str(entry.get("@id")): str(entry["sha256"])
        for entry in crate_graph(root)
        if "sha256" in entry
    }
