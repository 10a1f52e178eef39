"""Random gathered studies of every kind, made without a solver, for tests of the report's sentences.

Designs, categories, regimes, flags and outputs are drawn at random: effects that change sign with a category,
bimodal outputs, ties, unlimited and missing lives, factors with one level, results that lack a variable.
"""

from __future__ import annotations

import itertools

import numpy as np
import xarray as xr
import yaml

KINDS = ("grid", "lhs", "table", "inner_outer", "plackett_burman")
FLAGS = ("half_space", "yield", "static", "conformal", "jamming", "large_slip", "deep_life", "split_pole")
NUMBERS = {
    "friction_coefficient": (0.0, 0.5),
    "roller_profile_radius": (-12.0, -6.1),
    "axial_force": (0.0, 80.0),
    "velocity": (10.0, 90.0),
    "contact_angle": (15.0, 60.0),
}
LISTS = {
    "motor_force": [-20.0, 0.0, 20.0],
    "guide_curve_radius": [-220.0, 220.0, np.inf],
    "material_pair": ["steel / steel", "PA6 / steel", "POM / steel", "bronze / bronze"],
}


def random_study(seed: int) -> xr.Dataset:
    """Return a gathered study with a random design and random results.

    Parameters
    ----------
    seed : of everything that is drawn
    """
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    columns, sizes = _design(kind, rng)
    n = len(next(iter(columns.values())))
    results = _results(columns, n, rng)
    if kind == "grid":
        names = list(columns)
        shaped = {k: ((*names, *dims), v.reshape(*sizes, *v.shape[1:])) for k, (dims, v) in results.items()}
        coords = {name: np.array(list(dict.fromkeys(columns[name].tolist()))) for name in names}
        ds = xr.Dataset(shaped, coords=coords)
    else:
        ds = xr.Dataset({k: (("case", *dims), v) for k, (dims, v) in results.items()})
        ds = ds.assign_coords({k: ("case", v) for k, v in columns.items()}).assign_coords(case=np.arange(n))
    ds = ds.assign_coords(contact=[1, 2], body=["roller", "guide"])
    if "validity" in ds:
        masks = [1 << i for i in range(len(FLAGS))]
        ds["validity"].attrs = {"flag_meanings": " ".join(FLAGS), "flag_masks": masks}
    study = {"name": "random", "design": kind, "factors": {k: {} for k in columns}}
    if limits := _constraints(columns, results, np.random.default_rng([seed, 1])):
        study["constraints"] = limits
    ds.attrs["study"] = yaml.safe_dump(study, sort_keys=False)  # factors in the order of the dimensions
    return ds


def _constraints(columns: dict[str, np.ndarray], results: dict, rng: np.random.Generator) -> list[str]:
    """Return constraints on a factor, a list, a result or the regime as 'name operator value'; often none."""
    limits = ["regime != lift_off"] if "regime" in results else []
    for name, values in {**columns, "peak_stress_roller": results["peak_stress"][1][:, :, 0].max(axis=1)}.items():
        if name in ("material_pair", "motor_force"):
            limits.append(f"{name} != {values[rng.integers(len(values))].item()!r}")
        elif np.isfinite(values).all():
            limits.append(f"{name} {rng.choice(['<', '>='])} {np.quantile(values, rng.uniform(0.2, 0.8)):.4g}")
    return [str(v) for v in rng.permutation(limits)[: rng.integers(0, 3)]] if rng.random() < 0.3 else []


def _design(kind: str, rng: np.random.Generator) -> tuple[dict[str, np.ndarray], list[int]]:
    """Return the columns of the factors, (n,), and the number of levels of each factor of a grid."""
    numbers = [str(n) for n in rng.permutation(list(NUMBERS))][: rng.integers(1, 5)]
    lists = [str(n) for n in rng.permutation(list(LISTS))][: rng.integers(0, 3)]
    levels: dict[str, list] = {}
    for name in numbers:
        low, high = NUMBERS[name]
        count = 2 if kind == "plackett_burman" else int(rng.integers(1, 7))
        levels[name] = sorted({float(f"{v:.3g}") for v in rng.uniform(low, high, count)})
    for name in lists:
        levels[name] = LISTS[name][: rng.integers(1, len(LISTS[name]) + 1)]
    if kind == "grid":
        rows = list(itertools.product(*levels.values()))
        columns = {name: np.array([row[i] for row in rows]) for i, name in enumerate(levels)}
        return columns, [len(v) for v in levels.values()]
    n = int(rng.integers(3, 420))
    drawn = {name: rng.uniform(*NUMBERS[name], n) for name in numbers}
    listed = {name: rng.choice(np.array(levels[name]), n) for name in (levels if kind != "lhs" else lists)}
    if kind == "inner_outer":
        outer = list(itertools.product(*(levels[name] for name in levels if name != numbers[0])))
        inner = int(rng.integers(2, 60))
        columns = {numbers[0]: np.tile(drawn[numbers[0]][: min(inner, n)], len(outer))}
        step = len(columns[numbers[0]]) // len(outer)
        for i, name in enumerate(name for name in levels if name != numbers[0]):
            columns[name] = np.repeat(np.array([row[i] for row in outer]), step)
        return columns, []
    return (drawn | listed if kind == "lhs" else listed), []


def _results(columns: dict[str, np.ndarray], n: int, rng: np.random.Generator) -> dict:
    """Return made-up results of n cases by name: the dimensions after `case`, and the values."""
    codes = {name: np.unique(v, return_inverse=True)[1] for name, v in columns.items()}
    unit = {name: code / max(code.max(), 1) for name, code in codes.items()}
    name = list(codes)[int(rng.integers(len(codes)))]
    turned = np.where(codes[name] % 2, -1.0, 1.0) if rng.random() < 0.4 else 1.0  # Simpson's paradox
    logs = sum(rng.normal(0, rng.choice([0.0, 0.3, 1.0])) * u for u in unit.values()) * turned
    logs = logs + rng.normal(0, rng.choice([0.0, 0.0, 0.05, 0.5]), n)
    logs = logs + (3.0 * (rng.random(n) < 0.5) if rng.random() < 0.3 else 0.0)  # two modes
    logs = np.round(logs, 1) if rng.random() < 0.3 else logs  # ties
    life = 10 ** (3 + logs)
    life[rng.random(n) < rng.choice([0.0, 0.1])] = np.inf
    life[rng.random(n) < rng.choice([0.0, 0.1])] = np.nan
    results = {"roller_life_hours": ((), life)} if rng.random() < 0.85 else {}
    stress = 100 * 10 ** (0.3 * logs + rng.normal(0, 0.01, n))
    peak = stress[:, None, None] * rng.uniform(0.8, 1.0, (n, 2, 2))
    results["peak_stress"] = (("contact", "body"), peak)
    results["peak_z"] = (("contact", "body"), rng.uniform(0, 1, (n, 2, 2)) * (rng.random((n, 2, 2)) < rng.random()))
    if rng.random() < 0.5:
        results["error_estimate"] = (("contact", "body"), rng.lognormal(-6, 1, (n, 2, 2)))
    if rng.random() < 0.5:
        residual = rng.lognormal(rng.choice([-5.0, -1.0, 0.3]), 0.5, n)
        results["energy_residual"] = ((), np.where(rng.random(n) < 0.1, np.nan, residual))
    if rng.random() < 0.85:
        results["regime"] = ((), _regimes(codes, n, rng).astype(np.int8))
    if rng.random() < 0.8:
        body = np.zeros((n, 2), dtype=np.int32)
        for bit in range(len(FLAGS)):
            hit = (rng.random((n, 2)) < rng.choice([0.0, 0.0, 0.02, 0.3])) & _corner(codes, n, rng)[:, None]
            body |= np.where(hit, 1 << bit, 0)
        results["validity"] = ((), body[:, 0] | body[:, 1])
        if rng.random() < 0.6:
            results["validity_body"] = (("body",), body)
    if rng.random() < 0.5:
        results["converged"] = ((), (rng.random(n) < 0.95).astype(np.int8))
    return results


def _corner(codes: dict[str, np.ndarray], n: int, rng: np.random.Generator) -> np.ndarray:
    """Return the rows in a corner of the design, (n,): the upper or lower levels of some factors."""
    inside = np.ones(n, dtype=bool)
    for code in codes.values():
        if rng.random() < 0.3:
            inside &= code >= code.max() / 2 if rng.random() < 0.5 else code <= code.max() / 2
    return inside


def _regimes(codes: dict[str, np.ndarray], n: int, rng: np.random.Generator) -> np.ndarray:
    regime = np.zeros(n, dtype=int)
    for code in (1, 2, 3):
        share = rng.choice([0.0, 0.03, 0.4, 1.0]) if code < 3 else rng.choice([0.0, 0.02])
        if code == 2 and rng.random() < 0.4:  # at every level, but more often at some
            first = codes[next(iter(codes))]
            rising = first / max(first.max(), 1)
            regime[rng.random(n) < 0.1 + 0.6 * rising] = code
            continue
        regime[(rng.random(n) < share) & _corner(codes, n, rng)] = code
    return regime
