"""Tables on a terminal, in a file or in a pipe."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table


def print_table(
    heads: Sequence[str], rows: Sequence[Sequence[str]], width: int, right: Sequence[int] = (), title: str | None = None
) -> None:
    """Print a table, as wide as the terminal, or `width` letters in a file or pipe.

    Parameters
    ----------
    heads, rows : texts of the columns
    width : letters of a line
    right : numbers of the columns that are aligned to the right
    title : text above the table
    """
    table = Table(title=title, title_justify="left")
    for i, head in enumerate(heads):
        table.add_column(head, justify="right" if i in right else "left")
    for row in rows:
        table.add_row(*row)
    Console(width=None if Console().is_terminal else width, highlight=False, markup=False).print(table)
