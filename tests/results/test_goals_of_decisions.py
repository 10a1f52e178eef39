"""What a decision follows among candidates that meet a requirement, against raw rows by plain loops."""

from __future__ import annotations

import numpy as np
import pytest
import yaml

import trackroller as tr
from trackroller.report.headlines import headline_of

LIFE = "pair_life_to_first_limit_hours"
STEEL = "1.7225-quenched-tempered"
BASE = {
    "guide_curve_radius": float("inf"),
    "roller_material": STEEL,
    "guide_material": STEEL,
    "guide_overrollings_per_hour": 60,
    "motor_force": 0,
    "axial_force": 8,
}
GROUPS = ["forces", "contact", "friction_work", "peak_stress", "life", "limits"]


def solved(place, base=None, **keys):
    given = {**BASE, **(base or {})}
    own = {key: value for key, value in given.items() if key not in keys["factors"]}
    study = {"name": place.name, "base": own, "contact_model": "sliding", "accuracy": "preview", "outputs": GROUPS}
    study["not_checked"] = ["pressure_line"]  # the life has one line, so that value and ends agree
    return tr.run(study | keys, results=place, progress=False)


def worst(results, choices, values, way):
    """Return the worst value of each combination of choices: a dictionary."""
    found = {}
    for place, value in enumerate(values):
        key = tuple(results.table[name].iloc[place] for name in choices)
        found[key] = value if key not in found else way(found[key], value)
    return found


@pytest.fixture(scope="module")
def trade(tmp_path_factory):
    """Sizes and grooves: a large roller lasts, a small one is wanted, and so is a low friction power."""
    factors = {
        "axis_distance": {"values": [15, 19, 24, 30]},
        "roller_profile_radius": {"values": [-6.3, -7, -8.5]},
        "radial_force": {"values": [-60, -120]},
    }
    wanted = {LIFE: {"min": 1000}}
    goals = {"axis_distance": "min", "friction_power": "min"}
    return solved(tmp_path_factory.mktemp("trade"), {"friction_coefficient": 0.2}, factors=factors,
                  requirement=wanted, pareto=goals)  # fmt: skip


CHOICES = ("axis_distance", "roller_profile_radius")


def test_several_goals_choose_the_knee_of_what_meets_the_requirement(trade):
    power = trade.data["friction_power"].sum("contact").transpose(*trade.data["regime"].dims).values.ravel()
    lives = worst(trade, CHOICES, trade.table[LIFE], min)
    powers = worst(trade, CHOICES, power, max)
    met = [key for key in lives if lives[key] >= 1000]
    assert [key for key in lives if 900 < lives[key] < 1100] == [], "no candidate is near the requirement"
    assert 3 < len(met) < len(lives)
    points = {key: (key[0], powers[key]) for key in met}
    front = [
        key for key, own in points.items()
        if not any(all(a <= b for a, b in zip(one, own, strict=True)) and one != own for one in points.values())
    ]  # fmt: skip
    low, high = (np.array([end(points[key][i] for key in front) for i in (0, 1)]) for end in (min, max))
    far = {key: (((np.array(points[key]) - low) / (high - low)) ** 2).sum() for key in front}
    knee = min(far, key=far.get)
    answer = trade.answer
    assert answer.kind == "build"
    assert tuple(answer.headline["names"][0][name] for name in CHOICES) == knee
    assert knee != max(met, key=lives.get), "the longest life is another candidate"
    assert answer.headline["goals"][0]["value"] == pytest.approx(powers[knee])
    assert "friction power" in headline_of(answer).text
    for _, row in answer.table.iterrows():
        assert row["of_friction_power"] == pytest.approx(powers[tuple(row[name] for name in CHOICES)])


@pytest.fixture(scope="module")
def stress(tmp_path_factory):
    """Grooves whose friction power and stress are limited from both sides; no life is required."""
    factors = {
        "roller_profile_radius": {"values": [-6.2, -6.6, -7.2, -8.4, -11]},
        "radial_force": {"values": [-100, -200]},
    }
    wanted = {"friction_power": {"max": 0.4}, "peak_stress_roller": {"max": 650}}
    return solved(tmp_path_factory.mktemp("stress"), {"friction_coefficient": 0.2}, factors=factors, requirement=wanted)


def test_without_a_goal_the_life_chooses(stress):
    data = stress.data
    dims = data["regime"].dims
    power = data["friction_power"].sum("contact").transpose(*dims).values.ravel()
    peak = data["peak_stress"].sel(body="roller").max("contact").transpose(*dims).values.ravel()
    one = ("roller_profile_radius",)
    powers, peaks = worst(stress, one, power, max), worst(stress, one, peak, max)
    lives = worst(stress, one, stress.table[LIFE], min)
    met = [key for key in lives if powers[key] < 0.38 and peaks[key] < 620]
    assert 1 < len(met) < len(lives)
    longest, least = max(met, key=lives.get), min(met, key=powers.get)
    assert longest != least
    answer = stress.answer
    assert answer.headline["names"] == [{"roller_profile_radius": longest[0]}]
    table = answer.table.set_index("roller_profile_radius")
    for (groove,), value in peaks.items():
        assert table.loc[groove, "of_peak_stress_roller"] == pytest.approx(value)
        assert table.loc[groove, f"of_{LIFE}"] == pytest.approx(lives[(groove,)])


def test_nine_of_ten_conditions_stay_within_the_tenth_part_of_a_stress(tmp_path):
    factors = {
        "roller_profile_radius": {"values": [-6.3, -7.5]},
        "radial_force": {"uniform": [-200, -60], "scatter": True},
        "axial_force": {"uniform": [0, 45], "scatter": True},
    }
    keys = {
        "design": "inner_outer",
        "samples": 32,
        "requirement": {"peak_stress_guide": {"max": 500, "probability": 0.8}},
    }
    results = solved(tmp_path, {"friction_coefficient": 0.2, "contact_angle": 30}, factors=factors, **keys)
    data = results.data
    dims = data["regime"].dims
    rolls = (data["regime"].transpose(*dims) == 0).values.ravel()
    peak = data["peak_stress"].sel(body="guide").max("contact").transpose(*dims).values.ravel()
    groove = results.table["roller_profile_radius"].to_numpy()
    assert 0 < (~rolls).sum() < 7
    for _, row in results.answer.table.iterrows():
        own = np.sort(np.where(rolls, peak, np.inf)[groove == row["roller_profile_radius"]])
        assert (own <= row["tenth"]).mean() >= 0.9
        assert (own < row["tenth"]).mean() < 0.9
        assert row["tenth_low"] <= row["tenth"] <= row["tenth_high"]
        assert row["tenth"] > np.median(own)


def test_a_condition_in_which_no_candidate_holds_rules_none_out(tmp_path):
    """Without a requirement: a drive that skids on every groove, and loads that all grooves bear."""
    factors = {
        "roller_profile_radius": {"values": [-6.3, -7.5]},
        "friction_coefficient": {"values": [0.05, 0.2, 0.3]},
        "motor_force": {"values": [0, -15]},
    }
    results = solved(tmp_path, {"radial_force": -100}, factors=factors)
    lost = results.table[results.table["regime"] != 0]
    assert set(zip(lost["friction_coefficient"], lost["motor_force"], strict=True)) == {(0.05, -15.0)}
    answer = results.answer
    assert answer.kind == "build"
    assert answer.headline["not_held"]["count"] == 1
    assert headline_of(answer).lead.startswith("None holds in 1 of 6 conditions")


def test_equal_candidates_name_what_they_share_and_others_lack(tmp_path):
    """Two angles are equal within the error; the groove is what both have and others lack."""
    factors = {
        "roller_profile_radius": {"values": [-6.3, -7.5, -9]},
        "contact_angle": {"values": [44.999, 45.0]},
        "radial_force": {"values": [-60, -120]},
    }
    results = solved(tmp_path, {"friction_coefficient": 0.2}, factors=factors, requirement={LIFE: {"min": 1}})
    answer = results.answer
    assert answer.kind == "a_or_b"
    assert answer.headline["shared"] == {"roller_profile_radius": -6.3}
    assert "roller profile radius −6.3 mm" in headline_of(answer).lead
    caution = next(one for one in answer.warnings if one.code == "at_end")
    assert "−6.3 mm: largest of −9 mm to −6.3 mm" in caution.where


def named_loads(place, heavy):
    """Two steels under three named loads; friction belongs to the pair, and one load skids on both."""
    rows = ["load case,radial_force [N],motor_force [N],friction_coefficient,roller_material"]
    for material, friction, full in ((STEEL, 0.2, -200), ("C45-induction-hardened", 0.16, heavy)):
        rows += [f"empty,-60,0,{friction},{material}", f"full,{full},0,{friction},{material}"]
        rows.append(f"wet start,-200,-30,0.05,{material}")
    (place / "loads.csv").write_text("\n".join(rows) + "\n")
    base = {key: value for key, value in BASE.items() if key not in ("motor_force", "roller_material")}
    study = {
        "name": "named",
        "base": base,
        "method": "table",
        "table": "loads.csv",
        "contact_model": "sliding",
        "accuracy": "preview",
        "requirement": {LIFE: {"min": 20}},
        "not_checked": ["pressure_line"],
    }
    (place / "study.yaml").write_text(yaml.safe_dump(study))
    return tr.run(place / "study.yaml", results=place, progress=False)


def test_loads_of_one_name_are_paired(tmp_path):
    results = named_loads(tmp_path, -200)
    rows = results.table
    assert (rows["regime"] != 0).tolist() == [case == "wet start" for case in rows["load_case"]]
    answer = results.answer
    assert answer.kind == "build"
    assert answer.headline["not_held"] == {"count": 1, "of": 3, "where": "load case wet start"}
    leader = answer.table.iloc[0]
    lives = rows[rows["regime"] == 0].groupby("roller_material")[LIFE].min()
    assert leader["roller_material"] == lives.idxmax()
    assert leader["low"] == pytest.approx(lives.max())
    other = answer.table.iloc[1]
    by_case = rows[rows["regime"] == 0].pivot(index="load_case", columns="roller_material", values=LIFE)
    ratios = by_case[other["roller_material"]] / by_case[leader["roller_material"]]
    assert (other["ratio_low"], other["ratio_high"]) == pytest.approx((ratios.min(), ratios.max()))
    unlike = [one.where for one in answer.warnings if one.code == "unlike"]
    assert unlike == ["values that differ in conditions of one name: friction coefficient"]


def test_unequal_loads_of_one_name_are_not_paired(tmp_path):
    answer = named_loads(tmp_path, -260).answer
    assert answer.table["ratio_low"].iloc[1:].isna().all()
    assert any(one.where.startswith("candidates have other conditions: ") for one in answer.warnings)
