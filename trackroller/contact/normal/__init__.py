"""The normal problem on the half-space: pressures of drawn or measured profiles."""

from __future__ import annotations

from trackroller.contact.normal.pressure import (
    TOLERANCE,
    NormalSolution,
    displacement,
    lift,
    solve_normal,
)

__all__ = ["TOLERANCE", "NormalSolution", "displacement", "lift", "solve_normal"]
