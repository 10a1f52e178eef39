"""How often the rollers of a carriage pass a point of their rail in a stroke."""

from __future__ import annotations

import numpy as np

from trackroller.carriage.file import IN_LINE, SQUARE, Carriage, MountedRoller


def passes_per_km(whole: Carriage) -> np.ndarray:
    """Return how often rollers pass the busiest point of the rail of each roller, (n,) [1/km]; NaN
    without strokes.

    Notes
    -----
    A roller at x passes the points from x to x + stroke of its rail, so that the busiest point is
    passed by as many rollers of the rail as lie within one stroke.

    ASSUME: rollers with one direction of pressing on one line along x run on the same track of the
    same rail. ASSUME: the other rollers load the point as the roller itself does.
    """
    if not np.isfinite(whole.stroke):
        return np.full(len(whole.rollers), np.nan)
    counts = [_passes(roller, whole) for roller in whole.rollers]
    return np.array(counts, dtype=float) * 1000.0 / whole.stroke


def _passes(roller: MountedRoller, whole: Carriage) -> int:
    """Return how many rollers pass the busiest point of the rail of a roller in a stroke."""
    reach = max(float(np.abs([one.at for one in whole.rollers]).max()), 1.0)
    on_rail = [one.at[0] for one in whole.rollers if _on_one_rail(one, roller, IN_LINE * reach)]
    places = np.sort(on_rail)
    last = np.searchsorted(places, places + whole.stroke * 1000.0, side="right")
    return int((last - np.arange(len(places))).max())


def _on_one_rail(one: MountedRoller, other: MountedRoller, near: float) -> bool:
    """Return whether two rollers run on one line, pressing in one direction."""
    apart = float(np.abs(one.at[1:] - other.at[1:]).max())
    return apart <= near and float(one.pushes @ other.pushes) > 1 - SQUARE
