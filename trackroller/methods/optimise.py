"""Search for the best designs by multi-objective evolution over mixed factors.

Factors are real numbers, ordered lists (integers) or categories.

Every generation follows from the seed, its number and the results of all earlier generations alone. A search that was
stopped is therefore replayed from stored results, without a stored state of the search.

The method is NSGA-II [1]_ with the archive of all evaluated designs as the pool of parents: simulated binary crossover
and polynomial mutation for real genes, the same with rounding for ordered lists, exchange and redrawing for categories.
`validation/benchmarks/optimum.py` measures it beside the dense grid and a random search. pymoo 0.6.2 was not taken: its
algorithm for mixed variables covered less of the fronts ZDT1, ZDT2 and of a mixed one after 480 to 960 designs, and it
brings 20 further packages.

References
----------
.. [1] Deb et al. (2002), IEEE Trans. Evol. Comput. 6, 182-197
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trackroller.errors import InputError
from trackroller.methods.grid import Grid
from trackroller.methods.method import METHODS, Drawn, Factors, Method, Settings, crossed, in_order

CROSSOVER = 5.0  # distribution indices: larger ones keep children nearer to their parents
MUTATION = 10.0
CROSSED = 0.9  # share of the children that mix two parents
ROUNDS = 30  # attempts to find children that are new


@dataclass(frozen=True)
class Gene:
    """One free factor of a search.

    Parameters
    ----------
    levels : number of listed values; 0 for a real factor, whose gene is a quantile in [0, 1]
    ordered : whether the listed values go from less to more
    """

    levels: int = 0
    ordered: bool = True


class Optimise(Method):
    """Designs of a search, each at all conditions: lists of conditions in a grid, and `samples` rows of the others."""

    name = "optimise"
    takes = {"conditions": (), "population": 32, "genes": None, "table": None}
    weighted = proposes = True
    judged = ()

    def draw(self, free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
        """Return quantiles or indices of choices and conditions.

        `conditions` are the factors that are no choices. `genes` are the designs, shape (designs, choices), by default
        a first generation of `population` designs.
        """
        choices = {name: f for name, f in free.items() if name not in settings["conditions"]}
        inner = {name: f for name, f in free.items() if name not in choices}
        if not choices:
            remedy = "Give a choice two values or a range, or write roles: {NAME: choice}."
            raise InputError("factors", list(free), "at least one choice of the designer that varies", remedy)
        for name, f in choices.items():
            if not f.discrete and f.kind not in ("uniform", "loguniform"):
                raise InputError(f"factors.{name}", f.kind, "a list, uniform or loguniform: the range of a search")
        genes = settings["genes"]
        if genes is None:
            genes = first_generation(genes_of(choices), settings["population"], seed)
        listed, drawn = ({name: f for name, f in inner.items() if f.discrete is discrete} for discrete in (True, False))
        plain = {"rank_correlations": (), "replicates": 1}
        if drawn:
            sample = METHODS["sobol"].draw(drawn, n, seed, plain)[0]
        else:
            sample = np.zeros((1, 0))
        conditions = crossed(Grid().draw(listed, 0, 0, {})[0], sample)
        unit = in_order(crossed(genes, conditions), [*choices, *listed, *drawn], free)
        meta = {"design_points": len(genes), "inner_samples": len(conditions)}
        return unit, meta | {"outer": list(choices), "inner": list(inner)}


def genes_of(choices: Factors) -> list[Gene]:
    """Return the kind of each choice."""
    return [Gene(len(f.levels), f.ordered) for f in choices.values()]


def nondominated_ranks(costs: np.ndarray, violation: np.ndarray, enough: int | None = None) -> np.ndarray:
    """Return the front of each design: 0 for designs that no other one beats.

    Parameters
    ----------
    costs : smaller is better, shape (n, goals); NaN counts as the worst value
    violation : 0 for a design that meets every constraint, shape (n,). A design with less violation beats any other one
    enough : number of designs after which later fronts are not told apart; by default all of them

    Returns
    -------
    Shape (n,) of int. The time and the memory are proportional to n squared.

    Examples
    --------
    >>> nondominated_ranks(np.array([[0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]), np.zeros(3)).tolist()
    [0, 0, 1]
    """
    equal = violation[:, None] == violation[None]
    no_worse = equal.copy()
    better = np.zeros_like(equal)
    for values in np.where(np.isnan(costs), np.inf, costs).T:
        no_worse &= values[:, None] <= values[None]
        better |= values[:, None] < values[None]
    beats = (no_worse & better) | (violation[:, None] < violation[None])
    beaten_by = beats.sum(axis=0)
    ranks = np.full(len(costs), -1)
    front = 0
    while (ranks < 0).any():
        first = (ranks < 0) & (beaten_by == 0)
        ranks[first] = front
        beaten_by -= beats[first].sum(axis=0)
        front += 1
        if enough is not None and (ranks >= 0).sum() >= enough:
            ranks[ranks < 0] = front
    return ranks


def crowding(costs: np.ndarray) -> np.ndarray:
    """Return the normalised distance between the neighbours of each design of a front, shape (n,); inf at its ends."""
    out = np.zeros(len(costs))
    for values in np.nan_to_num(costs, posinf=np.nan, neginf=np.nan).T:
        finite = values[np.isfinite(values)]
        if not finite.size:
            continue
        values = np.clip(np.nan_to_num(values, nan=finite.max()), finite.min(), finite.max())
        order = np.argsort(values, kind="stable")
        spread = np.ptp(values)
        gaps = np.full(len(values), np.inf)
        gaps[1:-1] = 0.0
        if spread > 0:
            gaps[1:-1] = (values[order[2:]] - values[order[:-2]]) / spread
        out[order] += gaps
    return out


def survivors(costs: np.ndarray, violation: np.ndarray, count: int) -> np.ndarray:
    """Return the indices of the best designs by front, then by crowding, the best one first."""
    ranks = nondominated_ranks(costs, violation, count)
    space = np.zeros(len(costs))
    for front in range(ranks.max(initial=-1) + 1):
        rows = np.flatnonzero(ranks == front)
        space[rows] = crowding(costs[rows])
    return np.lexsort((-space, ranks))[:count]


def first_generation(genes: Sequence[Gene], count: int, seed: int) -> np.ndarray:
    """Return the genes of the first generation, a scrambled Sobol sequence, shape (count, genes); each design once."""
    from scipy.stats import qmc  # heavy, and a plan of a grid does not need it

    size = 1 << max(0, count - 1).bit_length()
    unit = qmc.Sobol(d=len(genes), rng=np.random.default_rng(seed)).random(size)[:count]
    return _new(_snapped(unit * [max(g.levels, 1) for g in genes], genes), np.empty((0, len(genes))), count)


def next_generation(
    genes: Sequence[Gene],
    known: np.ndarray,
    costs: np.ndarray,
    violation: np.ndarray,
    count: int,
    seed: Sequence[int],
) -> np.ndarray:
    """Return the genes of the next generation.

    Parameters
    ----------
    genes : kind of each gene
    known : genes of all evaluated designs, shape (n, genes)
    costs, violation : as for `nondominated_ranks`
    count : number of children
    seed : seed of the search and number of the generation

    Returns
    -------
    Shape (count, genes); fewer if the lists hold no further design, empty if every design is evaluated.
    """
    rng = np.random.default_rng(list(seed))
    parents = known[survivors(costs, violation, count)]
    children = np.empty((0, len(genes)))
    for attempt in range(ROUNDS):
        # a lower index stands for a better parent: of two drawn ones, the better one has children
        mother, father = (parents[rng.integers(0, len(parents), (2, count)).min(axis=0)] for _ in range(2))
        drawn = _mutated(_mixed(mother, father, genes, rng), genes, rng)
        if attempt > ROUNDS // 2:
            drawn = _snapped(rng.random(drawn.shape) * [max(g.levels, 1) for g in genes], genes)
        children = np.concatenate([children, _new(drawn, np.concatenate([known, children]), count - len(children))])
        if len(children) == count:
            return children
    return children


def _mixed(mother: np.ndarray, father: np.ndarray, genes: Sequence[Gene], rng: np.random.Generator) -> np.ndarray:
    """Mix the genes of two parents; a child takes a gene of the mother as it is, or a new one.

    The new gene is the father's, or of an ordered choice a value about both parents by simulated binary crossover (Deb
    and Agrawal 1995), whose `spread` is 1 at the parents themselves.
    """
    out = mother.copy()
    mixed = rng.random(len(out)) < CROSSED
    for j, gene in enumerate(genes):
        u = rng.random(len(out))
        swap = rng.random(len(out)) < 0.5
        side = rng.random(len(out)) < 0.5
        spread = np.where(u < 0.5, (2 * u) ** (1 / (CROSSOVER + 1)), (0.5 / (1 - u)) ** (1 / (CROSSOVER + 1)))
        middle = (mother[:, j] + father[:, j]) / 2
        half = np.abs(mother[:, j] - father[:, j]) / 2
        if gene.ordered:
            child = middle + np.where(side, spread, -spread) * half
        else:
            child = father[:, j]
        out[:, j] = np.where(mixed & swap, child, out[:, j])
    return out


def _mutated(children: np.ndarray, genes: Sequence[Gene], rng: np.random.Generator) -> np.ndarray:
    """Change a gene of each child, on average."""
    for j, gene in enumerate(genes):
        u = rng.random(len(children))
        hit = rng.random(len(children)) < 1 / len(genes)
        step = np.where(u < 0.5, (2 * u) ** (1 / (MUTATION + 1)) - 1, 1 - (2 - 2 * u) ** (1 / (MUTATION + 1)))
        if not gene.ordered:
            moved = rng.integers(0, gene.levels, len(children)).astype(float)
        elif gene.levels:  # at least to the next value
            moved = children[:, j] + np.sign(step) * np.maximum(np.abs(step) * gene.levels, 1.0)
        else:
            moved = children[:, j] + step
        children[:, j] = np.where(hit, moved, children[:, j])
    return _snapped(children, genes, whole=False)


def _snapped(values: np.ndarray, genes: Sequence[Gene], whole: bool = True) -> np.ndarray:
    """Return genes inside their bounds; lists as whole numbers, rounded down (`whole`) or to the nearest one."""
    out = np.array(values, dtype=float)
    shift = 0.5
    if whole:
        shift = 0.0
    for j, gene in enumerate(genes):
        if gene.levels:
            out[:, j] = np.clip(np.floor(out[:, j] + shift), 0, gene.levels - 1)
        else:
            out[:, j] = np.clip(out[:, j], 0.0, 1.0)
    return out


def _new(drawn: np.ndarray, known: np.ndarray, count: int) -> np.ndarray:
    """Return the first designs that differ from each other and from the known ones, at most `count`."""
    seen = {row.tobytes() for row in known}
    rows: list[np.ndarray] = []
    for row in drawn:
        key = row.tobytes()
        if len(rows) < count and key not in seen:
            seen.add(key)
            rows.append(row)
    return np.array(rows).reshape(len(rows), drawn.shape[1])
