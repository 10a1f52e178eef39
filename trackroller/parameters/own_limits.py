"""Files with limits of a user's own, `config/limits/NAME.py`: whether they are allowed, and what they declare.

They are programs, so they are loaded only where the user allows code: by `--allow-code` on the command line, or by the
environment variable TRACKROLLER_ALLOW_CODE with the folder, which worker processes and the jobs of a workflow inherit.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

from trackroller.errors import InputError

VARIABLE = "TRACKROLLER_ALLOW_CODE"  # the command line sets it for --allow-code


def hint(name: Any) -> str:
    """Return how to load the file of the folder config/limits that declares a limit; an empty text if none does."""
    file = Path("config", "limits", f"{name}.py")
    return f"{file} declares it: add --allow-code." if file.is_file() else ""


@cache
def digests() -> dict[Path, str]:
    """Return the SHA-256 of each allowed file, sorted by name; the files are read once, before they are loaded."""
    folder = os.environ.get(VARIABLE)
    files = sorted(Path(folder).resolve().glob("*.py")) if folder else ()
    return {path: hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@cache
def declarations() -> dict[str, Any]:
    """Return what the allowed files declare, in the form of `limits.json`.

    A process of its own loads them, because the declarations are needed before the room `damage` can be imported.

    Raises
    ------
    InputError
        If a file cannot be loaded, or if the folder has none.
    """
    if VARIABLE not in os.environ:
        return {"groups": {}, "mappings": {}, "parameters": [], "materials": []}
    if not digests():
        allowed = "a folder with limits, one file NAME.py each"
        raise InputError("--allow-code", os.environ[VARIABLE], allowed, "Add a file, or leave out --allow-code.")
    words = [sys.executable, "-m", "trackroller.damage.own", *map(str, digests())]
    bare = {name: value for name, value in os.environ.items() if name != VARIABLE}
    done = subprocess.run(words, env=bare, capture_output=True, text=True, check=False)
    if done.returncode:
        why = done.stderr.strip().splitlines()[-1:] or ["no reason"]
        raise InputError("limits", os.environ[VARIABLE], "files that declare one LIMIT each", f"Correct it: {why[0]}")
    content: dict[str, Any] = json.loads(done.stdout)
    return content
