"""The command of a carriage: lives, page, spectrum and study, and the sentences on them."""

from __future__ import annotations

import numpy as np
import pytest
from carts import ROLLER, cart, rollers_below, rollers_between, shuttle
from typer.testing import CliRunner

import trackroller as tr
from trackroller.carriage.file import load_carriage
from trackroller.carriage.files import doubts_of_carriage, spectrum_of, study_of
from trackroller.carriage.solve import forces_of, with_lives
from trackroller.cli.main import app
from trackroller.report.words.carriage import sentences
from trackroller.study.spectrum.file import Spectrum, load_spectrum
from trackroller.study.spectrum.solve import solve_spectrum
from trackroller.yaml_file import read_mapping, write_yaml


@pytest.fixture
def lifting():
    """Return a carriage whose left rollers lift in one of two cases."""
    push = {"name": "push", "share": 0.25, "forces": [{"force": [0, -1000, 0], "at": [0, 0, 0]}]}
    values = shuttle(payloads=[], cases=[push, {"name": "run", "share": 0.75, "speed": "2 m/s"}])
    below = {f"D{name}": one for name, one in rollers_below().items()}
    values["rollers"] = rollers_between(kind="floating") | below
    values["preload"] = [{"pair": [f"{end}L", f"{end}R"], "force": 100} for end in "FR"]
    return load_carriage(values)


@pytest.mark.slow
def test_the_life_of_a_roller_is_that_of_its_spectrum():
    """Lives add up over the load cases as `trackroller spectrum` adds them up, where one limit rules."""
    whole = load_carriage(shuttle(duty={"hours_per_day": 8}))
    ds = with_lives(forces_of(whole), whole)
    lives = {r.name: solve_spectrum(Spectrum.from_dict(spectrum_of(whole, ds, r.name))) for r in whole.rollers}
    for name, solved in lives.items():
        assert float(ds.life_km.sel(roller=name)) == pytest.approx(float(solved.roller_life_km), rel=1e-6)
    assert ds.attrs["worst_roller"] == str(ds.roller[int(ds.life_km.values.argmin())].values)
    assert np.allclose(ds.life_years * 8 * 365, ds.life_hours)


def test_a_lifted_roller_has_no_block_and_a_stated_share(lifting):
    ds = forces_of(lifting)
    assert float(ds.radial_force.sel(load_case="push", roller="FR")) == 0
    values = spectrum_of(lifting, ds, "FR")
    assert [block["name"] for block in values["blocks"]] == ["run"]
    assert "No block holds 25 % of the travel, in which the roller is lifted: push." in values["description"]
    assert values["blocks"][0]["velocity"] == 120
    assert Spectrum.from_dict(values).blocks[0].distance == 750


def test_sentences_state_lifted_rollers(lifting):
    ds = tr.carriage(lifting, lives=False)
    said = {(one.kind, one.values["roller"]): one.values for one in sentences(ds) if "roller" in one.values}
    assert said["carriage_lifted", "FR"]["cases"] == ["push"]
    assert said["carriage_lifted", "FR"]["share"] == 0.25
    assert ("carriage_lifted", "FL") not in said


def test_unusual_values_of_rollers_are_told():
    """Kilonewtons of a catalogue that were given as newtons."""
    values = shuttle()
    rated = {"radial_force": 3, "axial_force": 1, "basic_life": 100}
    values["rollers"]["FL"]["catalogue"] = rated
    whole = load_carriage(values)
    said = doubts_of_carriage(whole, forces_of(whole))
    assert any(
        one.startswith("rollers.FL.catalogue.radial_force = 3 N") and "write '3 kN' or 3000" in one for one in said
    )
    values["rollers"]["FL"]["catalogue"] = rated | {"radial_force": "3 kN", "axial_force": "1 kN"}
    whole = load_carriage(values)
    assert not doubts_of_carriage(whole, forces_of(whole))


def test_a_roller_with_play_is_named():
    values = shuttle(
        rollers=rollers_between() | {"D" + n: r for n, r in rollers_below().items()}, cases=[{"name": "a"}]
    )
    values["preload"] = [{"pair": [f"{end}L", f"{end}R"], "play": 0.5} for end in "FR"]
    said = [one for one in sentences(tr.carriage(values, lives=False)) if one.kind == "carriage_unloaded"]
    assert [one.values["roller"] for one in said] == ["FL", "FR", "RL", "RR"]
    assert said[0].values["gap"] == pytest.approx(0.25, abs=1e-6)


def test_a_study_of_the_worst_loads():
    whole = load_carriage(shuttle(cases=[{"name": "run"}]))
    ds = with_lives(forces_of(whole), whole)
    study = tr.load_study(study_of(whole, ds))
    design = study.design()
    worst = ds.sel(roller=ds.attrs["worst_roller"], load_case="run")
    assert np.allclose(design.axial_force, float(worst.axial_force), rtol=1e-9)
    assert np.allclose(design.radial_force, float(worst.radial_force), rtol=1e-9)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "roller.yaml").write_text(write_yaml(ROLLER))
    more = {"catalogue": {"radial_force": "3 kN", "axial_force": "1 kN", "basic_life": "100 km"}}
    values = shuttle(rollers=rollers_between(roller="roller.yaml", **more))
    (tmp_path / "shuttle.yaml").write_text(write_yaml(values))
    return tmp_path


def run(*words):
    return CliRunner().invoke(app, ["carriage", *words])


@pytest.mark.slow
def test_tables_and_page(folder):
    done = run("shuttle.yaml", "--report", "page.html")
    assert done.exit_code == 0, done.output
    assert "is the worst one" in done.output
    assert "By the maker's catalogue" in done.output
    page = (folder / "page.html").read_text(encoding="utf-8")
    for words in ("Margins", "Load factor", "own radius", "data:image/svg+xml"):
        assert words.lower() in page.lower()
    assert page.count("<table>") == 5


def test_the_spectrum_is_read_as_it_is(folder):
    done = run("shuttle.yaml", "--spectrum", "FL", "-o", "shift.yaml")
    assert done.exit_code == 0, done.output
    spectrum = load_spectrum(folder / "shift.yaml")
    assert [block.name for block in spectrum.blocks] == ["start", "curve", "run"]
    assert spectrum.options["contact_model"] == ["sliding"] or spectrum.options["contact_model"] == "sliding"


@pytest.mark.slow
def test_the_study_and_the_data(folder):
    assert run("shuttle.yaml", "--study", "-o", "study.yaml").exit_code == 0
    assert read_mapping(folder / "study.yaml")["name"].startswith("shuttle-")
    assert run("shuttle.yaml", "-o", "loads.nc").exit_code == 0
    import xarray as xr

    with xr.open_dataset(folder / "loads.nc") as ds:
        assert ds.radial_force.dims == ("load_case", "roller")
        assert ds.radial_force.attrs["units"] == "N"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--spectrum", "FL"], "Add -o shift.yaml"),
        (["--spectrum", "FX", "-o", "s.yaml"], "'FX' is not known"),
        (["--spectrum", "FL", "--study", "-o", "s.yaml"], "one of --spectrum and --study"),
        (["-o", "loads.txt"], "netCDF"),
    ],
)
def test_wrong_options_are_named(folder, words, message):
    done = run("shuttle.yaml", *words)
    assert message in str(done.exception)


def test_the_report_of_a_data_set(tmp_path):
    path = tr.report(tr.carriage(cart(), lives=False), tmp_path / "page.html")
    assert "carries the largest radial force" in path.read_text(encoding="utf-8")
