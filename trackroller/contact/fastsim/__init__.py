"""Kalker's simplified theory of rolling contact (FASTSIM)."""

from __future__ import annotations

from trackroller.contact.fastsim.patch import solve_patch, tractions
from trackroller.contact.fastsim.solution import FastsimSettings, FastsimSolution

__all__ = ["FastsimSettings", "FastsimSolution", "solve_patch", "tractions"]
