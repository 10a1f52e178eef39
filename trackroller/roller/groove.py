"""The groove of one roller at one travel, and the states between two solved ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Groove:
    """The worn state of one roller and its guide, and where the search for its balance starts.

    Attributes
    ----------
    travel : float
        Travel since the bodies were new [km].
    depth : numpy.ndarray, shape (m, 2, cells)
        Mean depth that wear took off the cells of roller and guide, outward from the first cell [mm]; m is 1 if both
        contacts are mirror images, otherwise 2.
    closing : numpy.ndarray, shape (m,)
        How far wear let the bodies close along the contact normal [mm].
    inclined : numpy.ndarray, shape (m,)
        Angle by which the contact normal has turned outward [rad].
    error : float
        Sum of the estimated errors of the depth in all steps [mm].
    balance : numpy.ndarray, shape (3,), optional
        Rolling radius shift [mm] and normal forces [N] of a similar state.
    boxes : numpy.ndarray, shape (m, 3), optional
        Ends and half length of the boxes around the patches of that state [mm].
    """

    travel: float
    depth: np.ndarray
    closing: np.ndarray
    inclined: np.ndarray
    error: float = 0.0
    balance: np.ndarray | None = None
    boxes: np.ndarray | None = None


def between(one: Groove, two: Groove, travel: float) -> Groove:
    """Return the state at a travel [km] between two states of a march, by linear interpolation."""
    part = (travel - one.travel) / (two.travel - one.travel)
    names = "depth", "closing", "inclined", "error"
    return Groove(travel, *((1.0 - part) * getattr(one, name) + part * getattr(two, name) for name in names))


def travel_to_depth(one: Groove, two: Groove, depth: float) -> float:
    """Return the travel [km] at which the deepest place reaches `depth` [mm] between two states; inf if it does not."""
    grown = two.depth - one.depth
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        part = np.where(two.depth >= depth, (depth - one.depth) / grown, np.inf)
    return float(one.travel + max(np.min(part, initial=np.inf), 0.0) * (two.travel - one.travel))
