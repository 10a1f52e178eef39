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

import numpy as np

from trackroller.contact.common import Elastic, Resultants, Slip, SurfaceTractions
from trackroller.contact.fastsim.patch import FastsimSettings, FastsimSolution, flexibilities
from trackroller.contact.fastsim.point import Totals, extrapolated
from trackroller.contact.fastsim.strips import Strips, strip_chords, strip_fields, strip_sums
from trackroller.contact.friction_laws import constant
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.linear import LARGEST_RATIO
from trackroller.contact.slip import Creepage
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


def _problem(
    patch: GridPatch, slip: Slip, friction, elastic: Elastic, settings: FastsimSettings, travel_speed
) -> tuple[Strips, np.ndarray]:
    """Return the strips for the kernels, and the loaded area of each patch [mm^2]."""
    n, rows, columns = patch.pressure.shape
    parts, x = equivalent_ellipses(patch), np.ascontiguousarray(patch.x)
    creep = Creepage.of_slip(slip, settings.profile_slip)
    mu, speed, spin = (
        np.array(np.broadcast_to(np.asarray(v, float), n), order="C")
        for v in (friction, settings.travel_speed if travel_speed is None else travel_speed, creep.spin)
    )
    own, flexible = parts.patch, np.full((2, n, columns), np.nan)
    if own.size:
        about = Creepage(creep.longitudinal[own] + spin[own] * parts.x, 0.0 * parts.x, spin[own])
        g, nu = (np.broadcast_to(v, n)[own] for v in (elastic.shear_modulus, elastic.poisson_ratio))
        found = flexibilities(parts.a, parts.b, mu[own] * parts.load, about, g, nu)
        flexible = np.stack([found.x[parts.of_strip], found.y[parts.of_strip]])
    a, b = patch.semi_axis_lateral, np.array(patch.semi_axis_rolling)
    hx, hy = 2 * a / columns, 2 * b / rows
    pressure = np.ascontiguousarray(np.nan_to_num(patch.pressure))
    strips = Strips(pressure, x, hx, hy, b, creep.along(x), spin, *flexible, mu, speed)
    return strips, parts.chords.sum(axis=1) * hx * hy


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
    law = (settings.law or constant()).knots
    strips, area = _problem(patch, slip, friction, elastic, settings, travel_speed)
    n, passes = len(patch.normal_force), []
    for steps in (settings.steps, 2 * settings.steps):
        totals = Totals(*(np.zeros(n) for _ in Totals._fields))
        given = (strips, steps, law, totals)
        share_rows(lambda first, last, given=given: strip_sums(first, last, *given), n, 4)
        passes.append(totals)
    fine, best = passes[1], extrapolated(*passes)
    f_t, f_a, m_r, work = (np.where(np.isfinite(patch.normal_force), part, np.nan) for part in best[:4])
    limit = strips.friction * patch.normal_force
    with np.errstate(divide="ignore", invalid="ignore"):
        stick, lack = fine.adhesion / area, np.where(limit > 0, fine.lack / limit, 0.0)
    return FastsimSolution(Resultants(f_t, f_a, m_r), work, stick, lack)


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
    law = (settings.law or constant()).knots
    strips, _ = _problem(patch, slip, friction, elastic, settings, travel_speed)
    n, rows, columns = patch.pressure.shape
    share, moved = (np.zeros((n, 2, rows, columns)) for _ in range(2))
    share_rows(lambda first, last: strip_fields(first, last, strips, law, share, moved), n, 4)
    shear = share * (strips.friction[:, None, None] * patch.pressure)[:, None]
    stick = (patch.pressure > 0) & (moved[:, 0] == 0.0) & (moved[:, 1] == 0.0)
    return SurfaceTractions(patch.x, patch.y, patch.pressure, shear[:, 0], shear[:, 1], moved[:, 0], moved[:, 1], stick)
