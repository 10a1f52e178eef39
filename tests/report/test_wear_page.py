"""The page and the command of a roller that wears: sentences from the rows, figures, and a run that goes on."""

import html
import json
import re
import shlex
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from limit_rows import headline, part_of
from typer.testing import CliRunner

import trackroller as tr
from trackroller.cli.main import app
from trackroller.report.figures.wear import course, profiles
from trackroller.results.validity_flags import SLIDING_WEAR
from trackroller.results.wear_answer import answer_of_wear, deeper_contact
from trackroller.roller.limit_notes import Placeholder, placeholder_line
from trackroller.roller.wearing import Groove, travel_to_depth

CASE = """
motor_force: -10
axial_force: 20
friction_coefficient: 0.2
roller_material: {like: 1.7225-quenched-tempered, wear_coefficient: 1.0e-5}
guide_material: {like: 1.7225-quenched-tempered, wear_coefficient: 0}
contact_model: sliding
accuracy: preview
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wear")
    (folder / "case.yaml").write_text(CASE)
    return folder


def call(folder, to, name, *more):
    words = ["wear", str(folder / "case.yaml"), "--to", to, "-o", str(folder / name), *more]
    result = CliRunner().invoke(app, words, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def read(path):
    with xr.open_dataset(path) as ds:
        return ds.load()


@pytest.fixture(scope="module")
def whole(place):
    call(place, "9 km", "whole.nc", "--quiet")
    return read(place / "whole.nc")


@pytest.mark.long
def test_a_run_of_the_command_goes_on_with_the_same_bits_and_writes_its_page(place, whole):
    call(place, "4km", "parts.nc", "--quiet")
    said = call(place, "9km", "parts.nc", "--report", str(place / "page.html"))
    parts = read(place / "parts.nc")
    for name in whole.variables:
        np.testing.assert_array_equal(parts[name].values, whole[name].values, err_msg=str(name))
    page = (place / "page.html").read_text(encoding="utf-8")
    assert page.count("<img ") == 2 and "trackroller wear --to 9km --report page.html" in page
    answer = answer_of_wear(whole)
    assert headline(answer) in " ".join(said.split())
    assert answer.headline["depths"] == {"roller": 1e3 * float(whole.groove_depth.isel(travel=-1).max())}
    assert answer.headline["travel"] == 9.0 and answer.table["depth"].tolist()[1] == 0.0
    assert deeper_contact(whole) == 2
    np.testing.assert_array_equal(part_of(answer, "states")["travel"], whole.travel.values)
    for draw in (profiles, course):
        assert draw(whole)[1].caption
    assert tr.report(whole, place / "again.html").exists()


def test_the_surfaces_touch_and_hold_the_worn_depth(whole):
    gap = whole.roller_surface - whole.guide_surface
    assert gap.min("place").values == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_array_equal(whole.guide_surface.values, -whole.worn_depth.sel(body="guide").values)


@pytest.mark.slow
def test_the_page_states_the_wear_coefficient_and_that_it_is_a_placeholder(tmp_path):
    case = {"motor_force": 0, "axial_force": 0, "friction_coefficient": 0.2}
    ds = tr.wear(case, to=1, contact_model="sliding", accuracy="preview")
    page = tr.report(ds, tmp_path / "page.html").read_text(encoding="utf-8")
    command = shlex.split(html.unescape(re.search("<code>(trackroller wear .*?)</code>", page)[1]))
    assert command[2:6] == ["--to", "1km", "--report", "page.html"]
    assert {"motor_force=0", "friction_coefficient=0.2", "contact_model=sliding", "accuracy=preview"} < set(command)
    assert SLIDING_WEAR in page
    assert "wear coefficient <i>k</i><sub>W</sub>" in page and "4.2·10⁻⁵ to 8.3·10⁻⁴" in page
    assert answer_of_wear(ds).headline["guessed"]


def test_the_headline_tells_a_larger_pressure_between_both_ends_alone(whole):
    worn = whole.assign(max_pressure=whole.max_pressure.copy())
    rising = np.linspace(400.0, 600.0, worn.sizes["travel"])
    worn["max_pressure"] = worn.max_pressure * 0.0 + xr.DataArray(rising, dims="travel")
    answer = answer_of_wear(worn)
    assert headline(answer).count("600 MPa") == 1
    assert answer.headline["pressure_error"] == float(whole.pressure_error.sel(contact=2).max()) > 0.0
    rising[1] = 700.0
    worn["max_pressure"] = worn.max_pressure * 0.0 + xr.DataArray(rising, dims="travel")
    assert "700 MPa at" in headline(answer_of_wear(worn))


def test_a_place_that_hardly_wears_gives_no_warning_on_the_way_to_the_permissible_depth():
    one = Groove(1.0, np.zeros((1, 2, 2)), np.zeros(1), np.zeros(1))
    two = replace(one, travel=2.0, depth=np.array([[[0.1, 5e-324], [0.0, 0.0]]]))
    with np.errstate(all="raise", under="ignore"):
        assert travel_to_depth(one, two, 0.05) == pytest.approx(1.5)
        assert travel_to_depth(one, two, 0.2) == np.inf


def worn_with(ds, damages, lives, end="travel", **inputs):
    """Return a run with damage sums at its end and lives [km] by body, and with other inputs of its case."""
    own = ds.assign({name: ds[name].copy(deep=True) for name in ("fatigue_damage", "life_travel", "life_travel_new")})
    for body, damage, life, new in zip(("roller", "guide"), damages, *lives, strict=True):
        own["fatigue_damage"].loc[{"body": body}] = damage
        own["life_travel"].loc[{"body": body}] = life
        own["life_travel_new"].loc[{"body": body}] = new
    case = json.loads(ds.attrs["case"]) | inputs
    return own.assign_attrs(case=json.dumps(case), end=end)


def test_fatigue_within_the_run_is_in_the_headline_and_a_longer_life_has_the_run_as_its_low_end(whole):
    last = float(whole.travel[-1])
    cut = worn_with(whole, (3.0, 0.2), ((0.4 * last, np.nan), (last, 9 * last)))
    answer = answer_of_wear(cut)
    assert answer.headline["fatigue"] == {"body": "roller", "travel": 0.4 * last}
    assert f"fatigue ends the roller after {0.4 * last:.3g} km" in headline(answer)
    lives = answer.table.set_index("body")[["life_travel", "life_travel_high"]]
    assert lives.loc["roller"].tolist() == [0.4 * last] * 2 and lives.loc["guide"].tolist() == [last, np.inf]
    assert answer_of_wear(worn_with(whole, (0.3, 0.2), ((np.nan,) * 2, (last,) * 2))).headline["fatigue"] is None


def test_a_required_travel_is_judged_by_fatigue_by_the_end_of_the_run_and_by_its_length(whole):
    last = float(whole.travel[-1])
    never, measured = ((np.nan,) * 2, (9 * last,) * 2), whole.assign_attrs(limits_notes="")
    for required, own, end, state in (
        (0.9 * last, never, "travel", "met"),
        (1.1 * last, never, "travel", "open"),
        (1.1 * last, never, "permissible", "missed"),
        (0.9 * last, ((0.5 * last, np.nan), (last, last)), "travel", "missed"),
        (0.4 * last, ((0.5 * last, np.nan), (last, last)), "travel", "met"),
    ):
        ds = worn_with(measured, (0.5, 0.5), own, end, required_travel=required)
        answer = answer_of_wear(ds)
        assert answer.headline["state"] == state and f"required {required:.3g} km: {state}" in headline(answer)
    guessed = whole.assign_attrs(limits_notes=placeholder_line([Placeholder("wear", "PA6", "wear_coefficient")]))
    ds = worn_with(guessed, (0.5, 0.5), never, required_travel=0.5 * last)
    assert answer_of_wear(ds).headline["state"] == "open"  # another coefficient may end it before
    ds = worn_with(guessed, (0.5, 0.5), ((0.2 * last, np.nan), (0.4 * last, last)), required_travel=0.5 * last)
    assert answer_of_wear(ds).headline["state"] == "missed"  # fatigue of the new groove alone
    assert "travel" not in answer_of_wear(guessed).not_given


def test_json_of_a_run_is_its_record(place, whole):
    said = call(place, "9 km", "whole.nc", "--json")
    content = json.loads(said)
    expected = json.loads(json.dumps(answer_of_wear(whole).to_dict()))
    assert content["answer"] == expected
    assert content["answer"]["question"] == "wear"
    depths = np.array(content["groove_depth"]["value"])
    np.testing.assert_array_equal(depths, whole["groove_depth"].values)
    assert {flag["name"] for flag in content["flags"]} >= {"wear_of_sliding"}
