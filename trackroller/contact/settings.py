"""The discretisation of each stage, as an accuracy asks for it."""

from __future__ import annotations

from dataclasses import dataclass

from trackroller.halfspace.peak import PeakSettings


@dataclass(frozen=True)
class Accuracy:
    """Settings of one accuracy: promised relative error of the peak and discretisation of the stages.

    `force_nodes` are Gauss points per smooth piece of the slip integrals, `coarse_nodes` serve the first pass, and
    `elements` along each axis of the ellipse serve the rolling contact models.
    """

    name: str
    tolerance: float
    force_nodes: int
    coarse_nodes: int
    peak: PeakSettings
    traction_points: int
    section_points: int
    elements: int
    grid_elements: int = 0  # of FASTSIM and of patches whose pressure is solved; 0: as many as `elements`

    @property
    def on_grids(self) -> int:
        """Return the elements of models that do not interpolate between their elements."""
        return self.grid_elements or self.elements
