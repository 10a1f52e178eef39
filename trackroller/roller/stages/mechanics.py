"""The stages of a solution up to the tractions: each takes the `Results` so far and adds its own quantities.

Those that look for stresses stand in `stages.stress`, what each case makes of them in `stages.case`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trackroller.contact.common import ContactModel, Elastic
from trackroller.contact.friction_laws import law_of
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.hertz import contact_modulus, shape
from trackroller.contact.models import contact_model
from trackroller.contact.slip import turning_of
from trackroller.roller import equilibrium as eq
from trackroller.roller.case import CaseTable
from trackroller.roller.dataset import validity_bit
from trackroller.roller.geometry import curvatures, lever_arms, rolling_radius
from trackroller.roller.options import Options
from trackroller.roller.requirements import Mirror, is_frictionless, is_mirror_symmetric
from trackroller.roller.stages import grid as stages_grid
from trackroller.roller.stages.scene import Results, Scene, surface_tractions

SIGN_CONVENTIONS = (
    "contact frame: x lateral, y in the rolling direction, z into the body; friction forces act on the roller; "
    "motor_force < 0 drives, > 0 brakes; contact 1 at +x_R, contact 2 at -x_R"
)


def prepare(table: CaseTable, options: Options) -> Scene:
    """Curvatures, Hertz shape and loads of a block."""
    alpha = np.deg2rad(table.contact_angle)
    r_a = rolling_radius(table.axis_distance, table.guide_profile_radius, alpha)
    k_x, k_y = curvatures(table.roller_profile_radius, table.guide_profile_radius, table.guide_curve_radius, r_a, alpha)
    bodies = (
        table.roller.youngs_modulus,
        table.roller.poisson_ratio,
        table.guide.youngs_modulus,
        table.guide.poisson_ratio,
    )
    hertz = shape(k_x, k_y, contact_modulus(*bodies), options.hertz)
    turning = None
    if "curve" in options.slip_terms:
        turning = turning_of(table.guide_curve_radius, table.guide_profile_radius, np.cos(alpha))
        # without a turning no solution is sought
        hertz = replace(hertz, lateral=np.where(np.isnan(turning), np.nan, hertz.lateral))
    # the cases of a group share their law
    law, travel = law_of(table.friction_law[0] if len(table) else None), table.velocity * (1000.0 / 60.0)
    model: ContactModel
    if options.normal == "halfspace":
        model = stages_grid.halfspace_model(table, options, r_a, law, travel)
    else:
        model = contact_model(
            options.contact_model,
            options.settings,
            Elastic.of_pair(*bodies),
            options.spin_model,
            law,
            travel,
            options.slip_terms,
        )
    loads = eq.Loads(
        table.radial_force,
        table.axial_force,
        table.motor_force,
        table.friction_coefficient,
        alpha,
        table.guide_profile_radius,
        r_a,
        hertz,
        model.difference_step,
        model.residual,
        falling=not law.is_constant,
        at_high_speed=law.at_high_speed,
    )
    bare = options.shortcuts and bool(is_frictionless(table).all())
    twins = is_mirror_symmetric(table) if options.shortcuts else np.zeros(len(table), bool)
    return Scene(table, loads, model, Mirror(twins), bare, len(table), turning)


def forces(results: Results) -> None:
    """Forces of both contacts and the resulting moments, eqs (8)-(14)."""
    f, b, loads, v = results.balance.forces, results.balance, results.scene.loads, results.values
    table = results.scene.table
    v["normal_force"], v["lateral_force"] = b.normal_force, f.lateral_force
    v["driving_force"], v["spin_moment"] = f.driving_force, f.spin_moment
    v["rolling_radius_shift"], v["slip"] = b.shift, b.shift / loads.rolling_radius
    sine, cosine = np.sin(loads.contact_angle), np.cos(loads.contact_angle)
    h_n, h_t = lever_arms(table.axis_distance, table.guide_profile_radius, loads.contact_angle)
    m, a, t, n = f.spin_moment, f.driving_force, f.lateral_force, b.normal_force
    v["drilling_torque"] = (m[:, 0] - m[:, 1]) * sine
    v["tilting_moment"] = h_n * (n[:, 0] - n[:, 1]) + h_t * (t[:, 0] + t[:, 1])
    v["yaw_moment"] = -((m[:, 0] + m[:, 1]) * cosine + (a[:, 0] - a[:, 1]) * loads.rolling_radius * sine)
    v["transmitted_force"] = a[:, 0] + a[:, 1]
    if isinstance(results.ellipse, GridPatch):
        stages_grid.shift_of_pressure(results, results.ellipse)


def contact(results: Results, options: Options) -> None:
    """Ellipse, pressure, shear and spin pole of both contacts."""
    v, e = results.values, results.ellipse
    v["semi_axis_lateral"] = results.by_contact(e.semi_axis_lateral)
    v["semi_axis_rolling"] = results.by_contact(e.semi_axis_rolling)
    v["max_pressure"] = results.by_contact(e.max_pressure)
    v["max_shear"] = results.by_contact(results.friction * e.max_pressure)  # where all slides under a constant law
    if isinstance(e, GridPatch):
        stages_grid.contact(results, e, validity_bit("conformal"))
    else:
        v["patch_area"] = np.pi * v["semi_axis_lateral"] * v["semi_axis_rolling"]
        v["pressure_centre"] = 0.0 * v["semi_axis_lateral"]
    pole_x = results.slip.pole_lateral
    with np.errstate(invalid="ignore"):
        ratio = (pole_x - (e.centre if isinstance(e, GridPatch) else 0.0)) / e.semi_axis_lateral
        pole_y = np.where(np.abs(ratio) < 1, -e.semi_axis_rolling * np.sqrt(np.maximum(1 - ratio**2, 0)), 0.0)
    if options.spin_model == "concentric":
        pole_y = np.zeros_like(pole_y)
    pole_y = np.where(np.isfinite(pole_x), pole_y, np.nan)
    v["spin_pole_lateral"], v["spin_pole_rolling"] = results.by_contact(pole_x), results.by_contact(pole_y)
    if results.scene.model.full_sliding or results.scene.frictionless:
        v["stick_area_fraction"] = results.by_contact(np.where(results.good, 0.0, np.nan))
    elif "contact" in options.outputs or "max_shear" in (options.stop_if or ""):
        v["stick_area_fraction"] = results.full(_stick_share(results))
        if results.scene.model.knows_tractions:  # a table knows the bound of the shear only
            v["max_shear"] = results.full(_largest_shear(results))


def steep_friction(results: Results, options: Options) -> None:
    """Marks cases with mu p_max v max(-df/dv)/G above 1: friction falls on the slip that elasticity gives way by.

    An element under traction tau moves by about tau/G of the travel; where friction falls with that by more than the
    traction itself, its state is not unique. That is why most rollers without a balance have none: the pressure of
    those is judged by their forces without friction.
    """
    scene = results.scene
    table, loads = scene.table, scene.loads
    if not loads.falling or options.contact_model == "sliding":
        return
    r, g = table.roller, table.guide
    shear = Elastic.of_pair(r.youngs_modulus, r.poisson_ratio, g.youngs_modulus, g.poisson_ratio).shear_modulus
    fall = law_of(table.friction_law[0]).steepest_fall * table.velocity * (1000.0 / 60.0)
    plain = 0.5 * (
        np.abs(loads.radial_force) / np.cos(loads.contact_angle)
        + np.abs(loads.axial_force) / np.sin(loads.contact_angle)
    )
    pressure = np.where(
        results.regime == eq.FAILED,
        loads.shape.pressure * np.cbrt(plain),
        np.max(results.values["max_pressure"], axis=1),
    )
    with np.errstate(invalid="ignore"):
        steep = loads.friction * pressure * fall / shear > 1.0
    results.bits |= np.where(steep, validity_bit("steep_friction"), 0).astype(np.int32)


def _stick_share(results: Results) -> np.ndarray:
    """Share of each existing patch that sticks; a table of the contact model knows it without tractions."""
    model, good = results.scene.model, results.good
    if model.knows_tractions:
        return surface_tractions(results).stick_share
    rolls = results.slides_along[good] == 0
    slip = replace(results.slip, shift=np.where(np.isfinite(results.slip.shift), results.slip.shift, 0.0)).take(good)
    share = model.stick(results.ellipse.take(good), slip, results.friction[good], results.rows[good])
    return np.where(rolls, share, 0.0)


def _largest_shear(results: Results) -> np.ndarray:
    """Largest |tau| of each existing patch [MPa]; under an ellipse the grid misses it as it misses the pressure's."""
    t = surface_tractions(results)
    largest = np.max(np.hypot(t.shear_lateral, t.shear_rolling), axis=(1, 2))
    if isinstance(results.ellipse, GridPatch):
        return largest
    return largest * results.ellipse.max_pressure[results.good] / np.max(t.pressure, axis=(1, 2))


def friction_work(results: Results, options: Options) -> None:
    """Friction energy int |tau| |v| per distance travelled, and the balance of energy."""
    per_distance, pressed = np.full(2 * results.scene.n, np.nan), np.zeros(2 * results.scene.n)
    rolls = results.good & (results.slides_along == 0)
    if results.scene.frictionless:
        per_distance[rolls] = 0.0
    elif rolls.any():
        mirror = results.scene.mirror
        asked = mirror.asked(rolls)
        works = results.scene.model.power(
            results.ellipse.take(asked), results.slip.take(asked), results.friction[asked], results.rows[asked]
        )
        per_distance[rolls] = mirror.spread(rolls, works.dissipated)
        pressed[rolls] = mirror.spread(rolls, works.by_pressure)
    w = results.by_contact(per_distance)
    results.values["friction_energy_per_distance"] = w
    _energy_balance(results, w, results.by_contact(pressed))


def _energy_balance(results: Results, local: np.ndarray, pressed: np.ndarray) -> None:
    """Dissipation that the resultants imply, -(xi F_A + phi M_R), and how far the local one is from the work put in.

    Work of the motor less that of the transmitted force per distance: -F_Motor - (1 + xi) (F_A1 + F_A2), which the
    balance of the drive torque makes equal to the sum over both contacts. Where the roller turns with the guide's
    curve, the drilling torque (M_R1 - M_R2) sin(alpha) works on that turning too; whatever leads the roller round the
    curve puts that in. On unlike materials the pressures put in `pressed` [N].
    ASSUME: the drive has no part in that; the torque of pressures which shear shifts is not in its balance.
    """
    v, loads = results.values, results.scene.loads
    xi = v["slip"]
    spin = results.by_contact(results.slip.spin)
    v["friction_energy_balance"] = -(xi[:, None] * v["driving_force"] + spin * v["spin_moment"])
    put_in = -loads.motor_force - (1.0 + xi) * v["transmitted_force"] + pressed.sum(axis=1)
    if results.scene.turning is not None:
        put_in = put_in + results.scene.turning * v["drilling_torque"]
    with np.errstate(divide="ignore", invalid="ignore"):
        residual = np.abs(local.sum(axis=1) - put_in) / np.abs(put_in)
    v["energy_residual"] = np.where(loads.friction > 0, residual, np.nan)


def tractions(results: Results, options: Options) -> None:
    """Pressure, shear, slip and friction energy over the patches."""
    t = surface_tractions(results)
    fields = {
        "patch_x": t.x,
        "patch_y": t.y,
        "pressure": t.pressure,
        "shear_lateral": t.shear_lateral,
        "shear_rolling": t.shear_rolling,
        "slip_lateral": t.slip_lateral,
        "slip_rolling": t.slip_rolling,
        "friction_energy_density": np.hypot(t.shear_lateral, t.shear_rolling)
        * np.hypot(t.slip_lateral, t.slip_rolling),
    }
    results.values.update({name: results.full(value) for name, value in fields.items()})
