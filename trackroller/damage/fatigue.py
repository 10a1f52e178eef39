"""The S-N curve (Wöhler line): cycles to failure for a stress, its scatter and its inverse, and hours of life.

The curve is straight in logarithms through (N_Rm, R_m) and the knee (N_k, sigma_D) (Wenzel et al. 2022 after
DIN 50100:2016). Stresses are in MPa, cycles and probabilities in 1; arrays may have any shapes that broadcast.

ASSUME: the peak von Mises stress is the amplitude, without a correction for mean stress or size, and one overrolling is
one cycle, as published.
ASSUME: the curve of the database holds for a failure probability of 50 %.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtri

from trackroller.errors import InputError, check_names
from trackroller.materials.sn_curve import curve_exponent
from trackroller.parameters import LIFE_RULES

CONVENTIONS = {
    "elementary": "Miner elementary: the S-N curve runs on below the fatigue limit (as published)",
    "haibach": "Haibach: slope 2k-1 below the fatigue limit",
    "unlimited": "Miner original: unlimited life below the fatigue limit",
}
AMPLITUDE = "peak von Mises stress taken as amplitude, one cycle an overrolling, 50 % failure probability"
PROBABILITIES = (0.1, 0.5, 0.9)
DECADES = 2.5631031310892007  # standard normal deviates between 10 % and 90 %


class SNCurve(NamedTuple):
    """S-N curve at a failure probability of 50 %, by its two points.

    Parameters
    ----------
    tensile_strength, fatigue_limit : array_like
        R_m > sigma_D > 0 [MPa].
    n_rm, n_k : array_like
        Cycles at R_m and at sigma_D, 0 < N_Rm < N_k [1].
    """

    tensile_strength: Any
    fatigue_limit: Any
    n_rm: Any
    n_k: Any


def curve_of(material: Any) -> SNCurve:
    """Return the S-N curve of a material.

    Parameters
    ----------
    material : Material, MaterialArrays or mapping
        One material, the columns of n materials, or the values of a material by name.

    Returns
    -------
    SNCurve
        Values of the shape that the material has.
    """
    known = material if isinstance(material, Mapping) else vars(material)
    strength = known["tensile_strength"]
    limit = known["fatigue_limit"] if "fatigue_limit" in known else known["fatigue_strength_ratio"] * strength
    return SNCurve(strength, limit, known["cycles_at_tensile_strength"], known["cycles_at_fatigue_limit"])


def woehler_exponent(curve: SNCurve) -> np.ndarray:
    """Return the exponent of an S-N curve, k = ln(N_k/N_Rm) / ln(R_m/sigma_D).

    Parameters
    ----------
    curve : SNCurve
        The curve.

    Returns
    -------
    numpy.ndarray
        k > 0 [1], of the broadcast shape.

    Raises
    ------
    InputError
        If the two points do not make a falling curve.
    """
    strength, limit, first, knee = (np.asarray(value, dtype=float) for value in curve)
    if not np.all((limit > 0) & (strength > limit) & (first > 0) & (knee > first)):
        given = "R_m, sigma_D, N_Rm, N_k"
        allowed = "it must fall: R_m > sigma_D > 0 and N_k > N_Rm > 0"
        raise InputError("S-N curve", given, allowed, "Correct the material.")
    return curve_exponent(knee / first, strength / limit)


def scatter_ranges(
    exponent: ArrayLike, scatter_cycles: float | None = None, scatter_stress: float | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return the scatter of life and of strength; a missing one follows from T_N = T_S^k.

    Parameters
    ----------
    exponent : array_like
        k of the S-N curve [1].
    scatter_cycles, scatter_stress : float, optional
        T_N = N_90/N_10 and T_S = S_90/S_10, both >= 1 [1]; the index is the failure probability in percent. Without
        both there is no scatter.

    Returns
    -------
    tuple of numpy.ndarray
        (T_N, T_S), each of the shape of `exponent`.

    Raises
    ------
    InputError
        If a scatter is below 1.
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
    """Return the knee of an S-N curve at another failure probability than 50 %.

    Parameters
    ----------
    fatigue_limit, n_k, exponent : array_like
        Knee [MPa], [1] and exponent [1] of the curve at 50 %; the exponent stays the same.
    probability : array_like
        Failure probability between 0 and 1 [1].
    scatter_cycles, scatter_stress : float, optional
        See `scatter_ranges`.

    Returns
    -------
    tuple of numpy.ndarray
        (sigma_D [MPa], N_k [1]), of the broadcast shape.

    Raises
    ------
    InputError
        If a probability lies outside (0, 1).

    Notes
    -----
    The scatter is log-normal (DIN 50100:2016). With the standard normal deviate u of the probability, lg N shifts by
    u lg(T_N)/2.563 and lg sigma_D by u lg(T_S)/2.563.
    """
    p = np.asarray(probability, dtype=float)
    if not np.all((p > 0) & (p < 1)):
        value = np.ravel(p)[0] if p.size == 1 else p.tolist()
        raise InputError("failure_probability", value, "it must lie between 0 and 1", "Give 0.1 for 10 %.")
    t_n, t_s = scatter_ranges(exponent, scatter_cycles, scatter_stress)
    deviate = ndtri(p) / DECADES
    fall = t_s**deviate
    # The curve moves along with the strength. If T_N is larger than this move gives, the curve also moves in cycles.
    beyond = t_n**deviate * fall ** -np.asarray(exponent, dtype=float)
    return np.asarray(fatigue_limit) * fall, np.asarray(n_k) * beyond


def _at_probability(
    curve: SNCurve, rule: str, probability: ArrayLike, *scatter: float | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the knee (sigma_D, N_k) at the failure probability, and the exponent k of a curve."""
    check_names("life_rule", [rule], LIFE_RULES)
    k = woehler_exponent(curve)
    limit, knee = np.asarray(curve.fatigue_limit, dtype=float), np.asarray(curve.n_k, dtype=float)
    if np.any(np.asarray(probability) != 0.5):
        limit, knee = line_at_probability(limit, knee, k, probability, *scatter)
    return limit, knee, k


def life_cycles(
    stress: ArrayLike,
    curve: SNCurve,
    rule: str = "elementary",
    *,
    failure_probability: ArrayLike = 0.5,
    scatter_cycles: float | None = None,
    scatter_stress: float | None = None,
) -> np.ndarray:
    """Return the cycles to failure, N = N_k (sigma/sigma_D)^-k above the fatigue limit.

    Parameters
    ----------
    stress : array_like
        Amplitude [MPa].
    curve : SNCurve
        The curve.
    rule : str
        Below sigma_D "elementary" runs the curve on, "haibach" takes the slope 2k - 1, "unlimited" gives inf.
    failure_probability : array_like
        Failure probability [1]; without a scatter range it has no effect.
    scatter_cycles, scatter_stress : float, optional
        See `scatter_ranges`.

    Returns
    -------
    numpy.ndarray
        Cycles [1] of the broadcast shape; inf for zero stress, NaN for NaN or a negative stress. Above R_m the curve
        is run on to fewer than N_Rm cycles, where it gives no fatigue life: the validity flag `static` warns.

    Raises
    ------
    InputError
        For an unknown rule, or a curve that does not fall.

    Examples
    --------
    >>> float(life_cycles(300.0, SNCurve(900.0, 400.0, 1e3, 2e6), "unlimited"))
    inf
    """
    limit, knee, k = _at_probability(curve, rule, failure_probability, scatter_cycles, scatter_stress)
    sigma = np.asarray(stress, dtype=float)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        ratio = np.where(sigma >= 0, sigma, np.nan) / limit
        exponent = np.where(ratio < 1, 2 * k - 1, k) if rule == "haibach" else k
        cycles = knee * ratio**-exponent
    return np.where(ratio < 1, np.inf, cycles) if rule == "unlimited" else cycles


def allowable_stress(
    cycles: ArrayLike,
    curve: SNCurve,
    rule: str = "elementary",
    *,
    failure_probability: ArrayLike = 0.5,
    scatter_cycles: float | None = None,
    scatter_stress: float | None = None,
) -> np.ndarray:
    """Return the stress amplitude that a number of cycles allows, the inverse of `life_cycles`.

    Parameters
    ----------
    cycles : array_like
        Cycles to failure [1].
    curve, rule, failure_probability, scatter_cycles, scatter_stress
        See `life_cycles`.

    Returns
    -------
    numpy.ndarray
        Amplitude [MPa], NaN for cycles <= 0. With the rule "unlimited" it stays at sigma_D beyond the knee.
    """
    limit, knee, k = _at_probability(curve, rule, failure_probability, scatter_cycles, scatter_stress)
    n = np.asarray(cycles, dtype=float)
    ratio = np.where(n > 0, n, np.nan) / knee
    exponent = np.where(ratio > 1, 2 * k - 1, k) if rule == "haibach" else k
    factor = ratio ** (-1.0 / exponent)
    return limit * (np.where(ratio > 1, 1.0, factor) if rule == "unlimited" else factor)


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
