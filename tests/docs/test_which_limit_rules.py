"""The tutorial on limits states what its shipped study finds."""

from pathlib import Path

import numpy as np
import pytest

import trackroller as tr

ROOT = Path(__file__).parents[2]
STEEL, ALUMINIUM, POM, PA6 = ("1.7225-quenched-tempered", "EN AW-7075", "POM", "PA6")


@pytest.mark.slow
def test_the_tutorial_on_limits_states_what_its_study_finds():
    results = tr.run(ROOT / "config" / "studies" / "what_ends_it.yaml", progress=False)
    ds = results.data
    pairs = [pair.split(" / ")[0] for pair in ds.material_pair.values]
    ds = ds.assign_coords(material_pair=pairs)
    conditions, close = ("friction_coefficient", "motor_force", "velocity"), {"roller_profile_radius": -6.3}
    lives = ds.pair_life_to_first_limit_hours.min(conditions)
    low, high = (ds[f"pair_life_to_first_limit_hours{end}"].min(conditions) for end in ("_low", "_high"))
    low, high = low.min("placeholder_position"), high.max("placeholder_position")
    told = (ROOT / "docs" / "tutorial" / "which-limit-rules.md").read_text(encoding="utf-8")

    def states(value, digits=3):
        number = float(f"{float(value):.{digits}g}")
        assert f"{number:,.0f} h" in told.replace("\n", " ") or f"{number:g} h" in told.replace("\n", " "), number

    fatigue = ds.life_hours_by_limit.sel(limit="fatigue", body="roller").min((*conditions, "placeholder_position"))
    for material in (STEEL, POM):
        states(fatigue.sel(material_pair=material, **close))
        states(low.sel(material_pair=material, **close))
        states(high.sel(material_pair=material, **close))
    states(low.sel(material_pair=PA6, **close))
    # wear ends the metals first, and never the best are aluminium, PA6 and the wider groove
    ending = ds.life_hours_by_limit.where(~ds.limit.isin(["pressure_line", "rating", "catalogue"])).sel(body="roller")
    first = ending.sel(material_pair=[STEEL, ALUMINIUM]).fillna(np.inf).argmin("limit")
    assert (ds.limit.values[first.values] == "wear").all()
    best = lives.stack(design=("material_pair", "roller_profile_radius")).idxmax("design").values.tolist()
    assert set(best) == {(POM, -6.3)}
    assert (results.answer.kind, results.answer.headline["names"][0]["material_pair"].split(" / ")[0]) == ("build", POM)
    # wear life goes with 1/k: the coefficient at which the shortest life of steel is the longest of POM
    _, worst = tr.load_database().on(STEEL, STEEL).records["wear_coefficient"].range
    equal = worst * float(low.sel(material_pair=STEEL, **close) / high.sel(material_pair=POM, **close))
    assert "4.28·10⁻⁶" in told and equal == pytest.approx(4.28e-6, rel=2e-3)
