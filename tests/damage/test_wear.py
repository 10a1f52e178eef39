"""Wear of roller and guide: depth, volume, travel until the groove has changed, life."""

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
import yaml
from command_line import trackroller
from scipy.integrate import quad

import trackroller as tr
from trackroller.contact.quantities import Ellipse
from trackroller.damage.wear import TABLE, deepest, mass_loss, sunk_area, table_of_laws, wear_depth
from trackroller.parameters.accuracy import PRESETS
from trackroller.roller.dataset import validity_bit

QUENCHED = "1.7225-quenched-tempered"
OUTPUTS = ("forces", "contact", "friction_work", "wear", "limits")
GIVEN = {"permissible_wear_depth": 0.05, "guide_overrollings_per_hour": 60.0}
K = 1e-5  # mm3/(N m)
CASES = [
    {"roller_material": QUENCHED, "guide_material": QUENCHED},
    {"motor_force": 0, "axial_force": 0, "guide_curve_radius": float("inf"), "friction_coefficient": 0.15},
    {"roller_material": "POM", "guide_material": QUENCHED, "radial_force": -60, "axial_force": 8, "motor_force": -3},
    {"motor_force": 20, "friction_coefficient": 0.4, "roller_profile_radius": -6.3},
]


def solved(outputs=OUTPUTS, contact_model="kalker", accuracy="preview", **case):
    options = {name: case.pop(name) for name in ("normal", "wear_law", "shortcuts") if name in case}
    return tr.solve(tr.Case(**(GIVEN | case)), outputs, contact_model=contact_model, accuracy=accuracy, **options)


def steel(k):
    return {"like": QUENCHED, "wear_coefficient": k}


def test_depth_agrees_with_an_independent_quadrature_and_its_order():
    """Under Hertz's pressure, with slip that varies over the patch, at a place of its own."""
    a, b, p, k = 0.7, 0.4, 900.0, 3e-5
    errors = []
    for n in (14, 42, 126):  # x = 0.3571 a is the centre of an element of each grid
        x, y, pressure = (part[:, None] for part in Ellipse(*(np.array([v]) for v in (a, b, p))).grid(n))
        slip = np.hypot(0.002 + 0.01 * x[..., None, :], 0.02 * y[..., :, None] - 0.004)
        depth = wear_depth(pressure, slip, y[..., 1] - y[..., 0], np.array([k]))[0, 0]
        place = int(np.argmin(abs(x[0, 0] - 5 / 14 * a)))
        at, end = x[0, 0, place], b * np.sqrt(1 - (x[0, 0, place] / a) ** 2)

        def work(y, at=at):
            root = np.sqrt(1 - (at / a) ** 2 - (y / b) ** 2)
            return p * root * np.hypot(0.002 + 0.01 * at, 0.02 * y - 0.004)

        exact = 1e-3 * k * quad(work, -end, end, points=[0.2])[0]
        errors.append(abs(depth[place] / exact - 1))
    assert errors[0] < 0.02 and errors[2] < 1e-3
    assert errors[0] > 2.5 * errors[1] > 6 * errors[2]


def test_coefficient_by_case_or_by_contact():
    pressure = np.ones((3, 2, 4, 5))
    spacing, k = np.full((3, 2), 0.1), np.array([1e-6, 2e-6, 4e-6])
    by_case = wear_depth(pressure, pressure, spacing, k)
    assert by_case.shape == (3, 2, 5)
    assert by_case[:, 0, 0] == pytest.approx(1e-3 * 0.4 * k)
    assert np.array_equal(by_case, wear_depth(pressure, pressure, spacing, np.stack([k, k], axis=1)))


def test_deepest_place_lies_between_the_nodes_and_mirrors():
    x = np.linspace(-1, 1, 21)
    depth = 1 - (x - 0.234) ** 2
    largest, place = deepest(np.tile(x, (1, 2, 1)), np.stack([depth, depth[::-1]])[None, :, None])
    assert largest == pytest.approx(1, abs=1e-12) and place[0, :, 0] == pytest.approx([0.234, -0.234])
    twice = np.abs(x) * (1 - x**2)  # two equal depths: the outer one counts in both contacts
    _, place = deepest(np.tile(x, (1, 2, 1)), np.stack([twice, twice])[None, :, None])
    assert place[0, 0, 0] == pytest.approx(-place[0, 1, 0]) and place[0, 0, 0] > 0.5
    _, nowhere = deepest(np.tile(x, (1, 2, 1)), np.zeros((1, 2, 1, 21)))
    assert np.isnan(nowhere).all()


@pytest.mark.parametrize("model", ["kalker", "sliding"])
@pytest.mark.parametrize("case", CASES)
def test_volume_is_the_friction_energy_times_the_coefficient_over_friction(model, case):
    bodies = {"roller_material": steel(K), "guide_material": steel(2 * K)}
    if case.get("roller_material") == "POM":
        bodies["roller_material"] = {"like": "POM", "wear_coefficient": K}
    ds = solved(contact_model=model, **(case | bodies))
    slides = 1e3 * ds.friction_energy_per_distance.values / case.get("friction_coefficient", 0.3)
    assert ds.wear_volume_per_km.values == pytest.approx(np.outer(slides, [K, 2 * K]), rel=1e-6)


@pytest.mark.parametrize("normal", ["hertz", "halfspace"])
def test_volume_is_the_integral_of_depth(normal):
    """From the stored tractions, which are not tied to the friction energy."""
    bodies = {"roller_material": steel(K), "guide_material": steel(K)}
    ds = solved((*OUTPUTS, "tractions"), accuracy="standard", normal=normal, **bodies)
    slip = np.hypot(ds.slip_lateral, ds.slip_rolling)
    x, y = (ds[name].diff(axis).mean(axis) for name, axis in (("patch_x", "x"), ("patch_y", "y")))
    depth = 1e-3 * K * (ds.pressure * slip).sum("y") * y
    whole = 1e6 * depth.sum("x") * x  # 1e6 mm in a km, whatever the number of overrollings
    assert whole.values == pytest.approx(ds.wear_volume_per_km.sel(body="roller").values, rel=5e-3)
    estimate = float(ds.wear_error_estimate.max())
    assert depth.max("x").values == pytest.approx(ds.wear_depth_per_overrolling[:, 0].values, rel=estimate)
    for contact in (1, 2):
        own = depth.sel(contact=contact)
        place = float(ds.patch_x.sel(contact=contact)[int(own.argmax("x"))])
        assert place == pytest.approx(float(ds.wear_place.sel(contact=contact)[0]), abs=float(x[contact - 1]))


def test_error_estimate_covers_95_percent_and_depth_converges():
    rng, cases = np.random.default_rng(5), []
    for _ in range(20):
        load = 10 ** rng.uniform(1.3, 2.6)
        cases.append(
            tr.Case(
                radial_force=-load,
                axial_force=rng.uniform(0, 0.3) * load,
                motor_force=rng.choice([0.0, -0.05, 0.1]) * load,
                friction_coefficient=rng.uniform(0.1, 0.4),
                roller_profile_radius=-6 * rng.uniform(1.05, 1.5),
                contact_angle=rng.uniform(25, 45),
                roller_material=str(rng.choice([QUENCHED, "POM"])),
                guide_material=QUENCHED,
            )
        )
    found = {}
    for n in (12, 28, 64):
        found[n] = tr.solve(cases, ("wear",), accuracy=replace(PRESETS["standard"], elements=n, name=str(n)))
    exact = found[64].wear_depth_per_overrolling[..., 0]
    known = exact.notnull().values
    assert known.sum() > 30
    errors = {n: abs(found[n].wear_depth_per_overrolling[..., 0] / exact - 1).values for n in (12, 28)}
    for n, error in errors.items():
        assert np.mean((error <= found[n].wear_error_estimate.values)[known]) >= 0.95
    assert np.median(errors[28][known]) < 0.5 * np.median(errors[12][known])
    volumes = [abs(found[n].wear_volume_per_km / found[64].wear_volume_per_km - 1).values[known] for n in (12, 28)]
    assert np.median(volumes[1]) < 0.4 * np.median(volumes[0]) < 2e-3


@pytest.mark.parametrize(("model", "shortcuts"), [("kalker", True), ("sliding", False)])
def test_mirrored_rollers_wear_at_mirrored_places(model, shortcuts):
    one, other = (solved(contact_model=model, axial_force=f, shortcuts=shortcuts) for f in (25.0, -25.0))
    back = other.isel(contact=[1, 0])
    for name in ("wear_depth_per_overrolling", "wear_volume_per_km", "wear_life_hours"):
        assert back[name].values == pytest.approx(one[name].values, rel=1e-6)
    assert back.wear_place.values == pytest.approx(-one.wear_place.values, abs=1e-5)
    assert float(other.run_in_distance) == pytest.approx(float(one.run_in_distance), rel=1e-6)
    same = solved(contact_model=model, axial_force=0, motor_force=0, shortcuts=shortcuts)
    assert float(same.wear_place[0, 0]) == pytest.approx(-float(same.wear_place[1, 0]), abs=1e-5)


def test_braked_roller_that_slides_fully_wears_the_guide_as_a_pencil():
    """The guide slides over 1 m below a patch that stands still: 1e-3 k int p dy, and k F_N of volume a metre."""
    ds = solved(accuracy="standard", motor_force=500, roller_material=steel(K), guide_material=steel(2 * K))
    assert ds.regime == 1
    force = ds.normal_force.values
    expected = 2e-3 * K * np.pi / 2 * (ds.max_pressure * ds.semi_axis_rolling).values
    assert ds.wear_depth_per_overrolling.sel(body="guide").values == pytest.approx(expected, rel=5e-3)
    assert ds.wear_place.sel(body="guide").values == pytest.approx([0, 0], abs=1e-9)
    assert ds.wear_volume_per_km.values == pytest.approx(np.outer(1e3 * force, [K, 2 * K]), rel=1e-9)
    assert ds.wear_depth_per_overrolling.sel(body="roller").isnull().all()
    driven = solved(motor_force=-500)
    assert driven.regime == 1 and driven.wear_volume_per_km.isnull().all()  # nobody knows how fast it spins


def test_scaling():
    """All lengths times two, all forces times four: equal pressures and slips, twice the depth, twice the run-in."""
    base = {"axis_distance": 21.75, "guide_profile_radius": 6.0, "roller_profile_radius": -7.0}
    loads = {"radial_force": -200.0, "axial_force": 30.0, "motor_force": -30.0}
    straight = {"guide_curve_radius": float("inf")}
    one = solved(**(base | loads | straight))
    two = solved(**({n: 2 * v for n, v in base.items()} | {n: 4 * v for n, v in loads.items()} | straight))
    for name, factor in (("wear_depth_per_overrolling", 2), ("wear_volume_per_km", 4), ("run_in_distance", 2)):
        assert two[name].values == pytest.approx(factor * one[name].values, rel=1e-6), name
    assert two.wear_depth_per_km.sel(body="roller").values == pytest.approx(one.wear_depth_per_km.values[:, 0])
    fast = solved(velocity=120.0, **(base | loads | straight))
    assert np.array_equal(fast.wear_depth_per_overrolling, one.wear_depth_per_overrolling)
    assert fast.wear_life_hours.values == pytest.approx(one.wear_life_hours.values * [0.5, 1.0])


def sum_of_gaps(depth, guide, groove):
    """The area between a guide's circle that is sunk by a depth and a groove, by a fine sum [mm2]."""
    x = np.linspace(-guide, guide, 2_000_001)
    gap = (guide - np.sqrt(guide**2 - x**2)) - np.sign(groove) * (abs(groove) - np.sqrt(groove**2 - x**2))
    return np.trapezoid(np.maximum(depth - gap, 0.0), x)


@pytest.mark.parametrize(("roller", "groove"), [(-7.0, 7.0), (-6.01, 6.01), (9.0, -9.0), (np.inf, np.inf)])
@pytest.mark.parametrize("depth", [1e-4, 0.05, 0.3])
def test_the_sunk_area_is_the_sum_of_the_gaps(roller, groove, depth):
    """Below the equator of the guide every line across the gap lies in the lens of both circles."""
    if np.isinf(groove):
        x = np.linspace(-6.0, 6.0, 2_000_001)
        expected = np.trapezoid(np.maximum(depth - (6.0 - np.sqrt(36.0 - x**2)), 0.0), x)
    else:
        expected = sum_of_gaps(depth, 6.0, groove)
    assert float(sunk_area(depth, 6.0, roller)) == pytest.approx(expected, rel=2e-5)


def test_the_sunk_area_of_a_small_depth_is_that_of_parabolas():
    """(4/3) h sqrt(2 h/kappa) with the difference kappa of the curvatures."""
    kappa, h = 1 / 6 - 1 / 7, 1e-5
    assert float(sunk_area(h, 6.0, -7.0)) == pytest.approx(4 / 3 * h * np.sqrt(2 * h / kappa), rel=1e-3)


def test_a_drawn_profile_that_is_the_circle_wears_out_after_the_same_hours():
    circle, drawn = (
        solved(normal="halfspace", roller_profile=profile, roller_material=steel(K), guide_material=steel(K))
        for profile in (None, {"arc": -7.0})
    )
    assert drawn.wear_life_hours_high.values == pytest.approx(circle.wear_life_hours_high.values, rel=0.02)


def test_rates_life_and_run_in_distance():
    ds = solved(required_travel=20, velocity=90, roller_material=steel(K), guide_material=steel(K))
    radius, depth = 21.75 - 6 * np.cos(np.deg2rad(30)), ds.wear_depth_per_overrolling.values
    hourly = np.array([90 * 60e3 / (2 * np.pi * radius), 60.0])
    per_km = depth * hourly / 5.4
    assert ds.wear_depth_per_km.values == pytest.approx(per_km)
    by_depth = 0.05 / depth / hourly
    lens = sum_of_gaps(0.05, 6.0, 7.0)  # the same area is worn off each overrolling
    by_area = lens / (1e-6 * ds.wear_volume_per_km.values) / hourly
    assert ds.wear_life_hours.values == pytest.approx((by_depth + by_area) / 2, rel=1e-4)
    assert ds.wear_life_hours_low.values == pytest.approx(by_depth) and (by_depth < by_area).all()
    assert ds.wear_life_hours_high.values == pytest.approx(by_area, rel=1e-4)
    a = ds.semi_axis_lateral.values
    gap = [6 - np.sqrt(36 - a**2), 7 - np.sqrt(49 - a**2)]  # of the two circles
    assert float(ds.run_in_distance) == pytest.approx(np.min((gap[0] - gap[1]) / per_km.max(axis=1)), rel=2e-2)
    of_wear = ds.sel(limit="wear")
    assert of_wear.utilisation.values == pytest.approx(20 / (5.4 * ds.wear_life_hours.min("contact").values))
    assert of_wear.life_hours_by_limit.values == pytest.approx(ds.wear_life_hours.min("contact").values)
    drawn = solved(normal="halfspace", velocity=90, roller_material=steel(K), guide_material=steel(K))
    assert float(drawn.run_in_distance) == pytest.approx(float(ds.run_in_distance), rel=0.1)
    unknown = solved(guide_overrollings_per_hour=None, velocity=90, roller_material=steel(K), guide_material=steel(K))
    assert float(unknown.run_in_distance) == pytest.approx(float(ds.run_in_distance))  # the roller wears faster
    assert unknown.wear_life_hours.sel(body="guide").isnull().all()


def test_flag_worn_where_a_life_exceeds_the_run_in_distance():
    thick = solved(roller_material=steel(K), guide_material=steel(K))
    assert (int(thick.validity_body[0]) & int(thick.validity_body[1]) & validity_bit("worn")) > 0
    thin = solved(permissible_wear_depth=1e-5, roller_material=steel(K), guide_material=steel(100 * K))
    assert not int(thin.validity) & validity_bit("worn")


def worn(ds):
    return {str(body): bool(int(ds.validity_body.sel(body=body)) & validity_bit("worn")) for body in ds.body.values}


# the roller wears to its permissible depth long before its run-in, the guide long after it
UNLIKE = {"permissible_wear_depth": 1e-5, "roller_material": steel(100 * K), "guide_material": steel(K / 100)}


def test_the_groove_wears_away_within_the_life_of_a_body_whose_own_life_is_longer():
    ds = solved(**UNLIKE)
    lives, run_in = ds.life_to_first_limit_hours, float(ds.run_in_distance) / 3.6  # 60 m/min
    assert float(lives.sel(body="roller")) < run_in < float(lives.sel(body="guide"))
    assert worn(ds) == {"roller": False, "guide": True}
    # without the checked limits the life follows from the limits that are computed
    assert worn(solved(("forces", "wear"), **UNLIKE)) == {"roller": False, "guide": True}


def test_a_body_that_breaks_has_no_life_that_a_groove_could_outlast():
    weak = steel(K) | {"tensile_strength": 300.0, "yield_strength": 250.0}
    ds = solved(roller_material=weak, guide_material=steel(K))
    assert float(ds.life_to_first_limit_hours.sel(body="roller")) == 0
    assert worn(ds) == {"roller": False, "guide": True}


@pytest.mark.slow
def test_page_and_terminal_name_the_body_that_outlives_the_groove(tmp_path):
    (tmp_path / "case.yaml").write_text(yaml.safe_dump({**GIVEN, **UNLIKE, "contact_model": "kalker"}))
    shown = trackroller("solve", "case.yaml", cwd=tmp_path).stdout
    trackroller("solve", "case.yaml", "--report", "sheet.html", cwd=tmp_path)
    for text in (shown, (tmp_path / "sheet.html").read_text(encoding="utf-8")):
        assert "The groove wears away within the life of the guide." in " ".join(text.split())


@pytest.mark.parametrize(
    ("output", "told"),
    [
        ("life_to_first_limit_hours_roller", []),
        ("life_to_first_limit_hours_guide", [2]),
        ("pair_life_to_first_limit_hours", []),  # it ends with the roller
        ("peak_stress_roller", [2]),
    ],
)
def test_the_answer_counts_the_life_that_it_is_about(tmp_path, monkeypatch, output, told):
    entries = [
        f"  {name}: {{like: {QUENCHED}, wear_coefficient: {{value: {k}, source: test}}}}"
        for name, k in (("soft", 100 * K), ("hard", K / 100))
    ]
    (tmp_path / "materials.yaml").write_text("\n".join(["materials:", *entries, ""]))
    monkeypatch.setenv("TRACKROLLER_MATERIALS", str(tmp_path / "materials.yaml"))
    base = GIVEN | {"permissible_wear_depth": 1e-5, "roller_material": "soft", "guide_material": "hard"}
    study = {"name": "unlike", "base": base, "factors": {"axial_force": {"values": [0, 5]}}, "accuracy": "preview"}
    study |= {"outputs": [*OUTPUTS, "peak_stress"], "contact_model": "sliding", "question": "how it behaves"}
    answer = tr.run(study | {"analysis": {"outputs": [output]}}, progress=False).answer
    assert [one.count for one in answer.warnings if one.code == "worn"] == told


def test_energy_law_equals_archard_for_a_linear_table_and_follows_its_corners():
    table = {"work_rate": [0, 100], "roller": [0, 100 * 7800 * K / 0.3], "guide": [0, 50 * 7800 * K / 0.3]}
    of_mass = {"like": QUENCHED, "density": 7800}
    energy = solved(wear_law="energy", wear_table=table, roller_material=of_mass, guide_material=of_mass)
    archard = solved(roller_material=steel(K), guide_material=steel(0.5 * K))
    for name in ("wear_depth_per_overrolling", "wear_volume_per_km", "wear_place", "run_in_distance"):
        assert energy[name].values == pytest.approx(archard[name].values, rel=1e-5), name
    railway = [0, 10.4, 77.2, 100], [0, 55, 55, 1466]
    assert mass_loss(np.array([5.2, 40, 77.2, 88.6, 111.4]), *railway) == pytest.approx([27.5, 55, 55, 760.5, 2171.5])


def test_the_energy_law_of_the_materials_needs_no_table():
    """Wheel and rail steel of the twin discs: 5.3 ug/(m mm2) per N/mm2, level from 10.4, steeper from 77.2 N/mm2."""
    pearlitic = {"roller_material": "C45", "guide_material": "1.7225-normalised", "motor_force": -10}
    law = tr.load_database().material("C45").energy_wear
    assert mass_loss(np.array([2.0, 10.4, 50.0, 77.2]), law.work_rate, law.loss) == pytest.approx(
        [5.3 * 2.0, 5.3 * 10.4, 55, 55], rel=0.003
    )
    assert law.loss[-1] == pytest.approx(61.9 * 100 - 4778.7, rel=0.04)  # as quoted, with its gap at 77.2
    energy = solved(wear_law="energy", **pearlitic)
    table = {"work_rate": law.work_rate, "roller": law.loss, "guide": law.loss}
    by_hand = solved(wear_law="energy", wear_table=table, **pearlitic)
    for name in ("wear_depth_per_overrolling", "wear_life_hours"):
        np.testing.assert_array_equal(energy[name], by_hand[name])
    notes = energy.attrs["limits_notes"]
    assert "energy_wear (dry twin discs of R8T" in notes and "no wear_table" not in notes
    assert "energy_wear" not in by_hand.attrs["limits_notes"] + solved(**pearlitic).attrs["limits_notes"]
    half = solved(wear_law="energy", **pearlitic | {"guide_material": QUENCHED})
    assert "wear: the case gives no wear_table." in half.attrs["limits_notes"]
    flag = validity_bit("wear_extrapolated")
    low = {"like": "C45", "energy_wear": {"work_rate": [0, 1e-6], "loss": [0, 5.3e-6], "source": "own tests"}}
    beyond = solved(wear_law="energy", **pearlitic | {"roller_material": low})
    assert int(beyond.validity) & flag and not int(energy.validity) & flag


def test_the_laws_of_two_materials_make_one_table_where_both_are_known():
    one = {"work_rate": [0.0, 10.0, 40.0], "loss": [0.0, 50.0, 80.0]}
    two = {"work_rate": [1.0, 20.0, 60.0], "loss": [3.0, 3.0, 43.0]}
    table = TABLE.parsed(table_of_laws(json.dumps(one), json.dumps(two)))
    assert table == {"work_rate": [1, 10, 20, 40], "roller": [5, 50, 60, 80], "guide": [3, 3, 3, 23]}
    work = np.linspace(1, 40, 79)
    for body, law in (("roller", one), ("guide", two)):
        own = mass_loss(work, law["work_rate"], law["loss"])
        assert mass_loss(work, table["work_rate"], table[body]) == pytest.approx(own)


@pytest.mark.parametrize(
    ("law", "message"),
    [
        (3, "a mapping with the lists work_rate, loss"),
        ({"work_rate": [0, 1]}, "energy_wear.loss.*a list of at least two numbers"),
        ({"work_rate": [0, 1], "loss": [0, 1, 2]}, "one value for each of the 2 work rates"),
        ({"work_rate": [1, 0], "loss": [0, 1]}, "work rates that rise"),
        ({"work_rate": [0, 1], "loss": [0, -1]}, "loss = -1"),
        ({"work_rate": [0, 1], "loss": [0, 1], "rate": 3}, "'rate' is not known"),
        ({"work_rate": [0, 1], "loss": [0, 1], "placeholder": "maybe"}, "true or false"),
    ],
)
def test_a_wrong_energy_law_of_a_material_is_refused(law, message):
    with pytest.raises(tr.InputError, match=message):
        tr.load_database().material({"like": "C45", "energy_wear": law})


def test_cases_of_equal_mechanics_share_their_tractions():
    cases = [GIVEN | {"wear_coefficient_factor": f, "velocity": v} for f, v in ((1, 60), (3, 60), (0.2, 20))]
    for table in ({"work_rate": [0, 9], "roller": [0, 9], "guide": [0, 9]}, None):
        law = "archard" if table is None else "energy"
        rows = [case | {"wear_table": table and table | {"roller": [0, 9 + i]}} for i, case in enumerate(cases)]
        both = tr.solve(rows, OUTPUTS, accuracy="preview", wear_law=law)
        for i, row in enumerate(rows):
            alone = tr.solve(row, OUTPUTS, accuracy="preview", wear_law=law)
            for name in ("wear_depth_per_km", "wear_life_hours", "run_in_distance"):
                assert both[name][i].values == pytest.approx(alone[name].values, rel=1e-12)


@pytest.mark.parametrize(
    "case",
    [
        {"roller_material": steel(0.0), "guide_material": steel(0.0)},
        {"roller_material": steel(1.0), "guide_material": steel(1.0)},
        {"roller_material": "POM", "guide_material": QUENCHED},
        {"roller_material": QUENCHED, "guide_material": "POM"},
        {"motor_force": -68.5},  # next to full slip at 69.3 N
        {"motor_force": -69.5},
        {"axial_force": 113, "motor_force": 0},  # a contact is nearly lifted
        {"axial_force": 130, "motor_force": 0},
        {"friction_coefficient": 0.0, "motor_force": 0},
        {"friction_coefficient": 1e-6, "motor_force": 0},
        {"friction_law": {"kind": "exponential", "lowest": 0.5, "speed": 10.0}, "motor_force": 0},
    ],
)
def test_extremes_give_a_result_or_a_reason(case):
    ds = solved(**case)
    depth = ds.wear_depth_per_overrolling.values
    if ds.regime == 0:
        assert np.isfinite(depth).all() and (depth >= 0).all() and float(ds.run_in_distance) >= 0
        assert (depth > 0).all() or "wear_coefficient" in str(case)
    elif ds.regime == 1:
        assert np.isnan(depth).all()
    else:
        assert np.isnan(depth).any() and np.isnan(float(ds.run_in_distance))


def test_wear_without_friction_is_the_limit_of_little_friction():
    bare, little = (solved(friction_coefficient=mu, motor_force=0, accuracy="standard") for mu in (0.0, 1e-6))
    assert bare.wear_volume_per_km.values == pytest.approx(little.wear_volume_per_km.values, rel=5e-3)
    endless = solved(roller_material=steel(0.0), guide_material=steel(0.0))
    assert np.isposinf(endless.wear_life_hours).all() and np.isposinf(endless.run_in_distance)


def test_placeholders_and_missing_values_are_told():
    guessed = solved(roller_material="POM", radial_force=-60, axial_force=5, motor_force=0).attrs["limits_notes"]
    assert "wear: placeholders of material 'POM': wear_coefficient (on 1.7225-normalised, measure, expected" in guessed
    measured = solved(("wear",), roller_material=steel(K), guide_material=steel(K))
    assert measured.attrs["limits_notes"] == ""
    unknown = {"like": QUENCHED, "family": "PEEK"}
    ds = solved(("wear", "limits"), roller_material=unknown | {"name": "mine"}, friction_coefficient=0.2)
    assert "wear: material 'mine' has no wear_coefficient." in ds.attrs["limits_notes"]
    assert ds.wear_life_hours.sel(body="roller").isnull().all() and np.isnan(float(ds.run_in_distance))
    energy = solved(("wear", "limits"), wear_law="energy", roller_material=steel(K), guide_material=steel(K))
    assert "wear: the case gives no wear_table." in energy.attrs["limits_notes"]
    assert "density" in energy.attrs["limits_notes"] and "wear_coefficient" not in energy.attrs["limits_notes"]
    assert energy.wear_volume_per_km.isnull().all()
    bare = solved(("wear", "limits"), permissible_wear_depth=None)
    assert "wear: the case gives no permissible_wear_depth." in bare.attrs["limits_notes"]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"permissible_wear_depth": 0}, "permissible_wear_depth"),
        ({"permissible_wear_depth": -1}, "permissible_wear_depth"),
        ({"required_travel": "far"}, "required_travel"),
        ({"wear_coefficient_factor": -1}, "wear_coefficient_factor"),
        ({"roller_material": steel(2.0)}, "wear_coefficient"),
        ({"wear_law": "tgamma"}, "wear_law"),
        ({"wear_table": {"work_rate": [0, 1], "roller": [0, 1]}}, "the mapping lacks guide"),
        ({"wear_table": {"work_rate": [0, 1], "roller": [0, 1], "guide": [0]}}, "numbers of entries"),
        ({"wear_table": {"work_rate": [1, 0], "roller": [0, 1], "guide": [0, 1]}}, "wear_table.work_rate"),
        ({"wear_table": {"work_rate": [0, 1], "roller": [0, -1], "guide": [0, 1]}}, "wear_table.roller"),
        ({"wear_table": {"work_rate": 3, "roller": [0, 1], "guide": [0, 1]}}, "wear_table.work_rate"),
        ({"wear_table": {"rate": [0, 1]}}, "rate"),
    ],
)
def test_bad_input_is_refused_by_name(wrong, message):
    with pytest.raises(tr.InputError, match=message):
        solved(**wrong)


def test_table_in_the_documentation_is_read():
    text = TABLE.meaning[TABLE.meaning.index("{") :]
    for key in ("work_rate", "roller", "guide"):
        text = text.replace(f"{key}:", f'"{key}":')
    assert TABLE.canonical(json.loads(text))["work_rate"] == [0, 10.4, 77.2, 100]


def test_a_given_factor_replaces_the_range_of_the_wear_coefficients():
    """At every place of the placeholders the wear is that of the coefficients times the factor, never of both."""
    case = {"roller_material": "EN AW-7075", "permissible_wear_depth": 0.1, "guide_overrollings_per_hour": 100}
    keys = {"outputs": ("wear", "shakedown"), "contact_model": "sliding", "accuracy": "preview"}
    base = tr.solve(case | {"wear_coefficient_factor": 3}, **keys)
    for place in (-1, 1):
        moved = tr.solve(case | {"wear_coefficient_factor": 3, "placeholder_position": place}, **keys)
        np.testing.assert_allclose(moved["wear_volume_per_km"], base["wear_volume_per_km"], rtol=1e-12)
        alone = tr.solve(case | {"placeholder_position": place}, **keys)
        assert (abs(3 * alone["wear_volume_per_km"] / base["wear_volume_per_km"] - 1) > 0.1).any()


def test_work_outside_the_table_of_the_energy_law_is_told():
    """The largest work of an element, from the stored tractions, lies inside, above or below the table."""
    rows = {"wear_law": "energy", "roller_material": {"like": QUENCHED, "density": 7800}}
    whole = {"work_rate": [0, 1e6], "roller": [0, 1e6], "guide": [0, 1e6]}
    inside = solved((*OUTPUTS, "tractions"), wear_table=whole, **rows)
    work = np.hypot(inside.shear_lateral, inside.shear_rolling) * np.hypot(inside.slip_lateral, inside.slip_rolling)
    largest = float(work.max())
    flag = validity_bit("wear_extrapolated")
    assert largest > 0 and not int(inside.validity) & flag
    for rates, told in (([0, 1.001], False), ([0, 0.999], True), ([0.5, 1.001], True)):
        table = {"work_rate": [largest * rate for rate in rates], "roller": rates, "guide": rates}
        ds = solved(wear_table=table, **rows)
        assert bool(int(ds.validity) & flag) == told, rates
        assert "_beyond_wear_table" not in ds
    assert not int(solved().validity) & flag
    both = tr.solve(
        [tr.Case(**GIVEN, wear_table=t) for t in (whole, table)], OUTPUTS, accuracy="preview", wear_law="energy"
    )
    assert [bool(bits & flag) for bits in both.validity.values] == [False, True]


LEFT = "The frictional work lies outside the table of wear."
TABLE_CASE = """
motor_force: -10
friction_coefficient: 0.2
roller_material: {like: 1.7225-quenched-tempered, density: 7800}
guide_material: {like: 1.7225-quenched-tempered, density: 7800}
wear_law: energy
wear_table: {work_rate: [0, MOST], roller: [0, MOST], guide: [0, MOST]}
outputs: [forces, wear, limits]
contact_model: sliding
accuracy: preview
"""


@pytest.mark.slow
@pytest.mark.parametrize(("most", "told"), [("0.5", True), ("1000", False)])
def test_terminal_sheet_rows_and_answer_tell_of_work_outside_the_table(tmp_path, most, told):
    (tmp_path / "case.yaml").write_text(TABLE_CASE.replace("MOST", most))
    shown = trackroller("solve", "case.yaml", cwd=tmp_path).stdout
    trackroller("solve", "case.yaml", "--report", "sheet.html", cwd=tmp_path)
    assert (LEFT in " ".join(shown.split())) == told
    assert (LEFT in (tmp_path / "sheet.html").read_text(encoding="utf-8")) == told
    given = yaml.safe_load(TABLE_CASE.replace("MOST", most))
    options = {name: given.pop(name) for name in ("wear_law", "outputs", "contact_model", "accuracy")}
    given |= {"roller_material": QUENCHED, "guide_material": QUENCHED}  # the work does not depend on the density
    study = {"name": "table", "base": given, "factors": {"axial_force": {"values": [0, 20]}}, **options}
    results = tr.run(study, progress=False)
    assert results.flagged("wear_extrapolated").tolist() == [told, told]
    where = [one.where for one in results.answer.warnings if one.code == "extrapolated"]
    assert ("wear beyond the table of its energy law" in where) == told


@pytest.mark.parametrize(("most", "told"), [("0.5", True), ("1000", False)])
def test_a_roller_that_is_followed_while_it_wears_tells_of_work_outside_the_table(tmp_path, most, told):
    """Whatever outputs the case names; the page needs the patch, which every run has."""
    (tmp_path / "case.yaml").write_text(
        TABLE_CASE.replace("MOST", most).replace("forces, wear, limits", "forces, limits")
    )
    trackroller("wear", "case.yaml", "--to", "1km", "-o", "w.nc", "--report", "w.html", cwd=tmp_path)
    with xr.open_dataset(tmp_path / "w.nc") as ds:
        assert ((ds["validity"].values & validity_bit("wear_extrapolated")) > 0).all() == told
    assert (LEFT in (tmp_path / "w.html").read_text(encoding="utf-8")) == told
