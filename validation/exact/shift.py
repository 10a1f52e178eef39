"""Shift of a patch from rest, solved on the same elements and by the same method as steady rolling.

The slip of one step from the state without shear is S = W + u. Here W is the rigid shift of the roller against the
guide, and u is the displacement difference. Dry friction holds for S (Kalker 1990, section 4.1; Cattaneo 1938;
Mindlin 1949). Exact solutions are known for this problem, so it verifies the elements and the iteration.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from trackroller.contact.influence import influence
from trackroller.contact.kalker.cells import unit_cells
from trackroller.contact.kalker.newton import Problem, newton, room_for
from trackroller.contact.quantities import Elastic, Ellipse, Resultants


@dataclass(frozen=True)
class ShiftSolution:
    """Solution of one shifted patch.

    Attributes
    ----------
    resultants : Resultants
        Forces on the roller [N] and moment [N mm], arrays (1,).
    traction : ndarray, shape (2, ny, nx)
        Lateral and rolling component over mu p_max [1].
    stick : ndarray of bool, shape (ny, nx)
        True where the surfaces stick.
    stick_fraction : float
        Share of the adhesion area in the patch [1].
    residual : float
        Largest residual of the friction law over mu p_max [1].
    """

    resultants: Resultants
    traction: np.ndarray
    stick: np.ndarray
    stick_fraction: float
    residual: float


def shift_patch(
    ellipse: Ellipse,
    lateral: float,
    rolling: float,
    turn: float,
    friction: float,
    elastic: Elastic,
    elements: int = 40,
    tolerance: float = 1e-8,
) -> ShiftSolution:
    """Solve for the tractions of one patch after a rigid shift from rest under constant pressure.

    Parameters
    ----------
    ellipse : Ellipse
        One Hertzian patch, arrays (1,).
    lateral, rolling : float
        Shift of the roller against the guide along x_C and y_C [mm].
    turn : float
        Rotation of the roller about z_C [rad].
    friction : float
        Friction coefficient mu > 0 [1].
    elastic : Elastic
        Combined constants, scalars or arrays (1,). The coupling constant is not used.
    elements : int
        Elements along each axis.
    tolerance : float
        Largest residual of the friction law over mu p_max [1].

    Returns
    -------
    ShiftSolution
        Tractions, adhesion area and resultants.

    Notes
    -----
    The shift is one step, so the slip keeps its direction during the shift. This is exact for shifts in one direction.
    """
    a, b, p, g, nu = (
        float(np.ravel(v)[0])
        for v in (
            ellipse.semi_axis_lateral,
            ellipse.semi_axis_rolling,
            ellipse.max_pressure,
            elastic.shear_modulus,
            elastic.poisson_ratio,
        )
    )
    height, share = unit_cells(elements, elements)
    unit = (2.0 * np.arange(elements) + 1.0) / elements - 1.0
    x, y = a * unit[None, :], b * unit[:, None]
    c = math.sqrt(a * b)
    functions = influence(2.0 * a / (elements * c), 2.0 * b / (elements * c), nu, elements, elements, rolling=False)
    rigid = ((lateral - turn * y) + 1j * (rolling + turn * x)) * g / (friction * p * c)
    problem = Problem(functions, rigid, height, 0.0, np.zeros(1), np.ones(1))
    room = room_for(elements, elements, 80)
    (traction, slip), residual, _, _ = newton(problem, room, np.zeros_like(rigid), tolerance, 60)
    scale = friction * p * 4.0 * a * b / elements**2
    sums = np.array([traction.real.sum(), traction.imag.sum(), (x * traction.imag - y * traction.real).sum()]) * scale
    stick = (height > 0) & (np.abs(traction - slip / functions.own) <= room.bound)
    fraction = float(share[stick].sum() / share.sum())
    field = np.stack([traction.real, traction.imag])
    return ShiftSolution(Resultants(*sums[:, None]), field, stick, fraction, residual)
