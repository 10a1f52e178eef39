"""Read the columns of a measured log as numbers, in pieces: a log of 50 minutes at 100 Hz has
300,000 lines.
"""

from __future__ import annotations

import codecs
import csv
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd

from trackroller.errors import Collector, InputError
from trackroller.files import UTF_16, opened
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.table_cells import RefusedCell, decimal_signs, plain_column
from trackroller.numerics.units import in_unit, split_quantity
from trackroller.roller.log_answers import LogAnswers
from trackroller.study.file.user_columns import read_table
from trackroller.tables.user_table import UserTable, is_workbook

COLUMNS = {
    "time": "s",
    "distance": "m",
    "radial_force": "N",
    "axial_force": "N",
    "velocity": "m/min",
    "speed": "m/s",
}
FIELD = "--from"
MOST_BYTES = 500_000_000  # of a log; its numbers take about as much memory
FIRST_BYTES = 200_000  # of a log, in which heads, units and decimal sign show
PIECE = 200_000  # lines that are read at once
SMALLER = (
    "Split the log, write a spectrum of each part, and put the blocks of all of them into one file."
)


@dataclass
class LogColumns:
    """The known columns of a log in the units of `COLUMNS`, with the number of each line in the
    file.

    `scales` holds the unit of each column in the file, over that of `COLUMNS`; `bare` names the
    columns that state no unit, and `empty` the lines that were left out because a cell stands for
    no value.
    """

    values: dict[str, np.ndarray]
    lines: np.ndarray
    path: Path
    head: int
    names: list[str]
    scales: dict[str, float] = field(default_factory=dict)
    bare: list[str] = field(default_factory=list)
    empty: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))

    def __len__(self) -> int:
        return len(self.lines)

    def take(self, rows: np.ndarray) -> LogColumns:
        """Return the log with some of its lines, by a mask or in a new order."""
        values = {name: column[rows] for name, column in self.values.items()}
        return LogColumns(
            values,
            self.lines[rows],
            self.path,
            self.head,
            self.names,
            self.scales,
            self.bare,
            self.empty,
        )


def read_columns(path: Path, answers: LogAnswers) -> LogColumns:
    """Return the columns of a log.

    Parameters
    ----------
    path : pathlib.Path
        CSV file or workbook.
    answers : LogAnswers
        What the user says; `missing` names the cells that stand for no value.

    Raises
    ------
    InputError
        If a cell is no finite number; the error names file, line and column.
    """
    wrong = Collector()
    heads = _heads(path, wrong)
    wrong.check()
    pieces = []
    for lines, cells in _pieces(path, heads):
        pieces.append(_numbers(cells, lines, heads, path, answers))
    values = {name: np.concatenate([piece[name] for _, piece in pieces]) for name in _known(heads)}
    lines = np.concatenate([lines for lines, _ in pieces])
    scales = {name: _scale(name, heads) for name in values}
    bare = [f"{name} in {COLUMNS[name]}" for name in values if not _stated_unit(name, heads)]
    log = LogColumns(values, lines, path, heads.head, heads.names, scales, bare)
    empty = np.any([np.isnan(column) for column in values.values()], axis=0)
    if empty.any():
        log = log.take(~empty)
        log.empty = lines[empty]
    return log


def _heads(path: Path, wrong: Collector) -> UserTable:
    """Return the table of the first lines of a log, with its names, units and decimal sign; all of
    a workbook.
    """
    with opened(path, FIELD, MOST_BYTES, SMALLER) as stream:
        if is_workbook(path):
            first = stream.read()
        else:
            first = stream.read(FIRST_BYTES)
    if len(first) == FIRST_BYTES and not is_workbook(path):
        wide = first.startswith(UTF_16)
        newline = b"\n"
        if first.startswith(codecs.BOM_UTF16_LE):
            newline = "\n".encode("utf-16-le")
        elif wide:
            newline = "\n".encode("utf-16-be")
        end = first.rfind(newline)
        while wide and end % 2 and end > 0:  # between two letters
            end = first.rfind(newline, 0, end)
        first = first[: end + len(newline)]
    return read_table(path, FIELD, "line", wrong, optional=COLUMNS, further=COLUMNS, content=first)


def _known(heads: UserTable) -> list[str]:
    return [name for name in heads.names if name in COLUMNS]


def _stated_unit(name: str, heads: UserTable) -> str:
    """Return the unit of a column in the file: that of its head, or that behind its first
    number.
    """
    place = heads.names.index(name)
    first = next((cell for cell in heads.column(place) if cell), "")
    parts = split_quantity(first)
    return heads.units[place] or (parts[1] if parts else "")


def _scale(name: str, heads: UserTable) -> float:
    unit = _stated_unit(name, heads)
    if unit:
        return in_unit(1.0, unit, COLUMNS[name], name)
    return 1.0


def _pieces(path: Path, heads: UserTable) -> Iterator[tuple[np.ndarray, dict[str, list[str]]]]:
    """Yield the numbers of some lines, and the cells of their known columns."""
    if is_workbook(path):
        lines = np.array(list(heads.lines))
        yield lines, {name: heads.column(heads.names.index(name)) for name in _known(heads)}
        return
    first_line = next(iter(heads.lines))
    with opened(path, FIELD, MOST_BYTES, SMALLER) as stream:
        first = stream.read(FIRST_BYTES)
        wide = first.startswith(UTF_16)
        _refuse_zeros(stream, path, wide)
    mark = b'"'
    encoding = "utf-8-sig"
    if wide:
        mark = '"'.encode("utf-16-le")
        encoding = "utf-16"
    # a mark further down is a letter, which no number has
    quoting: Literal[0, 1, 2, 3] = csv.QUOTE_NONE
    if mark in first:
        quoting = csv.QUOTE_MINIMAL
    try:
        with pd.read_csv(
            path,
            sep=heads.separator,
            header=None,
            names=[*range(heads.width), "further"],
            skiprows=first_line - 1,
            dtype=str,
            keep_default_na=False,
            skip_blank_lines=False,
            skipinitialspace=True,
            quoting=quoting,
            encoding=encoding,
            chunksize=PIECE,
        ) as reader:
            for piece in reader:
                yield _cells(piece.fillna(""), first_line, heads, path)
    except UnicodeDecodeError as error:
        remedy = "Save the file as UTF-8; in Excel choose 'CSV UTF-8'."
        wrong = f"is not UTF-8 text ({error.reason})"
        raise InputError(
            FIELD, str(path), "text in UTF-8, or in UTF-16 with its mark", remedy, wrong
        ) from None
    except pd.errors.ParserError as error:
        why = " ".join(str(error).split())
        allowed = f"lines of {heads.width} cells, one for each name, and quotation marks that close"
        raise InputError(
            FIELD, str(path), allowed, "Mend the line.", f"cannot be read ({why})"
        ) from None


def _refuse_zeros(stream: object, path: Path, wide: bool) -> None:
    """Refuse zero bytes, at which a reader of CSV would end a cell."""
    if wide:
        return
    stream.seek(0)  # type: ignore[attr-defined]
    while piece := stream.read(1 << 22):  # type: ignore[attr-defined]
        if b"\0" in piece:
            remedy = "Save the file as UTF-8."
            raise InputError(
                FIELD, str(path), "a text", remedy, "holds zero bytes, so it is no text"
            )


def _cells(
    piece: pd.DataFrame, first_line: int, heads: UserTable, path: Path
) -> tuple[np.ndarray, dict[str, list[str]]]:
    """Return the numbers of the lines of a piece that are neither empty nor comments, and their
    cells.
    """
    lines = piece.index.to_numpy() + first_line
    filled = (piece != "").any(axis=1).to_numpy()
    comments = piece[0].str.startswith("#").to_numpy(dtype=bool)
    rows = filled & ~comments
    beyond = [*range(max(heads.places) + 1, heads.width), "further"]
    longer = rows & (piece[beyond] != "").any(axis=1).to_numpy()
    if longer.any():
        row = int(np.argmax(longer))
        text = heads.separator.join(piece.iloc[row])
        allowed = f"{len(heads.places)} cells, one for each name; there are more"
        remedy = (
            "Write one cell for each name; with decimal commas, separate the columns by semicolons."
        )
        raise InputError(FIELD, text, allowed, remedy).at(path, int(lines[row]))
    filled_lines = piece[rows]
    places = {name: heads.places[heads.names.index(name)] for name in _known(heads)}
    return lines[rows], {
        name: filled_lines[place].str.strip().tolist() for name, place in places.items()
    }


def _numbers(
    cells: dict[str, list[str]],
    lines: np.ndarray,
    heads: UserTable,
    path: Path,
    answers: LogAnswers,
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return the numbers of a piece; NaN for a cell that stands for no value."""
    signs = heads.signs or decimal_signs(cell for column in cells.values() for cell in column)
    wrong = Collector()
    values = {}
    for name, column in cells.items():
        unit = heads.units[heads.names.index(name)]
        values[name] = _numbers_of(name, column, unit, signs, answers)
        bad = ~np.isfinite(values[name])
        if answers.missing:
            bad &= [cell.lower() not in answers.missing_words for cell in column]
        if bad.all() and len(bad) > 1:
            wrong.errors.append(_without_numbers(name, column[0]).at(path, int(lines[0])))
            continue
        for row in np.flatnonzero(bad)[:30]:
            wrong.errors.append(_refused(name, column[row], path, int(lines[row])))
        unit = _stated_unit(name, heads)
        marks = [
            in_unit(number, unit or COLUMNS[name], COLUMNS[name], name)
            for number in answers.missing_numbers
        ]
        values[name][np.isin(values[name], marks)] = np.nan
        values[name][~np.isfinite(values[name])] = np.nan
    wrong.check()
    return lines, values


def _numbers_of(
    name: str, cells: list[str], unit: str, signs: frozenset[str], answers: LogAnswers
) -> np.ndarray:
    """Return the numbers of a column in its unit of `COLUMNS`; NaN for a cell that holds none."""
    target = COLUMNS[name]
    plain = plain_column(cells, signs)
    numbers = _plain_numbers(plain)
    if numbers is not None and unit in ("", target):
        return numbers
    if numbers is not None:
        return np.array([in_unit(number, unit, target, name) for number in numbers])
    return np.array([_number_of(cell, unit, target, name) for cell in plain])


def _plain_numbers(cells: Sequence[str]) -> np.ndarray | None:
    """Return the numbers of cells without units, None if a cell holds something else."""
    try:
        numbers = np.fromiter(map(float, cells), float, len(cells))
    except ValueError:
        return None
    if np.isfinite(numbers).all() and "_" not in "".join(cells):
        return numbers
    return None


def _number_of(cell: str, unit: str, target: str, name: str) -> float:
    """Return the number of a cell in a unit; NaN for a cell without one, and one that is not
    clear.
    """
    if isinstance(cell, RefusedCell):
        return math.nan
    digits, stated = split_quantity(cell) or (cell, unit)
    number = number_or_nan(digits)
    if not stated or not math.isfinite(number):
        return number
    try:
        return in_unit(number, stated, target, name)
    except InputError:  # of a unit that is unknown or measures something else
        return math.nan


def _without_numbers(name: str, cell: str) -> InputError:
    """Return the error of a column in which no cell is a number, as one of dates is."""
    remedy = f"Write numbers, or rename the column if it is no {name}."
    if name == "time":
        remedy = (
            "Write the seconds since the first line, which =(A2-A$2)*86400 gives in a spreadsheet "
            "for dates in column A."
        )
    wrong = "and all cells below it are no numbers"
    return InputError(name, cell, f"finite numbers [{COLUMNS[name]}]", remedy, wrong)


def _refused(name: str, cell: str, path: Path, line: int) -> InputError:
    if isinstance(cell, RefusedCell):
        return InputError(name, str(cell), *cell.message).at(path, line)
    allowed = f"a finite number [{COLUMNS[name]}]"
    remedy = (
        f"Mend the cell or remove its line, or write log: {{missing: ['{cell}']}} in the "
        "case file to leave out"
    )
    return InputError(name, cell, allowed, f"{remedy} lines with such cells.").at(path, line)
