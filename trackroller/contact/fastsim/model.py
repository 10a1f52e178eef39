"""Contact model `fastsim`: the simplified theory on ellipses."""

from __future__ import annotations

import dataclasses

import numpy as np

from trackroller.contact.common import Resultants, Works
from trackroller.contact.fastsim.patch import FastsimSettings, FastsimSolution, solve_patch, tractions
from trackroller.contact.linear import LARGEST_RATIO
from trackroller.contact.protocol import ContactModel
from trackroller.contact.settings import Accuracy, Rollers
from trackroller.contact.slip import Creepage
from trackroller.parameters.contact_models import DECLARED


class FastsimModel(ContactModel):
    """Kalker's simplified theory; NaN where the ellipse is more slender than its coefficients reach.

    Many published studies use this theory. Its accuracy and its cost lie between those of `sliding` and `kalker`.
    """

    declaration = DECLARED["fastsim"]
    residual = declaration.converged_up_to
    most_slender = 0.99 * LARGEST_RATIO

    def __init__(self, given: Rollers, settings: Accuracy) -> None:
        self.given, n = given, settings.on_grids  # strips to steps as in the default settings
        self.settings = FastsimSettings(4 * n // 5, 6 * n // 5, n, given.law, given.profile_slip)

    def _solution(self, ellipse, slip, friction, rows) -> tuple[FastsimSolution, np.ndarray]:
        """Return the solution of the patches that are not too slender, and their numbers."""
        a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
        known = np.flatnonzero(np.maximum(a, b) <= self.most_slender * np.minimum(a, b))
        creep = Creepage.of_slip(slip.take(known), self.settings.profile_slip)
        elastic, travel = self.given.elastic.take(rows[known]), self.given.travel_speed[rows[known]]
        return solve_patch(ellipse.take(known), creep, friction[known], elastic, self.settings, travel), known

    def law(self, ellipse, slip, friction, rows, fine):
        solution, known = self._solution(ellipse, slip, friction, rows)
        return Resultants.unknown(len(rows)).replaced(known, solution.resultants)

    def surface(self, ellipse, slip, friction, rows):
        # Patches that are too slender for the theory occur in full slip only, which needs just their grid and pressure.
        a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
        known = np.maximum(a, b) <= self.most_slender * np.minimum(a, b)
        near = np.where(known, a, np.clip(a, b / self.most_slender, b * self.most_slender))
        rounder = dataclasses.replace(ellipse, semi_axis_lateral=near)
        elastic, travel = self.given.elastic.take(rows), self.given.travel_speed[rows]
        t = tractions(rounder, slip, friction, elastic, self.settings, travel)
        wrong = ~known[:, None, None]
        fields = {
            name: np.where(wrong, np.nan, getattr(t, name))
            for name in ("shear_lateral", "shear_rolling", "slip_lateral", "slip_rolling")
        }
        widened = t.x * (a / rounder.semi_axis_lateral)[:, None]
        return dataclasses.replace(t, x=widened, stick=t.stick & ~wrong, **fields)

    def power(self, ellipse, slip, friction, rows):
        solution, known = self._solution(ellipse, slip, friction, rows)
        work = np.full(len(rows), np.nan)
        work[known] = solution.friction_energy_per_distance
        return Works.of_friction(work)
