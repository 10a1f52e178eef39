"""Random tables as people, spreadsheets and programs write them, with the values that a person reads beside them.

Separators, decimal and thousands signs, units, encodings, totals, comments, hidden rows, formulas and more are drawn at
random. A reader may refuse a table, but it must never read another value than the person.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl

NUMBERS = {  # range, unit, and other units with their size in this unit
    "radial_force": ((-9000.0, -20.0), "N", {"kN": 1e3}),
    "axial_force": ((0.0, 2500.0), "N", {"kN": 1e3}),
    "velocity": ((5.0, 90.0), "m/min", {"m/s": 60.0}),
    "friction_coefficient": ((0.0, 0.5), "-", {"%": 0.01}),
    "guide_overrollings_per_hour": ((10.0, 9000.0), "1/h", {"1/min": 60.0}),
}
DISTANCE = ((1.0, 12000.0), "m", {"km": 1e3})
LABELS = {
    "part": ["00123", "00124", "007", "3E5", "1E2", "A-1", "1.10", "1.9", "12345678901234567890", "+5"],
    "note": ["full", "empty", "peak load", "-", "Größe µ", '5" rail', "a;b", "a,b", "x\ty", "#4", "1/2", "2-3", "TRUE"],
    "test no": ["1", "2", "3", "10", "12.5", "-4"],
}
SEPARATORS = [";", ";", ",", ",", "\t", "|"]
LOCALES = [
    (".", ""),
    (".", ""),
    (".", ","),
    (".", "'"),
    (",", ""),
    (",", ""),
    (",", "."),
    (",", "\u00a0"),
    (",", "\u202f"),
]
ENCODINGS = ["utf-8", "utf-8", "utf-8", "utf-8-sig", "utf-16", "cp1252", "utf-16-le"]
TOTALS = ["Sum", "Total", "Summe", "total:", "Gesamt", "Σ", "Grand total", "Mittelwert", "mean", ""]


@dataclass
class RandomTable:
    """A table in a file, and what a person reads in it."""

    path: Path
    values: dict[str, list[float | str]]
    quirks: list[str] = field(default_factory=list)


class _Writer:
    """Draws how a table looks, and writes it."""

    def __init__(self, rng: np.random.Generator, blocks: bool) -> None:
        self.rng, self.quirks = rng, []
        self.decimal, self.thousands = LOCALES[rng.integers(len(LOCALES))]
        self.rows = int(rng.integers(1, 7))
        names = [str(n) for n in rng.permutation(list(NUMBERS))][: rng.integers(1, 4)]
        names += ["distance"] if blocks else [str(n) for n in rng.permutation(list(LABELS))][: rng.integers(0, 3)]
        self.names = [*(["name"] if blocks else []), *(str(n) for n in rng.permutation(names))]
        self.values: dict[str, list[float | str]] = {}
        self.cells: dict[str, list[str]] = {}
        self.raw: dict[str, list[float | str]] = {}  # what a workbook stores
        self.heads: dict[str, str] = {}
        self.units: dict[str, str] = {}
        for name in self.names:
            self.column(name)

    def chance(self, probability: float, quirk: str) -> bool:
        """Return whether a rare thing happens, and note it."""
        if self.rng.random() < probability:
            self.quirks.append(quirk)
            return True
        return False

    def column(self, name: str) -> None:
        """Draw the column of a name."""
        self.heads[name] = name
        if name == "name" or name in LABELS:
            words = [f"block {i}" for i in range(self.rows)] if name == "name" else self.words(name)
            self.values[name], self.cells[name], self.raw[name] = list(words), words, list(words)
            return
        (low, high), unit, others = DISTANCE if name == "distance" else NUMBERS[name]
        written, size, of_cells = unit, 1.0, False
        if self.chance(0.4, f"unit of {name}"):
            written = str(self.rng.choice([unit, *others]))
            size = others.get(written, 1.0)
            form = int(self.rng.integers(6))
            of_cells = form == 5 and written != "-"
            forms = [
                f"{name} [{written}]",
                f"{name} ({written})",
                f"{name} / {written}",
                f"{name}, {written}",
                name,
                name,
            ]
            self.heads[name] = forms[form]
            if form == 4 or (form == 5 and not of_cells):
                self.units[name] = written
        places = int(self.rng.integers(0, 4)) + (0 if size == 1 else 3)
        truth, cells, raw = [], [], []
        for value in self.rng.uniform(low, high, self.rows):
            if self.rng.random() < 0.3:
                value = float(np.round(value, -2)) or high
            stored = float(f"{value / size:.{places}f}")
            stored = stored or float(f"{high / size:.{places}f}")
            cells.append(self.number(stored, places) + (f" {written}" if of_cells else ""))
            truth.append(stored * size)
            raw.append(f"{cells[-1]}" if of_cells else stored)
        self.values[name], self.cells[name], self.raw[name] = truth, cells, raw

    def words(self, name: str) -> list[str]:
        """Return labels."""
        return [str(word) for word in self.rng.choice(LABELS[name], self.rows)]

    def number(self, value: float, places: int) -> str:
        """Return a number as a person or a program writes it."""
        form = self.rng.random()
        if form < 0.05:
            return f"{value:.10e}".replace(".", self.decimal)
        text = f"{value:,.{places}f}" if form < 0.6 else f"{value:.{places}f}"
        if form > 0.8:
            text = repr(value).removesuffix(".0")
            text = text if "e" not in text else f"{value:.{places}f}"
        text = text.translate({ord(","): self.thousands or None, ord("."): self.decimal})
        sign = str(self.rng.choice(["-"] * 8 + ["\u2212", "\u2013"]))
        return text.replace("-", sign)

    def lines(self) -> list[list[str]]:
        """Return the heads and the lines of cells, with what people add."""
        lines = [[self.cells[name][i] for name in self.names] for i in range(self.rows)]
        heads = [self.heads[name] for name in self.names]
        if self.units:
            lines.insert(0, [self.units.get(name, "") for name in self.names])
        if self.chance(0.12, "total"):
            lines.append(self.total(lines))
        else:
            self.spoil(lines)
        if self.chance(0.05, "index"):
            heads, lines = ["", *heads], [[str(i), *line] for i, line in enumerate(lines)]
        if self.chance(0.06, "empty column"):
            heads, lines = [*heads, ""], [[*line, ""] for line in lines]
        if self.chance(0.05, "empty lines"):
            lines.insert(int(self.rng.integers(len(lines) + 1)), [""] * len(heads))
        if self.chance(0.05, "comment"):
            lines.insert(int(self.rng.integers(len(lines) + 1)), ["# measured on Monday"])
        above: list[list[str]] = []
        if self.chance(0.04, "unit in a comment"):
            above = [["# forces in kN"]]
            self.values = {} if self.has_bare_force() else self.values
        if self.chance(0.03, "second table"):
            heads, lines = [*heads, "", "load"], [[*line, "", "5"] for line in lines]
            self.values = {}
        if self.chance(0.03, "title"):
            lines, heads = [heads, *lines], ["Load cases"]
        return [*above, heads, *lines]

    def has_bare_force(self) -> bool:
        """Return whether a column of forces has its unit neither at its head, nor below it, nor in its cells."""
        bare = [name for name, head in self.heads.items() if head == name and name not in self.units]
        return any(name.endswith("_force") and "N" not in self.cells[name][0] for name in bare)

    def spoil(self, lines: list[list[str]]) -> None:
        """Empty, add or remove a cell of the last line, so that nobody knows its values."""
        places = [i for i, name in enumerate(self.names) if name != "name"]
        if len(self.names) > 1 and self.chance(0.06, "empty cell"):
            lines[-1][self.rng.choice(places)] = ""
        elif self.chance(0.05, "a cell too many"):
            lines[-1].append("7")
        elif len(self.names) > 1 and self.names[-1] != "name" and self.chance(0.03, "a cell too few"):
            lines[-1].pop()
        else:
            return
        self.values = {}

    def total(self, lines: list[list[str]]) -> list[str]:
        """Return a line that sums up the lines above: no case, and no block."""
        word, out = str(self.rng.choice(TOTALS)), []
        for name in self.names:
            if name == "name" or name in LABELS:
                out.append("")
            elif self.rng.random() < 0.6:
                out.append("")
            else:
                numbers = [v for v in self.raw[name] if isinstance(v, float)]
                value = sum(numbers) if word.lower() not in ("mittelwert", "mean") else float(np.mean(numbers or [0]))
                out.append(self.number(value, 2))
        texts = [i for i, name in enumerate(self.names) if name == "name" or name in LABELS] or [0]
        out[texts[0]] = word
        if not word and all(out):  # nobody can see that this line is a total
            out[-1] = ""
        return out


def random_csv(seed: int, folder: Path, blocks: bool = False) -> RandomTable:
    """Write a random CSV file.

    Parameters
    ----------
    seed : of everything that is drawn
    folder : place of the file
    blocks : whether the lines are blocks of a spectrum instead of cases
    """
    rng = np.random.default_rng([seed, int(blocks)])
    writer = _Writer(rng, blocks)
    separator = str(rng.choice(SEPARATORS))
    lines = writer.lines()
    end = str(rng.choice(["\r\n", "\n", "\n", "\r"]))
    stream = io.StringIO()
    quoting = csv.QUOTE_ALL if rng.random() < 0.15 else csv.QUOTE_MINIMAL
    if writer.chance(0.06, "sep="):
        stream.write(f"sep={separator}{end}")
    if writer.chance(0.06, "trailing separators"):
        lines = [[*line, ""] for line in lines]
    if writer.chance(0.04, "unquoted"):
        for line in lines:
            stream.write(separator.join(line) + end)
        flat = [cell for line in lines for cell in line]
        if any(separator in cell or cell[:1] == '"' for cell in flat):
            writer.values = {}
    else:
        csv.writer(stream, delimiter=separator, lineterminator=end, quoting=quoting).writerows(lines)
    encoding = str(rng.choice(ENCODINGS))
    text = stream.getvalue()
    path = folder / f"t{seed}.csv"
    path.write_bytes(text.encode(encoding, errors="replace"))
    if text.encode(encoding, errors="replace").decode(encoding) not in (text, "\ufeff" + text):
        writer.values = {}  # the file does not hold the text
    return RandomTable(
        path, writer.values, [*writer.quirks, separator, encoding, repr((writer.decimal, writer.thousands))]
    )


def random_workbook(seed: int, folder: Path, blocks: bool = False) -> RandomTable:
    """Write a random workbook; see `random_csv`."""
    rng = np.random.default_rng([seed, 2 + int(blocks)])
    writer = _Writer(rng, blocks)
    lines = writer.lines()
    book = openpyxl.Workbook()
    sheet = book.active
    numeric = {
        cell: value for name in writer.names for cell, value in zip(writer.cells[name], writer.raw[name], strict=True)
    }
    as_text = writer.chance(0.15, "numbers as text")
    for line in lines:
        labels = {word for name in writer.names if name == "name" or name in LABELS for word in writer.cells[name]}
        sheet.append([cell if as_text or cell in labels else numeric.get(cell, cell) or None for cell in line])
    if any(lines[-1]):
        _spoil(writer, sheet)
    if writer.chance(0.05, "other sheets"):
        book.create_sheet("empty")
        book.create_sheet("hidden").append(["radial_force", 1])
        book["hidden"].sheet_state = "hidden"
    path = folder / f"t{seed}.xlsx"
    book.save(path)
    return RandomTable(path, writer.values, [*writer.quirks, repr((writer.decimal, writer.thousands))])


def _spoil(writer: _Writer, sheet: Any) -> None:
    """Make the last row of a sheet such that nobody knows its values, or no program."""
    last, known = sheet.max_row, writer.values
    writer.values = {}
    if writer.chance(0.08, "hidden row"):
        sheet.row_dimensions[last].hidden = True
    elif writer.chance(0.05, "struck row"):
        for cell in sheet[last]:
            cell.font = openpyxl.styles.Font(strike=True)
    elif writer.chance(0.05, "hidden column"):
        sheet.column_dimensions["A"].hidden = True
    elif writer.chance(0.06, "formula"):
        sheet.cell(last, 1).value = "=2*3"
    elif writer.chance(0.04, "error"):
        sheet.cell(last, 1).value = "#DIV/0!"
    elif last > 2 and writer.chance(0.04, "merged"):
        sheet.merge_cells(start_row=last - 1, end_row=last, start_column=1, end_column=1)
    elif isinstance(sheet.cell(last, 1).value, float) and writer.chance(0.2, "format in thousands"):
        sheet.cell(last, 1).number_format = "0.0,"
    else:
        writer.values = known
