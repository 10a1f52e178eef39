"""Takes results/paper over into docs/paper.md: `python docs/adopt_paper.py [results/paper]`, after `snakemake paper`.

With `--check` it only compares the page with its data and ends with 1 if it is not up to date.
"""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

from trackroller.pages import markdown
from trackroller.paper import STORED, stored
from trackroller.paper_page import blocks

FOLDER = Path(__file__).parent
MADE_BY = "made by docs/adopt_paper.py from trackroller/data/paper_results.json"


def page() -> str:
    """The page from the data in the repository."""
    figures = json.loads((FOLDER / "data" / "paper_figures.json").read_text(encoding="utf-8"))
    return markdown(blocks(stored(), figures), MADE_BY)


def adopt(results: Path) -> None:
    """Copy data and figures, the latter with few colours so that the repository stays small; write the page."""
    from PIL import Image

    (FOLDER / "data").mkdir(exist_ok=True)
    shutil.copy(results / "paper.json", STORED)
    shutil.copy(results / "figures" / "index.json", FOLDER / "data" / "paper_figures.json")
    for picture in (results / "figures").glob("paper_*.png"):
        with Image.open(picture) as image:
            image.convert("RGB").quantize(96).save(FOLDER / "figures" / picture.name, optimize=True)
    (FOLDER / "paper.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    words = sys.argv[1:]
    if "--check" in words:
        raise SystemExit((FOLDER / "paper.md").read_text(encoding="utf-8") != page())
    adopt(Path(words[0] if words else "results/paper"))
