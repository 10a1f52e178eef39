"""The table of limits of one solved roller: utilisation and hours of each limit, and the first of each body."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from trackroller.analysis.table import BODIES
from trackroller.damage import LIMITS
from trackroller.report.numbers import life, rounded
from trackroller.report.terminal import print_table

if TYPE_CHECKING:
    import xarray as xr


def limit_rows(ds: xr.Dataset) -> list[list[str]]:
    """Return a row for each limit: its title, then utilisation [%] and hours of roller and guide."""
    rows = []
    for name in ds["limit"].values.tolist():
        cells = [LIMITS[name].title]
        for body in BODIES:
            own = ds.sel(limit=name, body=body)
            used, hours = float(own["utilisation"]), float(own["life_hours_by_limit"])
            cells.append("-" if math.isnan(used) else rounded(100 * used))
            cells.append("-" if math.isnan(hours) else life(hours))
        rows.append(cells)
    return rows


def first_limits(ds: xr.Dataset) -> list[str]:
    """Return one sentence for each body: the limit that comes first, and when."""
    words = [*(limit.title for limit in LIMITS.values()), "unknown"]
    out = []
    for body in BODIES:
        own = ds.sel(body=body)
        title, hours = words[int(own["limiting_mechanism"])], float(own["life_to_first_limit_hours"])
        when = "when is unknown" if math.isnan(hours) else f"after {life(hours)} h"
        when = "it is never reached" if math.isinf(hours) else "it is reached at once" if hours == 0 else when
        out.append(f"{body:<7} first limit: {title}; {when}")
    return out


def print_limits(ds: xr.Dataset) -> None:
    """Print the table of limits, the first limit of each body, and the values that are missing."""
    heads = ["limit", *(f"{body}, {unit}" for body in BODIES for unit in ("% used", "h"))]
    title = f"Limits at {100 * float(ds.attrs['failure_probability']):g} % failure probability"
    print_table(heads, limit_rows(ds), 140, range(1, 5), title)
    for sentence in (*first_limits(ds), *filter(None, ds.attrs["limits_notes"].split("\n"))):
        print(sentence)
