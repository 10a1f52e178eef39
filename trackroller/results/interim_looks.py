"""Look at the intervals of a sample that grows, the key `until`, and read the looks back from a
solved study.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from trackroller.methods.b10 import log_b10, share
from trackroller.methods.intervals import constant
from trackroller.parameters import REGIMES
from trackroller.results.index_labels import factor_name
from trackroller.results.robustness import material_deviations
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.targets import hits_of, scattering_body
from trackroller.study.design.levels import in_words
from trackroller.study.file.goals import statistic
from trackroller.study.outputs import Output, outputs, regimes

UNTIL = "until"  # attribute of study.nc with the looks and the reason for stopping (JSON)


def looks_of(results: SolvedCases) -> dict[str, Any] | None:
    """Return the looks at a grown sample from the attribute of its results; None for another
    study.
    """
    text = results.data.attrs.get(UNTIL)
    if not isinstance(text, str):
        return None
    looks: dict[str, Any] = json.loads(text)
    return looks


def look(results: SolvedCases) -> dict[str, Any]:
    """Return the widest interval of each output of `until`.

    Parameters
    ----------
    results : SolvedCases
        The solved step.

    Returns
    -------
    dict
        `cases`, and by output `half_width` (None: no interval yet) and `at`, the factor or design
        point with the widest interval; `constant` names outputs that do not vary, so that they have
        no index, and `empty` those without a valid case. `decided` counts the design points whose
        share is clear of the share that a requirement wants: their interval counts as 0. `unsure`
        numbers the design points with a wider interval than wanted (inner_outer).
    """
    design = results.design
    until = results.config.until
    assert until is not None
    record: dict[str, Any] = {
        "cases": design.size,
        "half_width": {},
        "at": {},
        "constant": [],
        "empty": [],
        "decided": {},
    }
    names = _names(results)
    unsure = np.zeros(len(names), dtype=bool)
    inside = results.inside.any() or results.config.analysis.keep != ("rolling",)
    for name in until.of:
        if design.method.points:
            values, widths = _of_points(results, name)
        else:
            values, widths = _of_indices(results, name)
        if np.isnan(values).all() or not (inside or statistic(name)[1] in REGIMES):
            record["empty"].append(name)
            widths[:] = np.inf
        elif not design.method.points and constant(values):
            record["constant"].append(name)
        widths = np.where(np.isnan(widths), np.inf, widths).reshape(-1, len(names)).max(axis=0)
        if design.method.points:
            decided = _decided(results, name, widths)
            record["decided"][name] = int(decided.sum())
            widths = np.where(decided, 0.0, widths)
        widest = int(widths.argmax())
        unsure = unsure | (widths > until.half_width)
        record["half_width"][name] = None
        if np.isfinite(widths[widest]):
            record["half_width"][name] = float(widths[widest])
        record["at"][name] = names[widest]
    if design.method.points:
        record["unsure"] = np.flatnonzero(unsure).tolist()
    return record


def _of_indices(results: SolvedCases, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return an output (n,) and the half widths of its headline indices; those of effects over the
    output's range.
    """
    design = results.design
    given = results.config.analysis
    y = outputs(
        results.data, design.factors, [name], given.keep, scale=given.scale, allowed=results.allowed
    )[0].values
    estimates = design.method.replicated(y, design, design.samples)
    scale = 1.0
    if design.method.effects and not constant(y):
        scale = float(np.nanmax(y) - np.nanmin(y))
    widths = [estimates[f"{index}_high"] - estimates[index] for index in design.method.narrowed]
    return y, np.concatenate(widths) / scale


def _of_points(results: SolvedCases, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the values (n,) and, by design point, the half width of log10 B10 or of a probability.

    It is 0 at a point without a value in any case: more cases would not decide there.
    """
    design, (kind, output), own = results.design, statistic(name), material_deviations(results)
    copies = int(design.meta["replicates"])
    points = design.points
    if output in REGIMES:
        values = hits = (regimes(results.data, results.dims) == REGIMES.index(output)).astype(float)
    else:
        column = _natural_output(results, output)
        values = results.with_breaks(column)
        scatter = own.get(scattering_body(output))
        if kind != "probability":
            if scatter is None:
                scatter = np.zeros(design.size)
            halves = [
                log_b10(values[r], scatter[r], np.arange(r.stop - r.start) % copies, copies)[1]
                for r in points
            ]
            return values, np.where([np.isnan(values[rows]).all() for rows in points], 0.0, halves)
        hits = hits_of(column, results.config.requirement[output], scatter)
    return values, _shares(results, hits)[1]


def _natural_output(results: SolvedCases, name: str) -> Output:
    """Return an output in its own scale over all cases, (n,)."""
    return outputs(
        results.data,
        results.design.factors,
        [name],
        unlimited=True,
        scale="natural",
        allowed=results.allowed,
    )[0]


def _shares(results: SolvedCases, hits: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the share of hits at each design point and the half width of its interval, shape
    (points,) each.
    """
    copies = int(results.design.meta["replicates"])
    points = results.design.points
    ends = [
        share(hits[rows], np.arange(rows.stop - rows.start) % copies, copies) for rows in points
    ]
    shares, widths = np.array(ends, dtype=float).T
    return shares, widths


def _decided(results: SolvedCases, name: str, widths: np.ndarray) -> np.ndarray:
    """Return the design points whose share is clear of the share that a requirement wants, shape
    (points,) bool.

    More cases would not change whether they meet it.
    """
    kind, output = statistic(name)
    own = results.config.requirement.get(output)
    if kind != "probability" or own is None or not own.in_shares:
        return np.zeros(len(widths), dtype=bool)
    column = _natural_output(results, output)
    scatter = material_deviations(results).get(scattering_body(output))
    shares = _shares(results, hits_of(column, own, scatter))[0]
    return np.asarray(np.abs(shares - own.probability) > widths)


def _names(results: SolvedCases) -> list[str]:
    """Return the factors, or the design points of an inner/outer design, in words."""
    design = results.design
    if not design.method.points:
        return list(map(factor_name, design.factors))
    named = [
        [in_words(n, design.columns[n][rows.start]) for n in design.meta["outer"]]
        for rows in design.points
    ]
    return [", ".join(row) or "all" for row in named]
