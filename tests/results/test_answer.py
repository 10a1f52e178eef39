"""The record of an answer against raw rows, by code of its own: plain loops and pandas, nothing of the package."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

import trackroller as tr
from trackroller.report.headlines import headline_of
from trackroller.results.questions import question_of

LIFE = "pair_life_to_first_limit_hours"
BASE = {
    "guide_curve_radius": float("inf"),
    "roller_material": "1.7225-quenched-tempered",
    "guide_material": "1.7225-quenched-tempered",
    "guide_overrollings_per_hour": 60,
    "axial_force": 8,
    "motor_force": 0,
}


def solved(tmp_path_factory, name, **keys):
    place = tmp_path_factory.mktemp(name)
    given = {key: value for key, value in BASE.items() if key not in keys["factors"]}
    study = {
        "name": name,
        "base": given,
        "contact_model": "sliding",
        "accuracy": "preview",
        "outputs": ["forces", "contact", "peak_stress", "life", "limits"],
        **keys,
    }
    return tr.run(study, results=place, progress=False)


@pytest.fixture(scope="module")
def grooves(tmp_path_factory):
    """Grooves under loads of which one lifts every design off, with a choice that changes nothing."""
    factors = {
        "roller_profile_radius": {"values": [-6.2, -6.6, -7.5]},
        "radial_force": {"values": [-60, -150]},
        "axial_force": {"values": [0, 8, 90]},
        "cooled_area": {"values": [2000, 4000]},
    }
    target = {"target": {LIFE: {"min": 20000}}}
    return solved(tmp_path_factory, "grooves", factors=factors, analysis=target)


def raw(results):
    """Return one row a case from the variables of the data set, without the tables of the package."""
    names = [LIFE, "regime", "roller_profile_radius", "radial_force", "axial_force", "cooled_area"]
    names += [f"{LIFE}_low", f"{LIFE}_high"]
    frame = results.data[[n for n in names if n in results.data.data_vars]].to_dataframe().reset_index()
    return frame.assign(middle=np.sqrt(frame[f"{LIFE}_low"] * frame[f"{LIFE}_high"]))


def test_a_decision_agrees_with_raw_rows(grooves):
    answer = grooves.answer
    rows = raw(grooves)
    rows["held"] = rows["regime"] == 0
    rows = rows[rows["cooled_area"] == 2000]
    some = rows.groupby(["radial_force", "axial_force"])["held"].transform("any")
    assert answer.question == "decide"
    assert answer.headline["not_held"]["count"] == rows[~some].groupby(["radial_force", "axial_force"]).ngroups
    for _, row in answer.table.iterrows():
        own = rows[(rows["roller_profile_radius"] == row["roller_profile_radius"])]
        inside = own[some[own.index]]
        low, high = f"{LIFE}_low", f"{LIFE}_high"
        assert row["low"] == pytest.approx(np.where(inside["held"], inside[low], 0.0).min(), rel=1e-9)
        assert row["holds"] == own["held"].sum()
        assert row["of"] == len(own)
        assert row["best"] == pytest.approx(own[own["held"]][high].max(), rel=1e-9)
        assert row["median"] == pytest.approx(own[own["held"]]["middle"].median(), rel=1e-9)


def test_the_leader_and_its_ratios_agree_with_raw_rows(grooves):
    answer = grooves.answer
    rows = raw(grooves)
    rows = rows[(rows["cooled_area"] == 2000) & (rows["regime"] == 0)]
    ends = [
        rows.pivot_table(index=["radial_force", "axial_force"], columns="roller_profile_radius", values=f"{LIFE}_{end}")
        for end in ("low", "high")
    ]
    worst = np.sqrt(ends[0].min() * ends[1].min())
    leader = worst.idxmax()
    assert answer.table["roller_profile_radius"].iloc[0] == leader
    for _, row in answer.table.iterrows():
        ratios = [(table[row["roller_profile_radius"]] / table[leader]).dropna() for table in ends]
        middle = np.sqrt(ratios[0] * ratios[1])
        assert row["ratio_low"] == pytest.approx(middle.min(), rel=1e-6)
        assert row["ratio_high"] == pytest.approx(middle.max(), rel=1e-6)


LINES = {"fatigue": "bending line", "pressure_line": "rolling-contact line"}


def test_each_end_of_a_candidate_names_the_line_that_gives_it(grooves):
    """At the worst condition the lives of both bodies by both lines are compared by hand."""
    answer = grooves.answer
    for _, row in answer.table[answer.table["holds"] > 0].iterrows():
        hours = {}
        for end in ("low", "high"):
            own = grooves.data[f"life_hours_by_limit_{end}"].stack(row=grooves.dims)
            hours[end] = own.sel(limit=list(LINES)).isel(row=int(row["case"]))
        reached = {"low": hours["low"].min("limit"), "high": hours["high"].max("limit")}
        lines = {}
        for end, lives in reached.items():
            body = str(lives["body"].values[int(lives.values.argmin())])
            own = hours[end].sel(body=body)
            nearest = own.values.argmin() if end == "low" else own.values.argmax()
            lines[end] = LINES[str(own["limit"].values[nearest])]
            assert row[end] == pytest.approx(float(lives.min()), rel=1e-9)
        assert (row["line_low"], row["line_high"]) == (lines["low"], lines["high"])
        assert row["line"] == f"{lines['low']} to {lines['high']}"
    leader = answer.table.iloc[0]
    assert (answer.headline["line_low"], answer.headline["line_high"]) == (leader["line_low"], leader["line_high"])
    assert f"{leader['line_low']} to {leader['line_high']})" in headline_of(answer).text
    assert answer.headline["ends"] == answer.headline["ends_high"] == "fatigue"


def test_a_requirement_between_both_lines_asks_for_tests_in_rolling_contact(tmp_path_factory):
    """Between both lines the requirement is open; below or above both it is not."""
    factors = {"roller_profile_radius": {"values": [-6.6, -7.5]}}
    kinds = {}
    for least in (100.0, 20000.0, 1e9):
        results = solved(tmp_path_factory, "between", factors=factors, requirement={"pair_life_hours": {"min": least}})
        ends = [results.data[f"{LIFE}_{end}"].to_numpy() for end in ("low", "high")]
        kinds[least] = results.answer.kind, results.answer.headline["measure"]
        if least == 20000.0:
            assert (ends[0] < least).all() and (ends[1] > least).all()
            assert set(results.answer.table["state"]) == {"open"}
    assert kinds[100.0][0] == "build"
    assert kinds[20000.0][0] == "measure"
    assert kinds[20000.0][1]["what"] == "fatigue in rolling contact"
    assert kinds[20000.0][1]["of"] == "1.7225-quenched-tempered"
    assert kinds[1e9][0] == "none"


def test_a_material_of_bending_alone_is_named_so_in_the_table(tmp_path_factory):
    factors = {"roller_material": {"values": ["EN AW-7075", "1.7225-quenched-tempered"]}}
    results = solved(
        tmp_path_factory, "two", factors=factors, base={k: v for k, v in BASE.items() if k != "roller_material"}
    )
    lines = results.answer.table.set_index("roller_material")["line"]
    assert lines["EN AW-7075"] == "bending line alone"
    assert lines["1.7225-quenched-tempered"] == "bending line to rolling-contact line"


def test_states_follow_the_ends_and_the_error(grooves):
    for _, row in grooves.answer.table.iterrows():
        shortest = row["low"] / (1 + row["error"])
        if row["state"] == "met":
            assert shortest >= 20000
        if row["state"] == "missed":
            assert row["high"] < 20000 * (1 + 1e-9) or row["holds"] < row["of"]


def test_a_choice_without_effect_is_named_and_left_out(grooves):
    assert grooves.answer.not_used["cooled_area"] == "no effect"
    assert "cooled_area" not in grooves.answer.table
    assert all("cooled_area" not in names for names in grooves.answer.headline["names"])


def test_a_limit_that_was_not_computed_for_a_body_is_not_checked(grooves):
    heat = [word for word in grooves.answer.not_checked["roller"] if word.startswith("heat")]
    assert heat
    uses = grooves.data["utilisation"]
    known = "heat" in uses["limit"].values and bool(uses.sel(limit="heat", body="roller").notnull().any())
    assert not known


def test_warnings_count_raw_rows(grooves):
    counts = {one.code: one.count for one in grooves.answer.warnings}
    lost = raw(grooves)
    lost = lost[(lost["cooled_area"] == 2000) & (lost["regime"] != 0)]
    assert counts["not_held"] == len(lost)


def test_curves_are_medians_of_like_cases(grooves):
    rows = raw(grooves)
    held = rows[rows["regime"] == 0]
    curve = next(one for one in grooves.answer.curves if one.factor == "roller_profile_radius")
    others = ["radial_force", "axial_force", "cooled_area"]
    table = held.pivot_table(index=others, columns="roller_profile_radius", values=LIFE).dropna()
    by_hand = np.exp(np.log(table).median())
    assert curve.levels == tuple(table.columns)
    assert curve.middle == pytest.approx(by_hand.to_numpy(), rel=1e-9)
    assert curve.height == pytest.approx(by_hand.max() / by_hand.min(), rel=1e-9)


def test_the_record_is_json(grooves):
    text = json.dumps(grooves.answer.to_dict())
    record = json.loads(text)
    assert record["version"] == 3
    assert len(record["rows"]) == 3
    assert {"question", "kind", "headline", "columns", "warnings", "not_checked"} <= set(record)


def test_what_ends_the_cases_is_counted(grooves):
    ends = grooves.answer.ends
    numbers = ends.drop(columns=["factor", "level"])
    assert numbers.iloc[0].sum() == len(grooves.table)
    for _, part in ends[ends["factor"] != "all"].groupby("factor"):
        assert part.drop(columns=["factor", "level"]).to_numpy().sum() == len(grooves.table)


def test_nothing_holds(tmp_path_factory):
    factors = {"roller_profile_radius": {"values": [-6.2, -7]}, "axial_force": {"values": [120, 150]}}
    answer = solved(tmp_path_factory, "nothing", factors=factors).answer
    assert answer.kind in ("none", "give")
    assert (answer.table["holds"] == 0).all()


def test_contact_models_are_compared_on_like_cases(tmp_path_factory):
    factors = {
        "contact_model": {"values": ["sliding", "kalker"]},
        "friction_coefficient": {"values": [0.1, 0.3]},
        "roller_profile_radius": {"values": [-6.6, -7.5]},
    }
    results = solved(tmp_path_factory, "models", factors=factors)
    answer = results.answer
    lives = results.data[LIFE].to_dataframe().reset_index()
    table = lives.pivot_table(
        index=["friction_coefficient", "roller_profile_radius"], columns="contact_model", values=LIFE
    )
    ratio = table["sliding"] / table["kalker"]
    row = answer.table.set_index("model").loc["sliding"]
    assert answer.question == "which model"
    assert row["ratio_low"] == pytest.approx(ratio.min(), rel=1e-9)
    assert row["ratio_high"] == pytest.approx(ratio.max(), rel=1e-9)


def test_one_roller_under_drawn_conditions_has_a_share(tmp_path_factory):
    factors = {
        "radial_force": {"normal": [-100, 15]},
        "friction_coefficient": {"uniform": [0.05, 0.3]},
    }
    results = solved(
        tmp_path_factory,
        "share",
        factors=factors,
        design="lhs",
        samples=64,
        analysis={"target": {LIFE: {"min": 20000}}},
    )
    answer = results.answer
    lives = [results.data[f"{LIFE}_{end}"].to_numpy() for end in ("low", "high")]
    share = float((np.sqrt(lives[0] * lives[1]) >= 20000).mean())
    n, z = 64, 1.959964
    middle = (share + z**2 / (2 * n)) / (1 + z**2 / n)
    half = z * np.sqrt(share * (1 - share) / n + z**2 / (4 * n**2)) / (1 + z**2 / n)
    assert answer.question == "how sure"
    assert answer.headline["share"] == pytest.approx(share)
    assert answer.headline["share_low"] == pytest.approx(max(0.0, middle - half), abs=1e-6)
    assert answer.headline["share_high"] == pytest.approx(min(1.0, middle + half), abs=1e-6)
    # one end of each life is by the bending line, the other by the rolling-contact line
    assert answer.headline["share_short"] <= (lives[0] >= 20000).mean() < (lives[1] >= 20000).mean()
    assert answer.headline["share_long"] >= (lives[1] >= 20000).mean()


@pytest.mark.parametrize(
    ("keys", "question"),
    [
        ({"factors": {"roller_profile_radius": {"values": [-6.6, -7]}}}, "decide"),
        ({"factors": {"friction_coefficient": {"values": [0.1, 0.2]}}}, "how it behaves"),
        (
            {
                "factors": {"friction_coefficient": {"values": [0.1, 0.2]}},
                "analysis": {"target": {"peak_stress_roller": {"max": 500}}},
            },
            "how sure",
        ),
        (
            {
                "factors": {"radial_force": {"uniform": [-90, -60]}, "roller_profile_radius": {"uniform": [-8, -6.6]}},
                "method": "saltelli",
                "samples": 8,
            },
            "what matters",
        ),
        ({"factors": {"roller_profile_radius": {"values": [-6.6, -7]}}, "question": "what matters"}, "what matters"),
    ],
)
def test_the_question_follows_from_the_study(tmp_path_factory, keys, question):
    results = solved(tmp_path_factory, "asks", **keys)
    assert question_of(results) == question
    assert results.answer.question == question
    assert isinstance(results.answer.table, pd.DataFrame)


def test_a_stress_is_judged_like_a_life(tmp_path_factory):
    factors = {"roller_profile_radius": {"values": [-6.2, -6.6, -7.5]}, "radial_force": {"values": [-60, -150]}}
    wanted = {"target": {"peak_stress_roller": {"max": 420}}}
    results = solved(tmp_path_factory, "stress", factors=factors, analysis=wanted)
    peaks = results.data["peak_stress"].sel(body="roller").max("contact")
    for _, row in results.answer.table.iterrows():
        own = peaks.sel(roller_profile_radius=row["roller_profile_radius"])
        assert row["high"] == pytest.approx(float(own.max()), rel=1e-9)
        surely = float((own * (1 + row["error"])).max()) <= 420
        assert (row["state"] == "met") == surely or row["state"] == "open"
