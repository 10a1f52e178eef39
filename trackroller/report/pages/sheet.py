"""The sheet of one roller and the page of a load spectrum as HTML, to print or to send."""

from __future__ import annotations

import json
import shlex
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from trackroller.analysis.table import BODIES
from trackroller.files import write_text
from trackroller.report import html
from trackroller.report.figures.roller_section import drawing
from trackroller.report.numbers import capital, life, number, rounded
from trackroller.report.pages.sheet_facts import body_materials, collect, versions_text
from trackroller.report.pages.spectrum import block_table, life_rows, sentences, warnings
from trackroller.report.tables.inputs import input_row, is_told

if TYPE_CHECKING:
    import xarray as xr

SHOWN = ("contact_shear", "contact_1_stress", "contact_2_stress")  # figures of the sheet, as far as drawn
FULL = 150.0  # percent of a limit at the right end of a bar


def write_sheet(ds: xr.Dataset, path: Path | str, name: str = "") -> Path:
    """Write the sheet of a solved roller as one HTML file that stands alone.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case. Figures need the outputs `tractions` and `subsurface`.
    path : Path or str
        The file to write.
    name : str
        Head of the sheet.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If `ds` is not the result of one case.
    """
    write_text(Path(path), render(ds, name))
    return Path(path)


def render(ds: xr.Dataset, name: str = "") -> str:
    """Return the sheet as HTML text; see `write_sheet`."""
    drawn = {}
    if any(v.ndim > 2 for v in ds.values()):
        from trackroller.report.figures.contact import plot_case  # heavy: matplotlib

        drawn = _pictures(partial(plot_case, ds))
    content = {
        "facts": collect(ds),
        "name": name or "Track roller",
        "drawing": drawing(ds) if "normal_force" in ds else "",
        "figures": [drawn[name] for name in SHOWN if name in drawn],
        "full": FULL,
    }
    return html.render("sheet.html.j2", content, life=life, number=number, rounded=rounded, bar=bar)


def bar(share: float) -> float:
    """Return the length of a bar in percent of its full length."""
    return round(min(100.0 * share, FULL) / FULL * 100.0, 1)


def _pictures(draw: Callable[[Path], list[Any]]) -> dict[str, dict[str, str]]:
    """Draw figures, and return the data URI, caption and sentence of each by its name."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        return {i.name: vars(i) | {"source": html.data_uri(folder / f"{i.name}.svg")} for i in draw(folder)}


def write_spectrum(ds: xr.Dataset, path: Path | str, file: str = "spectrum.yaml") -> Path:
    """Write the page of a load spectrum as one HTML file that stands alone.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `solve_spectrum`.
    path : Path or str
        The file to write.
    file : str
        Name of the spectrum file, for the command that repeats the page.

    Returns
    -------
    Path
        The file.
    """
    from trackroller.report.figures import spectrum, style  # heavy: matplotlib

    inputs = json.loads(ds.attrs["roller"])
    drawn = _pictures(partial(style.draw_all, [partial(spectrum.damage_by_block, ds)]))
    content = {
        "name": capital(str(ds.attrs["title"])),
        "description": str(ds.attrs.get("description", "")),
        "said": [sentence.text for sentence in sentences(ds)],
        "lives": [(body, life_rows(ds, body)) for body in BODIES],
        "conventions": capital(str(ds.attrs["life_conventions"])),
        "figure": next(iter(drawn.values()), None),
        "inputs": [input_row(name, value) for name, value in inputs.items() if is_told(name, value)],
        "materials": body_materials(json.loads(ds.attrs["materials"])),
        "blocks": block_table(ds),
        "flags": warnings(ds),
        "command": f"trackroller spectrum {shlex.quote(file)} --report {shlex.quote(Path(path).name)}",
        "versions": versions_text(),
    }
    write_text(Path(path), html.render("spectrum.html.j2", content))
    return Path(path)
