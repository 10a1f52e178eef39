"""Full sliding with an empirical spin pole: the model of Wenzel et al. 2022, eqs (20)-(30).

The friction traction opposes the rigid slip everywhere, tau = -mu f(|v|) p v/|v|, with a friction
law f of the local slip speed; f = 1 is the paper's model. `contact.slip` has the slip,
`contact.sliding_kernels` the integrals.

Frame: x_C lateral, y_C in the rolling direction (Kalker and CONTACT use x for rolling).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trackroller.contact.friction_laws import FrictionLaw, constant
from trackroller.contact.quantities import Ellipse, Patch, Resultants, SurfaceTractions
from trackroller.contact.sliding_kernels import Rule, SlidingEllipses, Sums, integrate
from trackroller.contact.slip import (
    Slip,
    lateral_slip,
    pole_lateral,
    pole_line,
    pole_offset,
    pole_rolling,
    rolling_slip,
    spin_model_index,
)
from trackroller.halfspace.tractions import lengths
from trackroller.numerics.quadrature import clustered_rule
from trackroller.numerics.threads import share_rows


@dataclass(frozen=True)
class Integrals:
    """Resultants on the roller, and dissipation int |tau| |v| per angular speed omega [N mm per
    rad], (n,).

    The dissipation is the local product of the published model. With its empirical spin pole it
    need not equal the work done by the drive and tilting forces.
    """

    resultants: Resultants
    power: np.ndarray


def integrals(
    ellipse: Ellipse,
    slip: Slip,
    friction: np.ndarray,
    *,
    spin_model: str = "skewed",
    nodes: int = 16,
    law: FrictionLaw | None = None,
    travel_speed: np.ndarray | float = 1.0,
) -> Integrals:
    """Integrate the friction traction of eq. (30) over n patches.

    Parameters
    ----------
    ellipse, slip : Ellipse, Slip
        Patches and their kinematics, arrays (n,).
    friction : ndarray, shape (n,)
        Friction coefficient mu at rest.
    spin_model : str
        'concentric', 'edge' or 'skewed': the paper's assumptions 0, 1 and 2.
    nodes : int
        Gauss points per smooth piece.
    law : FrictionLaw, optional
        Friction over its value at rest as a function of the slip speed; constant if not given.
    travel_speed : ndarray, shape (n,), or float
        omega r_A [mm/s]; only a law that is not constant depends on it.

    Returns
    -------
    Integrals
        F_T = int tau_x, F_A = int tau_y [N], M_R = int (x tau_y - y tau_x) [N mm], and the
        dissipation, (n,).

    Notes
    -----
    Relative error against adaptive quadrature: about 1e-4 at 6 nodes and 1e-8 at 16
    (tests/contact/test_sliding.py); 1e-5 at 12 nodes under smooth laws and laws with few knots
    (tests/contact/test_friction_laws.py).
    """
    n = np.size(friction)
    law = constant() if law is None or law.is_constant else law  # a law that stays at 1 is constant
    patches = SlidingEllipses(
        *np.array((*_geometry(ellipse, slip), travel_speed / slip.rolling_radius))
    )
    sums = np.empty((4, n))
    out = Sums(*sums)
    model, table, rule = spin_model_index(spin_model), law.knots, Rule(*clustered_rule(nodes))
    share_rows(lambda first, last: integrate(first, last, patches, model, table, rule, out), n, 32)
    f_t, f_a, m_r, power = friction * ellipse.max_pressure * sums
    return Integrals(Resultants(f_t, f_a, m_r), power)


def _geometry(patch: Patch, slip: Slip) -> tuple[np.ndarray, ...]:
    """Return a, b, sine and cosine of the contact angle, r_C,G and r_Delta0: `SlidingEllipses`
    without speed.
    """
    axes = patch.semi_axis_lateral, patch.semi_axis_rolling
    return *axes, slip.sine, slip.cosine, slip.guide_profile_radius, slip.shift


def slip_lines(
    patch: Patch, slip: Slip, x: np.ndarray, spin_model: str
) -> tuple[np.ndarray, np.ndarray]:
    """Return v_y/omega and the y_C where v_x vanishes at lateral positions x, eqs (21), (22) and
    (25).

    Parameters
    ----------
    patch, slip : Patch, Slip
        Patches and their kinematics, arrays (n,). Half the sides of its box stand for the semi-axes
        of a patch that is not elliptical.
    x : ndarray, shape (n, ...)
        Lateral positions [mm].
    spin_model : str
        See `integrals`.

    Returns
    -------
    tuple of ndarray, shape (n, ...)
        Both values [mm].
    """
    column = (-1, *(1,) * (x.ndim - 1))
    given = *_geometry(patch, slip), patch.centre
    a, b, sine, cosine, radius, shift, middle = (np.reshape(v, column) for v in given)
    x_spin = pole_lateral(shift, sine) - middle
    line = pole_line(a, x_spin, pole_rolling(x_spin, a, b), spin_model_index(spin_model))
    return rolling_slip(x, sine, cosine, radius, shift), pole_offset(x - middle, a, *line)


def slip_field(patch: Patch, slip: Slip, x: np.ndarray, y: np.ndarray, spin_model: str = "skewed"):
    """Return the slip of the roller against the guide per travel speed omega r_A, eq. (24).

    Parameters
    ----------
    patch, slip, spin_model
        See `slip_lines`.
    x, y : ndarray, shape (n, ...)
        Points [mm]; the shapes broadcast.

    Returns
    -------
    tuple of ndarray
        Lateral and rolling part [1].
    """
    along, offset = slip_lines(patch, slip, x, spin_model)
    sine, r_a = (
        np.reshape(v, (-1, *(1,) * (x.ndim - 1))) for v in (slip.sine, slip.rolling_radius)
    )
    return lateral_slip(y, offset, sine) / r_a, along / r_a


def tractions(
    ellipse: Ellipse,
    slip: Slip,
    friction: np.ndarray,
    *,
    spin_model: str = "skewed",
    points: int = 41,
    law: FrictionLaw | None = None,
    travel_speed=1.0,
) -> SurfaceTractions:
    """Return pressure, shear and slip on a grid of `points` x `points` over each patch, by eqs
    (26)-(30).

    All fields are 0 outside the ellipse.

    Parameters
    ----------
    ellipse, slip, friction, spin_model, travel_speed
        See `integrals`.
    points : int
        Points from edge to edge along each axis; under a `law` the centres of as many elements.
    law : FrictionLaw, optional
        Friction law that is not constant.

    Returns
    -------
    SurfaceTractions
        Fields of shape (n, points, points); the surfaces stick nowhere.
    """
    unit = np.linspace(-1.0, 1.0, points)
    if law is not None:
        unit = (2.0 * np.arange(points) + 1.0) / points - 1.0
    x, y, pressure = ellipse.pressures(unit)
    slip_x, slip_y = slip_field(ellipse, slip, x[:, None, :], y[:, :, None], spin_model)
    speed = lengths(slip_x, slip_y)
    bound = friction[:, None, None] * pressure / np.where(speed > 0, speed, np.inf)
    if law is not None:
        bound = bound * law(speed * np.broadcast_to(travel_speed, len(x))[:, None, None])
    return SurfaceTractions.of_sliding(
        x, y, pressure, (-bound * slip_x, -bound * slip_y), (slip_x, slip_y)
    )


def tractions_full_slip(
    ellipse: Ellipse, friction: np.ndarray, direction: np.ndarray
) -> Resultants:
    """Return the resultants of tau_y = direction mu p everywhere, direction = -sign(F_Motor);
    arrays (n,).
    """
    zero = np.zeros_like(friction)
    return Resultants(zero, direction * friction * ellipse.normal_force, zero)
