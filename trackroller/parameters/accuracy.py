"""Declare what the option `accuracy` allows: three rungs with the settings of every stage, and tolerances.

A rung is one accuracy with a name. A tolerance is met case by case: `roller.tolerance` walks the rungs, and a case
takes the result of the first rung whose estimated errors are within the tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from trackroller.errors import InputError
from trackroller.halfspace.peak_settings import PeakSettings


@dataclass(frozen=True)
class Accuracy:
    """Settings of each stage of a solution.

    Parameters
    ----------
    name : str
        Name of the rung.
    peak_error : float
        Relative error of the peak stress of full sliding that 99 % of the measured designs keep.
    force_nodes, coarse_nodes : int
        Gauss points in each smooth piece of the slip integrals, finally and in the first pass.
    peak : PeakSettings
        Search of the peak stress.
    traction_points, section_points : int
        Points along each axis of the stored tractions and stress sections.
    elements : int
        Elements along each axis of the patch for the rolling contact models. They double where the estimated error of
        a patch is large.
    grid_elements : int
        Elements of patches whose pressure is solved; 0: as many as `elements`.
    peak_elements : int
        Elements of the tractions from which a model finds the peak stress; 0: as many as `elements`.
    """

    name: str
    peak_error: float
    force_nodes: int
    coarse_nodes: int
    peak: PeakSettings
    traction_points: int
    section_points: int
    elements: int
    grid_elements: int = 0
    peak_elements: int = 0

    @property
    def on_grids(self) -> int:
        """Return the elements of models that do not interpolate between their elements."""
        return self.grid_elements or self.elements


# The quadratures and searches are the cheapest measured ones that kept the forces of full sliding within 5e-3, 2e-5 and
# 1e-7, and its peaks within 2e-2, 4e-3 and 3e-4, in 99 % of 1024 designs. The numbers of elements double from rung to
# rung; docs/validation/tradeoff.md states the errors of the rungs.
PRESETS: dict[str, Accuracy] = {
    own.name: own
    for own in (
        Accuracy("preview", 2e-2, 8, 6, PeakSettings(6, 6, 8, 16, 3, 1, 0.05, 2e-3), 31, 31, 12, 20),
        Accuracy("standard", 4e-3, 12, 6, PeakSettings(6, 8, 12, 24, 5, 3, 0.015, 3e-4), 41, 61, 28, 40),
        Accuracy("reference", 3e-4, 20, 6, PeakSettings(12, 16, 24, 48, 12, 8, 0.002, 4e-5), 81, 121, 56, 80),
    )
}
RUNGS = tuple(PRESETS)


def settings_of(rung: str, rough_peaks: bool) -> Accuracy:
    """Return the settings of a rung; with `rough_peaks` those of the peak are of the next coarser rung.

    `ModelDeclaration.rough_peaks` says why.
    """
    own = PRESETS[rung]
    coarser = PRESETS[RUNGS[max(RUNGS.index(rung) - 1, 0)]]
    if rough_peaks:
        return replace(own, peak=coarser.peak, peak_elements=coarser.elements)
    return own


# Smallest tolerance of each quantity: most designs keep these, and no rung keeps much smaller ones.
SMALLEST = {"forces": 1e-3, "peak": 0.01, "life": 0.1}
QUANTITIES = tuple(SMALLEST)
USUAL_EXPONENT = 10.0  # of S-N curves, to expect the cost of a tolerance of the life
PEAK_OUTPUTS = frozenset(("peak_stress", "life", "subsurface"))  # groups for which peaks are searched


@dataclass(frozen=True)
class Tolerance:
    """Relative errors that a case may have; infinite where nothing is asked.

    Parameters
    ----------
    forces : float
        Of F_N and friction work, relative to themselves, of F_T and F_A over mu F_N, and of M_R over mu F_N sqrt(a b).
    peak, life : float
        Of the peak stress and the life, relative to themselves.
    """

    forces: float = math.inf
    peak: float = math.inf
    life: float = math.inf

    @classmethod
    def read(cls, value: float | Mapping[str, float], outputs: Iterable[str]) -> Tolerance:
        """Return the tolerances that a user asks for; a number holds for forces and, if they are computed, for peaks.

        Raises
        ------
        InputError
            If a tolerance is smaller than `SMALLEST`, or belongs to a quantity that is not computed.
        """
        peaks = bool(PEAK_OUTPUTS & set(outputs))
        if isinstance(value, Mapping):
            tolerances = dict(value)
        elif peaks:
            tolerances = {"forces": value, "peak": value}
        else:
            tolerances = {"forces": value}
        for name, tolerance in tolerances.items():
            if tolerance < SMALLEST[name]:
                best = ", ".join(f"{key}: {max(SMALLEST[key], number):g}" for key, number in tolerances.items())
                allowed = f"{SMALLEST[name]:g} or more for {name}, which the finest rung keeps in most cases"
                raise InputError("accuracy", value, allowed, f"Write accuracy: {{{best}}}, or take 'reference'.")
        extra = [name for name in ("peak", "life") if name in tolerances]
        if extra and not peaks:
            remedy = f"Leave {extra[0]} out, or add peak_stress or life to outputs."
            raise InputError("accuracy", extra[0], "a tolerance of a quantity that is computed", remedy)
        return cls(**tolerances)

    @property
    def by_quantity(self) -> dict[str, float]:
        """Return the tolerances of forces and of peaks, as far as asked; a life takes a tenth, by a usual exponent."""
        tolerances = {"forces": self.forces, "peak": min(self.peak, self.life / USUAL_EXPONENT)}
        return {name: tolerance for name, tolerance in tolerances.items() if math.isfinite(tolerance)}


def tolerance_of(accuracy: Any, outputs: Iterable[str]) -> Tolerance | None:
    """Return the tolerances that a checked accuracy asks for, None for a rung and for settings."""
    if isinstance(accuracy, (str, Accuracy)):
        return None
    return Tolerance.read(accuracy, outputs)
