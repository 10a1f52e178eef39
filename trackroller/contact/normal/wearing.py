"""Depth that wear takes off a patch in one implicit step.

The depth that wears off at the lateral place x is the integral of local rates along the rolling
direction, for example of k p |s|. Wear changes the pressure: a wave of wave number q and depth d
changes it by E* q d/2, so that an explicit step of more than about a tenth of a micrometre turns
the groove into noise. The pressure at the end of the step is therefore an unknown of the step. In
each column of elements, along the rolling direction, its distribution stays that of the start, and
so does the rate of wear per load; the load Q of the column changes. With the influence matrix A of
the columns and the depth c Q of the step

    A (Q - Q_0) + c Q + gap = closing,   Q >= 0,   sum Q = sum Q_0,

where c is the rate of wear per load times the travel. Columns beside the patch take part, with the
gap that is left there, so that the patch can grow within the step. The rate per load is exact for
Archard's law; for a law that is not linear in the pressure its change is an error of first order in
the step.
"""

from __future__ import annotations

import numpy as np

from trackroller.contact.cross_sections import Gap
from trackroller.contact.influence import displacements

BESIDE = 0.25  # columns added on each side of the patch, over the columns of the grid
LOADED = 1e-5  # share of the largest column load from which a column counts as loaded
ROUNDS = 60  # limit of changes of the loaded columns
# columns at the end of a patch whose depths are evened; the share falls to nothing within as many
# more
RIM = 3.0
SPREAD = 0.25  # standard deviation of the smoothing of depths over the width of a column


class WearingPatch:
    """One patch whose columns of elements wear.

    Parameters
    ----------
    gap : Gap
        Gap of the bodies at the start of the step; x counts outward.
    x, y : numpy.ndarray, shape (M,) and (N,)
        Element centres [mm].
    pressure : numpy.ndarray, shape (N, M)
        Pressure [MPa].
    rates : numpy.ndarray, shape (2, N, M)
        Depth per travel that each element takes off roller and guide, over its length [1/km].
    modulus : float
        Contact modulus E* [MPa].

    Attributes
    ----------
    edges : numpy.ndarray, shape (m + 1,)
        Ends of the columns, those beside the patch included [mm].
    rate : numpy.ndarray, shape (m,)
        Depth per travel of each column at the start, of both bodies together [mm/km].
    """

    def __init__(
        self,
        gap: Gap,
        x: np.ndarray,
        y: np.ndarray,
        pressure: np.ndarray,
        rates: np.ndarray,
        modulus: float,
    ) -> None:
        hx, hy = x[1] - x[0], y[1] - y[0]
        beside = int(np.ceil(BESIDE * x.size))
        low = min(beside, int((x[0] - 0.5 * hx - gap.limits[0]) / hx + 1e-6))
        high = min(beside, int((gap.limits[1] - x[-1] - 0.5 * hx) / hx + 1e-6))
        low, high = max(low, 0), max(high, 0)
        wide = x[0] + hx * np.arange(-low, x.size + high)
        p = np.pad(pressure, ((0, 0), (low, high)))
        load, bodies = p.sum(axis=0), hy * np.pad(rates.sum(axis=1), ((0, 0), (low, high)))
        self.loaded = load > LOADED * load.max()
        inside = np.flatnonzero(self.loaded)
        first, last = int(inside[0]), int(inside[-1])
        # a column without load takes the distribution of the nearest loaded one
        near = inside[np.argmin(np.abs(np.arange(wide.size)[:, None] - inside), axis=1)]
        shape = p[:, near] / load[near]
        self.edges = wide[0] + hx * (np.arange(wide.size + 1) - 0.5)
        self.rate, self.width = bodies.sum(axis=0), hx
        with np.errstate(divide="ignore", invalid="ignore"):
            self._shares = np.nan_to_num(bodies / self.rate)[:, near]
        self._load = np.where(self.loaded, load, 0.0)
        per_load = np.where(self.loaded, self.rate / np.where(self.loaded, load, 1.0), 0.0)
        self._per_load = _continued(per_load, first, last)
        self._matrix = _column_matrix(shape, hx, hy) / modulus
        apart = self._matrix @ self._load + (shape * gap.field(wide, y)).sum(axis=0)
        closing = float((apart * self._load).sum() / self._load.sum())
        self._gap = np.where(self.loaded, 0.0, np.maximum(apart - closing, 0.0))

    def worn(self, travel: float) -> tuple[np.ndarray, float]:
        """Return the depth of roller and guide at each column after an implicit step, (2, m), and
        how far they close.

        Depths and closing are in mm, `travel` in km.
        """
        c = travel * self._per_load
        start = self._matrix @ self._load - self._gap
        active, load, closing = self.loaded.copy(), self._load, 0.0
        for _ in range(ROUNDS):
            at = np.flatnonzero(active)
            system = np.zeros((at.size + 1, at.size + 1))
            system[:-1, :-1] = self._matrix[np.ix_(at, at)] + np.diag(c[at])
            system[:-1, -1], system[-1, :-1] = -1.0, 1.0
            answer = np.linalg.solve(system, np.concatenate([start[at], [self._load.sum()]]))
            load, closing = np.zeros(active.size), float(answer[-1])
            load[at] = answer[:-1]
            apart = self._matrix @ load - start - closing
            wrong = (load < 0.0) | (~active & (apart < -1e-12 * abs(start).max()))
            if not wrong.any():
                break
            active = (active & (load > 0.0)) | (~active & wrong)
        load = np.maximum(load, 0.0)
        depth = c * load
        # columns that hold nearly no load wear as at the start
        return self._shares * np.where(self.loaded | active, depth, 0.0), closing


def _continued(values: np.ndarray, first: int, last: int) -> np.ndarray:
    """Return values of columns, continued beyond the loaded columns `first` to `last` along
    straight lines.
    """
    out, places = values.copy(), np.arange(values.size)
    for end, inward in ((first, 1), (last, -1)):
        span = min(3, last - first)
        slope = (values[end] - values[end + inward * span]) / span if span else 0.0
        beyond = (places - end) * inward < 0
        out[beyond] = np.maximum(
            values[end] + np.maximum(slope, 0.0) * np.abs(places[beyond] - end), 0.0
        )
    return out


def _column_matrix(shape: np.ndarray, hx: float, hy: float) -> np.ndarray:
    """Return the displacement of columns by unit loads of columns for E* = 1, both weighted by
    `shape` (N, m).
    """
    rows, columns = shape.shape
    influence = displacements(hx, hy, 0.0, rows, columns, 0, 0)[0]
    along = np.arange(rows)
    apart = rows - 1 + along[:, None] - along[None, :]
    out = np.empty((columns, columns))
    for step in range(columns):
        moved = influence[apart, columns - 1 + step] @ shape
        place = np.arange(columns - step)
        out[place, place + step] = out[place + step, place] = (
            shape[:, : columns - step] * moved[:, step:]
        ).sum(axis=0)
    return out


def on_cells(edges: np.ndarray, depth: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return the mean of depths (m,), constant between `edges` (m + 1,), in other cells with the
    edges `cells`.

    The cumulative volume is interpolated, so that no volume is lost and no depth is negative.
    """
    from scipy.interpolate import PchipInterpolator  # noqa: PLC0415 - heavy, and for worn profiles only

    with np.errstate(over="ignore"):  # a slope that underflows counts as zero
        volume = PchipInterpolator(
            edges, np.concatenate([[0.0], np.cumsum(depth * np.diff(edges))])
        )
    return np.maximum(np.diff(volume(np.clip(cells, edges[0], edges[-1]))) / np.diff(cells), 0.0)


def evened_at_rims(depth: np.ndarray, loaded: np.ndarray) -> np.ndarray:
    """Halve the differences between neighbouring depths (2, m) near both ends of the `loaded`
    columns (m,).

    A patch ends within a column, but a column is loaded as a whole or not at all. This leaves a
    false edge in the depths. The next patch has other columns: they press on this edge, and further
    steps would make it larger. The volume does not change.
    """
    inside, face = np.flatnonzero(loaded), np.arange(1, depth.shape[1])
    within = np.minimum(
        face - inside[0], inside[-1] + 1 - face
    )  # columns from each face to the nearer end of the patch
    flow = np.zeros((depth.shape[0], depth.shape[1] + 1))
    flow[:, 1:-1] = 0.25 * np.clip((2.0 * RIM - within) / RIM, 0.0, 1.0) * np.diff(depth, axis=1)
    return depth + np.diff(flow, axis=1)


def smoothed(depth: np.ndarray, width: float) -> np.ndarray:
    """Smooth the depths (m,) of cells over the `width` of a column of elements, in cells.

    The patch grows while it wears, and its columns with it. Their centres would see details of
    narrower cells at random, and wear would turn these details into noise. Means of neighbouring
    cells keep the volume.
    """
    variance = SPREAD**2 * max(width**2 - 1.0, 0.0)
    rounds = int(np.ceil(2.0 * variance))
    for _ in range(rounds):
        beside = np.pad(depth, 1, mode="edge")
        depth = depth + 0.5 * variance / rounds * (beside[2:] - 2.0 * depth + beside[:-2])
    return depth
