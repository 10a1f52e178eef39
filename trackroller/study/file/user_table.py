"""Read the tables of users: a line of names, then lines with one cell for each name, from a CSV file or a workbook.

The reader asks of each cell whether a person would read it otherwise. It then reads the cell as the person does, or
refuses it with file, line, column and remedy. A head may have a unit, such as `axial_force [kN]`, which then stands
behind each number of the column; so may a line of units below the heads.
"""

from __future__ import annotations

import itertools
import math
import re
import statistics
import unicodedata
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

from trackroller.errors import Collector, InputError, listing, raise_all
from trackroller.files import read_bytes, text_of
from trackroller.numerics.cells import (
    Refused,
    Stored,
    decimal_signs,
    is_number,
    plain_column,
    plain_labels,
    split_head,
    unbracketed,
)
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.units import PLAIN, in_unit, split_quantity
from trackroller.parameters import MATERIAL_FIELDS, PARAMETERS
from trackroller.roller.aliases import ALIASES
from trackroller.study.file.csv import csv_lines
from trackroller.study.file.xlsx import MAX_COLUMNS, sheet_lines

# numbers of tables of tests, beside the parameters
OF_TESTS = {
    "amplitude": "MPa",
    "cycles": "-",
    "travel_from": "km",
    "travel_to": "km",
    "wear_depth": "mm",
    "drive_force": "N",
}
UNITS = {name: parameter.unit for name, parameter in PARAMETERS.items()}
UNITS |= {"distance": "m", "guide_overrollings": "-"} | OF_TESTS
KNOWN = {*UNITS, *MATERIAL_FIELDS, *ALIASES, "material_pair", "name"}
MOST_ERRORS = 1_000  # of a table; a message shows fewer
ROUNDED = 0.01  # relative difference between a sum and what a line of totals states
FAR = 1.8  # times the largest addend
HEAD_ROWS = 1_000  # rows of a workbook among which the line of names is sought for its names alone
Lines = Iterable[tuple[int, list[str]]]

_SUMS = (
    "sums? totals? sub-?totals? summen? gesamt gesamtsumme zwischensumme insgesamt ergebnis gesamtergebnis somme "
    "totale totaux suma summa totaal totalt razem celkem toplam итого всего сумма 合计 总计 合計 総計 Σ ∑"
)
_SUM = re.compile(
    r"\W*(?:{0})(?![\w-]).*|.*(?<!\w)(?:{0})\W*".format("|".join(_SUMS.split())), re.IGNORECASE | re.DOTALL
)
_STATISTICS = (
    "mean average avg mittel mittelwert mw schnitt durchschnitt ø moyenne media median min minimum max maximum sd std "
    "stdev stddev standardabweichung count anzahl p05 p5 p10 p25 p50 p75 p90 p95 p99 perzentil percentile quantil "
    "quantile"
)
# a statistic with further words, such as 'arithm. Mittel', or a compound such as 'Gesamtweg'
_STATISTIC = re.compile(
    r"(?:.*(?<!\w))?(?:(?:{})(?!\w)|(?:gesamt|summen)\w).*".format("|".join(_STATISTICS.split())),
    re.IGNORECASE | re.DOTALL,
)
_EXCEL_ERROR = re.compile(r"#(?:DIV/0!|N/A|NAME\?|NULL!|NUM!|REF!|VALUE!|#+)", re.IGNORECASE)
_STATED_UNIT = re.compile(
    r"\[([^\[\]]{1,20})\]|\(([^()]{1,20})\)|\b(?:in|units?|einheit|einheiten)\b(?: is| =|:|=)? *([^\s,;:]{1,20})",
    re.IGNORECASE,
)
_BARE_UNITS = ("N", "%", "lbf", "kgf", "kp")
_OTHER_FORMATS = (".xls", ".xlsb", ".ods", ".fods", ".numbers")
_OLD = "a workbook of the old format .xls, or one with a password"


@dataclass
class UserTable:
    """A table of a user: names of the columns, number of their line, and the cells of each further line by number.

    Numbers of known columns have a decimal point, no thousands signs, and their unit behind them. Cells of further
    columns that hold numbers only are `Stored`; cells of other columns stay as they are. `known` holds the units of the
    known columns, `units` those that the file states for its columns, `signs` the decimal signs of its numbers,
    `separator` what stands between the cells of a CSV file, `places` where the columns stand in a line of the file, and
    `width` the largest number of cells of a line.
    """

    names: list[str]
    head: int
    lines: dict[int, list[str]]
    known: Mapping[str, str] = field(default_factory=lambda: UNITS)
    units: list[str] = field(default_factory=list)
    signs: frozenset[str] = frozenset()
    separator: str = ""
    places: list[int] = field(default_factory=list)
    width: int = 0

    def column(self, j: int) -> list[str]:
        """Return the cells of a column."""
        return [line[j] for line in self.lines.values()]

    def all(self, j: int, holds: Callable[[str], bool]) -> bool:
        """Return whether all cells of a column meet a condition."""
        return all(holds(line[j]) for line in self.lines.values())


def read_table(
    path: Path,
    field: str,
    what: str,
    wrong: Collector,
    used: Collection[str] = (),
    optional: Collection[str] = (),
    further: Mapping[str, str] = MappingProxyType({}),
    content: bytes | None = None,
) -> UserTable:
    """Read a CSV file, or the sheet of a workbook whose name ends in .xlsx or .xlsm.

    Lines have their number in the file, the first line being 1. Spaces around a cell, empty lines, comments and empty
    columns are left out.

    Parameters
    ----------
    path : Path
        The file.
    field : str
        Key of the study or spectrum that names the file, for messages.
    what : str
        What a line describes, such as 'case'.
    wrong : Collector
        Receives the errors of single lines and cells.
    used : collection of str
        Names of further columns that expressions use.
    optional : collection of str
        Names of columns whose cells may be empty.
    further : mapping
        Units of further columns of numbers by their names.
    content : bytes, optional
        Content of the file, or its first lines; by default a file of at most `MAX_BYTES` is read.

    Raises
    ------
    InputError
        If the file is not readable, has only one line, or has heads that are no names.
    """
    content = read_bytes(path, field) if content is None else content
    lines, separator = _lines(content, path, field, what)
    filled = [(number, cells) for number, cells in lines if any(cells)]
    head, heads, lines = _split(filled)
    remarks = {number: " ".join(filter(None, cells)) for number, cells in filled if _is_comment(cells)}
    found = dict(_without_comments(lines, heads, path, field, wrong))
    if not heads or not found:
        raise InputError(field, str(path), f"a table with a line of names and at least one {what}")
    width = max(len(cells) for _, cells in filled)
    places = [j for j, cell in enumerate(heads) if not _is_unnamed(cell)]
    _check_head(heads, found, path, head, field)
    _check_lengths(found, len(heads), separator, path, field, wrong)
    if not found:
        wrong.check()
    with _in_line(path, head):
        known = {**UNITS, **further}
        names, units = _names(_without_unnamed(heads, found, field), field, used, known)
    table = UserTable(names, head, found, known, units, separator=separator, places=places, width=width)
    _read_units(table, units, used, path)
    if not found:
        wrong.check()
        raise InputError(field, str(path), f"a table with at least one {what} below the units", "Add a line.")
    numbers = [j for j, name in enumerate(names) if name in known or (name in used and table.all(j, is_number))]
    _read_numbers(table, numbers, units)
    _check_remarks(table, {n: text for n, text in remarks.items() if n != head and n not in found}, path, field)
    _check_totals(table, numbers, path, field, what, wrong)
    _refuse_mixtures(table, numbers, used)
    _check_cells(table, optional, path, wrong)
    return table


def column_names(path: Path, field: str) -> list[str]:
    """Return the names of the columns of a table; [] for an empty one."""
    lines, _ = _lines(read_bytes(path, field, math.inf), path, field, "case", HEAD_ROWS)
    number, heads, _ = _split(_until_names(lines))
    with _in_line(path, number):
        return _names([head for head in heads if head], field, (), UNITS)[0]


def is_workbook(path: Path) -> bool:
    """Return whether a path names a workbook, by its ending."""
    return path.suffix.lower() in (".xlsx", ".xlsm")


def _lines(content: bytes, path: Path, field: str, what: str, most_rows: int | None = None) -> tuple[Lines, str]:
    """Return the lines with their numbers, and the character between the cells of a CSV file."""
    remedy = "Save the table as .xlsx or as CSV."
    zipped, old = content.startswith(b"PK\x03\x04"), content.startswith(b"\xd0\xcf\x11\xe0")
    if old or path.suffix.lower() in _OTHER_FORMATS:
        wrong = f"is {_OLD}" if old else "has another format"
        raise InputError(field, str(path), "a CSV file or a workbook (.xlsx)", remedy, wrong)
    if is_workbook(path):
        if not zipped:
            remedy = "Give the file the ending .csv, or save the table as .xlsx."
            raise InputError(field, str(path), "a readable workbook", remedy, "is no workbook")
        return sheet_lines(content, path, field, what, most_rows), ""
    if zipped or content.lstrip()[:1] == b"<":
        kind = "workbook or another archive" if zipped else "page of HTML or XML"
        remedy = "Give a workbook the ending .xlsx." if zipped else remedy
        raise InputError(field, str(path), "a CSV file", remedy, f"is a {kind}")
    return csv_lines(text_of(content, path, field), path, field)


def _is_comment(cells: Sequence[str]) -> bool:
    return cells[0][:1] == "#" and not isinstance(cells[0], Refused) and not _EXCEL_ERROR.match(cells[0])


def _until_names(lines: Lines) -> Iterator[tuple[int, list[str]]]:
    """Yield the filled lines up to the first one that is no comment."""
    for number, cells in lines:
        if any(cells):
            yield number, cells
            if not _is_comment(cells):
                return


def _split(lines: Lines) -> tuple[int, list[str], list[tuple[int, list[str]]]]:
    """Return the number of the line of names, the names, and the lines below; NumPy writes the names behind '#'."""
    lines = list(lines)
    first = next((i for i, (_, cells) in enumerate(lines) if not _is_comment(cells)), None)
    if first is None:
        return 0, [], []
    number, heads = lines[first]
    if first and not _are_names(heads):
        before, (mark, *others) = lines[first - 1]
        if _are_names(commented := [mark.lstrip("# "), *others]):
            number, heads, first = before, commented, first - 1
    while heads and not heads[-1]:
        heads = heads[:-1]
    return number, heads, lines[first + 1 :]


def _are_names(cells: Iterable[str]) -> bool:
    return any(split_head(cell)[0] in KNOWN for cell in cells)


def _without_comments(
    lines: list[tuple[int, list[str]]], heads: list[str], path: Path, field: str, wrong: Collector
) -> Iterator[tuple[int, list[str]]]:
    """Yield the lines that are no comments; where all lines begin with '#', it belongs to their labels."""
    labels = all(_is_comment(cells) for _, cells in lines)
    for number, cells in lines:
        if labels or not _is_comment(cells):
            yield number, cells
        elif (len(cells) >= len(heads) and any(cells[1:])) or any(map(is_number, cells[1:])):
            remedy = "Remove the line if it does not count, and '#' if it does."
            why = "begins with '#', but has cells as a line that counts"
            error = InputError(field, ", ".join(cells), "", remedy, why)
            wrong.errors.append(error.at(path, number))


def _check_head(heads: list[str], found: dict[int, list[str]], path: Path, head: int, field: str) -> None:
    """Refuse a line above the line of names, and names that blanks separate."""
    below = next((number for number, line in itertools.islice(found.items(), 20) if _are_names(line)), None)
    if below is not None and not _are_names(heads):
        allowed, remedy = f"the names of the columns, which stand in line {below}", "Remove the lines above it."
        raise InputError(field, ", ".join(filter(None, heads)), allowed, remedy).at(path, head)
    words = heads[0].split()
    if len(heads) == 1 and sum(word in KNOWN for word in words) > 1:
        allowed = "names with a semicolon, tab, bar or comma between them"
        raise InputError(field, heads[0], allowed, "Separate the columns by one of these.").at(path, head)


def _check_lengths(
    found: dict[int, list[str]], width: int, separator: str, path: Path, field: str, wrong: Collector
) -> None:
    """Move lines with more or fewer cells than names to the errors; empty cells at the end of a line do not count."""
    for number, line in list(found.items()):
        while len(line) > width and not line[-1]:
            line.pop()
        if len(line) != width:
            del found[number]
            hint = "Write one name for each column, and one cell for each name."
            if separator == ",":
                hint = "Write decimal points, or separate the columns by semicolons."
            allowed = f"{width} cell{'s' * (width > 1)}, one for each name; there are {len(line)}"
            wrong.errors.append(InputError(field, ", ".join(line), allowed, hint).at(path, number))


def _is_unnamed(head: str) -> bool:
    return not head or re.fullmatch(r"Unnamed: \d+", head) is not None


def _without_unnamed(heads: list[str], found: dict[int, list[str]], field: str) -> list[str]:
    """Return the heads without those of columns that are empty; refuse other columns without a name."""
    unnamed = [j for j, head in enumerate(heads) if _is_unnamed(head)]
    if not unnamed:
        return heads
    for j in unnamed:
        cells = [line[j] for line in found.values()]
        if any(cells):
            index = cells in ([str(i + first) for i in range(len(cells))] for first in (0, 1))
            remedy = "Leave the index out (pandas: index=False), or name it." if index else "Name it, or remove it."
            few = ", ".join(cells[:3])
            wrong = f"are cells of column {j + 1}, which has no name"
            raise InputError(field, few, "a name for each column", remedy, wrong)
    inner = next((j for j in unnamed if any(k not in unnamed for k in range(j))), len(heads))
    if beside := [head for j, head in enumerate(heads) if j > inner and j not in unnamed]:
        wrong = f"stand{'s' * (len(beside) == 1)} beside the empty column {inner + 1}, as a second table does"
        remedy = "Remove the empty column if these columns belong to the table, and these columns if not."
        raise InputError(field, ", ".join(beside), "columns of one table", remedy, wrong)
    for line in found.values():
        line[:] = [cell for j, cell in enumerate(line) if j not in unnamed]
    return [head for j, head in enumerate(heads) if j not in unnamed]


@contextmanager
def _in_line(path: Path, number: int) -> Iterator[None]:
    """Name file and line in the errors of a block."""
    try:
        yield
    except InputError as error:
        raise_all(one.at(path, number) for one in error.errors)


def _names(
    heads: list[str], field: str, used: Collection[str], known: Mapping[str, str]
) -> tuple[list[str], list[str]]:
    """Return the names of the columns and their units; '' for a column without unit.

    A column that is no number of the program keeps the unit as a part of its name, because no number is converted.
    """
    if len(heads) > MAX_COLUMNS:
        raise InputError(field, f"{len(heads)} columns", f"at most {MAX_COLUMNS:,} columns", "Remove some of them.")
    names, units, wrong = [], [], Collector()
    for head in heads:
        name, unit = split_head(unicodedata.normalize("NFC", head))
        name = ALIASES.get(name, name)
        with wrong.part():
            if isinstance(head, Refused):
                raise InputError(field, head, *head.message)
            if name in used and name not in known and unit not in PLAIN:
                allowed = f"a column without a unit, because an expression uses {name} and knows no units"
                remedy = f"Convert the numbers to the unit that the expression needs, and name the column {name}."
                raise InputError("column", head, allowed, remedy)
            if name in known and unit:
                _check_unit(name, unit, known)
        names.append(name if name in known or unit in PLAIN else unicodedata.normalize("NFC", head))
        units.append("" if name not in known or unit in PLAIN else unit)
    wrong.check()
    counts = Counter(names)
    if doubled := [name for name in names if counts[name] > 1]:
        raise InputError(field, ", ".join(doubled), "a different name for each column", "Rename or remove a column.")
    return names, units


def _check_unit(name: str, unit: str, known: Mapping[str, str]) -> None:
    """Refuse a unit that measures something else than the column."""
    if unit != known[name] and not (unit in PLAIN and known[name] in PLAIN):
        in_unit(1.0, unit, known[name], name)


def _read_units(table: UserTable, units: list[str], used: Collection[str], path: Path) -> None:
    """Take a line of units below the names out of the table, if there is one, and complete `units`."""
    number, line = next(iter(table.lines.items()), (0, []))
    below = {name: unbracketed(cell) for name, cell in zip(table.names, line, strict=True) if name in table.known}
    known = {cell for name, cell in zip(table.names, line, strict=True) if name in KNOWN}
    stated = any(_is_unit(name, unit, table.known) for name, unit in below.items())
    if any(map(is_number, below.values())) or not (stated or known == {"-"}):  # of pure numbers and names
        return
    wrong = Collector()
    for j, (name, cell) in enumerate(zip(table.names, line, strict=True)):
        with wrong.part():
            unit = below.get(name, "")
            if unit and not units[j]:
                _check_unit(name, unit, table.known)
                units[j] = "" if unit in PLAIN else unit
            elif unit not in ("", units[j]):
                raise InputError(name, cell, f"the unit at the head of the column, {units[j]}", "Remove one of them.")
            elif name in used and name not in table.known and unbracketed(cell) not in PLAIN:
                allowed = "no unit, because an expression uses this column and knows no units"
                raise InputError(name, cell, allowed, "Convert the numbers to the unit that the expression needs.")
    for error in wrong.errors:
        error.at(path, number)
    wrong.check()
    del table.lines[number]


def _check_remarks(table: UserTable, remarks: dict[int, str], path: Path, field: str) -> None:
    """Refuse a comment that states another unit for numbers of which neither the head nor the cells state one."""
    names = [name for name in table.names if name in table.known]
    bare = [name for name in names if not any(map(_with_unit, table.column(table.names.index(name))))]
    for number, text in itertools.islice(remarks.items(), HEAD_ROWS):
        for unit in _units_of(text):
            meant = [name for name in bare if unit != table.known[name] and _is_unit(name, unit, table.known)]
            meant = [name for name in meant if in_unit(1.0, unit, table.known[name], name) != 1.0]
            if meant:
                allowed = "units at the heads of the columns"
                remedy = f"Write {meant[0]} [{unit}] or {meant[0]} [{table.known[meant[0]]}], or remove this line."
                wrong = f"names the unit {unit}, and {listing(meant)} stand{'s' * (len(meant) == 1)} without a unit"
                raise InputError(field, text, allowed, remedy, wrong).at(path, number)


def _units_of(text: str) -> list[str]:
    """Return the words of a comment that may be units: in brackets, behind 'in' or 'unit', or no word of plain text."""
    stated = [next(filter(None, found)) for found in _STATED_UNIT.findall(text)]
    words = re.sub(r"\d[\d.,]*\s*[^\s\d,;:=()\[\]]+", " ", text)  # without quantities such as 3 kN
    others = [word.strip(".") for word in re.split(r"[\s,;:=#()\[\]]+", words)]
    return [*stated, *(word for word in others if re.search(r"[A-ZµμΩ/%°]", word[1:]) or word in _BARE_UNITS)]


def _is_unit(name: str, text: str, known: Mapping[str, str]) -> bool:
    """Return whether a text is a unit of a column's numbers."""
    if text in PLAIN or split_quantity(f"1 {text}") is None:
        return False
    try:
        in_unit(1.0, text, known[name], name)
    except InputError:
        return False
    return True


def _read_numbers(table: UserTable, numbers: list[int], units: list[str]) -> None:
    """Write the numbers of the table plainly, with their units; cells that are not clear become `Refused`."""
    columns = {j: table.column(j) for j in range(len(table.names))}
    signs = decimal_signs(cell for j in numbers for cell in columns[j])
    table.signs = signs
    for j, cells in columns.items():
        read = plain_column(cells, signs) if j in numbers else plain_labels(cells, signs)
        if unit := units[j]:
            read = [f"{cell} {unit}" if _without_unit(cell) else cell for cell in read]
        elif table.names[j] in table.known and table.known[table.names[j]] not in PLAIN and any(map(_with_unit, read)):
            read = [_beside_units(cell, table.known[table.names[j]]) for cell in read]
        if j in numbers and table.names[j] not in table.known:
            read = [cell if isinstance(cell, Refused) else Stored(cell) for cell in read]
        if read is not cells:
            for line, cell in zip(table.lines.values(), read, strict=True):
                line[j] = cell


def _beside_units(cell: str, unit: str) -> str:
    """Return a cell of a column in which other cells have units.

    A number without a unit is returned as `Refused`, because it could be in their unit; its message is raised where the
    cell is used.
    """
    if not _without_unit(cell) or number_or_nan(cell) == 0.0:
        return cell
    remedy = f"Write {cell} {unit}, or the unit at the head of the column."
    return Refused(cell, "a number with its unit, as in other cells of the column", remedy)


def _without_unit(cell: str) -> bool:
    return not isinstance(cell, Refused) and not math.isnan(number_or_nan(cell))


def _with_unit(cell: str) -> bool:
    return not isinstance(cell, Refused) and bool((split_quantity(cell) or ("", ""))[1])


def _check_totals(table: UserTable, numbers: list[int], path: Path, field: str, what: str, wrong: Collector) -> None:
    """Move lines that sum up the lines above to the errors."""
    labels = [j for j, name in enumerate(table.names) if name not in table.known and j not in numbers]
    above: list[list[str]] = []
    last = next(reversed(table.lines), None)
    for number, line in list(table.lines.items()):
        own = [line[j] for j in labels] or line[:1]
        words = [word for word in own if math.isnan(_value(word))]  # '5 min' is no minimum
        sums = any(_SUM.fullmatch(word) for word in words)
        if not sums and any(_STATISTIC.fullmatch(word) for word in words):
            sums = _sums_up(above, line, numbers)
        if not sums and number == last:
            sums = _sums_up(above, line, numbers, surely=bool(not labels or any(own)), one=True)
        if not above and sums:  # totals may stand above what they sum up
            below = [other for place, other in table.lines.items() if place != number]
            sums = _sums_up(below, line, numbers, one=True)
        if sums:
            del table.lines[number]
            allowed = f"one {what} a line; this line sums up the lines {'above' if above else 'below'}"
            remedy = f"Remove the line; if it is a {what}, " + ("rename it." if any(own) else "put it further up.")
            wrong.errors.append(InputError(field, ", ".join(line), allowed, remedy).at(path, number))
        else:
            above.append(line)


def _sums_up(
    above: list[list[str]], line: list[str], numbers: list[int], one: bool = False, surely: bool = False
) -> bool:
    """Return whether the numbers of a line are sums or statistics of the lines above, maybe rounded, or empty.

    With `one`, at least one of them must be a sum other than 0. With `surely`, that sum must have three addends and
    exceed the largest by far, because levels such as 0, 10, 20 and 30 or 0, 3, 0 and 3 often add up.
    """
    sums, kinds = 0, (sum, statistics.fmean, statistics.median, min, max, len, _deviation)
    for j in numbers:
        if not line[j]:
            continue
        values = [_value(cells[j]) for cells in above]
        value = _value(line[j])
        if len(values) < 2 or not any(math.isclose(kind(values), value, rel_tol=ROUNDED) for kind in kinds):
            return False
        plain = value != 0 and math.isclose(sum(values), value, rel_tol=ROUNDED)
        addends = [abs(one) for one in values if one]
        sums += plain and (not surely or (len(addends) > 2 and abs(value) > FAR * max(addends)))
    return sums > 0 or not one


def _deviation(values: list[float]) -> float:
    return statistics.stdev(values) if all(map(math.isfinite, values)) else math.nan


def _value(cell: str) -> float:
    parts = split_quantity(cell)
    return number_or_nan(parts[0] if parts else cell)


def _refuse_mixtures(table: UserTable, numbers: list[int], used: Collection[str]) -> None:
    """Refuse words and units in a column of numbers that an expression uses."""
    for j, name in enumerate(table.names):
        if (
            name not in used
            or name in table.known
            or j in numbers
            or all(math.isnan(_value(c)) for c in table.column(j))
        ):
            continue
        for line in table.lines.values():
            if line[j] and not isinstance(line[j], Refused) and not is_number(line[j]):
                allowed = "a plain number, because an expression uses the column and other cells of it are numbers"
                line[j] = Refused(line[j], allowed, "Write a number without unit, or words in all of its cells.")


def _check_cells(table: UserTable, optional: Collection[str], path: Path, wrong: Collector) -> None:
    """Refuse cells that are empty or not clear."""
    must = [j for j, name in enumerate(table.names) if name not in optional]
    for j in [j for j in must if table.lines and not any(table.column(j))]:
        must.remove(j)
        error = InputError(table.names[j], None, "a value in each line; all cells are empty", "Remove the column.")
        wrong.errors.append(error.at(path, table.head))
    for number, line in table.lines.items():
        for j in must:
            if not line[j]:
                remedy = "Fill the cell, or remove the line."
                error = InputError(table.names[j], line[j], "a value; the cell is empty", remedy)
                wrong.errors.append(error.at(path, number))
        for name, cell in zip(table.names, line, strict=True):
            if isinstance(cell, Refused):
                wrong.errors.append(InputError(name, str(cell), *cell.message).at(path, number))
        if len(wrong.errors) > MOST_ERRORS:
            break
