"""Compare the candidates of a study over their conditions, in arrays.

A candidate is one combination of choices. A condition is one combination of the other factors.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import norm

from trackroller.methods.b10 import b10
from trackroller.results.answer import Required
from trackroller.results.candidates import Candidates
from trackroller.results.case_columns import codes
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.factor_levels import MOST_LEVELS
from trackroller.results.first_limits import UNSURE
from trackroller.results.life_columns import FIRST_LIMIT, OF_PAIR
from trackroller.results.requirement import required_of
from trackroller.results.robustness import material_deviations
from trackroller.results.solved_cases import SolvedCases
from trackroller.roller.expected_errors import ratio_error
from trackroller.roller.output_names import is_life
from trackroller.roller.told_errors import ORDINARY_FRICTION
from trackroller.study.design.factor_names import SHELVES
from trackroller.study.design.levels import OF_MATERIALS
from trackroller.study.outputs import flat

LOADS = ("radial_force", "axial_force", "motor_force")
UNEQUAL = 0.01  # relative difference from which on loads of candidates are unlike
EQUAL = 1e-9  # relative difference of numbers that count as equal
STRESSES = (
    ("peak_stress_roller", "peak stress of the roller", "MPa"),
    ("peak_stress_guide", "peak stress of the guide", "MPa"),
)


def compared_output(
    results: SolvedCases, required: Iterable[Required]
) -> tuple[tuple[str, str, str], bool] | None:
    """Return the output that compares the candidates of a study, and whether more of it is better.

    It is the life to the first limit, or the life by fatigue, if the requirement is on a life or
    there is none; otherwise the first output that is required; without both the peak stress. None
    if the study has none of them.
    """
    outputs = list(required)
    life = results.life or next(
        (one for one in (FIRST_LIMIT, *results.fatigue_lives) if one[0] in results.table), None
    )
    if any(one.output in OF_PAIR for one in outputs) and life is not None:
        return life, True
    for one in outputs:
        rises = is_life(one.output) or not np.isfinite(one.most)
        return (one.output, one.words, one.units), rises
    if life is not None:
        return life, True
    for stress in STRESSES:
        if results.has(stress[0]):
            return stress, False
    return None


def wilson(hits: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the ends of Wilson's 95 % interval of a share.

    Parameters
    ----------
    hits, size : number of hits, which may be a sum of probabilities, and of trials, shape (k,) each

    References
    ----------
    Wilson (1927): Probable inference, the law of succession, and statistical inference. J. Am.
    Stat. Assoc. 22.
    """
    z = 1.959963984540054
    trials = np.maximum(size, 1)
    share = hits / trials
    middle = (share + z**2 / (2 * trials)) / (1 + z**2 / trials)
    half = z * np.sqrt(share * (1 - share) / trials + z**2 / (4 * trials**2)) / (1 + z**2 / trials)
    return np.clip(middle - half, 0.0, 1.0), np.clip(middle + half, 0.0, 1.0)


def unchanged_by(results: SolvedCases, name: str, values: Iterable[np.ndarray]) -> bool:
    """Return whether a factor changes none of some values where all other factors are equal.

    A factor of which a row has no such partner counts as one that may change them.
    """
    others = [factor for factor in results.factors if factor != name]
    group = codes(results.table, others)
    if (np.bincount(group)[group] < 2).any():
        return False
    first = np.unique(group, return_index=True)[1]
    partner = first[np.unique(group, return_inverse=True)[1]]
    return all(_equal(own, own[partner]) for own in values)


def _equal(one: np.ndarray, other: np.ndarray) -> bool:
    if one.dtype.kind in "OSU":
        return bool((one == other).all())
    return bool(np.isclose(one, other, rtol=EQUAL, atol=0.0, equal_nan=True).all())


@dataclass(frozen=True, eq=False)
class Comparison:
    """The cases of a study by candidate and condition.

    Attributes
    ----------
    results : the solved study
    ranges : the compared output of every case
    required : what is wanted
    groups : the candidates, with the choices that change nothing still among their choices
    """

    results: SolvedCases
    ranges: CaseRanges
    required: tuple[Required, ...]
    groups: Candidates

    @classmethod
    def of(cls, results: SolvedCases) -> Comparison | None:
        """Return the comparison of a study; None without a life, a stress and a requirement."""
        required = required_of(results)
        compared = compared_output(results, required)
        if compared is None or not len(results.table):
            return None
        output, rises = compared
        return cls(
            results,
            CaseRanges(results, output, rises),
            required,
            Candidates.grouped(results, output),
        )

    # which rows belong together

    @cached_property
    def judges(self) -> tuple[tuple[Required, CaseRanges], ...]:
        """Return each requirement with the output that judges it."""
        judges = []
        for one in self.required:
            own = self.ranges
            if not own.judges(one):
                rises = is_life(one.output) or not np.isfinite(one.most)
                own = CaseRanges(self.results, (one.output, one.words, one.units), rises)
            judges.append((one, own))
        return tuple(judges)

    @cached_property
    def lives(self) -> CaseRanges | None:
        """Return the life that ranks what meets a requirement which names no life; None where the
        compared output is a life, or the study has none.
        """
        if not self.required or is_life(self.ranges.output[0]) or self.results.life is None:
            return None
        return CaseRanges(self.results, self.results.life, True)

    @cached_property
    def followed(self) -> dict[str, str]:
        """Return the goals of numbers that the study follows beside its requirement, each `max` or
        `min`.
        """
        if not self.required:
            return {}
        goals = self.results.config.pareto.items()
        return {
            name: way for name, way in goals if self.results.quantity(name)[0].dtype.kind in "fiu"
        }

    @cached_property
    def others(self) -> dict[str, CaseRanges]:
        """Return the outputs beside the compared one on which a decision rests: other requirements,
        goals that are no inputs, and the life that ranks.
        """
        outputs = [own for _, own in self.judges if own is not self.ranges]
        inputs = {*self.results.factors, *self.results.goods}
        for name, way in self.followed.items():
            varies = name in self.results.derived or name not in self.results.base
            if name not in inputs and varies:
                _, units, words = self.results.quantity(name)
                outputs.append(CaseRanges(self.results, (name, words, units), way == "max"))
        if self.lives is not None:
            outputs.append(self.lives)
        named = {own.output[0]: own for own in outputs}
        named.pop(self.ranges.output[0], None)
        return named

    @cached_property
    def idle(self) -> dict[str, str]:
        """Return the choices that change nothing which a decision rests on: `no effect`, or `none
        on the NAME`. Rows of a shelf differ in their names, and in what they cost.
        """
        if not self.ranges.holds.any():
            return {}  # equal failures do not tell whether a choice has an effect
        judged = [self.ranges, *(own for _, own in self.judges)]
        deciding = [
            values for own in judged for values in (own.low, own.high, own.reason.astype(str))
        ]
        idle = {}
        for name in self.groups.choices:
            if name in SHELVES or not unchanged_by(self.results, name, deciding):
                continue
            table = self.results.table
            inputs = {*self.results.factors, *self.results.derived}
            columns = [table[n].to_numpy() for n in table if n not in inputs]
            if is_life(self.ranges.output[0]):
                word = "life"
            else:
                word = self.ranges.output[1]
            if unchanged_by(self.results, name, columns):
                idle[name] = "no effect"
            else:
                idle[name] = f"none on the {word}"
        return idle

    @cached_property
    def choices(self) -> tuple[str, ...]:
        """Return the names of the choices that tell candidates apart."""
        return tuple(name for name in self.groups.choices if name not in self.idle)

    @cached_property
    def candidate(self) -> np.ndarray:
        """Return the number of the candidate of each case, shape (n,); -1 for cases that are not
        compared.

        Not compared are cases of a less exact contact model, mixtures of a design, and all levels
        but the first one of a choice that changes nothing.
        """
        own = self.groups.with_untried >= 0
        for name in self.idle:
            first = self.results.levels(name)[0]
            own = own & (self.results.table[name] == first).to_numpy()
        candidate = np.where(own, codes(self.results.table, self.choices), -1)
        candidate[own] = np.unique(candidate[own], return_inverse=True)[1]
        return candidate

    @property
    def own(self) -> np.ndarray:
        """Return the cases that are compared, shape (n,)."""
        return np.asarray(self.candidate >= 0)

    @cached_property
    def count(self) -> int:
        """Return the number of candidates."""
        return int(self.candidate.max()) + 1

    @cached_property
    def spans(self) -> tuple[str, ...]:
        """Return the factors that span the range of a placeholder, and so are no conditions."""
        given = self.results.roles
        few = (n for n in UNSURE if n in given and len(self.results.levels(n)) <= MOST_LEVELS)
        if not self.drawn:
            return tuple(few)
        return ()

    @cached_property
    def conditions(self) -> tuple[str, ...]:
        """Return the names of the conditions.

        Conditions that candidates do not share are paired by their names, such as that of a load
        case, if a table has such a column and the loads of one name are equal.
        """
        names = tuple(n for n in self.groups.conditions if n not in self.spans)
        if self.drawn or self.count < 2 or self._each_has(names):
            return names
        for name in self.results.labels:
            if name in names and self._each_has((name,)) and self._equal_loads(name, names):
                return (name,)
        return names

    @property
    def unpaired(self) -> tuple[str, ...]:
        """Return the conditions that differ between candidates in conditions of one name."""
        if set(self.conditions) >= {*self.groups.conditions} - {*self.spans}:
            return ()
        others = [n for n in self.groups.conditions if n not in (*self.spans, *self.conditions)]
        varies = self.results.table[self.own].groupby([*self.conditions], sort=False)[others]
        return tuple(str(name) for name, most in varies.nunique().max().items() if most > 1)

    def _each_has(self, names: tuple[str, ...]) -> bool:
        """Return whether each candidate has each combination of some columns once at each place of
        the placeholders.
        """
        use = codes(self.results.table, names)[self.own]
        keys = np.stack([self.candidate[self.own], use, self.level[self.own]])
        once = np.unique(keys, axis=1).shape[1] == self.own.sum()
        return bool(once and self.own.sum() == np.prod([len(np.unique(key)) for key in keys]))

    def _equal_loads(self, name: str, names: tuple[str, ...]) -> bool:
        """Return whether all loads of one name are equal within a hundredth."""
        loads = [load for load in LOADS if load in names]
        own = self.results.table[self.own].groupby(name, sort=False)[loads]
        most, least = own.max(), own.min()
        return bool((most - least <= UNEQUAL * np.maximum(most.abs(), least.abs())).all(axis=None))

    @cached_property
    def drawn(self) -> bool:
        """Return whether the conditions are a random sample."""
        return bool(self.groups.conditions) and self.results.config.method.sampled

    @cached_property
    def use(self) -> np.ndarray:
        """Return the number of the condition of each case, shape (n,)."""
        return codes(self.results.table, self.conditions)

    @cached_property
    def level(self) -> np.ndarray:
        """Return the number of the place in the ranges of placeholders of each case, shape (n,)."""
        return codes(self.results.table, self.spans)

    @cached_property
    def pairs(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the pairs of a candidate and a condition: candidate and condition (p,), and the
        pair of each case.

        The pair of a case that is not compared is -1.
        """
        width = int(self.use.max()) + 1
        pair, inverse = np.unique(
            self.candidate[self.own] * width + self.use[self.own], return_inverse=True
        )
        of_case = np.full(len(self.candidate), -1)
        of_case[self.own] = inverse
        return pair // width, pair % width, of_case

    def all_in_pair(self, rows: np.ndarray) -> np.ndarray:
        """Return the pairs of which all cases are among some rows, shape (p,)."""
        pair = self.pairs[2]
        bad = np.bincount(pair[self.own & ~rows], minlength=len(self.pairs[0]))
        return np.asarray(bad == 0)

    def some_in_pair(self, rows: np.ndarray) -> np.ndarray:
        """Return the pairs of which a case is among some rows, shape (p,)."""
        pair = self.pairs[2]
        hits = np.bincount(pair[self.own & rows], minlength=len(self.pairs[0]))
        return np.asarray(hits > 0)

    def counted(self, pairs: np.ndarray) -> np.ndarray:
        """Return the number of conditions of each candidate among some pairs, shape
        (candidates,).
        """
        return np.bincount(self.pairs[0][pairs], minlength=self.count)

    @cached_property
    def rows(self) -> list[np.ndarray]:
        """Return the numbers of the cases of each candidate."""
        order = np.argsort(self.candidate, kind="stable")
        start = np.searchsorted(self.candidate[order], np.arange(self.count + 1))
        return [order[start[i] : start[i + 1]] for i in range(self.count)]

    @cached_property
    def matched(self) -> bool:
        """Return whether every candidate has the same conditions, each once at each place of the
        placeholders.
        """
        many = len(np.unique(self.use[self.own]))
        places = len(np.unique(self.level[self.own]))
        return bool(
            len(self.pairs[0]) == self.count * many and self.own.sum() == self.count * many * places
        )

    @cached_property
    def reachable(self) -> np.ndarray:
        """Return the cases in conditions that some candidate holds, shape (n,); all cases if no
        condition is held.

        Conditions that candidates do not share count for the candidates that have them. Drawn
        conditions all count.
        """
        if self.drawn or not self.conditions or not self.matched:
            return self.own
        possible = self.all_in_pair(self.ranges.holds)
        uses = np.unique(self.pairs[1][possible])
        rows = self.own & np.isin(self.use, uses)
        if rows.any():
            return rows
        return self.own

    @property
    def unreachable(self) -> np.ndarray:
        """Return the cases in conditions that no candidate holds, shape (n,); none if no condition
        is held at all.
        """
        return np.asarray(self.own & ~self.reachable)

    @cached_property
    def never_held(self) -> np.ndarray:
        """Return the cases in conditions that no candidate holds, drawn ones included, shape
        (n,).
        """
        uses = np.unique(self.pairs[1][self.all_in_pair(self.ranges.holds)])
        return np.asarray(self.own & ~np.isin(self.use, uses))

    # what meets the requirement

    def met(
        self, exact: bool = False, lives: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the cases that surely meet all requirements, and those that may, shape (n,) each.

        Parameters
        ----------
        exact : whether the errors of the solution do not count
        lives : lives of a second model that take the place of those of the pair, at both ends,
            shape (2, n) [h]
        """
        sure = self.ranges.holds & ~self.ranges.open
        may = np.where(self.ranges.judged, self.ranges.holds, True)
        for one, own in self.judges:
            certain, possible = own.meets(one, exact)
            if lives is not None and one.output in OF_PAIR:
                certain, possible = lives >= one.least
            sure = sure & certain
            may = may & possible
        return sure, may

    def hits(self) -> np.ndarray:
        """Return whether each case meets all requirements by its value alone, or how probably,
        shape (n,) [1].

        The scatter of a material makes a life a probability. Without a requirement a case that is
        held is a hit.
        """
        hits = self.ranges.holds.astype(float)
        for one, own in self.judges:
            hits = hits * self._chance(one, own)
        return hits

    def _chance(self, one: Required, own: CaseRanges) -> np.ndarray:
        within = (own.middle >= one.least) & (own.middle <= one.most)
        if not (self.scatter > 0).any() or not is_life(one.output) or not one.least > 0:
            return within.astype(float)
        with np.errstate(divide="ignore", invalid="ignore"):
            away = np.log10(own.middle / one.least) / np.maximum(self.scatter, 1e-9)
        return np.where(self.scatter > 0, norm.cdf(away), within)

    @cached_property
    def wanted_share(self) -> float:
        """Return the share of the conditions that has to meet the requirement [1]; NaN if none is
        given.
        """
        shares = [one.probability for one in self.required if np.isfinite(one.probability)]
        return max(shares, default=np.nan)

    # numbers of each candidate

    def smallest(self, values: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the worst value of each candidate among some rows, and its case, shape
        (candidates,) each.

        The value is NaN and the case -1 for a candidate without such a row.
        """
        chosen = np.flatnonzero(rows & self.own & ~np.isnan(values))
        tie = self.ranges.sign * self.ranges.middle[chosen]
        order = chosen[np.lexsort((tie, self.ranges.sign * values[chosen], self.candidate[chosen]))]
        numbers, first = np.unique(self.candidate[order], return_index=True)
        case = np.full(self.count, -1)
        case[numbers] = order[first]
        return np.where(case < 0, np.nan, values[case]), case

    def median(self, values: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return the median of each candidate among some rows, shape (candidates,); NaN without a
        row.
        """
        chosen = np.flatnonzero(rows & self.own & ~np.isnan(values))
        order = chosen[np.lexsort((values[chosen], self.candidate[chosen]))]
        number = np.bincount(self.candidate[order], minlength=self.count)
        start = np.cumsum(number) - number
        lower = []
        upper = []
        if len(order):
            lower = order[
                np.minimum(start + np.maximum(number - 1, 0) // 2, max(len(order) - 1, 0))
            ]
            upper = order[np.minimum(start + number // 2, max(len(order) - 1, 0))]
        if not len(order):
            return np.full(self.count, np.nan)
        one = values[lower]
        other = values[upper]
        return np.where(number > 0, np.where(one == other, one, 0.5 * (one + other)), np.nan)

    @cached_property
    def members(self) -> pd.DataFrame:
        """Return the choices of each candidate, in the order of their numbers."""
        numbers, first = np.unique(self.candidate, return_index=True)
        rows = first[numbers >= 0]
        own: dict[str, Any] = {
            name: self.results.table[name].to_numpy()[rows] for name in self.choices
        }
        return pd.DataFrame(own, index=range(len(rows)))

    @cached_property
    def materials(self) -> np.ndarray:
        """Return the materials of each candidate as one text, shape (candidates,)."""
        first = np.unique(self.candidate, return_index=True)
        rows = first[1][first[0] >= 0]
        named = [n for n in OF_MATERIALS if n in self.results.table]
        if not named:
            return np.full(len(rows), "", dtype=object)
        names = self.results.table[named].iloc[rows].astype(str)
        return names.agg(" / ".join, axis=1).to_numpy(dtype=object)

    @cached_property
    def rankable(self) -> bool:
        """Return whether the compared output ranks the candidates: a stress does among one pair of
        materials.
        """
        if is_life(self.ranges.output[0]) or self.required:
            return True
        return self.ranges.output in STRESSES and len(set(self.materials)) == 1

    def shares(self, hits: np.ndarray) -> np.ndarray:
        """Return the share of the conditions of each candidate that are hits, shape (candidates,).

        Parameters
        ----------
        hits : cases, bool, or the probability that each case is a hit, shape (n,)
        """
        total = np.bincount(self.candidate[self.own], minlength=self.count)
        sums = np.bincount(
            self.candidate[self.own], weights=hits[self.own].astype(float), minlength=self.count
        )
        return np.asarray(sums / np.maximum(total, 1))

    @cached_property
    def scatter(self) -> np.ndarray:
        """Return the standard deviation of log10 life by the material that ends each case, shape
        (n,) [1].
        """
        out = np.zeros(len(self.candidate))
        if not is_life(self.ranges.output[0]):
            return out
        own = material_deviations(self.results)
        names, guide = self.ranges.first
        if own:
            out = np.where(guide, own.get("guide", 0.0), own.get("roller", 0.0)) * (
                names == "fatigue"
            )
        return np.asarray(out, dtype=float)

    def tenth_part(self, number: int) -> tuple[float, float, float]:
        """Return what nine of ten drawn conditions of a candidate reach, or of an output of which
        less is better stay within, with its 95 % interval.

        The interval is NaN below the number of rows at which an order statistic reaches 95 %.
        """
        rows = self.rows[number]
        sign = self.ranges.sign
        values = np.where(
            self.ranges.holds[rows], self.ranges.middle[rows], self.ranges.worst_value
        )
        value, *ends = (sign * one for one in b10(sign * values, self.scatter[rows]))
        if len(rows) < ENOUGH:
            return value, np.nan, np.nan
        return value, min(ends), max(ends)

    def middle_interval(self, number: int) -> tuple[float, float]:
        """Return the 95 % interval of the median of the drawn conditions of a candidate, by order
        statistics.
        """
        rows = self.rows[number]
        ranked = np.sort(
            np.where(self.ranges.holds[rows], self.ranges.middle[rows], self.ranges.worst_value)
        )
        below = int(np.floor(0.5 * len(ranked) - 0.98 * np.sqrt(len(ranked))))
        if below < 1:
            return np.nan, np.nan
        return float(ranked[below - 1]), float(ranked[len(ranked) - below])

    def ratios(self, number: int, leader: int) -> np.ndarray:
        """Return how much longer one candidate lasts than another one, over the conditions that
        both hold.

        Returns
        -------
        Ratios, shape (2, k), at the low and at the high end of the placeholders if both have the
        same materials, otherwise twice those of the geometric middles. More than 1 is better
        whatever the output.
        """
        ends = [self.ranges.middle, self.ranges.middle]
        if self.materials[number] == self.materials[leader]:
            ends = [self.ranges.worse, self.ranges.better]
        return np.stack([self._paired(values, number, leader) for values in ends])

    def _paired(self, values: np.ndarray, number: int, leader: int) -> np.ndarray:
        table = self._of_condition(number)
        other = self._of_condition(leader)
        both = np.intersect1d(table[0], other[0], assume_unique=True)
        mine = values[table[1][np.searchsorted(table[0], both)]]
        theirs = values[other[1][np.searchsorted(other[0], both)]]
        with np.errstate(divide="ignore", invalid="ignore"):
            if self.ranges.rises:
                ratio = mine / theirs
            else:
                ratio = theirs / mine
        return np.where(mine == theirs, 1.0, ratio)

    def _of_condition(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the conditions and places of placeholders that a candidate holds, and the case of
        each.
        """
        rows = self.rows[number]
        rows = rows[self.ranges.holds[rows] & self.reachable[rows]]
        width = int(self.level.max()) + 1
        key, first = np.unique(self.use[rows] * width + self.level[rows], return_index=True)
        return key, rows[first]

    def error_of_ratio(self, number: int, leader: int) -> float:
        """Return the error of a ratio of the outputs of two candidates, as a factor less 1 [1].

        It was measured for lives by fatigue and peak stresses on the rungs. Elsewhere, also where
        fatigue ends one of both only, the errors of both candidates count as independent; outputs
        without a stated error have none.
        """
        rows = [self._of_condition(one)[1] for one in (number, leader)]
        errors = [float(np.median(self.ranges.error[own])) if len(own) else 0.0 for own in rows]
        if self._measured_error is None or not all(errors):
            return float(np.hypot(errors[0], errors[1]))
        return self._measured_error

    @cached_property
    def _measured_error(self) -> float | None:
        """Return the measured error of a ratio at the rung of the study; None where it was not
        measured.
        """
        name = self.ranges.output[0]
        data = self.results.data
        stated = data.get("peak_stress")
        if is_life(name):
            stated = data.get("life_cycles")
        if stated is None or "expected_relative_error" not in stated.attrs:
            return None  # solved patches, falling friction, tolerances and settings of a user
        if "contact_model" not in data.attrs:
            # the model is a choice of the study: errors of different models are not alike
            return None
        friction = self.results.table.get(
            "friction_coefficient", self.results.base.get("friction_coefficient", 0.0)
        )
        if np.max(friction) > ORDINARY_FRICTION:
            return None
        quantity = "peak_stress"
        if is_life(name):
            quantity = "life"
        return ratio_error(str(data.attrs["accuracy"]), str(data.attrs["contact_model"]), quantity)

    def hours_by_limit(self, end: str) -> np.ndarray | None:
        """Return the hours until each limit of each body, second models included, (n, limit, 2)
        [h]; None without.
        """
        name = f"life_hours_by_limit{end}"
        if name not in self.results.data:
            return None
        return flat(self.results.data, name, self.results.dims).astype(float)


ENOUGH = 29  # rows from which on an order statistic bounds the tenth part with 95 %
