"""Linear theory of rolling by polynomials: tractions P/sqrt(1 - r^2) on an ellipse without slip.

By Galin's theorem, these tractions displace the ellipse by a polynomial of the same degree. Without slip, the
displacement is u = (integral of the rigid slip along y) + f(x) with a free function f. The steady state is the solution
with P = 0 on the leading edge (Kalker 1967, On the rolling contact of two elastic bodies in the presence of dry
friction). The Boussinesq-Cerruti integrals are taken in polar coordinates about each point, because they are smooth
there.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from trackroller.contact import linear

MATCH = 1e4  # weight of the displacements against the leading edge in the least squares


def _basis(x: np.ndarray, y: np.ndarray, degree: int) -> np.ndarray:
    """Return products of Chebyshev polynomials of total degree up to `degree` = d, (..., (d + 1)(d + 2)/2)."""
    t_x, t_y = chebvander(x, degree), chebvander(y, degree)
    return np.concatenate([t_x[..., m : m + 1] * t_y[..., : degree - m + 1] for m in range(degree + 1)], axis=-1)


class LinearTheory:
    """Linear theory of elliptical patches; it stores the integrals that do not depend on shape and material.

    Parameters
    ----------
    degree : int
        Degree of the polynomials. The relative error of the coefficients is about 1e-4 at 12 and 1e-5 at 20.
    """

    def __init__(self, degree: int = 12) -> None:
        self.degree = degree
        turns = 2 * degree + 6
        angle = 2.0 * np.pi * (np.arange(turns) + 0.5) / turns
        nodes, weights = np.polynomial.legendre.leggauss(degree // 2 + 3)
        radius = np.sqrt((nodes + 1) / 2)
        self.x = (radius[:, None] * np.cos(angle)).ravel()
        self.y = (radius[:, None] * np.sin(angle)).ravel()
        self.weight = np.repeat(np.sqrt(weights), turns)
        self.directions = np.pi * (np.arange(2 * degree + 4) + 0.5) / (2 * degree + 4)
        self.chords = np.stack([self._chord(angle) for angle in self.directions])
        self._resultants(angle)
        edge = np.pi * (np.arange(6 * degree) + 0.5) / (6 * degree)
        self.edge = _basis(np.cos(edge), np.sin(edge), degree) * np.sqrt(np.pi / edge.size)

    def _chord(self, angle: float) -> np.ndarray:
        """Integrate each basis function over sqrt(1 - r^2) along the chord through each point, (points, basis)."""
        count = self.degree // 2 + 2
        nodes = np.cos(np.pi * (np.arange(count) + 0.5) / count)
        c, s = np.cos(angle), np.sin(angle)
        middle = -(self.x * c + self.y * s)
        half = np.sqrt(1.0 - (self.x**2 + self.y**2 - middle**2))
        t = middle[:, None] + half[:, None] * nodes
        return _basis(self.x[:, None] + t * c, self.y[:, None] + t * s, self.degree).mean(axis=1) * np.pi

    def _resultants(self, angle: np.ndarray) -> None:
        """Integrate the basis over sqrt(1 - r^2), with the factors 1, x and y, each (basis,)."""
        nodes, weights = np.polynomial.legendre.leggauss(self.degree + 2)
        radius = np.sqrt(1.0 - ((nodes + 1) / 2) ** 2)
        x, y = radius[:, None] * np.cos(angle), radius[:, None] * np.sin(angle)
        weights = np.pi / angle.size * weights[:, None] * np.ones_like(x)
        values = _basis(x, y, self.degree)
        self.force, self.force_x, self.force_y = (np.einsum("ij,ijb->b", weights * v, values) for v in (1.0, x, y))

    def _kernels(self, a: float, b: float, poisson: float) -> list[np.ndarray]:
        """Return the weights of the directions for u_xx, u_yy, u_xy; exact for the degree of the chords."""
        n = 1 << 13
        chi = np.pi * (np.arange(n) + 0.5) / n
        length = np.hypot(a * np.cos(chi), b * np.sin(chi))
        e_x, e_y = a * np.cos(chi) / length, b * np.sin(chi) / length
        frequency = np.fft.fftfreq(n, 1.0 / n)
        low = np.abs(frequency) < self.directions.size // 2
        waves = np.exp(2j * frequency[low] * (self.directions[:, None] - chi[0]))
        out = []
        for factor in (1.0 - poisson + poisson * e_x**2, 1.0 - poisson + poisson * e_y**2, poisson * e_x * e_y):
            spectrum = np.fft.fft(factor * a * b / length)[low] / n
            out.append((waves @ spectrum).real / self.directions.size)
        return out

    def coefficients(self, ratio: float, poisson: float) -> np.ndarray:
        """Return the creepage coefficients C11, C22, C23, C33.

        Parameters
        ----------
        ratio : float
            b/a, the semi-axis in the rolling direction over the lateral one [1].
        poisson : float
            Combined Poisson's ratio [1].

        Returns
        -------
        numpy.ndarray, shape (4,)
            Coefficients [1].

        Notes
        -----
        F_y = -G c^2 C11 xi, F_x = -G c^2 C22 eta + G c^3 C23 phi, M = -G c^3 C23 eta - G c^4 C33 phi with
        c^2 = a b, in the contact frame (x lateral, y rolling, w = (eta - phi y, xi + phi x)).
        """
        b = np.sqrt(ratio)
        a = 1.0 / b
        u_xx, u_yy, u_xy = (np.tensordot(w, self.chords, axes=(0, 0)) for w in self._kernels(a, b, poisson))
        q = MATCH * self.weight[:, None]
        free = q * chebvander(self.x, self.degree)
        none, edge_none = np.zeros_like(free), np.zeros_like(self.edge)
        edge_free = np.zeros((self.edge.shape[0], self.degree + 1))
        matrix = np.block(
            [
                [q * u_xx, q * u_xy, free, none],
                [q * u_xy, q * u_yy, none, free],
                [self.edge, edge_none, edge_free, edge_free],
                [edge_none, self.edge, edge_free, edge_free],
            ]
        )
        x, y, zero = a * self.x, b * self.y, np.zeros_like(self.x)
        edge_zero = np.zeros(2 * self.edge.shape[0])
        # The displacements are the integrals along y of the rigid slips (0, 1), (1, 0) and (-y, x).
        rigid = ((zero, y), (y, zero), (-y * y / 2, x * y))
        right = np.stack([np.concatenate([q[:, 0] * u, q[:, 0] * v, edge_zero]) for u, v in rigid], axis=1)
        scale = np.linalg.norm(matrix, axis=0)
        solution = np.linalg.lstsq(matrix / scale, right, rcond=1e-15)[0] / scale[:, None]
        p_x, p_y = solution[: self.force.size], solution[self.force.size : 2 * self.force.size]
        moment = a * self.force_x @ p_y - b * self.force_y @ p_x
        c_23 = 0.5 * (self.force @ p_x[:, 2] - moment[1])  # C23 = C32 by reciprocity
        return np.array([-self.force @ p_y[:, 0], -self.force @ p_x[:, 1], c_23, -moment[2]])


def tabulate(degree: int = 20) -> np.ndarray:
    """Compute the stored table at the interpolation nodes.

    Parameters
    ----------
    degree : int
        Degree of the polynomials of `LinearTheory`.

    Returns
    -------
    numpy.ndarray, shape (147, 6)
        Rows (ratio, nu, C11, C22, C23, C33) [1].
    """
    theory = LinearTheory(degree)
    ratios, poisson = linear.nodes()
    return np.array([[r, nu, *theory.coefficients(r, nu)] for r in ratios for nu in poisson])


def write_table(path) -> None:
    """Write the table of `tabulate` to a CSV file."""
    header = (
        "linear creepage coefficients, computed by validation.derivations.linear_creepage\nratio,nu,C11,C22,C23,C33"
    )
    np.savetxt(path, tabulate(), delimiter=",", fmt="%.9g", header=header)


if __name__ == "__main__":
    write_table(Path(linear.__file__).with_name(linear.TABLE))
