"""Friction laws: their mappings, and sliding and the exact theory under them."""

import json
import math

import numpy as np
import pytest
import xarray as xr
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.contact.friction_laws import constant, exponential_falling, law_of, linear_falling, table
from trackroller.contact.hertz import HertzShape
from trackroller.contact.models import contact_model
from trackroller.contact.quantities import Elastic, Ellipse, Resultants
from trackroller.contact.sliding import integrals
from trackroller.contact.slip import Slip
from trackroller.errors import InputError
from trackroller.parameters.accuracy import PRESETS
from trackroller.roller.case import to_table
from trackroller.roller.dataset import validity_bit
from trackroller.roller.equilibrium import RollerLoads, solve_equilibrium
from trackroller.study.file.load import parse_study

MAPPINGS = [
    {"kind": "constant"},
    {"kind": "linear", "speed": 100.0, "lowest": 0.5},
    {"kind": "exponential", "speed": 30.0},
    {"kind": "table", "speed": [0, 10, 100], "friction": [0.3, 0.35, 0.2]},
]


@pytest.mark.parametrize("mapping", MAPPINGS, ids=lambda m: m["kind"])
def test_a_law_survives_its_mapping_and_its_text(mapping):
    """Mapping -> law -> mapping -> law and JSON -> law give equal laws."""
    law = law_of(mapping)
    for again in (law_of(law.as_dict()), law_of(json.dumps(law.as_dict())), law_of(law)):
        assert again.as_dict() == law.as_dict()
        np.testing.assert_array_equal(again.knots, law.knots)


def test_laws_of_the_mapping_are_those_of_the_functions():
    for law in (law_of(None), constant(), law_of("constant"), linear_falling(10.0, 1.0)):
        assert law.is_constant and law.as_dict() == {"kind": "constant"}
    made = linear_falling(100, 0.5), exponential_falling(30.0, 0.4), table([0, 10, 100], [0.3, 0.35, 0.2])
    for mapping, law in zip(MAPPINGS[1:], made, strict=True):
        np.testing.assert_array_equal(law_of(mapping).knots, law.knots)
    np.testing.assert_allclose(table([0, 1], [3, 2]).factor, [1, 2 / 3])  # only ratios count
    np.testing.assert_allclose(law_of(MAPPINGS[1])([0, 50, 100, 1e6]), [1, 0.75, 0.5, 0.5])
    speeds = np.linspace(0, 300, 777)
    np.testing.assert_allclose(law_of(MAPPINGS[2])(speeds), 0.4 + 0.6 * np.exp(-speeds / 30), atol=1e-4)


@pytest.mark.parametrize(
    ("mapping", "names"),
    [
        ({"kind": "expnential", "speed": 3}, ("friction_law.kind", "exponential")),
        ({"speed": 3}, ("friction_law.kind", "constant, linear")),
        ({"kind": "linear"}, ("friction_law.speed", "needs speed")),
        ({"kind": "linear", "speed": -1}, ("friction_law.speed", "> 0")),
        ({"kind": "linear", "speed": "fast"}, ("friction_law.speed", "fast")),
        ({"kind": "linear", "speed": 1, "lowest": 2}, ("friction_law.lowest", "[0, 1]")),
        ({"kind": "linear", "speed": 1, "slope": 2}, ("friction_law.slope", "lowest")),
        ({"kind": "table", "speed": [0, 1], "friction": [1]}, ("friction_law.friction", "[1.0]", "as many")),
        ({"kind": "table", "speed": [1, 2], "friction": [1, 1]}, ("friction_law.speed", "rise from 0")),
        ({"kind": "table", "speed": [0, 1], "friction": [0, 1]}, ("friction_law.friction", "the first > 0")),
        ({"kind": "table", "speed": [0, "x"], "friction": [0, 1]}, ("friction_law.speed", "'x'", "numbers")),
        ({"kind": "table", "speed": [0, 5], "friction": [0.2, "a"]}, ("friction_law.friction", "'a'", "numbers")),
        ({"kind": "table", "speed": [0, 5], "friction": 0.2}, ("friction_law.friction", "0.2", "a list")),
        ({"kind": "table", "speed": [], "friction": []}, ("friction_law.speed", "[]", "a list")),
        (7, ("friction_law", "mapping")),
        ("{broken", ("friction_law", "JSON")),
    ],
)
def test_wrong_laws_are_refused_by_name(mapping, names):
    with pytest.raises(InputError) as caught:
        law_of(mapping)
    assert all(name in str(caught.value) for name in names), str(caught.value)


STEEL = Elastic.of_pair(210e3, 0.33, 210e3, 0.33)
ONE = np.ones(1)
PATCH = Ellipse(0.3 * ONE, 0.18 * ONE, 700.0 * ONE)
LAWS = {
    "linear": linear_falling(60.0, 0.3),
    "exponential": exponential_falling(20.0, 0.4),
    "table": table([0, 5, 20, 80], [0.3, 0.33, 0.2, 0.1]),
}
TRAVEL = 1000.0  # mm/s


def slip_of(angle: float, shift: float) -> Slip:
    return Slip(np.sin(angle) * ONE, np.cos(angle) * ONE, 6.0 * ONE, 16.5 * ONE, shift * ONE)


def models(law, names=("sliding", "kalker")):
    elastic = Elastic(*(np.atleast_1d(v) for v in (STEEL.shear_modulus, STEEL.poisson_ratio, STEEL.coupling)))
    return {name: contact_model(name, PRESETS["standard"], elastic, law=law, travel_speed=TRAVEL) for name in names}


def resultants_of(model, slip, mu=0.3):
    r = model.law(PATCH, slip, np.array([mu]), np.zeros(1, int), True)
    return np.array([r.lateral_force[0], r.driving_force[0], r.spin_moment[0]])


@pytest.mark.parametrize("name", LAWS)
def test_uniform_slip_has_the_friction_of_its_speed(name):
    """No spin, all slides at v = V r_Delta0/r_A: F_A = -mu f(v) F_N for every model."""
    law = LAWS[name]
    slip = slip_of(1e-6, 0.6)
    expected = -0.3 * law(TRAVEL * 0.6 / 16.5) * PATCH.normal_force[0]
    for kind, model in models(law).items():
        # the profile's curvature adds slip to the sliding model, elasticity to the others
        assert resultants_of(model, slip)[1] == pytest.approx(expected, rel=5e-3), kind


def test_drilling_under_a_linear_law_is_a_closed_integral():
    """Spin alone on a circle: M = mu p_max int sqrt(1-r^2) (1 - c r) r dA = mu p_max a^3 2 pi (pi/16 - 2 c/15)."""
    circle = Ellipse(0.2 * ONE, 0.2 * ONE, 700.0 * ONE)
    sine, radius = np.sin(0.5), 16.5
    fastest = TRAVEL * sine / radius * 0.2
    law = linear_falling(4.0 * fastest, 0.2)
    slope = 0.8 / 4.0
    # a flat guide, so that the slip is a plain rotation
    slip = Slip(sine * ONE, np.cos(0.5) * ONE, 1e9 * ONE, radius * ONE, 0.0 * ONE)
    found = integrals(
        circle, slip, 0.3 * ONE, law=law, travel_speed=TRAVEL, spin_model="concentric", nodes=12
    ).resultants
    expected = 0.3 * 700 * 0.2**3 * 2 * np.pi * (np.pi / 16 - slope * 2 / 15)
    assert abs(found.spin_moment[0]) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("name", LAWS)
def test_sliding_integrals_converge(name):
    """12 nodes against 48, pole inside and outside the patch: 3e-5 of mu F_N."""
    rng = np.random.default_rng(2)
    n = 40
    a, b, angle = np.exp(rng.uniform(-2.5, 0, n)), np.exp(rng.uniform(-2.5, 0, n)), rng.uniform(0.2, 1.3, n)
    ellipse = Ellipse(a, b, np.ones(n))
    slip = Slip(np.sin(angle), np.cos(angle), np.full(n, 6.0), np.full(n, 16.0), rng.uniform(-0.6, 0.6, n) * a)
    low, high = (
        integrals(ellipse, slip, np.full(n, 0.3), law=LAWS[name], travel_speed=TRAVEL, nodes=k) for k in (12, 48)
    )
    for part in ("lateral_force", "driving_force", "spin_moment"):
        scale = 0.3 * ellipse.normal_force * (np.maximum(a, b) if part == "spin_moment" else 1.0)
        assert np.max(np.abs(getattr(low.resultants, part) - getattr(high.resultants, part)) / scale) < 3e-5
    np.testing.assert_allclose(low.power, high.power, rtol=1e-4)


def test_constant_laws_are_the_same_to_the_last_bit():
    """No law, kind constant and a fall to 1.0 give identical numbers with every model."""
    slip = slip_of(0.5, -0.06)
    for kind in ("sliding", "kalker"):
        laws = (None, constant(), linear_falling(9.0, 1.0))
        found = [resultants_of(models(law, (kind,))[kind], slip) for law in laws]
        assert np.array_equal(found[0], found[1]) and np.array_equal(found[0], found[2]), kind


def test_a_law_that_hardly_falls_is_nearly_constant():
    """Continuity at lowest = 1, where sliding changes its quadrature."""
    slip = slip_of(0.5, -0.06)
    for kind in ("sliding", "kalker"):
        a, b = (resultants_of(models(linear_falling(50.0, low), (kind,))[kind], slip) for low in (1.0, 1.0 - 1e-7))
        np.testing.assert_allclose(b, a, rtol=1e-5)


def test_the_deeper_friction_falls_the_smaller_the_spin_moment():
    slip = slip_of(0.5, -0.03)
    for kind in ("sliding", "kalker"):
        moments = [
            abs(resultants_of(models(exponential_falling(20.0, low), (kind,))[kind], slip)[2])
            for low in (1.0, 0.8, 0.5, 0.2)
        ]
        assert np.all(np.diff(moments) < 0), (kind, moments)


@pytest.mark.parametrize("kind", ["sliding", "kalker"])
def test_tractions_have_the_friction_of_their_slip(kind):
    law = LAWS["exponential"]
    t = models(law, (kind,))[kind].surface(PATCH, slip_of(0.5, -0.06), np.array([0.3]), np.zeros(1, int))
    slides = ~t.stick & (t.pressure > 0.2 * 700)
    speed = TRAVEL * np.hypot(t.slip_lateral, t.slip_rolling)[slides]
    share = np.hypot(t.shear_lateral, t.shear_rolling)[slides] / (0.3 * t.pressure[slides])
    np.testing.assert_allclose(share, law(speed), rtol=1e-5)


@pytest.mark.parametrize(("kind", "normal"), [(k, n) for k in ("sliding", "kalker") for n in ("hertz", "halfspace")])
def test_the_largest_shear_is_that_of_the_solution(kind, normal):
    """Where friction falls with the slip, mu p_max is not reached."""
    case = tr.Case(motor_force=0, friction_law={"kind": "exponential", "speed": 5, "lowest": 0.3})
    ds = tr.solve(case, contact_model=kind, normal=normal, outputs=("contact", "tractions"))
    grid = np.hypot(ds.shear_lateral, ds.shear_rolling).max(axis=(1, 2))
    np.testing.assert_allclose(ds.max_shear, grid, rtol=2e-3)
    assert np.all(ds.max_shear < 0.95 * 0.3 * ds.max_pressure)


@pytest.mark.parametrize(
    "law",
    [
        {"kind": "linear", "speed": 3.5, "lowest": 0.5},
        {"kind": "linear", "speed": 2.7, "lowest": 0.5},
        {"kind": "linear", "speed": 1.8, "lowest": 0.5},
        {"kind": "exponential", "speed": 0.5, "lowest": 0.4},
        {"kind": "table", "speed": [0, 2, 20, 200], "friction": [0.3, 0.15, 0.1, 0.25]},
    ],
)
def test_friction_that_falls_steeply_is_solved_and_keeps_its_forces_on_finer_grids(law):
    """Friction by the slip of one element alone would let the slips of neighbours swing against each other."""
    case = tr.Case(motor_force=0, friction_law=law)
    rough, fine = (
        tr.solve(case, contact_model="kalker", accuracy=accuracy, outputs=("forces", "friction_work"))
        for accuracy in ("preview", "standard")
    )
    assert bool(fine.converged) and float(fine.energy_residual) < 1e-3
    scale = float(fine.normal_force.max()) * 0.3
    np.testing.assert_allclose(rough.lateral_force, fine.lateral_force, atol=0.005 * scale)


OUTPUTS = ("forces", "contact", "friction_work", "peak_stress")


@pytest.fixture(scope="module")
def roller():
    falling = {"kind": "exponential", "speed": 20, "lowest": 0.4}
    cases = [
        tr.Case(),
        tr.Case(friction_law={"kind": "constant"}),
        tr.Case(friction_law=falling),
        tr.Case(friction_law=falling, velocity=1e-3),
        tr.Case(friction_law=falling, motor_force=-60),
    ]
    return {kind: tr.solve(cases, outputs=OUTPUTS, contact_model=kind) for kind in ("sliding", "kalker")}


@pytest.mark.parametrize("kind", ["sliding", "kalker"])
def test_laws_in_the_roller(roller, kind):
    """A constant law changes nothing, slow travel little. Falling friction gives more slip and less spin moment."""
    ds = roller[kind]
    assert np.all(ds.converged == 1)
    for name in ("lateral_force", "spin_moment", "rolling_radius_shift", "peak_stress"):
        assert np.array_equal(ds[name][0], ds[name][1])
        # the peak of sliding is found on a grid under a law
        np.testing.assert_allclose(ds[name][3], ds[name][0], rtol=1.5e-2 if name == "peak_stress" else 2e-3)
    assert ds.rolling_radius_shift[2] < ds.rolling_radius_shift[0] < 0
    assert np.all(np.abs(ds.spin_moment[2]) < np.abs(ds.spin_moment[0]))
    if kind == "kalker":
        assert np.all(ds.energy_residual[:4] < 1e-2)


def test_a_motor_force_that_only_slow_slip_can_transmit_is_rolling(roller):
    """30 N lie beyond 0.4 mu F_N, the friction of fast slip, but below mu F_N: a balance at small slip exists."""
    for ds in roller.values():
        assert ds.regime[2] == 0
        np.testing.assert_allclose(ds.driving_force[2].sum(), 30.0, atol=1.5)


def test_complete_slip_has_the_friction_of_high_speed(roller):
    for ds in roller.values():
        assert ds.regime[4] == 1
        np.testing.assert_allclose(ds.driving_force[4], 0.4 * 0.3 * ds.normal_force[4], rtol=1e-4)


NEAR_THE_MOST = dict(
    radial_force=-150,
    axis_distance=20,
    velocity=120,
    contact_angle=35,
    friction_coefficient=0.202,
    axial_force=29.1,
    roller_profile_radius=-7.366,
    motor_force=-14.5,
    friction_law={"kind": "exponential", "speed": 20},
)


@pytest.mark.parametrize("kind", ["sliding", "kalker"])
def test_a_balance_that_the_rough_search_misplaces_is_found(kind):
    """The rough law brackets the balance beside that of the fine law, which has to be searched itself."""
    ds = tr.solve([NEAR_THE_MOST, tr.Case()], contact_model=kind, accuracy="preview", outputs=("forces",))
    assert ds.regime[0] == 0 and ds.converged[0] == 1 and ds.residual[0] < 1e-6
    assert ds.rolling_radius_shift[0] == pytest.approx(-0.09, abs=0.012)
    alone = tr.solve(NEAR_THE_MOST, contact_model=kind, accuracy="preview", outputs=("forces",))
    assert alone.rolling_radius_shift.item() == ds.rolling_radius_shift[0].item()


def test_most_falling_laws_of_a_sample_are_solved():
    """Sliding friction is continuous in the slip, so that the solver must find a solution."""
    rng = np.random.default_rng(20)
    cases = []
    for _ in range(40):
        force, mu = rng.uniform(80, 250), rng.uniform(0.1, 0.35)
        law = {"kind": "exponential", "speed": np.exp(rng.uniform(0, 5.3)), "lowest": rng.uniform(0.2, 0.8)}
        cases.append(
            tr.Case(
                radial_force=-force,
                friction_coefficient=mu,
                velocity=np.exp(rng.uniform(4, 8)),
                motor_force=rng.uniform(-0.6, 0.6) * mu * force,
                friction_law=law,
                axial_force=rng.uniform(-0.25, 0.25) * force,
            )
        )
    ds = solve_sliding(cases, accuracy="preview", outputs=("forces",))
    assert np.all(ds.regime != 3) and np.all(ds.converged == 1)


def limits_of(kind: str, accuracy: str = "preview"):
    """Return the paper's roller, free and driven, without a law and under laws at low, high and rising velocities."""
    falls = {"kind": "exponential", "speed": 20.0, "lowest": 0.5}
    one = {"kind": "table", "speed": [0.0, 5.0, 50.0], "friction": [0.3, 0.3, 0.3]}
    half = 0.5 * tr.Case().friction_coefficient
    drives = [{"motor_force": 0.0}, {"motor_force": -8.0}]
    kinds = [
        {},
        {"friction_law": one},
        *({"friction_law": falls, "velocity": v} for v in (1e-4, 1e7)),
        {"friction_coefficient": half},
    ]
    cases = [tr.Case(**drive, **law) for drive in drives for law in kinds]
    ds = tr.solve(cases, contact_model=kind, accuracy=accuracy, outputs=("forces", "friction_work"))
    assert np.all(ds.regime == 0) and np.all(ds.converged == 1)
    return ds


@pytest.mark.parametrize("kind", ["sliding", "kalker"])
def test_limits_of_falling_friction(kind):
    """Factor 1 is constant friction; slow travel has the friction at rest, fast travel that of the law's end."""
    ds = limits_of(kind, "standard" if kind == "kalker" else "preview")
    for name in ("normal_force", "lateral_force", "driving_force", "spin_moment"):
        values = ds[name].values.reshape(2, 5, 2)
        scale = np.max(np.abs(values[:, 0]), axis=(0, 1))
        np.testing.assert_array_equal(values[:, 1], values[:, 0])
        # sliding integrates by other nodes under a law; at preview they are few
        np.testing.assert_allclose(values[:, 2], values[:, 0], atol=2e-3 * scale, err_msg=f"{name} at rest")
        np.testing.assert_allclose(values[:, 3], values[:, 4], atol=2e-3 * scale, err_msg=f"{name} fast")


@pytest.mark.parametrize("kind", ["sliding", "kalker"])
def test_the_power_of_friction_falls_with_the_velocity_under_a_falling_law(kind):
    """More slip speed, less friction: the dissipation per distance of the free roller falls from rest to the end."""
    law = {"kind": "exponential", "speed": 40.0, "lowest": 0.5}
    cases = [tr.Case(motor_force=0.0, friction_law=law, velocity=v) for v in (1e-3, 20.0, 60.0, 200.0, 1e6)]
    accuracy = "standard" if kind == "kalker" else "preview"
    ds = tr.solve(cases, contact_model=kind, accuracy=accuracy, outputs=("friction_work",))
    energy = ds.friction_energy_per_distance.values.reshape(len(cases), -1).sum(axis=1)
    assert np.all(ds.converged == 1) and np.all(np.diff(energy) < 0), energy
    if kind == "kalker":
        assert np.all(ds.energy_residual < 1e-2)


def test_a_balance_within_a_jump_of_steep_friction_rolls_and_is_not_called_converged():
    """Friction that falls within the elastic slip: the row keeps its numbers, and `residual` tells the jump."""
    law = ContactJump()
    found = solve_equilibrium(law.loads, law)
    assert found.regime[0] == 0 and not found.converged[0]
    assert 1e-5 < found.residual[0] < 1e-2 and np.isfinite(found.shift[0])
    again = solve_equilibrium(law.loads, law)
    assert again.shift[0] == found.shift[0]


class ContactJump:
    """A driving force that falls with the slip and jumps by 0.4 % of what friction can give where it would balance."""

    def __init__(self) -> None:
        angle = np.full(1, 0.7)
        shape = HertzShape(*(np.full(1, v) for v in (0.05, 0.03, 1.5 / (np.pi * 0.05 * 0.03))))
        self.loads = RollerLoads(
            np.full(1, -200.0),
            np.zeros(1),
            np.full(1, -12.0),
            np.full(1, 0.3),
            angle,
            np.full(1, 6.0),
            np.full(1, 16.0),
            shape,
            1e-3,
            1e-7,
            falling=True,
            at_high_speed=0.5,
        )

    def __call__(self, ellipse, slip, friction, rows, fine):
        share = -slip.shift / np.hypot(slip.shift, 0.05)
        share = share + np.where(slip.shift < -0.00774, 4e-3, -4e-3)
        force = friction * ellipse.normal_force
        return Resultants(0.0 * force, force * share, 0.0 * force)


def test_friction_too_steep_for_elastic_surfaces_is_told():
    """mu p_max v max(-df/dv)/G above 1: the bit warns for the elastic models, not for gentle laws or full sliding."""
    steep, gentle = ({"kind": "linear", "speed": v, "lowest": 0.3} for v in (0.02, 200.0))
    bit = validity_bit("steep_friction")

    def marked(law, model):
        found = tr.solve(tr.Case(friction_law=law), contact_model=model, accuracy="preview", outputs="forces")
        return bool(int(found.validity) & bit)

    assert marked(steep, "kalker") and not marked(steep, "sliding")
    assert not marked(gentle, "kalker") and not marked({}, "kalker")
    assert linear_falling(50.0, 0.4).steepest_fall == pytest.approx(0.6 / 50.0)
    assert constant().steepest_fall == table([0, 1], [0.2, 0.3]).steepest_fall == 0.0


@pytest.mark.slow
def test_a_roller_without_balance_for_steep_friction_says_so():
    """Its pressures are unknown; the bit judges by those without friction."""
    steel = "1.7225-normalised"
    lost = tr.Case(
        axis_distance=14.031,
        guide_profile_radius=6.0791,
        roller_profile_radius=-7.4587,
        guide_curve_radius=math.inf,
        contact_angle=65.116,
        radial_force=-150.15,
        axial_force=15.834,
        motor_force=69.865,
        friction_coefficient=0.732,
        velocity=1344.0,
        friction_law={"kind": "linear", "lowest": 0.2, "speed": 100.0},
        roller_material={"like": steel, "youngs_modulus": 150978.0, "poisson_ratio": 0.13595},
        guide_material={"like": steel, "youngs_modulus": 13178.6, "poisson_ratio": 0.24861},
    )
    found = tr.solve(lost, contact_model="kalker", outputs="forces")
    assert int(found.converged) == 0  # several states of stick and slip: what is found is one of them at best
    assert int(found.regime) == 0 or np.isnan(found.normal_force).all()
    assert float(found.residual) > 1e-2 and "steep_friction" in str(found.reason.item())
    assert int(found.validity) & validity_bit("steep_friction")


MEASURED = {"kind": "table", "speed": [0, 20, 100], "friction": [0.15, 0.12, 0.1]}


def test_a_table_holds_as_measured_where_no_friction_coefficient_is_given():
    """A given friction coefficient scales the table, even if it equals the default; other laws keep the default."""
    assert tr.Case(friction_law=MEASURED).friction_coefficient == 0.15
    assert tr.Case.from_dict({"friction_law": {**MEASURED, "friction": [0.15] * 3}}).friction_coefficient == 0.15
    assert tr.Case(friction_law=MEASURED, friction_coefficient=0.3).friction_coefficient == 0.3
    assert tr.Case(friction_law=MAPPINGS[1]).friction_coefficient == tr.Case().friction_coefficient == 0.3
    assert tr.Case(friction_law=MEASURED, friction_coefficient=None).friction_coefficient is None
    with pytest.raises(InputError, match=r"friction_coefficient = 3\.0"):
        tr.Case(friction_law={**MEASURED, "friction": [3, 2, 1]})


def test_tables_of_a_study_and_a_design_hold_as_measured():
    other = {**MEASURED, "friction": [0.2, 0.1, 0.05]}
    data = {"name": "t", "method": "grid", "factors": {"friction_law": {"values": [MEASURED, other, None]}}}
    assert parse_study(data).design()["friction_coefficient"].values.tolist() == [0.15, 0.2, 0.3]
    given = parse_study(data | {"base": {"friction_coefficient": 0.3}}).design()
    assert given["friction_coefficient"].values.tolist() == [0.3, 0.3, 0.3]
    based = parse_study({"name": "t", "base": {"friction_law": MEASURED}}).design()
    assert based["friction_coefficient"].values.tolist() == [0.15]
    design = xr.Dataset({"friction_law": ("case", np.array([json.dumps(MEASURED), ""], dtype=object))})
    assert to_table(design).friction_coefficient.tolist() == [0.15, 0.3]
    with pytest.raises(InputError, match=r"base\.friction_law.*friction_coefficient: 0\.15"):
        parse_study({"name": "t", "base": {"friction_law": {**MEASURED, "friction": [0.15] * 3}}})
