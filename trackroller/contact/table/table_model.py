"""The exact theory by its table: contact model `kalker_table`, and `kalker` at accuracy `preview`.

Forces, spin moment, adhesion area and dissipation come from the table. Tractions, which stresses
need, come from the exact solver at the creepages found with the table. Peaks take them on few
elements, and on twice as many where the estimated error is large. Rollers outside the table's range
are solved exactly. Beside a nearly lifted contact the exact solver serves the loaded contact,
because a small error of its friction force is a large one of the light contact.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trackroller.contact.kalker.correction import SERVING
from trackroller.contact.kalker.kalker_model import KalkerModel
from trackroller.contact.kalker.subgrid import PARTS
from trackroller.contact.protocol import ContactModel
from trackroller.contact.quantities import Patch, Resultants, SurfaceTractions, Works
from trackroller.contact.rollers import Rollers
from trackroller.contact.slip import Slip
from trackroller.contact.table import spline as table
from trackroller.parameters.accuracy import Accuracy
from trackroller.parameters.contact_models import DECLARED

# Residual of the friction law over mu p_max in tractions on few elements; it changes peaks by 1e-4
# of themselves.
ROUGH_TOLERANCE = 5e-3


class TableModel(ContactModel):
    """Contact model of n rollers that looks the exact theory up in a table.

    Parameters
    ----------
    given : Rollers
        What is known of n rollers.
    settings : Accuracy
        Discretisation of `kalker`, which gives tractions and solves the rollers outside the table's
        range.
    """

    declaration = DECLARED["kalker_table"]
    knows_tractions = False
    # Relative error of the peak stress from the table and from coarse tractions, per unit of the
    # friction coefficient. Measured on random designs against `standard`: the search's own estimate
    # and this error cover 99 % of the peaks.
    peak_error = 0.12

    def __init__(self, given: Rollers, settings: Accuracy) -> None:
        super().__init__(given, settings)
        self.exact = KalkerModel(given, settings, trusts_table=True)
        self.served = KalkerModel(given, replace(settings, elements=SERVING[0]), trusts_table=True)
        self.correction, self.rough = self.served.correction, self.exact
        if settings.peak_elements not in (0, settings.elements):
            self.rough = KalkerModel(
                given, replace(settings, elements=settings.peak_elements), trusts_table=True
            )
            self.rough.correction.traction_tolerance = ROUGH_TOLERANCE
        # rollers outside the table's range
        self._beyond = np.zeros(np.shape(given.elastic.coupling), bool)

    @classmethod
    def errors(cls) -> dict[str, tuple[float, float, float, float]]:
        """Return the measured errors of the creep forces, over mu F_N and mu F_N sqrt(a b)."""
        median, p99 = (table.stored().force_error(level) for level in ("median", "p99"))
        return dict.fromkeys(("friction_force", "spin_moment"), (median, p99, p99, p99))

    def _table(self, patch: Patch, slip: Slip, friction, rows) -> table.TableSolution:
        return table.solve_patch(
            patch, slip.longitudinal, slip.spin, friction, self.given.elastic.take(rows)
        )

    def law(self, patch: Patch, slip: Slip, friction, rows, fine: bool) -> Resultants:
        """Return the resultants on the roller, arrays (m,)."""
        looked_up = self._table(patch, slip, friction, rows)
        rest = np.flatnonzero(~looked_up.known)
        if not rest.size:
            return looked_up.resultants
        self._beyond[rows[rest]] = True
        other = self.served.law(patch.take(rest), slip.take(rest), friction[rest], rows[rest], fine)
        return looked_up.resultants.replaced(rest, other)

    def surface(self, patch: Patch, slip: Slip, friction, rows) -> SurfaceTractions:
        """Return the tractions of the exact solver on a grid over each patch."""
        return self.exact.surface(patch, slip, friction, rows)

    def shares(self, patch: Patch, slip: Slip, friction, rows):
        """Return the tractions of the exact solver on few elements over their bound, see
        `ContactModel.shares`.
        """
        return self.rough.shares(patch, slip, friction, rows)

    def finer_shares(self, patch: Patch, slip: Slip, friction, rows):
        """Return `shares` from twice the elements, see `ContactModel.finer_shares`; None if they
        come from all.
        """
        own = self.rough
        return None if own is self.exact else own.finer_shares(patch, slip, friction, rows, PARTS)

    def stick(self, patch: Patch, slip: Slip, friction, rows) -> np.ndarray:
        """Return the adhesion area over the area of each patch, shape (m,)."""
        looked_up = self._table(patch, slip, friction, rows)
        share, rest = (
            np.where(friction > 0.0, looked_up.stick_fraction, 0.0),
            np.flatnonzero(~looked_up.known),
        )
        if rest.size:
            share[rest] = self.exact.stick(
                patch.take(rest), slip.take(rest), friction[rest], rows[rest]
            )
        return share

    def power(self, patch: Patch, slip: Slip, friction, rows) -> Works:
        """Return the dissipation: the work of the creepages, and of the pressures on unlike
        materials.

        The table does not hold the work of the pressures, so the exact solver gives it on unlike
        materials.
        """
        r = self.correction.law(patch, slip, friction, rows)
        work, pressed = (
            -(slip.longitudinal * r.driving_force + slip.spin * r.spin_moment),
            np.zeros(len(rows)),
        )
        rest = np.flatnonzero(self.given.elastic.coupling[rows] != 0.0)
        if rest.size:
            pressed[rest] = self.exact.power(
                patch.take(rest), slip.take(rest), friction[rest], rows[rest]
            ).by_pressure
        return Works(work + pressed, pressed)

    def state(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Return residual and convergence of the friction law in the patches solved exactly; 0 and
        True by table.
        """
        return self.served.state(n)

    def force_error(self, n: int) -> np.ndarray:
        """Return the estimated errors of contacts solved by elements, (n, 2); NaN where the table
        gives the forces.
        """
        return np.where(
            (self.used(n) == self.exact.name)[:, None], self.served.force_error(n), np.nan
        )

    def used(self, n: int) -> np.ndarray:
        """Return the name of the model that gave the forces of each of n rollers."""
        beyond = self._beyond | (self.correction.share > 0.0).any(axis=1)
        return np.where(beyond, self.exact.name, self.name).astype(object)
