"""Conditions on which a case needs no further work, such as `peak_stress > R_m or max_pressure >
1500`.

A condition is one comparison, or several comparisons joined by `or`. The left side is a result, or
the part of one in a body or contact, such as `peak_stress_roller`. The right side is an expression
over parameters and strengths. The condition holds for a case if it holds in any contact and body
that the name leaves open. Comparisons of results that are known before the stresses are evaluated
first. For `peak_stress > ...` a lower bound of the peak is compared, so that no peak has to be
searched for. This saves most of the work in wide studies, where many designs are overloaded and
their exact life is of no interest.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from trackroller.errors import InputError, check_names
from trackroller.numerics.units import without_units
from trackroller.parameters import BODIES, PARAMETERS, REGIMES
from trackroller.parameters.expressions import Relation, comparisons, condition, names
from trackroller.roller.dataset import VARIABLES
from trackroller.roller.output_names import CONTACTS, PARTS, unit_of

STRENGTHS = {
    "R_m": "tensile_strength",
    "tensile_strength": "tensile_strength",
    "fatigue_limit": "fatigue_limit",
}
# the share of adhesion is left out, because it needs the tractions
BEFORE_STRESSES = (
    "regime",
    *(
        v.name
        for v in VARIABLES.values()
        if v.group in ("forces", "contact") and v.name != "stick_area_fraction"
    ),
)
PEAK = "peak_stress"
_RESULTS = (*BEFORE_STRESSES, PEAK)
LEFT = (
    *_RESULTS,
    *(
        name
        for name, part in PARTS.items()
        if part.variable.name in _RESULTS and name not in _RESULTS
    ),
)


def compared(comparison: Relation) -> str:
    """Return the variable on the left side of a comparison."""
    if comparison.name in PARTS:
        return PARTS[comparison.name].variable.name
    return comparison.name


def stops_at(text: str | None) -> set[str]:
    """Return the variables that a condition compares; none without a condition."""
    if text is None:
        return set()
    return {compared(part) for part in parse_condition(text)}


@lru_cache(maxsize=64)
def parse_condition(text: str) -> tuple[Relation, ...]:
    """Return the comparisons of a condition.

    Parameters
    ----------
    text : str
        Value of the option `stop_if`; a number may have a unit, such as `peak_stress > 0.5 GPa`.

    Returns
    -------
    tuple of Relation
        The comparisons in the order of the text.

    Raises
    ------
    InputError
        If the text is not a condition, or a name on either side is unknown.

    Examples
    --------
    >>> [part.name for part in parse_condition("peak_stress > R_m or slip > 0.1")]
    ['peak_stress', 'slip']
    """
    parts = comparisons(without_units(text, unit_of, "stop_if"), "stop_if")
    for part in parts:
        check_names("stop_if: left side", [part.name], LEFT)
        if compared(part) == PEAK and part.symbol not in (">", ">="):
            allowed = "peak_stress > or >= a limit, because a lower bound of the peak decides"
            raise InputError("stop_if", text, allowed, "For example: peak_stress > R_m.")
        allowed_names: tuple[str, ...] = (*PARAMETERS, *STRENGTHS)
        if part.name == "regime":
            allowed_names = REGIMES
        check_names("stop_if: right side", names(part.limit, "stop_if"), allowed_names)
    return parts


def holds(comparison: Relation, value: np.ndarray, table: Any) -> np.ndarray:
    """Mark the cases for which a comparison holds in any contact and body.

    Parameters
    ----------
    comparison : Relation
        Part of a condition.
    value : numpy.ndarray, shape (n,), (n, 2) or (n, 2, 2)
        Values of the left side, by contact and body. The comparison never holds for NaN or an
        infinite value.
    table : CaseTable
        The n cases.

    Returns
    -------
    numpy.ndarray of bool, shape (n,)
        True where the comparison holds.
    """
    n = len(table)
    known: Mapping[str, Any]
    if comparison.name == "regime":
        known = {name: float(i) for i, name in enumerate(REGIMES)}
    else:
        known = {name: getattr(table, name)[:, None, None] for name in PARAMETERS}
        for name, field in STRENGTHS.items():
            known[name] = np.stack(
                [getattr(table.roller, field), getattr(table.guide, field)], axis=1
            )[:, None, :]
    full = value.reshape(n, *value.shape[1:], *(1,) * (3 - value.ndim)).astype(float)
    full = np.where(np.isfinite(full), full, np.nan)
    met = np.broadcast_to(
        condition(comparison.text, {**known, comparison.name: full}, "stop_if"), (n, 2, 2)
    )
    if comparison.name in PARTS:
        at = PARTS[comparison.name].at
        if "contact" in at:
            met = met[:, [CONTACTS.index(at["contact"])]]
        if "body" in at:
            met = met[:, :, [BODIES.index(at["body"])]]
    return np.logical_or.reduce(met.reshape(n, -1), axis=1)
