"""Judge over all load cases of a roller whether its groove wears away within the life, flag `worn`.

ASSUME: wear adds up linearly over the load cases: each uses up its travel over the run-in distance under it alone.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import xarray as xr

from trackroller.damage.miner import block_damage, repetitions_to_failure
from trackroller.roller.case import Case
from trackroller.roller.dataset import validity_bit

RUN_IN = "run_in_distance"
FLAG = "worn"


def groups_for_run_in(cases: Iterable[Case]) -> tuple[str, ...]:
    """Return the group of outputs that holds the run-in distance if the wear of a case is a limit, otherwise none."""
    return ("wear",) if any(case.permissible_wear_depth is not None for case in cases) else ()


def with_run_in(solved: xr.Dataset, roller: np.ndarray, travel: np.ndarray, life: np.ndarray) -> xr.Dataset:
    """Return solved load cases whose flag `worn` holds for the life of the roller over all of them.

    Parameters
    ----------
    solved : xarray.Dataset
        Results along `case`; without the run-in distance they are returned as they are.
    roller : numpy.ndarray of int
        Number of the roller of each case, from 0, (n,).
    travel : numpy.ndarray
        Travel in each case in one repetition of the load cases of its roller [km], (n,).
    life : numpy.ndarray
        Repetitions to the first limit of each roller and its guide, (rollers, 2) [1].

    Notes
    -----
    A load case whose wear is not known counts as one without wear, so that the flag is set only where it is sure.
    """
    if RUN_IN not in solved:
        return solved
    used = np.nan_to_num(block_damage(travel, solved[RUN_IN].values))
    run_in = repetitions_to_failure(np.bincount(roller, used, minlength=len(life)))
    worn = life > run_in[:, None]
    bit = validity_bit(FLAG)
    by_case = xr.DataArray(worn[roller], dims=("case", "body"))
    bodies = solved["validity_body"]
    pair = solved["validity"]
    return solved.assign(
        validity_body=(bodies & ~bit | xr.where(by_case, bit, 0)).astype(bodies.dtype).assign_attrs(bodies.attrs),
        validity=(pair & ~bit | xr.where(by_case.any("body"), bit, 0)).astype(pair.dtype).assign_attrs(pair.attrs),
    )
