"""A record on a terminal: the answer to a study, or the record of a roller, a spectrum or a
carriage.
"""

from __future__ import annotations

from dataclasses import replace

from trackroller.report.headlines import headline_of, warning_line
from trackroller.report.numbers import on_duty
from trackroller.report.tables.rows import (
    MOST_ROWS,
    MOST_SHOWN,
    ShownTable,
    rows_before_fold,
    rows_of,
)
from trackroller.report.terminal import print_table, print_text
from trackroller.results.answer import Answer, FurtherTable


def print_answer(answer: Answer) -> None:
    """Print the headline of an answer, its table, what all its rows share, and its warnings.

    Columns that are equal in all rows stand once below the table; of a long table the first rows
    are printed.
    """
    with on_duty(answer.facts.get("duty")):
        print_text(headline_of(answer).text)
    print_below_headline(answer)


def print_below_headline(answer: Answer) -> None:
    """Print what `print_answer` prints below the headline."""
    with on_duty(answer.facts.get("duty")):
        if rows_before_fold(answer) < len(answer.table):
            printed = MOST_ROWS
        else:
            printed = len(answer.table)
        _print_rows(rows_of(answer), most=printed)
        left = len(answer.table) - printed
        if left > 0:
            print_text(f"{left:,} more rows stand in the report.")
        for body, limits in answer.not_checked.items():
            if limits:
                print_text(f"not checked, {body}: {', '.join(limits)}")
        for name, why in answer.not_used.items():
            print_text(f"given, but not used: {name}, {why}")
        for caution in answer.warnings:
            print_text(warning_line(caution))


def print_part(answer: Answer, part: FurtherTable) -> None:
    """Print a further table of an answer with its note."""
    with on_duty(answer.facts.get("duty")):
        own = replace(answer, table=part.table, columns=part.columns, required=())
        _print_rows(rows_of(own), part.title, MOST_SHOWN)
        if part.note:
            print_text(part.note)


def _print_rows(table: ShownTable, title: str | None = None, most: int = MOST_ROWS) -> None:
    """Print the first rows of a table, and what all rows share."""
    heads = [f"{head.title} [{head.unit}]" if head.unit else head.title for head in table.heads]
    rows = [[cell.text for cell in row] for row in table.cells[:most]]
    right = [i for i, head in enumerate(table.heads) if "n" in head.kind.split()]
    if rows:
        names = sum("u" in head.kind.split() for head in table.heads)
        name_columns = 1
        if names < len(heads):
            name_columns = max(1, names)
        print_table(heads, rows, right, title, name_columns)
    if table.shared:
        print_text("; ".join(table.shared), "all rows")
