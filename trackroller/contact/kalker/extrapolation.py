"""Extrapolate forces from the grids h and 2h to elements of zero size: F = F_h + weight (F_h - F_2h)."""

from __future__ import annotations

import numpy as np

# The integrals between the centres converge with an order between 1 (full adhesion, with its singular trailing edge)
# and 2 (full slip, spin moment). The weight of patches that slide belongs to the order 1.58, that of adhesion to 1.
SLIDING, ADHESION = 0.5, 1.0
SECOND_ORDER = 1.0 / 3.0  # weight of quantities of second order


def weight(used: np.ndarray) -> np.ndarray:
    """Return the weight of patches, (n,), by the tractions over their bounds in the mean.

    The adhesion area, which is made of whole elements, would carry its jumps into the forces.
    """
    return SLIDING + (ADHESION - SLIDING) * (1.0 - used) ** 2


def energy(fine: np.ndarray, coarse: np.ndarray) -> np.ndarray:
    """Extrapolate the energy residual (local dissipation over work, less 1) from two grids, (n,).

    The ratio of work to dissipation converges with second order, so this ratio is extrapolated.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / (1.0 + fine)
        limit = 1.0 / (inverse + SECOND_ORDER * (inverse - 1.0 / (1.0 + coarse))) - 1.0
    return np.where(np.isfinite(limit), limit, fine)
