"""What a verdict asks for decides it: an input that brings conditions in reach, and the coefficients that count."""

import numpy as np

import trackroller as tr
from trackroller.report.words.verdict import verdict_sentences

STEEL = "1.7225-quenched-tempered"


def test_a_force_that_brings_nothing_in_reach_is_not_asked_for():
    """Where the drive exceeds the friction each roller skids or lifts off, whatever the axial force is."""
    base = {"guide_overrollings_per_hour": 200, "roller_material": STEEL, "guide_material": STEEL, "motor_force": -8}
    factors = {
        "contact_angle": {"values": [45, 55]},
        "radial_force": {"values": [-30, -120]},
        "friction_coefficient": {"values": [0.1, 0.2]},
    }
    study = {"name": "hopeless", "base": base, "factors": factors, "contact_model": "sliding"}
    results = tr.run(study | {"analysis": {"target": {"min": 1000}}}, progress=False)
    lost = {"radial_force": -30, "friction_coefficient": 0.1}
    assert set(results.data.regime.sel(lost).values.tolist()) == {1, 2}  # full slip and lift-off by 30 N
    cases = [tr.Case(**base, contact_angle=45, axial_force=force, **lost) for force in (-10, 0, 10)]
    assert (tr.solve(cases, outputs=("forces",), contact_model="sliding").regime == 1).all()
    assert results.verdict.kind == "none"
    assert "(axial force 30 N was not given)" in verdict_sentences(results)[1].text
    free = study | {"base": base | {"motor_force": 0}, "analysis": {"target": {"min": 1000}}}
    free["factors"] = factors | {"contact_angle": {"values": [25, 35]}}
    given = tr.run(free, progress=False).verdict
    assert (given.kind, given.turns[0].what) == ("give", "axial_force")


def test_both_coefficients_are_asked_for_where_one_does_not_decide():
    """The range of one wear coefficient alone leaves the order open at each of its values."""
    base = {
        "motor_force": 0,
        "axial_force": 2,
        "guide_curve_radius": np.inf,
        "guide_overrollings_per_hour": 30,
        "permissible_wear_depth": 0.1,
        "friction_coefficient": None,
        "contact_angle": 40,
        "guide_material": STEEL,
        "roller_profile_radius": -6.3,
    }
    factors = {"roller_material": {"values": [STEEL, "POM"]}, "radial_force": {"values": [-20, -40]}}
    results = tr.run({"name": "two", "base": base, "factors": factors, "contact_model": "sliding"}, progress=False)
    found = results.verdict
    assert found.kind == "measure" and [turn.of for turn in found.turns] == [STEEL, "POM"]
    own, other = (next(c for c in found.best if c.choices["roller_material"] == name) for name in (STEEL, "POM"))
    k = found.turns[0]
    assert k.high * own.low / k.low < other.high and k.low * own.high / k.high > other.low  # at both ends undecided
    assert "wear coefficient of POM on" in verdict_sentences(results)[0].text
