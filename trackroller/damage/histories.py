"""Stresses of the planes below a patch, which a point of a body passes while it is overrolled.

A point moves through the stress field along y at fixed x and z, so a line of a plane along y is its
stress history.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from trackroller.halfspace.tractions import Tractions

PADDING = 0.18  # nodes beyond the patch along y over those of the patch, on each side
# over the smaller half side of the patch; the stresses that decide lie at 0.3 to 0.8, or under high
# friction higher
DEPTHS = np.array([0.05, 0.1, 0.17, 0.26, 0.37, 0.5, 0.66, 0.9])


@dataclass(frozen=True)
class RollerTractions(Tractions):
    """Tractions on the rollers of n cases, (n, contact, ...); NaN where there is no patch, slips in
    full slip as well.

    Attributes
    ----------
    mirrored : numpy.ndarray of bool
        Cases whose contact 2 is the mirror image of contact 1, (n,).
    """

    mirrored: np.ndarray

    def by_patch(self, values: Callable[[int, int], Any], *shape: int) -> np.ndarray:
        """Return values of the case and contact of each patch, (n, contact, *shape); NaN where
        there is no patch.

        Contact 2 of a mirrored case repeats the values of contact 1.
        """
        own = [values(case, contact) for case, contact in zip(*self.solved_patches, strict=True)]
        return self.of_all_patches(np.array(own, dtype=float).reshape(-1, *shape))

    @property
    def solved_patches(self) -> tuple[np.ndarray, np.ndarray]:
        """Return case and contact of each patch that is no mirror image of another, (m,) each."""
        has_patch = np.isfinite(self.x[:, :, 0])
        has_patch[:, 1] &= ~self.mirrored
        case, contact = np.nonzero(has_patch)
        return case, contact

    def of_all_patches(self, values: np.ndarray) -> np.ndarray:
        """Return values of the `solved_patches`, (m, ...), for each case and contact, (n, contact,
        ...), as `by_patch`.
        """
        out = np.full((*self.x.shape[:2], *values.shape[1:]), np.nan)
        out[self.solved_patches] = values
        out[self.mirrored, 1] = out[self.mirrored, 0]
        return out

    @property
    def steps(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the spacings of the nodes along x and y, (n, contact) each [mm]."""
        step_x, step_y = (
            (axis[..., -1] - axis[..., 0]) / (axis.shape[-1] - 1) for axis in (self.x, self.y)
        )
        return step_x, step_y

    def loads(self, case: int, contact: int) -> PatchLoads:
        """Return the loads of one patch."""
        at = case, contact
        step_x, step_y = (float(step[at]) for step in self.steps)
        return PatchLoads(
            np.stack([self.shear_lateral[at], self.shear_rolling[at], self.pressure[at]]),
            step_x,
            step_y,
        )


@dataclass(frozen=True)
class PatchLoads:
    """Loads q_x, q_y, p of one patch as hats around nodes, (3, ny, nx) [MPa], and the spacings of
    the nodes [mm].
    """

    tractions: np.ndarray
    step_x: float
    step_y: float


def planes(loads: PatchLoads, depths: np.ndarray, poisson_ratio: np.ndarray) -> np.ndarray:
    """Return the stresses of both bodies on planes at any depth below one patch.

    Parameters
    ----------
    loads : PatchLoads
        The loads on the roller, bilinear between the nodes; (-q_x, -q_y, p) act on the guide.
    depths : numpy.ndarray
        z >= 0 of the planes, (depth,) [mm].
    poisson_ratio : numpy.ndarray
        nu of roller and guide, (2,) [1].

    Returns
    -------
    numpy.ndarray
        Stresses (body, depth, component, y, x) in the order of `halfspace.stress.COMPONENTS` [MPa].
        Along y the planes have `PADDING` times the nodes more on each side.
    """
    from trackroller.halfspace.hats import planes_below
    from trackroller.halfspace.stress import FRICTION_SIGNS

    rows = math.ceil(PADDING * loads.tractions.shape[1])
    padded = np.pad(loads.tractions, ((0, 0), (rows, rows), (0, 0))).astype(np.float32)
    return planes_below(padded, (loads.step_x, loads.step_y), depths, poisson_ratio, FRICTION_SIGNS)
