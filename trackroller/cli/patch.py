"""The command of one contact by itself: its forces at given creepages, as a table, JSON, netCDF or
a page.
"""

from __future__ import annotations

from pathlib import Path

from trackroller.cli.case import PRINTED, writable_data, writable_page, write_result
from trackroller.cli.usage import print_doubts


def run_patch(
    file: Path, creepage: str | None, as_json: bool, out: Path | None, report: Path | None
) -> None:
    """Solve a patch file, and write or print the result.

    `creepage` is a range that replaces the longitudinal creepages of the file. `out` receives
    netCDF and `report` the page. `as_json` prints JSON; without it and `out`, a table is printed.
    """
    target = None if out is None else writable_data(out, PRINTED)
    page = None if report is None else writable_page(report)
    from trackroller.one_patch.doubts import doubts_of_patch
    from trackroller.one_patch.inputs import creepage_range, load_patch
    from trackroller.one_patch.solve import solved_patch  # heavy: numba
    from trackroller.report.pages.patch import print_patch, write_patch  # heavy: jinja2
    from trackroller.report.pages.sheet import as_json as text_of

    changes = {} if creepage is None else {"longitudinal_creepage": creepage_range(creepage)}
    inputs = load_patch(file, changes)
    print_doubts(doubts_of_patch(inputs))
    ds = solved_patch(inputs)
    if target is not None:
        write_result(ds, target)
    if page is not None:
        write_patch(ds, page, file.name, creepage)
    if as_json:
        print(text_of(ds))
    elif target is None:
        print_patch(ds)
