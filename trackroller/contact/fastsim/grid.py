"""Kalker's simplified theory on patches of any shape whose pressure was solved on a grid, strip by strip.

Each column of elements is a strip, which may have several loaded intervals. The traction grows from the leading edge of
each loaded interval, as in `fastsim`. Its bound is mu times the solved pressure at the same place.

ASSUME: the flexibilities are those of an equivalent ellipse. This ellipse has the area of the patch and the axis ratio
that follows from the second moments of the pressure. Kik & Piotrowski (1996) use equal area and the ratio of length and
width. Both choices agree for an ellipse, but moments do not jump where a thin tail appears or disappears. Strips with
an empty column between them are separate patches, each with its own ellipse. Ayasse & Chollet (2005) use an ellipse for
each strip. For axis ratios beyond 50, the flexibilities of 50 are used.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from trackroller.contact.common import Elastic, SurfaceTractions
from trackroller.contact.fastsim.patch import flexibilities
from trackroller.contact.fastsim.point import Strips
from trackroller.contact.fastsim.solution import FastsimSettings, FastsimSolution, extrapolated, surface
from trackroller.contact.fastsim.strips import Loaded, strip_chords, strip_fields, strip_sums
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.linear import LARGEST_RATIO
from trackroller.contact.slip import Creepage, Slip
from trackroller.numerics.threads import share_rows


@dataclass(frozen=True)
class Islands:
    """Separate parts of n patches as equivalent ellipses.

    Attributes
    ----------
    patch : numpy.ndarray of int, shape (m,)
        Number of the patch to which each part belongs.
    x : numpy.ndarray, shape (m,)
        Lateral place of the part's middle [mm].
    a, b : numpy.ndarray, shape (m,)
        Lateral and rolling semi-axis [mm].
    load : numpy.ndarray, shape (m,)
        Normal force [N].
    of_strip : numpy.ndarray of int, shape (n, M)
        Number of the part to which each strip belongs.
    chords : numpy.ndarray, shape (n, M)
        Loaded length of each strip, in elements.
    """

    patch: np.ndarray
    x: np.ndarray
    a: np.ndarray
    b: np.ndarray
    load: np.ndarray
    of_strip: np.ndarray
    chords: np.ndarray


def equivalent_ellipses(patch: GridPatch) -> Islands:
    """Return the equivalent ellipse of each separate part of n patches.

    Parameters
    ----------
    patch : GridPatch
        The n patches.

    Returns
    -------
    Islands
        The ellipses. A patch of NaN has no ellipse. A strip without load gets the number of the part before it.
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
    # The load of an element is spread over its width hx, which adds hx^2/12 to the second moment.
    across = over(load * deviation**2) / force + hx[owner] ** 2 / 12
    ratio = np.sqrt((over(along) / force + hy[owner] ** 2 / 12) / across)
    ratio = np.clip(ratio, 1.0 / LARGEST_RATIO, LARGEST_RATIO)
    area = over(chords) * (hx * hy)[owner]
    a = np.sqrt(area / (np.pi * ratio))
    return Islands(owner, middle, a, ratio * a, force * (hx * hy)[owner], number, chords)


def _problem(
    patch: GridPatch, slip: Slip, friction, elastic: Elastic, profile: bool, travel_speed
) -> tuple[Loaded, Strips, np.ndarray]:
    """Return pressures and strips for the kernels, and the loaded area of each patch [mm^2]."""
    n, rows, columns = patch.pressure.shape
    parts, x = equivalent_ellipses(patch), np.ascontiguousarray(patch.x)
    creep = Creepage.of_slip(slip, profile)
    mu, speed, spin = (
        np.array(np.broadcast_to(np.asarray(v, float), n), order="C") for v in (friction, travel_speed, creep.spin)
    )
    own, flexible = parts.patch, np.full((2, n, columns), np.nan)
    if own.size:
        about = Creepage(creep.longitudinal[own] + spin[own] * parts.x, 0.0 * parts.x, spin[own])
        g, nu = (np.broadcast_to(v, n)[own] for v in (elastic.shear_modulus, elastic.poisson_ratio))
        flexibility = flexibilities(parts.a, parts.b, mu[own] * parts.load, about, g, nu)
        flexible = np.stack([flexibility.x[parts.of_strip], flexibility.y[parts.of_strip]])
    a, b = patch.semi_axis_lateral, np.array(patch.semi_axis_rolling)
    hx, hy = 2 * a / columns, 2 * b / rows
    loaded = Loaded(np.ascontiguousarray(np.nan_to_num(patch.pressure)), hx, hy, b, mu)
    strips = Strips(x, np.zeros(n), spin, creep.along(x), flexible[0], flexible[1], speed)
    return loaded, strips, parts.chords.sum(axis=1) * hx * hy


def solve_grid(
    patch: GridPatch,
    slip: Slip,
    friction,
    elastic: Elastic,
    settings: FastsimSettings | None = None,
    travel_speed=1.0,
) -> FastsimSolution:
    """Solve n patches with the rigid slip w = (-phi y, xi + phi x) by the simplified theory.

    Parameters
    ----------
    patch : GridPatch
        The n patches.
    slip : Slip
        Kinematics of the patches, arrays (n,).
    friction, elastic, settings, travel_speed
        See `fastsim.solve_patch`; the strips are the columns of the grid.

    Returns
    -------
    FastsimSolution
        Forces [N], moment about the nominal point [N mm], dissipation [N] and adhesion share of the loaded area [1];
        NaN for patches of NaN.

    Notes
    -----
    For an elliptical patch the result converges to that of `fastsim.solve_patch` with the number of elements.
    `tests/contact` compares both, and compares this function with the exact theory on the same patches.
    """
    settings = settings or FastsimSettings()
    loaded, strips, area = _problem(patch, slip, friction, elastic, settings.profile_slip, travel_speed)
    kernel = partial(strip_sums, loaded, strips, settings.law.knots)
    return extrapolated(kernel, settings.steps, area, np.isfinite(patch.normal_force))


def tractions(
    patch: GridPatch,
    slip: Slip,
    friction,
    elastic: Elastic,
    settings: FastsimSettings | None = None,
    travel_speed=1.0,
) -> SurfaceTractions:
    """Return pressure and shear of each element, and the slip at its centre per travel speed; see `solve_grid`."""
    settings = settings or FastsimSettings()
    loaded, strips, _ = _problem(patch, slip, friction, elastic, settings.profile_slip, travel_speed)
    n, rows, columns = patch.pressure.shape
    share, moved = (np.zeros((n, 2, rows, columns)) for _ in range(2))
    share_rows(partial(strip_fields, loaded, strips, settings.law.knots, share, moved), n, 4)
    bound = loaded.friction[:, None, None] * patch.pressure
    return surface(patch.x, patch.y, patch.pressure, share * bound[:, None], moved)
