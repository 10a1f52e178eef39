"""Sentences and a table on the result of a search for the best designs."""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.methods.b10 import b10
from trackroller.methods.optimise import nondominated_ranks
from trackroller.methods.probability import bounds
from trackroller.parameters.of_carriage import parameter_of
from trackroller.report.numbers import (
    BEYOND,
    Life,
    capital,
    lasting,
    long_name,
    part_of,
    percent,
    quantity,
    rounded,
    setting,
    with_unit,
)
from trackroller.report.tables.table import Table, factor_cell, heading
from trackroller.report.words.designs import (
    BEST,
    LARGE_ERROR,
    compared,
    ended_by,
    ends_text,
    life_error_of,
    within_words,
)
from trackroller.report.words.pareto import holes_words
from trackroller.report.words.sentence import Sentence, say
from trackroller.report.words.verdict import (
    bearing_words,
    targets_in_words,
    turn_words,
    unchecked_words,
    vain_in_base,
    what_words,
)
from trackroller.results.candidates import Candidates
from trackroller.results.intervals import Cases
from trackroller.results.judging import (
    Judged,
    beyond_data,
    choices_of,
    ends_of_goal,
    goal_column,
    goals_of_search,
    judge,
    optimum_of,
    recommended,
    required,
    shortfall,
)
from trackroller.results.results import SAME_ENDS as SAME
from trackroller.results.results import Results
from trackroller.results.verdict import Turn, not_checked, open_values
from trackroller.roller.limit_notes import guessed_lines
from trackroller.roller.output_names import is_life
from trackroller.study.file.goals import names_in
from trackroller.study.file.search import judged_by

WORST = " at the worst condition"  # end of the words of a goal
AT_END = 1e-3  # of the range of a choice, within which a value stands at its end


def optimum_sentences(results: Results) -> list[Sentence]:
    """Say which design a search recommends, whether it meets the target, and what was not checked.

    Returns
    -------
    The sentences; none for a study that is no search.
    """
    search = optimum_of(results)
    if search is None:
        return []
    judged, least = judge(results), least_violation(search)
    best = _best(search, judged)
    said = [_invalid(results, search, least) if least else None]
    if best is not None:
        said += [
            _recommended(results, search, best, judged),
            *_turns(results, search, best, judged),
            _unreached(results, search),
        ]
        said.append(_checked(results, search, large=True))
        chosen = all(one is None or one.kind != "requirement" for one in said)
        said.append(_guessed(results, search, best) if chosen else None)
        said.append(bearing_words(results, _limits(results, search, best)))
    said.append(_unchecked(results))
    return [sentence for sentence in said if sentence is not None]


def searched(results: Results) -> list[Sentence]:
    """Say how a search went, and how much its optima change at `reference`; nothing for another study."""
    search = optimum_of(results)
    if search is None:
        return []
    how = say("optimum", "searched", **{name: search[name] for name in ("designs", "model", "stopped")})
    checked = _checked(results, search, large=False) if search["optima"] and least_violation(search) < 1 else None
    return [*filter(None, [checked, _life_error(results, _best(search, judge(results)))]), how]


def _life_error(results: Results, best: dict[str, Any] | None) -> Sentence | None:
    """State the largest error by the solution of the lives of a design, where it exceeds `LARGE_ERROR`.

    None where a life is a goal: its error was found at `reference`.
    """
    if best is None or results.life is None or any(is_life(judged_by(goal)[1]) for goal in goals_of_search(results)):
        return None
    cases, many = Cases(Candidates.grouped(results, results.life)), results.design.meta["inner_samples"]
    own = np.arange(len(cases.error)) // many == best["design"]
    return life_error_of(cases, own, design_words(results, best["design"]))


def _best(search: dict[str, Any], judged: Judged) -> dict[str, Any] | None:
    """Return the recommended optimum: of those that are nearest to the target of the study as it is now."""
    if least_violation(search) == 1:
        return None
    designs = [one["design"] for one in search["optima"]]
    short = dict(zip(designs, judged.short[designs], strict=True))
    own = search["recommended"]
    if short[own] > min(short.values()):
        own = designs[recommended(judged.take(np.array(designs)))]
    return next(one for one in search["optima"] if one["design"] == own)


def least_violation(search: dict[str, Any]) -> float:
    """Return the share of the conditions in which the best design is not valid [1]; 0 if a design is always valid."""
    return float(min((one["violation"][0] for one in search["optima"]), default=1.0))


def design_words(results: Results, number: int) -> str:
    """Name a design of a search by its choices."""
    return ", ".join(setting(name, value) for name, value in choices_of(results, number).items())


def goal_values(results: Results, search: dict[str, Any], one: dict[str, Any], interval: bool = True) -> list[str]:
    """Write the goals of an optimum with their units; a life has its range and says whether S-N data end before it."""
    texts = []
    for goal, value in zip(search["goals"], one["values"], strict=True):
        units = goal_column(results, goal)[1]
        design, ends = one["design"], ends_of_goal(results, goal)
        beyond = bool(beyond_data(results, goal)[design])
        text = lasting(value, units, beyond) if units == "h" else quantity(value, units)
        text = percent(value) if judged_by(goal)[0] == "probability" else text
        if ends is not None and ends[1][design] > ends[0][design] * (1 + SAME):
            text = ends_text(float(ends[0][design]), float(ends[1][design]), BEYOND * beyond, units)
        else:
            text += _interval(results, goal, design) if interval else ""
        texts.append(text)
    return texts


def _interval(results: Results, goal: str, number: int) -> str:
    """Write the 95 % interval of a B10 or a probability over conditions that are all drawn; '' for other goals."""
    kind, output = judged_by(goal)
    inner, many = results.design.meta["inner"], results.design.meta["inner_samples"]
    if kind not in ("b10", "probability") or any(results.design.factors[name].discrete for name in inner):
        return ""
    rows = slice(number * many, (number + 1) * many)
    if kind == "probability":
        ends = [percent(float(end)) for end in bounds(goal_column(results, goal)[0][number], many)]
        return f" (95 % interval {' to '.join(ends)})"
    _, low, high = b10(np.where(results.held, np.nan_to_num(results.quantity(output)[0].astype(float)), 0.0)[rows])
    return f" (95 % interval {rounded(low)} to {rounded(high)})"


def _recommended(results: Results, search: dict[str, Any], best: dict[str, Any], judged: Judged) -> Sentence:
    words = [goal_column(results, goal)[2] for goal in search["goals"]]
    told = goal_values(results, search, best)
    found = results.pareto()  # counts a design that was solved twice once
    assert found is not None  # a search has goals
    values: dict[str, Any] = {"design": design_words(results, best["design"]), "front": int(found["optimal"].sum())}
    kept = found["optimal"].values == 1
    alike = all(len(np.unique(found[goal].values[kept])) == 1 for goal in search["goals"])
    least = least_violation(search)
    edges = [long_name(name) for name in _edges(results, best["design"])]
    several = len(search["goals"]) > 1 and values["front"] > 1 and not alike
    named = set[str]().union(*(names_in(str(one)) for one in results.config.constraints))
    bounded = any(judged_by(goal)[1] in named for goal in search["goals"])  # a constraint is a requirement, too
    if several and not least and not (required(results) or bounded):  # the goals alone do not choose
        ends = [goal_values(results, search, one, interval=False) for one in _ends(search)]
        worst = all(text.endswith(WORST) for text in words)
        words = [text.removesuffix(WORST) for text in words] if worst else words
        values |= {
            "worst": worst,
            "holes": holes_words(found, named=False),
            "edges": edges,
            "tried": int(found.attrs["rows"]),
        }
        return say("optimum", "requirement", ends=ends, words=words, goals=told, **values)
    values |= {"least": least, "constraints": [str(one) for one in results.config.constraints]}
    values["edges"] = edges
    values["goals"] = [" ".join(pair) for pair in zip(words, told, strict=True)]
    front = nondominated_ranks(judged.costs, judged.missed) == 0
    values |= {"alike": alike, "target": targets_in_words(results) if required(results) else ""}
    values["short"] = float(judged.short[best["design"]])
    values["what"] = [what_words(turn) for turn in _open_values(results, search, best)]
    values["others"] = int((judged.short == 0).sum()) if values["short"] else 0
    values |= {"meeting": int((front & (judged.short == 0)).sum()), "designs": len(front)}
    values["life"] = _life(results, search, best)
    values |= {"conditions": results.design.meta["inner_samples"], "limits": _limits(results, search, best)}
    return say("optimum", "recommended", **values)


def _open_values(results: Results, search: dict[str, Any], best: dict[str, Any]) -> tuple[Turn, ...]:
    """Return what to measure where no design surely meets the target, and the range of the nearest one leaves it open.

    Nothing where the error of its solution does.
    """
    if results.life is None or not 1 <= shortfall(results, exact=True)[best["design"]] < 2:
        return ()
    cases = Cases(Candidates.grouped(results, results.life))
    row = best["design"] * results.design.meta["inner_samples"]
    return open_values(cases, int(cases.candidates.place[row]))


def _turns(results: Results, search: dict[str, Any], best: dict[str, Any], judged: Judged) -> list[Sentence | None]:
    """Say at which values the target is met or missed."""
    if int(judged.short.min()) != 1:  # a design meets it, or all miss it
        return []
    return [turn_words(turn, targets_in_words(results)) for turn in _open_values(results, search, best)]


def _first_life(results: Results, search: dict[str, Any], best: dict[str, Any]) -> tuple[Cases, int, int] | None:
    """Return the cases of a search, and those on which both ends of the life of a design rest; None without one.

    It is the case of the life that is a goal, otherwise those with the smallest low end and the smallest high end.
    """
    if results.life is None:
        return None
    many, column = results.design.meta["inner_samples"], results.life[0]
    own = slice(best["design"] * many, (best["design"] + 1) * many)
    cases, held = Cases(Candidates.grouped(results, results.life)), results.held[own]
    lives = [np.where(held, end[own], np.inf) for end in cases.ends]
    for goal, value in zip(search["goals"], best["values"], strict=True):
        kind, output = judged_by(goal)
        if output == column and kind in ("worst", "b10") and value > 0:
            lives = 2 * [np.abs(np.where(held, results.column(column)[own], np.inf) - value)]
    low, high = (own.start + int(np.argmin(end)) for end in lives)
    return (cases, low, high) if held.any() else None


def _life(results: Results, search: dict[str, Any], best: dict[str, Any]) -> str:
    """Write the shortest life of a design in hours; '' where a life is a goal, which is told, or there is none."""
    found, goal = _first_life(results, search, best), results.life
    if found is None or goal is None or goal[2] != "h" or any(is_life(judged_by(one)[1]) for one in search["goals"]):
        return ""
    cases, low, high = found
    beyond = BEYOND * bool(cases.beyond[low] or cases.beyond_at_high[high])
    return ends_text(float(cases.ends[0][low]), float(cases.ends[1][high]), beyond, "h")


def _limits(results: Results, search: dict[str, Any], best: dict[str, Any]) -> list[str]:
    """Name what ends the life of a design: two limits if its range decides which."""
    found = _first_life(results, search, best)
    if found is None:
        return []
    cases, low, high = found
    return list(dict.fromkeys(ended_by(str(name)) for name in (cases.low_end[0][low], cases.high_end[high]) if name))


def _guessed(results: Results, search: dict[str, Any], best: dict[str, Any]) -> Sentence | None:
    """Say that fatigue ends the recommended design by an S-N line that rests on guesses."""
    found = _first_life(results, search, best)
    if found is None or "fatigue" not in (found[0].low_end[0][found[1]], found[0].high_end[found[2]]):
        return None
    cases, case, _ = found
    material = str(results.material("guide" if cases.low_end[1][case] else "roller")[case])
    return say("verdict", "guessed", material=material) if material in guessed_lines(results.data) else None


def _ends(search: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the optima that are best in the first and in the last goal."""
    signs = [-1.0 if direction == "max" else 1.0 for direction in search["goals"].values()]
    return [min(search["optima"], key=lambda one: signs[i] * one["values"][i]) for i in (0, len(signs) - 1)]


def _edges(results: Results, number: int) -> list[str]:
    """Return the choices of a design that stand at an end of the range that the search may take."""
    found = []
    for name, value in choices_of(results, number).items():
        factor = results.design.factors[name]
        tried = list(factor.levels if factor.discrete and factor.ordered and len(factor.levels) > 2 else factor.numbers)
        ends = (min(map(float, tried)), max(map(float, tried))) if tried else (0.0, 0.0)
        width = ends[1] - ends[0]
        if width and min(abs(float(value) - end) for end in ends) <= AT_END * width:
            found.append(name)
    return found


def _unchecked(results: Results) -> Sentence | None:
    """Name the limits that a search with lives did not check."""
    if results.life is None:
        return None
    left_out = not_checked(results)
    names, vain = unchecked_words(results, left_out), vain_in_base(results, left_out)
    return say("verdict", "not_checked", names=names, vain=vain) if names else None


def _invalid(results: Results, search: dict[str, Any], least: float) -> Sentence:
    """Say that no design is valid in all conditions, and why."""
    reasons = sorted(search["reasons"].items(), key=lambda pair: -pair[1])
    conditions = results.design.meta["inner_samples"]
    return say("optimum", "invalid", least=least, conditions=conditions, reasons=reasons)


def _unreached(results: Results, search: dict[str, Any]) -> Sentence | None:
    """Name the probabilities and lives that no design brings above 0, and goals without a value."""
    low = []
    for goal in (goal for goal, way in search["goals"].items() if way == "max"):
        values, _, words = goal_column(results, goal)
        rises = is_life(goal) or judged_by(goal)[0] == "probability"  # other goals may be negative
        if np.isnan(values).all() or (rises and not np.nanmax(values) > 0):
            low.append(words)
    return say("optimum", "unreached", goals=low) if low else None


def _checked(results: Results, search: dict[str, Any], large: bool) -> Sentence | None:
    """Say how much goals that are results change at `reference`; None where all goals are choices.

    A `large` change, above `LARGE_ERROR`, stands in the verdict, and a smaller one in the proof.
    """
    optima = search["optima"]
    solved = [i for i, goal in enumerate(search["goals"]) if goal not in results.design.meta["outer"]]
    if not solved:
        return None
    change = max(abs(_changes(one["values"], one["reference"])[i]) for one in optima for i in solved)
    if (change > LARGE_ERROR) != large:
        return None
    worse = sum(one["violation"][1] > one["violation"][0] for one in optima)
    return say("optimum", "checked", change=change, worse=worse, several=len(solved) > 1)


def _changes(before: list[float], after: list[float]) -> list[float]:
    """Return the relative changes of goals; 0 for a goal that was 0, and for unlimited goals."""
    return [b / a - 1 if a and np.isfinite([a, b]).all() else 0.0 for a, b in zip(before, after, strict=True)]


def optima_table(results: Results) -> Table | None:
    """Compare the recommended design and further optima, as columns: choices, goals, goals at reference."""
    search = optimum_of(results)
    if search is None or least_violation(search) == 1:
        return None
    shown = sorted(search["optima"], key=lambda one: one["design"] != search["recommended"])[:BEST]
    choices = [choices_of(results, one["design"]) for one in shown]
    rows: list[list[Any]] = [[heading(n), *(factor_cell(n, own[n]) for own in choices)] for n in choices[0]]
    for i, (goal, way) in enumerate(search["goals"].items()):
        if goal in choices[0]:
            continue
        _, units, words = goal_column(results, goal)
        head = with_unit(capital(words), units) if units not in ("", "1") else capital(words)
        for key, mark in (("values", " ↑" if way == "max" else " ↓"), ("reference", ", at reference")):
            numbers = [float(one[key][i]) for one in shown]
            if is_life(goal) and units == "h":
                marked = beyond_data(results, goal)
                numbers = [Life(v, bool(marked[one["design"]])) for v, one in zip(numbers, shown, strict=True)]
            rows.append([f"{head}{mark}", *numbers])
    if any(one["violation"][0] for one in shown):
        rows.append(["Does not hold in", *(percent(one["violation"][0]) for one in shown)])
    first = "Closest to valid" if least_violation(search) else "Recommended"
    heads = [first, *(f"Optimum {i}" for i in range(2, len(shown) + 1))]
    note = f"{_within(results)}{' Bold: differs from the first design.' * (len(shown) > 1)}".strip()
    return compared("optima", "Optima of the search", heads, rows, note)


def _within(results: Results) -> str:
    """Say where in the ranges of lives the numbers of a table stand; '' without ranges."""
    return f"Within the ranges: {within_words(results)}." if results.ranged else ""


def steps_table(results: Results) -> Table | None:
    """List the recommended design of a search and the designs one step of a real choice away; None without steps."""
    search = optimum_of(results)
    if search is None or not search["neighbours"]:
        return None
    judged = judge(results)
    best, many = _best(search, judged), results.design.meta["inner_samples"]
    if best is None or best["design"] != search["recommended"]:
        return None  # the steps are those around the design that the search recommended
    own = {"values": best["values"], "violation": best["violation"][0], "short": judged.short[best["design"]]}
    own["life"], near = judged.life[best["design"]], search["neighbours"]
    asked = [judged_by(goal) for goal in search["goals"]]
    counted = all(kind in ("b10", "probability") for kind, _ in asked)
    lives = "life" in near[0] and not any(is_life(output) for _, output in asked)
    rows = []
    for one in (own, *near):
        name = "Recommended"
        if one is not own:
            step, unit = float(one["step"]), getattr(parameter_of(one["choice"]), "unit", "1")
            name = f"{capital(long_name(one['choice']))} {'+' * (step > 0)}{quantity(step, unit)}"
        row: dict[str, Any] = {"Design": name}
        if required(results) and "short" in near[0]:
            row["Surely meets the target"] = "no" if one["short"] else "yes"
        if not counted:
            row["Holds in"] = part_of(round((1 - one["violation"]) * many), many)
        for goal, value in zip(search["goals"], one["values"], strict=True):
            _, units, words = goal_column(results, goal)
            head = with_unit(capital(words), units) if units not in ("", "1") else capital(words)
            known = not one["violation"] or goal in results.design.meta["outer"] or counted
            row[head] = percent(value) if judged_by(goal)[0] == "probability" else float(value) if known else np.nan
        if lives and results.life is not None:
            row[with_unit(f"{capital(results.life[1])}, shortest", results.life[2])] = (
                np.nan if one["violation"] else float(one["life"])
            )
        rows.append(row)
    return Table.of("steps", "Steps around the recommended design", rows, _within(results))
