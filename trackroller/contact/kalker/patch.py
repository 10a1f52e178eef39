"""Kalker's exact theory of steady rolling with friction on the elastic half-space.

The slip per travel speed is s = w - du/dy. Here w is the rigid slip of the roller against the
guide, and u is the displacement difference (Kalker 1990, sections 1.3 and 4.2). The material enters
the patch at y = +b. Dry friction holds in each element: |tau| <= mu p, and tau = -mu p s/|s| where
the element slides. Elements are rectangles of constant traction.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.kalker import batch, extrapolation, subgrid
from trackroller.contact.kalker.cells import cells, unit_cells
from trackroller.contact.kalker.loops import row_means
from trackroller.contact.kalker.newton import column_ranges
from trackroller.contact.kalker.problem import KalkerSettings, PatchSolution, joined
from trackroller.contact.linear import LARGEST_RATIO, creepage_coefficients
from trackroller.contact.quantities import Elastic, Ellipse, Resultants, SurfaceTractions
from trackroller.contact.slip import Creepage

BLOCK = 256  # patches that are solved together, to limit the memory for their tractions


def _level(
    ellipse: Ellipse | GridPatch,
    creep: Creepage,
    friction,
    elastic: Elastic,
    travel,
    settings: KalkerSettings,
    start: np.ndarray,
) -> batch.SolvedPatches:
    """Solve on the grid of the tractions `start` (n, 2, elements, elements), which the result
    overwrites.
    """
    elements = start.shape[-1]
    height, share = (v.reshape(-1, elements, elements) for v in cells(ellipse, elements))
    a, bound = ellipse.semi_axis_lateral, friction * ellipse.max_pressure
    x = ellipse.centre[:, None] + a[:, None] * ((2.0 * np.arange(elements) + 1.0) / elements - 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        coupling = elastic.coupling / friction
    patches = batch.Batch(
        a,
        ellipse.semi_axis_rolling,
        bound,
        bound / elastic.shear_modulus,
        elastic.poisson_ratio,
        coupling,
        creep.along(x),
        creep.lateral,
        creep.spin,
        travel,
        height,
        share,
        ellipse.is_hertzian,
        elastic.film * elastic.shear_modulus,
        False,
    )
    solution = batch.SolvedPatches.start(start, settings.law_in_use)
    batch.solve_batch(patches, settings.law_in_use, settings, solution)
    return solution


def _first(
    ellipse: Ellipse | GridPatch, creep: Creepage, friction, elastic: Elastic, elements: int
) -> np.ndarray:
    """Return the tractions over mu p_max from which the first grid starts, (n, 2, elements,
    elements).

    On ellipses they are those of Kalker's simplified theory (FASTSIM, 1982), from which Newton's
    method needs half the steps that it needs from zero. Elements without a finite value, and other
    patches, start at 0.
    """
    if not ellipse.is_hertzian:
        return np.zeros((friction.size, 2, elements, elements))
    a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
    c = creepage_coefficients(
        np.clip(b / a, 1.0 / LARGEST_RATIO, LARGEST_RATIO), elastic.poisson_ratio
    )
    height, _ = cells(ellipse, elements)
    places = (2.0 * np.arange(elements) + 1.0) / elements - 1.0
    with np.errstate(all="ignore"):
        # of an element, over the bound
        length = 2.0 * b / (elements * friction * ellipse.max_pressure)
        across = length * 4.0 * elastic.shear_modulus * c.c23 / (np.pi * b * np.sqrt(b / a))
        lateral = across[:, None] * (
            creep.lateral[:, None] - creep.spin[:, None] * b[:, None] * places
        )
        rolling = (length * 3.0 * elastic.shear_modulus * c.c11 / (8.0 * b))[:, None] * creep.along(
            a[:, None] * places
        )
        # a film is softer in the same way: both displacements add up
        softer = 1.0 + elastic.film * 3.0 * elastic.shear_modulus * c.c11 / (8.0 * b)
        rolling, lateral = rolling / softer[:, None], lateral / softer[:, None]
        out, traction = (
            np.empty((friction.size, 2, elements, elements)),
            np.zeros((2, friction.size, elements)),
        )
        for k in range(elements - 1, -1, -1):  # material enters at the leading edge
            traction[0] -= lateral[:, k, None]
            traction[1] -= rolling
            traction *= np.fmin(height[k] / np.sqrt((traction * traction).sum(axis=0)), 1.0)
            out[:, :, k] = np.moveaxis(traction, 0, 1)
    return np.nan_to_num(out, copy=False, nan=0.0, posinf=0.0, neginf=0.0)


def _coarse(
    ellipse, creep, friction, elastic, travel, settings: KalkerSettings, traction, started: bool
):
    """Solve on half the elements and, unless the iteration is `started`, fill its start `traction`
    from there.
    """
    n, half = friction.size, settings.elements // 2
    if started:
        first = traction.reshape(n, 2, half, 2, half, 2).mean(axis=(3, 5))
    else:
        first = _first(ellipse, creep, friction, elastic, half)
    solution = _level(ellipse, creep, friction, elastic, travel, settings, first)
    if not started:
        traction[:] = on_elements(ellipse, solution, settings.elements)
    return solution


def on_elements(
    ellipse: Ellipse | GridPatch, solution: batch.SolvedPatches | PatchSolution, elements: int
) -> np.ndarray:
    """Return the tractions of a solution, interpolated to `elements` along each axis, (n, 2,
    elements, elements).
    """
    height, _ = cells(ellipse, elements)
    share = subgrid.shares(
        subgrid.fields_of(ellipse, solution), elements / solution.traction.shape[-1]
    )
    return share * (height if height.ndim == 2 else height[:, None])


def shares(
    ellipse, solution: PatchSolution, parts: int = subgrid.PARTS
) -> tuple[np.ndarray, np.ndarray]:
    """Return the tractions over mu p at `parts` points a side of each element, and for elements of
    twice the size.
    """
    return subgrid.both_shares(subgrid.fields_of(ellipse, solution), parts)


def _integrals(
    ellipse, friction, solution: batch.SolvedPatches, settings: KalkerSettings
) -> tuple[np.ndarray, np.ndarray]:
    """Return the resultants (n, 3) and the share of the adhesion area (n,) of one grid: see
    `subgrid.integrals`.
    """
    if not (settings.between and friction.size):
        return solution.report.forces, solution.report.stick_fraction
    finer = ellipse if ellipse.is_hertzian else ellipse.refined(subgrid.PARTS, subgrid.PARTS)
    between = cells(finer, subgrid.PARTS * solution.traction.shape[-1])
    bound = (friction * ellipse.max_pressure)[:, None]
    sides = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
    forces, adhesion = subgrid.integrals(subgrid.fields_of(ellipse, solution), between, *sides)
    # without friction nothing sticks
    return bound * forces, np.where(solution.report.products > 0, adhesion, 0.0)


def _solve_block(
    ellipse, creep, friction, elastic, travel, settings: KalkerSettings, start
) -> PatchSolution:
    """Solve patches at once, see `solve_patch`: on all elements, and on half as many for the
    extrapolation.
    """
    n, elements = friction.size, settings.elements
    if start is not None:
        traction = np.array(start, float)
    elif settings.extrapolate:
        traction = np.empty((n, 2, elements, elements))
    else:
        traction = _first(ellipse, creep, friction, elastic, elements)
    coarse = None
    if settings.extrapolate:
        coarse = _coarse(
            ellipse, creep, friction, elastic, travel, settings, traction, start is not None
        )
    solution = _level(ellipse, creep, friction, elastic, travel, settings, traction)
    fine = solution.report
    value, stick = _integrals(ellipse, friction, solution, settings)
    limit, change = np.zeros((n, 6)), np.full((n, 3), np.nan)
    force_error, pressed = np.full(n, np.nan), fine.pressure_work
    work, energy = fine.work + pressed, fine.energy_residual
    if coarse is not None:
        other, stick_before = _integrals(ellipse, friction, coarse, settings)
        change, report = value - other, coarse.report
        weight, limit[:, :3] = extrapolation.extrapolated(
            ellipse, creep, friction, elastic, solution, value, change
        )
        softness = elastic.film * elastic.shear_modulus / ellipse.semi_axis_rolling
        force_error = extrapolation.force_error(
            ellipse, friction, stick, change, elements, softness
        )
        limit[:, 3] = extrapolation.adhesion(stick, stick_before, weight, elements) - stick
        pressed = pressed + weight * (pressed - report.pressure_work)
        work = work + weight * (work - report.work - report.pressure_work)
        # observed to be of second order wherever a part of the patch slides
        energy = extrapolation.energy(energy, report.energy_residual)
        limit[:, 4], limit[:, 5] = pressed - fine.pressure_work, energy - fine.energy_residual
    value = value + limit[:, :3]
    # the moment is about the nominal point, wherever the patch lies
    value = np.stack([value[:, 0], value[:, 1], value[:, 2] + ellipse.centre * value[:, 1]], axis=1)
    return PatchSolution(
        resultants=Resultants(value[:, 0], value[:, 1], value[:, 2]),
        traction=solution.traction,
        slip=solution.slip,
        stick=solution.stick,
        factor=solution.factor,
        stick_fraction=stick + limit[:, 3],
        friction_energy_per_distance=work,
        pressure_work=pressed,
        energy_residual=energy,
        limit=limit,
        error_estimate=np.abs(change),
        force_error=force_error,
        own_slip=fine.own_slip,
        residual=fine.residual,
        steps=fine.steps,
        products=fine.products,
        converged=fine.residual <= settings.tolerance,
    )


def _full(value, n: int) -> np.ndarray:
    # Numba compiles again for each memory layout, so every array gets the same one.
    return np.array(np.broadcast_to(np.asarray(value, float), n), order="C")


def _prepared(
    ellipse: Ellipse | GridPatch, friction, elastic: Elastic
) -> tuple[Any, np.ndarray, Elastic]:
    """Return patches, friction and constants as arrays (n,) of one memory layout."""
    n = np.size(ellipse.semi_axis_lateral)
    if ellipse.is_hertzian:
        ellipse = Ellipse(
            *(
                _full(v, n)
                for v in (
                    ellipse.semi_axis_lateral,
                    ellipse.semi_axis_rolling,
                    ellipse.max_pressure,
                )
            )
        )
    g, nu, k = (
        _full(v, n) for v in (elastic.shear_modulus, elastic.poisson_ratio, elastic.coupling)
    )
    return ellipse, _full(friction, n), Elastic(g, nu, k, _full(elastic.film, n))


def solve_patch(
    ellipse: Ellipse | GridPatch,
    creep: Creepage,
    friction,
    elastic: Elastic,
    settings: KalkerSettings | None = None,
    start: np.ndarray | None = None,
    travel_speed=None,
) -> PatchSolution:
    """Solve for tractions, slip and resultants of n patches in steady rolling with friction.

    Parameters
    ----------
    ellipse : Ellipse or GridPatch
        Patches, arrays (n,) [mm], [MPa]. The number of elements of a `GridPatch` is a multiple of
        `settings.elements`.
    creep : Creepage
        Rigid slip, arrays (n,) [1], [1/mm].
    friction : array_like, shape (n,) or ()
        Friction coefficient mu [1]; 0 gives no traction.
    elastic : Elastic
        Combined constants, arrays (n,) or scalars [MPa], [1].
    settings : KalkerSettings, optional
        Discretisation and stopping rule.
    start : ndarray, shape (n, 2, elements, elements), optional
        Tractions of a similar solution over mu p_max [1], from which the iteration starts.
    travel_speed : array_like, shape (n,) or (), optional
        Travel speed for friction laws [mm/s]; default: that of the settings.

    Returns
    -------
    PatchSolution
        Solution of the n patches. `converged` is False where the residual exceeds its tolerance.

    Notes
    -----
    Valid for half-spaces, steady rolling and dry friction. The validation pages state the error of
    the resultants. It is largest in full adhesion and in slender patches (b/a below 0.1) that
    contain the spin pole.

    References
    ----------
    Kalker, J. J. (1990). Three-Dimensional Elastic Bodies in Rolling Contact. Kluwer.
    """
    settings = settings or KalkerSettings()
    ellipse, friction, elastic = _prepared(ellipse, friction, elastic)
    n = friction.size
    xi, eta, phi = (_full(v, n) for v in (creep.longitudinal, creep.lateral, creep.spin))
    creep = Creepage(xi, eta, phi, creep.profile)
    travel = _full(settings.travel_speed if travel_speed is None else travel_speed, n)
    parts = []
    for i in range(0, max(n, 1), BLOCK):
        rows = slice(i, i + BLOCK)
        first = None if start is None else start[rows]
        parts.append(
            _solve_block(
                ellipse.take(rows),
                creep.take(rows),
                friction[rows],
                elastic.take(rows),
                travel[rows],
                settings,
                first,
            )
        )
    return parts[0] if len(parts) == 1 else joined(parts, slice(None))


def _slip_of_law(solution: PatchSolution, height: np.ndarray) -> np.ndarray:
    """Return the slips from which the friction law gave the tractions: under a falling law the
    means of neighbours.
    """
    if solution.factor.shape[1:] == (1, 1):
        return solution.slip
    out = np.empty_like(solution.slip)
    heights = np.broadcast_to(height, solution.stick.shape)
    for i in range(len(out)):
        moved = np.ascontiguousarray(np.moveaxis(solution.slip[i], 0, -1), float)
        means = np.empty_like(moved)
        first, count = column_ranges(np.ascontiguousarray(heights[i]))
        row_means(moved, first, count, means)
        out[i] = np.where(solution.stick[i], 0.0, np.moveaxis(means, -1, 0))
    return out


def to_tractions(ellipse: Any, friction, solution: PatchSolution) -> SurfaceTractions:
    """Return the fields of a solution at the element centres, with Hertz's pressure, which is 0
    outside the ellipse.
    """
    n, _, _, elements = solution.traction.shape
    ellipse, friction, _ = _prepared(ellipse, friction, Elastic(np.ones(n), np.ones(n), np.ones(n)))
    if not ellipse.is_hertzian:
        return _grid_tractions(ellipse, friction, solution)
    x, y, pressure = ellipse.grid(elements)
    _, _, (root,) = Ellipse(*np.ones((3, 1))).grid(elements)
    inside = root > 0
    height, _ = unit_cells(elements, elements)
    moved = _slip_of_law(solution, height)
    # The solution holds element means. The share of the traction bound at the centre is taken as
    # that of the mean.
    share = np.where(inside, root / np.where(height > 0, height, 1.0), 0.0)
    scale = (friction * ellipse.max_pressure)[:, None, None]
    shear = solution.traction * share * scale[:, None]
    slip = np.where(inside, moved, 0.0)
    stick = inside & solution.stick
    return SurfaceTractions(x, y, pressure, shear[:, 0], shear[:, 1], slip[:, 0], slip[:, 1], stick)


def _grid_tractions(patch: GridPatch, friction, solution: PatchSolution) -> SurfaceTractions:
    """Return the fields on a patch whose pressure was solved; the grid of the pressure may be
    finer.
    """
    elements = solution.traction.shape[-1]
    heights = patch.heights(elements)
    share, moved = (
        solution.traction / np.maximum(heights, 1e-300)[:, None],
        _slip_of_law(solution, heights),
    )
    share, slip, stick = (
        np.repeat(v, patch.shape[1] // elements, axis=-1) for v in (share, moved, solution.stick)
    )
    bound, loaded = friction[:, None, None] * patch.pressure, patch.pressure > 0
    shear = np.where(loaded[:, None], share * bound[:, None], 0.0)
    slip = np.where(loaded[:, None], slip, 0.0)
    return SurfaceTractions(
        patch.x,
        patch.y,
        patch.pressure,
        shear[:, 0],
        shear[:, 1],
        slip[:, 0],
        slip[:, 1],
        loaded & stick,
    )
