"""From a solved study to its labelled sensitivity indices.

The design decides the analysis: shares of variance on a grid, elementary effects for Morris, Sobol indices for
Saltelli samples, effects for response-surface designs, measures from given data for every independent sample. An
inner/outer array design gets distributions of life (`robustness`).
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray as xr

from trackroller.analysis import convergence, indices
from trackroller.analysis.givendata import firsts, given_data
from trackroller.analysis.labels import (
    RELIABLE,
    correlated,
    correlated_pairs,
    first_order_sums,
    labelled,
    note,
    treatment,
)
from trackroller.analysis.pairs import pairs
from trackroller.analysis.parts import parts_of
from trackroller.analysis.replicates import HEADLINES, replicated
from trackroller.analysis.robustness import material_deviations, robustness
from trackroller.analysis.sobol import sobol
from trackroller.analysis.table import StudyResults
from trackroller.analysis.targets import targets
from trackroller.errors import InputError
from trackroller.roller.dataset import file_attributes
from trackroller.study.design.sampling import SampledDesign
from trackroller.study.outputs import Output, outputs, regimes

log = logging.getLogger("trackroller")
NEEDS = {
    "grid": "a full grid, every level weighing the same",
    "saltelli": "whole blocks of the Saltelli design and independent factors",
    "morris": "pairs of neighbouring rows of a trajectory",
    "central_composite": "enough rows for the fitted polynomial",
    "box_behnken": "enough rows for the fitted polynomial",
    "plackett_burman": "enough rows for the fitted main effects",
    "lhs": "independent factors (correlated factors share their influence); any usable rows",
    "sobol": "independent factors (correlated factors share their influence); any usable rows",
    "table": "independent factors (correlated columns share their influence); any usable rows",
}


class Estimated(NamedTuple):
    """Estimates for one output, how many rows, blocks, effects or cells they used, and the sizes of their course."""

    estimates: indices.Estimates
    used: int
    total: int
    sizes: np.ndarray = np.zeros(0, dtype=int)


def _saltelli(y: np.ndarray, design: SampledDesign) -> Estimated:
    groups, second = design.meta.get("groups"), bool(design.meta["second_order"])
    count = len(groups or design.factors)
    block = design.blocks(y)
    blocks = len(block)
    # rows of A and B only: their mixtures repeat coordinates, so they are not independent rows
    own = np.full_like(block, np.nan)
    own[:, [0, -1]] = block[:, [0, -1]]
    given = given_data(own.ravel(), design.places, design.ordered)
    if groups:  # such a design gives single factors no Sobol index
        return Estimated(given, int(np.isfinite(block).all(axis=1).sum()), blocks)
    out = sobol(y, count, second)
    at = convergence.sizes(blocks)
    lean = block[:, np.r_[0 : count + 1, -1]]  # the course needs no second order

    def part(blocks: int) -> indices.Estimates:
        return sobol(lean[:blocks].ravel(), count, False)

    out |= convergence.course(part, at, part(blocks) if second else out, ("S1", "ST")) | given
    return Estimated(out, int(out.pop("blocks_used")), int(out.pop("blocks")), at)


def _morris(y: np.ndarray, design: SampledDesign) -> Estimated:
    step = len(design.factors) + 1

    def part(paths: int) -> indices.Estimates:
        rows = slice(0, paths * step)
        return indices.morris(y[rows], design.unit[rows], design.listed)

    total = int(design.meta["trajectories"])
    at = convergence.sizes(total, smallest=4)
    out = part(total)
    out |= convergence.course(part, at, out, ("mu_star",))
    return Estimated(out, int(out["effects_used"].sum()), total * (step - 1), at)


def _grid(y: np.ndarray, design: SampledDesign) -> Estimated:
    out = indices.grid_shares(y.reshape(design.meta["shape"]))
    out |= given_data(y, design.unit, design.ordered)
    return Estimated(out, int(out.pop("cells_used")), int(out.pop("cells")))


def _coded(y: np.ndarray, design: SampledDesign) -> Estimated:
    out = indices.effects(y, design.unit, design.listed, design.method != "plackett_burman")
    return Estimated(out, int(out.pop("rows_used")), len(y))


def _given(y: np.ndarray, design: SampledDesign) -> Estimated:
    ordered, places = design.ordered, design.places
    out = given_data(y, places, ordered)
    if len(design.factors) > 1 and not correlated_pairs(design):
        out |= pairs(y, places, ordered)
    at = convergence.sizes(len(y), smallest=64)

    def part(n: int) -> indices.Estimates:
        every = max(1, len(y) // n)  # the first rows of a table may be sorted, so take every so many rows
        return firsts(y[::every], places[::every], ordered)

    out |= convergence.course(part, at, out, ("first",))
    return Estimated(out, int(out.pop("rows_used")), len(y), at)


def _of_replicates(found: Estimated, y: np.ndarray, design: SampledDesign) -> Estimated:
    """Replace the intervals and the course of the headline indices by those of the replicates of a grown sample."""
    copies = int(design.meta["replicates"])
    total = design.samples
    at = convergence.sizes(total, smallest=2 * copies)
    out = replicated(y, design, total)
    names = HEADLINES[design.method]
    course = convergence.course(lambda samples: replicated(y, design, samples), at, out, names)
    return found._replace(estimates=found.estimates | out | course, sizes=at)


_METHODS: dict[str, Callable[[np.ndarray, SampledDesign], Estimated]] = {
    "saltelli": _saltelli,
    "morris": _morris,
    "grid": _grid,
    **dict.fromkeys(("lhs", "sobol", "table"), _given),
    **dict.fromkeys(("central_composite", "box_behnken", "plackett_burman"), _coded),
}
_UNIT = {"saltelli": "blocks", "morris": "elementary effects", "grid": "cells"}


def analyse(results: StudyResults) -> xr.Dataset:
    """Compute sensitivity indices of every output of a study and record how they were obtained.

    Parameters
    ----------
    results : StudyResults
        A solved study. The key `analysis` of its study file says which outputs and regimes count. The same study gives
        the same indices.

    Returns
    -------
    xarray.Dataset
        Dimensions output, factor, factor_2 and sample_size. By method: S1, ST, S2 (saltelli); mu, mu_star, sigma
        (morris); main_share, interaction_share, higher_share (grid); effect, curvature, interaction (response
        surfaces); first, delta, prcc (given data). A random sample also has interaction_share by a polynomial
        that predicts `fit_share` of the variance. The keys `groups` and `conditional_on` add the variables of
        `trackroller.analysis.parts.parts_of`. Indices have _low, _high and their course with the sample size. For
        each output: used_share, reliable, take_times, and `note`, which states the rows left out and why;
        first_order_sum, and first_order_sum_note, which explains a sum above 100 %. An
        inner/outer array design gives the result of `trackroller.analysis.robustness.robustness`.

    Raises
    ------
    InputError
        If no output or no factor varies.
    """
    ds, design, given = results.data, results.design, results.config.analysis
    if design.method == "optimise":
        allowed = "a design that draws its rows evenly: a search prefers good designs"
        raise InputError("design", design.method, allowed, "Take design saltelli, sobol or lhs for indices.")
    own = material_deviations(results)
    aims = targets(ds, design, given.target, own, results.view.valid) if given.target else xr.Dataset()
    if design.method == "inner_outer":
        return robustness(results, own).merge(aims, combine_attrs="override")
    columns = outputs(ds, design.factors, given.outputs, given.keep, scale=given.scale, allowed=results.allowed)
    if not columns or not design.factors:
        raise InputError("study", list(ds.data_vars), "at least one output and one factor that varies")
    by_output = []
    for number, column in enumerate(columns, 1):
        log.info("analyse output %d of %d: %s", number, len(columns), column.name)
        by_output.append(_METHODS[design.method](column.values, design))
        by_output[-1].estimates.pop("rows_used", None)
        if "replicates" in design.meta:
            by_output[-1] = _of_replicates(by_output[-1], column.values, design)
    result = labelled(design, columns, [one.estimates for one in by_output], by_output[0].sizes)
    result = result.merge(parts_of(design, columns, given))
    result = result.assign(_quality(result, design, columns, by_output))
    if tied := {name for pair in correlated_pairs(design) for name in pair[:2]}:
        words = {"long_name": "1 for a factor that is correlated with another factor", "units": "1"}
        result["correlated"] = ("factor", np.array([name in tied for name in design.factors], np.int8), words)
    result = result.assign(first_order_sums(result, design.method != "table"))
    result.attrs = {
        **file_attributes("Sensitivity analysis of a study of track rollers", "analysed"),
        "method": design.method,
        "needs": NEEDS[design.method],
        "rows": design.size,
        "kept_regimes": ", ".join(given.keep),
        "interval": "95 %",
        "treatment": treatment(regimes(ds, results.dims), given.keep, results.allowed) + correlated(design),
        "study": results.study.merged(),
    }
    return result.merge(aims, combine_attrs="override")


def _quality(
    result: xr.Dataset, design: SampledDesign, columns: list[Output], by_output: list[Estimated]
) -> dict[str, tuple[str, np.ndarray, dict[str, str]]]:
    """Return the variables that say how many rows the indices of each output use, and whether these suffice."""
    share = np.array([one.used / max(1, one.total) for one in by_output])
    unit = _UNIT.get(design.method, "rows")
    notes = [note(column, one.used, one.total, unit) for column, one in zip(columns, by_output, strict=True)]
    bounds = [_bounds(one.estimates, design.method) for one in by_output]
    if design.meta.get("groups"):
        bounds = list(zip(result["group_ST_low"].values, result["group_ST_high"].values, strict=True))
    wanted = convergence.HALF_WIDTH_MORRIS if design.method == "morris" else convergence.HALF_WIDTH
    times = [convergence.take_times(*both, wanted) for both in bounds]
    half = [convergence.half_width(*both) for both in bounds]
    return {
        name: ("output", values, {"long_name": words} | ({} if values.dtype == object else {"units": "1"}))
        for name, values, words in (
            ("used_share", share, "share of the rows that the indices use"),
            ("reliable", (share >= RELIABLE).astype(np.int8), f"1 where at least {RELIABLE:g} of the rows are used"),
            ("note", np.array(notes, dtype=object), "rows left out, and why"),
            ("half_width", np.array(half), "half width of the widest interval (of mu*: over the largest mu*)"),
            ("take_times", np.array(times), "factor on the samples after which the intervals are narrow enough"),
        )
    }


def _bounds(out: indices.Estimates, method: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the bounds of the indices that must be narrow, as shares of the variance or of the largest mu*."""
    names = [n for n in ({"saltelli": "ST", "morris": "mu_star"}.get(method, "first"), "S1") if f"{n}_low" in out]
    if method == "grid" or not names:
        return np.full(1, np.nan), np.full(1, np.nan)
    low, high = (np.concatenate([out[f"{name}_{end}"] for name in names]) for end in ("low", "high"))
    whole = float(np.nanmax(out["mu_star"], initial=0.0)) if method == "morris" else 1.0
    return (low / whole, high / whole) if whole > 0 else (low * np.nan, high * np.nan)
