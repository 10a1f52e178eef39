"""The lives of a study: their columns and words, and where the S-N data end."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from trackroller.damage import LIMITS
from trackroller.parameters import BODIES
from trackroller.roller.requirement import LIVES_OF_PAIR

# limits that end nothing: second models of an end that another limit has, and those that are not
# checked
BESIDE = tuple(name for name, limit in LIMITS.items() if limit.beside or limit.use is None)
# second models that may turn a verdict
RIVALS = tuple(name for name, limit in LIMITS.items() if limit.rivals or limit.use is None)
# limits that know the end of another one by other tests
EVIDENCE = tuple(name for name, limit in LIMITS.items() if limit.evidence_of)

LIVES = (
    ("pair_life_hours", "life of the pair", "h"),
    ("roller_life_hours", "life of the roller", "h"),
    ("guide_life_hours", "life of the guide", "h"),
    ("life_cycles_roller", "life of the roller", "overrollings"),
    ("life_cycles_guide", "life of the guide", "overrollings"),
)
FIRST_LIMIT = ("pair_life_to_first_limit_hours", "life to the first limit", "h")
OF_PAIR = LIVES_OF_PAIR
DATA_END = 1e8  # overrollings; no S-N curve of the database was measured beyond


def past_data(cycles: ArrayLike, knee: ArrayLike = np.inf) -> np.ndarray:
    """Return where lives [overrollings] exceed those at the fatigue limit, `knee`, or the end of
    the S-N data.
    """
    return np.asarray(np.asarray(cycles) > np.minimum(knee, DATA_END))


def lacks_a_body(hours: np.ndarray, limits: list[str], name: str) -> np.ndarray:
    """Return the cases in which a second model lacks the life of a body whose fatigue is known,
    shape (n,) bool.

    Parameters
    ----------
    hours : hours until each limit of each body, shape (n, limit, 2); NaN where it is not known
    limits : names of the limits
    name : the second model
    """
    if "fatigue" not in limits:
        return np.zeros(len(hours), dtype=bool)
    concerned = np.array([body in LIMITS[name].bodies for body in BODIES])
    by_fatigue = ~np.isnan(hours[:, limits.index("fatigue")])
    return np.asarray((by_fatigue & concerned & np.isnan(hours[:, limits.index(name)])).any(axis=1))


def body_lives(goal: str) -> dict[str, str]:
    """Return the columns of the lives of roller and guide that belong to the life of a pair."""
    name = "{}_life_hours"
    if goal == FIRST_LIMIT[0]:
        name = "life_to_first_limit_hours_{}"
    return {body: name.format(body) for body in BODIES}
