"""Read the CSV files of users: a line of names, then lines with one cell for each name."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from trackroller.errors import InputError


def csv_names(text: str, path: Path | str, field: str) -> list[str]:
    """Return the names of the columns; see `csv_lines`."""
    head = next((line for line in text.splitlines() if line.strip(" ,")), "")
    return csv_lines(f"{head}\n{head}", path, field, "line")[0]


def csv_lines(text: str, path: Path | str, field: str, what: str) -> tuple[list[str], dict[int, list[str]]]:
    """Return the names of the columns, and the cells of each line by its number in the file, the first line being 1.

    Spaces around a cell and empty lines are left out.

    Parameters
    ----------
    text : str
        Content of the file.
    path : Path or str
        Its path, for messages.
    field : str
        Key of the study or spectrum that names the file, for messages.
    what : str
        What a line describes, such as 'case'.

    Raises
    ------
    InputError
        If the file is not readable as CSV, has only one line, repeats a name, or has a line of another length.
    """
    try:
        reader = csv.reader(io.StringIO(text, newline=""))
        cells = ((reader.line_num, [cell.strip() for cell in row]) for row in reader)
        lines = {number: line for number, line in cells if any(line)}
    except csv.Error as exc:
        raise InputError(field, str(path), f"a readable CSV file ({exc})", "Shorten its cells.") from None
    if len(lines) < 2:
        raise InputError(field, str(path), f"a CSV with a line of names and at least one {what}")
    names = lines.pop(next(iter(lines)))
    if len(set(names)) < len(names) or not all(names):
        remedy = f"Correct the first line of {path}."
        raise InputError(field, ", ".join(names), "a different name for each column", remedy)
    for number, line in lines.items():
        if len(line) != len(names):
            raise InputError(field, f"{path}, line {number}", f"{len(names)} cells; there are {len(line)}")
    return names, lines
