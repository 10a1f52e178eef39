"""Conditions on which a case needs no further work, such as `peak_stress > R_m or max_pressure > 1500`.

A condition is one comparison, or several joined by `or`, each of a result on the left with an expression over
parameters and strengths on the right. It holds for a case if it holds in any contact and body. What is known before
the stresses decides first; `peak_stress > ...` may be decided by a lower bound of the peak instead of a search for it.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from trackroller.errors import InputError, unknown_name
from trackroller.parameters import PARAMETERS, REGIMES

STRENGTHS = {"R_m": "tensile_strength", "tensile_strength": "tensile_strength", "fatigue_limit": "fatigue_limit"}
BEFORE_STRESSES = (
    "regime",
    "normal_force",
    "lateral_force",
    "driving_force",
    "spin_moment",
    "rolling_radius_shift",
    "slip",
    "drilling_torque",
    "tilting_moment",
    "yaw_moment",
    "transmitted_force",
    "semi_axis_lateral",
    "semi_axis_rolling",
    "max_pressure",
    "max_shear",
)
PEAK = "peak_stress"
_COMPARE: dict[type, Any] = {
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}
_EXAMPLE = "For example: peak_stress > R_m or max_pressure > 1500"


@dataclass(frozen=True)
class Comparison:
    """`name` compared with the value of `limit`, a text over parameters and strengths (or a regime's name)."""

    name: str
    compare: Any
    limit: str

    @property
    def by_bound(self) -> bool:
        """Decided by a lower bound of the peak stress."""
        return self.name == PEAK


@lru_cache(maxsize=64)
def parse_condition(text: str) -> tuple[Comparison, ...]:
    """The comparisons of a condition; raises `InputError` (field `stop_if`) for what is none."""
    if not isinstance(text, str) or not text.strip():
        raise InputError("stop_if", text, "a comparison of a result with a limit", _EXAMPLE)
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, RecursionError, MemoryError, ValueError):
        raise InputError("stop_if", text, "comparisons joined by 'or'", _EXAMPLE) from None
    parts = tree.values if isinstance(tree, ast.BoolOp) and isinstance(tree.op, ast.Or) else [tree]
    return tuple(_comparison(part, text) for part in parts)


def _comparison(node: ast.expr, text: str) -> Comparison:
    from trackroller.numerics.expressions import names

    if not isinstance(node, ast.Compare) or len(node.ops) != 1 or type(node.ops[0]) not in _COMPARE:
        raise InputError("stop_if", text, "comparisons (> >= < <= == !=) joined by 'or'", _EXAMPLE)
    if not isinstance(node.left, ast.Name) or node.left.id not in (*BEFORE_STRESSES, PEAK):
        raise unknown_name("stop_if: left side", ast.unparse(node.left), (*BEFORE_STRESSES, PEAK))
    name, limit = node.left.id, ast.unparse(node.comparators[0])
    if name == PEAK and not isinstance(node.ops[0], (ast.Gt, ast.GtE)):
        raise InputError("stop_if", text, "peak_stress > or >= a limit: a lower bound decides it", _EXAMPLE)
    known = (*REGIMES,) if name == "regime" else (*PARAMETERS, *STRENGTHS)
    for other in names(limit, "stop_if"):
        if other not in known:
            raise unknown_name("stop_if: right side", other, known)
    return Comparison(name, _COMPARE[type(node.ops[0])], limit)


def holds(comparison: Comparison, value: np.ndarray, table: Any) -> np.ndarray:
    """Whether a comparison holds for each case in any contact and body, shape (n,).

    Parameters
    ----------
    comparison : part of a condition
    value : of its name, shape (n,), (n, 2) contacts or (n, 2, 2) contacts and bodies; NaN never holds
    table : `CaseTable` of the n cases
    """
    from trackroller.numerics.expressions import evaluate

    n = len(table)
    names: Mapping[str, Any]
    if comparison.name == "regime":
        names = {name: float(i) for i, name in enumerate(REGIMES)}
    else:
        names = {name: getattr(table, name)[:, None, None] for name in PARAMETERS}
        for name, field in STRENGTHS.items():
            names[name] = np.stack([getattr(table.roller, field), getattr(table.guide, field)], axis=1)[:, None, :]
    limit = evaluate(comparison.limit, names, "stop_if")
    full = value.reshape(n, *value.shape[1:], *(1,) * (3 - value.ndim))
    with np.errstate(invalid="ignore"):
        true = comparison.compare(full, limit) & np.isfinite(full)
    return np.asarray(np.broadcast_to(true, np.broadcast_shapes(true.shape, (n, 1, 1))).reshape(n, -1).any(axis=1))
