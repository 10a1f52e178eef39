"""Lives stand in years beside hours where the duty of the roller is known."""

from __future__ import annotations

import math

import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.report.numbers import hour_unit, lasting, on_duty, quantity
from trackroller.roller.duty import checked_duty, years

DUTY = {"hours_per_day": 8, "days_per_year": 220}


def test_a_year_of_travel_at_all_hours_is_a_year():
    assert years(24 * 365, checked_duty({"hours_per_day": 24, "days_per_year": "365"})) == 1.0
    assert years(4400, checked_duty(DUTY)) == 2.5


def test_hours_have_their_years_only_where_a_duty_is_known():
    assert lasting(3520, "h") == "3520 h" == quantity(3520, "h")
    with on_duty(checked_duty(DUTY)):
        assert lasting(3520, "h") == "3520 h (2 years)" == quantity(3520, "h")
        assert lasting(3520, "km") == "3520 km" and hour_unit(math.inf) == "h" == hour_unit(math.nan)
    assert hour_unit(3520) == "h"


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ({"hours_per_day": 25, "days_per_year": 200}, "duty.hours_per_day = 25"),
        ({"hours_per_day": 16}, "duty.days_per_year = None"),
        ({"hours_per_day": 16, "days_per_yaer": 3}, "days_per_year"),
        (16, "duty = 16"),
    ],
)
def test_a_wrong_duty_is_refused_by_name(value, words):
    for refused in (lambda: checked_duty(value), lambda: tr.load_study({"name": "d", "duty": value})):
        with pytest.raises(tr.InputError, match=words):
            refused()


def test_solve_and_plan_take_the_duty(tmp_path):
    (tmp_path / "case.yaml").write_text("duty: {hours_per_day: 8, days_per_year: 220}\ncontact_model: sliding\n")
    told = trackroller("solve", "case.yaml", "--set", "accuracy=preview", cwd=tmp_path).stdout
    life = next(line for line in told.splitlines() if "roller, median life" in line)
    hours = float(life.split("known):")[-1].split(" h (")[0].replace(",", "").split()[-1])
    assert float(life.split(" h (")[1].split(" years")[0]) == pytest.approx(hours / 1760, rel=0.02)
    study = tr.load_study({"name": "d", "duty": DUTY, "outputs": ["forces"]})
    assert tr.load_study(study.as_dict()).config.duty == {"hours_per_day": 8.0, "days_per_year": 220.0}
