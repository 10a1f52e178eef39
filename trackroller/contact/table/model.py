"""The exact theory by its table, for `contact_model="kalker"` at `preview`.

Forces, spin moment, stick and dissipation come from the table. Tractions, which stresses need, are those of the exact
solver on a coarse grid at the slip that the table found. Rollers outside the table's range are solved exactly.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from trackroller.contact.common import ContactModel, Elastic, Ellipse, Resultants, Slip, SurfaceTractions, Works
from trackroller.contact.table import spline as table


class TableModel(ContactModel):
    """Contact model of n rollers with combined constants `elastic` (n,); `exact` makes the model behind it.

    The step of derivatives and the residual are those of the exact model: a block may hold rollers of both kinds.
    """

    knows_tractions = False
    # Relative error of the peak stress that table and coarse tractions bring, per unit of the friction coefficient.
    # Measured on random designs against `standard`: the search's own estimate and this cover 99 % of the peaks.
    peak_error = 0.12

    def __init__(self, elastic: Elastic, exact: Callable[[], Any]) -> None:
        self.elastic, self._make = elastic, exact
        self._exact: Any = None

    @property
    def exact(self) -> Any:
        """The exact model, made when first needed."""
        if self._exact is None:
            self._exact = self._make()
        return self._exact

    def _table(self, ellipse: Ellipse, slip: Slip, friction, rows) -> table.TableSolution:
        return table.solve_patch(ellipse, slip.longitudinal, slip.spin, friction, self.elastic.take(rows))

    def law(self, ellipse: Ellipse, slip: Slip, friction, rows, fine: bool) -> Resultants:
        """Resultants on the roller, shape (n,)."""
        found = self._table(ellipse, slip, friction, rows)
        rest = np.flatnonzero(~found.known)
        if not rest.size:
            return found.resultants
        r = found.resultants
        forces = np.stack([r.lateral_force, r.driving_force, r.spin_moment])
        other = self.exact.law(ellipse.take(rest), slip.take(rest), friction[rest], rows[rest], fine)
        forces[:, rest] = other.lateral_force, other.driving_force, other.spin_moment
        return Resultants(*forces)

    def surface(self, ellipse: Ellipse, slip: Slip, friction, rows) -> SurfaceTractions:
        """Tractions of the exact solver on a grid over each patch."""
        return self.exact.surface(ellipse, slip, friction, rows)

    def stick(self, ellipse: Ellipse, slip: Slip, friction, rows) -> np.ndarray:
        """Share of each patch that sticks, shape (n,)."""
        found = self._table(ellipse, slip, friction, rows)
        share, rest = found.stick_fraction, np.flatnonzero(~found.known)
        if rest.size:
            t = self.exact.surface(ellipse.take(rest), slip.take(rest), friction[rest], rows[rest])
            share[rest] = t.stick_share
        return share

    def power(self, ellipse: Ellipse, slip: Slip, friction, rows) -> Works:
        """Dissipation: the work of the creepages; of unlike materials by the exact solver, with the pressures."""
        found = self._table(ellipse, slip, friction, rows)
        work, pressed = found.friction_energy_per_distance, np.zeros(len(rows))
        rest = np.flatnonzero(~found.known | (self.elastic.coupling[rows] != 0.0))
        if rest.size:
            other = self.exact.power(ellipse.take(rest), slip.take(rest), friction[rest], rows[rest])
            work[rest], pressed[rest] = other.dissipated, other.by_pressure
        return Works(work, pressed)

    def state(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Residual of the friction law in the patches at the last fine call, and if it is met, (n,); 0 by the table."""
        return (np.zeros(n), np.ones(n, bool)) if self._exact is None else self.exact.state(n)
