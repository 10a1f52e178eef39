"""Kalker's linear creepage coefficients for any ellipse, and the forces of the linear theory.

Values come from a stored table of `LinearTheory` (degree 20, good to 1e-5 .. 1e-4), interpolated by Chebyshev
polynomials in the logarithm of the axis ratio and in Poisson's ratio. Kalker's printed table (1990, table E.3)
agrees to its digits for axis ratios up to about 3 and is up to 1.2 % low at 5 and 10, where rectangular elements (80
and 160 along each axis, extrapolated) agree with the polynomials to 0.2 %: tests/test_kalker_linear.py.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

import numpy as np
from numpy.polynomial.chebyshev import chebpts1, chebval, chebvander

from trackroller.contact.common import Elastic, Ellipse, Resultants
from trackroller.contact.linear_polynomial import LinearTheory
from trackroller.errors import InputError

LARGEST_RATIO = 50.0  # and its inverse the smallest
NODES = (21, 7)  # of ln(ratio) and of nu
TABLE = "kalker_linear.csv"


@dataclass(frozen=True)
class CreepageCoefficients:
    """C11 (rolling direction), C22 (lateral), C23 (lateral by spin), C33 (spin moment) [-], arrays (n,)."""

    c11: np.ndarray
    c22: np.ndarray
    c23: np.ndarray
    c33: np.ndarray


def _nodes() -> tuple[np.ndarray, np.ndarray]:
    return np.exp(np.log(LARGEST_RATIO) * chebpts1(NODES[0])), 0.25 + 0.25 * chebpts1(NODES[1])


def tabulate(degree: int = 20) -> np.ndarray:
    """Rows (ratio, nu, C11, C22, C23, C33) at the interpolation nodes; the source of the stored table."""
    theory = LinearTheory(degree)
    ratios, poisson = _nodes()
    return np.array([[r, nu, *theory.coefficients(r, nu)] for r in ratios for nu in poisson])


def write_table(path) -> None:
    """Write the table of `tabulate` as CSV."""
    header = "linear creepage coefficients, computed by trackroller.contact.linear.tabulate\nratio,nu,C11,C22,C23,C33"
    np.savetxt(path, tabulate(), delimiter=",", fmt="%.9g", header=header)


@lru_cache(maxsize=1)
def _chebyshev() -> np.ndarray:
    """Coefficients (nodes of ratio, nodes of nu, 4) of the logarithms of the table."""
    text = resources.files("trackroller.contact").joinpath(TABLE).read_text(encoding="utf-8")
    values = np.loadtxt(text.splitlines(), delimiter=",")[:, 2:].reshape(*NODES, 4)
    u, v = (np.linalg.inv(chebvander(chebpts1(n), n - 1)) for n in NODES)
    return np.einsum("ij,kl,jlc->ikc", u, v, np.log(values))


def creepage_coefficients(axis_ratio, poisson_ratio) -> CreepageCoefficients:
    """Linear creepage coefficients.

    Parameters
    ----------
    axis_ratio : semi-axis in the rolling direction over the lateral one (Kalker's a/b) [-], (n,), 0.02 to 50
    poisson_ratio : combined Poisson's ratio [-], (n,), 0 to 0.5

    Raises `InputError` outside these ranges.
    """
    ratio, nu = np.broadcast_arrays(np.asarray(axis_ratio, float), np.asarray(poisson_ratio, float))
    edge = LARGEST_RATIO * (1 + 1e-12)
    if not np.all((ratio >= 1 / edge) & (ratio <= edge)):
        raise InputError("axis_ratio", axis_ratio, f"between {1 / LARGEST_RATIO:g} and {LARGEST_RATIO:g}")
    if not np.all((nu >= 0) & (nu <= 0.5)):
        raise InputError("poisson_ratio", poisson_ratio, "between 0 and 0.5")
    shape, ratio, nu = ratio.shape, ratio.reshape(-1), nu.reshape(-1)
    u, v = np.log(ratio) / np.log(LARGEST_RATIO), 4.0 * nu - 1.0
    rows = chebval(u, _chebyshev(), tensor=True)  # (nodes of nu, 4, ...)
    powers = np.moveaxis(chebvander(v, NODES[1] - 1), -1, 0)
    values = np.exp(np.einsum("kcn,kn->cn", rows, powers))
    return CreepageCoefficients(*values.reshape(4, *shape))


def resultants(ellipse: Ellipse, longitudinal, lateral, spin, elastic: Elastic) -> Resultants:
    """Forces [N] and moment [N mm] on the roller without any sliding: linear in the creepages.

    longitudinal xi, lateral eta [-], spin phi [1/mm]: rigid slip w = (eta - phi y, xi + phi x), arrays (n,).
    Validity: creepages so small that the friction bound is nowhere reached.
    """
    c = creepage_coefficients(ellipse.semi_axis_rolling / ellipse.semi_axis_lateral, elastic.poisson_ratio)
    square = ellipse.semi_axis_rolling * ellipse.semi_axis_lateral
    g = elastic.shear_modulus
    return Resultants(
        g * (-square * c.c22 * lateral + square**1.5 * c.c23 * spin),
        -g * square * c.c11 * longitudinal,
        -g * (square**1.5 * c.c23 * lateral + square**2 * c.c33 * spin),
    )


@lru_cache(maxsize=1)
def _sliding_integrals() -> np.ndarray:
    """Chebyshev coefficients in ln(ratio) of the logarithms of the three integrals of `sliding_flexibility`."""
    ratio, _ = _nodes()
    a, b = 1.0 / ratio[:, None], 1.0
    t = np.pi * (np.arange(8192) + 0.5) / 8192
    cos, sin = np.cos(t), np.sin(t)
    # directions phi with tan(phi) = (b/a) tan(t), which are dense where the integrand is steep
    size = np.hypot(a * cos, b * sin)
    c, s, step = a * cos / size, b * sin / size, a * b / size**2 * np.pi / t.size
    cube = step * size**3
    parts = (c**2 / a**2, c**4 / a**2, s**2 * c**2 * (1 / a**2 + 1 / b**2))
    values = np.stack([(part * cube).sum(axis=1) for part in parts], axis=1)
    return np.linalg.inv(chebvander(chebpts1(NODES[0]), NODES[0] - 1)) @ np.log(values)


def sliding_flexibility(axis_ratio, poisson_ratio) -> np.ndarray:
    """Flexibilities of x and y that full sliding with its pole far away asks of a simplified theory, over b/G: (n, 2).

    There the traction is mu p along y and turns across it as the rigid slip does, q_x ~ y mu p. The displacements of
    both are polynomials (Galin), and the flexibility L follows from equal lateral force, to the first order in the
    elasticity, of u and of u = L tau:

        L_x = 8/(15 G) int_0^pi (1 - nu + nu cos^2) cos^2/(a^2 l^3)
        L_y = 8/(15 G) int_0^pi [(1 - nu + nu sin^2) cos^2/a^2 + nu sin^2 cos^2/b^2]/l^3,  l^2 = cos^2/a^2 + sin^2/b^2

    Arguments as in `creepage_coefficients`.
    """
    ratio, nu = np.broadcast_arrays(np.asarray(axis_ratio, float), np.asarray(poisson_ratio, float))
    one, four, mixed = np.exp(chebval(np.log(ratio) / np.log(LARGEST_RATIO), _sliding_integrals()))
    return 8.0 / 15.0 * np.stack([(1 - nu) * one + nu * four, (1 - nu) * one + nu * mixed], axis=-1)
