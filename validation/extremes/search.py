"""Cases that depend on the answer: where a regime ends, or where the spin pole stands."""

from __future__ import annotations

import dataclasses

import numpy as np

from trackroller.roller.solver import solve
from validation.extremes.scenes import Scene

POINTS, ROUNDS = 16, 5  # of the search for a border, which ends at 15^-5 of the span
STEPS = 30  # of the search for a place of the pole


def located(scene: Scene, model: str, accuracy: str) -> Scene:
    """Return the scene with its cases; where they depend on the solution, the contact model finds them."""
    if scene.build is None:
        return scene
    numbers = _border(scene, model, accuracy) if scene.pairs else _places(scene, model, accuracy)
    return dataclasses.replace(scene, cases=tuple(scene.build(float(x)) for x in numbers))


def _border(scene: Scene, model: str, accuracy: str) -> np.ndarray:
    """Return the numbers of the cases as shares of the last number that still rolls."""
    assert scene.build is not None
    low, high = scene.span
    for _ in range(ROUNDS):
        tried = np.linspace(low, high, POINTS)
        ds = solve([scene.build(float(x)) for x in tried], "forces", contact_model=model, accuracy=accuracy)
        beyond = np.flatnonzero(ds.regime.values != 0)
        first = int(beyond[0]) if beyond.size else POINTS - 1
        low, high = tried[max(first - 1, 0)], tried[max(first, 1)]
    return np.asarray(scene.values) * (low + high) / 2


def _places(scene: Scene, model: str, accuracy: str) -> np.ndarray:
    """Return numbers that put the spin pole of contact 1 at the places `values` over a, by the Illinois rule."""
    assert scene.build is not None
    target = _bounded(np.asarray(scene.values))
    low, high = (np.full(target.size, v) for v in scene.span)
    f_low, f_high = -1.0 - target, 1.0 - target
    x, side = np.zeros(target.size), np.zeros(target.size)
    best, gap = x.copy(), np.full(target.size, np.inf)
    active = np.arange(target.size)
    for _ in range(STEPS):
        ds = solve(
            [scene.build(float(v)) for v in x[active]], ("forces", "contact"), contact_model=model, accuracy=accuracy
        )
        place = ds.spin_pole_lateral.values[:, 0] / ds.semi_axis_lateral.values[:, 0]
        # beyond the last slip the pole stays at its largest distance
        f = _bounded(np.where(np.isfinite(place), place, np.copysign(np.inf, x[active]))) - target[active]
        better = np.abs(f) < gap[active]
        best[active[better]], gap[active[better]] = x[active][better], np.abs(f)[better]
        up = f > 0
        same = np.where(up, 1.0, -1.0) == side[active]
        f_low[active] = np.where(up, np.where(same, f_low[active] / 2, f_low[active]), f)
        f_high[active] = np.where(up, f, np.where(same, f_high[active] / 2, f_high[active]))
        low[active], high[active] = np.where(up, low[active], x[active]), np.where(up, x[active], high[active])
        side[active] = np.where(up, 1.0, -1.0)
        active = active[np.abs(f) > 1e-11]
        if active.size == 0:
            break
        lo, hi, tl, th = low[active], high[active], f_low[active], f_high[active]
        x[active] = (lo * th - hi * tl) / (th - tl)
    return best


def _bounded(place: np.ndarray) -> np.ndarray:
    """Return places in (-1, 1), nearly linear in the motor force."""
    with np.errstate(invalid="ignore"):
        return np.where(np.isfinite(place), place / np.sqrt(1 + place * place), np.sign(place))
