"""The interval of each case of a study: both ends of its life, or why it is not met or not judged."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from trackroller.methods.b10 import b10
from trackroller.parameters import BODIES, FIRST_TO_FAIL, REGIMES
from trackroller.results.by_tests import POSITIONS, ByTests, probability_of
from trackroller.results.candidates import FEWEST, STRESS, Candidates
from trackroller.results.columns import codes
from trackroller.results.first_limits import UNSURE, first_at, first_limit
from trackroller.results.groups import MOST_LEVELS
from trackroller.results.lives import FIRST_LIMIT, OF_PAIR
from trackroller.results.results import Results
from trackroller.results.robustness import material_deviations
from trackroller.study.outputs import flat

OnTarget = tuple[np.ndarray, np.ndarray]  # cases that surely meet the target, and cases that may meet it, shape (n,)
NOT_JUDGED = (
    "life not known",
    "fatigue not known",
    "steep friction",
    "conformal",
    "outside the half-space",
    "not converged",
)


@dataclass(frozen=True)
class Cases:
    """The cases of a study with the interval of each.

    The interval is [0, 0] where a case is not met: it skids, lifts off, breaks, yields, misses a constraint, or exceeds
    a limit without hours on values that were given. It is [0, inf] where the model does not judge the case. Otherwise
    it holds the life at both ends of the ranges of the placeholders, or twice the same life where it rests on none.
    A life by a material that was fitted to tests is a range, too: 90 % of the lives by its posterior.

    Attributes
    ----------
    candidates : the designs of the study
    """

    candidates: Candidates

    @property
    def results(self) -> Results:
        """Return the solved study."""
        return self.candidates.results

    @property
    def own(self) -> np.ndarray:
        """Return the cases that are compared, shape (n,); not those of a less exact contact model."""
        return np.asarray(self.candidates.place >= 0)

    @cached_property
    def spans(self) -> tuple[str, ...]:
        """Return the conditions that span the ranges of placeholders, and so are none."""
        few = (n for n in UNSURE if n in self.candidates.conditions and len(self.results.levels(n)) <= MOST_LEVELS)
        return tuple(few) if self.candidates.matched else ()

    @cached_property
    def conditions(self) -> tuple[str, ...]:
        """Return the conditions of the use."""
        return tuple(n for n in self.candidates.conditions if n not in self.spans)

    @cached_property
    def use(self) -> np.ndarray:
        """Return the number of the condition of each case, shape (n,)."""
        return codes(self.results.table, self.conditions)

    @cached_property
    def level(self) -> np.ndarray:
        """Return the number of the place in the ranges of the placeholders of each case, shape (n,)."""
        return codes(self.results.table, self.spans)

    @property
    def sampled(self) -> bool:
        """Return whether the conditions are a random sample, large enough for what nine of ten reach: no stress."""
        own = self.candidates
        return own.drawn and own.goal != STRESS and bool(self.conditions) and bool(own.size.min() >= FEWEST)

    @cached_property
    def reason(self) -> np.ndarray:
        """Return why a case is not met or not judged, shape (n,); '' where it is judged."""
        results = self.results
        life = self._column("")
        out = np.full(len(life), "", dtype=object)
        missed = np.zeros(len(life), dtype=bool)
        if results.allowed is not None:
            missed = ~results.allowed
        masks = [
            ("life not known", np.isnan(life)),
            ("fatigue not known", results.without_fatigue),
            *((f"limit {name}", rows) for name, rows in self.results.limits_in("exceeded").items()),
            ("yields", results.flagged("yield")),
            ("breaks", results.flagged("static")),
            ("steep friction", results.flagged("steep_friction")),
            ("conformal", results.flagged("conformal")),
            ("outside the half-space", results.flagged("half_space")),
            ("misses a constraint", missed),
            ("not converged", (results.column("converged", 1.0) != 1) | (results.regime == REGIMES.index("failed"))),
            ("lifts off", results.regime == REGIMES.index("lift_off")),
            ("skids", results.regime == REGIMES.index("full_slip")),
        ]
        for word, rows in masks:  # the last one counts
            out[rows] = word
        return out

    @cached_property
    def judged(self) -> np.ndarray:
        """Return the cases that the model judges, shape (n,)."""
        return np.asarray(~np.isin(self.reason.astype(str), NOT_JUDGED))

    @cached_property
    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Return both ends of the goal of each case, as a life or as 1/stress, shape (n,) each."""
        low, high = self.unscattered
        return (low, high) if self.scatter is None else (low * self.scatter[0], high * self.scatter[1])

    @cached_property
    def unscattered(self) -> tuple[np.ndarray, np.ndarray]:
        """Return `ends` without the scatter of the material: the lives of the cases themselves."""
        return self._between(*((self._by_tests(i), end) for i, end in enumerate(("_low", "_high"))))

    @cached_property
    def scatter(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Return the factors on both ends, shape (n,) each, by which the material's own scatter changes B10.

        None unless the study asks for this scatter, and conditions are sampled. A factor is that of the design of a
        case: B10 with the scatter over B10 without it. A life that fatigue does not end has no such scatter.
        """
        own = material_deviations(self.results) if self.sampled and self._tests is None else {}
        if not own:
            return None
        lives = self._between((None, "_low"), (None, "_high"))
        factors = np.ones((2, len(self.reason)))
        for end, values, factor in zip(("_low", "_high"), lives, factors, strict=True):
            names, guide = self.at_end(end)
            deviation = np.where(guide, own.get("guide", 0.0), own.get("roller", 0.0)) * (names == "fatigue")
            for i in range(len(self.candidates.size)):
                rows = self.candidates.place == i
                plain = b10(values[rows])[0]
                if 0.0 < plain < np.inf:
                    factor[rows] = b10(values[rows], deviation[rows])[0] / plain
        return factors[0], factors[1]

    def _between(self, *shifted: tuple[Any, str]) -> tuple[np.ndarray, np.ndarray]:
        """Return both ends of the goal of each case, with the lives by fatigue moved at each end."""
        low, high = (self._column(end, shift) for shift, end in shifted)
        if not self.candidates.rising:
            with np.errstate(divide="ignore"):
                low, high = 1.0 / low, 1.0 / high
        met = self.reason == ""
        return np.where(met, low, 0.0), np.where(met, high, np.where(self.judged, 0.0, np.inf))

    @cached_property
    def positions(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return `ends` at each position of the posteriors of fitted materials; at the one position without them.

        At a position all cases share the values of a material. `ends` holds the band over all positions.
        """
        own, chance = self._tests, self._probability
        if own is None:
            return [self.ends]
        at = [own.at(draw, probability=chance) for draw in POSITIONS]
        return [self._between((shift, "_low"), (shift, "_high")) for shift in at]

    @property
    def _tests(self) -> ByTests | None:
        """Return the fits of materials to tests; None if the goal is no life, or no material was fitted."""
        return self.results.by_tests if self.candidates.rising else None

    @property
    def _probability(self) -> float:
        return probability_of(self.results, self.candidates.goal[0])

    @cached_property
    def _shifts(self) -> dict[str, np.ndarray]:
        """Return the shift of ln life by fatigue of each body at both ends of the band by the tests, (2, n)."""
        own = self._tests
        return {} if own is None else {body: own.ends(body, self._probability) for body in BODIES}

    def _by_tests(self, end: int) -> Any:
        """Return the shifts of ln life by body at an end of the band by the tests; None without fitted materials."""
        return (lambda body: self._shifts[body][end]) if self._shifts else None

    @cached_property
    def tested(self) -> dict[str, np.ndarray]:
        """Return the cases whose range the tests of each fitted material widen, (n,) bool by its name."""
        own = self._tests
        if own is None:
            return {}
        ended = {end: self.at_end(end) for end in ("_low", "_high")}
        out = {name: np.zeros(len(self.reason), dtype=bool) for name in own.fits}
        for names, guide in ended.values():
            body = np.where(guide, own.named["guide"], own.named["roller"])
            for name, rows in out.items():
                rows |= (names == "fatigue") & (body == name) & (self.reason == "")
        return out

    @cached_property
    def beyond_tests(self) -> np.ndarray:
        """Return the cases whose life by a fitted material lies beyond its tests, (n,)."""
        own, fatigue = self._tests, self.low_end[0] == "fatigue"
        if own is None:
            return np.zeros(len(self.reason), dtype=bool)
        return np.asarray(fatigue & np.where(self.low_end[1], own.beyond("guide"), own.beyond("roller")))

    def _column(self, end: str, shift: Any = None) -> np.ndarray:
        """Return the goal or an end of its range, shape (n,); the goal itself where no range is stored.

        `shift` moves the lives by fatigue, see `trackroller.results.by_tests.ByTests.lives`.
        """
        name = self.candidates.goal[0]
        value: np.ndarray = self.results.column(name)
        if end and f"{name}{end}" in self.results.data:
            found = flat(self.results.data, f"{name}{end}", self.results.dims).astype(float)
            value = np.where(np.isnan(found), value, found)
        own = self.results.by_tests
        return np.asarray(value if shift is None or own is None else own.lives(name, value, shift, end))

    @cached_property
    def guessed(self) -> np.ndarray:
        """Return the cases whose range rests on placeholders, (n,)."""
        return np.asarray(self._column("_high") > self._column("_low") * (1.0 + 1e-9))

    @cached_property
    def open_limits(self) -> dict[str, np.ndarray]:
        """Return the cases in which a limit is exceeded at one end of the range of a placeholder only."""
        return {name: rows & (self.reason == "") for name, rows in self.results.limits_in("open").items()}

    @cached_property
    def error(self) -> np.ndarray:
        """Return the relative error of the goal of each case by the solution, shape (n,) [1]; 0 if it is not known."""
        results = self.results
        if not self.candidates.rising:
            return np.asarray(np.nan_to_num(results.column("error_estimate_roller")))
        if "life_error_estimate" not in results.data:
            return np.zeros(len(results.table))
        data = results.data.transpose(..., "contact", "body", missing_dims="ignore")
        errors, lives = (flat(data, name, results.dims) for name in ("life_error_estimate", "life_cycles"))
        place = np.argmin(np.where(np.isnan(lives), np.inf, lives), axis=1)[:, None, :]
        own = np.nan_to_num(np.take_along_axis(errors, place, axis=1)[:, 0, :])
        by_fatigue = np.isin(self.first.astype(str), ("fatigue", ""))
        return np.asarray(np.where(by_fatigue, np.where(self.guide, own[:, 1], own[:, 0]), 0.0))

    @cached_property
    def guide(self) -> np.ndarray:
        """Return the cases in which the guide fails first, shape (n,)."""
        return np.asarray(self.results.first_failing(self.candidates.goal[0]) == FIRST_TO_FAIL.index("guide"))

    @cached_property
    def beyond(self) -> np.ndarray:
        """Return the cases whose life lies beyond the S-N data, shape (n,)."""
        return np.asarray(self.results.beyond_data(self.candidates.goal[0]))

    @cached_property
    def beyond_at_high(self) -> np.ndarray:
        """Return the cases whose life at the high end of its range ends by fatigue beyond the S-N data, shape (n,)."""
        fatigue = next((life[0] for life in self.results.fatigue_lives if life[0] in self.results.table), "")
        return np.asarray((self.high_end == "fatigue") & self.results.beyond_data(fatigue))

    @cached_property
    def first(self) -> np.ndarray:
        """Return the limit that ends each case, shape (n,); '' where it is not known."""
        if self.candidates.goal == FIRST_LIMIT:
            return first_limit(self.results)
        return np.full(len(self.results.table), "fatigue" if self.candidates.rising else "", dtype=object)

    def at_end(self, end: str) -> tuple[np.ndarray, np.ndarray]:
        """Return what ends each case at the `_low` or `_high` end of its range, and whether the guide does, (n,) each.

        What ends the case between the ends stands in for a limit that is not known there.
        """
        if self.candidates.goal != FIRST_LIMIT or f"life_hours_by_limit{end}" not in self.results.data:
            return self.first, self.guide
        shift, own = self._by_tests(("_low", "_high").index(end)), self.results.by_tests
        names, guide = first_at(self.results, end, None if own is None or shift is None else own.reached(shift, end))
        known = names != ""
        return np.where(known, names, self.first), np.where(known, guide, self.guide)

    @cached_property
    def low_end(self) -> tuple[np.ndarray, np.ndarray]:
        """Return what ends each case at the low end of its range, and whether it ends the guide, shape (n,) each."""
        return self.at_end("_low")

    @cached_property
    def high_end(self) -> np.ndarray:
        """Return what ends each case at the high end of its range, shape (n,)."""
        return self.at_end("_high")[0]

    @cached_property
    def out_of_reach(self) -> np.ndarray:
        """Return the cases of the conditions that no candidate meets, shape (n,).

        A candidate that is not judged in a condition does not meet it.
        """
        high = np.where(self.judged, self.ends[1], 0.0)
        if not self.conditions:
            return np.zeros(len(high), dtype=bool)
        if not self.candidates.matched:
            fails = self.own & np.isin(self.reason.astype(str), ("lifts off", "skids"))
            return np.asarray(fails & (not self._any_reaches(self.own)))
        most = np.zeros(self.use.max() + 1)
        np.maximum.at(most, self.use[self.own], high[self.own])
        hopeless = self.own & (most[self.use] == 0.0)
        # nine of ten conditions: those without any candidate count as 0, unless no candidate is left
        return hopeless if not (self.sampled and self._any_reaches(self.own)) else np.zeros(len(high), dtype=bool)

    def _any_reaches(self, rows: np.ndarray) -> bool:
        """Return whether nine of ten of these conditions are met by some candidate."""
        high = self.ends[1]
        groups = (high[rows & (self.candidates.place == i)] for i in range(len(self.candidates.size)))
        return any(len(own) and b10(own)[0] > 0.0 for own in groups)

    def on_target(self, exact: bool = True, scattered: bool = True) -> tuple[float, np.ndarray, np.ndarray]:
        """Return the required hours, the cases that surely meet the target, and the cases that may meet it.

        A target on a life of the pair or of the roller is judged by the life that is compared: a longer life by one
        limit is of no use if another limit comes first. Unless `exact`, the error of the solution widens the range of
        each life. Unless `scattered`, the lives of the cases themselves count, without the scatter of the material.
        """
        results = self.results
        error = 1.0 if exact else 1.0 + self.error
        both = self.ends if scattered else self.unscattered
        low, high = both[0] / error, both[1] * error
        required, others = np.nan, np.ones(len(low), dtype=bool)
        for name, ends in results.config.requirement.items():
            if name in self.other_targets:
                others &= results.meets(name)
            else:
                required = float(np.fmax(required, ends.least))
        least = 0.0 if np.isnan(required) else required
        uncertain = np.any([np.zeros(len(low), dtype=bool), *self.open_limits.values()], axis=0)
        judged = self.judged
        sure = judged & (self.reason == "") & (low >= least) & others & ~uncertain
        may = np.where(judged, (self.reason == "") & (high >= least) & others, True)
        return required, sure, np.asarray(may)

    @cached_property
    def other_targets(self) -> tuple[str, ...]:
        """Return the targets of the study that the life which is compared does not judge, such as those on a force."""
        hours, targets = self.candidates.goal[2] == "h", self.results.config.requirement
        return tuple(n for n, ends in targets.items() if not (hours and n in OF_PAIR and ends.only_least))

    def conditions_in(self, rows: np.ndarray) -> np.ndarray:
        """Return the number of conditions of each candidate that have one of these cases, shape (candidates,)."""
        place, many = self.candidates.design, len(self.candidates.size)
        pairs = np.unique(place[rows] * (int(self.use.max()) + 1) + self.use[rows])
        return np.bincount(pairs // (int(self.use.max()) + 1), minlength=many)

    def worst(self, kept: np.ndarray) -> np.ndarray:
        """Return the case of each candidate with the smallest low end, shape (candidates,); -1 without a case.

        Of sampled conditions it is the case whose low end nine of ten reach.
        """
        candidates, (low, high) = self.candidates, self.ends
        out = np.full(len(candidates.size), -1)
        rows = np.flatnonzero(kept & self.own)
        rows = rows[np.lexsort((high[rows], low[rows], candidates.place[rows]))]
        numbers, start, size = np.unique(candidates.place[rows], return_index=True, return_counts=True)
        step = np.ceil(0.1 * size).astype(int) - 1 if self.sampled else np.zeros(len(size), dtype=int)
        out[numbers] = rows[start + step]
        return out
