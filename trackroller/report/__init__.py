"""The report of a study: one HTML file that can be sent."""

from __future__ import annotations

from trackroller.report.page import write_report

__all__ = ["write_report"]
