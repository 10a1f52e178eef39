"""Tables of sensitivity indices in numbers: each index with the ends of its 95 % interval in
columns of their own.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import xarray as xr

from trackroller.methods.method import indices_of
from trackroller.report.numbers import capital, level_text, unit_text
from trackroller.report.tables.table import Table
from trackroller.results.ranking import estimate, index_words, method_of, order


def index_tables(sens: xr.Dataset) -> list[Table]:
    """Return all indices of all outputs, those of groups, and those within the levels of a
    category.
    """
    tables = [_all_indices(sens), _groups(sens), _levels(sens)]
    return [table for table in tables if table is not None]


def of_output(sens: xr.Dataset, output: str) -> str:
    """Name an output, 'log life of the roller' on the logarithmic scale."""
    part = sens.sel(output=output)
    text = str(part["output_name"].item())
    if str(part["scale"].item()) == "log10":
        return f"log {text}"
    return text


def effect_unit(sens: xr.Dataset, output: str) -> str:
    """Name the unit of an effect; on the logarithmic scale it is a power of ten."""
    part = sens.sel(output=output)
    if str(part["scale"].item()) == "log10":
        return "powers of ten"
    return unit_text(str(part["output_units"].item()))


def category(sens: xr.Dataset) -> str:
    """Name the factor whose levels the conditional indices stand for."""
    return str(sens["level"].attrs["factor"]).replace("_", " ")


def index_numbers(part: xr.Dataset, name: str, signed: bool) -> tuple[float, float, float]:
    """Return one index with the ends of its interval; an index without a sign is not below 0."""
    numbers = [float(value) for value in estimate(part, name)]
    if not signed:
        numbers = [float(np.maximum(0.0, value)) for value in numbers]
    return numbers[0], numbers[1], numbers[2]


def _row(part: xr.Dataset, keys: Sequence[str]) -> Iterator[tuple[str, Any]]:
    for key in keys:
        index = index_words(part, key)
        words = capital(index.words)
        value, low, high = index_numbers(part, key, index.signed)
        yield words, value
        yield f"{words}, low", low
        yield f"{words}, high", high


def _known(sens: xr.Dataset, keys: Sequence[str]) -> list[str]:
    return [key for key in keys if key in sens and bool(np.isfinite(sens[key]).any())]


def _all_indices(sens: xr.Dataset) -> Table | None:
    declared = indices_of(method_of(sens))
    keys = _known(sens, [name for name, index in declared.items() if index.of_factor])
    if not keys:  # such as an inner/outer design, whose analysis is that of its points
        return None
    rows = []
    for output in map(str, sens["output"].values):
        part = sens.sel(output=output)
        for rank in order(sens, output):
            one = part.sel(factor=rank.factor)
            row = {"Output": of_output(sens, output), "Unit of effects": effect_unit(sens, output)}
            rows.append(
                {
                    **row,
                    "Factor": rank.name,
                    **dict(_row(one, keys)),
                    "From": str(part["note"].item()),
                }
            )
    return Table.of("indices", "Indices", rows)


def _groups(sens: xr.Dataset) -> Table | None:
    if "group_ST" not in sens:
        return None
    rows = []
    for output in map(str, sens["output"].values):
        for group in sens["group"].values:
            one = sens.sel(output=output, group=group)
            row = {"Output": of_output(sens, output), "Group": str(one["group_name"].item())}
            row["Factors"] = str(one["group_members"].item())
            rows.append({**row, **dict(_row(one, _known(sens, ("group_S1", "group_ST"))))})
    return Table.of("groups", "Indices of groups of factors", rows)


def _levels(sens: xr.Dataset) -> Table | None:
    keys = _known(sens, ("conditional_S1", "conditional_ST"))
    if not keys:
        return None
    rows = []
    factor = str(sens["level"].attrs["factor"])
    for output in map(str, sens["output"].values):
        for level in sens["level"].values:
            part = sens.sel(output=output, level=level)
            for name in part["factor"].values:
                one = part.sel(factor=name)
                row: dict[str, Any] = {
                    "Output": of_output(sens, output),
                    capital(category(sens)): level_text(factor, level),
                }
                row["Factor"] = str(one["factor_name"].item())
                row["Cases"] = int(part["conditional_rows"])
                rows.append({**row, **dict(_row(one, keys))})
    return Table.of("levels", f"Indices within each {category(sens)}", rows)
