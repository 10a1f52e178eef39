"""Sum the damage of a load spectrum (Palmgren-Miner)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from trackroller.errors import InputError


def block_damage(applied: ArrayLike, bearable: ArrayLike) -> np.ndarray:
    """Return the damage n/N of each block of a spectrum (Palmgren-Miner).

    Parameters
    ----------
    applied : array_like
        Cycles n >= 0 of the block [1].
    bearable : array_like
        Cycles N to failure at the stress of the block [1]; inf for no failure.

    Returns
    -------
    numpy.ndarray
        Damage [1] of the broadcast shape; 0 for a block without cycles whatever its stress, NaN
        where N is NaN.

    Raises
    ------
    InputError
        If a block has a negative number of cycles.
    """
    n, life = np.broadcast_arrays(
        np.asarray(applied, dtype=float), np.asarray(bearable, dtype=float)
    )
    if np.any(n < 0):
        raise InputError("cycles", float(np.nanmin(n)), "cycles of a block >= 0")
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(n == 0, 0.0, n / life)


def repetitions_to_failure(damage: ArrayLike, critical_damage: float = 1.0) -> np.ndarray:
    """Return how often a spectrum can be repeated until failure, D_crit / D.

    Parameters
    ----------
    damage : array_like
        Damage sum of one repetition, >= 0 [1].
    critical_damage : float
        D_crit > 0 [1], at which failure is expected; 1 after Miner.

    Returns
    -------
    numpy.ndarray
        Repetitions [1]; inf where the spectrum does no damage.

    Raises
    ------
    InputError
        If the critical damage is not positive.
    """
    if not critical_damage > 0:
        raise InputError("critical_damage", critical_damage, "a number > 0", "1 is Miner's own.")
    with np.errstate(divide="ignore"):
        return critical_damage / np.asarray(damage, dtype=float)
