"""Read the cells of a table as a person reads them: minus, decimal and thousands signs, and the
unit of a column.

The cell `1.200` holds 1.2 where the decimal sign is a point, and 1200 where it is a comma. The
other numbers of the file decide: `decimal_signs` collects the signs that certainly stand before
decimals, and `plain` reads a cell with them. A cell that stays ambiguous is refused.

Examples
--------
>>> signs = decimal_signs(["9.000", "40,5"])
>>> [plain_cell(cell, signs) for cell in ("9.000", "40,5", "−0,2 kN", "1 234,5", "dry")]
['9000', '40.5', '-0.2 kN', '1234.5', 'dry']
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Sequence
from typing import NamedTuple

from trackroller.numerics.units import split_quantity

# hyphens, dashes, minus signs of word processors
DASHES = "\u2010\u2011\u2012\u2013\u2212\ufe63\uff0d"
SEPARATORS = ";\t|,"  # between the cells of a line
_MINUS = re.compile(f"(^|[eE])[{DASHES}]")
_STATED = re.compile(r'"?sep=(.)"?[;,\t|]*', re.IGNORECASE)
_NUMBER = re.compile(r"([-+]?) ?(\d[\d.,'’ ]*|[.,]\d+)(.*)", re.ASCII)
_EXPONENT = re.compile(r"[eE]([-+]?\d+)|[dD]([-+]\d+)", re.ASCII)
_GROUPED = re.compile(r"[1-9]\d{0,2}(?:([.,'’ ])\d{3})(?:\1\d{3})*(?:(?!\1)([.,])(\d+))?", re.ASCII)
_SINGLE = re.compile(r"(\d*)([.,])(\d*)", re.ASCII)
_NO_NUMBERS = re.compile(r"[^0-9.+\-eE\n]")
_HEADS = (  # name and unit: in brackets, or behind a slash, a comma or the word 'in'
    re.compile(r"(.*?)\s*\[([^\[\]]*)\]", re.DOTALL),
    re.compile(r"(.*?)\s*\(([^()]*(?:\([^()]*\)[^()]*)?)\)", re.DOTALL),
    re.compile(r"(.*?)\s*(?:/|,|\sin\s)\s*(.+)", re.DOTALL),
)


class Stored(str):
    """A number that a workbook stores as a number; its decimal sign is a point."""

    __slots__ = ()


class RefusedCell(str):
    """The text of a cell that the program would read otherwise than a person, with what is allowed
    and a remedy.
    """

    def __new__(cls, text: str, allowed: str, remedy: str) -> RefusedCell:
        """Return the cell with its message."""
        cell = super().__new__(cls, text)
        cell.message = (allowed, remedy)
        return cell

    message: tuple[str, str]


class AmbiguousNumber(ValueError):
    """A number that two readers understand differently; the text says why, `remedy` what to
    write.
    """

    def __init__(self, why: str, remedy: str) -> None:
        super().__init__(why)
        self.remedy = remedy


class _Parts(NamedTuple):
    """The parts of a cell with a number: digits of the whole part, decimals, and what stands before
    and behind.
    """

    sign: str
    whole: str
    decimals: str
    mark: str  # the sign before the decimals, or the only sign if it may also separate thousands
    certain: bool
    tail: str  # exponent and unit


def stated_separator(line: str) -> str:
    """Return the separator that a line such as `sep=;` states, which Excel understands; '' for
    another line.
    """
    stated = None
    if "=" in line:
        stated = _STATED.fullmatch(line)
    return stated[1] if stated else ""


def decimal_signs(cells: Iterable[str]) -> frozenset[str]:
    """Return the signs, point or comma, that certainly stand before decimals in some of the cells.

    Parameters
    ----------
    cells : iterable of str
        All cells of a file that should hold numbers.

    Returns
    -------
    frozenset of str
        Empty if no cell decides.
    """
    texts = [cell for cell in cells if not isinstance(cell, Stored)]
    return frozenset(sign for sign in ".," if any(_shows(cell, sign) for cell in texts))


def _shows(cell: str, sign: str) -> bool:
    """Return whether a sign certainly stands before the decimals of a cell."""
    other = "," if sign == "." else "."
    if sign not in cell and cell.count(other) < 2:  # as most cells, which need no parsing
        return False
    parts = _parts(_tidy(cell))
    return parts is not None and parts.certain and parts.mark == sign


def plain_cell(cell: str, signs: Collection[str]) -> str:
    """Return a cell as the program writes numbers; a cell that holds no number is returned as it
    is.

    Parameters
    ----------
    cell : str
        Such as '-1.200', '1 234,5 kN', '1,5E3' or 'dry'.
    signs : collection of str
        Decimal signs of the file, see `decimal_signs`.

    Returns
    -------
    str
        The number with a decimal point, without thousands signs, and with its unit, if it has one.

    Raises
    ------
    AmbiguousNumber
        If the number may have decimals or thousands.
    """
    if isinstance(cell, Stored):
        return cell
    text = _tidy(cell)
    if text.lstrip("+-") == "∞":
        return text.replace("∞", "inf")
    parts = _parts(text)
    if parts is None:
        return cell
    sign, whole, decimals, mark, certain, tail = parts
    if tail and split_quantity(f"1{tail}") is None and not re.fullmatch(r"e[-+]?\d+", tail):
        return cell
    if not certain:
        if len(signs) != 1:
            both = f"{whole}.{decimals} or {whole}{decimals}"
            why = f"a number that is clear: other cells do not tell whether this is {both}"
            clear = f"{sign}{whole}{mark}{decimals}0"
            remedy = (
                f"Write {sign}{whole}{decimals} or {clear}; one number such as {clear} "
                "decides for the whole file."
            )
            raise AmbiguousNumber(why, remedy)
        if mark not in signs:
            whole = whole + decimals
            decimals = ""
    number = f"{whole}.{decimals}" if decimals else whole
    return f"{sign.strip('+')}{number}{tail}"


def plain_quantity(text: str) -> str:
    """Return a number with its unit as the program writes it; '' for a text that is none, or that
    is so already.

    Examples
    --------
    >>> [plain_quantity(text) for text in ("0,1", "-1 200,5 N", "−1.200,5", "0.1")]
    ['0.1', '-1200.5 N', '-1200.5', '']
    """
    try:
        plain = plain_cell(text, decimal_signs([text]))
    except AmbiguousNumber:
        return ""
    if plain != text and (is_number(plain) or split_quantity(plain)):
        return plain
    return ""


def plain_column(cells: Sequence[str], signs: Collection[str]) -> Sequence[str]:
    """Return the cells of a column of numbers as `plain` does, but fast where all are plain numbers
    already.

    Ambiguous cells become `RefusedCell`.
    """
    if _are_plain(cells, signs):
        return cells
    with_points: Sequence[str] = ()
    if set(signs) == {","}:
        with_points = _with_points(cells)
    if with_points:
        return with_points
    return [_plain_or_refused(cell, signs) for cell in cells]


def _with_points(cells: Sequence[str]) -> Sequence[str]:
    """Return numbers with decimal commas as numbers with points; () if some cells are not that
    plain.
    """
    text = "\n".join(cells)
    if "." in text or re.search(r",(?!\d)", text):
        return ()
    with_points = text.replace(",", ".").split("\n")
    if len(with_points) == len(cells) and _are_plain(with_points, "."):
        return with_points
    return ()


def _are_plain(cells: Sequence[str], signs: Collection[str]) -> bool:
    """Return whether all cells of a column are numbers with at most one point, so that no cell has
    to be read by itself.

    The cells are searched as one text, which is fast. `signs` are the decimal signs of the column;
    a point beside another one separates thousands.
    """
    text = "\n".join(cells)
    if "." in text and set(signs) != {"."}:
        return False
    has_two_points = re.search(r"\.\d*\.", text)
    return not has_two_points and not _NO_NUMBERS.search(text)


def _plain_or_refused(cell: str, signs: Collection[str]) -> str:
    if isinstance(cell, RefusedCell):
        return cell
    try:
        return plain_cell(cell, signs)
    except AmbiguousNumber as exc:
        return RefusedCell(cell, str(exc), exc.remedy)


def is_number(cell: str) -> bool:
    """Return whether a cell holds a number without unit."""
    if isinstance(cell, RefusedCell):
        parts = None
    else:
        parts = _parts(_tidy(cell))
    return parts is not None and re.fullmatch(r"(?:e[-+]?\d+)?", parts.tail) is not None


def plain_labels(cells: Sequence[str], signs: Collection[str]) -> Sequence[str]:
    """Return a column that may hold labels: as `Stored` numbers if each cell is written as its
    number is.

    Other columns are returned as they are: `00123`, `3E5`, `1.10` and ambiguous numbers are labels.
    """
    if any(isinstance(cell, RefusedCell) for cell in cells):
        return cells
    own = decimal_signs(cells)
    if len(own) > 1:
        return cells
    signs = frozenset(signs) | own
    fast = _are_plain(cells, signs)
    numbers: list[str] = []
    for cell in cells:
        number = cell
        if not fast and not isinstance(cell, Stored):
            number = _plain_or_refused(cell, signs)
        if not isinstance(cell, Stored) and not _is_written_as(cell, number):
            return cells
        numbers.append(Stored(number))
    return numbers


def _is_written_as(cell: str, number: str) -> bool:
    """Return whether a cell is written as its number is, but for the decimal sign."""
    return (
        not isinstance(number, RefusedCell)
        and number == cell.replace(",", ".")
        and _reads_back(number)
    )


def _reads_back(text: str) -> bool:
    if not 0 < len(text) <= 25:
        return False
    try:
        number = float(text)
    except ValueError:
        return False
    if not math.isfinite(number):
        return False
    return text == repr(number) or (number.is_integer() and text == str(int(number)))


def split_head(head: str) -> tuple[str, str]:
    """Return name and unit of the head of a column; the unit is '' if there is none.

    Parameters
    ----------
    head : str
        Such as 'radial_force [kN]', 'x (um)', 'x / mm', 'x, mm' or 'x in mm'.

    Returns
    -------
    tuple of str
        What stands behind the name may be something else than a unit; whoever knows the column
        decides.

    Examples
    --------
    >>> split_head("radial_force (kN)"), split_head("velocity / (m/min)")
    (('radial_force', 'kN'), ('velocity', 'm/min'))
    >>> split_head("friction_coefficient [-]")
    ('friction_coefficient', '-')
    """
    for pattern in _HEADS:
        parts = pattern.fullmatch(head.strip())
        if parts:
            return parts[1].strip(" /,"), unbracketed(parts[2])
    return head.strip(), ""


def unbracketed(unit: str) -> str:
    """Return a unit without the brackets around it."""
    unit = unit.strip()
    if unit[:1] + unit[-1:] in ("[]", "()"):
        return unit[1:-1].strip()
    return unit


def _tidy(cell: str) -> str:
    """Return a text with plain blanks and a plain minus sign; '5 1/h' becomes '5 /h'."""
    text = _MINUS.sub(r"\1-", " ".join(cell.split()))  # split knows the blanks of all scripts
    return re.sub(r"(?<= )1/(?=[A-Za-z])", "/", text)


def _parts(text: str) -> _Parts | None:
    """Return the parts of a cell with a number; None for any other cell."""
    parts = _NUMBER.fullmatch(text)
    if parts is None:
        return None
    sign = parts[1]
    mantissa = parts[2].rstrip(" ")
    tail = parts[3]
    blank = " " if len(parts[2]) > len(mantissa) else ""
    exponent = None if blank else _EXPONENT.match(tail)
    # Fortran's 1.5D3; 5d3 is no number
    if not exponent and not blank and ("." in mantissa or "," in mantissa):
        exponent = re.match(r"[dD](\d+)()", tail, re.ASCII)
    if exponent:
        tail = f"e{exponent[1] or exponent[2]}{tail[exponent.end() :]}"
    elif re.match(r"[eE]?[-+]?\d|[-+.,'’]", tail):
        return None
    tail = blank + tail
    if mantissa.isdigit():
        return _Parts(sign, mantissa, "", "", True, tail)
    grouped = _GROUPED.fullmatch(mantissa)
    if grouped:
        mark = grouped[1]
        decimal = grouped[2]
        decimals = grouped[3]
        digits = mantissa
        if decimal:
            digits = mantissa[: grouped.start(2)]
        if mark in ".," and not decimal and digits.count(mark) == 1:  # thousands or three decimals
            whole, _, end = digits.partition(mark)
            return _Parts(sign, whole, end, mark, bool(exponent), tail)
        other = {".": ",", ",": "."}.get(mark, "")
        return _Parts(sign, digits.replace(mark, ""), decimals or "", decimal or other, True, tail)
    single = _SINGLE.fullmatch(mantissa)
    if single is None or (single[2] == "," and not single[3]):
        return None
    return _Parts(sign, single[1] or "0", single[3], single[2], True, tail)
