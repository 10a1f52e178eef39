"""Solve a case by the table of exact solutions before `contact_model="auto"` chooses a contact model.

The table takes microseconds a patch. The forces of a cheaper model are therefore compared with the exact forces case by
case. Materials that differ more than the table covers are looked up at the end of the table.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.contact import table as tables
from trackroller.contact.common import Elastic, Ellipse, Resultants, Slip, _Rows
from trackroller.contact.protocol import ContactModel
from trackroller.contact.table.model import TableModel
from trackroller.roller.equilibrium import ROLLING, Equilibrium, solve_equilibrium
from trackroller.roller.stages import mechanics as stages

if TYPE_CHECKING:
    from trackroller.roller.case import CaseTable
    from trackroller.roller.options import Options

FARTHEST_POLE = 3.0  # of |x_spin|/a; a spin pole farther away changes nothing


class NearestInTable(TableModel):
    """Contact model that reads the table at the nearest coupling |K|/mu; NaN outside its range of axis ratios."""

    def __init__(self, elastic: Elastic) -> None:
        super().__init__(elastic, ContactModel())

    def look_up(self, ellipse: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> tables.TableSolution:
        """Return resultants, adhesion share and dissipation of m patches from the table."""
        most = (1.0 - 1e-9) * tables.LARGEST_COUPLING * friction
        elastic = self.elastic.take(rows)
        near = replace(elastic, coupling=np.clip(elastic.coupling, -most, most))
        return tables.solve_patch(ellipse, slip.longitudinal, slip.spin, friction, near)

    def law(self, ellipse, slip, friction, rows, fine) -> Resultants:
        """Return the resultants on the roller, (m,)."""
        return self.look_up(ellipse, slip, friction, rows).resultants


@dataclass(frozen=True)
class Probe(_Rows):
    """Solution of n rollers by the table; arrays (n, 2) by contact, or (n,)."""

    regime: np.ndarray
    converged: np.ndarray
    normal_force: np.ndarray
    lateral_force: np.ndarray
    driving_force: np.ndarray
    spin_moment: np.ndarray
    arm: np.ndarray  # sqrt(a b) [mm]
    pole: np.ndarray  # |x_spin|/a
    stick: np.ndarray  # share of the patch
    friction: np.ndarray  # coefficient, (n,)

    @property
    def rolls(self) -> np.ndarray:
        """Return True for the rollers in the regime rolling, (n,)."""
        return self.regime == ROLLING

    def numbers(self) -> np.ndarray:
        """Return ln of the larger adhesion share, |x_spin|/a of the nearer pole, the larger |F_T|/(mu F_N), (n, 3)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            grip = np.abs(self.lateral_force / self.normal_force).max(axis=1) / self.friction
            return np.stack(
                [
                    np.log(np.clip(self.stick.max(axis=1), 1e-3, 1.0)),
                    np.minimum(self.pole.min(axis=1), FARTHEST_POLE),
                    grip,
                ],
                axis=1,
            )


def _solve(table: CaseTable, options: Options, model: str) -> tuple[Any, Equilibrium]:
    scene = stages.prepare(table, options.changed(contact_model=model, accuracy="preview", outputs=("forces",)))
    if model == "kalker_table":
        scene = replace(scene, model=NearestInTable(scene.model.elastic))  # type: ignore[attr-defined]
    return scene, solve_equilibrium(scene.loads, scene.mirror.law(scene.model.law))


def probe(table: CaseTable, options: Options) -> Probe:
    """Return forces, spin poles and adhesion shares of n rollers by the table.

    Parameters
    ----------
    table : CaseTable
        The n cases.
    options : Options
        Options of the solution; contact model and accuracy are replaced.

    Returns
    -------
    Probe
        Arrays of n rollers.
    """
    scene, balance = _solve(table, options, "kalker_table")
    loads, n, f = scene.loads, len(table), balance.forces
    rows = np.tile(np.arange(n), 2)
    patches, slip = loads.contacts(balance.normal_force.T.reshape(-1), balance.shift[rows], rows)
    stick, rolling = np.zeros(2 * n), np.flatnonzero(balance.regime[rows] == ROLLING)
    own = rows[rolling]
    found = scene.model.look_up(patches.take(rolling), slip.take(rolling), loads.friction[own], own)
    stick[rolling] = found.stick_fraction
    a, b = patches.semi_axis_lateral, patches.semi_axis_rolling
    with np.errstate(divide="ignore", invalid="ignore"):
        arm, pole = np.sqrt(a * b).reshape(2, n).T, np.abs(slip.pole_lateral / a).reshape(2, n).T
    return Probe(
        balance.regime,
        balance.converged,
        balance.normal_force,
        f.lateral_force,
        f.driving_force,
        f.spin_moment,
        arm,
        pole,
        stick.reshape(2, n).T,
        loads.friction,
    )


def force_error(table: CaseTable, options: Options, model: str, exact: Probe) -> np.ndarray:
    """Return the relative difference between the forces of a model and those of the table.

    Parameters
    ----------
    table : CaseTable
        The n cases.
    options : Options
        Options of the solution.
    model : str
        Name of the contact model.
    exact : Probe
        Result of `probe` for the same cases.

    Returns
    -------
    numpy.ndarray, shape (n,)
        Largest difference of: normal force, relative; lateral and driving force over F_N; spin moment over
        F_N sqrt(a b) [1]. It is 0 where both solutions slip or lift off, and inf where their regimes differ or one
        did not converge.
    """
    own = _solve(table, options, model)[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = [np.abs(own.normal_force / exact.normal_force - 1.0)]
        for name, length in (("lateral_force", 1.0), ("driving_force", 1.0), ("spin_moment", exact.arm)):
            apart = np.abs(getattr(own.forces, name) - getattr(exact, name))
            parts.append(apart / (exact.normal_force * length))
        worst = np.max(np.stack(parts), axis=(0, 2))
    sure = (own.regime == exact.regime) & own.converged & exact.converged
    return np.where(sure, np.where(exact.rolls, np.nan_to_num(worst, nan=np.inf), 0.0), np.inf)
