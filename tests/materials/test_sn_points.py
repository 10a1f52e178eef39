"""S-N curves by points, with a second exponent, and free of the tensile strength."""

from __future__ import annotations

import dataclasses
import itertools
import json
import math

import numpy as np
import pytest
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.damage.sn_curve import SNCurve, segments
from trackroller.errors import InputError
from trackroller.materials import add_material, builtin_database, load_database
from trackroller.materials.tables import material_details
from trackroller.roller.case import to_table
from trackroller.roller.case_limits import solved_of
from trackroller.study.spectrum.file import Spectrum
from trackroller.study.spectrum.solve import solve_spectrum

ELASTIC = {"youngs_modulus": 210e3, "poisson_ratio": 0.3, "tensile_strength": 900.0}
POINTS = [[700.0, 2e4], [500.0, 1e5], [420.0, 1e6], [400.0, 5e6]]
STRESS = np.geomspace(400.0, 700.0, 101)
FREE = {"fatigue_limit": 300.0, "cycles_at_fatigue_limit": 2e6, "woehler_exponent": 8.0}


def material(**values):
    return builtin_database().material(ELASTIC | values)


def test_a_line_by_points_interpolates_linearly_in_logarithms():
    curve = SNCurve.of(material(sn_points=POINTS))
    x, y = np.log(np.array(POINTS[::-1])).T
    assert np.allclose(np.log(curve.life_cycles(STRESS)), np.interp(np.log(STRESS), x, y), rtol=1e-13)
    assert np.allclose(curve.life_cycles([p[0] for p in POINTS]), [p[1] for p in POINTS], rtol=1e-13)
    assert np.allclose(curve.allowable_stress(curve.life_cycles(STRESS)), STRESS, rtol=1e-13)
    first = math.log(1e5 / 2e4) / math.log(700 / 500)
    assert float(curve.life_cycles(850.0)) == pytest.approx(2e4 * (850 / 700) ** -first, rel=1e-12)
    slopes = [math.log(c / a) / math.log(b / d) for (b, a), (d, c) in itertools.pairwise(POINTS)]
    assert np.allclose(curve.slope([600.0, 450.0, 410.0, 300.0]), [*slopes, slopes[-1]], rtol=1e-12)


@pytest.mark.parametrize(
    ("rule", "second", "exponent"),
    [
        ("elementary", None, 8.0),
        ("haibach", None, 15.0),
        ("elementary", 22.0, 22.0),
        ("haibach", 22.0, 22.0),
        ("unlimited", 22.0, math.inf),
    ],
)
def test_a_second_exponent_takes_the_place_of_the_rule_below_the_limit(rule, second, exponent):
    curve = SNCurve.of(material(**FREE, second_exponent=second), rule)
    below = 2e6 * (200.0 / 300.0) ** -exponent
    assert float(curve.life_cycles(200.0)) == pytest.approx(below, rel=1e-12)
    assert float(curve.life_cycles(600.0)) == pytest.approx(2e6 / 2.0**8, rel=1e-12)
    if rule != "unlimited":
        assert float(curve.allowable_stress(below)) == pytest.approx(200.0, rel=1e-12)
        assert float(curve.slope(200.0)) == exponent
    else:
        assert float(curve.allowable_stress(1e9)) == 300.0


@pytest.mark.parametrize(("second", "rule"), [(3.0, "elementary"), (3.0, "haibach"), (7.9, "elementary")])
@pytest.mark.parametrize("scatter", [{"scatter_in_cycles": 8.0}, {"scatter_in_stress": 1.3}])
def test_no_life_below_the_knee_scatters_less_than_above_it(second, rule, scatter):
    """With a smaller exponent below sigma_D the life scatters by T_N at all stresses, without a jump at the knee."""
    median = SNCurve.of(material(**FREE, second_exponent=second, **scatter), rule)
    early, late = (median.changed(failure_probability=p) for p in (0.1, 0.9))
    stress = np.geomspace(100.0, 900.0, 61)
    t_n = 8.0 if "scatter_in_cycles" in scatter else 1.3**8
    assert np.allclose(late.life_cycles(stress) / early.life_cycles(stress), t_n, rtol=1e-12)
    assert np.allclose(early.life_cycles(stress) * np.sqrt(t_n), median.life_cycles(stress), rtol=1e-12)
    assert np.allclose(early.allowable_stress(early.life_cycles(stress)), stress, rtol=1e-12)


@pytest.mark.parametrize(("second", "rule"), [(15.0, "elementary"), (None, "haibach"), (None, "elementary")])
def test_a_larger_exponent_below_the_knee_keeps_the_scatter_of_the_strength(second, rule):
    """The life scatters by T_N T_S^(k_2 - k) there, by the numbers of pyLife's formula."""
    median = SNCurve.of(material(**FREE, second_exponent=second, scatter_in_cycles=8.0), rule)
    early = median.changed(failure_probability=0.1)
    below = second or {"haibach": 15.0, "elementary": 8.0}[rule]
    t_s = 8.0 ** (1 / 8)
    assert float(median.life_cycles(200.0) / early.life_cycles(200.0)) == pytest.approx(
        math.sqrt(8.0 * t_s ** (below - 8.0)), rel=1e-12
    )
    assert float(median.life_cycles(600.0) / early.life_cycles(600.0)) == pytest.approx(math.sqrt(8.0), rel=1e-12)


def test_an_unlimited_life_keeps_the_scatter_of_the_fatigue_limit():
    median = SNCurve.of(material(**FREE, second_exponent=3.0, scatter_in_stress=1.3), "unlimited")
    early = median.changed(failure_probability=0.1)
    assert float(early.knee[0]) == pytest.approx(300.0 / math.sqrt(1.3), rel=1e-12)
    assert float(early.life_cycles(299.0 / math.sqrt(1.3))) == math.inf


@pytest.mark.parametrize("strength", [20.0, 299.9, 300.0, 300.1, 900.0, 1e5])
def test_a_line_by_limit_cycles_and_exponent_is_free_of_the_tensile_strength(strength):
    stress = np.array([1.0, 100.0, 299.0, 301.0, 800.0])
    curve = SNCurve.of(material(**FREE, tensile_strength=strength))
    assert np.allclose(curve.life_cycles(stress), 2e6 * (stress / 300.0) ** -8.0, rtol=1e-11)
    steep = SNCurve.of(material(**FREE | {"woehler_exponent": 900.0}, tensile_strength=strength))
    assert float(steep.life_cycles(301.0)) == pytest.approx(2e6 * (301 / 300) ** -900.0, rel=1e-9)


def test_a_free_line_stays_where_the_entry_changes_the_tensile_strength(tmp_path):
    path = tmp_path / "materials.yaml"
    add_material(path, "fitted", like="1.7225-normalised", **FREE, second_exponent=15, fatigue_limit_torsion=180)
    add_material(path, "points", like="fitted", sn_points=POINTS, fatigue_limit_torsion=240, source="own tests")
    database = load_database(path)
    for name, limit in (("fitted", 300.0), ("points", 400.0)):
        other = database.material({"like": name, "tensile_strength": 1500})
        assert other.fatigue_limit == pytest.approx(limit) and other.fatigue_strength_ratio == pytest.approx(
            limit / 1500
        )
        lives = [SNCurve.of(one).life_cycles(STRESS) for one in (other, database.material(name))]
        assert np.allclose(*lives, rtol=1e-12)
    assert database.material("fitted").second_exponent == 15 and database.material("points").second_exponent is None
    assert database.material("points").records["fatigue_strength_ratio"].source == "own tests"
    flatter = database.material({"like": "fitted", "woehler_exponent": 10})
    assert flatter.fatigue_limit == pytest.approx(300) and flatter.woehler_exponent == pytest.approx(10)
    with pytest.raises(InputError, match="would change a part of the sn_points"):
        database.material({"like": "points", "woehler_exponent": 10})
    assert "700, 20000" in next(r["value"] for r in material_details(database, "points") if r["field"] == "sn_points")


def test_each_number_of_a_line_keeps_its_own_mark():
    guess = {"value": 8, "placeholder": True, "source": "no source named", "note": "measure"}
    one = material(**FREE | {"woehler_exponent": guess})
    assert one.placeholders == ("cycles_at_tensile_strength",)
    assert one.records["cycles_at_tensile_strength"].note == "measure"
    assert material(sn_points={"value": POINTS, "placeholder": True}).placeholders
    in_gpa = [[stress / 1e3, cycles] for stress, cycles in POINTS]
    assert material(sn_points={"value": in_gpa, "unit": "GPa"}).fatigue_limit == pytest.approx(400)


def test_the_values_of_a_material_make_the_same_material_again():
    for values in ({"sn_points": POINTS}, FREE, FREE | {"tensile_strength": 200.0}):
        one = material(**values)
        assert builtin_database().material(json.loads(json.dumps(one.as_dict()))) == one
    assert "sn_points" not in builtin_database().material("PA6").as_dict()


def test_a_warm_material_keeps_the_shape_of_its_line():
    table = {"temperature": [20, 120], "tensile_strength": [900, 450]}
    one = material(sn_points=POINTS, temperature_dependence=table)
    assert one.at(120.0).sn_points == tuple((0.5 * s, n) for s, n in POINTS)
    assert np.allclose(
        SNCurve.of(one.at(120.0)).life_cycles(STRESS / 2), SNCurve.of(one).life_cycles(STRESS), rtol=1e-12
    )


def test_materials_with_and_without_points_share_a_table():
    """Lines of different lengths and materials without points stand in one array."""
    database = builtin_database()
    materials = [material(sn_points=POINTS), material(sn_points=POINTS[:2]), database.material("PA6")]
    cases = [tr.Case(roller_material=one) for one in materials]
    solved = solved_of(to_table(cases, database), {}, tr.roller.options.Options(), None)
    curve = SNCurve.of(solved.materials)
    stress = np.array([[450.0], [600.0], [30.0]])
    lives = curve.life_cycles(np.broadcast_to(stress, (3, 2)))[:, 0]
    assert np.allclose(
        lives, [SNCurve.of(m).life_cycles(s[0]) for m, s in zip(materials, stress, strict=True)], rtol=1e-13
    )
    assert segments(np.array(["", ""], dtype=object)) is None


def test_scatter_moves_the_whole_line():
    curve = SNCurve.of(material(sn_points=POINTS, scatter_in_stress=1.3))
    early = curve.changed(failure_probability=0.1)
    assert np.allclose(early.life_cycles(STRESS / math.sqrt(1.3)), curve.life_cycles(STRESS), rtol=1e-10)
    cycles = SNCurve.of(material(sn_points=POINTS, scatter_in_cycles=4.0, scatter_in_stress=1.0))
    early = cycles.changed(failure_probability=0.1)
    assert np.allclose(early.life_cycles(STRESS), curve.life_cycles(STRESS) / 2.0, rtol=1e-10)


def test_a_solved_roller_and_its_spectrum_follow_the_points():
    steel = ELASTIC | {"sn_points": [[1000, 1e4], [500, 1e5], [300, 1e7]], "second_exponent": 40, "name": "own"}
    base = {"roller_material": steel, "motor_force": 0, "axial_force": 0}
    curve = SNCurve.of(builtin_database().material(steel))
    for force in (-15.0, -150.0):
        ds = solve_sliding(tr.Case(**base, radial_force=force))
        own = ds.sel(body="roller")
        assert np.allclose(own.life_cycles, curve.life_cycles(own.peak_stress), rtol=1e-12)
        factor = (1.0 + own.error_estimate) ** curve.slope(own.peak_stress)
        assert np.allclose(1.0 + own.life_error_estimate, factor, rtol=1e-12)
    quick = {"contact_model": "sliding", "accuracy": "preview"}
    blocks = [{"distance": 60.0, "radial_force": force} for force in (-15.0, -150.0)]
    shift = solve_spectrum(Spectrum.from_dict({"base": base, "blocks": blocks, **quick}))
    own = shift.sel(body="roller")
    assert np.allclose(own.life_cycles, curve.life_cycles(own.peak_stress), rtol=1e-12)
    assert np.allclose(own.damage_sum, (own.overrollings / own.life_cycles).sum("block"), rtol=1e-12)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([[400, 1e5]], "at least two points"),
        ("400 MPa", "at least two points"),
        ([[400, 1e5], [300]], "point 2.*a pair"),
        ([[400, 1e5], [300, "many"]], r"point 2\.cycles"),
        ([[1e5, 400], [5e4, 300]], "less stress with more cycles"),
        ([[1e6, 400], [1e7, 300]], r"point 1\.stress.*MPa"),
        ([[400, 1e5], [400, 1e6]], "each stress once"),
        ([[400, 1e6], [300, 1e5]], "has 1e\\+06 cycles at 400 MPa"),
        ([[400, 1e5], [-300, 1e6]], r"point 2\.stress"),
        ({"values": [[400, 1e5], [300, 1e6]]}, "sn_points: key"),
    ],
)
def test_a_wrong_line_is_refused_with_its_point(points, words):
    with pytest.raises(InputError, match=words):
        material(sn_points=points)


def test_numbers_beside_points_must_say_the_same():
    assert material(sn_points=POINTS, fatigue_limit=401).fatigue_limit == 400
    for other in ({"fatigue_limit": 300}, {"woehler_exponent": 5}, {"cycles_at_fatigue_limit": 1e6}):
        with pytest.raises(InputError, match="which follows from the other values"):
            material(sn_points=POINTS, **other)
    one = material(sn_points=POINTS)
    assert dataclasses.replace(one, tensile_strength=1000.0).fatigue_strength_ratio == pytest.approx(0.4)
    with pytest.raises(InputError, match=r"second_exponent.*b is meant"):
        material(**FREE, second_exponent=-0.1)
