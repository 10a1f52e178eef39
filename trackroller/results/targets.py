"""Probability that a design meets the key `requirement`, at each design point and at each level of
a factor.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy import stats

from trackroller.methods import Design
from trackroller.methods.correlation import correlated_pairs
from trackroller.methods.factor import Factor
from trackroller.methods.probability import probabilities
from trackroller.results.factor_levels import MOST_LEVELS
from trackroller.results.life_columns import FIRST_LIMIT
from trackroller.roller.output_names import body_of, is_life
from trackroller.roller.requirement import Requirement
from trackroller.study.design.levels import in_words
from trackroller.study.outputs import Output, outputs

CLASSES = 4  # of a number with more than `MOST_LEVELS` levels
ENDS = ("", "_low", "_high")
# probability and its bounds, shape (targets,) each
Estimates = tuple[np.ndarray, np.ndarray, np.ndarray]


class Level(NamedTuple):
    """The rows of one level of a factor, or of one class of its values.

    Attributes
    ----------
    factor : name of the factor
    low, high : smallest and largest value of the factor in these rows; NaN if its values are texts
    text : the level or class in words
    rows : mask of the rows, shape (n,)
    """

    factor: str
    low: float
    high: float
    text: str
    rows: np.ndarray


def targets(
    ds: xr.Dataset,
    design: Design,
    requirement: Mapping[str, Requirement],
    deviations: Mapping[str, np.ndarray],
    allowed: np.ndarray | None = None,
    judged: Mapping[str, np.ndarray] = MappingProxyType({}),
) -> xr.Dataset:
    """Estimate the probability of meeting each target, and of meeting all.

    Parameters
    ----------
    ds : gathered study
    design : its design
    wanted : what is required by output
    deviations : body, or target -> standard deviation of log10 life of its material [1], shape
        (n,), see `material_deviations`
    allowed : cases that count, such as the valid ones, shape (n,)
    judged : life to the first limit by the targets that it judges, see
        `SolvedCases.judged_targets`, shape (n,) each

    Returns
    -------
    Dimension `target` (with `all` for several targets). `target_probability` (target, point) of an
    inner/outer design, else (target,) of all cases; `level_probability` (target, target_level).
    Both with _low and _high (95 %), NaN in a grid or a table, whose rows are no sample. A case that
    does not roll, is not allowed or has no value misses each target.

    Notes
    -----
    At a level of the outer array the probability is the mean over its design points. Their common
    sample counts once. If these have different numbers of samples, the bounds are the means of
    their bounds.
    """
    columns = outputs(
        ds, design.factors, list(requirement), scale="natural", unlimited=True, allowed=allowed
    )
    columns = [_judged(c, judged[c.name], allowed) if c.name in judged else c for c in columns]
    hits = np.stack(
        [
            hits_of(
                c,
                requirement[c.name],
                deviations.get(c.name, deviations.get(scattering_body(c.name))),
            )
            for c in columns
        ],
        axis=1,
    )
    names = [c.name for c in columns]
    if len(names) > 1:
        hits = np.column_stack([hits, _all(hits, names)])
        names = [*names, "all"]
    robust = design.method.points
    dims: tuple[str, ...]
    if robust:
        dims = ("target", "point")
        levels, estimates = _of_points(hits, design)
    else:
        dims = ("target",)
        levels, estimates = _of_rows(hits, design)
    out = xr.Dataset(coords=_coordinates(names, columns, requirement, levels))
    for end, whole in zip(ENDS, estimates[0], strict=True):
        out[f"target_probability{end}"] = (dims, whole, {"units": "1"})
    for end, part in zip(ENDS, zip(*estimates[1:], strict=True), strict=False):
        out[f"level_probability{end}"] = (
            ("target", "target_level"),
            np.stack(part, axis=1),
            {"units": "1"},
        )
    return out


def _judged(column: Output, life: np.ndarray, allowed: np.ndarray | None) -> Output:
    """Return the life to the first limit in the place of the life that a target names."""
    if allowed is None:
        values = life
    else:
        values = np.where(allowed, life, np.nan)
    return replace(column, values=values, long_name=FIRST_LIMIT[1])


def scattering_body(output: str) -> str:
    """Return the body whose material's scatter counts for a life, '' for another output."""
    if is_life(output):
        return body_of(output) or "roller"
    return ""


def hits_of(column: Output, limits: Requirement, deviation: np.ndarray | None) -> np.ndarray:
    """Return the probability that each case meets a target, shape (n,): 0 or 1 where the material
    has no scatter.
    """
    values = column.values
    met = limits.meets(values).astype(float)
    if deviation is None or not (deviation > 0).any():
        return met
    above_least = _share_above(values, limits.least, deviation)
    above_most = _share_above(values, limits.most, deviation)
    return np.where(np.isnan(values), 0.0, np.where(deviation > 0, above_least - above_most, met))


def _share_above(lives: np.ndarray, limit: float, deviation: np.ndarray) -> np.ndarray:
    """Return the share of the lives of a material above a limit, by the median life and the
    scatter, shape (n,).
    """
    if np.isinf(limit):
        share = 0.0
        if limit < 0:
            share = 1.0
        return np.full(len(lives), share)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(stats.norm.cdf(np.log10(lives / limit) / np.maximum(deviation, 1e-9)))


def _all(hits: np.ndarray, names: list[str]) -> np.ndarray:
    """Return the probability that a case meets all targets, shape (n,).

    ASSUME: the materials of roller and guide scatter independently of each other.
    """
    bodies = np.array([scattering_body(name) for name in names])
    return np.asarray(
        np.prod([hits[:, bodies == body].min(axis=1) for body in dict.fromkeys(bodies)], axis=0)
    )


def _of_points(hits: np.ndarray, design: Design) -> tuple[list[Level], list[Estimates]]:
    """Return the levels of the outer factors, and the probabilities at all points and at each
    level.
    """
    first = [rows.start for rows in design.points]
    outer = [name for name in design.meta["outer"] if len(design.meta["outer"]) > 1]
    levels = [
        level
        for name in outer
        for level in _levels(design.factors[name], design.columns[name][first])
    ]
    p, low, high = whole = at_points(hits, design)
    return levels, [
        (p.T, low.T, high.T),
        *(_at_level(hits, design, level, whole) for level in levels),
    ]


def at_points(hits: np.ndarray, design: Design) -> Estimates:
    """Return the probability of events and its bounds at each design point of an inner/outer array.

    Parameters
    ----------
    hits : share of each event at each case, 0 to 1, shape (n, m)
    design : the design

    Returns
    -------
    Probability, lower and upper bound [1], each of shape (points, m).
    """
    sizes = np.array([rows.stop - rows.start for rows in design.points])
    sample = inner_sample(design)
    bounds = np.empty((3, len(sizes), hits.shape[1]))
    for size in np.unique(sizes):
        own = np.flatnonzero(sizes == size)
        cube = np.stack([hits[design.points[point]] for point in own], axis=1)
        parts = probabilities(cube.reshape(size, -1), *_first(sample, size))
        bounds[:, own] = [part.reshape(len(own), -1) for part in parts]
    return bounds[0], bounds[1], bounds[2]


def _at_level(hits: np.ndarray, design: Design, level: Level, whole: Estimates) -> Estimates:
    """Return the mean probability of the design points of a level and its bounds.

    Points with different numbers of samples get the mean of their bounds, which is wide enough for
    any correlation.
    """
    own = [rows for rows, chosen in zip(design.points, level.rows, strict=True) if chosen]
    sizes = {rows.stop - rows.start for rows in own}
    if len(sizes) > 1:
        p, low, high = (part[level.rows].mean(axis=0) for part in whole)
        return p, low, high
    return probabilities(
        np.mean([hits[rows] for rows in own], axis=0), *_first(inner_sample(design), sizes.pop())
    )


def _first(sample: tuple[np.ndarray, ...], size: int) -> tuple[np.ndarray, ...]:
    """Return the first rows of the sample of `inner_sample`."""
    if sample:
        return sample[0][:size], sample[1]
    return ()


def _of_rows(hits: np.ndarray, design: Design) -> tuple[list[Level], list[Estimates]]:
    """Return the levels of the factors, and the probabilities over all rows and at each level."""
    rows = design.method.independent_rows(design)
    levels = [
        level
        for name, f in design.factors.items()
        for level in _levels(f, design.columns[name][rows])
    ]
    hits = hits[rows]
    if correlated_pairs(design):
        estimates = [probabilities(hits)]
    else:
        estimates = [probabilities(hits, design.places[rows], design.ordered)]
    estimates += [probabilities(hits[level.rows]) for level in levels]
    if not design.method.sampled:  # shares of such rows are no probabilities
        estimates = [(p, np.full_like(p, np.nan), np.full_like(p, np.nan)) for p, _, _ in estimates]
    return levels, estimates


def inner_sample(design: Design) -> tuple[np.ndarray, np.ndarray] | tuple[()]:
    """Return the inner sample of an inner/outer design; nothing if its factors are correlated and
    so not stratified.

    Returns
    -------
    Quantiles (of a list: index of its value), shape (samples, inner factors), and which of them are
    ordered.
    """
    if correlated_pairs(design):
        return ()
    names = list(design.factors)
    chosen = [names.index(name) for name in design.meta["inner"]]
    longest = max(design.points, key=lambda rows: rows.stop - rows.start)
    return design.places[longest, chosen], design.ordered[chosen]


def _levels(factor: Factor, values: np.ndarray) -> Iterator[Level]:
    """Yield the levels of a factor, or classes with equally many rows of a number that has more
    than `MOST_LEVELS`.
    """
    if not factor.numeric:
        texts = np.array([in_words(factor.name, value) for value in values])
        for text in dict.fromkeys(texts.tolist()):
            yield Level(factor.name, np.nan, np.nan, text, texts == text)
        return
    kinds, index = np.unique(values, return_inverse=True)
    if len(kinds) > MOST_LEVELS:
        index = ((stats.rankdata(values, "min") - 1) * CLASSES / len(values)).astype(int)
    for k in np.unique(index):
        own = values[index == k]
        yield Level(factor.name, float(own.min()), float(own.max()), "", index == k)


def _finite(limits: list[float]) -> np.ndarray:
    """Return limits with NaN in place of an infinite one, which asks for nothing."""
    numbers = np.array(limits, dtype=float)
    return np.where(np.isinf(numbers), np.nan, numbers)


def _coordinates(
    names: list[str],
    columns: list[Output],
    requirement: Mapping[str, Requirement],
    levels: list[Level],
) -> dict[str, Any]:
    words = [c.long_name for c in columns]
    units = [c.units for c in columns]
    if len(names) > len(columns):
        words.append("all targets")
        units.append("1")
    limits = [requirement.get(name, Requirement()) for name in names]
    return {
        "target": np.array(names, dtype=str),
        "target_name": ("target", np.array(words, dtype=str)),
        "target_units": ("target", np.array(units, dtype=str)),
        "target_min": ("target", _finite([limit.least for limit in limits])),
        "target_max": ("target", _finite([limit.most for limit in limits])),
        **{
            f"level_{key}": (
                "target_level",
                np.array([getattr(level, key) for level in levels], dtype=kind),
            )
            for key, kind in (("factor", str), ("low", float), ("high", float), ("text", str))
        },
        "level_rows": ("target_level", np.array([level.rows.sum() for level in levels], dtype=int)),
    }
