"""How each method draws its rows: quantiles or codes in the unit cube, then values of each factor.

Each function takes the independent factors, the number of samples, the seed and the method's settings, and
returns (columns, unit, meta) as `trackroller.study.design.sampling.SampledDesign` describes them.
"""

from __future__ import annotations

import csv
import itertools
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.errors import InputError, unknown_name
from trackroller.parameters import PARAMETERS
from trackroller.study.design import arrays as designs
from trackroller.study.design.factors import TAIL, Factor, column
from trackroller.study.design.grown_lhs import check_sizes, grown_lhs

MAX_ROWS = 50_000_000  # more rows than this are a typing error, not a study
Drawn = tuple[dict[str, np.ndarray], np.ndarray, dict[str, Any]]


def _map(free: Mapping[str, Factor], unit: np.ndarray, tail: float = 0.0) -> dict[str, np.ndarray]:
    return {name: f.from_unit(unit[:, j], tail) for j, (name, f) in enumerate(free.items())}


def _grid(free: Mapping[str, Factor], n: int, seed: int, settings: Mapping[str, Any]) -> Drawn:
    for name, factor in free.items():
        if not factor.discrete:
            raise InputError(
                f"factors.{name}",
                factor.kind,
                "a grid needs values, linspace or logspace",
                "Or choose a sampled design (lhs, sobol, saltelli, morris).",
            )
    shape = tuple(len(f.levels) for f in free.values())
    if np.prod([float(s) for s in shape]) > MAX_ROWS:
        raise InputError(
            "design",
            f"grid of {' x '.join(map(str, shape))}",
            f"at most {MAX_ROWS} rows",
            "Take fewer levels or a sampled design.",
        )
    index = np.indices(shape).reshape(len(shape), int(np.prod(shape))).T  # the last factor runs fastest
    columns = {name: f.take(index[:, j]) for j, (name, f) in enumerate(free.items())}
    return columns, index.astype(float), {"shape": shape}


def _random(free: Mapping[str, Factor], n: int, seed: int, method: str, earlier: Any) -> np.ndarray:
    if method == "lhs":
        return grown_lhs(len(free), [*check_sizes(earlier, n), n], seed)
    from scipy.stats import qmc

    engine = qmc.Sobol(d=len(free), rng=np.random.default_rng(seed))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # balance of a Sobol sequence off a power of two
        return engine.random(n)


def _lhs(free: Mapping[str, Factor], n: int, seed: int, settings: Mapping[str, Any]) -> Drawn:
    unit = _random(free, n, seed, "lhs", settings["grown_from"])
    return _map(free, unit), unit, {}


def _sobol(free: Mapping[str, Factor], n: int, seed: int, settings: Mapping[str, Any]) -> Drawn:
    unit = _random(free, n, seed, "sobol", ())
    return _map(free, unit), unit, {}


def _problem(free: Mapping[str, Factor]) -> dict[str, Any]:
    return {"num_vars": len(free), "names": list(free), "bounds": [[0.0, 1.0]] * len(free)}


def _saltelli(free: Mapping[str, Factor], n: int, seed: int, settings: Mapping[str, Any]) -> Drawn:
    from SALib.sample import sobol

    blocks = 1 << max(0, n - 1).bit_length()
    second = bool(settings["second_order"])
    unit = sobol.sample(_problem(free), blocks, calc_second_order=second, seed=seed)
    return _map(free, unit), unit, {"base_samples": blocks, "second_order": second}


def _morris(free: Mapping[str, Factor], n: int, seed: int, settings: Mapping[str, Any]) -> Drawn:
    """Trajectories of SALib; a listed factor moves between a random pair of its different values instead.

    A category mapped from SALib's four levels by bins would never show its fifth value, and its whole steps
    would be divided by 2/3: mu* would be 1.5 times too large beside continuous factors.
    """
    from SALib.sample import morris

    levels = settings["levels"]
    if not isinstance(levels, int) or levels < 4 or levels % 2:
        raise InputError("design option levels", levels, "an even whole number >= 4")
    count = len(free)
    # a seed for each trajectory, so that more of them leave the first ones as they were
    seeds = [int(np.random.SeedSequence([seed, i]).generate_state(1)[0]) for i in range(n)]
    unit = np.concatenate([morris.sample(_problem(free), 1, num_levels=levels, seed=s) for s in seeds])
    path = unit.reshape(n, count + 1, count)
    drawers = [np.random.default_rng([s, 1]) for s in seeds]
    columns = {}
    for j, (name, factor) in enumerate(free.items()):
        if not factor.discrete:
            columns[name] = factor.from_unit(unit[:, j], TAIL)
            continue
        pair = np.array([rng.choice(len(factor.levels), 2, replace=False) for rng in drawers])
        moved = path[:, :, j] != path[:, :1, j]
        path[:, :, j] = np.where(moved, pair[:, 1:], pair[:, :1])
        columns[name] = factor.take(path[:, :, j].ravel())
    return columns, path.reshape(-1, count), {"trajectories": n, "levels": levels}


def _coded(free: Mapping[str, Factor], method: str) -> Drawn:
    """Response-surface designs over continuous factors, repeated for each combination of listed values."""
    numeric = [name for name, f in free.items() if not f.discrete]
    listed = [name for name, f in free.items() if f.discrete]
    if method == "plackett_burman":
        for name in listed:
            if len(free[name].levels) != 2:
                raise InputError(
                    f"factors.{name}",
                    free[name].levels,
                    "plackett_burman takes two values a factor",
                    "Give two values, or choose morris.",
                )
        numeric, listed = list(free), []
    coded = getattr(designs, method)(len(numeric))
    combinations = list(itertools.product(*[range(len(free[k].levels)) for k in listed]))
    crossing = np.array(combinations, dtype=float).reshape(len(combinations), len(listed))
    unit = np.empty((len(crossing) * len(coded), len(free)))
    columns = {}
    for j, (name, factor) in enumerate(free.items()):
        if name in listed:
            unit[:, j] = np.repeat(crossing[:, listed.index(name)], len(coded))
            columns[name] = factor.take(unit[:, j])
        else:
            unit[:, j] = np.tile(coded[:, numeric.index(name)], len(crossing))
            columns[name] = factor.from_unit((unit[:, j] + 1) / 2, TAIL)
    return columns, unit, {"runs": len(coded), "crossed": listed}


def _nested(free: Mapping[str, Factor], n: int, seed: int, settings: Mapping[str, Any]) -> Drawn:
    """Grid of design points outside, the same scatter sample inside each (common random numbers)."""
    outer = {name: f for name, f in free.items() if not f.scatter}
    inner = {name: f for name, f in free.items() if f.scatter}
    if not inner:
        raise InputError("factors", list(free), "a nested study needs a factor that scatters (a distribution)")
    if settings["inner"] not in ("lhs", "sobol"):
        raise unknown_name("design option inner", settings["inner"], ("lhs", "sobol"))
    unit_in = _random(inner, n, seed, settings["inner"], settings["grown_from"])
    points, index, meta = _grid(outer, 0, 0, {}) if outer else ({}, np.zeros((1, 0)), {"shape": ()})
    count = len(index)
    drawn = _map(inner, unit_in)
    columns = {name: np.repeat(values, n) for name, values in points.items()}
    columns |= {name: np.tile(values, count) for name, values in drawn.items()}
    unit = np.empty((count * n, len(free)))
    for j, name in enumerate(free):
        unit[:, j] = (
            np.repeat(index[:, list(outer).index(name)], n)
            if name in outer
            else np.tile(unit_in[:, list(inner).index(name)], count)
        )
    meta |= {"outer": list(outer), "inner": list(inner), "inner_samples": n, "design_points": count}
    return columns, unit, meta


DRAW: dict[str, Callable[..., Drawn]] = {
    "grid": _grid,
    "lhs": _lhs,
    "sobol": _sobol,
    "saltelli": _saltelli,
    "morris": _morris,
    "nested": _nested,
    **{
        m: (lambda free, n, seed, settings, m=m: _coded(free, m))
        for m in ("central_composite", "box_behnken", "plackett_burman")
    },
}


def table(path: Any) -> tuple[dict[str, np.ndarray], dict[str, Factor], np.ndarray, dict[str, Any]]:
    """The user's own cases: a CSV with one named column a factor; columns that vary are the factors."""
    if path is None or not Path(path).is_file():
        raise InputError("table", path, "the path of a CSV file with one column a factor")
    with open(path, newline="", encoding="utf-8-sig") as stream:
        lines = [line for line in csv.reader(stream) if any(cell.strip() for cell in line)]
    if len(lines) < 2:
        raise InputError("table", str(path), "a CSV with a line of names and at least one case")
    names = [name.strip() for name in lines[0]]
    if len(set(names)) < len(names) or not all(names):
        raise InputError("table", ", ".join(names), "each column needs a name of its own")
    for number, line in enumerate(lines[1:], start=2):
        if len(line) != len(names) or not all(cell.strip() for cell in line):
            raise InputError("table", f"{path}, line {number}", f"{len(names)} values are wanted, none empty")
    columns: dict[str, np.ndarray] = {}
    for j, name in enumerate(names):
        cells = [line[j].strip() for line in lines[1:]]
        try:
            columns[name] = column([float(cell) for cell in cells], numeric=True)
        except ValueError:
            if name in PARAMETERS:
                raise InputError("table", f"column {name}", PARAMETERS[name].allowed()) from None
            columns[name] = column(cells, numeric=False)
    free = {
        name: Factor(name, "values", levels=tuple(dict.fromkeys(c.tolist())))
        for name, c in columns.items()
        if len(set(c.tolist())) > 1
    }
    unit = np.array([[f.levels.index(v) for v in columns[name]] for name, f in free.items()], dtype=float)
    return columns, free, unit.reshape(len(free), -1).T if free else np.zeros((len(lines) - 1, 0)), {}
