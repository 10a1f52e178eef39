"""What the page shows is what `solve`, the sheet and the study file say."""

from __future__ import annotations

import base64
import io
import json
import re
import threading
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import fake_solver
import numpy as np
import openpyxl
import pytest
import yaml

import trackroller as tr
from trackroller.app.fields import all_fields, slider
from trackroller.app.lane import STALE, Lane
from trackroller.app.materials import material, save_material
from trackroller.app.picture import curve, file_of_roller, picture, texts
from trackroller.app.picture import find_range as range_of
from trackroller.app.server import FILES, SOLVING, answer
from trackroller.app.spectrum import spectrum
from trackroller.app.studies import checked, file_of_study, headlines, listing, page_of
from trackroller.errors import InputError, WorkError
from trackroller.materials import load_database
from trackroller.parameters import MATERIAL_FIELDS, OPTIONS, PARAMETERS
from trackroller.results.roller_answer import answer_of_roller
from trackroller.results.spectrum_answer import answer_of_spectrum
from trackroller.study.file.load import load_study
from trackroller.study.run import run_study
from trackroller.study.spectrum.file import Spectrum
from trackroller.study.spectrum.solve import solve_spectrum
from trackroller.study.store.put import replacing


def test_every_parameter_stands_on_the_page():
    fields = all_fields()
    assert [p["name"] for p in fields["parameters"]] == [*PARAMETERS, "outer_radius", "groove_depth"]
    assert all(p["meaning"] and p["allowed"] and p["group"] for p in fields["parameters"])
    assert set(fields["bodies"]) == set(MATERIAL_FIELDS)
    assert {o["name"] for o in fields["options"]} == set(OPTIONS)
    assert any("42CrMo4" in material["description"] for material in fields["materials"])


def test_a_slider_holds_its_example_within_the_bounds():
    for parameter in PARAMETERS.values():
        ends = slider(parameter)
        if ends is not None:
            assert ends[0] <= parameter.default <= ends[1] and ends[0] < ends[1]
            assert parameter.accepts(ends[0]) and parameter.accepts(ends[1])


def numbers(picture):
    """Return the numbers of both contacts by their words."""
    rows = [[cell["text"] for cell in row] for row in picture["parts"]["contacts"]["rows"]]
    lines = {words: [v.replace("−", "-").replace(",", "") for v in values] for words, *values, _ in rows}
    return {words: tuple(map(float, values)) for words, values in lines.items() if "·" not in "".join(values)}


@pytest.fixture(scope="module")
def shown():
    return picture({"axial_force": 20, "guide_curve_radius": "inf"}, "standard", complete=True, inside=True)


@pytest.mark.slow
def test_the_tables_hold_the_numbers_of_solve(shown):
    ds = tr.solve(tr.Case(axial_force=20, guide_curve_radius=float("inf")), accuracy="standard")
    lines = numbers(shown)
    np.testing.assert_allclose(lines["normal force F_N"], ds.normal_force.values, rtol=1e-3)
    np.testing.assert_allclose(lines["largest contact pressure p_max"], ds.max_pressure.values, rtol=1e-3)
    np.testing.assert_allclose(
        lines["peak stress of the roller (von Mises)"], ds.peak_stress.sel(body="roller"), rtol=1e-2
    )
    assert (
        shown["answer"]["kind"] == "lasts"
        and " h" in shown["headline"]["lead"]
        and shown["drawing"].lstrip().startswith("<svg")
    )


def test_the_maps_carry_the_load(shown):
    """The pressure over the patch, as it is sent in bytes, adds up to the normal force."""
    loads = numbers(shown)["normal force F_N"]
    for patch, load in zip(shown["patches"], loads, strict=True):
        field = patch["fields"]["pressure"]
        nx, ny = patch["size"]
        values = np.frombuffer(base64.b64decode(field["data"]), np.uint8).reshape(ny, nx) / 255 * field["top"]
        dx, dy = np.diff(patch["x"])[0] / (nx - 1), np.diff(patch["y"])[0] / (ny - 1)
        assert values.sum() * dx * dy == pytest.approx(load, rel=0.01)
        assert abs(patch["pole"][0]) < 10 * patch["ellipse"][0]


def test_the_stress_below_is_that_of_the_peak(shown):
    ds = tr.solve(tr.Case(axial_force=20, guide_curve_radius=float("inf")))
    for section in shown["sections"]:
        peak = float(ds.peak_stress.sel(contact=section["contact"], body=section["body"]))
        assert section["field"]["top"] == pytest.approx(peak, rel=0.03)


@pytest.mark.slow
def test_margins_are_those_of_the_sheet(shown):
    groups = ("forces", "contact", "friction_work", "peak_stress", "life", "limits")
    ds = tr.solve(tr.Case(axial_force=20, guide_curve_radius=float("inf")), groups)
    told = {(row["name"], row["body"]): row["used_low"] for row in answer_of_roller(ds).table.to_dict("records")}
    rows = shown["answer"]["rows"]
    found = {(row["name"], row["body"]): row["used_low"] for row in rows}
    common = set(told) & set(found)
    assert {"lift_off", "full_slip"} <= {name for name, _ in common}
    for key in common:
        assert (found[key] is None and np.isnan(told[key])) or found[key] == pytest.approx(told[key], rel=1e-6)
    assert len(shown["limits"]["rows"]) == len(shown["limits"]["bars"]) == len(rows)
    assert "low" in [head["name"] for head in shown["limits"]["heads"]]


def test_lift_off_and_wrong_values_are_words():
    said = picture({"axial_force": 130}, complete=True)["headline"]
    assert said["lead"] == "A contact lifts off" and said["rest"].startswith(": both contacts carry at")
    assert picture({"axial_force": 130})["headline"] == {"lead": "A contact lifts off", "rest": "."}
    with pytest.raises(tr.InputError, match="conform"):
        picture({"roller_profile_radius": -5})
    with pytest.raises(tr.InputError, match="axial_force"):
        picture({"axial_forc": 3})


def test_a_curve_is_the_results_of_its_cases():
    found = curve({"motor_force": 0}, "axial_force", [0.0, 60.0])
    assert len(found["along"]) == 21 and found["refused"] == ""
    ds = tr.solve([tr.Case(motor_force=0, axial_force=v) for v in (0.0, 60.0)], accuracy="preview")
    ends = [found["columns"]["peak_stress_roller"]["values"][i] for i in (0, -1)]
    np.testing.assert_allclose(ends, ds.peak_stress.sel(body="roller").max("contact"), rtol=1e-6)


def test_a_curve_is_there_for_every_result_and_follows_its_parameter():
    found = curve({"heat_transfer_coefficient": 20, "cooled_area": 3000}, "ambient_temperature", [0.0, 60.0])["columns"]
    assert {"normal_force_1", "spin_pole_lateral_2", "shakedown_utilisation_roller_1", "slip"} <= set(found)
    heat = found["utilisation_guide_heat"]["values"]
    assert all(cold < hot for cold, hot in pairwise(heat))
    assert len(set(found["normal_force_1"]["values"])) == 1


def test_a_curve_names_what_it_leaves_out():
    found = curve({}, "roller_profile_radius", [-28.0, -1.75])
    values = found["columns"]["max_pressure"]["values"]
    assert "conform" in found["refused"] and np.isnan(values[-1]) and np.isfinite(values[0])


def test_no_label_of_a_curve_names_an_equation():
    labels = [column["label"] for column in curve({}, "axial_force", [0.0, 30.0])["columns"].values()]
    assert "tilting moment about the rolling direction" in labels
    assert not [label for label in labels if "eq." in label]


def test_the_page_asks_about_a_drive_that_nobody_gave():
    told = [picture(values)["warnings"] for values in ({"axial_force": 40}, {"axial_force": 40, "motor_force": 0})]
    asked = [[text for head, text in listed if text.startswith("Is the roller driven?")] for listed in told]
    assert "motor_force is not given, so -30 N is used" in asked[0][0] and asked[1] == []


def test_sheet_and_workbook_of_roller_and_study_are_saved(tmp_path, monkeypatch):
    values = {"axial_force": "40", "contact_model": "sliding"}
    book = openpyxl.load_workbook(io.BytesIO(file_of_roller(values, "roller.xlsx")))
    assert ("axial_force", "axial force", 40, "N", "given") in book["inputs"].values
    monkeypatch.chdir(tmp_path)
    study = {"name": "small", "factors": {"axial_force": {"values": [0, 30]}}, "contact_model": "sliding"}
    tr.run(tr.load_study(study | {"accuracy": "preview"}), results="results")
    rows = list(openpyxl.load_workbook(io.BytesIO(file_of_study("small", "cases.xlsx")))["cases"].values)
    assert rows[0][0] == "axial_force" and rows[1][0] == "N" and [row[0] for row in rows[2:]] == [0, 30]
    with pytest.raises(tr.InputError, match="of a study that was run"):
        file_of_study("small", "report.pdf")  # its report was not made


def test_each_text_repeats_the_case():
    values = {
        "axial_force": "70 N",
        "guide_curve_radius": "inf",
        "roller_material": "PA6",
        "contact_model": "kalker_table",
    }
    found = texts(values)
    same = {"axial_force": 70.0, "guide_curve_radius": "inf", "roller_material": "PA6", "contact_model": "kalker_table"}
    assert yaml.safe_load(found["YAML"]) == same
    for word in ("axial_force=70.0", "guide_curve_radius=inf", "roller_material=PA6", "contact_model=kalker_table"):
        assert word in found["command"]
    place: dict = {}
    exec(found["Python"], place)
    assert place["ds"].attrs["contact_model"] == "kalker_table" and "PA6" in place["ds"].attrs["case"]


def test_text_and_fields_of_a_study_follow_each_other(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mapping = {"name": "two", "factors": {"axial_force": {"values": [0, 30]}}, "contact_model": "sliding"}
    from_fields = checked(None, mapping)
    assert from_fields["errors"] == [] and dict(from_fields["plan"])["cases"].startswith("2,")
    assert checked(from_fields["text"])["study"] == mapping == yaml.safe_load(from_fields["text"])


def test_errors_of_a_study_name_field_and_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = checked("name: two\nfactors:\n  axial_force: {values: [0, x]}\ncontact_model: slidin\n")
    assert [(e["field"], e["line"]) for e in found["errors"]] == [
        ("factors.axial_force.values", 3),
        ("contact_model", 4),
    ]
    assert found["plan"] == [] and found["study"]["name"] == "two"
    assert "line" in checked("name: [")["errors"][0]["message"]


def test_altered_results_are_named_in_the_list_and_their_pages_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mapping = {"name": "two", "factors": {"axial_force": {"values": [0, 30]}}, "contact_model": "sliding"}
    root = run_study(load_study(mapping), solver=fake_solver.solve).folder.root
    with replacing(root / "report.html") as beside:
        beside.write_text("sound")
    assert listing()[0]["state"] == "done" and page_of("two", "report.html").read_text() == "sound"
    for name in ("report.html", "study.nc"):
        (root / name).write_bytes((root / name).read_bytes()[:-1])
    assert listing()[0]["state"] == "stopped" and "study.nc was altered" in listing()[0]["error"]
    with pytest.raises(WorkError, match=r"report\.html was altered"):
        page_of("two", "report.html")
    with pytest.raises(WorkError, match=r"study\.nc was altered"):
        headlines("two")


def test_only_the_newest_request_of_a_page_is_worked_on():
    lane, begun, go, done = Lane("test"), threading.Event(), threading.Event(), []
    first = lane.submit("page 1", lambda: begun.set() or go.wait())
    assert begun.wait(5)
    old = [lane.submit("page 1", lambda i=i: done.append(i)) for i in range(5)]
    other = lane.submit("page 2", lambda: done.append("other"))
    go.set()
    assert old[-1].result(5) is None and other.result(5) is None and first.result(5)
    assert [future.result(5) for future in old[:-1]] == [STALE] * 4
    assert sorted(map(str, done)) == ["4", "other"]


def test_an_error_of_one_request_stops_no_other():
    lane = Lane("test")
    with pytest.raises(ZeroDivisionError):
        lane.submit(1, lambda: 1 / 0).result(5)
    assert lane.submit(1, lambda: 7).result(5) == 7


def test_a_material_of_ones_own_is_written_and_solved(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    known = {row["field"]: row for row in material("1.7225-normalised")["rows"]}
    assert (known["tensile_strength"]["value"], known["tensile_strength"]["unit"]) == ("720", "MPa")
    assert known["hardness"]["mark"].startswith("placeholder, expected from")
    changed = {"tensile_strength": "810,5", "youngs_modulus": "206 GPa"}
    answer = save_material("our steel", "1.7225-normalised", changed, "test 12")
    assert answer["file"] == "config/materials.yaml" and answer["doubts"] == []
    assert "our steel" in [row["name"] for row in answer["materials"]]
    own = load_database().material("our steel")
    assert (own.tensile_strength, own.youngs_modulus, own.poisson_ratio) == (810.5, 206e3, 0.33)
    assert own.records["tensile_strength"].source == "test 12"
    save_material("our steel", "our steel", {"tensile_strength": "820"}, "test 13")  # the other values stay
    own = load_database().material("our steel")
    assert (own.tensile_strength, own.youngs_modulus) == (820.0, 206e3)
    values = {"roller_material": "our steel", "guide_material": "our steel"}
    assert picture(values, "preview", complete=False, inside=False)["answer"]["kind"] == "lasts"


@pytest.mark.parametrize(
    ("name", "changed", "source", "field"),
    [
        ("our steel", {"tensile_strength": "-3"}, "test", "tensile_strength"),
        ("our steel", {"tensile_strength": "strong"}, "test", "tensile_strength"),
        ("our steel", {"source": "x"}, "test", "source"),
        ("our steel", {"path": "elsewhere.yaml"}, "test", "path"),
        ("our steel", {"replace": "no"}, "test", "replace"),
        ("our steel", {}, "test", "material"),
        ("our steel", {"tensile_strength": "800"}, " ", "source"),
        (" ", {"tensile_strength": "800"}, "test", "material name"),
        *(("our steel", {key: "800"}, "test", key) for key in ("source", "path", "name", "replace", "like", "family")),
    ],
)
def test_a_wrong_material_leaves_the_file_as_it_is(tmp_path, monkeypatch, name, changed, source, field):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=field):
        save_material(name, "1.7225-normalised", changed, source)
    assert list(tmp_path.iterdir()) == []


def test_the_page_sums_a_spectrum_by_share_and_finds_how_far_a_force_may_go():
    """The page answers as `solve_spectrum` on its own file does, and as `tr.find` does."""
    values = {
        "motor_force": 0, "friction_coefficient": 0.1, "contact_model": "sliding", "guide_overrollings_per_hour": 60,
        "permissible_wear_depth": 0.1, "duty": {"hours_per_day": 16, "days_per_year": 250},
    }  # fmt: skip
    loads = [("heavy", "25 %", "-200", "20"), ("light", "0,75", "-80", "0")]
    blocks = [dict(zip(("name", "amount", "radial_force", "axial_force"), load, strict=True)) for load in loads]
    found = spectrum(values, "share", blocks)
    again = solve_spectrum(Spectrum.from_dict(yaml.safe_load(found["text"])))
    assert found["answer"] == json.loads(json.dumps(answer_of_spectrum(again).to_dict()))
    assert "years" not in found["headline"]["lead"]  # below a year
    assert not any("shift" in head["name"] for table in found["tables"] for head in table["heads"])
    with pytest.raises(InputError, match="add up to 1"):
        spectrum(values, "share", blocks[:1])
    condition = "max_pressure <= 700"
    case = {name: value for name, value in values.items() if name not in ("duty", "contact_model")}
    far = tr.find(tr.Case(**case), "axial_force", condition, contact_model="sliding")
    assert range_of(values, "axial_force", condition)["text"] == far.text


def test_a_curve_of_a_life_says_how_many_hours_are_a_year():
    values = {"motor_force": 0, "contact_model": "sliding", "duty": {"hours_per_day": 16, "days_per_year": 250}}
    assert curve(values, "axial_force", [0, 30])["columns"]["roller_life_hours"]["unit"] == "h; 4000 h = 1 year"
    del values["duty"]
    assert curve(values, "axial_force", [0, 30])["columns"]["roller_life_hours"]["unit"] == "h"


def test_outputs_of_a_case_file_are_computed_beside_those_of_the_page():
    values = {"motor_force": 0, "contact_model": "sliding", "accuracy": "preview", "outputs": ["forces", "shakedown"]}
    shown = picture(values)
    assert numbers(shown) == numbers(picture({key: value for key, value in values.items() if key != "outputs"}))
    assert curve(values, "motor_force", [0, 10])["along"] == pytest.approx(np.linspace(0, 10, 21))


def test_how_far_a_force_may_go_takes_years_and_shows_the_band_of_the_life():
    """A year of the duty is 4,000 h; the band at the end of the range is that of the case there."""
    wears = {"like": "1.7225-quenched-tempered"}
    values = {"motor_force": 0, "friction_coefficient": 0.1, "contact_model": "sliding", "permissible_wear_depth": 0.5}
    values |= {"roller_material": wears, "guide_material": wears, "guide_overrollings_per_hour": 60}
    values |= {"roller_profile_radius": -6.4, "duty": {"hours_per_day": 16, "days_per_year": 250}}
    life = "pair_life_to_first_limit_hours"
    told = range_of(values, "axial_force", f"{life} >= 0.05 years")
    plain = range_of(values, "axial_force", f"{life} >= 200")
    assert told["ends"] == plain["ends"] and told["text"].startswith("0.05 years are 200 h. ")
    band = re.search(rf"Above .*?: {life} \S+ \(([\d.e+]+) to ([\d.e+]+)\)", plain["text"])
    end = plain["ends"][1] * 1.0001
    case = tr.Case.from_dict({name: value for name, value in values.items() if name not in ("duty", "contact_model")})
    ds = tr.solve(replace(case, axial_force=end), contact_model="sliding")
    ends = [float(ds[f"{life}_{end}"]) for end in ("low", "high")]
    assert [float(one) for one in band.groups()] == pytest.approx(ends, rel=1e-2) and ends[0] < ends[1]
    del values["duty"]
    with pytest.raises(InputError, match="needs a duty"):
        range_of(values, "axial_force", f"{life} >= 0.05 years")


def test_every_question_of_the_page_has_a_function_that_answers():
    """The script of the page names functions, which renaming them does not find."""
    for name in SOLVING | FILES:
        assert callable(answer(name))
    scripts = (Path(__file__).resolve().parents[2] / "web" / "src" / "app").glob("*.js")
    asked = {name for script in scripts for name in re.findall(r'\bask\(\s*"(\w+)"', script.read_text("utf-8"))}
    assert len(asked) > 10 and asked <= {*SOLVING, *FILES}
