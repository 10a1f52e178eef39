"""From a solved study to its labelled sensitivity indices.

The design decides the analysis: shares of variance on a grid, elementary effects for Morris, Sobol
indices for Saltelli samples, effects for response-surface designs, measures from given data for
every independent sample. An inner/outer array design gets distributions of life (`robustness`).
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError
from trackroller.methods import Design, Method, convergence
from trackroller.methods.correlation import correlated_pairs
from trackroller.methods.factor import label
from trackroller.methods.method import Estimated, Estimates
from trackroller.methods.saltelli import all_groups
from trackroller.results.index_labels import (
    RELIABLE,
    correlated,
    factor_name,
    first_order_sums,
    labelled,
    note,
    stacked,
    treatment,
)
from trackroller.results.lives_by_tests import bands
from trackroller.results.robustness import material_deviations, robustness
from trackroller.results.solved_cases import SolvedCases, made_once
from trackroller.results.targets import targets
from trackroller.roller.dataset import file_attributes
from trackroller.study.file.goals import Analysis
from trackroller.study.outputs import Output, outputs, regimes

log = logging.getLogger("trackroller")


def _of_replicates(estimates: Estimated, y: np.ndarray, design: Design) -> Estimated:
    """Replace the intervals and the course of the headline indices by those of the replicates of a
    grown sample.
    """
    method = design.method
    total = design.samples
    at = convergence.sizes(total, smallest=2 * int(design.meta["replicates"]))
    out = method.replicated(y, design, total)
    course = convergence.course(
        lambda samples: method.replicated(y, design, samples), at, out, method.narrowed
    )
    return estimates._replace(estimates=estimates.estimates | out | course, sizes=at)


@made_once
def indices_of(results: SolvedCases) -> xr.Dataset:
    """Return the sensitivity indices that a study has, or compute them by `analyse`.

    Raises
    ------
    InputError
        If no output or no factor varies.
    """
    if results.known_indices is None:
        return analyse(results)
    return results.known_indices


@made_once
def analysis_of(results: SolvedCases) -> xr.Dataset | None:
    """Return the sensitivity indices of a study; None for a study that has none."""
    try:
        indices = indices_of(results)
    except InputError as error:
        log.info("no sensitivity analysis: %s", error)
        return None
    if indices.data_vars:
        return indices
    return None


def analyse(results: SolvedCases) -> xr.Dataset:
    """Compute sensitivity indices of every output of a study and record how they were obtained.

    Parameters
    ----------
    results : SolvedCases
        A solved study. The key `analysis` of its study file says which outputs and regimes count.
        The same study gives the same indices.

    Returns
    -------
    xarray.Dataset
        Dimensions output, factor, factor_2 and sample_size. By method: S1, ST, S2 (saltelli); mu,
        mu_star, sigma (morris); main_share, interaction_share, higher_share (grid); effect,
        curvature, interaction (response surfaces); first, delta, prcc (given data). A random sample
        also has interaction_share by a polynomial that predicts `fit_share` of the variance. The
        key `groups` adds group_S1 and group_ST, and `conditional_on` conditional_S1 and
        conditional_ST of each factor within each level of a category. Indices have _low, _high and
        their course with the sample size. For each output: used_share, reliable, take_times, and
        `note`, which states the rows left out and why; first_order_sum, and first_order_sum_note,
        which explains a sum above 100 %. An inner/outer array design gives the result of
        `trackroller.results.robustness.robustness`.

    Raises
    ------
    InputError
        If no output or no factor varies.
    """
    ds = results.data
    design = results.design
    given = results.config.analysis
    if design.method.proposes:
        allowed = "a design that draws its rows evenly: a search prefers good designs"
        remedy = "Take method: saltelli, sobol or lhs for indices."
        raise InputError("method", design.method.name, allowed, remedy)
    own = material_deviations(results)
    aims = _aims(results, own)
    if design.method.points:
        return robustness(results, own).merge(aims, combine_attrs="override")
    columns = outputs(
        ds, design.factors, given.outputs, given.keep, scale=given.scale, allowed=results.allowed
    )
    if not columns or not design.factors:
        raise InputError(
            "study", list(ds.data_vars), "at least one output and one factor that varies"
        )
    by_output = []
    for number, column in enumerate(columns, 1):
        log.info("analyse output %d of %d: %s", number, len(columns), column.name)
        by_output.append(design.method.estimate(column.values, design))
        by_output[-1].estimates.pop("rows_used", None)
        if "replicates" in design.meta:
            by_output[-1] = _of_replicates(by_output[-1], column.values, design)
    result = labelled(design, columns, [one.estimates for one in by_output], by_output[0].sizes)
    result = result.merge(_of_groups_and_levels(design, columns, given))
    result = result.assign(_quality(result, design, columns, by_output))
    result = result.assign(_correlated(design))
    result = result.assign(first_order_sums(result, not design.method.observed))
    result.attrs = {
        **file_attributes("Sensitivity analysis of a study of track rollers", "analysed"),
        "method": design.method.name,
        "needs": design.method.needs,
        "rows": design.size,
        "samples": design.samples,
        "kept_regimes": ", ".join(given.keep),
        "interval": "95 %",
        "treatment": treatment(regimes(ds, results.dims), given.keep, results.allowed)
        + correlated(design),
        "study": results.study.merged(),
    }
    return result.merge(aims, combine_attrs="override")


def _of_groups_and_levels(
    design: Design, columns: Sequence[Output], settings: Analysis
) -> xr.Dataset:
    """Compute the indices of groups and within the levels of a category that a study file asks for.

    Parameters
    ----------
    design : the design
    columns : the outputs
    asked : the key `analysis` of the study file, with `groups` and `conditional_on`

    Returns
    -------
    group_S1, group_ST (output, group) and conditional_S1, conditional_ST (output, level, factor),
    each with _low and _high, and conditional_rows (output, level). Empty if the study file asks for
    neither. A grid has no interval, a random sample or a table no conditional_ST.
    """
    variables: dict[str, Any] = {}
    coords: dict[str, Any] = {}
    if settings.groups:
        groups = all_groups(settings.groups, design.factors)
        coords["group"] = np.array(list(groups), dtype=object)
        words = [
            factor_name(name) if name in design.factors else name.replace("_", " ")
            for name in groups
        ]
        coords["group_name"] = ("group", np.array(words, dtype=object))
        members = [", ".join(map(factor_name, names)) for names in groups.values()]
        coords["group_members"] = ("group", np.array(members, dtype=object))
        estimates = [
            design.method.group_indices(column.values, design, groups) for column in columns
        ]
        variables |= stacked(design.method, estimates, ("output", "group"))
    category = settings.conditional_on
    if category:
        levels = design.factors[category].levels
        coords["level"] = (
            "level",
            np.array([label(level) for level in levels], dtype=object),
            {"factor": category},
        )
        coords["factor"] = np.array(list(design.factors), dtype=object)
        estimates = [within_levels(column.values, design, category) for column in columns]
        variables |= stacked(design.method, estimates, ("output", "level", "factor"))
    return xr.Dataset(
        variables, coords | {"output": np.array([c.name for c in columns], dtype=object)}
    )


def _aims(results: SolvedCases, deviations: dict[str, np.ndarray]) -> xr.Dataset:
    """Return the probabilities of meeting the requirement, and the bands by the tests of a fit; an
    empty data set where a study asks for neither.
    """
    judged = results.judged_targets
    of_roller = np.where(results.ended_by_fatigue(), deviations.get("roller", 0.0), 0.0)
    scatter = deviations | dict.fromkeys(judged, of_roller)
    aims = xr.Dataset()
    design = results.design
    requirement = results.config.requirement
    if requirement and design.method.weighted:
        aims = targets(results.data, design, requirement, scatter, results.holds, judged)
    if results.config.analysis.material_scatter == "fitted":
        aims = aims.merge(bands(results, deviations), join="left", combine_attrs="override")
    return aims


def _correlated(design: Design) -> dict[str, Any]:
    """Return the variable that marks correlated factors; nothing if all are independent."""
    tied = {name for pair in correlated_pairs(design) for name in pair[:2]}
    if not tied:
        return {}
    marks = np.array([name in tied for name in design.factors], np.int8)
    words = {"long_name": "1 for a factor that is correlated with another factor", "units": "1"}
    return {"correlated": ("factor", marks, words)}


def within_levels(y: np.ndarray, design: Design, category: str) -> Estimates:
    """Estimate the indices of all other factors within each level of a category.

    Parameters
    ----------
    y : output, shape (n,), NaN where unusable
    design : a grid, a Saltelli design, a random sample or a table
    category : a factor with a list of values

    Returns
    -------
    conditional_S1 with _low and _high, shape (levels, k), NaN for the category itself;
    conditional_ST too from a grid and a Saltelli design; conditional_rows, the blocks, cells or
    rows of each level, shape (levels,).

    Notes
    -----
    The variance is that among the rows of the level. Valid for independent factors, as the index
    over all rows.
    """
    place = list(design.factors).index(category)
    levels = design.factors[category].levels
    code = {level: i for i, level in enumerate(levels)}
    level_of = np.array([code[value] for value in design.columns[category].tolist()])
    by_level = [
        design.method.level_indices(y, design, place, level_of == i) for i in range(len(levels))
    ]
    return {name: np.stack([part[name] for part in by_level]) for name in by_level[0]}


def _quality(
    result: xr.Dataset, design: Design, columns: list[Output], by_output: list[Estimated]
) -> dict[str, tuple[str, np.ndarray, dict[str, str]]]:
    """Return the variables that say how many rows the indices of each output use, and whether these
    suffice.
    """
    share = np.array([one.used / max(1, one.total) for one in by_output])
    notes = [
        note(column, one.used, one.total, design.method.unit)
        for column, one in zip(columns, by_output, strict=True)
    ]
    bounds = [_bounds(one.estimates, design.method) for one in by_output]
    if design.meta.get("groups"):
        bounds = list(
            zip(result["group_ST_low"].values, result["group_ST_high"].values, strict=True)
        )
    times = [convergence.take_times(*both, design.method.half_width) for both in bounds]
    half = [convergence.half_width(*both) for both in bounds]
    reliable = (share >= RELIABLE).astype(np.int8)
    of_rows = f"1 where at least {RELIABLE:g} of the rows are used"
    of_width = "half width of the widest interval (of mu*: over the largest mu*)"
    of_times = "factor on the samples after which the intervals are narrow enough"
    texts = {"long_name": "rows left out, and why"}
    return {
        "used_share": _of_outputs(share, "share of the rows that the indices use"),
        "reliable": _of_outputs(reliable, of_rows),
        "note": ("output", np.array(notes, dtype=object), texts),
        "half_width": _of_outputs(np.array(half), of_width),
        "take_times": _of_outputs(np.array(times), of_times),
    }


def _of_outputs(values: np.ndarray, words: str) -> tuple[str, np.ndarray, dict[str, str]]:
    """Return plain numbers, one for each output, as a variable."""
    return "output", values, {"long_name": words, "units": "1"}


def _bounds(out: Estimates, method: Method) -> tuple[np.ndarray, np.ndarray]:
    """Return the bounds of the indices that must be narrow, as shares of the variance or of the
    largest effect.
    """
    names = [name for name in method.judged if f"{name}_low" in out]
    if not names:
        return np.full(1, np.nan), np.full(1, np.nan)
    low, high = (
        np.concatenate([out[f"{name}_{end}"] for name in names]) for end in ("low", "high")
    )
    whole = 1.0
    if method.effects:
        whole = float(np.nanmax(out[names[0]], initial=0.0))
    if whole > 0:
        return low / whole, high / whole
    return low * np.nan, high * np.nan
