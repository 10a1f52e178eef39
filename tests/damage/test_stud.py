"""The stud that carries the roller: closed forms by hand, quadratures of a beam, endurance, and its messages."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

import trackroller as tr
from trackroller.damage.bearing import BearingLoads
from trackroller.damage.sn_curve import SNCurve
from trackroller.damage.stud import FIELD, deflection, reversed_amplitude, root_loads, root_stress
from trackroller.errors import InputError

QUICK = {"contact_model": "sliding", "accuracy": "preview"}
STEEL = "1.7225-quenched-tempered"
STUD = {"diameter": 10, "length": 18, "material": STEEL, "yield_strength": 900}
ENDURING = STUD | {"load_ratio": 0, "notch_factor": 2, "cycles_per_hour": 30}
CASE = {"radial_force": -800, "axial_force": 100, "motor_force": -40, "friction_coefficient": 0.1}
GROUPS = ("forces", "peak_stress", "life", "stud", "limits")


def column(*values):
    return np.array(values, dtype=float)


def loads(pressing=0.0, driving=0.0, axial=0.0, tilting=0.0, yawing=0.0):
    return BearingLoads(*(column(value) for value in (pressing, driving, axial, tilting, yawing)))


def test_a_cantilever_by_pencil():
    """1000 N at 20 mm on 10 mm: M = 20 N m, W = 98.17 mm3, sigma = 203.7 MPa; 500 N along it: 6.366 MPa more."""
    root = root_loads(loads(pressing=-1000, axial=500), column(20), column(0))
    outer, middle = root_stress(root, column(10))
    assert outer == pytest.approx(203.72 + 6.366, abs=0.01)
    assert middle == pytest.approx(math.hypot(6.366, math.sqrt(3) * 4 / 3 * 1000 / 78.540), rel=1e-4)


def test_moments_of_the_contacts_and_forces_of_both_planes_add_up():
    root = root_loads(loads(-300, 400, 0, -1000, 2000), column(10), column(0))
    assert root.bending == pytest.approx(math.hypot(300 * 10 + 1000, 400 * 10 + 2000)) and root.shear == 500


def test_an_eccentric_collar_twists_the_stud_and_bends_it_by_the_axial_force():
    root = root_loads(loads(pressing=-1000, axial=200), column(20), column(0.75))
    assert root.torque == 750 and root.bending == 20000 + 150
    outer, _ = root_stress(root, column(10))
    sigma = 20150 / (math.pi * 1000 / 32) + 200 / (math.pi * 25)
    twist = 750 / (math.pi * 1000 / 16)  # polar modulus of a circle
    assert outer == pytest.approx(math.sqrt(sigma**2 + 3 * twist**2), rel=1e-14)


def test_shear_of_a_circle_by_the_first_moment_of_half_of_it():
    """Tau = V Q/(I b) at the neutral axis, with Q by quadrature."""
    radius, force = 5.0, 700.0
    first_moment, _ = quad(lambda z: z * 2 * math.sqrt(radius**2 - z**2), 0, radius)
    shear = force * first_moment / (math.pi * radius**4 / 4 * 2 * radius)
    _, middle = root_stress(root_loads(loads(pressing=-force), column(0.001), column(0)), column(2 * radius))
    assert middle == pytest.approx(math.sqrt(3) * shear, rel=1e-12)


def test_a_short_stud_fails_at_its_neutral_axis():
    root = root_loads(loads(pressing=-1000), column(1.0), column(0))
    outer, middle = root_stress(root, column(10))
    assert middle > outer


def test_the_deflection_is_the_energy_of_bending_and_shear():
    """Castigliano: the derivative of the strain energy by force and moment, with shear stresses V Q/(I b)."""
    force, moment, length, diameter, modulus, poisson = 900.0, 4000.0, 22.0, 9.0, 205000.0, 0.29
    radius = diameter / 2
    stiffness = modulus * math.pi * radius**4 / 4
    shear_modulus = modulus / 2 / (1 + poisson)

    def along(x):  # distance from the free end
        return (moment + force * x) * x / stiffness

    by_bending, _ = quad(along, 0, length)
    slope, _ = quad(lambda x: (moment + force * x) / stiffness, 0, length)
    inertia = math.pi * radius**4 / 4

    def energy(z):
        width = 2 * math.sqrt(radius**2 - z**2)
        first_moment = 2 / 3 * (radius**2 - z**2) ** 1.5
        return (first_moment / inertia / width) ** 2 * width

    form, _ = quad(energy, -radius, radius)
    by_shear = force * length * form / shear_modulus
    found = deflection(*map(column, (force, moment, length, diameter, modulus, poisson)))
    assert found[0] == pytest.approx(by_bending + by_shear, rel=1e-9)
    assert found[1] == pytest.approx(slope, rel=1e-12)


def test_mean_stress_by_goodmans_line():
    """A stress from 0 to 200 MPa at R_m = 600: 100/(1 - 100/600) = 120 MPa; reversed 200 MPa stay 200."""
    found = reversed_amplitude(column(200, 200, 200, 1200), column(0, -1, np.nan, 0), column(600, np.nan, 600, 600))
    assert found[:2] == pytest.approx([120, 200]) and np.isnan(found[2]) and np.isinf(found[3])


def test_the_results_of_a_case_by_hand():
    ds = tr.solve(CASE | {"stud": ENDURING}, outputs=GROUPS, **QUICK)
    moment = math.hypot(800 * 18 + abs(ds["tilting_moment"].item()), 40 * 18 + abs(ds["yaw_moment"].item()))
    stress = moment / (math.pi * 1000 / 32) + 100 / (math.pi * 25)
    assert ds["stud_stress"].item() == pytest.approx(stress, rel=1e-12)
    material = tr.load_database().material(STEEL)
    half = stress / 2
    amplitude = 2 * half / (1 - half / material.tensile_strength)
    assert ds["stud_endurance_utilisation"].item() == pytest.approx(amplitude / material.fatigue_limit, rel=1e-12)
    hours = float(SNCurve.of(material).life_cycles(amplitude)) / 30
    assert ds["stud_life_hours"].item() == pytest.approx(hours, rel=1e-12)
    row = ds.sel(limit="stud", body="roller")
    assert row["utilisation"].item() == pytest.approx(stress / 900, rel=1e-12)  # the endurance is a life here
    assert row["life_hours_by_limit"].item() == ds["stud_life_hours"].item()
    assert 0 < ds["stud_deflection"].item() < 0.1 and np.isnan(ds["utilisation"].sel(limit="stud", body="guide"))


@pytest.mark.parametrize("chance, deviates", [(0.1, -1.2815515655446004), (0.01, -2.3263478740408408)])
def test_failures_shift_the_life_of_a_stud_by_its_scatter(chance, deviates):
    """T_N is N_90/N_10, 2.563 standard deviations: the life moves by T_N^(u/2.563) as the line is straight."""
    median, own = (
        tr.solve(CASE | {"stud": ENDURING | {"scatter_in_cycles": 6}}, outputs=GROUPS, failure_probability=p, **QUICK)
        for p in (0.5, chance)
    )
    row = {"limit": "stud", "body": "roller"}
    expected = median["life_hours_by_limit"].sel(row).item() * 6 ** (deviates / 2.5631031310892007)
    for end in ("", "_low", "_high"):
        assert own[f"life_hours_by_limit{end}"].sel(row).item() == pytest.approx(expected, rel=1e-12)
    assert own["stud_life_hours"].item() == median["stud_life_hours"].item()  # the median one, as of the others


def test_a_stud_without_scatter_takes_the_typical_one_with_its_range():
    """From 10 to 50 % failed lie half of T_N in logarithms: 5.2, 10 and 16.1."""
    ds = tr.solve(CASE | {"stud": ENDURING}, outputs=GROUPS, failure_probability=0.1, **QUICK)
    median = ds["stud_life_hours"].item()
    for end, scatter in (("", 10.0), ("_low", 16.1), ("_high", 5.2)):
        life = ds[f"life_hours_by_limit{end}"].sel(limit="stud", body="roller").item()
        assert life == pytest.approx(median / scatter**0.5, rel=1e-12)
    note = f"stud: placeholders of material '{STEEL}': scatter_in_cycles"
    assert note in ds.attrs["limits_notes"]
    with_scatter = ENDURING | {"scatter_in_cycles": 4}
    other = tr.solve(CASE | {"stud": with_scatter}, outputs=GROUPS, failure_probability=0.1, **QUICK)
    assert note not in other.attrs["limits_notes"]


def test_failures_shift_the_fatigue_limit_of_a_stud_with_a_line():
    """T_S = T_N^(1/k) of the line through (N_Rm, R_m) and (N_k, sigma_D)."""
    line = {"tensile_strength": 800, "fatigue_limit": 200, "cycles_at_tensile_strength": 1e4}
    stud = {"diameter": 10, "length": 18, "yield_strength": 640, "load_ratio": 0, "notch_factor": 2}
    stud |= line | {"cycles_at_fatigue_limit": 2e6, "scatter_in_cycles": 9}
    median, own = (tr.solve(CASE | {"stud": stud}, outputs=GROUPS, failure_probability=p, **QUICK) for p in (0.5, 0.1))
    exponent = math.log(200) / math.log(4)
    used = [ds["utilisation"].sel(limit="stud", body="roller").item() for ds in (median, own)]
    assert used[0] == median["stud_endurance_utilisation"].item()
    assert used[1] == pytest.approx(used[0] * 3 ** (1 / exponent), rel=1e-9)


def test_an_endurance_without_cycles_is_a_utilisation():
    stud = {name: value for name, value in ENDURING.items() if name != "cycles_per_hour"} | {"fatigue_limit": 40}
    ds = tr.solve(CASE | {"stud": stud}, outputs=GROUPS, **QUICK)
    assert ds["utilisation"].sel(limit="stud", body="roller") == ds["stud_endurance_utilisation"] > 1
    assert ds["limit_state"].sel(limit="stud", body="roller") == 3 and np.isnan(ds["stud_life_hours"])


def test_a_stud_may_end_the_roller_first():
    stud = ENDURING | {"diameter": 5, "length": 50, "cycles_per_hour": 3600}
    mild = {"radial_force": -150, "axial_force": 10, "motor_force": 0, "roller_material": STEEL}
    ds = tr.solve(CASE | mild | {"stud": stud}, outputs=GROUPS, **QUICK)
    by_limit = ds["life_hours_by_limit"].sel(body="roller")
    words = ds["limiting_mechanism"].attrs["flag_meanings"].split()
    assert by_limit.sel(limit="stud").item() < by_limit.sel(limit="fatigue").item()
    assert words[int(ds["limiting_mechanism"].sel(body="roller"))] == "stud"


def test_a_stronger_radial_force_bends_more():
    cases = [CASE | {"radial_force": -force, "stud": STUD} for force in (400, 800)]
    stress = tr.solve(cases, outputs=GROUPS, **QUICK)["stud_stress"].values
    assert 1.5 < stress[1] / stress[0] < 2.5


WRONG = [
    ({"yield_strength": None}, "yield_strength is missing.*with a source of '1.7225-quenched-tempered'.*Add yield"),
    ({"material": "1.7225"}, "material"),
    ({"diameter": -3}, r"stud\.diameter"),
    ({"diametre": 3}, "diameter"),
    ({"notch_factor": 2}, "notch_factor .*stands without load_ratio.*Add load_ratio"),
    ({"load_ratio": 0}, "notch_factor is missing"),
    ({"load_ratio": 1, "notch_factor": 2}, "never changes"),
    ({"load_ratio": 0, "notch_factor": 0.5}, r"stud\.notch_factor"),
    ({"material": None, "load_ratio": 0, "notch_factor": 2}, "fatigue_limit is missing"),
    ({"material": None, "load_ratio": 0, "notch_factor": 2, "fatigue_limit": 99}, "tensile_strength is missing"),
    ({"yield_strength": 3000}, r"stud\.yield_strength = 3000.* at most tensile_strength, 1200"),
    ({"material": 17225}, "Put a name that looks like a number in quotes"),
]


@pytest.mark.parametrize(("changed", "message"), WRONG)
def test_studs_that_are_not_clear_are_refused(changed, message):
    stud = {name: value for name, value in (STUD | changed).items() if value is not None}
    with pytest.raises(InputError, match=message):
        tr.Case(stud=stud)


def test_the_remedies_of_the_messages_work():
    tr.Case(stud={"diameter": 10, "length": 18, "yield_strength": 640})
    tr.Case(stud=STUD | {"notch_factor": 2, "load_ratio": -1})
    bare = {"diameter": 10, "length": 18, "yield_strength": 640, "load_ratio": 0, "notch_factor": 1}
    tr.Case(stud=bare | {"fatigue_limit": 200, "tensile_strength": 800})


def test_the_values_of_a_material_stay_in_the_case():
    """A case that is stored and read again has the same stud, and no value without a source."""
    case = tr.Case(stud=STUD)
    stored = FIELD.parsed(case.stud) if isinstance(case.stud, str) else dict(case.stud)
    assert stored["tensile_strength"] == 1200 and stored["material"] == STEEL
    again = tr.Case(stud=stored)
    assert again.stud == case.stud


def test_unusual_studs_are_asked_about():
    database = tr.load_database()
    from trackroller.roller.doubts import doubts_of_case

    texts = doubts_of_case(tr.Case(stud=STUD | {"diameter": 0.01, "length": 0.018}), database)
    assert any("stud.diameter = 0.01 mm is 200 times below" in text and "'0.01 m'" in text for text in texts)
    texts = doubts_of_case(tr.Case(stud=STUD | {"length": 3}), database)
    assert any("less than half the diameter" in text for text in texts)
