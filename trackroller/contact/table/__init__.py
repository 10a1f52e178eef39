"""A table of dimensionless results of the exact theory, as splines."""

from __future__ import annotations

from trackroller.contact.table.coordinates import RATIOS
from trackroller.contact.table.spline import (
    TableSolution,
    nearest_forces,
    solve_patch,
    stored,
)

__all__ = ["RATIOS", "TableSolution", "nearest_forces", "solve_patch", "stored"]
