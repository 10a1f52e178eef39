"""The one picture of the first screen, by the arrays that an answer holds: front, history,
distribution or ratios.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from trackroller.report.pictures.distribution import draw_distribution
from trackroller.report.pictures.front import draw_front
from trackroller.report.pictures.history import draw_history
from trackroller.report.pictures.like import draw_like
from trackroller.report.pictures.picture import Picture
from trackroller.results.answer import Answer


def picture_of(answer: Answer) -> Picture | None:
    """Return the picture of the first screen of an answer, None if its table or its curves are the
    picture.
    """
    for name, draw in DRAWINGS.items():
        if answer.picture.get(name) is not None:
            return draw(answer, answer.picture)
    return None


def _goals(answer: Answer, data: Mapping[str, Any]) -> Picture | None:
    """Draw a search: the front of two goals, or the best value of one goal so far."""
    if len(data["words"]) == 1:
        return draw_history(answer, data)
    return draw_front(answer, data)


DRAWINGS: dict[str, Callable[[Answer, Mapping[str, Any]], Picture | None]] = {
    "goals": _goals,
    "values": draw_distribution,
    "points": draw_like,
}
