"""The best designs of a study side by side, on one page."""

from __future__ import annotations

from pathlib import Path

from trackroller.report.html import render, write_page
from trackroller.report.numbers import lives_in_years
from trackroller.report.tables.table import Table, cell
from trackroller.report.words.cases import valid_cases
from trackroller.report.words.designs import best_table
from trackroller.report.words.optimum import optima_table, optimum_sentences, searched
from trackroller.report.words.verdict import verdict_sentences
from trackroller.results.results import Results


@lives_in_years
def best_of(results: Results) -> tuple[list[str], Table | None]:
    """Return sentences on the best designs of a study, and a table of up to five of them."""
    optimum = optimum_sentences(results)
    said = [*optimum, *searched(results)] or verdict_sentences(results)
    ranked = bool(optimum) or results.verdict is not None
    if ranked and not (optimum or results.valid.all()):
        said = [*said, valid_cases(results)]  # a design that is left out may have the longest life
    table = (optima_table(results) or best_table(results)) if ranked else None
    return [sentence.text for sentence in said], table


def write_best(results: Results, out: Path) -> Path:
    """Write the comparison of the best designs as one page (.html or .pdf), and return its path."""
    said, table = best_of(results)
    content = {"name": results.config.name, "said": said, "table": table}
    return write_page(out, render("best.html.j2", content, cell=cell))
