"""Takes results/extremes over into docs/extremes.md, its data and figures.

`snakemake --cores all extremes; python docs/adopt_extremes.py`; with `--check` it only compares the page with the kept
data and ends with 1 if the page is not up to date.
"""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

from trackroller.study.extremes_page import markdown, read

FOLDER = Path(__file__).parent
KEPT = FOLDER / "data" / "extremes.json"


def page() -> str:
    """The page from the kept data."""
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    return markdown(kept["record"], kept["figures"])


def adopt(results: Path) -> None:
    """Copy data (without the regime map, which the figure shows) and figures."""
    record, figures = read(results)
    record.pop("map")
    KEPT.parent.mkdir(exist_ok=True)
    KEPT.write_text(json.dumps({"record": record, "figures": figures}) + "\n", encoding="utf-8")
    for figure in figures:
        shutil.copy(results / "figures" / f"{figure['name']}.png", FOLDER / "figures")


if __name__ == "__main__":
    if "--check" in sys.argv:
        sys.exit((FOLDER / "extremes.md").read_text(encoding="utf-8") != page())
    adopt(FOLDER.parent / "results" / "extremes")
    (FOLDER / "extremes.md").write_text(page(), encoding="utf-8")
