"""What a refused fit advises is done, and gives a result."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import norm
from typer.testing import CliRunner

import trackroller as tr
from trackroller.cli.main import app
from trackroller.fit.depths import fit_wear
from trackroller.fit.examples import write_examples
from trackroller.fit.next_tests import check_factor
from trackroller.fit.next_tests import tests_until as simulate_tests  # pytest takes the name for that of a test

UNDER = {"load_type": "axial", "stress_ratio": -1, "like": "1.7225-normalised"}
RIG = {"motor_force": 0, "friction_coefficient": 0.1, "axial_force": 20, "contact_model": "sliding"}
SLOPE, SCATTER = "the slope (--slope 8)", "the scatter (--scatter 4, in Python scatter_in_cycles=4)"
STRESS, CYCLES = [460, 430, 400, 370, 350], [75000, 120000, 310000, 600000, 900000]


def rows(stress, cycles, failed, **more):
    return {"amplitude": list(stress), "cycles": list(cycles), "failed": list(failed)} | more


def fits(table, **more):
    """Return the values of the fit of a table, all finite."""
    fit = tr.fit_sn(table, **UNDER | more)
    assert np.isfinite(fit.groups[0].line.estimate).all()
    return fit


@pytest.mark.parametrize(
    ("stress", "cycles", "failed", "message", "held", "further"),
    [
        (
            STRESS[:2], CYCLES[:2], [True] * 2,
            f"Test 2 more specimens, or hold {SLOPE} and {SCATTER}", {"slope": 8, "scatter_in_cycles": 4}, 2,
        ),
        (
            STRESS[:3], CYCLES[:3], [True] * 3,
            f"Test 1 more specimen, or hold {SLOPE} or {SCATTER}", {"slope": 8}, 1,
        ),
        (
            STRESS[:3], CYCLES[:3], [True] * 3,
            f"Test 1 more specimen, or hold {SLOPE} or {SCATTER}", {"scatter_in_cycles": "4"}, 1,
        ),
        (
            [460, 430, 370, 350], [75000, 120000, 1e7, 1e7], [True, True, False, False],
            f"Test 2 more specimens, or hold {SLOPE} and {SCATTER}", {"slope": 8, "scatter_in_cycles": 4}, 2,
        ),
    ],
)  # fmt: skip
def test_few_specimens(tmp_path, stress, cycles, failed, message, held, further):
    """The number of specimens that a message asks for suffices, and so do the values that it lets hold."""
    table = rows(stress, cycles, failed)
    path = tmp_path / "few.csv"
    text = "".join(f"{s},{n:.0f},{'yes' if f else 'no'}\n" for s, n, f in zip(stress, cycles, failed, strict=True))
    path.write_text(f"amplitude [MPa],cycles,failed\n{text}")
    with pytest.raises(tr.InputError) as refused:
        fits(path)
    assert message in str(refused.value)
    assert str(refused.value).startswith(f"{path}: tests = {len(stress)} ")
    fits(table, **held)
    added = rows([*stress, *STRESS[-further:]], [*cycles, *CYCLES[-further:]], [*failed, *[True] * further])
    assert fits(added).groups[0].line.size == len(stress) + further


def test_run_outs_alone_give_a_one_sided_bound_with_held_values():
    table = rows([330] * 4, [1e7] * 4, [False] * 4)
    with pytest.raises(tr.InputError, match=r"Hold the slope \(--slope 8\) and the scatter .* for a one-sided bound"):
        fits(table)
    low, high = tr.fit_sn(table, slope=8, scatter_in_cycles=4, **UNDER).interval("fatigue_strength")
    # the low end is the strength with which all four outlive the test with a probability of 5 %
    shift = math.log(4) / 2.5631031311 / 8 * norm.ppf(0.05**0.25)
    assert math.log(low) == pytest.approx(math.log(330) + shift, abs=1e-6)
    assert high == math.inf
    higher = rows([330] * 4 + STRESS, [1e7] * 4 + CYCLES, [False] * 4 + [True] * 5)
    fits(higher)


def test_one_amplitude_with_a_held_slope_or_a_second_one():
    table = rows([400] * 5, CYCLES, [True] * 5)
    with pytest.raises(tr.InputError, match=r"Hold the slope \(--slope 8\), or test a second amplitude"):
        fits(table)
    line = fits(table, slope=8).groups[0].line
    assert line.best.level == pytest.approx(np.log(CYCLES).mean(), abs=1e-6)  # the mean of ln N at one stress
    assert fits(rows([400] * 5 + [460], [*CYCLES, 9e4], [True] * 6)).material["woehler_exponent"] > 1


def test_failures_at_one_amplitude_beside_run_outs():
    table = rows([400] * 4 + [330], [*CYCLES[:4], 1e7], [True] * 4 + [False])
    with pytest.raises(tr.InputError, match=r"Hold the slope \(--slope 8\), or test another amplitude to failure"):
        fits(table)
    fits(table, slope=8)
    fits(rows([400] * 4 + [330, 460], [*CYCLES[:4], 1e7, 5e4], [True] * 4 + [False, True]))


def test_a_test_that_stands_twice_is_removed_or_named():
    table = rows([*STRESS, 350], [*CYCLES, 900000], [True] * 6)
    with pytest.raises(tr.InputError, match=r"Remove one of the two; if both were tested, name them"):
        fits(table)
    assert fits(rows(STRESS, CYCLES, [True] * 5)).groups[0].line.size == 5
    assert fits(table | {"test": list("ABCDEF")}).groups[0].line.size == 6


@pytest.mark.parametrize("column", ["failed", "runout"])
def test_a_run_out_without_end_gets_the_cycles_of_its_stop(column):
    codes = [True] * 5 + [False] if column == "failed" else [False] * 5 + [True]
    table = {"amplitude": [*STRESS, 340], "cycles": [*CYCLES, math.inf], column: codes}
    with pytest.raises(tr.InputError, match=r"write the cycles at which the specimen was stopped"):
        fits(table)
    assert fits(table | {"cycles": [*CYCLES, 1e7]}).groups[0].line.tests.failed.sum() == 5


def test_a_travel_in_place_of_cycles_belongs_to_the_bench():
    with pytest.raises(tr.InputError, match=r"If it is a travel in km, fit rollers with `trackroller fit bench`"):
        fits(rows(STRESS, BENCH["travel_from"], [True] * 5))
    on_bench(BENCH)


def test_a_group_is_chosen():
    table = rows(STRESS * 2, [*CYCLES, *(2 * n for n in CYCLES)], [True] * 10, group=["A"] * 5 + ["B"] * 5)
    with pytest.raises(tr.InputError, match=r"Choose one with --group NAME \(group=\), and fit each alone"):
        fits(table)
    lives = [fits(table, group=group).estimate("cycles", amplitude=400) for group in "AB"]
    assert lives[1] / lives[0] == pytest.approx(2, rel=1e-6)


@pytest.mark.parametrize("field", ["slope", "prior"])
def test_basquins_exponent_is_turned_into_the_slope_that_is_advised(field):
    more = {"slope": {"slope": 0.125}, "prior": {"prior": {"slope": [0.125, 2]}}}[field]
    with pytest.raises(tr.InputError, match=r"the slope is k = 1/b: write 8\."):
        fits(rows(STRESS, CYCLES, [True] * 5), **more)
    mended = {"slope": {"slope": 8}, "prior": {"prior": {"slope": [8, 2]}}}[field]
    fits(rows(STRESS, CYCLES, [True] * 5), **mended)


def test_a_material_that_lacks_its_other_values_or_its_slope(tmp_path):
    file = tmp_path / "materials.yaml"
    fit = tr.fit_sn(rows(STRESS, CYCLES, [True] * 5), name="rail", load_type="axial", stress_ratio=-1)
    with pytest.raises(tr.InputError, match=r"Name it with --like, in Python like=: a steel of the database"):
        fit.write(file)
    assert not list(tmp_path.iterdir())
    assert fits(rows(STRESS, CYCLES, [True] * 5), name="rail").write(file).woehler_exponent > 1
    whole = tr.fit_sn(rows([330] * 4, [1e7] * 4, [False] * 4), name="whole", slope=8, scatter_in_cycles=4, **UNDER)
    with pytest.raises(tr.InputError, match=r"lacks fatigue_limit.*test more specimens at other stresses"):
        whole.write(file)
    more = rows([330] * 4 + STRESS, [1e7] * 4 + CYCLES, [False] * 4 + [True] * 5)
    fits(more, name="whole", slope=8, scatter_in_cycles=4).write(file)


def test_names_that_differ_by_a_sign_only(tmp_path):
    file = tmp_path / "materials.yaml"
    fits(rows(STRESS, CYCLES, [True] * 5), name="rail a").write(file)
    with pytest.raises(tr.InputError, match="Choose a name that differs by a letter or digit"):
        fits(rows(STRESS, CYCLES, [True] * 5), name="rail-a").write(file)
    fits(rows(STRESS, CYCLES, [True] * 5), name="rail-b").write(file)


@pytest.mark.parametrize("words", [["--slope", "8", "--scatter", "4"], ["--slope=8", "--scatter=4"]])
def test_the_command_holds_values_as_its_message_says(tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "whole.csv").write_text("amplitude [MPa],cycles,failed\n" + "330,10000000,no\n" * 4)
    command = ["fit", "sn", "whole.csv", "--as", "whole", "--load-type", "axial", "--stress-ratio", "-1"]
    refused = CliRunner().invoke(app, command)
    assert "(--slope 8) and the scatter (--scatter 4" in str(refused.exception)
    assert [path.name for path in tmp_path.iterdir()] == ["whole.csv"]
    done = CliRunner().invoke(app, [*command, *words])
    assert done.exit_code == 0, done.exception
    assert (tmp_path / "fit-whole.html").is_file()


BENCH = {
    "radial_force": [-120, -150, -150, -180, -210],
    "travel_from": [130, 100, 50, 41.5, 31.7],
    "travel_to": [130, 150, 75, 41.5, 31.7],
    "end": ["fatigue roller"] * 5,
}


def on_bench(table, *values, **more):
    fit = tr.fit_bench(table, *values, **{"base": RIG} | more)
    assert np.isfinite(fit.groups[0].line.estimate).all()
    return fit


def test_few_rollers_are_more_rollers_or_fewer_values():
    table = {name: cells[:3] for name, cells in BENCH.items()}
    with pytest.raises(tr.InputError, match=r"tests = 3 .*more rows than the 3 fitted values.*fit fewer values"):
        on_bench(table)
    on_bench(table, "fatigue_strength, scatter")
    on_bench(BENCH)


def test_rollers_of_one_load():
    table = BENCH | {"radial_force": [-150] * 5}
    with pytest.raises(tr.InputError, match=r"Hold it \(--slope 8\), leave slope out of the fit, or test another load"):
        on_bench(table)
    on_bench(table, slope=8)
    on_bench(table, "fatigue_strength, scatter")


def test_rollers_that_all_stay_whole():
    table = BENCH | {"end": ["none"] * 5, "travel_to": [None] * 5}
    with pytest.raises(tr.InputError, match=r"Hold slope and scatter \(--slope 8 --scatter 4\) for a one-sided bound"):
        on_bench(table)
    low, high = tr.fit_bench(table, base=RIG, slope=8, scatter_in_cycles=4).interval("fatigue_strength")
    assert 0 < low < high == math.inf


def test_a_scatter_that_the_material_lacks():
    with pytest.raises(tr.InputError, match=r"Hold it with --scatter 4 \(scatter_in_cycles=4\), or fit it as well"):
        on_bench(BENCH, "fatigue_strength, slope")
    on_bench(BENCH, "fatigue_strength, slope", scatter_in_cycles=4)
    on_bench(BENCH, "fatigue_strength, slope, scatter")


def test_all_values_held_leave_nothing_to_fit():
    with pytest.raises(tr.InputError, match="Name fatigue_strength as well"):
        on_bench(BENCH, "slope", slope=8)
    on_bench(BENCH, "slope, fatigue_strength", slope=8, scatter_in_cycles=4)


def test_a_travel_to_that_is_missing_or_in_excess():
    for cells, remedy in (
        ({"travel_to": [130, None, 75, 41.5, 31.7]}, "it equals travel_from if the end was observed"),
        ({"travel_from": [160, 100, 50, 41.5, 31.7]}, "Swap the two"),
        ({"end": ["none"] + ["fatigue roller"] * 4, "travel_to": [140, 150, 75, 41.5, 31.7]}, "Leave travel_to empty"),
    ):
        with pytest.raises(tr.InputError, match=remedy):
            on_bench(BENCH | cells)
    on_bench(BENCH | {"travel_to": [130, 100, 75, 41.5, 31.7]})
    on_bench(BENCH | {"travel_to": [160, 150, 75, 41.5, 31.7]})
    on_bench(BENCH | {"end": ["none"] + ["fatigue roller"] * 4, "travel_to": [None, 150, 75, 41.5, 31.7]})


def test_both_bodies_failed_and_one_is_chosen():
    table = BENCH | {"end": ["fatigue guide"] + ["fatigue roller"] * 4}
    with pytest.raises(tr.InputError, match="Choose one with --body roller or --body guide"):
        on_bench(table)
    assert on_bench(table, body="roller").groups[0].line.tests.failed.sum() == 4


def test_a_drive_force_of_a_roller_with_a_motor_or_measured_once():
    forces = [0.02, 0.02, 0.02, 0.03, 0.03]
    once = BENCH | {"drive_force": [0.02, None, None, None, None]}
    with pytest.raises(tr.InputError, match=r"Measure it on two rollers or more, or leave friction_coefficient out"):
        on_bench(once, "friction_coefficient")
    driven = BENCH | {"drive_force": forces, "motor_force": [3.0, 0, 0, 0, 0]}
    on_bench(once | {"drive_force": [0.02, 0.02, None, None, None]}, "friction_coefficient")
    on_bench(once)
    with pytest.raises(tr.InputError, match=r"Set motor_force to 0 in this row, or leave drive_force empty"):
        on_bench(driven, "friction_coefficient")
    on_bench(driven | {"motor_force": [0] * 5}, "friction_coefficient")
    on_bench(driven | {"drive_force": [None, *forces[1:]]}, "friction_coefficient")
    with pytest.raises(tr.InputError, match=r"a force from (\S+) to (\S+) N.*check force and loads") as refused:
        on_bench(BENCH | {"drive_force": [1e4] * 5}, "friction_coefficient")
    assert "row 1, drive_force = 10000" in str(refused.value)


def test_depths_of_wear_that_are_too_few_or_equal():
    with pytest.raises(tr.InputError, match=r"tests = 1 .*Measure the groove once more"):
        fit_wear({"travel": [100.0], "wear_depth": [0.01]})
    with pytest.raises(tr.InputError, match="Write the mean of the two depths once"):
        fit_wear({"travel": [100.0, 100.0], "wear_depth": [0.01, 0.012]})
    with pytest.raises(tr.InputError, match=r"Measure one groove only, and correct the row"):
        fit_wear({"travel": [100.0, 200.0], "wear_depth": [0.02, 0.012]})


@pytest.mark.parametrize(
    ("field", "value", "good"),
    [
        ("tests", True, 1), ("tests", math.inf, 1), ("tests", 1.5, 1), ("tests", None, 1),
        ("longest", math.nan, 300), ("longest", -5, 300), ("longest", 1e300, "300 km"), ("longest", [1], 300),
        ("failure_probability", math.nan, 0.1), ("failure_probability", math.inf, "0.1"),
        ("candidates", None, [RIG]), ("candidates", 5, [RIG]), ("candidates", RIG, [RIG]), ("candidates", [5], [RIG]),
        ("candidates", [], [RIG]), ("design", None, RIG), ("design", [1], RIG),
    ],
)  # fmt: skip
def test_a_plan_is_asked_for_possible_numbers(bench_fit, field, value, good):
    free = {name: number for name, number in RIG.items() if name != "contact_model"}
    given = {"candidates": [free | {"radial_force": -200}], "design": RIG | {"radial_force": -120}, "tests": 1}
    with pytest.raises(tr.InputError, match=field.replace("_", ".")):
        tr.next_tests(bench_fit, **given | {field: value})
    if field not in ("candidates", "design"):
        assert tr.next_tests(bench_fit, **given | {field: good}).sizes["candidate"] == 1


@pytest.fixture(scope="module")
def bench_fit():
    return on_bench(BENCH)


@pytest.mark.parametrize("factor", [math.inf, math.nan, 1, 0, "much", None])
def test_a_factor_is_finite_and_the_advised_one_is_taken(factor):
    with pytest.raises(tr.InputError, match=r"until .*finite number above 1.*Give 2"):
        simulate_tests(None, None, factor)
    assert check_factor("2") == 2.0


def test_an_example_can_be_fitted(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_examples(tmp_path)
    assert tr.fit_bench("bench-synthetic.csv").groups[0].line.size > 3
