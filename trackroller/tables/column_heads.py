"""Find the line of names of a table, and read the name and the unit of each column."""

from __future__ import annotations

import itertools
import math
import re
import unicodedata
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from trackroller.errors import Collector, InputError, listing
from trackroller.numerics.table_cells import RefusedCell, is_number, plain_quantity, split_head
from trackroller.numerics.units import PLAIN, in_unit, split_quantity
from trackroller.tables.table_kind import Row, Source, TableKind
from trackroller.tables.totals import value_of
from trackroller.tables.xlsx import MAX_COLUMNS

_EXCEL_ERROR = re.compile(r"#(?:DIV/0!|N/A|NAME\?|NULL!|NUM!|REF!|VALUE!|#+)", re.IGNORECASE)


def is_comment(cells: Sequence[str]) -> bool:
    """Return whether a line begins with '#', but not with an error of a spreadsheet such as
    #N/A.
    """
    first = cells[0]
    return (
        first.startswith("#")
        and not isinstance(first, RefusedCell)
        and not _EXCEL_ERROR.match(first)
    )


def until_names(lines: Iterable[Row]) -> Iterator[Row]:
    """Yield the filled lines up to the first one that is no comment."""
    for number, cells in lines:
        if any(cells):
            yield number, cells
            if not is_comment(cells):
                return


def split_lines(lines: Iterable[Row], kind: TableKind) -> tuple[int, list[str], list[Row]]:
    """Return the number of the line of names, the names, and the lines below.

    NumPy writes the names behind '#'. A file that needs no names may begin with its first row.
    """
    lines = list(lines)
    first = next((i for i, (_, cells) in enumerate(lines) if not is_comment(cells)), None)
    if first is None:
        return 0, [], []
    number, cells = lines[first]
    if first and not _are_names(cells, kind):
        before, (mark, *others) = lines[first - 1]
        commented = [mark.lstrip("# "), *others]
        if _are_names(commented, kind):
            return before, _without_end(commented), lines[first:]
    if kind.names and _is_quantity(cells[0]):
        return number, list(kind.names), lines[first:]
    return number, _without_end(cells), lines[first + 1 :]


def _are_names(cells: Iterable[str], kind: TableKind) -> bool:
    return any(kind.knows(split_head(cell)[0]) for cell in cells)


def _is_quantity(cell: str) -> bool:
    """Return whether a cell holds a number, maybe with a decimal comma and a unit."""
    return is_number(cell) or not math.isnan(value_of(plain_quantity(cell) or cell))


def _without_end(heads: list[str]) -> list[str]:
    """Return heads without the empty ones behind the last name."""
    while heads and not heads[-1]:
        heads = heads[:-1]
    return heads


def check_head(heads: list[str], rows: dict[int, list[str]], head: int, source: Source) -> None:
    """Refuse a line above the line of names, and names that blanks separate."""
    kind = source.kind
    if _are_names(heads, kind):
        _check_separated(heads, head, source)
        return
    shown = ", ".join(filter(None, heads))
    for number, line in itertools.islice(rows.items(), 20):
        if _are_names(line, kind):
            allowed = f"the names of the columns, which stand in line {number}"
            remedy = "Remove the lines above it, or put '#' before them."
            raise InputError(kind.field, shown, allowed, remedy).at(source.path, head)
    if kind.names:
        with source.in_line(head):
            for name in heads:
                _check_spelling(name, kind)
        example = "; ".join(f"{name} [{kind.units[name]}]" for name in kind.names)
        allowed = f"a {kind.row}, or the names of the columns, such as {example}"
        remedy = (
            f"If it names the columns, write {listing(kind.names)} with their units; otherwise "
            "remove such lines, or "
            "put '#' before them."
        )
        wrong = f"is neither a {kind.row} nor the names of the columns"
        raise InputError(kind.field, shown, allowed, remedy, wrong).at(source.path, head)
    _check_separated(heads, head, source)


def _check_separated(heads: list[str], head: int, source: Source) -> None:
    """Refuse names that blanks separate."""
    words = heads[0].split()
    if len(heads) == 1 and sum(map(source.kind.knows, words)) > 1:
        allowed = "names with a semicolon, tab, bar or comma between them"
        remedy = "Separate the columns by one of these."
        raise InputError(source.kind.field, heads[0], allowed, remedy).at(source.path, head)


def _is_unnamed(head: str) -> bool:
    return not head or re.fullmatch(r"Unnamed: \d+", head) is not None


def named_columns(heads: list[str], rows: dict[int, list[str]], field: str) -> list[int]:
    """Return the places of the columns with names; refuse cells without a name, and a second
    table.
    """
    unnamed = [j for j, head in enumerate(heads) if _is_unnamed(head)]
    named = [j for j, head in enumerate(heads) if not _is_unnamed(head)]
    for j in unnamed:
        cells = [line[j] for line in rows.values()]
        if any(cells):
            wrong = f"are cells of column {j + 1}, which has no name"
            remedy = "Name it, or remove it."
            if _counts(cells):
                remedy = "Leave the index out (pandas: index=False), or name it."
            shown = ", ".join(cells[:3])
            raise InputError(field, shown, "a name for each column", remedy, wrong)
    for j in unnamed:
        beside = [heads[k] for k in named if k > j]
        if beside and len(beside) < len(named):
            stand = "stands" if len(beside) == 1 else "stand"
            wrong = f"{stand} beside the empty column {j + 1}, as a second table does"
            remedy = (
                "Remove the empty column if these columns belong to the table, and these "
                "columns if not."
            )
            raise InputError(field, ", ".join(beside), "columns of one table", remedy, wrong)
    return named


def _counts(cells: list[str]) -> bool:
    """Return whether cells count the rows from 0 or 1 on."""
    from_zero = [str(i) for i in range(len(cells) + 1)]
    return cells in (from_zero[:-1], from_zero[1:])


def head_names_and_units(
    heads: list[str], used: Collection[str], kind: TableKind
) -> tuple[list[str], list[str]]:
    """Return the names of the columns and their units; '' for a column without unit.

    A column that is no number of the program keeps the unit as a part of its name, because no
    number is converted.
    """
    if len(heads) > MAX_COLUMNS:
        allowed = f"at most {MAX_COLUMNS:,} columns"
        raise InputError(kind.field, f"{len(heads)} columns", allowed, "Remove some of them.")
    names = []
    units = []
    wrong = Collector()
    for head in heads:
        whole = unicodedata.normalize("NFC", head)
        name, unit = split_head(whole)
        name = kind.aliases.get(name, name)
        known = name in kind.units
        plain = unit in PLAIN
        with wrong.part():
            _check_named(head, name, unit, used, kind)
        if not known and not plain:
            name = whole
        names.append(name)
        if plain or not known:
            unit = ""
        units.append(unit)
    for name, beside in itertools.pairwise(names):
        with wrong.part():
            _check_unit_beside(name, beside, kind)
    wrong.check()
    counts = Counter(names)
    doubled = [name for name in names if counts[name] > 1]
    if doubled:
        allowed = "a different name for each column"
        raise InputError(kind.field, ", ".join(doubled), allowed, "Rename or remove a column.")
    return names, units


def _check_named(head: str, name: str, unit: str, used: Collection[str], kind: TableKind) -> None:
    """Refuse a head that is not clear, and a unit that nothing would convert."""
    if isinstance(head, RefusedCell):
        raise InputError(kind.field, head, *head.message)
    if name in kind.units and unit:
        check_unit(name, unit, kind.units)
    if not kind.knows(name):
        _check_spelling(head, kind)
    if name in used and name not in kind.units and unit not in PLAIN:
        allowed = f"a column without a unit, because an expression uses {name} and knows no units"
        remedy = (
            "Convert the numbers to the unit that the expression needs, and name the column "
            f"{name}."
        )
        raise InputError("column", head, allowed, remedy)


def _check_spelling(head: str, kind: TableKind) -> None:
    """Refuse a known name with a unit that does not stand in brackets, such as `velocity_m/s`."""
    for name, own in kind.units.items():
        if not head.lower().startswith(name):
            continue
        unit = head[len(name) :].strip(" _:-<>{}[]()")
        if unit == own or is_unit(name, unit, kind.units):
            wrong = "is no name with a unit in brackets"
            raise InputError("column", head, "names of columns", f"Write {name} [{unit}].", wrong)


def _check_unit_beside(name: str, beside: str, kind: TableKind) -> None:
    """Refuse a unit in a cell of its own: with decimal commas its column would hold the
    decimals.
    """
    if name in kind.units and not kind.knows(beside) and is_unit(name, beside, kind.units):
        wrong = f"is a unit in a cell of its own, beside {name}"
        raise InputError(
            "column", beside, "names of columns", f"Write {name} [{beside}], or rename it.", wrong
        )


def check_unit(name: str, unit: str, known: Mapping[str, str]) -> None:
    """Refuse a unit that measures something else than the column."""
    same = unit == known[name] or (unit in PLAIN and known[name] in PLAIN)
    if not same:
        in_unit(1.0, unit, known[name], name)


def is_unit(name: str, text: str, known: Mapping[str, str]) -> bool:
    """Return whether a text is a unit of a column's numbers."""
    if text in PLAIN or split_quantity(f"1 {text}") is None:
        return False
    try:
        in_unit(1.0, text, known[name], name)
    except InputError:
        return False
    return True
