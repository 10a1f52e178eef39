"""The S-N curve (Wöhler line): cycles to failure for a stress, its scatter and its inverse.

The curve is straight in logarithms through (N_Rm, R_m) and the knee (N_k, sigma_D) (Wenzel et al.
2022 after DIN 50100:2016), or through the points that a material gives, whose last one is the knee.
Stresses are in MPa, cycles and probabilities in 1; arrays may have any shapes that broadcast.

ASSUME: the curve of the database holds for a failure probability of 50 %. ASSUME: below sigma_D
the scatter of the strength stays, so that the life scatters by T_N T_S^(k_2 - k) there, as in
pyLife 2 (materiallaws/woehlercurve.py). A second exponent k_2 < k would make that less than T_N, by
8 -> 1.36 for k = 55 and k_2 = 8; there the life scatters by T_N at all stresses.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
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
GIVEN_SLOPE = (
    "a second exponent that a material gives holds below its fatigue limit, except with "
    "unlimited life"
)
PROBABILITIES = (0.1, 0.5, 0.9)
# Low end, value and high end of T_N = N_90/N_10 where a material gives no scatter [1]. Five values:
# 5.2, 6.8, 10.0 and 10.8, two public sets of S-N tests of steel evaluated in two ways each (pyLife,
# github.com/boschresearch/pylife, demos/data/woehler and tests/materialdata/woehler), and 16.1 of
# ball bearings, whose lives have the Weibull slope 10/9 (ISO 281). The value is the middle one.
# ASSUME: other materials scatter alike. Tests in rolling contact may scatter more: Tallian, McCool,
# J. Lubr. Technol. 100 (1978) 147-154, estimate slopes down to 0.4.
TYPICAL_SCATTER = (5.2, 10.0, 16.1)
# standard deviations of a normal distribution from 10 % to 90 %
DEVIATES_10_TO_90 = 2.5631031310892007


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


def segments(points: Any) -> np.ndarray | None:
    """Return where the exponent of a line by points changes: stress over sigma_D, and the exponent
    above it.

    Parameters
    ----------
    points : None, sequence of pairs, or numpy.ndarray of str
        Stresses [MPa] and cycles [1] of one line, (m, 2), from the largest stress to the knee. Or
        the lines of an array of materials of any shape as JSON, "" for none.

    Returns
    -------
    numpy.ndarray or None
        Rising stresses over sigma_D from 1 on, and exponents, (..., m - 1, 2) [1]; NaN behind a
        line that has fewer points than others. None without any line.

    Examples
    --------
    >>> segments([(400.0, 1e4), (200.0, 1e5), (100.0, 1e7)]).round(3).tolist()
    [[1.0, 6.644], [2.0, 3.322]]
    """
    if isinstance(points, np.ndarray) and points.dtype == object:
        lines = {text: _of_line(json.loads(text)) for text in set(points.ravel().tolist()) if text}
        if not lines:
            return None
        out = np.full((*points.shape, max(map(len, lines.values())), 2), np.nan)
        for text, line in lines.items():
            out[points == text, : len(line)] = line
        return out
    return _of_line(points) if points else None


def _of_line(points: Any) -> np.ndarray:
    """Return starts and exponents of the pieces of one line by points, (m - 1, 2)."""
    stresses, cycles = np.asarray(points, dtype=float)[::-1].T
    return np.stack(
        [
            stresses[:-1] / stresses[0],
            curve_exponent(cycles[:-1] / cycles[1:], stresses[1:] / stresses[:-1]),
        ],
        axis=1,
    )


def log_deviates(failure_probability: ArrayLike) -> np.ndarray:
    """Return by which power of T_N a life at a failure probability differs from the median life.

    The life is log-normal (DIN 50100:2016): u/2.563 with the standard normal deviate u.

    Examples
    --------
    >>> log_deviates([0.1, 0.5, 0.9]).round(12).tolist()
    [-0.5, 0.0, 0.5]
    """
    # heavy, and most curves hold for a failure probability of 50 %
    from scipy.special import ndtri

    return np.asarray(ndtri(np.asarray(failure_probability, dtype=float)) / DEVIATES_10_TO_90)


def typical_scatter(place: ArrayLike, failure_probability: float) -> np.ndarray:
    """Return T_N at a place in the range of `TYPICAL_SCATTER` [1].

    Parameters
    ----------
    place : array_like
        -1 for the end that gives the shorter life, 0 for the value, 1 for the other end; linear
        between them.
    failure_probability : float
        Failure probability of the life [1]. Below 0.5 more scatter gives a shorter life.

    Returns
    -------
    numpy.ndarray
        T_N of the shape of `place`.

    Examples
    --------
    >>> typical_scatter([-1, 0, 1], 0.1).tolist()
    [16.1, 10.0, 5.2]
    """
    least, value, most = TYPICAL_SCATTER
    worse = most
    better = least
    if failure_probability > 0.5:
        worse = least
        better = most
    at = np.asarray(place, dtype=float)
    return np.asarray(value + np.abs(at) * (np.where(at < 0, worse, better) - value))


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
        Below sigma_D "elementary" runs the curve on, "haibach" takes the slope 2k - 1, "unlimited"
        gives no failure. A second exponent takes the place of k and of 2k - 1.
    scatter_cycles, scatter_stress : array_like, optional
        T_N = N_90/N_10 and T_S = S_90/S_10, both >= 1 [1]; the index is the failure probability in
        percent. A missing one (None or NaN) follows from T_N = T_S^k. Without both there is no
        scatter.
    failure_probability : array_like
        Failure probability of the lives, between 0 and 1 [1]. Without scatter it has no effect.
    segments : numpy.ndarray, optional
        Lines by points above sigma_D, see `segments`, (..., m, 2). They take the place of the line
        to R_m; NaN where a material gives no points. The exponent k is that of the segment that
        ends at the knee.
    second_exponent : array_like, optional
        Exponent below sigma_D [1]; None or NaN where a material gives none.

    Raises
    ------
    InputError
        For a curve that does not fall, an unknown rule, a scatter below 1, or a probability outside
        (0, 1).

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
    segments: Any = None
    second_exponent: Any = None

    def __post_init__(self) -> None:
        check_names("life_rule", [self.rule], CONVENTIONS)
        strength, limit, first, knee = self._points
        falls = (limit > 0) & (strength > limit) & (first > 0) & (knee > first)
        by_points = (limit > 0) & (knee > 0) & np.isfinite(self._of_points(0)[1])
        if not np.all(falls | by_points):
            given = "R_m, sigma_D, N_Rm, N_k"
            allowed = "a curve that falls: R_m > sigma_D > 0 and N_k > N_Rm > 0"
            raise InputError("S-N curve", given, allowed, "Correct the material.")
        for name, value in (
            ("scatter_in_cycles", self.scatter_cycles),
            ("scatter_in_stress", self.scatter_stress),
        ):
            if np.any(_known(value) < 1):
                allowed = "the larger over the smaller value, >= 1"
                raise InputError(name, value, allowed, "Give its inverse.")
        p = np.asarray(self.failure_probability, dtype=float)
        if not np.all((p > 0) & (p < 1)):
            value = np.ravel(p)[0] if p.size == 1 else p.tolist()
            raise InputError(
                "failure_probability", value, "a number between 0 and 1", "Give 0.1 for 10 %."
            )

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
        if isinstance(material, Mapping):
            known = material
        else:
            known = vars(material)
        strength = known["tensile_strength"]
        if "fatigue_limit" in known:
            limit = known["fatigue_limit"]
        else:
            limit = known["fatigue_strength_ratio"] * strength
        knees = known["cycles_at_tensile_strength"], known["cycles_at_fatigue_limit"]
        scatter = known.get("scatter_in_cycles"), known.get("scatter_in_stress")
        line = {
            "segments": segments(known.get("sn_points")),
            "second_exponent": known.get("second_exponent"),
        }
        return cls(strength, limit, *knees, rule, *scatter, **line)

    def changed(self, **values: Any) -> SNCurve:
        """Return the curve with other values for some of its fields."""
        return replace(self, **values)

    def assuming(self, scatter: ArrayLike) -> SNCurve:
        """Return the curve with a scatter of the life T_N [1] where its own is not known."""
        return self.changed(
            scatter_cycles=np.where(self.scatters, _known(self.scatter_cycles), scatter)
        )

    @property
    def _points(self) -> tuple[np.ndarray, ...]:
        values = (self.tensile_strength, self.fatigue_limit, self.n_rm, self.n_k)
        return tuple(np.asarray(value, dtype=float) for value in values)

    @property
    def exponent(self) -> np.ndarray:
        """Return the exponent k = ln(N_k/N_Rm) / ln(R_m/sigma_D) > 0 [1], or that of the segment
        above the knee.
        """
        strength, limit, first, knee = self._points
        by_points = self._of_points(0)[1]
        # R_m plays no part in a line by points
        with np.errstate(divide="ignore", invalid="ignore"):
            to_strength = curve_exponent(knee / first, strength / limit)
        return np.asarray(np.where(np.isfinite(by_points), by_points, to_strength))

    def _of_points(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the stress over sigma_D at which segment i of each line begins, and its exponent
        [1].

        NaN for a line without this segment.
        """
        if self.segments is None:
            return np.asarray(np.nan), np.asarray(np.nan)
        return self.segments[..., i, 0], self.segments[..., i, 1]

    def _pieces(self) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Yield stress over sigma_D and cycles over N_k where a piece of the curve starts, and its
        exponent, upwards.

        NaN where the curve of a material has no further piece.
        """
        start = np.asarray(1.0)
        cycles = np.asarray(1.0)
        exponent = self.exponent
        yield start, cycles, exponent
        if self.segments is None:
            return
        for i in range(1, self.segments.shape[-2]):
            above, steeper = self._of_points(i)
            cycles = cycles * (above / start) ** -exponent
            start = above
            exponent = steeper
            yield start, cycles, exponent

    @property
    def scatters(self) -> np.ndarray:
        """Return whether the scatter of life or of strength is known, a bool array."""
        return np.asarray(
            ~(np.isnan(_known(self.scatter_cycles)) & np.isnan(_known(self.scatter_stress)))
        )

    @property
    def scatter_ranges(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the scatter of life T_N and of strength T_S [1], 1 without scatter."""
        k = self.exponent
        t_n = _known(self.scatter_cycles)
        t_s = _known(self.scatter_stress)
        cycles = np.where(np.isnan(t_n), np.where(np.isnan(t_s), 1.0, t_s**k), t_n)
        return cycles, np.where(np.isnan(t_s), np.where(np.isnan(t_n), 1.0, t_n ** (1.0 / k)), t_s)

    @property
    def log_life_deviation(self) -> np.ndarray:
        """Return the standard deviation of log10 life, lg(T_N) / 2.563 [1]; 0 without scatter."""
        return np.asarray(np.log10(self.scatter_ranges[0]) / DEVIATES_10_TO_90)

    @property
    def knee(self) -> tuple[np.ndarray, np.ndarray]:
        """Return sigma_D [MPa] and N_k [1] at the failure probability; the exponent stays the same.

        The scatter is log-normal (DIN 50100:2016). With the standard normal deviate u of the
        probability, lg N shifts by u lg(T_N)/2.563 and lg sigma_D by u lg(T_S)/2.563. A curve whose
        exponent falls below sigma_D shifts in lg N alone, so that no life scatters less than T_N.
        """
        _, limit, _, knee = self._points
        if not np.any(np.asarray(self.failure_probability) != 0.5):
            return limit, knee
        t_n, t_s = self.scatter_ranges
        deviate = log_deviates(self.failure_probability)
        fall = np.where(self._falls_faster_below, 1.0, t_s**deviate)
        # The curve moves along with the strength. If T_N is larger than this move gives, it also
        # moves in cycles.
        beyond = t_n**deviate * fall**-self.exponent
        return limit * fall, knee * beyond

    @property
    def _below(self) -> np.ndarray:
        """Return the exponent below sigma_D: the one that the material gives, otherwise 2k - 1 by
        Haibach, or k.
        """
        given = _known(self.second_exponent)
        by_rule = self.exponent
        if self.rule == "haibach":
            by_rule = 2 * self.exponent - 1
        return np.where(np.isnan(given), by_rule, given)

    @property
    def _falls_faster_below(self) -> np.ndarray:
        """Return whether the exponent is smaller below sigma_D than above it, a bool array."""
        if self.rule == "unlimited":
            return np.asarray(False)
        return np.asarray(self._below < self.exponent)

    def slope(self, stress: ArrayLike) -> np.ndarray:
        """Return the exponent of the life at a stress [1]: k, and below sigma_D that of the rule or
        the second one.

        A relative error of the stress changes the life by this exponent times the error.
        """
        ratio = np.asarray(stress, dtype=float) / self.knee[0]
        slope = self._below
        for start, _, exponent in self._pieces():
            slope = np.where(ratio >= start, exponent, slope)
        return slope

    def life_cycles(self, stress: ArrayLike) -> np.ndarray:
        """Return the cycles to failure, N = N_k (sigma/sigma_D)^-k above the fatigue limit.

        Parameters
        ----------
        stress : array_like
            Amplitude [MPa].

        Returns
        -------
        numpy.ndarray
            Cycles [1] of the broadcast shape; inf for zero stress, NaN for NaN or a negative
            stress. Above R_m, or above its first point, the curve is run on to fewer cycles; above
            R_m `fatigue` gives no life.
        """
        limit, knee = self.knee
        sigma = np.asarray(stress, dtype=float)
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            ratio = np.where(sigma >= 0, sigma, np.nan) / limit
            cycles: np.ndarray = knee * ratio**-self._below
            for start, own, exponent in self._pieces():
                cycles = np.where(ratio >= start, knee * own * (ratio / start) ** -exponent, cycles)
        if self.rule == "unlimited":
            return np.where(ratio < 1, np.inf, cycles)
        return cycles

    def allowable_stress(self, cycles: ArrayLike) -> np.ndarray:
        """Return the stress amplitude that a number of cycles allows, the inverse of `life_cycles`.

        Parameters
        ----------
        cycles : array_like
            Cycles to failure [1].

        Returns
        -------
        numpy.ndarray
            Amplitude [MPa], NaN for cycles <= 0. With the rule "unlimited" it stays at sigma_D
            beyond the knee.
        """
        limit, knee = self.knee
        n = np.asarray(cycles, dtype=float)
        ratio = np.where(n > 0, n, np.nan) / knee
        if self.rule == "unlimited":
            factor = np.ones_like(ratio)
        else:
            factor = ratio ** (-1.0 / self._below)
        for start, own, exponent in self._pieces():
            factor = np.where(ratio <= own, start * (ratio / own) ** (-1.0 / exponent), factor)
        return np.where(np.isnan(ratio), np.nan, limit * factor)


def _known(value: Any) -> np.ndarray:
    """Return a scatter as floats, NaN for None."""
    if value is None:
        value = np.nan
    return np.asarray(value, dtype=float)
