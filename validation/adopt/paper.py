"""Take results/paper over into docs/validation/paper.md: `python -m validation.adopt.paper [results/paper]`.

Run `snakemake -s validation/Snakefile --cores all paper` first.
With `--check` it only compares the page with its data and ends with 1 if it is not up to date.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from validation.adopt.common import DATA, PAGES, PICTURES, copy_figures, main
from validation.pages import markdown
from validation.paper.compute import STORED, stored
from validation.paper.page import blocks

MADE_BY = "made by validation/adopt/paper.py from validation/paper/paper_results.json"


def page() -> str:
    """Return the page from the data in the repository."""
    figures = json.loads((DATA / "paper_figures.json").read_text(encoding="utf-8"))
    return markdown(blocks(stored(), figures), MADE_BY, PICTURES)


def adopt(results: Path) -> None:
    """Copy data and figures."""
    shutil.copy(results / "paper.json", STORED)
    shutil.copy(results / "figures" / "index.json", DATA / "paper_figures.json")
    copy_figures(results, [picture.stem for picture in (results / "figures").glob("paper_*.png")], colours=96)


if __name__ == "__main__":
    main("paper", PAGES / "paper.md", page, adopt)
