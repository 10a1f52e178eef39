"""The verdict: how far each limit is used, when it is reached, and which limit comes first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trackroller.damage.limit import Limit, Results, SolvedRollers, variables
from trackroller.damage.pair import first_failure
from trackroller.numerics.parameter import Parameter
from trackroller.numerics.variable import BODIES, LIFE

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
    ("utilisation", _LB, "1", "", "load over the load at which the limit is reached", {"label": "utilisation"}),
    ("life_hours_by_limit", _LB, "h", "", "hours to the limit at the failure probability", LIFE | {"label": "life"}),
    (
        "life_to_first_limit_hours",
        ("body",),
        "h",
        "",
        "hours to the first limit that is known",
        LIFE | {"label": "life to the first limit"},
    ),
    (
        "pair_life_to_first_limit_hours",
        (),
        "h",
        "",
        "hours to the first limit of roller or guide that is known",
        LIFE | {"label": "life to the first limit"},
    ),
)


def until_reached(
    used: np.ndarray, life: np.ndarray, timed: np.ndarray, limits: Sequence[Limit], broken: np.ndarray | None = None
) -> np.ndarray:
    """Return when limits are reached, (..., limit, body), in the unit of `life`; NaN where it is not known.

    Parameters
    ----------
    used, life : numpy.ndarray
        Utilisation [1] and life in hours or shifts, (..., limit, body), NaN where they are not known.
    timed : numpy.ndarray of bool
        Whether a limit has a life, (limit,). A limit without a life is reached at once or never.
    limits : sequence of Limit
        The limits, some of which a utilisation of 1 ends at once although they have a life.
    broken : numpy.ndarray of bool, optional
        Where a body breaks at once, so that a limit is reached without a life, (..., limit, body).
    """
    at_once = ~timed | np.array([limit.ends_at_once for limit in limits], dtype=bool)
    never = np.where(np.isnan(used), np.nan, np.inf)
    now = (used >= 1.0) & at_once[:, None]
    return np.where(now if broken is None else now | broken, 0.0, np.where(timed[:, None], life, never))


def reached_by_breaking(breaks: np.ndarray, limits: Sequence[Limit]) -> np.ndarray:
    """Return which limits are reached at once because a body breaks, (..., limit, body).

    A body that is loaded above its tensile strength has no life by the S-N curve: fatigue counts as reached at once.

    Parameters
    ----------
    breaks : numpy.ndarray of bool
        Where a body is loaded above its tensile strength, (..., body).
    limits : sequence of Limit
        The limits.
    """
    of_fatigue = np.array([limit.name == "fatigue" for limit in limits], dtype=bool)
    return np.asarray(breaks[..., None, :] & of_fatigue[:, None])


def first_of(
    reached: np.ndarray, used: np.ndarray, limits: Sequence[Limit], broken: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return when the first limit is reached, and which one it is.

    Parameters
    ----------
    reached : numpy.ndarray
        When each limit is reached, in hours or shifts, (n, limit, body); NaN where it is not known.
    used : numpy.ndarray
        Utilisation, (n, limit, body) [1], which ranks limits that are reached together.
    limits : sequence of Limit
        The limits; a body that a limit does not concern does not lack it.
    broken : numpy.ndarray of bool, optional
        Limits that are reached because the body breaks at once, (n, limit, body). Its strength comes first.

    Returns
    -------
    tuple of numpy.ndarray
        The first one, (n, body), NaN where no known limit is ever reached and another one is not known; and the place
        of its limit, (n, body), -1 where no limit is known.
    """
    known, concerned = ~np.isnan(reached), np.array([[body in limit.bodies for body in BODIES] for limit in limits])
    first = np.min(np.where(known, reached, np.inf), axis=1)
    rank = np.where(known & (reached == first[:, None, :]), np.nan_to_num(used, nan=0.0), -1.0)
    rank = rank if broken is None else np.where(broken & (rank >= 0.0), -0.5, rank)
    missing = (~known & concerned).any(axis=1)
    place = np.where(known.any(axis=1), np.argmax(rank, axis=1), -1)
    return np.where(np.isinf(first) & missing, np.nan, first), place


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
    A limit that has no time counts as reached at once where its utilisation is at least 1, and otherwise never. Fatigue
    counts as reached at once where a body is loaded above its tensile strength. A limit that lacks a value is left out.
    """
    shape = len(solved.rolling_radius), len(limits), 2
    used, hours, broken = np.full(shape, np.nan), np.full(shape, np.nan), np.zeros(shape, dtype=bool)
    timed = np.zeros(len(limits), dtype=bool)
    for i, limit in enumerate(limits):
        assert limit.verdict is not None
        own = limit.verdict(solved, dict(solved.values))
        timed[i] = own.life_hours is not None
        for values, given in ((used, own.utilisation), (hours, own.life_hours)):
            if given is not None:
                values[:, i] = np.where([body in limit.bodies for body in BODIES], given, np.nan)
        if own.at_once is not None:
            broken[:, i] = own.at_once
    lives, first = first_of(until_reached(used, hours, timed, limits, broken), used, limits, broken)
    return {
        "utilisation": used,
        "life_hours_by_limit": hours,
        "life_to_first_limit_hours": lives,
        "pair_life_to_first_limit_hours": first_failure(*lives.T)[0],
        "limiting_mechanism": np.array([*numbers, unknown])[first],  # the place -1 is that of the last one
    }
