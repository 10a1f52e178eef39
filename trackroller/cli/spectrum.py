"""Command that prints the damage of a load spectrum and the life in shifts."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console
from rich.table import Table

from trackroller.cli.case import writable, write_result
from trackroller.parameters import REGIME_LABELS
from trackroller.report.sheet.text import as_json
from trackroller.study.spectrum.damage import BODIES, summary
from trackroller.study.spectrum.solve import load_spectrum, solve_spectrum

if TYPE_CHECKING:
    import xarray as xr


def run_spectrum(path: Path, json: bool, out: Path | None) -> None:
    """Solve the blocks of a spectrum file; print tables, JSON or write netCDF."""
    target = None if out is None else writable(out)
    dataset = solve_spectrum(load_spectrum(path))
    if target is not None:
        write_result(dataset, target)
    if json:
        print(as_json(dataset))
    elif out is None:
        print_spectrum(dataset)


def print_spectrum(ds: xr.Dataset) -> None:
    """Print the damage of each block, the lives in shifts, and sentences on their causes."""
    console = Console(width=None if Console().is_terminal else 140)
    title = f"{ds.attrs['title']}: damage per shift, in the track of each body that fails first"
    table = Table("block", "distance [m]", "regime", title=title, title_justify="left")
    for body in BODIES:
        table.add_column(f"{body} peak [MPa]", justify="right")
        table.add_column(f"{body} damage [-]", justify="right")
    for i, name in enumerate(ds["block"].values):
        cells = [str(name), f"{float(ds['distance'][i]):g}", REGIME_LABELS[int(ds["regime"][i])]]
        for body in BODIES:
            track = _track(ds, body)
            for variable in ("peak_stress", "damage"):
                cells.append(_cell(float(ds[variable].sel(body=body, contact=track)[i])))
        table.add_row(*cells)
    sums = [_cell(float(ds["damage_sum"].sel(body=b, contact=_track(ds, b)))) for b in BODIES]
    table.add_row("sum", f"{float(ds['distance'].sum()):g}", "", "", sums[0], "", sums[1])
    console.print(table)
    for body in BODIES:
        shifts = _cell(float(ds[f"{body}_life_shifts"]))
        console.print(f"{body:<7} {shifts} shifts{_scatter(ds, body)}", highlight=False)
    for sentence in summary(ds):
        console.print(sentence, highlight=False)


def _track(ds: xr.Dataset, body: str) -> int:
    shifts = ds["life_shifts"].sel(body=body).values
    return int(ds["contact"].values[int(np.argmin(np.where(np.isnan(shifts), np.inf, shifts)))])


def _cell(value: float) -> str:
    return "-" if np.isnan(value) else "unlimited" if np.isinf(value) else f"{value:.4g}"


def _scatter(ds: xr.Dataset, body: str) -> str:
    """Return the shifts at each failure probability as text; empty for materials without scatter."""
    if "life_shifts_at_probability" not in ds:
        return ""
    lives = ds["life_shifts_at_probability"].sel(body=body)
    if bool(lives.isnull().all()):
        return ""
    said = [
        f"{_cell(float(lives.sel(probability=p).min(skipna=False)))} until {100 * float(p):g} % have failed"
        for p in ds["probability"].values
    ]
    return f" ({', '.join(said)})"
