"""Life from the Woehler line, its scatter, and the damage sum of a load spectrum.

The line runs through (N_Rm, R_m) and (N_k, sigma_D), straight in logarithms (Wenzel et al. 2022 after
DIN 50100:2016). Stresses in MPa, cycles and probabilities in 1, arrays of any shapes that broadcast.

ASSUME: the peak von Mises stress is taken as the amplitude, without a mean-stress or size correction, and
one overrolling is one cycle, as published.
ASSUME: the line of the database holds for a failure probability of 50 %.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from trackroller.errors import InputError, unknown_name
from trackroller.parameters import LIFE_RULES

CONVENTIONS = {
    "elementary": "Miner elementary: the Woehler line runs on below the fatigue limit (as published)",
    "haibach": "Haibach: slope 2k-1 below the fatigue limit",
    "unlimited": "Miner original: unlimited life below the fatigue limit",
}
AMPLITUDE = "peak von Mises stress taken as amplitude, one cycle an overrolling, 50 % failure probability"
PROBABILITIES = (0.1, 0.5, 0.9)
DECADES = 2.5631031310892007  # standard normal deviates between 10 % and 90 %


def woehler_exponent(
    tensile_strength: ArrayLike, fatigue_limit: ArrayLike, n_rm: ArrayLike, n_k: ArrayLike
) -> np.ndarray:
    """Exponent of the Woehler line, k = ln(N_k/N_Rm) / ln(R_m/sigma_D).

    Parameters
    ----------
    tensile_strength, fatigue_limit : R_m > sigma_D > 0 [MPa]
    n_rm, n_k : cycles at R_m and at sigma_D, 0 < N_Rm < N_k [1]

    Returns
    -------
    k [1], > 0, of the broadcast shape. Raises `InputError` where the two points do not make a falling line.
    """
    strength, limit = np.asarray(tensile_strength, dtype=float), np.asarray(fatigue_limit, dtype=float)
    first, knee = np.asarray(n_rm, dtype=float), np.asarray(n_k, dtype=float)
    if not np.all((limit > 0) & (strength > limit) & (first > 0) & (knee > first)):
        given = "R_m, sigma_D, N_Rm, N_k"
        allowed = "it must fall: R_m > sigma_D > 0 and N_k > N_Rm > 0"
        raise InputError("Woehler line", given, allowed, "Correct the material.")
    return np.log(knee / first) / np.log(strength / limit)


def scatter_ranges(
    exponent: ArrayLike, scatter_cycles: float | None = None, scatter_stress: float | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Scatter of life and strength, the one that is missing from the other: T_N = T_S^k.

    Parameters
    ----------
    exponent : k of the Woehler line [1]
    scatter_cycles : T_N = N_90/N_10 >= 1 [1], indices are failure probabilities in percent
    scatter_stress : T_S = S_90/S_10 >= 1 [1]; neither given: no scatter

    Returns
    -------
    (T_N, T_S), each of the shape of `exponent`. Raises `InputError` for a value below 1.
    """
    k = np.asarray(exponent, dtype=float)
    for name, value in (("scatter_in_cycles", scatter_cycles), ("scatter_in_stress", scatter_stress)):
        if value is not None and not value >= 1:
            allowed = "the scatter is the larger over the smaller value, >= 1"
            raise InputError(name, value, allowed, "Give its inverse.")
    if scatter_cycles is None and scatter_stress is None:
        return np.ones_like(k), np.ones_like(k)
    if scatter_cycles is None:
        return np.asarray(scatter_stress, dtype=float) ** k, np.full_like(k, scatter_stress)
    if scatter_stress is None:
        return np.full_like(k, scatter_cycles), np.asarray(scatter_cycles, dtype=float) ** (1.0 / k)
    return np.full_like(k, scatter_cycles), np.full_like(k, scatter_stress)


def line_at_probability(
    fatigue_limit: ArrayLike,
    n_k: ArrayLike,
    exponent: ArrayLike,
    probability: ArrayLike,
    scatter_cycles: float | None = None,
    scatter_stress: float | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Knee (sigma_D, N_k) of the line at another failure probability than 50 %; the exponent stays.

    Log-normal scatter (DIN 50100:2016): lg N shifts by u lg(T_N)/2.563 and lg sigma_D by u lg(T_S)/2.563 with
    the standard normal deviate u of the probability.

    Parameters
    ----------
    fatigue_limit, n_k, exponent : knee [MPa], [1] and exponent [1] of the 50 % line
    probability : failure probability between 0 and 1 [1]
    scatter_cycles, scatter_stress : see `scatter_ranges`

    Returns
    -------
    (sigma_D [MPa], N_k [1]) of the broadcast shape. Raises `InputError` for a probability outside (0, 1).
    """
    from scipy.special import ndtri

    p = np.asarray(probability, dtype=float)
    if not np.all((p > 0) & (p < 1)):
        raise InputError(
            "failure_probability",
            np.ravel(p)[0] if p.size == 1 else p.tolist(),
            "it must lie between 0 and 1",
            "Give 0.1 for 10 %.",
        )
    t_n, t_s = scatter_ranges(exponent, scatter_cycles, scatter_stress)
    deviate = ndtri(p) / DECADES
    fall = t_s**deviate
    # the line moves along with the strength; what T_N demands beyond that is a shift in cycles
    beyond = t_n**deviate * fall ** -np.asarray(exponent, dtype=float)
    return np.asarray(fatigue_limit) * fall, np.asarray(n_k) * beyond


def _line(
    line: tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike],
    rule: str,
    probability: ArrayLike,
    scatter_cycles: float | None,
    scatter_stress: float | None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Knee (sigma_D, N_k) at the failure probability and exponent k of a line (R_m, sigma_D, N_Rm, N_k)."""
    if rule not in LIFE_RULES:
        raise unknown_name("life_rule", rule, LIFE_RULES)
    k = woehler_exponent(*line)
    limit, knee = np.asarray(line[1], dtype=float), np.asarray(line[3], dtype=float)
    if np.any(np.asarray(probability) != 0.5):
        limit, knee = line_at_probability(limit, knee, k, probability, scatter_cycles, scatter_stress)
    return limit, knee, k


def life_cycles(
    stress: ArrayLike,
    tensile_strength: ArrayLike,
    fatigue_limit: ArrayLike,
    n_rm: ArrayLike,
    n_k: ArrayLike,
    rule: str = "elementary",
    *,
    failure_probability: ArrayLike = 0.5,
    scatter_cycles: float | None = None,
    scatter_stress: float | None = None,
) -> np.ndarray:
    """Cycles to failure, N = N_k (sigma/sigma_D)^-k above the fatigue limit.

    Parameters
    ----------
    stress : amplitude [MPa]
    tensile_strength, fatigue_limit : R_m and sigma_D [MPa]
    n_rm, n_k : cycles at R_m and at sigma_D [1]
    rule : below sigma_D 'elementary' runs the line on, 'haibach' takes 2k-1, 'unlimited' gives inf
    failure_probability : of the line, needs one of the scatter ranges to differ from 50 %
    scatter_cycles, scatter_stress : see `scatter_ranges`

    Returns
    -------
    cycles [1] of the broadcast shape; inf for no stress, NaN for NaN or a negative stress. Above R_m the line
    is run on to fewer than N_Rm cycles: no fatigue life in earnest, the `static` validity bit warns.

    Raises `InputError` for an unknown rule or a line that does not fall.
    """
    line = (tensile_strength, fatigue_limit, n_rm, n_k)
    limit, knee, k = _line(line, rule, failure_probability, scatter_cycles, scatter_stress)
    sigma = np.asarray(stress, dtype=float)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        ratio = np.where(sigma >= 0, sigma, np.nan) / limit
        exponent = np.where(ratio < 1, 2 * k - 1, k) if rule == "haibach" else k
        cycles = knee * ratio**-exponent
    return np.where(ratio < 1, np.inf, cycles) if rule == "unlimited" else cycles


def allowable_stress(
    cycles: ArrayLike,
    tensile_strength: ArrayLike,
    fatigue_limit: ArrayLike,
    n_rm: ArrayLike,
    n_k: ArrayLike,
    rule: str = "elementary",
    *,
    failure_probability: ArrayLike = 0.5,
    scatter_cycles: float | None = None,
    scatter_stress: float | None = None,
) -> np.ndarray:
    """Stress amplitude [MPa] that is borne for so many cycles: the inverse of `life_cycles`.

    Parameters as there. With the rule 'unlimited' it stays at sigma_D beyond the knee. NaN for cycles <= 0.
    """
    line = (tensile_strength, fatigue_limit, n_rm, n_k)
    limit, knee, k = _line(line, rule, failure_probability, scatter_cycles, scatter_stress)
    n = np.asarray(cycles, dtype=float)
    ratio = np.where(n > 0, n, np.nan) / knee
    exponent = np.where(ratio > 1, 2 * k - 1, k) if rule == "haibach" else k
    factor = ratio ** (-1.0 / exponent)
    return limit * (np.where(ratio > 1, 1.0, factor) if rule == "unlimited" else factor)


def roller_hours(cycles: ArrayLike, velocity: ArrayLike, rolling_radius: ArrayLike) -> np.ndarray:
    """Hours until the roller has made so many revolutions, one overrolling each.

    Parameters
    ----------
    cycles : overrollings [1]
    velocity : v > 0 [m/min]
    rolling_radius : r_A > 0 [mm]

    Returns
    -------
    cycles 2 pi r_A / v in hours.
    """
    revolutions_per_hour = np.asarray(velocity) * 60e3 / (2 * np.pi * np.asarray(rolling_radius))
    return np.asarray(cycles, dtype=float) / revolutions_per_hour


def guide_hours(cycles: ArrayLike, overrollings_per_hour: ArrayLike) -> np.ndarray:
    """Hours until a point of the guide has been overrolled so often.

    Parameters
    ----------
    cycles : overrollings [1]
    overrollings_per_hour : of the guide point, > 0 [1/h], known from the track; NaN where it is not

    Returns
    -------
    hours, NaN where the overrollings per hour are not known.
    """
    return np.asarray(cycles, dtype=float) / np.asarray(overrollings_per_hour, dtype=float)


def block_damage(applied: ArrayLike, bearable: ArrayLike) -> np.ndarray:
    """Damage n/N of each block of a spectrum (Palmgren-Miner).

    Parameters
    ----------
    applied : cycles n of the block, >= 0 [1]
    bearable : cycles N to failure at its stress [1], inf for none

    Returns
    -------
    damage [1] of the broadcast shape; 0 for a block without cycles whatever its stress, NaN where N is NaN.
    """
    n, life = np.broadcast_arrays(np.asarray(applied, dtype=float), np.asarray(bearable, dtype=float))
    if np.any(n < 0):
        raise InputError("cycles", float(np.nanmin(n)), "a block's cycles must be >= 0")
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(n == 0, 0.0, n / life)


def damage_sum(
    stress: ArrayLike,
    cycles: ArrayLike,
    tensile_strength: ArrayLike,
    fatigue_limit: ArrayLike,
    n_rm: ArrayLike,
    n_k: ArrayLike,
    rule: str = "elementary",
    *,
    axis: int = -1,
) -> np.ndarray:
    """Damage sum D = sum n_i/N_i of a spectrum of stress blocks (Palmgren-Miner).

    Parameters
    ----------
    stress, cycles : amplitude [MPa] and cycles n_i [1] of the blocks along `axis`
    tensile_strength, fatigue_limit, n_rm, n_k, rule : see `life_cycles`; 'unlimited' is Miner original
    axis : axis of the blocks

    Returns
    -------
    D [1], without the axis of the blocks.
    """
    bearable = life_cycles(stress, tensile_strength, fatigue_limit, n_rm, n_k, rule)
    return block_damage(cycles, bearable).sum(axis=axis)


def repetitions_to_failure(damage: ArrayLike, critical_damage: float = 1.0) -> np.ndarray:
    """How often a spectrum (a shift) can be repeated: D_crit / D, inf where it does no damage.

    Parameters
    ----------
    damage : damage sum of one repetition, >= 0 [1]
    critical_damage : D_crit > 0 [1] at which failure is expected; 1 after Miner
    """
    if not critical_damage > 0:
        raise InputError("critical_damage", critical_damage, "it must be > 0", "1 is Miner's own.")
    with np.errstate(divide="ignore"):
        return critical_damage / np.asarray(damage, dtype=float)
