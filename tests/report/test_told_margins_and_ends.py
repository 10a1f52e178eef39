"""What the tables of designs tell of margins, of lives without an end, and of intervals, against the raw rows."""

import numpy as np

import trackroller as tr
from trackroller.report.numbers import plus_minus

STEEL = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
BASE = {"axial_force": 20, "guide_curve_radius": np.inf, "guide_overrollings_per_hour": 100, **STEEL}


def run(factors, **keys):
    study = {"name": "made", "base": BASE, "factors": factors, "contact_model": "sliding", "accuracy": "preview"}
    return tr.run(study | keys, progress=False)


def test_an_interval_of_rounding_alone_is_not_told():
    assert plus_minus(0.778, 0.778 - 1e-16, 0.778 + 1e-16) == "0.778"
    assert plus_minus(0.778, 0.768, 0.788) == "0.778 ± 0.010"
