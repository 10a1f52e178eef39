"""The user's own rows, whose columns are the factors."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from trackroller.methods.factor import Factor
from trackroller.methods.sample import Sample


class GivenTable(Sample):
    """Rows of a CSV file or workbook; nothing is drawn."""

    name = "table"
    takes = {"table": None}
    observed = True
    subset = False
    needs = "independent factors (correlated columns share their influence); any usable rows"
    whole = "cases of the table"
    uncorrelated = "Remove the key: the rows of the table have their own correlation."


def of_columns(columns: Mapping[str, np.ndarray]) -> tuple[dict[str, Factor], np.ndarray]:
    """Return the columns that vary as factors, and `unit` of these: numbers, or the index of other
    values.

    Parameters
    ----------
    columns : name -> values of all rows, shape (n,)

    Returns
    -------
    Factors by name, and an array of shape (n, number of factors).
    """
    levels = {name: tuple(dict.fromkeys(values.tolist())) for name, values in columns.items()}
    free = {
        name: Factor(name, "values", levels=own) for name, own in levels.items() if len(own) > 1
    }
    unit = np.empty((max(map(len, columns.values()), default=0), len(free)))
    for j, (name, factor) in enumerate(free.items()):
        index = {level: i for i, level in enumerate(factor.levels)}
        values = columns[name]
        if factor.ordered:
            unit[:, j] = values
        else:
            unit[:, j] = [index[value] for value in values.tolist()]
    return free, unit
