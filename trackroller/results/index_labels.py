"""Label sensitivity indices, and record which rows were used, which were left out and which factors
correlate.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr

from trackroller.methods import Design, Method
from trackroller.methods.correlation import correlated_pairs
from trackroller.methods.intervals import constant
from trackroller.methods.method import Estimates, index_of
from trackroller.parameters import REGIME_LABELS, REGIMES
from trackroller.parameters.carriage_fields import long_name_of
from trackroller.study.outputs import Output

RELIABLE = 0.9  # share of usable blocks, effects or cells below which an index is marked


def note(column: Output, used: int, total: int, unit: str) -> str:
    """Return a sentence on the rows used for one output.

    Parameters
    ----------
    column : the output
    used, total : number of rows, blocks, effects or cells
    unit : which of these, in the plural

    Returns
    -------
    How many were used and why the others were not.
    """
    if constant(column.values):
        return "constant or never usable: no index can be given"
    text = f"{used:,} of {total:,} {unit} used"
    if column.excluded:
        text += "; rows left out: " + ", ".join(
            f"{n:,} {why}" for why, n in column.excluded.items()
        )
        further = total - used - sum(column.excluded.values())
        if unit == "cells" and further > 0:
            text += (
                f", and {further:,} at the same levels, because indices of a grid need every "
                "combination of levels"
            )
    if used < RELIABLE * total:
        text += "; the indices describe the cases used, not the whole range of the factors"
    return text


def first_order_sums(result: xr.Dataset, drawn: bool) -> dict[str, Any]:
    """Return the sums of the first-order indices, and why a sum exceeds 100 %.

    Parameters
    ----------
    result : labelled indices with `used_share`; `correlated` marks correlated factors
    drawn : whether the design draws the factors, so that nothing but stated correlations ties them

    Returns
    -------
    Variables first_order_sum [1] and first_order_sum_note along `output`; the note is empty for a
    sum of up to 100 %. Negative estimates count as 0. Empty without estimated first-order indices;
    those of a grid are exact.

    Notes
    -----
    First-order indices of independent factors add up to 100 % at most. Estimates exceed it if
    factors are correlated, by sampling errors (the root of the sum of squares of the half widths),
    or because rows are left out: the remaining rows are no sample of independent factors.
    """
    name = "first"
    if "S1" in result:
        name = "S1"
    if "main_share" in result or name not in result:
        return {}
    total = result[name].clip(min=0.0).sum("factor").values
    error = np.sqrt(
        (((result[f"{name}_high"] - result[f"{name}_low"]) / 2) ** 2).sum("factor").values
    )
    tied = []
    if "correlated" in result:
        tied = [str(n) for n in result["factor_name"].values[result["correlated"].values == 1]]
    rows = zip(total, error, result["used_share"].values, strict=True)
    notes = np.array([_excess(*row, tied, drawn) for row in rows], dtype=object)
    return {
        "first_order_sum": (
            "output",
            total,
            {"long_name": "sum of the first-order indices", "units": "1"},
        ),
        "first_order_sum_note": (
            "output",
            notes,
            {"long_name": "why the first-order indices exceed 100 % together"},
        ),
    }


def _excess(total: float, error: float, used: float, tied: list[str], drawn: bool) -> str:
    """Return why first-order indices add up to more than 100 %; '' where they do not."""
    if not total > 1.005:
        return ""
    text = (
        f"The first-order indices add up to {100 * total:.0f} %, those of independent factors "
        "to 100 % at most: "
    )
    if tied:
        return (
            text
            + f"{' and '.join(tied)} are correlated, and each index holds influence of the others."
        )
    if total - 1 > error and used < 1:
        left = (
            f"{100 * (1 - used):.0f} % of the rows are left out, and in the others the factors "
            "may be dependent."
        )
        return text + left
    if total - 1 > error and not drawn:
        return (
            text + f"the excess is above the sampling error of ± {100 * error:.0f} %, so the "
            "factors may be dependent."
        )
    return text + f"the sum of so small a sample has a 95 % interval of ± {100 * error:.0f} %."


def treatment(regime: np.ndarray, keep: Iterable[str], allowed: np.ndarray | None = None) -> str:
    """Return a sentence on the treatment of the regimes.

    Parameters
    ----------
    regime : number of the regime of each case, shape (n,)
    keep : names of the regimes whose cases were used
    allowed : whether each case meets the constraints of the study, shape (n,)

    Returns
    -------
    How many cases each regime has, which regimes were left out, and how many cases miss a
    constraint.
    """
    counts = {name: int((regime == i).sum()) for i, name in enumerate(REGIMES)}
    words = dict(zip(REGIMES, REGIME_LABELS, strict=True))
    text = ", ".join(f"{n:,} {words[name]}" for name, n in counts.items() if n)
    left = [words[name] for name, n in counts.items() if n and name not in tuple(keep)]
    if left:
        text += f"; the indices leave out the rows with {' and '.join(left)}; "
        text += "how often these occur is a separate output, whose indices use all rows"
    else:
        text += "; no row left out for its regime"
    counted = np.isin(regime, [REGIMES.index(name) for name in keep])
    if allowed is None:
        missed = 0
    else:
        missed = int((counted & ~allowed).sum())
    if missed:
        text += f"; {missed:,} further rows miss a constraint and are left out of the same indices"
    return text


def correlated(design: Design) -> str:
    """Return a warning of correlated factors, or an empty text; see `correlated_pairs`."""
    warnings = [
        f"{factor_name(one)} and {factor_name(other)} are correlated (rank correlation {rho:.2f})"
        for one, other, rho in correlated_pairs(design)
    ]
    if warnings:
        return f"; {', '.join(warnings)}: the index of each includes the influence of both"
    return ""


def labelled(
    design: Design, columns: list[Output], results: list[Estimates], at: np.ndarray
) -> xr.Dataset:
    """Join the results of all outputs.

    Parameters
    ----------
    design : the design
    columns : the outputs
    results : estimates of each output
    at : sample sizes of the courses, shape (m,)

    Returns
    -------
    Dataset with the dimensions output, factor, factor_2 and sample_size, with units and long names.
    """
    coords = output_labels(columns) | {
        "factor": np.array(list(design.factors), dtype=object),
        "scale": ("output", np.array([c.scale for c in columns], dtype=object)),
        "factor_name": ("factor", np.array([factor_name(n) for n in design.factors], dtype=object)),
    }
    out = xr.Dataset(stacked(design.method, results, ("output", "factor", "factor_2")), coords)
    if "factor_2" in out.dims:
        out = out.assign_coords(factor_2=out["factor"].values)
    if at.size and "sample_size" in out.dims:
        words = {"long_name": "rows of the design, from the first on", "units": "1"}
        out = out.assign_coords(sample_size=("sample_size", at, words))
    return out


def output_labels(columns: list[Output]) -> dict[str, Any]:
    """Return the coordinates along `output`: name, units and words of each output."""
    return {
        "output": np.array([c.name for c in columns], dtype=object),
        "output_units": ("output", np.array([c.units for c in columns], dtype=object)),
        "output_name": ("output", np.array([c.long_name for c in columns], dtype=object)),
    }


def stacked(method: Method, results: list[Estimates], dims: tuple[str, ...]) -> dict[str, Any]:
    """Return the estimates of all outputs as variables of a data set.

    Parameters
    ----------
    method : declares the words of each estimate, and whether it has the unit of the output
    results : estimates of each output
    dims : dimensions of an estimate, `output` first; one with fewer dimensions takes the first of
        them

    Returns
    -------
    Dimensions, values and attributes by the name of the estimate.

    Raises
    ------
    InputError : the method does not declare an estimate
    """
    out: dict[str, Any] = {}
    for name in results[0]:
        values = np.stack([r[name] for r in results])
        root = name.removesuffix("_low").removesuffix("_high").removesuffix("_course")
        axes = dims[: values.ndim]
        if "_course" in name:
            axes = ("output", "sample_size", "factor")
        index = index_of(method, root)
        attrs = {"units": "1", "long_name": index.words + name[len(root) :].replace("_", " ")}
        if index.sized:
            attrs |= {
                "units": "",
                "comment": "in the unit of the output; on the scale log10 in powers of ten",
            }
        out[name] = (axes, values, attrs)
    return out


def factor_name(name: str) -> str:
    """Return the long name of a parameter or of a field of a carriage, or the name of another
    factor with spaces.
    """
    return long_name_of(name)
