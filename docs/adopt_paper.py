"""Takes results/paper over into docs/paper.md: `python docs/adopt_paper.py [results/paper]`, after `snakemake paper`.

With `--check` it only compares the page with its data and ends with 1 if it is not up to date.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from adopt import DATA, copy_figures, main

from trackroller.pages import markdown
from trackroller.paper import STORED, stored
from trackroller.paper_page import blocks

MADE_BY = "made by docs/adopt_paper.py from trackroller/data/paper_results.json"


def page() -> str:
    """The page from the data in the repository."""
    figures = json.loads((DATA / "paper_figures.json").read_text(encoding="utf-8"))
    return markdown(blocks(stored(), figures), MADE_BY)


def adopt(results: Path) -> None:
    """Copy data and figures."""
    shutil.copy(results / "paper.json", STORED)
    shutil.copy(results / "figures" / "index.json", DATA / "paper_figures.json")
    copy_figures(results, [picture.stem for picture in (results / "figures").glob("paper_*.png")], colours=96)


if __name__ == "__main__":
    main("paper", page, adopt)
