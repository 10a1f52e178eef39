"""How surely a requirement is met: the answer to a study of one candidate, or to one that asks for
shares.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.results.answer import Answer
from trackroller.results.candidate_table import candidate_columns, candidate_table, names_of
from trackroller.results.comparison import Comparison
from trackroller.results.decide import Decider, leading, not_held_by_any, with_ratios
from trackroller.results.effect_curves import Effects
from trackroller.results.ends_by_factor import ends_by_factor
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.study_facts import (
    cautions,
    checks_left_out,
    facts_of,
    given_for_nothing,
    not_given_words,
)


def answer_how_sure(results: SolvedCases) -> Answer:
    """Return how surely the candidates of a study meet its requirement.

    Parameters
    ----------
    results : SolvedCases
        A solved study with a life, a stress or a requirement.

    Notes
    -----
    `kind` is `share` for drawn conditions, `count` for listed ones, and `cannot_tell` where no case
    can be judged. Of several candidates the one with the largest share stands first.
    """
    own = Comparison.of(results)
    assert own is not None
    table = candidate_table(own)
    order = _order(own, table)
    shown = with_ratios(own, table.iloc[order].reset_index(drop=True))
    one = shown.iloc[0]
    names = []
    if own.count > 1:
        names = names_of(own, order[:1])
    head: dict[str, Any] = {"names": names, **leading(own, one)}
    if not own.drawn:
        head |= {name: int(one[name]) for name in ("meets", "judged", "of")}
    kind = "count"
    if own.drawn:
        kind = "share"
    if not own.ranges.judged[own.own].any():
        kind = "cannot_tell"
        head |= {"why": "model"}
    return Answer(
        question="how sure",
        kind=kind,
        headline=head | not_held_by_any(own),
        output=own.ranges.output,
        table=shown,
        columns=candidate_columns(own, shown),
        required=own.required,
        curves=Effects.of(own.ranges).curves(),
        ends=ends_by_factor(results, own.ranges),
        picture={
            "values": _values(own, order, own.ranges.middle),
            "low": _values(own, order, own.ranges.low),
            "high": _values(own, order, own.ranges.high),
        },
        not_checked=checks_left_out(results),
        not_used=given_for_nothing(results) | own.idle,
        not_given=not_given_words(results),
        warnings=cautions(own, shown),
        facts=facts_of(results, own),
    )


def _order(own: Comparison, table: Any) -> list[int]:
    """Return the candidates by the share or the number of conditions that meet the requirement, the
    largest first.
    """
    decider = Decider(own, table)
    if own.drawn:
        share = table["share"]
    else:
        share = table["meets"] / table["of"]
    return [int(n) for n in np.lexsort((-decider.score, -share.to_numpy(dtype=float)))]


def _values(own: Comparison, order: list[int], values: np.ndarray) -> list[np.ndarray]:
    """Return some values of the conditions of each candidate, in rising order; a condition that is
    not held has the worst value.

    Parameters
    ----------
    values : of the cases, shape (n,)
    """
    counted = np.where(own.ranges.holds, values, own.ranges.worst_value)
    return [np.sort(counted[own.rows[n]]) for n in order]
