"""The answer of a search: the best candidate, or the corners and the knee of a front."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from trackroller.damage import LIMITS, limit_word
from trackroller.errors import InputError, listing
from trackroller.methods.optimise import nondominated_ranks
from trackroller.parameters import BODIES, REGIMES
from trackroller.parameters.carriage_fields import long_name_of, parameter_of
from trackroller.results.answer import Answer, Caution, Column, Required, yes_or_blank
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.comparison import wilson
from trackroller.results.life_columns import OF_PAIR, lacks_a_body
from trackroller.results.requirement import required_of
from trackroller.results.search_fitness import (
    Judged,
    Shares,
    beyond_data,
    choices_of,
    ends_of_goal,
    goal_column,
    judge,
    judges_of,
    life_of_search,
    optimum_of,
    required,
    shares_of,
    shortfall,
)
from trackroller.results.solved_cases import SAME_ENDS, SolvedCases
from trackroller.results.study_facts import (
    case_cautions,
    checks_left_out,
    facts_of,
    given_for_nothing,
    not_given_words,
)
from trackroller.results.turning_values import value_behind
from trackroller.roller.output_names import is_life
from trackroller.study.design.levels import in_words
from trackroller.study.file.search import judged_by
from trackroller.study.outputs import flat

AT_END = 1e-3  # of the range of a choice, within which a value stands at its end
REASONS = {  # why a candidate does not hold, as what binds another one
    "skids": "skidding",
    "lifts off": "lift-off",
    "breaks": "the tensile strength",
    "yields": "yielding",
    "misses a constraint": "a constraint",
}
GOAL = "goal_{}"  # column of a goal by its number; `_low` and `_high` are the ends of its range
REFERENCE = "goal_{}_reference"
REQUIRED = "required_{}"  # column of the output of a requirement by its number


@dataclass(frozen=True)
class _Outcome:
    """A search with its candidates.

    Attributes
    ----------
    results : the solved search
    search : what it found, see `optimum_of`
    """

    results: SolvedCases
    search: Mapping[str, Any]

    @cached_property
    def judged(self) -> Judged:
        """Return all gathered candidates."""
        return judge(self.results)

    @cached_property
    def ranges(self) -> CaseRanges:
        """Return the output of every case that says why a case does not hold: the life, otherwise
        the first goal.
        """
        life = life_of_search(self.results)
        if life is not None:
            return life
        goal, way = next(iter(self.goals.items()))
        output = judged_by(goal)[1]
        if output in REGIMES:
            return CaseRanges(self.results, ("converged", "converged", "1"), True)
        _, units, words = self.results.quantity(output)
        return CaseRanges(self.results, (output, words, units), way == "max")

    @cached_property
    def shares(self) -> list[Shares]:
        """Return the share of the conditions in which each candidate meets each requirement."""
        return shares_of(self.results)

    @cached_property
    def judges(self) -> list[tuple[Required, CaseRanges]]:
        """Return each requirement with the output that judges it."""
        return judges_of(self.results)

    @cached_property
    def goals(self) -> dict[str, str]:
        """Return the goals with `max` or `min`."""
        return dict(self.search["goals"])

    @property
    def is_required(self) -> bool:
        """Return whether the candidates have to meet a requirement."""
        return required(self.results)

    @cached_property
    def states(self) -> np.ndarray:
        """Return whether each candidate meets the requirement, shape (candidates,): `met`, `open`,
        `missed`, or `none`.

        Optima are judged by their solution at `reference`. `none` stands where a candidate does not
        hold in enough conditions to be compared.
        """
        short = shortfall(self.results)
        for number, one in self.optima.items():
            short[number] = one["short"][1]
        states = np.where(short == 0, "met", np.where(short < 2, "open", "missed")).astype(object)
        return np.where(self.judged.violation > 0, "none", states)

    def rows(self, candidate: int) -> slice:
        """Return the cases of a candidate."""
        many = int(self.results.design.meta["inner_samples"])
        return slice(candidate * many, (candidate + 1) * many)

    @cached_property
    def front(self) -> np.ndarray:
        """Return the candidates that no other one beats, shape (candidates,) bool."""
        best = self.judged
        return np.asarray(
            (nondominated_ranks(best.costs, best.missed) == 0) & (best.missed == best.missed.min())
        )

    @cached_property
    def optima(self) -> dict[int, Mapping[str, Any]]:
        """Return the optima that were solved at `reference`, by the number of the candidate."""
        return {int(one["design"]): one for one in self.search["optima"]}

    @cached_property
    def corners(self) -> dict[int, bool]:
        """Return the best candidate in each of several goals, and whether no step improves it, by
        its number.
        """
        outcome: dict[int, bool] = {}
        for one in self.search.get("corners", ()):
            outcome[int(one["design"])] = outcome.get(int(one["design"]), True) and bool(
                one["solved"]
            )
        return outcome

    @property
    def chosen(self) -> int:
        """Return the recommended candidate."""
        return int(self.search["recommended"])

    @property
    def usable(self) -> bool:
        """Return whether a candidate holds in some condition."""
        return bool(self.search["optima"])

    @cached_property
    def named(self) -> list[int]:
        """Return the candidates of the headline: the recommended one, or both corners and the knee
        in their order.
        """
        if not self.usable:
            return []
        if len(self.goals) == 1 or self.is_required:
            return [self.chosen]
        corners = list(self.corners)
        return list(dict.fromkeys([*corners[:1], self.chosen, *corners[1:]]))

    @cached_property
    def shown(self) -> list[int]:
        """Return the candidates of the table: those of the headline, the corners, then the others
        along the first goal.
        """
        others = [number for number in self.optima if number not in (*self.named, *self.corners)]
        order = sorted(
            others, key=lambda number: tuple(np.nan_to_num(self.judged.costs[number], nan=np.inf))
        )
        if self.usable:
            return list(dict.fromkeys([*self.named, *self.corners, *order]))
        return []


def answer_of_search(results: SolvedCases) -> Answer:
    """Return the answer of a search.

    Parameters
    ----------
    results : SolvedCases
        A solved study with `method: optimise`.

    Returns
    -------
    Answer
        Its kind is `one` (one goal), `front` (several goals, no requirement: corners and knee),
        `front_required` (the best that meets the requirement), `solve_finer` (only the error of the
        solution leaves the requirement open), `open` (a range leaves it open), or `none`: no
        candidate holds, or none meets the requirement. The headline holds `designs` (name, goals,
        `at`, `stopped`), `binds`, `accuracy`, `extrapolated`, `second` and `exceeded`. Where no
        candidate is known to meet the requirement, `nearest` stands in place of `designs`; of
        `open`, `measure` is the value whose range leaves it open.

    Raises
    ------
    InputError
        If the study is no search, or its results hold no search.
    """
    search = optimum_of(results)
    if search is None:
        allowed = "results of a search, method: optimise"
        raise InputError(
            "study", results.study.name, allowed, "Run the search to its end.", "holds no search"
        )
    outcome = _Outcome(results, search)
    kind = _kind(outcome)
    first = next(iter(outcome.goals))
    _, units, words = goal_column(results, first)
    table, columns = _table(outcome)
    return Answer(
        question="best",
        kind=kind,
        headline=_headline(outcome, kind),
        output=(judged_by(first)[1], words, units),
        table=table,
        columns=columns,
        required=required_of(results),
        picture=_picture(outcome),
        not_checked=checks_left_out(results),
        not_used=given_for_nothing(results),
        not_given=not_given_words(results),
        warnings=_warnings(outcome),
        facts=_facts(outcome),
    )


def _kind(outcome: _Outcome) -> str:
    """Return the kind of the answer, see `answer_of_search`."""
    if not outcome.usable:
        return "none"
    state = outcome.states[outcome.chosen]
    if outcome.is_required and state == "open":
        exact = shortfall(outcome.results, exact=True)[outcome.chosen]
        if 1 <= exact < 2:
            return "open"
        return "solve_finer"
    if outcome.is_required and state != "met":
        return "none"
    if len(outcome.goals) == 1:
        return "one"
    if outcome.is_required:
        return "front_required"
    return "front"


def _headline(outcome: _Outcome, kind: str) -> dict[str, Any]:
    """Return the numbers and names of the headline."""
    head: dict[str, Any] = {"designs": []}
    if kind in ("one", "front", "front_required"):
        head["designs"] = [_candidate(outcome, number) for number in outcome.named]
    if not outcome.usable:
        return head
    chosen = outcome.chosen
    head |= {
        "accuracy": "reference",
        "extrapolated": bool(_beyond(outcome)[chosen]),
        "second": _second(outcome, chosen),
        "exceeded": _exceeded(outcome, chosen),
        "count": int(outcome.front.sum()),
    }
    if not head["designs"]:
        if kind == "open":
            head["measure"] = value_behind(
                outcome.results, outcome.judges, _numbers(outcome, chosen)
            )
        return head | {"nearest": _nearest(outcome, chosen)}
    if outcome.is_required and _is_drawn(outcome):
        own = _requirement(outcome, chosen)
        head |= {key: own[key] for key in ("share", "share_low", "share_high")}
        head |= {
            "wanted": max(one.least for one in outcome.shares),
            "n": outcome.results.design.meta["inner_samples"],
        }
    if kind != "front":
        binds = _binds(outcome, chosen)[:2]
        head["binds"] = ""
        if binds:
            head["binds"] = listing(binds)
    return head


def _candidate(outcome: _Outcome, number: int) -> dict[str, Any]:
    """Return a candidate of the headline: its choices and its goals at `reference`."""
    at = ""
    if len(outcome.named) > 1:
        at = "knee"
        if number in outcome.corners:
            at = "corner"
    goals = []
    for goal, value in zip(outcome.goals, outcome.optima[number]["reference"], strict=True):
        _, units, words = goal_column(outcome.results, goal)
        is_choice = judged_by(goal)[1] in outcome.results.design.meta["outer"]
        goals.append(
            {"words": words, "units": units, "value": float(value), "is_choice": is_choice}
        )
    required = []
    for (_, own), value in zip(outcome.judges, outcome.optima[number]["required"][1], strict=True):
        if own.output[0] not in {judged_by(goal)[1] for goal in outcome.goals} and not _is_drawn(
            outcome
        ):
            required.append({"words": own.output[1], "units": own.output[2], "value": float(value)})
    stopped = _is_stopped(outcome, number)
    name = {
        choice: _level(choice, value)
        for choice, value in choices_of(outcome.results, number).items()
    }
    return {"name": name, "at": at, "goals": goals, "required": required, "stopped": stopped}


def _nearest(outcome: _Outcome, number: int) -> dict[str, Any]:
    """Return the candidate that comes nearest to the requirement: its name, where it holds and
    meets, and its low end.
    """
    rows = outcome.rows(number)
    meets = min((own.sure[number] for own in outcome.shares), default=0.0)
    perhaps = min((own.may[number] for own in outcome.shares), default=0.0)
    of = rows.stop - rows.start
    worse = outcome.ranges.worse[rows]
    if outcome.ranges.rises:
        low = float(worse.min())
    else:
        low = float(worse.max())
    return {
        "name": _name(outcome, number),
        "holds": int(outcome.results.holds[rows].sum()),
        "judged": int(outcome.ranges.judged[rows].sum()),
        "meets": round(float(meets) * of),
        "perhaps": round(float(perhaps) * of),
        "of": of,
        "low": low,
        "verdict": str(outcome.states[number]),
    }


def _numbers(outcome: _Outcome, number: int) -> np.ndarray:
    """Return the numbers of the cases of a design, shape (k,)."""
    rows = outcome.rows(number)
    return np.arange(rows.start, rows.stop)


def _name(outcome: _Outcome, number: int) -> dict[str, Any]:
    """Return the choices of a candidate, those that have one value in all candidates left out."""
    own = choices_of(outcome.results, number)
    varied = [name for name in own if _varies(outcome, name)]
    return {name: _level(name, own[name]) for name in varied or own}


def _varies(outcome: _Outcome, name: str) -> bool:
    """Return whether a choice has several values among the candidates of the table."""
    texts = {str(choices_of(outcome.results, number)[name]) for number in outcome.shown}
    return len(texts) > 1 or len(outcome.shown) == 1


def _level(name: str, value: Any) -> Any:
    """Return a level as a number or as a text."""
    if isinstance(value, (bool, int, float, np.number)):
        return float(value)
    return in_words(name, value)


def _is_stopped(outcome: _Outcome, number: int) -> bool:
    """Return whether the search stopped before a corner, or before its only optimum."""
    if number in outcome.corners:
        return not outcome.corners[number]
    return (
        number == outcome.chosen
        and len(outcome.goals) == 1
        and not outcome.search.get("polished", False)
    )


def _table(outcome: _Outcome) -> tuple[pd.DataFrame, tuple[Column, ...]]:
    """Return one row a candidate that was solved at `reference`, with its columns."""
    table = pd.DataFrame([_row(outcome, number) for number in outcome.shown])
    columns = [*_choice_columns(outcome), *_goal_columns(outcome), *_required_columns(outcome)]
    if outcome.is_required:
        columns.append(Column("verdict", "Requirement", kind="state", meaning=_MEANINGS["verdict"]))
        if outcome.results.design.meta["inner_samples"] > 1:
            columns.append(
                Column("share", "Conditions that meet it", "1", _MEANINGS["share"], "share")
            )
        if _is_drawn(outcome):
            title = "95 % interval of the share"
            columns.append(
                Column("share_low", title, "1", _MEANINGS["share_low"], "share", "share_high")
            )
    columns += [
        Column("binds", "Bound by", kind="text", meaning=_MEANINGS["binds"]),
        Column("step", "A step changes the first goal to", "1", _MEANINGS["step"], "ratio"),
        Column("step_of", "Step", kind="text", meaning="the choice that is moved, and by how much"),
        Column("corner", "Corner", kind="text", meaning=_MEANINGS["corner"]),
        Column("second", "Second model", "h", _MEANINGS["second"]),
        Column(
            "second_verdict",
            "By the second model",
            kind="state",
            meaning="the requirement by the second model",
        ),
        Column("exceeded", "Largest use above 100 %", "1", _MEANINGS["exceeded"], "share"),
        Column(
            "extrapolated",
            "Extrapolated",
            kind="text",
            meaning="a life among the goals lies beyond its data",
        ),
    ]
    if table.empty:
        names = [name for column in columns for name in (column.name, column.until) if name]
        return pd.DataFrame(columns=names), tuple(columns)
    return table, tuple(column for column in columns if _is_known(table, column))


_MEANINGS = {
    "verdict": "met: enough conditions meet the requirement also with the told error; missed: "
    "they do not; open: between both",
    "share": "share of the conditions that meet the requirement with the told error",
    "share_low": "Wilson's 95 % interval of this share for the number of drawn conditions",
    "binds": "what a design with a better goal would miss, and the choices that stand at an end "
    "of their range",
    "step": "smallest ratio (of a goal to be large) or largest one (of a goal to be small) if one "
    "choice moves by its tolerance",
    "corner": "solved: neither an end of a range nor the smallest step improves the goal; "
    "stopped: the search stopped before",
    "second": "shortest life by a second model of an end that another limit has",
    "exceeded": "largest use of a limit other than fatigue over the conditions, if it is above "
    "100 %",
}


def _is_known(table: pd.DataFrame, column: Column) -> bool:
    """Return whether a column says something in some row."""
    values = table[column.name]
    return bool(column.role) or bool((values.notna() & (values.astype(str) != "")).any())


def _choice_columns(outcome: _Outcome) -> list[Column]:
    """Return a column for each choice."""
    columns = []
    for name in outcome.results.design.meta["outer"]:
        known = parameter_of(name)
        units = ""
        if known:
            units = known.units
        role = ""
        if _varies(outcome, name):
            role = "name"
        columns.append(
            Column(name, long_name_of(name), units, "choice of the designer", "level", role=role)
        )
    return columns


def _goal_columns(outcome: _Outcome) -> list[Column]:
    """Return the columns of each goal: its value, the range of a life, and its value at
    `reference`.
    """
    columns = []
    for number, (goal, way) in enumerate(outcome.goals.items(), 1):
        if judged_by(goal)[1] in outcome.results.design.meta["outer"]:
            continue  # its value stands in the column of the choice
        _, units, words = goal_column(outcome.results, goal)
        better = "smaller is better"
        if way == "max":
            better = "larger is better"
        name = GOAL.format(number)
        columns.append(Column(name, words, units, f"{words}; {better}"))
        columns.append(
            Column(
                f"{name}_low", f"{words}, range", units, "with placeholders", until=f"{name}_high"
            )
        )
        columns.append(
            Column(
                REFERENCE.format(number), f"{words} at reference", units, "the same at `reference`"
            )
        )
    return columns


def _required_columns(outcome: _Outcome) -> list[Column]:
    """Return a column for the output of each requirement at `reference`."""
    columns = []
    for place, (_, own) in enumerate(outcome.judges, 1):
        _, words, units = own.output
        meaning = f"{words} at the worst condition, at `reference`; of a range its worse end"
        columns.append(Column(REQUIRED.format(place), words, units, meaning))
    return columns


def _row(outcome: _Outcome, number: int) -> dict[str, Any]:
    """Return the row of a design."""
    row: dict[str, Any] = {"design": number}
    row |= {
        name: _level(name, value) for name, value in choices_of(outcome.results, number).items()
    }
    reference = outcome.optima[number]["reference"]
    for place, (goal, value) in enumerate(zip(outcome.goals, reference, strict=True), 1):
        name = GOAL.format(place)
        row[name] = float(outcome.judged.values[number, place - 1])
        row |= dict(
            zip((f"{name}_low", f"{name}_high"), _range(outcome, goal, number), strict=True)
        )
        row[REFERENCE.format(place)] = float(value)
    for place, value in enumerate(outcome.optima[number]["required"][1], 1):
        row[REQUIRED.format(place)] = float(value)
    if outcome.is_required:
        row |= _requirement(outcome, number)
    if number == outcome.chosen:
        row |= _step(outcome)
    else:
        row |= {"step": np.nan, "step_of": ""}
    row["binds"] = ""
    if number in (*outcome.named, *outcome.corners):
        row["binds"] = ", ".join(_binds(outcome, number))
    row["corner"] = _corner(outcome, number)
    second = _second_life(outcome, number)
    if second is None:
        row["second"] = np.nan
        row["second_verdict"] = ""
    else:
        row["second"] = second[1]
        row["second_verdict"] = second[2]
    over = _exceeded(outcome, number)
    if over is None:
        row["exceeded"] = np.nan
    else:
        row["exceeded"] = over["use"]
    row["extrapolated"] = yes_or_blank(_beyond(outcome)[number])
    return row


def _range(outcome: _Outcome, goal: str, number: int) -> tuple[float, float]:
    """Return both ends of a life that is a goal; NaN where it has no range."""
    ends = ends_of_goal(outcome.results, goal)
    if ends is None or not ends[1][number] > ends[0][number] * (1.0 + SAME_ENDS):
        return np.nan, np.nan
    return float(ends[0][number]), float(ends[1][number])


def _corner(outcome: _Outcome, number: int) -> str:
    """Return whether a candidate that ends the front, or the optimum of one goal, is solved."""
    if number not in outcome.corners:
        return ""
    if _is_stopped(outcome, number):
        return "stopped"
    return "solved"


def _requirement(outcome: _Outcome, number: int) -> dict[str, Any]:
    """Return whether a candidate meets the requirement, and in which share of the conditions."""
    share = float(outcome.optima[number]["share"][1])
    low, high = (np.nan, np.nan)
    if _is_drawn(outcome):
        count = np.array([outcome.results.design.meta["inner_samples"]])
        low, high = (float(end[0]) for end in wilson(share * count, count))
    return {
        "verdict": str(outcome.states[number]),
        "share": share,
        "share_low": low,
        "share_high": high,
    }


def _is_drawn(outcome: _Outcome) -> bool:
    """Return whether the conditions are drawn, so that a share has an interval."""
    design = outcome.results.design
    inner = design.meta["inner"]
    return bool(inner) and not any(design.factors[name].discrete for name in inner)


def _step(outcome: _Outcome) -> dict[str, Any]:
    """Return to which part or multiple a tolerance takes the first goal of the recommended
    candidate.
    """
    way = next(iter(outcome.goals.values()))
    own = float(outcome.judged.values[outcome.chosen, 0])
    worst = np.nan
    step = ""
    for one in outcome.search["neighbours"]:
        ratio = np.nan
        if own:
            ratio = float(one["values"][0]) / own
        is_worse = ratio > worst
        if way == "max":
            is_worse = ratio < worst
        if np.isnan(worst) or is_worse:
            worst = ratio
            step = f"{long_name_of(one['choice'])} {one['step']}"
    return {"step": worst, "step_of": step}


def _binds(outcome: _Outcome, number: int) -> list[str]:
    """Return what binds a candidate: what the nearest candidate with a better goal misses, then
    ends of ranges.

    A goal in which a candidate that misses no more is better is bound by the other goals.
    """
    judged = outcome.judged
    words = []
    for costs in judged.costs.T:
        better = costs < costs[number]
        misses = judged.missed > judged.missed[number]
        if (better & ~misses).any() or not better.any():
            continue
        rows = np.flatnonzero(better)
        away = np.abs(judged.genes[rows] - judged.genes[number]).sum(axis=1)
        words.append(_missed(outcome, int(rows[np.argmin(away)])))
    return [*dict.fromkeys(word for word in words if word), *_at_ends(outcome, number)]


def _missed(outcome: _Outcome, number: int) -> str:
    """Return what a candidate misses, in words that follow "bound by"."""
    if outcome.judged.violation[number] == 0:
        lacking = [own for own in outcome.shares if not own.enough(own.sure)[number]]
        if lacking:
            return f"the required {lacking[0].required.words}"
        return ""
    causes = Counter(str(word) for word in outcome.ranges.reason[outcome.rows(number)] if word)
    if not causes:
        return ""
    cause = causes.most_common(1)[0][0]
    return REASONS.get(cause, limit_word(cause.removeprefix("limit ")))


def _at_ends(outcome: _Outcome, number: int) -> list[str]:
    """Return the choices of a candidate that stand at an end of their range in the search."""
    words = []
    for name, value in choices_of(outcome.results, number).items():
        factor = outcome.results.study.parsed[name]
        tried = factor.numbers
        if factor.discrete:
            tried = ()
            if factor.ordered and factor.numeric and len(factor.levels) > 2:
                tried = factor.levels
        if not tried:
            continue
        low, high = min(map(float, tried)), max(map(float, tried))
        for end, word in ((low, "smallest"), (high, "largest")):
            if high > low and abs(float(value) - end) <= AT_END * (high - low):
                words.append(f"the {word} {long_name_of(name)}")
    return words


def _beyond(outcome: _Outcome) -> np.ndarray:
    """Return the candidates with a goal that is a life beyond its data, shape (candidates,)."""
    lives = [goal for goal in outcome.goals if is_life(judged_by(goal)[1])]
    none = np.zeros(len(outcome.judged.values), dtype=bool)
    return np.asarray(
        np.any([none, *(beyond_data(outcome.results, goal) for goal in lives)], axis=0)
    )


def _required_life(outcome: _Outcome) -> tuple[float, float]:
    """Return the required life of the pair and the share of the conditions that has to reach it;
    NaN without one.
    """
    lives = [
        own for own in outcome.shares if own.required.output in OF_PAIR and own.required.least > 0
    ]
    if not lives:
        return np.nan, np.nan
    longest = max(lives, key=lambda own: own.required.least)
    return longest.required.least, longest.least


def _second_life(outcome: _Outcome, number: int) -> tuple[str, float, str] | None:
    """Return the second model with the shortest life of a candidate, this life [h], and its state
    by the requirement.

    None where no second model knows its life in every condition that is judged.
    """
    data = outcome.results.data
    rows = outcome.rows(number)
    if "life_hours_by_limit" not in data:
        return None
    hours = flat(data, "life_hours_by_limit", outcome.results.dims)[rows]
    valid = outcome.results.valid[rows]
    least, share = _required_life(outcome)
    shortest: tuple[str, float, str] | None = None
    limits = data["limit"].values.tolist()
    for place, limit in enumerate(limits):
        if (
            limit not in LIMITS
            or not LIMITS[limit].rivals
            or lacks_a_body(hours[valid], limits, limit).any()
        ):
            continue
        own = np.fmin.reduce(hours[valid, place], axis=1)
        if not own.size or np.isnan(own).any():
            continue
        verdict = ""
        if not np.isnan(least):
            verdict = "missed"
            if (own >= least).sum() / len(valid) >= share - 1e-9:
                verdict = "met"
        if shortest is None or own.min() < shortest[1]:
            shortest = limit, float(own.min()), verdict
    return shortest


def _second(outcome: _Outcome, number: int) -> dict[str, str] | None:
    """Return the second model that turns the state of a candidate; None if none does."""
    second = _second_life(outcome, number)
    if second is None or second[2] in ("", outcome.states[number]):
        return None
    return {"limit": second[0], "verdict": second[2]}


def _exceeded(outcome: _Outcome, number: int) -> dict[str, Any] | None:
    """Return the limit of a candidate that is exceeded most, second models included; None if all
    are kept.

    A use of the S-N curve above 1 is a finite life, and no excess.
    """
    data = outcome.results.data
    rows = outcome.rows(number)
    if "utilisation" not in data:
        return None
    use = flat(data, "utilisation", outcome.results.dims)[rows]
    hours = flat(data, "life_hours_by_limit", outcome.results.dims)[rows]
    limits = data["limit"].values.tolist()
    counted = np.array([limit != "fatigue" for limit in limits])
    known = np.where(counted[:, None] & outcome.results.valid[rows][:, None, None], use, np.nan)
    if not (known > 1.0).any():
        return None
    case, limit, body = np.unravel_index(np.nanargmax(known), known.shape)
    after = float(hours[case, limit, body])
    return {
        "limit": limit_word(limits[limit]),
        "body": BODIES[body],
        "use": float(known[case, limit, body]),
        "hours": after,
    }


def _picture(outcome: _Outcome) -> dict[str, Any]:
    """Return the candidates of the picture: their goals, those of the front, and those of the
    headline.

    Of one goal `history` holds the best value that was known after each candidate, among those that
    miss least.
    """
    judged = outcome.judged
    names = list(outcome.goals)
    picture: dict[str, Any] = {
        "goals": judged.values,
        "front": outcome.front,
        "met": judged.missed == 0,
        "named": np.array(outcome.named, dtype=int),
        "words": [goal_column(outcome.results, goal)[2] for goal in names],
        "units": [goal_column(outcome.results, goal)[1] for goal in names],
        "ways": list(outcome.goals.values()),
    }
    if len(names) == 1:
        costs = np.where(judged.missed == 0, judged.costs[:, 0], np.inf)
        best = np.minimum.accumulate(np.where(np.isnan(costs), np.inf, costs))
        sign = 1.0
        if outcome.goals[names[0]] == "max":
            sign = -1.0
        picture["history"] = np.where(np.isfinite(best), sign * best, np.nan)
    return picture


def _warnings(outcome: _Outcome) -> tuple[Caution, ...]:
    """Return the warnings of a search."""
    results = outcome.results
    if not outcome.usable:
        texts = ", ".join(
            f"{word.replace('_', ' ')} {n:,}" for word, n in outcome.search["reasons"].items()
        )
        tried = int(outcome.search["designs"])
        return (Caution("not_held", tried, tried, texts, "candidates"),)
    rows = np.zeros(len(results.table), dtype=bool)
    rows[outcome.rows(outcome.chosen)] = True
    warnings = case_cautions(results, outcome.ranges, rows)
    # of the candidates of the table, below
    warnings = [one for one in warnings if one.code != "extrapolated"]
    shown = np.array(outcome.shown)
    beyond = int(_beyond(outcome)[shown].sum())
    if beyond:
        warnings.append(
            Caution("extrapolated", beyond, len(shown), "designs of the table", "candidates")
        )
    turned = [number for number in outcome.shown if _second(outcome, number) is not None]
    if turned:
        limits = sorted({str(_second_life(outcome, number)[0]) for number in turned})  # type: ignore[index]
        warnings.append(
            Caution("second_model", len(turned), len(shown), listing(limits), "candidates")
        )
    stopped = [number for number in outcome.named if _is_stopped(outcome, number)]
    ends = _at_ends(outcome, outcome.chosen)
    if stopped or ends:
        where = ends
        if stopped:
            where = ["the search stopped before it", *ends]
        warnings.append(
            Caution("at_end", len(stopped) or 1, len(outcome.named), listing(where), "candidates")
        )
    return tuple(warnings)


def _facts(outcome: _Outcome) -> dict[str, Any]:
    """Return what the title line says, and how the search went."""
    results = outcome.results
    search = outcome.search
    conditions = int(results.design.meta["inner_samples"])
    return facts_of(results) | {
        "candidates": int(results.design.meta["design_points"]),
        "conditions": [conditions, conditions],
        "drawn": _is_drawn(outcome),
        "searched": int(search["designs"]),
        "searched_with": str(search["model"]),
        "stopped": str(search["stopped"]),
        "alike": _are_alike(outcome.judged.values[outcome.front]),
    }


def _are_alike(values: np.ndarray) -> Sequence[bool]:
    """Return which goals have one value over the front, shape (goals,)."""
    return [len(np.unique(column[~np.isnan(column)])) <= 1 for column in values.T]
