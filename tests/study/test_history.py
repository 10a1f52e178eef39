"""A log of loads becomes a spectrum: travel at each level, and the same damage as the log itself."""

from __future__ import annotations

import numpy as np
import pytest
from typer.testing import CliRunner

import trackroller as tr
from trackroller.cli.main import app
from trackroller.errors import InputError
from trackroller.study.spectrum.file import Spectrum, load_spectrum
from trackroller.study.spectrum.history import levels, read_log, spectrum_of_log
from trackroller.study.spectrum.solve import solve_spectrum
from trackroller.yaml_file import write_yaml

STEEL = "1.7225-quenched-tempered"
ROLLER = {"roller_material": STEEL, "guide_material": STEEL, "contact_model": "sliding", "motor_force": 0} | {
    "friction_coefficient": 0.1,
    "guide_curve_radius": "inf",
}


def log(path, heads="time [s],radial_force [N],axial_force [N],speed [m/s]", **columns):
    values = {"t": np.arange(60.0), "r": np.full(60, -200.0), "a": np.full(60, 20.0), "v": np.ones(60)} | columns
    lines = [",".join(f"{value:.8g}" for value in row) for row in zip(*values.values(), strict=True)]
    path.write_text("\n".join([heads, *lines]) + "\n", encoding="utf-8")
    return path


def an_hour(n=3600, seed=1):
    """Return forces and speed of an hour of travel: swings, noise, stops and a few shocks."""
    rng = np.random.default_rng(seed)
    t = np.arange(float(n))
    radial = -300 - 150 * np.sin(t / 40) ** 2 - 40 * rng.standard_normal(n)
    radial[rng.integers(0, n, 12)] -= 250
    axial = 60 * np.sin(t / 300) + 15 * rng.standard_normal(n)
    speed = np.where(t % 200 < 20, 0.0, 1 + 0.3 * np.sin(t / 50))
    return {"t": t, "r": np.minimum(radial, -20), "a": axial, "v": speed}


def test_travel_at_each_level(tmp_path):
    """Two loads, each for half of the time, at two speeds."""
    half = np.arange(60) < 30
    path = log(tmp_path / "log.csv", r=np.where(half, -100.0, -300.0), v=np.where(half, 1.0, 2.0))
    values, notes = spectrum_of_log(path, ROLLER)
    blocks = values["blocks"]
    assert [block["radial_force"] for block in blocks] == [-300, -100]
    assert [block["distance"] for block in blocks] == pytest.approx([59.0, 29.5])
    assert [block["velocity"] for block in blocks] == pytest.approx([120, 60])
    assert notes[0].startswith("60 lines of log.csv in 2 levels")


@pytest.mark.parametrize(
    ("head", "units", "cells"),
    [
        ("time;speed;radial_force;axial_force", "ms;mm/s;kN;N", "{0}000;1000;-0,2;20"),
        ("time [s];speed [m/s];radial_force [N];axial_force [N]", "", "{0},00;1,0;-200,0;20,0"),
        ("time [min];speed;radial_force;axial_force", "min;m/s;N;N", "{1:.4f};1;-200;20"),
    ],
)
def test_units_and_decimal_commas_of_time_and_speed(head, units, cells, tmp_path):
    lines = [head, *filter(None, [units]), *(cells.format(i, i / 60) for i in range(0, 5))]
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    found = read_log(tmp_path / "log.csv", 60.0)
    assert found.travel.sum() == pytest.approx(4.0, rel=1e-3)  # m in 4 s
    assert 3600 * found.hours.sum() == pytest.approx(4.0, rel=1e-3)
    assert found.radial.tolist() == [-200.0] * 5


def test_two_columns_that_say_the_speed_are_refused(tmp_path):
    text = "time,speed,velocity,radial_force\n0,1,30,-200\n1,1,30,-200\n"
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"line 1: columns = 'speed, velocity'.*Remove one of the columns"):
        read_log(tmp_path / "log.csv", 60.0)


def test_a_log_over_distance(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("distance [km],radial_force [kN]\n0,-0.1\n1,-0.1\n3,-0.2\n")
    values, notes = spectrum_of_log(path, ROLLER | {"velocity": 30})
    assert sum(block["distance"] for block in values["blocks"]) == pytest.approx(3000)
    assert {block["axial_force"] for block in values["blocks"]} == {0}
    assert any("No column axial_force" in note for note in notes)
    block = {"name": "level 1", "distance": 1000, "radial_force": -200, "axial_force": 0, "velocity": 30}
    assert values["blocks"][0] == block


@pytest.mark.long
def test_the_damage_of_an_hour_is_that_of_its_lines(tmp_path):
    """Each line solved by itself with `sliding` gives the same damage of each track within 1 %."""
    hour = an_hour()
    values, _ = spectrum_of_log(log(tmp_path / "log.csv", **hour), ROLLER)
    found = solve_spectrum(Spectrum.from_dict(values))
    loads = {"radial_force": hour["r"], "axial_force": hour["a"]}
    base = {key: value for key, value in ROLLER.items() if key != "contact_model"}
    cases = [base | {name: float(value[i]) for name, value in loads.items()} for i in range(len(hour["t"]))]
    raw = tr.solve(cases, outputs=("forces", "peak_stress", "life"), contact_model="sliding")
    travel = hour["v"] * (1 - 0.5 * np.isin(np.arange(len(cases)), (0, len(cases) - 1)))
    cycles = found.overrollings.sel(body="roller").values.sum() * travel / travel.sum()
    damage = (cycles[:, None] / raw.life_cycles.sel(body="roller").values).sum(axis=0)
    assert np.allclose(found.damage_sum.sel(body="roller"), damage, rtol=0.01)


def test_levels_keep_the_sums_of_powers():
    hour = an_hour()
    loads, weights = np.column_stack([hour["r"], hour["a"]]), hour["v"]
    made = levels(loads, weights, np.tan(np.pi / 6))
    assert sorted(np.concatenate(made).tolist()) == list(range(3600))
    assert 20 < len(made) < 300
    for side in (-1, 1):
        contact = -loads[:, 0] + side * loads[:, 1] / np.tan(np.pi / 6)
        contact = np.maximum(contact, 0)
        for power in (1, 3, 5):
            raw = weights @ contact**power
            means = [np.average(contact[own], weights=weights[own]) if weights[own].sum() else 0 for own in made]
            binned = sum(weights[own].sum() * mean**power for own, mean in zip(made, means, strict=True))
            assert binned == pytest.approx(raw, rel=0.01)


def told(tmp_path, heads="time [s],radial_force [N],axial_force [N],speed [m/s]", **columns):
    return " ".join(spectrum_of_log(log(tmp_path / "log.csv", heads, **columns), ROLLER)[1])


def test_gaps_spikes_drift_sign_and_unit_are_told(tmp_path):
    t = np.arange(60.0)
    noise = np.random.default_rng(0).standard_normal(60)
    assert "1 gap of 51 s in all, before line 32" in told(tmp_path, t=np.where(t < 30, t, t + 50))
    spiky = -200 + noise
    spiky[40] = -900
    assert "1 spike of one line, which count as loads: the largest -900 N in line 42" in told(tmp_path, r=spiky)
    assert "radial_force drifts: its median moves by -" in told(tmp_path, r=-200 + noise - t)
    assert "All radial forces are positive" in told(tmp_path, r=200 + noise)
    bare = told(tmp_path, "time,radial_force,axial_force,speed")
    assert "time in s, radial_force in N, axial_force in N and speed in m/s" in bare
    assert "if it is in kN" in told(tmp_path, r=np.full(60, -0.2))
    assert "no radial force presses" in told(tmp_path, r=np.where(t < 15, 0.0, -200.0))
    assert "radial_force is above 0 in 75 % of the lines" in told(tmp_path, r=np.where(t < 15, -200.0, 200.0))
    fast = np.ones(60) + 0.01 * noise
    fast[10] = 100
    assert "The speed has 1 spike of one line, and the travel holds them: the largest 6000 m/min" in told(
        tmp_path, v=fast
    )
    assert "The speed is below 0 in 25 % of the lines" in told(tmp_path, v=np.where(t < 15, -1.0, 1.0))
    quiet = told(tmp_path, r=-200 + noise)
    assert not any(word in quiet for word in ("gap", "spike", "drift", "positive", "unit"))


def test_lines_with_lift_off_have_levels_of_their_own(tmp_path):
    """A mean of lines with and without a lifted contact stands for neither."""
    axial = np.where(np.arange(60) == 7, 150.0, 110.0)  # 200 tan 30 deg = 115
    path = log(tmp_path / "log.csv", a=axial)
    values, notes = spectrum_of_log(path, ROLLER)
    assert sorted({block["axial_force"] for block in values["blocks"]}) == [110, 150]
    assert any("Over 1.69 % of the travel the axial force lifts one contact off" in note for note in notes)


def test_decimal_commas(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time [min];radial_force [kN];speed [m/s]\n0,0;-0,10;1,5\n0,5;-0,10;1,5\n1,0;-0,10;1,5\n")
    values, _ = spectrum_of_log(path, ROLLER)
    assert sum(block["distance"] for block in values["blocks"]) == pytest.approx(90)
    assert values["blocks"][0]["radial_force"] == -100


def test_a_stop_in_a_log_over_distance(tmp_path, recwarn):
    """A line that neither moves nor has a speed takes no time."""
    path = tmp_path / "log.csv"
    path.write_text("distance,radial_force,speed\n0,-100,1\n10,-100,0\n10,-100,0\n10,-100,0\n20,-100,1\n")
    values, _ = spectrum_of_log(path, ROLLER)
    assert sum(block["distance"] for block in values["blocks"]) == pytest.approx(20)
    assert not recwarn


def test_a_gap_adds_no_travel(tmp_path):
    t = np.arange(60.0)
    values, _ = spectrum_of_log(log(tmp_path / "log.csv", t=np.where(t < 30, t, t + 50)), ROLLER)
    assert sum(block["distance"] for block in values["blocks"]) == pytest.approx(59)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time,axial_force\n0,1\n1,1\n", "Name a column radial_force"),
        ("radial_force\n-1\n-2\n", "Name a column time or distance"),
        ("time,radial_force\n0,-1\n0,-2\n", "line 3: time = 0.0 .*times that increase"),
        ("time,radial_force\n0,-1\n1,x\n", "line 3"),
        ("time [m],radial_force\n0,-1\n1,-2\n", "a unit that can be converted to s"),
        ("time,radial_force,velocity\n0,-1,0\n1,-2,0\n", "in which the roller moves"),
    ],
)
def test_mistakes_in_a_log_are_named(tmp_path, text, words):
    (tmp_path / "log.csv").write_text(text)
    with pytest.raises(InputError, match=words):
        spectrum_of_log(tmp_path / "log.csv", ROLLER)


def test_the_command(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    log(tmp_path / "log.csv")
    (tmp_path / "r.yaml").write_text(write_yaml(ROLLER))
    done = CliRunner().invoke(app, ["spectrum", "r.yaml", "--from", "log.csv", "-o", "shift.yaml"])
    assert done.exit_code == 0, done.output
    assert "60 lines of log.csv in 1 level" in done.output
    spectrum = load_spectrum(tmp_path / "shift.yaml")
    assert spectrum.blocks[0].distance == pytest.approx(59)
    assert spectrum.blocks[0].case.roller_material == STEEL
    done = CliRunner().invoke(app, ["spectrum", "--from", "log.csv", "-o", "shift.nc"])
    assert "Add -o shift.yaml" in str(done.exception)
