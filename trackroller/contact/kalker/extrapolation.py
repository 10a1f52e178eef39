"""Extrapolate forces from the grids h and 2h to elements of zero size: F = F_h + weight (F_h - F_2h)."""

from __future__ import annotations

import numpy as np

from trackroller.contact.common import Elastic, Ellipse

# The observed order is about 2 in full sliding and 1 in full adhesion, so the weight lies between 1/3 and 1.
SECOND_ORDER = 1.0 / 3.0
SLIDING_WEIGHT = 0.5  # The weight grows with the stick fraction f as 0.5 (1 + f^2).
# A small adhesion area lies around the point where the rigid slip vanishes. Its observed radius is REACH mu p/(G phi).
# While this area has fewer than RESOLVED elements, the error of the driving force is of first order. With more
# elements, a weight of 1 would overshoot the small force of free rolling by a few per cent. In full adhesion the error
# is of first order again.
REACH, RESOLVED = 0.3, 3.0

# In a slender patch the traction changes its direction around the spin pole within a length of about b. If this length
# has fewer than SEEN elements of the coarser grid across, the forces depend on the place of the pole between the
# elements. The finer grid is then closer to the limit than any extrapolation (b/a from 0.05 to 0.4). A pole in the
# middle of the patch, as in free rolling, does no harm.
SEEN, BLIND = 4.5, 2.5


def _unseen(ellipse: Ellipse, creep, elements: int, pressure: np.ndarray) -> np.ndarray:
    """Return how poorly the coarser grid resolves the traction around the spin pole, 0 (well) to 1 (not), (n,)."""
    across = 4.0 * ellipse.semi_axis_lateral / elements
    few = np.clip((SEEN - ellipse.semi_axis_rolling / across) / (SEEN - BLIND), 0.0, 1.0)
    off = np.minimum(np.abs(creep.longitudinal / creep.spin) / across, 1.0)
    unseen = few**2 * (3.0 - 2.0 * few) * off**2 * (3.0 - 2.0 * off) * np.minimum(2.0 * pressure, 1.0)
    return np.where(np.isfinite(unseen), unseen, 0.0)


def energy(fine: np.ndarray, coarse: np.ndarray) -> np.ndarray:
    """Extrapolate the energy residual (local dissipation over work, less 1) from two grids, (n,).

    The ratio of work to dissipation converges with second order, so this ratio is extrapolated.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / (1.0 + fine)
        limit = 1.0 / (inverse + SECOND_ORDER * (inverse - 1.0 / (1.0 + coarse))) - 1.0
    return np.where(np.isfinite(limit), limit, fine)


def weights(ellipse: Ellipse, creep, friction, elastic: Elastic, elements: int, stick_fraction) -> np.ndarray:
    """Return the extrapolation weights of F_T, F_A and M_R.

    The weights are smooth functions of loads and creepages, so the extrapolated forces are smooth as well and the
    equilibrium of the roller has a solution.

    Parameters
    ----------
    ellipse, creep, friction, elastic
        See `kalker.solve_patch`; `creep` is the creepage at the middle of each patch.
    elements : int
        Elements along each axis of the finer grid.
    stick_fraction : ndarray, shape (n,)
        Share of the adhesion area on the finer grid [1].

    Returns
    -------
    ndarray, shape (n, 3)
        Weights [1].
    """
    plain = SLIDING_WEIGHT * (1.0 + stick_fraction**2)
    a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
    with np.errstate(all="ignore"):
        place = (creep.longitudinal / (creep.spin * a)) ** 2 + (creep.lateral / (creep.spin * b)) ** 2
        pressure = np.sqrt(np.clip(1.0 - place, 0.0, None))  # pressure at the spin pole over p_max; 0 outside the patch
        radius = REACH * friction * ellipse.max_pressure * pressure / (elastic.shear_modulus * np.abs(creep.spin))
        resolved = np.pi * radius**2 * elements**2 / (4.0 * a * b) / RESOLVED
        first_order = pressure / (1.0 + resolved**2)
        seen = 1.0 - _unseen(ellipse, creep, elements, pressure)
    first_order = np.maximum(np.where(np.isfinite(first_order), first_order, 0.0), stick_fraction**2)
    driving = SECOND_ORDER + (1.0 - SECOND_ORDER) * first_order
    return np.stack([plain, driving, plain], axis=1) * seen[:, None]
