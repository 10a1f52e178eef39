"""The headline of an answer: one template a question, at most 40 words, from the record alone.

What does not fit a template stands in the table. A text that the record holds (`where`, `binds`) is said if it has at
most eight words. Lives are written with their years if `Answer.facts` holds `duty` (hours a day and days a year).

Keys of `Answer.headline`; a key that is missing, None, NaN or empty is left out of the words:

`decide`, by `Answer.kind` (`build`, `a_or_b`, `none`, `measure`, `give`, `solve_finer`, `cannot_tell`)

=================  =====================================================================================================
`names`            list of dict: name of a column of role `name` -> level of the named candidates; only choices that
                   differ between them and the rest; the first one is the leader (of `none` empty)
`low`, `high`      of the leader's required output at its worst condition [unit of `Answer.output`]
`worst`            levels of that condition in words (stands in the table)
`ends`, `ends_high`  limit that ends it, in words that follow "then": "fatigue", "wear"
`body`             `roller`, `guide` or ''
`error`            told error of the leader's output [1]
`extrapolated`     whether the leader's life lies beyond its data
`not_held`         {count, of, where}: conditions that no candidate holds; `where` as "all 12 driven at friction 0.05"
`not_judged`       {count, of, where}: the same for conditions that the model cannot judge
`elsewhere`        whether the leader holds all other conditions, so that the headline says "elsewhere"
`exceeded`         {limit, body, use [1], hours}: the worst check of the leader above 100 %
`second`           {limit, verdict}: second model ("the rating") that turns the leader's verdict; a state of `STATES`
`measure`          {what, of, on, turn, units, low, high}: placeholder, its body, the other one, where the leader turns
`give`             {what}: load that was not given, in words: "the motor force"
`nearest`          {name (as one of `names`), holds, of, meets, low, fails}: `fails` says where it fails, in words
`up_to`, `from_on`  levels of the single numeric choice between which all conditions meet the requirement
`share`, `share_low`, `share_high`  share of the drawn conditions that meets it, Wilson's interval [1]
`wanted`, `n`      share that is wanted [1]; drawn conditions
=================  =====================================================================================================

`how sure`: `share`, `share_low`, `share_high`, `wanted`, `n` of drawn conditions, or `meets`, `of` of listed loads; and
`low`, `high`, `ends`, `ends_high`, `body`, `error`, `extrapolated`, `exceeded`, `second`, `not_held` as above.

`what matters`: `factors`, a list of at most two dicts, the largest first: `title`, `units`, `index`, `index_low`,
`index_high` [1] (NaN without indices), `height` (as a factor), `from`, `to` (levels at the smallest and the largest end
of the curve), `at_from`, `at_to` [unit of the output]; `asked`: the same of a factor that the study asks for.

`which model`: `changes`: ``, `verdict`, `order` or `verdict and order`; `models`: list of dict `model`, `verdict`,
`low`, `high`, `error`, `leader` (a dict as one of `names`); `smallest`, `largest` ratio on like rows, to the model `base`.

`best`, by `Answer.kind` (`one`, `front`, `front_required`): `designs`, a list of dict: `name` (as one of `names`),
`at` (`corner`, `knee` or ''), `goals` (list of {words, units, value}), `stopped` (search stopped before this end);
`binds` (requirement, limit or end of a range in words), `accuracy` (of these numbers), `extrapolated`, `exceeded`, `second`.

`how it behaves`: `smallest`, `largest` [unit of the output], `at_smallest`, `at_largest` (levels in words),
`ends` (list of {limit, body, count}), `of` (cases), `lost` (cases without the output), `ends_low`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from trackroller.errors import listing
from trackroller.report.numbers import capital, hour_unit, level_text, number, on_duty, percent, unit_text
from trackroller.results.answer import Answer, Caution, Column, Required
from trackroller.study.design.levels import NAMED

MOST_WORDS = 40
MOST_CHOICES = 3  # of a candidate that a headline names; the others stand in the table
SHORT = 8  # words of a text from the record that a headline repeats


@dataclass(frozen=True)
class Headline:
    """A headline: the answer itself, and what follows it."""

    lead: str
    rest: str = ""

    @property
    def text(self) -> str:
        """Return the whole headline."""
        return self.lead + self.rest


def headline_of(answer: Answer) -> Headline:
    """Return the headline of an answer.

    Parameters
    ----------
    answer : Answer
        The record; the keys of its `headline` stand at the top of this module.

    Raises
    ------
    KeyError
        If this room has no template for the question or the kind of the answer.
    """
    with on_duty(answer.facts.get("duty")):
        return TEMPLATES[answer.question](answer)
