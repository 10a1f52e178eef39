"""List the licences of every package that the lock files pin: `python docs/licences.py [--write]`.

The list comes from the metadata of the installed packages. Without `--write` the program compares the packages of the
lock files with the licences in `LICENCES.md` and ends with 1 if they differ.
"""

from __future__ import annotations

import re
import sys
from importlib import metadata
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "LICENCES.md"
LOCKS = ("requirements.lock", "requirements-ci.lock")
HEAD = """# Licences of the dependencies

Made by `make lock` from the metadata of the packages. trackroller is under the MIT licence and ships none of them.
The script of the explorer holds fflate (MIT) and d3-scale with the d3 modules it needs (ISC); their licences stand at
its head, in `trackroller/report/explorer/assets/explorer.js` and in every report.

| package | licence |
| --- | --- |
"""


def locked() -> list[str]:
    """Return the names of the packages in the lock files, normalised and sorted."""
    found = set()
    for lock in LOCKS:
        text = (ROOT / lock).read_text(encoding="utf-8")
        found |= {_normal(name) for name in re.findall(r"^([A-Za-z0-9_.-]+)==", text, re.M)}
    return sorted(found)


def _normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def licence(name: str) -> str:
    """Return the licence of an installed package in a few words, 'not installed here' for one that is not."""
    try:
        meta = metadata.metadata(name)
    except metadata.PackageNotFoundError:
        return "not installed here"
    stated = meta.get("License-Expression") or ""
    classes = [c.rpartition("::")[2].strip() for c in meta.get_all("Classifier", []) if c.startswith("License ::")]
    free = (meta.get("License") or "").strip().splitlines()
    return (
        stated
        or ", ".join(dict.fromkeys(c for c in classes if c != "OSI Approved"))
        or (free[0][:60] if free else "see package")
    )


def render() -> str:
    """Return the page."""
    return HEAD + "".join(f"| {name} | {licence(name)} |\n" for name in locked())


def main() -> int:
    """Write the page, or compare its packages with the lock files."""
    if "--write" in sys.argv[1:]:
        PAGE.write_text(render(), encoding="utf-8")
        return 0
    listed = re.findall(r"^\| ([a-z0-9-]+) \| (?!licence|---)", PAGE.read_text(encoding="utf-8"), re.M)
    return int(listed != locked())


if __name__ == "__main__":
    raise SystemExit(main())
