"""Stresses on whole planes below the nodes of a grid: convolutions with the stresses of hat
loads.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft

from trackroller.halfspace.influence import NU
from trackroller.halfspace.kernels import bilinear_corner
from trackroller.numerics.compiled import compiled, fast


@compiled
def _mirror_hats(corners, area, signs, out):  # pragma: no cover (compiled)
    """Write second differences of corner values (ny + 2, nx + 2) and their signed mirror images to
    `out`.
    """
    for j in range(corners.shape[0] - 2):
        for i in range(corners.shape[1] - 2):
            ends = corners[j, i] + corners[j, i + 2] + corners[j + 2, i] + corners[j + 2, i + 2]
            beside = (
                corners[j, i + 1]
                + corners[j + 2, i + 1]
                + corners[j + 1, i]
                + corners[j + 1, i + 2]
            )
            value = (ends - 2.0 * beside + 4.0 * corners[j + 1, i + 1]) / area
            left, back = signs[0] if i > 0 else 1.0, signs[1] if j > 0 else 1.0
            out[j, i], out[j, -i], out[-j, i], out[-j, -i] = (
                value,
                left * value,
                back * value,
                left * back * value,
            )


@compiled
def hat_kernels(sides, nodes, depths, lengths, zero):  # pragma: no cover (compiled)
    """Return the stresses of unit hat loads at node offsets -(n - 1) to n - 1, for circular
    convolutions.

    Parameters
    ----------
    sides : tuple of float
        Grid spacings along x and y over the larger of the two [1].
    nodes : tuple of int
        Numbers n of nodes along x and y.
    depths : numpy.ndarray
        z >= 0 over the larger spacing, (depth,) [1].
    lengths : tuple of int
        Lengths of the convolution along y and x, at least 2 n - 1 each.
    zero : numpy.float32 or numpy.float64
        0 in the precision of the result.

    Returns
    -------
    numpy.ndarray
        (depth, load, component, y, x) [1]: loads q_x, q_y, p; the six components without nu, then
        the factors of nu in xx, yy and xy. Offset 0 has index 0, and -1 the last one.
    """
    nx, ny = nodes
    out = np.full((depths.size, 3, 9, lengths[0], lengths[1]), zero)
    corners = np.empty((27, ny + 2, nx + 2))
    for depth in range(depths.size):
        for j in range(ny + 2):
            for i in range(nx + 2):
                k = bilinear_corner(sides[0] * (i - 1.0), sides[1] * (j - 1.0), depths[depth])
                for load in range(3):
                    for c in range(6):
                        corners[9 * load + c, j, i] = k[6 * load + c]
                    for c in range(3):
                        corners[9 * load + 6 + c, j, i] = k[NU + 6 * load + c + c // 2]
        for load in range(3):
            for c in range(9):
                kind = c if c < 6 else c - 6 + (c - 6) // 2
                # xy and zx change their sign in the mirror image in x, xy and yz in y, and so do
                # q_x and q_y
                odd_x = (kind == 3 or kind == 5) != (load == 0)
                odd_y = (kind == 3 or kind == 4) != (load == 1)
                at, own = corners[9 * load + c], out[depth, load, c]
                _mirror_hats(
                    at, sides[0] * sides[1], (-1.0 if odd_x else 1.0, -1.0 if odd_y else 1.0), own
                )
    return out


@fast
def body_spectra(spectra, kernels, poisson_ratio, signs):  # pragma: no cover (compiled)
    """Return the Fourier transforms of the stresses of both bodies, (body, depth, component, y, x).

    Parameters
    ----------
    spectra : numpy.ndarray
        Transforms of q_x, q_y, p, (3, y, x) [MPa].
    kernels : numpy.ndarray
        Transforms of `hat_kernels`, (depth, load, 9, y, x) [1].
    poisson_ratio, signs : numpy.ndarray
        nu of the bodies [1], and the signs of q_x and q_y on them, (body,).
    """
    depths, bodies, (long, wide) = len(kernels), poisson_ratio.size, spectra.shape[1:]
    out = np.empty((bodies, depths, 6, long, wide), dtype=spectra.dtype)
    load, kernel = spectra.reshape((3, long * wide)), kernels.reshape((depths, 3, 9, long * wide))
    stress = out.reshape((bodies, depths, 6, long * wide))
    for depth in range(depths):
        for c in range(6):
            k_x, k_y, k_p = kernel[depth, 0, c], kernel[depth, 1, c], kernel[depth, 2, c]
            by_nu = c + 6 if c < 2 else 8  # places of xx, yy and xy; the others do not depend on nu
            n_x, n_y, n_p = (
                kernel[depth, 0, by_nu],
                kernel[depth, 1, by_nu],
                kernel[depth, 2, by_nu],
            )
            for body in range(bodies):
                sign, nu = signs[body], poisson_ratio[body] if c < 2 or c == 3 else np.float32(0.0)
                for i in range(load.shape[1]):
                    sheared = load[0, i] * (k_x[i] + nu * n_x[i]) + load[1, i] * (
                        k_y[i] + nu * n_y[i]
                    )
                    stress[body, depth, c, i] = load[2, i] * (k_p[i] + nu * n_p[i]) + sign * sheared
    return out


def planes_below(
    tractions: np.ndarray,
    sides: tuple[float, float],
    depths: np.ndarray,
    poisson_ratio: ArrayLike,
    signs: ArrayLike,
) -> np.ndarray:
    """Return the stresses of bodies on planes below the nodes of a grid.

    Parameters
    ----------
    tractions : numpy.ndarray
        q_x, q_y, p at the nodes, (3, ny, nx) [MPa], bilinear between them. Their precision is that
        of the sums.
    sides : tuple of float
        Grid spacings along x and y [mm].
    depths : numpy.ndarray
        z >= 0 of the planes, (depth,) [mm].
    poisson_ratio, signs : array_like
        nu of the bodies [1], and the signs of q_x and q_y on them, (body,).

    Returns
    -------
    numpy.ndarray
        Stresses (body, depth, component, ny, nx) in the order of `stress.COMPONENTS` [MPa].
    """
    (_, ny, nx), unit, kind = tractions.shape, max(sides), tractions.dtype.type
    bodies = np.asarray(poisson_ratio, kind), np.asarray(signs, kind)
    lengths = fft.next_fast_len(2 * ny - 1), fft.next_fast_len(2 * nx - 1, real=True)
    loads, spacings = fft.rfft2(tractions, lengths), (sides[0] / unit, sides[1] / unit)
    out = np.empty((len(bodies[0]), depths.size, 6, ny, nx))
    for i in range(depths.size):  # one plane at a time saves memory
        hats = hat_kernels(spacings, (nx, ny), depths[i : i + 1] / unit, lengths, kind(0.0))
        spectra = body_spectra(loads, fft.rfft2(hats), *bodies)
        out[:, i] = fft.irfft2(spectra, lengths)[:, 0, :, :ny, :nx]
    return out
