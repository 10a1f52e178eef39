"""Extrapolate forces from the grids h and 2h to elements of zero size: F = F_h + weight (F_h - F_2h)."""

from __future__ import annotations

import numpy as np

# The forces converge with order 2 where the patch slides, and with order 1 where much of it sticks: the traction is
# singular at the trailing edge of full adhesion, and the displacement has a kink at the leading edge.
SLIDING, ADHESION = 1.0 / 3.0, 1.0
EARLY = 16  # power of the used share of the bound: a small adhesion area decides the order already
FITTED, FITTED_AT, SLENDER = 0.077, 28, 0.6  # factor, elements and power of the axis ratio of `force_error`
SECOND_ORDER = 1.0 / 3.0  # weight of quantities of second order
FEW = 5.0  # elements in an adhesion area of which half the change between the grids is chance
# Factors of `unseen_adhesion`: share, power of b/a, range of b/a, and spins of an element at which the adhesion area
# begins to be unseen and at which its share has halved.
UNSEEN, UNSEEN_POWER, RATIOS, SEEN, SMALL = 0.62, 0.8, (0.25, 3.5), 0.57, 5.0


def weight(used: np.ndarray) -> np.ndarray:
    """Return the weight of patches, (n,), by the tractions over their bounds in the mean.

    The adhesion area, which is made of whole elements, would carry its jumps into the forces.
    """
    return SLIDING + (ADHESION - SLIDING) * (1.0 - used**EARLY)


def unseen_adhesion(spin: np.ndarray, ratio: np.ndarray, pole: np.ndarray, elements: int) -> np.ndarray:
    """Return the share of mu F_N that |F_T| lacks where the adhesion area at the pole is below an element, (n,).

    Both grids lack it alike, so that their difference does not show it. The formula was fitted to random designs: it
    falls with the area of an element, and vanishes where the elements see the adhesion area or where there is none.

    Parameters
    ----------
    spin : |phi| sqrt(a b) G / (mu p_max), (n,)
    ratio : b/a, (n,)
    pole : distance of the spin pole from the centre over a, (n,)
    elements : along each axis
    """
    of_element = np.maximum(spin / elements, 1e-9)
    share = UNSEEN * np.clip(ratio, *RATIOS) ** UNSEEN_POWER / elements**2
    inside = np.clip(10.0 * (1.0 - pole), 0.0, 1.0)
    return inside * share / (1.0 + (SEEN / of_element) ** 6) / (1.0 + of_element / SMALL)


def force_error(
    change: np.ndarray, capacity: np.ndarray, stick: np.ndarray, ratio: np.ndarray, elements: int
) -> np.ndarray:
    """Return the estimated error of extrapolated friction forces, (n,) [N].

    The change from elements of twice the size alone tells little, because the coarse grid hardly sees a small adhesion
    area. The formula was fitted to random designs, so that 1 in 100 errs by more; see
    `validation.benchmarks.force_errors`.

    Parameters
    ----------
    change : of F_T, F_A (and M_R) from elements of twice the size, (n, 3) [N]
    capacity : mu F_N, (n,) [N]
    stick : share of the adhesion area, (n,)
    ratio : b/a, (n,); the elements of slender patches are slender too
    elements : along each axis
    """
    finer, largest = (FITTED_AT / elements) ** 1.5, np.abs(change[:, :2]).max(axis=1)
    factor = FITTED * np.maximum(ratio, 1.0 / ratio) ** SLENDER * np.cbrt(stick + 3e-3)
    return factor * np.sqrt(finer * capacity * (largest + 1e-3 * finer * capacity))


def adhesion(fine: np.ndarray, coarse: np.ndarray, weight: np.ndarray, elements: int) -> np.ndarray:
    """Extrapolate the share of the adhesion area from two grids, (n,).

    The coarse grid tells little of an area of few elements, so its change counts less there.
    """
    count = 0.25 * np.pi * elements**2 * fine
    return np.clip(fine + weight * count / (count + FEW) * (fine - coarse), 0.0, 1.0)


def energy(fine: np.ndarray, coarse: np.ndarray) -> np.ndarray:
    """Extrapolate the energy residual (local dissipation over work, less 1) from two grids, (n,).

    The ratio of work to dissipation converges with second order, so this ratio is extrapolated.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1.0 / (1.0 + fine)
        limit = 1.0 / (inverse + SECOND_ORDER * (inverse - 1.0 / (1.0 + coarse))) - 1.0
    return np.where(np.isfinite(limit), limit, fine)
