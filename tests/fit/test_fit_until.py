"""How many more tests a user needs, against a closed form and own campaigns."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

import trackroller as tr
from trackroller.fit.next_tests import tests_until as until
from trackroller.report.pages.fit import next_sentences, until_sentences

UNDER = {"load_type": "rolling contact", "stress_ratio": -1}
ROWS = {"amplitude": [520, 500, 480, 460, 440], "cycles": [2.1e5, 3.5e5, 6e5, 9e5, 1.1e6], "failed": [True] * 5}
FREE = {"motor_force": 0, "friction_coefficient": 0.1}
CANDIDATES = [FREE | {"radial_force": force} for force in (-150, -250)]
DESIGN = FREE | {"radial_force": -120}


def planned(fit, **more):
    return tr.next_tests(fit, CANDIDATES, DESIGN, tests=2, **more)


def test_with_held_slope_and_scatter_the_number_has_a_closed_form():
    """The width is then that of a mean with a known deviation s: 2 s sqrt(2 c/n), with c by the cut-off of n tests."""
    fit = tr.fit_sn(ROWS, slope=8, scatter_in_cycles=4, **UNDER)
    s = math.log(4) / (2 * stats.norm.ppf(0.9))

    def width(n):
        t = stats.t.ppf(0.95, n - 1)
        return 2 * s * math.sqrt(2 * min(t**2 / 2, n / 2 * math.log1p(t**2 / (n - 1))) / n)

    factor = 1.5
    expected = next(n for n in range(1, 200) if width(5 + n) <= math.log(factor))
    found = until(fit, planned(fit), factor, campaigns=4)
    assert found.tests.values.tolist() == [expected] * 4
    assert (found.hours > 0).all()
    said = until_sentences(found, factor)
    assert f"about {expected} more tests" in said[0]
    assert f"nine of ten need {expected} to {expected} tests" in said[1]


def test_no_test_is_needed_for_a_factor_that_is_reached():
    fit = tr.fit_sn(ROWS, slope=8, scatter_in_cycles=4, **UNDER)
    plan = planned(fit)
    low, high = plan.interval_now.values
    found = until(fit, plan, 1.01 * high / low)
    assert not found.tests.values.any()
    assert "no further test is needed" in until_sentences(found, 9)[0]
    assert f"{low:.4g}"[:3] in next_sentences(plan)[0]


@pytest.mark.slow
def test_a_campaign_ends_at_the_number_that_the_fit_confirms():
    """Own campaigns with the line of the fit: the interval is narrow enough after about that number of tests."""
    given = ROWS | {"cycles": [1.6e5, 4e5, 5e5, 1.2e6, 1.0e6]}
    fit = tr.fit_sn(given, **UNDER)
    plan, factor = planned(fit), 3.0
    found = until(fit, plan, factor, campaigns=40)
    low, middle, high = np.quantile(found.tests.values, (0.05, 0.5, 0.95), method="inverted_cdf")
    assert 1 <= low < middle < high
    line, rng = fit.groups[0].line, np.random.default_rng(8)
    chosen, numbers = plan.chosen.values, []
    for _ in range(6):
        rows = {name: list(values) for name, values in given.items()}
        while True:
            stress = float(plan.stress.values[chosen[(len(rows["cycles"]) - 5) % len(chosen)]])
            life = line.best.level - line.best.slope * (math.log(stress) - line.reference)
            rows["amplitude"].append(stress)
            rows["cycles"].append(round(math.exp(life + math.exp(line.best.log_scatter) * rng.normal())))
            rows["failed"].append(True)
            ends = tr.fit_sn(rows, **UNDER).interval(
                "cycles", amplitude=float(plan.design_stress), failure_probability=0.1
            )
            if ends.high < factor * ends.low:
                break
        numbers.append(len(rows["cycles"]) - 5)
    assert low <= np.median(numbers) <= high


@pytest.mark.parametrize("factor", [1.0, 0.5, math.nan])
def test_a_factor_that_is_none_is_refused(factor):
    fit = tr.fit_sn(ROWS, slope=8, scatter_in_cycles=4, **UNDER)
    with pytest.raises(tr.InputError, match=r"until = .*a finite number above 1.*Give 2"):
        until(fit, planned(fit), factor)
