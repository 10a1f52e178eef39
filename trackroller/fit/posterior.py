"""Posterior of a fitted line on fixed points of its values: deterministic, without a sampler.

The prior is flat in ln strength, in the slope and in ln scatter, unless a prior is given. The
points are a Sobol sequence under a multivariate t distribution, and each carries a weight: its
posterior density over that of the distribution. The distribution takes mean and covariance of the
posterior of a first, coarse set of points. A regular grid of five values has too few points along
each of them to tell a quantile.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy.special import gammaincinv, ndtri

from trackroller.fit.line import NAMES, Line, Values, expanded

COARSE = 4096  # points of the first sets
FINE = 16384  # points of the last set
ROUNDS = 3  # sets that only find mean and covariance
FREEDOM = 4.0  # of the t distribution, whose tails must be heavier than those of the posterior
WIDER = 1.3  # factor on the standard deviations of the posterior that was found
KEPT = 1e-7  # weight over the largest one below which a point is dropped
LONG_NAMES = {
    "level": "ln of the cycles at the reference stress",
    "slope": "slope of the S-N line",
    "log_scatter": "ln of the standard deviation of ln cycles",
    "log_limit": "ln of the median fatigue limit in MPa",
    "log_limit_scatter": "ln of the standard deviation of the ln fatigue limit",
}


@dataclass(frozen=True)
class Posterior:
    """Points of the values of a line, with their weights.

    Attributes
    ----------
    values : Values
        The values of a line at each point, (points,) each; held ones are the same at all points.
    weight : numpy.ndarray
        Probability of each point, which sum up to 1, (points,).
    """

    values: Values
    weight: np.ndarray

    def quantile(self, values: np.ndarray, at: float | np.ndarray) -> np.ndarray:
        """Return quantiles of a quantity that has one value at each point.

        Parameters
        ----------
        values : numpy.ndarray
            The quantity, (points,).
        at : float or array
            Probabilities.
        """
        order = np.argsort(values, kind="stable")
        below = np.cumsum(self.weight[order]) - 0.5 * self.weight[order]
        return np.interp(at, below, values[order])

    def variance(self, values: np.ndarray) -> float:
        """Return the variance of a quantity that has one finite value at each point."""
        mean = float(self.weight @ values)
        return float(self.weight @ (values - mean) ** 2)

    def to_dataset(self) -> xr.Dataset:
        """Return the points along the dimension `point`, with `weight` and what each value is."""
        variables = {
            name: ("point", np.asarray(value), {"units": "1", "long_name": LONG_NAMES[name]})
            for name, value in zip(NAMES, self.values, strict=True)
        }
        words = {"units": "1", "long_name": "posterior probability of the point"}
        return xr.Dataset(variables | {"weight": ("point", self.weight, words)})

    @classmethod
    def from_dataset(cls, ds: xr.Dataset) -> Posterior:
        """Return the posterior that `to_dataset` wrote."""
        return cls(Values(*(ds[name].values for name in NAMES)), ds["weight"].values)


@dataclass(frozen=True)
class Normal:
    """A normal prior of one of the values of a line."""

    mean: float
    deviation: float

    def log_density(self, value: np.ndarray) -> np.ndarray:
        """Return the logarithm of the density, without its constant."""
        return np.asarray(-0.5 * ((value - self.mean) / self.deviation) ** 2)


def log_prior(
    line: Line, points: np.ndarray, priors: Mapping[str, Normal], at: float = math.nan
) -> np.ndarray:
    """Return the logarithm of the prior density at points of the free values of a line, (...).

    Flat in ln strength means a density of the level in proportion to 1/slope, because the level
    moves by the slope times ln strength. `priors` are those of `slope`, `log_scatter` and
    `log_strength`: the ln of the median fatigue limit, or of the strength at the cycles `at` of a
    line without one.
    """
    values = line.values(points)
    if line.sloped and "slope" in line.free:
        density = -np.log(values.slope)
    else:
        density = np.zeros(np.shape(values.level))
    for name, prior in priors.items():
        if name == "log_strength":
            value = log_strength(line, values, at)
        else:
            value = getattr(values, name)
        density = density + prior.log_density(np.asarray(value))
    return np.asarray(density)


def log_strength(line: Line, values: Values, at: float) -> np.ndarray:
    """Return the ln of the median fatigue limit, or of the median strength at the cycles `at`."""
    if line.knee:
        return np.asarray(values.log_limit)
    return np.asarray(line.reference + (values.level - math.log(at)) / values.slope)


def posterior(
    line: Line, priors: Mapping[str, Normal] | None = None, at: float = math.nan
) -> Posterior:
    """Return the posterior of a line.

    Parameters
    ----------
    line : Line
        The line with its tests; at least one test failed.
    priors : mapping of str to Normal, optional
        Priors of `slope`, `log_scatter` and `log_strength`; the others are flat.
    at : float
        Cycles to which a prior of the strength belongs.

    Returns
    -------
    Posterior
        The points that carry all but a share of 1e-6 of the probability.

    Notes
    -----
    ASSUME: the values lie within the bounds of `trackroller.fit.line.BOUNDS`.
    """
    priors = dict(priors or {})
    p = len(line.free)

    def density(points: np.ndarray) -> np.ndarray:
        inside = ((points >= line.limits[:, 0]) & (points <= line.limits[:, 1])).all(axis=-1)
        clipped = np.clip(points, *line.limits.T)
        return np.where(
            inside, line.log_likelihood(clipped) + log_prior(line, clipped, priors, at), -np.inf
        )

    # importance sampling: the points of each round lie about the mean of the round before, spread
    # by the root of its covariance
    middle = line.estimate
    factor = _factor(line)
    for count in (COARSE,) * ROUNDS + (FINE,):
        standard, log_proposal = _standard_points(p, count)
        points = middle + WIDER * standard @ factor.T
        value = density(points) - log_proposal
        weight = np.exp(value - value.max())
        weight /= weight.sum()
        middle = weight @ points
        spread = (points - middle).T @ (weight[:, None] * (points - middle))
        factor = np.linalg.cholesky(spread + 1e-12 * np.eye(p))
    counts = weight > KEPT * weight.max()
    return Posterior(line.values(points[counts]), weight[counts] / weight[counts].sum())


@functools.cache
def _standard_points(p: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return Sobol points under the standard t distribution (count, p), and ln of its density
    (count,).
    """
    from scipy.stats import qmc  # heavy, and a stored posterior is not drawn again

    uniform = qmc.Sobol(p + 1, rng=1).random(count)
    uniform = np.clip(uniform, 1e-9, 1.0 - 1e-9)
    radius = np.sqrt(FREEDOM / (2.0 * gammaincinv(FREEDOM / 2, uniform[:, -1])))
    points = ndtri(uniform[:, :-1]) * radius[:, None]
    return points, -0.5 * (FREEDOM + p) * np.log1p((points**2).sum(axis=1) / FREEDOM)


def _factor(line: Line) -> np.ndarray:
    """Return the factor of the covariance by the curvature of the likelihood at its maximum, (p,
    p).
    """
    spans = 0.1 * np.ptp(line.limits, axis=1)
    _, _, curvature = expanded(lambda points: -line.log_likelihood(points), line.estimate)
    roots, axes = np.linalg.eigh(curvature)
    length = 1.0 / np.sqrt(np.maximum(roots, 1e-12))
    # a flat likelihood bounds no axis
    longest = np.min(spans[:, None] / np.maximum(np.abs(axes), 1e-12), axis=0)
    return np.asarray(axes * np.minimum(length, longest))


def ln_range(deviation: float) -> float:
    """Return the range from 10 to 90 % of a log-normal value, T = exp(2.563 s), from the deviation
    of its logarithm.
    """
    return math.exp(2.0 * float(ndtri(0.9)) * deviation)
