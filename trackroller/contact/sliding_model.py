"""Contact model `sliding`: full sliding on ellipses."""

from __future__ import annotations

from trackroller.contact import sliding
from trackroller.contact.normal.patch_models import GridSlidingModel
from trackroller.contact.protocol import ContactModel
from trackroller.contact.quantities import Works
from trackroller.contact.rollers import Rollers
from trackroller.parameters.accuracy import Accuracy
from trackroller.parameters.contact_models import DECLARED

FINER = 2  # points of sliding tractions on a grid, over the elements of the rolling contact models


class SlidingModel(ContactModel):
    """Full sliding with an empirical spin pole (Wenzel et al. 2022), under any friction law."""

    declaration = DECLARED["sliding"]
    on_solved_patches = GridSlidingModel
    elastic = False
    difference_step = 1e-5
    residual = declaration.converged_up_to

    def __init__(self, given: Rollers, settings: Accuracy) -> None:
        self.given, self.settings = given, settings
        self.full_sliding = given.law.is_constant

    def _integrals(self, ellipse, slip, friction, rows, nodes: int) -> sliding.Integrals:
        g, travel = self.given, self.given.travel_speed[rows]
        return sliding.integrals(
            ellipse,
            slip,
            friction,
            spin_model=g.spin_model,
            nodes=nodes,
            law=g.law,
            travel_speed=travel,
        )

    def law(self, ellipse, slip, friction, rows, fine):
        nodes = self.settings.force_nodes if fine else self.settings.coarse_nodes
        return self._integrals(ellipse, slip, friction, rows, nodes).resultants

    def surface(self, ellipse, slip, friction, rows):
        g, travel, points = self.given, self.given.travel_speed[rows], self.settings.traction_points
        if self.full_sliding:
            return sliding.tractions(
                ellipse, slip, friction, spin_model=g.spin_model, points=points
            )
        points = FINER * self.settings.on_grids
        return sliding.tractions(
            ellipse,
            slip,
            friction,
            spin_model=g.spin_model,
            points=points,
            law=g.law,
            travel_speed=travel,
        )

    def power(self, ellipse, slip, friction, rows):
        integrals = self._integrals(ellipse, slip, friction, rows, self.settings.force_nodes)
        return Works.of_friction(integrals.power / slip.rolling_radius)
