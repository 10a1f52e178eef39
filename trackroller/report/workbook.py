"""Export of the report's tables, of the cases of a study and of one roller, as CSV files and XLSX
workbooks.
"""

from __future__ import annotations

import csv
import itertools
import json
import math
import re
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.damage.first_limit import STATES
from trackroller.errors import InputError
from trackroller.files import inert_cell
from trackroller.parameters import REGIME_LABELS
from trackroller.parameters.carriage_fields import parameter_of
from trackroller.parameters.validity import VALIDITY
from trackroller.report import html
from trackroller.report.headlines import headline_of
from trackroller.report.numbers import long_name, plain, unit_text
from trackroller.report.tables.table import Table, cell
from trackroller.results.answer import Answer, Column
from trackroller.results.results import Results
from trackroller.results.roller_answer import answer_of_roller
from trackroller.roller import stored_inputs as record
from trackroller.roller.aliases import RADII
from trackroller.roller.dataset import FLAGS
from trackroller.roller.duty import OVERROLLINGS, duty_of, strokes_of
from trackroller.roller.output_names import PARTS
from trackroller.study.outputs import flat, parts_in
from trackroller.study.store.put import put, put_text


def export(tables: Sequence[Table], folder: Path) -> list[Path]:
    """Write every table as CSV and all of them as one workbook `tables.xlsx`.

    Parameters
    ----------
    folder : place of the files, made when missing

    Returns
    -------
    The paths written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for table in tables:
        path = folder / f"{table.name}.csv"
        with path.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows(
                [inert_cell(value) for value in row] for row in [table.heads, *table.rows]
            )
        paths.append(path)
    book = folder / "tables.xlsx"
    put(book, lambda beside: _save(beside, map(_Sheet.of, tables)))
    return [*paths, book]


def write_answer(answer: Answer, folder: Path) -> list[Path]:
    """Write the record of an answer as a workbook, its rows as CSV, and all of it as JSON.

    The workbook has the sheets `headline`, `rows` (numbers with all digits, texts as texts),
    `columns` with their definitions, `effects`, `ends` and `warnings`.

    Parameters
    ----------
    answer : the record
    folder : place of `answer.xlsx`, `answer.csv` and `answer.json`, made when missing

    Returns
    -------
    The paths written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    rows = _rows_sheet(answer)
    book, table, record_file = (folder / f"answer.{ending}" for ending in ("xlsx", "csv", "json"))
    sheets = [_headline_sheet(answer), rows, *_further_sheets(answer)]
    put(book, lambda beside: _save(beside, map(_Sheet.of, sheets)))
    with table.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows(
            [inert_cell(value) for value in row] for row in [rows.heads, *rows.rows]
        )
    put_text(
        record_file,
        json.dumps(answer.to_dict(), ensure_ascii=False, allow_nan=False, indent=1) + "\n",
    )
    return [book, table, record_file]


def _headline_sheet(answer: Answer) -> Table:
    """Return the headline and its fields, one field a row; a field of a field has its name behind a
    dot.
    """
    fields = [
        ("headline", headline_of(answer).text),
        ("question", answer.question),
        ("kind", answer.kind),
    ]
    fields += [
        (f"output.{name}", text)
        for name, text in zip(("name", "words", "units"), answer.output, strict=True)
    ]
    fields += list(_fields("", answer.headline))
    for place, one in enumerate(answer.required, 1):
        fields += list(_fields(f"required.{place}", vars(one)))
    fields += list(_fields("facts", answer.facts))
    return Table("headline", "Headline", ["field", "value"], [list(field) for field in fields])


def _fields(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Yield each plain value of a record with the names that lead to it."""
    if isinstance(value, Mapping):
        for key, one in value.items():
            yield from _fields(f"{name}.{key}".lstrip("."), one)
    elif isinstance(value, (list, tuple)):
        for place, one in enumerate(value, 1):
            yield from _fields(f"{name}.{place}", one)
    elif value is not None:
        if isinstance(value, (str, int, float)):
            cell_value = value
        else:
            cell_value = str(value)
        yield name, cell_value


def _rows_sheet(answer: Answer) -> Table:
    """Return the rows of an answer: every column that a reader is shown, and both ends of a
    range.
    """
    return _sheet_of("rows", "Rows", answer.table, answer.columns)


def _sheet_of(name: str, title: str, table: pd.DataFrame, columns: Sequence[Column]) -> Table:
    """Return the rows of a table of a record as a sheet."""
    names = [one for column in columns for one in (column.name, column.until) if one]
    names_kept = [one for one in dict.fromkeys(names) if one in table]
    values = [table[one].astype(object).tolist() for one in names_kept]
    return Table(name, title, names_kept, [list(row) for row in zip(*values, strict=True)])


def _further_sheets(answer: Answer) -> list[Table]:
    """Return definitions of the columns, effects, ends and warnings."""
    heads = ["column", "title", "unit", "kind", "until", "definition"]
    every = [*answer.columns, *(one for part in answer.parts for one in part.columns)]
    meanings = [[one.name, one.title, one.units, one.kind, one.until, one.meaning] for one in every]
    sheets = [Table("columns", "Columns", heads, meanings)]
    sheets += [_sheet_of(part.name, part.title, part.table, part.columns) for part in answer.parts]
    effects = [
        [
            curve.factor,
            level,
            *(float(end[place]) for end in (curve.middle, curve.low, curve.high)),
            curve.units,
        ]
        for curve in answer.curves
        for place, level in enumerate(curve.levels)
    ]
    if answer.curves or not answer.parts:
        heads = ["factor", "level", "middle", "low", "high", "unit of level"]
        sheets.append(Table("effects", "Effects", heads, effects))
    if not answer.ends.empty:
        ends = [list(row) for row in answer.ends.itertuples(index=False)]
        sheets.append(Table("ends", "Ends", list(map(str, answer.ends.columns)), ends))
    warnings = [[one.code, one.count, one.of, one.what, one.where] for one in answer.warnings]
    unchecked = [
        ["not_checked", "", "", body, limit]
        for body, of in answer.not_checked.items()
        for limit in of
    ]
    sheets.append(
        Table(
            "warnings",
            "Warnings",
            ["code", "count", "of", "what", "where"],
            [*warnings, *unchecked],
        )
    )
    return sheets


MOST_ROWS = 1_048_574  # of a sheet below its names and units, by the format XLSX
# ASSUME: a sheet of more cells, 1 GB of XML, takes a spreadsheet minutes and more memory than most
# machines have
MOST_CELLS = 20_000_000
BLOCK = 4_096  # rows that are texts at the same time


def write_cases(table: pd.DataFrame, path: Path) -> Path:
    """Write the cases of a study as a workbook with one sheet, or as CSV, by the name of the file.

    The workbook has a line of units below the names, and words in place of the numbers of flags; a
    CSV file has the numbers.

    Parameters
    ----------
    table : one row a case, with the names of inputs and results as columns
    path : the file, .xlsx or .csv

    Returns
    -------
    The path.
    """
    if path.suffix.lower() == ".csv":
        texts = table.select_dtypes(exclude="number")
        inert = table.assign(**{str(name): texts[name].map(inert_cell) for name in texts}).rename(
            columns=inert_cell
        )
        return put(path, lambda beside: inert.to_csv(beside, index=False))
    if path.suffix.lower() != ".xlsx":
        raise InputError(
            "cases", str(path), "a file whose name ends in .xlsx or .csv", "Change the name."
        )
    _check_size(table)
    names = list(map(str, table.columns))
    sheet = _Sheet("cases", (names, list(map(unit_of, names))), _rows_of_cases(table), len(table))
    return put(path, lambda beside: _save(beside, [sheet]))


def _check_size(table: pd.DataFrame) -> None:
    """Refuse cases that a sheet cannot hold, or that make a workbook which no spreadsheet opens."""
    remedy = "Write them as .csv."
    if len(table) > MOST_ROWS:
        raise InputError("cases", len(table), f"at most {MOST_ROWS:,} cases in a workbook", remedy)
    if table.size > MOST_CELLS:
        cells = f"{len(table):,} cases of {table.shape[1]} columns"
        raise InputError("cases", cells, f"at most {MOST_CELLS:,} cells in a workbook", remedy)


def _rows_of_cases(table: pd.DataFrame) -> Iterator[Sequence[Any]]:
    """Yield the cells of each case, with words in place of the numbers of flags."""
    for start in range(0, len(table), BLOCK):
        block = table.iloc[start : start + BLOCK]
        columns = [in_words(str(name), block[name].astype(object).tolist()) for name in block]
        yield from zip(*columns, strict=True)


def write_results(results: Results, path: Path) -> Path:
    """Write the cases of a study with every limit, as a workbook or as CSV; see `write_cases`."""
    data = results.data
    dims = results.dims
    limits = [str(name) for name, variable in data.data_vars.items() if "limit" in variable.dims]
    columns = {}
    for name, part in parts_in(data, limits, dims).items():
        values = flat(part.values(data).to_dataset(name=name), name, dims).astype(float)
        if part.variable.name == "limit_state":
            values[values == STATES.index("unknown")] = np.nan
        if np.isfinite(values).any():
            columns[name] = values
    return write_cases(results.to_table().assign(**columns), path)


def write_roller(ds: xr.Dataset, path: Path) -> Path:
    """Write the result of one case as a workbook with the sheets `inputs`, `results` and `limits`.

    Further sheets hold the rest of its record: `headline`, `columns`, `warnings`, and one for each
    further table.
    """
    answer = answer_of_roller(ds)
    limits = _rows_sheet(answer)
    sheets = [
        _inputs_sheet(ds),
        _results_sheet(ds),
        Table("limits", "Limits", limits.heads, limits.rows),
        _headline_sheet(answer),
        *_further_sheets(answer),
    ]
    return put(path, lambda beside: _save(beside, map(_Sheet.of, sheets)))


def _inputs_sheet(ds: xr.Dataset) -> Table:
    """Return the inputs of one case, its duty and its strokes, and where each value is from."""
    strokes = strokes_of(ds) or {}
    given = {name: value for name, value in record.inputs_of(ds).items() if value is not None}
    inputs = record.radii_of(ds) | given
    example = record.names_not_given(ds.attrs)
    sources = dict.fromkeys(inputs, "given") | dict.fromkeys(example, "example")
    if record.friction_records(ds.attrs):  # left out, or a level of the database
        sources["friction_coefficient"] = "database"
    if strokes:
        sources |= {OVERROLLINGS: "strokes", "hours_per_day": "strokes"}
    units = dict.fromkeys(RADII, "mm")
    rows = [
        [name, long_name(name), _plain(value), units.get(name, unit_of(name)), sources[name]]
        for name, value in inputs.items()
    ]
    units = {"stroke": "m"}
    rows += [
        [name, long_name(name), value, units.get(name, "-"), sources.get(name, "given")]
        for name, value in ((duty_of(ds) or {}) | strokes).items()
    ]
    return Table("inputs", "Inputs", ["input", "meaning", "value", "unit", "from"], rows)


def _results_sheet(ds: xr.Dataset) -> Table:
    """Return the numbers that are known of one case, without those of single limits."""
    names = [str(name) for name, own in ds.data_vars.items() if own.dtype.kind in "fiu"]
    rows = []
    for name, part in parts_in(ds, names, ()).items():
        if "limit" in part.at:
            continue
        value = part.values(ds).item()
        if not math.isnan(value):
            rows.append([name, part.words, in_words(name, [value])[0], unit_of(name)])
    return Table("results", "Results", ["result", "meaning", "value", "unit"], rows)


def _plain(value: Any) -> Any:
    """Return an input as a cell: a number, a name, or a mapping as JSON."""
    if isinstance(value, (int, float, str)):
        return value
    return json.dumps(value, default=str)


def unit_of(name: str) -> str:
    """Return the unit of an input or a result as `--set` and tables of cases take it, "-" for a
    pure number.

    Examples
    --------
    >>> unit_of("radial_force"), unit_of("peak_stress_roller"), unit_of("regime")
    ('N', 'MPa', '-')
    """
    parameter = parameter_of(name)
    if parameter is not None:
        return parameter.unit
    if name not in PARTS and name.replace("years", "hours") in PARTS:
        return "year"
    if name in PARTS:
        return unit_text(PARTS[name].variable.units).replace("–", "-")
    return "-"


def in_words(name: str, values: Sequence[Any]) -> list[Any]:
    """Return the values of a column, with words in place of the numbers of a flag.

    Examples
    --------
    >>> in_words("regime", [0.0, 2.0]), in_words("validity_roller", [0, 3]), in_words("slip", [0.1])
    (['rolling', 'lift-off'], ['', 'half space, yield'], [0.1])
    """
    variable = max(
        (flag for flag in _WORDS if name == flag or name.startswith(f"{flag}_")),
        key=len,
        default="",
    )
    if not variable:
        return list(values)
    return [_word_of(_WORDS[variable], value) for value in values]


def _word_of(words: Callable[[int], str], value: Any) -> Any:
    if isinstance(value, float) and math.isnan(value):
        return value
    return words(int(value))


def _flags_set(bits: int) -> str:
    """Return the validity flags that are set, by name."""
    return ", ".join(plain(name) for i, name in enumerate(VALIDITY) if bits >> i & 1)


def _word(words: Sequence[str]) -> Callable[[int], str]:
    def word_of(code: int) -> str:
        if 0 <= code < len(words):
            return plain(words[code])
        return str(code)

    return word_of


_WORDS: dict[str, Callable[[int], str]] = {
    name: _word(words) for name, (_, words) in FLAGS.items()
} | {"regime": _word(REGIME_LABELS), "validity": _flags_set, "at_surface": _word(("no", "yes"))}


@dataclass(frozen=True)
class _Sheet:
    """One sheet of a workbook.

    Attributes
    ----------
    name : of the sheet
    heads : its first lines, which stay in sight; the last of them filters
    rows : cells of each further line, taken once
    count : number of these lines
    """

    name: str
    heads: Sequence[Sequence[str]]
    rows: Iterable[Sequence[Any]]
    count: int

    @classmethod
    def of(cls, table: Table) -> _Sheet:
        """Return the sheet of a table."""
        return cls(table.name, [table.heads], table.rows, len(table.rows))


def _save(path: Path, sheets: Iterable[_Sheet]) -> None:
    """Write a workbook; only a block of each sheet is in memory."""
    by_place = dict(enumerate(sheets, 1))
    names = [re.sub(r"[\[\]:*?/\\]", " ", sheet.name)[:31] for sheet in by_place.values()]
    parts: dict[str, dict[str, Any]] = {
        "[Content_Types].xml": {"part": "types", "names": names},
        "_rels/.rels": {"part": "root"},
        "xl/workbook.xml": {"part": "book", "names": names},
        "xl/_rels/workbook.xml.rels": {"part": "links", "names": names},
    }
    for place, sheet in by_place.items():
        parts[f"xl/worksheets/sheet{place}.xml"] = _content_of(sheet)
    with zipfile.ZipFile(path, "w") as file:
        file.comment = b"trackroller"  # which other programs drop as they save the workbook
        for name, content in parts.items():
            info = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            info.compress_type = zipfile.ZIP_DEFLATED
            with file.open(info, "w") as into:
                for text in html.pieces(
                    "workbook.xml.j2", content, figure=_figure, printable=_printable
                ):
                    into.write(text.encode())


def _content_of(sheet: _Sheet) -> dict[str, Any]:
    """Return the variables of the template for a sheet."""
    heads = len(sheet.heads)
    widths = [min(max(len(str(name)) + 3, 9), 40) for name in sheet.heads[0]]
    return {
        "part": "sheet",
        "rows": itertools.chain(sheet.heads, sheet.rows),
        "heads": heads,
        "widths": widths,
        "span": f"A{heads}:{_letters(len(widths))}{heads + sheet.count}",
    }


def _letters(column: int) -> str:
    """Return the letters of a column of a sheet, from 1."""
    if column:
        above, own = divmod(column - 1, 26)
    else:
        above = 0
        own = 0
    first_letters = ""
    if above:
        first_letters = _letters(above)
    return first_letters + chr(ord("A") + own)


def _figure(value: Any) -> str | None:
    """Return a finite number with all its figures, None for anything else."""
    if isinstance(value, (int, float, np.number)) and np.isfinite(value):
        return repr(float(value))
    return None


def _printable(value: Any) -> str:
    """Return a text without the characters that XML forbids."""
    if isinstance(value, str):
        text = value
    else:
        text = cell(value)
    return re.sub(r"[\x00-\x08\x0b\x0c\x0e-\x1f]", " ", text)
