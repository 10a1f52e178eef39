"""Plain results of a run of cases: taken, joined and finished without knowing where they came from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

_PLAIN = ("regime", "converged", "bits", "model", "stopped")  # fields with one entry a case


@dataclass
class Block:
    """Values by name, first axis the case (n,); `model` is the number of the contact model in `CONTACT_MODELS`."""

    values: dict[str, np.ndarray]
    regime: np.ndarray
    converged: np.ndarray
    bits: np.ndarray
    model: np.ndarray
    stopped: np.ndarray
    bodies: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.regime)

    def take(self, rows: np.ndarray) -> Block:
        """The cases `rows`; a row may be taken more than once."""
        values = {name: array[rows] for name, array in self.values.items()}
        plain = {name: getattr(self, name)[rows] for name in _PLAIN}
        return Block(values, **plain, bodies=None if self.bodies is None else self.bodies[rows])


def join(parts: Sequence[Block]) -> Block:
    """Blocks one after another; fields of different grids, and those that a block lacks, are filled up with NaN."""
    if len(parts) == 1:
        return parts[0]
    names = dict.fromkeys(name for part in parts for name in part.values)
    none: np.ndarray = np.empty(0)
    values = {
        name: _joined([part.values.get(name, none) for part in parts], [len(part) for part in parts]) for name in names
    }
    plain = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _PLAIN}
    flags = [part.bodies for part in parts if part.bodies is not None]
    return Block(values, **plain, bodies=np.concatenate(flags) if len(flags) == len(parts) else None)


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
