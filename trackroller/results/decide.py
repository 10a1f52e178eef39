"""Which candidate to build: the answer to a study with choices."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from trackroller.damage import limit_word
from trackroller.methods.b10 import quantile
from trackroller.methods.optimise import nondominated_ranks
from trackroller.parameters import BODIES
from trackroller.parameters.carriage_fields import long_name_of
from trackroller.results.answer import Answer
from trackroller.results.candidate_table import (
    candidate_columns,
    candidate_table,
    names_of,
    shared_names,
    states_of,
)
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.comparison import EQUAL, Comparison
from trackroller.results.effect_curves import Effects
from trackroller.results.ends_by_factor import ends_by_factor
from trackroller.results.life_columns import FIRST_LIMIT, OF_PAIR
from trackroller.results.search_fitness import normalised
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.study_facts import (
    cautions,
    checks_left_out,
    facts_of,
    given_for_nothing,
    lost_by_missing_input,
    not_given_words,
)
from trackroller.results.subgroups import labels_in_place, places_of, places_text, plain
from trackroller.results.turning_values import Turning
from trackroller.roller.output_names import is_life

RIVALS = 200  # of the leader that are compared with it pair by pair, the best ones


@dataclass
class Decision:
    """What a decision says of its candidates, by their numbers.

    Attributes
    ----------
    kind : see `trackroller.results.answer.Answer`
    order : all candidates, the best one first
    named : candidates that the headline names
    why : of `cannot_tell`: `model`, `conditions` or `materials`
    measure : what to measure, see `Turning`
    """

    kind: str
    order: list[int]
    named: list[int]
    why: str = ""
    measure: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Decider:
    """The comparison of a study with the table of its candidates.

    Attributes
    ----------
    own : the comparison
    table : see `candidate_table`
    """

    own: Comparison
    table: pd.DataFrame

    @cached_property
    def turning(self) -> Turning:
        """Return the lives of candidates while a placeholder moves."""
        return Turning(self.own)

    @cached_property
    def score(self) -> np.ndarray:
        """Return what ranks the candidates, more is better, shape (m,).

        It is the tenth part of drawn conditions, otherwise the geometric middle of the range at the
        worst condition.
        """
        name = "middle"
        if self.own.drawn and is_life(self.own.ranges.output[0]):
            name = "tenth"
        values = self.table[name].to_numpy(dtype=float)
        worst = 0.0
        if not self.own.ranges.rises:
            worst = -np.inf
        return np.where(np.isnan(values), worst, self.own.ranges.sign * values)

    @cached_property
    def goals(self) -> np.ndarray:
        """Return the goals of the study beside its requirement at the worst condition of each
        candidate, more is better, shape (m, goals).

        A candidate of which a goal is not known, such as a roller without a price, is the worst
        one.
        """
        own = self.own
        columns = [np.zeros((own.count, 0))]
        for name, way in own.followed.items():
            values = own.results.quantity(name)[0]
            sign = -1.0
            if way == "max":
                sign = 1.0
            worst = np.full(own.count, np.inf)
            rows = own.reachable & ~np.isnan(values.astype(float))
            np.minimum.at(worst, own.candidate[rows], sign * values[rows].astype(float))
            columns.append(np.where(np.isposinf(worst), -np.inf, worst)[:, None])
        return np.concatenate(columns, axis=1)

    def by_goals(self, numbers: np.ndarray) -> np.ndarray:
        """Return what ranks some candidates by the goals, more is better, shape (k,).

        It is the goal itself. Of several goals it is the nearness to the best of all of them, each
        normalised over the candidates that no other one beats in all goals, as in a search.
        """
        goals = self.goals[numbers]
        if goals.shape[1] < 2:
            return np.asarray(goals.sum(axis=1))
        front = nondominated_ranks(-goals, np.zeros(len(goals))) == 0
        shares = normalised(-goals[front])
        key = np.full(len(goals), -np.inf)
        key[front] = -np.round((shares**2).sum(axis=1), 9)
        return key

    @cached_property
    def lasting(self) -> np.ndarray:
        """Return the life that ranks candidates where a requirement names no life, more is better,
        shape (m,) [h]; 0 where the compared output is a life, or the study has none.

        It is the tenth part of drawn conditions, otherwise the middle of the range at the worst
        condition.
        """
        own = self.own
        life = own.lives
        if life is None:
            return np.zeros(own.count)
        values = np.where(life.holds, life.middle, 0.0)
        if own.drawn:
            return np.array([float(quantile(np.sort(values[rows]), 0.1)) for rows in own.rows])
        worst = np.full(own.count, np.inf)
        rows = own.reachable
        np.minimum.at(worst, own.candidate[rows], values[rows])
        return np.where(np.isposinf(worst) | np.isnan(worst), 0.0, worst)

    def best_first(self, among: Iterable[int]) -> list[int]:
        """Return some candidates, the best one first: by the goals, the life, the score, the
        median, then the number held.
        """
        numbers = np.array(list(among), dtype=int)
        median = self.own.ranges.sign * np.nan_to_num(
            self.table["median"].to_numpy(dtype=float), nan=-np.inf
        )
        keys = (self.table["holds"].to_numpy(), median, self.score, self.lasting)
        order = np.lexsort((*(-key[numbers] for key in keys), -self.by_goals(numbers)))
        return [int(one) for one in numbers[order]]

    def nearest_first(self, among: Iterable[int]) -> list[int]:
        """Return some candidates: those that hold most conditions first, then meet most, then with
        the largest low.
        """
        numbers = np.array(list(among), dtype=int)
        worse_end = "high"
        if self.own.ranges.rises:
            worse_end = "low"
        worse = self.table[worse_end].to_numpy(dtype=float)
        low = self.own.ranges.sign * np.nan_to_num(worse, nan=self.own.ranges.worst_value)
        median = self.own.ranges.sign * np.nan_to_num(
            self.table["median"].to_numpy(dtype=float), nan=-np.inf
        )
        keys = (median, low, self.table["meets"].to_numpy(), self.table["holds"].to_numpy())
        order = np.lexsort(tuple(-key[numbers] for key in keys))
        return [int(one) for one in numbers[order]]

    def decided(self) -> Decision:
        """Return which candidate to build, or why that cannot be said."""
        if self.own.drawn and self.own.required and not np.isfinite(self.own.wanted_share):
            return self._by_share()
        if self.own.required:
            return self._by_requirement()
        return self._by_rank()

    def _by_share(self) -> Decision:
        """Return the candidate with the largest share; the shares are not judged."""
        keys = self.score, self.table["share"].to_numpy()
        order = [int(one) for one in np.lexsort(tuple(-key for key in keys))]
        holds = self.table["holds"].to_numpy() > 0
        if not holds.any():
            return Decision("none", order, [])
        return Decision("build", order, order[:1])

    def _by_requirement(self) -> Decision:
        state = self.table["state"].to_numpy()
        every = np.arange(self.own.count)
        groups = [self.best_first(every[state == word]) for word in ("met", "open")]
        others = self.nearest_first(every[(state != "met") & (state != "open")])
        order = [*groups[0], *groups[1], *others]
        if groups[0]:
            tied = [one for one in groups[0][1:RIVALS] if self._tied(groups[0][0], one)]
            named = [groups[0][0], *tied]
            kind = "build"
            if tied:
                kind = "a_or_b"
            return Decision(kind, [*named, *(n for n in order if n not in named)], named)
        if groups[1]:
            return self._open(order, groups[1])
        return Decision("none", order, [])

    def _open(self, order: list[int], among: list[int]) -> Decision:
        """Return the decision where no candidate surely meets the requirement, and some may."""
        judged = self.table["judged"].to_numpy() == self.table["of"].to_numpy()
        known = [number for number in among if judged[number]]
        if not known:
            return Decision("cannot_tell", order, [], "model")
        leader = known[0]
        order = [leader, *(n for n in order if n != leader)]
        if states_of(self.own, self.table, exact=True)[leader] != "open":
            return Decision("solve_finer", order, [leader], "error")
        least = max(
            (one.least for one in self.own.required if one.output in OF_PAIR), default=np.nan
        )
        turning = self.turning
        placeholder = (
            turning.of_open_limit(leader)
            or turning.decides(leader, least)
            or turning.behind(leader)
        )
        return Decision("measure", order, [leader], measure=placeholder or {})

    def _by_rank(self) -> Decision:
        own = self.own
        table = self.table
        every = np.arange(own.count)
        order = self.nearest_first(every)
        judged = (table["judged"] == table["of"]).to_numpy()
        # a condition that no candidate holds, or in which the model judges none, rules none out
        counts = own.counted(np.isin(own.pairs[1], np.unique(own.use[own.reachable])))
        if own.drawn:  # nine of ten drawn conditions have to be held
            pool = every[self.score > own.ranges.sign * own.ranges.worst_value]
        else:
            holds = table["holds"].to_numpy()
            pool = every[(holds >= counts) & (holds > 0)]
        if not len(pool):
            unknown = (~judged & (table["holds"] == 0)).any() and (table["holds"] == 0).all()
            if unknown or self._may_hold().any():
                return Decision("cannot_tell", order, [], "model")
            return Decision("none", order, [])
        if not own.rankable:
            return Decision("cannot_tell", order, [], "materials")
        if not own.matched and not own.drawn and own.conditions and own.count > 1:
            return Decision("cannot_tell", order, [], "conditions")
        ranked = self.best_first(pool)
        leader, *rivals = ranked
        rivals = rivals[:RIVALS]
        named = [leader, *(one for one in rivals if not self._beats(leader, one))]
        order = [
            *named,
            *(n for n in ranked if n not in named),
            *(n for n in order if n not in ranked),
        ]
        placeholder = self.turning.of_span(leader, rivals) or self.turning.leads(leader, rivals)
        if placeholder:
            return Decision("measure", order, [leader], measure=placeholder)
        if len(named) > 1:
            return Decision("a_or_b", order, named)
        return Decision("build", order, named)

    def _may_hold(self) -> np.ndarray:
        """Return the candidates that fail in none of the judged conditions that count, or in a
        tenth of the drawn ones, shape (m,).
        """
        own = self.own
        failed = own.reachable & own.ranges.judged & ~own.ranges.holds
        number = np.bincount(own.candidate[failed], minlength=own.count)
        share = 0.0
        if own.drawn:
            share = 0.1
        of = np.bincount(own.candidate[own.own], minlength=own.count)
        return np.asarray(number <= share * of)

    def _beats(self, one: int, other: int) -> bool:
        """Return whether a candidate is never worse than another one by more than the error, and
        somewhere better.

        Where ratios cross, the worst condition decides.
        """
        ratios = self.own.ratios(one, other)
        error = self.own.error_of_ratio(one, other)
        never_worse = bool((ratios >= 1.0 / (1.0 + error) - EQUAL).all())
        somewhere_better = bool((ratios > 1.0 + error + EQUAL).any())
        if never_worse:
            return somewhere_better
        mine, theirs = self.score[one], self.score[other]
        margin = error * abs(theirs)
        return bool(mine > theirs + margin + EQUAL * abs(theirs))

    def _tied(self, one: int, other: int) -> bool:
        """Return whether two candidates are equal within the error in every condition, by the goals
        and by the life.
        """
        if (self.goals[one] != self.goals[other]).any():
            return False
        if self.own.lives is not None:
            longer, shorter = sorted((self.lasting[one], self.lasting[other]), reverse=True)
            error = float(np.median(self.own.lives.error[self.own.rows[one]]))
            if longer > shorter * (1.0 + error + EQUAL):
                return False
        ratios = self.own.ratios(one, other)
        error = self.own.error_of_ratio(one, other)
        inside = (ratios >= 1.0 / (1.0 + error) - EQUAL) & (ratios <= 1.0 + error + EQUAL)
        return bool(inside.all() and ratios.size)


def answer_decide(results: SolvedCases) -> Answer:
    """Return which candidate of a study to build.

    Parameters
    ----------
    results : SolvedCases
        A solved study with a life, a stress or a requirement.
    """
    own = Comparison.of(results)
    assert own is not None
    table = candidate_table(own)
    decider = Decider(own, table)
    decision = decider.decided()
    turns = _missing_input(own, decision)
    if turns:
        decision.kind = "give"
    shown = with_ratios(own, table.iloc[decision.order].reset_index(drop=True))
    if decision.kind == "none":
        number_named = 1
    else:
        number_named = len(decision.named)
    return Answer(
        question="decide",
        kind=decision.kind,
        headline=_headline(own, table, decision) | turns,
        output=own.ranges.output,
        table=shown,
        columns=candidate_columns(own, shown),
        required=own.required,
        curves=Effects.of(own.ranges).curves(),
        ends=ends_by_factor(results, own.ranges),
        not_checked=checks_left_out(results),
        not_used=given_for_nothing(results) | own.idle,
        not_given=not_given_words(results),
        warnings=cautions(own, shown, number_named),
        facts=facts_of(results, own),
    )


def _missing_input(own: Comparison, decision: Decision) -> dict[str, Any]:
    """Return the load to give that was not given and by which conditions are lost; {} without one.

    None is asked for where no candidate meets the requirement in the conditions that are held.
    """
    name = lost_by_missing_input(own)
    if not name or decision.kind == "cannot_tell":
        return {}
    lost = own.never_held
    missed = decision.kind == "none" and own.ranges.holds.any() and bool(own.required)
    if missed and not _meets_without(own, lost):
        return {}
    return {"give": {"what": long_name_of(name)}, **lost_conditions(own, lost)}


def _meets_without(own: Comparison, lost: np.ndarray) -> bool:
    """Return whether some candidate may meet the requirement in the drawn conditions without the
    lost ones.
    """
    if not own.drawn:
        return False  # the states of candidates leave out the conditions that none holds
    rows = own.own & ~lost
    total = np.bincount(own.candidate[rows], minlength=own.count)
    hits = np.bincount(own.candidate[rows & own.met()[1]], minlength=own.count)
    return bool((hits[total > 0] >= own.wanted_share * total[total > 0]).any())


def with_ratios(own: Comparison, shown: pd.DataFrame) -> pd.DataFrame:
    """Return the table with the ratios of each candidate to the first one."""
    numbers = shown["number"].tolist()
    ends = np.full((len(numbers), 2), np.nan)
    better = np.zeros(len(numbers), dtype=int)
    for i, number in enumerate(numbers):
        middle = own.ratios(number, numbers[0])
        if middle.size and own.matched:
            one = np.sqrt(middle[0]) * np.sqrt(middle[1])
            ends[i] = one.min(), one.max()
            better[i] = int((one > 1.0 + own.error_of_ratio(number, numbers[0])).sum())
    return shown.assign(ratio_low=ends[:, 0], ratio_high=ends[:, 1], longer=better)


def _headline(own: Comparison, table: pd.DataFrame, decision: Decision) -> dict[str, Any]:
    """Return the numbers and names of the headline: the named candidates, and what a reader must
    know of them.
    """
    one = table.iloc[decision.order[0]]
    names = []
    if decision.named:
        names = names_of(own, decision.named)
    head: dict[str, Any] = {
        "names": names,
        "why": decision.why,
        **leading(own, one),
        "measure": decision.measure,
    }
    if len(decision.named) > 1:
        head["shared"] = shared_names(own, decision.named)
    head["goals"] = _goals_of(own, one)
    head |= not_held_by_any(own)
    if decision.kind in ("none", "cannot_tell"):
        head["nearest"] = {
            "name": names_of(own, [decision.order[0]])[0],
            **{key: plain(one[key]) for key in NEAREST},
            "cause": "",
        }
        if one["holds"] == 0 and one["judged"] == one["of"]:
            head["nearest"]["cause"] = causes_text(own, own.rows[int(one["number"])])
    return head | _level_reached(own, table)


NEAREST = ("holds", "judged", "of", "meets", "perhaps", "low", "fails", "fails_counted")


def _goals_of(own: Comparison, one: pd.Series) -> list[dict[str, Any]]:
    """Return the goals that are neither choices nor the compared output, at the worst condition of
    a candidate.
    """
    goals = []
    for name in own.followed:
        _, units, words = own.results.quantity(name)
        if name in own.results.goods:
            units = str(own.results.data[name].attrs.get("units", ""))
        for key in (f"of_{name}", f"own_{name}", name):
            if key in one.index and name not in own.choices:
                goals.append({"words": words, "units": units, "value": plain(one[key])})
                break
    return goals


def leading(own: Comparison, one: pd.Series) -> dict[str, Any]:
    """Return what a headline says of one candidate, a row of `candidate_table`."""
    head: dict[str, Any] = {
        key: plain(one[key])
        for key in ("low", "high", "worst", "ends", "ends_high", "body", "body_high", "error")
    }
    if not one["line_alone"]:
        head |= {key: plain(one[key]) for key in ("line_low", "line_high")}
    head["extrapolated"] = bool(one["extrapolated"])
    head["elsewhere"] = bool(one["holds"] < one["of"])
    if one["exceeded_by"]:
        head["exceeded"] = {
            "limit": plain(one["exceeded_by"]),
            "body": plain(one["exceeded_body"]),
            "use": float(one["use"]),
            "hours": float(one["use_hours"]),
        }
    earlier = _earlier_end(own, int(one["number"]), float(one["low"]))
    if earlier:
        head["earlier"] = earlier
    if one["second_state"] not in ("", one["state"]):
        head["second"] = {
            "limit": plain(one["second"]),
            "verdict": plain(one["second_state"]),
            "low": plain(one["second_low"]),
            "high": plain(one["second_high"]),
        }
    if own.drawn:
        shares = ("share", "share_low", "share_high", "share_short", "share_long")
        head |= {key: float(one[key]) for key in shares}
        head |= {"wanted": own.wanted_share, "n": int(one["n"]), "judged": int(one["judged"])}
    return head


def _earlier_end(own: Comparison, number: int, low: float) -> dict[str, Any]:
    """Return the first limit of a candidate at its worst condition, where the life of a body is
    compared and this limit comes before its low end [h]; {} otherwise.
    """
    results = own.results
    name, _, units = own.ranges.output
    if units != "h" or name == FIRST_LIMIT[0] or FIRST_LIMIT[0] not in results.table:
        return {}
    first = CaseRanges(results, FIRST_LIMIT, True)
    rows = own.rows[number]
    rows = rows[(own.reachable & own.ranges.holds & first.holds)[rows]]
    if not len(rows) or not first.low[rows].min() < low:
        return {}
    worst = rows[np.argmin(first.low[rows])]
    limit, guide = (part[worst] for part in first.first_at("_low"))
    return {
        "limit": limit_word(str(limit)),
        "body": BODIES[int(guide)],
        "low": float(first.low[worst]),
        "high": float(first.high[rows].min()),
    }


def not_held_by_any(own: Comparison) -> dict[str, Any]:
    """Return how many conditions no candidate holds, and where; {} if each is held by one."""
    return lost_conditions(own, own.unreachable)


def lost_conditions(own: Comparison, rows: np.ndarray) -> dict[str, Any]:
    """Return the number of conditions of some cases, which no candidate holds, and where they are;
    {} without cases.

    `not_held` are the conditions in which the model judges every candidate, out of all judged
    conditions. `not_judged` are the others: some candidate may hold them.
    """
    lost = {}
    unknown = np.isin(own.use, np.unique(own.use[rows & ~own.ranges.judged]))
    of = len(np.unique(own.use[own.own]))
    open_conditions = _conditions_of(own, rows & unknown, of)
    if open_conditions:
        lost["not_judged"] = open_conditions
        of -= open_conditions["count"]
    failed = _conditions_of(own, rows & ~unknown, of)
    if failed:
        lost["not_held"] = failed
    return lost


def _conditions_of(own: Comparison, rows: np.ndarray, of: int) -> dict[str, Any]:
    """Return the number of conditions of some cases, out of how many, and where they are; {}
    without cases.
    """
    if not rows.any():
        return {}
    table = own.results.table
    first = np.flatnonzero(own.own)[np.unique(own.use[own.own], return_index=True)[1]]
    lost = np.isin(own.use[first], np.unique(own.use[rows]))
    names = [name for name in own.conditions if table[name].nunique() > 1]
    names = labels_in_place(table.iloc[first], names, own.results.labels, lost)
    place = places_of(table.iloc[first], names, lost, np.ones(len(first), dtype=bool))
    where = places_text(place, table.iloc[first]) or causes_text(own, rows)
    return {"count": int(lost.sum()), "of": of, "where": where}


def causes_text(own: Comparison, rows: np.ndarray) -> str:
    """Return the causes by which some cases are not held, the most frequent one first."""
    words = pd.Series(own.ranges.reason[rows]).map(
        lambda word: limit_word(str(word).removeprefix("limit "))
    )
    return " or ".join(words.value_counts().index)


def _level_reached(own: Comparison, table: pd.DataFrame) -> dict[str, Any]:
    """Return between which levels of the single numeric choice all conditions meet the requirement;
    {} without.
    """
    if len(own.choices) != 1 or not own.required or not own.results.numeric(own.choices[0]):
        return {}
    levels = own.members[own.choices[0]].to_numpy(dtype=float)
    met = (table["state"] == "met").to_numpy()
    order = np.argsort(levels)
    hits = np.flatnonzero(met[order])
    contiguous = len(hits) > 1 and hits[-1] - hits[0] + 1 == len(hits)
    if not contiguous or len(hits) == len(levels):
        return {}
    head = {}
    if hits[0] > 0:
        head["from_on"] = float(levels[order][hits[0]])
    if hits[-1] < len(levels) - 1:
        head["up_to"] = float(levels[order][hits[-1]])
    return head
