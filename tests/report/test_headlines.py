"""Each headline says the numbers of its record, in at most 40 words."""

from __future__ import annotations

import dataclasses
import math

import made_answers
import pytest
from made_answers import decide, required

from trackroller.report.headlines import DECISIONS, MOST_WORDS, TEMPLATES, WARNING_HEADS, headline_of, warning_line
from trackroller.results.answer import QUESTIONS, WARNINGS, Caution


@pytest.mark.parametrize("name", made_answers.ALL)
def test_a_headline_has_at_most_forty_words_and_one_sentence(name):
    head = headline_of(made_answers.ALL[name]())
    assert 3 <= len(head.text.split()) <= MOST_WORDS
    assert head.text.endswith(".") and head.text[0] == head.text[0].upper()
    assert "nan" not in head.text and "None " not in head.text[1:] and "  " not in head.text


def test_every_question_and_kind_has_a_template():
    assert set(QUESTIONS) <= set(TEMPLATES)
    kinds = {make().kind for make in made_answers.ALL.values() if make().question == "decide"}
    assert kinds == set(DECISIONS)
    assert {make().question for make in made_answers.ALL.values()} == set(QUESTIONS)


def test_every_warning_has_one_line():
    assert set(WARNING_HEADS) == set(WARNINGS)
    assert warning_line(Caution("not_held", 9, 1080, "friction 0.05")) == "Not held, 9 of 1,080 cases: friction 0.05"
    assert warning_line(Caution("at_end", 1, 1, "groove 6.2 mm", "candidates")) == "At an end, leader: groove 6.2 mm"


@pytest.mark.parametrize(
    ("name", "lead"),
    [
        ("build", "Build groove 6.2 mm, axis distance 26 mm"),
        ("tie", "Groove 6.2 or 6.3 mm"),
        ("none", "None reaches 20,000 h; nearest groove 6.2 mm"),
        ("measure", "Measure the wear coefficient of POM on steel (1·10⁻⁶ to 2·10⁻⁵ mm³/(N m))"),
        ("give", "Give the motor force: without it 12 of 54 conditions are lost"),
        ("sure", "82 % (78 to 85) of the 500 drawn conditions reach 5,000 h"),
        ("loads", "Meets 14 of 20 loads"),
        ("matters", "Roller steel and groove decide the life to the first limit"),
        ("models", "The verdict changes with the contact model, the order does not"),
        ("front", "No requirement, three designs"),
        ("behaves", "Life to the first limit 1.3·10⁻⁵ to 4.2·10⁹ h"),
    ],
)
def test_the_lead_is_the_answer(name, lead):
    assert headline_of(made_answers.ALL[name]()).lead == lead


def test_a_number_has_the_figures_of_its_error():
    head = {"low": 211_634.0, "high": 211_634.0}
    said = [headline_of(decide(headline=head | {"error": error})).ending for error in (0.48, 0.02)]
    assert " 210,000 h" in said[0] and " 212,000 h" in said[1]


def test_a_number_just_below_its_requirement_does_not_read_like_it():
    head = {"low": 19_960.0, "high": 19_960.0, "error": 0.3}
    assert "19,960 h" in headline_of(decide(headline=head)).ending


def test_years_are_said_from_one_year_on_and_up_to_a_thousand():
    def years(hours):
        one = made_answers.years()
        return headline_of(dataclasses.replace(one, headline={**one.headline, "low": hours, "high": hours})).ending

    assert "(53 years, extrapolated)" in years(212_000.0)
    assert "18 h (extrapolated)" in years(18.0)
    assert "(over 1,000 years, extrapolated)" in years(1e9)


def test_conditions_that_no_candidate_holds_come_first():
    lost = {"count": 20, "of": 54, "where": "all 12 driven at friction 0.05"}
    text = headline_of(decide(headline={"not_held": lost, "elsewhere": True})).text
    assert text.startswith("None holds in 20 of 54 conditions (all 12 driven at friction 0.05); elsewhere groove 6.2")


def test_a_text_that_is_too_long_stands_in_the_table_alone():
    lost = {"count": 20, "of": 54, "where": " and ".join(["friction 0.05"] * 9)}
    text = headline_of(decide(headline={"not_held": lost, "elsewhere": True})).text
    assert text.startswith("None holds in 20 of 54 conditions; elsewhere")


def test_an_exceeded_limit_and_a_second_model_are_in_the_headline():
    head = {"exceeded": {"limit": "catalogue", "body": "roller", "use": 2.62, "hours": 3.0}}
    head["second"] = {"limit": "the rating", "verdict": "missed"}
    assert "the rating misses; catalogue exceeded (262 %)" in headline_of(decide(headline=head)).ending


def test_what_does_not_roll_is_said_in_brackets():
    head = {"low": 0.0, "high": 0.0, "ends": "skids", "body": "", "extrapolated": False}
    assert "0 h (skids) at its worst condition" in headline_of(decide(headline=head)).ending


def test_several_requirements_are_named_together():
    stress = dataclasses.replace(made_answers.stresses().required[0])
    text = headline_of(decide(required=(required(), stress))).text
    assert "required 20,000 h and peak stress of the roller at most 420 MPa" in text


@pytest.mark.parametrize("hidden", ["low", "high", "ends", "body", "error", "extrapolated"])
def test_a_key_that_is_missing_is_left_out(hidden):
    one = decide()
    for value in (None, math.nan):
        head = {**one.headline, hidden: value}
        if hidden == "high" or value is None:
            text = headline_of(dataclasses.replace(one, headline={k: v for k, v in head.items() if k != hidden})).text
            assert "None" not in text and "nan" not in text


def test_a_range_leaves_conditions_open_in_the_count():
    near = made_answers.nearest().headline["nearest"]
    said = [
        headline_of(decide("none", headline={"names": [], "nearest": near | more})).text
        for more in ({"perhaps": 9}, {"perhaps": 11}, {"meets": 0, "fails": "everywhere"})
    ]
    assert "meets 9 of 12" in said[0] and "meets 9 to 11 of 12" in said[1]
    assert said[2].endswith("fails everywhere.")
