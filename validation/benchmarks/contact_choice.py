"""Measures how far the cheaper contact models lie from the exact theory; makes the map behind `contact_model="auto"`.

    python -m validation.benchmarks.contact_choice sample --cases 800 --seed 1 --output designs.npz     0.1 s a case
    python -m validation.benchmarks.contact_choice sample --cases 500 --seed 2101 --exact standard --output exact.npz
    python -m validation.benchmarks.contact_choice map exact.npz designs.npz    writes the map
    python -m validation.benchmarks.contact_choice check fresh.npz    its coverage on another sample, kept there

A random sample of designs over friction, angles, radii, curves, loads, materials and drive, wider than what anybody
builds, is solved with all three models. At `preview` the exact theory is the table that `auto` compares with, which
serves for peak stresses; what the table itself is off takes a sample with `--exact standard`, as does an honest check.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
from pathlib import Path
from typing import Any

import numpy as np

import trackroller as tr
from trackroller.roller.case import to_table
from trackroller.roller.choice import choose as choice
from trackroller.roller.options import Options
from validation.benchmarks.peak_coverage import random_case

COVERAGE, TABLE_COVERAGE, SMALLEST = 0.98, 0.99, 1e-5
FACTOR = 1.2  # of the difference of the forces from the table, for materials more unlike than it holds
TOLERANCES = (0.01, 0.02, 0.05, 0.1, 0.2)
MODELS = ("sliding", "fastsim", "kalker")
KEPT = (
    "normal_force",
    "lateral_force",
    "driving_force",
    "spin_moment",
    "semi_axis_lateral",
    "semi_axis_rolling",
    "rolling_radius_shift",
    "stick_area_fraction",
    "peak_stress",
    "regime",
    "converged",
    "residual",
)
BATCH = 20


def sample(n: int, seed: int) -> list[tr.Case]:
    """`n` designs; friction log-uniform from 0.01 to 1, everything else as in peak_coverage.py."""
    rng = np.random.default_rng(seed)
    cases: list[tr.Case] = []
    while len(cases) < n:
        friction = 10 ** rng.uniform(-2, 0)
        try:
            cases.append(dataclasses.replace(random_case(rng), friction_coefficient=friction))
        except tr.InputError:
            continue
    return cases


def solve_all(cases: list[tr.Case], exact: str = "preview") -> dict[str, np.ndarray]:
    """Quantities of all models, arrays (model, n, ...); the exact theory at the accuracy `exact`."""
    accuracy = {"sliding": "standard", "fastsim": "preview", "kalker": exact}
    parts: dict[str, list[Any]] = {name: [] for name in KEPT}
    for i in range(0, len(cases), BATCH):
        found = [
            tr.solve(
                cases[i : i + BATCH],
                outputs=("forces", "contact", "peak_stress"),
                contact_model=m,
                accuracy=accuracy[m],
            )
            for m in MODELS
        ]
        for name in KEPT:
            parts[name].append(np.stack([ds[name].values for ds in found]))
        print(f"{min(i + BATCH, len(cases))} of {len(cases)}", file=sys.stderr, flush=True)
    return {name: np.concatenate(p, axis=1) for name, p in parts.items()}


def error_parts(found: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Errors of the forces and of the peak stress by cheaper model, shape (2, model, n); and which cases roll, (n,).

    They are those of `contact_choice`; inf for another regime, or where the cheaper model did not converge.
    """
    f = {name: value.astype(float) for name, value in found.items() if name in KEPT}
    normal, square = f["normal_force"][-1], f["semi_axis_lateral"][-1] * f["semi_axis_rolling"][-1]
    out = []
    for k in range(len(MODELS) - 1):
        with np.errstate(invalid="ignore"):
            parts = [np.abs(f["normal_force"][k] / normal - 1.0)]
            parts += [np.abs(f[n][k] - f[n][-1]) / normal for n in ("lateral_force", "driving_force")]
            parts.append(np.abs(f["spin_moment"][k] - f["spin_moment"][-1]) / (normal * np.sqrt(square)))
            peak = np.abs(f["peak_stress"][k] / f["peak_stress"][-1] - 1.0).max(axis=(1, 2))
            two = np.stack([np.max(np.stack(parts), axis=(0, 2)), peak])
        out.append(np.where((f["regime"][k] == f["regime"][-1]) & np.all(np.isfinite(two), axis=0), two, np.inf))
    return np.stack(out, axis=1), (f["regime"][-1] == 0) & (f["converged"][-1] == 1)


def errors(found: dict[str, np.ndarray]) -> np.ndarray:
    """The larger of both errors by model, shape (model, n).

    Cases that do not roll by the exact theory are NaN if they do not by the cheaper model either, else inf.
    """
    parts, rolls = error_parts(found)
    same = found["regime"][:-1] == found["regime"][-1]
    return np.where(rolls, parts.max(axis=0), np.where(same, np.nan, np.inf))


def fit(x: np.ndarray, log_error: np.ndarray, weight: float = 1e-2) -> np.ndarray:
    """Least squares with a slight preference for small coefficients."""
    m = choice.monomials(x)
    return np.linalg.solve(m.T @ m + weight * np.eye(m.shape[1]), m.T @ log_error)


def held_out(z: np.ndarray, log_error: np.ndarray, folds: int = 8) -> np.ndarray:
    """Residuals of designs that a fit has not seen."""
    left, fold = np.empty(len(z)), np.arange(len(z)) % folds
    for k in range(folds):
        out = fold == k
        left[out] = log_error[out] - choice.monomials(z[out]) @ fit(z[~out], log_error[~out])
    return left


def make_map(cases: list[tr.Case], found: dict[str, np.ndarray], finest: np.ndarray) -> dict[str, np.ndarray]:
    """Range; by model the scales, coefficients and margin for the peak stress, and what the table adds to the forces.

    `finest` (n,): designs whose exact theory was that of `standard` and not that of the table itself.
    """
    table, (error, rolls) = to_table(cases, None), error_parts(found)
    options = Options(contact_model="auto")
    x, exact = choice.features(table), choice.probe(table, options)
    rolls &= np.all(np.isfinite(x), axis=1) & exact.rolls
    out: dict[str, list[np.ndarray]] = {}
    for k, name in enumerate(choice.CHEAPER):
        force = choice.force_error(table, options, name, exact)
        good = rolls & np.isfinite(force) & np.isfinite(error[0, k])
        z = choice.peak_features(x, exact.numbers(), force)[good]
        log_error = np.log(np.clip(error[1, k][good], SMALLEST, 1.0))
        centre, width = z.mean(axis=0), z.std(axis=0)
        z = (z - centre) / width
        left = held_out(z, log_error)
        more = np.full(len(x), np.nan)
        more[good] = (error[0, k][good] - FACTOR * force[good]) / exact.friction[good]
        beyond = choice.beyond_table(x)
        table_error = [
            max(np.quantile(more[good & finest & kind], TABLE_COVERAGE, method="higher"), 0.0)
            for kind in (~beyond, beyond)
        ]
        told = {
            "centre": centre,
            "width": width,
            "coefficients": fit(z, log_error),
            "factor": np.array(FACTOR),
            "margin": np.quantile(left, COVERAGE, method="higher"),
            "table_error": np.array(table_error),
        }
        print(
            f"{name}: {good.sum()} designs, margin {np.exp(told['margin']):.2f}, spread {left.std():.2f}; "
            f"table {table_error[0]:.4f}, {table_error[1]:.4f} of mu ({(good & finest).sum()} designs)"
        )
        for key, value in told.items():
            out.setdefault(key, []).append(np.asarray(value))
    for row in out["table_error"]:  # one table for both models
        row[0] = max(r[0] for r in out["table_error"])
    lower, upper, names = x[rolls].min(axis=0), x[rolls].max(axis=0), list(choice.FEATURES)
    upper[names.index("lift")] = 0.0  # no axial force, which a random draw never gives
    lower[names.index("drive")] = 0.0
    return {
        **{key: np.array(values) for key, values in out.items()},
        "lower": lower,
        "upper": upper,
        "coverage": np.array(COVERAGE),
        "designs": np.array(int(rolls.sum())),
    }


def check(cases: list[tr.Case], found: dict[str, np.ndarray], tolerances=TOLERANCES) -> dict[str, np.ndarray]:
    """By tolerance: share of each model, share of designs within it, and among those with a cheaper model."""
    table, error = to_table(cases, None), errors(found)
    rolls = ~np.any(np.isnan(error), axis=0)
    shares, met, met_cheaper = [], [], []
    for tolerance in tolerances:
        chosen = choice.choose(table, Options(contact_model="auto", contact_tolerance=tolerance))[rolls]
        own = np.select([chosen == m for m in choice.CHEAPER], error[:, rolls], 0.0)
        shares.append([np.mean(chosen == m) for m in MODELS])
        met.append(np.mean(own <= tolerance))
        cheap = chosen != MODELS[-1]
        met_cheaper.append(np.mean(own[cheap] <= tolerance) if cheap.any() else np.nan)
    return {
        "tolerances": np.array(tolerances),
        "shares": np.array(shares),
        "met": np.array(met),
        "met_cheaper": np.array(met_cheaper),
        "checked": np.array(int(rolls.sum())),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("sample", "map", "check"))
    parser.add_argument("files", nargs="*", type=Path, help="samples")
    parser.add_argument("--cases", type=int, default=800)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--exact", default="preview", help="accuracy of the exact theory")
    parser.add_argument("--output", type=Path, default=Path("designs.npz"))
    options = parser.parse_args()
    if options.what == "sample":
        found = solve_all(sample(options.cases, options.seed), options.exact)
        np.savez_compressed(options.output, n=options.cases, seed=options.seed, exact=options.exact, **found)  # type: ignore[arg-type]
        return 0
    target = Path(choice.__file__).with_name(choice.MAP)
    found = {p: dict(np.load(p, allow_pickle=False)) for p in options.files}
    cases = {p: sample(int(f["n"]), int(f["seed"])) for p, f in found.items()}
    every = [c for p in options.files for c in cases[p]]
    joined = {name: np.concatenate([f[name] for f in found.values()], axis=1) for name in KEPT}
    finest = np.concatenate([np.full(int(f["n"]), str(f["exact"]) != "preview") for f in found.values()])
    arrays = make_map(every, joined, finest) if options.what == "map" else dict(choice.stored())
    if options.what == "check":
        arrays.update(check(every, joined))
        for name in ("tolerances", "shares", "met", "met_cheaper", "checked"):
            print(name, arrays[name].round(4).tolist())
    np.savez_compressed(target, **arrays)  # type: ignore[arg-type]
    choice.stored.cache_clear()
    return 0


if __name__ == "__main__":
    sys.exit(main())
