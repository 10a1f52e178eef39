"""Designs over their conditions, against plain pandas on the raw rows."""

import json
import math

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from reference_cases import solve_sliding
from synthetic_results import results_of
from verdict_by_hand import check_verdict

import trackroller as tr
from trackroller.report.numbers import BEYOND
from trackroller.report.pages.study import contents
from trackroller.report.words.designs import best_table
from trackroller.report.words.pareto import pareto_sentence
from trackroller.report.words.verdict import verdict_sentences
from trackroller.results.candidates import lift_off_margin, slip_margin
from trackroller.results.pareto import study_pareto
from trackroller.roller.regime_limits import limits
from trackroller.study.file.load import parse_study

GRID = {
    "name": "choose",
    "design": "grid",
    "outputs": ["forces", "contact", "peak_stress", "life"],
    "contact_model": "sliding",
    "base": {"guide_overrollings_per_hour": 600},
    "factors": {
        "roller_profile_radius": {"values": [-6.5, -8, -10]},
        "material_pair": {
            "values": [["1.7225-quenched-tempered", "1.7225-normalised"], ["1.7225-normalised", "PA6"]],
        },
        "friction_coefficient": {"values": [0, 0.1, 0.3]},
        "motor_force": {"values": [0, -30]},
        "axial_force": {"values": [0, 70]},
    },
}
SAMPLE = {
    "design": "inner_outer",
    "samples": 32,
    "base": {"guide_overrollings_per_hour": 600, "motor_force": 0},
    "factors": {
        "roller_profile_radius": {"values": [-6.5, -8]},
        "contact_angle": {"values": [30, 40]},
        "friction_coefficient": {"uniform": [0.05, 0.3]},
        "axial_force": {"uniform": [0, 40]},
    },
}


def solved(**changes):
    """Return a study solved with full sliding, as its view, and its rows as one plain table."""
    study = parse_study(GRID | changes)
    ds = solve_sliding(study.design(), outputs=GRID["outputs"], life_rule=changes.get("life_rule", "elementary"))
    design = study.design()
    names = [n for n, v in design.variables.items() if v.dims == ("case",) and n != "case"]
    if "material_pair" in study.factors:
        pairs = [f"{a} / {b}" for a, b in design[["roller_material", "guide_material"]].to_dataframe().values[:, -2:]]
        ds = ds.assign_coords(material_pair=("case", np.array(pairs, dtype=object)))
    ds = ds.assign_coords({n: design[n] for n in names} | {"case": design["case"]})
    materials = {m for n in ("roller_material", "guide_material") for m in set(design[n].values.tolist())}
    known = {m: vars(study.materials.material(m)) for m in materials}
    values = {m: {k: v for k, v in own.items() if k == "name" or isinstance(v, float)} for m, own in known.items()}
    ds.attrs |= {"study": study.merged(), "materials": json.dumps(values)}
    frame = pd.DataFrame({n: design[n].values for n in names})
    for name in (
        "regime",
        "converged",
        "validity",
        "first_to_fail",
        *(f"{b}_life_hours" for b in ("roller", "guide", "pair")),
    ):
        frame[name] = ds[name].values
    frame["rolls"] = (frame["regime"] == 0) & (frame["converged"] == 1)
    outside = sum(1 << ds["validity"].attrs["flag_meanings"].split().index(f) for f in OUTSIDE)
    frame["valid"] = frame["rolls"] & ((frame["validity"] & outside) == 0)
    for body in ("roller", "guide"):
        cycles = ds["life_cycles"].sel(body=body).min("contact").values
        knee = np.array([values[m]["cycles_at_fatigue_limit"] for m in frame[f"{body}_material"]])
        frame[f"{body}_beyond"] = cycles > np.minimum(knee, 1e8)
    frame["beyond"] = np.where(frame["first_to_fail"] == 1, frame["guide_beyond"], frame["roller_beyond"])
    return ds, frame


OUTSIDE = ("half_space", "yield", "static", "conformal", "steep_friction")
LIFE = "pair_life_hours"
CHOICES = ["roller_profile_radius", "roller_material"]


def compared(frame, choices, life):
    """Return the numbers of each design by a group-by on the raw rows, the best design first."""
    frame = frame.assign(life=frame[life].where(frame["valid"]))
    groups = frame.groupby(choices)
    found = groups.agg(cases=("life", "size"), rolls=("rolls", "sum"), valid=("life", "count"), worst=("life", "min"))
    found["median"], found["best"] = groups.life.median(), groups.life.max()
    known = frame[frame["valid"]].groupby(choices)
    for code, word in enumerate(("roller", "guide", "none", "unknown")):
        found[f"first_{word}"] = known.first_to_fail.apply(lambda values, code=code: (values == code).sum())
    found["beyond"] = known.beyond.sum()
    return found.sort_values(["valid", "worst"], ascending=False)


@pytest.mark.parametrize("rate", [None, 600, 2e5], ids=["unknown", "roller first", "guide first"])
def test_designs_of_a_grid_against_a_group_by(rate):
    """Counts, lives, bodies that fail first and lives beyond the data; the sentence names the best design."""
    ds, frame = solved(base={"guide_overrollings_per_hour": rate} if rate else {})
    results = results_of(ds)
    designs = results.candidates()
    assert designs.matched and designs.comparable and not designs.drawn
    assert designs.conditions == ("friction_coefficient", "motor_force", "axial_force")
    life = "pair_life_hours" if rate else "roller_life_hours"
    expected = compared(frame, CHOICES, life)
    assert (designs.table["valid"] > 0).sum() == (expected["valid"] > 0).sum()
    expected, table = expected[expected["valid"] > 0], designs.table[designs.table["valid"] > 0]
    assert table["roller_profile_radius"].tolist() == expected.index.get_level_values(0).tolist()
    for name in expected:
        np.testing.assert_allclose(table[name], expected[name], err_msg=name)
    conditions = frame[frame["valid"]][list(designs.conditions)].drop_duplicates()
    assert designs.possible == len(conditions)
    said = {s.kind: s.values for s in verdict_sentences(results)}
    pairs = frame.assign(material_pair=results.table["material_pair"].to_numpy())
    check_verdict(results.verdict, pairs, list(designs.choices), list(designs.conditions), life)
    if rate is None:
        assert any("guide_overrollings_per_hour" in name for name in said["not_checked"]["names"])
        assert said["ends"]["who"] == "roller"
    else:
        best = results.verdict.best[0]
        assert best.body == ("guide" if frame["first_to_fail"][best.case] == 1 else "roller")
        assert (said["ends"]["who"], said["ends"]["body"]) == ("pair", best.body)


def test_the_worst_condition_is_named_and_the_pair_fails_with_its_first_body():
    ds, frame = solved(base={"guide_overrollings_per_hour": 2e5})
    np.testing.assert_array_equal(
        frame["pair_life_hours"], np.minimum(frame["roller_life_hours"], frame["guide_life_hours"])
    )
    results = results_of(ds)
    best, said = results.verdict.best[0], {s.kind: s.values for s in verdict_sentences(results)}
    worst = frame.iloc[best.case]
    assert worst["valid"] and worst["pair_life_hours"] == best.low
    drive = "free rolling" if worst["motor_force"] == 0 else "driven −30 N"
    friction = f"friction coefficient {worst['friction_coefficient']:g}"
    assert said["ends"]["where"] == f"{friction}, {drive}, axial force {worst['axial_force']:g} N"


def test_an_inner_outer_design_is_compared_by_the_life_that_nine_of_ten_reach():
    """The order statistic of raw rows, with cases that are not valid as life 0."""
    ds, frame = solved(**SAMPLE)
    designs = results_of(ds).candidates()
    assert designs.choices == ("roller_profile_radius", "contact_angle") and designs.drawn and designs.comparable
    lives = frame["pair_life_hours"].where(frame["valid"], 0.0)
    groups = lives.groupby([frame["roller_profile_radius"], frame["contact_angle"]])
    expected = groups.apply(lambda own: np.sort(own)[math.ceil(0.1 * len(own)) - 1]).sort_values(ascending=False)
    np.testing.assert_allclose(designs.table["b10"], expected)
    said = verdict_sentences(results_of(ds))[1].values
    assert said["sampled"] and said["candidate"].low == pytest.approx(expected.max()) and len(said["interval"]) == 2


def test_conditions_that_no_design_meets_are_left_out_of_the_life_that_nine_of_ten_reach():
    """The order statistic of the raw rows of the other conditions; the verdict and the table have the same number."""
    factors = SAMPLE["factors"] | {"axial_force": {"uniform": [0, 250]}}
    ds, frame = solved(**SAMPLE | {"factors": factors})
    results, choices = results_of(ds), ["roller_profile_radius", "contact_angle"]
    met = frame.groupby("axial_force")["valid"].transform("any")
    lives = frame["pair_life_hours"].where(frame["valid"], 0.0)[met]
    groups = lives.groupby([frame[name][met] for name in choices])
    expected = groups.apply(lambda own: np.sort(own)[math.ceil(0.1 * len(own)) - 1])
    found = results.candidates().table
    assert not met.all() and (expected == 0).any() and (expected > 0).any()
    np.testing.assert_allclose(found.set_index(choices)["b10"].sort_index(), expected.sort_index())
    assert [one.low for one in results.verdict.candidates] == found["b10"].tolist() and found["rank"].max() > 1


def test_a_sample_in_which_no_design_repeats_names_the_design_of_experiments_that_can_answer():
    factors = SAMPLE["factors"] | {"roller_profile_radius": {"uniform": [-8, -6.5]}}
    ds, frame = solved(design="lhs", samples=40, factors=factors)
    said = verdict_sentences(results_of(ds))
    assert said[0].kind == "cannot_tell" and frame["valid"].any()
    advice = next(one for one in said if one.kind == "unanswered")
    assert (advice.values["designs"], advice.values["most"]) == (40, 1)
    assert advice.values["choices"] == ["roller profile radius", "contact angle"]
    assert advice.values["conditions"] == ["friction coefficient", "axial force"] and "inner_outer" in advice.text
    page = contents(results_of(ds))
    assert "candidates" not in {t.name for t in page["tables"]["decide"]}
    ds, _ = solved(design="lhs", samples=40, factors={"roller_profile_radius": {"uniform": [-8, -6.5]}})
    said = verdict_sentences(results_of(ds))  # no condition varies: each row is a design under the one condition
    assert said[0].kind in ("build", "a_or_b") and "worst condition" not in " ".join(one.text for one in said)


def test_lives_beyond_the_data_are_never_bare():
    """All peaks below the fatigue limit: no hours stand alone, and an unlimited life is no number."""
    light = {"guide_overrollings_per_hour": 600, "radial_force": -1, "motor_force": 0}
    factors = {"roller_profile_radius": {"values": [-6.5, -8]}, "friction_coefficient": {"values": [0.0, 0.2]}}
    ds, frame = solved(base=light | {"axial_force": 0}, factors=factors)
    assert frame["beyond"].all()
    said = {one.kind: one.text for one in verdict_sentences(results_of(ds))}
    assert BEYOND in said["ends"] and BEYOND in said["next"]
    ds, _ = solved(base=light | {"axial_force": 0}, factors=factors, life_rule="unlimited")
    results = results_of(ds)
    said = {one.kind: one.text for one in verdict_sentences(results)}
    assert f"no failure ({BEYOND})" in said["ends"] and "unlimited" not in said["ends"]
    assert results.verdict.kind == "a_or_b" and results.verdict.why == "tie" and "They tie" in said["ends"]
    assert best_table(results_of(ds)).heads[1:] == ["Candidate 1 (tie)", "Candidate 1 (tie)"]


@pytest.mark.slow
def test_margins_against_the_searched_limits():
    """Slip margin: what the drive leaves of the motor force at which the roller skids; lift-off: 0 where it lifts."""
    cases = [tr.Case(), tr.Case(friction_coefficient=0.1, motor_force=-10), tr.Case(axial_force=78.0)]
    ds = solve_sliding(cases)
    data = {
        n: ("case", np.array([getattr(c, n) for c in cases]))
        for n in ("friction_coefficient", "motor_force", "axial_force")
    }
    results = results_of(ds.assign_coords(data))
    edges = [limits(c, "sliding").motor_force[0] for c in cases[:2]]
    expected = [1 - c.motor_force / edge for c, edge in zip(cases, edges, strict=False)]
    np.testing.assert_allclose(slip_margin(results)[:2], expected, atol=5e-5)
    loads = ds["normal_force"].values
    np.testing.assert_allclose(lift_off_margin(results), loads.min(axis=1) / loads.max(axis=1))
    assert lift_off_margin(results)[2] < 0.01  # lifts at 78.08 N


def test_roles_of_the_study_file_decide_what_a_design_is():
    ds, frame = solved(roles={"friction_coefficient": "choice", "roller_profile_radius": "condition"})
    designs = results_of(ds).candidates()
    assert set(designs.choices) == {"friction_coefficient", "material_pair"} and len(designs.size) == 6
    expected = compared(frame, ["friction_coefficient", "roller_material"], "pair_life_hours")
    np.testing.assert_allclose(designs.table["worst"].dropna(), expected["worst"].dropna())


def test_a_study_without_choices_has_one_design():
    factors = {"friction_coefficient": {"values": [0.1, 0.3]}, "axial_force": {"values": [0, 30]}}
    ds, frame = solved(factors=factors, base=GRID["base"] | {"motor_force": 0})
    results = results_of(ds)
    said = verdict_sentences(results)
    assert said[0].text.startswith("The pair lasts") and "next" not in {one.kind for one in said}
    assert results.verdict.kind == "lasts" and results.verdict.best[0].low == frame["pair_life_hours"].min()
    assert isinstance(ds, xr.Dataset) and best_table(results_of(ds)).heads == ["", "All conditions"]


def test_the_pareto_set_is_one_of_designs_at_their_worst_condition():
    """Goals by a group-by on raw rows, the set by brute force; the number of valid conditions is a goal, too."""
    ds, frame = solved()
    frame["pressure"] = ds["max_pressure"].max("contact").values
    valid = frame[frame["valid"]].groupby(CHOICES)
    expected = valid.agg(life=("pair_life_hours", "min"), pressure=("pressure", "max"), valid=("valid", "sum"))
    results = results_of(ds)
    front = study_pareto(results)
    assert front.attrs["objectives"] == "pair_life_hours max, max_pressure min"
    materials = [pair.split(" / ")[0] for pair in front["material_pair"].values]
    found = pd.DataFrame(
        {
            "life": front["pair_life_hours"].values,
            "pressure": front["max_pressure"].values,
            "valid": front["valid_in"].values,
        },
        index=pd.MultiIndex.from_arrays([front["roller_profile_radius"].values, materials]),
    )
    for name in expected:
        np.testing.assert_allclose(found[name].sort_index(), expected[name].sort_index(), err_msg=name)
    costs = found.to_numpy() * [-1, 1, -1]
    beaten = [any((o <= c).all() and (o < c).any() for o in costs) for c in costs]
    assert front["optimal"].values.tolist() == [int(not b) for b in beaten]
    said = pareto_sentence(front, results).values
    assert 1 < sum(front["optimal"].values) and len(expected) > 2
    assert (said["count"], said["of"], said["kind"]) == (sum(front["optimal"].values), len(expected), "design")
    most = frame[frame["valid"]].groupby(["friction_coefficient", "axial_force"]).ngroups
    assert said["partly"] == sum(o and v < most for o, v in zip(front["optimal"].values, found["valid"], strict=True))
    ds, _ = solved(base={})
    results = results_of(ds)
    assert BEYOND in pareto_sentence(study_pareto(results), results).values["first"][0]


def test_a_condition_that_is_a_goal_is_no_condition():
    ds, frame = solved(pareto={"pair_life_hours": "max", "axial_force": "max"})
    front = study_pareto(results_of(ds))
    worst = frame[frame["valid"]].groupby([*CHOICES, "axial_force"]).pair_life_hours.min()
    assert sorted(front["pair_life_hours"].values) == pytest.approx(sorted(worst))


def test_a_sample_of_cases_has_no_pareto_set_of_designs():
    factors = SAMPLE["factors"] | {"roller_profile_radius": {"uniform": [-8, -6.5]}}
    ds, _ = solved(design="lhs", samples=40, factors=factors)
    assert study_pareto(results_of(ds)) is None
    ds, _ = solved(design="lhs", samples=40, factors=factors, pareto={"pair_life_hours": "max", "max_pressure": "min"})
    results = results_of(ds)
    said = pareto_sentence(study_pareto(results), results)
    assert said.values["kind"] == "case" and "inner_outer" in said.text


def test_equal_designs_tie_and_one_design_is_no_set():
    light = {"guide_overrollings_per_hour": 600, "radial_force": -1, "motor_force": 0, "axial_force": 0}
    same = {"axis_distance": {"values": [20, 22]}, "friction_coefficient": {"values": [0.0, 0.2]}}
    goals = {"pair_life_hours": "max", "radial_force": "min"}
    ds, _ = solved(base=light, factors=same, pareto=goals, life_rule="unlimited")
    results = results_of(ds)
    said = pareto_sentence(study_pareto(results), results)
    assert (said.values["count"], said.values["of"], said.values["alike"]) == (2, 2, True)
    assert f"no failure ({BEYOND})" in said.text
    ds, _ = solved(factors={"friction_coefficient": {"values": [0.1, 0.2]}})
    results = results_of(ds)
    assert pareto_sentence(study_pareto(results), results).values["of"] == 1


def test_targets_are_met_by_designs():
    """Designs that meet a life of the pair in their conditions, by a group-by on raw rows."""
    ds, frame = solved(analysis={"target": {"min": 100}})
    results = results_of(ds)
    assert results.config.requirement["pair_life_hours"].least == 100
    hits = (frame["valid"] & (frame["pair_life_hours"] >= 100)).groupby([frame[n] for n in CHOICES]).sum()
    found = results.verdict
    assert sorted(one.met for one in found.candidates) == sorted(hits) and 0 < max(hits) < 12
    (radius, material), most = hits.idxmax(), hits.max()
    first = found.candidates[0]
    assert (first.choices["roller_profile_radius"], first.met, first.conditions) == (radius, most, 12)
    assert first.choices["material_pair"].startswith(material)
    row = next(r for r in best_table(results).rows if r[0] == "Meets the targets in")
    assert row[1] == f"{hits[results.candidates().table.iloc[0][CHOICES[0]], material]} of 12"
    ds, _ = solved(base={}, analysis={"target": {"min": 100}})
    assert any("guide_overrollings_per_hour" in name for name in verdict_sentences(results_of(ds))[-1].values["names"])
