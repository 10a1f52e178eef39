"""The stages of a solution: each takes the `Results` so far and adds its own quantities.

Arrays have the case as first axis (n,), then contact (2) and body (2: roller, guide).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from trackroller import equilibrium as eq
from trackroller import fatigue, stages_grid
from trackroller.case import CaseTable
from trackroller.contact import sliding
from trackroller.contact.common import DetailedSlip, Elastic, Ellipse, Resultants, Slip, SurfaceTractions
from trackroller.contact.friction_laws import law_of
from trackroller.contact.hertz import contact_modulus, shape
from trackroller.contact.models import ContactModel, contact_model, traction_share
from trackroller.contact.normal_patch import GridPatch
from trackroller.contact.slip import pole_split, turning_of
from trackroller.contact.table_model import TableModel
from trackroller.dataset import VALIDITY_BITS
from trackroller.geometry import curvatures, lever_arms, rolling_radius
from trackroller.halfspace.bounds import lower_bounds
from trackroller.halfspace.ellipse import NO_FIELD, patch_rows, stress_parts
from trackroller.halfspace.peak import Peak, find_peaks
from trackroller.halfspace.stress import von_mises
from trackroller.parameters import CONTACT_MODELS
from trackroller.requirements import Mirror, distinct_rows, is_frictionless, is_mirror_symmetric, normalised_patches
from trackroller.stop import holds, parse_condition

if TYPE_CHECKING:
    from trackroller.blocks import Block
    from trackroller.solver import Options

LIFE_CONVENTIONS = (
    "Woehler line N = N_k (sigma/sigma_D)^-k through (N_Rm, R_m) and (N_k, sigma_D); the peak von Mises stress is "
    "taken as the amplitude (as published); below sigma_D: elementary runs the line on, haibach uses the slope 2k - 1, "
    "unlimited gives inf; roller: one overrolling per revolution; guide: overrollings per hour are the user's input"
)
JAMMING = 1 << list(VALIDITY_BITS).index("jamming")
SIGN_CONVENTIONS = (
    "contact frame: x lateral, y in the rolling direction, z into the body; friction forces act on the roller; "
    "motor_force < 0 drives, > 0 brakes; contact 1 at +x_R, contact 2 at -x_R"
)


@dataclass(frozen=True)
class Scene:
    """A block of cases with what follows from geometry and material alone."""

    table: CaseTable
    loads: eq.Loads
    model: ContactModel
    mirror: Mirror
    frictionless: bool  # none of the cases has friction: no tractions to look for
    n: int
    turning: np.ndarray | None = None  # of the rollers with the guide's curve [1/mm], (n,), if it counts

    def kinematics(self, slip: Slip, rows: np.ndarray) -> Slip:
        """The slip with the turning of the rollers `rows` in the curve, where that counts."""
        if self.turning is None:
            return slip
        return DetailedSlip(slip.sine, slip.cosine, slip.guide_profile_radius, slip.rolling_radius, slip.shift,
                            self.turning[rows], np.full(len(rows), None))  # fmt: skip

    def law(self, ellipse: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray, fine: bool) -> Resultants:
        """The contact law of the equilibrium."""
        return self.model.law(ellipse, self.kinematics(slip, rows), friction, rows, fine)


@dataclass
class Results:
    """Quantities found so far for one block."""

    scene: Scene
    balance: eq.Equilibrium
    regime: np.ndarray
    converged: np.ndarray
    ellipse: Ellipse  # arrays (2 n,): contact 1 of all cases, then contact 2
    slip: Slip
    friction: np.ndarray
    good: np.ndarray  # (2 n,) patches that exist
    bits: np.ndarray
    stopped: np.ndarray  # (n,) the condition of stop_if holds
    values: dict[str, np.ndarray] = field(default_factory=dict)
    surface: SurfaceTractions | None = None  # of the existing patches, once asked for
    share: np.ndarray | None = None  # their traction over its bound, once asked for

    @classmethod
    def start(cls, scene: Scene, balance: eq.Equilibrium) -> Results:
        normal = balance.normal_force.T.reshape(-1)
        s = scene.loads.shape
        two = lambda v: np.concatenate([v, v])  # noqa: E731
        sine = np.sin(scene.loads.contact_angle)
        ellipse = type(s)(two(s.lateral), two(s.rolling), two(s.pressure)).at(normal)
        slip = Slip(np.concatenate([sine, -sine]), two(np.cos(scene.loads.contact_angle)),
                    two(scene.loads.guide_profile_radius), two(scene.loads.rolling_radius),
                    two(balance.shift))  # fmt: skip
        slip = scene.kinematics(slip, np.tile(np.arange(scene.n), 2))
        if isinstance(scene.model, stages_grid.GRID_MODELS):
            ellipse = scene.model.patch(ellipse, slip, np.tile(np.arange(scene.n), 2))
        friction = scene.loads.friction * np.where(balance.regime == eq.FULL_SLIP, scene.loads.at_high_speed, 1.0)
        # the friction law of each patch has to hold beside the balance of the roller
        unmet, met = scene.model.state(scene.n)
        rolls = balance.regime == eq.ROLLING
        converged = balance.converged & (met | ~rolls)
        out = cls(scene, balance, balance.regime, converged, ellipse, slip, two(friction),
                  np.isfinite(normal), np.where(balance.jamming, JAMMING, 0).astype(np.int32),
                  np.zeros(scene.n, bool))  # fmt: skip
        out.values["residual"] = np.where(rolls, np.fmax(balance.residual, unmet), balance.residual)
        return out

    def by_contact(self, flat: np.ndarray) -> np.ndarray:
        """(2 n, ...) -> (n, 2, ...)."""
        return np.moveaxis(flat.reshape(2, self.scene.n, *flat.shape[1:]), 0, 1)

    @property
    def rows(self) -> np.ndarray:
        """The roller that each of the 2 n patches belongs to."""
        return np.tile(np.arange(self.scene.n), 2)

    @property
    def slides_along(self) -> np.ndarray:
        """Direction of the traction along y_C in full slip, 0 in rolling; shape (2 n,)."""
        along = np.where(self.regime == eq.FULL_SLIP, -np.sign(self.scene.loads.motor_force), 0.0)
        return np.concatenate([along, along])

    def full(self, flat_good: np.ndarray) -> np.ndarray:
        """Values of the existing patches spread to all, NaN elsewhere, shape (n, 2, ...)."""
        out = np.full((2 * self.scene.n, *flat_good.shape[1:]), np.nan)
        out[self.good] = flat_good
        return self.by_contact(out)


def prepare(table: CaseTable, options: Options) -> Scene:
    """Curvatures, Hertz shape and loads of a block."""
    alpha = np.deg2rad(table.contact_angle)
    r_a = rolling_radius(table.axis_distance, table.guide_profile_radius, alpha)
    k_x, k_y = curvatures(table.roller_profile_radius, table.guide_profile_radius, table.guide_curve_radius, r_a, alpha)
    bodies = (table.roller.youngs_modulus, table.roller.poisson_ratio,
              table.guide.youngs_modulus, table.guide.poisson_ratio)  # fmt: skip
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
        model = contact_model(options.contact_model, options.settings, Elastic.of_pair(*bodies), options.spin_model,
                              law, travel, options.slip_terms)  # fmt: skip
    loads = eq.Loads(table.radial_force, table.axial_force, table.motor_force, table.friction_coefficient, alpha,
                     table.guide_profile_radius, r_a, hertz, model.difference_step, model.residual,
                     falling=not law.is_constant, at_high_speed=law.at_high_speed)  # fmt: skip
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
    v["max_shear"] = results.by_contact(results.friction * e.max_pressure)
    if isinstance(e, GridPatch):
        stages_grid.contact(results, e, 1 << list(VALIDITY_BITS).index("conformal"))
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
    elif "contact" in options.outputs:
        v["stick_area_fraction"] = results.full(_stick_share(results))


def _stick_share(results: Results) -> np.ndarray:
    """Share of each existing patch that sticks; a table of the contact model knows it without tractions."""
    model, good = results.scene.model, results.good
    if not isinstance(model, TableModel):
        t = surface_tractions(results)
        return t.stick.sum(axis=(1, 2)) / (t.pressure > 0).sum(axis=(1, 2))
    rolls = results.slides_along[good] == 0
    slip = replace(results.slip, shift=np.where(np.isfinite(results.slip.shift), results.slip.shift, 0.0)).take(good)
    share = model.stick(results.ellipse.take(good), slip, results.friction[good], results.rows[good])
    return np.where(rolls, share, 0.0)


def friction_work(results: Results, options: Options) -> None:
    """Friction energy int |tau| |v| per distance travelled, and the balance of energy."""
    per_distance = np.full(2 * results.scene.n, np.nan)
    rolls = results.good & (results.slides_along == 0)
    if results.scene.frictionless:
        per_distance[rolls] = 0.0
    elif rolls.any():
        mirror = results.scene.mirror
        asked = mirror.asked(rolls)
        per_distance[rolls] = mirror.spread(rolls, results.scene.model.power(
            results.ellipse.take(asked), results.slip.take(asked), results.friction[asked], results.rows[asked]
        ))  # fmt: skip
    w = results.by_contact(per_distance)
    results.values["friction_energy_per_distance"] = w
    _energy_balance(results, w)


def _energy_balance(results: Results, local: np.ndarray) -> None:
    """Dissipation that the resultants imply, -(xi F_A + phi M_R), and how far the local one is from the work put in.

    Work of the motor less that of the transmitted force per distance: -F_Motor - (1 + xi) (F_A1 + F_A2), which the
    balance of the drive torque makes equal to the sum over both contacts. Where the roller turns with the guide's
    curve, the drilling torque (M_R1 - M_R2) sin(alpha) works on that turning too; whatever leads the roller round the
    curve puts that in.
    """
    v, loads = results.values, results.scene.loads
    xi = v["slip"]
    spin = results.by_contact(results.slip.spin)
    v["friction_energy_balance"] = -(xi[:, None] * v["driving_force"] + spin * v["spin_moment"])
    put_in = -loads.motor_force - (1.0 + xi) * v["transmitted_force"]
    if results.scene.turning is not None:
        put_in = put_in + results.scene.turning * v["drilling_torque"]
    with np.errstate(divide="ignore", invalid="ignore"):
        residual = np.abs(local.sum(axis=1) - put_in) / np.abs(put_in)
    v["energy_residual"] = np.where(loads.friction > 0, residual, np.nan)


def _patches(results: Results, options: Options, slip: Slip | None = None) -> np.ndarray:
    good = results.good
    slip = results.slip if slip is None else slip
    return patch_rows(results.ellipse.take(good), slip.take(good), results.friction[good],
                      sliding.spin_model_index(options.spin_model), results.slides_along[good])  # fmt: skip


def _poisson(results: Results, options: Options) -> np.ndarray:
    table = results.scene.table
    nu = np.stack([table.roller.poisson_ratio, table.guide.poisson_ratio], axis=1)
    if options.stress_bodies == "published":
        nu = np.repeat(nu.mean(axis=1, keepdims=True), 2, axis=1)
    return np.concatenate([nu, nu])


def _traction_fields(results: Results) -> np.ndarray | None:
    """Traction over its bound on the grid of each existing patch; None where full sliding needs no grid."""
    if results.scene.model.full_sliding or results.scene.frictionless:
        return None
    if results.share is None:
        results.share = traction_share(surface_tractions(results), results.friction[results.good])
    return results.share


def stop(results: Results, options: Options) -> None:
    """Marks the cases for which the condition of `stop_if` holds already: what follows leaves them out."""
    if options.stop_if is None:
        return
    table, v = results.scene.table, results.values
    bounded = []
    for comparison in parse_condition(options.stop_if):
        if comparison.by_bound:
            bounded.append(comparison)
            continue
        value = results.regime.astype(float) if comparison.name == "regime" else v[comparison.name]
        results.stopped |= holds(comparison, value, table)
    if bounded:
        lower = _peak_bound(results, options)
        for comparison in bounded:
            results.stopped |= holds(comparison, lower, table)


def _peak_bound(results: Results, options: Options) -> np.ndarray:
    """Lower bound of the peak stress, shape (n, 2, 2): the largest of a few points of each patch."""
    wanted = results.good & ~np.tile(results.stopped, 2)
    out = np.full((2 * results.scene.n, 2), np.nan)
    if wanted.any():
        among, fields = wanted[results.good], _traction_fields(results)
        patches, ratios = _patches(results, options)[among], _poisson(results, options)[wanted]
        bound = lower_bounds(patches, ratios, None if fields is None else fields[among])
        out[wanted] = bound * results.ellipse.max_pressure[wanted][:, None]
    if options.stress_bodies == "published":
        out[:, 1] = out[:, 0]
    return results.by_contact(out)


def _ellipse_peaks(results: Results, options: Options, asked: np.ndarray):
    """Peaks under the ellipses `asked` (2 n,) over p_max; p_max, and the sign that their x needs."""
    among = asked[results.good]  # of the existing patches
    # contact 2 is searched as its mirror image, so that mirrored scenes have the same numbers
    second = np.repeat([False, True], results.scene.n)
    seen = replace(results.slip, sine=np.abs(results.slip.sine))
    fields = _traction_fields(results)
    if fields is not None:
        fields = fields[among]
        fields[second[asked]] = fields[second[asked]][..., ::-1] * np.array([-1.0, 1.0])[:, None, None]
    peak = _peaks(_patches(results, options, seen)[among], _poisson(results, options)[asked], fields, options)
    scale = results.ellipse.max_pressure[asked][:, None]
    side = np.where(second[asked], -1.0, 1.0)[:, None]
    return peak, scale, side


def peak_stress(results: Results, options: Options) -> None:
    """Peak von Mises stress of each contact and body, its place and error estimate."""
    good = results.good & ~np.tile(results.stopped, 2)
    mirror = results.scene.mirror
    asked = mirror.asked(good)
    if isinstance(results.ellipse, GridPatch):
        peak, scale, side = stages_grid.peaks(results, asked, _poisson(results, options), options), 1.0, 1.0
    else:
        peak, scale, side = _ellipse_peaks(results, options, asked)
    error = peak.error
    if isinstance(results.scene.model, TableModel):
        error = error + results.scene.model.peak_error(results.friction[asked])[:, None]
    found = {"peak_stress": (peak.stress * scale, 1.0), "peak_x": (side * peak.x, -1.0), "peak_y": (peak.y, 1.0),
             "peak_z": (peak.z, 1.0), "error_estimate": (error, 1.0)}  # fmt: skip
    for name, (value, sign) in found.items():
        full = np.full((2 * results.scene.n, 2), np.nan)
        full[good] = mirror.spread(good, value, sign)
        full = results.by_contact(full)
        if options.stress_bodies == "published":
            full = np.repeat(full[:, :, :1], 2, axis=2)
        results.values[name] = full


def _peaks(patches: np.ndarray, ratios: np.ndarray, fields: np.ndarray | None, options: Options) -> Peak:
    """Peaks of patches; patches without a slip field of their own are searched once for each ellipticity."""
    if fields is not None:
        return find_peaks(patches, ratios, options.settings.peak, fields)
    patches, length = normalised_patches(patches)
    first = number = np.arange(len(patches))
    if options.shortcuts:
        first, number = distinct_rows(np.hstack([patches, ratios]))
    peak = find_peaks(patches[first], ratios[first], options.settings.peak)
    scale = length[:, None]
    return Peak(peak.stress[number], peak.x[number] * scale, peak.y[number] * scale, peak.z[number] * scale,
                peak.error[number])  # fmt: skip


def finish(table: CaseTable, block: Block, options: Options) -> None:
    """What follows from forces and stresses case by case: power, life and warnings."""
    v = block.values
    if "friction_work" in options.outputs:
        v["friction_power"] = v["friction_energy_per_distance"] * (table.velocity / 60.0)[:, None]
    if "life" in options.outputs:
        life(table, v, options)
    validity(table, block)


def life(table: CaseTable, v: dict[str, np.ndarray], options: Options) -> None:
    """Overrollings and hours to failure from the peak stress."""
    per_body, errors = [], []
    for j, m in enumerate((table.roller, table.guide)):
        column = lambda a: a[:, None]  # noqa: E731
        line = (column(m.tensile_strength), column(m.fatigue_limit), column(m.cycles_at_tensile_strength),
                column(m.cycles_at_fatigue_limit))  # fmt: skip
        per_body.append(fatigue.life_cycles(v["peak_stress"][:, :, j], *line, rule=options.life_rule))
        exponent = fatigue.woehler_exponent(*line)
        if options.life_rule == "haibach":  # the flatter line below the fatigue limit
            exponent = np.where(v["peak_stress"][:, :, j] < line[1], 2.0 * exponent - 1.0, exponent)
        errors.append(exponent * v["error_estimate"][:, :, j])
    v["life_cycles"] = np.stack(per_body, axis=2)
    v["life_error_estimate"] = np.stack(errors, axis=2)
    r_a = rolling_radius(table.axis_distance, table.guide_profile_radius, np.deg2rad(table.contact_angle))
    roller = fatigue.roller_hours(per_body[0], table.velocity[:, None], r_a[:, None])
    guide = fatigue.guide_hours(per_body[1], table.guide_overrollings_per_hour[:, None])
    v["life_hours"] = np.stack([roller, guide], axis=2)
    v["roller_life_hours"], v["guide_life_hours"] = roller.min(axis=1), guide.min(axis=1)


def surface_tractions(results: Results) -> SurfaceTractions:
    """Tractions of the existing patches on a grid, found once."""
    if results.surface is None:
        good, mirror = results.good, results.scene.mirror
        asked = mirror.asked(good)
        slip = results.slip.take(asked)
        rolling = replace(slip, shift=np.where(results.slides_along[asked] == 0, slip.shift, 0.0))
        t = mirror.spread_surface(good, results.scene.model.surface(
            results.ellipse.take(asked), rolling, results.friction[asked], results.rows[asked]))  # fmt: skip
        mu, along = results.friction[good], results.slides_along[good]
        full = (along != 0)[:, None, None]
        results.surface = replace(
            t,
            shear_lateral=np.where(full, 0.0, t.shear_lateral),
            shear_rolling=np.where(full, along[:, None, None] * mu[:, None, None] * t.pressure, t.shear_rolling),
            slip_lateral=np.where(full, np.nan, t.slip_lateral),
            slip_rolling=np.where(full, np.nan, t.slip_rolling),
            stick=t.stick & ~full,
        )
    return results.surface


def tractions(results: Results, options: Options) -> None:
    """Pressure, shear, slip and friction energy over the patches."""
    t = surface_tractions(results)
    fields = {"patch_x": t.x, "patch_y": t.y, "pressure": t.pressure, "shear_lateral": t.shear_lateral,
              "shear_rolling": t.shear_rolling, "slip_lateral": t.slip_lateral, "slip_rolling": t.slip_rolling,
              "friction_energy_density": np.hypot(t.shear_lateral, t.shear_rolling)
              * np.hypot(t.slip_lateral, t.slip_rolling)}  # fmt: skip
    results.values.update({name: results.full(value) for name, value in fields.items()})


def subsurface(results: Results, options: Options) -> None:
    """All stress components on the two section planes through each peak."""
    m, n = options.settings.section_points, results.scene.n
    depth_points = (m + 1) // 2
    shape_xz = (n, 2, 2, depth_points, m)
    v = results.values
    for name in ("von_mises_xz", "von_mises_yz"):
        v[name] = np.full(shape_xz, np.nan)
    for name in ("stress_xz", "stress_yz"):
        v[name] = np.full((n, 6, *shape_xz[1:]), np.nan)
    for name, count in (("xz_x", m), ("xz_z", depth_points), ("yz_y", m), ("yz_z", depth_points)):
        v[name] = np.full((n, 2, 2, count), np.nan)
    grid = isinstance(results.ellipse, GridPatch)
    rows, fields = (None, None) if grid else (_patches(results, options), _traction_fields(results))
    centre = results.ellipse.centre if isinstance(results.ellipse, GridPatch) else np.zeros(2 * n)
    nu = _poisson(results, options)
    order = max(options.settings.peak.polish, 24)  # the rim is met exactly, where quadrature is hardest
    for row, flat in enumerate(np.flatnonzero(results.good)):
        j, i = divmod(flat, n)
        e = results.ellipse
        a, b, p = e.semi_axis_lateral[flat], e.semi_axis_rolling[flat], e.max_pressure[flat]
        across, along = centre[flat] + np.linspace(-1.5 * a, 1.5 * a, m), np.linspace(-1.5 * b, 1.5 * b, m)
        depth = np.linspace(0.0, 1.0, depth_points) ** 1.5 * 2.0 * min(a, b)
        for body in (0, 1):
            x0, y0 = v["peak_x"][i, j, body], v["peak_y"][i, j, body]
            sign = -1.0 if body == 1 and options.stress_bodies == "both" else 1.0
            planes = (("xz", across, np.full(m, y0)), ("yz", np.full(m, x0), along))
            for plane, xs, ys in planes:
                points = np.stack([np.tile(xs, depth_points), np.tile(ys, depth_points), np.repeat(depth, m)], axis=1)
                if rows is None:
                    s = stages_grid.section(results, row, points, nu[flat, body], sign)
                else:
                    one = NO_FIELD if fields is None else fields[row]
                    parts = stress_parts(rows[row], points, order, order, one)
                    s = p * (parts[:, 0] + nu[flat, body] * parts[:, 1]
                             + sign * (parts[:, 2] + nu[flat, body] * parts[:, 3]))  # fmt: skip
                v[f"stress_{plane}"][i, :, j, body] = s.T.reshape(6, depth_points, m)
                v[f"von_mises_{plane}"][i, j, body] = von_mises(s).reshape(depth_points, m)
            v["xz_x"][i, j, body], v["yz_y"][i, j, body] = across, along
            v["xz_z"][i, j, body] = v["yz_z"][i, j, body] = depth


def validity(table: CaseTable, block: Block) -> None:
    """Bits that warn where the model leaves its ground, see `dataset.VALIDITY_BITS`."""
    v = block.values
    bit = {name: 1 << i for i, name in enumerate(VALIDITY_BITS)}
    r_g, alpha = table.guide_profile_radius, np.deg2rad(table.contact_angle)
    r_a = rolling_radius(table.axis_distance, r_g, alpha)
    smallest = np.min(np.abs([table.roller_profile_radius, r_g, r_a / np.cos(alpha),
                              table.guide_curve_radius / np.cos(alpha)]), axis=0)  # fmt: skip
    a = np.max(v["semi_axis_lateral"], axis=1)
    size = np.maximum(a, np.max(v["semi_axis_rolling"], axis=1))
    strength = np.minimum(table.roller.tensile_strength, table.guide.tensile_strength)

    def warn(name: str, condition: np.ndarray) -> None:
        block.bits |= np.where(condition, bit[name], 0).astype(np.int32)

    with np.errstate(invalid="ignore"):
        warn("half_space", size > 0.3 * smallest)
        # ASSUME: the database holds no yield strength, so R_m stands for it
        warn("yield", np.max(v["max_pressure"], axis=1) > 1.6 * strength)
        warn("conformal", a >= r_g * np.minimum(np.pi / 2 - alpha, alpha))
        split = [pole_split(v["semi_axis_lateral"][:, k], sign * np.sin(alpha), np.cos(alpha), r_g,
                                    v["rolling_radius_shift"]) for k, sign in ((0, 1.0), (1, -1.0))]  # fmt: skip
        warn("split_pole", (block.model == CONTACT_MODELS.index("sliding")) & (np.maximum(*split) > 0.1))
        warn("large_slip", np.abs(v["slip"]) > 0.1)
        if "peak_stress" in v:
            limits = np.stack([table.roller.tensile_strength, table.guide.tensile_strength], axis=1)[:, None, :]
            knee = np.stack([table.roller.fatigue_limit, table.guide.fatigue_limit], axis=1)[:, None, :]
            warn("static", np.any(v["peak_stress"] > limits, axis=(1, 2)))
            warn("deep_life", np.any(v["peak_stress"] < knee, axis=(1, 2)))
