"""Effort of the search for the largest stress; a module without numba, which planning a study does
not need.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PeakSettings:
    """Effort of the search.

    Attributes
    ----------
    scan, climb, polish, summit : int
        Quadrature points of the four steps.
    seeds, finalists : int
        Number of seeds that climb, and of climbs that are polished.
    step : float
        Smallest step of the polish, in normalised coordinates.
    floor : float
        Scale of the part of the relative error that the changes between the steps do not show.
    """

    scan: int
    climb: int
    polish: int
    summit: int
    seeds: int
    finalists: int
    step: float
    floor: float
