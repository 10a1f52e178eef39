"""Tractions between the centres of elements.

Neither the traction nor its direction is smooth where slip turns into stick or about the spin pole.
The vector z = tau/(mu p) - k s with k > 0 is smooth. The law of dry friction gives the traction
from it: tau = mu p P(z), where P shortens a vector to at most length 1. Cubic splines therefore
interpolate z, and the law is applied at each point. With k from the slip that an element's own
traction causes, a stick area smaller than an element has about its true size.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from trackroller.contact.kalker.cells import cells
from trackroller.contact.quantities import filled
from trackroller.numerics.compiled import compiled
from trackroller.numerics.splines import interpolated

PARTS = 3  # points along each side of an element
POINTS = 2**15  # between elements that are held at once: these stay in the fast caches
RIM = 0.2  # smallest divisor of slips over the largest traction bound


def smooth(
    traction: np.ndarray, slip: np.ndarray, bound: np.ndarray, height: np.ndarray, own
) -> np.ndarray:
    """Return z of elements with tractions, slips, traction bounds, pressures over the largest, and
    own slips.
    """
    return traction / np.where(bound > 0.0, bound, 1.0) - slip / (own * np.maximum(height, RIM))


def _filled(z: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Return fields z (n, 2, m, m) with the values of the nearest loaded element outside the
    patches.
    """
    if height.ndim == 2:
        return filled(z, height)
    return np.array([filled(z[i : i + 1], own)[0] for i, own in enumerate(height)]).reshape(z.shape)


@compiled
def _shorten(z):
    """Shorten the vectors of a field (2, ny, nx) to at most length 1, in place."""
    for i in range(z.shape[1]):
        for j in range(z.shape[2]):
            square = z[0, i, j] ** 2 + z[1, i, j] ** 2
            if square > 1.0:
                z[0, i, j] /= np.sqrt(square)
                z[1, i, j] /= np.sqrt(square)


class Fields(NamedTuple):
    """Solution of n patches of m x m elements.

    Attributes
    ----------
    height : (m, m) or (n, m, m)
        Mean pressure of each element over the largest of the patch.
    traction, slip : (n, 2, m, m)
        Tractions over mu p_max, and slips.
    own_slip : (n,)
        Slip that the traction mu p_max of an element causes at itself.
    factor : (n, m, m) or (n, 1, 1)
        Friction over its value at rest.
    """

    height: np.ndarray
    traction: np.ndarray
    slip: np.ndarray
    own_slip: np.ndarray
    factor: np.ndarray

    @property
    def heights(self) -> np.ndarray:
        """Return the pressures with an axis for each of traction's, (1, m, m) or (n, 1, m, m)."""
        return self.height[None] if self.height.ndim == 2 else self.height[:, None]

    @property
    def used(self) -> np.ndarray:
        """Return the tractions over their bounds in the mean, 0 (small creepages) to 1 (full slip),
        (n,).
        """
        total = (self.heights * self.factor[:, None]).sum(axis=(1, 2, 3))
        return np.minimum(
            np.hypot(self.traction[:, 0], self.traction[:, 1]).sum(axis=(1, 2)) / total, 1.0
        )

    def before_law(self) -> np.ndarray:
        """Return z = tau/(mu p) - k s of the elements (n, 2, m, m), outside the patches that of the
        nearest inside.
        """
        bound, own = self.heights * self.factor[:, None], self.own_slip[:, None, None, None]
        return _filled(smooth(self.traction, self.slip, bound, self.heights, own), self.height)

    def pieces(self, parts: float) -> Iterator[tuple[slice, Fields]]:
        """Return pieces of the patches that have about POINTS points with `parts` times the
        elements.
        """
        n, _, _, m = self.traction.shape
        size = max(int(POINTS / (parts * m) ** 2), 1)
        for i in range(0, max(n, 1), size):
            rows = slice(i, i + size)
            height = self.height if self.height.ndim == 2 else self.height[rows]
            yield rows, Fields(height, *(field[rows] for field in self[1:]))

    def finer_factor(self, parts: float) -> np.ndarray:
        """Return the factor of the friction on `parts` times the elements, (n, 1, ., .)."""
        if self.factor.shape[1:] == (1, 1):
            return self.factor[:, None]
        low, high = (
            reduce(self.factor, axis=(1, 2))[:, None, None, None] for reduce in (np.min, np.max)
        )
        return np.clip(
            interpolated(_filled(self.factor[:, None], self.height), parts, parts), low, high
        )


def fields_of(patch: Any, solution: Any) -> Fields:
    """Return the fields of a solution, or of one grid of it, on n patches."""
    height, _ = cells(patch, solution.traction.shape[-1])
    return Fields(height, solution.traction, solution.slip, solution.own_slip, solution.factor)


def shares(fields: Fields, parts: float = PARTS) -> np.ndarray:
    """Return the traction over mu p at rest on `parts` times the elements, (n, 2, parts m, parts
    m).
    """
    return np.concatenate(
        [_between(some.before_law(), some, parts) for _, some in fields.pieces(parts)]
    )


def both_shares(fields: Fields, parts: int = PARTS) -> tuple[np.ndarray, np.ndarray]:
    """Return `shares`, and those of elements of twice the size whose z is the mean of four, (n, 2,
    ., .) each.

    Both have single precision, as the search for peaks takes them.
    """
    n, _, _, m = fields.traction.shape
    fine, coarse = (
        np.empty((n, 2, parts * size, parts * size), np.float32) for size in (m, m // 2)
    )
    for rows, some in fields.pieces(parts):
        z, factor = some.before_law(), some.factor
        if factor.shape[1:] != (1, 1):
            factor = _of_four(factor)
        twice = some._replace(height=_of_four(some.height), factor=factor)
        fine[rows], coarse[rows] = _between(z, some, parts), _between(_of_four(z), twice, parts)
    return fine, coarse


def _of_four(field: np.ndarray) -> np.ndarray:
    """Return the means (..., m/2, m/2) of 2 x 2 elements of a field (..., m, m)."""
    m = field.shape[-1] // 2
    return field.reshape(*field.shape[:-2], m, 2, m, 2).mean(axis=(-3, -1))


def _between(z: np.ndarray, fields: Fields, parts: float) -> np.ndarray:
    """Interpolate z (n, 2, m, m) to `parts` times the elements and apply the law of friction of the
    fields.
    """
    return _by_law(interpolated(z, parts, parts), fields, parts)


def bounded(fine: np.ndarray) -> np.ndarray:
    """Shorten z (n, 2, ny, nx) to the traction over its bound, in place."""
    for field in fine:
        _shorten(field)
    return fine


def _by_law(fine: np.ndarray, fields: Fields, parts: float) -> np.ndarray:
    """Turn z on `parts` times the elements into the traction over mu p at rest, in place."""
    return np.multiply(bounded(fine), fields.finer_factor(parts), out=fine)


@compiled
def _sum(traction, a, b, out):
    """Add up F_T, F_A and M_R of tractions (2, ny, nx) on one patch."""
    ny, nx = traction.shape[1:]
    for i in range(ny):
        y = b * ((2.0 * i + 1.0) / ny - 1.0)
        for j in range(nx):
            x = a * ((2.0 * j + 1.0) / nx - 1.0)
            out[0] += traction[0, i, j]
            out[1] += traction[1, i, j]
            out[2] += x * traction[1, i, j] - y * traction[0, i, j]
    for k in range(3):
        out[k] *= 4.0 * a * b / (nx * ny)


@compiled
def _adhesion(z, share):
    """Return the part of a patch where z (2, ny, nx) is shorter than 1; `share` (ny, nx) is the
    part of each element.

    |z|^2 is taken as linear within an element, with the slopes to its neighbours, so that the
    boundary may cross it.
    """
    _, ny, nx = z.shape
    excess = z[0] ** 2 + z[1] ** 2 - 1.0
    sticking = 0.0
    for i in range(ny):
        for j in range(nx):
            along = excess[min(i + 1, ny - 1), j] - excess[max(i - 1, 0), j]
            across = excess[i, min(j + 1, nx - 1)] - excess[i, max(j - 1, 0)]
            steep = 0.5 * (abs(along) + abs(across)) + 1e-12
            sticking += share[i, j] * min(max(0.5 - excess[i, j] / steep, 0.0), 1.0)
    return sticking / share.sum()


def integrals(
    fields: Fields, finer: tuple[np.ndarray, np.ndarray], a: np.ndarray, b: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return F_T, F_A and M_R over mu p_max, (n, 3), and the share of the adhesion area, (n,).

    `finer` are the mean pressure over the largest, and the share inside the patch, of PARTS times
    the elements, each (., .) or (n, ., .); a, b (n,) are the half sides of the patches [mm]. In
    full adhesion the traction is singular at the trailing edge, which an element's mean contains
    and a smooth field does not. The weight of the elements' own tractions therefore grows as less
    of the bound is used.
    """
    height, share = (np.broadcast_to(v, (len(a), *v.shape[-2:])) for v in finer)
    adhesion, smooth, plain = np.empty(len(a)), np.zeros((len(a), 3)), np.zeros((len(a), 3))
    for rows, some in fields.pieces(PARTS):
        fine = interpolated(some.before_law(), PARTS, PARTS)
        adhesion[rows] = [_adhesion(z, own) for z, own in zip(fine, share[rows], strict=True)]
        between = _by_law(fine, some, PARTS)
        between *= height[rows, None]
        for i, own in enumerate(between, rows.start):
            _sum(own, a[i], b[i], smooth[i])
            _sum(fields.traction[i], a[i], b[i], plain[i])
    return smooth + (1.0 - fields.used[:, None]) ** 2 * (plain - smooth), adhesion
