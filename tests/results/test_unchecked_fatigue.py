"""A life at a failure probability needs the scatter of the materials: without it, fatigue was not checked."""

import numpy as np

import trackroller as tr
from trackroller.report.words.verdict import verdict_sentences

BEARING = {"rows": 2, "row_distance": 7, "dynamic_rating": 1900, "static_rating": 900, "kind": "ball"}
BEARING |= {"e": 0.35, "X": 0.56, "Y": 1.4, "X0": 0.6, "Y0": 0.5}
SCATTERS = "scattering steel"
MATERIALS = """materials:
  scattering steel:
    like: 1.7225-quenched-tempered
    scatter_in_cycles: {value: 3, unit: "-", source: own tests}
"""
PLAIN = "1.7225-quenched-tempered"


def test_fatigue_that_no_life_holds_is_named(tmp_path, monkeypatch):
    (tmp_path / "materials.yaml").write_text(MATERIALS)
    monkeypatch.setenv("TRACKROLLER_MATERIALS", str(tmp_path / "materials.yaml"))
    for roller, guide, says in (
        (PLAIN, PLAIN, "fatigue at 10 % failures (give `scatter_in_cycles`)"),
        (SCATTERS, PLAIN, "fatigue of the guide at 10 % failures"),
        (SCATTERS, SCATTERS, ""),
    ):
        base = {"bearing": BEARING, "motor_force": 0, "axial_force": 5, "guide_overrollings_per_hour": 100}
        base |= {"roller_material": roller, "guide_material": guide, "guide_curve_radius": np.inf}
        study = {"name": "chance", "base": base, "failure_probability": 0.1, "contact_model": "sliding"}
        study |= {"factors": {"radial_force": {"values": [-60, -90]}}, "accuracy": "preview"}
        results = tr.run(study, progress=False)
        hours = results.data["life_hours_by_limit"].sel(limit="fatigue").transpose("radial_force", "body").values
        assert np.isfinite(hours).all(axis=0).tolist() == [roller is SCATTERS, guide is SCATTERS]
        said = verdict_sentences(results)[-1].text
        assert says in said if says else "fatigue" not in said


def test_half_of_the_bearings_reach_the_life_of_a_verdict():
    """L10 by ISO 281 is the life of nine of ten: by Weibull 10/9, half of the ball bearings last 5.45 times as long."""
    base = {"bearing": BEARING, "motor_force": 0, "axial_force": 40, "guide_overrollings_per_hour": 1}
    base |= {
        "roller_material": "100Cr6",
        "guide_material": "100Cr6",
        "contact_angle": 45,
        "roller_profile_radius": -6.2,
    }
    study = {"name": "half", "base": base, "factors": {"radial_force": {"values": [-150, -200]}}}
    study |= {"contact_model": "sliding", "accuracy": "preview", "outputs": ["forces", "life", "bearing", "limits"]}
    results = tr.run(study, progress=False)
    assert results.verdict.best[0].ends == "bearing"
    share = float(results.data["bearing_life_hours"].min()) / results.verdict.best[0].low
    said = {one.kind: one.text for one in verdict_sentences(results)}
    assert f"nine of ten {share:.2g} times it" in said["bearing"]
    median = tr.run(study | {"failure_probability": 0.1}, progress=False)
    assert "bearing" not in {one.kind for one in verdict_sentences(median)}


def test_a_life_by_fewer_limits_beats_no_other(tmp_path, monkeypatch):
    """At 10 % failures fatigue of one of two steels is not known: its life to the bearing is not compared, nor counted.

    The bearing outlasts fatigue of the other steel by far, so that this life alone would win.
    """
    (tmp_path / "materials.yaml").write_text(MATERIALS)
    monkeypatch.setenv("TRACKROLLER_MATERIALS", str(tmp_path / "materials.yaml"))
    base = {"bearing": BEARING, "motor_force": 0, "axial_force": 5, "guide_overrollings_per_hour": 100}
    base |= {"guide_material": SCATTERS, "guide_curve_radius": np.inf, "roller_profile_radius": -7.5}
    study = {"name": "fewer", "base": base, "failure_probability": 0.1, "contact_model": "sliding"}
    study |= {"factors": {"roller_material": {"values": [PLAIN, SCATTERS]}, "radial_force": {"values": [-60, -90]}}}
    study |= {"accuracy": "preview", "analysis": {"target": {"min": 10}}}
    results = tr.run(study, progress=False)
    lives = results.data["pair_life_to_first_limit_hours"]
    assert float(lives.sel(roller_material=PLAIN).min()) > float(lives.sel(roller_material=SCATTERS).max())
    found = results.verdict
    assert [one.choices["roller_material"] for one in found.best] == [SCATTERS] and found.kind == "build"
    assert [one.judged for one in found.candidates] == [True, False]
    scattering = (results.table["roller_material"] == SCATTERS).to_numpy()
    np.testing.assert_array_equal(results.held, scattering)
    assert (
        results.analysis["target_probability"].values.item() == 0.5 * (lives.sel(roller_material=SCATTERS) >= 10).mean()
    )
    said = " ".join(one.text for one in verdict_sentences(results))
    assert f"Not judged: {PLAIN}, which has no known life by fatigue." in said
