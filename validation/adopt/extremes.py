"""Copy results/extremes into docs/validation/extremes.md, its data and figures.

`snakemake -s validation/Snakefile --cores all extremes; python -m validation.adopt.extremes`; with `--check` it only
compares the page with the kept data and ends with 1 if the page is not up to date.
"""

from __future__ import annotations

import json
from pathlib import Path

from validation.adopt.common import DATA, PAGES, PICTURES, copy_figures, main, shortened
from validation.extremes.page import blocks, read
from validation.pages import markdown

KEPT = DATA / "extremes.json"
LEFT_OUT = ("The scenes", "Kernels against many digits")
MADE_BY = "made by validation/adopt/extremes.py from docs/data/extremes.json"


def page() -> str:
    """Return the page from the stored data."""
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    shown = shortened(blocks(kept["record"], kept["figures"]), LEFT_OUT, "docs/data/extremes.json")
    return markdown(shown, MADE_BY, PICTURES)


def adopt(results: Path) -> None:
    """Copy data (without the regime map, which the figure shows) and figures."""
    record, figures = read(results)
    record.pop("map")
    KEPT.write_text(json.dumps({"record": record, "figures": figures}) + "\n", encoding="utf-8")
    copy_figures(results, [figure["name"] for figure in figures])


if __name__ == "__main__":
    main("extremes", PAGES / "extremes.md", page, adopt)
