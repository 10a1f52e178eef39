"""What every design of experiments is: how it draws rows, what they can be used for, and how it
analyses them.

A method is one class in one file of this room, registered once. Study file, schema, plan, analysis
and report take everything that they ask of a design from its class, so none of them asks for a
method by its name.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeVar

import numpy as np

from trackroller.errors import InputError
from trackroller.methods.factor import Factor

# a share of variance or a probability whose 95 % interval has at most this half width is known
HALF_WIDTH = 0.05
Estimates = dict[str, np.ndarray]
# places of the rows and numbers of the method, see `Design`
Drawn = tuple[np.ndarray, dict[str, Any]]
Factors = Mapping[str, Factor]
Settings = Mapping[str, Any]


class Key(NamedTuple):
    """A key of the study file that one method takes."""

    kind: Any  # type of its value
    default: Any
    meaning: str


class Index(NamedTuple):
    """An index that a method gives: its words, and what its numbers are.

    Parameters
    ----------
    words : name of the index in tables and data sets
    sized : whether it has the unit of the output; otherwise it is a share or another number without
        a unit
    signed : whether it may be negative, so that its size counts whatever its sign
    of_factor : whether tables show it beside each factor
    """

    words: str
    sized: bool = False
    signed: bool = False
    of_factor: bool = False


class Estimated(NamedTuple):
    """Estimates for one output, how many rows, blocks, effects or cells they used, and the sizes of
    their course.
    """

    estimates: Estimates
    used: int
    total: int
    sizes: np.ndarray = np.zeros(0, dtype=int)


@dataclass(frozen=True)
class Design:
    """The rows of a design and the facts that an analysis needs.

    Parameters
    ----------
    columns : every factor, derived ones included: name -> shape (n,), float, or object for
        categories
    factors : the independent factors by name; indices are given for them
    method : how the rows were drawn
    unit : shape (n, number of factors) [1]: quantiles; codes -1..1 in classical designs; the index
        of the listed value for a list in a grid, an inner/outer array or a Morris design
    meta : numbers of the method (base_samples, second_order, levels, shape, inner_samples, ...)
    """

    columns: dict[str, np.ndarray]
    factors: dict[str, Factor]
    method: Method
    unit: np.ndarray
    meta: dict[str, Any] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Return the number of rows."""
        if self.columns:
            return len(next(iter(self.columns.values())))
        return 0

    @property
    def samples(self) -> int:
        """Return the number of base samples, trajectories, samples of the largest design point, or
        rows.
        """
        counts = (
            self.meta[key]
            for key in ("base_samples", "trajectories", "inner_samples")
            if key in self.meta
        )
        return int(next(counts, self.size))

    @property
    def places(self) -> np.ndarray:
        """Return `unit` with the index of the listed value for every list, also in random
        samples.
        """
        places = self.unit.copy()
        for j, factor in enumerate(self.factors.values()):
            if factor.discrete and self.method.random(factor):
                places[:, j] = factor.bin(self.unit[:, j])
        return places

    @property
    def ordered(self) -> np.ndarray:
        """Return for which factors more and less mean something, shape (number of factors,)."""
        return np.array([f.ordered for f in self.factors.values()], dtype=bool)

    @property
    def listed(self) -> np.ndarray:
        """Return which factors are lists, shape (number of factors,)."""
        return np.array([f.discrete for f in self.factors.values()], dtype=bool)

    @property
    def points(self) -> list[slice]:
        """Return the rows of each design point of a method with `points`."""
        sizes = (
            self.meta.get("point_samples")
            or [self.meta["inner_samples"]] * self.meta["design_points"]
        )
        return [
            slice(end - size, end)
            for size, end in zip(sizes, itertools.accumulate(sizes), strict=True)
        ]


class Method:
    """A design of experiments. A class of its own states its name, `draw` and whatever differs from
    this class.

    Attributes
    ----------
    name : word for `design` in a study file
    takes : settings that other designs refuse, with the values that they have if they are not
        given; a `Key` adds a key to the study file
    sampled : whether the key `samples` counts, and the rows are drawn at random
    weighs : whether the values of a list are drawn at random, in proportion to their weights
    weighted : whether rows have known weights, so that they give probabilities of a target
    grows : whether more samples keep the rows of fewer samples, so that the key `until` can double
        them
    crossed : whether the rows are the full grid of all lists, which become dimensions of the
        results
    observed : whether the rows are the user's own, so that nothing is known of how the factors
        depend on each other
    subset : whether any rows of the design are a smaller design of the same method
    points : whether one sample is repeated at each of several design points, which are compared
    proposes : whether the next designs follow from results, so that rows are no even sample and
        have no indices
    quick : whether the analysis leaves out the measures of given data, which take longer than all
        others
    tail : quantile [1] at which an unbounded factor is cut, for designs that visit the ends of a
        range
    first_look : samples of a replicate at the first look of the key `until`
    indices : every index that the analysis gives, by the name of its estimate and in the order of
        tables
    headline : index that ranks the factors; `first` if the analysis does not have it
    narrowed : indices whose intervals the key `until` narrows
    judged : indices whose intervals say whether there are samples enough; empty for a design
        without an interval
    effects : whether these indices have the unit of the output, and count relative to the largest
        of them
    half_width : half width of an interval that counts as narrow
    needs : what the indices need, in words
    unit, samples_unit : what an index and the key `samples` count, in the plural
    whole : what the rows are where their shares are no probabilities; '' for a random sample
    uncorrelated : why the design takes no rank correlations, or what to take instead
    reference : subject and paper for the page on methods
    """

    name: str
    takes: Mapping[str, Any] = {}
    sampled = weighs = weighted = grows = crossed = observed = subset = points = proposes = (
        quick
    ) = False
    tail = 0.0
    first_look = 8
    indices: Mapping[str, Index] = {}
    headline = "first"
    narrowed: tuple[str, ...] = ("first",)
    judged: tuple[str, ...] = ("first",)
    effects = False
    half_width = HALF_WIDTH
    needs = ""
    unit = samples_unit = "rows"
    whole = ""
    uncorrelated = "This design has fixed combinations of values. Take method: lhs."
    reference: tuple[str, str] | None = None

    def draw(self, free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
        """Draw the rows.

        Parameters
        ----------
        free : the independent factors
        n : number of samples. If the method `grows`, the rows of a larger number begin with those
            of a smaller one (of each design point, if it has `points`)
        seed : the same seed gives the same rows
        settings : values of what the method `takes`

        Returns
        -------
        `unit` and `meta` of `Design`.
        """
        raise NotImplementedError

    def check(self, free: Factors) -> None:
        """Refuse factors that the design cannot take; raise `InputError`."""

    def random(self, factor: Factor) -> bool:
        """Return whether the design draws the values of a factor at random, so that its place is a
        quantile.
        """
        return self.weighs

    def values(self, factor: Factor, places: np.ndarray) -> np.ndarray:
        """Return the values of a factor at its places, a column of `Design.unit`, shape (n,)."""
        if factor.discrete and not self.random(factor):
            return factor.take(places)
        return factor.from_unit(places, self.tail)

    def estimate(self, y: np.ndarray, design: Design) -> Estimated:
        """Return the indices of one output.

        Parameters
        ----------
        y : output, shape (n,), NaN where unusable
        design : the rows
        """
        raise NotImplementedError

    def from_replicates(
        self, y: np.ndarray, unit: np.ndarray, design: Design, member: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the indices of `narrowed` one after the other, and the half widths of their
        intervals.

        Parameters
        ----------
        y, unit : output and places of the first rows, shape (n,) and (n, k)
        design : the whole design
        member : replicate of each base sample, trajectory or row
        """
        raise NotImplementedError

    def replicated(self, y: np.ndarray, design: Design, samples: int) -> Estimates:
        """Estimate the indices of `narrowed` from the first samples, with intervals from
        independent replicates.

        Parameters
        ----------
        y : output, shape (n,), NaN where unusable
        design : a design with replicates
        samples : number of base samples, trajectories or rows, a multiple of the replicates

        Returns
        -------
        Each index with _low and _high, shape (k,); NaN if too few rows are usable or the output is
        constant.
        """
        copies = int(design.meta["replicates"])
        count = len(design.factors)
        rows = len(y) // design.samples
        y = y[: samples * rows]
        unit = design.places[: samples * rows]
        values, half = self.from_replicates(y, unit, design, np.arange(samples) % copies)
        out: Estimates = {}
        for i, name in enumerate(self.narrowed):
            value, wide = (part[i * count : (i + 1) * count] for part in (values, half))
            out |= {name: value, f"{name}_low": value - wide, f"{name}_high": value + wide}
        return out

    def group_indices(
        self, y: np.ndarray, design: Design, groups: Mapping[str, Sequence[str]]
    ) -> Estimates:
        """Estimate the first-order and the total index of groups of factors.

        Parameters
        ----------
        y, design : as in `estimate`
        groups : name -> factors; together they hold each factor once

        Returns
        -------
        group_S1, the share of variance Var(E[y | group]) / V, and group_ST, one minus that of all
        other factors, shape (groups,), with _low and _high unless they are exact. Valid for
        independent factors.
        """
        raise NotImplementedError

    def level_indices(
        self, y: np.ndarray, design: Design, place: int, inside: np.ndarray
    ) -> Estimates:
        """Estimate the indices of all other factors within one level of a category.

        Parameters
        ----------
        y, design : as in `estimate`
        place : number of the category among the factors
        inside : rows at the level, shape (n,)

        Returns
        -------
        conditional_S1 with _low and _high, shape (k,), NaN for the category itself; conditional_ST
        too from some methods; conditional_rows, the blocks, cells or rows behind them, shape ().
        The variance is that among the rows of the level. Valid for independent factors.
        """
        raise NotImplementedError

    def independent_rows(self, design: Design) -> np.ndarray:
        """Return the numbers of the rows that are draws of their own, from which shares are
        counted.
        """
        return np.arange(design.size)

    @property
    def defaults(self) -> dict[str, Any]:
        """Return the values of the settings that are not given."""
        defaults = dict(self.takes)
        for name, setting in self.takes.items():
            if isinstance(setting, Key):
                defaults[name] = setting.default
        return defaults

    @property
    def follows(self) -> bool:
        """Return whether the places of the rows follow from their values, so that they are not
        stored.
        """
        return self.crossed or self.observed

    @property
    def grouped(self) -> bool:
        """Return whether the rows give indices of groups of factors."""
        return type(self).group_indices is not Method.group_indices

    @property
    def conditional(self) -> bool:
        """Return whether the rows give indices within each level of a category."""
        return type(self).level_indices is not Method.level_indices


GROUPED = {  # indices of the keys `groups` and `conditional_on`, of every method that takes them
    "group_S1": Index(
        "first-order Sobol index of the group, interactions inside the group included"
    ),
    "group_ST": Index("total Sobol index of the group"),
    "conditional_S1": Index("first-order Sobol index, computed from the rows of one level only"),
    "conditional_ST": Index("total Sobol index, computed from the rows of one level only"),
    "conditional_rows": Index("rows, cells or blocks behind the indices of one level"),
}
METHODS: dict[str, Method] = {}
M = TypeVar("M", bound=type[Method])


def register(method: M) -> M:
    """Add a design of experiments to study files, schema, plan, analysis and report; a decorator of
    its class.

    Parameters
    ----------
    method : subclass of `Method` with a `name`

    Returns
    -------
    The class.

    Raises
    ------
    InputError : another design has the name
    """
    if method.name in METHODS:
        raise InputError("method", method.name, "a name that no other design of experiments has")
    METHODS[method.name] = method()
    return method


def indices_of(method: Method | None) -> dict[str, Index]:
    """Return the indices that a method declares, or those of all methods, with those of groups and
    levels.
    """
    methods = list(METHODS.values())
    if method is not None:
        methods = [method]
    return {name: index for one in methods for name, index in one.indices.items()} | GROUPED


def index_of(method: Method | None, name: str) -> Index:
    """Return the declaration of an index.

    Parameters
    ----------
    method : the method of the analysis; None where the analysis names no method
    name : name of the estimate, without `_low`, `_high` and `_course`

    Raises
    ------
    InputError : the method does not declare the index
    """
    known = indices_of(method)
    if name not in known:
        if method is None:
            of = "a design"
        else:
            of = f"design {method.name}"
        remedy = f"Add '{name}': Index(words, ...) to `indices` of the class of the method."
        raise InputError(f"index of {of}", name, ", ".join(known), remedy, wrong="is not declared")
    return known[name]


def study_keys() -> dict[str, tuple[Key, str]]:
    """Return the keys of the study file that methods declare, each with the name of its method."""
    return {
        name: (own, method.name)
        for method in METHODS.values()
        for name, own in method.takes.items()
        if isinstance(own, Key)
    }


def those_that_take(key: str) -> list[str]:
    """Return the designs that take a key of the study file."""
    return [name for name, method in METHODS.items() if key in method.takes]


def those_with(trait: str) -> list[str]:
    """Return the designs for which an attribute of `Method` is true."""
    return [name for name, method in METHODS.items() if getattr(method, trait)]


def crossed(outer: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """Return each row of one array beside all rows of another one."""
    return np.concatenate(
        [np.repeat(outer, len(inner), axis=0), np.tile(inner, (len(outer), 1))], axis=1
    )


def in_order(places: np.ndarray, names: list[str], free: Factors) -> np.ndarray:
    """Return the columns of places, whose names are given, in the order of the factors."""
    return places[:, [names.index(name) for name in free]]


def spread(values: np.ndarray, place: int) -> np.ndarray:
    """Return values of all other factors with NaN for a category, shape (k,)."""
    return np.insert(np.asarray(values, dtype=float), place, np.nan)
