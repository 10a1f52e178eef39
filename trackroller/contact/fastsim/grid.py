"""Kalker's simplified theory on patches whose pressure was solved on a grid: any shape, strip by strip.

Each column of elements is a strip. Where it is loaded, once or several times, its traction grows from the leading edge
of each loaded interval as in `fastsim`, bounded by mu times the solved pressure of its place.

ASSUME: flexibilities are those of an equivalent ellipse: the area of the patch, and the ratio of axes that the second
moments of its pressure have. Kik & Piotrowski (1996) take equal area and the ratio of length and width; moments do
not leap where a thin tail is gained or lost, and both agree for an ellipse. Strips with an empty column between them
are patches of their own, each with its own ellipse (Ayasse & Chollet 2005 go further, to one for each strip). Beyond
an axis ratio of 50 the flexibilities are those of 50.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from trackroller.contact.common import Elastic, Resultants, Slip, SurfaceTractions
from trackroller.contact.fastsim.patch import FastsimSettings, FastsimSolution, flexibilities
from trackroller.contact.fastsim.strips import strip_chords, strip_fields, strip_sums
from trackroller.contact.friction_laws import constant
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.linear import LARGEST_RATIO
from trackroller.numerics.threads import share_rows


@dataclass(frozen=True)
class Islands:
    """Separate parts of n patches as ellipses, arrays (m,), and the part that each strip belongs to, (n, M).

    patch : number of the patch; x : its middle [mm]; a, b : semi-axes across and along [mm]; load [N]
    """

    patch: np.ndarray
    x: np.ndarray
    a: np.ndarray
    b: np.ndarray
    load: np.ndarray
    of_strip: np.ndarray
    chords: np.ndarray


def equivalent_ellipses(patch: GridPatch) -> Islands:
    """Ellipses with the area of each separate part of n patches and the axis ratio of its second moments.

    A patch of NaN has none; strips without load are numbered as the part before.
    """
    pressure = np.nan_to_num(patch.pressure)
    n, rows, columns = pressure.shape
    hx, hy = 2 * patch.semi_axis_lateral / columns, 2 * patch.semi_axis_rolling / rows
    chords = np.zeros((n, columns))
    strip_chords(pressure, chords)
    load = pressure.sum(axis=1)
    loaded = load > 0
    begins = loaded & ~np.pad(loaded, ((0, 0), (1, 0)))[:, :-1]
    number = np.maximum(np.cumsum(begins).reshape(n, columns) - 1, 0)
    m = int(begins.sum())

    def over(values: np.ndarray) -> np.ndarray:
        return np.bincount(number[loaded], weights=values[loaded], minlength=m)[:m]

    owner = np.repeat(np.arange(n), begins.sum(axis=1))
    force = over(load)
    x, y = np.nan_to_num(patch.x), np.nan_to_num(patch.y)
    middle = over(load * x) / force
    deviation = x - middle[number] if m else x
    along = np.einsum("nij,ni->nj", pressure, y * y)
    # elements carry their load over their sides
    across = over(load * deviation**2) / force + hx[owner] ** 2 / 12
    ratio = np.sqrt((over(along) / force + hy[owner] ** 2 / 12) / across)
    ratio = np.clip(ratio, 1.0 / LARGEST_RATIO, LARGEST_RATIO)
    area = over(chords) * (hx * hy)[owner]
    a = np.sqrt(area / (np.pi * ratio))
    return Islands(owner, middle, a, ratio * a, force * (hx * hy)[owner], number, chords)


def _problem(patch: GridPatch, slip: Slip, friction, elastic: Elastic, settings: FastsimSettings):
    """Arrays for the kernels up to the friction, and the loaded area of each patch [mm^2]."""
    n, rows, columns = patch.pressure.shape
    parts = equivalent_ellipses(patch)
    spin, x = np.array(slip.spin, float), np.ascontiguousarray(patch.x)
    along = slip.longitudinal[:, None] + spin[:, None] * x
    if settings.profile_slip:
        along = along + slip.beyond_tangent(x)
    mu = np.array(np.broadcast_to(np.asarray(friction, float), n), order="C")
    own, flexibility = parts.patch, np.full((n, columns, 2), np.nan)
    if own.size:
        about = np.stack([slip.longitudinal[own] + spin[own] * parts.x, 0 * parts.x, spin[own]], axis=1)
        g, nu = (np.broadcast_to(v, n)[own] for v in (elastic.shear_modulus, elastic.poisson_ratio))
        found, _ = flexibilities(parts.a, parts.b, mu[own] * parts.load, about, g, nu)
        flexibility = found[parts.of_strip]
    a, b = patch.semi_axis_lateral, patch.semi_axis_rolling
    sides = np.stack([2 * a / columns, 2 * b / rows], axis=1)
    pressure = np.ascontiguousarray(np.nan_to_num(patch.pressure))
    arrays = (pressure, x, sides, np.array(b), along, spin, flexibility, mu)
    return arrays, parts.chords.sum(axis=1) * sides[:, 0] * sides[:, 1]


def _rows_of(function, rest: tuple, first: int, last: int) -> None:
    function((first, last), *rest)


def _travel(travel_speed, settings: FastsimSettings, n: int) -> np.ndarray:
    given = settings.travel_speed if travel_speed is None else travel_speed
    return np.array(np.broadcast_to(np.asarray(given, float), n), order="C")


def solve_grid(
    patch: GridPatch,
    slip: Slip,
    friction,
    elastic: Elastic,
    settings: FastsimSettings | None = None,
    travel_speed=None,
) -> FastsimSolution:
    """Simplified theory for n solved patches with rigid slip w = (-phi y, xi + phi x); see the head of this file.

    Parameters
    ----------
    patch, slip : arrays (n,); friction : coefficient mu [-], (n,) or scalar
    elastic : combined constants, (n,); the coupling constant is not used
    settings : `steps` along each loaded interval and the friction law count here; the strips are those of the grid
    travel_speed : [mm/s], (n,) or scalar, for friction laws; that of the settings if not given

    Forces [N], moment about the nominal point [N mm], dissipation [N], stick over the loaded area [-]; NaN for patches
    of NaN. With the pressure of an ellipse they are those of `fastsim.solve_patch` but for an error that falls with
    the elements (tests/test_fastsim_grid.py); against the exact theory on the same patches see there as well.
    """
    settings = settings or FastsimSettings()
    law = settings.law or constant()
    arrays, area = _problem(patch, slip, friction, elastic, settings)
    n = len(patch.normal_force)
    totals, travel = np.zeros((2, n, 6)), _travel(travel_speed, settings, n)
    for k, steps in enumerate((settings.steps, 2 * settings.steps)):
        rest = (*arrays, travel, steps, law.speed, law.factor, totals[k])
        share_rows(partial(_rows_of, strip_sums, rest), n, 4)
    best = 2.0 * totals[1] - totals[0]  # the steps are of first order
    best[~np.isfinite(patch.normal_force)] = np.nan
    limit = arrays[-1] * patch.normal_force
    with np.errstate(divide="ignore", invalid="ignore"):
        stick, lack = totals[1, :, 4] / area, np.where(limit > 0, totals[1, :, 5] / limit, 0.0)
    return FastsimSolution(Resultants(best[:, 0], best[:, 1], best[:, 2]), best[:, 3], stick, lack)


def tractions(
    patch: GridPatch,
    slip: Slip,
    friction,
    elastic: Elastic,
    settings: FastsimSettings | None = None,
    travel_speed=None,
) -> SurfaceTractions:
    """Pressure and shear of each element, and the slip at its centre per travel speed; see `solve_grid`."""
    settings = settings or FastsimSettings()
    law = settings.law or constant()
    arrays, _ = _problem(patch, slip, friction, elastic, settings)
    n, rows, columns = patch.pressure.shape
    share, moved = (np.zeros((n, 2, rows, columns)) for _ in range(2))
    rest = (*arrays, _travel(travel_speed, settings, n), law.speed, law.factor, share, moved)
    share_rows(partial(_rows_of, strip_fields, rest), n, 4)
    shear = share * (arrays[-1][:, None, None] * patch.pressure)[:, None]
    stick = (patch.pressure > 0) & (moved[:, 0] == 0.0) & (moved[:, 1] == 0.0)
    return SurfaceTractions(patch.x, patch.y, patch.pressure, shear[:, 0], shear[:, 1], moved[:, 0], moved[:, 1], stick)
