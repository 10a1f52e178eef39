"""Command that prints the damage of a load spectrum and the life of roller and guide, and writes its page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from trackroller.cli.case import writable, write_result
from trackroller.report.sheet.spectrum import block_table, life_rows, sentences, warnings
from trackroller.report.sheet.text import as_json
from trackroller.study.spectrum.file import load_spectrum
from trackroller.study.spectrum.solve import BODIES, solve_spectrum

if TYPE_CHECKING:
    import xarray as xr


def run_spectrum(path: Path, json: bool, out: Path | None, page: Path | None) -> None:
    """Solve the blocks of a spectrum file; print tables or JSON, write netCDF or a page."""
    target, sheet = (None if place is None else writable(place) for place in (out, page))
    dataset = solve_spectrum(load_spectrum(path))
    if target is not None:
        write_result(dataset, target)
    if sheet is not None:
        from trackroller.report.sheet.spectrum_page import write_spectrum  # heavy: matplotlib

        write_spectrum(dataset, sheet, path.name)
    if json:
        print(as_json(dataset))
    elif target is None:
        print_spectrum(dataset)


def print_spectrum(ds: xr.Dataset) -> None:
    """Print the damage of each block, the lives, sentences on their causes and warnings."""
    console = Console(width=None if Console().is_terminal else 180, highlight=False, markup=False)
    told = block_table(ds)
    table = Table(title=f"{ds.attrs['title']}: damage per shift", title_justify="left")
    for i, head in enumerate(told.heads):
        table.add_column(head, justify="right" if i else "left")
    for row in told.rows:
        table.add_row(*row)
    console.print(table)
    console.print(told.note)
    for body in BODIES:
        console.print(
            f"{body:<7} {'; '.join(f'{row.words}: {row.value} {row.unit}'.rstrip() for row in life_rows(ds, body))}"
        )
    for sentence in sentences(ds):
        console.print(sentence.text)
    for text in warnings(ds):
        console.print(f"warning {text}")
