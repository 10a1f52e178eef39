"""Equilibrium of the roller: normal forces, rolling radius shift and regime, for any contact
model.
"""

from __future__ import annotations

from trackroller.roller.equilibrium.roller import ContactLaw, RollerLoads
from trackroller.roller.equilibrium.solution import (
    FAILED,
    FULL_SLIP,
    LIFT_OFF,
    ROLLING,
    Equilibrium,
    solve_equilibrium,
)

__all__ = [
    "FAILED",
    "FULL_SLIP",
    "LIFT_OFF",
    "ROLLING",
    "ContactLaw",
    "Equilibrium",
    "RollerLoads",
    "solve_equilibrium",
]
