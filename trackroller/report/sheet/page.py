"""The sheet of one roller as a page of HTML, to print or to send."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from trackroller.report import html
from trackroller.report.numbers import life, number, rounded
from trackroller.report.sheet.drawing import drawing
from trackroller.report.sheet.facts import collect
from trackroller.study.files import write_text

if TYPE_CHECKING:
    import xarray as xr

SHOWN = ("contact_shear", "contact_1_stress", "contact_2_stress")  # figures of the sheet, as far as drawn
FULL = 150.0  # percent of a limit at the right end of a bar


def write_sheet(ds: xr.Dataset, path: Path | str, name: str = "") -> Path:
    """Write the sheet of a solved roller.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case. Figures need the outputs `tractions` and `subsurface`.
    path : Path or str
        The HTML file to write; it stands alone.
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
    content = {
        "facts": collect(ds),
        "name": name or "Track roller",
        "drawing": drawing(ds) if "normal_force" in ds else "",
        "figures": _figures(ds),
        "full": FULL,
    }
    return html.render("sheet.html.j2", content, life=life, number=number, rounded=rounded, bar=bar)


def bar(share: float) -> float:
    """Return the length of a bar in percent of its full length."""
    return round(min(100.0 * share, FULL) / FULL * 100.0, 1)


def _figures(ds: xr.Dataset) -> list[dict[str, str]]:
    """Draw the figures that the data set has fields for, as data URIs with captions."""
    if not any(v.ndim > 2 for v in ds.values()):
        return []
    from trackroller.report.figures.contact import plot_case  # heavy: matplotlib

    with tempfile.TemporaryDirectory() as folder:
        infos = {info.name: info for info in plot_case(ds, Path(folder))}
        return [
            {"caption": infos[name].caption, "source": html.data_uri(Path(folder) / f"{name}.svg")}
            for name in SHOWN
            if name in infos
        ]
