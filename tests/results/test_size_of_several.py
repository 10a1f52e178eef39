"""The least roller of a shelf for a carriage and for a load spectrum, against their own solutions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

import trackroller as tr
from trackroller.carriage.example import EXAMPLE
from trackroller.carriage.solve import solve_carriage
from trackroller.cli.main import app
from trackroller.errors import InputError
from trackroller.study.spectrum.file import Spectrum, load_spectrum
from trackroller.study.spectrum.solve import solve_spectrum
from trackroller.yaml_file import parse_mapping

HARD = "1.7225-quenched-tempered"
ROWS = {
    "mid": (30, -8.4, HARD, 3),
    "large": (40, -8.2, HARD, 5),
    "soft": (20, -9, "1.7225-normalised", 1),
    "no price": (44, -8.2, HARD, None),
}
QUICK = {"contact_model": "sliding", "accuracy": "preview"}


@pytest.fixture
def shelf(tmp_path, monkeypatch) -> Path:
    """Return the file of a shelf of four rollers for a rail with a contour of 8 mm."""
    monkeypatch.chdir(tmp_path)
    lines = ["name;axis_distance [mm];roller_profile_radius [mm];roller_material;price [EUR]"]
    for name, values in ROWS.items():
        lines.append(";".join([name, *("" if value is None else str(value) for value in values)]))
    path = tmp_path / "rollers.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def cart(name="", **more):
    """Return the example of a carriage with a roller of the shelf at each place."""
    values = parse_mapping(EXAMPLE, "example")
    for entry in values["rollers"].values():
        entry["roller"] = {**entry["roller"], **QUICK, **roller(name)}
    return values | more


def roller(name):
    if not name:
        return {}
    axis, groove, material, _ = ROWS[name]
    return {"axis_distance": axis, "roller_profile_radius": groove, "roller_material": material}


def test_the_lives_of_a_carriage_are_those_of_its_worst_roller(shelf):
    found = tr.size(cart(), shelf, life="1 years", safety=1.2, least="price")  # 16 h on 250 days
    table = found.table.set_index("roller")
    for name in ROWS:
        life = solve_carriage(cart(name))["life_hours_low"].min().item()
        assert table.loc[name, "life_hours"] == pytest.approx(life, rel=1e-7)  # forces of 8 digits
        assert table.loc[name, "life_ratio"] == pytest.approx(life / 4000, rel=1e-7)
    assert found.least == "mid" and found.unranked == ("no price",)
    assert table.loc["soft", "verdict"] == "not enough" and "times the forces" in table.loc["soft", "overload"]


def test_a_carriage_without_a_life_is_judged_by_its_load_ratios(shelf):
    table = tr.size(cart(), shelf, safety=20, least="price").table.set_index("roller")
    for name in ROWS:
        assert (table.loc[name, "verdict"] == "enough") == (table.loc[name, "load_ratio"] >= 20)
    ds = solve_carriage(cart("mid"))
    forces = {force: ds[force].values.ravel() for force in ("radial_force", "axial_force")}
    strength = tr.load_database().material(HARD).tensile_strength
    pressures = []
    for radial, axial in zip(*forces.values(), strict=True):
        ratio = table.loc["mid", "load_ratio"]
        case = cart("mid")["rollers"]["FL"]["roller"] | {"radial_force": ratio * radial, "axial_force": ratio * axial}
        options = {key: case.pop(key) for key in QUICK}
        pressures.append(tr.solve(case, **options)["max_pressure"].max().item())
    assert max(pressures) / (1.6 * strength) == pytest.approx(1.0, abs=2e-4)


@pytest.mark.slow
def test_each_place_takes_its_own_roller_and_they_are_solved_together(shelf):
    found = tr.size(cart(), shelf, life=6000, least="price", each=True)
    places = found.mounting.table.set_index("place")
    assert places["roller"].to_dict() == {"FL": "large", "FR": "large", "RL": "mid", "RR": "mid"}
    solved = solve_carriage(found.mounting.carriage)
    assert np.array_equal(solved["life_hours"].values, places["life_hours"].values)
    assert (solved["life_hours"] >= 6000).all() and found.mounting.enough
    # the cheaper roller is not enough in front: by hand from the carriage that has it everywhere
    cheap = solve_carriage(cart("mid"))["life_hours"].to_series()
    assert (cheap[["FL", "FR"]] < 6000).all() and (cheap[["RL", "RR"]] > 6000).all()
    nothing = tr.size(cart(), shelf, life=1e9, each=True)
    assert not nothing.mounting.enough and set(nothing.mounting.table["roller"]) == {""}


def test_the_failures_of_a_sizing_take_the_place_of_those_of_the_carriage(shelf):
    found = tr.size(cart(failures="1%"), shelf, life=6000, failures="50%")
    assert float(found.results.data.attrs["failure_probability"]) == 0.5
    kept = tr.size(cart(failures="10%"), shelf, life=6000)
    assert float(kept.results.data.attrs["failure_probability"]) == 0.1
    at_half, at_tenth = (sizing.table.set_index("roller")["life_hours"] for sizing in (found, kept))
    assert (at_tenth < at_half[at_tenth.index]).all()


def test_a_catalogue_of_a_place_is_refused(shelf):
    values = cart()
    values["rollers"]["FL"]["catalogue"] = {"radial_force": 900, "axial_force": 300, "basic_life": 100}
    with pytest.raises(InputError, match=r"rollers\.FL.catalogue stands in the place"):
        tr.size(values, shelf, life=100)


BLOCKS = [
    {"name": "loaded", "distance": 4000, "radial_force": -300, "axial_force": 20},
    {"name": "peak", "distance": 1000, "radial_force": -500, "axial_force": 50},
    {"name": "parked", "distance": 0, "radial_force": -5000, "axial_force": 50},
]
BASE = {"guide_profile_radius": 8, "motor_force": 0, "guide_material": HARD, "guide_overrollings_per_hour": 60}
SPECTRUM = {"base": BASE, "blocks": BLOCKS, "duty": {"hours_per_day": 8, "days_per_year": 200}} | QUICK


def test_the_lives_of_a_spectrum_are_those_of_its_page(shelf):
    found = tr.size(SPECTRUM, shelf, life="3 years", safety=1.5, least="price")
    table = found.table.set_index("roller")
    cheapest = []
    for name in ROWS:
        ds = solve_spectrum(Spectrum.from_dict(SPECTRUM | {"base": BASE | roller(name)}))
        life = ds["pair_life_to_first_limit_hours_low"].item()
        assert table.loc[name, "life_hours"] == life
        assert table.loc[name, "life_ratio"] == life / 4800
        if table.loc[name, "verdict"] == "enough":
            cheapest.append((ROWS[name][3] or np.inf, name))
            assert life >= 4800
    assert found.least == min(cheapest)[1] and found.unranked == ("no price",)
    # the block without travel does not count
    worst = BASE | roller("mid") | {"radial_force": -500, "axial_force": 50}
    ratio = found.ratios.table.loc["mid", "static"]
    loaded = worst | {"radial_force": -500 * ratio, "axial_force": 50 * ratio}
    used = tr.solve(loaded, **QUICK)["utilisation"].sel(limit="static").max().item()
    assert used == pytest.approx(1.0, abs=2e-4)


def test_the_lives_of_a_spectrum_at_a_probability_take_the_typical_scatter(shelf):
    """The low end of T_N is 16.1 between 10 and 90 % failed, and 4.0 from 10 % to 50 %."""
    at_half, at_tenth = (
        tr.size(SPECTRUM, shelf, life=100, **chance).table.set_index("roller")["life_hours"]
        for chance in ({}, {"failures": "10%"})
    )
    assert at_tenth["mid"] == pytest.approx(at_half["mid"] / 16.1**0.5, rel=1e-6)
    with pytest.raises(InputError, match="places"):
        tr.size(SPECTRUM, shelf, life=100, each=True)
    with pytest.raises(InputError, match=r"prize.*Did you mean 'price'"):
        tr.size(SPECTRUM, shelf, life=100, least="prize")


def test_the_spectrum_with_the_least_roller_is_written_and_repeats_its_life(shelf, tmp_path):
    (tmp_path / "loads").mkdir()
    lines = ["name,distance,radial_force,axial_force"]
    lines += [",".join(str(value) for value in block.values()) for block in BLOCKS]
    Path("loads/blocks.csv").write_text("\n".join(lines) + "\n")
    Path("loads/shift.yaml").write_text(yaml.safe_dump(SPECTRUM | {"blocks": "blocks.csv"}))
    words = ["size", "loads/shift.yaml", "--shelf", "rollers.csv", "--life", "3 years", "--least", "price", "-q"]
    done = CliRunner().invoke(app, [*words, "-o", "sized.yaml"])
    assert done.exit_code == 0 and "the spectrum with mid" in done.output
    found = tr.size("loads/shift.yaml", shelf, life="3 years", least="price").table.set_index("roller")
    ds = solve_spectrum(load_spectrum("sized.yaml"))
    assert ds["pair_life_to_first_limit_hours_low"].item() == found.loc["mid", "life_hours"]
    then = done.output.rpartition("its page: trackroller ")[2].split()
    assert CliRunner().invoke(app, then).exit_code == 0 and Path("page.html").is_file()
    told = CliRunner().invoke(app, words)
    assert "no study is kept of a spectrum; -o sized.yaml" in told.output


COOLED = {"heat_transfer_coefficient": 20, "cooled_area": 8000}


def test_a_temperature_of_a_spectrum_is_that_of_its_hottest_block(shelf):
    warm = SPECTRUM | {"base": BASE | COOLED}
    table = tr.size(warm, shelf, temperature=60).table.set_index("roller")
    for name in ROWS:
        rises = []
        for block in BLOCKS[:2]:
            loads = {force: block[force] for force in ("radial_force", "axial_force")}
            ds = tr.solve(BASE | COOLED | roller(name) | loads, ("heat",), **QUICK)
            rises.append((ds["flash_temperature_rise"] + ds["bulk_temperature_rise"]).max().item())
        assert table.loc[name, "temperature_ratio"] == pytest.approx(40 / max(rises), rel=1e-9)
    bare = tr.size(SPECTRUM, shelf, temperature=60).table.set_index("roller").loc[["mid", "large"]]
    assert set(bare["verdict"]) == {"open"} and bare["excluded_by"].str.contains("cooled_area").all()


@pytest.mark.slow
def test_a_wear_depth_of_a_carriage_counts_at_each_place_and_everywhere(shelf):
    found = tr.size(cart(), shelf, life=0.1, wear_depth="0.05 mm", least="price", each=True)
    assert found.mounting.enough and "wear_ratio" in found.table
    for entry in found.mounting.carriage["rollers"].values():
        assert entry["roller"]["permissible_wear_depth"] == 0.05
    ds = solve_carriage(found.mounting.carriage)
    wear = ds["life_hours_by_limit"].sel(limit="wear", body="roller")
    assert (wear > 0.1).all() and np.isfinite(wear).all()
    unknown = tr.size(cart(), shelf, temperature=60, each=True)
    assert not unknown.mounting.enough and "enough" not in set(unknown.table["verdict"])


@pytest.mark.slow
def test_the_command_writes_the_carriage_of_its_places(shelf, tmp_path):
    text = EXAMPLE.replace(
        "motor_force: 0\n", "motor_force: 0\n      contact_model: sliding\n      accuracy: preview\n"
    )
    Path("cart.yaml").write_text(text)
    words = ["size", "cart.yaml", "--shelf", "rollers.csv", "--life", "6000", "--least", "price", "-q"]
    done = CliRunner().invoke(app, [*words, "--each", "-o", "sized.yaml"])
    assert done.exit_code == 0 and "solved together" in done.output
    assert (solve_carriage("sized.yaml")["life_hours"] >= 6000).all()
    assert CliRunner().invoke(app, ["verify", "results/size-cart-rollers"]).exit_code == 0
    refused = CliRunner().invoke(app, [*words, "-o", "sized.yaml"])
    assert refused.exit_code != 0


def test_a_stud_excludes_a_roller_and_its_load_ratio_is_that_of_the_forces(shelf):
    """Stress and moments of a stud are proportional to the forces, but for the moments of the contacts."""
    text = shelf.read_text().splitlines()
    studs = {"mid": "10;25;640", "large": "5;25;640", "soft": "16;25;640", "no price": "16;25;640"}
    rows = [f"{line};{studs[line.split(';')[0]]}" for line in text[1:]]
    heads = "stud_diameter [mm];stud_length [mm];stud_yield_strength [MPa]"
    shelf.write_text("\n".join([f"{text[0]};{heads}", *rows]) + "\n")
    case = BASE | {"radial_force": -500, "axial_force": 50} | QUICK
    found = tr.size(case, shelf, life=100, safety=1.5)
    table = found.table.set_index("roller")
    assert "stud of the roller" in table.loc["large", "excluded_by"] and table.loc["large", "verdict"] == "not enough"
    for name in ("mid", "large"):
        ratio = found.ratios.table.loc[name, "stud"]
        stud = dict(zip(("diameter", "length", "yield_strength"), map(float, studs[name].split(";")), strict=True))
        loaded = BASE | roller(name) | {"radial_force": -500 * ratio, "axial_force": 50 * ratio, "stud": stud}
        ds = tr.solve(loaded, outputs=("forces", "stud"), **QUICK)
        assert ds["stud_static_utilisation"].item() == pytest.approx(1.0, abs=2e-4)


def test_a_stud_counts_in_a_carriage(shelf):
    stud = {"diameter": 6, "length": 20, "yield_strength": 640}
    values = cart("mid")
    for entry in values["rollers"].values():
        entry["roller"]["stud"] = stud
    ds = solve_carriage(values)
    used = ds["utilisation"].sel(limit="stud", body="roller")
    assert (used > 1).all() and (ds["limit_state"].sel(limit="stud", body="roller") == 3).all()
