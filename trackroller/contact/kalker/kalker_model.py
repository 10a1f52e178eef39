"""Contact model `kalker`: the exact theory on ellipses."""

from __future__ import annotations

import numpy as np

from trackroller.contact.kalker import extrapolation
from trackroller.contact.kalker.correction import Correction
from trackroller.contact.kalker.law import KalkerLaw
from trackroller.contact.kalker.patch import shares, to_tractions
from trackroller.contact.kalker.problem import KalkerSettings
from trackroller.contact.normal.patch_models import GridKalkerModel
from trackroller.contact.protocol import ContactModel
from trackroller.contact.rollers import Rollers
from trackroller.contact.slip import Creepage
from trackroller.parameters.accuracy import Accuracy
from trackroller.parameters.contact_models import DECLARED

LEAST_UNDER_LAW = 20  # least number of elements across a patch under a friction law
FINER_PARTS = 6  # points of the traction along each side of an element of a refined patch


class KalkerModel(ContactModel):
    """Steady rolling on the elastic half-space with adhesion and slip areas (Kalker 1990)."""

    declaration = DECLARED["kalker"]
    on_solved_patches = GridKalkerModel

    def __init__(self, given: Rollers, settings: Accuracy, trusts_table: bool = False) -> None:
        self.given, law, elastic = given, given.law, given.elastic
        self.elements = settings.elements if law.is_constant else max(settings.elements, LEAST_UNDER_LAW)
        discretisation = KalkerSettings(self.elements, tolerance=1e-8, law=law, profile_slip=given.profile_slip)
        self._law = KalkerLaw(elastic, discretisation, given.travel_speed)
        if law.is_constant and not np.any(elastic.film):  # all that the table behind the corrections holds
            self.correction = Correction(elastic, discretisation, trusts_table)

    def law(self, ellipse, slip, friction, rows, fine):
        return self._law(ellipse, slip, friction, rows, fine)

    def _solution(self, ellipse, slip, friction, rows):
        solution = self._law.kept if self.correction is None else self.correction.solution
        return solution(ellipse, slip, friction, rows)

    def surface(self, ellipse, slip, friction, rows):
        return to_tractions(ellipse, friction, self._solution(ellipse, slip, friction, rows))

    def stick(self, ellipse, slip, friction, rows):
        return self._solution(ellipse, slip, friction, rows).stick_fraction

    def shares(self, ellipse, slip, friction, rows):
        return shares(ellipse, self._solution(ellipse, slip, friction, rows))

    def finer_shares(self, ellipse, slip, friction, rows, parts=FINER_PARTS):
        if self.correction is None:
            return None
        coarse = self._solution(ellipse, slip, friction, rows)
        finer = self.correction.on_finer(ellipse, slip, friction, rows, coarse)
        return *shares(ellipse, finer, parts), finer.converged

    def pole_stress(self, ellipse, slip, friction, rows):
        if self.correction is None:  # the formula was fitted to constant friction
            return super().pole_stress(ellipse, slip, friction, rows)
        return extrapolation.pole_stress(ellipse, Creepage.of_slip(slip), friction, self.given.elastic.take(rows))

    def power(self, ellipse, slip, friction, rows):
        if self.correction is not None:
            return self.correction.works(ellipse, slip, friction, rows)
        return self._solution(ellipse, slip, friction, rows).works

    def force_error(self, n):
        if self.correction is None:
            return self._law.error(n)
        # rollers that the corrected law has not balanced
        return np.where(np.isnan(self.correction.error), self._law.error(n), self.correction.error)

    def state(self, n):
        return self._law.state(n) if self.correction is None else self.correction.state(n)
