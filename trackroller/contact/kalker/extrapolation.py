"""Extrapolate forces from the grids h and 2h to elements of zero size: F = F_h + weight (F_h - F_2h)."""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.kalker import subgrid
from trackroller.contact.quantities import Elastic, Ellipse, slenderness
from trackroller.contact.slip import Creepage

# The forces converge with order 2 where the patch slides, and with order 1 where much of it sticks: the traction is
# singular at the trailing edge of full adhesion, and the displacement has a kink at the leading edge.
SLIDING, ADHESION = 1.0 / 3.0, 1.0
# Power of the mean traction over its bound in `weight`. It is high, because even a small adhesion area lowers the order
# with which the forces converge.
EARLY = 24
# Patches that are long in the rolling direction converge faster by this power of b/a, if the elements resolve
# an adhesion area, which means that more than SEEN_USED of the bound is unused.
LONG, SEEN_USED = 0.42, 1e-4
UNLIKE = 3.4  # factor on (K/mu)^2 of unlike bodies: they slide at the leading edge, where like bodies stick
FITTED, FITTED_AT, SLENDER = 0.054, 28, 0.9  # factor, elements and power of the axis ratio of `force_error`
# Least error over mu F_N with a film, on FITTED_AT elements: 1 in 100 of 220 random patches erred more. Below the given
# flexibility over that of the bodies the error fades to that without a film.
FILM_ERROR, FILM_SHARE = 0.015, 0.05
ORDER = 1.5  # with which the errors of extrapolated forces fall
SECOND_ORDER = 1.0 / 3.0  # weight of quantities of second order
FEW = 5.0  # elements in an adhesion area at which half of the change between the grids is random
# Factors of `unseen_adhesion`: share, power of b/a, range of b/a, and two spins of an element: where the elements
# begin to miss the adhesion area, and where the share that they resolve has halved.
UNSEEN, UNSEEN_POWER, RATIOS, SEEN, SMALL = 0.62, 0.8, (0.25, 3.5), 0.57, 5.0
# Terms of `pole_stress`: constant, times ln(spin), of the pressure, times |ln(b/a)|, and of unlike bodies, (K/mu)^2.
AT_POLE = 1.807, 0.174, 0.0184, 0.05, 0.13
# The least spin and b/a of patches whose elements missed a peak at the pole, among 460 designs.
RESOLVED_SPIN, LEAST_RATIO = 3.0, 0.8


def weight(used: np.ndarray, ratio: np.ndarray, coupling: np.ndarray) -> np.ndarray:
    """Return the weight of patches, (n,). Its factors were fitted to random designs.

    Parameters
    ----------
    used : mean of the tractions over their bounds, (n,). The adhesion area is not used here: it grows by whole
        elements, so that the forces would jump.
    ratio : b/a, (n,)
    coupling : K/mu, (n,); 0 for like bodies
    """
    seen = 1.0 - np.exp((used - 1.0) / SEEN_USED)
    sliding = SLIDING * np.maximum(ratio, 1.0) ** (-LONG * seen)
    return sliding + (ADHESION - sliding) * (1.0 - used**EARLY) / (1.0 + UNLIKE * coupling**2)


def unseen_adhesion(spin: np.ndarray, ratio: np.ndarray, pole: np.ndarray, elements: int) -> np.ndarray:
    """Return by how much |F_T| is too small where the adhesion area at the pole is below an element, over mu F_N (n,).

    Both grids miss this area equally, so that their difference does not show the error. The formula was fitted to
    random designs: it falls with the area of an element. It is 0 where the elements resolve the adhesion area and where
    there is no adhesion area.

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


def extrapolated(
    ellipse: Ellipse | GridPatch,
    creep: Creepage,
    friction,
    elastic: Elastic,
    solution: Any,
    value: np.ndarray,
    change: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Extrapolate the resultants `value` (n, 3) of `solution`; `change` (n, 3) came with the last halving of elements.

    `solution` is a solution or a grid of it.

    Returns
    -------
    The weight (n,) and the correction of the resultants (n, 3) [N, N, N mm].
    """
    unlike = elastic.coupling / np.where(friction > 0.0, friction, np.inf)
    share = weight(subgrid.fields_of(ellipse, solution).used, _ratio(ellipse), unlike)
    limit = share[:, None] * change
    if ellipse.is_hertzian and solution.factor.shape[1:] == (1, 1):  # the formula was fitted to constant friction
        unseen = _unseen(ellipse, creep, friction, elastic, solution.traction.shape[-1])
        unseen[elastic.film > 0.0] = 0.0  # and to bodies without a film
        limit[:, 0] += np.sign(value[:, 0]) * unseen
    return share, limit


def doubled(
    ellipse: Ellipse | GridPatch, creep: Creepage, friction, elastic: Elastic, finer: Any, coarse: Any
) -> tuple[np.ndarray, np.ndarray]:
    """Extrapolate from the solutions `coarse`, which may be extrapolated, and `finer` on twice the elements.

    Returns
    -------
    Resultants (n, 3) [N, N, N mm], and their change with the elements, (n, 3).
    """
    plain = finer.resultants.columns
    change = plain - (coarse.resultants.columns - coarse.limit[:, :3])
    _, limit = extrapolated(ellipse, creep, friction, elastic, finer, plain, change)
    return plain + limit, change


def _pole(ellipse: Ellipse | GridPatch, creep: Creepage, friction, elastic: Elastic) -> tuple[np.ndarray, np.ndarray]:
    """Return |phi| sqrt(a b) G / (mu p_max), and the distance of the spin pole from the centre over a, (n,)."""
    a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
    with np.errstate(divide="ignore", invalid="ignore"):
        spin = np.abs(creep.spin) * np.sqrt(a * b) * elastic.shear_modulus / (friction * ellipse.max_pressure)
        return spin, np.abs(creep.longitudinal / creep.spin) / a


def _unseen(ellipse, creep: Creepage, friction, elastic: Elastic, elements: int) -> np.ndarray:
    """Return the error of |F_T| by `unseen_adhesion`, (n,) [N]."""
    with np.errstate(invalid="ignore"):
        spin, pole = _pole(ellipse, creep, friction, elastic)
        share = unseen_adhesion(spin, _ratio(ellipse), pole, elements)
    known = np.isfinite(share) & (creep.lateral == 0.0)
    return np.where(known, share, 0.0) * friction * ellipse.normal_force


def pole_stress(ellipse: Ellipse, creep: Creepage, friction: np.ndarray, elastic: Elastic) -> np.ndarray:
    """Return the von Mises stress on the surface near the spin pole over p_max, (n,) [1]; 0 without a pole inside.

    The tractions turn around a small adhesion area. Their stress grows with the logarithm of the size of the patch over
    that of the area, as below a vortex of tractions. The terms were fitted to 238 random patches with resolved areas:
    the stress is within 3 % of theirs in the mean, and within 8 %. The terms of slenderness and of unlike bodies follow
    wider designs. Below a spin of `RESOLVED_SPIN`, elements resolve the area, and 0 is returned.
    """
    constant, growth, pressed, longer, unlike = AT_POLE
    spin, pole = _pole(ellipse, creep, friction, elastic)
    ratio = _ratio(ellipse)
    with np.errstate(invalid="ignore", divide="ignore"):
        bound = friction * np.sqrt(1.0 - pole * pole)
        stress = bound * (constant + growth * np.log(np.maximum(spin, 1.0))) + pressed / bound
        stress *= (1.0 + longer * np.abs(np.log(ratio))) * (1.0 + unlike * (elastic.coupling / friction) ** 2)
        hides = np.isfinite(stress) & (bound > 0.0) & (spin > RESOLVED_SPIN) & (ratio > LEAST_RATIO)
    return np.where(hides, stress, 0.0)


def error_scale(elements: int) -> float:
    """Return how the errors of forces grow from FITTED_AT to `elements` along each axis, a factor."""
    return (FITTED_AT / elements) ** ORDER


def elements_for(excess: np.ndarray, elements: int) -> np.ndarray:
    """Return how many elements along each axis make an error of `elements` smaller by the factor `excess`, (n,)."""
    return elements * np.maximum(excess, 1.0) ** (1.0 / ORDER)


def force_error(
    ellipse: Ellipse | GridPatch, friction, stick: np.ndarray, change: np.ndarray, elements: int, softness=0.0
) -> np.ndarray:
    """Return the estimated error of extrapolated friction forces, (n,) [N].

    The change from elements of twice the size alone is a poor estimate, because the coarse grid hardly resolves a small
    adhesion area. The formula was fitted to random designs; the error of 1 in 100 designs is larger; see
    `validation.benchmarks.kalker_errors`.

    Parameters
    ----------
    ellipse : patches, arrays (n,); the elements of slender patches are slender too
    friction : mu, (n,)
    stick : share of the adhesion area, (n,)
    change : of F_T, F_A (and M_R) from elements of twice the size, (n, 3) [N]
    elements : along each axis
    softness : flexibility of a film times G over b, (n,) or 0; with a film the formula alone tells too little
    """
    capacity = friction * ellipse.normal_force
    finer, largest = error_scale(elements), np.abs(change[:, :2]).max(axis=1)
    factor = FITTED * slenderness(ellipse) ** SLENDER * np.cbrt(stick + 3e-3)
    error = factor * np.sqrt(finer * capacity * (largest + 1e-3 * finer * capacity))
    return np.maximum(error, FILM_ERROR * finer * capacity * np.minimum(softness / FILM_SHARE, 1.0))


def _ratio(ellipse: Ellipse | GridPatch) -> np.ndarray:
    return ellipse.semi_axis_rolling / ellipse.semi_axis_lateral


def adhesion(fine: np.ndarray, coarse: np.ndarray, weight: np.ndarray, elements: int) -> np.ndarray:
    """Extrapolate the share of the adhesion area from two grids, (n,).

    The coarse grid resolves an area of few elements poorly, so that the change gets a smaller weight there.
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
