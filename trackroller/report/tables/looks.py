"""The table of the looks at a sample that grew until its intervals were narrow."""

from __future__ import annotations

from trackroller.analysis.looks import looks_of
from trackroller.analysis.table import StudyView
from trackroller.report.numbers import capital, rounded
from trackroller.report.tables.table import Table
from trackroller.report.words.growth import quantity_words


def looks_table(view: StudyView) -> Table | None:
    """List the widest interval of each output at each look; None for a study without the key `until`."""
    found = looks_of(view.solved) if view.results is not None else None
    if found is None:
        return None
    names = list(found["looks"][0]["half_width"])
    heads = ["Cases", *(capital(quantity_words(name, view.solved.design.method)) for name in names)]
    rows = [
        [
            one["cases"],
            *(
                "–" if one["half_width"][n] is None else f"± {rounded(one['half_width'][n], 2)} ({one['at'][n]})"
                for n in names
            ),
        ]
        for one in found["looks"]
    ]
    note = (
        f"Widest 95 % interval at each look and where; wanted: ± {found['half_width']:g}. Stopped: {found['stopped']}."
    )
    return Table("looks", "Intervals as the sample grew", heads, rows, note)
