"""A life at a failure probability needs the scatter of the materials: without it, fatigue was not checked."""

import numpy as np

import trackroller as tr
from trackroller.report.words.verdict import verdict_sentences

BEARING = {"rows": 2, "row_distance": 7, "dynamic_rating": 1900, "static_rating": 900, "kind": "ball"}
BEARING |= {"e": 0.35, "X": 0.56, "Y": 1.4, "X0": 0.6, "Y0": 0.5}
SCATTERS = {"like": "1.7225-quenched-tempered", "scatter_in_cycles": 3.0}
PLAIN = "1.7225-quenched-tempered"


def test_fatigue_that_no_life_holds_is_named():
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
