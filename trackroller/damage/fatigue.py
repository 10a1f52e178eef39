"""Hours of life, and the damage sum of a load spectrum; the S-N curve stands in `trackroller.damage.sn_curve`."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from trackroller.errors import InputError


def roller_hours(cycles: ArrayLike, velocity: ArrayLike, rolling_radius: ArrayLike) -> np.ndarray:
    """Return the hours until the roller has made as many revolutions as cycles.

    Parameters
    ----------
    cycles : array_like
        Overrollings [1], one in each revolution.
    velocity : array_like
        v > 0 [m/min].
    rolling_radius : array_like
        r_A > 0 [mm].

    Returns
    -------
    numpy.ndarray
        cycles 2 pi r_A / v [h].
    """
    revolutions_per_hour = np.asarray(velocity) * 60e3 / (2 * np.pi * np.asarray(rolling_radius))
    return np.asarray(cycles, dtype=float) / revolutions_per_hour


def guide_hours(cycles: ArrayLike, overrollings_per_hour: ArrayLike) -> np.ndarray:
    """Return the hours until a point of the guide has been overrolled as often as cycles say.

    Parameters
    ----------
    cycles : array_like
        Overrollings [1].
    overrollings_per_hour : array_like
        Overrollings of the guide point, > 0 [1/h]; NaN where they are not known.

    Returns
    -------
    numpy.ndarray
        Hours [h]; NaN where the overrollings per hour are not known.
    """
    return np.asarray(cycles, dtype=float) / np.asarray(overrollings_per_hour, dtype=float)


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
        Damage [1] of the broadcast shape; 0 for a block without cycles whatever its stress, NaN where N is NaN.

    Raises
    ------
    InputError
        If a block has a negative number of cycles.
    """
    n, life = np.broadcast_arrays(np.asarray(applied, dtype=float), np.asarray(bearable, dtype=float))
    if np.any(n < 0):
        raise InputError("cycles", float(np.nanmin(n)), "a block's cycles must be >= 0")
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
        raise InputError("critical_damage", critical_damage, "it must be > 0", "1 is Miner's own.")
    with np.errstate(divide="ignore"):
        return critical_damage / np.asarray(damage, dtype=float)
