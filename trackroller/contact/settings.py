"""Settings that one accuracy gives to each stage of a solution."""

from __future__ import annotations

from dataclasses import dataclass

from trackroller.halfspace.peak import PeakSettings


@dataclass(frozen=True)
class Accuracy:
    """Settings of one accuracy.

    Parameters
    ----------
    name : str
        Name of the accuracy.
    tolerance : float
        Promised relative error of the peak stress [1].
    force_nodes, coarse_nodes : int
        Gauss points in each smooth piece of the slip integrals, finally and in the first pass.
    peak : PeakSettings
        Search of the peak stress.
    traction_points, section_points : int
        Points along each axis of the stored tractions and stress sections.
    elements : int
        Elements along each axis of the patch for the rolling contact models.
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
