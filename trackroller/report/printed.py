"""The answer to a study on a terminal."""

from __future__ import annotations

from trackroller.report.headlines import headline_of, warning_line
from trackroller.report.numbers import on_duty
from trackroller.report.tables.rows import MOST_ROWS, rows_of
from trackroller.report.terminal import print_table, print_text
from trackroller.results.answer import Answer


def print_answer(answer: Answer) -> None:
    """Print the headline of an answer, its table, what all its rows share, and its warnings.

    Columns that are equal in all rows stand once below the table; of a long table the first rows are printed.
    """
    with on_duty(answer.facts.get("duty")):
        print_text(headline_of(answer).text)
        table = rows_of(answer)
        heads = [f"{head.title} [{head.unit}]" if head.unit else head.title for head in table.heads]
        rows = [[cell.text for cell in row] for row in table.cells[:MOST_ROWS]]
        right = [i for i, head in enumerate(table.heads) if "n" in head.kind.split()]
        if rows:
            print_table(heads, rows, right)
        left = len(answer.table) - len(rows)
        if left > 0:
            print_text(f"{left:,} more rows stand in the report.")
        if table.shared:
            print_text("; ".join(table.shared), "all rows")
        for body, limits in answer.not_checked.items():
            if limits:
                print_text(f"not checked, {body}: {', '.join(limits)}")
        for caution in answer.warnings:
            print_text(warning_line(caution))
