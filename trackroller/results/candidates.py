"""Compare candidates over their conditions.

A candidate is one combination of choices. It is judged over all conditions in which the study has
it, the worst first.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd

from trackroller.methods.b10 import b10
from trackroller.parameters import FIRST_TO_FAIL, REGIMES
from trackroller.results.case_columns import codes
from trackroller.results.life_columns import FIRST_LIMIT, body_lives
from trackroller.results.lives_by_tests import beyond_sn_data
from trackroller.results.robustness import material_deviations
from trackroller.results.solved_cases import SolvedCases, made_once
from trackroller.roller.output_names import is_life
from trackroller.study.design.levels import OF_MATERIALS

FEWEST = 20  # sampled conditions of a candidate below which its life is not stated
# conditions that all candidates of a table must have, so that they are compared over these alone
SHARED = 2
# compared in a study without lives
STRESS = ("peak_stress_roller", "peak stress of the roller", "MPa")
# without lives and stresses: 1 in each solved case, so that all tie
UNRANKED = ("converged", "conditions met", "")
TIED = 1e-9  # relative difference of lives that count as equal


def slip_margin(results: SolvedCases) -> np.ndarray:
    """Return the share of the largest transmissible force that the drive leaves, 1 - |F_Motor|/(mu
    |F_rad|/cos alpha).

    Returns
    -------
    Shape (n,) [1]; NaN without friction and drive, and with friction that depends on the slip
    speed.

    Notes
    -----
    At full slip no lateral friction is left, and both contacts carry |F_rad|/cos alpha together.
    """
    friction = "friction_coefficient"
    if "friction_coefficient_value" in results.table:
        friction = "friction_coefficient_value"
    motor, mu, radial, angle = (
        _input(results, n) for n in ("motor_force", friction, "radial_force", "contact_angle")
    )
    if results.base.get("friction_law") or "friction_law" in results.table:
        return np.full(len(results.table), np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        margin: np.ndarray = 1.0 - np.abs(motor) * np.cos(np.deg2rad(angle)) / (mu * np.abs(radial))
    return margin


def lift_off_margin(results: SolvedCases) -> np.ndarray:
    """Return the load of the lighter contact over that of the heavier one, shape (n,) [1]; 0 at
    lift-off.
    """
    loads = np.stack([results.column("normal_force_1"), results.column("normal_force_2")])
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio: np.ndarray = np.min(loads, axis=0) / np.max(loads, axis=0)
    return np.where(results.regime == REGIMES.index("lift_off"), 0.0, ratio)


def _input(results: SolvedCases, name: str) -> np.ndarray:
    if name in results.table and results.numeric(name):
        return results.column(name)
    value = results.base.get(name)
    filled = np.nan
    if isinstance(value, (int, float)):
        filled = float(value)
    return np.full(len(results.table), filled)


def mixed(results: SolvedCases) -> np.ndarray:
    """Return the rows of a random design that are no draws of their own, such as the mixtures of
    Saltelli's; (n,).
    """
    out = np.ones(len(results.table), dtype=bool)
    out[results.design.method.independent_rows(results.design)] = False
    return out


def _shared(candidate: np.ndarray, use: np.ndarray) -> np.ndarray:
    """Mark the rows whose conditions every candidate has once; none if there are fewer than
    `SHARED` such conditions.

    Parameters
    ----------
    candidate : number of the candidate of each row, -1 for rows that are not compared, shape (n,)
    use : number of the condition of each row, shape (n,)
    """
    rows = np.flatnonzero(candidate >= 0)
    pairs = pd.DataFrame({"candidate": candidate[rows], "use": use[rows]})
    tried = pairs.drop_duplicates().groupby("use").size()
    shared = tried.index[tried == candidate.max() + 1].to_numpy()
    in_common = np.isin(use, shared) & (candidate >= 0)
    each_once = not pairs[in_common[rows]].duplicated().any()
    if len(shared) >= SHARED and each_once:
        return in_common
    return np.zeros(len(use), dtype=bool)


def goal_without_lives(results: SolvedCases) -> tuple[str, str, str] | None:
    """Return what compares candidates without lives: a stress, else whether they meet the target;
    None without both.
    """
    if STRESS[0] in results.table:
        return STRESS
    if results.config.requirement:
        return UNRANKED
    return None


@made_once
def candidates_of(results: SolvedCases, free: tuple[str, ...] = ()) -> Candidates | None:
    """Return the candidates of a study: the combinations of choices, each judged over its
    conditions.

    Parameters
    ----------
    results : SolvedCases
        The solved study.
    free : tuple of str
        Conditions that count as choices here, because a goal names them.

    Returns
    -------
    Candidates or None
        None without a valid case that has a life or a stress, unless the study has a target.
    """
    goal = results.life or goal_without_lives(results)
    if goal is None or not (results.valid & ~np.isnan(results.column(goal[0]))).any():
        return None
    return Candidates.grouped(results, goal, free)


@dataclass(frozen=True)
class Candidates:
    """The combinations of choices of a study, each judged over its conditions.

    Attributes
    ----------
    results : the solved study
    choices, conditions : names of the factors by role
    goal : column, words and unit of the life that is compared; of a study without lives the peak
        stress of the roller, and `UNRANKED` without this stress
    candidate : number of the candidate of each case, shape (n,); -1 for cases of a less exact
        contact model, and for those that are no draws of their own
    matched : whether each candidate has the same conditions, each once
    untried : rows of a table whose conditions were not tried with every candidate, shape (n,) bool;
        not in `candidate`
    with_untried : `candidate` with the rows of `untried`, shape (n,)
    """

    results: SolvedCases
    choices: tuple[str, ...]
    conditions: tuple[str, ...]
    goal: tuple[str, str, str]
    candidate: np.ndarray
    matched: bool
    untried: np.ndarray
    with_untried: np.ndarray

    @classmethod
    def grouped(
        cls, results: SolvedCases, goal: tuple[str, str, str], free: tuple[str, ...] = ()
    ) -> Candidates:
        """Return the candidates of a study, whether a case is valid or not.

        Parameters
        ----------
        results : the solved study
        goal : column, words and unit of what is compared
        free : conditions that count as choices here
        """
        roles = results.roles | dict.fromkeys(free, "choice")
        choices, conditions = (
            tuple(n for n, r in roles.items() if r == role) for role in ("choice", "condition")
        )
        own = results.of_one_model()
        candidate = np.where(own, codes(results.table, choices), -1)
        candidate[own] = np.unique(candidate[own], return_inverse=True)[1]
        use = codes(results.table, conditions)
        left_out = np.zeros(len(use), dtype=bool)
        if conditions:
            left_out = mixed(results)
        if left_out.any():
            candidate = np.where(left_out, -1, candidate)
            candidate[candidate >= 0] = np.unique(candidate[candidate >= 0], return_inverse=True)[1]
        if results.config.method.observed:
            shared = _shared(candidate, use)
        else:
            shared = np.zeros(len(use), dtype=bool)
        untried = shared
        if shared.any():
            untried = own & ~shared
        with_untried = candidate
        candidate = np.where(untried, -1, candidate)
        counted = candidate >= 0
        several = candidate.max() + 1
        many = len(np.unique(use[counted]))
        pairs = len(np.unique(candidate[counted] * (use.max() + 1) + use[counted]))
        matched = bool(pairs == counted.sum() == several * many)
        return cls(results, choices, conditions, goal, candidate, matched, untried, with_untried)

    @cached_property
    def size(self) -> np.ndarray:
        """Return the number of conditions of each candidate, shape (candidates,)."""
        return np.bincount(self.candidate[self.candidate >= 0])

    @property
    def drawn(self) -> bool:
        """Return whether the conditions are a random sample, so that a worst case depends on its
        size.
        """
        return bool(self.conditions) and (not self.matched or self.results.config.method.sampled)

    @property
    def comparable(self) -> bool:
        """Return whether the candidates can be compared: they share their conditions, or each has a
        sample of them.
        """
        return (
            not self.conditions or self.matched or bool(self.size.min() >= FEWEST and self.weighted)
        )

    @property
    def weighted(self) -> bool:
        """Return whether the rows stand for the use: drawn by their probability, or the
        user's own.
        """
        method = self.results.config.method
        return method.weighted or method.observed

    @property
    def rising(self) -> bool:
        """Return whether more of the goal is better."""
        return is_life(self.goal[0])

    @property
    def ranks(self) -> bool:
        """Return whether the goal ranks the candidates: a life does, and a stress does among
        candidates of one material.
        """
        one = not any(
            self.members[name].nunique() > 1 for name in OF_MATERIALS if name in self.choices
        )
        return self.rising or (self.goal == STRESS and one)

    @property
    def usable(self) -> np.ndarray:
        """Return the cases whose life or stress counts, shape (n,): they hold, are compared, and
        have a value.
        """
        rows: np.ndarray = (
            self.results.holds
            & (self.candidate >= 0)
            & ~np.isnan(self.results.column(self.goal[0]))
        )
        return rows

    @cached_property
    def reached(self) -> np.ndarray:
        """Return the cases of the conditions in which a candidate holds, shape (n,); all if
        candidates share no conditions.

        So do all of drawn conditions, and of a study in which no candidate holds anywhere.
        """
        if self.drawn or not self.matched or not self.usable.any():
            return np.ones(len(self.candidate), dtype=bool)
        use = codes(self.results.table, self.conditions)
        return np.isin(use, use[self.usable])

    @cached_property
    def valid_in(self) -> np.ndarray:
        """Return the number of valid cases of each candidate, shape (candidates,)."""
        return self._count(self.usable)

    @cached_property
    def possible(self) -> int:
        """Return the number of conditions in which at least one candidate is valid; 0 if candidates
        share no conditions.
        """
        if self.matched:
            return len(np.unique(codes(self.results.table, self.conditions)[self.usable]))
        return 0

    @cached_property
    def members(self) -> pd.DataFrame:
        """Return the choices of each candidate, in the order of their numbers."""
        numbers, first = np.unique(self.candidate, return_index=True)
        rows = first[numbers >= 0]
        own = {name: self.results.table[name].to_numpy()[rows] for name in self.choices}
        return pd.DataFrame(own, index=range(len(rows)))

    @cached_property
    def table(self) -> pd.DataFrame:
        """Return one row a candidate, the best first: by the share of conditions that it holds,
        then by its life.

        Columns: the choices; the numbers of cases `cases`, `rolls` and `valid`; `worst`, `median`
        and `best` of the goal over the valid cases, `worst_case` (its row), and which of the three
        lie beyond the S-N data; the number of valid cases in which each body fails `first_`; the
        worst life of each body; the smallest margins, at most 0 where a case slips or lifts off;
        with random conditions `b10`, the life that nine of ten cases reach if cases that are not
        valid count as 0, with its 95 % interval; `rank`, equal for ties.
        """
        return _ranked(*self._listed)

    @cached_property
    def _listed(self) -> tuple[pd.DataFrame, pd.Series, pd.Series, pd.Series]:
        """Return the rows of `table` in the order of their numbers, and what ranks them: see
        `_ranked`.
        """
        results = self.results
        table = self.members.copy()
        table["cases"] = self.size
        for name, rows in (("rolls", results.rolling), ("valid", self.usable)):
            table[name] = self._count(rows)
        table = table.assign(**self._spread())
        first = results.first_failing(self.goal[0])
        for code, word in enumerate(FIRST_TO_FAIL):
            table[f"first_{word}"] = self._count(self.usable & (first == code))
        for body, name in body_lives(self.goal[0]).items():
            case = self._least(results.column(name), self.usable)
            table[f"worst_{body}"] = np.where(case < 0, np.nan, results.column(name)[case])
            table[f"worst_{body}_beyond"] = (case >= 0) & beyond_sn_data(results, name)[case]
        for name, margin, lost in (
            ("slip_margin", slip_margin(results), "full_slip"),
            ("lift_off_margin", lift_off_margin(results), "lift_off"),
        ):
            case = self._least(
                margin, self.reached & (results.rolling | (results.regime == REGIMES.index(lost)))
            )
            table[name] = np.where(case < 0, np.nan, margin[case])
        if self.rising:
            sign = 1.0
        else:
            sign = -1.0
        key = sign * table["worst"]
        if self.goal == FIRST_LIMIT:
            case = self._least(results.sure_life, self.usable)
            key = pd.Series(np.where(case < 0, np.nan, results.sure_life[case]), table.index)
        share = table["valid"] / table["cases"]
        if self.drawn and self.rising:
            table = table.assign(**self._quantile())
            sure = table["b10"] > 0
            key = table["b10"].where(sure, key)
            share = share.where(~sure, 2.0)
        return table, share, key, sign * table["median"]

    def cases_of(self, number: int) -> np.ndarray:
        """Return the cases of a row of `table` by its index, shape (n,) bool."""
        rows: np.ndarray = self.candidate == number
        return rows

    def worst_cases(self, values: np.ndarray, way: str) -> np.ndarray:
        """Return the case of each candidate with the worst value among its valid cases, -1 without
        one.

        Parameters
        ----------
        values : of the cases, shape (n,)
        way : `max` if more is better, otherwise `min`
        """
        if way == "max":
            worse = values
        else:
            worse = -values
        return self._least(worse, self.usable)

    def _count(self, rows: np.ndarray) -> np.ndarray:
        return np.bincount(self.candidate[rows & (self.candidate >= 0)], minlength=len(self.size))

    def _least(self, values: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return the case with the smallest value of each candidate among the rows, -1 if no value
        is known.
        """
        known = np.flatnonzero(rows & (self.candidate >= 0) & ~np.isnan(values))
        order = known[np.lexsort((values[known], self.candidate[known]))]
        candidates, first = np.unique(self.candidate[order], return_index=True)
        out = np.full(len(self.size), -1)
        out[candidates] = order[first]
        return out

    def _spread(self) -> dict[str, np.ndarray]:
        """Return worst, median and best of the goal of each candidate, and whether they lie beyond
        the S-N data.
        """
        values = self.results.column(self.goal[0])
        rows = np.flatnonzero(self.usable)
        if self.rising:
            rising_values = values[rows]
        else:
            rising_values = -values[rows]
        order = rows[np.lexsort((rising_values, self.candidate[rows]))]
        number = self._count(self.usable)
        start = np.cumsum(number) - number
        some = number > 0
        beyond = beyond_sn_data(self.results, self.goal[0])
        ends = {
            "worst": (0, 0),
            "median": ((number - 1) // 2, number // 2),
            "best": (number - 1, number - 1),
        }
        columns: dict[str, np.ndarray] = {}
        for name, two in ends.items():
            low, high = (order[np.where(some, start + step, 0)] for step in two)
            middle = np.where(low == high, values[low], (values[low] + values[high]) / 2)
            columns[name] = np.where(some, middle, np.nan)
            columns[f"{name}_beyond"] = some & (beyond[low] | beyond[high])
        columns["worst_case"] = np.where(some, order[np.where(some, start, 0)], -1)
        columns["beyond"] = self._count(self.usable & beyond)
        return columns

    def _quantile(self) -> dict[str, np.ndarray]:
        """Return the life that nine of ten cases of each candidate reach, its interval, and whether
        it lies beyond.

        Cases that are not valid have life 0. The scatter of the material of the body that fails
        first counts if the study asks for it, and if the S-N curve decides.
        """
        results = self.results
        lives = np.where(self.usable, results.column(self.goal[0]), 0.0)
        own = {}
        if self.goal != FIRST_LIMIT:
            own = material_deviations(results)
        guide = results.first_failing(self.goal[0]) == FIRST_TO_FAIL.index("guide")
        scatter = np.where(guide, own.get("guide", 0.0), own.get("roller", 0.0))
        cases = [self.cases_of(i) for i in range(len(self.size))]
        ends = np.array([b10(lives[c], scatter[c]) for c in cases]).T
        columns = dict(zip(("b10", "b10_low", "b10_high"), ends, strict=True))
        rests = np.array(
            [max(b10(lives[c])[0], value) for c, value in zip(cases, ends[0], strict=True)]
        )
        there = self.usable & (lives <= rests[self.candidate])
        there &= beyond_sn_data(results, self.goal[0])
        return columns | {"b10_beyond": self._count(there) > 0}


def _ranked(
    table: pd.DataFrame, share: pd.Series, key: pd.Series, middle: pd.Series
) -> pd.DataFrame:
    """Sort candidates by the share of cases that they hold, then by the key, and rank them; equal
    ones tie.
    """
    order = np.lexsort((-middle.fillna(-np.inf), -key.fillna(-np.inf), -share))
    shares = share.to_numpy()[order]
    keys = key.to_numpy()[order]
    same = np.isclose(shares[1:], shares[:-1], TIED, 0) & np.isclose(
        keys[1:], keys[:-1], TIED, 0, equal_nan=True
    )
    rank = np.maximum.accumulate(
        np.concatenate([[1], np.where(same, 1, np.arange(2, len(order) + 1))])
    )
    return table.iloc[order].assign(rank=rank)


def hardest_first(candidates: Candidates) -> np.ndarray:
    """Number the conditions of the cases, shape (n,): fewest valid candidates first, then the worse
    worst case.

    Cases of a less exact contact model have the number -1.
    """
    table = candidates.results.table
    own = candidates.candidate >= 0
    use = codes(table, candidates.conditions)
    use = np.unique(np.where(own, use, -1), return_inverse=True)[1] - int(not own.all())
    worst = np.full(use.max() + 1, np.inf)
    if candidates.rising:
        sign = 1.0
    else:
        sign = -1.0
    values = candidates.results.column(candidates.goal[0]) * sign
    np.minimum.at(worst, use[candidates.usable], values[candidates.usable])
    valid = np.bincount(use[candidates.usable], minlength=len(worst))
    return np.where(own, np.argsort(np.lexsort((worst, valid)))[use], -1)
