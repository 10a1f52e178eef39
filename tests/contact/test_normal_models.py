"""The chain on patches solved on a grid: Hertz as the special case, drawn profiles through every entrance."""

import json
import math
from dataclasses import replace
from unittest import mock

import numpy as np
import pytest
import xarray as xr
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.contact import kalker, sliding
from trackroller.contact.friction_laws import linear_falling
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.hertz import exact_shape
from trackroller.contact.influence import pressure_displacements
from trackroller.contact.kalker import correction
from trackroller.contact.kalker.cells import unit_cells
from trackroller.contact.normal import lift
from trackroller.contact.normal import patch_models as normal_models
from trackroller.contact.normal import patch_sliding as normal_sliding
from trackroller.contact.quantities import Elastic
from trackroller.contact.slip import Slip
from trackroller.halfspace.grid_peak import GridLoad, find_grid_peaks
from trackroller.halfspace.stress import body_stress, stress_from_tractions
from trackroller.parameters.accuracy import PRESETS
from trackroller.roller.options import Options

PARABOLAS = {"guide_profile": {"parabola": 6.0}, "roller_profile": {"parabola": -7.0}}
LOADS = {"motor_force": -20.0, "friction_coefficient": 0.25}


def hertz_patch(n=40, k_x=0.0238, k_y=0.0587, load=115.0, centre=0.0):
    """Return an ellipse, and the same patch as elements of a grid."""
    one = np.ones(1)
    e = exact_shape(k_x * one, k_y * one, 117e3 * one).at(load * one)
    height = unit_cells(n, n)[0] * e.max_pressure[0]
    grid = GridPatch(
        e.semi_axis_lateral,
        e.semi_axis_rolling,
        e.max_pressure,
        load * one,
        centre * one,
        height[None],
        0 * one,
        0 * one,
        np.zeros(1, bool),
        0 * one,
    )
    return e, grid


def slip_of(shift):
    one, alpha = np.ones(1), math.radians(30)
    return Slip(math.sin(alpha) * one, math.cos(alpha) * one, 6 * one, 16.55 * one, shift * one)


def numbers(resultants):
    return np.array([resultants.lateral_force[0], resultants.driving_force[0], resultants.spin_moment[0]])


@pytest.mark.parametrize("spin_model", ["concentric", "edge", "skewed"])
def test_sliding_on_the_grid_converges_to_sliding_on_the_ellipse(spin_model):
    errors = []
    for n in (20, 40):
        e, grid = hertz_patch(n)
        slip, mu = slip_of(-0.03), np.array([0.3])
        expected = numbers(sliding.integrals(e, slip, mu, spin_model=spin_model, nodes=40).resultants)
        found = normal_sliding.solve_sliding(grid, slip, mu, spin_model)
        scale = mu * 115 * np.array([1, 1, e.semi_axis_lateral[0]])
        errors.append(np.abs(numbers(found.resultants) - expected) / scale)
        power = sliding.integrals(e, slip, mu, spin_model=spin_model, nodes=40).power
        assert found.works.dissipated * slip.rolling_radius == pytest.approx(power, rel=0.1 / n)
    assert np.all(errors[1] < 1.2e-3) and np.all(errors[1] < 0.5 * errors[0] + 1e-4)


def test_sliding_under_a_falling_law_matches_the_ellipse():
    e, grid = hertz_patch(40)
    law, slip, mu = linear_falling(40.0, 0.3), slip_of(-0.05), np.array([0.3])
    expected = sliding.integrals(e, slip, mu, law=law, travel_speed=1000.0, nodes=40)
    found = normal_sliding.solve_sliding(grid, slip, mu, "skewed", law, 1000.0)
    np.testing.assert_allclose(numbers(found.resultants), numbers(expected.resultants), atol=2e-3 * 0.3 * 115)
    assert found.works.dissipated * slip.rolling_radius == pytest.approx(expected.power, rel=3e-3)


def test_kalker_with_the_pressures_of_an_ellipse_is_kalker_on_the_ellipse():
    e, grid = hertz_patch(40)
    slip, mu, steel = slip_of(-0.05), np.array([0.3]), Elastic.of_pair(210e3, 0.33, 210e3, 0.33)
    steel = Elastic(*(np.array([float(v)]) for v in (steel.shear_modulus, 0.33, 0.0)))
    creep = kalker.Creepage.of_slip(slip)
    on_ellipse = kalker.solve_patch(e, creep, mu, steel)
    on_grid = kalker.solve_patch(grid, creep, mu, steel)
    np.testing.assert_allclose(numbers(on_grid.resultants), numbers(on_ellipse.resultants), rtol=1e-3)
    assert on_grid.friction_energy_per_distance == pytest.approx(on_ellipse.friction_energy_per_distance, rel=1e-3)


def test_a_patch_beside_the_nominal_point_feels_the_slip_of_its_place():
    """Moving patch and slip together changes the spin moment by the lever of the driving force, and nothing else."""
    _, here = hertz_patch(20)
    _, there = hertz_patch(20, centre=0.2)
    mu, spin = np.array([0.3]), -math.sin(math.radians(30)) / 16.55
    steel = Elastic(np.array([79e3]), np.array([0.33]), np.array([0.0]))
    settings = kalker.KalkerSettings(elements=20)
    at_0 = kalker.solve_patch(
        here, kalker.Creepage(np.array([-1e-3 + 0.2 * spin]), np.zeros(1), np.array([spin])), mu, steel, settings
    )
    at_2 = kalker.solve_patch(
        there, kalker.Creepage(np.array([-1e-3]), np.zeros(1), np.array([spin])), mu, steel, settings
    )
    moved = numbers(at_0.resultants) + np.array([0, 0, 0.2 * at_0.resultants.driving_force[0]])
    np.testing.assert_allclose(numbers(at_2.resultants), moved, rtol=1e-6)


def test_stress_parts_of_a_grid_are_those_of_its_tractions():
    rng = np.random.default_rng(0)
    x, y = np.linspace(-0.4, 0.4, 8), np.linspace(-0.2, 0.2, 6)
    load = GridLoad(x, y, rng.normal(size=(6, 8, 3)))
    points = np.concatenate([rng.uniform(-0.5, 0.5, (6, 3)) * [1, 1, 0] + [0, 0, d] for d in (0.0, 0.1)])
    for sign, nu in ((1.0, 0.3), (-1.0, 0.45)):
        q = load.tractions
        expected = stress_from_tractions(x, y, q[..., 2], sign * q[..., 0], sign * q[..., 1], points, nu)
        np.testing.assert_allclose(body_stress(load.stress_parts(points), nu, sign), expected, atol=1e-9)


@pytest.mark.parametrize("shift", [0.1, -0.03])
def test_peak_below_a_grid_matches_the_peak_below_the_ellipse(shift):
    from trackroller.halfspace.ellipse import patch_rows
    from trackroller.halfspace.peak import find_peaks
    from trackroller.parameters.accuracy import PRESETS

    e, grid = hertz_patch(40)
    slip, mu, nu = slip_of(shift), np.array([0.3]), np.array([[0.33, 0.3]])
    exact = find_peaks(patch_rows(e, slip, mu, 2, np.zeros(1)), nu, PRESETS["reference"].peak)
    t = normal_sliding.tractions(grid, slip, mu)
    fields = np.stack([t.shear_lateral[0], t.shear_rolling[0], t.pressure[0]], axis=-1)
    found = find_grid_peaks([GridLoad(t.x[0], t.y[0], fields)], nu)
    error = np.abs(found.stress / (exact.stress * e.max_pressure[0]) - 1)
    assert np.all(error < 2e-3) and np.all(error <= found.error)


@pytest.mark.slow
@pytest.mark.parametrize("model", ["sliding", "kalker"])
def test_hertz_is_the_special_case_of_the_whole_chain(model):
    """Parabolas give the results of normal='hertz'; so do small circles, up to the change by their shape."""
    outputs = ("forces", "contact", "peak_stress", "life", "friction_work")
    case = tr.Case(**LOADS)
    hertz = tr.solve(case, outputs, contact_model=model)
    parabolas = tr.solve(tr.Case(**LOADS, **PARABOLAS), outputs, contact_model=model, normal="halfspace")
    circles = tr.solve(case, outputs, contact_model=model, normal="halfspace")
    load = float(hertz.normal_force.max())
    for ds, forces, rest, peak in ((parabolas, 1e-3, 2e-3, 6e-3), (circles, 2e-3, 4e-3, 1.2e-2)):
        assert int(ds.regime) == 0 and int(ds.converged) == 1 and float(ds.residual) <= 1e-7
        for name in ("normal_force", "lateral_force", "driving_force"):
            np.testing.assert_allclose(ds[name], hertz[name], atol=forces * load, err_msg=name)
        for name in ("semi_axis_lateral", "semi_axis_rolling", "max_pressure"):
            np.testing.assert_allclose(ds[name], hertz[name], rtol=rest, err_msg=name)
        np.testing.assert_allclose(ds.patch_area, hertz.patch_area, rtol=6e-3)
        np.testing.assert_allclose(ds.peak_stress, hertz.peak_stress, rtol=peak)
        np.testing.assert_allclose(ds.friction_energy_per_distance, hertz.friction_energy_per_distance, rtol=5e-3)
        assert np.all(np.isfinite(ds.life_cycles))
    assert np.abs(parabolas.pressure_centre).max() < 1e-6
    if model == "kalker":
        assert float(circles.energy_residual) < 1e-2


@pytest.mark.slow
def test_forces_stay_in_balance_on_an_uneven_profile_cut_by_its_edge():
    """Equations (7) and (9) hold, the pressures carry the load, an edge is told, and stress rises at it."""
    arcs = {"arcs": [{"radius": -7, "to": 0.1}, {"radius": -6.4}], "edge": {"outer": 0.25}}
    case = tr.Case(roller_profile=arcs, **LOADS)
    ds = solve_sliding(case, ("forces", "contact", "peak_stress", "tractions"), normal="halfspace")
    s, c = math.sin(math.radians(30)), math.cos(math.radians(30))
    (n1, n2), (t1, t2) = ds.normal_force.values, ds.lateral_force.values
    assert c * (t1 + t2) + s * (n1 - n2) + case.axial_force == pytest.approx(0, abs=1e-5)
    assert s * (t2 - t1) + c * (n1 + n2) + case.radial_force == pytest.approx(0, abs=1e-5)
    x, y = ds.patch_x.values, ds.patch_y.values
    cell = (x[:, 1] - x[:, 0]) * (y[:, 1] - y[:, 0])
    np.testing.assert_allclose(ds.pressure.sum(("y", "x")) * cell, ds.normal_force, rtol=1e-9)
    np.testing.assert_allclose(ds.shear_lateral.sum(("y", "x")) * cell, ds.lateral_force, rtol=1e-6)
    # outward is +x in contact 1 and -x in contact 2
    ends = np.array([x[0, -1] + 0.5 * (x[0, 1] - x[0, 0]), -(x[1, 0] - 0.5 * (x[1, 1] - x[1, 0]))])
    np.testing.assert_allclose(ends, 0.25, atol=1e-9)
    bit = list(ds.validity.attrs["flag_meanings"].split()).index("conformal")
    assert int(ds.validity) & (1 << bit)
    whole = solve_sliding(tr.Case(**LOADS), ("contact", "peak_stress"), normal="halfspace")
    assert np.all(ds.max_pressure.values > whole.max_pressure.values)
    assert float(ds.error_estimate.max()) > 3 * float(whole.error_estimate.max())  # a sharp edge does not converge


def test_full_slip_and_no_friction_work_on_solved_patches():
    frictionless = tr.Case(motor_force=0.0, friction_coefficient=0.0)
    slips = solve_sliding(tr.Case(motor_force=-500.0), ("forces", "contact", "peak_stress"), normal="halfspace")
    rolls = solve_sliding(frictionless, normal="halfspace")
    assert int(slips.regime) == 1 and int(rolls.regime) == 0
    expected = solve_sliding(tr.Case(motor_force=-500.0), ("forces", "peak_stress"))
    np.testing.assert_allclose(slips.driving_force, expected.driving_force, rtol=1e-9)
    np.testing.assert_allclose(slips.peak_stress, expected.peak_stress, rtol=5e-3)
    np.testing.assert_allclose(rolls.peak_stress, solve_sliding(frictionless).peak_stress, rtol=6e-3)


def circle_points(radius, n=81):
    return [[float(x), math.sqrt(radius**2 - x * x)] for x in np.linspace(-4, 4, n)]


@pytest.mark.slow
def test_a_drawn_circle_gives_what_the_circle_gives_through_every_entrance(tmp_path, monkeypatch):
    """Case, mapping, JSON in a design data set, and a CSV file: the same numbers; and both sides alike."""
    monkeypatch.chdir(tmp_path)
    points = circle_points(6.0)
    (tmp_path / "guide.csv").write_text("\n".join(f"{x!r}; {z!r}" for x, z in points), encoding="utf-8")
    circle = solve_sliding(tr.Case(**LOADS), "contact", normal="halfspace")
    cases = [tr.Case(guide_profile={"points": points}, **LOADS), {"guide_profile": {"file": "guide.csv"}, **LOADS}]
    drawn = solve_sliding(cases, "contact", normal="halfspace")
    text = json.dumps({"points": points, "frame": "section"})
    design = xr.Dataset(
        {"guide_profile": ("case", np.array([text], object)), **{k: ("case", [v]) for k, v in LOADS.items()}}
    )
    by_design = solve_sliding(design, "contact", normal="halfspace")
    for name in ("max_pressure", "patch_area", "semi_axis_lateral"):
        np.testing.assert_allclose(drawn[name][0], circle[name], rtol=2e-3, err_msg=name)
        np.testing.assert_array_equal(drawn[name][1], drawn[name][0])
        np.testing.assert_array_equal(by_design[name][0], drawn[name][0])


@pytest.mark.slow
def test_batches_give_the_same_bits_however_they_are_cut():
    profiles = [None, {"arc": -7, "edge": {"outer": 0.3}}]
    cases = [tr.Case(roller_profile=p, axial_force=a, motor_force=0.0) for p in profiles for a in (0.0, 25.0)]
    outputs = ("forces", "contact")
    together = solve_sliding(cases, outputs, normal="halfspace")
    for i in (3, 1):
        alone = solve_sliding([cases[i]], outputs, normal="halfspace")
        for name in ("lateral_force", "max_pressure", "patch_area", "rolling_radius_shift"):
            np.testing.assert_array_equal(alone[name][0], together[name][i], err_msg=name)


@pytest.mark.slow
def test_profiles_work_as_factors_of_a_study(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.yaml").write_text(
        """
name: grooves
base: {motor_force: 0, friction_coefficient: 0.2}
factors:
  roller_profile: {values: [{arc: -7}, {arc: -7, edge: {outer: 0.3, chamfer: 0.5}}]}
method: grid
outputs: [forces, contact, peak_stress, life]
normal: halfspace
contact_model: sliding
accuracy: preview
""",
        encoding="utf-8",
    )
    study = tr.load_study("study.yaml")
    ds = tr.solve(study.design(), **study.options)
    assert ds.sizes["case"] == 2 and ds.attrs["normal"] == "halfspace"
    assert np.all(ds.max_pressure[1] > ds.max_pressure[0]) and np.all(ds.life_cycles[1] < ds.life_cycles[0])


def test_options_that_do_not_fit_are_refused():
    with pytest.raises(tr.InputError, match="halfspace"):
        solve_sliding(tr.Case(**PARABOLAS))
    assert Options(normal="halfspace").normal == "halfspace"


def test_subsurface_fields_hold_the_peak():
    ds = solve_sliding(tr.Case(**LOADS), ("peak_stress", "subsurface"), normal="halfspace", accuracy="preview")
    for field in (ds.von_mises_xz.max(("section_z", "section_x")), ds.von_mises_yz.max(("section_z", "section_y"))):
        np.testing.assert_allclose(field, ds.peak_stress, rtol=0.04)


def test_a_sticking_patch_feels_the_rim_as_on_the_ellipse(monkeypatch):
    """Where three quarters of the patch stick, the share of the rim's elements decides: within 1 % of Hertz."""
    monkeypatch.setattr(correction, "REFINED_ERROR", np.inf)  # solved patches are not refined
    options = {"contact_angle": 12.0, "friction_coefficient": 0.9, "motor_force": 0.0, "axial_force": 5.0}
    alike = replace(PRESETS["standard"], elements=PRESETS["standard"].on_grids)
    hertz = tr.solve(tr.Case(**options), ("forces", "contact"), contact_model="kalker", accuracy=alike)
    grid = tr.solve(tr.Case(**options, **PARABOLAS), ("forces", "contact"), contact_model="kalker", normal="halfspace")
    assert float(hertz.stick_area_fraction.min()) > 0.6
    np.testing.assert_allclose(grid.lateral_force, hertz.lateral_force, rtol=1e-2)
    np.testing.assert_allclose(grid.spin_moment, hertz.spin_moment, rtol=1e-2)
    np.testing.assert_allclose(grid.stick_area_fraction, hertz.stick_area_fraction, atol=0.02)


@pytest.mark.slow
@pytest.mark.parametrize(("guide", "roller", "curve", "alpha"), [(2.0, -3.0, 800.0, 55.0), (12.0, -12.2, 60.0, 25.0)])
def test_peaks_of_slender_sliding_patches_keep_within_one_per_cent(guide, roller, curve, alpha):
    """The slip turns within an element where its pole lies in a slender patch: finer tractions are taken there."""
    loads = {"radial_force": -40.0, "axial_force": 5.0, "motor_force": 0.0, "friction_coefficient": 0.7}
    shape = {
        "guide_profile_radius": guide,
        "roller_profile_radius": roller,
        "guide_curve_radius": curve,
        "contact_angle": alpha,
        "axis_distance": 40.0,
    }
    drawn = {"guide_profile": {"parabola": guide}, "roller_profile": {"parabola": roller}}
    hertz = solve_sliding(tr.Case(**loads, **shape), ("contact", "peak_stress"), accuracy="reference")
    grid = solve_sliding(tr.Case(**loads, **shape, **drawn), ("contact", "peak_stress"), normal="halfspace")
    ratio = float((hertz.semi_axis_lateral / hertz.semi_axis_rolling)[0])
    assert ratio < 0.25 or ratio > 8
    np.testing.assert_allclose(grid.peak_stress, hertz.peak_stress, rtol=1e-2)
    assert np.all(np.abs(grid.peak_stress / hertz.peak_stress - 1) <= grid.error_estimate)


def test_finer_elements_carry_the_same():
    """Each element's load stays its own, and the pressure of an ellipse comes out as that of finer elements."""
    _, grid = hertz_patch(20)
    _, fine = hertz_patch(40)
    found = grid.refined(2, 2).pressure
    np.testing.assert_allclose(found.reshape(1, 20, 2, 20, 2).mean(axis=(2, 4)), grid.pressure, rtol=1e-12)
    inside = np.hypot(*np.meshgrid(*2 * [(np.arange(40) + 0.5) / 20 - 1])) < 0.8
    np.testing.assert_allclose(found[0][inside], fine.pressure[0][inside], rtol=2e-3)


def test_lift_by_shear_and_creep_by_pressure_are_reciprocal():
    """Betti: the pressures' work on the lift by shear is that of the shear on the creep by the pressures."""
    rng, shape, sides, per_stress = np.random.default_rng(3), (7, 9), (0.03, 0.05), 2e-6
    shear_x, shear_y, pressure = rng.normal(size=(3, *shape))
    apart = lift(shear_x, shear_y, *sides, per_stress)
    kernel = per_stress * pressure_displacements(*sides, *shape, 0, 0)  # of the creep at a distance from a pressure
    j, i = np.arange(shape[0]), np.arange(shape[1])
    rows, columns = j[:, None] - j[None, :] + shape[0] - 1, i[:, None] - i[None, :] + shape[1] - 1
    at = kernel[:, rows[:, None, :, None], columns[None, :, None, :]]
    creep = np.einsum("cjikl,kl->cji", at, pressure)
    assert np.sum(pressure * apart) == pytest.approx(np.sum(shear_x * creep[0] + shear_y * creep[1]), rel=1e-10)


@pytest.mark.long
def test_shear_presses_on_unlike_materials_only():
    """A margin around the patch changes nothing; the rounds settle; friction raises p_max of polyamide on steel."""
    outputs = ("forces", "contact", "friction_work")
    plastic = tr.Case(roller_material="PA6", motor_force=0.0, friction_coefficient=0.3)
    slight = replace(plastic, friction_coefficient=1e-3)
    solve = lambda case, normal: tr.solve(case, outputs, contact_model="kalker", normal=normal)  # noqa: E731
    one_sided = lambda self, ellipse, slip, friction, rows: self.patch(ellipse, slip, rows)  # noqa: E731
    with mock.patch.object(normal_models.GridKalkerModel, "settled", one_sided):
        one_way, none = solve(plastic, "halfspace"), solve(slight, "halfspace")
    both, little = solve(plastic, "halfspace"), solve(slight, "halfspace")
    for name in ("normal_force", "max_pressure", "semi_axis_lateral", "semi_axis_rolling", "patch_area"):
        np.testing.assert_allclose(little[name], none[name], rtol=6e-3)
        np.testing.assert_allclose(both[name], one_way[name], rtol=4e-2)
    assert float(both.max_pressure[0] / one_way.max_pressure[0]) > 1.003
    assert np.all(np.abs(both.pressure_centre) > 2 * np.abs(one_way.pressure_centre))
    with mock.patch.object(normal_models, "ROUNDS", 6):
        settled = solve(plastic, "halfspace")
    for name in ("normal_force", "lateral_force", "spin_moment", "max_pressure"):
        np.testing.assert_allclose(both[name], settled[name], rtol=1e-4)
    assert bool(both.converged) and float(both.energy_residual) < 5e-3


@pytest.mark.long
def test_unlike_and_like_materials_in_one_batch_keep_their_digits():
    """Rounds of the one do not move the starts of the other."""
    changes = [{"roller_material": "PA6", "motor_force": 0.0}, {"friction_coefficient": 0.2}, {"guide_material": "POM"}]
    cases = [tr.Case(**change) for change in changes]
    options = {"contact_model": "kalker", "normal": "halfspace", "accuracy": "preview"}
    together = tr.solve(cases, ("forces", "contact"), **options)
    for i, case in enumerate(cases):
        alone = tr.solve([case], ("forces", "contact"), **options)
        for name in ("normal_force", "lateral_force", "rolling_radius_shift", "max_pressure", "residual"):
            np.testing.assert_array_equal(together[name][i], alone[name][0])


@pytest.mark.slow
def test_the_peak_below_a_groove_edge_is_found_and_said_to_be_unknown():
    """The edge cuts the patch of contact 2: its pressure is singular there, and so is the stress."""
    cut = tr.Case(motor_force=0, friction_coefficient=0.1, roller_profile={"arc": -7, "edge": {"outer": 0.3}})
    ds = solve_sliding(cut, normal="halfspace", outputs=("peak_stress", "tractions"))
    peak = ds.peak_stress.sel(contact=2, body="roller")
    t = ds.sel(contact=2)
    x, y = t.patch_x.values, t.patch_y.values
    loaded = x[np.nonzero(t.pressure.values.max(axis=0))[0]]
    ends = loaded.min() - 0.5 * (x[1] - x[0]), loaded.max() + 0.5 * (x[1] - x[0])
    below = np.array([(end, 0.0, z) for end in ends for z in np.linspace(0.0, 0.02, 21)])
    stress = tr.stress_from_tractions(x, y, t.pressure, t.shear_lateral, t.shear_rolling, below, poisson_ratio=0.33)
    at_edge = tr.von_mises(stress).max()
    assert at_edge > 1.05 * float(ds.peak_stress.sel(contact=1, body="roller"))
    assert float(peak) > 0.98 * at_edge
    assert float(ds.error_estimate.sel(contact=2, body="roller")) > 0.1
    assert float(ds.error_estimate.sel(contact=1).max()) < 0.01


@pytest.mark.long
def test_pressure_on_ridges_a_few_elements_wide_stays_as_it_was_solved():
    """Waves of 0.5 um every 0.1 mm: the field that stresses come from has the pressure that is told."""
    x = np.arange(-4.5, 4.501, 0.0125)
    waves = np.sqrt(36.0 - x * x) + 5e-4 * np.cos(20.0 * np.pi * (np.abs(x) - 3.0))
    drawn = {"points": np.column_stack([x, waves]).tolist()}
    case = tr.Case(motor_force=0, friction_coefficient=0.1, guide_profile=drawn)
    rough, fine = (
        solve_sliding(case, normal="halfspace", accuracy=a, outputs=("contact", "peak_stress", "tractions"))
        for a in ("standard", "reference")
    )
    np.testing.assert_allclose(rough.pressure.max(("y", "x")), rough.max_pressure, rtol=0.05)
    off = np.abs(rough.peak_stress / fine.peak_stress - 1.0)
    assert np.all(off < 0.1) and np.all(off < rough.error_estimate)


@pytest.mark.slow
def test_a_flat_with_a_small_blend_is_as_accurate_as_a_smooth_profile():
    """Reference numbers: 80 x 160 elements. With square elements p_max was 12 %, and the work 1.5 % off."""
    arcs = [{"radius": 0.46328709, "to": -0.28140686}, {"radius": math.inf, "to": 0.28140686}, {"radius": 0.46328709}]
    case = tr.Case(
        contact_angle=41.743698223,
        radial_force=-755.14179188,
        axial_force=113.27126878,
        motor_force=0.0,
        friction_coefficient=0.38658001778,
        guide_profile={"arcs": arcs},
        roller_profile={"arc": 60.0},
    )
    outputs = ("forces", "contact", "friction_work", "peak_stress")
    ds = tr.solve(case, outputs, contact_model="kalker", normal="halfspace")
    np.testing.assert_allclose(ds.normal_force, [324.8701, 547.5090], rtol=5e-4)
    off = np.abs(ds.lateral_force - [-54.8479, 101.7052]) / (0.38658 * ds.normal_force)
    assert np.all(off < 2e-3) and np.all(off < ds.force_error_estimate) and np.all(ds.force_error_estimate < 1e-2)
    np.testing.assert_allclose(ds.spin_moment, [23.9323, -43.7177], rtol=2e-3)
    np.testing.assert_allclose(ds.friction_energy_per_distance, [0.9226, 1.6853], rtol=2e-3)
    np.testing.assert_allclose(ds.max_pressure, [2357.0912, 3064.2577], rtol=3e-3)
    peaks = np.array([[2096.97, 2099.89], [2728.29, 2732.23]])
    np.testing.assert_allclose(ds.peak_stress, peaks, rtol=5e-3)
    assert np.all(np.abs(ds.peak_stress / peaks - 1.0) < ds.error_estimate)


@pytest.mark.slow
def test_a_flat_pressure_is_not_stopped_by_the_bound_of_an_ellipse():
    """`stop_if` bounds the peak below a solved pressure by points of this pressure, not of a Hertzian ellipse."""
    flat = tr.Case(guide_profile={"parabola": 6.0, "edge": {"inner": 0.15, "outer": 0.15}}, friction_coefficient=0.0)
    stopped = lambda limit: solve_sliding(flat, ("peak_stress",), normal="halfspace", stop_if=f"peak_stress > {limit}")  # noqa: E731
    peak = float(solve_sliding(flat, ("peak_stress",), normal="halfspace").peak_stress.max())
    assert not bool(stopped(1.02 * peak).stopped)
    assert bool(stopped(0.3 * peak).stopped)


def test_an_offset_pressure_tilts_the_roller():
    """F_N x_p of an off-centre pressure adds to the tilting moment, eqs (13), (14)."""
    case = tr.Case(guide_profile={"parabola": 6.0, "edge": {"outer": 0.05}}, friction_coefficient=0.2)
    ds = solve_sliding(case, ("forces", "contact"), normal="halfspace", accuracy="preview")
    alpha, reach = math.radians(30), 21.75
    (n_1, n_2), (t_1, t_2) = ds.normal_force.values, ds.lateral_force.values
    offset = float((ds.normal_force * ds.pressure_centre).sum())
    arms = reach * math.sin(alpha) * (n_1 - n_2) + (reach * math.cos(alpha) - 6.0) * (t_1 + t_2)
    assert abs(offset) > 0.1
    assert float(ds.tilting_moment) == pytest.approx(arms + offset, rel=1e-9)
