"""Judge the candidates of a search over their conditions, and choose among the best ones."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from trackroller.methods.b10 import b10
from trackroller.methods.factor import readable
from trackroller.methods.optimise import crowding
from trackroller.parameters import REGIME_LABELS, REGIMES
from trackroller.results.answer import Required
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.comparison import Comparison
from trackroller.results.constraints import Column
from trackroller.results.lives_by_tests import beyond_sn_data
from trackroller.results.requirement import requirements_of
from trackroller.results.solved_cases import OUTSIDE, SolvedCases, made_once
from trackroller.roller.output_names import is_life
from trackroller.roller.requirement import Requirement
from trackroller.study.file.search import judged_by
from trackroller.study.outputs import flat

# a condition in which it does not roll, or has no known life, counts as 0
SAFE_B10 = "B10 of {} over all conditions"
SHARE_ROUNDING = 1e-9  # of a share of conditions
OPTIMUM = "optimum"  # attribute of study.nc with what the search found (JSON)


@dataclass(frozen=True)
class Judged:
    """Designs with their goals.

    Attributes
    ----------
    genes : shape (n, choices)
    values : goals in their units, shape (n, goals); NaN where no condition gives a value
    costs : the same with smaller as better
    violation : share of the conditions in which the candidate is not valid [1], shape (n,); 0 where
        B10 or a probability counts these conditions, and where the requirement allows so many to
        fail
    reasons : cases by what they break, of all candidates together
    goals : what each column of `values` is, with `min` or `max`
    short : how far a candidate is from the requirement of the study, see `shortfall`; shape (n,),
        0 everywhere without one
    life : shortest life over the conditions, of a range its low end; shape (n,), 0 everywhere
        without lives
    share : smallest share of the conditions that surely meets a requirement [1], shape (n,); NaN
        without one
    required : output of each requirement at its worst condition, of a range its worse end; shape
        (n, requirements)
    """

    genes: np.ndarray
    values: np.ndarray
    costs: np.ndarray
    violation: np.ndarray
    short: np.ndarray
    life: np.ndarray
    share: np.ndarray
    required: np.ndarray
    reasons: Mapping[str, int] = field(default_factory=dict)
    goals: Mapping[str, str] = field(default_factory=dict)

    @property
    def missed(self) -> np.ndarray:
        """What a candidate misses, shape (n,): conditions in which it is not valid, and the
        requirement; 0 for nothing.

        A candidate that misses less is better, whatever its goals.
        """
        return np.asarray(self.violation + self.short)

    def take(self, rows: np.ndarray) -> Judged:
        """Return some of the candidates."""
        own: dict[str, Any] = {name: getattr(self, name)[rows] for name in _BY_CANDIDATE}
        return replace(self, **own)

    def __add__(self, other: Judged) -> Judged:
        """Return the candidates of both."""
        counts = {
            k: self.reasons.get(k, 0) + other.reasons.get(k, 0)
            for k in {**self.reasons, **other.reasons}
        }
        both: dict[str, Any] = {
            name: np.concatenate((getattr(self, name), getattr(other, name)))
            for name in _BY_CANDIDATE
        }
        return replace(self, **both, reasons=counts)


_BY_CANDIDATE = ("genes", "values", "costs", "violation", "short", "life", "share", "required")


def goals_of_search(results: SolvedCases) -> dict[str, str]:
    """Return the goals of a search: the key `goals`, otherwise the usual ones."""
    return dict(results.config.goals) or results.goals


def judge(results: SolvedCases, genes: np.ndarray | None = None) -> Judged:
    """Judge each candidate of a solved search over its conditions.

    Parameters
    ----------
    results : SolvedCases
        A solved study with `method: optimise`.
    genes : numpy.ndarray, shape (n, choices), optional
        Genes of the candidates; by default those of the design.
    """
    design = results.design
    goals = goals_of_search(results)
    table, known = _values(results)
    counted = all(judged_by(goal)[0] in ("b10", "probability") for goal in goals)
    if genes is None:
        places = [list(design.factors).index(name) for name in design.meta["outer"]]
        genes = design.unit[:: design.meta["inner_samples"], places]
    costs = table * np.where(np.array(list(goals.values())) == "max", -1.0, 1.0)
    if counted:
        violation = np.isnan(table).any(axis=1).astype(float)
    else:
        violation = _beyond_spare(results, 1.0 - known.mean(axis=1))
    return Judged(
        genes=genes,
        values=table,
        costs=costs,
        violation=violation,
        short=shortfall(results),
        life=_shortest(results),
        share=_smallest_share(results),
        required=_required_values(results),
        reasons=_reasons(results, known.ravel()),
        goals=goals,
    )


def _beyond_spare(results: SolvedCases, lost: np.ndarray) -> np.ndarray:
    """Return shares of conditions in which candidates are not valid; 0 where the requirement allows
    so many to fail.
    """
    required = _to_meet(results).values()
    if not required or not all(own.in_shares for own in required):
        return lost
    spare = 1.0 - max(own.probability for own in required)
    return np.where(lost <= spare + SHARE_ROUNDING, 0.0, lost)


def _shortest(results: SolvedCases) -> np.ndarray:
    """Return the shortest life of each candidate over its conditions, of a range its low end, shape
    (candidates,).
    """
    shape = results.design.meta["design_points"], results.design.meta["inner_samples"]
    life = life_of_search(results)
    if life is None:
        return np.zeros(shape[0])
    return np.asarray(life.low.reshape(shape).min(axis=1))


def _smallest_share(results: SolvedCases) -> np.ndarray:
    """Return the smallest share of the conditions in which each candidate surely meets a
    requirement; NaN without one.
    """
    nothing = np.full(results.design.meta["design_points"], np.nan)
    return np.asarray(np.fmin.reduce([nothing, *(own.sure for own in shares_of(results))]))


def _required_values(results: SolvedCases) -> np.ndarray:
    """Return the output of each requirement at its worst condition, shape (candidates,
    requirements).
    """
    shape = results.design.meta["design_points"], results.design.meta["inner_samples"]
    columns = [np.zeros((shape[0], 0))]
    for _, own in judges_of(results):
        worse = own.worse.reshape(shape)
        if own.rises:
            worst = worse.min(axis=1)
        else:
            worst = worse.max(axis=1)
        columns.append(worst[:, None])
    return np.concatenate(columns, axis=1)


def _values(results: SolvedCases) -> tuple[np.ndarray, np.ndarray]:
    """Return the goals of each candidate, (candidates, goals), and where all goals of a case are
    known, (candidates, cases).
    """
    design = results.design
    shape = design.meta["design_points"], design.meta["inner_samples"]
    valid = results.holds.reshape(shape)
    goals = goals_of_search(results)
    values = []
    known = valid.copy()
    for goal in goals:
        kind, output = judged_by(goal)
        if kind == "probability":
            values.append(_met(results, output).reshape(shape).mean(axis=1))
            continue
        raw = results.quantity(output)[0].astype(float).reshape(shape)
        good = valid & ~np.isnan(raw)
        if kind != "b10":  # which counts a condition without a life as life 0
            known &= good
        values.append(_over_conditions(raw, good, kind, goals[goal]))
    return np.stack(values, axis=1), known


def required(results: SolvedCases) -> bool:
    """Return whether a search has a requirement that its candidates have to meet."""
    return bool(_to_meet(results))


def _to_meet(results: SolvedCases) -> dict[str, Requirement]:
    """Return what the candidates of a search have to meet.

    An output whose probability is a goal has to meet its requirement in as many conditions as
    possible, unless the requirement says in how many.
    """
    chances = {
        judged_by(goal)[1]
        for goal in goals_of_search(results)
        if judged_by(goal)[0] == "probability"
    }
    required = requirements_of(results)
    return {name: own for name, own in required.items() if own.in_shares or name not in chances}


@made_once
def judges_of(results: SolvedCases) -> list[tuple[Required, CaseRanges]]:
    """Return each requirement that the candidates of a search have to meet, with the output that
    judges it.
    """
    own = Comparison.of(results)
    required = _to_meet(results)
    if own is None:
        return []
    return [pair for pair in own.judges if pair[0].output in required]


def life_of_search(results: SolvedCases) -> CaseRanges | None:
    """Return the life that orders candidates with the same goals, with its range; None in a study
    without lives.
    """
    if results.life is None:
        return None
    return CaseRanges(results, results.life, True)


@dataclass(frozen=True)
class Shares:
    """The share of the conditions in which each candidate of a search meets one requirement.

    Attributes
    ----------
    required : the requirement
    sure, may : shares of the conditions that surely meet it, and that may meet it [1], shape
        (candidates,)
    least : share that is enough [1]
    """

    required: Required
    sure: np.ndarray
    may: np.ndarray
    least: float

    def enough(self, shares: np.ndarray) -> np.ndarray:
        """Return which shares are enough."""
        return np.asarray(shares >= self.least - SHARE_ROUNDING)


@made_once
def shares_of(results: SolvedCases, exact: bool = False) -> list[Shares]:
    """Return the share of the conditions in which each candidate meets each requirement of a
    search.

    All conditions have to meet a requirement without a probability; nine of ten where a goal is a
    B10.
    """
    design = results.design
    shape = design.meta["design_points"], design.meta["inner_samples"]
    enough = 1.0
    if any(judged_by(goal)[0] == "b10" for goal in goals_of_search(results)):
        enough = min(1.0, float(np.floor(0.9 * shape[1] + 1.0)) / shape[1])
    shares = []
    for one, own in judges_of(results):
        sure, may = (hits.reshape(shape).mean(axis=1) for hits in own.meets(one, exact))
        if np.isnan(one.probability):
            share = enough
        else:
            share = one.probability
        shares.append(Shares(one, sure, may, share))
    return shares


def shortfall(results: SolvedCases, exact: bool = False) -> np.ndarray:
    """Return how far each candidate of a search is from the requirement of the study, shape
    (candidates,).

    Parameters
    ----------
    results : the solved search
    exact : whether the errors of the solutions do not count

    Returns
    -------
    0 where the candidate meets every requirement; 1 where a range or an error leaves that open, 2
    where it misses one, plus a part below 1 by the share of the conditions that lacks, then by the
    life. 0 for all without a requirement.
    """
    count = results.design.meta["design_points"]
    shares = shares_of(results, exact)
    if not shares:
        return np.zeros(count)
    met = np.all([own.enough(own.sure) for own in shares], axis=0)
    may = np.all([own.enough(own.may) for own in shares], axis=0)
    lack = np.max([np.clip(own.least - own.sure, 0.0, 1.0) for own in shares], axis=0)
    missing = 0.9 * lack + 0.09 * _life_gap(results) * (0.5 / results.design.meta["inner_samples"])
    return np.asarray(np.where(met, 0.0, np.where(may, 1.0, 2.0) + missing))


def _life_gap(results: SolvedCases) -> np.ndarray:
    """Return how much the shortest life of each candidate lacks of the required one, 0 to 1, shape
    (candidates,).
    """
    gap = np.zeros(results.design.meta["design_points"])
    for one, own in judges_of(results):
        if is_life(own.output[0]) and one.least > 0:
            gap = np.maximum(gap, 1.0 - np.clip(_shortest(results) / one.least, 0.0, 1.0))
    return gap


def _met(results: SolvedCases, output: str) -> np.ndarray:
    """Return which cases are in a regime, or are valid and meet a target of the study, shape
    (n,).
    """
    if output in REGIMES:
        return np.asarray(results.regime == REGIMES.index(output))
    return np.asarray(results.holds & results.meets(output))


def _over_conditions(raw: np.ndarray, good: np.ndarray, kind: str, way: str) -> np.ndarray:
    """Return a statistic of a result over the conditions of each candidate, shape (n, conditions)
    -> (n,).
    """
    if kind == "b10":
        return np.array([b10(lives)[0] for lives in np.where(good, raw, 0.0)])
    out = np.full(len(raw), np.nan)
    some = good.any(axis=1)
    if kind == "mean":
        out[some] = np.mean(raw[some], axis=1, where=good[some])
    else:
        if way == "max":
            worst, end = np.min, np.inf
        else:
            worst, end = np.max, -np.inf
        out[some] = worst(np.where(good, raw, end)[some], axis=1)
    return out


def _reasons(results: SolvedCases, known: np.ndarray) -> dict[str, int]:
    """Count the cases that do not count, by what they break."""
    counts = {word: int((results.regime == i).sum()) for i, word in enumerate(REGIMES) if i}
    counts |= {
        flag: int((results.rolling & results.flagged(flag)).sum())
        for flag in results.flags
        if flag in OUTSIDE
    }
    if results.allowed is not None:
        counts["constraints"] = int((results.inside & ~results.allowed).sum())
    counts |= {
        name: int((results.valid & rows).sum())
        for name, rows in results.limits_in("exceeded").items()
    }
    counts["no value of a goal"] = int((results.holds & ~known).sum())
    return {word: n for word, n in counts.items() if n}


def recommended(best: Judged) -> int:
    """Return the candidate of a front that is nearest to the best of all goals, each normalised
    over the front.

    Only the candidates that miss least count. Lives count by their logarithm, because they span
    decades. Of equal candidates, the first goal decides, then the longer life.
    """
    costs = normalised(best.costs)
    # rounded, so that candidates that differ by rounding alone tie
    distance = np.round((costs**2).sum(axis=1), 9)
    order = np.lexsort((-best.life, costs[:, 0], distance, best.missed))  # the last key leads
    return int(order[0])


def best_in(best: Judged, goal: int) -> int:
    """Return the candidate of a front that is best in one goal; of equal ones the other goals
    decide, then the life.
    """
    others = np.delete(best.costs, goal, axis=1).T
    return int(np.lexsort((-best.life, *others, best.costs[:, goal], best.missed))[0])


def normalised(costs: np.ndarray) -> np.ndarray:
    """Return costs from 0 (best) to 1 (worst) by goal; goals that span a decade by their
    logarithm.
    """
    out = np.zeros(costs.shape)
    for j, values in enumerate(costs.T):
        finite = values[np.isfinite(values)]
        if not finite.size:
            continue
        size = np.abs(finite)
        sign = np.sign(finite[0])
        if (np.sign(finite) == sign).all() and size.max() > 10 * size.min() > 0:
            values, finite = (sign * np.log(np.abs(v)) for v in (values, finite))
        low, high = finite.min(), finite.max()
        out[:, j] = (np.clip(np.nan_to_num(values, nan=high), low, high) - low) / (
            high - low or 1.0
        )
    return out


def spread(costs: np.ndarray, count: int) -> np.ndarray:
    """Return the indices of at most `count` candidates along a front: the least crowded ones, its
    ends first.
    """
    left = np.arange(len(costs))
    while len(left) > count:
        left = np.delete(left, np.argmin(crowding(costs[left])))
    return left


def optimum_of(results: SolvedCases) -> dict[str, Any] | None:
    """Return what a search found, from the attribute of its results; None for another study."""
    text = results.data.attrs.get(OPTIMUM)
    if not isinstance(text, str):
        return None
    optimum: dict[str, Any] = json.loads(text)
    return optimum


def choices_of(results: SolvedCases, number: int) -> dict[str, Any]:
    """Return the choices of a candidate of a search by name."""
    design = results.design
    row = number * design.meta["inner_samples"]
    return {name: readable(design.columns[name][row : row + 1])[0] for name in design.meta["outer"]}


def goal_column(results: SolvedCases, goal: str) -> Column:
    """Return the values (n,) of a goal by candidate, its units and its name in words."""
    kind, output = judged_by(goal)
    values = _values(results)[0][:, list(goals_of_search(results)).index(goal)]
    if kind == "probability":
        if output in REGIMES:
            return values, "1", f"probability of {REGIME_LABELS[REGIMES.index(output)]}"
        return values, "1", f"probability that the {results.quantity(output)[2]} meets its target"
    _, units, words = results.quantity(output)
    if output in results.design.meta["outer"] or results.design.meta["inner_samples"] == 1:
        return values, units, words
    named = {"worst": f"{words} at the worst condition", "b10": SAFE_B10.format(f"the {words}")}
    return values, units, named.get(kind, f"mean {words}")


def ends_of_goal(results: SolvedCases, goal: str) -> tuple[np.ndarray, np.ndarray] | None:
    """Return both ends of the range of a life that is a goal, shape (candidates,) each; None if it
    has no range.
    """
    kind, output = judged_by(goal)
    if not is_life(output) or kind == "probability" or f"{output}_low" not in results.data:
        return None
    shape = results.design.meta["design_points"], results.design.meta["inner_samples"]
    raw = results.quantity(output)[0].astype(float)
    valid = results.holds.reshape(shape)
    ends = []
    for end in ("_low", "_high"):
        own = flat(results.data, f"{output}{end}", results.dims).astype(float)
        lives = np.where(np.isnan(own), raw, own).reshape(shape)
        ends.append(
            _over_conditions(lives, valid & ~np.isnan(lives), kind, goals_of_search(results)[goal])
        )
    return ends[0], ends[1]


def beyond_data(results: SolvedCases, goal: str) -> np.ndarray:
    """Return for which candidates a life that is a goal rests on a life beyond the S-N data, shape
    (n,).
    """
    kind, output = judged_by(goal)
    shape = results.design.meta["design_points"], results.design.meta["inner_samples"]
    if not is_life(output) or kind == "probability":
        return np.zeros(shape[0], dtype=bool)
    lives = results.quantity(output)[0].astype(float).reshape(shape)
    counted = results.holds.reshape(shape) & (
        (kind == "mean") | (lives <= goal_column(results, goal)[0][:, None])
    )
    return np.asarray((counted & beyond_sn_data(results, output).reshape(shape)).any(axis=1))
