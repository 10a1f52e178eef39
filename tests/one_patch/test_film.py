"""A film between the bodies: its limits in closed form, CONTACT's creep curve, told errors, and who refuses it."""

import csv
from pathlib import Path

import numpy as np
import pytest

import trackroller as tr
from trackroller.contact.friction_laws import exponential_falling, steepness
from trackroller.contact.kalker import Creepage, KalkerSettings, solve_patch
from trackroller.contact.quantities import Elastic, Ellipse
from trackroller.parameters.validity import VALIDITY

ROOT = Path(__file__).parents[2]
STEEL = {"youngs_modulus": 210e3, "poisson_ratio": 0.28}
ELLIPSE = {"normal_force": 1000.0, "semi_axes": (0.6, 0.4), "materials": STEEL, "friction_coefficient": 0.3}
DISCS = {
    "normal_force": 7000.0, "curvature_rolling": 0.04, "curvature_lateral": 0.0, "width": 10.0,
    "materials": STEEL, "friction_coefficient": 0.3,
}  # fmt: skip
SOFT = 0.01  # mm^3/N, some 2000 times the flexibility b/G of the bodies
FREE = {"motor_force": 0.0, "friction_coefficient": 0.2}
FALLING = {"kind": "exponential", "speed": 1250.0 / np.log(2.0), "lowest": 0.14 / 0.33}


def contact_curve():
    """Return creepages and forces over F_N of CONTACT with a film."""
    with (ROOT / "validation" / "measured" / "creep_curves.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["series"] == "film"]
    names = "longitudinal_creepage [1]", "normal_force [N]", "driving_force [N]"
    creepage, load, force = (np.array([float(row[name]) for row in rows]) for name in names)
    return creepage, force / load


@pytest.mark.parametrize("kind", [ELLIPSE, DISCS])
def test_a_very_stiff_film_changes_nothing(kind):
    creepage = [5e-4, 2e-3]
    bare = tr.patch(**kind, longitudinal_creepage=creepage)
    stiff = tr.patch(**kind, longitudinal_creepage=creepage, layer_flexibility=1e-14)
    for name in ("driving_force", "shear_rolling"):
        np.testing.assert_allclose(stiff[name], bare[name], rtol=1e-5, atol=1e-4)


def test_a_very_soft_film_has_the_slope_of_its_own():
    """Each point moves by its own traction: tau = xi (b(x) - y)/L in adhesion, so that F = 8/3 a b^2 xi/L."""
    creepage = 1e-2 * 0.3 * 1000.0 * SOFT / (8.0 / 3.0 * 0.6 * 0.4**2)  # of 1 % of the largest force
    own = tr.patch(**ELLIPSE, longitudinal_creepage=creepage, layer_flexibility=SOFT)
    told = float(own["force_error_estimate"])
    np.testing.assert_allclose(own["friction_force_share"], 1e-2, atol=min(told, 2e-4))
    lateral = tr.patch(**ELLIPSE, lateral_creepage=creepage, layer_flexibility=SOFT)
    np.testing.assert_allclose(lateral["lateral_force"], own["driving_force"], rtol=1e-3)


def test_a_very_soft_film_between_discs_has_the_slope_of_its_own():
    """F = 2 w b^2 xi/L."""
    half = float(tr.patch(**DISCS)["semi_axis_rolling"])
    creepage = 1e-2 * 2100.0 * SOFT / (2.0 * 10.0 * half**2)
    own = tr.patch(**DISCS, longitudinal_creepage=creepage, layer_flexibility=SOFT)
    np.testing.assert_allclose(own["friction_force_share"], 1e-2, rtol=2e-3)


def test_a_film_and_falling_friction_give_the_creep_curve_of_contact():
    creepage, force = contact_curve()
    own = tr.patch(
        106700.0, semi_axes=(12.61, 6.304), materials={"youngs_modulus": 2.0 * 82e3 * 1.28, "poisson_ratio": 0.28},
        friction_coefficient=0.33, longitudinal_creepage=creepage, velocity="10 m/s",
        layer_flexibility=1.25 / 8200.0, friction_law=FALLING,
    )  # fmt: skip
    assert own["converged"].all() and not own["steep_friction"].any()
    np.testing.assert_allclose(-own["driving_force"] / 106700.0, force, atol=0.02 * 0.33)
    # it rises more slowly than without a film, and falls beyond its largest value
    assert np.argmax(-own["driving_force"].values) == list(creepage).index(0.018)


@pytest.mark.slow
@pytest.mark.parametrize("elements", [12, 28, 56])
def test_told_errors_hold_with_a_film(elements):
    rng = np.random.default_rng(11)
    n = 40
    b = 10.0 ** rng.uniform(-1.0, 0.0, n)
    a = b * 10.0 ** rng.uniform(-0.6, 1.0, n)
    pressure, friction = rng.uniform(300.0, 1500.0, n), rng.uniform(0.05, 0.5, n)
    softness = 10.0 ** rng.uniform(-2.0, 2.0, n)
    scale = friction * pressure / 8e4 * (1.0 + softness)
    ways = [rng.choice(signs, n) * 10.0 ** rng.uniform(-1.2, 0.8, n) for signs in ([-1, 1, 0], [-1, 0, 0], [-1, 1, 0])]
    creep = Creepage(scale * ways[0], scale * ways[1], scale * ways[2] / np.sqrt(a * b))
    elastic = Elastic(np.full(n, 8e4), np.full(n, 0.28), np.zeros(n), softness * b / 8e4)
    ellipse = Ellipse(a, b, pressure)
    fine = solve_patch(ellipse, creep, friction, elastic, KalkerSettings(112, tolerance=1e-8))
    own = solve_patch(ellipse, creep, friction, elastic, KalkerSettings(elements, tolerance=1e-8))
    error = np.abs(own.resultants.columns - fine.resultants.columns)[:, :2].max(axis=1)
    assert np.mean(error > own.force_error) <= 0.05
    assert np.all(error < 2.0 * own.force_error)


def test_the_elements_dissipate_the_work_of_the_resultants_with_a_film():
    own = tr.patch(**ELLIPSE, longitudinal_creepage=0.02, spin=0.01, layer_flexibility=2e-5)
    shear = own["shear_lateral"] * own["slip_lateral"] + own["shear_rolling"] * own["slip_rolling"]
    area = 4.0 * 0.6 * 0.4 / own.sizes["x"] ** 2
    np.testing.assert_allclose(-shear.sum() * area, own["friction_energy_per_distance"], rtol=0.05)


def test_a_roller_with_a_film_is_the_patch_with_it():
    case = tr.Case(**FREE, layer_flexibility=1e-5)
    roller = tr.solve(case, outputs=("forces", "contact")).sel(contact=1)
    alpha = np.deg2rad(case.contact_angle)
    radius = case.axis_distance - case.guide_profile_radius * np.cos(alpha)
    own = tr.patch(
        float(roller["normal_force"]),
        semi_axes=(float(roller["semi_axis_lateral"]), float(roller["semi_axis_rolling"])),
        materials=[case.roller_material, case.guide_material],
        friction_coefficient=0.2,
        longitudinal_creepage=float(roller["slip"]),
        spin=-np.sin(alpha) / radius,
        layer_flexibility="1e-5 mm3/N",
    )
    bound = 0.2 * float(roller["normal_force"])
    for name in ("lateral_force", "driving_force"):
        assert abs(float(own[name] - roller[name])) < 1e-3 * bound


def test_a_case_beside_one_with_a_film_keeps_every_bit():
    alone = tr.solve(tr.Case(**FREE))
    beside = tr.solve([tr.Case(**FREE, layer_flexibility=1e-6), tr.Case(**FREE)]).isel(case=1)
    for name in alone.data_vars:
        np.testing.assert_array_equal(beside[name], alone[name])


def test_a_film_is_solved_by_elements_at_preview_too():
    ds = tr.solve([tr.Case(**FREE), tr.Case(**FREE, layer_flexibility=1e-5)], outputs="forces", accuracy="preview")
    words = str(ds["contact_model_used"].attrs["flag_meanings"]).split()
    assert [words[number] for number in ds["contact_model_used"].values] == ["kalker_table", "kalker"]
    # the table's errors do not hold for a film, so that none of them is told for the pair
    fine = tr.solve(tr.Case(**FREE, layer_flexibility=1e-5), outputs="forces", accuracy="reference")
    off = abs(ds.isel(case=1)["lateral_force"] - fine["lateral_force"]) / (0.2 * fine["normal_force"])
    assert (off < ds.isel(case=1)["force_error_estimate"]).all()


@pytest.mark.parametrize("model", ["sliding", "kalker_table"])
def test_a_model_without_films_refuses_one(model):
    case = tr.Case(**FREE, layer_flexibility=1e-5)
    with pytest.raises(tr.InputError) as error:
        tr.solve(case, contact_model=model)
    assert str(error.value) == (
        f"layer_flexibility = 1e-05 is not usable. Allowed: 0 (no film) with contact_model: {model}. "
        "Take contact_model: kalker, or leave layer_flexibility out."
    )
    tr.solve(tr.Case(**FREE), contact_model=model, outputs="forces", accuracy="preview")
    tr.solve(case, contact_model="kalker", outputs="forces", accuracy="preview")


def test_friction_that_falls_too_steeply_for_a_film_is_flagged():
    law = exponential_falling(100.0, 0.4)
    bound, travel, one = 0.3 * 1000.0, 1000.0, np.ones(1)
    bare = steepness(law, bound * one, travel * one, 8e4 * one, 0.0 * one, 0.02 * one)
    np.testing.assert_allclose(bare, bound * travel * law.steepest_fall / 8e4)
    film = steepness(law, bound * one, travel * one, 8e4 * one, 1e-4 * one, 0.02 * one)
    np.testing.assert_allclose(film - bare, travel * 1e-4 * bound * law.steepest_fall / 0.02)
    form = {"kind": "exponential", "speed": 100.0, "lowest": 0.4}
    flags = [
        int(
            tr.patch(**ELLIPSE, longitudinal_creepage=0.01, friction_law=form, layer_flexibility=film)["steep_friction"]
        )
        for film in (0.0, 1e-3)
    ]
    assert flags == [0, 1]
    cases = [tr.Case(**FREE, friction_law=form, layer_flexibility=film) for film in (0.0, 1e-3)]
    ds = tr.solve(cases, outputs=("forces", "contact"), accuracy="preview")
    bit = 1 << list(VALIDITY).index("steep_friction")
    assert [(int(bits) & bit) > 0 for bits in ds["validity"].values] == [False, True]


FILMS = (
    ("base: {layer_flexibility: 1e-5}\nfactors: {friction_coefficient: {values: [0.1, 0.3]}}\n", "base"),
    ("factors: {layer_flexibility: {values: [0, 1e-5]}}\n", "factors"),
    ("factors: {layer_flexibility: {uniform: [1e-6, 1e-5]}}\ndesign: lhs\nsamples: 8\n", "factors"),
    (
        "factors:\n  friction_coefficient: {values: [0.1, 0.3]}\n"
        "  layer_flexibility: {expression: friction_coefficient * 1e-5}\n",
        "factors",
    ),
)


@pytest.mark.parametrize("model", ["sliding", "[kalker, kalker_table]"])
@pytest.mark.parametrize(("text", "where"), FILMS, ids=["base", "list", "range", "expression"])
def test_a_study_with_a_film_is_refused_when_it_is_read(tmp_path, text, where, model):
    path = tmp_path / "film.yaml"
    path.write_text(f"name: film\ncontact_model: {model}\n{text}", encoding="utf-8")
    with pytest.raises(tr.InputError) as error:
        tr.load_study(path)
    told = str(error.value)
    assert f"{where}.layer_flexibility = " in told and told.endswith(
        "Take contact_model: kalker, or leave layer_flexibility out."
    )
    path.write_text(f"name: film\ncontact_model: kalker\n{text}", encoding="utf-8")
    tr.load_study(path)


def test_a_table_with_a_film_is_refused_by_its_line(tmp_path):
    (tmp_path / "cases.csv").write_text("friction_coefficient,layer_flexibility [mm3/N]\n0.1,0\n0.2,1e-5\n")
    path = tmp_path / "film.yaml"
    text = "name: film\ndesign: table\ntable: cases.csv\n"
    path.write_text(text + "contact_model: sliding\n", encoding="utf-8")
    with pytest.raises(tr.InputError, match=r"cases\.csv, line 3: layer_flexibility = 1e-05"):
        tr.load_study(path)
    path.write_text(text + "contact_model: kalker\n", encoding="utf-8")
    tr.load_study(path)


def test_a_study_with_a_friction_law_that_its_model_has_not_is_refused_when_it_is_read():
    study = {"name": "law", "base": {"friction_law": {"kind": "exponential", "speed": 100, "lowest": 0.4}}}
    study |= {"factors": {"friction_coefficient": {"values": [0.1, 0.3]}}, "contact_model": "kalker_table"}
    with pytest.raises(
        tr.InputError, match=r"base\.friction_law = .* constant friction with contact_model: kalker_table"
    ):
        tr.load_study(study)
