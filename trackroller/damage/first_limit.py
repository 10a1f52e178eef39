"""The first limit: how far each limit is used, when it is reached, and which limit comes first."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from trackroller.damage.limit import Limit, LimitUse, SolvedRollers, Values, variables
from trackroller.damage.pair import first_failure
from trackroller.numerics.parameter import Parameter
from trackroller.numerics.variable import BODIES, LIFE

GROUP = "limits"
MEANING = (
    "how far each limit is used whose inputs are given, hours to each with their range, and "
    "the first one"
)
POSITION = Parameter(
    "placeholder_position",
    "f_P",
    "-",
    math.nan,
    "place of all placeholders of materials in their ranges: -1 the worse end, 0 the value, "
    "1 the better end; if it is "
    "not given, lives have the range between the ends",
    -1.0,
    1.0,
    allow_missing=True,
    role="condition",
    label="place of the placeholders of materials in their ranges",
)
ENDS = ("", "_low", "_high")  # a life, and the ends of its range
STATES = ("unknown", "kept", "open", "exceeded")
_LB = ("limit", "body")
# bounds of utilisations whose numbers were not computed, see the option `at_most`
AT_MOST = "utilisation_at_most"
_FIRST = "hours to the first limit that is known"


def _life(
    name: str, dims: tuple[str, ...], meaning: str, label: str, of: str = ""
) -> tuple[tuple[str, Any, str, str, str, Any], ...]:
    """Return the rows of a life and of the ends of its range."""
    ends = (
        ("", "", ""),
        ("_low", "low end of the ", ", low end"),
        ("_high", "high end of the ", ", high end"),
    )
    fields = LIFE | {"of": of}
    return tuple(
        (
            name + end,
            dims,
            "h",
            "",
            head + meaning,
            fields | {"end": end[1:], "label": label + tail},
        )
        for end, head, tail in ends
    )


RESULTS = variables(
    GROUP,
    (
        "utilisation",
        _LB,
        "1",
        "",
        "load over the load at which the limit is reached",
        {"label": "utilisation"},
    ),
    (
        AT_MOST,
        _LB,
        "1",
        "",
        "bound of the utilisation of a limit that is kept, in place of the number",
        {"label": "utilisation, at most", "estimate": True},
    ),
    *_life("life_hours_by_limit", _LB, "hours to the limit at the failure probability", "life"),
    *_life("life_to_first_limit_hours", ("body",), _FIRST, "life to the first limit"),
    *_life(
        "pair_life_to_first_limit_hours",
        (),
        f"{_FIRST}, of roller or guide",
        "life to the first limit",
        "pair",
    ),
)


def breaking(breaks: np.ndarray, limits: Sequence[Limit]) -> np.ndarray:
    """Return the limits that a body reaches at once because it breaks, (..., limit, body) bool.

    It is the static limit; without it fatigue counts, because a body above its tensile strength has
    no life by the S-N curve.

    Parameters
    ----------
    breaks : numpy.ndarray
        Whether a body is loaded above its tensile strength, (..., body) bool.
    limits : sequence of Limit
        The limits.
    """
    names = [limit.name for limit in limits]
    own = "static" if "static" in names else "fatigue"
    return np.asarray(breaks[..., None, :] & np.array([name == own for name in names])[:, None])


def with_evidence(life: np.ndarray, limits: Sequence[Limit], end: str) -> np.ndarray:
    """Return lives whose range reaches to the lives by other tests of the same end.

    Parameters
    ----------
    life : numpy.ndarray
        When each limit is reached at one of `ENDS`, (..., limit, body); NaN where it is not known.
    limits : sequence of Limit
        The limits; `Limit.evidence_of` names the one that a limit has other tests of.
    end : str
        One of `ENDS`. The value itself stays that of the limit.

    Returns
    -------
    numpy.ndarray
        At the low end the shorter, at the high end the longer one of both lives, of the same
        shape. A life that is not known stays so.

    Examples
    --------
    >>> from trackroller.damage import LIMITS
    >>> both = [LIMITS["fatigue"], LIMITS["pressure_line"]]
    >>> hours = np.array([[100.0, 100.0], [7e3, np.nan]])
    >>> [with_evidence(hours, both, end)[0].tolist() for end in ENDS]
    [[100.0, 100.0], [100.0, 100.0], [7000.0, 100.0]]
    """
    names = [limit.name for limit in limits]
    out = np.array(life, dtype=float)
    for place, limit in enumerate(limits):
        if not end or limit.evidence_of not in names:
            continue
        ended = names.index(limit.evidence_of)
        own = out[..., ended, :]
        if end == "_low":
            reached = np.fmin(own, life[..., place, :])
        else:
            reached = np.fmax(own, life[..., place, :])
        out[..., ended, :] = np.where(np.isnan(own), np.nan, reached)
    return out


def first_of(
    life: np.ndarray,
    used: np.ndarray,
    ends: np.ndarray,
    limits: Sequence[Limit],
    broken: np.ndarray,
    lacking: np.ndarray | None = None,
    end: str = "",
) -> tuple[np.ndarray, np.ndarray]:
    """Return when the first limit is reached, and which one it is.

    Parameters
    ----------
    life : numpy.ndarray
        When each limit is reached, in hours or shifts, (n, limit, body); NaN where it is not known.
    used : numpy.ndarray
        Utilisation, (n, limit, body) [1], which ranks limits that are reached together.
    ends : numpy.ndarray of bool
        Whether a limit has a life, (limit,). Limits that have none, and limits beside others, end
        nothing.
    limits : sequence of Limit
        The limits; a body that a limit does not concern does not lack it.
    broken : numpy.ndarray of bool
        Limits that a body reaches at once because it breaks, (n, limit, body), see `breaking`.
    lacking : numpy.ndarray of bool, optional
        Where a limit is not checked because a value is not given, (n, limit, body).
    end : str
        The one of `ENDS` to which the lives belong, see `with_evidence`.

    Returns
    -------
    tuple of numpy.ndarray
        The first one, (n, body), NaN where no limit is known, or where no known limit is ever
        reached and another one that is checked is not known; and the place of its limit, (n, body),
        -1 where no limit is known.
    """
    counted = (ends & ~np.array([limit.beside for limit in limits], dtype=bool))[:, None]
    concerned = counted & [[body in limit.bodies for body in BODIES] for limit in limits]
    life = with_evidence(life, limits, end)
    life, known = np.where(broken, 0.0, life), (counted & ~np.isnan(life)) | broken
    first = np.min(np.where(known, life, np.inf), axis=1)
    rank = np.where(known & (life == first[:, None, :]), np.nan_to_num(used, nan=0.0), -1.0)
    if lacking is None:
        unknown = concerned & ~known
    else:
        unknown = concerned & ~known & ~lacking
    some = known.any(axis=1)
    never = np.isinf(first) & unknown.any(axis=1)
    return np.where(never | ~some, np.nan, first), np.where(some, np.argmax(rank, axis=1), -1)


def states(
    used: np.ndarray,
    life: np.ndarray,
    broken: np.ndarray,
    limits: Sequence[Limit],
    bounded: np.ndarray | None = None,
) -> np.ndarray:
    """Return the state of each limit as its place in `STATES`, (n, limit, body).

    Parameters
    ----------
    used : numpy.ndarray
        Utilisation at the values of materials and at both ends of their placeholders, (place, n,
        limit, body) [1].
    life, broken : numpy.ndarray
        Life [h], and whether the body breaks at once, (n, limit, body).
    limits : sequence of Limit
        The limits; one that is not bounded is kept as long as the body does not break.
    bounded : numpy.ndarray of bool, optional
        Where a bound shows that a limit is kept, (n, limit, body); the utilisation is NaN there.

    Notes
    -----
    A limit is exceeded if its utilisation is above 1 wherever the placeholders lie in their ranges,
    and open if it is above 1 at one end only.
    """
    has_bound = np.array([limit.bounded for limit in limits], dtype=bool)[:, None]
    least, most = used.min(axis=0), used.max(axis=0)
    unknown = np.isnan(used[0]) & np.isnan(life)
    if bounded is not None:
        unknown = unknown & ~bounded
    state = np.where(unknown, STATES.index("unknown"), STATES.index("kept"))
    state = np.where(has_bound & (most > 1.0), STATES.index("open"), state)
    return np.where((has_bound & (least > 1.0)) | broken, STATES.index("exceeded"), state)


def _ends(own: LimitUse) -> np.ndarray:
    """Return the life of a limit and the ends of its range, (end, n, body), which is the life
    itself where the limit gives none.
    """
    low = own.life_low
    high = own.life_high
    if low is None:
        low = own.life_hours
    if high is None:
        high = own.life_hours
    return np.array([own.life_hours, low, high])


def _lacking(solved: SolvedRollers, limits: Sequence[Limit]) -> np.ndarray:
    """Return where a limit lacks a value, (n, limit, body) bool."""
    out = np.zeros((len(solved.rolling_radius), len(limits), len(BODIES)), dtype=bool)
    for i, limit in enumerate(limits):
        out[:, i] = limit.lacking(solved)
    return out


def _bound(solved: SolvedRollers, limit: Limit) -> np.ndarray:
    """Return the bound of the utilisation that stands in place of the number, (n, body) [1]; NaN
    where the number counts.
    """
    bounded = limit.kept_by_bound(solved)
    if limit.bound is None or not bounded.any():
        return np.full(bounded.shape, np.nan)
    return np.where(bounded, limit.bound(solved), np.nan)


def limit_uses(
    places: Sequence[SolvedRollers],
    limits: Sequence[Limit],
    numbers: Sequence[int],
    unknown: int,
    served: np.ndarray | None = None,
) -> Values:
    """Return how far each limit is used, hours to each and to the first, their ranges, and which
    one is first.

    Parameters
    ----------
    places : sequence of SolvedRollers
        Cases with the results of the solver and of the limits: at the values of the materials, and
        if some of these are placeholders with a range, at their worse and at their better ends.
    limits : sequence of Limit
        The limits that count.
    numbers : sequence of int
        Number of each limit in the flags of `limiting_mechanism`.
    unknown : int
        Number for bodies of which no limit is known.
    served : numpy.ndarray of bool, optional
        Which limits count for a case, (n, limit), by default all. Of the others nothing is known.

    Returns
    -------
    dict of str to numpy.ndarray
        `utilisation` [1], `utilisation_at_most` [1], `life_hours_by_limit` [h] and `limit_state`,
        (n, limit, body);
        `life_to_first_limit_hours` [h] and `limiting_mechanism`, (n, body);
        `pair_life_to_first_limit_hours` [h], (n,). Each life also has the ends of its range, with
        `_low` and `_high` in its name.

    Notes
    -----
    A limit without hours ends no life; `limit_state` says whether it is exceeded. A body that is
    loaded above its tensile strength breaks at once. The ends of the life to the first limit count
    other tests of the same end, see `with_evidence`.
    """
    shape = len(places), len(places[0].rolling_radius), len(limits), len(BODIES)
    used = np.full(shape, np.nan)
    at_most = np.full(shape[1:], np.nan)
    broken = np.zeros(shape[1:], dtype=bool)
    if served is None:
        served = np.ones(shape[1:3], dtype=bool)
    lives = np.full((len(ENDS), *shape), np.nan)
    timed = np.zeros(len(limits), dtype=bool)
    lacking = _lacking(places[0], limits)
    for i, limit in enumerate(limits):
        assert limit.use is not None
        if not served[:, i].any():
            continue
        counts = served[:, i, None]
        concerned = counts & [body in limit.bodies for body in BODIES]
        at_most[:, i] = np.where(counts, _bound(places[0], limit), np.nan)
        for place, solved in enumerate(places):
            own = limit.use(solved, dict(solved.values))
            if own.utilisation is not None:
                used[place, :, i] = np.where(concerned, own.utilisation, np.nan)
            if own.life_hours is not None:
                timed[i] = True
                lives[:, place, :, i] = np.where(concerned, _ends(own), np.nan)
            if own.at_once is not None:
                broken[:, i] = own.at_once & counts
    used = np.where(np.isnan(at_most), used, np.nan)
    at_once = breaking(np.asarray(broken.any(axis=1)), limits)
    out: Values = {
        "utilisation": used[0],
        AT_MOST: at_most,
        "limit_state": states(used, lives[0, 0], at_once, limits, ~np.isnan(at_most)),
    }
    # the worse and the better place are the last but one and the last one; without placeholders
    # there is one place
    at = (0, min(1, len(places) - 1), len(places) - 1)
    for place_of_end, (end, place) in enumerate(zip(ENDS, at, strict=True)):
        life = lives[place_of_end, place]
        first, which = first_of(life, used[0], timed, limits, at_once, lacking, end)
        out |= {f"life_hours_by_limit{end}": life, f"life_to_first_limit_hours{end}": first}
        out[f"pair_life_to_first_limit_hours{end}"] = first_failure(*first.T)[0]
        if not end:
            # the place -1 is that of the last one
            out["limiting_mechanism"] = np.array([*numbers, unknown])[which]
    return out
