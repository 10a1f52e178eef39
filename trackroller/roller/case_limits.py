"""Which limits are computed for which case, and what the limits receive of the cases.

A plan asks this too, so that nothing here loads the solver.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact.drawn_profiles import gap
from trackroller.damage import computed
from trackroller.damage.limit import TRACTIONS, Limit, SolvedRollers
from trackroller.damage.wear import TABLE as WEAR_TABLE
from trackroller.numerics.rows import distinct
from trackroller.numerics.variable import BODIES
from trackroller.parameters import MAPPING_FIELDS, PARAMETERS
from trackroller.roller.case import CaseTable
from trackroller.roller.case_table import TEXTS
from trackroller.roller.geometry import rolling_radius

if TYPE_CHECKING:
    from trackroller.roller.options import Options


def solved_of(
    table: CaseTable,
    values: dict[str, np.ndarray],
    options: Options,
    regime: np.ndarray | None = None,
) -> SolvedRollers:
    """Return cases, materials and results as the limits receive them."""
    fields = [field.name for field in dataclasses.fields(table.roller)]
    names = [name for name in fields if name not in TEXTS or name == "sn_points"]
    cases = {name: getattr(table, name) for name in (*PARAMETERS, *MAPPING_FIELDS)}
    if options.wear_law == "energy":  # with another law a table of the materials serves nothing
        cases[WEAR_TABLE.name] = table.loss_tables
    return SolvedRollers(
        cases,
        {
            name: np.array([getattr(body, name) for body in (table.roller, table.guide)]).T
            for name in names
        },
        values,
        rolling_radius(
            table.axis_distance, table.guide_profile_radius, np.deg2rad(table.contact_angle)
        ),
        vars(options),
        regime=regime,
        unworn_gap=partial(_unworn_gap, table),
        ends=_ends(table),
    )


def _ends(table: CaseTable) -> dict[str, np.ndarray]:
    """Return the ends of the ranges of placeholders as `SolvedRollers` has them.

    A value whose place in its range is given has no range, and a given factor replaces that of the
    wear coefficient.
    """
    given = ~np.isnan(table.placeholder_position)
    out = {}
    bodies = [distinct(own.ends) for own in (table.roller, table.guide)]
    ranges = [ends for materials, _ in bodies for ends in materials]
    for name in sorted({name for ends in ranges for name in ends}):
        is_fixed = given
        if name == "wear_coefficient":
            is_fixed = given | ~np.isnan(table.wear_coefficient_factor)
        columns = [
            np.array([ends.get(name, (1.0, 1.0)) for ends in materials])[place]
            for materials, place in bodies
        ]
        out[name] = np.where(is_fixed[:, None, None], 1.0, np.stack(columns, axis=1))
    return {name: shares for name, shares in out.items() if np.any(shares != 1.0)}


def _unworn_gap(table: CaseTable, case: int, contact: int, lateral: np.ndarray) -> np.ndarray:
    """Return the gap of the undeformed profiles at lateral places of one contact of a case, see
    `SolvedRollers`.
    """
    alpha = float(np.deg2rad(table.contact_angle[case]))
    axis = float(table.axis_distance[case])
    guide_radius = float(table.guide_profile_radius[case])
    between = gap(
        str(table.guide_profile[case]),
        str(table.roller_profile[case]),
        guide_radius,
        float(table.roller_profile_radius[case]),
        alpha,
        float(rolling_radius(axis, guide_radius, alpha)),
        float(table.guide_curve_radius[case]),
        contact + 1,
    )
    return between.lateral(lateral)


def with_weakest(table: CaseTable, cases: CaseTable, number: np.ndarray) -> CaseTable:
    """Return cases that several others share, with the lowest yield strength among these.

    Parameters
    ----------
    table, cases : CaseTable
        The m cases with a mechanics of their own, and all n cases.
    number : numpy.ndarray of int
        Number in `table` of each case, (n,).

    Notes
    -----
    The strength decides which bodies need a number of shakedown, see `Limit.kept_by_bound`. A
    mechanics gets the number if one of its cases needs it.
    """
    ends = _ends(cases).get("yield_strength", np.ones((len(cases), 2, 2)))
    weakest = {}
    for i, body in enumerate(BODIES):
        own = getattr(cases, body).yield_strength * ends[:, i, 0]
        lowest = np.full(len(table), np.inf)
        np.fmin.at(lowest, number, own)
        lowest[np.isinf(lowest)] = np.nan
        weakest[body] = dataclasses.replace(getattr(table, body), yield_strength=lowest)
    return dataclasses.replace(table, **weakest)


def to_compute(solved: SolvedRollers, options: Options) -> tuple[Limit, ...]:
    """Return the limits to compute: those named among the outputs, and the checked ones that a
    case serves; all of them without a case, so that an empty result has its variables.
    """
    candidates = computed(options.outputs, options.not_checked, options.life_criterion)
    if not len(solved.rolling_radius):
        return tuple(candidates)
    return tuple(own for own in candidates if has_results(own, solved, options).any())


def has_results(limit: Limit, solved: SolvedRollers, options: Options) -> np.ndarray:
    """Return the cases for which a limit is computed, (n,) bool.

    A case decides for itself, so that its results do not depend on the cases beside it.
    """
    if limit.group in options.outputs or limit.use is None:
        return np.ones(len(solved.rolling_radius), dtype=bool)
    return limit.served(solved)


def marks_of_limits(table: CaseTable, options: Options) -> np.ndarray:
    """Return two numbers of each case that others with the same mechanics may lack, (n, 2).

    The first is that of the set of limits whose needs have to be computed for the case, and cases
    are solved together only if it is equal. The second is a number of the case alone if one of
    these limits needs the tractions of each case, see `of_patches`, and otherwise 0.
    """
    solved = solved_of(table, {}, options)
    mark = np.zeros(len(table))
    alone = np.zeros(len(table), dtype=bool)
    for place, limit in enumerate(
        computed(options.outputs, options.not_checked, options.life_criterion)
    ):
        if limit.needs or limit.shared is not None:
            concerned = has_results(limit, solved, options)
            mark += concerned * 2.0**place
            if of_patches([limit]):
                alone |= concerned
    return np.stack([mark, np.where(alone, 1.0 + np.arange(len(table)), 0.0)], axis=1)


def of_patches(limits: Iterable[Limit]) -> tuple[Limit, ...]:
    """Return the limits that need the tractions of each case, not of each mechanics alone."""
    return tuple(
        limit
        for limit in limits
        if TRACTIONS in limit.needs and (limit.shared is None or not limit.shared_by_mechanics)
    )
