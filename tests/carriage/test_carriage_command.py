"""The command of a carriage: lives, page, spectrum and study, and the sentences on them."""

from __future__ import annotations

import re

import numpy as np
import pytest
from carts import ROLLER, cart, rollers_below, rollers_between, shuttle
from typer.testing import CliRunner

import trackroller as tr
from trackroller.carriage.example import EXAMPLE
from trackroller.carriage.file import load_carriage
from trackroller.carriage.files import spectrum_of, study_of
from trackroller.carriage.loads import GRAVITY
from trackroller.carriage.solve import cases_of, doubts_of_rollers, forces_of, with_lives
from trackroller.cli.main import app
from trackroller.damage import LIMITS
from trackroller.errors import InputError
from trackroller.results.carriage_answer import answer_of_carriage
from trackroller.roller.stored_inputs import doubts_of
from trackroller.study.spectrum.file import Spectrum, load_spectrum
from trackroller.study.spectrum.solve import solve_spectrum
from trackroller.yaml_file import write_yaml


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


def test_the_record_states_lifted_rollers(lifting):
    ds = tr.carriage(lifting, lives=False)
    answer = answer_of_carriage(ds)
    rows = answer.table.set_index("roller")
    assert (rows.loc["FR", "lifted"], rows.loc["FR", "lifted_share"]) == ("push", 0.25) and rows.loc[
        "FL", "lifted"
    ] == ""
    (told,) = [caution.where for caution in answer.warnings if caution.where.startswith("lifted: ")]
    assert "FR in push (25 % of the travel)" in told and "FL" not in told


def test_a_carriage_without_a_life_says_why():
    weak = [{"pair": [f"{end}L", f"{end}R"], "force": "60 N"} for end in "FR"]
    ds = tr.carriage(shuttle(cases=[{"name": "run"}], preload=weak))
    answer = answer_of_carriage(ds)
    assert answer.kind == "no_life" and answer.headline["unknown"] == ["FL", "FR", "RL", "RR"]
    (told,) = [caution for caution in answer.warnings if caution.where.startswith("not on both contacts")]
    assert (told.code, told.count) == ("not_held", 4) and "FL, FR, RL, RR in run" in told.where
    unknown = tr.carriage(cart(rollers={n: r | {"roller": None, "stiffness": 1e4} for n, r in rollers_below().items()}))
    answer = answer_of_carriage(unknown)
    assert answer.kind == "forces" and answer.headline["without_file"] == ["FL", "FR", "RL", "RR"]
    assert any("the file of FL, FR, RL, RR" in caution.where for caution in answer.warnings)


def test_lives_beyond_the_fatigue_limit_are_told():
    """A life that rests on the rule beyond the fatigue limit is no number to trust, and a carriage says so."""
    light = [{"pair": [f"{end}L", f"{end}R"], "force": "60 N"} for end in "FR"]
    ds = tr.carriage(shuttle(cases=[{"name": "run"}], preload=light, payloads=[], mass={"value": 4, "at": [0, 0, 0]}))
    told = [caution.where for caution in answer_of_carriage(ds).warnings if caution.code == "extrapolated"]
    words = "The peak stress lies below the fatigue limit for FL, FR, RL, RR in run. The life rests"
    assert any(text.startswith(words) for text in told), told


def test_unusual_values_of_rollers_are_told():
    """Kilonewtons of a catalogue that were given as newtons."""
    values = shuttle()
    rated = {"radial_force": 3, "axial_force": 1, "basic_life": 100}
    values["rollers"]["FL"]["catalogue"] = rated
    whole = load_carriage(values)
    said = doubts_of_rollers(whole, forces_of(whole))
    assert any(
        one.startswith("Roller FL: catalogue.radial_force = 3 N") and "write '3 kN' or 3000" in one for one in said
    )
    values["rollers"]["FL"]["catalogue"] = rated | {"radial_force": "3 kN", "axial_force": "1 kN"}
    whole = load_carriage(values)
    assert not doubts_of_rollers(whole, forces_of(whole))


def test_a_roller_with_play_is_named():
    values = shuttle(
        rollers=rollers_between() | {"D" + n: r for n, r in rollers_below().items()}, cases=[{"name": "a"}]
    )
    values["preload"] = [{"pair": [f"{end}L", f"{end}R"], "play": 0.5} for end in "FR"]
    ds = tr.carriage(values, lives=False)
    (told,) = [caution for caution in answer_of_carriage(ds).warnings if "the play is larger" in caution.where]
    assert told.count == 4 and all(f"{name} (0.25 mm away" in told.where for name in ("FL", "FR", "RL", "RR"))
    assert -float(ds["approach"].sel(roller="FL").max()) == pytest.approx(0.25, abs=1e-6)


def test_a_study_has_the_loads_of_all_rollers(folder):
    whole = load_carriage(folder / "shuttle.yaml")
    ds = forces_of(whole)
    assert run("shuttle.yaml", "--study", "-o", "study.yaml").exit_code == 0
    design = tr.load_study(folder / "study.yaml").design()
    for name in ("radial_force", "axial_force"):
        assert np.allclose(design[name], ds[name].values.ravel(), rtol=1e-9, atol=1e-9)
    assert np.allclose(np.unique(design["velocity"]), sorted({tr.Case().velocity, 60}))
    rows = (folder / "study.csv").read_text().splitlines()
    assert rows[0] == "load_case,roller,share,radial_force [N],axial_force [N],velocity [m/min]"
    assert [row.split(",")[:3] for row in rows[1:3]] == [["start", "FL", "0.1"], ["start", "FR", "0.1"]]


def test_a_lifted_roller_has_no_row(lifting):
    study, rows = study_of(lifting, forces_of(lifting), "t.csv")
    lifted = int((forces_of(lifting).radial_force == 0).sum())
    assert len(rows.splitlines()) == 1 + 16 - lifted and f"{lifted} in all" in study["description"]


def test_rollers_that_differ_have_columns(tmp_path):
    values = shuttle(duty={"hours_per_day": 8})
    values["rollers"]["FL"]["roller"] = ROLLER | {"guide_curve_radius": 5000, "guide_material": "1.7225-normalised"}
    whole = load_carriage(values)
    study, rows = study_of(whole, forces_of(whole), "s.csv")
    (tmp_path / "s.csv").write_text(rows)
    (tmp_path / "s.yaml").write_text(write_yaml(study))
    design = tr.load_study(tmp_path / "s.yaml").design()
    left = rows.splitlines()[1].split(",")
    assert left[1] == "FL" and {"5000", "1.7225-normalised"} <= set(left)
    assert sorted({*design["guide_curve_radius"].values.tolist()}) == [5000, np.inf]
    assert study["duty"] == {"hours_per_day": 8, "days_per_year": 365} and study["contact_model"] == "sliding"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"contact_model": "kalker"}, "contact_model"),
        ({"roller_profile": {"arc": -8.0}, "normal": "hertz"}, "roller_profile"),
    ],
)
def test_rollers_that_no_table_can_hold_are_refused(change, message):
    values = shuttle()
    values["rollers"]["FL"]["roller"] = ROLLER | change
    whole = load_carriage(values)
    with pytest.raises(InputError, match=message):
        study_of(whole, forces_of(whole), "s.csv")


def test_a_table_of_somebody_else_is_kept(folder):
    (folder / "study.csv").write_text("mine\n")
    assert "which somebody has changed" in str(run("shuttle.yaml", "--study", "-o", "study.yaml").exception)
    assert (folder / "study.csv").read_text() == "mine\n" and not (folder / "study.yaml").exists()
    (folder / "study.csv").unlink()
    for _ in range(2):
        assert run("shuttle.yaml", "--study", "-o", "study.yaml").exit_code == 0


def test_rows_that_somebody_added_are_kept(folder):
    assert run("shuttle.yaml", "--study", "-o", "study.yaml").exit_code == 0
    table = folder / "study.csv"
    more = table.read_text() + "by hand,FL,0.1,-900,0,30\n"
    table.write_text(more)
    assert "which somebody has changed" in str(run("shuttle.yaml", "--study", "-o", "study.yaml").exception)
    assert table.read_text() == more
    assert run("shuttle.yaml", "--study", "-o", "other.yaml").exit_code == 0, "the remedy works"


@pytest.mark.parametrize(
    ("name", "made"),
    [
        ("my shuttle", "my-shuttle-loads"),
        ("Lift 7 (new)", "Lift-7-new-loads"),
        ("Fördergerät/2", "Fordergerat-2-loads"),
        ("滑车", "loads"),
        ("-" * 90, "loads"),
        ("x" * 90, f"{'x' * 40}-{'x' * 14}-loads"),
    ],
)
def test_any_name_of_a_carriage_makes_a_name_of_a_study(tmp_path, name, made):
    whole = load_carriage(shuttle(name=name))
    study, rows = study_of(whole, forces_of(whole), "s.csv")
    (tmp_path / "s.csv").write_text(rows)
    (tmp_path / "s.yaml").write_text(write_yaml(study))
    assert tr.load_study(tmp_path / "s.yaml").name == made
    of_roller = spectrum_of(whole, forces_of(whole), "FL")
    assert tr.load_study(study | {"name": of_roller["name"], "table": str(tmp_path / "s.csv")}).name.endswith("FL")


def test_a_study_of_one_load_case(tmp_path):
    whole = load_carriage(shuttle(cases=[{"name": "run"}]))
    study, rows = study_of(whole, forces_of(whole), "s.csv")
    (tmp_path / "s.csv").write_text(rows)
    (tmp_path / "s.yaml").write_text(write_yaml(study))
    assert study["roles"] == {"roller": "condition"} and len(tr.load_study(tmp_path / "s.yaml").design().case) == 4


@pytest.mark.slow
def test_the_study_runs_as_it_is(folder):
    assert run("shuttle.yaml", "--study", "-o", "study.yaml").exit_code == 0
    done = CliRunner().invoke(app, ["run", "study.yaml"])
    assert done.exit_code == 0, done.output
    whole = load_carriage(folder / "shuttle.yaml")
    ds = with_lives(forces_of(whole), whole)
    results = tr.open_study(folder / "results" / "shuttle-loads")
    lives = results.data["pair_life_to_first_limit_hours"].values
    assert np.allclose(lives, ds.case_life_hours.values.ravel(), rtol=1e-6)
    told = CliRunner().invoke(app, ["best", "shuttle-loads"]).output
    i, j = np.unravel_index(ds.case_life_hours.values.argmin(), ds.case_life_hours.shape)
    assert f"load case {ds.load_case.values[i]}, roller {ds.roller.values[j]}" in " ".join(told.split())


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
    assert "ends first" in done.output
    assert "By the catalogue" in " ".join(done.output.split())
    page = (folder / "page.html").read_text(encoding="utf-8")
    for words in ("Margins", "Load factor", "own radius", "data:image/svg+xml"):
        assert words.lower() in page.lower()
    assert page.count("<table") == 8  # not checked, warnings, and values without a source, too


def test_the_spectrum_is_read_as_it_is(folder):
    done = run("shuttle.yaml", "--spectrum", "FL", "-o", "shift.yaml")
    assert done.exit_code == 0, done.output
    spectrum = load_spectrum(folder / "shift.yaml")
    assert [block.name for block in spectrum.blocks] == ["start", "curve", "run"]
    assert spectrum.options["contact_model"] == ["sliding"] or spectrum.options["contact_model"] == "sliding"


@pytest.mark.slow
def test_the_data(folder):
    assert run("shuttle.yaml", "-o", "loads.nc").exit_code == 0
    import xarray as xr

    with xr.open_dataset(folder / "loads.nc") as ds:
        assert ds.radial_force.dims == ("load_case", "roller")
        assert ds.radial_force.attrs["units"] == "N"


def test_doubts_about_rollers_are_told(folder):
    """What `solve` asks about a roller is asked about each roller of a carriage, under the loads of the carriage."""
    values = shuttle(rollers=rollers_between(stiffness=1e4))
    values["rollers"]["FL"]["roller"] = ROLLER | {"roller_profile_radius": 0.1, "radial_force": -1e7}
    (folder / "odd.yaml").write_text(write_yaml(values))
    done = run("odd.yaml", "--spectrum", "FR", "-o", "s.yaml")
    told = [line.partition("doubtful: ")[2] for line in done.stderr.splitlines() if "doubtful" in line]
    assert told[0].startswith("Roller FL: radial_force = -10000000.0 in its file does not count")
    assert told[1].startswith("Roller FL: roller_profile_radius = 0.1 mm is 3 times below the usual")
    assert doubts_of(tr.carriage(values, lives=False)) == told


def test_places_in_metres_are_asked_about():
    values = shuttle(cases=[{"name": "run", "speed": "1 m/s"}])
    for entry in values["rollers"].values():
        entry["at"] = [value / 1000 for value in entry["at"]]
    (text,) = doubts_of(tr.carriage(values, lives=False))
    assert text.startswith("largest distance of the rollers = 0.3 mm is 33.3 times below") and "'0.3 m'" in text
    for entry in values["rollers"].values():
        entry["at"] = [f"{value} m" for value in entry["at"]]
    assert doubts_of(tr.carriage(values, lives=False)) == [], "the remedy works"


def test_doubts_that_rollers_share_are_told_once():
    values = shuttle(rollers=rollers_between(roller=ROLLER | {"velocity": 0.1}), cases=[{"name": "stand"}])
    ds = tr.carriage(values, lives=False)
    (text,) = doubts_of(ds)
    assert text.startswith("Roller FL, FR, RL, RR: velocity = 0.1 m/min is 3 times below")
    values["cases"][0]["speed"] = "1 m/s"
    assert doubts_of(tr.carriage(values, lives=False)) == []


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--spectrum", "FL"], "Add -o shift.yaml"),
        (["--spectrum", "FX", "-o", "s.yaml"], "'FX' is not known"),
        (["--spectrum", "FL", "--study", "-o", "s.yaml"], "one of --spectrum and --study"),
        (["-o", "loads.txt"], "netCDF"),
        (["--example"], "nothing but -o beside it"),
    ],
)
def test_wrong_options_are_named(folder, words, message):
    done = run("shuttle.yaml", *words)
    assert message in str(done.exception)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "trackroller carriage --example -o shuttle.yaml"),
        (["nothere.yaml"], "trackroller carriage --example -o nothere.yaml"),
        (["--example", "-o", "a.txt"], "ends in .yaml"),
        (["--example", "-o", "shuttle.yaml"], "is there already"),
        (["--example", "--study"], "--study"),
    ],
)
def test_a_newcomer_is_led_to_the_example(folder, words, message):
    before = (folder / "shuttle.yaml").read_text()
    done = run(*words)
    assert message in str(done.exception)
    assert (folder / "shuttle.yaml").read_text() == before


def test_the_example_is_one_file_that_can_be_solved(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run("--example").stdout == EXAMPLE
    done = run("--example", "-o", "cart.yaml")
    assert done.exit_code == 0 and "trackroller carriage cart.yaml" in done.stderr
    ds = forces_of(load_carriage(tmp_path / "cart.yaml"))
    assert np.allclose(ds.axial_force.sum("roller"), -100 * GRAVITY)
    assert run("cart.yaml", "--spectrum", "FL", "-o", "s.yaml").exit_code == 0
    assert load_spectrum(tmp_path / "s.yaml").blocks[1].name == "curve"


@pytest.mark.slow
def test_the_example_answers_how_many_years(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run("--example", "-o", "shuttle.yaml").exit_code == 0
    said = run("shuttle.yaml").output
    assert "ends first" in said and "years)" in said
    ds = tr.carriage("shuttle.yaml")
    last = " ".join(said.split()).rpartition("The carriage lasts ")[2]
    worst = ds.attrs["worst_roller"]
    body, limit = (str(ds[name].sel(roller=worst).values) for name in ("first_body", "first_limit"))
    place = {"guide": f"the rail under roller {worst}", "roller": f"roller {worst}"}[body]
    per_year = float((ds.life_hours / ds.life_years).sel(roller=worst))
    ends = [float(ds[f"life_hours{end}"].sel(roller=worst)) / per_year for end in ("_low", "_high")]
    assert re.search(
        rf"\(([\d.]+) to ([\d.]+) years\): then {place} reaches its first limit, {re.escape(LIMITS[limit].word)}\.$",
        last,
    ), last
    told = re.search(r"\(([\d.]+) to ([\d.]+) years", last)
    assert [float(end) for end in told.groups()] == pytest.approx(ends, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("more", "body", "limit"), [({}, None, "fatigue"), ({"guide_overrollings_per_hour": 1e9}, "guide", None)]
)
def test_the_body_and_the_limit_that_end_a_carriage(more, body, limit):
    """One load case: the first body and limit are those of `trackroller.solve` under the same loads."""
    whole = load_carriage(cart(rollers=rollers_below(roller=ROLLER | more), cases=[{"name": "run", "speed": "1 m/s"}]))
    ds = with_lives(forces_of(whole), whole)
    case = cases_of(whole, ds)[0, 0]
    one = tr.solve(case, ("forces", "peak_stress", "life", "limits"), contact_model="sliding")
    alone = one.life_to_first_limit_hours.values
    first = ["roller", "guide"][int(np.nanargmin(alone))]
    words = one.limiting_mechanism.attrs["flag_meanings"].split()
    assert str(ds.first_body.values[0]) == first and (body is None or first == body)
    which = words[list(one.limiting_mechanism.attrs["flag_values"]).index(int(one.limiting_mechanism.sel(body=first)))]
    assert str(ds.first_limit.values[0]) == which and (limit is None or which == limit)


def test_the_report_of_a_data_set(tmp_path):
    path = tr.report(tr.carriage(cart(), lives=False), tmp_path / "page.html")
    assert "carries most" in path.read_text(encoding="utf-8")
