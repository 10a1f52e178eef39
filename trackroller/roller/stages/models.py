"""The contact model of a block of cases, on Hertz's ellipses or on patches solved for the drawn cross-sections."""

from __future__ import annotations

import numpy as np

from trackroller.contact.common import Elastic
from trackroller.contact.drawn_profiles import gap, treats_sides_alike
from trackroller.contact.friction_laws import FrictionLaw
from trackroller.contact.hertz import contact_modulus
from trackroller.contact.models import contact_model
from trackroller.contact.normal.patches import Patches
from trackroller.contact.protocol import ContactModel
from trackroller.roller.case import CaseTable
from trackroller.roller.options import Options


def bodies(table: CaseTable) -> tuple[np.ndarray, ...]:
    """Return Young's modulus [MPa] and Poisson's ratio of the roller, then of the guide, each (n,)."""
    roller, guide = table.roller, table.guide
    return roller.youngs_modulus, roller.poisson_ratio, guide.youngs_modulus, guide.poisson_ratio


def model_of(
    table: CaseTable, options: Options, rolling_radius: np.ndarray, law: FrictionLaw, travel_speed: np.ndarray
) -> ContactModel:
    """Make the contact model that the options ask for.

    Parameters
    ----------
    table : n cases
    options : contact model, normal problem, slip terms and accuracy
    rolling_radius : r_A, (n,) [mm]
    law : friction law that the cases share
    travel_speed : of the rollers, (n,) [mm/s]
    """
    elastic = Elastic.of_pair(*bodies(table))
    patches = None if options.normal == "hertz" else _patches(table, options, rolling_radius)
    name, settings, terms = options.contact_model, options.settings, options.slip_terms
    return contact_model(name, settings, elastic, options.spin_model, law, travel_speed, terms, patches)


def _patches(table: CaseTable, options: Options, rolling_radius: np.ndarray) -> Patches:
    """Make the solver of the normal problem; contacts with the same gap share their solutions."""
    alpha = np.deg2rad(table.contact_angle)
    radii = (table.guide_profile_radius, table.roller_profile_radius, alpha, rolling_radius, table.guide_curve_radius)
    columns = np.stack(radii, axis=1).tolist()

    def gaps(row: int, side: int):
        guide, roller = str(table.guide_profile[row]), str(table.roller_profile[row])
        if treats_sides_alike(guide) and treats_sides_alike(roller):
            side = 1
        key = (guide, roller, *columns[row], side)
        return key, lambda: gap(*key)

    even = 2 * -(-options.settings.on_grids // 2)
    return Patches(gaps, contact_modulus(*bodies(table)), even)
