"""Sentences on designs: which one to build, what fails first, and which of them meet a target."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from trackroller.analysis.designs import FEWEST, Designs, factor_roles
from trackroller.analysis.table import StudyView
from trackroller.parameters import BODIES, FIRST_TO_FAIL
from trackroller.report.numbers import (
    BEYOND,
    GUIDE_UNKNOWN,
    NO_FAILURE,
    capital,
    count,
    lasting,
    listing,
    long_name,
    percent,
    quantity,
    rounded,
    setting,
    share,
)
from trackroller.report.words.sentence import Sentence

BEYOND_MEANS = "Beyond the S-N data: below the fatigue limit, or above 10⁸ overrollings."
MOST_TIES = 3  # designs with equal lives that are named


def design_words(designs: Designs, row: pd.Series) -> str:
    """Name a design by its choices, materials first, such as 'PA6 on itself, contact angle 30°'."""
    names = sorted(designs.choices, key=lambda name: designs.view.numeric(name))
    return ", ".join(setting(name, row[name]) for name in names)


def condition_words(designs: Designs, case: int) -> str:
    """Name the conditions of a case, without those that do not change the goal of its design there."""
    table, goal = designs.view.table, designs.view.column(designs.goal[0])
    own = designs.usable & (designs.place == designs.place[case])
    alike = own & (goal == goal[case])
    told = [n for n in designs.conditions if table[n][alike].nunique() < max(table[n][own].nunique(), 2)]
    return ", ".join(setting(name, table[name].iloc[case]) for name in told or designs.conditions)


def alone(designs: Designs) -> bool:
    """Return whether the roller stands for the pair in every case, because the guide's hours are unknown."""
    return designs.rising and not designs.view.has("guide_life_hours")


def _lasts(designs: Designs, life: str) -> str:
    """Say how long roller and guide last, or the roller alone; `life` is written by `lasting`."""
    if life.startswith(NO_FAILURE):
        return life.replace(
            NO_FAILURE, "the roller does not fail" if alone(designs) else "roller and guide do not fail"
        )
    return f"{'the roller lasts' if alone(designs) else 'roller and guide last'} {life}"


def size_words(view: StudyView) -> str:
    """State the size of a study: '162 cases: 9 designs in 18 conditions each'."""
    cases, designs = len(view.table), Designs.of(view)
    text = f"{count(cases)} case{'s' * (cases > 1)}"
    if designs is None or not (designs.matched and designs.choices and designs.conditions):
        return text
    many, size = len(designs.size), int(designs.size[0])
    each = f": {count(many)} design{'s' * (many > 1)} in {count(size)} conditions{' each' * (many > 1)}"
    return text + each * (many * size == cases)


def best_design(view: StudyView) -> list[Sentence]:
    """Say which design to build, how long it lasts, what fails first, and which design comes next.

    Returns
    -------
    The sentences; none without a valid design. A study whose designs of experiments cannot answer says which one can.
    """
    designs = Designs.of(view)
    if designs is None:
        nothing = np.zeros(len(view.table), dtype=bool)
        text = "Build none of these designs: not one case is valid."
        return [] if view.valid.any() else [Sentence("none_valid", text, {}, nothing)]
    if not designs.comparable:
        return [_unanswered(designs)]
    table, rows = designs.table, designs.usable
    best = table.iloc[0]
    ties = int((table["rank"] == 1).sum())
    name = design_words(designs, best)
    head = f"Build {name}: " if name else "The study has one design: "
    text = head + (_life(designs, best) if designs.rising else _stress(designs, best))
    values: dict[str, Any] = {"design": {n: best[n] for n in designs.choices}, "ties": ties}
    values |= {key: best[key] for key in ("worst", "median", "best", "valid", "cases", "rolls", "worst_case", "beyond")}
    said = [Sentence("best", f"{text}.", values, rows)]
    if ties > 1:
        said.append(_ties(designs, ties, rows))
    if designs.rising and (first := _first(designs, best, rows)) is not None:
        said.append(first)
    if (margins := _margins(best, rows, bool(designs.conditions))) is not None:
        said.append(margins)
    if len(table) > ties and table.iloc[ties]["valid"]:
        said.append(_next(designs, table.iloc[ties], rows))
    return said


def target_of_designs(view: StudyView, words: str) -> Sentence | None:
    """Say how many designs meet the study's targets in all their conditions, and which one meets them most often.

    Parameters
    ----------
    view : the study
    words : the targets in words

    Returns
    -------
    The sentence; None without a target, or if the study cannot compare its designs.
    """
    designs = Designs.of(view)
    met = designs.targets_met() if designs is not None and designs.comparable else None
    if designs is None or met is None:
        return None
    shares = met / designs.size
    best, every = int(np.argmax(shares)), int((shares == 1).sum())
    many = count(len(met))
    values = {"met": met.tolist(), "every": every, "best": best}
    if len(met) == 1:
        text = f"{capital(words)}: met in {count(int(met[0]))} of {count(int(designs.size[0]))} conditions"
    elif not designs.conditions:
        text = f"{capital(words)}: met by {count(every)} of {many} designs"
    else:
        them = "them" if words.startswith("all ") else "it"
        text = f"{capital(words)}: {count(every) if every else 'none'} of {many} designs "
        text += f"{'meet' if every > 1 else 'meets'} {them} in all conditions"
        if not met.any():
            text += f", and no design meets {them} in any condition"
        elif not every:
            row = designs.table[designs.table.index == best].iloc[0]
            text += f"; {design_words(designs, row)} meets {them} most often, in {count(int(met[best]))} of "
            text += f"{count(int(designs.size[best]))} conditions"
    text += f"; {GUIDE_UNKNOWN}" if "pair_life_hours" in _targets(view) and alone(designs) else ""
    return Sentence("target_of_designs", f"{text}.", values, designs.usable)


def _targets(view: StudyView) -> dict[str, Any]:
    return dict((view.study.get("analysis") or {}).get("target") or {})


def _life(designs: Designs, row: pd.Series) -> str:
    """Write worst, median and best life of a design, with the conditions in which it is valid."""
    unit = designs.goal[2]
    lives, every = _lives(row, unit, "worst", "median", "best")
    if not designs.conditions:
        return f"{_lasts(designs, lasting(row['worst'], unit, row['worst_beyond']))}{_alone(designs)}"
    where = condition_words(designs, int(row["worst_case"]))
    text = f"{_lasts(designs, lives[0])} at its worst condition ({where}), {lives[1]} in the median"
    text += f" and {lives[2]} at best{every}"
    if np.isinf(row["worst"]):
        text = f"{_lasts(designs, lives[0])} in any condition in which it is valid"
    if designs.drawn:
        low, high = rounded(row["b10_low"]), rounded(row["b10_high"])
        nine = f"nine of ten of its {count(int(row['cases']))} sampled conditions reach "
        nine += lasting(row["b10"], unit, row["b10_beyond"])
        nine += f" (95 % interval {low} to {high})"
        many = f"one in ten or more of its {count(int(row['cases']))} sampled conditions are not valid"
        text = f"{nine if row['b10'] > 0 else f'{many}, so there is no life that nine of ten reach'}; {text}"
    return f"{text}; {_validity(designs, row)}{_alone(designs)}"


def _lives(row: pd.Series, unit: str, *which: str) -> tuple[list[str], str]:
    """Write lives of a design, and a common remark where all of them lie beyond the S-N data."""
    if "b10" not in row and all(row[f"{k}_beyond"] and np.isfinite(row[k]) for k in which):
        return [quantity(row[k], unit) for k in which], f", {'all' if len(which) > 2 else 'both'} {BEYOND}"
    return [lasting(row[k], unit, row[f"{k}_beyond"]) for k in which], ""


def _alone(designs: Designs) -> str:
    return f"; {GUIDE_UNKNOWN}" if alone(designs) else ""


def _stress(designs: Designs, row: pd.Series) -> str:
    worst, unit = quantity(row["worst"], designs.goal[2]), designs.goal[2]
    if not designs.conditions:
        return f"its {designs.goal[1]} is {worst}, the lowest; the study holds no lives"
    where = condition_words(designs, int(row["worst_case"]))
    text = f"its {designs.goal[1]} is at most {worst} ({where}) and {quantity(row['median'], unit)} in the median"
    return f"{text}; {_validity(designs, row)}; the study holds no lives"


def _validity(designs: Designs, row: pd.Series) -> str:
    """Write in how many of its conditions a design is valid, and whether another design is valid in the others."""
    valid, cases = int(row["valid"]), int(row["cases"])
    if valid == cases:
        return f"it is valid in all {count(cases)} conditions"
    text = f"it is {_valid_in(row)}"
    if designs.matched and len(designs.size) > 1:
        more = designs.possible - valid
        none = cases - designs.possible
        others = [f"no design is valid in {count(none)}"] if none else []
        others += [f"other designs are valid in {count(more)} of the others"] if more else []
        text += f" ({'; '.join(others)})"
    return text


def _valid_in(row: pd.Series) -> str:
    valid, cases, rolls = (int(row[name]) for name in ("valid", "cases", "rolls"))
    rolling = f", rolls in {count(rolls)}" if rolls > valid else ""
    return f"valid in {count(valid)} of {count(cases)} conditions{rolling}"


def _ties(designs: Designs, ties: int, rows: np.ndarray) -> Sentence:
    """Name the designs that are no worse than the first."""
    others = designs.table.iloc[1:ties]
    named = [design_words(designs, row) for _, row in others.head(MOST_TIES).iterrows()]
    named += [f"{count(len(others) - MOST_TIES)} more"] if len(others) > MOST_TIES else []
    which = "nine-of-ten life" if designs.drawn and designs.rising else "worst case"
    text = f"{count(ties)} designs tie with this {which}; the others are {listing(named)}."
    if len(others) == 1:
        text = f"{count(ties)} designs tie with this {which}; the other is {named[0]}."
    return Sentence("ties", text, {"ties": ties}, rows)


def _first(designs: Designs, row: pd.Series, rows: np.ndarray) -> Sentence | None:
    """Say which body of a design fails first, and in how many of its valid cases."""
    counts = {word: int(row[f"first_{word}"]) for word in FIRST_TO_FAIL}
    known = counts["roller"] + counts["guide"]
    if not known:
        return None
    most, fewer = sorted(BODIES, key=lambda body: -counts[body])
    valid = int(row["valid"])
    if not designs.conditions:
        text = f"The {most} fails first."
    elif counts[most] == valid:
        text = f"The {most} fails first in all of its {count(valid)} valid conditions."
    else:
        text = f"The {most} fails first in {count(counts[most])} of its {count(valid)} valid conditions "
        text += f"({share(counts[most], valid)}), the {fewer} in {count(counts[fewer])}"
        text += f"; neither fails in {count(counts['none'])}" if counts["none"] else ""
        text += f"; the guide's hours are unknown in {count(counts['unknown'])}" if counts["unknown"] else ""
        text += "."
    return Sentence("first", text, counts, rows)


def _margins(row: pd.Series, rows: np.ndarray, several: bool) -> Sentence | None:
    """Say how far a design stays from slip and lift-off where it rolls."""
    margins, slip, lift = [], float(row["slip_margin"]), float(row["lift_off_margin"])
    least = "at least " if several else ""
    if slip < 1:  # without a drive nothing slips
        margins.append(f"{least}{percent(slip)} of the transmissible force is left before it slips")
    if np.isfinite(lift):
        margins.append(f"the lighter contact carries {least}{percent(lift)} of the load of the heavier one")
    text = f"{'Where it rolls, ' if several else ''}{listing(margins)}."
    return Sentence("margins", capital(text), {"slip": slip, "lift_off": lift}, rows) if margins else None


def _next(designs: Designs, row: pd.Series, rows: np.ndarray) -> Sentence:
    """Name the design that comes next, with the same numbers."""
    unit = designs.goal[2]
    (worst, middle), every = _lives(row, unit, "worst", "median")
    if designs.drawn and designs.rising and row["b10"] > 0:
        text = f"nine of ten conditions reach {lasting(row['b10'], unit, row['b10_beyond'])}; {worst} at the worst"
        text += f"; {_valid_in(row)}"
    elif not designs.conditions:
        text, every = lasting(row["worst"], unit, row["worst_beyond"]), ""
    else:
        text = f"{worst} at its worst condition, {middle} in the median{every}; {_valid_in(row)}"
    text += "; roller alone: give `guide_overrollings_per_hour`" if alone(designs) else ""
    values = {"design": {n: row[n] for n in designs.choices}, "worst": row["worst"], "median": row["median"]}
    return Sentence("next", f"Next: {design_words(designs, row)}: {text}.", values, rows)


def _unanswered(designs: Designs) -> Sentence:
    """Say why a study cannot compare designs, and which design of experiments can."""
    roles = factor_roles(designs.view)
    choices, conditions = (
        listing([long_name(n) for n in roles if roles[n] == role]) for role in ("choice", "condition")
    )
    few, most = int(designs.size.min()), int(designs.size.max())
    method = str(designs.view.study.get("design", "")).replace("_", " ")
    if most == 1:
        text = f"Each of the {count(len(designs.size))} cases is a design of its own at one condition"
    else:
        sizes = f"{few} to {most}" if few < most else str(few)
        text = f"The {count(len(designs.size))} designs have {sizes} conditions each, which differ between designs; "
        text += f"a comparison needs {FEWEST}"
    text += f", so this {method} study cannot say which design is best. " if method else ". "
    text += f"To choose, give {choices} as lists and {conditions} as distributions with `design: inner_outer`"
    values = {"designs": len(designs.size), "least": few, "most": most}
    return Sentence("unanswered", f"{text}.", values, designs.usable)
