"""Look at the intervals of a sample that grows, the key `until`, and read the looks back from a solved study."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np

from trackroller.analysis.indices import constant
from trackroller.analysis.labels import factor_name
from trackroller.analysis.replicates import HEADLINES, log_b10, replicated, share
from trackroller.analysis.robustness import material_deviations
from trackroller.analysis.table import StudyResults
from trackroller.analysis.targets import body_of, hits_of
from trackroller.parameters import REGIMES
from trackroller.study.design.levels import in_words
from trackroller.study.file.goals import statistic
from trackroller.study.outputs import outputs, regimes

UNTIL = "until"  # attribute of study.nc with the looks and the reason for stopping (JSON)


def looks_of(results: StudyResults) -> dict[str, Any] | None:
    """Return the looks at a grown sample from the attribute of its results; None for another study."""
    text = results.data.attrs.get(UNTIL)
    return json.loads(text) if isinstance(text, str) else None


def look(results: StudyResults) -> dict[str, Any]:
    """Return the widest interval of each output of `until`.

    Parameters
    ----------
    results : StudyResults
        The solved step.

    Returns
    -------
    dict
        `cases`, and by output `half_width` (None: no interval yet) and `at`, the factor or design point with the widest
        interval; `constant` names outputs that do not vary, so that they have no index.
    """
    design, until = results.design, results.config.until
    assert until is not None
    widths: dict[str, list[tuple[str, float]]]
    seen: dict[str, Any] = {"cases": design.size, "half_width": {}, "at": {}, "constant": []}
    if design.method == "inner_outer":
        widths = {name: _of_points(results, name) for name in until.of}
    else:
        given = results.config.analysis
        columns = outputs(
            results.data, design.factors, until.of, given.keep, scale=given.scale, allowed=results.allowed
        )
        columns = columns[: len(until.of)]  # indicators of regimes follow
        widths = {column.name: _of_indices(column.values, results) for column in columns}
        seen["constant"] = [column.name for column in columns if constant(column.values)]
    for name, named in widths.items():
        place, width = max(named, key=lambda item: math.inf if math.isnan(item[1]) else item[1])
        seen["half_width"][name] = width if math.isfinite(width) else None
        seen["at"][name] = place
    return seen


def _of_indices(y: np.ndarray, results: StudyResults) -> list[tuple[str, float]]:
    """Return the half widths of the headline indices of an output by factor; those of mu* over the output's range."""
    design = results.design
    found = replicated(y, design, results.config.samples)
    scale = float(np.nanmax(y) - np.nanmin(y)) if design.method == "morris" and not constant(y) else 1.0
    return [
        (factor_name(factor), float(half))
        for name in HEADLINES[design.method]
        for factor, half in zip(design.factors, (found[f"{name}_high"] - found[name]) / scale, strict=True)
    ]


def _of_points(results: StudyResults, name: str) -> list[tuple[str, float]]:
    """Return the half widths of log10 B10 or of a probability by design point."""
    design = results.design
    shape, copies = (design.meta["design_points"], design.meta["inner_samples"]), int(design.meta["replicates"])
    member, (kind, output) = np.arange(shape[1]) % copies, statistic(name)
    own = material_deviations(results)
    if output in REGIMES:
        hits = (regimes(results.data, results.dims) == REGIMES.index(output)).astype(float)
    else:
        column = outputs(
            results.data, design.factors, [output], scale="natural", unlimited=True, allowed=results.allowed
        )[0]
        scatter = own.get(body_of(output), np.zeros(design.size))
        if kind != "probability":
            lives = zip(column.values.reshape(shape), scatter.reshape(shape), strict=True)
            halves = [log_b10(*one, member, copies)[1] for one in lives]
            return list(zip(_point_names(results), halves, strict=True))
        hits = hits_of(column, results.config.analysis.target[output], own.get(body_of(output)))
    return [
        (point, share(row, member, copies)[1])
        for point, row in zip(_point_names(results), hits.reshape(shape), strict=True)
    ]


def _point_names(results: StudyResults) -> list[str]:
    design = results.design
    first, outer = np.arange(design.meta["design_points"]) * design.meta["inner_samples"], design.meta["outer"]
    rows = [[in_words(name, design.columns[name][row]) for name in outer] for row in first]
    return [", ".join(row) or "all" for row in rows]
