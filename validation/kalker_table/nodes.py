"""Nodes of the table of the exact theory, and the dimensionless patches that belong to them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from trackroller.contact import kalker
from trackroller.contact.linear import creepage_coefficients
from trackroller.contact.quantities import Elastic, Ellipse
from trackroller.contact.table.coordinates import HALF_WAY, RATIOS, coupling_creepage, spin_arm

FRICTION, SHEAR_MODULUS = 0.3, 1e3  # of the solved problem; the dimensionless results do not depend on these values
PARTS = 16  # equal parts of the range of rho, 0 to 1; the nodes of rho are ends of some parts
LOG_RATIOS = (math.log(RATIOS[0]), math.log(RATIOS[1]))
SLIDING = 1e5  # r of the nodes at rho = 1
# Half the nodes of theta [deg], close where the spin pole leaves a slender patch and the forces bend sharply.
CLOSE = (3.5, 10.5, 17.5, 24.5, 31.5, 38.5, 45.0, 50.5, 55.0, 58.5, 61.5, 64.5, 68.5, 73.5, 80.0, 87.0)


@dataclass(frozen=True)
class Nodes:
    """Nodes of the coordinates.

    Attributes
    ----------
    levels : numbers n of the nodes rho = n / `PARTS` above 0
    chi : number of nodes of chi
    half_theta : nodes of theta above 0 [rad]
    ratios : number of nodes of ln g
    """

    levels: tuple[int, ...]
    chi: int
    half_theta: tuple[float, ...]
    ratios: int

    @property
    def rho(self) -> np.ndarray:
        """Return the nodes from 0 to 1."""
        return np.array([0, *self.levels]) / PARTS

    @property
    def chis(self) -> np.ndarray:
        """Return the nodes from 0 to half a step before 90 deg."""
        return np.arange(self.chi) * np.pi / (2 * self.chi - 1)

    @property
    def theta(self) -> np.ndarray:
        """Return the nodes, which are symmetric about 0."""
        half = np.array(self.half_theta)
        return np.concatenate([-half[::-1], half])

    @property
    def log_g(self) -> np.ndarray:
        """Return the nodes of the logarithm of the axis ratio."""
        return np.linspace(*LOG_RATIOS, self.ratios)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Return the numbers of nodes of chi, theta and ln g."""
        return self.chi, 2 * len(self.half_theta), self.ratios

    def mesh(self) -> tuple[np.ndarray, ...]:
        """Return chi, theta and g of all nodes of a level, (nodes,) each."""
        chi, theta, g = np.meshgrid(self.chis, self.theta, np.exp(self.log_g), indexing="ij")
        return chi.ravel(), theta.ravel(), g.ravel()


FORCES = Nodes((1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 15, 16), 11, tuple(np.deg2rad(CLOSE)), 10)
# the part that Poisson's ratio adds is small and smooth, so that fewer nodes suffice
POISSON = Nodes((2, 4, 5, 6, 7, 8, 10, 12, 14, 16), 4, tuple(np.deg2rad(np.arange(5.625, 90.0, 11.25))), 8)


def radius(rho) -> np.ndarray:
    """Return r of nodes rho; `SLIDING` at rho = 1."""
    rho = np.asarray(rho, float)
    return np.where(rho < 1.0, HALF_WAY * rho / np.where(rho < 1.0, 1.0 - rho, 1.0), SLIDING)


def problem(g, nu, r, chi, theta):
    """Return ellipse (c = 1 mm, N = 1 N), creepages, friction and constants of dimensionless patches, (n,) each.

    Parameters
    ----------
    g, nu, r, chi, theta : array_like, shape (n,) or ()
        Axis ratio, Poisson's ratio [1], length and angles [rad] of `table.coordinates`.
    """
    g, nu, r, chi, theta = (np.array(v, float) for v in np.broadcast_arrays(g, nu, r, chi, theta))
    ellipse = Ellipse(1 / np.sqrt(g), np.sqrt(g), np.full(g.shape, 1.5 / np.pi))
    c11 = creepage_coefficients(g, nu).c11
    bend = FRICTION / (SHEAR_MODULUS * c11)
    x, y, z = r * np.cos(chi) * np.sin(theta), r * np.cos(chi) * np.cos(theta), r * np.sin(chi)
    coupling = FRICTION * z / (c11 * coupling_creepage(g))
    elastic = Elastic(np.full(g.shape, SHEAR_MODULUS), nu, coupling)
    return ellipse, (x - z) * bend, y * bend / spin_arm(g), np.full(g.shape, FRICTION), elastic


def solve_exact(g, nu, r, chi, theta, elements: int) -> np.ndarray:
    """Return F_T/(mu N), F_A/(mu N), M_R/(mu N c) and the share of the adhesion area by elements, (n, 4)."""
    ellipse, xi, phi, mu, elastic = problem(g, nu, r, chi, theta)
    settings = kalker.KalkerSettings(elements=elements, tolerance=1e-5)
    s = kalker.solve_patch(ellipse, kalker.Creepage(xi, np.zeros_like(xi), phi), mu, elastic, settings)
    r = s.resultants
    forces = (v / FRICTION for v in (r.lateral_force, r.driving_force, r.spin_moment))
    return np.stack([*forces, s.stick_fraction], axis=1)
