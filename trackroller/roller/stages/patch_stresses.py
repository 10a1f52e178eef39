"""Interface of the stress stages to the patches of a block: bounds and places of peaks, and stresses at points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from trackroller.halfspace.peak import Peak
    from trackroller.roller.options import Options
    from trackroller.roller.stages.scene import StageResults


class PatchStresses:
    """Stresses below all patches of a block; `EllipseStresses` and `GridStresses` compute them.

    Attributes
    ----------
    poisson_ratio : of roller and guide below each patch, (2 n, 2) [1]
    """

    def __init__(self, results: StageResults, options: Options) -> None:
        self.results = results
        self.options = options
        table = results.scene.table
        nu = np.stack([table.roller.poisson_ratio, table.guide.poisson_ratio], axis=1)
        if options.stress_bodies == "published":
            nu = np.repeat(nu.mean(axis=1, keepdims=True), 2, axis=1)
        self.poisson_ratio = np.concatenate([nu, nu])

    def bounds(self, searched: np.ndarray) -> np.ndarray:
        """Return a lower bound of the peak stress below the m patches `searched` (2 n,), (m, 2) [MPa]."""
        raise NotImplementedError

    def peaks(self, searched: np.ndarray) -> Peak:
        """Return the peak stresses [MPa] below the m patches `searched` (2 n,), arrays (m, 2)."""
        raise NotImplementedError

    def at(self, flat: int, points: np.ndarray, body: int, sign: float) -> np.ndarray:
        """Return the stress components of one body at points below the patch number `flat` of 2 n.

        Parameters
        ----------
        points : (m, 3) array of x_C, y_C and depth [mm]
        body : 0 for the roller, 1 for the guide
        sign : +1 if the friction acts on the body as on the roller, -1 if it acts the other way

        Returns
        -------
        (m, 6) array in the order of `halfspace.stress.COMPONENTS` [MPa]
        """
        raise NotImplementedError
