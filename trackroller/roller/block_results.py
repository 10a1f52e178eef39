"""Results of a block of cases as plain arrays, which can be selected by row and joined."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trackroller.parameters import REGIMES

_PLAIN = ("regime", "converged", "bits", "model", "rung", "stopped")  # fields with one entry a case


@dataclass
class BlockResults:
    """Results of n cases; the first axis of every array is the case.

    Attributes
    ----------
    values : dict of str to numpy.ndarray
        Arrays by their names in `dataset.VARIABLES`.
    regime, converged, bits, stopped : numpy.ndarray, shape (n,)
        Flags as in `dataset.FLAGS`; `bits` are the validity flags.
    model : numpy.ndarray of int, shape (n,)
        Number of the contact model in `CONTACT_MODELS`.
    rung : numpy.ndarray of int, shape (n,)
        Number of the accuracy in `RUNGS`; 0 for settings that are no rung.
    bodies : numpy.ndarray of int, shape (n, 2), optional
        Validity flags of each body.
    """

    values: dict[str, np.ndarray]
    regime: np.ndarray
    converged: np.ndarray
    bits: np.ndarray
    model: np.ndarray
    rung: np.ndarray
    stopped: np.ndarray
    bodies: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.regime)

    def take(self, rows: np.ndarray) -> BlockResults:
        """Return the cases `rows`; a row may occur more than once."""
        values = {name: array[rows] for name, array in self.values.items()}
        plain = {name: getattr(self, name)[rows] for name in _PLAIN}
        bodies = None
        if self.bodies is not None:
            bodies = self.bodies[rows]
        return BlockResults(values, **plain, bodies=bodies)

    def fail(self, rows: list[int]) -> None:
        """Mark the cases `rows` as failed, without results."""
        if not rows:
            return
        self.regime[rows] = REGIMES.index("failed")
        self.converged[rows] = False
        for array in self.values.values():
            if array.dtype.kind == "f":
                array[rows] = np.nan


def join(parts: Sequence[BlockResults]) -> BlockResults:
    """Return blocks joined along the case; NaN fills missing values and the ends of shorter
    grids.
    """
    if len(parts) == 1:
        return parts[0]
    names = dict.fromkeys(name for part in parts for name in part.values)
    none: np.ndarray = np.empty(0)
    values = {
        name: _joined(
            [part.values.get(name, none) for part in parts], [len(part) for part in parts]
        )
        for name in names
    }
    plain = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _PLAIN}
    flags = [part.bodies for part in parts if part.bodies is not None]
    bodies = None
    if len(flags) == len(parts):
        bodies = np.concatenate(flags)
    return BlockResults(values, **plain, bodies=bodies)


def _joined(arrays: list[np.ndarray], lengths: list[int]) -> np.ndarray:
    known = [array for array in arrays if array.size]
    if not known:
        return np.concatenate([a for a, n in zip(arrays, lengths, strict=True) if len(a) == n])
    shape = tuple(np.max([array.shape[1:] for array in known], axis=0).astype(int))
    out = np.full((sum(lengths), *shape), np.nan)
    for array, end, n in zip(arrays, np.cumsum(lengths), lengths, strict=True):
        if array.size:
            out[(slice(end - n, end), *(slice(0, own) for own in array.shape[1:]))] = array
    return out
