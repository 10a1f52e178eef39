"""Functions and samples whose sensitivity indices are known exactly, to check estimators with."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from SALib.sample import sobol as sobol_sample
from scipy.stats import norm

Data = tuple[np.ndarray, np.ndarray]  # quantiles or list indices (n, k), output (n,)


class Function(NamedTuple):
    """A function of independent uniform variables with its first-order and total indices."""

    evaluate: Callable[[np.ndarray], np.ndarray]
    first: np.ndarray
    total: np.ndarray


def ishigami(unit: np.ndarray) -> np.ndarray:
    """Return the function of Ishigami & Homma (1990), a = 7, b = 0.1; `unit`: quantiles, shape (n, 3)."""
    x = (2 * unit - 1) * np.pi
    return np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def functions() -> dict[str, Function]:
    """Return the test functions with their exact indices."""
    v = np.array([0.5 * (1 + 0.1 * np.pi**4 / 5) ** 2, 49 / 8, 8 * 0.01 * np.pi**8 / 225])
    a = np.array([0, 1, 4.5, 9, 99.0])
    part = 1 / (3 * (1 + a) ** 2)
    whole = np.prod(1 + part) - 1
    linear = np.array([1 / 12, 4 / 12, 36 / 144])  # x1 + 2 x2 + 6 x3 x4, centred
    exponent = np.array([3.0, 0.9, 0.15])
    mean = np.expm1(exponent) / exponent
    spread = np.expm1(2 * exponent) / (2 * exponent) / mean**2 - 1
    all_exp = np.prod(1 + spread) - 1
    return {
        "Ishigami": Function(
            ishigami, np.array([v[0], v[1], 0]) / v.sum(), np.array([v[0] + v[2], v[1], v[2]]) / v.sum()
        ),
        "g-function": Function(
            lambda u: np.prod((np.abs(4 * u - 2) + a) / (1 + a), axis=1),
            part / whole,
            part * (1 + whole) / (1 + part) / whole,
        ),
        "sum and product": Function(
            lambda u: 100 + u[:, 0] + 2 * u[:, 1] + 6 * (u[:, 2] - 0.5) * (u[:, 3] - 0.5),
            np.append(linear[:2], [0, 0]) / linear.sum(),
            linear[[0, 1, 2, 2]] / linear.sum(),
        ),
        "exponential": Function(
            lambda u: np.exp(u @ exponent), spread / all_exp, spread * (1 + all_exp) / (1 + spread) / all_exp
        ),
    }


def problem(count: int) -> dict[str, Any]:
    """Return SALib's description of `count` factors on the unit interval."""
    return {"num_vars": count, "names": [f"x{i}" for i in range(count)], "bounds": [[0.0, 1.0]] * count}


def saltelli_rows(function: Function, blocks: int, seed: int) -> Data:
    """Return the rows of a Saltelli design with second order."""
    unit = sobol_sample.sample(problem(len(function.first)), blocks, seed=seed)
    return unit, function.evaluate(unit)


def random_rows(function: Function, size: int, seed: int) -> Data:
    """Return random rows."""
    unit = np.random.default_rng(seed).random((size, len(function.first)))
    return unit, function.evaluate(unit)


def rows_of_factor(function: Function, size: int, factor: int, seed: int) -> Data:
    """Return random rows of all factors, of which only one is shown to the estimator."""
    unit, y = random_rows(function, size, seed)
    return unit[:, [factor]], y


def category_rows(size: int, seed: int) -> Data:
    """Return rows of a uniform number and three categories, of which one adds 3."""
    rng = np.random.default_rng(seed)
    unit = np.column_stack([rng.random(size), rng.integers(0, 3, size)])
    return unit, unit[:, 0] + 3.0 * (unit[:, 1] == 1)


def normal_pair(size: int, correlation: float, factor: float, seed: int) -> Data:
    """Return a pair of normal variables. With a factor, take the exponential of the second; delta stays the same."""
    x, noise = np.random.default_rng(seed).standard_normal((2, size))
    y = correlation * x + np.sqrt(1 - correlation**2) * noise
    return x[:, None], np.exp(factor * y) if factor else y


@cache
def exact_delta(correlation: float) -> float:
    """Return delta of a normal pair: mean total variation of N(r x, 1 - r^2) from N(0, 1), by quadrature."""
    x = norm.ppf((np.arange(500) + 0.5) / 500)[:, None]
    y = np.linspace(-8, 8, 2001)
    apart = np.abs(norm.pdf(y, correlation * x, np.sqrt(1 - correlation**2)) - norm.pdf(y))
    return float(apart.sum(axis=1).mean() * (y[1] - y[0]) / 2)
