"""From a requirement to the least roller of a shelf, for the live page."""

from __future__ import annotations

from typing import Any

import pandas as pd

from trackroller.app.carriage import TABLES, is_carriage, place_of
from trackroller.app.picture import Values, read
from trackroller.damage import limit_word
from trackroller.errors import InputError, check_names
from trackroller.report.sizing import head_of, lead_of, notes_of, shown
from trackroller.results.size import REQUIRED, Sizing, size
from trackroller.roller.duty import STROKES_ATTRIBUTE
from trackroller.roller.stored_inputs import given_inputs
from trackroller.study.file.shelf import ROLLER
from trackroller.yaml_file import read_mapping

STATES = {"enough": "kept", "open": "open", "not enough": "exceeded"}


def sized(
    values: Values,
    carriage: str,
    shelf: str,
    required: dict[str, str],
    accuracy: str,
) -> dict[str, Any]:
    """Size the roller on the screen, or those of a carriage.

    Parameters
    ----------
    values : mapping
        Fields of the case and options by name, with loads, rail and duty.
    carriage : str
        Name of a carriage file, which takes the place of the roller on the screen; may be empty.
    shelf : str
        Name of the table of rollers.
    required : dict of str to str
        Texts by the names of `trackroller.results.size.REQUIRED`; an empty one is not required.
    accuracy : str
        Accuracy of the solution; a carriage has that of its rollers' files.

    Returns
    -------
    dict
        The answer in a sentence, notes, and the tables of verdicts and of load ratios as texts.
    """
    if not shelf.strip():
        raise InputError("shelf", None, "a table of rollers", "Choose a file of this folder.")
    table = place_of(shelf, "shelf", TABLES, "rollers.csv")
    case: Any
    if carriage.strip():
        case = place_of(carriage, "carriage")
        if not is_carriage(case):
            keys = ", ".join(read_mapping(case, "carriage file"))[:100]
            raise InputError("carriage", carriage, "a carriage file", "Choose another one.", keys)
    else:
        own, options, beside = read(values)
        case = given_inputs(own) | options | beside | {"accuracy": accuracy}
        case.pop("outputs", None)
        case.pop(STROKES_ATTRIBUTE, None)  # hours and overrollings follow from them
    check_names("requirement", required, REQUIRED)
    limits: dict[str, Any] = {name: str(text).strip() or None for name, text in required.items()}
    return _on_page(size(case, table, **limits))


def _on_page(sizing: Sizing) -> dict[str, Any]:
    """Return a sizing as texts."""
    tables = [_table(sizing.table, [head_of(str(name), sizing.units) for name in sizing.table])]
    if sizing.ratios is not None:
        ratios = sizing.ratios.table.reindex(sizing.table[ROLLER])
        heads = [ROLLER, *(limit_word(str(name)) for name in ratios)]
        tables.append(_table(ratios.reset_index(), heads))
    return {
        "lead": lead_of(sizing),
        "notes": notes_of(sizing),
        "states": [STATES[str(verdict)] for verdict in sizing.table["verdict"]],
        "least": sizing.least,
        "tables": tables,
    }


def _table(table: pd.DataFrame, heads: list[str]) -> dict[str, Any]:
    """Return a table as texts, its heads with a blank in place of each underscore."""
    rows = [[shown(value) for value in row] for row in table.itertuples(index=False)]
    return {"heads": [head.replace("_", " ") for head in heads], "rows": rows}
