"""The option `life_criterion`: which stress enters the S-N curve."""

import math

import numpy as np
import pytest

import trackroller as tr
from trackroller.materials import builtin_database
from trackroller.study.spectrum.file import Spectrum
from trackroller.study.spectrum.solve import solve_spectrum

STEEL_EXPONENT = math.log(500) / math.log(2)
FREE = {"motor_force": 0.0, "guide_overrollings_per_hour": 90.0}
QUICK = {"contact_model": "sliding", "accuracy": "preview"}


@pytest.mark.parametrize(
    ("criterion", "credit", "result"),
    [
        ("von_mises_amplitude", True, "von_mises_amplitude"),
        ("goodman", True, "goodman_stress"),
        ("findley", True, "findley_utilisation"),
        ("dang_van", True, "dang_van_utilisation"),
        ("dang_van", False, "dang_van_utilisation_without_pressure"),
    ],
)
def test_the_stress_of_the_criterion_enters_the_sn_curve(criterion, credit, result):
    """A share of 1 of a criterion's limit is the fatigue limit, so it gives N_k overrollings."""
    options = {**QUICK, "life_criterion": criterion, "credit_pressure": credit}
    ds = tr.solve(tr.Case(**FREE), outputs=("life", "multiaxial", "limits"), **options)
    stress = ds[result] * (1.0 if criterion in ("von_mises_amplitude", "goodman") else 360.0)
    assert np.allclose(ds.fatigue_stress, stress, rtol=1e-14)
    assert np.allclose(ds.life_cycles, 5e6 * (stress / 360.0) ** -STEEL_EXPONENT, rtol=1e-12)
    used = ds.utilisation.sel(limit="fatigue")
    assert np.allclose(used, ds.fatigue_stress.max("contact") / 360.0, rtol=1e-14)
    assert ds.life_error_estimate.isnull().all() and "expected_relative_error" not in ds.life_hours.attrs
    assert ds.attrs["life_criterion"] == criterion
    alone = tr.solve(tr.Case(**FREE), outputs="life", **options)
    assert not {"findley_stress", "von_mises_amplitude"} & set(alone) and alone.life_hours.equals(ds.life_hours)


def test_the_published_criterion_takes_the_peak_stress():
    ds = tr.solve(tr.Case(**FREE), outputs=("peak_stress", "life"), **QUICK)
    assert "fatigue_stress" not in ds and np.allclose(ds.life_cycles, 5e6 * (ds.peak_stress / 360.0) ** -STEEL_EXPONENT)


def test_a_criterion_without_its_limit_says_what_to_enter_and_leaves_the_other_body():
    """The life of a material without a limit in torsion is not known; that of the other body is."""
    known = ("youngs_modulus", "poisson_ratio", "tensile_strength", "fatigue_strength_ratio")
    known += ("cycles_at_tensile_strength", "cycles_at_fatigue_limit")
    material = builtin_database().material("1.7225-normalised")
    steel = {"name": "bare"} | {name: getattr(material, name) for name in known}
    ds = tr.solve(tr.Case(**FREE, roller_material=steel), outputs="life", life_criterion="findley", **QUICK)
    assert ds.life_hours.sel(body="roller").isnull().all() and ds.life_hours.sel(body="guide").notnull().all()
    assert "material 'bare' has no fatigue_limit_torsion" in ds.attrs["limits_notes"]


def test_softer_stress_of_a_criterion_lengthens_the_life_of_a_spectrum():
    """Each block of a spectrum takes the stress of the criterion."""
    blocks = [{"distance": 60.0, "radial_force": force} for force in (-150.0, -250.0)]
    lives = {}
    for criterion in ("von_mises_peak", "von_mises_amplitude"):
        given = Spectrum.from_dict({"base": FREE, "blocks": blocks, "life_criterion": criterion, **QUICK})
        lives[criterion] = solve_spectrum(given)
    stress = lives["von_mises_amplitude"].fatigue_stress
    damage = lives["von_mises_amplitude"].overrollings / (5e6 * (stress / 360.0) ** -STEEL_EXPONENT)
    total = lives["von_mises_amplitude"].damage_sum
    assert np.allclose(damage.sum("block").transpose(*total.dims), total, rtol=1e-12)
    assert lives["von_mises_amplitude"].roller_life_shifts > 2 * lives["von_mises_peak"].roller_life_shifts


def test_a_roller_by_goodman_exceeds_its_amplitude_as_far_as_its_strength_lets_it():
    """A point is unloaded in between, so that the stress pulsates, and a strength without end leaves the amplitude.

    Amplitude and mean lie within a circle whose radius is the peak stress.
    """
    steels = [{"like": "1.7225-normalised", "tensile_strength": strength} for strength in (720.0, 2e4)]
    cases = [tr.Case(**FREE, roller_material=steel) for steel in steels]
    ds = tr.solve(cases, ("multiaxial", "peak_stress"), **QUICK).sel(body="roller")
    assert (ds.goodman_stress > ds.von_mises_amplitude).all()
    bound = ds.peak_stress[0] / np.sqrt(1.0 - (ds.peak_stress[0] / 720.0) ** 2)
    assert (ds.goodman_stress[0] < bound).all() and (ds.goodman_stress[0] > 1.2 * ds.von_mises_amplitude[0]).all()
    assert np.allclose(ds.goodman_stress[1], ds.von_mises_amplitude[1], rtol=0.05)
