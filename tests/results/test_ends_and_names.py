"""Second models beside wear, placeholders that a factor spans, goals of a shelf and names of conditions."""

from __future__ import annotations

import numpy as np
import pytest

import trackroller as tr

BASE = {"guide_curve_radius": float("inf"), "motor_force": 0, "friction_coefficient": 0.14}
QUICK = {"contact_model": "sliding", "accuracy": "preview"}
SHELF = [
    {"name": name, "axis_distance": size, "roller_profile_radius": -6.5, "roller_material": material, "price": price}
    for name, size, material, price in (
        ("A18", 18, "EN AW-7075-T651", 9),
        ("L28", 28, "PA66-moist", 12),
        ("L20", 20, "PA66-moist", 13),
    )
]


def solved(place, **keys):
    return tr.run({"name": place.name} | QUICK | keys, results=place, progress=False)


@pytest.fixture(scope="module")
def shelf(tmp_path_factory):
    """Aluminium that wear may end early, beside plastic that lasts."""
    place = tmp_path_factory.mktemp("shelf")
    wear = {"permissible_wear_depth": 0.08, "guide_material": "42CrMo4+QT-40", "guide_overrollings_per_hour": 40}
    return solved(
        place,
        base=BASE | wear | {"axial_force": 4},
        factors={"roller": {"rows": SHELF}, "radial_force": {"values": [-30, -60]}},
        requirement={"pair_life_to_first_limit_hours": {"min": 40}},
        pareto={"axis_distance": "min", "price": "min"},
    )


def test_a_rating_does_not_lift_a_verdict_that_wear_leaves_open(shelf):
    data, answer = shelf.data.sel(roller="A18"), shelf.answer
    row = answer.table.set_index("roller").loc["A18"]
    wear = data["life_hours_by_limit_low"].sel(limit="wear").min(), data["life_hours_by_limit_high"].sel(limit="wear")
    assert float(wear[0]) < 40 < float(wear[1].min("body").min()), "wear alone leaves it open"
    rating = float(data["life_hours_by_limit"].sel(limit="rating").min())
    assert rating > 40 and row["second"] == "rating" and row["state"] == "open"
    assert row["second_state"] == "open"
    assert not [one for one in answer.warnings if one.code == "second_model"]


def test_each_goal_of_a_shelf_is_in_the_headline_and_in_a_column(shelf):
    answer = shelf.answer
    assert answer.headline["names"] == [{"roller": "L20"}] or answer.headline["names"] == [{"roller": "L28"}]
    named = answer.headline["names"][0]["roller"]
    values = {goal["words"]: goal["value"] for goal in answer.headline["goals"]}
    size = {"L28": 28.0, "L20": 20.0}[named]
    assert values["axis distance"] == size and values["price"] == {"L28": 12.0, "L20": 13.0}[named]
    column = next(one for one in answer.columns if one.title == "Axis distance")
    assert answer.table.set_index("roller")[column.name].to_dict() == {"A18": 18.0, "L28": 28.0, "L20": 20.0}


def test_a_placeholder_that_a_factor_spans_leaves_a_requirement_open(tmp_path):
    """The wear depth goes with the factor: below the limit at one end of it in all conditions, above at the other."""
    wear = {"roller_material": "POM", "guide_material": "42CrMo4+QT-40", "axial_force": 0}
    study = {
        "base": BASE | wear,
        "factors": {
            "roller_profile_radius": {"values": [-6.3, -6.6, -8]},
            "wear_coefficient_factor": {"values": [0.5, 2]},
            "radial_force": {"values": [-30, -60]},
        },
        "outputs": ["forces", "contact", "wear"],
    }
    plain = solved(tmp_path, **study, question="decide", requirement={"max_pressure": {"max": 1e4}})
    depth = plain.data["wear_depth_per_km"].sel(body="roller").max("contact")
    worst = depth.max("radial_force")
    own = worst.sel(roller_profile_radius=-6.6).values
    assert own[1] == pytest.approx(4 * own[0]), "a depth goes with the coefficient"
    most = float(np.sqrt(own[0] * own[1]))
    answer = solved(tmp_path, **study, requirement={"wear_depth_per_km_roller": {"max": most}}).answer
    for _, row in answer.table.iterrows():
        low, high = worst.sel(roller_profile_radius=row["roller_profile_radius"]).values
        expected = "met" if high <= most else "missed" if low > most else "open"
        assert row["state"] == expected
        assert (row["low"], row["high"]) == pytest.approx((low, high))
        may = (depth.sel(roller_profile_radius=row["roller_profile_radius"]) <= most).any("wear_coefficient_factor")
        assert row["perhaps"] == int(may.sum())
    assert "open" in set(answer.table["state"])


def test_a_place_of_a_placeholder_that_a_candidate_was_not_tried_at_does_not_leave_it_open(tmp_path):
    """B misses at the only wear coefficient that it has, A meets at both of its own."""
    lines = ["roller_profile_radius,wear_coefficient_factor,radial_force"]
    for radius, factor in ((-6.3, 0.5), (-6.3, 2), (-6.6, 2)):
        lines += [f"{radius},{factor},{load}" for load in (-30, -60)]
    (tmp_path / "rows.csv").write_text("\n".join(lines), encoding="utf-8")
    study = {
        "base": BASE | {"roller_material": "POM", "guide_material": "42CrMo4+QT-40", "axial_force": 0},
        "method": "table",
        "table": str(tmp_path / "rows.csv"),
        "outputs": ["forces", "contact", "wear"],
        "question": "decide",
    }
    plain = solved(tmp_path, **study, requirement={"max_pressure": {"max": 1e4}})
    depth = plain.data["wear_depth_per_km"].sel(body="roller").max("contact").values
    lost = (plain.table["roller_profile_radius"] == -6.6).to_numpy()
    assert depth[lost].min() > 0
    most = 0.5 * depth[lost].min()
    answer = solved(tmp_path, **study, requirement={"wear_depth_per_km_roller": {"max": most}}).answer
    states = dict(zip(answer.table["roller_profile_radius"], answer.table["state"], strict=True))
    assert states[-6.6] == "missed"


def test_conditions_of_a_table_go_by_their_names(tmp_path):
    lines = ["drawing,weather,roller_profile_radius,radial_force,motor_force,friction_coefficient"]
    for drawing, radius in (("A", -6.4), ("B", -7)):
        for weather, load, drive, friction in (("dry", -100, 0, 0.2), ("wet", -100, -4, 0.1), ("ice", -60, -6, 0.04)):
            lines.append(f"{drawing},{weather},{radius},{load},{drive},{friction}")
    (tmp_path / "loads.csv").write_text("\n".join(lines), encoding="utf-8")
    base = {"guide_curve_radius": float("inf"), "axial_force": 2, "guide_overrollings_per_hour": 60}
    results = solved(tmp_path, base=base, method="table", table=str(tmp_path / "loads.csv"))
    lost = results.table[results.table["regime"] != 0]
    assert set(lost["weather"]) == {"ice"} and len(lost) == 2
    assert results.answer.headline["not_held"] == {"count": 1, "of": 3, "where": "weather ice"}
    caution = next(one for one in results.answer.warnings if one.code == "not_held")
    assert caution.where == "skids 2: weather ice"
