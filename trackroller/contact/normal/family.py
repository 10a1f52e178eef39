"""Patches of one gap under any load, from solutions of the normal problem on a fixed lattice of
loads.

The equilibrium asks for a patch at tens of slightly different loads. The loads of a geometric
lattice, F/E* = LATTICE^k, are solved from scratch. The lattice does not depend on the wanted loads,
so that no result depends on earlier ones. Between lattice loads the box around the patch and the
pressures over their load are interpolated. This interpolation is exact for Hertz's gap and starts
the solution for other gaps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from trackroller.contact.cross_sections import Gap
from trackroller.contact.hertz import exact_shape
from trackroller.contact.normal.measure import (
    Box,
    largest_pressure,
    patch_area,
    patch_box,
    roughness,
)
from trackroller.contact.normal.pressure import NormalSolution, displacement, solve_normal

LATTICE = 1.6  # ratio of neighbouring lattice loads
# Largest `roughness` of a pressure whose ridges the elements resolve: with the given elements
# across, and with finer ones, on which the rim of the patch is rougher. PROBE elements along the
# rolling direction are enough to measure it.
RESOLVED, RESOLVED_FINER = 0.15, 0.35
FACTORS = 1, 2, 4, 8  # on the elements across
PROBE = 8
# relative change of the largest pressure, by twice the elements, up to which a ridge is resolved
STEADY = 0.01
KEPT = 8  # number of solutions between lattice loads that are kept in memory
OVERLAP = 1e-3  # least overlap outside the box that counts as contact, over the approach
COARSE = 16  # elements along each axis of the first solutions, which find the box around the patch
BOX_TOLERANCE = 3e-3  # relative change of the sides of the box at which it counts as found
TOUCHES = 1e-9  # largest distance at which a patch ends at an edge, over the width of the box
MARGIN = 0.08  # margin around the box over its sides; shear can move the patch
# height up to which places count as the lowest ones, over the heights of the whole gap
LOWEST = 1e-6
SAMPLES = 401  # points across for the first box and for the search of contact outside the box


@dataclass(frozen=True)
class Node:
    """Solution for one load.

    Attributes
    ----------
    box : Box
        Rectangle around the patch.
    shares : numpy.ndarray, shape (N, M)
        Share of the load that each element carries, with the sum 1.
    largest : float
        Largest pressure over E* [1].
    approach : float
        Approach of the bodies [mm].
    area : float
        Area of the patch [mm^2].
    reaches : bool
        True if the patch ends at an edge of the material.
    residual : float
        Residual of `solve_normal`.
    """

    box: Box
    shares: np.ndarray
    largest: float
    approach: float = math.nan
    area: float = math.nan
    reaches: bool = False
    residual: float = math.nan


def nearest_lattice(load: float) -> float:
    """Return the power of LATTICE that is nearest to `load`, the normal force over E* [mm^2]."""
    return LATTICE ** round(math.log(load) / math.log(LATTICE))


class Family:
    """All patches of one gap.

    Parameters
    ----------
    gap : Gap
        Gap of the undeformed bodies.
    elements : int
        Number of elements along the rolling direction of the box.
    across : int
        Factor on this number for the elements across, see `finer_across`.
    near : Box, optional
        Box of a similar patch, from which the search for the box starts.
    """

    def __init__(self, gap: Gap, elements: int, across: int = 1, near: Box | None = None) -> None:
        self.gap, self._near = gap, near
        self.shape = elements, elements * across
        self.limits = gap.limits
        self._nodes: dict[int, Node] = {}
        self._asked: dict[float, Node] = {}
        x = np.linspace(-1.0, 1.0, SAMPLES)[1:-1]
        low, high = self.limits
        # even samples over the whole width, and closer ones around the nominal point for small
        # patches
        x = np.unique(
            np.concatenate(
                [0.5 * (low + high) + 0.5 * (high - low) * x, np.where(x < 0, -low, high) * x**5]
            )
        )
        self._samples, self._lateral = x, gap.lateral(x)

    def between(self, load: float) -> Node:
        """Interpolate box and shares under load/E* [mm^2] between two lattice loads; exact for
        Hertz's gap.
        """
        k = math.floor(math.log(load) / math.log(LATTICE))
        low, high = self.node(k), self.node(k + 1)
        # in Hertz's theory the sizes grow with the cube root of the load
        t = (np.cbrt(load) - np.cbrt(LATTICE**k)) / (
            np.cbrt(LATTICE ** (k + 1)) - np.cbrt(LATTICE**k)
        )
        sides = [
            (1 - t) * getattr(low.box, name) + t * getattr(high.box, name)
            for name in ("low", "high", "half")
        ]
        box, shares = self._clipped(*sides), (1 - t) * low.shares + t * high.shares
        return Node(box, shares, shares.max() / box.cell(shares.size) * load)

    def at(self, load: float) -> Node:
        """Return the solution under load/E* [mm^2], on a box that changes continuously with the
        load.
        """
        if load not in self._asked:
            start = self.between(load)
            solution = self._pressure(start.box, load, self.shape, start.shares)
            self._asked = dict(list(self._asked.items())[-KEPT:])
            self._asked[load] = self._node_of(solution, start.box, load)
        return self._asked[load]

    def pressed(
        self, load: float, lift: np.ndarray | None = None, start: np.ndarray | None = None
    ) -> Node:
        """Return the solution with the surfaces moved apart by `lift` (N, M) [mm], on a box with a
        margin on all sides.

        `load` is F/E* [mm^2], `start` are pressures (N, M) to start from.
        """
        box = self.between(load).box
        margin = MARGIN * (box.high - box.low)
        wide = self._clipped(box.low - margin, box.high + margin, (1.0 + 2.0 * MARGIN) * box.half)
        return self._node_of(self._pressure(wide, load, self.shape, start, lift), wide, load)

    def node(self, k: int) -> Node:
        """Return the solution under F/E* = LATTICE^k; it is computed at the first call."""
        if k not in self._nodes:
            self._nodes[k] = self._solve(LATTICE**k)
        return self._nodes[k]

    def finer_across(self, load: float) -> int:
        """Return the factor on the elements across that ridges of the pressure under load/E* [mm^2]
        need.

        Where the patch ends at an edge of the material the pressure is infinite on any elements;
        the factor is 1.
        """
        box, coarser, highest, smooth = self._around(load), 1, 0.0, False
        for factor in FACTORS:
            pressure = self._pressure(box, load, (PROBE, factor * self.shape[1])).pressure
            if self._reaches(pressure, box):
                return 1
            # an edge of the elements may hide a ridge by chance, so that twice the elements have
            # the last word; where the box of another load cuts the patch, they resolve the cut
            # alone
            cut = pressure.max() == max(pressure[:, 0].max(), pressure[:, -1].max())
            if smooth and (cut or abs(pressure.max() - highest) < STEADY * highest):
                return coarser
            smooth = roughness(pressure) <= (RESOLVED if factor == 1 else RESOLVED_FINER)
            if smooth and factor == 1:
                return 1
            coarser, highest = factor, pressure.max()
        return FACTORS[-1]

    def _reaches(self, pressure: np.ndarray, box: Box) -> bool:
        """Return True if the patch ends at an edge of the material."""
        near = TOUCHES * (box.high - box.low)
        at_low, at_high = box.low - near <= self.limits[0], box.high + near >= self.limits[1]
        return bool((at_low and pressure[:, 0].any()) or (at_high and pressure[:, -1].any()))

    def _start(self, load: float) -> Box:
        """Return a first box by Hertz's theory, with the mean curvature of the gap over the width
        of the patch.
        """
        near = self._near and self._clipped(self._near.low, self._near.high, self._near.half)
        # a groove that became steep may end before the place of the similar patch
        if near and near.low < near.high:
            return near
        lowest = float(self._lateral.min())
        # the middle of the lowest places: on a flat, rounding alone decides which place is the
        # lowest
        above = (self._lateral - lowest) / (LOWEST * float(np.ptp(self._lateral)))
        weight = np.maximum(1.0 - above, 0.0) * np.gradient(self._samples)
        centre = float(weight @ self._samples / weight.sum())
        k_y = float(self.gap.curvature(np.array(centre)))
        wide = 0.1 * (self.limits[1] - self.limits[0])
        half = wide
        for _ in range(12):
            ends = np.interp([centre - wide, centre + wide], self._samples, self._lateral)
            k_x = max((ends.sum() - 2 * lowest) / wide**2, 1e-4 * k_y)
            hertz = exact_shape(np.array([k_x]), np.array([k_y]), np.array([1.0])).at(
                np.array([load])
            )
            wide = float(np.sqrt(wide * hertz.semi_axis_lateral[0]))
            half = float(hertz.semi_axis_rolling[0])
        return self._clipped(centre - 1.25 * wide, centre + 1.25 * wide, 1.4 * half)

    def _clipped(self, low: float, high: float, half: float) -> Box:
        return Box(max(low, self.limits[0]), min(high, self.limits[1]), half)

    def _pressure(
        self,
        box: Box,
        load: float,
        shape: tuple[int, int],
        start: np.ndarray | None = None,
        lift: np.ndarray | None = None,
    ) -> NormalSolution:
        """Return the pressure under a load over a box; `lift` is a further gap, `start` a pressure
        to start from.
        """
        x, y, hx, hy = box.grid(*shape)
        gap = self.gap.field(x, y)
        return solve_normal(gap if lift is None else gap + lift, hx, hy, load, start=start)

    def _solve(self, load: float) -> Node:
        """Solve the patch under a load in a box that is fitted to it in a few turns."""
        box, solution = self._around(load), None
        for attempt in range(6):
            solution = self._pressure(
                box, load, self.shape, None if solution is None else solution.pressure
            )
            filled = patch_box(solution.pressure, box)
            wider = self._beyond(solution, box)
            if wider != box:
                box = wider
                continue
            change = max(abs(filled.low - box.low), abs(filled.high - box.high)) / (
                box.high - box.low
            )
            if max(change, abs(filled.half / box.half - 1)) < BOX_TOLERANCE or attempt > 2:
                break
            if attempt > 0:  # the box may oscillate by a part of an element
                filled = Box(
                    *(0.5 * (getattr(box, k) + getattr(filled, k)) for k in ("low", "high", "half"))
                )
            box = self._clipped(filled.low, filled.high, filled.half)
        return self._node_of(solution, box, load)

    def _node_of(self, solution, box: Box, load: float) -> Node:
        _, _, hx, hy = box.grid(*self.shape)
        p = solution.pressure
        top, area = largest_pressure(p), patch_area(p, hx, hy)
        return Node(
            box,
            p * (hx * hy / load),
            top,
            solution.approach,
            area,
            self._reaches(p, box),
            solution.residual,
        )

    def _beyond(self, solution, box: Box) -> Box:
        """Return the box, wider by 1.2 elements on each side where the bodies would overlap just
        outside it.
        """
        rows, columns = self.shape
        x, y, hx, hy = box.grid(rows, columns)
        around = np.zeros((rows + 2, columns + 2))
        around[1:-1, 1:-1] = solution.pressure
        x, y = (
            np.concatenate([[x[0] - hx], x, [x[-1] + hx]]),
            np.concatenate([[y[0] - hy], y, [y[-1] + hy]]),
        )
        total = displacement(around, hx, hy) + self.gap.field(x, y)
        overlap = total < solution.approach - OVERLAP * (solution.approach - self._lateral.min())
        low = box.low - 1.2 * hx * overlap[:, 0].any()
        high = box.high + 1.2 * hx * overlap[:, -1].any()
        return self._clipped(low, high, box.half + 1.2 * hy * overlap[[0, -1]].any())

    def _around(self, load: float) -> Box:
        """Return a box that the patch fills, by coarse solutions."""
        box = self._start(load)
        for _ in range(20):
            solution = self._pressure(box, load, (COARSE, COARSE))
            filled = patch_box(solution.pressure, box)
            low, high, half = filled.low, filled.high, filled.half
            width = high - low
            grows = self._outside(solution, box)
            near = TOUCHES * width
            if solution.pressure[:, 0].any() and low - near <= box.low > self.limits[0]:
                grows = (min(grows[0], low - 0.3 * width), grows[1])
            if solution.pressure[:, -1].any() and high + near >= box.high < self.limits[1]:
                grows = (grows[0], max(grows[1], high + 0.3 * width))
            taller = solution.pressure[0].any() and (1.0 + TOUCHES) * half >= box.half
            if grows == (np.inf, -np.inf) and not taller:
                tight = self._clipped(low, high, half)
                if (box.high - box.low) < 1.2 * (tight.high - tight.low) and box.half < 1.2 * half:
                    return tight
                box = self._clipped(low - 0.04 * width, high + 0.04 * width, 1.06 * half)
                continue
            box = self._clipped(
                min(low, grows[0]), max(high, grows[1]), 1.4 * half if taller else 1.06 * half
            )
        return box

    def _outside(self, solution, box: Box) -> tuple[float, float]:
        """Return the outermost places left and right of the box where the bodies would overlap;
        (inf, -inf) if none.
        """
        x, y, hx, hy = box.grid(COARSE, COARSE)
        beyond = (self._samples < box.low - 0.5 * hx) | (self._samples > box.high + 0.5 * hx)
        places = self._samples[beyond]
        if places.size == 0:
            return np.inf, -np.inf
        distance = np.hypot(places[:, None, None] - x, y[:, None])
        sink = (hx * hy / np.pi) * (solution.pressure / distance).sum(axis=(1, 2))
        deep = solution.approach - OVERLAP * (solution.approach - self._lateral.min())
        overlap = places[self._lateral[beyond] + sink < deep]
        left, right = overlap[overlap < box.low], overlap[overlap > box.high]
        return (float(left.min()) if left.size else np.inf), (
            float(right.max()) if right.size else -np.inf
        )
