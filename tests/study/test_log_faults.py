"""Logs with a known truth: with each fault the travel is that of the truth, or the fault is told or asked about."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from trackroller.cli.main import app
from trackroller.errors import InputError
from trackroller.roller.log_answers import answers_of, checked_log
from trackroller.study.spectrum import history, log_columns
from trackroller.study.spectrum.file import load_spectrum
from trackroller.study.spectrum.history import levels, spectrum_of_log
from trackroller.study.spectrum.log import read_log
from trackroller.study.spectrum.log_doubts import is_mark, marks_of
from trackroller.yaml_file import read_mapping, write_yaml

UNITS = {"time": "s", "distance": "m", "radial_force": "N", "axial_force": "N", "speed": "m/s", "velocity": "m/min"}
AXES = [("time", "speed"), ("time", "velocity"), ("time", "distance"), ("time", "distance", "speed"), ("distance",)]
STEEL = "1.7225-quenched-tempered"
ROLLER = {"roller_material": STEEL, "guide_material": STEEL, "contact_model": "sliding", "motor_force": 0}


def truth(n=400, seed=0):
    """Return a random walk of loads at 10 Hz and 0.5 to 1.5 m/s, with all columns that a log may have."""
    rng = np.random.default_rng(seed)
    time = np.arange(n) / 10
    walk = np.cumsum(rng.standard_normal(n))
    radial = -220 - 60 * np.sin(walk / 6) - rng.random(n)
    axial = 20 * np.sin(walk / 9) + rng.random(n)
    speed = 1 + 0.5 * np.sin(time / 3)
    distance = np.append(0.0, np.cumsum((speed[1:] + speed[:-1]) / 2 * np.diff(time)))
    columns = {"time": time, "distance": distance, "radial_force": radial, "axial_force": axial, "speed": speed}
    return columns | {"velocity": 60 * speed}


def write(path, columns, names, units=UNITS, digits=".10g"):
    """Write a log, and return its path."""
    heads = ",".join(f"{name} [{units[name]}]" for name in names)
    rows = zip(*(columns[name] for name in names), strict=True)
    path.write_text("\n".join([heads, *(",".join(f"{cell:{digits}}" for cell in row) for row in rows)]) + "\n")
    return path


def names_of(axes):
    return [*axes, "radial_force", "axial_force"]


def read(path, **answers):
    return read_log(path, 60.0, answers_of({"log": answers}))


def codes(log):
    """Return the codes of the doubts about a log, without that of a drift: a random walk of loads drifts."""
    return {doubt.code for doubt in log.doubts} - {"drift"}


def damage(log):
    """Return the sum of travel times load cubed, to which damage grows."""
    return float(np.sum(log.travel * np.abs(log.radial) ** 3))


@pytest.mark.parametrize("axes", AXES)
@pytest.mark.parametrize("seed", range(3))
def test_a_log_without_faults_raises_no_doubt(tmp_path, axes, seed):
    whole = truth(seed=seed)
    found = read(write(tmp_path / "log.csv", whole, names_of(axes)))
    assert found.travel.sum() == pytest.approx(whole["distance"][-1], rel=2e-3)
    assert codes(found) <= ({"no_velocity"} if axes == ("distance",) else set())


@pytest.mark.parametrize("axes", AXES)
@pytest.mark.parametrize("mark", [-9999, 9999, -999.9, 32767, -32768, 9.9e37, 1e30, -6999, 65535, 8888])
@pytest.mark.parametrize("column", ["radial_force", "axial_force"])
@settings(max_examples=3, deadline=None)
@given(start=st.integers(0, 390), length=st.integers(1, 10))
def test_marks_are_asked_about_and_their_lines_left_out(tmp_path_factory, axes, mark, column, start, length):
    """The lines with a mark are left out by the key that the question names, whatever unit the column has."""
    folder = tmp_path_factory.mktemp("mark")
    whole = truth()
    whole[column] = whole[column].copy()
    whole[column][start : start + length] = mark
    path = write(folder / "log.csv", whole, names_of(axes))
    with pytest.raises(InputError, match=rf"line {start + 2}: {column} = .*log: {{missing: \[.*\]}}") as error:
        read(path)
    marks = re.search(r"missing: \[(.+?)\]", str(error.value))[1].split(", ")
    found = read(path, missing=marks)
    kept = truth()["distance"][-1]
    assert found.travel.sum() <= kept * 1.001
    assert found.travel.sum() > kept * (1 - 2 * (length + 1) / 400)
    assert "left_out" in codes(found)
    assert np.abs(found.radial).max() < 300
    assert len(read(path, missing=[]).travel) == 400


@pytest.mark.parametrize("cell", ["inf", "-inf", "nan", "NaN", "", "1e400", "---", "∞", "Infinity"])
@pytest.mark.parametrize("column", ["time", "radial_force", "axial_force", "speed"])
def test_cells_without_a_finite_number_are_refused_by_line_and_left_out_on_request(tmp_path, cell, column):
    path = write(tmp_path / "log.csv", truth(), names_of(("time", "speed")))
    lines = path.read_text().splitlines()
    cells = lines[50].split(",")
    cells[["time", "speed", "radial_force", "axial_force"].index(column)] = cell
    lines[50] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=rf"line 51: {column} = .*a finite number.*missing: \['{cell}'\]"):
        read(path)
    assert len(read(path, missing=[cell]).travel) == 399


@pytest.mark.parametrize("axes", [("time", "distance"), ("time", "distance", "speed"), ("distance",)])
@settings(max_examples=20, deadline=None)
@given(row=st.integers(2, 397), to=st.sampled_from([0.0, 1000.0]), first=st.sampled_from([5000.0, 3.0]))
def test_a_reset_of_the_counter_is_no_travel(tmp_path_factory, axes, row, to, first):
    whole = truth()
    true = whole["distance"]
    moved = np.append(true[:row] + first, true[row:] - true[row] + to)
    path = write(tmp_path_factory.mktemp("reset") / "log.csv", whole | {"distance": moved}, names_of(axes))
    found = read(path)
    assert found.travel.sum() == pytest.approx(true[-1], rel=5e-3)
    told = {"jump", "gap"} & codes(found)
    assert told or abs(moved[row] - moved[row - 1]) < 1.0  # a step as others is none that anybody sees


@pytest.mark.parametrize("axes", [("time", "speed"), ("time", "distance"), ("time", "distance", "velocity")])
@settings(max_examples=20, deadline=None)
@given(row=st.integers(2, 397), back=st.sampled_from([3600.0, 7200.0, 86400.0, 1e6]))
def test_a_clock_set_back_changes_no_travel(tmp_path_factory, axes, row, back):
    whole = truth()
    whole["time"] = np.append(whole["time"][:row], whole["time"][row:] - back)
    found = read(write(tmp_path_factory.mktemp("clock") / "log.csv", whole, names_of(axes)))
    assert found.travel.sum() == pytest.approx(whole["distance"][-1], rel=5e-3)
    assert 3600 * found.hours.sum() == pytest.approx(39.9, rel=5e-3)
    assert "clock_back" in codes(found)
    assert ("an hour" in " ".join(found.notes)) == (back == 3600.0)


@pytest.mark.parametrize("axes", [("time", "speed"), ("time", "distance"), ("time", "distance", "velocity")])
def test_other_orders_of_the_lines(tmp_path, axes):
    """Lines from the newest to the oldest, in any order, and two that are exchanged."""
    whole = truth()
    rng = np.random.default_rng(4)
    exchanged = np.arange(400)
    exchanged[[100, 101]] = 101, 100
    for order, code in ((np.arange(400)[::-1], "reversed"), (rng.permutation(400), "sorted"), (exchanged, "sorted")):
        mixed = {name: column[order] for name, column in whole.items()}
        found = read(write(tmp_path / "log.csv", mixed, names_of(axes)))
        assert found.travel.sum() == pytest.approx(whole["distance"][-1], rel=2e-3)
        assert code in codes(found)


@pytest.mark.parametrize("axes", [("time", "speed"), ("time", "distance"), ("time", "distance", "velocity")])
@pytest.mark.parametrize("unit", [0.5, 1.0, 2.0])
def test_rounded_times(tmp_path, axes, unit):
    """Times in whole seconds of a log at 10 Hz; the lines of one time share the step to the next."""
    whole = truth()
    rounded = whole | {"time": np.floor(whole["time"] / unit + 1e-9) * unit}
    found = read(write(tmp_path / "log.csv", rounded, names_of(axes)))
    assert found.travel.sum() == pytest.approx(whole["distance"][-1], rel=0.01)
    assert 3600 * found.hours.sum() == pytest.approx(39.9, rel=0.01)
    assert "equal_times" in codes(found)
    exact = read(write(tmp_path / "exact.csv", whole, names_of(axes)))
    assert damage(found) == pytest.approx(damage(exact), rel=0.01)


@pytest.mark.parametrize("axes", AXES)
def test_a_gap_is_told(tmp_path, axes):
    """Lines are missing for 5 s; a counter still knows the travel."""
    whole = truth()
    kept = np.r_[0:200, 250:400]
    found = read(write(tmp_path / "log.csv", {name: c[kept] for name, c in whole.items()}, names_of(axes)))
    lost = whole["distance"][250] - whole["distance"][199]
    expected = whole["distance"][-1] - (0.0 if {"time", "distance"} <= set(axes) else lost)
    assert found.travel.sum() == pytest.approx(expected, rel=0.01)
    assert {"gap", "gap_with_travel"} & codes(found)
    assert "line 202" in " ".join(found.notes)


@pytest.mark.parametrize("axes", AXES)
def test_a_line_for_each_change_is_asked_about(tmp_path, axes):
    """Loads in steps of 1 to 200 tenths of a second: only `hold: last` gives the damage."""
    rng = np.random.default_rng(7)
    ends = np.cumsum(rng.geometric(0.02, 100))
    time = np.append(0.0, ends / 10)
    radial = np.append(-100 - 300 * rng.random(100), -100.0)
    columns = {"time": time, "distance": time, "radial_force": radial, "axial_force": 0 * time, "speed": 1 + 0 * time}
    path = write(tmp_path / "log.csv", columns | {"velocity": 60 + 0 * time}, names_of(axes))
    with pytest.raises(InputError, match=r"log: {hold: last}.*log: {hold: middle}.*log: {hold: step}"):
        read(path)
    found = read(path, hold="last")
    assert found.travel.sum() == pytest.approx(time[-1])
    assert damage(found) == pytest.approx(float(np.sum(np.diff(time) * np.abs(radial[:-1]) ** 3)))
    assert read(path, hold="middle").travel.sum() == pytest.approx(time[-1])
    if axes != ("time", "distance") and axes != ("time", "distance", "speed"):
        assert read(path, hold="step").travel.sum() < time[-1]


def test_two_rates_are_asked_about(tmp_path):
    time = np.append(np.arange(150) / 100, 1.5 + np.arange(50))
    columns = truth(200) | {"time": time, "speed": np.ones(200)}
    path = write(tmp_path / "log.csv", columns, names_of(("time", "speed")))
    with pytest.raises(InputError, match=r"49 long steps, which hold 49 of 50.5 s"):
        read(path)
    assert read(path, hold="last").travel.sum() == pytest.approx(50.5)


def test_uneven_steps_are_told(tmp_path):
    """No step is so long that it is a gap, but each line may hold until the next one."""
    time = np.cumsum(np.random.default_rng(1).choice([1.0, 2.0, 3.0], 100))
    columns = truth(100) | {"time": time}
    found = read(write(tmp_path / "log.csv", columns, names_of(("time", "speed"))))
    assert "uneven" in codes(found)


@pytest.mark.parametrize("column", ["speed", "velocity"])
@pytest.mark.parametrize("factor", [1 / 60, 60.0, 3.6, 1000.0, 1.2, 0.0])
def test_columns_that_contradict_are_asked_about(tmp_path, column, factor):
    """The speed is in another unit than its head says, or wrong."""
    whole = truth()
    path = write(tmp_path / "log.csv", whole | {column: factor * whole[column]}, names_of(("time", "distance", column)))
    with pytest.raises(InputError, match=rf"distance = .*{column} to .*log: {{travel: distance}}") as error:
        read(path)
    assert ("if this is its unit" in str(error.value)) == (factor not in (1.2, 0.0) and "no" != hint(column, factor))
    assert read(path, travel="distance").travel.sum() == pytest.approx(whole["distance"][-1], rel=2e-3)
    if factor:
        by_speed = read(path, travel="velocity").travel.sum()
        assert by_speed == pytest.approx(factor * whole["distance"][-1], rel=2e-3)


def hint(column, factor):
    """Return 'no' for a factor that no usual unit explains."""
    usual = {"speed": (60.0, 3.6, 1000.0), "velocity": (1 / 60, 1000.0)}
    return "yes" if factor in usual[column] else "no"


def test_columns_that_differ_a_little_are_told(tmp_path):
    whole = truth()
    path = write(
        tmp_path / "log.csv", whole | {"speed": 1.05 * whole["speed"]}, names_of(("time", "distance", "speed"))
    )
    assert "travel_differs" in codes(read(path))


@pytest.mark.parametrize("level", [0.0, 1.0])
@pytest.mark.parametrize("count", [1, 3])
def test_spikes_are_told_in_a_constant_and_in_a_varying_speed(tmp_path, level, count):
    """The speed is constant with level 0; the remedy of the note gives the travel."""
    whole = truth()
    speed = 1 + level * (whole["speed"] - 1)
    spiky = speed.copy()
    spiky[50 : 50 + 40 * count : 40] = 1700.0 - np.arange(count)
    path = write(tmp_path / "log.csv", whole | {"speed": spiky}, names_of(("time", "speed")))
    found = read(path)
    assert {"speed_spike", "few_lines"} >= codes(found) >= {"speed_spike"}
    note = next(doubt for doubt in found.doubts if doubt.code == "speed_spike")
    assert (note.count, note.line) == (count, 52)
    assert note.values["share"] > 75
    assert "log: {spikes: leave out}" in note.text
    assert read(path, spikes="leave out").travel.sum() == pytest.approx(np.sum(speed) / 10, rel=0.01)


def test_a_spike_in_a_constant_load_is_told(tmp_path):
    whole = truth() | {"radial_force": np.where(np.arange(400) == 77, -5000.0, -400.0)}
    found = read(write(tmp_path / "log.csv", whole, names_of(("time", "speed"))))
    assert [(d.count, d.line) for d in found.doubts if d.code == "spike"] == [(1, 79)]


def test_a_clipped_sensor_is_told(tmp_path):
    whole = truth()
    small = np.minimum(whole["radial_force"], -200)  # the smallest loads are equal, which hides nothing
    assert "clipped" not in codes(read(write(tmp_path / "log.csv", whole | {"radial_force": small}, NAMES)))
    large = np.maximum(whole["radial_force"], -230)
    found = read(write(tmp_path / "log.csv", whole | {"radial_force": large}, NAMES))
    doubt = next(doubt for doubt in found.doubts if doubt.code == "clipped")
    assert doubt.count == int(np.sum(whole["radial_force"] <= -230))
    assert f"{100 * doubt.count / 400:.3g} % of the lines" in doubt.text


NAMES = names_of(("time", "speed"))


def test_a_frozen_sensor_is_told(tmp_path):
    whole = truth()
    whole["radial_force"][150:230] = whole["radial_force"][150]
    found = read(write(tmp_path / "log.csv", whole, NAMES))
    doubt = next(doubt for doubt in found.doubts if doubt.code == "frozen")
    assert doubt.count == 80 and doubt.line == 152 and "in 80 lines on end, the first line 152" in doubt.text
    steps = truth()
    steps["radial_force"] = np.repeat(steps["radial_force"][::20], 20)  # a load that changes now and then
    stopped = truth()
    stopped["radial_force"][150:230] = 0.0  # told as travel without a load
    for columns in (truth(), steps, stopped):
        assert "frozen" not in codes(read(write(tmp_path / "log.csv", columns, NAMES)))


def test_few_lines_that_carry_the_life_are_told(tmp_path):
    whole = truth()
    radial = whole["radial_force"].copy()
    radial[200:210] = -2000 - np.arange(10)
    values, notes = spectrum_of_log(write(tmp_path / "log.csv", whole | {"radial_force": radial}, NAMES), ROLLER)
    assert re.search(r"\d+ lines, the first line 20\d, hold 8\d.* % of the sum of travel times load", " ".join(notes))
    assert {"few_lines"} <= {doubt["code"] for doubt in values["log"]["doubts"]}


def test_units_of_marks_are_those_of_the_file(tmp_path):
    whole = truth()
    radial = whole["radial_force"] / 1e3
    radial[10:20] = -9999
    path = write(tmp_path / "log.csv", whole | {"radial_force": radial}, NAMES, UNITS | {"radial_force": "kN"})
    with pytest.raises(InputError, match=r"missing: \[-9999\]"):
        read(path)
    assert len(read(path, missing=[-9999]).travel) == 390


@settings(max_examples=100, deadline=None)
@given(st.lists(st.floats(-500, 500).filter(lambda x: not is_mark(x)), min_size=30, max_size=80, unique=True))
def test_values_within_their_range_are_no_marks(values):
    even = np.linspace(-600, 600, 60)  # fills the range, so that no value stands apart
    assert marks_of(np.concatenate([values, even]), 1.0) == []


def test_the_key_log_is_checked():
    assert checked_log({"hold": "last", "missing": -9999}) == {"hold": "last", "missing": ["-9999"]}
    for wrong, words in (
        ({"hold": "next"}, "last, middle, step"),
        ({"holds": "last"}, "Did you mean 'hold'"),
        ({"missing": [[1]]}, "a list of numbers and texts"),
        ("last", "Write log: {hold: last}"),
    ):
        with pytest.raises(InputError, match=words):
            checked_log(wrong)


def test_a_long_log_is_read_in_pieces(tmp_path, monkeypatch):
    """Pieces, and lines of nearly the same loads that count as one, change nothing that matters."""
    whole = truth(3000)
    path = write(tmp_path / "log.csv", whole, NAMES)
    values, _ = spectrum_of_log(path, ROLLER)
    monkeypatch.setattr(log_columns, "PIECE", 71)
    monkeypatch.setattr(log_columns, "FIRST_BYTES", 900)
    monkeypatch.setattr(history, "MOST_POINTS", 100)
    pieces, _ = spectrum_of_log(path, ROLLER)

    def effect(spectrum):
        return sum(block["distance"] * abs(block["radial_force"]) ** 3 for block in spectrum["blocks"])

    assert sum(b["distance"] for b in pieces["blocks"]) == pytest.approx(whole["distance"][-1], rel=2e-3)
    assert effect(pieces) == pytest.approx(effect(values), rel=5e-3)
    text = path.read_text().splitlines()
    text[2000] = text[2000].replace(",", ",x", 1)
    path.write_text("\n".join(text) + "\n")
    with pytest.raises(InputError, match=r"line 2001: speed = 'x"):
        read(path)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("separator", [";", "\t"])
def test_a_long_log_with_decimal_commas_comments_and_empty_lines(tmp_path, monkeypatch, encoding, separator):
    monkeypatch.setattr(log_columns, "FIRST_BYTES", 2000)
    monkeypatch.setattr(log_columns, "PIECE", 50)
    whole = truth()
    path = write(tmp_path / "log.csv", whole, NAMES)
    exact = read(path)
    lines = path.read_text().replace(",", separator).replace(".", ",").splitlines()
    lines[300:300] = ["", "# a remark", separator * 3]
    path.write_text("\n".join(lines) + "\n", encoding=encoding)
    found = read(path)
    assert np.array_equal(found.travel, exact.travel)
    assert np.array_equal(found.radial, exact.radial)
    assert found.lines[298] == 300
    assert found.lines[299] == 304


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("1,2,3,4,5", "4 cells, one for each name"),
        ("1,2,3,4,5,6", "lines of 4 cells"),
        ("1,2,3", "line 301: axial_force = ''.*a finite number"),
        ('1,2,3,"4', "line 301: axial_force = '\"4'.*a finite number"),
        ('1,2,3,"4"5', "line 301: axial_force = '\"4\"5'.*a finite number"),
        ("1,2,3,1_0", "line 301: axial_force = '1_0'"),
    ],
)
def test_wrong_lines_far_down_are_named(tmp_path, monkeypatch, line, words):
    monkeypatch.setattr(log_columns, "FIRST_BYTES", 2000)
    path = write(tmp_path / "log.csv", truth(), NAMES)
    lines = path.read_text().splitlines()
    lines[300] = line
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=words):
        read(path)


def test_a_huge_log_is_refused_with_advice_for_logs(tmp_path, monkeypatch):
    """The blocks of the parts of a log, put into one file, hold the travel of the log."""
    whole = truth()
    path = write(tmp_path / "log.csv", whole, NAMES)
    together, _ = spectrum_of_log(path, ROLLER)
    monkeypatch.setattr(log_columns, "MOST_BYTES", 10_000)
    with pytest.raises(InputError, match="put the blocks of all of them into one file"):
        read(path)
    lines = path.read_text().splitlines()
    travel = 0.0
    for part in (lines[1:201], lines[200:]):
        path.write_text("\n".join([lines[0], *part]) + "\n")
        travel += sum(block["distance"] for block in spectrum_of_log(path, ROLLER)[0]["blocks"])
    assert travel == pytest.approx(sum(block["distance"] for block in together["blocks"]), rel=1e-6)


def test_levels_of_a_log_that_was_merged_cover_all_travel(monkeypatch):
    monkeypatch.setattr(history, "MOST_POINTS", 10)
    whole = truth()
    loads = np.column_stack([whole["radial_force"], whole["axial_force"]])
    weights = np.ones(400)
    means, travel, hours = history._merged(loads, weights, weights / 2, 0.5)
    assert travel.sum() == pytest.approx(400)
    assert hours.sum() == pytest.approx(200)
    assert travel @ means == pytest.approx(weights @ loads)
    assert sum(travel[own].sum() for own in levels(means, travel, 0.5)) == pytest.approx(400)


def test_the_case_file_answers_and_the_spectrum_records_the_doubts(tmp_path, monkeypatch):
    """The command asks, takes the answer, and its file is a load spectrum that keeps the doubts."""
    monkeypatch.chdir(tmp_path)
    whole = truth()
    whole["radial_force"][100:104] = -9999
    write(tmp_path / "log.csv", whole, NAMES)
    command = ["spectrum", "r.yaml", "--from", "log.csv", "-o", "shift.yaml"]
    (tmp_path / "r.yaml").write_text(write_yaml(ROLLER))
    assert "log: {missing: [-9999]}" in str(CliRunner().invoke(app, command).exception)
    (tmp_path / "r.yaml").write_text(write_yaml(ROLLER | {"log": {"missing": [-9999]}}))
    done = CliRunner().invoke(app, command)
    assert done.exit_code == 0, done.output
    assert "4 lines without a value left out" in done.output
    record = read_mapping(tmp_path / "shift.yaml", "load spectrum")["log"]
    assert record["file"] == "log.csv"
    assert {"code": "left_out", "count": 4, "line": 102, "values": "'-9999'"} in record["doubts"]
    assert load_spectrum(tmp_path / "shift.yaml").blocks


@pytest.mark.parametrize(
    ("axes", "column", "unit", "speed"),
    [
        (("time", "distance"), "distance", "km", 6e4),
        (("time", "distance"), "time", "ms", 6e4),
        (("time", "distance"), "distance", "mm", 0.06),
        (("time", "velocity"), "velocity", "m/s", 3600),
        (("time", "speed"), "speed", "mm/s", 0.06),
    ],
)
def test_a_speed_that_no_roller_has_is_told(tmp_path, axes, column, unit, speed):
    """The numbers are right, and a head states another unit than theirs."""
    columns = truth() | {"speed": np.ones(400), "velocity": np.full(400, 60.0), "distance": np.arange(400) / 10}
    path = write(tmp_path / "l.csv", columns, names_of(axes), UNITS | {column: unit})
    log = read(path)
    (doubt,) = [doubt for doubt in log.doubts if doubt.code == "unusual_speed"]
    assert doubt.values["value"] == pytest.approx(speed)
    assert f"check the units of {axes[0]} and {axes[1]}" in doubt.text
    assert "unusual_speed" not in codes(read(write(path, columns, names_of(axes)))), "the remedy works"


def test_a_log_with_long_stops_moves_at_a_usual_speed(tmp_path):
    columns = truth()
    columns["speed"] = np.where(np.arange(400) % 10 == 0, 1.0, 0.0)
    log = read(write(tmp_path / "l.csv", columns, names_of(("time", "speed"))))
    assert "unusual_speed" not in codes(log)


@pytest.mark.parametrize("stamp", ["2026-11-29 10:00:{:06.3f}", "10:00:{:04.1f}", "29.11.2026 10:00:{:02.0f}"])
def test_a_column_of_dates_is_one_error_whose_remedy_works(tmp_path, stamp):
    columns = {name: column[:300] for name, column in truth().items()}
    path = write(tmp_path / "l.csv", columns, names_of(("time", "speed")))
    head, *lines = path.read_text().splitlines()
    seconds = [line.split(",")[0] for line in lines]
    dated = [
        ",".join([stamp.format(float(time)), *line.split(",")[1:]]) for time, line in zip(seconds, lines, strict=True)
    ]
    path.write_text("\n".join([head, *dated]) + "\n")
    with pytest.raises(InputError, match="all cells below it are no numbers") as caught:
        read(path)
    assert len(caught.value.errors) == 1 and "seconds since the first line" in str(caught.value)
    path.write_text("\n".join([head, *lines]) + "\n")
    assert read(path).travel.sum() > 0
