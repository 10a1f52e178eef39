"""Friction power, life and validity flags of each case, from its forces and stresses."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact import close_fit
from trackroller.contact.slip import pole_split
from trackroller.damage import LIMITS, checked_limits, first_limit
from trackroller.damage.histories import RollerTractions
from trackroller.damage.limit import Limit, SolvedRollers
from trackroller.damage.wear import BEYOND_TABLE, KM_PER_HOUR
from trackroller.halfspace.tractions import Tractions
from trackroller.parameters import CONTACT_MODELS
from trackroller.parameters.validity import VALIDITY
from trackroller.roller.case import CaseTable
from trackroller.roller.case_limits import has_results, of_patches, solved_of, to_compute
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
            v |= _evaluated(limit, solved, options)
    places = [solved]
    if any(limit.moves(solved).any() for limit in computed_limits):
        places += [_at_end(solved, computed_limits, options, end) for end in (0, 1)]
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
        numbers = [names.index(limit.name) for limit in counted]
        known = _known_uses(counted, solved, options)
        v |= first_limit.limit_uses(places, counted, numbers, len(names), known)
    for name in [name for name in v if name.startswith("_") and name != BEYOND_TABLE]:
        del v[name]


def _known_uses(limits: Sequence[Limit], solved: SolvedRollers, options: Options) -> np.ndarray:
    """Return for which cases checked limits were computed, (n, limit) bool."""
    own = [has_results(limit, solved, options) for limit in limits]
    return np.array(own, dtype=bool).reshape(len(limits), -1).T


def _evaluated(limit: Limit, solved: SolvedRollers, options: Options) -> dict[str, np.ndarray]:
    """Return the results of a limit; cases for which it is not computed keep their values, or have
    NaN.
    """
    concerned = has_results(limit, solved, options)
    return _of_cases(concerned, limit.evaluate(solved), solved.values)


def _of_cases(
    concerned: np.ndarray, own: Mapping[str, np.ndarray], others: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return values (n, ...) of the cases concerned, and for the others those of the same name or
    NaN.
    """
    if concerned.all():
        return dict(own)
    return {
        name: np.where(
            concerned.reshape(-1, *(1,) * (value.ndim - 1)), value, others.get(name, np.nan)
        )
        for name, value in own.items()
    }


def _at_end(
    solved: SolvedRollers, limits: tuple[Limit, ...], options: Options, end: int
) -> SolvedRollers:
    """Return the rollers and their results with the placeholders at the worse (0) or the better (1)
    end.
    """
    values = dict(solved.values)
    moved = solved.at_end(end)
    on_patches = of_patches(limits)
    for limit in limits:
        concerned = limit.moves(solved) & has_results(limit, solved, options)
        if not concerned.any():
            continue
        if limit in on_patches:
            own = {result.name: values[f"_{end}_{result.name}"] for result in limit.results}
        else:
            own = limit.evaluate(dataclasses.replace(moved, values=values))
        values |= _of_cases(concerned, own, values)
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
        if limit.moves(solved).any():
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
    computed_for = _known_uses(counted, solved, options)
    known = first_limit.limit_uses(
        [solved], counted, range(len(counted)), len(counted), computed_for
    )
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
            # NaN where the wear of a case is not computed
            warn("wear_extrapolated", v.pop(BEYOND_TABLE) > 0.0)
    block.bodies = body | block.bits[:, None]  # The flags of the equilibrium hold for both bodies.
    block.bits |= body[:, 0] | body[:, 1]
