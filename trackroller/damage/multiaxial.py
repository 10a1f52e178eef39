"""Fatigue by multiaxial criteria: von Mises amplitude, Findley and Dang Van, from the stresses during an overrolling.

A path is the stress history of one point, (t, 6) in the order of `halfspace.stress.COMPONENTS`. The unloaded state
before and after the overrolling belongs to it. Lines whose upper bound lies below a value that was found cannot govern
and are skipped.

ASSUME: shakedown to the centre of the smallest ball that holds the path of the deviator (Dang Van, mesoscopic).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from trackroller.damage.histories import Tractions, planes
from trackroller.damage.limit import TRACTIONS, Limit, Results, Solved, optional, variables
from trackroller.damage.shakedown import smallest_ball

COARSE, KEPT, ROUNDS = 92, 3, 7  # planes searched first, those refined, and how often the step is halved


def deviators(stress: np.ndarray) -> np.ndarray:
    """Return coordinates u of deviators with |u|^2 = J2, (..., 5) [MPa], of stresses (..., 6)."""
    x, y, z, xy, yz, zx = np.moveaxis(stress, -1, 0)
    return np.stack([(x - y) / 2.0, (2.0 * z - x - y) / np.sqrt(12.0), xy, yz, zx], axis=-1)


def largest_principal(u: np.ndarray, mean: np.ndarray) -> np.ndarray:
    """Return the largest principal stress (...) of `deviators` (..., 5) and mean stresses (...) [MPa]."""
    third = u[..., 1] / np.sqrt(3.0)
    x, y, z, (xy, yz, zx) = u[..., 0] - third, -u[..., 0] - third, 2.0 * third, np.moveaxis(u[..., 2:], -1, 0)
    size = np.sqrt(np.einsum("...d,...d->...", u, u) / 3.0)
    determinant = x * (y * z - yz**2) - xy * (xy * z - yz * zx) + zx * (xy * yz - y * zx)
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = np.arccos(np.clip(0.5 * determinant / size**3, -1.0, 1.0)) / 3.0
    return np.asarray(mean + np.where(size > 0, 2.0 * size * np.cos(turn), 0.0))


def longest_chord(points: np.ndarray) -> np.ndarray:
    """Return the largest distance between two points of each set, (..., t, d) to (...)."""
    square = np.einsum("...td,...td->...t", points, points)
    between = square[..., :, None] + square[..., None, :] - 2.0 * points @ np.swapaxes(points, -1, -2)
    return np.asarray(np.sqrt(np.maximum(between.max(axis=(-2, -1)), 0.0)))


def von_mises_amplitude(path: np.ndarray) -> np.ndarray:
    """Return half the longest chord of paths (..., t, 6), as a von Mises stress, (...) [MPa]."""
    return np.asarray(0.5 * np.sqrt(3.0) * longest_chord(deviators(path)))


def findley_constants(bending: np.ndarray, torsion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return k_F [1] and the largest stress that Findley's criterion allows [MPa].

    Parameters
    ----------
    bending, torsion : numpy.ndarray
        Fully reversed limits [MPa]; their ratio lies between 1 and 2.
    """
    share = 2.0 * torsion / bending - 1.0
    k = share / np.sqrt(1.0 - share**2)
    return k, bending / 2.0 * (k + np.sqrt(1.0 + k**2))


def dang_van_constants(bending: np.ndarray, torsion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a_D [1] and the stress that Dang Van's criterion allows [MPa]; torsion over bending exceeds 0.5."""
    return 3.0 * (torsion / bending - 0.5), torsion


def _on_planes(path: np.ndarray, normals: np.ndarray, k: float) -> np.ndarray:
    """Return tau_a + k sigma_n,max of a path (t, 6) on planes (p, 3), (p,) [MPa]."""
    traction = path[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]] @ normals.T  # (t, 3, p)
    normal = np.einsum("tip,pi->pt", traction, normals)
    shear = np.moveaxis(traction, -1, 0) - normal[:, :, None] * normals[:, None, :]
    return np.asarray(0.5 * longest_chord(shear) + k * normal.max(axis=1))


def _hemisphere(count: int) -> np.ndarray:
    """Return normals that cover half a sphere evenly, (count, 3)."""
    i = np.arange(count)
    z, turn = (i + 0.5) / count, np.pi * (3.0 - np.sqrt(5.0)) * i
    return np.stack([np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), z], axis=1)


def findley(path: np.ndarray, k: float) -> float:
    """Return the largest tau_a + k sigma_n,max over all planes [MPa], tau_a as half the longest chord of the shear.

    Parameters
    ----------
    path : numpy.ndarray
        Stresses, (t, 6) [MPa].
    k : float
        k_F >= 0 [1].
    """
    normals = np.concatenate([_hemisphere(COARSE), np.eye(3)])
    normals = normals[np.argsort(_on_planes(path[::2], normals, k))[-KEPT:]]
    values = _on_planes(path, normals, k)
    step = np.sqrt(2.0 * np.pi / COARSE)
    for _ in range(ROUNDS):
        helper = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
        first = np.cross(normals, helper)
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        second = np.cross(normals, first)
        turns = [(np.cos(a), np.sin(a)) for a in np.arange(6) * np.pi / 3]
        tried = np.stack([normals, *(normals + step * (c * first + s * second) for c, s in turns)], axis=1)
        tried /= np.linalg.norm(tried, axis=2, keepdims=True)
        found = _on_planes(path, tried.reshape(-1, 3), k).reshape(len(normals), -1)
        which = np.argmax(found, axis=1)
        normals, values = tried[np.arange(len(normals)), which], found.max(axis=1)
        step *= 0.5
    return float(values.max())


def dang_van(path: np.ndarray, a: float, credit_pressure: bool = True) -> float:
    """Return the largest tau(t) + a sigma_h(t) of a path (t, 6) [MPa].

    tau is the largest shear of the deviator around the centre of the smallest ball that holds the path. Without
    `credit_pressure` a negative sigma_h counts as 0.
    """
    from trackroller.halfspace.stress import max_shear  # heavy, and planning reads only the declaration below

    centre = ball_centre(deviators(path))
    hydrostatic = path[:, :3].mean(axis=1)
    x = deviators(path) - centre
    third = x[:, 1] / np.sqrt(3.0)
    shear = max_shear(np.stack([x[:, 0] - third, -x[:, 0] - third, 2.0 * third, *x[:, 2:].T], axis=1))
    return float(np.max(shear + a * (hydrostatic if credit_pressure else np.maximum(hydrostatic, 0.0))))


def ball_centre(points: np.ndarray) -> np.ndarray:
    """Return the centre (d,) of the smallest ball around points (t, d)."""
    return smallest_ball(points.T, np.zeros(len(points)))[1]


def governing(paths: np.ndarray, bounds: np.ndarray, value: Callable[[np.ndarray], float]) -> float:
    """Return the largest value over paths (m, t, 6), of which those with a bound below a value found are skipped.

    Parameters
    ----------
    paths : numpy.ndarray
        The paths.
    bounds : numpy.ndarray
        Numbers that the values do not exceed, (m,) [MPa].
    value : callable
        Function of one path.
    """
    largest = -np.inf
    for i in np.argsort(bounds)[::-1]:
        if bounds[i] <= largest:
            break
        largest = max(largest, value(paths[i]))
    return float(largest)


def stresses(t: Tractions, case: int, contact: int, constants: np.ndarray, poisson_ratio: np.ndarray) -> np.ndarray:
    """Return amplitude, Findley's and Dang Van's stress of both bodies below one patch.

    Parameters
    ----------
    t, case, contact : the tractions and the place of the patch
    constants : k_F and a_D of both bodies, (body, 2) [1]; NaN where they are not known
    poisson_ratio : of both bodies, (2,) [1]

    Returns
    -------
    numpy.ndarray
        Amplitude, Findley, Dang Van, Dang Van without credit of pressure, (body, 4) [MPa].
    """
    out = np.full((2, 4), np.nan)
    for body, planar in enumerate(planes(t, case, contact, poisson_ratio)):
        lines = planar.transpose(0, 3, 2, 1).reshape(-1, planar.shape[2], 6)
        paths = np.concatenate([lines, np.zeros((len(lines), 1, 6))], axis=1)
        u, mean = deviators(paths), paths[:, :, :3].mean(axis=2)
        chords = longest_chord(u)
        out[body, 0] = 0.5 * np.sqrt(3.0) * chords.max()
        k, a = constants[body]
        if np.isnan(k + a):
            continue
        # tau_a is at most half a chord, and sigma_n,max at most the largest principal stress
        largest = largest_principal(u, mean).max(axis=1)
        out[body, 1] = governing(paths, 0.5 * chords + k * largest, partial(findley, k=k))
        middle = 0.5 * (u.max(axis=1, keepdims=True) + u.min(axis=1, keepdims=True))
        away = np.sqrt(np.einsum("mtd,mtd->mt", u - middle, u - middle))
        # the centre of the smallest ball, whose radius is at least half a chord, lies no farther from the middle
        beside = np.sqrt(np.maximum(away.max(axis=1) ** 2 - (0.5 * chords) ** 2, 0.0))[:, None]
        for i, credit in ((2, True), (3, False)):
            pressed = a * (mean if credit else np.maximum(mean, 0.0))
            bounds = (np.minimum(away + beside, away.max(axis=1)[:, None]) + pressed).max(axis=1)
            out[body, i] = governing(paths, bounds, partial(dang_van, a=a, credit_pressure=credit))
    return out


def evaluate(solved: Solved) -> Results:
    """Return stresses [MPa] and utilisations [1] of the criteria, (n, contact, body)."""
    m, t = solved.materials, solved.tractions()
    limits = m["fatigue_limit"], m["fatigue_limit_torsion"]
    (k, findley_limit), (a, dang_van_limit) = findley_constants(*limits), dang_van_constants(*limits)
    found = np.full((*t.x.shape[:2], 2, 4), np.nan)
    for case, contact in t.patches():
        constants = np.stack([k[case], a[case]], axis=1)
        found[case, contact] = stresses(t, case, contact, constants, m["poisson_ratio"][case])
    found = t.spread(found)
    return {
        "von_mises_amplitude": found[..., 0],
        "findley_stress": found[..., 1],
        "dang_van_stress": found[..., 2],
        "dang_van_stress_without_pressure": found[..., 3],
        "findley_utilisation": found[..., 1] / findley_limit[:, None, :],
        "dang_van_utilisation": found[..., 2] / dang_van_limit[:, None, :],
        "dang_van_utilisation_without_pressure": found[..., 3] / dang_van_limit[:, None, :],
    }


_CB = ("contact", "body")
LIMIT = Limit(
    name="multiaxial",
    title="multiaxial fatigue (Findley, Dang Van)",
    group="multiaxial",
    meaning="von Mises amplitude, Findley's and Dang Van's stress while a point is overrolled",
    evaluate=evaluate,
    needs=(TRACTIONS,),
    results=variables(
        "multiaxial",
        ("von_mises_amplitude", _CB, "MPa", "sigma_a", "half the longest chord of the deviator's path, von Mises"),
        ("findley_stress", _CB, "MPa", "tau_a + k_F sigma_n", "largest stress of Findley's criterion"),
        ("dang_van_stress", _CB, "MPa", "tau + a_D sigma_h", "largest stress of Dang Van's criterion"),
        ("dang_van_stress_without_pressure", _CB, "MPa", "", "the same, with negative sigma_h counted as 0"),
        ("findley_utilisation", _CB, "1", "", "Findley's stress over its limit"),
        ("dang_van_utilisation", _CB, "1", "", "Dang Van's stress over its limit"),
        ("dang_van_utilisation_without_pressure", _CB, "1", "", "the same, with negative sigma_h counted as 0"),
    ),
    materials=(optional("fatigue_limit_torsion", "tau_D", "MPa", "fully reversed fatigue limit in torsion", 0.0, 2e5),),
    requires=("fatigue_limit_torsion",),
)
