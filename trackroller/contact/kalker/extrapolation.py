"""From two grids h and 2h to the limit of ever smaller elements: F = F_h + weight (F_h - F_2h)."""

from __future__ import annotations

import numpy as np

from trackroller.contact.common import Elastic, Ellipse

# The observed order is near 2 in sliding and 1 in full stick, so that the weight lies between 1/3 and 1.
SECOND_ORDER = 1.0 / 3.0
SLIDING_WEIGHT = 0.5  # grows with the stick fraction f as 0.5 (1 + f^2)
# About the point where the rigid slip vanishes lies a small stick area, of radius REACH mu p/(G phi) by observation.
# While it has fewer than RESOLVED elements, the driving force is of first order; beyond, a weight of 1 overshoots by
# some per cent of the little force there is in free rolling. Full stick is of first order again.
REACH, RESOLVED = 0.3, 3.0

# In a slender patch the traction turns about the spin pole within a length of about b. Where that has fewer than SEEN
# elements across of the coarser grid, its forces depend on where the pole lies between these; the finer grid is then
# nearer to the limit than any extrapolation (b/a 0.05 to 0.4). A pole in the middle, as in free rolling, is harmless.
SEEN, BLIND = 4.5, 2.5


def _unseen(ellipse: Ellipse, creep, elements: int, pressure: np.ndarray) -> np.ndarray:
    """From 0 to 1: does the coarser grid not see how the traction turns about the spin pole? Shape (n,)."""
    across = 4.0 * ellipse.semi_axis_lateral / elements
    few = np.clip((SEEN - ellipse.semi_axis_rolling / across) / (SEEN - BLIND), 0.0, 1.0)
    off = np.minimum(np.abs(creep.longitudinal / creep.spin) / across, 1.0)
    unseen = few**2 * (3.0 - 2.0 * few) * off**2 * (3.0 - 2.0 * off) * np.minimum(2.0 * pressure, 1.0)
    return np.where(np.isfinite(unseen), unseen, 0.0)


def energy(fine: np.ndarray, coarse: np.ndarray) -> np.ndarray:
    """Local dissipation over the work, less 1, from that on both grids: of second order in work over dissipation."""
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / (1.0 + fine)
        limit = 1.0 / (inverse + SECOND_ORDER * (inverse - 1.0 / (1.0 + coarse))) - 1.0
    return np.where(np.isfinite(limit), limit, fine)


def weights(ellipse: Ellipse, creep, friction, elastic: Elastic, elements: int, stick_fraction) -> np.ndarray:
    """Weights of F_T, F_A and M_R, shape (n, 3).

    Smooth in loads and slips, so that the extrapolated forces are, and have a balance. Arguments as of `solve_patch`,
    with the creepage at the middle of the patch; `elements` along each axis of the finer grid.
    """
    plain = SLIDING_WEIGHT * (1.0 + stick_fraction**2)
    a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
    with np.errstate(all="ignore"):
        place = (creep.longitudinal / (creep.spin * a)) ** 2 + (creep.lateral / (creep.spin * b)) ** 2
        pressure = np.sqrt(np.clip(1.0 - place, 0.0, None))  # there, over the largest; 0 if it lies outside
        radius = REACH * friction * ellipse.max_pressure * pressure / (elastic.shear_modulus * np.abs(creep.spin))
        resolved = np.pi * radius**2 * elements**2 / (4.0 * a * b) / RESOLVED
        first_order = pressure / (1.0 + resolved**2)
        seen = 1.0 - _unseen(ellipse, creep, elements, pressure)
    first_order = np.maximum(np.where(np.isfinite(first_order), first_order, 0.0), stick_fraction**2)
    driving = SECOND_ORDER + (1.0 - SECOND_ORDER) * first_order
    return np.stack([plain, driving, plain], axis=1) * seen[:, None]
