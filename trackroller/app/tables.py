"""Tables of a record as the live page shows them: heads with their definitions, cells and bars as
texts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from trackroller.report.pages.blocks import part_rows
from trackroller.report.pictures.uses import UseBars
from trackroller.report.tables.rows import ShownTable, rows_of
from trackroller.results.answer import Answer, FurtherTable

# columns of the limits on the page
SHOWN = ("limit", "body", "state", "value", "used_low", "low", "block")


def limits_on_page(answer: Answer, shown: Sequence[str] = SHOWN) -> dict[str, Any]:
    """Return the table of limits with its bars, without the columns that stand on the sheet
    alone.
    """
    rows = rows_of(answer, [column for column in answer.columns if column.name in shown])
    bars = UseBars.of(answer)
    shown_bars: dict[str, Any] = {"bars": [], "axis": ""}
    if bars is not None:
        lines = [str(bars.row(row)) for row in answer.table.to_dict("records")]
        shown_bars = {"bars": lines, "axis": str(bars.head())}
    return {"name": "limits", "title": "Limits", **_texts(rows), **shown_bars, "note": ""}


def part_on_page(answer: Answer, part: FurtherTable) -> dict[str, Any]:
    """Return a further table with its heads and cells as texts."""
    return {
        "name": part.name,
        "title": part.title,
        **_texts(part_rows(answer, part)),
        "note": part.note,
    }


def _texts(rows: ShownTable) -> dict[str, Any]:
    cells = [[asdict(cell) for cell in row] for row in rows.cells]
    return {
        "heads": [asdict(head) for head in rows.heads],
        "rows": cells,
        "shared": list(rows.shared),
    }
