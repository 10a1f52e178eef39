"""The best designs of a study side by side, on one page."""

from __future__ import annotations

from pathlib import Path

from trackroller.analysis.table import StudyView
from trackroller.report.html import render, write_page
from trackroller.report.numbers import lives_in_years
from trackroller.report.tables.table import Table, cell
from trackroller.report.words.cases import valid_cases
from trackroller.report.words.designs import best_design, best_table
from trackroller.report.words.optimum import optima_table, optimum_sentences

NOTHING = "The study has no result that ranks designs. Add life or peak_stress to its outputs, and run it again."


@lives_in_years
def best_of(view: StudyView) -> tuple[list[str], Table | None]:
    """Return sentences on the best designs of a study, and a table of up to five of them."""
    optimum = optimum_sentences(view)
    said = optimum or best_design(view)
    if not said:
        return [NOTHING], None
    if not (optimum or view.valid.all()):
        said = [*said, valid_cases(view)]  # a design that is left out may have the longest life
    return [sentence.text for sentence in said], optima_table(view) or best_table(view)


def write_best(view: StudyView, out: Path) -> Path:
    """Write the comparison of the best designs as one page (.html or .pdf), and return its path."""
    said, table = best_of(view)
    content = {"name": view.study["name"], "said": said, "table": table}
    return write_page(out, render("best.html.j2", content, cell=cell))
