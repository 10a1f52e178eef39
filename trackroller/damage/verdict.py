"""The verdict: how far each limit is used, when it is reached, and which limit comes first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trackroller.damage.limit import Limit, Results, SolvedRollers, variables
from trackroller.damage.pair import first_failure
from trackroller.parameters import BODIES, Parameter

GROUP = "limits"
MEANING = "how far each limit asked for is used, hours to each, and the first; alone it asks for all limits"
POSITION = Parameter(
    "placeholder_position",
    "f_P",
    "-",
    0.0,
    "place of all placeholders of materials in their ranges: -1 the worse end, 0 the value, 1 the better end",
    -1.0,
    1.0,
    role="condition",
    label="place of the placeholders of materials in their ranges",
)
_LB = ("limit", "body")
RESULTS = variables(
    GROUP,
    ("utilisation", _LB, "1", "", "load over the load at which the limit is reached"),
    ("life_hours_by_limit", _LB, "h", "", "hours to the limit at the failure probability"),
    ("life_to_first_limit_hours", ("body",), "h", "", "hours to the first limit that is known"),
    ("pair_life_to_first_limit_hours", (), "h", "", "hours to the first limit of roller or guide that is known"),
)


def hours_until_reached(used: np.ndarray, hours: np.ndarray, timed: np.ndarray, at_once: np.ndarray) -> np.ndarray:
    """Return the hours until limits are reached [h]; NaN where they are not known. The arrays broadcast.

    Parameters
    ----------
    used, hours : numpy.ndarray
        Utilisation [1] and life [h], NaN where they are not known.
    timed, at_once : numpy.ndarray of bool
        Whether a limit has a life, and whether a utilisation of 1 ends the life at once although it has one. A limit
        without a life is reached at once or never.
    """
    never = np.where(np.isnan(used), np.nan, np.inf)
    return np.where((used >= 1.0) & (at_once | ~timed), 0.0, np.where(timed, hours, never))


def first_of(reached: np.ndarray, used: np.ndarray, concerned: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return when the first limit is reached, and which one it is.

    Parameters
    ----------
    reached : numpy.ndarray
        When each limit is reached, in hours or shifts, (n, limit, body); NaN where it is not known.
    used : numpy.ndarray
        Utilisation, (n, limit, body) [1], which ranks limits that are reached together.
    concerned : numpy.ndarray of bool
        Bodies that a limit concerns, (limit, body).

    Returns
    -------
    tuple of numpy.ndarray
        The first one, (n, body), NaN where no known limit is ever reached and another one is not known; and the place
        of its limit, (n, body).
    """
    known = ~np.isnan(reached)
    first = np.min(np.where(known, reached, np.inf), axis=1)
    rank = np.where(known & (reached == first[:, None, :]), np.nan_to_num(used, nan=0.0), -1.0)
    missing = (~known & concerned).any(axis=1)
    return np.where(np.isinf(first) & missing, np.nan, first), np.argmax(rank, axis=1)


def verdict(solved: SolvedRollers, limits: Sequence[Limit], numbers: Sequence[int], unknown: int) -> Results:
    """Return utilisation and hours of each limit, the hours to the first limit, and its number.

    Parameters
    ----------
    solved : SolvedRollers
        Cases with the results that the limits need, and with the results of the limits themselves.
    limits : sequence of Limit
        The limits that count.
    numbers : sequence of int
        Number of each limit in the flags of `limiting_mechanism`.
    unknown : int
        Number for bodies of which no limit is known.

    Returns
    -------
    dict of str to numpy.ndarray
        `utilisation` [1], `life_hours_by_limit` [h], (n, limit, body); `life_to_first_limit_hours` [h] and
        `limiting_mechanism`, (n, body); `pair_life_to_first_limit_hours` [h], (n,).

    Notes
    -----
    A limit that has no time counts as reached at once where its utilisation is at least 1, and otherwise never. A limit
    that lacks a value is left out.
    """
    n = len(solved.rolling_radius)
    used, hours, reached = (np.full((n, len(limits), 2), np.nan) for _ in range(3))
    concerned = np.array([[body in limit.bodies for body in BODIES] for limit in limits]).reshape(-1, 2)
    for i, limit in enumerate(limits):
        assert limit.verdict is not None
        own = limit.verdict(solved, dict(solved.values))
        if own.utilisation is not None:
            used[:, i] = own.utilisation
        if own.life_hours is not None:
            hours[:, i] = own.life_hours
        timed, at_once = np.array(own.life_hours is not None), np.array(limit.ends_at_once)
        reached[:, i] = hours_until_reached(used[:, i], hours[:, i], timed, at_once)
    for values in (used, hours, reached):
        values[:, ~concerned] = np.nan
    lives, first = first_of(reached, used, concerned)
    known = ~np.isnan(reached).all(axis=1)
    which = np.asarray(numbers, dtype=int)[first]
    return {
        "utilisation": used,
        "life_hours_by_limit": hours,
        "life_to_first_limit_hours": lives,
        "pair_life_to_first_limit_hours": first_failure(*lives.T)[0],
        "limiting_mechanism": np.where(known, which, unknown),
    }
