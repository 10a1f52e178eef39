"""From the factors of a study to the rows of a design.

A method of `trackroller.methods` first draws places: quantiles in the unit cube, codes of a
classical design, or indices of listed values. The places are then mapped through the distribution
of each factor, so that every method takes every factor. The values of a list are equally likely in
random samples (lhs, sobol, saltelli), unless they have weights. In Morris trajectories they are
random pairs of different values, and in response-surface designs they are crossed with all other
rows.
"""

from __future__ import annotations

import graphlib
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.errors import Collector, InputError, check_names, unknown_name
from trackroller.methods import METHODS, Design, those_that_take, those_with
from trackroller.methods.factor import Factor, parse, readable
from trackroller.methods.grid import MAX_ROWS
from trackroller.methods.table import of_columns
from trackroller.parameters import PARAMETERS, expressions
from trackroller.study.design.read_table import genes, table, table_lines


def sample(
    factors: Mapping[str, Any],
    method: str,
    n: int,
    seed: int,
    *,
    base: Mapping[str, Any] | None = None,
    used: Collection[str] = (),
    **options: Any,
) -> Design:
    """Draw a design.

    Parameters
    ----------
    factors : name -> dictionary as described in `trackroller.methods.factor`
    method : one of `METHODS`
    n : rows (lhs, sobol), trajectories (morris), base samples (saltelli, rounded up to a power of
        two; the design has n (2 k + 2) rows, or n (k + 2) without second order), samples per design
        point (inner_outer). The other methods have their own number
    seed : the same seed gives the same design
    base : values that expressions may use besides the factors
    used : names that constraints use, which may be further columns of a table
    options : second_order (saltelli, default true), groups (saltelli: groups of factors whose
        columns are exchanged together; the design has n (2 g + 2) or n (g + 2) rows for g groups,
        single factors included), levels (morris, default 4), table (path of the CSV), inner
        (inner_outer: sobol, the default, or lhs), point_samples (inner_outer: samples of each
        design point), rank_correlations (lhs, sobol, inner_outer: see
        `trackroller.methods.correlation`), conditions and population (optimise: factors that are no
        choices, and designs of the first generation), table (optimise: CSV of the genes of the
        designs instead), replicates (independent samples of n / replicates each, which take turns:
        sample i belongs to replicate i % replicates)

    Returns
    -------
    Design. Factors with a single value are columns but not independent factors.

    Raises
    ------
    InputError : unknown method or option, a factor the method cannot take, a value outside its
        bounds
    """
    settings = _settings(method, options)
    drawn_by = METHODS[method]
    columns: dict[str, np.ndarray] = {}
    if drawn_by.observed:
        columns = table(settings["table"], {*_in_expressions(factors), *used})
    parsed = {name: parse(name, spec) for name, spec in factors.items()}
    meta: dict[str, Any] = {}
    if drawn_by.observed:
        free, unit = of_columns(columns)
        _check_beside_table(parsed, columns, settings["table"])
    else:
        free = {name: factor for name, factor in parsed.items() if factor.varies}
        if not free and not drawn_by.crossed:
            raise InputError("factors", list(factors), "at least one factor that varies")
        _check_weights(free, method)
        if drawn_by.sampled and int(n) < 1:
            raise InputError("samples", n, "a whole number >= 1")
        if drawn_by.proposes and settings["table"] is not None:
            settings["genes"] = genes(settings["table"])
        unit, meta = drawn_by.draw(free, int(n), int(seed), settings)
        columns = {name: drawn_by.values(f, unit[:, j]) for j, (name, f) in enumerate(free.items())}
    if len(unit) > MAX_ROWS:
        raise InputError("method", method, f"at most {MAX_ROWS} rows")
    columns = _with_computed(columns, parsed, dict(base or {}), len(unit))
    _check_bounds(columns, parsed)
    if settings.get("replicates", 1) > 1:
        meta["replicates"] = settings["replicates"]
    return Design(columns, free, drawn_by, unit, meta | {"seed": int(seed)})


def _in_expressions(factors: Mapping[str, Any]) -> set[str]:
    """Return the names that the expressions of factors use."""
    texts = [spec.get("expression", "0") for spec in factors.values()]
    return {name for text in texts for name in expressions.names(text)}


def _check_beside_table(
    parsed: Mapping[str, Factor], columns: Mapping[str, np.ndarray], path: str
) -> None:
    """Refuse factors that stand beside a table in vain, and names of rows that a shelf has not.

    Parameters
    ----------
    parsed : all factors: expressions, and shelves of which a column of the table names rows
    columns : columns of the table by name, shape (n,)
    path : the table
    """
    wrong = Collector()
    for name, factor in parsed.items():
        field = f"factors.{name}"
        if factor.beside and name in columns:
            wrong.errors += _unknown_rows(factor, columns[name], path)
            for twice in {*factor.beside} & {*columns}:
                remedy = "Remove it from the table, or from the shelf."
                wrong.errors.append(
                    InputError(f"column {twice}", None, "one value", remedy, f"is in {field} too")
                )
        elif factor.beside:
            remedy = f"Add a column {name} to the table, with names of its rows."
            allowed = "a shelf whose rows a column of the table names"
            wrong.errors.append(InputError(field, None, allowed, remedy))
        elif name in columns:
            remedy = f"Remove it, or the column {name} of the table."
            wrong.errors.append(
                InputError(field, None, "one description", remedy, "is a column of the table too")
            )
        elif factor.kind != "expression":
            allowed = "factors as columns of the table"
            remedy = "Only expressions and shelves may stand beside a table."
            wrong.errors.append(InputError(field, factor.levels, allowed, remedy))
    wrong.check()


def _unknown_rows(factor: Factor, levels: np.ndarray, path: str) -> list[InputError]:
    """Return an error for each case of a table that names no row of a shelf."""
    known = {str(level) for level in factor.levels}
    places = [place for place, level in enumerate(levels.tolist()) if level not in known]
    if not places:
        return []
    lines = table_lines(Path(path))
    return [
        unknown_name(factor.name, levels[place], sorted(known)).at(Path(path), lines[place])
        for place in places
    ]


def _with_computed(
    columns: Mapping[str, np.ndarray], parsed: Mapping[str, Factor], base: dict[str, Any], rows: int
) -> dict[str, np.ndarray]:
    """Return drawn columns with those of single levels, of shelves and of expressions.

    Columns of a table and of shelves come first, then the factors in their order.
    """
    whole = dict(columns)
    for name, factor in parsed.items():
        if len(factor.levels) == 1:
            whole[name] = factor.take(np.zeros(rows, dtype=int))
    whole |= columns_of_rows(parsed, whole)
    whole |= _derived(parsed, whole, base, rows)
    beside = [name for name in whole if name not in parsed]
    return {name: whole[name] for name in (*beside, *(name for name in parsed if name in whole))}


def columns_of_rows(
    parsed: Mapping[str, Factor], columns: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return the columns of all factors that are `rows`, shape (n,) each.

    Parameters
    ----------
    parsed : all factors
    columns : their levels, shape (n,)
    """
    out: dict[str, np.ndarray] = {}
    for name, factor in parsed.items():
        if factor.beside and name in columns:
            out |= factor.columns_at(columns[name])
    return out


def _settings(method: str, options: Mapping[str, Any]) -> dict[str, Any]:
    check_names("method", [method], METHODS)
    settings = METHODS[method].defaults
    for key in options.keys() - settings.keys():
        having = those_that_take(key)
        if having:
            raise InputError(
                key, options[key], f"an option of design {' and '.join(having)}", "Remove the key."
            )
        raise unknown_name("design option", key, settings)
    return {**settings, **options}


def _check_weights(free: Mapping[str, Factor], method: str) -> None:
    """Refuse weights in a design that does not draw the values of a list at random."""
    drawing = those_with("weighs")
    outer = METHODS[method].points
    for name, factor in free.items():
        if factor.weights and not METHODS[method].random(factor):
            where = f"design {method}"
            remedy = f"Remove the weights, or choose method: {drawing[0]}."
            if outer:
                where = f"the outer array of {method}"
                remedy = "Remove the weights, or add scatter: true."
            random = f"a design that draws values at random ({', '.join(drawing)})"
            allowed = f"{random}; {where} takes each value equally often"
            raise InputError(f"factors.{name}.weights", list(factor.weights), allowed, remedy)


def _derived(
    parsed: Mapping[str, Factor], columns: Mapping[str, np.ndarray], base: dict[str, Any], rows: int
) -> dict[str, np.ndarray]:
    """Evaluate the expressions, each after the expressions that it needs."""
    texts = {name: f.text for name, f in parsed.items() if f.kind == "expression"}
    defaults = {name: p.default for name, p in PARAMETERS.items()}
    known = {
        name: _compared(value)
        for name, value in {**defaults, **base, **columns}.items()
        if name not in texts
    }
    needs = graphlib.TopologicalSorter(
        {name: expressions.names(text) & {*texts} for name, text in texts.items()}
    )
    out: dict[str, np.ndarray] = {}
    try:
        order = list(needs.static_order())
    except graphlib.CycleError as exc:
        name, *circle = exc.args[1]
        allowed = "expressions that do not need each other in a circle: " + ", ".join(circle)
        raise InputError(f"factors.{name}.expression", texts[name], allowed) from None
    for name in order:
        value = expressions.evaluate(texts[name], known, f"factors.{name}.expression")
        known[name] = out[name] = np.broadcast_to(value, (rows,)).copy()
        bad = int(np.isnan(out[name]).sum())
        if bad:
            wrong = f"is not a number in {bad} of {rows} rows"
            raise InputError(
                f"factors.{name}.expression", texts[name], "a number in each row", wrong=wrong
            )
    return out


def _compared(value: Any) -> Any:
    """Return a column for expressions, in which a pair of materials is the text 'roller /
    guide'.
    """
    pairs = (
        isinstance(value, np.ndarray)
        and value.dtype == object
        and any(isinstance(v, tuple) for v in value)
    )
    return readable(value) if pairs else value


def _check_bounds(columns: Mapping[str, np.ndarray], parsed: Mapping[str, Factor]) -> None:
    """Refuse a distribution that reaches outside a parameter's bounds before anything is solved."""
    remedies = {
        "normal": "Cut the distribution: truncnormal: [mean, sd, low, high].",
        "lognormal": "Take another median, or a smaller standard deviation of the logarithm.",
        "weibull": "Take another scale, or a larger shape.",
        "expression": "Change the expression or the ranges of its factors.",
    }
    for name, values in columns.items():
        if name not in PARAMETERS or values.dtype == object:
            continue
        good = PARAMETERS[name].accepts(values)
        if not good.all():
            kind = parsed[name].kind if name in parsed else "table"
            wrong = f"lies outside, as {int((~good).sum())} of {good.size} rows do"
            allowed = PARAMETERS[name].allowed()
            raise InputError(
                f"factors.{name}", float(values[~good][0]), allowed, remedies.get(kind, ""), wrong
            )
