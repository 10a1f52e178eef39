"""Two discs that roll on each other: the exact theory in plane strain, on a line of elements across
the contact.

The problem of each disc is the same at every place of its width, so that one column of elements is
enough. Longitudinal tractions act in plane strain, lateral ones in antiplane shear. Carter (1926)
solved longitudinal creepage of like discs in closed form; here any creepage, unlike discs and
friction laws are solved as on patches.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trackroller.contact.kalker import batch
from trackroller.contact.kalker.problem import KalkerSettings, PatchSolution
from trackroller.contact.quantities import Elastic, Resultants, SurfaceTractions
from trackroller.contact.slip import Creepage
from trackroller.numerics.rows import Rows

# along the contact, by the rung of accuracy
ELEMENTS = {"preview": 128, "standard": 256, "reference": 512}


@dataclass(frozen=True)
class LineContact(Rows):
    """Contacts of two discs with Hertz's pressure, arrays (n,).

    Attributes
    ----------
    half_length : numpy.ndarray
        Half length b of the contact in the rolling direction [mm].
    width : numpy.ndarray
        Width of the discs [mm].
    max_pressure : numpy.ndarray
        Largest pressure p_max [MPa].
    """

    half_length: np.ndarray
    width: np.ndarray
    max_pressure: np.ndarray

    @classmethod
    def of_load(cls, normal_force, width, curvature, modulus) -> LineContact:
        """Return the contacts of discs under a load.

        Parameters
        ----------
        normal_force, width : ndarray, shape (n,)
            F_N [N], and the width over which it is spread evenly [mm].
        curvature : ndarray, shape (n,)
            Relative curvature in the rolling plane [1/mm].
        modulus : ndarray, shape (n,)
            Contact modulus E* [MPa].

        Returns
        -------
        LineContact
            b = sqrt(4 F_N/(pi w k E*)) and p_max = 2 F_N/(pi b w), Johnson (1985), section 4.2c.
        """
        half = np.sqrt(4.0 * normal_force / (np.pi * width * curvature * modulus))
        return cls(half, width, 2.0 * normal_force / (np.pi * half * width))

    @property
    def normal_force(self) -> np.ndarray:
        """Return F_N = pi/2 b w p_max [N]."""
        return 0.5 * np.pi * self.half_length * self.width * self.max_pressure


def line_heights(elements: int) -> np.ndarray:
    """Return the mean of sqrt(1 - y^2) over equal elements of [-1, 1], shape (elements,)."""
    edges = np.linspace(-1.0, 1.0, elements + 1)
    integral = 0.5 * (edges * np.sqrt(1.0 - edges**2) + np.arcsin(edges))
    return np.asarray(np.diff(integral) * elements / 2.0)


def _level(
    line: LineContact,
    creep: Creepage,
    friction,
    elastic: Elastic,
    travel,
    settings: KalkerSettings,
    elements: int,
) -> batch.SolvedPatches:
    """Solve on a line of elements, from zero tractions."""
    n = len(friction)
    bound = friction * line.max_pressure
    with np.errstate(divide="ignore", invalid="ignore"):
        coupling = elastic.coupling / friction
    patches = batch.Batch(
        0.5 * line.width,
        line.half_length,
        bound,
        bound / elastic.shear_modulus,
        elastic.poisson_ratio,
        coupling,
        creep.longitudinal[:, None],
        creep.lateral,
        np.zeros(n),
        travel,
        line_heights(elements).reshape(1, elements, 1),
        np.ones((1, elements, 1)),
        True,
        elastic.film * elastic.shear_modulus,
        True,
    )
    found = batch.SolvedPatches.start(np.zeros((n, 2, elements, 1)), settings.law_in_use)
    batch.solve_batch(patches, settings.law_in_use, settings, found)
    return found


def solve_discs(
    line: LineContact,
    creep: Creepage,
    friction: np.ndarray,
    elastic: Elastic,
    elements: int,
    settings: KalkerSettings,
    travel_speed: np.ndarray,
) -> PatchSolution:
    """Solve for tractions, slip and resultants of n pairs of discs in steady rolling with friction.

    Parameters
    ----------
    line : LineContact
        The contacts, arrays (n,).
    creep : Creepage
        Longitudinal and lateral creepage, arrays (n,) [1]; discs have no spin.
    friction : ndarray, shape (n,)
        Friction coefficient mu [1]; 0 gives no traction.
    elastic : Elastic
        Combined constants, arrays (n,).
    elements : int
        Elements along the contact, even.
    settings : KalkerSettings
        Friction law and stopping rule; the discretisation of patches does not count.
    travel_speed : ndarray, shape (n,)
        Travel speed for friction laws [mm/s].

    Returns
    -------
    PatchSolution
        Solution of the n contacts; fields have one column, nx = 1. The spin moment is that of the
        lateral tractions about the middle of the contact.

    Notes
    -----
    Valid for wide discs, whose contact is short beside the radii and the width. The resultants are
    extrapolated from half as many elements; the change is the estimated error.

    References
    ----------
    Carter, F. W. (1926). On the action of a locomotive driving wheel. Proc. R. Soc. A 112, 151-157.
    """
    n = len(friction)
    coarse = _level(line, creep, friction, elastic, travel_speed, settings, elements // 2)
    found = _level(line, creep, friction, elastic, travel_speed, settings, elements)
    report = found.report
    # of first order: the adhesion area ends between elements
    change = report.forces - coarse.report.forces
    limit = np.zeros((n, 6))
    limit[:, :3] = change
    return PatchSolution(
        resultants=Resultants(*(report.forces + change).T),
        traction=found.traction,
        slip=found.slip,
        stick=found.stick,
        factor=found.factor,
        stick_fraction=report.stick_fraction,
        friction_energy_per_distance=report.work + report.pressure_work,
        pressure_work=report.pressure_work,
        energy_residual=report.energy_residual,
        limit=limit,
        error_estimate=np.abs(change),
        force_error=np.abs(change[:, :2]).max(axis=1),
        own_slip=report.own_slip,
        residual=report.residual,
        steps=report.steps,
        products=report.products,
        converged=report.residual <= settings.tolerance,
    )


def to_tractions(
    line: LineContact, friction: np.ndarray, solution: PatchSolution
) -> SurfaceTractions:
    """Return the fields of a solution as means of the elements, (n, elements, 1)."""
    elements = solution.traction.shape[-2]
    y = line.half_length[:, None] * ((2.0 * np.arange(elements) + 1.0) / elements - 1.0)
    pressure = line.max_pressure[:, None, None] * line_heights(elements).reshape(1, elements, 1)
    shear = solution.traction * (friction * line.max_pressure)[:, None, None, None]
    x = np.zeros((len(friction), 1))
    return SurfaceTractions(
        x,
        y,
        pressure,
        shear[:, 0],
        shear[:, 1],
        solution.slip[:, 0],
        solution.slip[:, 1],
        solution.stick,
    )
