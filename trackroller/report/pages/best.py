"""The best designs of a study side by side, on one page."""

from __future__ import annotations

from pathlib import Path

from trackroller.analysis.table import StudyView
from trackroller.report.html import render, write_page
from trackroller.report.numbers import lives_in_years
from trackroller.report.tables.designs import best_table
from trackroller.report.tables.optimum import optima_table
from trackroller.report.tables.table import Table, cell
from trackroller.report.words.designs import best_design
from trackroller.report.words.optimum import optimum_sentences


@lives_in_years
def best_of(view: StudyView) -> tuple[list[str], Table | None]:
    """Return sentences on the best designs of a study, and a table of up to five of them."""
    said = [sentence.text for sentence in optimum_sentences(view) or best_design(view)]
    return said, optima_table(view) or best_table(view)


def write_best(view: StudyView, out: Path) -> Path:
    """Write the comparison of the best designs as one page (.html or .pdf), and return its path."""
    said, table = best_of(view)
    name = str(view.study.get("name") or "study")
    return write_page(out, render("best.html.j2", {"name": name, "said": said, "table": table}, cell=cell))
