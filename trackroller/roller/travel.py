"""Put the worn profiles into cases that ask for a travel; cases that differ in travel alone share one march."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace
from functools import lru_cache

import numpy as np

from trackroller.roller.case_table import CaseTable
from trackroller.roller.options import Options
from trackroller.roller.reflection import handed
from trackroller.roller.wearing import ENDS, Groove, Wearing, between

KEPT = 64  # marches that a process keeps


class _Case:
    """One case of a table with its options, equal to cases that differ in travel alone."""

    def __init__(self, table: CaseTable, options: Options) -> None:
        self.table = table
        self.options = options
        columns = {f.name: getattr(table, f.name) for f in fields(table) if f.name not in ("travel", "roller", "guide")}
        bodies = [vars(body) for body in (table.roller, table.guide)]
        texts = [repr(values[0]) for part in (columns, *bodies) for values in part.values()]
        self.key = repr(options), *texts

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Case) and self.key == other.key


class _Course:
    """The states of one march, which goes on when a longer travel is asked for."""

    def __init__(self, case: _Case) -> None:
        self.wearing = Wearing(case.table, case.options)
        self._march: Iterator = self.wearing.march()
        self._states: list[Groove] = []
        self._end = ""

    def at(self, travel: float) -> tuple[Groove, str]:
        """Return the state at a travel [km], and why the march ends before it."""
        while not self._end and (not self._states or self._states[-1].travel < travel):
            step = next(self._march, None)
            if step is None:  # nothing wears
                return replace(self.wearing.start, travel=travel), ""
            state, results, _, self._end = step
            if not self.wearing.end(results):
                state = self.wearing.turned(state, results)
            self._states.append(state)
        later = next((i for i, state in enumerate(self._states) if state.travel >= travel), None)
        if later is None:
            return self._states[-1], self._end
        if later == 0:
            return self._states[0], ""
        return between(self._states[later - 1], self._states[later], travel), ""


@lru_cache(maxsize=KEPT)
def _course(case: _Case) -> _Course:
    return _Course(case)


def with_travel(table: CaseTable, options: Options) -> tuple[CaseTable, dict[int, str]]:
    """Return the cases with the profiles that are worn after their travel, and why some have none, by row.

    Parameters
    ----------
    table : CaseTable
        The n cases.
    options : Options
        Options of the solution.

    Raises
    ------
    InputError
        For Hertzian patches, or bodies without a wear coefficient.
    """
    rows = np.flatnonzero(table.travel > 0.0)
    lost = {}
    if not rows.size:
        return table, {}
    profiles = {name: getattr(table, name).copy() for name in ("guide_profile", "roller_profile")}
    for row in rows.tolist():
        own, mirrored = handed(table.take(np.array([row])))
        course = _course(_Case(own, options))
        state, reason = course.at(float(table.travel[row]))
        if reason:
            lost[row] = f"after {state.travel:.4g} km, before its travel: {ENDS[reason]}"
        elif mirrored[0]:
            state = replace(state, **{n: getattr(state, n)[::-1] for n in ("depth", "closing", "inclined")})
        worn = course.wearing.worn_table(state)
        for name, texts in profiles.items():
            texts[row] = getattr(worn, name)[0]
    return replace(table, **profiles), lost
