"""A hedge names the value whose range leaves a requirement open; what the model does not judge is not called lost."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest

import trackroller as tr
from trackroller.report.headlines import headline_of
from trackroller.report.tables.rows import rows_of
from trackroller.results.roller_answer import answer_of_roller

BASE = {"axis_distance": 26, "contact_angle": 45, "motor_force": 0, "friction_coefficient": 0.2, "axial_force": 4}
LIFE = "pair_life_to_first_limit_hours"
WORN = {"roller_material": "PA66-dry", "permissible_wear_depth": 0.15, "velocity": 80}
OUTPUTS = ["forces", "contact", "friction_work", "peak_stress", "life", "wear", "limits"]
MODEL = {"contact_model": "sliding", "accuracy": "preview"}


def solved(base=(), **keys):
    given = {name: value for name, value in (BASE | dict(base)).items() if name not in keys["factors"]}
    study = {"name": "ranges", "base": given, **MODEL, **keys}
    return tr.run(study, progress=False)


@pytest.mark.slow
def test_a_search_that_a_range_leaves_open_names_the_value_and_its_range():
    """The wear coefficient of a plastic on steel is a range, and the required life lies within that of the wear."""
    keys = {
        "factors": {"axis_distance": {"uniform": [20, 30]}, "radial_force": {"values": [-12, -30]}},
        "method": "optimise",
        "budget": {"designs": 16, "population": 8},
        "outputs": OUTPUTS,
        "goals": {"axis_distance": "min"},
        "not_checked": ["pressure_line"],
    }
    wear = tr.solve(BASE | WORN | {"axis_distance": 30, "radial_force": -30}, outputs=OUTPUTS, **MODEL)
    low, high = (float(wear[f"{LIFE}{end}"]) for end in ("_low", "_high"))
    assert high > 2 * low
    results = solved(WORN, requirement={LIFE: {"min": float(np.sqrt(low * high))}}, **keys)
    answer = results.answer
    assert answer.kind == "open"
    named = answer.headline["measure"]
    assert (named["what"], named["of"]) == ("wear_coefficient", "PA66-dry")
    text = headline_of(answer).text
    assert (
        text.startswith("Wear coefficient of PA66-dry") and "leaves" in text and " to " in text.partition(" leaves")[0]
    )
    assert named["low"] < named["high"]


def test_what_the_model_does_not_judge_is_not_called_lost():
    """At −2,000 N the deep groove breaks and the close one is no half-space; at −9 N both drives skid."""
    factors = {
        "roller_profile_radius": {"values": [-7, -6.02]},
        "radial_force": {"values": [-60, -120, -2000]},
        "motor_force": {"values": [0, -25]},
    }
    results = solved(factors=factors)
    table = results.table
    skids = (table["regime"] == 1).to_numpy()
    outside = results.flagged("half_space")
    groove = table["roller_profile_radius"].to_numpy()
    conditions = table.groupby(["radial_force", "motor_force"]).ngroup().to_numpy()
    failed = {
        int(one)
        for one in np.unique(conditions)
        if (skids | results.flagged("static"))[conditions == one].all() and not outside[conditions == one].any()
    }
    unknown = {int(one) for one in np.unique(conditions[outside & (groove == -6.02)])}
    assert failed and unknown and not failed & unknown
    head = results.answer.headline
    assert head["not_judged"]["count"] == len(unknown) and head["not_judged"]["of"] == 6
    assert head["not_held"]["count"] == len(failed) and head["not_held"]["of"] == 6 - len(unknown)
    text = headline_of(results.answer).text
    assert f"one holds in {len(failed)} of {6 - len(unknown)} judged conditions" in text
    assert f"{len(unknown)} of 6 conditions" in text and "not judged" in text


def test_a_single_candidate_says_how_many_loads_are_judged():
    factors = {"radial_force": {"values": [-60, -120, -2000]}}
    results = solved({"roller_profile_radius": -6.02}, factors=factors, requirement={LIFE: {"min": 1}})
    assert results.flagged("half_space").tolist() == [False, False, True]
    answer = results.answer
    assert (answer.headline["meets"], answer.headline["judged"], answer.headline["of"]) == (2, 2, 3)
    assert headline_of(answer).text.startswith("Meets 2 of 3 loads, 2 of them judged")


@pytest.mark.parametrize(("loads", "kind"), [([-60, -2000], "build"), ([-2000], "cannot_tell")])
def test_candidates_that_may_hold_every_condition_are_not_ruled_out(loads, kind):
    """The close groove holds at −60 N and is not judged at −2,000 N, where the other one breaks."""
    factors = {"roller_profile_radius": {"values": [-7, -6.02]}, "radial_force": {"values": loads}}
    assert solved(factors=factors).answer.kind == kind


LOADS = {"roller_profile_radius": {"values": [-6.3, -7]}, "radial_force": {"values": [-60, -120]}}


def test_a_required_life_of_the_roller_is_its_life_by_fatigue():
    """Wear ends the plastic roller long before fatigue does; the life that was asked for is judged, wear is said."""
    least = 5000.0
    keys = {"factors": LOADS, "outputs": OUTPUTS, "not_checked": ["pressure_line"]}
    results = solved(WORN, requirement={"roller_life_hours": {"min": least}}, **keys)
    rows = results.table
    by_groove = rows.groupby("roller_profile_radius")
    fatigue = by_groove["roller_life_hours"].min()
    first = results.data[f"{LIFE}_low"].min("radial_force").to_series()
    assert (first < least).all() and fatigue[-6.3] > least > fatigue[-7.0]
    answer = results.answer
    assert answer.output[0] == "roller_life_hours"
    assert answer.table["state"].tolist() == ["met", "missed"]
    assert answer.table["low"].tolist() == pytest.approx([fatigue[-6.3], fatigue[-7.0]])
    assert answer.headline["earlier"]["limit"] == "wear"
    assert answer.headline["earlier"]["low"] == pytest.approx(first[-6.3])
    text = headline_of(answer).text
    assert "life of the roller" in text and "wear of the roller comes first" in text


def test_a_sheet_judges_the_life_of_the_roller_that_was_asked():
    loads = {"roller_profile_radius": -6.3, "radial_force": -60}
    sheet = tr.solve(BASE | WORN | loads, outputs=OUTPUTS, **MODEL)
    life = float(sheet["roller_life_hours"])
    assert float(sheet[f"{LIFE}_high"]) < life
    for least, state in ((0.99 * life, "met"), (1.01 * life, "missed")):
        asked = sheet.assign_attrs(requirement=json.dumps({"roller_life_hours": {"min": least}}))
        answer = answer_of_roller(asked)
        assert answer.headline["states"] == [state]
        assert "required life of the roller at least" in headline_of(answer).text


@pytest.mark.parametrize("wanted", [{"min": 20}, {"max": 200}])
def test_an_output_of_a_roller_that_skids_everywhere_is_said_by_its_cause(wanted, tmp_path):
    """All loads skid: the record says so, and neither headline nor table shows an infinite force."""
    factors = {"roller_profile_radius": {"values": [-6.3, -7]}, "motor_force": {"values": [-60, -70]}}
    base = {"radial_force": -60}
    results = solved(base, factors=factors, requirement={"normal_force_1": wanted})
    assert (results.table["regime"] == 1).all() and results.table["normal_force_1"].notna().all()
    answer = results.answer
    assert answer.headline["nearest"]["cause"] == "skids" and set(answer.table["ends"]) == {"skids"}
    text = headline_of(answer).text
    assert text.endswith("skids everywhere.")
    tr.report(results, tmp_path / "page.html")
    rows = rows_of(answer)
    cells = [cell.text for row in rows.cells for cell in row]
    assert "not held" in cells and not [one for one in (*cells, *rows.shared, text) if "\u221e" in one]
    shown = re.sub(r"<script.*?</script>", "", (tmp_path / "page.html").read_text(), flags=re.S)
    assert "\u221e N" not in shown and "\u2212\u221e" not in shown


def test_a_turning_value_is_that_of_one_form_of_the_worn_groove():
    """The range of a life by wear is that of the coefficient times that of two forms; a turn moves the first one."""
    base = WORN | {"permissible_wear_depth": 0.02}
    results = solved(base, factors=LOADS, outputs=OUTPUTS)
    by_wear = results.data["life_hours_by_limit_low"].sel(limit="wear", body="roller", roller_profile_radius=-6.3)
    shortest = float(by_wear.min())
    asked = solved(base, factors=LOADS, outputs=OUTPUTS, requirement={LIFE: {"min": 3 * shortest}})
    named = asked.answer.headline["measure"]
    assert asked.answer.kind == "measure" and named["what"] == "wear_coefficient"
    longest = float(results.data["life_hours_by_limit_high"].sel(limit="wear", body="roller").max())
    assert longest / shortest > 1.05 * named["high"] / named["low"], "two forms widen the range of the life"
    step = (named["high"] / named["low"]) ** (1 / 200)
    assert named["high"] / 3 / step <= named["turn"] <= named["high"] / 3
