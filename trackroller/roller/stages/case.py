"""Friction power, life and validity flags of each case, from its forces and stresses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact.slip import pole_split
from trackroller.damage import fatigue
from trackroller.damage.pair import first_failure
from trackroller.parameters import CONTACT_MODELS
from trackroller.roller.case import CaseTable
from trackroller.roller.dataset import VALIDITY_BITS
from trackroller.roller.geometry import rolling_radius

if TYPE_CHECKING:
    from trackroller.roller.blocks import Block
    from trackroller.roller.options import Options

LIFE_CONVENTIONS = (
    "S-N curve N = N_k (sigma/sigma_D)^-k through (N_Rm, R_m) and (N_k, sigma_D); the peak von Mises stress is taken "
    "as the amplitude (as published); below sigma_D: elementary continues the curve, haibach uses the slope 2k - 1, "
    "unlimited gives inf; roller: one overrolling per revolution; guide: overrollings per hour are the user's input"
)


def finish(table: CaseTable, block: Block, options: Options) -> None:
    """Add friction power, life and validity flags to the results of a block, in place."""
    v = block.values
    if "friction_work" in options.outputs:
        v["friction_power"] = v["friction_energy_per_distance"] * (table.velocity / 60.0)[:, None]
    if "life" in options.outputs:
        life(table, v, options)
    validity(table, block)


def life(table: CaseTable, v: dict[str, np.ndarray], options: Options) -> None:
    """Add overrollings and hours to failure and their relative error to the results `v`, from the peak stress.

    The relative error of the life is the exponent of the S-N curve times the relative error of the stress.
    """
    per_body, errors = [], []
    for j, material in enumerate((table.roller, table.guide)):
        curve = fatigue.SNCurve(*(np.asarray(value)[:, None] for value in fatigue.curve_of(material)))
        per_body.append(fatigue.life_cycles(v["peak_stress"][:, :, j], curve, rule=options.life_rule))
        exponent = fatigue.woehler_exponent(curve)
        if options.life_rule == "haibach":  # The curve is flatter below the fatigue limit.
            exponent = np.where(v["peak_stress"][:, :, j] < curve.fatigue_limit, 2.0 * exponent - 1.0, exponent)
        errors.append(exponent * v["error_estimate"][:, :, j])
    v["life_cycles"] = np.stack(per_body, axis=2)
    v["life_error_estimate"] = np.stack(errors, axis=2)
    r_a = rolling_radius(table.axis_distance, table.guide_profile_radius, np.deg2rad(table.contact_angle))
    roller = fatigue.roller_hours(per_body[0], table.velocity[:, None], r_a[:, None])
    guide = fatigue.guide_hours(per_body[1], table.guide_overrollings_per_hour[:, None])
    v["life_hours"] = np.stack([roller, guide], axis=2)
    v["roller_life_hours"], v["guide_life_hours"] = roller.min(axis=1), guide.min(axis=1)
    v["pair_life_hours"], v["first_to_fail"] = first_failure(v["roller_life_hours"], v["guide_life_hours"])


def split_pole(table: CaseTable, v: dict[str, np.ndarray]) -> np.ndarray:
    """Return True where the slip of the sliding model vanishes away from its spin pole, (n,); see `pole_split`."""
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


def validity(table: CaseTable, block: Block) -> None:
    """Set the validity flags where the assumptions of the model do not hold, see `dataset.VALIDITY_BITS`."""
    v = block.values
    bit = {name: 1 << i for i, name in enumerate(VALIDITY_BITS)}
    r_g, alpha = table.guide_profile_radius, np.deg2rad(table.contact_angle)
    r_a = rolling_radius(table.axis_distance, r_g, alpha)
    radii = [[table.roller_profile_radius, r_a / np.cos(alpha)], [r_g, table.guide_curve_radius / np.cos(alpha)]]
    smallest = np.min(np.abs(radii), axis=1).T
    a = np.max(v["semi_axis_lateral"], axis=1)
    size = np.maximum(a, np.max(v["semi_axis_rolling"], axis=1))
    strength = np.stack([table.roller.tensile_strength, table.guide.tensile_strength], axis=1)
    body = np.zeros((len(table), 2), dtype=np.int32)

    def warn(name: str, condition: np.ndarray) -> None:
        """Set a flag where the condition holds: (n,) of the pair of bodies, or (n, 2) of each body."""
        body[:] |= np.where(condition if condition.ndim == 2 else condition[:, None], bit[name], 0).astype(np.int32)

    with np.errstate(invalid="ignore"):
        warn("half_space", size[:, None] > 0.3 * smallest)
        # ASSUME: R_m replaces the yield strength, which the database does not have.
        warn("yield", np.max(v["max_pressure"], axis=1)[:, None] > 1.6 * strength)
        warn("conformal", a >= r_g * np.minimum(np.pi / 2 - alpha, alpha))
        warn("split_pole", (block.model == CONTACT_MODELS.index("sliding")) & split_pole(table, v))
        warn("large_slip", np.abs(v["slip"]) > 0.1)
        if "peak_stress" in v:
            knee = np.stack([table.roller.fatigue_limit, table.guide.fatigue_limit], axis=1)
            warn("static", np.any(v["peak_stress"] > strength[:, None, :], axis=1))
            warn("deep_life", np.any(v["peak_stress"] < knee[:, None, :], axis=1))
    block.bodies = body | block.bits[:, None]  # The flags of the equilibrium hold for both bodies.
    block.bits |= body[:, 0] | body[:, 1]
