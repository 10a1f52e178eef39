"""Sentences that a reader took for false: what they count and name, against the raw rows."""

import json
from pathlib import Path

import numpy as np
import pytest

import trackroller as tr
from trackroller.contact.profiles import canonical
from trackroller.report.numbers import between, lasting, on_duty
from trackroller.study.design.levels import short

LIFE = "pair_life_to_first_limit_hours"
STEEL = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
BASE = {"axial_force": 8, "motor_force": 0, "guide_curve_radius": np.inf, "guide_overrollings_per_hour": 150, **STEEL}
LOADS = {"radial_force": {"values": [-150, -70]}, "friction_coefficient": {"values": [0.1, 0.2]}}


def run(factors, base=None, **keys):
    study = {"name": "read", "base": BASE | (base or {}), "factors": factors}
    return tr.run(study | {"contact_model": "sliding", "accuracy": "preview"} | keys, progress=False)


def search(goals, **keys):
    factors = {"axis_distance": {"uniform": [15, 28]}, "profile_ratio": {"uniform": [1.05, 1.3]}}
    factors["roller_profile_radius"] = {"expression": "-profile_ratio * guide_profile_radius"}
    return run(factors | LOADS, design="optimise", goals=goals, budget={"designs": 24}, **keys)


def test_a_measured_profile_has_the_name_of_its_file(tmp_path, monkeypatch):
    """The name stays where only the points are stored, and a smoothed profile has another name than the raw one."""
    monkeypatch.chdir(tmp_path)
    x = np.linspace(-4.0, 4.0, 81)
    z = np.sqrt(6.8**2 - x**2) - 6.8
    Path("worn.csv").write_text("\n".join(f"{a:.4f}; {b:.6f}" for a, b in zip(x, z, strict=True)), encoding="utf-8")
    levels = [{"arc": -6.8}, {"file": "worn.csv"}, {"file": "worn.csv", "smooth": "auto"}]
    results = run({"roller_profile": {"values": levels}, "radial_force": {"values": [-60, -120]}}, normal="halfspace")
    names = [short("roller_profile", value) for value in results.data["roller_profile"].values]
    assert names[:2] == ["arc −6.8 mm", "worn.csv, 81 points"] and names[2].startswith("worn.csv ")
    assert len(set(names)) == 3
    lives = results.data["roller_life_hours"].transpose("roller_profile", ...).values
    np.testing.assert_allclose(lives[1], lives[0], rtol=0.05)
    stored = canonical(json.loads(str(results.data["roller_profile"].values[1])))  # without the file
    assert stored["name"] == "worn.csv" and len(stored["points"]) == 81
    named = canonical({"points": stored["points"], "name": "Rig 3, after 40 km"})
    assert short("roller_profile", named) == "Rig 3, after 40 km, 81 points"
    with pytest.raises(tr.InputError, match="exactly one of"):
        canonical({"points": stored["points"], "file": "worn.csv"})
    with pytest.raises(tr.InputError, match="at most 80"):
        canonical({"points": stored["points"], "name": "a\nb"})


def test_one_year_is_singular():
    with on_duty({"hours_per_day": 8, "days_per_year": 220}):
        assert lasting(1760.0, "h") == "1760 h (1 year)"
        assert between(1760.0, 1761.0).endswith("(1 year)") and between(1760.0, 3520.0).endswith("(1 to 2 years)")
