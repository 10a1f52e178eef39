"""Heat of friction and hysteresis: flash and bulk temperatures of roller and guide.

Each body sees a heat source that moves over it with the travel speed (Carslaw and Jaeger), at any
Péclet number.

ASSUME: one factor parts the heat of a contact between the bodies, such that their largest
temperatures agree. ASSUME: the guide stays at ambient temperature but for the flash; the roller
loses its heat from `cooled_area` alone. ASSUME: friction and the values of heat do not depend on
temperature, and hysteresis does not change the balance. E and R_m follow the bulk temperature where
a material has a table, see `roller.temperature`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from trackroller.damage.histories import RollerTractions
from trackroller.damage.limit import (
    TRACTIONS,
    Limit,
    LimitUse,
    SolvedRollers,
    Values,
    optional,
    variables,
    worst,
)
from trackroller.numerics.parameter import Parameter
from trackroller.numerics.variable import BODIES, LARGEST, SUM


def heat_density(t: RollerTractions, speed: np.ndarray) -> np.ndarray:
    """Return the heat of friction |tau . s| v of each element, (n, contact, y, x) [W/mm2], for v,
    (n,) [mm/s].
    """
    work = np.abs(t.shear_lateral * t.slip_lateral + t.shear_rolling * t.slip_rolling)
    return np.asarray(1e-3 * work * speed[:, None, None, None])


def of_patches(solved: SolvedRollers) -> Values:
    """Return what the tractions give, at the values of the materials and at both ends of their
    placeholders.

    These are the largest temperature rise of each body if it took all heat of the contact, `_rise`,
    (n, contact, body, place) [K], the power of friction, `_heat_power` [W], and the mean of
    pressure times velocity, `_pressure_velocity` [MPa m/s], (n, contact).
    """
    # numba compiles on import, and planning needs none of it
    from trackroller.damage.moving_source import largest_rises

    t = solved.tractions()
    v = solved.values
    speed = solved.cases["velocity"] * 1e3 / 60.0
    heat = heat_density(t, speed)
    places = [solved]
    if solved.ends:
        places += [solved.at_end(end) for end in (0, 1)]
    # (n, body, place)
    conductivity, diffusivity = (
        np.stack([values_of(place.materials) for place in places], axis=2)
        for values_of in (_conductivity, _diffusivity)
    )
    decays = speed[:, None, None] / (4.0 * diffusivity)
    case, contact = t.solved_patches
    steps = np.stack(t.steps, axis=2)[case, contact]
    own_decays = decays[case].reshape(case.size, len(BODIES) * len(places))
    rises = largest_rises(steps, heat[case, contact], own_decays)
    whole = t.of_all_patches(rises.reshape(-1, *decays.shape[1:]) / conductivity[case])
    cell = (t.x[:, :, 1] - t.x[:, :, 0]) * (t.y[:, :, 1] - t.y[:, :, 0])
    slides = (t.slip * t.pressure).sum(axis=(2, 3))
    return {
        "_rise": whole,
        "_heat_power": heat.sum(axis=(2, 3)) * cell,
        "_pressure_velocity": 1e-3 * speed[:, None] * slides * cell / v["patch_area"],
    }


def _conductivity(materials: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return K of roller and guide, (n, 2) [W/(mm K)]."""
    return np.asarray(1e-3 * materials["thermal_conductivity"])


def _diffusivity(materials: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return kappa of roller and guide, (n, 2) [mm2/s]."""
    m = materials
    return np.asarray(1e6 * m["thermal_conductivity"] / (m["density"] * m["heat_capacity"]))


def hysteresis_moments(
    force: np.ndarray, length: np.ndarray, loss: np.ndarray, compliance: np.ndarray
) -> np.ndarray:
    """Return the moment that the loss of strain energy takes in each body, 3 alpha P b/16 (Johnson
    1985, ch. 9).

    Parameters
    ----------
    force, length : numpy.ndarray
        Normal force [N] and semi-axis b along the rolling direction [mm], (n, contact).
    loss, compliance : numpy.ndarray
        Share alpha of the strain energy that a body loses in a cycle [1], and (1 - nu^2)/E, (n,
        body).

    Returns
    -------
    numpy.ndarray
        Moments, (n, contact, body) [N mm]. The bodies store energy in proportion to their
        compliance.
    """
    share = compliance / compliance.sum(axis=1, keepdims=True)
    return np.asarray(3.0 / 16.0 * (force * length)[:, :, None] * (loss * share)[:, None, :])


def evaluate(solved: SolvedRollers) -> Values:
    """Return temperature rises [K], (n, contact, body), partition and hysteresis, (n, contact).

    `drive_torque` [N mm] and `rolling_resistance` [N], (n,), take in the hysteresis of both
    contacts.
    """
    m = solved.materials
    v = solved.values
    c = solved.cases
    speed = c["velocity"] * 1e3 / 60.0
    whole = v["_rise"][..., solved.place]
    total = whole.sum(axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        partition = np.where(total > 0, whole[:, :, 1] / total, 0.5 + 0.0 * total)
    soft = (1.0 - m["poisson_ratio"] ** 2) / m["youngs_modulus"]
    moments = hysteresis_moments(
        v["normal_force"], v["semi_axis_rolling"], m["loss_fraction"], soft
    )
    lost = 1e-3 * moments[:, :, 0] * (speed / solved.rolling_radius)[:, None]
    power = (partition * v["_heat_power"] + lost).sum(axis=1)
    bulk = power / (1e-6 * c["heat_transfer_coefficient"] * c["cooled_area"])
    flashes = whole * np.stack([partition, 1.0 - partition], axis=2)
    bulks = np.stack([bulk[:, None] + 0.0 * partition, 0.0 * partition], axis=2)
    allowed = np.fmin(m["temperature_limit"], c["permissible_temperature"][:, None])
    room = (allowed - c["ambient_temperature"][:, None])[:, None, :]
    rise = flashes + bulks
    # a body whose surroundings are too hot is over its limit without any heat of its own
    used = np.where(
        (room <= 0.0) & ~np.isnan(rise), np.inf, rise / np.where(room > 0.0, room, np.nan)
    )
    lossy = np.nan_to_num(moments.sum(axis=2).sum(axis=1))
    with_hysteresis = {}
    if "rolling_resistance" in v:
        resistance = v["rolling_resistance"] + lossy / solved.rolling_radius
        with_hysteresis["rolling_resistance"] = resistance
    return {
        # the drive turns the roller against the loss; without a known loss the torque is that of
        # the tractions alone one axis after the other: the order of a sum over two depends on the
        # number of cases
        "drive_torque": v["drive_torque"] + lossy,
        **with_hysteresis,
        "flash_temperature_rise": flashes,
        "bulk_temperature_rise": bulks,
        "heat_utilisation": used,
        "heat_partition": partition,
        "hysteresis_moment": moments.sum(axis=2),
        "pressure_velocity": v["_pressure_velocity"],
    }


_CB = ("contact", "body")
_C = ("contact",)
LIMIT = Limit(
    name="heat",
    title="heat (temperature limit of the material)",
    short="heat",
    group="heat",
    meaning="flash and bulk temperature of roller and guide, hysteresis, pressure times velocity",
    shared=of_patches,
    shared_by_mechanics=False,
    evaluate=evaluate,
    use=lambda solved, results: LimitUse(worst(results["heat_utilisation"]), None),
    needs=(TRACTIONS,),
    results=variables(
        "heat",
        (
            "flash_temperature_rise",
            _CB,
            "K",
            "theta_f",
            "largest rise of the surface temperature in the patch",
            LARGEST,
        ),
        (
            "bulk_temperature_rise",
            _CB,
            "K",
            "theta_b",
            "mean temperature rise of the body by friction and hysteresis",
            LARGEST,
        ),
        (
            "heat_utilisation",
            _CB,
            "1",
            "",
            "temperature rise over what the permissible temperature leaves",
            LARGEST,
        ),
        ("heat_partition", _C, "1", "beta", "share of the heat that flows into the roller"),
        (
            "hysteresis_moment",
            _C,
            "N mm",
            "M_h",
            "rolling resistance by the loss of strain energy in both bodies",
            SUM,
        ),
        (
            "pressure_velocity",
            _C,
            "MPa m s-1",
            "p v",
            "mean of pressure times slip speed over the patch",
            LARGEST,
        ),
    ),
    parameters=(
        optional(
            "heat_transfer_coefficient",
            "h",
            "W/(m2 K)",
            "heat transfer coefficient of the roller",
            0.0,
        ),
        optional("cooled_area", "A_c", "mm2", "surface from which the roller loses heat", 0.0),
        Parameter(
            "ambient_temperature",
            "theta_0",
            "degC",
            20.0,
            "temperature of the surroundings",
            -100.0,
            1000.0,
            role="condition",
        ),
        optional(
            "permissible_temperature",
            "theta_zul",
            "degC",
            "permissible temperature of roller and guide; that of their materials counts too",
            -100.0,
            4e3,
        ),
    ),
    materials=(
        optional(
            "loss_fraction",
            "alpha",
            "-",
            "share of the strain energy lost in a cycle",
            0.0,
            1.0,
            closed=True,
        ),
        optional("thermal_conductivity", "K", "W/(m K)", "thermal conductivity", 0.0, 5e3),
        optional("heat_capacity", "c", "J/(kg K)", "heat capacity", 0.0, 2e4),
        optional("density", "rho", "kg/m3", "density", 0.0, 3e4),
        optional(
            "temperature_limit", "theta_max", "degC", "highest temperature in use", -100.0, 4e3
        ),
    ),
    requires=(
        "thermal_conductivity",
        "heat_capacity",
        "density",
        "loss_fraction",
        "temperature_limit",
        "heat_transfer_coefficient",
        "cooled_area",
    ),
    or_field={"temperature_limit": "permissible_temperature"},
    compares=("heat_utilisation", "temperature rise that is permitted"),
    assumes=(
        "Heat: friction and values of materials do not depend on temperature, but E and R_m "
        "where a table is given.",
    ),
)
