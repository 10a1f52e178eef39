"""S-N curves are entered as engineers have them: any sufficient combination, contradictions refused."""

from __future__ import annotations

import itertools
import math

import pytest
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.damage.sn_curve import SNCurve
from trackroller.errors import InputError
from trackroller.materials import builtin_database, load_database

ELASTIC = {"youngs_modulus": 3000.0, "poisson_ratio": 0.3, "tensile_strength": 60.0}
# one curve: R_m = 60 MPa, sigma_D = 30 MPa at 1e7 cycles, k = 8, so N_Rm = 1e7 / 2**8
WHOLE = {"cycles_at_tensile_strength": 1e7 / 2**8, "cycles_at_fatigue_limit": 1e7, "woehler_exponent": 8.0}
LIMITS = ({"fatigue_limit": 30.0}, {"fatigue_strength_ratio": 0.5}, {})


def _material(values):
    return builtin_database().material({**ELASTIC, **values})


@pytest.mark.parametrize("limit", LIMITS, ids=lambda v: ", ".join(v) or "no limit")
@pytest.mark.parametrize("count", [2, 3])
def test_any_sufficient_combination_gives_the_same_curve(limit, count):
    for names in itertools.combinations(WHOLE, count):
        values = {**limit, **{name: WHOLE[name] for name in names}}
        if len(values) < 3:
            continue
        material = _material(values)
        assert material.fatigue_limit == pytest.approx(30.0, rel=1e-12)
        assert material.cycles_at_tensile_strength == pytest.approx(39062.5, rel=1e-12)
        assert material.cycles_at_fatigue_limit == pytest.approx(1e7, rel=1e-12)
        assert material.woehler_exponent == pytest.approx(8.0, rel=1e-12)


@pytest.mark.parametrize(
    "values",
    [{"fatigue_limit": 30.0}, {"woehler_exponent": 8.0, "fatigue_limit": 30.0}, {"cycles_at_fatigue_limit": 1e7}],
)
def test_too_few_values_are_refused(values):
    with pytest.raises(InputError, match="lacks"):
        _material(values)


@pytest.mark.parametrize(
    ("values", "field"),
    [
        ({**WHOLE, "fatigue_limit": 31.0}, "woehler_exponent"),
        ({**WHOLE, "fatigue_limit": 30.0, "fatigue_strength_ratio": 0.6}, "fatigue_limit"),
        ({**WHOLE, "fatigue_limit": 61.0}, "fatigue_limit"),
        ({"fatigue_limit": 30.0, "cycles_at_fatigue_limit": 1e7, "woehler_exponent": -3}, "woehler_exponent"),
        ({"fatigue_limit": 30.0, "cycles_at_tensile_strength": 1e300, "woehler_exponent": 999}, "woehler_exponent"),
    ],
)
def test_a_contradiction_is_refused_with_its_field(values, field):
    with pytest.raises(InputError) as caught:
        _material(values)
    assert caught.value.field.endswith(field) and caught.value.remedy


def test_rounded_values_that_agree_are_taken():
    material = _material({**WHOLE, "fatigue_limit": 30.0, "woehler_exponent": 8.02})
    assert material.cycles_at_tensile_strength == 39062.5


def test_an_exponent_changes_the_curve_of_a_known_material(tmp_path):
    path = tmp_path / "materials.yaml"
    path.write_text(
        "materials:\n  PA6:\n    fatigue_limit: {value: 30, unit: MPa, source: test}\n"
        "    cycles_at_fatigue_limit: 1e7\n    woehler_exponent: 8\n"
    )
    material = load_database(path).material("PA6")
    strength = builtin_database().material("PA6").tensile_strength
    assert material.fatigue_limit == pytest.approx(30.0)
    assert material.cycles_at_tensile_strength == pytest.approx(1e7 * (30.0 / strength) ** 8)
    assert material.records["fatigue_strength_ratio"].source == "test"


def test_a_life_follows_the_curve_as_entered():
    roller = {**ELASTIC, "fatigue_limit": 30.0, "cycles_at_fatigue_limit": 1e7, "woehler_exponent": 8.0}
    ds = solve_sliding(tr.Case(roller_material=roller, radial_force=-5, axial_force=0, motor_force=0))
    stress = float(ds.peak_stress.sel(body="roller").max())
    assert float(ds.life_cycles.sel(body="roller").min()) == pytest.approx(1e7 * (stress / 30.0) ** -8.0, rel=1e-9)
    assert math.isfinite(stress)


@pytest.mark.parametrize("scatter", [2.5, 6.0])
def test_lives_below_the_fatigue_limit_scatter_by_a_power_of_t_n(scatter):
    """The scatter in stress stays, T_S = T_N^(1/k), and the slope grows to 2k - 1: T_S^(2k - 1)."""
    curve = SNCurve(900.0, 400.0, 2e4, 3e6, "haibach", scatter)
    late, early = (curve.changed(failure_probability=p) for p in (0.9, 0.1))
    k = float(curve.exponent)
    assert float(late.life_cycles(800.0) / early.life_cycles(800.0)) == pytest.approx(scatter)
    assert float(late.life_cycles(200.0) / early.life_cycles(200.0)) == pytest.approx(scatter ** ((2 * k - 1) / k))
