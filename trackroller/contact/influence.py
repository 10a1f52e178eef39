"""Influence functions of steady rolling on the elastic half-space, and their fast products.

The displacement differences of rectangular elements with constant traction are closed forms of Cerruti's and
Boussinesq's solutions (Kalker 1990, Three-Dimensional Elastic Bodies in Rolling Contact, chapter 3). The slip needs
their derivative in the rolling direction, which is y here and x in Kalker and CONTACT.

Lengths are scaled by c = sqrt(a b), tractions by the largest traction bound, slips by this bound over G.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from rocket_fft import c2c

from trackroller.numerics.compiled import compiled, fast, formula

ROUND = 1e-5  # least |a^2 - b^2|/(a b) at which the closed form for ellipses keeps its digits; the form errs by less
THIRD = 1.0 / 3.0
# Elements of constant traction make the adhesion area end 0.16 elements too close to the leading edge, however many
# elements there are. The tractions at its trailing end therefore err with first order. Subtracting SHARPER times the
# second differences of the influence functions mends this: against the closed form of Carter's rolling contact,
# the end of the adhesion area then errs by less than 0.03 elements in the mean.
SHARPER = 1.0 / 12.0
DIGITS = 13  # digits of element sizes and Poisson's ratio; patches that differ by rounding share influence functions


@fast
def _log_part(x, y):
    """Return x asinh(y / |x|), 0 at x = 0."""
    return 0.0 if x == 0.0 else x * math.asinh(y / abs(x))


@compiled
def displacements(hx, hy, poisson, ny, nx, below, above):
    """Return the displacement differences at distances (j hy, i hx) of a unit traction on an element, for G = 1.

    Kalker (1990) chapter 3: u_x = 1/(pi G) int [(1-nu)/r + nu x^2/r^3] tau_x + nu x y/r^3 tau_y.

    Parameters
    ----------
    hx, hy : float
        Element sides.
    poisson : float
        Combined Poisson's ratio [1].
    ny, nx : int
        Numbers of elements.
    below, above : int
        Additional rows at both ends.

    Returns
    -------
    numpy.ndarray, shape (3, 2 ny - 1 + below + above, 2 nx - 1)
        Components xx, yy, xy for j from -(ny-1)-below to ny-1+above and i from -(nx-1) to nx-1.
    """
    rows, columns, zero = 2 * ny - 1 + below + above, 2 * nx - 1, ny + below
    corner = np.empty((3, rows + 1, columns + 1))
    for j in range(rows, -1, -1):
        y, mirror = (j - zero + 0.5) * hy, 2 * zero - 1 - j
        for i in range(nx, columns + 1):
            x = (i - nx + 0.5) * hx
            if j < zero and mirror <= rows:  # the antiderivatives are odd or even in x and y
                for c in range(3):
                    corner[c, j, i] = corner[c, mirror, i] if c == 2 else -corner[c, mirror, i]
            else:
                along_y, along_x = _log_part(x, y), _log_part(y, x)  # int int y^2/r^3, int int x^2/r^3
                corner[0, j, i] = along_y * (1.0 - poisson) + along_x
                corner[1, j, i] = along_x * (1.0 - poisson) + along_y
                corner[2, j, i] = -poisson * math.sqrt(x * x + y * y)
            for c in range(3):
                corner[c, j, columns - i] = corner[c, j, i] if c == 2 else -corner[c, j, i]
    return _over_element(corner, 1.0 / math.pi)


@compiled
def _over_element(corner, factor):
    """Turn corner values (m, rows + 1, columns + 1) of a double antiderivative into integrals over elements."""
    out = np.empty((corner.shape[0], corner.shape[1] - 1, corner.shape[2] - 1))
    for c in range(out.shape[0]):
        for j in range(out.shape[1]):
            for i in range(out.shape[2]):
                ahead = corner[c, j + 1, i + 1] - corner[c, j + 1, i]
                out[c, j, i] = factor * (ahead - corner[c, j, i + 1] + corner[c, j, i])
    return out


@compiled
def pressure_displacements(hx, hy, ny, nx, below, above):
    """Return the tangential displacement differences x, y of a unit pressure on an element for G = K = 1, (2, ., .).

    u = -K/(pi G) int p r/|r|^2: the surfaces of both bodies move towards the load (Kalker 1990, section 1.5).
    Parameters as in `displacements`.
    """
    rows, columns = 2 * ny - 1 + below + above, 2 * nx - 1
    corner = np.empty((2, rows + 1, columns + 1))
    for j in range(rows + 1):
        y = (j - (ny - 1) - below - 0.5) * hy
        for i in range(columns + 1):
            x = (i - (nx - 1) - 0.5) * hx
            log = 0.5 * math.log(x * x + y * y)
            corner[0, j, i] = y * log + x * math.atan(y / x)
            corner[1, j, i] = x * log + y * math.atan(x / y)
    return _over_element(corner, -1.0 / math.pi)


@compiled
def _multipliers(kernel, ny, nx):
    """Return the spectrum (2 ny, 2 nx) of a complex influence function (2 ny - 1, 2 nx - 1) of the distances."""
    field = np.zeros((2 * ny, 2 * nx), np.complex128)
    for j in range(2 * ny - 1):
        for i in range(2 * nx - 1):
            field[(j - ny + 1) % (2 * ny), (i - nx + 1) % (2 * nx)] = kernel[j, i]
    c2c(field, field, np.array([0, 1]), True, 1.0, 1)
    return field


@fast
def _combined(p, q, z, out):
    """Write P Z + Q conj(Z(-k)) into `out`."""
    ly, lx = z.shape
    for i in range(ly):
        mirror = ly - i if i > 0 else 0
        for j in range(lx):
            a, b, c, d = p[i, j], q[i, j], z[i, j], z[mirror, lx - j if j > 0 else 0]
            real = a.real * c.real - a.imag * c.imag + b.real * d.real + b.imag * d.imag
            imag = a.real * c.imag + a.imag * c.real + b.imag * d.real - b.real * d.imag
            out[i, j] = complex(real, imag)


@compiled
def convolve(field, p, q, work, out):
    """Write the product of influence functions and tractions `field` into `out`, both (ny, nx).

    `p` and `q` are the spectra of `Influence`; `work` (2, 2 ny, 2 nx) serves the transforms.
    """
    ny, nx = field.shape
    # c2c(input, output, axes, forward, factor, threads); only the rows that hold tractions or slips are transformed
    c2c(field, work[0, :ny], np.array([1]), True, 1.0, 1)
    c2c(work[0, :ny], work[1], np.array([0]), True, 1.0, 1)
    _combined(p, q, work[1], work[0])
    c2c(work[0], work[1], np.array([0]), False, 0.5 / ny, 1)
    c2c(work[1, :ny], work[0, :ny], np.array([1]), False, 0.5 / nx, 1)
    for i in range(ny):
        for j in range(nx):
            out[i, j] = work[0, i, j]


@formula
def difference(behind, here, ahead, far, hy):
    """Return -du/dy of four displacements, one row behind to two rows ahead, with an error of third order.

    The material enters at the leading edge, which is ahead. A central difference alone would leave the shortest waves
    undetermined in the adhesion area. Upwind differences of second order, with two thirds of the central one, have no
    error of second order. About the spin pole, where the slip turns, this error would act on F_T with first order.
    """
    return (behind * THIRD + 0.5 * here - ahead + far * (0.5 * THIRD)) * (1.0 / hy)


@compiled
def _sharpened(u):
    """Return influence functions (3, m, n) less `SHARPER` times their second differences, (3, m - 2, n - 2)."""
    along = u[:, 1:-1] - SHARPER * (u[:, 2:] - 2.0 * u[:, 1:-1] + u[:, :-2])
    return along[:, :, 1:-1] - SHARPER * (along[:, :, 2:] - 2.0 * along[:, :, 1:-1] + along[:, :, :-2])


@compiled
def plane_displacements(hy, poisson, ny, below, above):
    """Return the displacement differences of a unit traction on an element of two discs, for G = 1.

    They are those of `displacements` for elements without end across the rolling direction, up to a constant that no
    slip contains: lateral ones in antiplane shear, -2/pi int ln|y|, longitudinal ones in plane strain, 1 - nu times it.

    Parameters
    ----------
    hy, poisson, ny, below, above
        As in `displacements`.

    Returns
    -------
    numpy.ndarray, shape (3, 2 ny - 1 + below + above, 1)
        Components xx, yy, xy.
    """
    rows, zero = 2 * ny - 1 + below + above, ny + below
    out = np.zeros((3, rows, 1))
    for j in range(rows):
        low = (j - zero + 0.5) * hy
        high = low + hy
        integral = high * math.log(abs(high)) - low * math.log(abs(low)) - hy
        out[0, j, 0] = -2.0 / math.pi * integral
        out[1, j, 0] = (1.0 - poisson) * out[0, j, 0]
    return out


@compiled
def _functions(hx, hy, poisson, ny, nx, rolling, sharpened, film):
    """Return the fields of `Influence`, of the slips in `rolling` or of the displacements."""
    more = int(sharpened)
    u = displacements(hx, hy, poisson, ny + more, nx + more, 1, 2)
    u = _sharpened(u) if sharpened else u
    return _influence_of(u, hy, ny, nx, rolling, film)


@compiled
def _plane_functions(hy, poisson, ny, film):
    """Return the fields of `Influence` of the slips of two discs."""
    return _influence_of(plane_displacements(hy, poisson, ny, 1, 2), hy, ny, 1, True, film)


@compiled
def _influence_of(u, hy, ny, nx, rolling, film):
    """Return the fields of `Influence` of displacements `u`, to which a `film` adds under an element itself."""
    for c in range(2):
        u[c, ny, nx - 1] += film
    kernel = u[:, 1 : 2 * ny].copy()
    if rolling:
        for c in range(3):
            for j in range(2 * ny - 1):
                for i in range(2 * nx - 1):
                    kernel[c, j, i] = difference(u[c, j, i], u[c, j + 1, i], u[c, j + 2, i], u[c, j + 3, i], hy)
    p, q = 0.5 * (kernel[0] + kernel[1]) + 0j, 0.5 * (kernel[0] - kernel[1]) + 1j * kernel[2]
    own = 0.5 * (u[0, ny : ny + 3, nx - 1] + u[1, ny : ny + 3, nx - 1])
    scale = (1.5 * own[0] - 2.0 * own[1] + 0.5 * own[2]) / hy if rolling else own[0]
    return _multipliers(p, ny, nx), _multipliers(q, ny, nx), scale, kernel[:2, :, nx - 1].copy()


class Influence(NamedTuple):
    """Influence functions of ny x nx elements for products by fast Fourier transforms; a field is x + iy.

    They give the slips in rolling, or the displacements.

    Attributes
    ----------
    p, q : numpy.ndarray, shape (2 ny, 2 nx)
        Spectra in W = P Z + Q conj(Z(-k)) of slips W and tractions Z.
    own : float
        Mean slip that an element's unit traction causes at itself, by upwind differences; the scale of slips.
    column : numpy.ndarray, shape (2, 2 ny - 1)
        Slips xx and yy that an element's unit traction causes in its own column, from ny - 1 rows behind it on.
    """

    p: np.ndarray
    q: np.ndarray
    own: float
    column: np.ndarray

    def product(self, field: np.ndarray) -> np.ndarray:
        """Return the slips, or the displacements, of tractions `field` (ny, nx)."""
        out = np.empty(field.shape, complex)
        convolve(field.astype(complex), self.p, self.q, np.empty((2, *self.p.shape), complex), out)
        return out


@lru_cache(maxsize=64)
def _influence(
    hx: float, hy: float, poisson: float, ny: int, nx: int, rolling: bool, sharpened: bool, film: float
) -> Influence:
    return Influence(*_functions(hx, hy, poisson, ny, nx, rolling, sharpened, film))


def rounded(*values: float) -> tuple[float, ...]:
    """Return numbers with DIGITS digits."""
    return tuple(float(f"{value:.{DIGITS}g}") for value in values)


def influence(
    hx: float,
    hy: float,
    poisson: float,
    ny: int,
    nx: int,
    rolling: bool = True,
    sharpened: bool = False,
    film: float = 0.0,
) -> Influence:
    """Return the influence functions of ny x nx elements of size hy x hx for G = 1; the last ones used are kept.

    `sharpened` influence functions place the trailing end of the adhesion area without an error of first order, see
    `SHARPER`. A `film` between the bodies moves each element by this length under a unit traction of its own.
    """
    hx, hy, poisson, film = rounded(hx, hy, poisson, film)
    return _influence(hx, hy, poisson, ny, nx, rolling, sharpened, film)


def plane_influence(hy: float, poisson: float, ny: int, film: float = 0.0) -> Influence:
    """Return the influence functions of two discs with ny elements of length hy, for G = 1, see `influence`."""
    return _plane_influence(*rounded(hy, poisson, film), ny)


@lru_cache(maxsize=64)
def _plane_influence(hy: float, poisson: float, film: float, ny: int) -> Influence:
    return Influence(*_plane_functions(hy, poisson, ny, film))


def coupling_slip(pressure: np.ndarray, hx: float, hy: float) -> np.ndarray:
    """Return the slip -du/dy (ny, nx), x + iy, of a pressure field (ny, nx) for K = G = 1, by central differences."""
    ny, nx = pressure.shape
    u = pressure_displacements(hx, hy, ny, nx, 1, 1)
    slip = 0.5 * (u[:, :-2] - u[:, 2:]) / hy
    p = _multipliers(slip[0] + 1j * slip[1], ny, nx)
    return Influence(p, np.zeros_like(p), 1.0, np.zeros((2, 1))).product(pressure)


@compiled
def hertz_coupling_slip(a, b, ny, nx):
    """Return the slip -du/dy, x + iy, of Hertz's pressure at the centres of elements, for p_max = K = G = 1.

    Parameters
    ----------
    a, b : float
        Semi-axes, lateral and in the rolling direction.
    ny, nx : int
        Numbers of elements over the box around the ellipse.

    Returns
    -------
    numpy.ndarray, shape (ny, nx)
        Slip at the centres of the elements.

    Notes
    -----
    u is the field of `pressure_displacements`. The pressure is a pile of elliptical layers of constant pressure. Inside
    a layer u is linear in x and y; outside, u follows from the analytic function z - sqrt(z^2 - c^2) of z = x + iy with
    c^2 = a^2 - b^2. The integral of du/dy over the layers is a closed form. It is computed for one quadrant.
    """
    square = a * a - b * b
    square = math.copysign(max(abs(square), ROUND * a * b), square)
    c = np.sqrt(complex(square))
    out = np.empty((ny, nx), np.complex128)
    for j in range(ny // 2, ny):
        y = b * ((2.0 * j + 1.0) / ny - 1.0)
        for i in range(nx // 2, nx):
            x = a * ((2.0 * i + 1.0) / nx - 1.0)
            z = complex(x, y)
            if z == 0.0:
                z = complex(1e-9 * a, 0.0)  # the centre of an odd number of elements
            height = math.sqrt(max(1.0 - (x / a) ** 2 - (y / b) ** 2, 0.0))
            root = z * np.sqrt(1.0 - (1.0 - height * height) * square / (z * z))
            outside = (2j * a * b / square) * (1.0 - height - z / c * np.log((c + z) / (c * height + root)))
            slip = outside.conjugate() + (2j * a / (a + b)) * height
            mirror = complex(-slip.real, slip.imag)
            out[j, i] = out[ny - 1 - j, nx - 1 - i] = slip
            out[j, nx - 1 - i] = out[ny - 1 - j, i] = mirror
    return out
