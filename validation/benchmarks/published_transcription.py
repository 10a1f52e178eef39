"""Time a plain NumPy transcription of the paper's stress calculation, eqs. (1)-(6), under the tractions of `sliding`.

Written from the equations of Wenzel et al., Appl. Mech. 2022, 3, 692-704, and not from any program: the derivatives of
Omega come from SymPy (as in the paper), are evaluated on n x n surface points, weighted with the tractions and
integrated by Simpson's rule; displacement gradients and Hooke's law follow as printed. One point per evaluation, as
an optimiser asks for them. The peak is sought by SciPy's differential evolution with its default settings.

Two styles give the same numbers at very different cost, so `validation.benchmarks.speed` measures both:
"printed"  every integral is evaluated where it stands in eqs. (4)-(5), by scipy.integrate.simpson;
"reused"   each of the twenty derivatives of Omega is evaluated once per point and each integral is a weighted sum:
           the same mathematics written with care, some twenty times faster.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import sympy as sp
from scipy.integrate import simpson
from scipy.optimize import differential_evolution

import trackroller as tr
from trackroller.halfspace.influence import corner_loads, stress_parts
from trackroller.halfspace.stress import body_stress, von_mises
from trackroller.materials import load_database
from trackroller.parameters.accuracy import PRESETS

POINTS = 40  # surface points per direction
POPSIZE = 15  # scipy's default; 3 unknowns make a population of 45
AXES = "xyz"
_ORDERS = [(i, j, 3 - i - j) for i in range(4) for j in range(4 - i)] + [
    (i, j, 4 - i - j)
    for i in range(4)
    for j in range(4 - i)  # every fourth derivative has at least one z
]
STYLES = ("printed", "reused")


@dataclass(frozen=True)
class Contact:
    """One contact patch: nodes x (nx,), y (ny,) [mm], tractions q_x, q_y, q_z (ny, nx) on the body [MPa], nu."""

    x: np.ndarray
    y: np.ndarray
    q_x: np.ndarray
    q_y: np.ndarray
    q_z: np.ndarray
    poisson_ratio: float


@cache
def derivatives_of_omega() -> dict:
    """Return functions of (x - xi, y - eta, z, rho): the derivatives of Omega, eqs. (2)-(3), by orders in x, y, z."""

    x, y, z = sp.symbols("x y z", real=True)
    name = sp.Symbol("rho", positive=True)
    rho = sp.sqrt(x**2 + y**2 + z**2)
    omega = z * sp.log(rho + z) - rho
    # `factor` replaces `simplify`, which takes minutes; the symbol rho shortens the expressions
    return {
        (i, j, k): sp.lambdify((x, y, z, name), sp.factor(sp.diff(omega, x, i, y, j, z, k).subs(rho, name)), "numpy")
        for i, j, k in _ORDERS
    }


def _integrals(contact: Contact, point: Sequence[float], style: str):
    """Return a function Q(load, along): the derivative of the potential Q_load, eq. (1), along the named axes."""
    x, y, z = point
    # Omega depends on x - xi: derivatives with respect to x
    u, v = x - contact.x[None, :], y - contact.y[:, None]
    q = dict(zip(AXES, (contact.q_x, contact.q_y, contact.q_z), strict=True))
    if style == "printed":

        def integral(load: str, along: str) -> float:
            rho = np.sqrt(u**2 + v**2 + z**2)
            omega = derivatives_of_omega()[tuple(along.count(axis) for axis in AXES)](u, v, z, rho)
            return float(simpson(simpson(q[load] * omega, x=contact.x, axis=1), x=contact.y))

        return integral
    rho = np.sqrt(u**2 + v**2 + z**2)
    table = {order: f(u, v, z, rho) for order, f in derivatives_of_omega().items()}
    weights = np.outer(*(simpson(np.eye(nodes.size), x=nodes, axis=1) for nodes in (contact.y, contact.x)))
    sums = {(load, order): float(np.sum(weights * q[load] * d)) for load in AXES for order, d in table.items()}
    return lambda load, along: sums[load, tuple(along.count(axis) for axis in AXES)]


def stress_at(contact: Contact, point: Sequence[float], style: str = "printed") -> np.ndarray:
    """Return sigma_x, sigma_y, sigma_z, tau_xy, tau_yz, tau_xz [MPa] at one point z > 0, eqs. (1)-(5). (6,)."""
    z, nu = point[2], contact.poisson_ratio
    Q = _integrals(contact, point, style)

    def gradient(i: str, j: str) -> float:
        """Return d(E / (1 + nu) u_i) / dj, eq. (5) and its two companions; the last term by the product rule."""
        value = -z * sum(Q(load, load + "z" + i + j) for load in AXES)
        if j == "z":
            value -= sum(Q(load, load + "z" + i) for load in AXES)
        if i == "z":
            value += Q("z", "zz" + j) + (1 - 2 * nu) * sum(Q(load, load + "z" + j) for load in AXES)
        else:
            value += 2 * Q(i, "zz" + j) - Q("z", i + "z" + j) + 2 * nu * sum(Q(load, load + i + j) for load in AXES)
        return value / (2 * np.pi)

    def normal(i: str) -> float:  # eq. (4); E / (1 + nu) has cancelled
        dilatation = gradient("x", "x") + gradient("y", "y") + gradient("z", "z")
        return nu / (1 - 2 * nu) * dilatation + gradient(i, i)

    def shear(i: str, j: str) -> float:
        return (gradient(i, j) + gradient(j, i)) / 2

    return np.array([*map(normal, AXES), shear("x", "y"), shear("y", "z"), shear("x", "z")])


def equivalent(stress: np.ndarray) -> float:
    """Return sigma_DEH, eq. (6) [MPa]."""
    sx, sy, sz, txy, tyz, txz = stress
    return float(np.sqrt(0.5 * ((sx - sy) ** 2 + (sz - sx) ** 2 + (sy - sz) ** 2 + 6 * (txy**2 + txz**2 + tyz**2))))


def search_box(contact: Contact) -> list[tuple[float, float]]:
    """Return the bounds of the search: the patch; in depth from 1.5 grid steps to its half width."""
    x, y = contact.x, contact.y
    deepest = max(x[-1] - x[0], y[-1] - y[0]) / 2
    start = 1.5 * max(x[1] - x[0], y[1] - y[0])
    return [(x[0], x[-1]), (y[0], y[-1]), (start, max(deepest, 2 * start))]


def evaluations_of_search(contact: Contact, seed: int = 1) -> int:
    """Count the evaluations of SciPy's differential evolution (popsize 15, polish) with our faster kernels."""
    loads = corner_loads(contact.x, contact.y, np.stack([contact.q_x, contact.q_y, contact.q_z], -1))
    count = 0

    def negative(point: np.ndarray) -> float:
        nonlocal count
        count += 1
        parts = stress_parts(loads, np.asarray(point, dtype=float)[None])[0]
        return -float(von_mises(body_stress(parts, contact.poisson_ratio, 1.0)))

    differential_evolution(negative, search_box(contact), popsize=POPSIZE, rng=seed)
    return count


def contacts_of_case(case: tr.Case, points: int = POINTS) -> list[Contact]:
    """Return both contacts on the roller of a case, with the forces, ellipses and tractions of `sliding`."""
    accuracy = replace(PRESETS["standard"], traction_points=points)
    ds = tr.solve(case, outputs=("tractions",), contact_model="sliding", accuracy=accuracy).squeeze()
    nu = load_database().material(case.roller_material).poisson_ratio
    names = ("patch_x", "patch_y", "shear_lateral", "shear_rolling", "pressure")
    return [Contact(*(ds.isel(contact=k)[name].values for name in names), nu) for k in (0, 1)]


def time_transcription(
    contacts: Sequence[Contact], style: str = "printed", sample: int = 20, seed: int = 1
) -> dict[str, Any]:
    """Return the processor time that the transcription needs for the peaks of one case (both contacts, one body each).

    Times `sample` evaluations at random points of each contact and multiplies by the evaluations that the search takes.
    SymPy's derivation is not counted.

    Returns
    -------
    dict
        `seconds`, `evaluations`, `points` of the patch across, `style`.
    """
    rng = np.random.default_rng(seed)
    seconds, evaluations = 0.0, 0
    for contact in contacts:
        low, high = np.array(search_box(contact)).T
        places = rng.uniform(low, high, (sample, 3))
        stress_at(contact, places[0], style)  # the measured time leaves out the derivation and the first call
        start = time.process_time()
        for place in places:
            equivalent(stress_at(contact, place, style))
        each = (time.process_time() - start) / sample
        count = evaluations_of_search(contact, seed)
        seconds, evaluations = seconds + each * count, evaluations + count
    return {"seconds": seconds, "evaluations": evaluations, "points": contacts[0].x.size, "style": style}
