"""The page and the command of a roller that wears: sentences from the rows, figures, and a run that goes on."""

import html
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
from trackroller.results.flags import SLIDING_WEAR
from trackroller.results.wear_answer import answer_of_wear, deeper_contact
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
    assert "wear coefficient <i>k</i><sub>W</sub>" in page and "1·10⁻⁵ to 1·10⁻⁴" in page
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
