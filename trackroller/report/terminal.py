"""Tables and texts on a terminal, in a file or in a pipe."""

from __future__ import annotations

import os
import sys
import textwrap
from collections.abc import Sequence
from typing import TextIO

from rich.console import Console
from rich.table import Table

from trackroller.errors import escaped

NARROW = 12  # letters; cells that are longer may be broken between words
FRAME = 3  # letters that the frame takes for each column
WIDE = 10_000  # letters of a line in a file or a pipe, which no window limits


def room() -> int:
    """Return the letters of a line: COLUMNS, else those of the terminal; a file or a pipe has no
    limit.
    """
    columns = os.environ.get("COLUMNS", "").lstrip("0")
    # not `Console.is_terminal`: that is true for a file, too, where FORCE_COLOR asks for colours
    if columns.isdigit() or sys.stdout.isatty():
        return Console().width
    return WIDE


def print_table(
    heads: Sequence[str],
    rows: Sequence[Sequence[str]],
    right: Sequence[int] = (),
    title: str | None = None,
    names: int = 1,
) -> None:
    """Print a table that cuts no cell: cells are broken between words, and a table that is too wide
    is parted.

    Each part of a table repeats its first columns, which name the rows, where the line has room for
    them.

    Parameters
    ----------
    heads, rows : texts of the columns
    right : numbers of the columns that are aligned to the right
    title : text above the table
    names : number of first columns that name a row
    """
    width = room()
    columns = [[head, *(row[i] for row in rows)] for i, head in enumerate(heads)]
    least = [_least(cells) for cells in columns]
    wide = sum(least[:names]) + FRAME * names > width / 2
    if wide:
        repeated = [0]
    else:
        repeated = list(range(names))
    parts = [list(repeated)]
    for i in range(len(repeated), len(heads)):
        if sum(least[j] + FRAME for j in (*parts[-1], i)) + 1 > width and len(parts[-1]) > len(
            repeated
        ):
            parts.append(list(repeated))
        parts[-1].append(i)
    console = Console(width=width, highlight=False, markup=False)
    for number, own in enumerate(parts):
        heading = title
        if number:
            heading = None
        table = Table(title=heading, title_justify="left")
        spare = width - 1 - sum(least[i] + FRAME for i in own)
        for i in own:
            extra = max(0, min(spare, max(map(len, columns[i])) - least[i]))
            spare -= extra
            table.add_column(heads[i], width=least[i] + extra, overflow="fold")
            table.columns[-1].justify = "left"
            if i in right:
                table.columns[-1].justify = "right"
        for row in rows:
            table.add_row(*(row[i] for i in own))
        console.print(table)


def _least(cells: Sequence[str]) -> int:
    """Return the letters that a column needs so that only long cells are broken, and only between
    words.
    """
    longest = max(map(len, cells))
    word = max((len(word) for cell in cells for word in cell.split()), default=0)
    if longest <= NARROW:
        return longest
    return max(word, NARROW)


def print_text(text: str, head: str = "", to: TextIO | None = None) -> None:
    """Print a sentence after a head of its own column, broken between words where the line ends.

    A character of a file's name that a terminal obeys stands as an escape.
    """
    first_indent = ""
    indent = "  "
    if head:
        first_indent = f"{head:<9}"
        indent = " " * 9
    lines = textwrap.wrap(
        escaped(text),
        room(),
        initial_indent=first_indent,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
    print("\n".join(lines), file=to)
