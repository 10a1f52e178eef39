"""What to measure: the placeholder on which a decision turns, and the value at which it turns."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from trackroller.damage import LIMITS
from trackroller.parameters import BODIES
from trackroller.results.answer import Required
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.comparison import Comparison
from trackroller.results.first_limits import COEFFICIENT, reached_by_body
from trackroller.results.life_columns import BESIDE, FIRST_LIMIT
from trackroller.results.solved_cases import SolvedCases
from trackroller.roller.limit_notes import Placeholder, placeholders_of
from trackroller.study.outputs import flat

STEPS = np.linspace(0.0, 1.0, 201)  # places of a placeholder in its range, on a logarithmic scale
LINE = (
    "fatigue in rolling contact"  # what a life between a bending and a rolling-contact line lacks
)
# of the leader's range over which a rival must lead before the placeholder is worth a measurement
LEAST = 0.1


@dataclass(frozen=True, eq=False)
class Turning:
    """Lives of candidates while one placeholder moves through its range, and all others stay in the
    middle.

    Attributes
    ----------
    own : the comparison of a study
    """

    own: Comparison

    @cached_property
    def hours(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the hours to each limit of each body at both ends, (n, limit, 2); None if lives
        have no range.
        """
        data = self.own.results.data
        if self.own.ranges.output != FIRST_LIMIT or "life_hours_by_limit_low" not in data:
            return None
        ends = []
        for end in ("_low", "_high"):
            moved = self.own.ranges.hours_at(end)
            ends.append(reached_by_body(self.own.results, end, moved))
        return ends[0], ends[1]

    @cached_property
    def _worst(self) -> dict[tuple[int, int, bool], np.ndarray]:
        return {}

    @cached_property
    def placeholders(self) -> list[Placeholder]:
        """Return the placeholders of limits that end lives, and the tests of fitted materials."""
        placeholders = [
            one for one in placeholders_of(self.own.results.data) if one.limit not in BESIDE
        ]
        tests = [Placeholder("fatigue", name, "tests") for name in self.own.ranges.tested]
        lines = [Placeholder("fatigue", name, LINE) for name in self.own.ranges.between_lines]
        return placeholders + tests + lines

    def moves(self, one: Placeholder, rows: np.ndarray) -> np.ndarray:
        """Return which limits and bodies of some cases rest on a placeholder, (rows, limit, 2)
        bool.
        """
        names = [str(name) for name in self.own.results.data["limit"].values]
        out = np.zeros((len(rows), len(names), len(BODIES)), dtype=bool)
        if one.limit not in names:
            return out
        for place, body in enumerate(BODIES):
            other = self.materials[BODIES[1 - place]][rows]
            here = self.materials[body][rows] == one.material
            out[:, names.index(one.limit), place] = here & ((other == one.on) | (one.on == ""))
        return out

    @cached_property
    def materials(self) -> dict[str, np.ndarray]:
        """Return the names of the materials of each body, (n,)."""
        return {body: self.own.results.material(body) for body in BODIES}

    def worst(self, number: int, one: Placeholder, one_form: bool = False) -> np.ndarray:
        """Return the life of a candidate at its worst condition at each of `STEPS` of a
        placeholder, (steps,) [h].

        A life by wear is a range by its coefficient and by the form in which the groove wears: at
        one place, or over the run-in width. With `one_form` the coefficient moves alone, to which
        the life is inversely proportional, and the groove wears in the form with the shorter life.
        """
        key = number, self.placeholders.index(one), one_form
        if key not in self._worst:
            self._worst[key] = self._worst_of(number, one, one_form)
        return self._worst[key]

    def _worst_of(self, number: int, one: Placeholder, one_form: bool) -> np.ndarray:
        assert self.hours is not None
        rows = self.own.rows[number]
        rows = rows[self.own.reachable[rows] & self.own.ranges.holds[rows]]
        if not len(rows):
            return np.zeros(len(STEPS))
        with np.errstate(divide="ignore", invalid="ignore"):
            low, high = (np.log(hours[rows]) for hours in self.hours)
        endless = np.isposinf(low)
        open_end = np.isposinf(high) & ~endless
        with np.errstate(invalid="ignore"):
            width = np.where(endless | open_end, 0.0, high - low)
        start = np.where(endless, np.inf, low)
        moved = self.moves(one, rows)
        still = np.where(moved, np.inf, start + 0.5 * width).min()
        least = np.full(len(STEPS), still)
        with np.errstate(invalid="ignore"):
            for limit, body in np.argwhere(moved.any(axis=0)):
                here = moved[:, limit, body]
                moving = width[here, limit, body]
                if one_form:
                    moving = np.minimum(moving, np.log(one.high / one.low))
                lines = start[here, limit, body, None] + moving[:, None] * STEPS
                least = np.minimum(least, lines.min(axis=0))
            return np.asarray(np.exp(least))

    def leads(self, leader: int, rivals: list[int]) -> dict[str, Any] | None:
        """Return the placeholder of a leader over whose range a rival leads for at least a tenth;
        None without one.

        Returns
        -------
        `what`, `of` (its material), `on` (the other one), `turn` (where a rival overtakes; NaN if
        it is not known), `units`, `low` and `high` (the range of the placeholder).
        """
        if self.hours is None:
            return None
        best = LEAST
        placeholder = None
        for one in self.placeholders:
            mine = self.worst(leader, one)
            if mine[-1] <= mine[0] * (1 + 1e-9):
                continue
            for rival in rivals:
                ahead = self.worst(rival, one) > mine * (
                    1.0 + self.own.error_of_ratio(leader, rival)
                )
                if ahead.mean() >= best:
                    best = float(ahead.mean())
                    placeholder = record_of(one, self._overtaken(leader, rival, one))
        return placeholder

    def _overtaken(self, leader: int, rival: int, one: Placeholder) -> int:
        """Return the step at which a rival overtakes the leader, or falls behind it, while a wear
        coefficient moves and the groove wears in one form; -1 where it does neither.
        """
        if not has_turn(one):
            return -1
        margin = 1.0 + self.own.error_of_ratio(leader, rival)
        ahead = self.worst(rival, one, True) > margin * self.worst(leader, one, True)
        changes = np.flatnonzero(ahead != ahead[0])
        if not len(changes):
            return -1
        return int(changes[0])

    def decides(self, number: int, least: float) -> dict[str, Any] | None:
        """Return the placeholder whose place decides whether a candidate reaches a life; None
        without one.

        Of several, the one with the widest effect counts.
        """
        if self.hours is None:
            return None
        widest = 1.0
        placeholder = None
        for one in self.placeholders:
            mine = self.worst(number, one)
            width = np.inf
            if mine[0] > 0:
                width = mine[-1] / mine[0]
            if width <= widest * (1 + 1e-9):
                continue
            widest = width
            placeholder = record_of(one, self._reached(number, one, least))
        return placeholder

    def _reached(self, number: int, one: Placeholder, least: float) -> int:
        """Return the step from which on a candidate reaches a life while a wear coefficient moves
        and the groove wears in the form with the shorter life; -1 without one.
        """
        if not has_turn(one):
            return -1
        enough = self.worst(number, one, True) >= least
        if not enough[-1] or enough[0]:
            return -1
        return int(np.argmax(enough))

    def of_open_limit(self, number: int) -> dict[str, Any] | None:
        """Return the placeholder that leaves a limit without hours open for a candidate; None if
        none is open.
        """
        return value_of_open_limit(self.own.results, self.own.ranges, self._counted(number))

    def behind(self, number: int) -> dict[str, Any] | None:
        """Return the value whose range leaves the requirement open for a candidate; None without
        one.
        """
        return value_behind(self.own.results, self.own.judges, self._counted(number))

    def _counted(self, number: int) -> np.ndarray:
        """Return the numbers of the cases of a candidate that count, shape (k,)."""
        rows = self.own.rows[number]
        return np.asarray(rows[self.own.reachable[rows]])

    def of_span(self, leader: int, rivals: list[int]) -> dict[str, Any] | None:
        """Return the placeholder whose range a factor spans if a rival leads over a tenth of it or
        more; None without.

        The leader stands at each level of the factor in turn. Rivals of the same materials stand at
        the same level, because they share the placeholder, and all others in the middle of their
        range.
        """
        own = self.own
        if not own.spans or not rivals:
            return None
        levels = np.unique(own.level[own.own])
        mine = self._at_level(leader, levels)
        ahead = np.zeros(len(levels), dtype=bool)
        overtaking: list[int] = []
        for rival in rivals:
            if own.materials[rival] == own.materials[leader]:
                theirs = self._at_level(rival, levels)
            else:
                theirs = np.full(len(levels), self._middle(rival, levels))
            leads = theirs > mine * (1.0 + own.error_of_ratio(leader, rival))
            ahead |= leads
            if leads.any():
                overtaking.append(rival)
        if ahead.mean() < LEAST:
            return None
        known = self._behind(leader, int(np.argmin(mine)), levels)
        if own.spans[0] != COEFFICIENT and known is not None and 0 < mine.min() < mine.max():
            target = max(self._middle(rival, levels) for rival in overtaking)
            share = np.log(target / mine.min()) / np.log(mine.max() / mine.min())
            return record_of(known, int(np.clip(np.searchsorted(STEPS, share), 0, len(STEPS) - 1)))
        name = own.spans[0]
        values = own.results.levels(name)
        what = name
        if name == COEFFICIENT:
            what = "wear_coefficient"
        quantity = {"what": what, "of": "", "on": "", "turn": np.nan, "units": "times its value"}
        return quantity | {"low": values[0], "high": values[-1]}

    def _middle(self, number: int, levels: np.ndarray) -> float:
        """Return the geometric middle of the range of a candidate over the places of the
        placeholders.
        """
        lives = self._at_level(number, levels)
        return float(np.sqrt(lives.min()) * np.sqrt(lives.max()))

    def _behind(self, number: int, place: int, levels: np.ndarray) -> Placeholder | None:
        """Return the placeholder of the limit that ends a candidate at one place of the
        placeholders; None without.
        """
        own = self.own
        rows = own.rows[number]
        rows = rows[own.reachable[rows] & (own.level[rows] == levels[place])]
        row = int(rows[np.argmin(own.ranges.middle[rows])])
        limit, guide = (part[row] for part in own.ranges.first)
        material = str(self.materials[BODIES[int(guide)]][row])
        known = [one for one in self.placeholders if (one.limit, one.material) == (limit, material)]
        if known:
            return known[0]
        return None

    def _at_level(self, number: int, levels: np.ndarray) -> np.ndarray:
        """Return the life of a candidate at its worst condition at each level of the spanned
        placeholders.
        """
        own = self.own
        rows = own.rows[number]
        rows = rows[own.reachable[rows]]
        at_level = [
            own.ranges.middle[rows[own.level[rows] == level]].min(initial=np.inf)
            for level in levels
        ]
        return np.array(at_level)


def has_turn(one: Placeholder) -> bool:
    """Return whether the value at which an answer turns can be said of a placeholder: of a wear
    coefficient, to which the life by wear is inversely proportional.
    """
    return one.name.startswith("wear_coefficient") and one.low > 0


def record_of(one: Placeholder, step: int = -1) -> dict[str, Any]:
    """Return a placeholder with the value at one of `STEPS`, -1 for none; only a wear coefficient
    has one.
    """
    turn = np.nan
    if step >= 0 and has_turn(one):
        turn = float(one.high * (one.low / one.high) ** STEPS[step])
    return {
        "what": one.name,
        "of": one.material,
        "on": one.on,
        "turn": turn,
        "units": one.units,
        "low": one.low,
        "high": one.high,
    }


def value_behind(
    results: SolvedCases, judges: Sequence[tuple[Required, CaseRanges]], rows: np.ndarray
) -> dict[str, Any] | None:
    """Return the value whose range leaves a requirement open, as `Turning.leads` does; None where
    no range does.

    Parameters
    ----------
    results : SolvedCases
        The solved study.
    judges : sequence of pairs
        Each requirement with the output that judges it.
    rows : numpy.ndarray of int, shape (k,)
        Cases of one design.
    """
    for required, ranges in judges:
        of_limit = value_of_open_limit(results, ranges, rows)
        if of_limit is not None:
            return of_limit
        sure, may = ranges.meets(required, exact=True)
        unsettled = rows[(may & ~sure & ranges.holds)[rows]]
        if not len(unsettled):
            continue
        widest = unsettled[np.argmax(_width(ranges, unsettled))]
        values = _values_behind(results, ranges, int(widest))
        if values:
            return record_of(max(values, key=_turns))
    return None


def _width(ranges: CaseRanges, rows: np.ndarray) -> np.ndarray:
    """Return the width of the range of some cases on a logarithmic scale, shape (k,)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        width = np.log(ranges.high[rows]) - np.log(ranges.low[rows])
    return np.asarray(np.nan_to_num(width, nan=0.0, posinf=np.inf))


def _turns(one: Placeholder) -> float:
    """Return how many times a placeholder may be larger than at its low end; 0 without a range."""
    if np.isnan(one.low):
        return 0.0
    if one.low <= 0.0:
        return np.inf
    return one.high / one.low


def _values_behind(results: SolvedCases, ranges: CaseRanges, row: int) -> list[Placeholder]:
    """Return the placeholders of the limit that ends a case at its worse end, and the tests of a
    fitted material.
    """
    end = "_high"
    if ranges.rises:
        end = "_low"
    limit, guide = (part[row] for part in ranges.first_at(end))
    bodies = (BODIES[int(guide)], BODIES[1 - int(guide)])
    material, other = (str(results.material(body)[row]) for body in bodies)
    values = [
        one
        for one in placeholders_of(results.data)
        if (one.limit, one.material) == (limit, material) and one.on in ("", other)
    ]
    if limit == "fatigue" and material in ranges.tested:
        values.append(Placeholder("fatigue", material, "tests"))
    return values


def value_of_open_limit(
    results: SolvedCases, ranges: CaseRanges, rows: np.ndarray
) -> dict[str, Any] | None:
    """Return the placeholder that leaves a limit without hours open in some cases of a design, as
    `Turning.leads` does; None if none is open.

    The use of the shakedown limit is inversely proportional to the yield strength, so that its turn
    is known.
    """
    for limit, hit in ranges.open_limits.items():
        own = rows[hit[rows]]
        place = results.data["limit"].values.tolist().index(limit)
        if not len(own) or _has_hours(results, own, place):
            continue
        use = flat(results.data, "utilisation", results.dims)[own, place].astype(float)
        row, body = np.unravel_index(np.nanargmax(use), use.shape)
        material = str(results.material(BODIES[body])[own[row]])
        known = [
            one
            for one in placeholders_of(results.data)
            if (one.limit, one.material) == (limit, material)
        ]
        if not known:
            return {
                "what": LIMITS[limit].word,
                "of": material,
                "on": "",
                "turn": np.nan,
                "units": "",
            }
        placeholder = record_of(known[0])
        if len(known) > 1:
            placeholder["what"] = " or ".join(dict.fromkeys(one.name for one in known))
        if known[0].name == "yield_strength":
            stored = json.loads(str(results.data.attrs.get("materials", "{}"))).get(material, {})
            placeholder["turn"] = float(stored.get("yield_strength", np.nan)) * float(
                np.nanmax(use)
            )
        return placeholder
    return None


def _has_hours(results: SolvedCases, rows: np.ndarray, place: int) -> bool:
    """Return whether the hours to a limit are known in some cases."""
    name = "life_hours_by_limit"
    if name not in results.data:
        return False
    return not bool(np.isnan(flat(results.data, name, results.dims)[rows, place]).all())
