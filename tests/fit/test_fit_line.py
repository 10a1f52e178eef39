"""The likelihood of a Basquin line against closed forms, its intervals and its posterior."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import integrate, optimize, stats

from trackroller.fit.line import Line, Tests
from trackroller.fit.posterior import Normal, log_prior, posterior

RNG = np.random.default_rng(5)
STRESS = np.log(np.repeat([700.0, 800.0, 900.0], 5))
LIVES = 12.0 - 7.0 * (STRESS - np.log(800.0)) + 0.5 * RNG.normal(size=15)


def complete(stress=STRESS, lives=LIVES):
    return Tests(np.asarray(stress), np.asarray(lives), np.asarray(lives))


def censored(at=12.0):
    ends = np.where(at < LIVES, np.inf, LIVES)
    return Tests(STRESS, np.minimum(LIVES, at), ends)


def test_without_censoring_the_line_is_the_regression():
    line = Line(complete())
    slope, level = np.polyfit(STRESS - line.reference, LIVES, 1)
    rest = LIVES - level - slope * (STRESS - line.reference)
    expected = [level, -slope, math.log(np.sqrt(np.mean(rest**2)))]
    assert line.estimate == pytest.approx(expected, rel=1e-6)


def test_the_interval_of_the_slope_follows_from_the_sums_of_squares():
    """For complete data the profile is -n/2 ln(RSS), so that an end solves RSS/RSS_0 = exp(t^2/n)."""
    line = Line(complete())
    x = STRESS - line.reference
    rss = float(np.sum((LIVES - LIVES.mean() + line.best.slope * (x - x.mean())) ** 2))
    t = stats.t.ppf(0.95, len(x) - 3)
    half = math.sqrt(rss * (math.exp(t**2 / len(x)) - 1.0) / np.sum((x - x.mean()) ** 2))
    low, high = line.interval("slope")
    assert (low, high) == pytest.approx((line.best.slope - half, line.best.slope + half), rel=1e-3)


def test_an_interval_of_a_life_holds_the_estimate_and_widens_away_from_the_tests():
    line = Line(censored())
    widths = []
    for stress in (800.0, 700.0, 600.0, 500.0):
        low, high = line.interval_of_life(math.log(stress), 0.1)
        assert low < float(line.log_life(line.best, math.log(stress), 0.1)) < high
        widths.append(high - low)
    assert widths == sorted(widths)


def test_inspections_that_bracket_lives_closely_tell_as_much_as_the_lives():
    close = Tests(STRESS, LIVES - 1e-4, LIVES + 1e-4)
    assert Line(close).estimate == pytest.approx(Line(complete()).estimate, abs=1e-4)


def test_the_likelihood_of_each_kind_of_end_is_its_probability():
    tests = Tests(np.array([6.0, 6.0, 6.0]), np.array([10.0, 10.0, -np.inf]), np.array([11.0, np.inf, 10.0]))
    values = np.array([[10.2, 7.0, math.log(0.4)]])
    parts = stats.norm.cdf(11, 10.2, 0.4) - stats.norm.cdf(10, 10.2, 0.4)
    expected = math.log(parts) + stats.norm.logsf(10, 10.2, 0.4) + stats.norm.logcdf(10, 10.2, 0.4)
    assert Line(tests).log_likelihood(values)[0] == pytest.approx(expected, rel=1e-9)


def test_a_random_knee_survives_by_its_limit_or_by_its_life():
    tests = Tests(np.array([6.0]), np.array([10.0]), np.array([np.inf]))
    values = np.array([[9.8, 7.0, math.log(0.4), 5.9, math.log(0.1)]])
    fails = stats.norm.cdf(6.0, 5.9, 0.1)
    expected = math.log(1.0 - fails * stats.norm.cdf(10.0, 9.8, 0.4))
    assert Line(tests, knee=True).log_likelihood(values)[0] == pytest.approx(expected, rel=1e-9)


def test_shifting_all_lives_shifts_the_line_alone():
    one, two = Line(censored()), Line(Tests(STRESS, censored().low + math.log(2), censored().high + math.log(2)))
    assert two.estimate - one.estimate == pytest.approx([math.log(2), 0, 0], abs=1e-6)


def test_no_failure_gives_the_bound_of_the_rule_of_three():
    """Without failures, all n tests survive with the probability of 5 % at the low end of the interval."""
    n = 8
    line = Line(Tests(np.full(n, 6.0), np.full(n, 12.0), np.full(n, np.inf)), slope=8.0, scatter=0.6)
    low, high = line.interval_of_life(6.0, 0.5)
    assert n * stats.norm.logsf((12.0 - low) / 0.6) == pytest.approx(math.log(0.05), rel=1e-3)
    assert high == math.inf


def test_the_posterior_agrees_with_a_quadrature():
    """For a held scatter and slope, the posterior of the level is one-dimensional."""
    line = Line(censored(), slope=7.0, scatter=0.5)
    found = posterior(line)
    grid = np.linspace(line.estimate[0] - 2, line.estimate[0] + 2, 2001)
    density = np.exp(line.log_likelihood(grid[:, None]) - line.largest)
    below = integrate.cumulative_trapezoid(density, grid, initial=0)
    expected = np.interp([0.05, 0.5, 0.95], below / below[-1], grid)
    assert found.quantile(found.values.level, np.array([0.05, 0.5, 0.95])) == pytest.approx(expected, abs=5e-3)


def test_the_posterior_of_three_values_agrees_with_a_grid():
    line = Line(censored(13.0))
    spans = [(a - w, a + w) for a, w in zip(line.estimate, (1.5, 10.0, 1.6), strict=True)]
    axes = [np.linspace(max(low, bound[0]), high, 71) for (low, high), bound in zip(spans, line.limits, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    weight = line.log_likelihood(points) + log_prior(line, points, {})
    weight = np.exp(weight - weight.max())
    life = line.log_life(line.values(points), math.log(600.0), 0.1)
    order = np.argsort(life)
    expected = np.interp([0.05, 0.5, 0.95], np.cumsum(weight[order]) / weight.sum(), life[order])
    found = posterior(line)
    mine = found.quantile(line.log_life(found.values, math.log(600.0), 0.1), np.array([0.05, 0.5, 0.95]))
    assert mine == pytest.approx(expected, abs=0.04)


def test_a_sharp_prior_holds_the_slope():
    found = posterior(Line(censored()), {"slope": Normal(9.0, 0.05)})
    assert found.quantile(found.values.slope, np.array([0.05, 0.95])) == pytest.approx([8.92, 9.08], abs=0.03)


def test_an_estimate_at_a_bound_is_named():
    lives = np.concatenate([np.full(3, 10.0), np.full(3, 10.0) + 1e-9])
    line = Line(complete(np.log([800.0] * 3 + [700.0] * 3), lives))
    assert set(line.at_bound) == {"slope"}


def test_the_interval_of_a_life_is_that_of_an_own_profile_where_newton_s_method_stalls():
    """Three kinds of censoring: from the last place of the profile alone, one end was 1.7 times too long."""
    stress = np.log([420.76, 420.76, 446.14, 446.14, 468.91, 468.91, 489.67, 489.67])
    low = np.log([1244937, 1915288, 957644, 478822, 191529, 335175, 114917, 86188])
    high = np.log([1244937, np.inf, 1436466, 718233, 287293, np.inf, 114917, np.inf])
    line = Line(Tests(stress, low, high))

    def loss(level, slope, log_scatter, reference):
        middle, scatter = level - slope * (stress - reference), math.exp(log_scatter)
        first, last = (low - middle) / scatter, (high - middle) / scatter
        exact = low == high
        likely = np.where(exact, stats.norm.logpdf(first) - log_scatter, 0.0)
        within = stats.norm.cdf(last[~exact]) - stats.norm.cdf(first[~exact])
        return -likely[exact].sum() - np.log(np.maximum(within, 1e-300)).sum()

    def profile(life, log_stress):
        """Return the least loss of lines on which 10 % have failed at `life`."""

        def own(rest):
            return loss(life - stats.norm.ppf(0.1) * math.exp(rest[1]), rest[0], rest[1], log_stress)

        starts = (11.0, -0.5), (22.0, -0.8)
        return min(optimize.minimize(own, start, method="Nelder-Mead").fun for start in starts)

    goal = loss(*line.estimate, line.reference) + line.cut_off(0.9)
    lows = []
    for own in (384.2, 388.56, 393.0, 402.0):
        interval = line.interval_of_life(math.log(own), 0.1)
        lows.append(interval.low)
        for end in interval:
            assert profile(end, math.log(own)) == pytest.approx(goal, abs=2e-3)
    assert lows == sorted(lows, reverse=True)
