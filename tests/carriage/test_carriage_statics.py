"""Forces of the rollers of a carriage against arrangements that are solved by hand, and against the least energy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from carts import SIDES, cart, rollers_below, rollers_between, shuttle
from limit_rows import headline, part_of
from scipy.optimize import lsq_linear, minimize

from trackroller.carriage import statics
from trackroller.carriage.file import load_carriage
from trackroller.carriage.files import study_of
from trackroller.carriage.loads import GRAVITY, wrenches_of
from trackroller.carriage.solve import forces_of, solve_carriage, springs_of
from trackroller.carriage.statics import equilibrium
from trackroller.errors import InputError
from trackroller.results.carriage_answer import answer_of_carriage

G = GRAVITY


def solved(values):
    return forces_of(load_carriage(values))


def test_four_equal_springs():
    """P = F/4 +- F/2 (b/c) +- F/2 (a/d): makers' formula for a load off the centre."""
    ds = solved(cart(mass={"value": 100, "at": [30, 10, 50]}, rollers=rollers_below(stiffness=1e4)))
    f, wheelbase, gauge = 100 * G, 300, 80
    for name, (x, y) in SIDES.items():
        expected = f / 4 + math.copysign(f / 2 * 30 / wheelbase, x) + math.copysign(f / 2 * 10 / gauge, y)
        assert -float(ds.radial_force.sel(roller=name)[0]) == pytest.approx(expected, rel=1e-12)


def test_four_equal_axial_springs():
    """The same formula holds along the axes of rollers whose preload makes their contacts equally stiff."""
    ds = solved(shuttle(cases=[{"name": "run"}]))
    f, x = 100 * G, 48.0
    for name, (at, _) in SIDES.items():
        expected = -(f / 4 + math.copysign(f / 2 * x / 300, at))
        assert float(ds.axial_force.sel(roller=name)[0]) == pytest.approx(expected, rel=1e-9)
        assert float(ds.radial_force.sel(roller=name)[0]) == pytest.approx(-1000, rel=1e-9)


def test_three_rollers_are_determinate():
    """Two rollers in front and one behind: the lever rule, without any stiffness."""
    down = {"pushes": [0, 0, -1], "x_R": [0, 1, 0]}
    places = {"A": [200, 50, 0], "B": [200, -50, 0], "C": [-100, 0, 0]}
    rollers = {
        name: {"at": at, **down, "kind": "floating" if name == "B" else "locating"} for name, at in places.items()
    }
    ds = solved(cart(mass={"value": 60, "at": [50, 10, 70]}, rollers=rollers))
    f = 60 * G
    assert -float(ds.radial_force.sel(roller="C")[0]) == pytest.approx(f * 150 / 300, rel=1e-12)
    front = f * 150 / 300
    assert -float(ds.radial_force.sel(roller="A")[0]) == pytest.approx(front / 2 + f * 10 / 100, rel=1e-12)
    assert -float(ds.radial_force.sel(roller="B")[0]) == pytest.approx(front / 2 - f * 10 / 100, rel=1e-12)


def test_two_rollers_press_against_two_others_with_their_preload():
    ds = solved(shuttle(mass={"value": 0, "at": [0, 0, 0]}, payloads=[], cases=[{"name": "none"}]))
    assert np.allclose(ds.radial_force, -1000, rtol=1e-12)
    assert np.all(ds.axial_force == 0)


def sums(values):
    """Return what is left of the forces and moments of each load case, over the largest force."""
    whole, ds = load_carriage(values), solved(values)
    left = []
    for i, case in enumerate(whole.cases):
        rest = wrenches_of(whole, case).all
        for j, roller in enumerate(whole.rollers):
            force = roller.pushes * float(ds.radial_force[i, j]) - roller.axis * float(ds.axial_force[i, j])
            rest = rest + np.concatenate([force, np.cross(roller.at, force)])
        left.append(np.abs(rest).max())
    return np.array(left) / float(np.abs(ds.radial_force).max()) / 150


HARD = [
    {"name": "all", "share": 1, "acceleration": 1.5, "speed": 1, "curve_radius": "-3 m", "gradient": "4 %"}
    | {"cant": "-2 deg", "forces": [{"force": [5, 20, -30], "at": [10, 200, 100]}]}
]


@pytest.mark.parametrize("values", [shuttle(), cart(cases=HARD), shuttle(cases=HARD)])
def test_forces_and_moments_add_up_to_nothing(values):
    assert sums(values).max() < 1e-12


def test_hand_sums_of_a_curve():
    """In a left curve the inertia v^2/R pushes to the right; the left rollers, outside their rail, hold it."""
    ds = solved(shuttle(payloads=[], rollers=rollers_between(stiffness=1e4)))
    lateral = 40 * 1.0**2 / 1.5
    left, right = (float(ds.radial_force.sel(load_case="curve", roller=f"F{side}")) for side in "LR")
    assert right - left == pytest.approx(lateral / 2, rel=1e-9)
    assert left == pytest.approx(-1000 - lateral / 4, rel=1e-9)
    assert float(ds.drive_force.sel(load_case="start")) == pytest.approx(80, rel=1e-12)


def test_each_mass_has_its_own_radius():
    beside = cart(mass={"value": 40, "at": [0, 30, 0]}, cases=[{"name": "c", "speed": 1, "curve_radius": "1.5 m"}])
    lateral = -40 * 1.0 * (1.5 - 0.03) / 1.5**2
    assert float(solved(beside).axial_force.sum()) == pytest.approx(lateral, rel=1e-12)


def test_gradient_and_cant():
    ds = solved(
        cart(cases=[{"name": "up", "share": 0.5, "gradient": "10 %"}, {"name": "tilt", "share": 0.5, "cant": "3 deg"}])
    )
    assert float(ds.drive_force[0]) == pytest.approx(40 * G * math.sin(math.atan(0.1)), rel=1e-12)
    assert float(ds.axial_force[1].sum()) == pytest.approx(40 * G * math.sin(math.radians(3)), rel=1e-12)
    assert float(-ds.radial_force[0].sum()) == pytest.approx(40 * G * math.cos(math.atan(0.1)), rel=1e-12)


def mirrored(values):
    """Return a carriage seen in a mirror between left and right; the axes keep their own directions."""

    def flip(vector):
        return [vector[0], -vector[1], vector[2]]

    out = values | {"mass": values["mass"] | {"at": flip(values["mass"]["at"])}}
    out["payloads"] = [one | {"at": flip(one["at"])} for one in values.get("payloads", [])]
    rollers = values["rollers"]
    out["rollers"] = {n: r | {key: flip(r[key]) for key in ("at", "pushes", "x_R")} for n, r in rollers.items()}
    out["cases"] = [
        {key: f"-{v}" if key == "curve_radius" else v for key, v in case.items()} for case in values["cases"]
    ]
    return out


def test_cant_balances_a_curve():
    """Where tan(cant) = v^2/(g R), nothing presses sideways, and the rollers carry m sqrt(g^2 + (v^2/R)^2)."""
    speed, radius = 3.0, 2.0  # m/s, m
    sideways = speed**2 / radius
    curve = {"name": "curve", "speed": speed, "curve_radius": f"{radius} m", "cant": f"{100 * sideways / G} %"}
    ds = solved(cart(cases=[curve], mass={"value": 40, "at": [0, 0, 0]}))
    assert np.allclose(ds.radial_force, -10 * math.hypot(G, sideways), rtol=1e-12)
    assert np.allclose(ds.axial_force, 0, atol=1e-9)


def test_a_tilted_mass_has_its_horizontal_radius():
    """A mass 500 mm above the origin moves inward by 500 sin(cant)."""
    curve = {"name": "curve", "speed": 1, "curve_radius": "2 m", "cant": "30 deg", "share": 1}
    whole = load_carriage(cart(cases=[curve], mass={"value": 1, "at": [0, 0, 500]}))
    force = wrenches_of(whole, whole.cases[0]).all[:3]
    sideways = (2 - 0.25) / 2**2
    across, up = G / 2 - sideways * math.cos(math.pi / 6), -G * math.cos(math.pi / 6) - sideways / 2
    assert force == pytest.approx([0, across, up], abs=1e-12)


def test_a_missing_stiffness_may_decide_which_roller_lifts():
    """Three loaded rollers are determinate, but a soft roller in a corner makes the opposite one lift."""
    rollers = rollers_below()
    for name in ("FR", "RR"):
        rollers[name]["kind"] = "floating"
    del rollers["FL"]["roller"]
    with pytest.raises(InputError, match=r"rollers\.FL\.roller is missing"):
        solved(cart(rollers=rollers, mass={"value": 40, "at": [10, 5, 60]}))


def test_a_counter_roller_that_lifts_needs_no_stiffness():
    down, up = {"pushes": [0, 0, -1], "x_R": [0, 1, 0]}, {"pushes": [0, 0, 1], "x_R": [0, 1, 0], "kind": "floating"}
    places = {"A": [200, 50, 0], "B": [200, -50, 0], "C": [-100, 0, 0]}
    rollers = {n: {"at": at, **down, "kind": "floating" if n == "B" else "locating"} for n, at in places.items()}
    ds = solved(cart(mass={"value": 60, "at": [50, 10, 70]}, rollers=rollers | {"D": {"at": [50, 10, -40], **up}}))
    assert float(ds.radial_force.sel(roller="D")[0]) == 0
    assert -float(ds.radial_force.sel(roller="C")[0]) == pytest.approx(30 * G, rel=1e-12)


def test_an_axial_force_of_rounding_is_none():
    ds = solved(cart(mass={"value": 40, "at": [30, 10, 60]}))
    assert np.all(ds.axial_force == 0)


def test_a_mirrored_vehicle_has_mirrored_loads():
    values = shuttle(payloads=[{"value": 60, "at": [80, 15, 150]}])
    here, there = solved(values), solved(mirrored(values))
    assert np.allclose(here.radial_force, there.radial_force, rtol=1e-9)
    assert np.allclose(here.axial_force, there.axial_force, rtol=1e-9)  # x_R is upright: no sign changes


def test_twice_the_mass_is_twice_the_load():
    one, two = (
        solved(cart(mass={"value": m, "at": [20, 5, 60]}, rollers=rollers_below(stiffness=1e4))) for m in (40, 80)
    )
    assert np.allclose(2 * one.radial_force, two.radial_force, rtol=1e-12)


def test_the_order_of_rollers_does_not_matter():
    values = shuttle(payloads=[{"value": 60, "at": [80, 15, 150]}])
    other = solved(values | {"rollers": dict(reversed(values["rollers"].items()))})
    for name in ("radial_force", "axial_force"):
        assert np.allclose(solved(values)[name], other[name].sel(roller=solved(values).roller), rtol=1e-9)


def test_stiff_springs_give_the_determinate_forces():
    """One of four rollers a million times softer than the others leaves three, which are determinate."""
    rollers = rollers_below(stiffness=1e10)
    rollers["RR"]["stiffness"] = 1e4
    four = solved(cart(mass={"value": 40, "at": [0, 20, 60]}, rollers=rollers))
    rollers.pop("RR")
    three = solved(cart(mass={"value": 40, "at": [0, 20, 60]}, rollers=rollers))
    assert np.allclose(four.radial_force.sel(roller=["FL", "FR", "RL"]), three.radial_force, rtol=1e-5)


def test_contacts_in_series_with_soft_springs_share_like_the_springs():
    soft = solved(cart(mass={"value": 40, "at": [20, 5, 60]}, rollers=rollers_below(structure=1.0)))
    springs = solved(cart(mass={"value": 40, "at": [20, 5, 60]}, rollers=rollers_below(stiffness=1.0)))
    assert np.allclose(soft.radial_force, springs.radial_force, rtol=1e-4)


@pytest.mark.parametrize("lateral", [0.0, 30.0, 60.0])
@pytest.mark.parametrize("more", [{}, {"stiffness": 2e4}, {"structure": 3e3}])
def test_one_sided_contact_has_the_least_energy(lateral, more):
    """A general minimiser finds the same forces of radial springs, in cases in which rollers lift too."""
    rollers = rollers_below(**more) | {
        f"S{i}": {
            "at": [x, y, -20],
            "pushes": [0, -1 if y > 0 else 1, 0],
            "x_R": [0, 0, 1],
            "kind": "floating",
            "roller": {},
        }
        for i, (x, y) in enumerate(SIDES.values())
    }
    for name in SIDES:
        rollers[name]["kind"] = "floating"
    rollers["S0"]["kind"] = "locating"
    rollers["S0"]["stiffness"] = {"radial": 1e4, "axial": 1e-9}  # its axial spring is there, and carries nothing
    force = {"force": [0, lateral, 0], "at": [40, 0, 150]}
    mass = {"value": 40, "at": [100, 0, 60]}
    whole = load_carriage(cart(mass=mass, rollers=rollers, cases=[{"name": "push", "forces": [force]}]))
    springs = springs_of(whole)
    wrench = wrenches_of(whole, whole.cases[0]).all
    reduced = np.concatenate([wrench[1:3], wrench[3:] / springs.length])
    found = equilibrium(springs, reduced)

    def energy(place):
        approach = springs.offset + springs.radial @ place
        force, _ = springs.force(approach)
        return 1e3 * (springs.energy(approach, force) - reduced @ place), 1e3 * (springs.radial.T @ force - reduced)

    best = minimize(energy, found.start * 0.5, jac=True, method="BFGS", options={"gtol": 1e-7, "maxiter": 5000})
    force, _ = springs.force(springs.offset + springs.radial @ best.x)
    assert np.allclose(force, found.radial, atol=1e-3 * force.max())
    assert (lateral < 60) or (found.radial[:4] == 0).any()


def sharing(lateral=0.0, structure=None):
    """Return a carriage whose eight rollers share the axial load."""
    more = {} if structure is None else {"structure": structure}
    below = {f"D{name}": one for name, one in rollers_below(**more).items()}
    push = {"name": "push", "forces": [{"force": [0, lateral, 0], "at": [60, 0, 80]}]}
    return shuttle(rollers=rollers_between(**more) | below, payloads=[{"value": 20, "at": [30, 10, 50]}], cases=[push])


@pytest.mark.parametrize("structure", [None, 3e4])
@pytest.mark.parametrize("lateral", [0.0, 900.0, 3000.0])
def test_axial_stiffness_belongs_to_the_radial_force(lateral, structure):
    whole = load_carriage(sharing(lateral, structure))
    springs, wrench = springs_of(whole), wrenches_of(whole, whole.cases[0]).all
    found = equilibrium(springs, np.concatenate([wrench[1:3], wrench[3:] / springs.length]))
    assert found.converged
    radial, _ = springs.force(springs.offset + springs.radial @ found.start)
    assert np.allclose(found.radial, radial, atol=1e-7 * radial.max())
    pressed = found.loaded & springs.locating
    slide = (springs.axial @ found.start)[pressed]
    stiffness = springs.axial_stiffness(np.maximum(radial, 1e-3))[pressed]
    assert np.allclose(found.axial[pressed], stiffness * slide, rtol=1e-6, atol=1e-4)
    assert np.all(found.axial[~pressed] == 0)


def test_newton_s_method_ends_where_the_passes_end(monkeypatch):
    quick = solved(sharing(900.0))
    monkeypatch.setattr(statics, "NEWTON", ())
    slow = solved(sharing(900.0))
    for name in ("radial_force", "axial_force"):
        assert np.allclose(quick[name], slow[name], rtol=1e-7, atol=1e-6)


def test_the_slope_of_the_axial_stiffness():
    springs, force = springs_of(load_carriage(sharing(structure=3e4))), np.full(8, 500.0)
    slope = (springs.axial_stiffness(force + 0.01) - springs.axial_stiffness(force - 0.01)) / 0.02
    assert np.allclose(springs.axial_slope(force), slope, rtol=1e-6)


def test_forces_that_do_not_settle_are_told(monkeypatch):
    assert solved(sharing(900.0)).converged.values.tolist() == [True]
    monkeypatch.setattr(statics, "MOST_PASSES", 1)
    monkeypatch.setattr(statics, "_searched", lambda *args: None)
    ds = solve_carriage(sharing(900.0), lives=False)
    assert ds.radial_force.isnull().all() and ds.axial_force.isnull().all()
    assert ds.converged.values.tolist() == [False]
    answer = answer_of_carriage(ds)
    assert answer.kind == "unsettled" and "push are not known" in headline(answer)
    assert part_of(answer, "cases")["settled"].tolist() == ["no"]
    assert math.isnan(ds.loads_to_lift_off[0]) and part_of(answer, "cases")["loads_lift_off"].isna().all()


def test_margins_of_a_cart():
    """A payload outside the wheelbase tips a cart where the moment about the front rollers vanishes."""
    values = cart(payloads=[{"value": 10, "at": [250, 0, 50]}], rollers=rollers_below(stiffness=1e4))
    ds = solve_carriage(values, lives=False)
    assert float(ds.payload_to_tipping[0]) == pytest.approx(40 * 150 / (10 * 100), rel=1e-6)
    assert float(ds.payload_to_lift_off[0]) == pytest.approx(6.0, rel=1e-6)
    assert float(ds.loads_to_lift_off[0]) == math.inf


def test_margin_to_one_contact():
    """A front roller has the axial force F/4 + F/2 (x/wheelbase); its preload bears up to F_rad tan(alpha)."""
    ds = solve_carriage(shuttle(cases=[{"name": "run"}]), lives=False)
    bears = 1000 * math.tan(math.radians(30))
    assert float(ds.loads_to_one_contact[0]) == pytest.approx(bears / (100 * G * (0.25 + 24 / 300)), rel=1e-6)
    payload = G * (0.25 + 40 / 300)  # N per kg of payload, 80 mm in front
    assert float(ds.payload_to_one_contact[0]) == pytest.approx((bears - 10 * G) / (60 * payload), rel=1e-6)
    first, second = answer_of_carriage(ds).headline["margins"]
    assert (first["of"], first["end"], first["case"]) == ("payload", "one contact", "run")
    assert (first["times"], second["times"]) == (float(ds.payload_to_one_contact[0]), float(ds.loads_to_one_contact[0]))


def test_preload_lifts_off_at_its_own_multiplier():
    """Linear pairs share a lateral force by half until one roller of each pair lifts, at twice the preload."""
    push = {"name": "push", "forces": [{"force": [0, 500, 0], "at": [0, 0, 0]}]}
    below = {
        name.replace("F", "f").replace("R", "r"): one
        for name, one in rollers_below(stiffness=1e4, kind="floating").items()
    }
    values = shuttle(payloads=[], rollers=rollers_between(stiffness=1e4) | below, cases=[push])
    values["preload"] = [{"pair": [f"{end}L", f"{end}R"], "force": 400} for end in "FR"]
    values["mass"]["at"] = [0, 0, 0]
    ds = solve_carriage(values, lives=False)
    assert float(ds.loads_to_lift_off[0]) == pytest.approx(2 * 2 * 400 / 500, rel=1e-3)


def test_play_leaves_a_roller_without_load():
    values = shuttle(
        rollers=rollers_between(stiffness=1e4) | {"D" + n: r for n, r in rollers_below(stiffness=1e4).items()}
    )
    values["preload"] = [{"pair": ["FL", "FR"], "play": 0.5}, {"pair": ["RL", "RR"], "play": "500 um"}]
    ds = solved(values)
    assert np.all(ds.radial_force.sel(roller=["FL", "FR", "RL", "RR"]) == 0)
    assert float(ds.approach.sel(load_case="run", roller="FL")) == pytest.approx(-0.25, abs=1e-3)


def test_a_roller_without_load_is_told_with_its_cause():
    """Only a roller of a pair with play is told that its play is larger than the deflection."""
    values = shuttle(
        rollers=rollers_between(stiffness=1e4) | {"D" + n: r for n, r in rollers_below(stiffness=1e4).items()}
    )
    values["preload"] = [{"pair": ["FL", "FR"], "play": 0.5}]
    texts = [caution.where for caution in answer_of_carriage(solve_carriage(values, lives=False)).warnings]
    (of_pair,) = [text for text in texts if "without load in any case: FL" in text]
    assert "the play is larger than the deflection" in of_pair
    rollers = {"FL": [200, 50, 0], "FR": [200, -50, 0], "RL": [-200, 50, 0], "up": [0, 0, -40]}
    made = {n: {"at": at, "pushes": [0, 0, -1], "x_R": [0, 1, 0], "stiffness": 1e4} for n, at in rollers.items()}
    made["up"]["pushes"] = [0, 0, 1]
    values = cart(rollers=made, mass={"value": 40, "at": [60, 10, 60]})
    texts = [caution.where for caution in answer_of_carriage(solve_carriage(values, lives=False)).warnings]
    assert "without load in any case: up; a preload presses them on" in texts


def test_a_maker_s_example_of_the_load_factor():
    """Axial 300 lb and radial 100 lb on one wheel: load factor 0.38, and 124.7 million inches."""
    pound, inches = 4.4482216, 1e6 * 25.4e-6
    roller = load_carriage(
        cart(
            rollers=rollers_below(
                catalogue={"radial_force": 9700, "axial_force": 4000, "basic_life": 6.84 * inches}
                | {"law": "lubricated", "offset": 0}
            )
        )
    ).rollers[0]
    factor = float(roller.catalogue.load_factor(100 * pound, -300 * pound))
    assert factor == pytest.approx(0.38, abs=0.005)
    assert float(roller.catalogue.life(0.38)) / inches == pytest.approx(124.7, abs=0.1)


@pytest.mark.parametrize(("law", "power"), [("dry", 2), ("lubricated", 3)])
def test_catalogue_lives(law, power):
    catalogue = {"radial_force": "1 kN", "axial_force": "400 N", "basic_life": "100 km", "law": law}
    ds = solved(cart(rollers=rollers_below(catalogue=catalogue)))
    factor = 10 * G / 1000
    assert np.allclose(ds.load_factor, factor)
    assert np.allclose(ds.catalogue_life_km, 100 / (0.03 + 0.97 * factor) ** power)


def test_a_catalogue_with_factors():
    catalogue = {"radial_force": "1 kN", "axial_force": "400 N", "basic_life": "100 km", "law": "cubic"}
    catalogue |= {"exponent": 2.5, "speed_factor": 0.6, "stroke_factor": 0.8}
    ds = solved(cart(rollers=rollers_below(catalogue=catalogue)))
    factor = 10 * G / 1000 / 0.8
    assert np.allclose(ds.load_factor, factor)
    assert np.allclose(ds.catalogue_life_km, 0.6 * 100 / factor**2.5)


def test_margins_beyond_one_contact_are_not_stated():
    """The model of a roller on both contacts ends where an axial force lifts one of them."""
    ds = solve_carriage(shuttle(cases=[{"name": "run"}]), lives=False)
    assert float(ds.payload_to_one_contact[0]) < float(ds.payload_to_lift_off[0])
    answer = answer_of_carriage(ds)
    assert [one["end"] for one in answer.headline["margins"]] == ["one contact", "one contact"]
    row = part_of(answer, "cases").iloc[0]
    later = [f"{part}_{end}" for part in ("payload", "loads") for end in ("lift_off", "tipping")]
    assert row[later].isna().all() and row["payload_one_contact"] == float(ds.payload_to_one_contact[0])


def vehicle(rng):
    """Return a random carriage with linear springs: side guides, with or without load wheels and hold-down rollers."""
    x, y = rng.uniform(80, 300), rng.uniform(30, 150)
    layout = rng.choice(["s", "sd", "sdu"])
    rollers = {}
    for name, (front, left) in {"FL": (1, 1), "FR": (1, -1), "RL": (-1, 1), "RR": (-1, -1)}.items():
        made = {
            "s": {"at": [front * x, left * y, 0], "pushes": [0, -left, 0], "x_R": [0, 0, 1]},
            "d": {"at": [front * x, left * y, -20], "pushes": [0, 0, -1], "x_R": [0, 1, 0]},
            "u": {"at": [front * x, left * y, -60], "pushes": [0, 0, 1], "x_R": [0, 1, 0]},
        }
        for group in layout:
            locating = layout == "s" or rng.random() < 0.5
            stiffness = {"radial": 10 ** rng.uniform(4, 5.5), "axial": 10 ** rng.uniform(3.5, 5.5)}
            kind = "locating" if locating else "floating"
            rollers[group + name] = made[group] | {"kind": kind, "stiffness": stiffness}
    preload = [{"pair": [f"s{end}L", f"s{end}R"], "force": float(rng.uniform(0, 600))} for end in "FR"]
    force = {
        "force": rng.uniform([-200, -600, -400], [200, 600, 200]).tolist(),
        "at": rng.uniform([-x, -y, -50], [x, y, 150]).tolist(),
    }
    values = cart(rollers=rollers, cases=[{"name": "push", "forces": [force]}])
    values["mass"]["at"] = rng.uniform([-x, -y, -50], [x, y, 100]).tolist()
    return values | ({"preload": preload} if rng.random() < 0.5 else {})


def carrying_sets(springs, wrench):
    """Return the forces of each set of carrying rollers that its least complementary energy confirms."""
    n, size = len(springs.radial), max(np.abs(wrench).max(), springs.force(springs.offset)[0].max())
    locating = np.flatnonzero(springs.locating)
    confirmed = []
    for number in range(2 ** len(locating)):
        own = [place for k, place in enumerate(locating) if number >> k & 1]
        compliance = np.concatenate([springs.radial_compliance, springs.axial_compliance[own]])
        unloaded = np.concatenate([springs.offset / springs.radial_compliance, np.zeros(len(own))])
        columns = np.vstack([springs.radial, springs.axial[own]]).T
        root = np.sqrt(compliance / compliance.mean())
        rows, right = np.vstack([np.diag(root), 1e5 * columns]), np.concatenate([root * unloaded, 1e5 * wrench])
        least = np.concatenate([np.zeros(n), np.full(len(own), -np.inf)])
        forces = lsq_linear(rows, right, (least, np.inf), tol=1e-14, method="bvls", max_iter=500).x
        balanced = np.abs(columns @ forces - wrench).max() <= 1e-6 * size
        if balanced and (springs.locating & (forces[:n] > 1e-7 * size)).nonzero()[0].tolist() == own:
            confirmed.append(forces[:n])
    return confirmed


def reduced(whole, springs):
    wrench = wrenches_of(whole, whole.cases[0]).all
    return np.concatenate([wrench[1:3], wrench[3:] / springs.length])


def test_random_vehicles_have_the_forces_of_a_set_that_the_least_energy_confirms():
    """Every carrying set is tried by another method: its complementary energy, with the forces as unknowns."""
    rng = np.random.default_rng(3)
    settled = refused = open_ = searched = 0
    for _ in range(300):
        whole = load_carriage(vehicle(rng))
        springs = springs_of(whole)
        wrench = reduced(whole, springs)
        try:
            found = equilibrium(springs, wrench)
        except statics.Moves:
            refused += 1
            assert not carrying_sets(springs, wrench)
            continue
        if not found.converged:
            open_ += 1
            assert not carrying_sets(springs, wrench)
            continue
        settled += 1
        size = max(np.abs(wrench).max(), found.radial.max())
        assert np.abs(springs.radial.T @ found.radial + springs.axial.T @ found.axial - wrench).max() < 1e-9 * size
        assert (found.radial >= 0).all() and not found.axial[~(springs.locating & found.loaded)].any()
        try:
            quick = equilibrium(springs, wrench, thorough=False).converged
        except statics.Moves:
            quick = False
        if not quick:
            searched += 1
            sets = carrying_sets(springs, wrench)
            assert min(np.abs(forces - found.radial).max() for forces in sets) < 1e-4 * size
    assert settled > 150 and refused > 20 and open_ > 0 and searched > 0


def test_a_vehicle_without_a_consistent_set_has_no_forces_and_no_lives():
    """No set of carrying rollers is consistent here: each locating wheel lifts if it carries, and not otherwise."""
    guides = rollers_between(stiffness=1e5, kind="floating")
    wheels = rollers_below(stiffness=1e5)
    for name, (x, y) in SIDES.items():
        place = [x, math.copysign(100, y), 0]
        guides[name]["at"] = place
        wheels[name] |= {"at": [*place[:2], -20], "kind": "locating" if y > 0 else "floating"}
    rollers = {"g" + name: one for name, one in guides.items()} | {"v" + name: one for name, one in wheels.items()}
    for name in SIDES:
        up = {"at": [*wheels[name]["at"][:2], -60], "pushes": [0, 0, 1], "kind": "floating"}
        rollers["u" + name] = wheels[name] | up
    force = {"force": [0, -585, -293], "at": [-48, 0, 112]}
    cases = [{"name": "side", "speed": 1, "forces": [force]}]
    values = {"name": "cart", "mass": {"value": 40, "at": [76, 29, -35]}, "rollers": rollers, "cases": cases}
    ds = solve_carriage(values)
    assert not ds.converged.any() and ds.radial_force.isnull().all() and ds.life_km.isnull().all()
    assert ds.attrs["worst_roller"] == ""
    answer = answer_of_carriage(ds)
    assert "not known" in headline(answer) and "more preload helps" in headline(answer)
    assert any("More preload helps" in caution.where for caution in answer.warnings)
    whole = load_carriage(values)
    assert not carrying_sets(springs_of(whole), reduced(whole, springs_of(whole)))
    preload = [{"pair": [f"g{end}L", f"g{end}R"], "force": 600} for end in "FR"]
    for one in guides:
        rollers["g" + one]["kind"] = "locating"
    assert solved(values | {"preload": preload}).converged.all()  # what the message advises
    with pytest.raises(InputError, match="fulfil all conditions"):
        study_of(whole, forces_of(whole), "loads.csv")
