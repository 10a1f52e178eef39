"""What an accuracy setting means for each stage."""

from __future__ import annotations

from dataclasses import dataclass

from trackroller.errors import InputError, unknown_name
from trackroller.halfspace.peak import PeakSettings
from trackroller.parameters import ACCURACIES


@dataclass(frozen=True)
class Accuracy:
    """Settings of one accuracy: aimed relative error of the peak and quadrature orders of the stages.

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


PRESETS = {
    "preview": Accuracy("preview", 2e-2, 8, 6, PeakSettings(8, 8, 8, 16, 3, 1, 0.05, 2e-3), 31, 31, 20),
    "standard": Accuracy("standard", 2e-3, 12, 6, PeakSettings(6, 8, 12, 24, 5, 3, 0.015, 3e-4), 41, 61, 40),
    "reference": Accuracy("reference", 1e-4, 20, 8, PeakSettings(12, 16, 24, 48, 8, 6, 0.001, 1e-5), 81, 121, 80),
}


def accuracy_settings(accuracy: str | float) -> Accuracy:
    """Settings of a preset, or the cheapest preset that meets a relative tolerance of the peak stress.

    Raises `InputError` for unknown names and for tolerances outside (0, 1) or below what `reference` reaches.
    """
    if isinstance(accuracy, str):
        try:
            return PRESETS[accuracy]
        except KeyError:
            pass
        try:
            accuracy = float(accuracy)
        except ValueError:
            raise unknown_name("accuracy", str(accuracy), (*ACCURACIES, "a relative tolerance such as 1e-3")) from None
    if isinstance(accuracy, bool) or not 0.0 < accuracy < 1.0:
        raise InputError("accuracy", accuracy, f"one of {', '.join(ACCURACIES)} or a relative tolerance in (0, 1)")
    for preset in PRESETS.values():
        if preset.tolerance <= accuracy:
            return preset
    raise InputError("accuracy", accuracy, f"the finest tolerance is {PRESETS['reference'].tolerance:g}",
                     "Use 'reference'.")  # fmt: skip
