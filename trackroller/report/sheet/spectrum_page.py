"""The page of a load spectrum, to print or to send."""

from __future__ import annotations

import json
import shlex
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from trackroller.report import html
from trackroller.report.figures.spectrum import damage_by_block
from trackroller.report.figures.style import look, save
from trackroller.report.numbers import capital
from trackroller.report.sheet.facts import body_materials, versions
from trackroller.report.sheet.rows import input_row, is_told
from trackroller.report.sheet.spectrum import block_table, life_rows, sentences, warnings
from trackroller.study.files import write_text
from trackroller.study.spectrum.solve import BODIES

if TYPE_CHECKING:
    import xarray as xr


def write_spectrum(ds: xr.Dataset, path: Path | str, file: str = "spectrum.yaml") -> Path:
    """Write the page of a load spectrum as one HTML file.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `solve_spectrum`.
    path : Path or str
        The file to write; it stands alone.
    file : str
        Name of the spectrum file, for the command that repeats the page.

    Returns
    -------
    Path
        The file.
    """
    inputs = json.loads(ds.attrs["roller"])
    content = {
        "name": capital(str(ds.attrs["title"])),
        "description": str(ds.attrs.get("description", "")),
        "said": [sentence.text for sentence in sentences(ds)],
        "lives": [(body, life_rows(ds, body)) for body in BODIES],
        "conventions": capital(str(ds.attrs["life_conventions"])),
        "figure": _figure(ds),
        "inputs": [input_row(name, value) for name, value in inputs.items() if is_told(name, value)],
        "materials": body_materials(json.loads(ds.attrs["materials"])),
        "blocks": block_table(ds),
        "flags": warnings(ds),
        "command": f"trackroller spectrum {shlex.quote(file)} --report {shlex.quote(Path(path).name)}",
        "versions": ", ".join(f"{name} {version}" for name, version in versions().items()),
    }
    write_text(Path(path), html.render("spectrum.html.j2", content))
    return Path(path)


def _figure(ds: xr.Dataset) -> dict[str, str]:
    """Draw the damage by block, as a data URI with caption and sentence; empty if no damage is known."""
    with look(), tempfile.TemporaryDirectory() as folder:
        drawn = damage_by_block(ds)
        if drawn is None:
            return {}
        save(drawn[0], Path(folder), drawn[1].name)
        source = html.data_uri(Path(folder) / f"{drawn[1].name}.svg")
    return {"source": source, "caption": drawn[1].caption, "sentence": drawn[1].sentence}
