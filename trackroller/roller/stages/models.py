"""The contact model of a block of cases, on Hertz's ellipses or on patches solved for the drawn cross-sections."""

from __future__ import annotations

from dataclasses import replace
from itertools import zip_longest
from typing import Any

import numpy as np

from trackroller.contact.drawn_profiles import gap, has_details, smoothed_otherwise, treats_sides_alike
from trackroller.contact.friction_laws import FrictionLaw
from trackroller.contact.hertz import contact_modulus
from trackroller.contact.models import contact_model
from trackroller.contact.normal.family import Family, nearest_lattice
from trackroller.contact.normal.patches import Boxes, GapOf, NormalSolver
from trackroller.contact.protocol import ContactModel
from trackroller.contact.quantities import Elastic
from trackroller.errors import ShapeError
from trackroller.roller.case import CaseTable
from trackroller.roller.geometry import contact_geometry
from trackroller.roller.options import Options


def bodies(table: CaseTable) -> tuple[np.ndarray, ...]:
    """Return Young's modulus [MPa] and Poisson's ratio of the roller, then of the guide, each (n,)."""
    roller, guide = table.roller, table.guide
    return roller.youngs_modulus, roller.poisson_ratio, guide.youngs_modulus, guide.poisson_ratio


def model_of(
    table: CaseTable,
    options: Options,
    rolling_radius: np.ndarray,
    law: FrictionLaw,
    travel_speed: np.ndarray,
    across: int = 1,
    near: Boxes | None = None,
    film: np.ndarray | None = None,
) -> ContactModel:
    """Make the contact model that the options ask for.

    Parameters
    ----------
    table : n cases
    options : contact model, normal problem, slip terms and accuracy
    rolling_radius : r_A, (n,) [mm]
    law : friction law that the cases share
    travel_speed : of the rollers, (n,) [mm/s]
    across : factor on the elements across solved patches, see `finer_across`
    near : boxes around similar patches of both contacts, from which the normal problem starts
    film : flexibility of a film between the bodies, (n,) [mm^3/N]; None is no film
    """
    elastic = replace(Elastic.of_pair(*bodies(table)), layer_flexibility=film)
    if options.normal == "hertz":
        patches = None
    else:
        patches = _patches(table, options, rolling_radius, across, near)
    name = options.contact_model
    settings = options.settings
    terms = options.slip_terms
    return contact_model(name, settings, elastic, options.spin_model, law, travel_speed, terms, patches)


def _gaps(table: CaseTable, rolling_radius: np.ndarray) -> GapOf:
    alpha = np.deg2rad(table.contact_angle)
    radii = (table.guide_profile_radius, table.roller_profile_radius, alpha, rolling_radius, table.guide_curve_radius)
    columns = np.stack(radii, axis=1).tolist()

    def gaps(row: int, side: int):
        guide, roller = str(table.guide_profile[row]), str(table.roller_profile[row])
        if treats_sides_alike(guide) and treats_sides_alike(roller):
            side = 1
        key = (guide, roller, *columns[row], side)
        return key, lambda: gap(*key)

    return gaps


def _elements(options: Options) -> int:
    return 2 * -(-options.settings.on_grids // 2)


def _patches(
    table: CaseTable, options: Options, rolling_radius: np.ndarray, across: int, near: Boxes | None
) -> NormalSolver:
    """Return the solver of the normal problem. It solves contacts with the same gap only once."""
    gaps = _gaps(table, rolling_radius)
    return NormalSolver(gaps, contact_modulus(*bodies(table)), _elements(options), across, near)


def finer_across(table: CaseTable, options: Options) -> np.ndarray:
    """Return the factor on the elements across that ridges of the pressures need in each case, (n,) of int.

    The loads are those of the balance without friction. Cases with Hertzian patches have the factor 1.
    """
    out = np.ones(len(table), int)
    if options.normal == "hertz":
        return out
    alpha, radius, *_ = contact_geometry(vars(table))
    gaps = _gaps(table, radius)
    modulus = contact_modulus(*bodies(table))
    mean = np.abs(table.radial_force) / np.cos(alpha)
    tilt = table.axial_force / np.sin(alpha)
    known: dict[tuple, int] = {}
    for row in range(len(table)):
        if not (has_details(str(table.guide_profile[row])) or has_details(str(table.roller_profile[row]))):
            continue
        for side, load in ((1, mean[row] - tilt[row]), (2, mean[row] + tilt[row])):
            if load <= 0.0:
                continue
            key, make = gaps(row, side)
            scaled = nearest_lattice(0.5 * load / modulus[row])
            if (key, scaled) not in known:
                try:
                    known[key, scaled] = Family(make(), _elements(options)).finer_across(scaled)
                except ShapeError:  # the patches of this case cannot be solved, which the solution reports
                    known[key, scaled] = 1
            out[row] = max(out[row], known[key, scaled])
    return out


CHANGED = 0.1  # change of the largest pressure, as a share, from which on the smoothing of points is told


def depends_on_smoothing(table: CaseTable, options: Options, across: int, normal_force: np.ndarray) -> np.ndarray:
    """Return where the pressure changes by more than `CHANGED` with the smoothing of measured points, (n,).

    Both profiles are smoothed more, and then less, see `smoothed_otherwise`. The patches of all smoothings are found
    on the elements of accuracy "preview", by interpolation between lattice loads.

    Parameters
    ----------
    table : n cases that share their profiles
    options : normal problem
    across : factor on the elements across the patches, see `finer_across`
    normal_force : F_N of both contacts, (n, 2) [N]; contacts without a force do not count
    """
    out = np.zeros(len(table), bool)
    if options.normal == "hertz" or not len(table):
        return out
    given = str(table.guide_profile[0]), str(table.roller_profile[0])
    others = list(zip_longest(*(smoothed_otherwise(text) for text in given), fillvalue=None))
    if not others:
        return out
    as_given = _largest_pressures(table, options, across, normal_force)
    for guide, roller in others:
        columns = {"guide_profile": guide or given[0], "roller_profile": roller or given[1]}
        texts: dict[str, Any] = {name: np.full(len(table), text, dtype=object) for name, text in columns.items()}
        try:
            other = _largest_pressures(replace(table, **texts), options, across, normal_force)
        except ShapeError:  # no contact with this smoothing
            return ~out
        lost = np.isnan(other) & ~np.isnan(as_given)
        with np.errstate(invalid="ignore"):
            out |= np.any(lost | (np.abs(other / as_given - 1.0) > CHANGED), axis=1)
    return out


def _largest_pressures(table: CaseTable, options: Options, across: int, normal_force: np.ndarray) -> np.ndarray:
    """Return the largest pressures under normal forces (n, 2) [N], interpolated between lattice loads, (n, 2) [MPa]."""
    rows = np.tile(np.arange(len(table)), 2)
    side = np.repeat([1.0, -1.0], len(table))
    radius = contact_geometry(vars(table)).rolling_radius
    patches = _patches(table, options.changed(accuracy="preview"), radius, across, None)
    pressure = patches.at(normal_force.T.reshape(-1), side, rows, fine=False).max_pressure
    return np.asarray(pressure.reshape(2, -1).T)
