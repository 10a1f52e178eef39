"""The verdict of a study: which candidate to build, or why the study cannot say so.

A candidate is a combination of choices, judged over the conditions of the study. Each case has an interval of its life:
`[0, 0]` where the candidate does not meet its condition, `[0, inf]` where the model cannot judge it, otherwise the life
at both ends of the ranges of the placeholders.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd

from trackroller.damage import LIMITS
from trackroller.errors import listing
from trackroller.methods.b10 import b10, quantile
from trackroller.parameters import BODIES
from trackroller.results.candidates import STRESS, TIED, Candidates, goal_without_lives, slip_margin
from trackroller.results.first_limits import COEFFICIENT, reached_by_body
from trackroller.results.groups import MOST_LEVELS, confined
from trackroller.results.intervals import Cases, OnTarget
from trackroller.results.lives import BESIDE, FIRST_LIMIT
from trackroller.results.pareto import end_places, goals_of
from trackroller.results.results import SAME_ENDS, Results
from trackroller.roller.limit_notes import Placeholder, placeholders_of
from trackroller.roller.output_names import is_life
from trackroller.roller.record import names_not_given
from trackroller.roller.requirement import Requirement
from trackroller.study.design.levels import OF_MATERIALS
from trackroller.study.outputs import flat

CAUSES = {"lifts off": "axial_force", "skids": "motor_force"}  # input that brings a condition out of reach
LOADS = ("radial_force", "axial_force", "motor_force")  # on which each life rests
MANY = 0.5  # share of conditions out of reach by an input that was not given, from which on the input is asked for
RESAMPLES = 400  # of the sampled conditions, for the error of a difference of B10
TAIL = 0.025  # share of the resamples below the 95 % interval
MOST_PLACES = 2  # combinations of two factors that describe conditions
STRONGEST = 50  # candidates of each pair of materials by each measure that may beat others


@dataclass(frozen=True)
class Candidate:
    """A combination of choices with the interval of its life, or of its stress, over the conditions.

    Attributes
    ----------
    number : index in `Candidates.table`
    choices : levels by factor
    low, high, median, best : of the goal: the two ends over the conditions, the median of the conditions, and the high
        end at the best one [goal's unit]
    error : relative error of `low` by the solution [1]
    interval : 95 % interval of `low` where it is the life that nine of ten sampled conditions reach, else NaN
    case, case_high : row of the worst condition, for the low and for the high end
    ends, body : what ends it there: a limit, or the reason why the condition is not met or not judged; '' where nothing
        does; and the body
    ends_high, body_high : what ends it there at the high end of the ranges of the placeholders, and the body
    met, conditions : number of conditions that it meets, and of all conditions that count
    status : `met`, `open` or `missed` of the target; '' without a target
    judged : whether the model judges it in all conditions
    holds : life at the worst condition if the model held outside its range; equals `low` where it is judged
    beyond : whether an end of its life lies beyond the S-N data
    open_limits : limits without hours that are exceeded only at one end of the range of a placeholder
    unchecked : limits that were checked for other candidates only
    edges : choices that stand at the end of their levels
    tested : fitted materials whose tests leave the range of `low` and `high` open
    beyond_tests : whether `low` lies beyond the tests of a fitted material, by its stress or its cycles
    guessed : whether placeholders leave this range open, too
    """

    number: int
    choices: Mapping[str, Any]
    low: float
    high: float
    median: float
    best: float
    error: float
    interval: tuple[float, float]
    case: int
    ends: str
    ends_high: str
    body: str
    body_high: str
    met: int
    conditions: int
    status: str
    judged: bool
    holds: float
    beyond: bool
    open_limits: tuple[str, ...] = ()
    unchecked: tuple[str, ...] = ()
    edges: tuple[str, ...] = ()
    tested: tuple[str, ...] = ()
    beyond_tests: bool = False
    guessed: bool = False
    case_high: int = -1


@dataclass(frozen=True)
class Misses:
    """Conditions that are not met.

    Attributes
    ----------
    count, of : number of these conditions, and of all conditions
    reasons : why, each with the number of its cases, the most frequent first
    where : levels of factors that hold together exactly in these conditions, or two such combinations of two factors;
        empty if no levels do, and for sampled conditions, whose values coincide by chance
    not_given : inputs among the causes that were not given, or where no candidate is enough all such loads, with the
        values that were used
    """

    count: int
    of: int
    reasons: Mapping[str, int]
    where: tuple[Mapping[str, tuple[Any, ...]], ...] = ()
    not_given: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Turn:
    """What to measure or to give, and the value at which the decision turns.

    Attributes
    ----------
    what : value of a material, field of a case, `requirement`, or `tests` of a fitted material
    of, on : its material, and the material that it runs on; '' otherwise
    value : at which the decision turns, NaN if it is not known
    until : from which on the other of two candidates is better for certain, or the target is missed; NaN otherwise
    low, high : range of the placeholder, NaN if there is none
    units : of these numbers
    candidate : number of the candidate that it belongs to, -1 without one
    """

    what: str
    of: str = ""
    on: str = ""
    value: float = np.nan
    until: float = np.nan
    low: float = np.nan
    high: float = np.nan
    units: str = ""
    candidate: int = -1


@dataclass(frozen=True)
class Tradeoff:
    """The ends of a Pareto set.

    Attributes
    ----------
    goals : words, units and direction of each goal
    ends : for each goal the choices and the values of the design that is best in it, and which of these are lives
        beyond the S-N data
    designs : number of Pareto-optimal designs
    """

    goals: tuple[tuple[str, str, str], ...]
    ends: tuple[tuple[Mapping[str, Any], tuple[float, ...], tuple[bool, ...]], ...]
    designs: int


@dataclass(frozen=True)
class Verdict:
    """What a study answers: which candidate to build, or why it cannot say so.

    Attributes
    ----------
    kind : `build`, `a_or_b`, `none`, `measure`, `give`, `cannot_tell`, or `lasts` for a study with one candidate
    goal : column, words and unit of what is compared
    required : smallest life that the target asks for [h], NaN without one
    target : targets of the study; empty without them
    candidates : all candidates, the best first
    named : number of the first candidates that the verdict names: one, or all that the study cannot tell apart
    why : `tie`, `error` or `range` of candidates that it cannot tell apart; of `cannot_tell`: `conditions`, `model`,
        `accuracy` where the error of the solution holds the target, or `sample` where the interval of the sampled
        conditions does, `untried` where it meets the target under the conditions that a table tries it under, or
        `materials` where stresses of different materials would have to rank them
    next : the next best candidate, None without one
    out_of_reach : conditions that no candidate meets, None without one
    fails : where the first candidate misses the target, or its conditions; None if it does not
    turns : what to measure or to give
    rest : verdict over the conditions that remain, of the kind `give`
    tradeoff : of several goals without a target
    tried : number of candidates of a study whose candidates do not repeat; 0 otherwise
    sampled : whether a life is the one that nine of ten sampled conditions reach
    not_checked : limits that were not checked, and `guide` if its hours are not known
    longest : row with the longest life, where no row meets the target and designs do not repeat; otherwise -1
    within_error : row of the first candidate whose error leaves the target open, otherwise -1
    not_given : inputs that were not given, and with whose values a candidate lifts off or skids somewhere
    """

    kind: str
    goal: tuple[str, str, str]
    candidates: tuple[Candidate, ...]
    required: float = np.nan
    target: Mapping[str, Requirement] = field(default_factory=dict)
    named: int = 1
    why: str = ""
    next: Candidate | None = None
    out_of_reach: Misses | None = None
    fails: Misses | None = None
    turns: tuple[Turn, ...] = ()
    rest: Verdict | None = None
    tradeoff: Tradeoff | None = None
    tried: int = 0
    sampled: bool = False
    not_checked: tuple[str, ...] = ()
    longest: int = -1
    within_error: int = -1
    not_given: Mapping[str, float] = field(default_factory=dict)

    @property
    def ranked(self) -> Verdict:
        """Return the verdict that ranks the candidates: that over the rest where a value is asked for, else itself."""
        return self if self.rest is None else self.rest

    @property
    def best(self) -> tuple[Candidate, ...]:
        """Return the candidates that the verdict names."""
        return self.candidates[: self.named]

    @property
    def not_judged(self) -> tuple[Candidate, ...]:
        """Return the candidates that the model does not judge, and that may be better than the first one."""
        first = self.candidates[0].low if self.candidates else 0.0
        return tuple(c for c in self.candidates if not c.judged and (c.high > first or not self.goal_rises))

    @property
    def choices(self) -> tuple[str, ...]:
        """Return the names of the choices; empty where the study cannot tell candidates apart."""
        return tuple(self.candidates[0].choices) if self.candidates else ()

    @property
    def goal_rises(self) -> bool:
        """Return whether more of the goal is better."""
        return is_life(self.goal[0])


def verdict_of(results: Results) -> Verdict | None:
    """Return the verdict of a study; None for a search, and for a study without lives, stresses and targets.

    Parameters
    ----------
    results : Results
        A solved study.

    Returns
    -------
    Verdict or None
        A search recommends its own design, see `trackroller.results.judging.recommended`.

    Notes
    -----
    Candidates of the same materials are compared at equal places of the placeholders: a candidate is beaten if another
    one is nowhere worse, and better beyond the error somewhere. Other candidates are beaten if their high end lies
    below the low end of another one by more than the error. The error is the root of the squares of the errors of both
    solutions and of the sample of conditions. The posterior of a fitted material counts as a place, too: candidates of
    the same materials are compared at equal positions of it.
    """
    lives = (FIRST_LIMIT, *results.fatigue_lives)
    known = (life for life in lives if life[0] in results.table)
    goal = results.life or next(known, None) or goal_without_lives(results)
    if results.config.method.proposes or goal is None or not len(results.table):
        return None
    candidates = Candidates.grouped(results, goal)
    cases = Cases(candidates)
    if not candidates.comparable:
        reach: np.ndarray = np.zeros(len(results.table), dtype=bool)
        turns = _given(cases, reach)
        required, _, may = cases.on_target()
        if results.config.requirement and not may[cases.own].any():
            fails = _misses(cases, cases.own & ~may, cases.own, np.where(cases.reason == "", cases.first, cases.reason))
            facts = {"required": required, "fails": fails, "longest": _longest(candidates), **_shared(cases)}
            return Verdict("none", goal, (), why="conditions", **facts)
        unknown = Verdict("cannot_tell", goal, (), why="conditions", **_shared(cases))
        return replace(unknown, kind="give", turns=turns, rest=unknown) if turns else unknown
    reach = cases.out_of_reach
    turns = _given(cases, reach)
    traded = _tradeoff(results)
    if turns:
        left = cases.own & ~reach
        rest = _decided(cases, left if left.any() else cases.own, reach)
        out = _misses(cases, reach, cases.own, cases.reason)
        beside = {name: value for name, value in rest.not_given.items() if name not in [turn.what for turn in turns]}
        others = replace(rest, out_of_reach=None, not_given=beside) if left.any() else None
        return replace(rest, kind="give", turns=turns, rest=others, out_of_reach=out)
    found = _decided(cases, cases.own, reach)
    if traded is not None and found.kind in ("build", "a_or_b", "measure"):
        found = replace(found, kind="give", turns=(Turn("requirement"),), rest=found, tradeoff=traded)
    return found


def _longest(candidates: Candidates) -> int:
    """Return the usable case with the longest life, -1 without one or in a study without lives."""
    known = candidates.usable
    if not (candidates.rising and known.any()):
        return -1
    return int(np.argmax(np.where(known, candidates.results.column(candidates.goal[0]), -np.inf)))


@dataclass(frozen=True)
class Scores:
    """Both ends of each candidate over its conditions, and what comparing them needs.

    Attributes
    ----------
    low, high : shape (m,), as a life or as 1/stress
    places : both ends at each place of the placeholders and position of the posteriors, shape (m, places)
    judged : shape (m,)
    error : relative errors of the solutions, shape (m,)
    draws : logarithms of B10 of resampled conditions, shape (m, resamples); no columns without a sample
    materials : names of the materials, shape (m,)
    case : row of the worst condition, shape (m,); -1 without one
    stress : whether stresses are compared, which rank candidates of the same materials only
    """

    low: np.ndarray
    high: np.ndarray
    places: np.ndarray
    judged: np.ndarray
    error: np.ndarray
    draws: np.ndarray
    materials: np.ndarray
    case: np.ndarray
    stress: bool

    def beaten_by(self, i: int, others: np.ndarray, exact: bool = False) -> np.ndarray:
        """Return which of the other candidates beat a candidate, shape (k,); `exact` leaves the errors out."""
        error = 0.0 * self.error[others] if exact else self.spread(i, others)
        alike = (self.materials[others] == self.materials[i]) & self.judged[others] & self.judged[i]
        mine, theirs = self.places[i], self.places[others]
        at_equal = (theirs >= mine * (1 - TIED)).all(axis=1) & (theirs > mine * (1 + TIED + error[:, None])).any(axis=1)
        apart = self.low[others] > self.high[i] * (1 + TIED + error)
        return np.asarray(np.where(alike, at_equal, apart))

    def spread(self, i: int, others: np.ndarray) -> np.ndarray:
        """Return the relative errors of the leads of others over a candidate, shape (k,)."""
        numerical = self.error[others] ** 2 + self.error[i] ** 2
        if not self.draws.shape[1]:
            return np.asarray(np.sqrt(numerical))
        least = np.quantile(self.draws[others] - self.draws[i], TAIL, axis=1, method="lower")
        lead = _logarithm(self.low[others]) - _logarithm(self.low[i])
        return np.asarray(np.sqrt(numerical + np.clip(lead - least, 0.0, None) ** 2))

    def unbeaten(self, among: np.ndarray, exact: bool = False) -> np.ndarray:
        """Return which of some candidates no other one of them beats, as numbers."""
        rivals = self._strongest(among)
        return np.array([i for i in among if not self.beaten_by(i, rivals[rivals != i], exact).any()], dtype=int)

    def _strongest(self, among: np.ndarray) -> np.ndarray:
        """Return the candidates that may beat others: the strongest of each pair of materials by each measure."""
        kept: set[int] = set()
        for pair in np.unique(self.materials[among]):
            own = among[self.materials[among] == pair]
            for measure in self.places[own].T:
                kept |= set(own[np.argsort(-measure, kind="stable")[:STRONGEST]].tolist())
        return np.array(sorted(kept), dtype=int)


def _scores(cases: Cases, kept: np.ndarray) -> Scores:
    """Return the ends of each candidate over the cases that are kept."""
    candidates = cases.candidates
    many, levels = len(candidates.size), int(cases.level.max()) + 1
    low, high = cases.ends
    ends = np.full((2, many, levels), np.inf)
    positions = np.full((len(cases.positions), 2, many, levels), np.inf)
    draws = np.zeros((many, 0))
    judged = np.bincount(candidates.place[kept & ~cases.judged], minlength=many) == 0
    if cases.sampled:
        draws = _resampled(cases, kept)
        for i, level in np.ndindex(many, levels):
            rows = kept & (candidates.place == i) & (cases.level == level)
            if rows.any():  # a condition that is not judged counts as 0, unless more than one in ten are not
                sure = np.where(cases.judged, high, 0.0)[rows]
                most = b10(high[rows])[0]
                judged[i] |= b10(sure)[0] > 0
                ends[:, i, level] = b10(low[rows])[0], b10(sure)[0] if judged[i] else most
                for at, both in zip(positions, cases.positions, strict=True) if len(positions) > 1 else ():
                    at[:, i, level] = [quantile(np.where(cases.judged, end, 0.0)[rows], 0.1) for end in both]
    else:
        for out, both in zip([ends, *positions], [(low, high), *cases.positions], strict=True):
            for end, values in zip(out, both, strict=True):
                np.minimum.at(end, (candidates.place[kept], cases.level[kept]), values[kept])
    empty = np.bincount(candidates.place[kept], minlength=many) == 0  # no condition is left
    ends[:, empty] = positions[:, :, empty] = 0.0
    case = cases.worst(kept)
    error = np.where(case < 0, 0.0, cases.error[case])
    table = candidates.members
    named = [name for name in OF_MATERIALS if name in candidates.choices]
    pairs = table[named].astype(str).agg(" / ".join, axis=1).to_numpy(dtype=str) if named else np.full(many, "")
    lowest, highest = ends[0].min(axis=1), ends[1].max(axis=1)
    places = np.concatenate([*ends] if len(positions) == 1 else [end for at in positions for end in at], axis=1)
    return Scores(lowest, highest, places, judged, error, draws, pairs, case, candidates.goal == STRESS)


def _resampled(cases: Cases, kept: np.ndarray) -> np.ndarray:
    """Return the logarithm of B10 of each candidate in resamples of its conditions, shape (m, resamples).

    Candidates that share their conditions share the resamples, so that their common scatter cancels.
    """
    candidates, low = cases.candidates, cases.ends[0]
    out = np.empty((len(candidates.size), RESAMPLES))
    for i in range(len(out)):
        rows = np.flatnonzero(kept & (candidates.place == i))
        if not len(rows):
            out[i] = _logarithm(0.0)
            continue
        rows = rows[np.argsort(cases.use[rows], kind="stable")]
        random = np.random.default_rng(0 if candidates.matched else i)
        drawn = random.multinomial(len(rows), np.full(len(rows), 1 / len(rows)), RESAMPLES)
        order = np.argsort(low[rows], kind="stable")
        reached = drawn[:, order].cumsum(axis=1) >= 0.1 * len(rows)
        out[i] = _logarithm(low[rows][order][np.argmax(reached, axis=1)])
    return out


def _logarithm(lives: np.ndarray | float) -> np.ndarray:
    """Return the logarithm of lives; that of 0 and of infinity is a finite number beyond all others."""
    with np.errstate(divide="ignore"):
        return np.asarray(np.clip(np.log(lives), -100.0, 100.0))


def _status(cases: Cases, rows: np.ndarray, sure: np.ndarray, may: np.ndarray, of_all: bool = True) -> str:
    """Return whether a candidate meets a target in its cases: `met`, `missed`, or `open`.

    All conditions count, or nine of ten of a sample, at each place of the placeholders. A sample stands for all
    conditions, so that its 95 % interval counts; with `of_all` False it stands for itself alone.
    """

    def ends(hits: np.ndarray) -> list[tuple[bool, bool]]:
        """Return whether enough conditions are hits, for certain and possibly, at each place."""
        found = []
        for level in np.unique(cases.level[rows]):
            own = hits[rows[cases.level[rows] == level]].astype(float)
            value, low, high = b10(own) if cases.sampled else (own.min(),) * 3
            found.append((low > 0, high > 0) if of_all else (value > 0, value > 0))
        return found

    if all(certain for certain, _ in ends(sure)):
        return "met"
    return "open" if any(possible for _, possible in ends(may)) else "missed"


def _of_all_rows(cases: Cases, i: int, shared: str, sure: np.ndarray, may: np.ndarray) -> str:
    """Return whether a candidate meets the target in all its rows of a table, from the status over shared conditions.

    It is open where another candidate was tried under a condition that this one was not tried under.
    """
    untried = cases.candidates.untried
    own = untried & (cases.candidates.design == i)
    if not shared or shared == "missed" or not untried.any():
        return shared
    if not may[own].all():
        return "missed"
    everywhere = set(cases.use[own]) == set(cases.use[untried])
    return shared if everywhere and sure[own].all() else "open"


def _decided(cases: Cases, wanted: np.ndarray, reach: np.ndarray) -> Verdict:
    """Return the verdict over the cases `wanted`; those out of reach are left out of the ranking, not of the target."""
    candidates, target = cases.candidates, cases.results.config.requirement
    kept = wanted & ~reach
    kept = kept if kept.any() else wanted
    if target and cases.sampled:  # nine of ten of all conditions
        kept = wanted
    scores = _scores(cases, kept)
    required, sure, may = cases.on_target()
    counted, good = (wanted, cases.on_target(scattered=False)[1]) if target else (kept, cases.ends[0] > 0)
    size = cases.conditions_in(counted)
    met = size - cases.conditions_in(counted & ~good)
    rows = [np.flatnonzero(counted & (candidates.place == i)) for i in range(len(size))]
    within = cases.on_target(exact=False)[1:]
    shared = np.array([_status(cases, own, *within) if target else "" for own in rows])
    status = np.array([_of_all_rows(cases, i, str(word), *within) for i, word in enumerate(shared)])
    order = _order(scores, status, met / np.maximum(size, 1), _least_met(cases, counted & good))
    kind, first, why = _by_target(scores, order, status) if target else _by_rank(scores, order)
    if kind == "measure" and target:  # unless no value is missing, but a finer solution or conditions are
        decided = [_status(cases, rows[first[0]], sure, may, of_all) != "open" for of_all in (True, False)]
        if _of_all_rows(cases, first[0], "met", sure, may) == "open":
            kind, why = "cannot_tell", "untried"
        elif any(decided):
            kind, why = "cannot_tell", "accuracy" if decided[0] else "sample"
    unsure = _within_error(cases, rows[first[0]], (sure, may), within) if why == "accuracy" else -1
    order = np.array([*first, *(i for i in order if i not in first)])
    everywhere = wanted | candidates.untried
    if kind == "none":  # of all conditions, those without any candidate included
        size = cases.conditions_in(everywhere)
        met = size - cases.conditions_in(everywhere & ~good)
    facts = {"met": met, "conditions": size, "status": status}
    listed = tuple(_candidate(cases, scores, kept, int(i), facts) for i in order)
    named = len(first) or min(1, len(listed))
    left = [one for one in listed[named:] if one.judged and scores.high[one.number] > 0]
    found = Verdict(
        kind,
        candidates.goal,
        listed,
        required=required,
        named=named,
        why=why,
        next=left[0] if left and first else None,
        out_of_reach=_misses(cases, wanted & reach, wanted, cases.reason) if (wanted & reach).any() else None,
        within_error=unsure,
        **_shared(cases),
    )
    if kind == "none":
        own = everywhere & (candidates.design == listed[0].number)
        reason = np.where(cases.reason == "", cases.first, cases.reason)
        fails = _misses(cases, own & ~good, own, reason)
        loads = {n: float(cases.results.base[n]) for n in LOADS if _unnamed(cases.results, n)}
        return replace(found, fails=replace(fails, not_given=loads))
    return replace(found, turns=_turns(cases, found)) if kind == "measure" else found


def _within_error(cases: Cases, rows: np.ndarray, exact: OnTarget, within: OnTarget) -> int:
    """Return the row among those whose error changes whether the target is met that lasts shortest within its error."""
    changed = [rows[(a != b)[rows]] for a, b in zip(exact, within, strict=True)]
    own = next(own for own in changed if len(own))
    return int(own[np.argmin((cases.ends[0] / (1.0 + cases.error))[own])])


def rows_of(candidates: Candidates, one: Candidate, kept: np.ndarray) -> np.ndarray:
    """Return the cases of a candidate among those that are kept, shape (n,)."""
    return np.asarray(kept & (candidates.place == one.number))


def _order(scores: Scores, status: np.ndarray, share: np.ndarray, life: np.ndarray) -> np.ndarray:
    """Return the numbers of the candidates, the best first.

    Those that meet the target come first, by the low end; then open ones; then by the share of conditions that are met.
    """
    rank = np.array([("met", "open", "missed").index(word) if word else 0 for word in status])
    low = np.where(rank < 2, scores.low, 0.0)
    return np.lexsort((-scores.high, -life, -share, -low, rank))


def _least_met(cases: Cases, rows: np.ndarray) -> np.ndarray:
    """Return the smallest low end of each candidate among some cases, shape (m,); 0 without one."""
    out = np.full(len(cases.candidates.size), np.inf)
    np.minimum.at(out, cases.candidates.place[rows], cases.ends[0][rows])
    some = np.bincount(cases.candidates.place[rows], minlength=len(out)) > 0
    return np.where(some, out, 0.0)


Found = tuple[str, list[int], str]  # kind, numbers of the named candidates, and why


def _by_target(scores: Scores, order: np.ndarray, status: np.ndarray) -> Found:
    """Return the verdict with a target: the best that meet it, else what is open, else none."""
    met = order[status[order] == "met"]
    if scores.stress and len(firsts := _first_of_materials(scores, met)) > 1:
        return "cannot_tell", firsts, "materials"
    if len(met):
        rivals = [i for i in met[1:] if scores.low[met[0]] <= scores.low[i] * (1 + TIED + _error(scores, met[0], i))]
        return _together(scores, [int(met[0]), *map(int, rivals)], len(scores.low) == 1)
    maybe = order[status[order] == "open"]
    judged = maybe[scores.judged[maybe]]
    if len(judged):
        return "measure", [int(judged[0])], "range"
    return ("cannot_tell", [], "model") if len(maybe) else ("none", [], "")


def _first_of_materials(scores: Scores, among: np.ndarray) -> list[int]:
    """Return the first of some candidates of each pair of materials, as numbers."""
    places = np.unique(scores.materials[among], return_index=True)[1]
    return [int(i) for i in among[np.sort(places)]]


def _error(scores: Scores, i: int, j: int) -> float:
    """Return the relative error of the lead of the first candidate over the second one."""
    return float(scores.spread(j, np.array([i]))[0])


def _together(scores: Scores, named: list[int], alone: bool) -> Found:
    """Return `build` for one candidate, otherwise that they tie or lie within the error."""
    if len(named) == 1:
        return "lasts" if alone else "build", named, ""
    first = scores.places[named[0]]
    tie = all(np.isclose(scores.places[i], first, rtol=2 * TIED, atol=0).all() for i in named)
    return "a_or_b", named, "tie" if tie else "error"


def _by_rank(scores: Scores, order: np.ndarray) -> Found:
    """Return the verdict without a target: the unbeaten candidates."""
    pool = order[scores.judged[order] & (scores.high[order] > 0)]
    if not len(pool):
        unknown = (~scores.judged & (scores.high > 0)).any()
        return ("cannot_tell", [], "model") if unknown else ("none", [], "")
    if scores.stress and len(firsts := _first_of_materials(scores, pool)) > 1:
        return "cannot_tell", firsts, "materials"
    best = scores.unbeaten(pool)
    certain = scores.unbeaten(pool, exact=True)
    places = scores.places[certain]
    if len(certain) > 1 and not np.isclose(places, places[0], rtol=2 * TIED, atol=0).all():
        return "measure", [int(i) for i in best], "range"
    return _together(scores, [int(i) for i in best], len(scores.low) == 1)


def _candidate(cases: Cases, scores: Scores, kept: np.ndarray, i: int, facts: Mapping[str, np.ndarray]) -> Candidate:
    """Return a candidate as data."""
    candidates, results = cases.candidates, cases.results
    own = candidates.place == i
    rows = np.flatnonzero(kept & own) if (kept & own).any() else np.flatnonzero(own)
    case = int(scores.case[i]) if scores.case[i] >= 0 else int(rows[0])
    goal, judged, met = results.column(candidates.goal[0]), cases.judged, cases.reason == ""
    known = goal[rows[(met | ~judged)[rows] & ~np.isnan(goal[rows])]]
    never = 0.0 if candidates.rising else np.inf
    middle = np.where(met, goal, never)[rows[judged[rows]]]
    highest = _worst_high(cases, rows, case)
    interval = b10(cases.ends[0][rows])[1:] if cases.sampled else (np.nan, np.nan)
    return Candidate(
        number=i,
        choices={name: _plain(results.table[name].iloc[rows[0]]) for name in candidates.choices},
        low=_as_goal(candidates, scores.low[i]),
        high=_as_goal(candidates, scores.high[i]),
        median=float(np.median(middle)) if middle.size else np.nan,
        best=_as_goal(candidates, cases.ends[1][rows[judged[rows]]].max(initial=0.0)),
        error=float(scores.error[i]),
        interval=(float(interval[0]), float(interval[1])),
        case=case,
        ends=str(cases.reason[case] or ("" if np.isinf(cases.ends[0][case]) else cases.low_end[0][case])),
        ends_high=str(cases.reason[highest] or ("" if np.isinf(cases.ends[1][highest]) else cases.high_end[highest])),
        body="guide" if cases.low_end[1][case] else "roller",
        body_high="guide" if cases.at_end("_high")[1][highest] else "roller",
        met=int(facts["met"][i]),
        conditions=int(facts["conditions"][i]),
        status=str(facts["status"][i]),
        judged=bool(scores.judged[i]),
        holds=float(known.min() if candidates.rising else known.max()) if known.size else np.nan,
        beyond=bool(met[case] and (cases.beyond[case] or cases.beyond_at_high[highest])),
        open_limits=tuple(name for name, there in cases.open_limits.items() if there[rows].any()),
        unchecked=_unchecked(cases, rows),
        edges=_edges(candidates, results.table.iloc[rows[0]]),
        tested=tuple(name for name, there in cases.tested.items() if there[case]),
        beyond_tests=bool(cases.beyond_tests[case] and met[case]),
        guessed=bool(cases.guessed[case] and met[case]),
        case_high=highest,
    )


def _worst_high(cases: Cases, rows: np.ndarray, case: int) -> int:
    """Return the row of a candidate with the smallest high end: `case` if none is smaller there, or of a sample."""
    high = cases.ends[1]
    if cases.sampled:
        return case
    groups = [rows[cases.level[rows] == level] for level in np.unique(cases.level[rows])]
    best = max(groups, key=lambda own: high[own].min())
    least = int(best[np.argmin(high[best])])
    alike = best[cases.use[best] == cases.use[case]]
    return case if len(alike) and high[alike].min() <= high[least] * (1 + TIED) else least


def _as_goal(candidates: Candidates, score: float) -> float:
    """Return a score in the unit of the goal: a life as it is, a stress from 1/stress."""
    if candidates.rising:
        return float(score)
    return float(1.0 / score) if score > 0 else np.inf


def _edges(candidates: Candidates, row: pd.Series) -> tuple[str, ...]:
    """Return the choices of a candidate that stand at the smallest or largest of at least three numbers."""
    results = candidates.results
    numbers = [name for name in candidates.choices if results.numeric(name) and len(results.levels(name)) > 2]
    return tuple(n for n in numbers if row[n] in (results.levels(n)[0], results.levels(n)[-1]))


def _unchecked(cases: Cases, rows: np.ndarray) -> tuple[str, ...]:
    """Return the limits with hours that are known for some candidates and in none of these cases."""
    data = cases.results.data
    if "life_hours_by_limit" not in data:
        return ()
    known = ~np.isnan(flat(data, "life_hours_by_limit", cases.results.dims)).all(axis=2)
    names = data["limit"].values.tolist()
    return tuple(
        name for i, name in enumerate(names) if name not in BESIDE and known[:, i].any() and not known[rows, i].any()
    )


def _shared(cases: Cases) -> dict[str, Any]:
    """Return what every verdict of a study says."""
    candidates = cases.candidates
    return {
        "target": cases.results.config.requirement,
        "tried": 0 if cases.conditions else len(candidates.size),
        "sampled": cases.sampled,
        "not_checked": not_checked(cases.results, candidates.rising),
        "not_given": {n: float(cases.results.base[n]) for n, rows in _by_not_given(cases).items() if rows.any()},
    }


def not_checked(results: Results, lives: bool = True) -> tuple[str, ...]:
    """Return the limits that a study did not check, and `guide` if the hours of the guide are not known.

    Parameters
    ----------
    results : the solved study
    lives : whether the study compares lives

    Notes
    -----
    The life by fatigue is known at a failure probability other than 0.5 only for materials that state their scatter:
    `fatigue of the guide` names a body whose material does not.
    """
    first = results.life == FIRST_LIMIT
    known = {"static"} if lives or results.has(STRESS[0]) else set()
    known |= {"fatigue"} if lives and not first else set()
    given = results.data.get("guide_overrollings_per_hour")
    hours = results.knows("guide_life_hours") or (given is not None and bool(given.notnull().any()))
    some: list[str] = []
    if "limit" in results.data.dims:
        names = results.data["limit"].values.tolist()
        values = [results.data[n] for n in ("utilisation", "life_hours_by_limit") if n in results.data]
        known |= {name for i, name in enumerate(names) if any(v.isel(limit=i).notnull().any() for v in values)}
        if first and "fatigue" in known:
            fatigue = results.data["life_hours_by_limit"].sel(limit="fatigue")
            bodies = [body for body in BODIES if body != "guide" or hours]
            some = [f"fatigue of the {body}" for body in bodies if not fatigue.sel(body=body).notnull().any()]
    wanted = [name for name, limit in LIMITS.items() if limit.verdict is not None and name not in BESIDE]
    missing = [name for name in wanted if name not in known]
    return tuple(missing + some + ["guide"] * (lives and not hours))


def _misses(cases: Cases, bad: np.ndarray, among: np.ndarray, reason: np.ndarray) -> Misses:
    """Describe cases that are not met among others, by their conditions."""
    candidates, names, use = cases.candidates, cases.conditions, cases.use
    table = candidates.results.table
    for name in reversed(cases.other_targets):  # the first one is named
        reason = np.where((cases.reason == "") & ~candidates.results.meets(name), f"target {name}", reason)
    counts = Counter(str(word) for word in reason[bad])
    causes = [name for cause, name in CAUSES.items() if cause in counts and _unnamed(candidates.results, name)]
    found = Misses(
        len(np.unique(use[bad])),
        len(np.unique(use[among])),
        dict(counts.most_common()),
        not_given={name: float(candidates.results.base[name]) for name in causes},
    )
    if candidates.drawn or not bad.any():
        return found
    restricted: dict[str, tuple[Any, ...]] = {}
    for name in names:
        levels = [v for v in candidates.results.levels(name) if (table[name].to_numpy() == v)[bad].any()]
        if len(levels) < len(candidates.results.levels(name)):
            restricted[name] = tuple(map(_plain, levels))
    covered = among & np.all([among, *(table[name].isin(own).to_numpy() for name, own in restricted.items())], axis=0)
    if restricted and set(use[covered]) == set(use[bad]):
        return replace(found, where=(restricted,))
    first = np.flatnonzero(among)[np.unique(use[among], return_index=True)[1]]  # a row of each condition
    few = [name for name in names if len(candidates.results.levels(name)) <= MOST_LEVELS]
    hit = np.isin(use[first], use[bad])
    products = confined(table.iloc[first], few, hit, np.ones(len(first), dtype=bool), MOST_PLACES, whole=True)
    return replace(found, where=tuple(one.levels for one in products))


def _plain(value: Any) -> Any:
    """Return a level as a plain number or text."""
    return value.item() if isinstance(value, np.generic) else value


def _unnamed(results: Results, name: str) -> bool:
    """Return whether an input of the roller was not given, and is no factor either."""
    return name in names_not_given(results.data.attrs) and name not in results.factors


def _by_not_given(cases: Cases) -> dict[str, np.ndarray]:
    """Return the cases that lift off or skid by each input that was not given, shape (n,) by its name.

    A case whose drive exceeds what friction transmits skids under any axial force, so that this force is no remedy
    there.
    """
    skids = slip_margin(cases.results) < 0
    return {
        name: cases.own & (cases.reason == cause) & ~(skids & (name != "motor_force"))
        for cause, name in CAUSES.items()
        if _unnamed(cases.results, name)
    }


def _given(cases: Cases, reach: np.ndarray) -> tuple[Turn, ...]:
    """Return the inputs that were not given and that bring conditions out of reach of every candidate.

    With a target each such condition counts, because no candidate can meet it. Without one the verdict turns on the
    input if it takes at least half of the conditions.
    """
    results = cases.results
    turns = []
    for name, by_it in _by_not_given(cases).items():
        hopeless = by_it & reach
        wanted = bool(results.config.requirement) and hopeless.any()
        share = hopeless.sum() if cases.candidates.matched and cases.conditions else by_it.sum()
        if wanted or share >= MANY * cases.own.sum():
            turns.append(Turn(name, low=float(results.base[name]), high=float(results.base[name]), units="N"))
    return tuple(turns)


def _tradeoff(results: Results) -> Tradeoff | None:
    """Return the ends of the Pareto set; None unless the study file has several goals and no target."""
    if len(results.config.pareto) < 2 or results.config.requirement:
        return None
    front = results.pareto()
    if front is None or front.attrs.get("kind") == "case" or (front["optimal"].values == 1).sum() < 2:
        return None
    goals, names = goals_of(front), [n for n in str(front.attrs["factors"]).split(", ") if n in front]
    ends = tuple(
        (
            {n: _plain(front[n].values[place]) for n in names},
            tuple(float(front[goal].values[place]) for goal, _ in goals),
            tuple(f"beyond_{goal}" in front and bool(front[f"beyond_{goal}"].values[place]) for goal, _ in goals),
        )
        for place in end_places(front)
    )
    words = tuple(
        (str(front[n].attrs.get("long_name") or n), str(front[n].attrs.get("units", "")), way) for n, way in goals
    )
    return Tradeoff(words, ends, int((front["optimal"].values == 1).sum()))


def _turns(cases: Cases, found: Verdict) -> tuple[Turn, ...]:
    """Return what to measure, with the value at which the decision turns where the life follows from it.

    The life until a body wears is inversely proportional to its wear coefficient, and the use of the shakedown limit to
    its yield strength.
    """
    one = max(found.best, key=lambda c: c.high / c.low if c.low > 0 else np.inf)  # the widest range
    other = next((c for c in found.best if c.number != one.number), None)
    least = found.required if np.isfinite(found.required) else other.high if other else np.nan
    until = least if np.isfinite(found.required) else other.low if other else np.nan
    turns = [_of_limit(cases, one, limit) for limit in one.open_limits]
    turns += [Turn("tests", name, candidate=one.number) for name in one.tested]
    if one.ends == "wear" or not turns:
        turns.append(_of_wear(cases, one, least, until))
        alone = np.isfinite([turns[-1].value, turns[-1].until]).any() or np.isfinite(found.required)
        if not alone:  # one coefficient does not decide
            others = (c for c in found.best if c.number != one.number and c.ends == "wear")
            turns += [_of_wear(cases, c, np.nan, np.nan) for c in others]
    first = {(turn.what, turn.of, turn.on): turn for turn in reversed(turns)}
    return tuple(turn for turn in turns if first[turn.what, turn.of, turn.on] is turn)


def open_values(cases: Cases, number: int) -> tuple[Turn, ...]:
    """Return what to measure for a candidate whose range leaves the target of the study open."""
    candidates, many = cases.candidates, len(cases.candidates.size)
    facts = {"met": np.zeros(many), "conditions": candidates.size, "status": np.full(many, "open")}
    one = _candidate(cases, _scores(cases, cases.own), cases.own, number, facts)
    return _turns(cases, Verdict("measure", candidates.goal, (one,), required=cases.on_target()[0], named=1))


def _bodies(cases: Cases, one: Candidate) -> tuple[str, str]:
    """Return the material of the body that ends a candidate, and the material of the other body."""
    names = {body: str(cases.results.material(body)[one.case]) for body in BODIES}
    return names[one.body], names["roller" if one.body == "guide" else "guide"]


def _of_wear(cases: Cases, one: Candidate, least: float, until: float) -> Turn:
    """Return the wear coefficient below which a candidate reaches `least`, and above which it stays below `until`.

    Both are one value for a required life, unless the life lies between bounds for one coefficient.

    The low end of its life belongs to the high end of the coefficient. The high end belongs to the low end of the
    coefficient, or where places of the placeholder are rows of their own, to that of the worst row.
    """
    of, on = _bodies(cases, one)
    if one.ends != "wear":
        return Turn("placeholder_position", of, on, candidate=one.number)
    found = [p for p in _placeholders(cases.results, "wear", of) if p.on == on]
    low, high, units = (found[0].low, found[0].high, found[0].units) if found else (np.nan, np.nan, "")
    if COEFFICIENT in cases.spans:
        levels = cases.results.levels(COEFFICIENT)
        low, high, units = float(levels[0]), float(levels[-1]), "times its value"
    place = cases.results.data["limit"].values.tolist().index("wear"), BODIES.index(one.body)
    longest = float(reached_by_body(cases.results, "_high")[one.case][place])  # another limit may end it before
    there = high if cases.spans else low
    value, beyond = high * one.low / least, there * longest / until if until > 0 else np.nan
    alike = until == least and beyond <= value * (1.0 + SAME_ENDS)
    value, beyond = (x if low < x < high else np.nan for x in (value, beyond))
    beyond = np.nan if alike else beyond
    return Turn("wear_coefficient", of, on, value, beyond, low, high, units, one.number)


def _of_limit(cases: Cases, one: Candidate, limit: str) -> Turn:
    """Return the placeholders that an open limit rests on, and of the only one the value from which it is kept."""
    results = cases.results
    rows = rows_of(cases.candidates, one, cases.own)
    place = results.data["limit"].values.tolist().index(limit)
    use = flat(results.data, "utilisation", results.dims)[rows, place]
    body = BODIES[int(np.nanargmax(np.nanmax(use, axis=0)))] if np.isfinite(use).any() else one.body
    of = str(results.material(body)[one.case])
    several = list(dict.fromkeys(one.name for one in _placeholders(results, limit, of)))
    if len(several) > 1:  # which of them opens the limit is not known
        return Turn(listing(several, "or"), of, candidate=one.number)
    own = next(iter(_placeholders(results, limit, of)), Placeholder(limit, of, "placeholder"))
    stored = json.loads(str(results.data.attrs.get("materials", "{}"))).get(of, {}).get(own.name, np.nan)
    known = own.name == "yield_strength" and np.isfinite(use).any()
    value = float(stored) * float(np.nanmax(use)) if known else np.nan
    return Turn(own.name, of, own.on, value, np.nan, own.low, own.high, own.units, one.number)


def _placeholders(results: Results, limit: str, material: str) -> list[Placeholder]:
    """Return the placeholders of a material on which a limit rests."""
    return [one for one in placeholders_of(results.data) if (one.limit, one.material) == (limit, material)]
