"""The number of samples that the report asks for: enough on functions with known indices, and not far too many."""

import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import stats
from synthetic_results import results_of

from trackroller.methods.b10 import b10 as life_of_nine_in_ten
from trackroller.report.words.samples import of_target, samples, undecided
from trackroller.results.sensitivity import analyse
from trackroller.study.file.load import parse_study

PI = np.pi
CARRIERS = {
    "axial_force": {"uniform": [-PI, PI]},
    "motor_force": {"uniform": [-PI, PI]},
    "velocity": {"uniform": [1.0, 1.0 + 2 * PI]},
}
V = np.array([0.5 * (1 + 0.1 * PI**4 / 5) ** 2, 49 / 8, 8 * 0.01 * PI**8 / 225])  # Ishigami, a = 7, b = 0.1
EXACT = {"ST": np.array([V[0] + V[2], V[1], V[2]]) / V.sum(), "first": np.array([V[0], V[1], 0]) / V.sum()}


def analysed(design, count, seed):
    """Analyse a study whose friction power is the Ishigami function of three factors."""
    data = {"name": "e", "design": design, "samples": count, "seed": seed, "factors": CARRIERS}
    data["analysis"] = {"outputs": ["friction_power"]}
    data["outputs"] = ["forces", "friction_work"]
    study = parse_study(data | ({"second_order": False} if design == "saltelli" else {}))
    ds = study.design()
    x1, x2, x3 = ds["axial_force"].values, ds["motor_force"].values, ds["velocity"].values - 1 - PI
    ds["friction_power"] = ("case", np.sin(x1) + 7 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1))
    return analyse(results_of(ds))


@pytest.mark.parametrize(
    ("design", "index", "start"), [("saltelli", "ST", 60), ("lhs", "first", 200), ("morris", "", 8)]
)
def test_the_number_asked_for_is_enough_and_not_far_too_much(design, index, start):
    """The half width at that number is at most the promised one and a quarter more, and the indices lie within it."""
    said = samples(analysed(design, start, 1), start)
    assert said.kind == "more"
    number = int(re.search(r"Write `samples: (\d+)`", said.text)[1])
    base = 64 if design == "saltelli" else start
    assert number % base == 0 and (number // base).bit_count() == 1
    late = analysed(design, number, 2)
    half = float(late["half_width"][0])
    assert half < 1.25 * said.values["predicted"] and half > 0.4 * said.values["predicted"]
    assert samples(late, number).kind == "enough" or half < 1.25 * (0.15 if design == "morris" else 0.05)
    assert float(analysed(design, number // 4, 3)["half_width"][0]) > (0.15 if design == "morris" else 0.05)
    if index:
        assert np.abs(late[index].values[0] - EXACT[index]).max() < 1.25 * half


def lives(count, seed, spread=0.2):
    """Return two design points with a lognormal life, of which B10 and the probability of 1,000 h are known."""
    data = {"name": "e", "design": "inner_outer", "samples": count, "seed": seed, "outputs": ["forces", "life"]}
    data["factors"] = {"velocity": {"values": [30.0, 60.0]}, "axial_force": {"normal": [0.0, 1.0]}}
    data["factors"]["friction_coefficient"] = {"uniform": [0.1, 0.3]}
    data["analysis"] = {"target": {"roller_life_hours": {"min": 1000}}}
    study = parse_study(data)
    ds = study.design()
    logs = 3 + spread * ds["axial_force"].values - 0.1 * (ds["velocity"].values > 45)
    ds["roller_life_hours"] = ("case", 10**logs, {"units": "h"})
    return analyse(results_of(ds))


def test_design_points_need_samples_for_b10_and_probabilities():
    said = samples(lives(50, 1), 50)
    assert said.kind == "more"
    late = lives(said.values["number"], 2)
    b10, low, high = (float(late[n].sel(output="roller_life_hours")[0]) for n in ("b10", "b10_low", "b10_high"))
    assert (high - low) / 2 / b10 < 1.3 * said.values["predicted"] <= 1.3 * 0.1
    exact = 10 ** (3 - 0.2 * stats.norm.ppf(0.9))
    assert abs(b10 / exact - 1) < 1.25 * said.values["predicted"]
    assert samples(late, said.values["number"]).kind == "enough"
    # so few that the lower bound of B10 is the shortest life itself
    few = samples(lives(20, 1, 0.001).drop_dims("target"), 20)
    assert few.kind == "more" and "Write `samples: 80`" in few.text


def test_designs_without_samples_are_not_told_to_take_more():
    sens = analysed("lhs", 200, 1)
    assert samples(sens.assign_attrs(method="central_composite"), 200) is None
    table = samples(sens.assign_attrs(method="table", rows=200), 1024)  # `samples` does not count for a table
    assert table.text.split("only. ")[1].startswith(f"A table of {table.values['number']} rows gives")
    assert table.values["number"] == 200 * table.values["take_times"]


@pytest.mark.slow
def test_first_order_indices_above_100_percent_say_why():
    """A small sample of a function without interactions, and factors that are correlated."""
    study = {"name": "e", "design": "lhs", "samples": 40, "seed": 1, "outputs": ["forces", "friction_work"]}
    study |= {"factors": CARRIERS, "analysis": {"outputs": ["friction_power"]}}

    def note(samples, seed, **extra):
        parsed = parse_study(study | {"samples": samples, "seed": seed} | extra)
        ds = parsed.design()
        ds["friction_power"] = ("case", ds["axial_force"].values + ds["motor_force"].values)
        found = analyse(results_of(ds))
        assert float(found["first_order_sum"][0]) == pytest.approx(float(found["first"].clip(0).sum()))
        return str(found["first_order_sum_note"].values[0])

    small = [note(40, seed) for seed in range(12)]
    assert any("small a sample" in text and "±" in text for text in small)
    tied = note(400, 1, rank_correlations=[["axial_force", "motor_force", 0.8]])
    assert 150 <= int(re.search(r"(\d+) %", tied)[1]) < 200 and "are correlated" in tied
    exact = [note(3000, seed, factors=dict(list(CARRIERS.items())[:2])) for seed in range(3)]
    assert [text for text in exact if text and not re.search("10[1-4] %, .* ± [1-4] %", text)] == []


def drawn(count, seed, least):
    """Return the analysis of a random sample with a lognormal life and a target on it."""
    data = {"name": "t", "design": "lhs", "samples": count, "seed": seed, "outputs": ["forces", "life"]}
    data["factors"] = {"axial_force": {"normal": [0.0, 1.0]}, "velocity": {"uniform": [20.0, 60.0]}}
    data["factors"]["friction_coefficient"] = {"uniform": [0.1, 0.3]}
    data["analysis"] = {"target": {"roller_life_hours": {"min": least}}}
    ds = parse_study(data).design()
    noise = np.random.default_rng(seed).normal(0.0, 0.3, count)
    ds["roller_life_hours"] = ("case", 10 ** (3 + 0.2 * ds["axial_force"].values + noise), {"units": "h"})
    return analyse(results_of(ds))


def test_a_sample_with_a_target_is_judged_by_its_probability():
    """60 rows know the probability of 1,000 h, one in two, to about +- 12 %, and 2,000 rows to +- 2 %."""
    said = of_target(drawn(60, 1, 1000.0), 60)
    told, half = (int(text) for text in re.findall(r" is (\d+) ± (\d+) % only", said.text)[0])
    plain = 1.96 * np.sqrt(0.25 / 60)
    assert said.kind == "more" and abs(told / 100 - 0.5) < plain and 0.6 * plain < half / 100 < 1.2 * plain
    late = of_target(drawn(said.values["number"], 2, 1000.0), 0)
    assert late.kind == "enough" and re.search(
        r"Enough samples: the probability of .* is (4[5-9]|5[0-5]) ± [1-5] %", late.text
    )


def test_the_number_that_decides_an_open_target_leaves_it_outside_the_interval_of_b10():
    """Lognormal lives whose B10 is 1,000 h: of the number asked for, the lower bound is nine tenths of it."""
    draw = lambda n, seed: 1000 * 10 ** (0.2 * (np.random.default_rng(seed).normal(size=n) + stats.norm.ppf(0.9)))  # noqa: E731
    middle, low, high = life_of_nine_in_ten(draw(80, 5))
    required = 0.9 * middle
    assert low < required < middle
    one = SimpleNamespace(low=middle, interval=(low, high))
    found: Any = SimpleNamespace(best=(one,), required=required)
    said = undecided(found, 80, False)
    number = int(re.search(r"Write `samples: (\d+)`", said.text)[1])
    assert number % 80 == 0 and 80 < number <= 80 * 64
    bounds = np.array([life_of_nine_in_ten(draw(number, seed)) for seed in range(8)])
    assert np.median(bounds[:, 1] / bounds[:, 0]) > 0.9 * 0.98  # beside a target at nine tenths of it
    quarter = np.array([life_of_nine_in_ten(draw(number // 8, seed)) for seed in range(8)])
    assert np.median(quarter[:, 1] / quarter[:, 0]) < 0.85
    found.required = middle * 1.0001
    assert undecided(found, 80, False) is None  # too close to say
