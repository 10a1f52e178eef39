"""From the factors of a study to the rows of a design.

Every method first draws quantiles in the unit cube (SALib, scipy.stats.qmc) or a classical design in coded units.
It then maps them through the distribution of each factor, so that every method takes every factor. The values of a
list are equally likely in random samples (lhs, sobol, saltelli), unless they have weights. In Morris trajectories they
are random pairs of different values, and in response-surface designs they are crossed with all other rows.
"""

from __future__ import annotations

import graphlib
import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from trackroller.errors import InputError, check_names, unknown_name
from trackroller.parameters import PARAMETERS, expressions
from trackroller.study.design.draws import DRAW, MAX_ROWS, table
from trackroller.study.design.factors import TAIL, Factor, parse
from trackroller.study.design.kinds import DESIGNS, those_that_take, those_with


def is_random(factor: Factor, method: str) -> bool:
    """Return whether a design draws the values of a factor at random."""
    return DESIGNS[method].weighs or (method == "inner_outer" and factor.scatter)


def values_at(factor: Factor, places: np.ndarray, method: str) -> np.ndarray:
    """Return the values of a factor at its places in a design, a column of `SampledDesign.unit`, shape (n,)."""
    coded = DESIGNS[method].coded
    if factor.discrete and method != "plackett_burman" and not is_random(factor, method):
        return factor.take(places)
    tail = TAIL if coded or method == "morris" else 0.0
    return factor.from_unit((places + 1) / 2 if coded else places, tail)


@dataclass(frozen=True)
class SampledDesign:
    """The rows of a design and the facts that an analysis needs.

    Parameters
    ----------
    columns : every factor, derived ones included: name -> shape (n,), float, or object for categories
    factors : the independent factors by name; indices are given for them
    method : one of `DESIGNS`
    unit : shape (n, number of factors) [1]: quantiles; codes -1..1 in classical designs; the index of the
        listed value for a list in a grid, an inner/outer array or a Morris design
    meta : numbers of the method (base_samples, second_order, levels, shape, inner_samples, ...)
    """

    columns: dict[str, np.ndarray]
    factors: dict[str, Factor]
    method: str
    unit: np.ndarray
    meta: dict[str, Any] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Return the number of rows."""
        return len(next(iter(self.columns.values()))) if self.columns else 0

    @property
    def places(self) -> np.ndarray:
        """Return `unit` with the index of the listed value for every list, also in random samples."""
        places = self.unit.copy()
        for j, factor in enumerate(self.factors.values()):
            if factor.discrete and is_random(factor, self.method):
                places[:, j] = factor.bin(self.unit[:, j])
        return places

    @property
    def ordered(self) -> np.ndarray:
        """Return for which factors more and less mean something, shape (number of factors,)."""
        return np.array([f.ordered for f in self.factors.values()], dtype=bool)

    @property
    def listed(self) -> np.ndarray:
        """Return which factors enter `unit` as list indices, shape (number of factors,)."""
        values = [f.discrete and self.method != "plackett_burman" for f in self.factors.values()]
        return np.array(values, dtype=bool)

    @property
    def samples(self) -> int:
        """Return the number of base samples, trajectories, samples of the largest design point, or rows."""
        counts = (self.meta[key] for key in ("base_samples", "trajectories", "inner_samples") if key in self.meta)
        return int(next(counts, self.size))

    @property
    def points(self) -> list[slice]:
        """Return the rows of each design point of an inner/outer array."""
        sizes = self.meta.get("point_samples") or [self.meta["inner_samples"]] * self.meta["design_points"]
        return [slice(end - size, end) for size, end in zip(sizes, itertools.accumulate(sizes), strict=True)]

    def blocks(self, values: np.ndarray) -> np.ndarray:
        """Return the values (n,) of a Saltelli design by base sample, shape (base samples, rows of a base sample).

        The first row of a base sample is its row of A, and the last one its row of B.
        """
        return values.reshape(int(self.meta["base_samples"]), -1)


def sample(
    factors: Mapping[str, Any],
    method: str,
    n: int,
    seed: int,
    *,
    base: Mapping[str, Any] | None = None,
    **options: Any,
) -> SampledDesign:
    """Draw a design.

    Parameters
    ----------
    factors : name -> dictionary as described in `trackroller.study.design.factors`
    method : one of `DESIGNS`
    n : rows (lhs, sobol), trajectories (morris), base samples (saltelli, rounded up to a power of two; the design has
        n (2 k + 2) rows, or n (k + 2) without second order), samples per design point (inner_outer). The other
        methods have their own number
    seed : the same seed gives the same design
    base : values that expressions may use besides the factors
    options : second_order (saltelli, default true), groups (saltelli: groups of factors whose columns are exchanged
        together; the design has n (2 g + 2) or n (g + 2) rows for g groups, single factors included), levels (morris,
        default 4), table (path of the CSV), inner (inner_outer: sobol, the default, or lhs), point_samples
        (inner_outer: samples of each design point),
        rank_correlations (lhs, sobol, inner_outer: see `trackroller.study.design.correlation`), conditions and
        population (optimise: factors that are no choices, and designs of the first generation), table (optimise: CSV
        of the genes of the designs instead), replicates (independent samples of n / replicates each, which
        take turns: sample i belongs to replicate i % replicates)

    Returns
    -------
    SampledDesign. Factors with a single value are columns but not independent factors.

    Raises
    ------
    InputError : unknown method or option, a factor the method cannot take, a value outside its bounds
    """
    settings = _settings(method, options)
    if method == "table":
        used = {name for spec in factors.values() for name in expressions.names(spec.get("expression", "0"))}
        columns, free, unit = table(settings["table"], used)
        meta: dict[str, Any] = {}
        parsed = {name: parse(name, spec) for name, spec in factors.items() if name not in columns}
        for name in (name for name, factor in parsed.items() if factor.kind != "expression"):
            allowed = "a table has its factors as columns"
            raise InputError(f"factors.{name}", factors[name], allowed, "Only expressions may stand beside a table.")
    else:
        parsed = {name: parse(name, spec) for name, spec in factors.items()}
        free = {k: f for k, f in parsed.items() if f.varies}
        if not free and method != "grid":
            raise InputError("factors", list(factors), "at least one factor must vary")
        _check_weights(free, method)
        if not DESIGNS[method].array and int(n) < 1:
            raise InputError("samples", n, "a whole number >= 1")
        unit, meta = DRAW[method](free, int(n), int(seed), settings)
        columns = {name: values_at(f, unit[:, j], method) for j, (name, f) in enumerate(free.items())}
    rows = len(unit)
    if rows > MAX_ROWS:
        raise InputError("design", method, f"at most {MAX_ROWS} rows")
    for name, factor in parsed.items():
        if len(factor.levels) == 1:
            columns[name] = factor.take(np.zeros(rows, dtype=int))
    columns |= _derived(parsed, columns, dict(base or {}), rows)
    order = [*[k for k in columns if k not in parsed], *[k for k in parsed if k in columns]]
    columns = {name: columns[name] for name in order}
    _check_bounds(columns, parsed)
    if settings.get("replicates", 1) > 1:
        meta["replicates"] = settings["replicates"]
    return SampledDesign(columns, free, method, unit, meta | {"seed": int(seed)})


def _settings(method: str, options: Mapping[str, Any]) -> dict[str, Any]:
    check_names("design", [method], DESIGNS)
    settings = DESIGNS[method].takes
    for key in options.keys() - settings.keys():
        if having := those_that_take(key):
            raise InputError(key, options[key], f"an option of design {' and '.join(having)}", "Remove the key.")
        raise unknown_name("design option", key, settings)
    return {**settings, **options}


def _check_weights(free: Mapping[str, Factor], method: str) -> None:
    """Refuse weights in a design that does not draw the values of a list at random."""
    drawing, outer = those_with("weighs"), method == "inner_outer"
    for name, factor in free.items():
        if factor.weights and not is_random(factor, method):
            where = "the outer array of inner_outer" if outer else f"design {method}"
            known = f"a design that draws values at random ({', '.join(drawing)})"
            remedy = f"Remove the weights, or {'add scatter: true' if outer else f'choose design {drawing[0]}'}."
            allowed = f"{known}; {where} takes each value equally often"
            raise InputError(f"factors.{name}.weights", list(factor.weights), allowed, remedy)


def _derived(
    parsed: Mapping[str, Factor], columns: Mapping[str, np.ndarray], base: dict[str, Any], rows: int
) -> dict[str, np.ndarray]:
    """Evaluate the expressions, each after the expressions that it needs."""
    texts = {name: f.text for name, f in parsed.items() if f.kind == "expression"}
    defaults = {name: p.default for name, p in PARAMETERS.items()}
    known = {name: value for name, value in {**defaults, **base, **columns}.items() if name not in texts}
    needs = graphlib.TopologicalSorter({name: expressions.names(text) & {*texts} for name, text in texts.items()})
    out: dict[str, np.ndarray] = {}
    try:
        order = list(needs.static_order())
    except graphlib.CycleError as exc:
        name, *circle = exc.args[1]
        allowed = "expressions must not need each other in a circle: " + ", ".join(circle)
        raise InputError(f"factors.{name}.expression", texts[name], allowed) from None
    for name in order:
        value = expressions.evaluate(texts[name], known, f"factors.{name}.expression")
        known[name] = out[name] = np.broadcast_to(value, (rows,)).copy()
        if bad := int(np.isnan(out[name]).sum()):
            allowed = f"it is not a number in {bad} of {rows} rows"
            raise InputError(f"factors.{name}.expression", texts[name], allowed)
    return out


def _check_bounds(columns: Mapping[str, np.ndarray], parsed: Mapping[str, Factor]) -> None:
    """Refuse a distribution that reaches outside a parameter's bounds before anything is solved."""
    remedies = {
        "normal": "Cut the distribution: truncnormal: [mean, sd, low, high].",
        "expression": "Change the expression or the ranges of its factors.",
    }
    for name, values in columns.items():
        if name not in PARAMETERS or values.dtype == object:
            continue
        good = PARAMETERS[name].accepts(values)
        if not good.all():
            kind = parsed[name].kind if name in parsed else "table"
            allowed = f"{PARAMETERS[name].allowed()} (outside: {int((~good).sum())} of {good.size} rows)"
            raise InputError(f"factors.{name}", float(values[~good][0]), allowed, remedies.get(kind, ""))
