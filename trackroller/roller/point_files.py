"""Read the points of a cross-section from a text file beside the case or study that names the file.

A file is read as a person would read it. Where a person would hesitate, it is refused with the line and what to do.
"""

from __future__ import annotations

import csv
import math
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from trackroller.contact.profiles import PointRows
from trackroller.errors import Collector, InputError
from trackroller.files import find_beside, read_bytes, text_of
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.table_cells import (
    DASHES,
    Refused,
    decimal_signs,
    is_number,
    plain_column,
    split_head,
    stated_separator,
)
from trackroller.numerics.units import in_unit, split_quantity
from trackroller.roller.simpack_profile import is_simpack, simpack_points

EVEN = 1e-3  # variation of a column over that of the others up to which it only says where the section lies
HEADINGS = 5  # largest number of heading lines before the first point; remarks do not count
CLEARLY = 2.0  # factor between the bends of two readings of a column from which on the smoother one is meant
EXPORT = "Export the position across the profile and the height as two columns of text, such as `x [mm]; z [mm]`."

_LOST = re.compile(
    r"|\*+|\?+|-+|[-+]?(?:nan|inf|infinity|∞)|#?n/?a!?|#?nv|null|none|bad|lost|over|overflow|invalid"
    r"|[-+]?1[.,]#[a-z]+\d*",
    re.IGNORECASE,
)
# spreadsheets write #N/A, German ones #NV; programs in C on Windows write 1.#QNAN, 1.#IND and 1.#INF
_REMARK = re.compile(r"(?<!1[.,])#(?!n/?a\b|nv\b)", re.IGNORECASE)
_WHOLE_REMARK = re.compile(r"[%!]|//|[;*]+(?=\s*[^\W\d_])[^;]*$")
_DATE = re.compile(r"\d{1,4}[-./]\d{1,2}[-./]\d{1,4}\b")
_PLAIN_SIGNS = dict.fromkeys(map(ord, DASHES), "-") | dict.fromkeys(map(ord, "\u00a0\u2007\u2009\u202f"), " ")
_SCALE = re.compile(
    r"(?:scal\w*|factors?|faktor|skal\w*|ma(?:ß|ss)stab|magnif\w*|multiplier|gain|facteur|échelle|exaggerat\w*|zoom"
    r"|überhöh\w*|ueberhoeh\w*|vergrößer\w*|vergroesser\w*|verstärk\w*|verstaerk\w*)(?:\W+[xyz])?"
    r"\W+([-+\d.,eE]+(?:\s*[:/]\s*[\d.,]+)?)"
    r"|(?<![\d:.,])((?:[125]|25)0*\s*:\s*1|1\s*:\s*(?:[125]|25)0*)(?![\d:.,])"
    r"|(\d[\d.,]*)\s*-?\s*(?:fold|fach)\b"
    r"|\b(?-i:V[vhxyz]?)\s*[:=]\s*(\d+)(?![\d.,])(?!\s*[^\W\dx_:])",  # V=1000, but no speed and no version
    re.IGNORECASE,
)
_TIMES = re.compile(  # in the cell of a name: `10*z`, `10z`, `z x10`, `z * 10`, `-z`
    r"([-+]?\d[\d.,]*)\s*[*×·x]?\s*[xyz]\b.*|\b[xyz]\b.*?(?:[*×·]\s*|\sx\s?|\(x\s?)([-+]?\d[\d.,]*).*|([-−])\s*[xyz]\b.*",
    re.IGNORECASE,
)

# lengths as the heads of files spell them, in lower case, and as the units of parameters are spelt
_LENGTHS = {
    word: unit
    for unit, words in {
        "mm": "mm millimeter millimeters millimetre millimetres",
        "um": "um µm μm micron microns micrometer micrometers micrometre micrometres mikrometer",
        "nm": "nm nanometer nanometers nanometre nanometres",
        "cm": "cm centimeter centimeters centimetre centimetres zentimeter",
        "dm": "dm decimeter decimetre dezimeter",
        "yd": "yd yard yards",
        "m": "m meter meters metre metres",
        "inch": 'in inch inches zoll " ″',
        "thou": "mil mils thou",
        "ft": "ft foot feet",
    }.items()
    for word in words.split()
}
_PROSE = ("in", "m", '"', "″", "foot", "feet", "thou")  # words and signs of plain text, too
_BRACKETS = re.compile(r"\[\s*([^\[\]]*?)\s*\]|\(\s*([^()]*?)\s*\)|\{\s*([^{}]*?)\s*\}|<\s*([^<>]*?)\s*>")
_BEHIND = re.compile(r"(.*\S)[\s_.\-]+(\S+)")  # `z mm`, `z_mm`
_COUNTS = "no nr n i k idx index id point pt punkt line # count t time zeit".split()
_ACROSS = "position pos width lateral breite s".split()
_UP = "height höhe hoehe".split()
_DOWN = "depth tiefe".split()


class _Line(NamedTuple):
    """A line of a file: its number, the text before a remark, and the remark."""

    number: int
    text: str
    remark: str


class _Column(NamedTuple):
    """A column that is read: its place, and the unit that its head states, '' for none."""

    place: int
    unit: str


def read_points(name: Any, field: str) -> PointRows:
    """Read rows of two numbers from a text file.

    Columns are separated by semicolons, tabs, bars, commas or blanks; quotes around cells, decimal commas and thousands
    signs are understood where the numbers are clear. The text is UTF-8, UTF-16 or that of Windows in western countries.

    The last of at most five heading lines may name the columns and state their units, as in `x [mm]; z [um]`,
    `x (mm), z / in` or `x_mm`; so may a line of units below the names, and units behind each number. Columns beside two
    that are named x, y or z are left out. A unit or a scale elsewhere in the heading lines is refused. Files of SIMPACK
    (`.prr`, `.prw`) are read with their unit, shift and mirroring.

    The file lies beside the case or study file that names it, or below the working directory. Absolute paths and '..'
    are refused, so that a study file from somebody else cannot read private files.

    Parameters
    ----------
    name : str
        Relative path of the file.
    field : str
        `guide_profile.file` or `roller_profile.file`, for error messages.

    Returns
    -------
    PointRows
        Points [x, z] [mm] in the order of the file, with their lines.

    Raises
    ------
    InputError
        If the path is not allowed, the file does not exist, or a line does not hold two numbers.
    """
    path = find_beside(name, field)
    lines = _lines(_text(path, field))
    if is_simpack([line.text for line in lines]):
        return simpack_points([(line.number, line.text) for line in lines], path, field)
    return _read_columns(lines, path, field)


def _text(path: Path, field: str) -> str:
    """Return the text of a file in UTF-8, UTF-16 or the encoding of Windows in western countries."""
    content = read_bytes(path, field)
    for mark, kind in ((b"PK\x03\x04", "a workbook or another packed file"), (b"\xd0\xcf\x11\xe0", "an old workbook")):
        if content.startswith(mark):
            remedy = "Save the sheet with the columns x and z as CSV."
            raise InputError(field, str(path), "a text file with two columns", remedy, f"is {kind}")
    text = text_of(content, path, field, western=True)
    if re.search(r"[\x01-\x08\x0e-\x19\x1b-\x1f]", text):
        remedy = "Save the points as text."
        raise InputError(field, str(path), "a text file with two columns", remedy, "holds bytes that are no text")
    return text


def _lines(text: str) -> list[_Line]:
    """Return the lines that are not empty.

    '#' begins a remark, and so do '%', '!' and '//' at the start of a line, and ';' and '*' before a word.
    """
    found = []
    for number, line in enumerate(re.split(r"\r\n|\r|\n", text.translate(_PLAIN_SIGNS)), start=1):
        line = line.strip("\x1a\x0c ")
        whole = _WHOLE_REMARK.match(line) and not _LOST.fullmatch(line.strip(";* "))
        before, *remark = ["", line.lstrip("%!/*;")] if whole else _REMARK.split(line, maxsplit=1)
        if before.strip() or "".join(remark).strip():
            found.append(_Line(number, before.rstrip(" "), "".join(remark).strip()))
    return found


def _read_columns(lines: Sequence[_Line], path: Path, field: str) -> PointRows:
    """Return the points of a file of columns with heading lines."""
    lines, sign = _separator(lines)
    texts = {line.number: line.text for line in lines if line.text.strip()}
    rows = {number: cells for number, text in texts.items() if any(cells := _cells(text, sign))}
    first = next((number for number, cells in rows.items() if _is_data(cells)), None)
    if first is None:
        start = next((number for number in rows if re.search(r"\d", texts[number])), 1)
        raise InputError(
            field, texts.get(start, ""), "lines of two numbers x, z", EXPORT, "is not followed by points"
        ).at(path, start)
    heads = [_Line(number, texts[number], "") for number in rows if number < first]
    if len(heads) > HEADINGS:
        wrong = f"is the first of {len(heads)} heading lines, as other programs and instruments write them"
        allowed = f"at most {HEADINGS} heading lines before the numbers, and remarks after '#'"
        raise InputError(field, heads[0].text, allowed, EXPORT, wrong).at(path, heads[0].number)
    data = {number: cells for number, cells in rows.items() if number >= first}
    remarks = [_Line(line.number, line.remark, "") for line in lines if line.remark]
    table = _Table(heads, remarks, data, sign, path, field)
    _check_scales(table)
    head, columns = _columns(table)
    whole = {number: cells for number, cells in data.items() if len(cells) == table.width}
    given = [[cells[column.place] for cells in whole.values()] for column in columns]
    signs = _decimal_signs(table, whole, given, {column.unit for column in columns})
    read = [plain_column(cells, signs) for cells in given]
    units = [_unit_of_cells(table, whole, *column) for column in zip(columns, read, strict=True)]
    _check_units(table, head, units)
    wrong_lines, points = Collector(), {}
    pairs = dict(zip(whole, zip(*read, strict=True), strict=True))
    for number, cells in data.items():
        pair = pairs.get(number, ())
        values = [_length(cell, unit, field) for cell, unit in zip(pair, units, strict=False)]
        if values and all(map(math.isfinite, values)):
            points[number] = values
        else:
            wrong_lines.errors.append(_wrong_line(texts[number], cells, pair, table).at(path, number))
    wrong_lines.check()
    return PointRows(list(points.values()), path, tuple(points))


def _number(cell: str) -> float:
    """Return the number of a cell, whatever unit stands behind it; NaN for a cell without a clear number."""
    number = math.nan if isinstance(cell, Refused) else number_or_nan(cell)
    if math.isnan(number) and not isinstance(cell, Refused) and (parts := split_quantity(cell)):
        number = float(parts[0])
    return number


def _length(cell: str, unit: str, field: str) -> float:
    """Return the number of a cell in mm, NaN for a cell without a number."""
    number = _number(cell)
    return in_unit(number, unit, "mm", field) if unit not in ("", "mm") and math.isfinite(number) else number


def _decimal_signs(
    table: _Table, whole: dict[int, list[str]], given: list[list[str]], units: set[str]
) -> frozenset[str]:
    """Return the decimal sign of the points; refuse both signs in one file.

    Where no cell decides, 4.472 may be 4472. Decimals that are read as thousands jump where a number has no thousands,
    and thousands that are read as decimals do so, too. Where nothing jumps, no profile is 4472 mm high.
    """
    signs = decimal_signs(cell for cells in given for cell in cells)
    if len(signs) == 2:
        shown = ((number, decimal_signs(pair)) for number, pair in zip(whole, zip(*given, strict=True), strict=True))
        marks = [(number, mark) for number, found in shown for mark in sorted(found)]
        number, mark = next((number, mark) for number, mark in marks if mark != marks[0][1])
        line = _Line(number, table.sign.join(whole[number]), "")
        wrong = f"has the decimal sign '{mark}', and lines before have '{marks[0][1]}'"
        raise table.error(line, wrong, "one decimal sign in the file", "Write all numbers in the same way.")
    marks_seen = [mark for mark in ".," if any(mark in cell for cells in given for cell in cells)]
    if signs or len(marks_seen) != 1:
        return signs
    bends = {sign: sum(_bend(plain_column(cells, sign)) for cells in given) for sign in ".,"}
    smooth, rough = sorted(bends, key=bends.__getitem__)
    if CLEARLY * bends[smooth] < bends[rough]:
        return frozenset(smooth)
    words = any(cell[-1:].isalpha() for cells in given for cell in cells)
    return frozenset("" if words or units & {"um", "nm", "thou"} else marks_seen)


def _bend(cells: Sequence[str]) -> float:
    """Return the sum of the changes of a column's steps, over its range."""
    numbers = [number for cell in cells if math.isfinite(number := number_or_nan(cell))]
    return float(np.abs(np.diff(numbers, n=2)).sum() / (np.ptp(numbers) or 1.0)) if len(numbers) > 2 else 0.0


def _unit_of_cells(table: _Table, whole: dict[int, list[str]], column: _Column, cells: Sequence[str]) -> str:
    """Return the unit of a column: that of its head, or that which stands behind each of its numbers."""
    unit = column.unit
    for count, (number, cell) in enumerate(zip(whole, cells, strict=True)):
        parts = None if not cell or cell[-1].isdigit() or isinstance(cell, Refused) else split_quantity(cell)
        own = "" if parts is None else _LENGTHS.get(parts[1].lower(), parts[1])
        if count == 0 and not column.unit:
            unit = own
        if own != unit and (own or not (column.unit or math.isnan(number_or_nan(cell)))):
            line = _Line(number, table.sign.join(whole[number]), "")
            wrong = f"has {f'the unit {parts[1]}' if parts else 'no unit'}, and the column has {unit or 'none'}"
            raise table.error(line, wrong, "one unit for a column", "Write it at the head: x [mm], z [um].")
        if own not in ("", *_LENGTHS.values()):
            line = _Line(number, table.sign.join(whole[number]), "")
            raise table.error(line, f"has the unit {own}", "a unit of length", "Write it at the head: x [mm], z [um].")
    return unit


def _check_units(table: _Table, head: _Line | None, units: list[str]) -> None:
    """Refuse a unit for one of two columns, and units that no column has."""
    if any(units) and not all(units):
        wrong = f"gives a unit for one column only, '{''.join(units)}'"
        raise table.error(head, wrong, "a unit for each of the two columns", "Write both, such as x [um], z [um].")
    if not any(units):
        _check_other_units(table)


def _check_scales(table: _Table) -> None:
    """Refuse a scale other than 1 in heads and remarks: nobody knows whether the numbers contain it."""
    for line in (*table.heads, *(remark for remark in table.remarks if remark.number < table.first)):
        cells = _head_cells(line.text, table.sign, table.width)
        times = [found for cell in cells if (found := _TIMES.fullmatch(cell))] if len(cells) > 1 else []
        for found in (*_SCALE.finditer(line.text), *times):
            stated = next(filter(None, found.groups()))
            stated = "-1" if stated in "-−" else stated
            if _scale(stated) != 1.0:
                wrong = f"states a scale of {stated}, which is not applied"
                raise table.error(line, wrong, "points without a scale", "Multiply the numbers, or remove this line.")


def _scale(text: str) -> float:
    """Return the number of a scale such as '10', '2,5' or '1:2'; NaN for another text."""
    parts = [number_or_nan(part.strip().replace(",", ".").rstrip(".")) for part in re.split("[:/]", text)]
    return parts[0] / parts[1] if len(parts) == 2 and parts[1] else parts[0]


def _wrong_line(text: str, cells: list[str], pair: Sequence[str], table: _Table) -> InputError:
    """Return the error for a line without two numbers; `pair` are its cells of x and z, if it has as many as others."""
    wrong, allowed = "does not hold two numbers", "two numbers x, z"
    remedy = "Write decimal points; decimal commas only between semicolons, tabs or blanks; remarks after '#'."
    if clear := next((cell.message for cell in pair if isinstance(cell, Refused)), None):
        return InputError(table.field, text, *clear)
    if len(cells) == 1:
        remedy = "Put the number of points and other remarks behind '#'."
    elif not pair:
        wrong = f"has {len(cells)} cells, and others have {table.width}"
    elif any(_LOST.fullmatch(cell) for cell in pair):
        wrong, remedy = "is a point that was not measured", "Leave out the lines of lost points."
    return InputError(table.field, text, allowed, remedy, wrong)


def _separator(lines: Sequence[_Line]) -> tuple[Sequence[_Line], str]:
    """Return the lines, and what separates columns: ';', tab, '|', ',', ', ' (with blanks) or ' '."""
    if lines and (stated := stated_separator(lines[0].text.strip())):
        return lines[1:], stated
    data = [line.text.strip(" ") for line in lines if re.match(r"[\"'\s]*[-+.,;\d]", line.text)]
    data = [text for text in data if re.search(r"\d", text)] or [line.text for line in lines]
    data = [re.sub(r'"[^"]*"', "0", text) for text in data]

    def usual(pattern: str) -> bool:
        return sum(re.search(pattern, text) is not None for text in data) >= 0.5 * len(data)

    signs = {";": ";", "\t": "\t", "|": r"\|", ", ": r",\s|\s,", " ": r"\S\s+[\"']?[-+]?[.,]?\d"}
    return lines, next((sign for sign, pattern in signs.items() if usual(pattern)), ",")


def _cells(text: str, sign: str) -> list[str]:
    """Return the cells of a line without quotes; more than two cells do not end with empty ones."""
    if sign == " ":
        cells = text.split()
    elif sign == ", ":
        cells = re.split(r"\s*,\s+|\s+,\s*|,$", text.strip())  # a comma beside a blank is no decimal comma
        plain = text.strip().split(",")
        cells = plain if len(cells) == 1 and all("." in cell for cell in plain) else cells  # no blank before a sign
    else:
        cells = next(csv.reader([text.strip(" ")], delimiter=sign, skipinitialspace=True), [])
    cells = [cell.strip().strip("\"'").strip() for cell in cells]
    while len(cells) > 2 and not cells[-1]:
        cells.pop()
    return cells


def _is_data(cells: list[str]) -> bool:
    """Return whether cells are a point: the first begins like a number, or it is lost and another shows one."""
    if re.match(r"[-+]?[.,]?\d", cells[0]):
        return not _DATE.match(cells[0])
    return _LOST.fullmatch(cells[0]) is not None and any(map(is_number, cells))


class _Table:
    """Lines of cells, and the lines that may say what they mean."""

    def __init__(
        self,
        heads: list[_Line],
        remarks: list[_Line],
        data: dict[int, list[str]],
        sign: str,
        path: Path,
        field: str,
    ) -> None:
        self.heads, self.data, self.sign, self.path, self.field = heads, data, sign, path, field
        self.remarks = remarks
        self.first = next(iter(data))
        self.width = Counter(map(len, data.values())).most_common(1)[0][0]

    def column(self, place: int) -> list[float]:
        """Return the numbers of a column."""
        cells = [cells[place] for cells in self.data.values() if len(cells) == self.width]
        return [number for cell in plain_column(cells, decimal_signs(cells)) if math.isfinite(number := _number(cell))]

    def error(self, line: _Line | None, wrong: str, allowed: str, remedy: str) -> InputError:
        """Return the error for a head, or for the first line of numbers if there is none."""
        text = line.text if line is not None else self.sign.join(self.data[self.first])
        error = InputError(self.field, text, allowed, remedy, wrong)
        return error.at(self.path, self.first if line is None else line.number)


def _columns(table: _Table) -> tuple[_Line | None, tuple[_Column, _Column]]:
    """Return the head, if there is one, and the columns of x and z."""
    head, cells, own = _head(table)
    _check_width(table, head, cells)
    places = _places(table, head, [_word(cell) for cell in cells]) if cells else (0, 1)
    units = [""] * 2
    if cells:
        texts = own or cells
        if not own and any(cell.strip().lower() in _LENGTHS for cell in cells):
            wrong = "has units in cells of their own"
            raise table.error(head, wrong, "units in the cells of the names", "Write x [mm], z [um].")
        units = [_unit(texts[place], table, head) for place in places]
    return head, (_Column(places[0], units[0]), _Column(places[1], units[1]))


def _head(table: _Table) -> tuple[_Line | None, list[str], list[str]]:
    """Return the line that names the columns, its cells, and the cells of a line of units below it.

    The cells are empty if no line names the columns.
    """
    lines = table.heads or [line for line in table.remarks if line.number < table.first]
    units: list[str] = []
    for line in reversed(lines):
        cells = _head_cells(line.text, table.sign, table.width)
        bare = [_BRACKETS.sub(lambda found: found[found.lastindex or 0], cell).strip() for cell in cells]
        stated = [cell.lower() in _LENGTHS for cell in bare]
        if (
            not units
            and len(cells) == table.width
            and sum(stated) > 1
            and all(unit or cell in ("", "-") for cell, unit in zip(bare, stated, strict=True))
        ):
            units = bare
            last = line
            continue
        known = [word for word in map(_word, cells) if word]
        if len(known) < 2 and re.match(r"[^;|\t]*[:=]\s*\S", line.text):  # a key with its value
            break
        mark = table.sign.strip(" ")
        separated = line in table.heads and mark in line.text and mark != ""
        named = len(known) > 1 or (known and len(cells) == 1)
        bracketed = all(_BRACKETS.search(cell) for cell in cells)
        if separated or named or ((known or bracketed) and len(cells) == table.width and line in table.heads):
            return line, cells, units
        break
    return (last, units, units) if units else (None, [], [])


def _head_cells(text: str, sign: str, width: int) -> list[str]:
    """Return the cells of a head, each with its unit."""
    text = re.sub(r"\b([xyz])(mm|[uµμn]m)\b", r"\1 [\2]", text, flags=re.IGNORECASE)  # xum
    wide = [cell.strip("\"'") for cell in re.split(r"\s{2,}", text.strip())]
    if sign == " " and len(wide) == width > 1:
        return wide
    mark = next((mark for mark in (sign.strip(" "), ";", "\t", ",") if mark and mark in text), "")
    if mark:
        cells = _cells(text, mark)
        pairs = list(zip(cells[::2], cells[1::2], strict=False))
        if mark == "," and len(cells) == 2 * width and all(unit.lower() in _LENGTHS for _, unit in pairs):
            return [f"{name}, {unit}" for name, unit in pairs]
        return cells
    joined = re.sub(r"(?<=[^\s\])}>])\s+(?=[\[({<])|\s*(?=/)|(?<=/)\s*", "", text.strip())
    return [cell.strip("\"'") for cell in re.sub(r"\s+in\s+", "/", joined).split()]


def _check_width(table: _Table, head: _Line | None, cells: list[str]) -> None:
    """Refuse numbers without names, more numbers than names, and decimal commas between commas."""
    allowed = "two numbers a line, x and z"
    if table.width == 1:
        raise table.error(None, "is one number", allowed, EXPORT)
    commas = table.sign == "," and not any(mark in cell for row in table.data.values() for cell in row for mark in ".,")
    if table.width == 2 and (len(cells) == 2 or not (cells or commas)):
        return
    if table.width > 2 and len(cells) == table.width:
        return
    wrong = f"begins lines of {table.width} numbers" + (f", and the head names {len(cells)} columns" if cells else "")
    if commas and table.width <= 4:
        remedy = "Commas between columns and decimal commas cannot be told apart: separate the columns by semicolons."
        raise table.error(None, wrong, allowed, remedy)
    counted = np.diff(table.column(0))
    wrong += ", of which the first counts the points" if counted.size and np.all(counted == 1) else ""
    remedy = "Keep two columns, the position across the profile and the height, or name all columns, such as x, y, z."
    raise table.error(None, wrong, allowed, remedy)


def _word(cell: str) -> str:
    """Return what a column's name says: an axis, 'across', 'up', 'down', 'count', 'several', '' for other words."""
    name = _BRACKETS.sub(" ", cell).lower()
    words = re.split(r"[\W\d_]+", name) if name.strip() != "#" else ["#"]
    meanings = {**dict.fromkeys(_COUNTS, "count"), **dict.fromkeys(_ACROSS, "across"), **dict.fromkeys(_UP, "up")}
    meanings |= {**dict.fromkeys(_DOWN, "down"), "x": "x", "y": "y", "z": "z"}
    letters = {word for word in words if word in ("x", "y", "z")}
    if len(letters) > 1:
        return "several"
    return next((meanings[word] for word in (*letters, *words) if word in meanings), "")


def _places(table: _Table, head: _Line | None, words: list[str]) -> tuple[int, int]:
    """Return the places of x and z among columns with names."""
    remedy = "Name the columns x and z, or keep these two without names."
    if "down" in words:
        allowed = "a height z, which counts towards the roller's axis"
        raise table.error(head, "names a depth", allowed, "Write -depth as z.")
    rank = {"across": 0, "x": 1, "y": 2, "z": 3, "up": 4}
    found = {word: words.index(word) for word in rank if word in words}
    if "several" in words or any(words.count(word) > 1 for word in found):
        raise table.error(head, "names two columns alike", "different names for the columns", remedy)
    if len(found) == 3 and {"x", "y", "z"} == set(found):
        columns = {word: table.column(place) for word, place in found.items()}
        widths = {word: float(np.ptp(column)) if column else 0.0 for word, column in columns.items()}
        even = min(widths, key=widths.__getitem__)
        if widths[even] <= EVEN * min(width for word, width in widths.items() if word != even):
            del found[even]  # a section at a constant place
    if len(found) == 2:
        first, second = sorted(found, key=rank.__getitem__)
        return found[first], found[second]
    if len(words) == 2 and "count" not in words and words[0] not in ("z", "up") and words[1] not in ("x", "across"):
        return 0, 1
    wrong = "does not say which columns are the position across the profile and the height"
    raise table.error(head, wrong, "the names x and z", remedy)


def _unit(cell: str, table: _Table, head: _Line | None) -> str:
    """Return the unit that a cell of the head states, as the units of parameters are spelt; '' for none."""
    inside = [next(filter(None, found), "") for found in _BRACKETS.findall(cell)]
    known = [_LENGTHS[text.lower()] for text in inside if text.lower() in _LENGTHS]
    name, unit = split_head(_BRACKETS.sub("", cell))
    behind = None if unit else _BEHIND.fullmatch(name)
    if behind and not is_number(behind[1].split()[-1]):  # not a quantity, such as `tip 2 um`
        unit = behind[2]
    if (unit or name).lower() in _LENGTHS:
        known.append(_LENGTHS[(unit or name).lower()])
    elif unit and "/" in cell and not known:
        inside.append(unit)
    wrong = [text for text in inside if text.lower() not in _LENGTHS and text.lower() not in ("x", "y", "z")]
    if not known:  # a unit at another place of the name
        wrong += [text for text in re.split(r"[\W\d_]+", cell) if text.lower() in _LENGTHS]
    if len(set(known)) > 1:
        remedy = "Write x [mm], z [um]; remarks after '#'."
        raise table.error(head, f"gives a column the units {' and '.join(known)}", "one unit for a column", remedy)
    if wrong and not known:
        told = f"gives a column the unit '{' and '.join(wrong)}'"
        raise table.error(head, told, "a unit of length for each of the two columns", "Write x [mm], z [um].")
    return known[0] if known else ""


def _check_other_units(table: _Table) -> None:
    """Refuse a unit other than mm in heads and remarks, because the numbers are taken as mm."""
    for line in (*table.heads, *table.remarks):
        inside = [text.lower() for found in _BRACKETS.findall(line.text) for text in found]
        stated = re.search(r"(?:unit|einheit|unité)\w*\W+(?:is |in )?(\S+)", line.text, re.I)
        inside += [stated[1].lower().strip(".,;)]")] if stated else []
        words = [
            found[2].lower() for found in re.finditer(r"(\d\s*)?(?<![^\W\d_])([^\W\d_]+)", line.text) if not found[1]
        ]
        for word in (*inside, *(word for word in words if word not in _PROSE)):
            if _LENGTHS.get(word, "mm") != "mm":
                allowed = "numbers in mm, or a unit for each column"
                remedy = f"Name the columns with their units: x [{word}], z [{word}]."
                raise table.error(line, f"says '{word}', but no column has this unit", allowed, remedy)
