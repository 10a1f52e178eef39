"""The words of margins in the table of limits: bounds that a case gives, lives that do not exist, ranges in years."""

import trackroller as tr
from trackroller.report.numbers import between, on_duty
from trackroller.report.pages.sheet import collect
from trackroller.report.tables.limits import not_checked

FREE = {"motor_force": 0, "friction_coefficient": 0.1}


def margins_of(**values):
    ds = tr.solve(tr.Case(**FREE | values), contact_model="sliding", accuracy="preview")
    return {(margin.short, margin.body): margin for margin in collect(ds).margins}


def test_a_margin_of_wear_names_the_permissible_depth_that_was_given():
    found = margins_of(permissible_wear_depth=0.1, guide_overrollings_per_hour=60)
    for body in ("roller", "guide"):
        assert found["wear", body].required == "0.1 mm: permissible wear depth of roller and guide"


def test_a_body_that_breaks_at_once_has_no_fatigue_life():
    found = margins_of(radial_force=-900, roller_profile_radius=8.5)
    for body in ("roller", "guide"):
        assert found["static failure", body].life == "exceeded now"
        assert found["rolling-contact fatigue", body].life == "no fatigue life"


def test_a_range_of_years_whose_ends_read_alike_is_one_number():
    with on_duty({"hours_per_day": 16, "days_per_year": 250}):
        assert between(15_100, 15_300) == "15,100 to 15,300 h (3.8 years)"
        assert between(90, 6900) == "90 to 6900 h (up to 1.7 years)"


def test_a_value_that_was_given_for_limits_that_are_not_checked_is_named():
    def said(options=None, **values):
        ds = tr.solve(tr.Case(**FREE | values), contact_model="sliding", accuracy="preview", **options or {})
        return [text for text in not_checked(ds) if text.startswith("Given, but not used")]

    assert said(required_travel=40) == ["Given, but not used: required_travel, because wear is not checked."]
    left_out = said({"not_checked": ("wear",)}, permissible_wear_depth=0.1)
    assert left_out == ["Given, but not used: permissible_wear_depth, because wear is not checked."]
    assert said(permissible_wear_depth=0.1) == [] == said(guide_overrollings_per_hour=60)


def test_the_limit_that_the_verdict_names_leads_the_table():
    """The standard rating is a second model of fatigue; it is reached earlier here, and ends nothing by itself."""
    steel = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
    facts = collect(tr.solve(tr.Case(**FREE | steel, roller_profile_radius=-6.4), accuracy="preview"))
    rating = next(m for m in facts.margins if m.beside and m.body == "roller")
    assert facts.margins[0].short == "rolling-contact fatigue" and rating.low < facts.margins[0].hours
    assert facts.verdict.startswith("Rolls. Rolling-contact fatigue ends the roller")
