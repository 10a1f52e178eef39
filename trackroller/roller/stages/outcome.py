"""Friction power, life and validity flags of each case, from its forces and stresses."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact import close_fit
from trackroller.contact.drawn_profiles import gap
from trackroller.contact.slip import pole_split
from trackroller.damage import LIMITS, checked_limits, computed, first_limit
from trackroller.damage.histories import RollerTractions
from trackroller.damage.limit import TRACTIONS, Limit, LimitUse, SolvedRollers
from trackroller.damage.wear import BEYOND_TABLE, KM_PER_HOUR
from trackroller.damage.wear import TABLE as WEAR_TABLE
from trackroller.halfspace.tractions import Tractions
from trackroller.numerics.rows import distinct
from trackroller.numerics.variable import BODIES
from trackroller.parameters import CONTACT_MODELS, MAPPING_FIELDS, PARAMETERS
from trackroller.parameters.validity import VALIDITY
from trackroller.roller.case import CaseTable
from trackroller.roller.case_table import TEXTS
from trackroller.roller.geometry import rolling_radius
from trackroller.roller.stages.scene import StageResults, surface_tractions

if TYPE_CHECKING:
    from trackroller.roller.block_results import BlockResults
    from trackroller.roller.options import Options

LIFE_CONVENTIONS = (
    "S-N curve N = N_k (sigma/sigma_D)^-k through (N_Rm, R_m) and (N_k, sigma_D); the peak "
    "von Mises stress is taken "
    "as the amplitude (as published), or through the points of a material; below sigma_D: "
    "elementary continues the "
    "curve, haibach uses the slope 2k - 1, a second exponent of the material takes their "
    "place, unlimited gives inf; "
    "no life (NaN) in full slip and where the peak stress exceeds R_m; roller: one overrolling "
    "per revolution; guide: overrollings per hour are the user's input"
)


def finish(table: CaseTable, block: BlockResults, options: Options) -> None:
    """Add friction power, life and validity flags to the results of a block, in place."""
    v = block.values
    if "friction_work" in options.outputs:
        v["friction_power"] = v["friction_energy_per_distance"] * (table.velocity / 60.0)[:, None]
    limits(table, v, options, block.regime)
    validity(table, block, options)


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
    case serves.
    """
    candidates = computed(options.outputs, options.not_checked, options.life_criterion)
    return tuple(
        own
        for own in candidates
        if own.group in options.outputs or own.use is None or own.served(solved)
    )


def of_patches(limits: Iterable[Limit]) -> tuple[Limit, ...]:
    """Return the limits that need the tractions of each case, not of each mechanics alone."""
    return tuple(
        limit
        for limit in limits
        if TRACTIONS in limit.needs and (limit.shared is None or not limit.shared_by_mechanics)
    )


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


def limits(
    table: CaseTable, v: dict[str, np.ndarray], options: Options, regime: np.ndarray
) -> None:
    """Add the results of the limits asked for to the results `v`, and how far each is used if it is
    asked for.
    """
    solved = solved_of(table, v, options, regime)
    computed_limits = to_compute(solved, options)
    on_patches = of_patches(computed_limits)  # see `patch_limits`
    for limit in computed_limits:
        if limit not in on_patches:
            v |= limit.evaluate(solved)
    places = [solved]
    if any(limit.moves(solved) for limit in computed_limits):
        places += [_at_end(solved, computed_limits, end) for end in (0, 1)]
        for end, place in zip(("low", "high"), places[1:], strict=True):
            names = [
                result.name
                for limit in computed_limits
                for result in limit.results
                if result.end == end
            ]
            v |= {name: place.values[name] for name in names}
    if first_limit.GROUP in options.outputs:
        names = list(LIMITS)
        counted = checked_limits(options.outputs, options.not_checked)
        known = list(counted)
        for i, limit in enumerate(counted):
            if limit not in computed_limits:
                known[i] = _nothing(limit)
        v |= first_limit.limit_uses(
            places, known, [names.index(limit.name) for limit in counted], len(names)
        )
    for name in [name for name in v if name.startswith("_") and name != BEYOND_TABLE]:
        del v[name]


def _nothing(limit: Limit) -> Limit:
    """Return a limit that no case serves, of which nothing is known."""
    unknown = LimitUse(None, None)
    return dataclasses.replace(limit, use=lambda solved, results: unknown, bound=None)


def _at_end(solved: SolvedRollers, limits: tuple[Limit, ...], end: int) -> SolvedRollers:
    """Return the rollers and their results with the placeholders at the worse (0) or the better (1)
    end.
    """
    values = dict(solved.values)
    moved = solved.at_end(end)
    on_patches = of_patches(limits)
    for limit in (limit for limit in limits if limit.moves(solved)):
        if limit in on_patches:
            own = {result.name: values[f"_{end}_{result.name}"] for result in limit.results}
        else:
            own = limit.evaluate(dataclasses.replace(moved, values=values))
        values |= own
    return dataclasses.replace(moved, values=values)


def patch_limits(results: StageResults, options: Options, limits: tuple[Limit, ...]) -> None:
    """Add the results of the limits that need the tractions of the patches, or what these limits
    share.

    Limits that rest on placeholders are also computed at both ends of their ranges, as `_0_NAME`
    and `_1_NAME`.
    """
    scene = results.scene
    own = of_patches(limits)
    shared = [limit for limit in limits if limit.shared is not None and limit not in own]
    if not own and not shared:
        return

    @cache
    def fields() -> RollerTractions:
        t = surface_tractions(results)
        names = [field.name for field in dataclasses.fields(Tractions)]
        own = {name: results.full(getattr(t, name)) for name in names}
        own |= {name: own[name] * scene.unit[:, None, None] for name in ("x", "y")}
        return RollerTractions(**own, mirrored=scene.mirror.symmetric)

    solved = dataclasses.replace(
        solved_of(scene.table, results.values, options, results.regime), tractions=fields
    )
    for limit in own:
        ready = solved
        if limit.shared is not None:
            ready = dataclasses.replace(solved, values=results.values | limit.shared(solved))
        if limit.moves(solved):
            for end in (0, 1):
                at_end = limit.evaluate(ready.at_end(end))
                results.values |= {f"_{end}_{one.name}": at_end[one.name] for one in limit.results}
        results.values |= limit.evaluate(ready)
    for limit in shared:
        assert limit.shared is not None
        results.values |= limit.shared(solved)


def split_pole(table: CaseTable, v: dict[str, np.ndarray]) -> np.ndarray:
    """Return True where the slip of the sliding model vanishes away from its spin pole, (n,); see
    `pole_split`.
    """
    alpha = np.deg2rad(table.contact_angle)
    split = [
        pole_split(
            v["semi_axis_lateral"][:, k],
            sign * np.sin(alpha),
            np.cos(alpha),
            table.guide_profile_radius,
            v["rolling_radius_shift"],
        )
        for k, sign in ((0, 1.0), (1, -1.0))
    ]
    with np.errstate(invalid="ignore"):
        return np.maximum(*split) > 0.1


def outlives_groove(table: CaseTable, block: BlockResults, options: Options) -> np.ndarray:
    """Return True where the own life of a body, in travel of the roller, exceeds the run-in
    distance, (n, 2).

    The life is that to the first limit among those that are computed: a body that breaks has none,
    and a second model of an end does not shorten it. A life that is not known exceeds nothing.
    """
    v = block.values
    # a limit that a bound shows to be kept ends no life
    solved = solved_of(table, v, options.changed(at_most=()), block.regime)
    run_in = v["run_in_distance"] / (KM_PER_HOUR * table.velocity)
    counted = [own for own in to_compute(solved, options) if own.use is not None]
    known = first_limit.limit_uses([solved], counted, range(len(counted)), len(counted))
    return np.asarray(known["life_to_first_limit_hours"] > run_in[:, None])


def validity(table: CaseTable, block: BlockResults, options: Options) -> None:
    """Set the validity flags where the assumptions of the model do not hold, see
    `parameters.validity`.
    """
    v = block.values
    bit = {name: 1 << i for i, name in enumerate(VALIDITY)}
    r_g = table.guide_profile_radius
    alpha = np.deg2rad(table.contact_angle)
    r_a = rolling_radius(table.axis_distance, r_g, alpha)
    radii = [
        [table.roller_profile_radius, r_a / np.cos(alpha)],
        [r_g, table.guide_curve_radius / np.cos(alpha)],
    ]
    a = np.max(v["semi_axis_lateral"], axis=1)
    b = np.max(v["semi_axis_rolling"], axis=1)
    lateral, rolling = np.abs(radii).transpose(1, 2, 0)  # of both bodies, (n, 2)
    widest = np.full(len(table), close_fit.PLAIN)
    if options.normal == "hertz":
        widest = close_fit.widest(table.roller_profile_radius)
    strength = np.stack([table.roller.tensile_strength, table.guide.tensile_strength], axis=1)
    body = np.zeros((len(table), 2), dtype=np.int32)

    def warn(name: str, condition: np.ndarray) -> None:
        """Set a flag where the condition holds: (n,) of the pair of bodies, or (n, 2) of each
        body.
        """
        if condition.ndim == 1:
            condition = condition[:, None]
        body[:] |= np.where(condition, bit[name], 0).astype(np.int32)

    with np.errstate(invalid="ignore"):
        too_wide = (a[:, None] > widest[:, None] * lateral) | (
            a[:, None] > close_fit.PLAIN * rolling
        )
        too_large = too_wide | (b[:, None] > close_fit.PLAIN * np.minimum(lateral, rolling))
        warn("half_space", too_large)
        close = a > close_fit.PLAIN * np.min(lateral, axis=1)
        warn("close_fit", close & ~np.any(too_large, axis=1))
        # ASSUME: R_m stands for the yield strength, whose values in the database are guesses.
        warn("yield", np.max(v["max_pressure"], axis=1)[:, None] > 1.6 * strength)
        warn("conformal", a >= r_g * np.minimum(np.pi / 2 - alpha, alpha))
        warn("split_pole", (block.model == CONTACT_MODELS.index("sliding")) & split_pole(table, v))
        warn("large_slip", np.abs(v["slip"]) > 0.1)
        if "peak_stress" in v:
            knee = np.stack([table.roller.fatigue_limit, table.guide.fatigue_limit], axis=1)
            warn("static", np.any(v["peak_stress"] > strength[:, None, :], axis=1))
            amplitude = v.get("fatigue_stress", v["peak_stress"])
            # the worse contact sets the life
            warn("deep_life", np.all(amplitude < knee[:, None, :], axis=1))
        if "heat_utilisation" in v:
            warn("overheated", np.any(v["heat_utilisation"] > 1.0, axis=1))
        if "run_in_distance" in v:
            warn("worn", outlives_groove(table, block, options))
        if BEYOND_TABLE in v:
            warn("wear_extrapolated", v.pop(BEYOND_TABLE))
    block.bodies = body | block.bits[:, None]  # The flags of the equilibrium hold for both bodies.
    block.bits |= body[:, 0] | body[:, 1]
