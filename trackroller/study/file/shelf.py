"""Read shelves: tables of rollers, bearings or guides, of which each row is a level of a factor.

factors:
  roller: {file: rollers.csv}

A row has a name, sets parameters of a case, and may have columns of the user's own, such as mass
and price. A column is named as its parameter. A key of a bearing, a catalogue or a stud stands
behind its field: `catalogue_basic_life [km]`. In a shelf of bearings the keys stand alone. An empty
cell of a parameter takes the value of `base`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from trackroller.damage.bearing import FIELD as BEARING
from trackroller.damage.catalogue import FIELD as CATALOGUE
from trackroller.damage.mapping import MappingField
from trackroller.damage.stud import FIELD as STUD
from trackroller.errors import Collector, InputError, checked_text, nearest, raise_all
from trackroller.files import find_beside
from trackroller.methods.factor import ROWS
from trackroller.numerics.numbers import finite_number
from trackroller.numerics.table_cells import is_number, split_head
from trackroller.numerics.units import PLAIN, split_quantity
from trackroller.parameters import PARAMETERS
from trackroller.roller.aliases import ALIASES, RADII, renamed, with_options
from trackroller.roller.case import Case
from trackroller.roller.settings import checked_case
from trackroller.study.design.factor_names import (
    BEARING_DIAMETER,
    CASE_FIELDS,
    GEOMETRY,
    SHELVES,
    SIZES,
    check_own_name,
    names_without_blanks,
    without_blanks,
)
from trackroller.study.design.shelf_rows import field_of_row
from trackroller.study.file.user_columns import column_names, read_table
from trackroller.tables.column_heads import is_unit
from trackroller.tables.user_table import UserTable

ROLLER = "roller"  # shelf of rollers
FIELDS = (BEARING, CATALOGUE, STUD)  # mappings of a case whose keys are columns of a shelf
PROFILES = ("roller_profile", "guide_profile")  # their cells name files of points
OUTER_DIAMETER = "outer_diameter"  # of the bearings in a shelf of bearings
MEASURED = ("kg", "mm", "N", "N mm", "MPa", "h", "W", "K")  # units to which those of goods convert
MANY_GROOVES = 5  # beside which a single convex roller is asked about
CURRENCIES = ("EUR", "USD", "GBP", "CHF", "JPY", "CNY", "SEK", "PLN", "CZK", "INR", "KRW")
KIND = "shelf"  # of the file, in messages
Keys = Mapping[str, tuple[MappingField, str]]
Place = tuple[Path, int]


@dataclass
class Places:
    """Where the rows of shelves stand: the file and the number of the line, by shelf and name of
    the row.

    Attributes
    ----------
    lines : dict
        File and line by shelf and name of the row.
    errors : list of InputError
        Errors of rows that were left out, so that the checks of the other rows find theirs. They
        are raised by `in_files`.
    """

    lines: dict[tuple[str, str], Place] = field(default_factory=dict)
    errors: list[InputError] = field(default_factory=list)

    @contextmanager
    def in_files(self) -> Iterator[None]:
        """Name file, line and column in errors on rows of shelves, and raise those of `errors`
        with them.
        """
        wrong = Collector()
        with wrong.part():
            yield
        errors = [*self.errors, *(self._placed(one) for one in wrong.errors)]
        raise_all(sorted(errors, key=lambda error: (str(error.file or ""), error.line or 0)))

    def leave_out(self, shelf: str, rows: Sequence[Mapping[str, Any]], error: InputError) -> Any:
        """Return the rows without those that an error names, and note it; raise it if it names
        none, or all of them.
        """
        named = rows_named(shelf, rows, error)
        if not named or len(named) == len(rows):
            raise_all(self._placed(one) for one in error.errors)
        self.errors += [self._placed(one) for one in error.errors]
        return [row for row in rows if str(row.get("name")) not in named]

    def _placed(self, error: InputError) -> InputError:
        for (shelf, name), place in self.lines.items():
            head = f"{field_of_row(shelf, name)}."
            if error.field.startswith(head):
                return error.named(error.field.removeprefix(head)).at(*place)
        return error


def with_rows(data: Mapping[str, Any]) -> tuple[dict[str, Any], Places]:
    """Return the keys of a study file with the rows of its shelves in place of their files.

    A value of `base` that fills empty cells of a shelf moves into its rows. The study then needs
    none of the files.

    Parameters
    ----------
    data : mapping
        Keys of a study file.

    Returns
    -------
    tuple of dict and Places
        The keys, and where the rows stand, for messages.

    Raises
    ------
    InputError
        If a file or cell is not allowed, or a cell is empty and `base` has no value for it.
    """
    places = Places()
    factors = data.get("factors")
    base = data.get("base")
    if not isinstance(factors, Mapping) or not isinstance(base, (Mapping, type(None))):
        return dict(data), places
    given = dict(factors)
    left = dict(base or {})
    wrong = Collector()
    for shelf in (name for name in SHELVES if isinstance(factors.get(name), Mapping)):
        spec = dict(factors[shelf])
        with wrong.part():
            if "file" in spec:
                spec |= _read(shelf, spec.pop("file"), places)
            if isinstance(spec.get(ROWS), list) and all(
                isinstance(row, Mapping) for row in spec[ROWS]
            ):
                spec[ROWS] = _sound_rows(shelf, spec[ROWS], left, places)
        given[shelf] = spec
    wrong.check()
    out = {**data, "factors": given}
    if base is not None:
        out["base"] = left
    return out, places


def _sound_rows(
    shelf: str, rows: list[Mapping[str, Any]], base: dict[str, Any], places: Places
) -> list[dict[str, Any]]:
    """Return the rows with the values of `base` in empty cells, without those that are wrong."""
    filled: list[dict[str, Any]] = []
    values = dict(base)
    try:
        filled = _filled(shelf, rows, values)
    except InputError as error:
        values = dict(base)
        filled = _filled(shelf, places.leave_out(shelf, rows, error), values)
    for name in {*base} - {*values}:
        del base[name]
    for check in (_check_ratings, _check_grooves):
        try:
            check(shelf, filled)
        except InputError as error:
            filled = list(places.leave_out(shelf, filled, error))
    return filled


def rows_named(shelf: str, rows: Iterable[Mapping[str, Any]], error: InputError) -> set[str]:
    """Return the names of the rows that each of some errors names; none where an error names no
    row.
    """
    heads = {f"{field_of_row(shelf, str(row.get('name')))}.": str(row.get("name")) for row in rows}
    named = set()
    for one in error.errors:
        own = [name for head, name in heads.items() if one.field.startswith(head)]
        if not own:
            return set()
        named.add(own[-1])
    return named


def without_overridden(keys: Mapping[str, Any], shelf: str) -> dict[str, Any]:
    """Return keys of a study whose `base` holds no parameter that the rows of a shelf give.

    A case or study then takes the rollers of a shelf in place of its own.

    Parameters
    ----------
    keys : mapping
        Keys of a study with rows, as `with_rows` returns them.
    shelf : str
        Name of the shelf.
    """
    given = names_of_columns({shelf: keys["factors"][shelf]})
    if given & {*RADII}:
        given |= {"axis_distance"}
    if "axis_distance" in given:
        given |= {*RADII}
    base = {name: value for name, value in (keys.get("base") or {}).items() if name not in given}
    return {**keys, "base": base}


def base_beside_shelf(
    values: Mapping[str, Any],
) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """Return the values of a case file as the `base` of a study of a shelf, its options, and the
    entries beside the case.

    A case may leave its roller to the shelf. Its geometry is checked with each row of it, and
    not with the roller of the paper's example, which need not fit its rail.

    Parameters
    ----------
    values : mapping
        Entries of a case file by name.
    """
    given = renamed(with_options(values))
    geometry = {name: given[name] for name in (*GEOMETRY, *RADII) if name in given}
    others = {name: value for name, value in given.items() if name not in geometry}
    case, options, beside = checked_case(others)
    return {**_base_of_case(case), **geometry}, options, beside


def _base_of_case(case: Case) -> dict[str, Any]:
    """Return the values of a case that were given, as the `base` of a study."""
    given = {name: value for name, value in case.as_dict().items() if name not in case.not_given}
    return {name: value for name, value in given.items() if value not in (None, "")}


def names_of_columns(factors: Mapping[str, Any]) -> set[str]:
    """Return the names of all columns of shelves among the factors of a study file, which may be
    wrong otherwise.
    """
    specs = [factors[name] for name in SHELVES if isinstance(factors.get(name), Mapping)]
    rows = [row for spec in specs if isinstance(spec.get(ROWS), list) for row in spec[ROWS]]
    return {str(name) for row in rows if isinstance(row, Mapping) for name in row}


def _filled(
    shelf: str, rows: list[Mapping[str, Any]], base: dict[str, Any]
) -> list[dict[str, Any]]:
    """Return rows with the values of `base` where they have none, and remove these values from
    `base`.
    """
    names = list(dict.fromkeys(name for row in rows for name in row))
    wrong = Collector()
    used = set()
    filled = []
    for row in rows:
        values = {}
        for name in names:
            if name in row:
                values[name] = row[name]
            elif name in base:
                values[name] = base[name]
                used.add(name)
            elif name in CASE_FIELDS or name in SIZES:
                where = f"{field_of_row(shelf, str(row.get('name')))}.{name}"
                remedy = (
                    f"Fill the cell, or write base: {{{name}: ...}} for all rows without a value."
                )
                wrong.errors.append(InputError(where, None, "a value", remedy, "is missing"))
            else:
                values[name] = None
        filled.append(values)
    wrong.check()
    for name in used:
        del base[name]
    return filled


def _check_ratings(shelf: str, rows: list[dict[str, Any]]) -> None:
    """Refuse a permissible axial force above the radial one where most rows of the shelf have them
    the other way.

    A single row does not tell: some rollers carry more axial than radial force.
    """
    ratings: dict[str, tuple[float, float]] = {}
    for row in rows:
        catalogue = row.get(CATALOGUE.name)
        if isinstance(catalogue, Mapping):
            radial, axial = (
                finite_number(catalogue.get(name), "N") for name in ("radial_force", "axial_force")
            )
            ratings[str(row.get("name"))] = (radial, axial)
    larger = [name for name, (radial, axial) in ratings.items() if axial > radial]
    if 2 * len(larger) >= len(ratings):
        return
    raise_all(
        InputError(
            f"{field_of_row(shelf, name)}.catalogue_axial_force",
            f"{ratings[name][1]:g} N",
            f"at most catalogue_radial_force, {ratings[name][0]:g} N, as in the other rows",
            "Exchange the two cells; put a roller that carries more axial force into a shelf of "
            "its own.",
            "is larger than the permissible radial force",
        )
        for name in larger
    )


def _check_grooves(shelf: str, rows: list[dict[str, Any]]) -> None:
    """Refuse a convex roller in a shelf whose other rollers have grooves: a sign is lost easily.

    A shelf with several convex rollers means them.
    """
    name = "roller_profile_radius"
    parameter = PARAMETERS[name]
    radii = {str(row.get("name")): finite_number(row.get(name), parameter.unit) for row in rows}
    convex = [row for row, radius in radii.items() if radius > 0]
    grooves = [row for row, radius in radii.items() if radius < 0]
    if len(convex) != 1 or len(grooves) < MANY_GROOVES:
        return
    field = f"{field_of_row(shelf, convex[0])}.{name}"
    remedy = (
        f"Write {-radii[convex[0]]:g} for a groove, or put the convex roller into a shelf of its "
        "own."
    )
    allowed = "a radius below 0, as in the other rows"
    wrong = "is that of a convex roller"
    raise InputError(field, f"{radii[convex[0]]:g} mm", allowed, remedy, wrong)


def _read(shelf: str, file: Any, places: Places) -> dict[str, Any]:
    """Return the rows of a file and the units of its further columns, and note where the rows
    stand.
    """
    path = find_beside(file, f"factors.{shelf}.file")
    keys = _keys_of(shelf)
    heads = column_names(path, KIND)
    own_units = _own_units(heads, keys)
    known = _units_of(keys) | dict.fromkeys((*SIZES, OUTER_DIAMETER), "mm") | own_units
    wrong = Collector()
    table = read_table(path, KIND, "row", wrong, (), [*heads, *known], known)
    _check_heads(table, path, keys)
    with wrong.part():
        _note_names(table, shelf, path, places)
    if any(error.line not in table.lines for error in wrong.errors):
        wrong.check()
    columns, units = _own_columns(table, own_units, keys, path, wrong)
    rows = {}
    for place, (number, cells) in enumerate(table.lines.items()):
        row = dict(zip(table.names, cells, strict=True))
        with wrong.part():
            own = {name: values[place] for name, values in columns.items()}
            rows[number] = _row(row, shelf, keys) | own
        for error in wrong.errors:
            if not error.line:
                error.at(path, number)
    wrong_lines = {error.line for error in wrong.errors}
    sound = [row for number, row in rows.items() if number not in wrong_lines]
    if not sound:
        wrong.check()
    places.errors += wrong.errors
    if units:
        return {ROWS: sound, "units": units}
    return {ROWS: sound}


def _keys_of(shelf: str) -> dict[str, tuple[MappingField, str]]:
    """Return the columns that are keys of a mapping: field and key by the name of the column."""
    keys = {}
    for own in FIELDS:
        for key in (*own.words, *own.texts, *(number.name for number in own.numbers)):
            keys[f"{own.name}_{key}"] = (own, key)
            if own.name == shelf:
                keys[key] = (own, key)
    return keys


def _units_of(keys: Keys) -> dict[str, str]:
    """Return the units of the columns of numbers among the keys of mappings."""
    numbers = {(own.name, number.name): number.unit for own in FIELDS for number in own.numbers}
    return {
        column: numbers[own.name, key]
        for column, (own, key) in keys.items()
        if (own.name, key) in numbers
    }


def _is_of_case(name: str, keys: Keys) -> bool:
    """Return whether a column is the name of a row, a parameter, a key of a mapping, or a size."""
    return (
        name in ("name", OUTER_DIAMETER, *SIZES, *keys, *CASE_FIELDS)
        or ALIASES.get(name) in PARAMETERS
    )


def _own_units(heads: Iterable[str], keys: Keys) -> dict[str, str]:
    """Return the units that the heads of the user's own columns state, such as EUR."""
    parts = [split_head(head) for head in heads]
    return {name: unit for name, unit in parts if unit not in PLAIN and not _is_of_case(name, keys)}


def _check_heads(table: UserTable, path: Path, keys: Keys) -> None:
    """Refuse a table without names of its rows, and columns whose names are not clear."""
    wrong = Collector()
    known = (*CASE_FIELDS, *SIZES, *keys)
    if "name" not in table.names:
        wrong.errors.append(
            InputError(KIND, None, "a column name, which names each row", "Add it.", "has no names")
        )
    for head in table.names:
        with wrong.part():
            if head == "material_pair":
                remedy = "Write the columns roller_material and guide_material."
                raise InputError("column", head, "parameters, and columns of your own", remedy)
            if not _is_of_case(head, keys):
                _check_own_head(head, known)
    with wrong.part():
        names_without_blanks(table.names, "column")
    for error in wrong.errors:
        error.at(path, table.head)
    wrong.check()


def _check_own_head(head: str, known: Iterable[str]) -> None:
    """Refuse the name of a column that is nearly that of a parameter, or that results cannot
    have.
    """
    close = nearest(head, known)
    if close:
        remedy = f"Did you mean '{close}'? Rename the column if it is one of your own."
        raise InputError(
            "column", head, "parameters, and columns of your own", remedy, "is not known"
        )
    name = without_blanks(head)
    check_own_name(name, "column")
    if not name.isidentifier():
        allowed = "a name of letters, digits and '_', with a unit in brackets behind it"
        raise InputError("column", head, allowed, "Rename it, for example price [EUR].")


def _note_names(table: UserTable, shelf: str, path: Path, places: Places) -> None:
    """Note the line of each row by its name; refuse rows without a name, and names that stand
    twice.
    """
    wrong = Collector()
    column = table.names.index("name") if "name" in table.names else 0
    for number, cells in table.lines.items():
        name = cells[column]
        before = places.lines.get((shelf, name))
        with wrong.part():
            if not name:
                raise InputError("name", name, "a name in each row", "Name the row.").at(
                    path, number
                )
            _checked_cell(name, "name", (path, number))
            if before is not None:
                stands = f"stands in line {before[1]} too"
                error = InputError(
                    "name", name, "a different name for each row", "Rename one of them.", stands
                )
                raise error.at(path, number)
        places.lines.setdefault((shelf, name), (path, number))
    wrong.check()


def _row(cells: Mapping[str, str], shelf: str, keys: Keys) -> dict[str, Any]:
    """Return the name and the parameters of a row; empty cells are left out."""
    row: dict[str, Any] = {"name": cells["name"]}
    for head, cell in cells.items():
        if head == "name" or not cell or not _is_of_case(head, keys):
            continue
        if head in keys:
            own, key = keys[head]
            row.setdefault(own.name, {})[key] = cell
        elif head == OUTER_DIAMETER:
            if shelf != BEARING.name:
                remedy = (
                    f"Write outer_radius of the roller, or {BEARING_DIAMETER} of the bearing in it."
                )
                raise InputError(
                    head,
                    cell,
                    "a size of one body",
                    remedy,
                    "may be that of the roller or of a bearing",
                )
            row[BEARING_DIAMETER] = cell
        elif head in PROFILES and not cell.startswith("{"):
            row[head] = {"file": cell}
        else:
            row[head] = cell
    return row


def _own_columns(
    table: UserTable, units: Mapping[str, str], keys: Keys, path: Path, wrong: Collector
) -> tuple[dict[str, list[Any]], dict[str, str]]:
    """Return the values and the units of the user's own columns by their names in a study."""
    columns: dict[str, list[Any]] = {}
    shown: dict[str, str] = {}
    for j, head in enumerate(table.names):
        if _is_of_case(head, keys):
            continue
        cells = {number: line[j] for number, line in table.lines.items()}
        name = without_blanks(head)
        unit = units.get(head, "") or _unit_in_cells(head, cells, path, wrong)
        if unit:
            shown[name] = unit
            columns[name] = [
                _number(head, cell, unit, (path, number), wrong) for number, cell in cells.items()
            ]
        elif all(_is_plain_number(cell) for cell in cells.values() if cell):
            columns[name] = [float(cell) if cell else None for cell in cells.values()]
        else:
            columns[name] = [
                _checked_text_of(head, cell, (path, number), wrong)
                for number, cell in cells.items()
            ]
    return columns, shown


def _checked_text_of(head: str, cell: str, place: Place, wrong: Collector) -> str:
    """Return a cell of a column of words; a character that tables cannot show adds an error."""
    with wrong.part():
        _checked_cell(cell, head, place)
    return str(cell)


def _checked_cell(cell: str, head: str, place: Place) -> None:
    """Refuse a text with line ends, or with other characters that tables cannot show."""
    try:
        checked_text(cell, head)
    except InputError as error:
        raise error.at(*place) from None


def _is_plain_number(cell: str) -> bool:
    """Return whether a cell is a number and no label, such as the order number 00123."""
    digits = cell.lstrip("-")
    return (
        is_number(cell)
        and math.isfinite(finite_number(cell))
        and not (digits[:1] == "0" and digits[1:2].isdigit())
    )


def _number(head: str, cell: str, unit: str, place: Place, wrong: Collector) -> float | None:
    """Return a cell of a column of numbers with a unit; None for an empty one."""
    if not cell:
        return None
    number = finite_number(cell.removesuffix(unit).strip())
    with wrong.part():
        try:
            if math.isnan(number) and unit not in CURRENCIES:
                number = finite_number(cell, unit, head)
            if math.isnan(number):
                raise InputError(
                    head, cell, f"a number in {unit}", "Correct the cell, or leave it empty."
                )
        except InputError as error:
            raise error.at(*place) from None
    return number


def _unit_in_cells(head: str, cells: Mapping[int, str], path: Path, wrong: Collector) -> str:
    """Return the unit that all numbers of a column have behind them; '' for a column of words or
    plain numbers.

    Cells with another unit than the first one are errors.
    """
    parts = {number: split_quantity(cell) for number, cell in cells.items() if cell}
    units = [part[1] for part in parts.values() if part]
    if not units or not _is_unit_of_goods(head, units[0]):
        return ""
    for number, part in parts.items():
        if part is None or part[1] != units[0]:
            allowed = f"a number in {units[0]}, as in the first row"
            remedy = (
                "Write all cells in one unit, and the unit at the head of the column: "
                f"{head} [{units[0]}]."
            )
            wrong.errors.append(InputError(head, cells[number], allowed, remedy).at(path, number))
    return units[0]


def _is_unit_of_goods(head: str, unit: str) -> bool:
    """Return whether a text behind a number is a unit of goods, and no part of a name such as 608
    ZZ.
    """
    return unit in CURRENCIES or any(is_unit(head, unit, {head: measure}) for measure in MEASURED)
