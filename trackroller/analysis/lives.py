"""The lives of a study: columns and words, the body that fails first, and what lies beyond the S-N data."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from trackroller.damage.pair import first_failure
from trackroller.parameters import BODIES, FIRST_TO_FAIL

if TYPE_CHECKING:
    from trackroller.analysis.table import StudyView

LIVES = (
    ("pair_life_hours", "life of the pair", "h"),
    ("roller_life_hours", "life of the roller", "h"),
    ("guide_life_hours", "life of the guide", "h"),
    ("life_cycles_roller", "life of the roller", "overrollings"),
    ("life_cycles_guide", "life of the guide", "overrollings"),
)
FIRST_LIMIT = ("pair_life_to_first_limit_hours", "life to the first limit", "h")
DATA_END = 1e8  # overrollings; no S-N curve of the database was measured beyond


def past_data(cycles: ArrayLike, knee: ArrayLike = np.inf) -> np.ndarray:
    """Return where lives [overrollings] exceed those at the fatigue limit, `knee`, or the end of the S-N data."""
    return np.asarray(np.asarray(cycles) > np.minimum(knee, DATA_END))


def body_lives(goal: str) -> dict[str, str]:
    """Return the columns of the lives of roller and guide that belong to the life of a pair."""
    name = "life_to_first_limit_hours_{}" if goal == FIRST_LIMIT[0] else "{}_life_hours"
    return {body: name.format(body) for body in BODIES}


def first_failing(view: StudyView, goal: str) -> np.ndarray:
    """Return the number in `FIRST_TO_FAIL` of the body that fails first in every case, shape (n,)."""
    if goal != FIRST_LIMIT[0]:
        return view.column("first_to_fail", FIRST_TO_FAIL.index("unknown"))
    return first_failure(*(view.column(name) for name in body_lives(goal).values()))[1]


def beyond_data(view: StudyView, column: str) -> np.ndarray:
    """Mark the cases in which a life lies beyond the S-N data, shape (n,); see `StudyView.beyond_data`."""
    if "life" not in column or "wear" in column:
        return np.zeros(len(view.table), dtype=bool)
    if not any(body in column for body in BODIES):
        guide = first_failing(view, column) == FIRST_TO_FAIL.index("guide")
        own = body_lives(column)
        return np.where(guide, *(beyond_data(view, own[body]) for body in ("guide", "roller")))
    body = "guide" if "guide" in column else "roller"
    if "first_limit" in column:
        fatigue = view.column(f"limiting_mechanism_{body}") == view.limits.index("fatigue")
        rate = view.column(f"life_cycles_{body}") / view.column(f"{body}_life_hours")  # overrollings an hour
        return np.asarray((fatigue & beyond_data(view, f"{body}_life_hours")) | past_data(view.column(column) * rate))
    names = pd.Series(view.material(body))
    stored = json.loads(str(view.attrs.get("materials", "{}")))
    knees = {n: float(stored.get(n, {}).get("cycles_at_fatigue_limit", np.inf)) for n in names.unique()}
    endless = np.isposinf(view.column(f"{body}_life_hours"))
    return past_data(view.column(f"life_cycles_{body}"), names.map(knees).to_numpy(dtype=float)) | endless
