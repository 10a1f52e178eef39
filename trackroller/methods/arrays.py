"""Classical designs in coded units: -1 and +1 are the ends of a factor's range, 0 its middle.

pyDOE gives the central composite designs and the Box-Behnken designs of 3 to 5 factors. This module
has what pyDOE lacks: for 6 and 7 factors the published Box-Behnken blocks (49 and 57 rows; pyDOE
combines all pairs: 61 and 85), and Plackett-Burman designs for each number of factors up to 47
(pyDOE fails for 24 to 27, 32 to 35 and 40 to 43).

SALib has no counterpart for the fit of a response surface with lists.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np

from trackroller.errors import InputError
from trackroller.methods.factor import TAIL, Factor
from trackroller.methods.grid import Grid
from trackroller.methods.intervals import constant
from trackroller.methods.method import (
    Design,
    Drawn,
    Estimated,
    Estimates,
    Factors,
    Index,
    Method,
    Settings,
    crossed,
    in_order,
)

Terms = list[tuple[Any, ...]]


class Coded(Method):
    """A classical design over the continuous factors, repeated for each combination of listed
    values.
    """

    quick = quadratic = True
    tail = TAIL
    indices = {
        "effect": Index(
            "change over the range; of a list the largest less the smallest mean",
            sized=True,
            signed=True,
            of_factor=True,
        ),
        "curvature": Index("curvature of the fit", sized=True, signed=True, of_factor=True),
        "interaction": Index("two-factor interaction effect", sized=True, signed=True),
        "r_squared": Index("share of variance fitted"),
    }
    headline = "effect"
    judged = ()
    needs = "enough rows for the fitted polynomial"
    rows: Callable[[int], np.ndarray]

    def values(self, factor: Factor, places: np.ndarray) -> np.ndarray:
        """Return the values at codes from -1 to 1, or listed values by index."""
        if factor.discrete:
            return factor.take(places)
        return factor.from_unit((places + 1) / 2, self.tail)

    def draw(self, free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
        """Return codes of the continuous factors, crossed with indices of the others."""
        numeric = [name for name, f in free.items() if not f.discrete]
        listed = [name for name, f in free.items() if f.discrete]
        coded = type(self).rows(len(numeric))
        crossing = Grid().draw({name: free[name] for name in listed}, n, seed, {})[0]
        unit = in_order(crossed(crossing, coded), [*listed, *numeric], free)
        return unit, {"runs": len(coded), "crossed": listed}

    def estimate(self, y: np.ndarray, design: Design) -> Estimated:
        """Return the effects of a fitted polynomial."""
        out = effects(y, design.unit, self.lists(design), self.quadratic)
        return Estimated(out, int(out.pop("rows_used")), len(y))

    def lists(self, design: Design) -> np.ndarray:
        """Return which factors enter the fit by their values, shape (k,)."""
        return design.listed


class CentralComposite(Coded):
    """Corners, face centres and centre."""

    name = "central_composite"
    reference = (
        "Design: central composite",
        "Box, Wilson (1951): On the experimental attainment of optimum conditions. J. R. Stat. "
        "Soc. B 13, 1–45",
    )

    @staticmethod
    def rows(count: int) -> np.ndarray:
        """Return the coded rows of so many continuous factors."""
        return central_composite(count)


class BoxBehnken(Coded):
    """Three levels of each factor and no corner."""

    name = "box_behnken"
    reference = (
        "Design: Box–Behnken",
        "Box, Behnken (1960): Some new three level designs for the study of quantitative "
        "variables. "
        "Technometrics 2, 455–475",
    )

    @staticmethod
    def rows(count: int) -> np.ndarray:
        """Return the coded rows of so many continuous factors."""
        return box_behnken(count)


class PlackettBurman(Coded):
    """Two levels of each factor; a list has two values, which are its ends."""

    name = "plackett_burman"
    quadratic = False
    needs = "enough rows for the fitted main effects"
    reference = (
        "Design: Plackett–Burman",
        "Plackett, Burman (1946): The design of optimum multifactorial experiments. Biometrika "
        "33, 305–325",
    )

    def values(self, factor: Factor, places: np.ndarray) -> np.ndarray:
        """Return the values at codes -1 and 1, of a list too."""
        return factor.from_unit((places + 1) / 2, self.tail)

    def draw(self, free: Factors, n: int, seed: int, settings: Settings) -> Drawn:
        """Return codes of all factors."""
        for name, factor in free.items():
            if factor.discrete and len(factor.levels) != 2:
                allowed = "two values a factor, with plackett_burman"
                raise InputError(
                    f"factors.{name}", factor.levels, allowed, "Give two values, or choose morris."
                )
        coded = plackett_burman(len(free))
        return coded, {"runs": len(coded), "crossed": []}

    def lists(self, design: Design) -> np.ndarray:
        """Return that no factor enters the fit by its values: two values are the ends of a
        range.
        """
        return np.zeros(len(design.factors), dtype=bool)


# Box & Behnken (1960): the factors that vary together in one block
_BLOCKS: dict[int, tuple[tuple[int, int, int], ...]] = {
    6: ((0, 1, 3), (1, 2, 4), (2, 3, 5), (0, 3, 4), (1, 4, 5), (0, 2, 5)),
    7: ((3, 4, 5), (0, 5, 6), (1, 4, 6), (0, 1, 3), (2, 3, 6), (0, 2, 4), (1, 2, 5)),
}

_RANGE = (
    "Give the factors ranges, such as {uniform: [low, high]}; a list of values is no numeric "
    "factor."
)


def central_composite(count: int) -> np.ndarray:
    """Return a face-centred central composite design: corners, face centres, centre.

    Parameters
    ----------
    count : number of factors, 1 to 8

    Returns
    -------
    Coded design, shape (2**count + 2 count + 1, count). A deterministic solver needs only one
    centre point.

    Raises
    ------
    InputError : another number of factors

    References
    ----------
    Box & Wilson (1951), J. R. Stat. Soc. B 13, 1-45.
    """
    remedy = _RANGE
    if count > 8:
        remedy = (
            "Screen the factors first (morris or plackett_burman) and keep the influential ones."
        )
    if not 1 <= count <= 8:
        name = f"central_composite with {count} numeric factors"
        raise InputError("method", name, "1 to 8 numeric factors", remedy)
    if count == 1:  # pyDOE needs two factors
        return np.array([[-1.0], [1.0], [-1.0], [1.0], [0.0]])
    from pydoe import ccdesign  # heavy, and other designs do not need it

    return np.asarray(ccdesign(count, center=(0, 1), face="ccf"))


def box_behnken(count: int) -> np.ndarray:
    """Return a Box-Behnken design: three levels of each factor, no corner.

    Parameters
    ----------
    count : number of factors, 3 to 7

    Returns
    -------
    Coded design, shape (n, count), with one centre point.

    Raises
    ------
    InputError : another number of factors

    References
    ----------
    Box & Behnken (1960), Technometrics 2, 455-475.
    """
    remedy = _RANGE
    if count:
        remedy = "Use central_composite (up to 8 factors), or lhs."
    if not 3 <= count <= 7:
        raise InputError(
            "method", f"box_behnken with {count} numeric factors", "3 to 7 numeric factors", remedy
        )
    if count not in _BLOCKS:
        from pydoe import bbdesign  # heavy, as above

        return np.asarray(bbdesign(count, center=1))
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    rows = np.zeros((len(_BLOCKS[count]) * len(signs) + 1, count))
    for number, block in enumerate(_BLOCKS[count]):
        rows[number * len(signs) : (number + 1) * len(signs), block] = signs
    return rows


def plackett_burman(count: int) -> np.ndarray:
    """Return a folded two-level screening design, whose main effects are clear of two-factor
    interactions.

    Parameters
    ----------
    count : number of factors, 1 to 47

    Returns
    -------
    Coded design, shape (2 m, count), m the smallest Hadamard order above `count`: a power of two
    (Sylvester) or q + 1 with a prime q = 3 mod 4 (Paley).

    Raises
    ------
    InputError : another number of factors

    References
    ----------
    Plackett & Burman (1946), Biometrika 33, 305-325; Box & Wilson (1951) for the fold-over.
    """
    if not 1 <= count <= 47:
        raise InputError(
            "method", f"plackett_burman with {count} factors", "1 to 47 factors", "Use morris."
        )
    from scipy.linalg import hadamard  # heavy, as above

    order = next(m for m in (2, 4, 8, 12, 16, 20, 24, 32, 44, 48) if m > count)
    if order & (order - 1) == 0:
        matrix = hadamard(order, float)
    else:
        matrix = _paley(order)
    half = matrix[:, 1 : count + 1]
    return np.concatenate([half, -half])


def _paley(order: int) -> np.ndarray:
    """Return the Hadamard matrix of Paley's first construction, shape (order, order), first column
    +1.
    """
    q = order - 1
    legendre = np.full(q, -1.0)
    legendre[0] = 0.0
    legendre[np.arange(1, q) ** 2 % q] = 1.0
    matrix = np.ones((order, order))
    matrix[1:, 1:] = -(legendre[(np.arange(q)[:, None] - np.arange(q)) % q] + np.eye(q))
    return matrix


def effects(y: np.ndarray, coded: np.ndarray, listed: np.ndarray, quadratic: bool) -> Estimates:
    """Fit the effects of a two- or three-level design by least squares.

    Parameters
    ----------
    y : output, shape (n,); unusable rows are left out of the fit
    coded : design, shape (n, k): -1..1, or list indices
    listed : which factors are lists, shape (k,)
    quadratic : whether to fit curvature and interactions too, if there are enough rows

    Returns
    -------
    effect, effect_low, effect_high (k,), curvature (k,), interaction (k, k), r_squared (),
    rows_used ().

    Notes
    -----
    y = c + sum b_i x_i (+ sum b_ij x_i x_j + sum b_ii x_i^2), x in [-1, 1]. The effect of a factor
    is 2 b_i, the change of the output over its range. A list enters by its values; its effect is
    the largest less the smallest mean. Intervals come from the residuals (Student t). The solver
    has no noise, so they show lack of fit.
    """
    from scipy.stats import t as student  # heavy, as above

    good = np.isfinite(y)
    y, coded, count = y[good], coded[good], coded.shape[1]
    out: Estimates = {
        name: np.full(count, np.nan)
        for name in ("effect", "effect_low", "effect_high", "curvature")
    }
    out |= {"interaction": np.full((count, count), np.nan), "r_squared": np.array(np.nan)}
    out["rows_used"] = np.array(good.sum())
    terms, matrix = _terms(coded, listed, quadratic)
    if quadratic and np.linalg.matrix_rank(matrix) < matrix.shape[1]:
        terms, matrix = _terms(coded, listed, False)
    if constant(y) or np.linalg.matrix_rank(matrix) < matrix.shape[1]:
        return out
    beta, *_ = np.linalg.lstsq(matrix, y, rcond=None)
    residual = y - matrix @ beta
    free = len(residual) - matrix.shape[1]
    wide = np.nan
    variance = np.nan
    if free > 0:
        wide = student.ppf(0.975, free)
        variance = residual @ residual / free
    out["r_squared"] = np.array(1 - (residual @ residual) / ((y - y.mean()) ** 2).sum())
    covariance = np.linalg.inv(matrix.T @ matrix) * variance
    for i in range(count):
        contrast = _contrast(i, bool(listed[i]), terms, beta)
        size = contrast @ beta
        half = wide * np.sqrt(contrast @ covariance @ contrast)
        out["effect"][i] = size
        out["effect_low"][i] = size - half
        out["effect_high"][i] = size + half
    for p, term in enumerate(terms):
        if term[0] == "square":
            out["curvature"][term[1]] = beta[p]
        elif term[0] == "product":
            out["interaction"][term[1], term[2]] = 2 * beta[p]
    return out


def _contrast(factor: int, listed: bool, terms: Terms, beta: np.ndarray) -> np.ndarray:
    """Return the weights of the coefficients whose sum is the effect of a factor."""
    contrast = np.zeros(len(terms))
    if not listed:
        contrast[terms.index(("line", factor))] = 2.0
        return contrast
    levels = [p for p, term in enumerate(terms) if term[:2] == ("level", factor)]
    means = np.append(beta[levels], 0.0)  # the last value of the list is the reference
    for level, sign in ((int(means.argmax()), 1.0), (int(means.argmin()), -1.0)):
        if level < len(levels):
            contrast[levels[level]] = sign
    return contrast


def _terms(coded: np.ndarray, listed: np.ndarray, quadratic: bool) -> tuple[Terms, np.ndarray]:
    """Return the terms of the fitted polynomial and their columns, shape (n, terms)."""
    terms: Terms = [("one",)]
    columns = [np.ones(len(coded))]
    numeric = [i for i in range(coded.shape[1]) if not listed[i]]
    for i in range(coded.shape[1]):
        if listed[i]:
            for level in np.unique(coded[:, i])[:-1]:
                terms.append(("level", i, level))
                columns.append((coded[:, i] == level).astype(float))
        else:
            terms.append(("line", i))
            columns.append(coded[:, i])
    if quadratic:
        terms += [("square", i) for i in numeric]
        columns += [coded[:, i] ** 2 for i in numeric]
        pairs = [(i, j) for i in numeric for j in numeric if i < j]
        terms += [("product", i, j) for i, j in pairs]
        columns += [coded[:, i] * coded[:, j] for i, j in pairs]
    return terms, np.stack(columns, axis=1)
