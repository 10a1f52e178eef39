"""Kalker's exact theory of rolling contact: adhesion and slip areas on the elastic half-space."""

from __future__ import annotations

from trackroller.contact.kalker.patch import shares, solve_patch, to_tractions
from trackroller.contact.kalker.problem import KalkerSettings, PatchSolution
from trackroller.contact.slip import Creepage

__all__ = [
    "Creepage",
    "KalkerSettings",
    "PatchSolution",
    "shares",
    "solve_patch",
    "to_tractions",
]
