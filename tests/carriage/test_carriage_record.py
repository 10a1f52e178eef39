"""The record of a carriage against its rollers, each solved alone: limits, requirements, second models, materials."""

import numpy as np
import pytest
from carts import ROLLER, cart, rollers_below, rollers_between, shuttle

import trackroller as tr
from trackroller.carriage.example import EXAMPLE
from trackroller.report.headlines import end_of_carriage, headline_of
from trackroller.results.carriage_answer import answer_of_carriage
from trackroller.yaml_file import parse_mapping

POM = ROLLER | {"guide_material": "POM-C", "permissible_wear_depth": 0.2, "guide_overrollings_per_hour": 60}
LAW = {"radial_force": 90.0, "axial_force": 40.0, "basic_life": 100.0, "law": "lubricated"}


def alone(ds, roller, values):
    """Return the results of one roller in each load case, and the share of the hours of each load case."""
    own = ds.sel(roller=roller)
    fields = {name: value for name, value in values.items() if name not in ("contact_model", "requirement")}
    cases = []
    for case in ds["load_case"].values:
        loads = {name: float(own[name].sel(load_case=case)) for name in ("radial_force", "axial_force")}
        speed = float(ds["speed"].sel(load_case=case))
        loads |= {} if np.isnan(speed) else {"velocity": 60 * speed}
        cases.append(tr.Case(**{**fields, **loads}))
    solved = tr.solve(cases, ("forces", "peak_stress", "life", "limits"), contact_model="sliding")
    time = ds["share"].values / np.array([case.velocity for case in cases])
    return solved, time


@pytest.fixture(scope="module")
def polymer():
    return tr.carriage(shuttle(rollers=rollers_between(roller=POM)))


def test_limits_are_those_of_the_rollers_over_the_load_cases(polymer):
    for roller in ("FL", "RR"):
        solved, time = alone(polymer, roller, POM)
        own = polymer.sel(roller=roller)
        np.testing.assert_allclose(
            own["utilisation"].sel(limit=solved["limit"].values), solved["utilisation"].max("case"), rtol=1e-12
        )
        for body in ("roller", "guide"):
            hours = solved["life_hours_by_limit"].sel(limit="wear", body=body).values
            mean = time.sum() / np.sum(time / hours)  # Palmgren-Miner by hand
            assert float(own["life_hours_by_limit"].sel(limit="wear", body=body)) == pytest.approx(mean, rel=1e-9)


def test_what_was_not_checked_is_listed_by_body(polymer):
    left = answer_of_carriage(polymer).not_checked
    roller, _ = alone(polymer, "FL", POM)
    for body in ("roller", "guide"):
        words = " ".join(left[body])
        for limit in ("rating", "heat", "wear", "fatigue", "shakedown"):
            unknown = bool(roller["utilisation"].sel(limit=limit, body=body).isnull().all())
            unknown &= bool(roller["life_hours_by_limit"].sel(limit=limit, body=body).isnull().all())
            assert (limit in words) == unknown, (limit, body)
    assert "rating (material 'POM-C' has no hardness)" in left["guide"]


def test_values_that_nobody_measured_or_gave_are_warnings(polymer):
    codes = {}
    for caution in answer_of_carriage(polymer).warnings:
        codes.setdefault(caution.code, []).append(caution.where)
    assert [text.partition(":")[0] for text in codes["guessed"]] == ["1.7225-quenched-tempered", "POM-C"]
    assert any("axis distance" in text and "axial force" not in text for text in codes["not_given"])


def test_a_catalogue_that_is_exceeded_comes_first_and_one_that_ends_sooner_is_told():
    rollers = rollers_below(catalogue=LAW)
    rollers["RR"]["catalogue"] = LAW | {"radial_force": 400.0}
    ds = tr.carriage(cart(rollers=rollers, cases=[{"name": "run", "speed": "1 m/s"}]))
    answer = answer_of_carriage(ds)
    factors = {name: float(-ds["radial_force"].sel(roller=name)[0]) / 90.0 for name in ("FL", "FR", "RL")}
    worst = max(factors, key=factors.get)
    assert factors[worst] > 1
    assert headline_of(answer).text.startswith(
        f"Catalogue of the roller {worst} exceeded ({100 * factors[worst]:.0f} %)"
    )
    assert answer.headline["exceeded"][0]["km"] == pytest.approx(100 / (0.03 + 0.97 * factors[worst]) ** 3, rel=1e-9)
    (told,) = [one.where for one in answer.warnings if one.code == "second_model" and "catalogue" in one.where]
    km = 100 / (0.03 + 0.97 * float(-ds["radial_force"].sel(roller="RR")[0]) / 400.0) ** 3
    assert ("RR" in told) == (km < float(ds["life_km"].sel(roller="RR")))
    assert not any("catalogue" in words for words in answer.not_checked["roller"])


def test_each_end_of_a_life_adds_up_one_line_and_names_it():
    """Damage of the load cases by each line alone; the shorter sum is the low end, the longer one the high end."""
    cases = [{"name": "slow", "share": 0.25, "speed": "0.5 m/s"}, {"name": "fast", "share": 0.75, "speed": "1 m/s"}]
    ds = tr.carriage(cart(cases=cases))
    answer = answer_of_carriage(ds)
    own = ds.sel(roller=answer.headline["roller"], body=answer.headline["body"])
    solved, time = alone(ds, answer.headline["roller"], ROLLER)
    lines = {"fatigue": "bending line", "pressure_line": "rolling-contact line"}
    for end, chosen in (("low", min), ("high", max)):
        lives = {}
        for name in lines:
            of_case = solved[f"life_hours_by_limit_{end}"].sel(limit=name, body=answer.headline["body"]).values
            lives[name] = float(time.sum() / (time / of_case).sum())
            assert float(own[f"life_hours_by_limit_{end}"].sel(limit=name)) == pytest.approx(lives[name], rel=1e-3)
        nearest = chosen(lives, key=lives.get)
        assert answer.headline[end] == pytest.approx(lives[nearest], rel=1e-3)
        assert answer.headline[f"line_{end}"] == lines[nearest]
    assert f"({answer.headline['line_low']} to {answer.headline['line_high']})" in headline_of(answer).text


def test_the_life_that_files_of_rollers_require_is_judged():
    cases = [{"name": "slow", "share": 0.25, "speed": "0.5 m/s"}, {"name": "fast", "share": 0.75, "speed": "1 m/s"}]
    ds = tr.carriage(cart(cases=cases))
    low, high = (float(ds[f"life_hours_{end}"].sel(roller="FL")) for end in ("low", "high"))
    pace = 0.25 / 1.8 + 0.75 / 3.6  # hours a km
    for least, state in ((0.5 * low, "met"), (np.sqrt(low * high), "open"), (2.0 * high, "missed")):
        travel = ROLLER | {"required_travel": least / pace, "permissible_wear_depth": 900}
        rollers = rollers_below(roller=travel)
        own = tr.carriage(cart(cases=cases, rollers=rollers))
        answer = answer_of_carriage(own)
        assert answer.headline["state"] == state and f": {state}" in headline_of(answer).text
        assert answer.required[0].least == pytest.approx(least, rel=1e-6)
    rollers = rollers_below()
    most = 2 * float(ds["life_hours_high"].sel(roller="RR"))
    rollers["RR"]["roller"] = ROLLER | {"requirement": {"pair_life_hours": {"min": most}, "slip": {"max": 1}}}
    answer = answer_of_carriage(tr.carriage(cart(cases=cases, rollers=rollers)))
    assert answer.headline["state"] == "missed" and answer.headline["of"] == ["RR"]
    assert dict(zip(answer.table["roller"], answer.table["state"], strict=True))["FL"] == ""
    assert any("requirement.slip in its file is not judged" in one.where for one in answer.warnings)


def test_an_unknown_life_is_bounded_by_its_known_load_cases():
    """A pull lifts a contact of FL in a rare load case; the run presses FL so that it lasts less than all others."""
    pull = {"name": "pull", "share": 0.01, "speed": "1 m/s", "forces": [{"force": [0, 0, -7000], "at": [150, 40, 0]}]}
    push = {"name": "run", "share": 0.99, "speed": "1 m/s", "forces": [{"force": [0, 0, -150], "at": [150, 40, 0]}]}
    loaded = ROLLER | {"guide_overrollings_per_hour": 60}
    ds = tr.carriage(shuttle(rollers=rollers_between(roller=loaded), cases=[pull, push]))
    lost = [str(one) for one in ds["roller"].values if np.isnan(ds["life_hours"].sel(roller=one))]
    assert "FL" in lost
    solved, time = alone(ds, "FL", loaded)
    known = solved.isel(case=1)
    assert int(solved["regime"].values[0]) != 0 and int(known["regime"].values) == 0
    by_hand = float(known["life_hours"].min()) * time.sum() / time[1]
    assert float(ds["life_hours_at_most"].sel(roller="FL")) == pytest.approx(by_hand, rel=1e-9)
    others = [float(ds["life_hours"].sel(roller=one)) for one in ds["roller"].values if one not in lost]
    answer = answer_of_carriage(ds)
    table = answer.table.set_index("roller")
    bounds = [float(table.loc[one, "at_most"]) for one in lost]
    assert min(bounds) < min(others, default=np.inf), "no roller whose life is known ends before"
    head = answer.headline
    assert head["roller"] == lost[int(np.argmin(bounds))] and head["at_most"] == pytest.approx(min(bounds))
    assert head["unknown_in"] == "pull (lift-off)"
    text = headline_of(answer).text
    assert "× 0 to" not in text
    assert f"{head['roller']} lasts at most" in text and "ends first" not in text and "pull" in text
    assert end_of_carriage(answer).startswith("The carriage lasts at most")


def test_rollers_stand_in_the_order_in_which_they_fail():
    """The lives of the rollers to their first limits, at their low ends, rise down the table."""
    ds = tr.carriage(parse_mapping(EXAMPLE, "carriage"))
    table = answer_of_carriage(ds).table
    lives = {str(one): float(ds["life_hours_low"].sel(roller=one)) for one in ds["roller"].values}
    assert sorted(lives, key=lives.get) == table["roller"].tolist() and len(set(lives.values())) > 1
