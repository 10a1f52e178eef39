"""Kalker's simplified theory of rolling contact (FASTSIM)."""

from __future__ import annotations

from trackroller.contact.fastsim.patch import FastsimSettings, FastsimSolution, solve_patch, tractions

__all__ = ["FastsimSettings", "FastsimSolution", "solve_patch", "tractions"]
