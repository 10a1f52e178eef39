"""Judge the rollers of a sizing: what each reaches of what is required, and by whose value a
verdict is open.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.parameters import BODIES
from trackroller.results.answer import Required
from trackroller.results.candidate_table import states_of
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.comparison import Comparison
from trackroller.results.results import Results
from trackroller.results.turning_values import Turning
from trackroller.roller.limit_notes import lacks_of
from trackroller.roller.output_names import is_life
from trackroller.study.file.shelf import ROLLER
from trackroller.study.outputs import flat

VERDICTS = ("enough", "open", "not enough")
# limits that a sizing asks for by a permitted value: the field of a case by the argument of `size`
PERMITTED = {
    "temperature": "permissible_temperature",
    "wear_depth": "permissible_wear_depth",
}
LIMIT_OF = {"temperature": "heat", "wear_depth": "wear"}
RATIO = {"temperature": "temperature_ratio", "wear_depth": "wear_ratio"}


@dataclass(frozen=True, eq=False)
class RollerVerdicts:
    """What each roller of a shelf reaches in a solved study.

    Attributes
    ----------
    results : Results
        The study, with the rollers as levels of its factor `roller`.
    permitted : tuple of str
        Those of `PERMITTED` that are required.
    """

    results: Results
    permitted: tuple[str, ...] = ()

    @cached_property
    def rows(self) -> pd.DataFrame:
        """Return the table of the answer by roller."""
        answer = self.results.answer
        assert answer is not None
        rows = answer.table
        levels = self.results.study.parsed[ROLLER].levels
        if ROLLER not in rows:
            rows = rows.assign(**{ROLLER: levels[0]})
        return rows.set_index(ROLLER).reindex(levels)

    @cached_property
    def own(self) -> Comparison:
        """Return the comparison of the rollers, whose candidates have the numbers of `rows`."""
        own = Comparison.of(self.results)
        assert own is not None
        return own

    @cached_property
    def turning(self) -> Turning:
        """Return what a placeholder does to the life of a roller."""
        return Turning(self.own)

    @cached_property
    def exact_states(self) -> list[str]:
        """Return the states of the candidates without the errors of the solution."""
        table = self.rows.sort_values("number").reset_index(drop=True)
        return states_of(self.own, table, exact=True)

    def table(self) -> pd.DataFrame:
        """Return the verdict of each roller, what excludes it, and its ratio to each requirement,
        by roller.
        """
        rows = self.rows
        columns: dict[str, list[str]] = {"verdict": [], "excluded_by": []}
        for name in rows.index:
            verdict, why = self._verdict(name)
            columns["verdict"].append(verdict)
            columns["excluded_by"].append(why)
        table = pd.DataFrame(columns, rows.index)
        for one, ranges in self.own.judges:
            if ranges is self.own.ranges and is_life(ranges.output[0]):
                table["life_hours"] = rows["low"]
                table["life_ratio"] = rows["low"] / one.least
                table["ends"] = rows["ends"]
            else:
                worst = np.array([self._worst(ranges, name) for name in rows.index])
                table[one.output] = worst
                table[f"{one.output}_ratio"] = _ratio(worst, one)
        for name in self.permitted:
            table[RATIO[name]] = self._permitted_ratios(name)
        second = [self._turned_by(name) for name in rows.index]
        if any(second):
            table["second_model"] = second
        return table

    def _turned_by(self, name: str) -> str:
        """Return the second model of an end, such as a catalogue, that turns the verdict of a
        roller, with its life; '' where none does.
        """
        row = self._row(name)
        if row["second_state"] in ("", row["state"]):
            return ""
        verbs = {"met": "meets", "open": "leaves open", "missed": "misses"}
        verb = verbs[row["second_state"]]
        return f"{row['second']} {verb} the life: {row['second_low']:.3g} h"

    def holding(self) -> list[tuple[str, str]]:
        """Return whether each roller holds all of its conditions: the verdict, and what is exceeded
        or leaves it open; 'held' where it is enough.
        """
        return [self._holding(name) for name in self.rows.index]

    def _row(self, name: str) -> dict[str, Any]:
        """Return the row of a roller in the table of the answer."""
        return self.rows.loc[name].to_dict()  # type: ignore[return-value]

    def _holding(self, name: str) -> tuple[str, str]:
        row = self._row(name)
        if row["exceeded"]:  # by a second model too, such as a catalogue
            return VERDICTS[2], str(row["exceeded"])
        if row["holds"] < row["of"]:
            if row["judged"] == row["of"]:
                return VERDICTS[2], self._reasons(name)
            return VERDICTS[1], self._reasons(name)
        limit = self.turning.of_open_limit(int(row["number"]))
        if limit is not None:
            return VERDICTS[1], f"{limit['what']} of {limit['of']}{_range_of(limit)} decides"
        return VERDICTS[0], "held"

    def _verdict(self, name: str) -> tuple[str, str]:
        """Return the verdict on a roller, and what excludes it or leaves it open."""
        row = self._row(name)
        if self.own.drawn and np.isfinite(self.own.wanted_share):
            return self._by_share(name)
        verdict, reason = self._holding(name)
        if verdict == VERDICTS[2]:
            return verdict, reason
        misses = [self._missed(name, *judge) for judge in self.own.judges]
        text = "; ".join(filter(None, misses))
        if text:
            return VERDICTS[2], text
        lacking = [self._lacking(name, one) for one in self.permitted]
        if verdict == VERDICTS[1]:
            lacking.insert(0, reason)
        text = "; ".join(filter(None, lacking))
        if text:
            return VERDICTS[1], f"open: {text}"
        if row["state"] == "open":
            return VERDICTS[1], f"open: {self._open(name)}"
        return VERDICTS[0], ""

    def _by_share(self, name: str) -> tuple[str, str]:
        """Return the verdict on a roller of which a share of drawn conditions has to be enough."""
        row = self._row(name)
        words = {"met": VERDICTS[0], "open": VERDICTS[1]}
        verdict = words.get(str(row["state"]), VERDICTS[2])
        if verdict == VERDICTS[0]:
            return verdict, ""
        share = f"{100 * row['share']:.3g} % of the conditions are enough"
        if verdict == VERDICTS[1]:
            return verdict, f"open: {share}"
        return verdict, share

    def _cases(self, name: str) -> np.ndarray:
        """Return the numbers of the cases of a roller."""
        return self.own.rows[int(self._row(name)["number"])]

    def _reasons(self, name: str) -> str:
        """Return why conditions of a roller are not held or not judged, and how many."""
        reasons = self.own.ranges.reason[self._cases(name)]
        text = ", ".join(dict.fromkeys(str(one) for one in reasons if one))
        row = self._row(name)
        if row["holds"] == 0:
            return text
        return f"{text} in {row['of'] - row['holds']} of {row['of']} conditions"

    def _missed(self, name: str, one: Required, ranges: CaseRanges) -> str:
        """Return how a roller surely misses a requirement; '' if it does not."""
        cases = self._cases(name)
        may = ranges.meets(one)[1]
        if may[cases].all():
            return ""
        worst = self._worst(ranges, name)
        if ranges is self.own.ranges and is_life(ranges.output[0]):
            row = self._row(name)
            return f"life: {row['ends']} after {row['low']:.4g} h"
        return f"{one.words}: {worst:.4g} {one.units}"

    def _worst(self, ranges: CaseRanges, name: str) -> float:
        """Return an output of a roller at its worst condition; NaN if it is not known."""
        values = ranges.sign * ranges.worse[self._cases(name)]
        if np.isnan(values).all():
            return float("nan")
        return float(ranges.sign * np.nanmin(values))

    def _open(self, name: str) -> str:
        """Return by whose value the verdict on a roller is open."""
        row = self._row(name)
        number = int(row["number"])
        if not is_life(self.own.ranges.output[0]):
            return "its range decides"
        if self.exact_states[number] != "open":
            error = 100.0 * row["error"]
            ends = f"{row['ends']} after {row['low']:.4g} h"
            return f"{ends}, with a told error of {error:.0f} %: a finer accuracy decides"
        span = f"{row['ends']} between {row['low']:.4g} and {row['high']:.4g} h"
        value = self.turning.decides(number, self._least_life)
        if value is None:
            return span
        return f"{span}: {value['what']} of {value['of']}{_range_of(value)} decides"

    @cached_property
    def _least_life(self) -> float:
        """Return the required life [h]; NaN without one."""
        lives = [one.least for one, _ in self.own.judges if is_life(one.output)]
        return max(lives, default=float("nan"))

    def _lacking(self, name: str, quantity: str) -> str:
        """Return what is missing so that a permitted value can be judged for a roller; '' if
        nothing is.
        """
        data = self.results.data
        cases = self._cases(name)
        if is_permitted_known(data, quantity, self.results.dims)[cases].all():
            return ""
        materials = {str(own[cases[0]]) for own in self.turning.materials.values()}
        return lacks_in_words(data, quantity, materials)

    def _permitted_ratios(self, quantity: str) -> list[float]:
        """Return the permitted temperature rise over the rise of each roller at its worst
        condition, or its life to the wear depth over the required one [1].
        """
        values = permitted_ratios(self.results.data, quantity, self._least_life, self.results.dims)
        ratios = []
        for name in self.rows.index:
            known = values[self._cases(name)]
            ratio = float("nan")
            if np.isfinite(known).any():
                ratio = float(np.nanmin(known))
            if ratio >= 1.0 and self._lacking(name, quantity):
                ratio = float("nan")  # what is not known may be less
            ratios.append(ratio)
        return ratios


def permitted_ratios(
    data: xr.Dataset, quantity: str, life: float, dims: tuple[str, ...] = ()
) -> np.ndarray:
    """Return the permitted value over the value of solved cases, (n, body) [1].

    Parameters
    ----------
    data : xarray.Dataset
        Results with `utilisation` and `life_hours_by_limit_low`.
    quantity : str
        One of `PERMITTED`: `temperature` compares temperature rises, `wear_depth` the low end of
        the life to this depth with the required one.
    life : float
        Required life [h].
    dims : tuple of str
        Dimensions of the cases.
    """
    if quantity == "wear_depth":
        return of_limit(data, "life_hours_by_limit_low", LIMIT_OF[quantity], dims) / life
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / of_limit(data, "utilisation", LIMIT_OF[quantity], dims))


def _range_of(value: dict[str, Any]) -> str:
    """Return the range of a placeholder in words; '' without one."""
    low = value.get("low", float("nan"))
    high = value.get("high", float("nan"))
    if not (isinstance(low, float) and isinstance(high, float) and np.isfinite([low, high]).all()):
        return ""
    units = str(value["units"]).strip(" -")
    return f" ({low:g} to {high:g} {units})".replace(" )", ")")


def _ratio(worst: np.ndarray, one: Required) -> np.ndarray:
    """Return how many times an output meets a requirement [1], below 1 if it misses it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        above = np.where(np.isfinite(one.least), worst / one.least, np.inf)
        below = np.where(np.isfinite(one.most), one.most / worst, np.inf)
    return np.asarray(np.minimum(above, below))


def of_limit(data: xr.Dataset, name: str, limit: str, dims: tuple[str, ...]) -> np.ndarray:
    """Return a result by limit of one limit, (n, body); NaN if the limit is not there."""
    if name not in data or limit not in data["limit"].values:
        size = int(np.prod([data.sizes[dim] for dim in dims]))
        return np.full((size, len(BODIES)), np.nan)
    values: np.ndarray = flat(data.sel(limit=limit), name, dims)
    return np.asarray(values, dtype=float).reshape(-1, len(BODIES))


def is_permitted_known(data: xr.Dataset, quantity: str, dims: tuple[str, ...] = ()) -> np.ndarray:
    """Return in which cases a permitted value is compared, (n,) bool: of the roller, and of the
    guide where any case knows it, because its overrollings may not be given.
    """
    name = "utilisation"
    if quantity == "wear_depth":
        name = "life_hours_by_limit"
    known = ~np.isnan(of_limit(data, name, LIMIT_OF[quantity], dims))
    counts = [True, bool(known[:, 1].any())]
    return np.asarray(known[:, counts].all(axis=1))


def lacks_in_words(data: xr.Dataset, quantity: str, materials: Iterable[str]) -> str:
    """Return why a permitted value is not compared: what its limit lacks of the case and of some
    materials.
    """
    own = [one for one in lacks_of(data) if one.limit == LIMIT_OF[quantity]]
    known = [one.words for one in own if not one.material or one.material in materials]
    words = ", ".join(known) or "its limit is not checked"
    return f"the {quantity.replace('_', ' ')} is not known: {words}"
