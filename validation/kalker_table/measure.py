"""Measure the table of the exact theory: the share of rolling designs outside its range, and its errors.

Designs are the random rollers of `validation.benchmarks.samples`. Patches cover the whole range evenly; every other
one has unlike bodies with |K|/mu from 0.1 to 20. Errors are differences from elements, over mu F_N for forces and over
mu F_N sqrt(a b) for the spin moment.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

import trackroller as tr
from trackroller.contact import kalker, table
from trackroller.contact.kalker import Creepage, KalkerSettings
from trackroller.contact.linear import creepage_coefficients
from trackroller.contact.models import CLASSES
from trackroller.contact.quantities import Elastic, Ellipse
from trackroller.contact.table import spline
from trackroller.contact.table.coordinates import HALF_WAY, RATIOS, coupling_creepage
from trackroller.materials import load_database
from validation.benchmarks.samples import random_designs
from validation.kalker_table import build
from validation.kalker_table.nodes import LOG_RATIOS, problem

SEED, DESIGNS, PATCHES, ELEMENTS = 7, 1000, 400, 40
LARGEST_COUPLING = 20.0  # of |K|/mu of the patches; shipped materials and a friction of 0.01 come to 19.5
LEVELS = {"median": 50, "p95": 95, "p99": 99, "worst": 100}
Problem = tuple[Ellipse, np.ndarray, np.ndarray, np.ndarray, Elastic]  # ellipse, xi, phi, mu, elastic


def patches(n: int, seed: int) -> Problem:
    """Return n random dimensionless patches over the whole range; half of them have unlike bodies."""
    rng = np.random.default_rng(seed)
    g, nu = np.exp(rng.uniform(*LOG_RATIOS, n)), rng.uniform(0.0, 0.5, n)
    rho, theta = rng.uniform(0.02, 0.98, n), rng.uniform(-np.pi / 2, np.pi / 2, n)
    kappa = np.where(np.arange(n) % 2, 10 ** rng.uniform(-1.0, np.log10(LARGEST_COUPLING), n), 0.0)
    plane = HALF_WAY * rho / (1.0 - rho)  # size of longitudinal and spin creepage together
    z = kappa * creepage_coefficients(g, nu).c11 * coupling_creepage(g)
    x, r = plane * np.sin(theta) + z, np.hypot(plane, z)
    r = np.sqrt(x**2 + (plane * np.cos(theta)) ** 2 + z**2)
    return problem(g, nu, r, np.arcsin(z / r), np.arctan2(x, plane * np.cos(theta)))


def rolling(designs: list[tr.Case]) -> Any:
    """Return the solution of rollers by the table at `preview`."""
    return tr.solve(designs, outputs=("forces", "contact"), contact_model="kalker_table", accuracy="preview")


def outside(designs: list[tr.Case], found: Any) -> dict[str, float]:
    """Return the shares of the designs that elements served, and of those with an axis ratio beyond the table's."""
    used = found.contact_model_used
    by_table = used.flag_values[used.flag_meanings.split().index("kalker_table")]
    g = (found.semi_axis_rolling / found.semi_axis_lateral).values
    return {
        "designs": float(len(designs)),
        "by_elements": float(np.mean(used.values != by_table)),
        "outside": float(np.mean(((g < RATIOS[0]) | (g > RATIOS[1])).any(axis=1))),
        "axis_ratio_too_small": float(np.mean((g < RATIOS[0]).any(axis=1))),
        "axis_ratio_too_large": float(np.mean((g > RATIOS[1]).any(axis=1))),
        "smallest_axis_ratio": float(np.nanmin(g)),
        "largest_axis_ratio": float(np.nanmax(g)),
    }


def design_patches(designs: list[tr.Case], found: Any) -> Problem:
    """Return the patches in which solved rollers touch the guide."""
    known = load_database()
    pairs = [[known.material(str(name)) for name in (c.roller_material, c.guide_material)] for c in designs]
    bodies = np.array([[v for m in pair for v in (m.youngs_modulus, m.poisson_ratio)] for pair in pairs])
    sign = np.array([1.0, -1.0])
    alpha = np.deg2rad([[c.contact_angle] for c in designs])
    radius = np.array([[c.axis_distance] for c in designs])
    radius = radius - np.array([[c.guide_profile_radius] for c in designs]) * np.cos(alpha)
    both = Elastic.of_pair(*bodies.T[:, :, None])
    values = np.broadcast_arrays(
        found.semi_axis_lateral.values,
        found.semi_axis_rolling.values,
        found.max_pressure.values,
        found.rolling_radius_shift.values[:, None] / radius,
        -np.sin(alpha) * sign / radius,
        np.array([[c.friction_coefficient] for c in designs]),
        both.shear_modulus,
        both.poisson_ratio,
        both.coupling,
    )
    there = np.isfinite(values[0] * values[3]) & (values[2] > 0)
    a, b, pressure, xi, phi, mu, *elastic = (np.ascontiguousarray(v[there]) for v in values)
    return Ellipse(a, b, pressure), xi, phi, mu, Elastic(*elastic)


def errors(p: Problem, elements: int) -> np.ndarray:
    """Return the differences between table and elements in F_T, F_A, M_R and the adhesion share, (n, 4)."""
    ellipse, xi, phi, mu, elastic = p
    settings = KalkerSettings(elements=elements, tolerance=1e-5)
    exact = kalker.solve_patch(ellipse, Creepage(xi, 0.0 * xi, phi), mu, elastic, settings)
    found = table.solve_patch(ellipse, xi, phi, mu, elastic)
    capacity = mu * ellipse.normal_force
    arm = np.sqrt(ellipse.semi_axis_lateral * ellipse.semi_axis_rolling)
    off = [
        (getattr(found.resultants, name) - getattr(exact.resultants, name)) / capacity
        for name in ("lateral_force", "driving_force", "spin_moment")
    ]
    return np.stack([*off[:2], off[2] / arm, found.stick_fraction - exact.stick_fraction], axis=1)


def summary(p: Problem, off: np.ndarray) -> dict[str, float]:
    """Return levels of the errors of forces and adhesion share, of like and unlike bodies."""
    out: dict[str, float] = {}
    like, inside = p[4].coupling == 0.0, np.isfinite(off[:, 0])
    for name, rows in (("like", inside & like), ("unlike", inside & ~like)):
        for what, e in (("force", np.abs(off[rows, :3]).max(axis=1)), ("stick", np.abs(off[rows, 3]))):
            out.update({f"{name}_{what}_{label}": float(np.percentile(e, q)) for label, q in LEVELS.items()})
    return out


def measure(tables: spline.Tables) -> dict[str, dict[str, float]]:
    """Return the share of designs outside the table, and its errors on patches of designs and of its whole range."""
    unknown = {"friction_force": (1.0, 1.0, 1.0, 1.0)}  # the errors that the table will state
    with (
        mock.patch.object(spline, "stored", lambda: tables),
        mock.patch.object(CLASSES["kalker_table"], "errors", lambda: unknown),
    ):
        rollers = random_designs(DESIGNS, SEED)
        found = rolling(rollers)
        pick = np.random.default_rng(SEED).permutation(DESIGNS)[: PATCHES // 2]
        own = design_patches([rollers[i] for i in pick], found.isel(case=pick))
        measured = {"range": outside(rollers, found)}
        for name, p in (("designs", own), ("patches", patches(PATCHES, SEED))):
            measured[name] = summary(p, errors(p, ELEMENTS))
        return measured


def write_measured(levels: Sequence[Path], path: Path, report: Path) -> None:
    """Join the levels in the files `levels` to the table `path` with its errors; write all measured numbers to JSON."""
    parts = []
    for file in levels:
        with np.load(file) as arrays:
            parts.append(dict(arrays))
    splines = build.join(parts)
    measured = measure(spline.Tables(**splines, errors={}))
    build.write(path, splines, measured["patches"])
    report.write_text(json.dumps(measured, indent=1) + "\n", encoding="utf-8")
