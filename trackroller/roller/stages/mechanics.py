"""The stages of a solution up to the tractions; each stage takes the `StageResults` so far and adds
its quantities.

The stages that compute stresses stand in `stages.stress`; friction power, life and warnings stand
in `stages.outcome`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trackroller.contact import close_fit
from trackroller.contact.drawn_profiles import inclined
from trackroller.contact.friction_laws import law_of, steepness
from trackroller.contact.hertz import contact_modulus, shape
from trackroller.contact.normal.patches import Boxes
from trackroller.contact.quantities import Elastic, error_of_work
from trackroller.contact.slip import pole_rolling, turning_of
from trackroller.contact.wedge import determinant, own_change
from trackroller.numerics.numbers import rounded
from trackroller.roller import equilibrium as eq
from trackroller.roller.case import CaseTable
from trackroller.roller.distinct_contacts import Mirror, is_frictionless, is_mirror_symmetric
from trackroller.roller.expected_errors import expected_errors
from trackroller.roller.geometry import contact_geometry, lever_arms
from trackroller.roller.options import Options
from trackroller.roller.stages.models import bodies, model_of
from trackroller.roller.stages.scene import Scene, StageResults, surface_tractions
from trackroller.roller.stop import stops_at

SIGN_CONVENTIONS = (
    "contact frame: x lateral, y in the rolling direction, z into the body; friction forces "
    "act on the roller; "
    "motor_force < 0 drives, > 0 brakes; contact 1 at +x_R, contact 2 at -x_R"
)
MM_PER_S = 1000.0 / 60.0  # mm/s for 1 m/min
FINITE = {
    "normal_force",
    "lateral_force",
    "driving_force",
    "spin_moment",
    "max_pressure",
    "peak_stress",
}


def prepare(
    table: CaseTable, options: Options, across: int = 1, near: Boxes | None = None
) -> Scene:
    """Compute curvatures, Hertz shape, contact model and loads of a block.

    Rollers on Hertzian patches are solved with r_A as the unit of length, and what enters the
    solution is rounded. So rollers that differ in size alone have the same stresses, bit for bit.
    Unrounded, their inputs would differ in the last digits, which changes a peak stress by up to
    1e-3.

    Parameters
    ----------
    table : n cases that share their friction law
    options : contact model, normal problem, slip terms, accuracy and shortcuts
    across, near : factor on the elements across solved patches and boxes to start from, see
        `models.model_of`
    """
    alpha, r_a, k_x, k_y = contact_geometry(vars(table))
    unit = np.ones(len(table))  # drawn profiles are in mm
    if options.normal == "hertz":
        unit = r_a
    r_a = r_a / unit
    k_x = rounded(k_x * unit)
    k_y = rounded(k_y * unit)
    guide = rounded(table.guide_profile_radius / unit)
    curve = rounded(table.guide_curve_radius / unit)
    hertz = shape(k_x, k_y, contact_modulus(*bodies(table)), options.hertz)
    turning = None
    if "curve" in options.slip_terms:
        turning = turning_of(curve, guide, np.cos(alpha))
        # a contact beyond the axis of a concave guide cannot turn with it: its shape is NaN, and
        # the row fails
        hertz = replace(hertz, lateral=np.where(np.isnan(turning), np.nan, hertz.lateral))
    law = law_of(None)
    if len(table):
        law = law_of(table.friction_law[0])
    film = rounded(table.layer_flexibility / unit)
    model = model_of(table, options, r_a, law, table.velocity * MM_PER_S, across, near, film)
    loads = eq.RollerLoads(
        rounded(table.radial_force / unit**2),
        rounded(table.axial_force / unit**2),
        rounded(table.motor_force / unit**2),
        table.friction_coefficient,
        alpha,
        guide,
        r_a,
        hertz,
        model.difference_step,
        model.residual,
        falling=not law.is_constant,
        at_high_speed=law.at_high_speed,
    )
    bare = options.shortcuts and bool(is_frictionless(table).all())
    if options.shortcuts:
        twins = is_mirror_symmetric(table)
    else:
        twins = np.zeros(len(table), bool)
    turned = np.array([inclined(str(text)) for text in table.guide_profile]).reshape(-1, 2) * [
        1.0,
        -1.0,
    ]
    inclination = None
    if turned.any():
        inclination = turned
    return Scene(table, loads, model, unit, Mirror(twins), bare, len(table), turning, inclination)


def forces(results: StageResults) -> None:
    """Add the forces of both contacts and the resulting moments, eqs (8)-(14).

    Where the resultant of the pressure lies beside the nominal point of contact, its offset adds
    F_N x_p to the tilting moment, and in full slip F_A x_p is the spin moment.
    """
    f = results.balance.forces
    b = results.balance
    loads = results.scene.loads
    v = results.values
    offset = results.by_contact(results.patch.pressure_centre)
    slides = (results.regime == eq.FULL_SLIP)[:, None]
    v["normal_force"] = b.normal_force
    v["lateral_force"] = f.lateral_force
    if results.scene.inclined is not None:
        v["lateral_force"] = f.lateral_force - b.normal_force * results.scene.inclined
    v["driving_force"] = f.driving_force
    v["spin_moment"] = np.where(slides, offset * f.driving_force, f.spin_moment)
    v["rolling_radius_shift"] = b.shift
    v["slip"] = b.shift / loads.rolling_radius
    height = results.scene.table.axis_distance / results.scene.unit
    h_n, h_t = lever_arms(height, loads.guide_profile_radius, loads.contact_angle)
    m = f.spin_moment
    a = f.driving_force
    t = f.lateral_force
    n = b.normal_force
    # eqs (10), (11), (12)
    v["drilling_torque"] = (m[:, 0] - m[:, 1]) * loads.sine
    tilting = h_n * (n[:, 0] - n[:, 1]) + h_t * (t[:, 0] + t[:, 1])
    v["tilting_moment"] = tilting + (n * offset).sum(axis=1)
    v["yaw_moment"] = -(
        (m[:, 0] + m[:, 1]) * loads.cosine + (a[:, 0] - a[:, 1]) * loads.rolling_radius * loads.sine
    )
    v["transmitted_force"] = a[:, 0] + a[:, 1]
    v["drive_torque"] = v["drilling_torque"] + v["transmitted_force"] * loads.rolling_radius


def force_error(results: StageResults, options: Options) -> None:
    """Add the estimated errors of F_N, and of the friction forces over mu F_N.

    Models without an estimate give the measured bound.

    An error of the ratio F_T/F_N of one contact changes F_N of both contacts by eqs (7), (9). The
    relative change is largest in a contact near lift-off.
    """
    scene = results.scene
    v = results.values
    error = scene.model.force_error(scene.n)
    twins = scene.mirror.symmetric
    error[twins] = np.fmax(error[twins, :1], error[twins, 1:])
    plain = not scene.loads.falling and not np.any(scene.table.layer_flexibility)
    measured = expected_errors(options, scene.model.name, plain).get("friction_force")
    if measured is not None:
        error = np.where(np.isnan(error), max(measured.bound, measured.p99), error)
    known = (results.regime == eq.FULL_SLIP) | (scene.loads.friction == 0.0)
    capacity = scene.loads.friction[:, None] * v["normal_force"]
    with np.errstate(divide="ignore", invalid="ignore"):
        used = np.hypot(v["lateral_force"], v["driving_force"]) / capacity
        of_load = _load_error(results, error * scene.loads.friction[:, None])
        error = error + np.sqrt(used) * of_load
    for name, estimate in (
        ("force_error_estimate", error),
        ("normal_force_error_estimate", of_load),
    ):
        estimate = np.where(known[:, None], 0.0, estimate)
        v[name] = np.where(np.isfinite(v["lateral_force"]), estimate, np.nan)


def _load_error(results: StageResults, of_ratio: np.ndarray) -> np.ndarray:
    """Return the relative errors of F_N that errors (n, 2) of the ratios F_T/F_N cause by eqs (7),
    (9), (n, 2).
    """
    v = results.values
    loads = results.scene.loads
    normal = v["normal_force"]
    one, two = (v["lateral_force"] / normal).T
    own = np.stack(
        [own_change(loads.sine, loads.cosine, two), own_change(loads.sine, loads.cosine, -one)],
        axis=1,
    )
    wedge = np.abs(determinant(loads.sine, loads.cosine, one, two))
    return (own * of_ratio + (of_ratio * normal)[:, ::-1] / normal) / wedge[:, None]


def contact(results: StageResults, options: Options) -> None:
    """Add extent, pressure, shear, adhesion area and spin pole of both contacts."""
    v = results.values
    patch = results.patch
    model = results.scene.model
    wide, long = patch.half_extents
    v["semi_axis_lateral"] = results.by_contact(wide)
    v["semi_axis_rolling"] = results.by_contact(long)
    v["max_pressure"] = results.by_contact(patch.max_pressure)
    v["patch_area"] = results.by_contact(patch.area)
    v["pressure_centre"] = results.by_contact(patch.pressure_centre)
    results.flag("conformal", np.logical_or.reduce(results.by_contact(patch.reaches_edge), axis=1))
    _close_fit(results, options)
    pole_x, pole_y = _spin_pole(results, options)
    v["spin_pole_lateral"] = results.by_contact(pole_x)
    v["spin_pole_rolling"] = results.by_contact(pole_y)
    # mu p_max is exact where the whole patch slides under a constant friction law, and a bound
    # elsewhere
    v["max_shear"] = results.by_contact(results.friction * patch.max_pressure)
    if model.full_sliding or results.scene.frictionless:
        v["stick_area_fraction"] = results.by_contact(np.where(results.good, 0.0, np.nan))
    elif "contact" in options.outputs or "max_shear" in stops_at(options.stop_if):
        if model.knows_tractions:
            v["max_shear"] = results.full(_largest_shear(results))
        v["stick_area_fraction"] = _stick_share(results)


def _close_fit(results: StageResults, options: Options) -> None:
    """Add a/R and the errors of Hertz's theory that follow from it; NaN for patches that are no
    ellipses.
    """
    v = results.values
    scene = results.scene
    radii = (
        scene.table.guide_profile_radius / scene.unit,
        scene.table.roller_profile_radius / scene.unit,
    )
    ratio = close_fit.conformity(v["semi_axis_lateral"], *radii)
    v["conformity"] = ratio
    if options.normal != "hertz":
        ratio = np.full_like(ratio, np.nan)
    for name, law in close_fit.LAWS.items():
        v[name] = close_fit.model_error(ratio, law)


def _spin_pole(results: StageResults, options: Options) -> tuple[np.ndarray, np.ndarray]:
    """Return the spin pole x, y [mm] of the model's slip field, (2 n,), eqs (22), (23)."""
    patch = results.patch
    pole_x = results.slip.pole_lateral
    with np.errstate(invalid="ignore"):
        pole_y = np.nan_to_num(
            pole_rolling(pole_x - patch.centre, patch.semi_axis_lateral, patch.semi_axis_rolling)
        )
    if options.spin_model == "concentric":
        pole_y = np.zeros_like(pole_y)
    return pole_x, np.where(np.isfinite(pole_x), pole_y, np.nan)


def steep_friction(results: StageResults, options: Options) -> None:
    """Flag cases whose friction law falls too steeply for a unique solution, see
    `friction_laws.steepness`.

    Most rollers without a balance fail for this reason. A failed roller has no patch; its forces
    without friction give an estimate.
    """
    scene = results.scene
    table = scene.table
    loads = scene.loads
    if not loads.falling or not scene.model.elastic:
        return
    plain = 0.5 * (
        np.abs(loads.radial_force) / loads.cosine + np.abs(loads.axial_force) / loads.sine
    )
    failed = results.regime == eq.FAILED
    root = np.cbrt(plain)
    pressure = np.where(
        failed, loads.shape.pressure * root, np.max(results.values["max_pressure"], axis=1)
    )
    half = np.where(
        failed, loads.shape.rolling * root, np.min(results.values["semi_axis_rolling"], axis=1)
    )
    steep = steepness(
        law_of(table.friction_law[0]),
        loads.friction * pressure,
        table.velocity * MM_PER_S,
        Elastic.of_pair(*bodies(table)).shear_modulus,
        table.layer_flexibility / scene.unit,
        2.0 * half / max(scene.model.elements, 1),
    )
    with np.errstate(invalid="ignore"):
        results.flag("steep_friction", steep > 1.0)


def _stick_share(results: StageResults) -> np.ndarray:
    """Return the share of the adhesion area in both patches of each roller [1], 0 in full slip, (n,
    2).
    """
    mirror = results.scene.mirror
    rolls = results.good & (results.slides_along == 0)
    share = results.scene.model.stick(*results.of(mirror.to_solve(rolls)))
    if share is None:
        return results.full(surface_tractions(results).stick_share)
    out = np.where(results.good, 0.0, np.nan)
    out[rolls] = mirror.spread(rolls, share)
    return results.by_contact(out)


def _largest_shear(results: StageResults) -> np.ndarray:
    """Return the largest |tau| of each existing patch [MPa].

    Under an ellipse the grid misses the largest shear as it misses the largest pressure, which is
    known: the ratio of the two pressures corrects the shear.
    """
    t = surface_tractions(results)
    largest = np.max(t.shear, axis=(1, 2))
    if not results.patch.is_hertzian:
        return largest
    return largest * results.patch.max_pressure[results.good] / np.max(t.pressure, axis=(1, 2))


def dissipation(results: StageResults) -> tuple[np.ndarray, np.ndarray]:
    """Return the friction energy int |tau| |v| per distance, and the work that the pressures
    supply, (n, 2) [N].
    """
    per_distance = np.full(2 * results.scene.n, np.nan)
    pressed = np.zeros(2 * results.scene.n)
    rolls = results.good & (results.slides_along == 0)
    if results.scene.frictionless:
        per_distance[rolls] = 0.0
    elif rolls.any():
        mirror = results.scene.mirror
        works = results.scene.model.power(*results.of(mirror.to_solve(rolls)))
        per_distance[rolls] = mirror.spread(rolls, works.dissipated)
        pressed[rolls] = mirror.spread(rolls, works.by_pressure)
    return results.by_contact(per_distance), results.by_contact(pressed)


def friction_work(results: StageResults, options: Options) -> None:
    """Add the friction energy per distance travelled, its estimated error, and the energy
    balance.
    """
    v = results.values
    model = results.scene.model
    v["friction_energy_per_distance"], pressed = dissipation(results)
    first, second = v["friction_energy_per_distance"].T
    v["rolling_resistance"] = first + second
    _energy_balance(results, v["friction_energy_per_distance"], pressed)
    forces = v["driving_force"].T.reshape(-1), v["spin_moment"].T.reshape(-1)
    factor = results.by_contact(
        error_of_work(results.patch, results.slip, results.friction, *forces)
    )
    # elements lose energy where nearly all sticks; in full sliding the difference is the model's
    lost = 0.0
    if model.elastic:
        lost = np.nan_to_num(np.abs(v["energy_residual"]))[:, None]
    error = v["force_error_estimate"]
    with np.errstate(invalid="ignore"):
        v["friction_energy_error_estimate"] = np.where(error > 0.0, error * factor + lost, error)


def _energy_balance(results: StageResults, local: np.ndarray, pressed: np.ndarray) -> None:
    """Add the dissipation that the resultants imply, and the difference between the local
    dissipation and the work.

    The resultants dissipate -(xi F_A + phi M_R). The motor puts in, less the work of the
    transmitted force per distance, -F_Motor - (1 + xi) (F_A1 + F_A2); the balance of the drive
    torque makes this equal to the sum over both contacts. Where the roller turns with the guide's
    curve, the drilling torque (M_R1 - M_R2) sin(alpha) works on that turning too; the support that
    leads the roller round the curve supplies this work. On unlike materials the pressures supply
    `pressed` [N]. ASSUME: the drive supplies no part of the work of the pressures; the torque of
    pressures that shear shifts is not in the balance of the drive torque.
    """
    v = results.values
    loads = results.scene.loads
    xi = v["slip"]
    spin = results.by_contact(results.slip.spin)
    v["friction_energy_balance"] = -(xi[:, None] * v["driving_force"] + spin * v["spin_moment"])
    put_in = -loads.motor_force - (1.0 + xi) * v["transmitted_force"] + pressed.sum(axis=1)
    if results.scene.turning is not None:
        put_in = put_in + results.scene.turning * v["drilling_torque"]
    with np.errstate(divide="ignore", invalid="ignore"):
        residual = np.abs(local.sum(axis=1) - put_in) / np.abs(put_in)
    v["energy_residual"] = np.where(loads.friction > 0, residual, np.nan)


def settle(results: StageResults) -> None:
    """Take the mark of convergence from rolling rows with a force, a pressure or a peak that is no
    finite number.
    """
    v = results.values
    rolls = results.regime == eq.ROLLING
    for name in FINITE & v.keys():
        settled = ~rolls | np.isfinite(v[name]).all(axis=tuple(range(1, v[name].ndim)))
        if name == "peak_stress":
            settled = settled | results.stopped
        results.converged = results.converged & settled


def tractions(results: StageResults, options: Options) -> None:
    """Add pressure, shear, slip and friction energy over the patches."""
    t = surface_tractions(results)
    fields = {
        "patch_x": t.x,
        "patch_y": t.y,
        "pressure": t.pressure,
        "shear_lateral": t.shear_lateral,
        "shear_rolling": t.shear_rolling,
        "slip_lateral": t.slip_lateral,
        "slip_rolling": t.slip_rolling,
        "friction_energy_density": t.shear * t.slip,
    }
    results.values.update({name: results.full(value) for name, value in fields.items()})
