"""Borgonovo's delta from given data: how far knowing a factor moves the whole distribution of an output.

delta = E[ integral |f(y) - f(y | x)| dy ] / 2, between 0 (no influence) and 1. Densities are kernel estimates on a
common grid (bandwidth after Scott as in SALib), the classes of `x` equal-count bins or the values of a list. An
output of few different values needs no kernel: there the distance is that of the frequencies.

References: Borgonovo (2007), Reliab. Eng. Syst. Saf. 92, 771-784; Plischke, Borgonovo & Smith (2013), Eur. J. Oper.
Res. 226, 536-550 (given-data estimate and its correction by bootstrap).
"""

from __future__ import annotations

import numpy as np

POINTS = 256  # of the density's grid
FEW = 10  # different values of an output that is no continuous quantity
MAX_ROWS = 4096  # of a sample: more change the index by less than its interval


def classes(rows: int) -> int:
    """Number of equal-count classes for so many rows: enough to see two waves, few enough to fill each."""
    return int(np.clip(np.round(np.sqrt(rows) / 2), 8, 32))


def delta(y: np.ndarray, group: np.ndarray, seed: int = 0, resamples: int = 60) -> tuple[float, float, float, float]:
    """Delta with its 95 % interval, and the value that an inert factor stays below in 95 % of cases.

    Parameters
    ----------
    y : output, shape (n,), finite
    group : class of each row, shape (n,), 0 and up
    resamples : bootstrap resamples (and half as many permutations)

    Returns
    -------
    delta, low, high, noise [1]. The bias of the plain estimate, which is never below 0, is taken off by the bootstrap
    (2 d - mean of the resamples); the interval is the resamples' own spread about it.
    """
    if len(y) > MAX_ROWS:
        every = np.linspace(0, len(y) - 1, MAX_ROWS).astype(int)
        y, group = y[every], group[every]
    group = np.unique(group, return_inverse=True)[1]
    place, width, kernel = _grid(y)
    rng = np.random.default_rng(seed)
    count, rows = int(group.max()) + 1, len(y)
    cell = group * width + place

    def counted(cells: np.ndarray) -> np.ndarray:
        return np.bincount(cells, minlength=count * width).reshape(count, width)

    best = float(_distance(counted(cell)[None], kernel)[0])
    drawn = _distance(np.stack([counted(cell[rng.integers(0, rows, rows)]) for _ in range(resamples)]), kernel)
    middle = min(1.0, max(0.0, 2 * best - float(drawn.mean())))
    spread = 1.959964 * float(drawn.std(ddof=1))
    half = max(20, resamples // 2)
    mixed = [rng.permutation(group) * width + place for _ in range(half)]
    inert = _distance(np.stack([counted(cells) for cells in mixed]), kernel)
    again = _distance(np.stack([counted(cells[rng.integers(0, rows, rows)]) for cells in mixed]), kernel)
    # what the correction leaves of an inert factor's plain estimates
    noise = float(np.percentile(inert, 95)) * max(0.0, 2 - float(again.mean() / max(inert.mean(), 1e-300)))
    return middle, max(0.0, middle - spread), min(1.0, middle + spread), noise


def _grid(y: np.ndarray) -> tuple[np.ndarray, int, np.ndarray | None]:
    """Grid cell of each row, number of cells (padded), and the grid's own y; None for an output of few values."""
    values, index = np.unique(y, return_inverse=True)
    if len(values) <= FEW:
        return index, len(values), None
    low, high = values[0], values[-1]
    room = 0.5 * (high - low)  # kernels reach beyond the ends; the padding keeps them from coming round
    at = np.linspace(low - room, high + room, POINTS * 2)
    step = at[1] - at[0]
    return np.rint((y - at[0]) / step).astype(int), POINTS * 2, at


def _distance(counts: np.ndarray, at: np.ndarray | None) -> np.ndarray:
    """Mean distance of the classes' densities from that of all rows, for counts (resamples, classes, cells)."""
    rows = counts.sum(axis=2)
    share = rows / rows.sum(axis=1, keepdims=True)
    if at is None:
        density = counts / np.maximum(rows, 1)[:, :, None]
        whole = counts.sum(axis=1) / counts.sum(axis=(1, 2))[:, None]
    else:
        step = at[1] - at[0]
        density = _smooth(counts, rows, at, step)
        whole = _smooth(counts.sum(axis=1)[:, None, :], rows.sum(axis=1, keepdims=True), at, step)[:, 0]
    apart = np.abs(density - whole[:, None, :]).sum(axis=2) / 2
    return np.asarray((share * apart).sum(axis=1))


def _smooth(counts: np.ndarray, rows: np.ndarray, at: np.ndarray, step: float) -> np.ndarray:
    """Kernel density times the step, by a product in the frequency domain; bandwidth sd n^(-1/5) (Scott)."""
    number = np.maximum(rows, 1)
    mean = (counts @ at) / number
    square = (counts @ (at - at.mean()) ** 2) / number - (mean - at.mean()) ** 2
    wide = np.sqrt(np.maximum(square, step**2)) * number**-0.2
    frequency = 2 * np.pi * np.fft.rfftfreq(len(at), step)
    damped = np.exp(-0.5 * (frequency * wide[..., None]) ** 2)
    return np.fft.irfft(np.fft.rfft(counts / number[..., None], axis=-1) * damped, len(at), axis=-1)
