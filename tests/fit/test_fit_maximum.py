"""The maximum of the likelihood with a fatigue limit, against an own likelihood and other starts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import optimize
from scipy.special import log_ndtr

import trackroller as tr
from trackroller.fit.line import Line, Tests

KINDS = (
    "usual", "run-outs far below", "no run-outs", "run-outs at one level", "two levels", "few tests", "steep",
    "unbalanced", "sharp limit", "scattered stresses",
)  # fmt: skip
STARTS = 40
CLOSE = 1e-4  # of ln L
FEW, MANY = range(20), range(20, 220)
UNDER = {"load_type": "axial", "stress_ratio": -1}
COUPONS = [
    (460, 61000), (460, 98000), (430, 120000), (430, 75000), (400, 210000), (400, 310000), (370, 420000), (370, 600000),
]  # fmt: skip


def drawn(seed):
    """Return ln stress, ln cycles, and which specimens failed, of a random plan; None if too few failed."""
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    slope = rng.uniform(18, 45) if kind == "steep" else rng.uniform(4, 12)
    limit, knee = rng.uniform(200, 600), rng.uniform(3e5, 2e6)
    limit_scatter = 0.004 if kind == "sharp limit" else math.exp(rng.uniform(math.log(0.01), math.log(0.12)))
    scatter = math.exp(rng.uniform(math.log(0.15), 0.0))
    longest = math.log(rng.choice([2e6, 5e6, 1e7]))
    levels, count = rng.integers(4, 7), rng.integers(2, 6)
    if kind == "two levels":
        levels, count = 2, rng.integers(4, 9)
    if kind == "few tests":
        levels, count = rng.integers(6, 8), 1
    number = rng.integers(1, 9, levels) if kind == "unbalanced" else np.full(levels, count)
    stress = limit * np.repeat(np.linspace(rng.uniform(0.8, 1.0), rng.uniform(1.15, 1.5), levels), number)
    if kind == "scattered stresses":
        stress = stress * np.exp(0.03 * rng.normal(size=len(stress)))
    own_limit = limit * np.exp(limit_scatter * rng.normal(size=len(stress)))
    life = math.log(knee) - slope * np.log(stress / limit) + scatter * rng.normal(size=len(stress))
    fails = (stress > own_limit) & (life < longest)
    if kind == "no run-outs":
        fails[:] = True
    if kind == "run-outs at one level":
        kept = fails | (stress == stress.min())
        stress, life, fails = stress[kept], life[kept], fails[kept]
    below = {"run-outs far below": rng.uniform(0.25, 0.7, 3), "run-outs at one level": np.full(3, 0.7)}
    further = limit * below.get(kind, np.empty(0))
    stress, fails = np.append(stress, further), np.append(fails, np.zeros(len(further), bool))
    life = np.where(fails, np.append(life, np.full(len(further), longest)), longest)
    if fails.sum() < 2 or np.ptp(stress[fails]) < 1e-9 or len(stress) < 6:
        return None
    return np.log(stress), life, fails


def line_of(stress, life, fails):
    return Line(Tests(stress, life, np.where(fails, life, np.inf)), knee=True)


def own_log_likelihood(values, stress, life, fails, reference):
    """Return ln L from the probability of each end: to fail, above its own limit, or to last."""
    level, slope, log_scatter, log_limit, log_limit_scatter = values
    scatter = math.exp(log_scatter)
    z = (life - level + slope * (stress - reference)) / scatter
    above = (stress - log_limit) / math.exp(log_limit_scatter)
    ends = log_ndtr(above) - 0.5 * z**2 - log_scatter
    lasts = np.logaddexp(log_ndtr(-above), log_ndtr(above) + log_ndtr(-z))
    return float(np.where(fails, ends, lasts).sum())


def own_largest(stress, life, fails, line, held=None):
    """Return the largest ln L of many starts; `held` is a place among the values and its value."""
    rng = np.random.default_rng(1)
    limits, place = line.limits, None if held is None else held[0]
    bounds = limits if held is None else np.delete(limits, place, axis=0)
    slope, level = np.polyfit(stress[fails] - line.reference, life[fails], 1)

    def loss(free):
        values = free if held is None else np.insert(free, *held)
        return -own_log_likelihood(values, stress, life, fails, line.reference)

    best = math.inf
    for _ in range(STARTS):
        start = np.array([
            level + 0.5 * rng.normal(), -slope * math.exp(0.5 * rng.normal()), rng.uniform(-3.0, 0.7),
            rng.uniform(stress.min() - 0.4, stress.max() + 0.2), rng.uniform(-5.7, -0.7),
        ])  # fmt: skip
        start = start if held is None else np.delete(start, place)
        found = optimize.minimize(loss, np.clip(start, *bounds.T), method="L-BFGS-B", bounds=bounds)
        best = min(best, found.fun)
    return -best


def check_the_maximum(seed):
    tests = drawn(seed)
    if tests is None:
        return
    line = line_of(*tests)
    own = own_log_likelihood(line.estimate, *tests, line.reference)
    assert own == pytest.approx(line.largest, abs=1e-8), seed
    assert own > own_largest(*tests, line) - CLOSE, (seed, KINDS[seed % len(KINDS)])


@pytest.mark.parametrize("seed", FEW)
def test_no_other_start_finds_a_likelier_line(seed):
    check_the_maximum(seed)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(MANY.start, MANY.stop, 20))
def test_no_other_start_finds_a_likelier_line_of_many_plans(first):
    for seed in range(first, first + 20):
        check_the_maximum(seed)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["slope", "log_limit"])
@pytest.mark.parametrize("seed", [0, 1, 3, 7, 9, 16])
def test_the_own_profile_reaches_the_cut_off_at_the_ends_of_an_interval(seed, name):
    """A little beyond an end no start finds values that are likely enough."""
    tests = drawn(seed)
    line = line_of(*tests)
    place, goal = line.free.index(name), line.largest - line.cut_off(0.9)
    low, high = line.interval(name)
    for end, side in ((low, -1.0), (high, 1.0)):
        if end in line.bounds[name]:
            continue
        assert own_largest(*tests, line, (place, end)) == pytest.approx(goal, abs=0.05)
        for share in (0.05, 0.2, 0.5):
            beyond = end + side * share * (high - low)
            if line.bounds[name][0] < beyond < line.bounds[name][1]:
                assert own_largest(*tests, line, (place, beyond)) < goal


def columns(run_outs):
    amplitude, cycles = (list(values) for values in zip(*COUPONS, strict=True))
    return {
        "amplitude": [*amplitude, *run_outs],
        "cycles": [*cycles, *[1e7] * len(run_outs)],
        "failed": [True] * len(cycles) + [False] * len(run_outs),
    }


def test_run_outs_far_below_the_limit_change_neither_line_nor_limit():
    one = tr.fit_sn(columns([370, 350]), **UNDER)
    two = tr.fit_sn(columns([370, 350, 100, 100]), **UNDER)
    assert two.groups[0].line.largest == pytest.approx(one.groups[0].line.largest, abs=1e-6)
    for name in ("woehler_exponent", "fatigue_limit", "scatter_in_cycles"):
        assert two.material[name] == pytest.approx(one.material[name], rel=1e-3)
        # two more tests lower the cut-off a little, so that intervals are narrower
        narrow, wide = two.interval(name), one.interval(name)
        assert wide.low < narrow.low < two.material[name] < narrow.high < wide.high
    low, high = two.interval("cycles", amplitude=400)
    assert 1e5 < low < two.estimate("cycles", amplitude=400) < high < 1e6


def test_tests_that_a_line_alone_explains_give_no_limit():
    """A limit anywhere below the failures is as likely as none, so that no number may stand for it."""
    given = columns([200])
    given["amplitude"] += [210]
    given["cycles"] += [1e6]
    given["failed"] += [False]
    fit = tr.fit_sn(given, **UNDER)
    assert not fit.groups[0].line.knee
    assert any("No fatigue limit makes the tests likelier" in note for note in fit.notes)
    assert "scatter_in_stress" not in fit.material
    forced = tr.fit_sn(given, knee=True, **UNDER).groups[0].line
    assert not forced.limit_matters
    assert forced.largest == pytest.approx(fit.groups[0].line.largest, abs=1e-6)


def test_run_outs_shorter_than_the_longest_failure_bring_no_limit_and_a_word():
    given = columns([370, 350])
    given["cycles"] = [
        1e5 if not failed else cycles for failed, cycles in zip(given["failed"], given["cycles"], strict=True)
    ]
    fit = tr.fit_sn(given, **UNDER)
    assert not fit.groups[0].line.knee
    assert sum("The run-outs do not show a fatigue limit" in note for note in fit.notes) == 1
    assert tr.fit_sn(given, knee=True, **UNDER).groups[0].line.knee, "as the page on tests says"
    whole = tr.fit_sn(columns([]), **UNDER)
    assert not any("run-outs" in note for note in whole.notes)
