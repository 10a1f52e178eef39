"""Sum a load spectrum by limit: Miner's sum where a limit has a life, the largest utilisation where it has none.

ASSUME: damage by each limit adds up linearly; a limit without a life is reached by the worst block alone.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS, miner
from trackroller.damage.pair import first_failure
from trackroller.damage.verdict import first_of, hours_until_reached
from trackroller.parameters import BODIES
from trackroller.roller.case import Case
from trackroller.study.spectrum.file import Spectrum

Variables = dict[str, Any]


def cases_of(spectrum: Spectrum, overrollings: np.ndarray) -> list[Case]:
    """Return the cases of the blocks, with the overrollings of the guide per hour of travel.

    Parameters
    ----------
    spectrum : Spectrum
        The load spectrum.
    overrollings : numpy.ndarray
        Overrollings per shift, (block, body) [1].
    """
    made = []
    for block, own in zip(spectrum.blocks, overrollings, strict=True):
        known = block.guide_overrollings and block.hours > 0
        more = {"guide_overrollings_per_hour": float(own[1]) / block.hours} if known else {}
        made.append(replace(block.case, **more))
    return made


def by_limit(spectrum: Spectrum, solved: xr.Dataset, fatigue: np.ndarray) -> Variables:
    """Return damage, utilisation and shifts of each limit, and the first limit of each body.

    Parameters
    ----------
    spectrum : Spectrum
        The load spectrum.
    solved : xarray.Dataset
        Its solved blocks with the group `limits`.
    fatigue : numpy.ndarray
        Damage of each track by the S-N curve per shift, (block, contact, body) [1].

    Returns
    -------
    dict of str to tuple
        Variables of a data set. A block of no distance does not count. Fatigue adds up track by track; of the other
        limits the worse contact of each block counts.
    """
    limits = [LIMITS[name] for name in solved["limit"].values.tolist()]
    used, hours = (
        solved[name].transpose("case", "limit", "body").values for name in ("utilisation", "life_hours_by_limit")
    )
    travel = np.array([block.hours for block in spectrum.blocks])[:, None, None]
    damage = miner.block_damage(travel, hours)
    worst = np.argmax(np.nan_to_num(fatigue.sum(axis=0), nan=np.inf), axis=0)
    for i in (i for i, limit in enumerate(limits) if limit.name == "fatigue"):
        damage[:, i] = np.take_along_axis(fatigue, worst[None, None], axis=1)[:, 0]
    most = np.max(np.where(travel > 0, used, 0.0), axis=0)
    # D_crit belongs to Miner's rule of the S-N curve; other limits are reached at a sum of 1
    critical = np.array([spectrum.critical_damage if limit.name == "fatigue" else 1.0 for limit in limits])[:, None]
    shifts = critical * miner.repetitions_to_failure(damage.sum(axis=0))
    timed = solved["life_hours_by_limit"].notnull().any(["case", "body"]).values[:, None]
    at_once = np.array([limit.ends_at_once for limit in limits])[:, None]
    concerned = np.array([[body in limit.bodies for body in BODIES] for limit in limits])
    reached = np.where(concerned, hours_until_reached(most, shifts, timed, at_once), np.nan)
    first, which = (found[0] for found in first_of(reached[None], most[None], concerned))
    words = (*LIMITS, "unknown")
    numbers = np.array([words.index(limit.name) for limit in limits])
    names = np.where(np.isnan(reached).all(axis=0), len(words) - 1, numbers[which])
    flag = {"long_name": "limit that the body reaches first", "flag_meanings": " ".join(words)}
    return {
        "damage_by_limit": (("block", "limit", "body"), damage, _attrs("damage of the block per shift by a limit")),
        "damage_sum_by_limit": (("limit", "body"), damage.sum(axis=0), _attrs("damage per shift by a limit")),
        "utilisation": (("limit", "body"), most, _attrs("largest utilisation of a limit in a block")),
        "life_shifts_by_limit": (("limit", "body"), shifts, _attrs("shifts until a limit with a life is reached")),
        "life_to_first_limit_shifts": ("body", first, _attrs("shifts until the first known limit is reached")),
        "pair_life_to_first_limit_shifts": (
            (),
            float(first_failure(*first)[0]),
            _attrs("shifts until roller or guide reaches its first known limit"),
        ),
        "limiting_mechanism": ("body", names.astype(np.int8), flag),
    }


def _attrs(long_name: str) -> dict[str, str]:
    return {"units": "1", "long_name": long_name, "symbol": ""}
