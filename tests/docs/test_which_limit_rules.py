"""The tutorial on limits states what its shipped study finds."""

from pathlib import Path

import numpy as np
import pytest

import trackroller as tr

ROOT = Path(__file__).parents[2]
STEEL, ALUMINIUM, POM, PA6 = ("1.7225-quenched-tempered", "EN AW-7075", "POM", "PA6")


def test_the_tutorial_on_limits_states_what_its_study_finds():
    ds = tr.run(ROOT / "config" / "studies" / "what_ends_it.yaml", progress=False).data
    pairs = [pair.split(" / ")[0] for pair in ds.material_pair.values]
    ds = ds.assign_coords(material_pair=pairs)
    conditions = ("friction_coefficient", "motor_force", "velocity")
    lives = ds.pair_life_to_first_limit_hours.min(conditions)
    worst, close = lives.min("placeholder_position"), {"roller_profile_radius": -6.3}
    told = (ROOT / "docs" / "tutorial" / "which-limit-rules.md").read_text(encoding="utf-8")

    def states(value, digits=3):
        number = float(f"{float(value):.{digits}g}")
        assert f" {number:,.0f} h" in told or f" {number:g} h" in told, number

    fatigue = ds.life_hours_by_limit.sel(limit="fatigue", body="roller").min((*conditions, "placeholder_position"))
    for material in (STEEL, POM):
        states(fatigue.sel(material_pair=material, **close))
        states(worst.sel(material_pair=material, **close))
    states(worst.sel(material_pair=PA6, **close))
    for place, material in ((0, STEEL), (0, POM), (1, STEEL)):
        states(lives.sel(material_pair=material, placeholder_position=place, **close))
    # wear ends the metals first, and never the best are aluminium, PA6 and the wider groove
    first = ds.life_hours_by_limit.sel(body="roller", material_pair=[STEEL, ALUMINIUM]).fillna(np.inf).argmin("limit")
    assert (ds.limit.values[first.values] == "wear").all()
    best = lives.stack(design=("material_pair", "roller_profile_radius")).idxmax("design").values.tolist()
    assert best == [(POM, -6.3), (POM, -6.3), (STEEL, -6.3)]
    # wear life goes with 1/k: the coefficient at which steel outlives POM
    guessed = tr.load_database().on(STEEL, STEEL).wear_coefficient
    here = lives.sel(placeholder_position=0, **close)
    equal = guessed * float(here.sel(material_pair=STEEL) / here.sel(material_pair=POM))
    assert equal == pytest.approx(4e-6, rel=0.1)
