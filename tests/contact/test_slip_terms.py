"""Terms of the rigid slip beyond the tangent of a straight guide: equilibria against CONTACT's variants."""

import json

import numpy as np
import pytest
import xarray as xr
from reference_cases import DATA, solve_sliding
from synthetic_results import results_of

import trackroller as tr
from trackroller.contact.cross_sections import arcs
from trackroller.contact.slip import Slip, contour_over_tangent, rolling_slip, turning_of
from trackroller.errors import InputError
from trackroller.parameters import CONTACT_MODELS
from trackroller.roller.case import to_table
from trackroller.roller.explain import explain
from trackroller.roller.options import Options
from trackroller.study.file.load import parse_study
from trackroller.study.store.fingerprint import fingerprints

VARIANTS = json.loads((DATA / "contact.json").read_text(encoding="utf-8"))["variants"]
PAPER, FREE = {}, {"motor_force": 0.0}
TIGHT = {"guide_curve_radius": 39.5}
OUTPUTS = ("forces", "friction_work")
BOTH = ("profile", "curve")


def roller(ds, name):
    return np.atleast_1d(ds[name].values)


@pytest.mark.parametrize(
    ("name", "change", "terms"),
    [
        ("papercase_n90", PAPER, ()),
        ("papercase_profile_slip", PAPER, ("profile",)),
        ("papercase_spin_curve", PAPER, ("curve",)),
        ("papercase_profile_slip_spin_curve", PAPER, BOTH),
        ("free_n90", FREE, ()),
        ("free_profile_slip", FREE, ("profile",)),
        ("free_spin_curve", FREE, ("curve",)),
        ("rC39.5_FM-30_spin_curve", TIGHT, ("curve",)),
        ("rC39.5_FM0_spin_curve", TIGHT | FREE, ("curve",)),
    ],
)
def test_whole_equilibria_agree_with_contact(name, change, terms):
    """Normal forces within 0.1 %, lateral forces and spin moments within 0.3 %, other results within 1 %."""
    record = VARIANTS[f"sens_{name}"]
    ds = tr.solve(tr.Case(**change), outputs=OUTPUTS, contact_model="kalker", accuracy="reference", slip_terms=terms)
    assert ds.converged == 1
    assert ds.attrs["slip_terms"] == (", ".join(terms) or "none")
    np.testing.assert_allclose(ds.normal_force, record["normal_force"], rtol=1e-3)
    np.testing.assert_allclose(ds.lateral_force, record["lateral_force"], rtol=3e-3)
    np.testing.assert_allclose(ds.spin_moment, record["spin_moment"], rtol=3e-3)
    np.testing.assert_allclose(ds.driving_force, record["driving_force"], rtol=1e-2)
    # in free rolling the shift is a small difference of larger terms; CONTACT's own grids differ by more
    assert float(ds.rolling_radius_shift) == pytest.approx(record["rolling_radius_shift"], rel=1e-2, abs=1.5e-5)
    # the work on the slip in the tangent plane; CONTACT's resultants were summed in this plane too
    np.testing.assert_allclose(ds.friction_energy_balance, record["friction_power_per_speed"], rtol=3e-3)
    # the drive torque has the lever arms of the tangent, which the slip of the profile has not
    assert float(ds.energy_residual) < (6e-3 if "profile" in terms else 5e-4)


def test_curve_puts_its_work_in_beside_the_motor():
    """The drilling torque also does work on the rotation of the roller in the curve, a sixth of the balance."""
    ds = tr.solve(tr.Case(**TIGHT), outputs=OUTPUTS, contact_model="kalker", slip_terms=("curve",))
    turning = 1.0 / (39.5 + 6.0 * np.cos(np.deg2rad(30.0)))
    motor = 30.0 - (1.0 + float(ds.slip)) * float(ds.transmitted_force)
    led = turning * float(ds.drilling_torque)
    spent = float(ds.friction_energy_per_distance.sum())
    assert spent == pytest.approx(motor + led, rel=2e-3)
    assert led / spent > 1 / 6


@pytest.mark.parametrize("model", ["kalker", "kalker_table"])
def test_a_straight_guide_has_no_turning(model):
    case = tr.Case(guide_curve_radius=np.inf)
    plain, curved = (tr.solve(case, outputs=OUTPUTS, contact_model=model, slip_terms=t) for t in ((), ("curve",)))
    np.testing.assert_allclose(curved.lateral_force, plain.lateral_force, rtol=1e-9)
    assert float(curved.energy_residual) == pytest.approx(float(plain.energy_residual), abs=1e-8)


def test_an_inner_curve_takes_spin_away():
    table = [tr.Case(guide_curve_radius=-60.0)]
    plain, curved = (tr.solve(table, outputs=OUTPUTS, contact_model="kalker", slip_terms=t) for t in ((), ("curve",)))
    assert float(curved.friction_energy_per_distance.sum()) < 0.9 * float(plain.friction_energy_per_distance.sum())
    assert float(curved.energy_residual[0]) < 2e-3


def test_a_contact_beyond_the_axis_of_the_curve_is_a_failed_row():
    assert np.isnan(turning_of(np.array([-5.0]), np.array([6.0]), np.array([0.9]))).all()
    case = {"axis_distance": 9.0, "contact_angle": 30.0, "guide_curve_radius": -5.0}
    ds = tr.solve([case, {}], outputs="forces", contact_model="kalker", slip_terms=("curve",))
    assert ds.regime.values.tolist() == [3, 0]


def test_preview_serves_the_curve_by_table_and_the_profile_by_elements():
    for terms, model in ((("curve",), "kalker_table"), (BOTH, "kalker")):
        fine, rough = (
            tr.solve(tr.Case(**TIGHT), outputs=OUTPUTS, contact_model="kalker", accuracy=a, slip_terms=terms)
            for a in ("standard", "preview")
        )
        assert CONTACT_MODELS[int(rough.contact_model_used)] == model
        np.testing.assert_allclose(rough.lateral_force, fine.lateral_force, rtol=0.03)
        # the slip of the profile is responsible for 0.5 %, the coarse elements for another 0.5 %
    assert float(rough.energy_residual) < 1.2e-2


def test_patches_solved_on_a_grid_take_the_contour_as_it_is_drawn():
    """Patches solved on a grid have the friction forces of the ellipse if the contours are drawn as circles."""
    hertz = tr.solve(tr.Case(), outputs=OUTPUTS, contact_model="kalker", slip_terms=BOTH)
    grid = tr.solve(tr.Case(), outputs=OUTPUTS, contact_model="kalker", slip_terms=BOTH, normal="halfspace")
    np.testing.assert_allclose(grid.lateral_force, hertz.lateral_force, rtol=2e-2)
    np.testing.assert_allclose(grid.rolling_radius_shift, hertz.rolling_radius_shift, rtol=1e-2)
    assert float(grid.energy_residual) < 1e-2


@pytest.mark.parametrize("degrees", [10.0, 30.0, 60.0])
def test_contour_of_a_drawn_circle_is_eq_20(degrees):
    alpha, x = np.deg2rad(degrees), np.linspace(-0.5, 0.5, 11)
    one = np.ones(1)
    drawn = contour_over_tangent(arcs([6.0], []), alpha)
    for sign in (1.0, -1.0):
        plain = (sign * np.sin(alpha) * one, np.cos(alpha) * one, 6.0 * one, 16.0 * one, -0.06 * one)
        slip, own = Slip(*plain), Slip(*plain, contour=np.array([drawn], dtype=object))
        expected = [rolling_slip(v, sign * np.sin(alpha), np.cos(alpha), 6.0, -0.06) / 16.0 for v in x]
        whole = slip.longitudinal[:, None] + slip.spin[:, None] * x + slip.beyond_tangent(x[None, :])
        np.testing.assert_allclose(whole[0], expected, atol=1e-15)
        np.testing.assert_allclose(own.beyond_tangent(x[None, :]), slip.beyond_tangent(x[None, :]), atol=1e-13)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"slip_terms": ("profil",)}, ("slip_terms", "profil", "Did you mean 'profile'")),
        ({"slip_terms": 3}, ("slip_terms", "profile, curve")),
        ({"contact_model": "sliding", "slip_terms": ("curve",)}, ("slip_terms", "kalker", "leave 'curve' out")),
    ],
)
def test_what_cannot_be_is_refused(options, words):
    with pytest.raises(InputError) as problem:
        tr.solve(tr.Case(), outputs="forces", **({"contact_model": "kalker"} | options))
    assert all(word in str(problem.value) for word in words)


def test_sliding_has_the_slip_of_the_profile_anyway():
    plain, told = (solve_sliding(tr.Case(), outputs=OUTPUTS, slip_terms=t) for t in ((), ("profile",)))
    assert np.array_equal(plain.lateral_force, told.lateral_force)


STUDY = {"name": "a", "factors": {"friction_coefficient": {"values": [0.1, 0.3]}}, "contact_model": "kalker"}


def test_study_file_takes_them_and_the_fingerprint_tells_them_apart():
    study = parse_study(STUDY | {"slip_terms": ["curve", "profile"]})
    assert study.options["slip_terms"] == BOTH
    assert "slip_terms:\n- profile\n- curve" in study.merged()
    table = to_table([tr.Case()])
    marks = {t: fingerprints(table, parse_study(STUDY | {"slip_terms": t}).options)[0] for t in ((), ("curve",), BOTH)}
    assert len(set(marks.values())) == 3
    without = parse_study(STUDY).options
    del without["slip_terms"]
    assert fingerprints(table, without)[0] == marks[()]


@pytest.mark.parametrize(
    "wrong",
    [
        {"slip_terms": ["curv"]},
        {"slip_terms": {"curve": 1}},
        {"slip_terms": "curve", "contact_model": ["sliding", "kalker"]},
    ],
)
def test_study_file_is_refused_before_it_runs(wrong):
    with pytest.raises(InputError, match="slip_terms"):
        parse_study(STUDY | wrong)


def test_a_spectrum_takes_them():
    from trackroller.study.spectrum.file import Spectrum
    from trackroller.study.spectrum.solve import solve_spectrum

    told = {"blocks": [{"distance": 1000.0}], "contact_model": "kalker_table", "accuracy": "preview"}
    plain, curved = (
        solve_spectrum(Spectrum.from_dict(told | {"base": TIGHT, "slip_terms": t})) for t in ([], ["curve"])
    )
    assert curved.attrs["slip_terms"] == "curve"
    assert np.all(curved.peak_stress != plain.peak_stress)


def test_the_plan_tells_what_the_slip_counts():
    stage = explain(to_table([tr.Case()]), Options(contact_model="kalker", slip_terms=BOTH))[1]
    assert "slip counts profile and curve" in stage.why


def test_time_of_a_study_counts_each_contact_model():
    from trackroller.study.cost import rate, study_rate

    both = parse_study(STUDY | {"contact_model": ["sliding", "kalker"]})
    each = [rate(both.options | {"contact_model": name}) for name in ("sliding", "kalker")]
    assert study_rate(both) == pytest.approx(2 / (1 / each[0] + 1 / each[1]))
    assert study_rate(parse_study(STUDY)) == each[1]


def test_figures_hold_the_most_exact_of_several_contact_models():

    groups = ("forces", "peak_stress", "life")
    made = [tr.solve(tr.Case(), outputs=groups, contact_model=name) for name in ("sliding", "kalker_table")]
    ds = xr.concat(
        made,
        dim=xr.Variable("contact_model", ["sliding", "kalker_table"]),
        coords="minimal",
        compat="override",
        combine_attrs="override",
    )
    assert results_of(ds).held_level("contact_model") == "kalker_table"
