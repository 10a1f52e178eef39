"""Every text of a user passes one check where it is read, and no cell of a table runs as a formula."""

from __future__ import annotations

import errno

import numpy as np
import pandas as pd
import pytest
import yaml
from command_line import trackroller

import trackroller as tr
from trackroller.carriage.file import load_carriage
from trackroller.errors import InputError, checked_text
from trackroller.files import STUDY_MARK, disk_error, inert_cell
from trackroller.materials.edit import add_material
from trackroller.materials.entries import EntryParser
from trackroller.report.workbook import write_cases
from trackroller.study.spectrum.file import Spectrum

SIGNS = ["\x1b[2J", "\x07", "a\x00b", "\x85", "\x9b31m", "\u202egpj.exe", "\u2066x", "\u200f", "\ud800"]
ROLLER = {"at": [0, 0, 0], "pushes": [0, 0, -1], "x_R": [0, 1, 0], "stiffness": 1e4}
CART = {"mass": {"value": 4, "at": [0, 0, 0]}, "rollers": {"F": ROLLER}, "cases": [{"name": "run"}]}
SPECTRUM = {"name": "s", "blocks": [{"name": "run", "distance": 1000, "radial_force": -200}]}
STUDY = {"name": "s", "outputs": ["forces"], "factors": {"velocity": {"values": [60, 70]}}}


@pytest.mark.parametrize("sign", SIGNS)
def test_a_sign_that_a_terminal_obeys_is_refused_and_shown_escaped(sign):
    with pytest.raises(InputError, match="holds a control character or a mark of direction") as caught:
        checked_text(f"lift {sign}", "name")
    assert str(caught.value).isprintable()
    named = str(caught.value).split("Remove the character ")[1].rstrip(".")
    assert named.encode("ascii").decode("unicode_escape") in sign
    text = f"lift {sign}".replace(named.encode("ascii").decode("unicode_escape"), "")
    assert checked_text(text, "name") == text, "the remedy works"


ALIKE = ["a\u200b", "\ufeffa", "so\xadft", "a\u2060b", "a\u200d", "a\ufe0f", "\u3164", "\u2800", "\U000e0041a"]


@pytest.mark.parametrize(("value", "shown"), [(np.float64(2.5), "2.5"), (np.array([1.0, 2.0]), "[1.0, 2.0]")])
def test_a_message_shows_numbers_without_names_of_the_library(value, shown):
    assert f"slip = {shown} is" in str(InputError("slip", value, "a number"))


@pytest.mark.parametrize("text", [*ALIKE, "\u0301a", "a \u0308", "   ", "\u3000"])
def test_a_name_that_does_not_show_whole_is_refused_and_the_remedy_works(text):
    with pytest.raises(InputError, match=r"an invisible character|without its letter|blanks") as caught:
        checked_text(text, "name")
    if text.isspace():
        assert "Write a name" in str(caught.value)
        return
    code = str(caught.value).split("Remove the character ")[1].rstrip(".")
    mended = text.replace(code.encode("ascii").decode("unicode_escape"), "") or "name"
    assert checked_text(mended.rstrip(), "name")


@pytest.mark.parametrize("text", ["e\u0301", "می‌خواهم", "नमस्‍ते", "👨‍👩‍👧", "⚠\ufe0f"])
def test_letters_of_several_characters_stay(text):
    assert checked_text(text, "name") == text


@pytest.mark.parametrize("value", [None, ""])
def test_an_empty_name_is_one_that_was_not_given(value):
    cart = load_carriage(CART | {"name": value, "description": value, "cases": [{"name": value}]})
    assert (cart.name, cart.description, cart.cases[0].name) == ("carriage", "", "case 1")
    spectrum = Spectrum.from_dict(SPECTRUM | {"name": value, "blocks": [{"name": value, "distance": 10}]})
    assert (spectrum.name, spectrum.blocks[0].name) == ("spectrum", "block 1")


@pytest.mark.parametrize("value", [True, 1.5, ["a"], {"a": 1}, np.ones(2)])
@pytest.mark.parametrize("key", ["name", "description", "cases"])
def test_a_name_is_a_text(key, value):
    given = [{"name": value}] if key == "cases" else value
    with pytest.raises(InputError, match=r"a text, or a whole number\. Put the text in quotes"):
        load_carriage(CART | {key: given})


@pytest.mark.parametrize("name", ["", None])
def test_a_roller_has_a_name(name):
    with pytest.raises(InputError, match="name of a roller is missing"):
        load_carriage(CART | {"rollers": {name: ROLLER}})


@pytest.mark.parametrize("text", ["Förderer 7", "滑车", "a b\u00a0c", "µm ± 3 °", "=1+1", "العربة"])
def test_other_texts_stay(text):
    assert checked_text(text, "name") == text


def test_only_a_description_has_several_lines():
    assert checked_text("two\nlines\tand a tab", "description", lines=True)
    with pytest.raises(InputError, match="control character"):
        checked_text("two\nlines", "name")


@pytest.mark.parametrize(
    ("read", "field"),
    [
        (lambda text: load_carriage(CART | {"name": text}), "name"),
        (lambda text: load_carriage(CART | {"description": text}), "description"),
        (lambda text: load_carriage(CART | {"rollers": {text: ROLLER}}), "roller"),
        (lambda text: load_carriage(CART | {"cases": [{"name": text}]}), "name"),
        (lambda text: Spectrum.from_dict(SPECTRUM | {"name": text}), "name"),
        (lambda text: Spectrum.from_dict(SPECTRUM | {"description": text}), "description"),
        (lambda text: Spectrum.from_dict(SPECTRUM | {"blocks": [SPECTRUM["blocks"][0] | {"name": text}]}), "name"),
        (lambda text: tr.load_study(STUDY | {"description": text}), "description"),
        (lambda text: tr.load_study(STUDY | {"factors": {"roller_material": {"values": [text]}}}), "roller_material"),
        (lambda text: tr.Case.from_dict({"roller_material": text}), "roller_material"),
        (lambda text: tr.fit_sn({}, name=text), "name of a material"),
        (lambda text: tr.fit_bench({}, "slope", name=text), "name of a material"),
        (lambda text: add_material("materials.yaml", text, like="PA6"), "name of a material"),
    ],
)
def test_texts_of_mappings_are_checked(read, field):
    with pytest.raises(InputError, match="control character") as caught:
        read("run\x1b[2J")
    assert field in str(caught.value)


@pytest.mark.parametrize("place", ["name", "value", "key"])
def test_texts_of_files_are_checked(tmp_path, place):
    evil = "run\x1b[2J"
    cart = {
        "name": CART | {"name": evil},
        "value": CART | {"cases": [{"name": evil}]},
        "key": CART | {"rollers": {evil: ROLLER}},
    }[place]
    (tmp_path / "cart.yaml").write_text(yaml.safe_dump(cart))
    done = trackroller("carriage", "cart.yaml", cwd=tmp_path, code=2)
    assert "\\x1b" in done.stderr and "\x1b" not in done.stdout + done.stderr
    assert "line " in done.stderr


@pytest.mark.parametrize("table", ["label,velocity\nrun\x1b[2J,60\nb,70\n", "lab\x1bel,velocity\na,60\nb,70\n"])
def test_labels_of_tables_are_checked(tmp_path, table):
    (tmp_path / "t.csv").write_text(table)
    (tmp_path / "s.yaml").write_text("{name: s, method: table, table: t.csv, outputs: [forces]}")
    done = trackroller("plan", "s.yaml", cwd=tmp_path, code=2)
    line = 1 if "lab\x1bel" in table else 2
    assert f"t.csv, line {line}" in done.stderr and "\x1b" not in done.stdout + done.stderr


@pytest.mark.parametrize("text", ["my\x1b[2J", "two\nlines"])
def test_names_of_materials_are_checked(text):
    with pytest.raises(InputError, match=r"name of a material = .* control character"):
        EntryParser("materials.", "file", {}).material(text, {"like": "PA6"}, {})


@pytest.mark.parametrize(
    "line", ["carriage ca\x1b[2Jrt.yaml", "solve --set a\x1b[2Jb=1", "so\x1b[2Jlve", "solve --a\x1b=1"]
)
def test_messages_show_what_was_written_escaped(tmp_path, line):
    done = trackroller(*line.split(" "), cwd=tmp_path, code=2)
    assert "\\x1b" in done.stderr and "\x1b" not in done.stdout + done.stderr


@pytest.mark.parametrize("text", ["=1+1", "+cmd", "-run", "@SUM(A1)", "\t=1", "\r=1", "-2+3", "=-1", "+1+1"])
def test_a_cell_that_a_spreadsheet_would_run_is_a_text(text):
    assert inert_cell(text) == f"'{text}"


@pytest.mark.parametrize("value", [-1, "-1", "+2.5e-3", "-1,5", "-inf", "run", "", None, 3.0, "a=b"])
def test_numbers_and_other_texts_of_cells_stay(value):
    assert inert_cell(value) == value


def test_heads_and_cells_of_a_written_table_do_not_run(tmp_path):
    table = pd.DataFrame({"=head": ["=1+1", "run"], "velocity": [-1.0, 2.0]})
    path = write_cases(table, tmp_path / "t.csv")
    assert path.read_text().splitlines() == ["'=head,velocity", "'=1+1,-1.0", "run,2.0"]


def test_only_a_study_keeps_its_finished_cases(tmp_path):
    full = OSError(errno.ENOSPC, "no space")
    alone, study = tmp_path / "out.nc", tmp_path / "results" / "s" / "chunks" / "1.nc"
    study.parent.mkdir(parents=True)
    (study.parent.parent / STUDY_MARK).write_text("{}")
    assert "finished case" not in str(disk_error(full, alone))
    assert "every finished case is kept" in str(disk_error(full, study))


ODD = ["=1+1", "+20 N", "-x", "@SUM(A1)"]


@pytest.mark.parametrize("name", ODD)
@pytest.mark.parametrize("ending", ["csv", "xlsx"])
def test_a_table_that_was_written_has_the_same_names_when_it_is_read(tmp_path, monkeypatch, name, ending):
    """A material, a load case and a roller may have any name: what we write is inert, and is read as it was meant."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "config").mkdir()
    add_material(tmp_path / "config/materials.yaml", name, like="PA6")
    table = pd.DataFrame({"label": [name, "b"], "roller_material": ["PA6", name], "velocity": [60.0, 70.0]})
    path = write_cases(table, tmp_path / f"t.{ending}")
    study = {"name": "s", "method": "table", "table": path.name, "outputs": ["forces"], "contact_model": "sliding"}
    read = tr.load_study(study).drawn.columns
    assert read["label"].tolist() == [name, "b"] and read["roller_material"].tolist() == ["PA6", name]


@pytest.mark.parametrize("name", ODD)
def test_the_study_of_a_carriage_keeps_names_of_rollers_cases_and_materials(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "config").mkdir()
    add_material(tmp_path / "config/materials.yaml", name, like="PA6")
    roller = ROLLER | {"roller": {"contact_model": "sliding", "velocity": 60}}
    places = {name: [-100, 40, 0], "B": [100, 40, 0], "C": [-100, -40, 0], "D": [100, -40, 0]}
    rollers = {key: roller | {"at": at} for key, at in places.items()}
    rollers[name]["roller"] = {"contact_model": "sliding", "velocity": 60, "roller_material": name}
    cart = CART | {"rollers": rollers, "cases": [{"name": name, "speed": 1}]}
    (tmp_path / "cart.yaml").write_text(yaml.safe_dump(cart))
    trackroller("carriage", "cart.yaml", "--study", "-o", "loads.yaml", cwd=tmp_path)
    assert all(
        cell[:1] not in "=+@"
        for line in (tmp_path / "loads.csv").read_text().splitlines()[1:]
        for cell in line.split(",")
    )
    read = tr.load_study("loads.yaml").drawn.columns
    assert set(read["load_case"]) == {name} and name in read["roller"] and name in read["roller_material"]


def test_a_formula_in_a_table_is_refused_and_a_name_with_an_apostrophe_is_taken(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study = {"name": "s", "method": "table", "table": "t.csv", "outputs": ["forces"]}
    (tmp_path / "t.csv").write_text("label,velocity\n=1+1,60\nb,70\n")
    with pytest.raises(InputError, match=r"this is a formula\. Write its value; if it is a name, write ' before it"):
        tr.load_study(study)
    (tmp_path / "t.csv").write_text("label,velocity\n'=1+1,60\nb,70\n")
    assert tr.load_study(study).drawn.columns["label"].tolist() == ["=1+1", "b"]
