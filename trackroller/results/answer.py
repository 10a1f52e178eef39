"""The answer to a study: one flat record of numbers and names.

The record holds numbers and names, no sentences. `Results.answer` returns it, and `to_dict` states
its keys.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from trackroller.study.file.questions import QUESTIONS as QUESTIONS

# of the keys of `Answer.to_dict`; a key that is new or renamed, or that changes its meaning,
# raises it
VERSION = 3
WARNINGS = {  # code -> what it means
    "not_held": "cases that skid, lift off, break, or exceed a limit",
    "not_judged": "cases that the model cannot judge",
    "second_model": "a second model of the same end changes the verdict",
    "extrapolated": "lives or wear beyond the data that their rule was made from",
    "worn": "results of the new groove beyond its run-in",
    "not_given": "values that nobody gave",
    "at_end": "the named design stands at the end of a range, or the search stopped before it",
    "unlike": "loads, scatter or samples differ between the candidates",
    "guessed": "values of materials that nobody has measured",
    "doubtful": "values that are unusual, or that tests contradict",
    "flagged": "an assumption of the model or an accuracy is not kept",
}
# of a candidate; a limit has those of `trackroller.damage.first_limit.STATES`
STATES = ("met", "open", "missed", "none")


def yes_or_blank(true: bool) -> str:
    """Return the cell of a column that marks some rows: 'yes', or '' where it does not hold."""
    if true:
        return "yes"
    return ""


@dataclass(frozen=True)
class Column:
    """A column of the table of an answer.

    Attributes
    ----------
    name : its key in `Answer.table`
    title : its head
    units : unit of its numbers; '' for texts and plain numbers
    meaning : its definition in one sentence
    kind : `level` of a factor, `number`, `count`, `share` [1], `ratio`, `error` [1], `state`,
        `text`, `whole` for a number that is said with four figures, `life` for hours of which a
        very long life is said as a bound, `years`, or `bounded` for a value of a permitted one, in
        the unit that the column `units` states
    until : column with the upper end of the same range, or with the permitted value; '' without one
    role : `name` for the choices that name a row, `bar` for those that the picture of a decision
        draws (`low`, `median` and `best`), `use` for the share of a limit that is used, `file` for
        one that stands in files alone; otherwise an empty text
    """

    name: str
    title: str
    units: str = ""
    meaning: str = ""
    kind: str = "number"
    until: str = ""
    role: str = ""


@dataclass(frozen=True)
class Caution:
    """A warning as data.

    Attributes
    ----------
    code : one of `WARNINGS`
    count, of : rows concerned, of all
    where : the levels that hold these rows, or the values concerned
    what : what is counted: `cases`, `candidates`, `blocks`, `rollers`; '' for one roller, where
        nothing is counted
    """

    code: str
    count: int
    of: int
    where: str
    what: str = "cases"


@dataclass(frozen=True)
class Curve:
    """The effect of one factor on the output of an answer.

    Attributes
    ----------
    factor, title, units : the factor with its words and unit
    role : `choice`, `condition` or ''
    levels : values of the factor, shape (k,)
    middle, low, high : of the output at each level, and the tenth and the ninetieth hundredth of
        the cases, shape (k,) each [unit of the output]
    logarithmic : whether the levels stand on a logarithmic axis
    ordered : whether the levels have an order
    height : largest over smallest middle [1]; of an output that is not above 0 everywhere largest
        less smallest [unit of the output]
    shape : `rise`, `fall`, `hump`, `dip`, `cliff`, `groups` or `flat`
    rows : cases that it rests on
    left_out : valid cases that lack a partner at some level
    by_ratio : whether `height` is a ratio; otherwise it is a difference
    by : what it is made of: `like cases` that are there at all levels, a `fit`, `changes` between
        cases that differ in this factor alone, or `drawn cases` at each level, which differ in all
        factors
    """

    factor: str
    title: str
    units: str
    role: str
    levels: tuple[Any, ...]
    middle: np.ndarray
    low: np.ndarray
    high: np.ndarray
    logarithmic: bool
    ordered: bool
    height: float
    shape: str
    rows: int
    left_out: int = 0
    by_ratio: bool = True
    by: str = "like cases"


@dataclass(frozen=True)
class Required:
    """What is wanted of one output.

    Attributes
    ----------
    output : name of the output
    words, units : of the output
    least, most : smallest and largest value that is enough [unit of the output]; infinite without
        one
    probability : share of the conditions that have to meet it [1]; NaN without one
    years : the same life in years, where the study file says so; NaN otherwise
    """

    output: str
    words: str
    units: str
    least: float = -math.inf
    most: float = math.inf
    probability: float = math.nan
    years: float = math.nan


@dataclass(frozen=True, eq=False)
class FurtherTable:
    """A further table of an answer, such as the forces of both contacts or the blocks of a
    spectrum.

    Attributes
    ----------
    name, title : its key in files, and its head on a page
    table : its rows
    columns : the columns of `table` in their order
    note : what holds for all of it, in one or two sentences
    """

    name: str
    title: str
    table: pd.DataFrame
    columns: tuple[Column, ...]
    note: str = ""


@dataclass(frozen=True, eq=False)
class Answer:
    """The answer to a study.

    Attributes
    ----------
    question : one of `QUESTIONS`, `roller` for one roller, `spectrum`, `carriage` or `wear`
    kind : the answer in one word. Of a decision: `build`, `a_or_b`, `none`, `measure`, `give`,
        `solve_finer` or `cannot_tell`. Every module of a question states its own
    headline : the numbers and names of the headline
    output : name, words and unit of what the table compares
    table : one row a candidate, factor, model or output; the first row is the one that the headline
        names
    columns : the columns of `table` in their order
    required : what is wanted
    curves : effects, the largest first
    ends : counts of cases by what ends them (columns) at each level of a factor (columns `factor`
        and `level`)
    outputs : range of each usual output over the cases that are held, see
        `trackroller.results.output_ranges`
    parts : further tables
    picture : arrays of the picture of the first screen that `table` and `curves` do not hold
    not_checked : limits that were not checked for each body
    not_used : values that were given and changed nothing
    not_given : values that nobody gave, with their units in words
    warnings : see `Caution`
    facts : title line: `name`, `description`, `date`, `cases`, `candidates`, `conditions`, `drawn`,
        `models`, `accuracy`, `duty`, `strokes` (those that the duty was given in), `counted` (what
        `cases` counts); of one roller `probability`, `regime`, `converged` and `reason` as well
    """

    question: str
    kind: str
    headline: Mapping[str, Any]
    output: tuple[str, str, str]
    table: pd.DataFrame
    columns: tuple[Column, ...]
    required: tuple[Required, ...] = ()
    curves: tuple[Curve, ...] = ()
    ends: pd.DataFrame = field(default_factory=pd.DataFrame)
    outputs: pd.DataFrame = field(default_factory=pd.DataFrame)
    parts: tuple[FurtherTable, ...] = ()
    picture: Mapping[str, Any] = field(default_factory=dict)
    not_checked: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    not_used: Mapping[str, str] = field(default_factory=dict)
    not_given: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[Caution, ...] = ()
    facts: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def shared(self) -> dict[str, Any]:
        """Return the columns that have one value in all of several rows, with this value."""
        if len(self.table) < 2:
            return {}
        same = {}
        for column in self.columns:
            ends = [name for name in (column.name, column.until) if name]
            if not column.role and all(
                self.table[name].nunique(dropna=False) == 1 for name in ends
            ):
                same[column.name] = self.table[column.name].iloc[0]
        return same

    def to_dict(self) -> dict[str, Any]:
        """Return the record as plain numbers, texts, lists and dictionaries, as JSON holds them.

        Infinite and undefined numbers are the texts `inf`, `-inf` and None.
        """
        named = {
            "version": VERSION,
            "question": self.question,
            "kind": self.kind,
            "headline": self.headline,
            "output": dict(zip(("name", "words", "units"), self.output, strict=True)),
            "columns": [vars(column) for column in self.columns],
            "rows": self.table.to_dict("records"),
            "required": [vars(one) for one in self.required],
            "effects": [vars(curve) for curve in self.curves],
            "ends": self.ends.to_dict("records"),
            "outputs": self.outputs.to_dict("records"),
            "parts": {part.name: _part(part) for part in self.parts},
            "not_checked": self.not_checked,
            "not_used": self.not_used,
            "not_given": self.not_given,
            "warnings": [vars(caution) for caution in self.warnings],
            "facts": self.facts,
        }
        plain: dict[str, Any] = plain_value(named)
        return plain


def _part(part: FurtherTable) -> dict[str, Any]:
    """Return a further table as plain values."""
    columns = [vars(column) for column in part.columns]
    return {
        "title": part.title,
        "columns": columns,
        "rows": part.table.to_dict("records"),
        "note": part.note,
    }


def plain_value(value: Any) -> Any:
    """Return a value as JSON holds it: arrays as lists, NaN as None, infinity as a text."""
    if isinstance(value, Mapping):
        return {str(key): plain_value(one) for key, one in value.items()}
    if isinstance(value, np.ndarray):
        return plain_value(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain_value(one) for one in value]
    if isinstance(value, np.generic):
        return plain_value(value.item())
    if isinstance(value, float) and math.isnan(value):
        return None
    if isinstance(value, float) and math.isinf(value):
        return str(value)
    if isinstance(value, (str, int, float, bool)) or value is None:
        return value
    return str(value)
