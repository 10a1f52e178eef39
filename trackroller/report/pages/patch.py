"""The page of one contact by itself: its table, creep curve and fields; and the table on a
terminal.
"""

from __future__ import annotations

import json
import shlex
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from trackroller.parameters.patch_fields import CREEPAGES, PATCH_FIELDS
from trackroller.report import html
from trackroller.report.figures.patch import PER_CENT, along_cases
from trackroller.report.numbers import capital, rounded, unit_text, with_unit
from trackroller.report.pages.record import pictures, versions_text
from trackroller.report.tables.table import Table, cell
from trackroller.report.terminal import print_table, print_text

IN_PER_CENT = (
    *CREEPAGES[:2],
    "friction_force_share",
    "stick_area_fraction",
    "force_error_estimate",
)
HEADS = {  # of the columns that every table has
    "driving_force": "F_y",
    "lateral_force": "F_x",
    "spin_moment": "Spin moment",
    "friction_force_share": "Force over mu F_N",
    "force_error_estimate": "Estimated error over mu F_N",
    "friction_power": "Friction power",
    "stick_area_fraction": "Adhesion area",
    "max_pressure": "Largest pressure",
    "semi_axis_lateral": "Half width",
    "semi_axis_rolling": "Half length",
}
# share of mu F_N below which a force in every case is rounding, so that its column is left out
NO_FORCE = 1e-6


def table_of_cases(ds: xr.Dataset) -> Table:
    """List the creepages and results of each case.

    Creepages that are 0 and forces that are rounding in every case have no column.
    """
    own = along_cases(ds)
    names = [name for name in CREEPAGES if (own[name] != 0.0).any() or name == CREEPAGES[0]]
    names += [name for name in HEADS if not _is_rounding(own, name)]
    scale = {name: PER_CENT for name in IN_PER_CENT}
    values = [(own[name] * scale.get(name, 1.0)).values.tolist() for name in names]
    rows = [[str(i), *map(cell, row)] for i, row in enumerate(zip(*values, strict=True))]
    return Table("patch_cases", "Forces", ["Case", *(_head(own, name) for name in names)], rows)


def _is_rounding(ds: xr.Dataset, name: str) -> bool:
    """Return whether a lateral force or a spin moment is rounding in every case."""
    if name not in ("lateral_force", "spin_moment"):
        return False
    scale = ds["friction_coefficient"] * ds["normal_force"]
    if name == "spin_moment":
        scale = scale * ds["semi_axis_rolling"]
    return bool((abs(ds[name]) <= NO_FORCE * scale).all())


def _head(ds: xr.Dataset, name: str) -> str:
    if name in IN_PER_CENT:
        units = "%"
    else:
        units = unit_text(str(ds[name].attrs["units"]))
    words = HEADS.get(name) or capital(str(ds[name].attrs["long_name"]))
    return with_unit(words, units)


def table_of_inputs(ds: xr.Dataset) -> Table:
    """List load, shape, friction and materials; of a value that varies its least and its
    largest.
    """
    rows = []
    for name in PATCH_FIELDS:
        if name not in ds or name in CREEPAGES or name in HEADS:
            continue
        ends = dict.fromkeys(rounded(float(end)) for end in (ds[name].min(), ds[name].max()))
        rows.append([_head(ds, name), " to ".join(ends)])
    for i, body in enumerate(json.loads(ds.attrs["materials"]), 1):
        constants = f"E {rounded(body['youngs_modulus'])} MPa, nu {rounded(body['poisson_ratio'])}"
        rows.append([f"Material of body {i}", f"{body['name']}: {constants}"])
    law = json.loads(ds.attrs["friction_law"])
    rows.append(["Friction law", ", ".join(f"{key} {value}" for key, value in law.items())])
    rows.append(["Accuracy", str(ds.attrs["accuracy"])])
    return Table("patch_inputs", "Inputs", ["Value", ""], rows)


def sentences(ds: xr.Dataset) -> list[str]:
    """Return the statements at the head of the page: the largest force, and cases without a
    solution.
    """
    own = along_cases(ds)
    used = own["friction_force_share"]
    texts = []
    if used.notnull().any():
        best = own.isel(case=int(np.nanargmax(used.values.round(4))))  # the first of equal ones
        creepages = ", ".join(
            f"{best[name].attrs['long_name']} {rounded(_shown(best, name))} {_unit_shown(name)}"
            for name in CREEPAGES
            if float(best[name]) != 0.0
        )
        share = rounded(PER_CENT * float(best["friction_force_share"]))
        texts.append(
            f"The largest friction force is {share} % of mu F_N, at {creepages or 'no creepage'}."
        )
    missed = int((own["converged"] == 0).sum())
    if missed:
        texts.append(
            f"{missed} of {own.sizes['case']} cases have not converged: the friction law is not "
            "met there."
        )
    steep = int((own["steep_friction"] == 1).sum())
    if steep:
        texts.append(
            f"{capital(own['steep_friction'].attrs['long_name'])} in {steep} of "
            f"{own.sizes['case']} cases."
        )
    return texts


def _shown(one: xr.Dataset, name: str) -> float:
    if name in IN_PER_CENT:
        return float(one[name]) * PER_CENT
    return float(one[name])


def _unit_shown(creepage: str) -> str:
    if creepage == "spin":
        return "/mm"
    return "%"


def write_patch(
    ds: xr.Dataset, path: Path | str, file: str = "patch.yaml", creepage: str | None = None
) -> Path:
    """Write the page of one contact as one HTML file that stands alone, or as PDF by the name of
    the file.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.patch`.
    path : Path or str
        The file to write.
    file : str
        Name of the patch file, for the command that repeats the page.
    creepage : str, optional
        The range of creepages of that command.

    Returns
    -------
    Path
        The file.
    """
    from trackroller.report.figures import patch  # heavy: matplotlib

    words = ["trackroller", "patch", file, "--report", Path(path).name]
    if creepage is not None:
        words += ["--creepage", creepage]
    content = {
        "name": ds.attrs["patch"],
        "description": ds.attrs["description"],
        "said": sentences(ds),
        "figures": list(
            pictures(partial(patch.creep_curve, ds), partial(patch.fields, ds)).values()
        ),
        "cases": table_of_cases(ds),
        "inputs": table_of_inputs(ds),
        "conventions": [f"{capital(text)}." for text in str(ds.attrs["conventions"]).split("; ")],
        "command": shlex.join(words),
        "versions": versions_text(),
    }
    return html.write_page(Path(path), html.render("patch.html.j2", content))


def print_patch(ds: xr.Dataset) -> None:
    """Print the results of each case as a table, below the statements of the page."""
    for text in sentences(ds):
        print_text(text)
    table = table_of_cases(ds)
    print_table(table.heads, table.rows, range(1, len(table.heads)))
