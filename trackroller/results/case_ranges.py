"""One output of every case with its range: both ends, the error of the solution, and why a case has
no value.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trackroller.parameters import BODIES, FIRST_TO_FAIL, REGIMES
from trackroller.results.answer import Required
from trackroller.results.first_limits import first_at, first_limit
from trackroller.results.life_columns import EVIDENCE, FIRST_LIMIT, OF_PAIR
from trackroller.results.lives_by_tests import beyond_sn_data, by_tests_of
from trackroller.results.solved_cases import SolvedCases
from trackroller.roller.output_names import body_of, is_life
from trackroller.study.outputs import flat, of_fatigue, of_first_limit

NOT_JUDGED = (
    "value not known",
    "fatigue not known",
    "steep friction",
    "conformal",
    "outside the half-space",
    "not converged",
)


@dataclass(frozen=True, eq=False)
class CaseRanges:
    """One output of every case.

    A case that is not held (it skids, lifts off, yields, breaks, misses a constraint, or exceeds a
    limit) has the worst value at both ends: a life of 0, otherwise an infinite value. A case that
    the model cannot judge has every value from the worst to the best one. All other cases have the
    range that placeholders and fits leave.

    Attributes
    ----------
    results : the solved study
    output : name, words and unit
    rises : whether more is better
    """

    results: SolvedCases
    output: tuple[str, str, str]
    rises: bool

    @cached_property
    def value(self) -> np.ndarray:
        """Return the output itself, shape (n,); NaN where it is not known."""
        return self._stored("")

    @cached_property
    def low(self) -> np.ndarray:
        """Return the low end of the range, shape (n,)."""
        return self._end(0)

    @cached_property
    def high(self) -> np.ndarray:
        """Return the high end of the range, shape (n,)."""
        return self._end(1)

    @property
    def worse(self) -> np.ndarray:
        """Return the worse end of the range, shape (n,)."""
        if self.rises:
            return self.low
        return self.high

    @property
    def better(self) -> np.ndarray:
        """Return the better end of the range, shape (n,)."""
        if self.rises:
            return self.high
        return self.low

    @property
    def sign(self) -> float:
        """Return 1 if more is better, otherwise -1."""
        if self.rises:
            return 1.0
        return -1.0

    @property
    def worst_value(self) -> float:
        """Return the value of a case that is not held."""
        if not self.rises:
            return np.inf
        if is_life(self.output[0]):
            return 0.0
        return -np.inf

    @property
    def best_value(self) -> float:
        """Return the value that a case may have which the model cannot judge."""
        if self.rises:
            return np.inf
        return -np.inf

    @cached_property
    def middle(self) -> np.ndarray:
        """Return the geometric middle of the range, shape (n,); the mean of both ends unless both
        are above 0.
        """
        low, high = self.low, self.high
        with np.errstate(invalid="ignore", over="ignore"):
            between = np.where(
                (low > 0) & (high > 0), np.sqrt(low) * np.sqrt(high), 0.5 * (low + high)
            )
        return np.asarray(np.where(low == high, low, between))

    @cached_property
    def reason(self) -> np.ndarray:
        """Return why a case is not held or not judged, shape (n,); '' where it is held."""
        results = self.results
        out = np.full(len(self.value), "", dtype=object)
        missed = np.zeros(len(out), dtype=bool)
        if results.allowed is not None:
            missed = ~results.allowed
        unsolved = (results.column("converged", 1.0) != 1) | (
            results.regime == REGIMES.index("failed")
        )
        masks = [
            ("value not known", np.isnan(self.value)),
            ("fatigue not known", results.without_fatigue & is_life(self.output[0])),
            *((f"limit {name}", rows) for name, rows in results.limits_in("exceeded").items()),
            ("yields", results.flagged("yield")),
            ("breaks", results.flagged("static")),
            ("steep friction", results.flagged("steep_friction")),
            ("conformal", results.flagged("conformal")),
            ("outside the half-space", results.flagged("half_space")),
            ("misses a constraint", missed),
            ("not converged", unsolved),
            ("lifts off", results.regime == REGIMES.index("lift_off")),
            ("skids", results.regime == REGIMES.index("full_slip")),
        ]
        for word, rows in masks:  # the last one counts
            out[rows] = word
        return out

    @cached_property
    def holds(self) -> np.ndarray:
        """Return the cases that are held and judged, shape (n,)."""
        return np.asarray(self.reason == "")

    @cached_property
    def judged(self) -> np.ndarray:
        """Return the cases that the model judges, shape (n,)."""
        return np.asarray(~np.isin(self.reason.astype(str), NOT_JUDGED))

    @cached_property
    def open_limits(self) -> dict[str, np.ndarray]:
        """Return the held cases in which a limit is exceeded at one end of a placeholder only,
        shape (n,) by limit.
        """
        return {name: rows & self.holds for name, rows in self.results.limits_in("open").items()}

    @cached_property
    def open(self) -> np.ndarray:
        """Return the cases with any limit that is open, shape (n,)."""
        return np.asarray(
            np.any([np.zeros(len(self.value), dtype=bool), *self.open_limits.values()], axis=0)
        )

    @cached_property
    def error(self) -> np.ndarray:
        """Return the relative error of the output by the solution, shape (n,) [1]; 0 where none is
        stated.
        """
        name = self.output[0]
        if is_life(name):
            return self._error_of_life
        body = body_of(name)
        stated = f"error_estimate_{body}"
        if name.startswith("peak_stress") and stated in self.results.table:
            return np.asarray(np.nan_to_num(self.results.column(stated)))
        return np.zeros(len(self.value))

    @cached_property
    def told_error(self) -> np.ndarray:
        """Return the error that is stated, shape (n,) [1].

        NaN where none is: a case that is not held, a life that another limit than fatigue ends, an
        output without one.
        """
        name = self.output[0]
        results = self.results
        stated = np.full(len(self.value), name.startswith("peak_stress"))
        if is_life(name):
            stated = self._by_fatigue & ("life_error_estimate" in results.data)
        elif f"error_estimate_{body_of(name)}" not in results.table:
            stated = np.zeros(len(stated), dtype=bool)
        return np.asarray(np.where(self.holds & stated, self.error, np.nan))

    @cached_property
    def _by_fatigue(self) -> np.ndarray:
        """Return the cases that fatigue ends, or that no known limit ends, shape (n,)."""
        return np.isin(self.first[0].astype(str), ("fatigue", ""))

    @cached_property
    def _error_of_life(self) -> np.ndarray:
        """Return the error of the fatigue life that ends a case, shape (n,) [1]; 0 where another
        limit ends it.
        """
        results = self.results
        if "life_error_estimate" not in results.data:
            return np.zeros(len(self.value))
        data = results.data.transpose(..., "contact", "body", missing_dims="ignore")
        errors = flat(data, "life_error_estimate", results.dims)
        lives = flat(data, "life_cycles", results.dims)
        place = np.argmin(np.where(np.isnan(lives), np.inf, lives), axis=1)[:, None, :]
        own = np.nan_to_num(np.take_along_axis(errors, place, axis=1)[:, 0, :])
        return np.asarray(
            np.where(self._by_fatigue, np.where(self.first[1], own[:, 1], own[:, 0]), 0.0)
        )

    @cached_property
    def first(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the limit that ends each case, and whether it ends the guide, shape (n,) each; ''
        if unknown.
        """
        name = self.output[0]
        guide = self.results.first_failing(name) == FIRST_TO_FAIL.index("guide")
        if name == FIRST_LIMIT[0]:
            return first_limit(self.results), guide
        word = ""
        if of_fatigue(name):
            word = "fatigue"
        body = body_of(name)
        if body:
            guide = np.full(len(self.value), body == "guide")
        return np.full(len(self.value), word, dtype=object), guide

    def first_at(self, end: str) -> tuple[np.ndarray, np.ndarray]:
        """Return what ends each case at the `_low` or `_high` end, and whether it ends the guide,
        shape (n,) each.
        """
        if self.output[0] != FIRST_LIMIT[0] or f"life_hours_by_limit{end}" not in self.results.data:
            return self.first
        names, guide = first_at(self.results, end, self.hours_at(end))
        known = names != ""
        return np.where(known, names, self.first[0]), np.where(known, guide, self.first[1])

    def hours_at(self, end: str) -> np.ndarray | None:
        """Return the hours by each limit at an end, with the lives by fatigue moved by the tests;
        None without.
        """
        tests = by_tests_of(self.results)
        if tests is None:
            return None
        side = ("_low", "_high").index(end)
        return tests.hours(lambda body: self._shifts[body][side], end)

    @cached_property
    def tested(self) -> dict[str, np.ndarray]:
        """Return the held cases that fatigue of each fitted material ends, shape (n,) bool by its
        name.
        """
        tests = by_tests_of(self.results)
        if tests is None or not is_life(self.output[0]):
            return {}
        ended = {name: np.zeros(len(self.value), dtype=bool) for name in tests.fits}
        for end in ("_low", "_high"):
            names, guide = self.first_at(end)
            material = np.where(guide, tests.named["guide"], tests.named["roller"])
            for name in ended:
                ended[name] |= (names == "fatigue") & (material == name) & self.holds
        return ended

    @cached_property
    def between_lines(self) -> list[str]:
        """Return the materials whose life by fatigue ends a held case and reaches to that by other
        tests, which give one of its ends.
        """
        materials: set[str] = set()
        for end in ("_low", "_high"):
            names, guide = self.first_at(end)
            of_line = self.holds & np.isin(names.astype(str), EVIDENCE)
            for body, rows in (("guide", of_line & guide), ("roller", of_line & ~guide)):
                materials |= set(self.results.material(body)[rows].astype(str).tolist())
        return sorted(materials)

    @cached_property
    def beyond(self) -> np.ndarray:
        """Return the cases whose life lies beyond the data of its rule, shape (n,)."""
        return np.asarray(beyond_sn_data(self.results, self.output[0]) & self.holds)

    def judges(self, required: Required) -> bool:
        """Return whether this output judges a requirement: it names it, or a life that comes to the
        first limit.
        """
        of_pair = self.output[0] == FIRST_LIMIT[0] and required.output in OF_PAIR
        only_least = np.isfinite(required.least) and np.isinf(required.most)
        return required.output == self.output[0] or (of_pair and only_least)

    def meets(self, required: Required, exact: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Return the cases that surely meet a requirement on this output, and those that may, shape
        (n,) each.

        Parameters
        ----------
        required : what is wanted
        exact : whether the error of the solution does not count
        """
        if exact:
            error = 0.0 * self.error
        else:
            error = self.error
        lowest = _shrunk(self.low, error)
        highest = _grown(self.high, error)
        surely = (lowest >= required.least) & (highest <= required.most)
        perhaps = (highest >= required.least) & (lowest <= required.most)
        sure = self.holds & surely & ~self.open
        may = np.where(self.judged, self.holds & perhaps, True)
        return np.asarray(sure), np.asarray(may)

    @cached_property
    def _shifts(self) -> dict[str, np.ndarray]:
        """Return the shift of ln life by fatigue of each body at both ends of the band by the
        tests, (2, n) each.
        """
        tests = by_tests_of(self.results)
        if tests is None:
            return {}
        chance = 0.5
        if of_first_limit(self.output[0]):
            chance = float(self.results.data.attrs.get("failure_probability", 0.5))
        return {body: tests.ends(body, chance) for body in BODIES}

    def _stored(self, end: str) -> np.ndarray:
        """Return the output or an end of its range as it is stored, shape (n,)."""
        name = self.output[0]
        results = self.results
        value: np.ndarray
        if name in results.table:
            value = results.table[name].to_numpy(dtype=float)
        else:
            value = results.quantity(name)[0].astype(float)
        if end and f"{name}{end}" in results.data:
            stored = flat(results.data, f"{name}{end}", results.dims).astype(float)
            value = np.where(np.isnan(stored), value, stored)
        return value

    def _end(self, side: int) -> np.ndarray:
        end = ("_low", "_high")[side]
        stored = self._stored(end)
        tests = by_tests_of(self.results)
        if tests is not None and is_life(self.output[0]):
            stored = tests.lives(self.output[0], stored, lambda body: self._shifts[body][side], end)
        is_better = (side == 1) == self.rises
        if is_better:
            unknown = self.best_value
        else:
            unknown = self.worst_value
        missing = np.where(self.judged, self.worst_value, unknown)
        return np.where(self.holds, stored, missing)


def _shrunk(values: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Return the smallest values within a relative error."""
    return np.where(values > 0, values / (1.0 + error), values * (1.0 + error))


def _grown(values: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Return the largest values within a relative error."""
    return np.where(values > 0, values * (1.0 + error), values / (1.0 + error))
