"""The table of the looks at a sample that grew until its intervals were narrow."""

from __future__ import annotations

from trackroller.analysis.looks import looks_of
from trackroller.analysis.table import StudyView
from trackroller.report.numbers import capital, rounded
from trackroller.report.tables.table import Table
from trackroller.report.words.growth import quantity_words


def looks_table(view: StudyView) -> Table | None:
    """List the widest interval of each output at each look; None for a study without the key `until`."""
    growth = looks_of(view.solved) if view.results is not None else None
    if growth is None:
        return None
    rows = []
    for one in growth["looks"]:
        row = {"Cases": one["cases"]}
        for name, width in one["half_width"].items():
            text = "–" if width is None else f"± {rounded(width, 2)} ({one['at'][name]})"
            row[capital(quantity_words(name, view.solved.design.method))] = text
        rows.append(row)
    note = f"Widest 95 % interval at each look and where; wanted: ± {growth['half_width']:g}."
    return Table.of("looks", "Intervals as the sample grew", rows, f"{note} Stopped: {growth['stopped']}.")
