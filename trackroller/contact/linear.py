"""Kalker's linear creepage coefficients for any ellipse, and the forces of the linear theory.

The coefficients come from a stored table, which `python -m validation.derivations.linear_creepage`
writes. Chebyshev polynomials interpolate it in the logarithm of the axis ratio and in Poisson's
ratio. `tests/contact` compares the coefficients with Kalker's printed table (1990, table E.3) and
with rectangular elements. The printed table is about 1 % low at the axis ratios 5 and 10.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

import numpy as np
from numpy.polynomial.chebyshev import chebpts1, chebval, chebvander

from trackroller.contact.quantities import Resultants
from trackroller.contact.slip import Creepage
from trackroller.errors import InputError
from trackroller.numerics.compiled import compiled

LARGEST_RATIO = 50.0  # of b/a; the smallest ratio is its inverse
NODES = (21, 7)  # of ln(ratio) and of nu
TABLE = "kalker_linear.csv"


@dataclass(frozen=True)
class CreepageCoefficients:
    """C11 (rolling direction), C22 (lateral), C23 (lateral force by spin), C33 (spin moment) [1],
    arrays (n,).
    """

    c11: np.ndarray
    c22: np.ndarray
    c23: np.ndarray
    c33: np.ndarray


def nodes() -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes of the table: axis ratios (21,) and Poisson's ratios (7,) [1]."""
    return np.exp(np.log(LARGEST_RATIO) * chebpts1(NODES[0])), 0.25 + 0.25 * chebpts1(NODES[1])


@lru_cache(maxsize=1)
def chebyshev() -> np.ndarray:
    """Return Chebyshev coefficients of the logarithms of C11, C22, C23, C33, (4, nodes of ratio,
    nodes of nu).
    """
    text = resources.files("trackroller.contact").joinpath(TABLE).read_text(encoding="utf-8")
    values = np.loadtxt(text.splitlines(), delimiter=",")[:, 2:].reshape(*NODES, 4)
    u, v = (np.linalg.inv(chebvander(chebpts1(n), n - 1)) for n in NODES)
    return np.ascontiguousarray(np.einsum("ij,kl,jlc->cik", u, v, np.log(values)))


@compiled
def logarithm(ratio, poisson_ratio, series):
    """Return the logarithm of the creepage coefficient with the Chebyshev `series` (nodes of ratio,
    nodes of nu).
    """
    u, v = math.log(ratio) / math.log(LARGEST_RATIO), 4.0 * poisson_ratio - 1.0
    total, now, before = 0.0, 1.0, u  # Chebyshev polynomials of u, and of v below
    for i in range(series.shape[0]):
        line, power, last = 0.0, 1.0, v
        for k in range(series.shape[1]):
            line += power * series[i, k]
            power, last = 2.0 * v * power - last, power
        total += now * line
        now, before = 2.0 * u * now - before, now
    return total


@compiled
def _logarithms(ratio, poisson_ratio, series, out):
    """Write the logarithms of all creepage coefficients into `out` (4, n)."""
    for field in range(out.shape[0]):
        for i in range(out.shape[1]):
            out[field, i] = logarithm(ratio[i], poisson_ratio[i], series[field])


def creepage_coefficients(axis_ratio, poisson_ratio) -> CreepageCoefficients:
    """Return Kalker's linear creepage coefficients.

    Parameters
    ----------
    axis_ratio : array_like, shape (n,)
        b/a, the semi-axis in the rolling direction over the lateral one, from 0.02 to 50 [1].
        Kalker calls it a/b.
    poisson_ratio : array_like, shape (n,)
        Combined Poisson's ratio from 0 to 0.5 [1].

    Returns
    -------
    CreepageCoefficients
        Arrays of the broadcast shape.

    Raises
    ------
    InputError
        If a value lies outside these ranges.
    """
    ratio, nu = np.broadcast_arrays(np.asarray(axis_ratio, float), np.asarray(poisson_ratio, float))
    edge = LARGEST_RATIO * (1 + 1e-12)
    if not np.all((ratio >= 1 / edge) & (ratio <= edge)):
        allowed = f"values between {1 / LARGEST_RATIO:g} and {LARGEST_RATIO:g}"
        raise InputError("axis_ratio", axis_ratio, allowed, "Leave out more slender patches.")
    if not np.all((nu >= 0) & (nu <= 0.5)):
        raise InputError(
            "poisson_ratio", poisson_ratio, "values between 0 and 0.5", "Correct the material."
        )
    values = np.empty((4, ratio.size))
    _logarithms(np.array(ratio.reshape(-1)), np.array(nu.reshape(-1)), chebyshev(), values)
    return CreepageCoefficients(*np.exp(values).reshape(4, *ratio.shape))


def linear_resultants(
    a, b, creep: Creepage, shear_modulus, coefficients: CreepageCoefficients
) -> Resultants:
    """Return the forces and the spin moment of the linear theory, in which no element slides.

    Parameters
    ----------
    a, b : ndarray, shape (n,)
        Lateral and rolling semi-axis [mm].
    creep : Creepage
        Rigid slip w = (eta - phi y, xi + phi x) [1], [1/mm].
    shear_modulus : ndarray, shape (n,)
        Combined shear modulus G [MPa].
    coefficients : CreepageCoefficients
        See `creepage_coefficients`.

    Returns
    -------
    Resultants
        Forces [N] and spin moment [N mm] on the roller, (n,).

    Notes
    -----
    Valid for creepages so small that the traction reaches the friction bound nowhere.
    """
    xi, eta, phi, c = creep.longitudinal, creep.lateral, creep.spin, coefficients
    size, stiffness = np.sqrt(a * b), a * b * shear_modulus
    return Resultants(
        -stiffness * (c.c22 * eta - size * c.c23 * phi),
        -(stiffness * c.c11 * xi),
        -stiffness * size * (c.c23 * eta + size * c.c33 * phi),
    )


@lru_cache(maxsize=1)
def _sliding_integrals() -> np.ndarray:
    """Return Chebyshev coefficients in ln(ratio) of the logarithms of the integrals of
    `sliding_flexibility`.
    """
    ratio, _ = nodes()
    a, b = 1.0 / ratio[:, None], 1.0
    t = np.pi * (np.arange(8192) + 0.5) / 8192
    cos, sin = np.cos(t), np.sin(t)
    # The substitution tan(phi) = (b/a) tan(t) places the directions phi densely where the integrand
    # is steep.
    size = np.hypot(a * cos, b * sin)
    c, s, step = a * cos / size, b * sin / size, a * b / size**2 * np.pi / t.size
    cube = step * size**3
    parts = (c**2 / a**2, c**4 / a**2, s**2 * c**2 * (1 / a**2 + 1 / b**2))
    values = np.stack([(part * cube).sum(axis=1) for part in parts], axis=1)
    return np.linalg.inv(chebvander(chebpts1(NODES[0]), NODES[0] - 1)) @ np.log(values)


def sliding_flexibility(axis_ratio, poisson_ratio) -> np.ndarray:
    """Return the flexibilities of the simplified theory for full sliding with a distant spin pole.

    Parameters
    ----------
    axis_ratio, poisson_ratio : array_like, shape (n,)
        See `creepage_coefficients`.

    Returns
    -------
    numpy.ndarray, shape (n, 2)
        Flexibilities L_x and L_y over b/G [1].

    Notes
    -----
    With a distant pole, the traction is mu p along y, and its lateral part follows the rigid slip,
    q_x ~ y mu p. The displacements of both tractions are polynomials (Galin's theorem). The
    flexibility L is chosen so that u and L tau give the same lateral force to first order in the
    elasticity:

        L_x = 8/(15 G) int_0^pi (1 - nu + nu cos^2) cos^2/(a^2 l^3) L_y = 8/(15 G) int_0^pi [(1 - nu
        + nu sin^2) cos^2/a^2 + nu sin^2 cos^2/b^2]/l^3,  l^2 = cos^2/a^2 + sin^2/b^2
    """
    ratio, nu = np.broadcast_arrays(np.asarray(axis_ratio, float), np.asarray(poisson_ratio, float))
    one, four, mixed = np.exp(chebval(np.log(ratio) / np.log(LARGEST_RATIO), _sliding_integrals()))
    return 8.0 / 15.0 * np.stack([(1 - nu) * one + nu * four, (1 - nu) * one + nu * mixed], axis=-1)
