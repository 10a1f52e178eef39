"""The S-N curve (Wöhler line): cycles to failure for a stress, its scatter and its inverse.

The curve is straight in logarithms through (N_Rm, R_m) and the knee (N_k, sigma_D) (Wenzel et al. 2022 after
DIN 50100:2016). Stresses are in MPa, cycles and probabilities in 1; arrays may have any shapes that broadcast.

ASSUME: the curve of the database holds for a failure probability of 50 %.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trackroller.errors import InputError, check_names

CONVENTIONS = {
    "elementary": "Miner elementary: the S-N curve runs on below the fatigue limit (as published)",
    "haibach": "Haibach: slope 2k-1 below the fatigue limit",
    "unlimited": "Miner original: unlimited life below the fatigue limit",
}
PROBABILITIES = (0.1, 0.5, 0.9)
DEVIATES_10_TO_90 = 2.5631031310892007  # standard deviations of a normal distribution from 10 % to 90 %


def curve_exponent(cycles: np.ndarray | float, stresses: np.ndarray | float) -> np.ndarray | float:
    """Return the exponent of an S-N curve, k = ln(N_k/N_Rm) / ln(R_m/sigma_D).

    Parameters
    ----------
    cycles, stresses : float or numpy.ndarray
        N_k/N_Rm and R_m/sigma_D, both > 1 [1].

    Returns
    -------
    float or numpy.ndarray
        k > 0 [1].

    Examples
    --------
    >>> round(float(curve_exponent(5e6 / 1e4, 2.0)), 3)
    8.966
    """
    return np.log(cycles) / np.log(stresses)


@dataclass(frozen=True)
class SNCurve:
    """An S-N curve with its rule below the fatigue limit, its scatter and its failure probability.

    A curve does not change: `changed` returns another one.

    Parameters
    ----------
    tensile_strength, fatigue_limit : array_like
        R_m > sigma_D > 0 at a failure probability of 50 % [MPa].
    n_rm, n_k : array_like
        Cycles at R_m and at sigma_D at a failure probability of 50 %, 0 < N_Rm < N_k [1].
    rule : str
        Below sigma_D "elementary" runs the curve on, "haibach" takes the slope 2k - 1, "unlimited" gives no failure.
    scatter_cycles, scatter_stress : array_like, optional
        T_N = N_90/N_10 and T_S = S_90/S_10, both >= 1 [1]; the index is the failure probability in percent. A missing
        one (None or NaN) follows from T_N = T_S^k. Without both there is no scatter.
    failure_probability : array_like
        Failure probability of the lives, between 0 and 1 [1]. Without scatter it has no effect.

    Raises
    ------
    InputError
        For a curve that does not fall, an unknown rule, a scatter below 1, or a probability outside (0, 1).

    Examples
    --------
    >>> curve = SNCurve(900.0, 400.0, 1e3, 2e6)
    >>> float(curve.changed(rule="unlimited").life_cycles(300.0))
    inf
    """

    tensile_strength: Any
    fatigue_limit: Any
    n_rm: Any
    n_k: Any
    rule: str = "elementary"
    scatter_cycles: Any = None
    scatter_stress: Any = None
    failure_probability: Any = 0.5

    def __post_init__(self) -> None:
        check_names("life_rule", [self.rule], CONVENTIONS)
        strength, limit, first, knee = self._points
        if not np.all((limit > 0) & (strength > limit) & (first > 0) & (knee > first)):
            given = "R_m, sigma_D, N_Rm, N_k"
            allowed = "a curve that falls: R_m > sigma_D > 0 and N_k > N_Rm > 0"
            raise InputError("S-N curve", given, allowed, "Correct the material.")
        for name, value in (("scatter_in_cycles", self.scatter_cycles), ("scatter_in_stress", self.scatter_stress)):
            if np.any(_known(value) < 1):
                allowed = "the larger over the smaller value, >= 1"
                raise InputError(name, value, allowed, "Give its inverse.")
        p = np.asarray(self.failure_probability, dtype=float)
        if not np.all((p > 0) & (p < 1)):
            value = np.ravel(p)[0] if p.size == 1 else p.tolist()
            raise InputError("failure_probability", value, "a number between 0 and 1", "Give 0.1 for 10 %.")

    @classmethod
    def of(cls, material: Any, rule: str = "elementary") -> SNCurve:
        """Return the S-N curve of a material at a failure probability of 50 %.

        Parameters
        ----------
        material : Material, MaterialArrays or mapping
            One material, the columns of n materials, or the values of a material by name.
        rule : str
            Rule below the fatigue limit.

        Returns
        -------
        SNCurve
            Values of the shape that the material has.
        """
        known = material if isinstance(material, Mapping) else vars(material)
        strength = known["tensile_strength"]
        limit = known["fatigue_limit"] if "fatigue_limit" in known else known["fatigue_strength_ratio"] * strength
        knees = known["cycles_at_tensile_strength"], known["cycles_at_fatigue_limit"]
        scatter = known.get("scatter_in_cycles"), known.get("scatter_in_stress")
        return cls(strength, limit, *knees, rule, *scatter)

    def changed(self, **values: Any) -> SNCurve:
        """Return the curve with other values for some of its fields."""
        return replace(self, **values)

    @property
    def _points(self) -> tuple[np.ndarray, ...]:
        values = (self.tensile_strength, self.fatigue_limit, self.n_rm, self.n_k)
        return tuple(np.asarray(value, dtype=float) for value in values)

    @property
    def exponent(self) -> np.ndarray:
        """Return the exponent k = ln(N_k/N_Rm) / ln(R_m/sigma_D) > 0 [1]."""
        strength, limit, first, knee = self._points
        return np.asarray(curve_exponent(knee / first, strength / limit))

    @property
    def scatters(self) -> np.ndarray:
        """Return whether the scatter of life or of strength is known, a bool array."""
        return np.asarray(~(np.isnan(_known(self.scatter_cycles)) & np.isnan(_known(self.scatter_stress))))

    @property
    def scatter_ranges(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the scatter of life T_N and of strength T_S [1], 1 without scatter."""
        k, t_n, t_s = self.exponent, _known(self.scatter_cycles), _known(self.scatter_stress)
        cycles = np.where(np.isnan(t_n), np.where(np.isnan(t_s), 1.0, t_s**k), t_n)
        return cycles, np.where(np.isnan(t_s), np.where(np.isnan(t_n), 1.0, t_n ** (1.0 / k)), t_s)

    @property
    def log_life_deviation(self) -> np.ndarray:
        """Return the standard deviation of log10 life, lg(T_N) / 2.563 [1]; 0 without scatter."""
        return np.asarray(np.log10(self.scatter_ranges[0]) / DEVIATES_10_TO_90)

    @property
    def knee(self) -> tuple[np.ndarray, np.ndarray]:
        """Return sigma_D [MPa] and N_k [1] at the failure probability; the exponent stays the same.

        The scatter is log-normal (DIN 50100:2016). With the standard normal deviate u of the probability, lg N shifts
        by u lg(T_N)/2.563 and lg sigma_D by u lg(T_S)/2.563.
        """
        from scipy.special import ndtri  # heavy, and planning reads only the declarations of the limits

        _, limit, _, knee = self._points
        if not np.any(np.asarray(self.failure_probability) != 0.5):
            return limit, knee
        t_n, t_s = self.scatter_ranges
        deviate = ndtri(np.asarray(self.failure_probability, dtype=float)) / DEVIATES_10_TO_90
        fall = t_s**deviate
        # The curve moves along with the strength. If T_N is larger than this move gives, it also moves in cycles.
        beyond = t_n**deviate * fall**-self.exponent
        return limit * fall, knee * beyond

    def slope(self, stress: ArrayLike) -> np.ndarray:
        """Return the exponent of the life at a stress [1]: k, and 2k - 1 below sigma_D by Haibach.

        A relative error of the stress changes the life by this exponent times the error.
        """
        return self._slope(np.asarray(stress, dtype=float) < self.knee[0])

    def _slope(self, below: np.ndarray) -> np.ndarray:
        """Return the exponent of the life where a load lies below the fatigue limit, and where it does not."""
        k = self.exponent
        return np.where(below, 2 * k - 1, k) if self.rule == "haibach" else k

    def life_cycles(self, stress: ArrayLike) -> np.ndarray:
        """Return the cycles to failure, N = N_k (sigma/sigma_D)^-k above the fatigue limit.

        Parameters
        ----------
        stress : array_like
            Amplitude [MPa].

        Returns
        -------
        numpy.ndarray
            Cycles [1] of the broadcast shape; inf for zero stress, NaN for NaN or a negative stress. Above R_m the
            curve is run on to fewer than N_Rm cycles; there `fatigue` gives no life.
        """
        limit, knee = self.knee
        sigma = np.asarray(stress, dtype=float)
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            ratio = np.where(sigma >= 0, sigma, np.nan) / limit
            cycles = knee * ratio ** -self._slope(ratio < 1)
        return np.where(ratio < 1, np.inf, cycles) if self.rule == "unlimited" else cycles

    def allowable_stress(self, cycles: ArrayLike) -> np.ndarray:
        """Return the stress amplitude that a number of cycles allows, the inverse of `life_cycles`.

        Parameters
        ----------
        cycles : array_like
            Cycles to failure [1].

        Returns
        -------
        numpy.ndarray
            Amplitude [MPa], NaN for cycles <= 0. With the rule "unlimited" it stays at sigma_D beyond the knee.
        """
        limit, knee = self.knee
        n = np.asarray(cycles, dtype=float)
        ratio = np.where(n > 0, n, np.nan) / knee
        factor = ratio ** (-1.0 / self._slope(ratio > 1))
        return limit * (np.where(ratio > 1, 1.0, factor) if self.rule == "unlimited" else factor)


def _known(value: Any) -> np.ndarray:
    """Return a scatter as floats, NaN for None."""
    return np.asarray(np.nan if value is None else value, dtype=float)
