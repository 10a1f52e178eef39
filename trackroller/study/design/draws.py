"""How each method draws its rows: quantiles, codes or numbers of listed values of each factor.

Each function takes the independent factors, the number of samples, the seed and the options of the method. It returns
(unit, meta) as `trackroller.study.design.sampling.SampledDesign` describes them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.errors import Collector, InputError, nearest, unknown_name
from trackroller.numerics.numbers import read_number
from trackroller.parameters import PARAMETERS
from trackroller.roller.aliases import AXIS_DISTANCE, RADII
from trackroller.study.design import correlation, saltelli
from trackroller.study.design.entries import FACTOR_NAMES, check_own_name, field_value
from trackroller.study.design.evolution import Gene, first_generation
from trackroller.study.design.factors import Factor, column
from trackroller.study.design.kinds import those_with
from trackroller.study.design.replicates import in_turn, sobol_rows
from trackroller.study.design.saltelli import all_groups
from trackroller.study.file.csv import read_rows

MAX_ROWS = 50_000_000  # a larger number is a typing error
Drawn = tuple[np.ndarray, dict[str, Any]]
Factors = Mapping[str, Factor]
Settings = Mapping[str, Any]


def _crossed(outer: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """Return each row of one array beside all rows of another one."""
    return np.concatenate([np.repeat(outer, len(inner), axis=0), np.tile(inner, (len(outer), 1))], axis=1)


def _in_order(places: np.ndarray, names: list[str], free: Factors) -> np.ndarray:
    """Return the columns of places, whose names are given, in the order of the factors."""
    return places[:, [names.index(name) for name in free]]


def check_listed(factors: Factors) -> None:
    """Refuse distributions in a grid."""
    for name, factor in factors.items():
        if not factor.discrete and factor.kind != "expression":
            remedy = "Or choose a sampled design (lhs, sobol, saltelli, morris)."
            raise InputError(f"factors.{name}", factor.kind, "a grid needs values, linspace or logspace", remedy)


def _grid(free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
    check_listed(free)
    shape = tuple(len(f.levels) for f in free.values())
    if np.prod([float(s) for s in shape]) > MAX_ROWS:
        size = f"grid of {' x '.join(map(str, shape))}"
        raise InputError("design", size, f"at most {MAX_ROWS} rows", "Take fewer levels or a sampled design.")
    index = np.indices(shape).reshape(len(shape), int(np.prod(shape))).T  # the last factor runs fastest
    return index.astype(float), {"shape": shape}


def _random(method: str, free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
    entries = tuple(settings.get(correlation.KEY, ()))
    root = correlation.copula(entries, free)
    copies = settings.get("replicates", 1)

    def one(seed: int) -> np.ndarray:
        if method == "lhs":
            from scipy.stats import qmc  # heavy, and a plan of a grid does not need it

            unit = qmc.LatinHypercube(d=len(free), rng=np.random.default_rng(seed)).random(n)
            return correlation.correlate(unit, root, strata=True)
        return correlation.correlate(sobol_rows(len(free), n // copies, seed), root, strata=False)

    return in_turn(one, seed, copies), {correlation.KEY: entries}


def _saltelli(free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
    copies = settings["replicates"]
    blocks = 1 << max(0, n // copies - 1).bit_length()
    second = bool(settings["second_order"])
    meta: dict[str, Any] = {"base_samples": copies * blocks, "second_order": second}
    groups = all_groups(settings["groups"] or {}, free)  # without groups each factor is one of its own
    owner = {name: group for group, members in groups.items() for name in members}
    owners = [owner[name] for name in free]
    order = list(dict.fromkeys(owners))  # groups in the order of their first factors
    if settings["groups"]:
        meta["groups"] = order
    draw = partial(saltelli.draw, blocks, [order.index(owner) for owner in owners], second)
    unit = in_turn(lambda own: draw(own).reshape(blocks, -1, len(free)), seed, copies)
    return unit.reshape(-1, len(free)), meta


def _morris(free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
    """Draw SALib's trajectories; a list moves between a random pair of its different values instead.

    If the values of a list were bins over SALib's four levels, a fifth value would never occur. A step between two
    values would also be divided by the step 2/3 of the unit range, so that mu* of a list would be 1.5 times too large
    beside that of continuous factors.
    """
    from SALib.sample import morris  # heavy, and other designs do not need it

    levels = settings["levels"]
    if not isinstance(levels, int) or levels < 4 or levels % 2:
        raise InputError("design option levels", levels, "an even whole number >= 4")
    count = len(free)
    # a seed for each trajectory, so that more of them leave the first ones as they were
    problem = {"num_vars": count, "names": list(free), "bounds": [[0.0, 1.0]] * count}
    seeds = [int(np.random.SeedSequence([seed, i]).generate_state(1)[0]) for i in range(n)]
    unit = np.concatenate([morris.sample(problem, 1, num_levels=levels, seed=s) for s in seeds])
    # trajectories are independent, so they take turns as they are
    meta = {"trajectories": n, "levels": levels}
    path = unit.reshape(n, count + 1, count)
    drawers = [np.random.default_rng([s, 1]) for s in seeds]
    for j, factor in enumerate(free.values()):
        if factor.discrete:
            pair = np.array([rng.choice(len(factor.levels), 2, replace=False) for rng in drawers])
            moved = path[:, :, j] != path[:, :1, j]
            path[:, :, j] = np.where(moved, pair[:, 1:], pair[:, :1])
    return path.reshape(-1, count), meta


def _coded(method: str, free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
    """Lay a classical design over the continuous factors, repeated for each combination of listed values."""
    numeric = [name for name, f in free.items() if not f.discrete]
    listed = [name for name, f in free.items() if f.discrete]
    if method == "plackett_burman":
        for name in listed:
            if len(free[name].levels) != 2:
                allowed = "plackett_burman takes two values a factor"
                raise InputError(f"factors.{name}", free[name].levels, allowed, "Give two values, or choose morris.")
        numeric, listed = list(free), []
    from trackroller.study.design import arrays  # heavy: pydoe

    coded = getattr(arrays, method)(len(numeric))
    crossing = _grid({name: free[name] for name in listed}, n, seed, {})[0]
    unit = _in_order(_crossed(crossing, coded), [*listed, *numeric], free)
    return unit, {"runs": len(coded), "crossed": listed}


def _inner_outer(free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
    """Repeat one sample of the scattering factors (inner array) at each point of a grid (outer array).

    The same inner sample (common random numbers) keeps chance out of differences; some points may have its first rows.
    """
    outer = {name: f for name, f in free.items() if not f.scatter}
    inner = {name: f for name, f in free.items() if f.scatter}
    if not inner:
        allowed = "design inner_outer needs a factor that scatters (a distribution)"
        raise InputError(
            "factors", list(free), allowed, "Give one factor a distribution such as {normal: [0.1, 0.02]}."
        )
    sample, more = _random(settings["inner"], inner, n, seed, settings)
    index, meta = _grid(outer, 0, 0, {})
    sizes = list(settings["point_samples"]) or [n] * len(index)
    sides = np.repeat(index, sizes, axis=0), np.concatenate([sample[:size] for size in sizes])
    unit = _in_order(np.concatenate(sides, axis=1), [*outer, *inner], free)
    meta |= more | {"outer": list(outer), "inner": list(inner), "inner_samples": n, "design_points": len(index)}
    meta |= {"point_samples": sizes} if min(sizes) < n else {}
    return unit, meta


def genes_of(choices: Factors) -> list[Gene]:
    """Return the kind of each choice for `evolution`."""
    return [Gene(len(f.levels), f.ordered) for f in choices.values()]


def _optimise(free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
    """Cross designs with conditions: lists of conditions among each other, and n rows of those that scatter."""
    choices = {name: f for name, f in free.items() if name not in settings["conditions"]}
    inner = {name: f for name, f in free.items() if name not in choices}
    if not choices:
        remedy = "Give a choice two values or a range, or write roles: {NAME: choice}."
        raise InputError("factors", list(free), "at least one choice of the designer that varies", remedy)
    for name, f in choices.items():
        if not f.discrete and f.kind not in ("uniform", "loguniform"):
            raise InputError(f"factors.{name}", f.kind, "a list, uniform or loguniform: the range of a search")
    if settings["table"] is None:
        genes = first_generation(genes_of(choices), settings["population"], seed)
    else:
        lines = read_rows(Path(settings["table"]), "table", "design", Collector(), most=math.inf).lines
        genes = np.array([[read_number(cell) for cell in line] for line in lines.values()])
    listed, drawn = ({name: f for name, f in inner.items() if f.discrete is discrete} for discrete in (True, False))
    sample = _random("sobol", drawn, n, seed, {})[0] if drawn else np.zeros((1, 0))
    conditions = _crossed(_grid(listed, 0, 0, {})[0], sample)
    unit = _in_order(_crossed(genes, conditions), [*choices, *listed, *drawn], free)
    meta = {"design_points": len(genes), "inner_samples": len(conditions)}
    return unit, meta | {"outer": list(choices), "inner": list(inner)}


DRAW: dict[str, Callable[..., Drawn]] = {
    "optimise": _optimise,
    "grid": _grid,
    "lhs": partial(_random, "lhs"),
    "sobol": partial(_random, "sobol"),
    "saltelli": _saltelli,
    "morris": _morris,
    "inner_outer": _inner_outer,
    **{method: partial(_coded, method) for method in those_with("coded")},
}


def table(path: Any, used: Collection[str] = ()) -> tuple[dict[str, np.ndarray], dict[str, Factor], np.ndarray]:
    """Read the user's own cases from a CSV file.

    Parameters
    ----------
    path : CSV or workbook with one named column a factor
    used : names that expressions use

    Returns
    -------
    Columns (name -> shape (n,)), then as `of_columns`.

    Raises
    ------
    InputError : no such file, a line of another length, an empty cell, or a text where a number is wanted
    """
    wrong = Collector()
    names, head, lines = read_rows(Path(path), "table", "case", wrong, most=math.inf)
    with wrong.part():
        _check_names(names, used, path, head)
    columns = {}
    for j, name in enumerate(names):
        cells = {number: line[j] for number, line in lines.items()}
        numbers = _numbers_of(name, cells)
        columns[name] = _cells_of(name, cells, path, wrong) if numbers is None else numbers
    wrong.check()
    return columns, *of_columns(columns)


def table_lines(path: Path) -> list[int]:
    """Return the number of the line of each case of a table."""
    return list(read_rows(path, "table", "case", Collector(), most=math.inf).lines)


def _check_names(names: list[str], used: Collection[str], path: Any, head: int) -> None:
    """Refuse further columns of a table that look like a misspelt name, and a table with further columns only."""
    own, wrong = [name for name in names if name not in FACTOR_NAMES and name not in used], Collector()
    for name in own:
        with wrong.part():
            check_own_name(name, "table column")
            if name in RADII:
                remedy = f'Add factors: {{axis_distance: {{expression: "{AXIS_DISTANCE}"}}}}.'
                raise InputError("table column", name, "a parameter, or a column that an expression uses", remedy)
            if nearest(name, FACTOR_NAMES) or len(own) == len(names):
                raise unknown_name("table column", name, FACTOR_NAMES)
    for error in wrong.errors:
        error.at(path, head)
    wrong.check()


def _numbers_of(name: str, cells: Mapping[int, str]) -> np.ndarray | None:
    """Return a column of plain numbers that its parameter allows, None for any other column."""
    if name in FACTOR_NAMES and name not in PARAMETERS:
        return None
    try:
        numbers = np.array([read_number(cell) for cell in cells.values()], dtype=float)
    except ValueError:
        return None
    return numbers if name not in PARAMETERS or PARAMETERS[name].accepts(numbers).all() else None


def _cells_of(name: str, cells: Mapping[int, str], path: Any, wrong: Collector) -> np.ndarray:
    """Return a column with words, units or wrong cells; each wrong cell adds an error."""
    values: list[Any] = []
    for number, cell in cells.items():
        try:
            if not cell:
                raise InputError(name, cell, "a value; the cell is empty", "Fill the cell, or remove the line.")
            pair = [part.strip() for part in cell.split("/")] if name == "material_pair" else cell
            values.append(field_value(name, pair, name) if name in FACTOR_NAMES else cell)
        except InputError as error:
            wrong.errors += [one.at(path, number) for one in error.errors]
    return column(values, name in PARAMETERS and not any(isinstance(value, str) for value in values))


def of_columns(columns: Mapping[str, np.ndarray]) -> tuple[dict[str, Factor], np.ndarray]:
    """Return the columns that vary as factors, and `unit` of these: numbers, or the index of other values.

    Parameters
    ----------
    columns : name -> values of all rows, shape (n,)

    Returns
    -------
    Factors by name, and an array of shape (n, number of factors).
    """
    levels = {name: tuple(dict.fromkeys(values.tolist())) for name, values in columns.items()}
    free = {name: Factor(name, "values", levels=own) for name, own in levels.items() if len(own) > 1}
    unit = np.empty((max(map(len, columns.values()), default=0), len(free)))
    for j, (name, factor) in enumerate(free.items()):
        index = {level: i for i, level in enumerate(factor.levels)}
        values = columns[name]
        unit[:, j] = values if factor.ordered else [index[value] for value in values.tolist()]
    return free, unit
