"""Count how often the `error_estimate` of a peak covers what brute force finds, for axis ratios 0.02 to 50.

    python -m validation.benchmarks.peak_bruteforce [--patches N] [--seed S] [--accuracy PRESET] [--slender]

Random sliding patches (friction 0 to 1, Poisson's ratio 0 to 0.5, pole inside or outside, some in full slip) are
sampled at thousands of random points, many on the edge and where the slip turns; from the twelve highest, evaluated
again with fine quadrature, a random walk climbs. It shares the stress kernels with the search, but neither points
nor steps.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from trackroller.contact.quantities import Ellipse
from trackroller.contact.slip import Slip
from trackroller.halfspace.ellipse import NO_FIELD, RayRoom, near_parts, patch_rows, unit_rule
from trackroller.halfspace.peak import find_peaks
from trackroller.halfspace.stress import von_mises
from trackroller.parameters.accuracy import PRESETS
from validation.benchmarks.command import run


def random_patches(n: int, seed: int, slenderness: tuple[float, float] = (1.0, 50.0)) -> tuple[np.ndarray, np.ndarray]:
    """Return rows of `patch_rows` (n, 12) of area pi, and Poisson's ratios (n, 2) of roller and guide."""
    rng = np.random.default_rng(seed)
    ratio = np.exp(rng.uniform(math.log(slenderness[0]), math.log(slenderness[1]), n) * rng.choice([-1, 1], n))
    a, b = np.sqrt(ratio), 1 / np.sqrt(ratio)
    friction = rng.uniform(0, 1, n) * (rng.random(n) < 0.9)
    alpha = rng.uniform(0.2, 1.3, n) * rng.choice([-1, 1], n)
    shift = rng.uniform(-1.2, 1.2, n) * a * np.sin(alpha)
    size = np.maximum(a, 1.0)
    rows = patch_rows(
        Ellipse(a, b, np.ones(n)),
        Slip(np.sin(alpha), np.cos(alpha), 30 * size, 60 * size, shift),
        friction,
        2,
        np.where(rng.random(n) < 0.15, 1.0, 0.0),
    )
    return rows, rng.uniform(0, 0.5, (n, 2))


def stresses(row: np.ndarray, nu: np.ndarray, u: np.ndarray, order: int) -> np.ndarray:
    """Return the von Mises stress (m, 2) of roller and guide at points u (m, 3) over (a, b, smaller semi-axis)."""
    points = np.ascontiguousarray(u * np.array([row[0], row[1], min(row[0], row[1])]))
    rule = unit_rule(order)
    parts = near_parts(row, NO_FIELD, points, (rule, rule), RayRoom.empty())
    bodies = [parts[:, 0] + nu[k] * parts[:, 1] + s * (parts[:, 2] + nu[k] * parts[:, 3]) for k, s in ((0, 1), (1, -1))]
    return np.stack([von_mises(stress) for stress in bodies], axis=1)


def project(u: np.ndarray) -> np.ndarray:
    u[:, :2] /= np.maximum(np.hypot(u[:, 0], u[:, 1]), 1.0)[:, None]
    u[:, 2] = np.maximum(u[:, 2], 0.0)
    return u


def sampled(row: np.ndarray, rng: np.random.Generator, n: int) -> np.ndarray:
    """Return n points all over the patch, a sixth of them on its edge, and n/3 near the lines where the slip turns."""
    r, t = np.sqrt(rng.random(n)), rng.uniform(0, 2 * np.pi, n)
    r[: n // 6] = 1.0
    everywhere = np.stack([r * np.cos(t), r * np.sin(t), rng.exponential(0.4, n) * (rng.random(n) < 0.45)], axis=1)
    a, b, half = row[0], row[1], n // 6
    pole = np.clip(row[8] / a, -1, 1)
    x = rng.uniform(-1, 1, half)
    fold = (row[9] + np.where(x < pole, row[10] * (x + 1), row[11] * (x - 1)) * a) / b
    chord = np.clip(pole + rng.normal(size=half) * min(b / a, 1), -1, 1)
    x, y = (
        np.append(x, chord),
        np.append(fold + rng.normal(size=half) * min(a / b, 1), np.sqrt(1 - chord**2) * rng.uniform(-1, 1, half)),
    )
    turning = np.stack([x, y, rng.exponential(0.3, 2 * half) * (rng.random(2 * half) < 0.3)], axis=1)
    return project(np.concatenate([everywhere, turning]))


def climbed(row: np.ndarray, nu: np.ndarray, rng: np.random.Generator, points: int = 3000) -> np.ndarray:
    """Return the highest stress found, and its place, of both bodies, shape (2, 4)."""
    fine = 96
    u = sampled(row, rng, points)
    rough, out = stresses(row, nu, u, 24), np.empty((2, 4))
    thin = np.append(np.minimum([row[1] / row[0], row[0] / row[1]], 1.0), 1.0)
    for body in (0, 1):
        top = u[np.argsort(-rough[:, body])[:12]]
        value = stresses(row, nu, top, fine)[:, body]
        best, at, step = value.max(), top[value.argmax()].copy(), 0.1
        while step > 0.004:
            near = rng.normal(size=(16, 3)) * (rng.random((16, 3)) < 0.6) * np.where(rng.random((16, 1)) < 0.5, thin, 1)
            tried = project(at + step * near)
            value = stresses(row, nu, tried, fine)[:, body]
            if value.max() > best:
                best, at = value.max(), tried[value.argmax()]
            else:
                step *= 0.5
        out[body] = best, *at
    return out


def measure(patches: int = 800, seed: int = 1, accuracy: str = "standard", slender: bool = False) -> dict[str, Any]:
    """Return how often the estimate of a peak covers brute force; `slender` takes axis ratios from 5 to 50 only."""
    rows, nu = random_patches(patches, seed, (5.0, 50.0) if slender else (1.0, 50.0))
    rng = np.random.default_rng(seed)
    force = np.array([climbed(row, ratio, rng) for row, ratio in zip(rows, nu, strict=True)])
    found = find_peaks(rows, nu, PRESETS[accuracy].peak)
    below = force[:, :, 0] / found.stress - 1
    covered = below <= found.error
    return {
        "peaks_within_0.2_percent": float(np.mean(below <= 2e-3)),
        "covered_of_peaks": float(np.mean(covered)),
        "covered_of_patches": float(np.mean(covered.all(axis=1))),
        "peaks_above_brute_force_by_0.2_percent": int(np.sum(below < -2e-3)),
        "estimate_percentiles_50_90": np.quantile(found.error, (0.5, 0.9)),
        "missed": [
            {
                "patch": int(i),
                "body": ("roller", "guide")[k],
                "ellipticity": rows[i][0] / rows[i][1],
                "friction": rows[i][2],
                "below": below[i, k],
                "estimate": found.error[i, k],
                "place": force[i, k, 1:].round(3),
            }
            for i, k in np.argwhere(~covered)
        ],
    }


if __name__ == "__main__":
    run(measure, __doc__)
