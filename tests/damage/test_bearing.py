"""The bearing inside the roller and the maker's catalogue."""

import math

import numpy as np
import pytest

import trackroller as tr
from trackroller.damage.bearing import BearingLoads, equivalent, life_at, rating_life, row_forces
from trackroller.damage.catalogue import catalogue_km
from trackroller.errors import InputError

BEARING = {"rows": 2, "row_distance": 8, "kind": "ball", "dynamic_rating": 4000, "static_rating": 2000}
BEARING |= {"e": 0.27, "X": 0.56, "Y": 1.6, "X0": 0.6, "Y0": 0.5}
CATALOGUE = {"radial_force": 800, "axial_force": 300, "moment": 4000, "basic_life": 100, "law": "dry"}
BALL, ROLLER = np.array(["ball"], dtype=object), np.array(["roller"], dtype=object)


def column(*values):
    return np.array(values, dtype=float)


def test_worked_example_of_a_maker():
    """A ball bearing 6309 (C = 55.3 kN) under 10 kN lives 169 million turns, 940 h at 3,000 turns a minute (SKF)."""
    life = rating_life(np.array([[10000.0]]), column(55300), BALL)
    assert life == pytest.approx(169, abs=0.5) and life * 1e6 / (60 * 3000) == pytest.approx(940, abs=1)


def test_equivalent_load_by_pencil():
    """F_r = 4 kN and F_a = 2.2 kN: P = 0.56 * 4000 + 1.6 * 2200 = 5760 N, (29000/5760)^3 = 127.6."""
    factors = {"e": 0.27, "X": 0.56, "Y": 1.6, "X0": 0.6, "Y0": 0.5}
    load, static = equivalent(column(4000), column(2200), factors)
    assert load == pytest.approx(5760, rel=1e-14) and static == pytest.approx(4000)
    assert rating_life(load[:, None], column(29000), BALL) == pytest.approx(127.6, abs=0.05)
    assert rating_life(load[:, None], column(29000), ROLLER) == pytest.approx((29000 / 5760) ** (10 / 3), rel=1e-12)


def test_a_small_axial_force_does_not_count():
    factors = {"e": 0.27, "X": 0.56, "Y": 1.6, "X0": 0.6, "Y0": 0.5}
    assert equivalent(column(1000, 1000), column(269, 271), factors)[0] == pytest.approx([1000, 560 + 1.6 * 271])


@pytest.mark.parametrize(("kind", "slope"), [(BALL, 10 / 9), (ROLLER, 9 / 8)])
def test_two_equal_rows_live_shorter_than_one(kind, slope):
    one, two = (rating_life(np.full((1, n), 500.0), column(4000), kind) for n in (1, 2))
    assert two / one == pytest.approx(2 ** (-1 / slope), rel=1e-12)
    assert rating_life(np.array([[500.0, np.nan]]), column(4000), kind) == one


def test_half_of_the_ball_bearings_reach_545_times_the_rating_life():
    assert life_at(1.0, 0.5, 10 / 9) == pytest.approx(5.45, abs=0.005)
    assert life_at(1.0, 0.1, 10 / 9) == pytest.approx(1.0, rel=1e-14)


def test_the_rows_carry_forces_and_moments_in_balance():
    loads = BearingLoads(column(-200), column(-30), column(50), column(900), column(-400))
    radial, axial = row_forces(loads, column(2), column(8))
    pressing, driving = (-100 + 900 / 8, -100 - 900 / 8), (-15 + 400 / 8, -15 - 400 / 8)
    assert radial[0] == pytest.approx([math.hypot(*row) for row in zip(pressing, driving, strict=True)])
    assert axial[0].tolist() == [0.0, 50.0]  # the row with the larger radial force
    assert sum(pressing) == -200 and (pressing[0] - pressing[1]) * 8 / 2 == 900


def test_axial_force_alone_loads_one_row_by_y():
    loads = BearingLoads(*(column(v) for v in (0, 0, 100, 0, 0)))
    load, static = equivalent(
        *row_forces(loads, column(2), column(8)), {k: BEARING[k] for k in ("e", "X", "Y", "X0", "Y0")}
    )
    assert load[0].tolist() == [160.0, 0.0] and static[0].tolist() == [50.0, 0.0]
    assert rating_life(load, column(4000), BALL) == pytest.approx(25.0**3)


def test_catalogue_laws():
    law = np.array(["dry", "lubricated", "cubic", "", "square"], dtype=object)
    km = catalogue_km(np.full(5, 0.5), np.full(5, 100.0), law)
    assert km[[0, 1, 2, 4]] == pytest.approx([100 / 0.515**2, 100 / 0.515**3, 800, 400]) and np.isnan(km[3])
    assert catalogue_km(np.ones(3), np.full(3, 70.0), law[:3]) == pytest.approx([70, 70, 70])
    assert catalogue_km(np.zeros(3), np.full(3, 70.0), law[:3])[2] == np.inf


def test_worked_example_of_a_catalogue():
    """DualVee W4X, 300 lbf axial of 900 and 100 lbf radial of 2181: LF 0.38, 6.84e6/LF^3 = 124.7e6 inch, 3167 km."""
    factor = 300 / 900 + 100 / 2181
    assert round(factor, 2) == 0.38
    inches = catalogue_km(np.array([0.38]), np.array([6.84e6]), np.array(["cubic"], dtype=object))
    assert inches == pytest.approx([124.7e6], rel=5e-4) and inches * 25.4e-6 == pytest.approx([3167], rel=5e-4)
    pounds = 4.4482216  # N
    wheel = {"radial_force": 2181 * pounds, "axial_force": 900 * pounds, "basic_life": 6.84e6 * 25.4e-6, "law": "cubic"}
    load = {"radial_force": -100 * pounds, "axial_force": 300 * pounds, "motor_force": 0}
    shape = {"axis_distance": 60, "guide_profile_radius": 20, "roller_profile_radius": 60, "contact_angle": 75}
    ds = tr.solve(tr.Case(**load, **shape, catalogue=wheel), ("bearing",), contact_model="sliding", accuracy="preview")
    assert float(ds.catalogue_life_km) == pytest.approx(6.84e6 * 25.4e-6 / factor**3, rel=1e-9)


def test_factors_of_speed_and_stroke_and_an_exponent():
    """Rollon: 100 km (C/P f_h)^3, so that a stroke factor divides the load; a factor of the life is DualVee's AF."""
    base = {"radial_force": 800, "axial_force": 300, "basic_life": 100, "law": "cubic"}
    more = [{}, {"stroke_factor": 0.7}, {"speed_factor": 0.6}, {"exponent": 2.5, "offset": 0.1}, {"law": "square"}]
    cases = [tr.Case(motor_force=0, axial_force=30, catalogue=base | own) for own in more]
    ds = tr.solve(cases, ("bearing",), contact_model="sliding", accuracy="preview")
    ratio = 200 / 800 + 30 / 300
    factor = np.array([ratio, ratio / 0.7, ratio, ratio, ratio])
    assert ds.catalogue_load_factor.values == pytest.approx(factor, rel=1e-6)
    km = [ratio**-3, (ratio / 0.7) ** -3, 0.6 * ratio**-3, (0.1 + 0.9 * ratio) ** -2.5, ratio**-2]
    assert ds.catalogue_life_km.values == pytest.approx(100 * np.array(km), rel=1e-6)


def test_a_catalogue_without_a_moment_and_with_an_offset():
    """Moment, law and offset may be left out; an offset of 0 leaves BL/LF^2."""
    short = {name: CATALOGUE[name] for name in ("radial_force", "axial_force", "basic_life")}
    catalogues = [short, short | {"moment": 1e12, "law": "dry"}, short | {"offset": 0}, short | {"law": "cubic"}]
    cases = [tr.Case(motor_force=40, axial_force=20, catalogue=one) for one in catalogues]
    ds = tr.solve(cases, ("bearing", "limits"), contact_model="sliding")
    factor = ds.catalogue_load_factor.values
    assert factor == pytest.approx(np.full(4, np.hypot(200, 40) / 800 + 20 / 300), rel=1e-6)
    km = 100 * np.array([(0.03 + 0.97 * factor[0]) ** -2] * 2 + [factor[0] ** -2, factor[0] ** -3])
    assert ds.catalogue_life_km.values == pytest.approx(km, rel=1e-6)


def test_a_roller_with_bearing_and_catalogue():
    """Free rolling without axial force: no moment, each row carries half the radial force."""
    case = {"motor_force": 0, "axial_force": 0, "bearing": BEARING, "catalogue": CATALOGUE}
    ds = tr.solve(tr.Case(**case, permissible_radial_force=250), ("bearing", "limits"), contact_model="sliding")
    turns = 60 * 60e3 / (2 * math.pi * (21.75 - 6 * math.cos(math.radians(30))))
    hours = (4000 / 100) ** 3 * 2 ** (-9 / 10) * 1e6 / turns
    assert float(ds.bearing_life_hours) == pytest.approx(hours, rel=1e-6)
    assert float(ds.bearing_static_safety) == pytest.approx(20, rel=1e-9)
    assert float(ds.bearing_utilisation) == pytest.approx(200 / 250, rel=1e-12)  # ring or stud
    assert float(ds.catalogue_load_factor) == pytest.approx(200 / 800, rel=1e-6)
    by_limit = ds.life_hours_by_limit.sel(body="roller")
    assert float(by_limit.sel(limit="bearing")) == pytest.approx(5.449 * hours, rel=1e-3)
    assert float(by_limit.sel(limit="catalogue")) == pytest.approx(100 / (0.03 + 0.97 / 4) ** 2 / 3.6, rel=1e-6)
    assert np.isnan(ds.utilisation.sel(body="guide", limit=["bearing", "catalogue"])).all()


def test_cases_with_other_bearings_share_their_mechanics():
    cases = [tr.Case(motor_force=0, bearing=BEARING | {"dynamic_rating": c}) for c in (1000, 2000, 4000)]
    cases.append(tr.Case(motor_force=0))
    ds = tr.solve(cases, ("bearing", "forces"), contact_model="sliding")
    assert len(np.unique(ds.normal_force.values, axis=0)) == 1
    lives = ds.bearing_life_hours.values
    assert lives[:3] / lives[0] == pytest.approx([1, 8, 64], rel=1e-12) and np.isnan(lives[3])


@pytest.mark.parametrize(
    ("field", "change", "told"),
    [
        ("bearing", {"rows": 1}, "permissible_moment"),
        ("bearing", {"rows": 3}, "rows"),
        ("bearing", {"rows": 1.5}, "1 or 2"),
        ("bearing", {"row_distance": None}, "row_distance"),
        ("bearing", {"dynamic_rating": None}, "lacks dynamic_rating"),
        ("bearing", {"dynamic_rating": -1}, "dynamic_rating"),
        ("bearing", {"dynamic_ratng": 5}, "Did you mean 'dynamic_rating'"),
        ("bearing", {"kind": "needle"}, "ball, roller"),
        ("catalogue", {"law": "wet"}, "dry, lubricated, cubic"),
        ("catalogue", {"basic_life": None}, "lacks basic_life"),
        ("catalogue", {"radial": 800}, "Write radial_force"),
        ("catalogue", {"axial": 300}, "Write axial_force"),
        ("catalogue", {"basic_life_km": 100}, "Write basic_life"),
        ("catalogue", {"lubricated": True}, "Write law: lubricated"),
        ("catalogue", {"offset": 2}, "offset"),
        ("catalogue", {"exponent": 0.1}, "exponent"),
        ("catalogue", {"speed_factor": 0}, "speed_factor"),
        ("catalogue", {"stroke_factor": -1}, "stroke_factor"),
    ],
)
def test_contradictory_ratings_are_refused_by_name(field, change, told):
    with pytest.raises(InputError, match=told):
        tr.Case(**{field: (BEARING if field == "bearing" else CATALOGUE) | change})


def test_a_case_without_bearing_says_so_and_the_other_limits_are_computed():
    ds = tr.solve(tr.Case(motor_force=0), ("peak_stress", "bearing", "limits"), contact_model="sliding")
    assert "bearing: the case gives no bearing" in ds.attrs["limits_notes"]
    assert "catalogue: the case gives no catalogue" in ds.attrs["limits_notes"]
    assert np.isnan(ds.utilisation.sel(limit="bearing")).all() and (ds.utilisation.sel(limit="static") > 0).all()
