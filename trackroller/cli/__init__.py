"""The command line: one module for each group of commands, and the functions that the workflow's scripts call."""

from __future__ import annotations

from trackroller.cli.main import main

__all__ = ["main"]
