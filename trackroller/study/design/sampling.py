"""From a factor table to the rows of a design.

Every method first draws quantiles in the unit cube (SALib, scipy.stats.qmc, or a coded classical design) and
then maps them through each factor's own distribution, so all methods take all factors. Categories are mapped
honestly: equal-probability bins where the method is about probability (lhs, sobol, saltelli), random pairs of
different categories in Morris trajectories, a full crossing in response-surface designs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from trackroller.errors import InputError, nearest, unknown_name
from trackroller.numerics import expressions
from trackroller.parameters import PARAMETERS
from trackroller.study.design.draws import DRAW, MAX_ROWS, table
from trackroller.study.design.factors import Factor, parse

METHODS = (
    "grid",
    "lhs",
    "sobol",
    "morris",
    "saltelli",
    "central_composite",
    "box_behnken",
    "plackett_burman",
    "nested",
    "table",
)
OPTIONS: dict[str, dict[str, Any]] = {
    "saltelli": {"second_order": True},
    "morris": {"levels": 4},
    "table": {"table": None},
    "nested": {"inner": "lhs", "grown_from": ()},
    "lhs": {"grown_from": ()},
}


@dataclass(frozen=True)
class SampledDesign:
    """The rows of a design and what an analysis must know of it.

    Attributes
    ----------
    columns : every factor, derived ones included: name -> shape (n,), float, or object for categories
    factors : the independent factors, which indices are given for, by name
    method : one of `METHODS`
    unit : shape (n, number of factors) [1]: quantiles; coded -1..1 in classical designs; the index of the
        listed value for a listed factor of a grid, nested or Morris design
    meta : numbers that belong to the method (base_samples, second_order, levels, shape, inner_samples, ...)
    """

    columns: dict[str, np.ndarray]
    factors: dict[str, Factor]
    method: str
    unit: np.ndarray
    meta: dict[str, Any] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Number of rows."""
        return len(next(iter(self.columns.values()))) if self.columns else 0

    @property
    def places(self) -> np.ndarray:
        """As `unit`, with the index of the listed value for every listed factor of a random sample too."""
        if self.method not in ("lhs", "sobol", "saltelli"):
            return self.unit
        places = self.unit.copy()
        for j, factor in enumerate(self.factors.values()):
            if factor.discrete:
                count = len(factor.levels)
                places[:, j] = np.minimum((self.unit[:, j] * count).astype(int), count - 1)
        return places


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
    method : one of `METHODS`
    n : rows (lhs, sobol), trajectories (morris), base samples (saltelli, rounded up to a power of two; the
        rows are n (2 k + 2), or n (k + 2) without second order), samples per design point (nested); the
        other methods have their own number
    seed : the same seed gives the same design
    base : values that expressions may use besides the factors
    options : second_order (saltelli, default true), levels (morris, default 4), table (path of the CSV),
        inner (nested: lhs or sobol), grown_from (lhs, nested: earlier numbers of samples whose rows come first)

    Returns
    -------
    SampledDesign. Factors with a single value are columns but no independent factor.

    Raises
    ------
    InputError : unknown method or option, a factor the method cannot take, a value outside its bounds
    """
    settings = _settings(method, options)
    if method == "table":
        columns, free, unit, meta = table(settings["table"])
        factors = {name: spec for name, spec in factors.items() if name not in columns}
        parsed = {name: parse(name, spec) for name, spec in factors.items()}
        if left := [f.name for f in parsed.values() if f.kind != "expression"]:
            raise InputError(
                f"factors.{left[0]}",
                factors[left[0]],
                "a table has its factors as columns",
                "Only expressions may stand beside a table.",
            )
    else:
        parsed = {name: parse(name, spec) for name, spec in factors.items()}
        free = {k: f for k, f in parsed.items() if f.kind != "expression" and not _single(f)}
        if not free and method != "grid":
            raise InputError("factors", list(factors), "at least one factor must vary")
        if method not in ("grid", "central_composite", "box_behnken", "plackett_burman") and int(n) < 1:
            raise InputError("samples", n, "a whole number >= 1 is wanted")
        columns, unit, meta = DRAW[method](free, int(n), int(seed), settings)
    if columns and len(unit) > MAX_ROWS:
        raise InputError("design", method, f"at most {MAX_ROWS} rows")
    rows = len(unit)
    for name, factor in parsed.items():
        if factor.discrete and _single(factor):
            columns[name] = factor.take(np.zeros(rows, dtype=int))
    columns |= _derived(parsed, columns, dict(base or {}), rows)
    order = [*[k for k in columns if k not in parsed], *[k for k in parsed if k in columns]]
    columns = {name: columns[name] for name in order}
    _check_bounds(columns, parsed)
    return SampledDesign(columns, free, method, unit, meta | {"seed": int(seed)})


def _settings(method: str, options: Mapping[str, Any]) -> dict[str, Any]:
    if method not in METHODS:
        raise unknown_name("design", method, METHODS)
    settings: dict[str, Any] = {**OPTIONS.get(method, {})}
    for key, value in options.items():
        if key not in settings:
            close = nearest(key, settings)
            allowed = f"{method} takes " + (", ".join(settings) or "none")
            raise InputError(f"design option {key}", value, allowed, f"Did you mean '{close}'?" if close else "")
        settings[key] = value
    return settings


def _single(factor: Factor) -> bool:
    return factor.discrete and len(factor.levels) == 1


def _derived(
    parsed: Mapping[str, Factor], columns: Mapping[str, np.ndarray], base: dict[str, Any], rows: int
) -> dict[str, np.ndarray]:
    """Expressions in the order of their needs."""
    pending = {name: f.text for name, f in parsed.items() if f.kind == "expression"}
    defaults = {name: p.default for name, p in PARAMETERS.items()}
    known: dict[str, Any] = {**defaults, **base, **columns}
    for name in pending:
        known.pop(name, None)
    out: dict[str, np.ndarray] = {}
    while pending:
        ready = [n for n, text in pending.items() if not expressions.names(text) & set(pending)]
        if not ready:
            name, text = next(iter(pending.items()))
            raise InputError(
                f"factors.{name}.expression",
                text,
                "expressions must not need each other in a circle: " + ", ".join(pending),
            )
        for name in ready:
            value = expressions.evaluate(pending.pop(name), known, f"factors.{name}.expression")
            known[name] = out[name] = np.broadcast_to(value, (rows,)).copy()
            if bad := int(np.isnan(out[name]).sum()):
                raise InputError(
                    f"factors.{name}.expression",
                    parsed[name].text,
                    f"it is not a number in {bad} of {rows} rows",
                )
    return out


def _check_bounds(columns: Mapping[str, np.ndarray], parsed: Mapping[str, Factor]) -> None:
    """A distribution that reaches outside a parameter's bounds is refused before anything is solved."""
    for name, values in columns.items():
        if name not in PARAMETERS or values.dtype == object:
            continue
        good = PARAMETERS[name].accepts(values)
        if not good.all():
            kind = parsed[name].kind if name in parsed else "table"
            remedy = {
                "normal": "Cut the distribution: truncnormal: [mean, sd, low, high].",
                "expression": "Mend the expression or the ranges it draws on.",
            }.get(kind, "")
            raise InputError(
                f"factors.{name}",
                float(values[~good][0]),
                f"{PARAMETERS[name].allowed()} (outside: {int((~good).sum())} of {good.size} rows)",
                remedy,
            )
