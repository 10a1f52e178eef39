"""The command of shelves: show the rows of a table of rollers, bearings or guides, and check them."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from trackroller.cli.case import case_of
from trackroller.cli.usage import print_doubts
from trackroller.damage.bearing import FIELD as BEARING
from trackroller.damage.catalogue import FIELD as CATALOGUE
from trackroller.errors import InputError
from trackroller.files import files_beside
from trackroller.numerics.units import PLAIN
from trackroller.parameters import PARAMETERS
from trackroller.report.terminal import print_table, print_text
from trackroller.study.design.entries import SHELVES, SIZES
from trackroller.study.design.levels import entries, in_words
from trackroller.study.file.load import parse_study
from trackroller.study.file.shelf import with_rows, without_overridden
from trackroller.study.file.study import Study


def print_shelf(file: Path, of: str, case: Path | None, settings: list[str] | None) -> None:
    """Print the rows of a shelf after all checks of a study: `of` says of what, a case gives rail and empty cells."""
    if of not in SHELVES:
        raise InputError("--of", of, ", ".join(SHELVES), "Choose one of them.")
    study = shelf_study(file, of, case, settings)
    factor = study.parsed[of]
    heads = ["name", *(_head(name, factor.units) for name in factor.beside)]
    rows = []
    for i, level in enumerate(factor.levels):
        values = [_cell(name, column[i]) for name, column in factor.beside.items()]
        rows.append([in_words(of, level), *values])
    print_table(heads, rows)
    print_text(f"rows: {len(rows)}. A study takes them as factors: {{{of}: {{file: {file.name}}}}}")
    print_doubts(study.doubts())


def shelf_study(file: Path, of: str, case: Path | None, settings: list[str] | None) -> Study:
    """Return a study of the rows of a shelf beside the values of a case, which the shelf overrides."""
    base: dict[str, Any] = {}
    if case is not None or settings:
        given, _, _ = case_of(case, settings)
        base = {name: value for name, value in given.as_dict().items() if name not in given.not_given}
        base = {name: value for name, value in base.items() if value not in (None, "")}
    with files_beside(file):
        keys, places = with_rows({"name": "shelf", "base": base, "factors": {of: {"file": file.name}}})
    with places.in_files():
        return parse_study(without_overridden(keys, of))


def _head(name: str, units: Any) -> str:
    """Return the head of a column with its unit."""
    unit = units.get(name, "")
    if name in PARAMETERS:
        unit = PARAMETERS[name].unit
    elif name in SIZES:
        unit = "mm"
    if unit in PLAIN:
        return name
    return f"{name} [{unit}]"


def _cell(name: str, value: Any) -> str:
    """Return a value of a row as text."""
    if value is None or value == "" or (isinstance(value, float) and math.isnan(value)):
        return "–"
    if name in (BEARING.name, CATALOGUE.name):
        return entries(json.loads(value))
    return in_words(name, value)
