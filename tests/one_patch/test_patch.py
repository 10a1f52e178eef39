"""One contact by itself: against the roller's balance, Carter's discs, CONTACT, symmetries, and bad input."""

import csv
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from command_line import trackroller

import trackroller as tr
from trackroller.one_patch.inputs import checked_patch, load_patch

ROOT = Path(__file__).parents[2]
STEEL = {"youngs_modulus": 210e3, "poisson_ratio": 0.28}
PLASTIC = {"youngs_modulus": 3e3, "poisson_ratio": 0.4}
ELLIPSE = {"normal_force": 1000.0, "semi_axes": (0.6, 0.4), "materials": STEEL, "friction_coefficient": 0.3}
DISCS = {
    "normal_force": 7000.0, "curvature_rolling": 0.04, "curvature_lateral": 0.0, "width": 10.0,
    "materials": STEEL, "friction_coefficient": 0.3,
}  # fmt: skip
CURVE = np.array([0.0, 5e-4, 1e-3, 2e-3, 3e-3, 4e-3, 6e-3, 2e-2])


def curves(series):
    """Return creepages and forces over mu F_N of a series of CONTACT."""
    with (ROOT / "validation" / "measured" / "creep_curves.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["series"] == series]
    creepage, load, force, friction = (
        np.array([float(row[name]) for row in rows])
        for name in ("longitudinal_creepage [1]", "normal_force [N]", "driving_force [N]", "friction_at_rest [1]")
    )
    return creepage, force / (load * friction)


def carter(creepage, half_length):
    """Return the force over mu F_N of like discs by Carter (1926): 1 - (d/b)^2, d = b - xi/(mu k)."""
    sticking = np.maximum(half_length - creepage / (DISCS["curvature_rolling"] * DISCS["friction_coefficient"]), 0.0)
    return 1.0 - (sticking / half_length) ** 2, sticking / half_length


@pytest.mark.parametrize("motor_force", [0.0, -20.0])
def test_a_patch_has_the_forces_of_the_roller_in_its_balance(motor_force):
    case = tr.Case(motor_force=motor_force, friction_coefficient=0.2)
    roller = tr.solve(case, outputs=("forces", "contact", "friction_work")).sel(contact=1)
    alpha = np.deg2rad(case.contact_angle)
    radius = case.axis_distance - case.guide_profile_radius * np.cos(alpha)
    own = tr.patch(
        float(roller["normal_force"]),
        curvature_rolling=np.cos(alpha) * (1.0 / radius + 1.0 / case.guide_curve_radius),
        curvature_lateral=1.0 / case.roller_profile_radius + 1.0 / case.guide_profile_radius,
        materials=[case.roller_material, case.guide_material],
        friction_coefficient=0.2,
        longitudinal_creepage=float(roller["slip"]),
        spin=-np.sin(alpha) / radius,
        velocity=case.velocity,
    )
    for name in ("semi_axis_lateral", "semi_axis_rolling", "max_pressure"):
        np.testing.assert_allclose(own[name], roller[name], rtol=1e-9)
    bound = 0.2 * float(roller["normal_force"])
    told = float(own["force_error_estimate"]) + float(roller["force_error_estimate"])
    for name in ("lateral_force", "driving_force"):
        assert abs(float(own[name] - roller[name])) < told * bound
    error = float(roller["friction_energy_error_estimate"]) + told
    np.testing.assert_allclose(own["friction_power"], roller["friction_power"], rtol=error)
    np.testing.assert_allclose(own["stick_area_fraction"], roller["stick_area_fraction"], atol=0.02)


def test_the_creep_curve_of_an_ellipse_is_that_of_contact():
    creepage, force = curves("half-space")
    modulus = 2.0 * 82e3 * 1.28
    own = tr.patch(
        106700.0, semi_axes=(12.61, 6.304), materials={"youngs_modulus": modulus, "poisson_ratio": 0.28},
        friction_coefficient=0.33, longitudinal_creepage=creepage, velocity="10 m/s",
    )  # fmt: skip
    np.testing.assert_allclose(-own["driving_force"] / (0.33 * 106700.0), force, atol=0.012)
    np.testing.assert_allclose(own["max_pressure"], 640.7, rtol=1e-3)
    # in steady rolling the power is force times creepage times speed
    np.testing.assert_allclose(own["friction_power"], -own["driving_force"] * creepage * 10.0, rtol=1e-12)


def test_the_sum_of_the_elements_dissipates_the_work_of_the_resultants():
    own = tr.patch(**ELLIPSE, longitudinal_creepage=[2e-3, 0.02], lateral_creepage=[1e-3, 0.0], spin=[5e-3, 2e-2])
    shear = own["shear_lateral"] * own["slip_lateral"] + own["shear_rolling"] * own["slip_rolling"]
    area = 4.0 * 0.6 * 0.4 / own.sizes["x"] ** 2
    np.testing.assert_allclose(-shear.sum(("x", "y")) * area, own["friction_energy_per_distance"], rtol=0.02)


def test_like_discs_follow_carter():
    own = tr.patch(**DISCS, longitudinal_creepage=CURVE)
    half_length = own["semi_axis_rolling"].values
    modulus = 0.5 * 210e3 / (1.0 - 0.28**2)
    np.testing.assert_allclose(half_length, np.sqrt(4.0 * 700.0 / (np.pi * 0.04 * modulus)))
    force, sticking = carter(CURVE, half_length)
    np.testing.assert_allclose(-own["driving_force"] / 2100.0, force, atol=5e-5)
    assert (abs(-own["driving_force"] / 2100.0 - force) <= own["force_error_estimate"] + 1e-12).all()
    np.testing.assert_allclose(own["stick_area_fraction"], sticking, atol=5e-3)
    np.testing.assert_allclose(own["pressure"].mean("y").squeeze() * 2.0 * half_length * 10.0, 7000.0)


def test_lateral_creepage_of_discs_is_that_of_antiplane_shear():
    """The displacement is 1/(1 - nu) of that in plane strain, so that more creepage gives the same force."""
    own = tr.patch(**DISCS, lateral_creepage=CURVE)
    force, _ = carter(CURVE * (1.0 - 0.28), own["semi_axis_rolling"].values)
    np.testing.assert_allclose(-own["lateral_force"] / 2100.0, force, atol=5e-5)
    np.testing.assert_allclose(own["driving_force"], 0.0, atol=1e-6)


@pytest.mark.parametrize("materials", [[STEEL, STEEL], [PLASTIC, STEEL]])
def test_a_very_wide_ellipse_is_like_discs_in_its_middle(materials):
    wide = {"materials": materials, "friction_coefficient": 0.3, "longitudinal_creepage": 1e-3, "accuracy": "reference"}
    ellipse = tr.patch(1000.0, semi_axes=(20.0, 0.5), **wide)
    middle = ellipse.isel(x=ellipse.sizes["x"] // 2)
    load = 0.5 * np.pi * 0.5 * float(ellipse["max_pressure"])
    of_discs = float(tr.patch(1.0, curvature_rolling=1.0, curvature_lateral=0, width=1.0, **wide)["semi_axis_rolling"])
    curvature = load * (of_discs / 0.5) ** 2  # b^2 = 4 F/(pi w k E*)
    discs = tr.patch(load, curvature_rolling=curvature, curvature_lateral=0.0, width=1.0, **wide)
    np.testing.assert_allclose(discs["semi_axis_rolling"], 0.5, rtol=1e-9)
    at = np.interp(middle["patch_y"], discs["patch_y"], discs["shear_rolling"].squeeze("x"))
    largest = float(np.abs(at).max())
    off = middle["shear_rolling"].values - at
    assert np.sqrt(np.mean(off**2)) < 0.05 * largest  # the ellipse has fewer elements at the edges
    assert abs(off.mean()) < 0.03 * largest


def test_full_sliding_of_discs_turns_with_the_creepage():
    own = tr.patch(**DISCS, longitudinal_creepage=0.3, lateral_creepage=0.4)
    np.testing.assert_allclose([own["lateral_force"], own["driving_force"]], [-0.8 * 2100.0, -0.6 * 2100.0], rtol=5e-3)
    np.testing.assert_allclose(own["friction_force_share"], 1.0, rtol=1e-4)


def test_a_single_contact_has_no_cases_and_a_list_has():
    assert "case" not in tr.patch(**ELLIPSE, accuracy="preview").dims
    several = tr.patch(**ELLIPSE, longitudinal_creepage=["0.1 %", 0.001], accuracy="preview")
    assert several.sizes["case"] == 2
    assert several["driving_force"][0] == several["driving_force"][1] < 0.0


def test_a_result_is_written_and_read(tmp_path):
    own = tr.patch(**DISCS, longitudinal_creepage=CURVE, accuracy="preview")
    own.to_netcdf(tmp_path / "discs.nc")
    with xr.open_dataset(tmp_path / "discs.nc") as read:
        xr.testing.assert_equal(read.load(), own)
    assert all("units" in variable.attrs for variable in own.data_vars.values())


FILE = """
normal_force: 7 kN
curvature_rolling: 0.04 1/mm
curvature_lateral: 0
width: 1 cm
materials: {youngs_modulus: 210 GPa, poisson_ratio: 0.28}
friction_coefficient: 0.3
longitudinal_creepage: [0, 0.1 %]
"""


def test_a_file_says_what_the_function_says(tmp_path):
    path = tmp_path / "discs.yaml"
    path.write_text(FILE)
    inputs = load_patch(path)
    own = tr.patch(**DISCS, longitudinal_creepage=[0.0, 1e-3])
    assert inputs.name == "discs" and inputs.is_discs and not inputs.single
    assert all(np.array_equal(column, own[name]) for name, column in inputs.columns.items() if name != "semi_axes")


@pytest.mark.parametrize(
    ("change", "field", "word", "remedy"),
    [
        ({"longitudinal_creepage": 2}, "longitudinal_creepage", "", {"longitudinal_creepage": "2 %"}),
        ({"longitudinal_creepage": "2 mm"}, "longitudinal_creepage", "unit", {"longitudinal_creepage": 0.02}),
        ({"semi_axes": [1, 2]}, "semi_axes", "beside", {"semi_axes": None}),
        ({"width": None}, "width", "missing", {"width": "10 mm"}),
        ({"curvature_lateral": 0.01}, "width", "no width", {"curvature_lateral": 0}),
        ({"curvature_lateral": 1e-300}, "curvature_lateral", "two discs", {"curvature_lateral": 0, "width": "10 mm"}),
        ({"spin": 0.01}, "spin", "0 for two discs", {"spin": None}),
        ({"friction_coefficient": None}, "friction_coefficient", "missing", {"friction_coefficient": 0.3}),
        ({"materials": None}, "materials", "missing", {"materials": "PA6"}),
        ({"curvature_rolling": None}, "curvature_rolling", "missing", {"curvature_rolling": 0.04}),
        ({"curvature_lateral": [0, 1]}, "curvature_lateral", "all cases", {"curvature_lateral": 0}),
        ({"normal_force": [1, 2], "spin": [0, 0, 0]}, "normal_force", "one length", {"normal_force": 1, "spin": 0}),
        ({"accuracy": "fine"}, "accuracy", "preview", {"accuracy": "preview"}),
        ({"creepage": 0.1}, "patch: key", "", {"creepage": None}),
        ({"name": "a\x1b[2J"}, "name", "control", {"name": "a"}),
    ],
)  # fmt: skip
def test_bad_input_is_refused_with_a_remedy_that_works(tmp_path, change, field, word, remedy):
    with pytest.raises(tr.InputError) as error:
        checked_patch({**DISCS, **change})
    assert error.value.field == field and word in str(error.value)
    assert len(error.value.errors) == 1
    checked_patch({**DISCS, **change, **remedy})


def test_an_error_of_a_file_names_its_line(tmp_path):
    path = tmp_path / "discs.yaml"
    path.write_text(FILE.replace("0.3", "-0.3"))
    with pytest.raises(tr.InputError, match=r"line 7.*friction_coefficient"):
        load_patch(path)


def test_a_modulus_in_another_unit_is_asked_about(tmp_path):
    (tmp_path / "discs.yaml").write_text(FILE.replace("210 GPa", "210"))
    told = trackroller("patch", "discs.yaml", cwd=tmp_path).stderr
    assert "doubtful: youngs_modulus = 210 MPa" in told and "write '210 GPa' or 210000" in told
    (tmp_path / "discs.yaml").write_text(FILE)
    assert "doubtful" not in trackroller("patch", "discs.yaml", cwd=tmp_path).stderr, "the remedy works"
