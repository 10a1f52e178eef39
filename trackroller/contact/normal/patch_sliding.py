"""Full sliding with an empirical spin pole under pressures solved on a grid.

This is the model of `contact.sliding`, eqs (21)-(30). The rules of the spin pole take half the
sides of the box around the patch as semi-axes. The pressure is constant in each element. The
integrals use Gauss points across the rolling direction and closed forms along it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trackroller.contact.friction_laws import FrictionLaw, constant
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.quantities import Resultants, SurfaceTractions, Works
from trackroller.contact.sliding import slip_field, slip_lines
from trackroller.contact.slip import Slip

POINTS = 4  # Gauss points across each element
# parts of each element along the rolling direction in which a falling friction law is constant
PIECES = 3
_TINY = 1e-13  # keeps logarithms finite on the column through the pole


@dataclass(frozen=True)
class SlidingPatches:
    """Friction of n patches.

    Attributes
    ----------
    resultants : Resultants
        Forces [N] and spin moment [N mm] on the roller, (n,).
    works : Works
        Dissipation per distance travelled [N], (n,).
    shear_lateral, shear_rolling : numpy.ndarray, shape (n, N, M)
        Mean shear of each element [MPa].
    """

    resultants: Resultants
    works: Works
    shear_lateral: np.ndarray
    shear_rolling: np.ndarray


def solve_sliding(
    patch: GridPatch,
    slip: Slip,
    friction: np.ndarray,
    spin_model: str = "skewed",
    law: FrictionLaw | None = None,
    travel_speed: np.ndarray | float = 1.0,
) -> SlidingPatches:
    """Compute the friction of n sliding patches, tau = -mu f(|v|) p v/|v|.

    Parameters
    ----------
    patch, slip : GridPatch, Slip
        Patches and their kinematics, arrays (n,).
    friction : numpy.ndarray, shape (n,)
        Coefficient mu [1].
    spin_model : str
        'concentric', 'edge' or 'skewed'.
    law : FrictionLaw, optional
        Friction as a function of the slip speed; constant if not given.
    travel_speed : numpy.ndarray, shape (n,), or float
        omega r_A [mm/s].

    Returns
    -------
    SlidingPatches
        Resultants, dissipation and shear.

    Notes
    -----
    On Hertz's ellipse with 40 elements the result agrees with `contact.sliding` within 1e-3 of mu
    F_N (tests/contact/test_normal_models.py).
    """
    n, rows, columns = patch.pressure.shape
    law, per_omega = law or constant(), travel_speed / slip.rolling_radius
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    total, shear = np.empty((n, 4)), np.empty((n, 2, rows, columns))
    hx, hy = 2 * patch.semi_axis_lateral / columns, 2 * patch.semi_axis_rolling / rows
    x = (patch.x[:, :, None] + 0.5 * hx[:, None, None] * nodes).reshape(n, columns * POINTS)
    along, offset = slip_lines(patch, slip, x, spin_model)
    for i in range(n):
        line = x[i], along[i], offset[i], slip.sine[i], patch.semi_axis_rolling[i]
        means = _column_means(*line, rows, law, per_omega[i])
        across = (
            (means.reshape(4, columns, POINTS, rows) * (0.5 * weights)[:, None])
            .sum(axis=2)
            .transpose(0, 2, 1)
        )
        bound = friction[i] * patch.pressure[i]
        shear[i] = across[:2] * bound
        total[i] = (across * bound).sum(axis=(1, 2)) * hx[i] * hy[i]
    works = Works.of_friction(total[:, 3] / slip.rolling_radius)
    return SlidingPatches(
        Resultants(total[:, 0], total[:, 1], total[:, 2]), works, shear[:, 0], shear[:, 1]
    )


def _column_means(x, along, offset, sine, half, m, law, per_omega) -> np.ndarray:
    """Return means over the m elements of each column of -v_x/|v|, -v_y/|v|, their moment and
    |v|/omega.

    The result has the shape (4, columns, m); `half` is half the length of the box [mm].
    """
    pieces = 1 if law.is_constant else PIECES
    edges = half * np.linspace(-1.0, 1.0, m * pieces + 1)
    eps = np.maximum(np.abs(along / sine), _TINY * half)[:, None]
    t = edges - offset[:, None]
    rho, angle = np.hypot(t, eps), np.arcsinh(t / eps)
    mixed = 0.5 * eps * eps * angle
    tilt, turn = np.diff(rho, axis=1), np.diff(eps * angle, axis=1)
    lever = np.diff(0.5 * t * rho - mixed, axis=1) + offset[:, None] * tilt
    speed = abs(sine) * np.diff(0.5 * t * rho + mixed, axis=1)
    sign, sign_along = np.sign(sine), np.where(along > 0, 1.0, -1.0)[:, None]
    parts = np.stack(
        [-sign * tilt, -sign_along * turn, sign * lever - x[:, None] * sign_along * turn, speed]
    )
    step = 2.0 * half / m
    if pieces > 1:
        parts = parts * law(speed / (step / pieces) * per_omega)
        parts = parts.reshape(4, x.size, m, pieces).sum(axis=3)
    return parts / step


def tractions(
    patch: GridPatch, slip: Slip, friction, spin_model="skewed", law=None, travel_speed=1.0
) -> SurfaceTractions:
    """Return pressure and mean shear of each element, and the slip at its centre; parameters as in
    `solve_sliding`.
    """
    solution = solve_sliding(patch, slip, friction, spin_model, law, travel_speed)
    moved = slip_field(patch, slip, patch.x[:, None, :], patch.y[:, :, None], spin_model)
    shear = solution.shear_lateral, solution.shear_rolling
    return SurfaceTractions.of_sliding(patch.x, patch.y, patch.pressure, shear, moved)
