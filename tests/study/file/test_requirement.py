"""The keys requirement, question, method and own of a study, and a requirement in the file of one roller."""

import numpy as np
import pytest

import trackroller as tr
from trackroller.roller.requirement import checked_requirement, requirement_of
from trackroller.roller.settings import checked_case, with_beside
from trackroller.study.file.load import parse_study

DUTY = {"hours_per_day": 16, "days_per_year": 250}
HEAD = {
    "name": "keys",
    "base": {"radial_force": -200, "motor_force": 0, "guide_curve_radius": "inf"},
    "factors": {"friction_coefficient": {"values": [0.1, 0.2]}, "axis_distance": {"values": [20, 22]}},
    "outputs": ["forces", "contact", "friction_work", "peak_stress", "life", "limits"],
    "contact_model": "sliding",
    "accuracy": "preview",
}


def test_years_are_hours_of_the_duty_and_stand_in_the_file_as_they_were_written():
    wanted = {"pair_life_hours": {"min": "3 years", "probability": "95 %"}}
    study = tr.load_study({**HEAD, "duty": DUTY, "requirement": wanted})
    own = study.config.requirement["pair_life_hours"]
    assert (own.least, own.most, own.years, own.probability) == (3 * 16 * 250, np.inf, 3.0, 0.95)
    again = parse_study(study.as_dict()).config.requirement["pair_life_hours"]
    assert again == own and again.written == {"min": "3 years", "probability": 0.95}


def test_the_other_names_of_requirement_and_method_mean_the_same():
    one = tr.load_study({**HEAD, "method": "grid", "requirement": {"min": 500}})
    other = tr.load_study({**HEAD, "design": "grid", "analysis": {"target": {"min": 500}}})
    assert one.merged() == other.merged() and "method: grid" in one.merged()
    assert one.config.requirement["pair_life_hours"].ends == {"min": 500.0}


@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ({"requirement": {"pair_life_hours": {"min": "3 years"}}}, "needs a duty.*Write duty"),
        ({"requirement": {"pair_life_hours": {"min": 5, "probability": 1.2}}}, "probability = 1.2.*above 0"),
        ({"requirement": {"pair_life_hours": {"probability": 0.9}}}, "min, max or both"),
        ({"requirement": {"pair_life_hours": {"mim": 9, "max": 10}}}, "Did you mean 'min'"),
        ({"requirement": {"pair_life_hors": {"min": 9}}}, "requirement = .*Did you mean 'pair_life_hours'"),
        ({"requirement": {"max_pressure": {"min": 9, "max": 3}}}, "min below max"),
        ({"requirement": {"max_pressure": {"max": "3 years"}}}, "converted to MPa"),
        ({"requirement": {"min": 9}, "analysis": {"target": {"min": 9}}}, "requirement.*Remove analysis.target"),
        ({"method": "grid", "design": "grid"}, "method = .*Remove design"),
        ({"method": "gird"}, "method = 'gird'.*Did you mean 'grid'"),
        ({"design": "gird"}, "design = 'gird'.*Did you mean 'grid'"),
        ({"question": "what matter"}, "Did you mean 'what matters'"),
        ({"own": {"heat": "friction_powr_2"}}, "own.heat.*Did you mean 'friction_power_2'"),
        ({"own": {"axial_force": "slip"}}, "is no parameter"),
        ({"own": {"slip": "2*friction_power_2"}}, "results do not use for something else"),
        ({"own": {"rate": "2*regime"}}, "arithmetic with a text"),
    ],
)
def test_a_wrong_key_is_refused_with_a_remedy(keys, named):
    with pytest.raises(tr.InputError, match=named):
        tr.load_study({**HEAD, **keys})


def test_the_remedy_for_years_works():
    wanted = {"requirement": {"pair_life_hours": {"min": "3 years"}}}
    with pytest.raises(tr.InputError) as refused:
        tr.load_study({**HEAD, **wanted})
    assert "duty: {hours_per_day: 16, days_per_year: 250}" in str(refused.value)
    assert tr.load_study({**HEAD, **wanted, "duty": DUTY}).config.requirement["pair_life_hours"].least == 12000


def test_a_factor_made_of_results_is_pointed_to_own_outputs():
    factors = {**HEAD["factors"], "friction_coefficient": {"expression": "friction_power_2 / 1000"}}
    with pytest.raises(tr.InputError, match=r"computed before the solution.*under own:"):
        tr.load_study({**HEAD, "factors": factors})


def test_an_own_output_is_an_output_like_any_other():
    text = "friction_power_2/(friction_coefficient*normal_force_2)"
    keys = {"own": {"heat_per_force": text}, "requirement": {"heat_per_force": {"max": 0.5}}}
    keys |= {"analysis": {"outputs": ["heat_per_force"]}, "constraints": ["heat_per_force > 0"]}
    results = tr.run({**HEAD, **keys}, progress=False)
    data = results.data
    power, force = (data[name].sel(contact=2) for name in ("friction_power", "normal_force"))
    by_hand = (power / (data["friction_coefficient"] * force)).transpose(*results.dims).values.ravel()
    np.testing.assert_allclose(results.to_table()["heat_per_force"], by_hand)
    assert results.meets("heat_per_force").tolist() == (by_hand <= 0.5).tolist()
    assert results.indices()["output"].values.tolist() == ["heat_per_force"]
    assert results.allowed.all()


def test_the_file_of_a_roller_takes_a_requirement():
    wanted = {"pair_life_to_first_limit_hours": {"min": "3 years"}, "peak_stress_roller": {"max": "0.6 GPa"}}
    case, options, beside = checked_case({"contact_model": "sliding", "duty": DUTY, "requirement": wanted})
    found = requirement_of(with_beside(tr.solve(case, **options), beside))
    assert found["pair_life_to_first_limit_hours"].least == 12000
    assert found["peak_stress_roller"].most == pytest.approx(600)
    with pytest.raises(tr.InputError, match=r"probability.*one roller has one condition"):
        checked_case({"requirement": {"max_pressure": {"max": 900, "probability": 0.9}}})
    with pytest.raises(tr.InputError, match="Did you mean 'max_pressure'"):
        checked_case({"requirement": {"max_presure": {"max": 900}}})


def test_a_value_that_is_not_known_meets_no_requirement():
    own = checked_requirement({"slip": {"min": -1, "max": 1}})["slip"]
    assert own.meets(np.array([-1.0, 1.0, 1.1, np.nan])).tolist() == [True, True, False, False]


BEARING = {"rows": 2, "row_distance": 8, "kind": "ball", "dynamic_rating": 3000, "static_rating": 1500}
BEARING |= {"e": 0.3, "X": 0.56, "Y": 1.5, "X0": 0.6, "Y0": 0.5}


def test_bearings_as_levels_have_their_names_or_short_ones():
    from trackroller.study.design.levels import in_words

    levels = [{**BEARING, "name": "NSK-6000"}, BEARING, {**BEARING, "dynamic_rating": 600}]
    keys = {**HEAD, "factors": {"bearing": {"values": levels}}, "outputs": [*HEAD["outputs"], "bearing"]}
    texts = [in_words("bearing", one) for one in tr.load_study(keys).factors["bearing"]["values"]]
    assert texts[0] == "NSK-6000" and len(set(texts)) == 3 and max(map(len, texts)) <= 40
    assert texts[2].startswith("ball, dynamic rating 600")
    keys["factors"] = {"bearing": {"values": [{**BEARING, "name": "A"}, {**BEARING, "e": 0.2, "name": "A"}]}}
    with pytest.raises(tr.InputError, match="a name of its own for each level"):
        tr.load_study(keys)
