"""What the live page says of a carriage is what `trackroller carriage` says, and it writes its own files only."""

from __future__ import annotations

import numpy as np
import pytest

import trackroller as tr
from trackroller.app.carriage import (
    Change,
    carriage_files,
    carriage_lives,
    carriage_loads,
    carriage_spectrum,
    open_carriage,
    save_carriage,
)
from trackroller.carriage.example import EXAMPLE
from trackroller.carriage.file import load_carriage
from trackroller.carriage.solve import forces_of
from trackroller.errors import InputError
from trackroller.study.spectrum.file import load_spectrum
from trackroller.yaml_file import change_yaml, parse_mapping


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def changed(**values):
    """Return the changes of values whose paths are written with two underscores."""
    parts = {name: name.split("__") for name in values}
    return [
        Change(path=[int(one) if one.isdigit() else one for one in parts[name]], value=value)
        for name, value in values.items()
    ]


def test_the_loads_are_those_of_the_statics():
    shown = carriage_loads(EXAMPLE, changes=changed(mass__value="55", payloads__0__at__1="12"))
    values = parse_mapping(EXAMPLE, "file")
    values["mass"]["value"], values["payloads"][0]["at"][1] = 55, 12
    ds = forces_of(load_carriage(values))
    assert shown["errors"] == []
    np.testing.assert_array_equal(shown["loads"]["radial"], ds.radial_force)
    np.testing.assert_array_equal(shown["loads"]["axial"], ds.axial_force)
    assert [row[0] for row in shown["loads"]["table"]["rows"]] == ["FL", "FR", "RL", "RR"]
    assert shown["values"] == values


def test_a_change_keeps_the_comments():
    shown = carriage_loads(EXAMPLE, changes=changed(rollers__FL__at__2="1.5", cases__1__speed="2 m/s"))
    before, after = EXAMPLE.splitlines(), shown["text"].splitlines()
    assert [pair for pair in zip(before, after, strict=True) if pair[0] != pair[1]] == [
        ("    at: [150, 40, 0]", "    at: [150, 40, 1.5]"),
        (before[-3], before[-3].replace("1 m/s", "2 m/s")),
    ]


def test_entries_are_added_and_removed():
    new = "{value: 3 kg, at: [0, 0, 50]}"
    shown = carriage_loads(EXAMPLE, changes=changed(payloads__1=new, cases__0=None, duty=None))
    assert len(shown["values"]["payloads"]) == 2 and len(shown["values"]["cases"]) == 2
    assert "duty" not in shown["values"]
    assert "shares that add up to 1" in shown["errors"][0]["message"]


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"mass__value": "fast"}, "mass.value"),
        ({"mass__value": "yes"}, "mass.value"),
        ({"mass__value": "[1"}, "mass.value"),
        ({"cases__1__speed": "-1"}, "case 'curve'.speed"),
        ({"rollers__FL__x_R": "[0, 1, 0]"}, "rollers.FL.pushes"),
        ({"rollers__FL__at__0": "10"}, "preload[1].pair"),
        ({"preload": None}, "case"),
    ],
)
def test_wrong_values_are_named_by_their_fields(change, field):
    shown = carriage_loads(EXAMPLE, changes=changed(**change))
    assert [one["field"] for one in shown["errors"]] == [field]
    assert shown["loads"] is None and shown["values"]


def test_a_carriage_that_tips_keeps_its_places():
    shown = carriage_loads(EXAMPLE, changes=changed(preload=None))
    assert "the carriage: it" in shown["errors"][0]["message"]
    assert len(shown["places"]["rollers"]) == 4


@pytest.mark.parametrize("text", ["", "mass: [", "- 1", "mass: !!python/object:os.system {}", "a: &a [*a]"])
def test_texts_that_are_no_carriage_are_named(text):
    assert carriage_loads(text)["errors"]
    assert carriage_loads(text, changes=changed(mass__value="1"))["errors"]


@pytest.mark.slow
def test_lives_are_those_of_the_command():
    shown, ds = carriage_lives(EXAMPLE), tr.carriage(parse_mapping(EXAMPLE, "file"))
    assert shown["worst"] == ds.attrs["worst_roller"]
    assert "years" in shown["headline"]["lead"]
    assert [one["title"] for one in shown["tables"]] == [
        "Limits",
        "Loads of the rollers",
        "Load cases and margins",
        "Masses",
        "Places and directions",
        "Values that nobody has measured",
    ]


def test_the_page_writes_over_its_own_files_only(folder):
    mine = f"# mine\n{EXAMPLE}"
    assert save_carriage(EXAMPLE, "cart.yaml") == {"file": "cart.yaml"}
    save_carriage(EXAMPLE + "\n", "cart.yaml", "cart.yaml")
    assert carriage_files()["files"] == ["cart.yaml"]
    (folder / "cart.yaml").write_text(mine)
    with pytest.raises(InputError, match="is there already"):
        save_carriage(EXAMPLE, "cart.yaml", "cart.yaml")
    assert open_carriage("cart.yaml") == {"text": mine}
    for opened in ("", "other.yaml"):
        with pytest.raises(InputError, match="is there already"):
            save_carriage(EXAMPLE, "cart.yaml", opened)
    save_carriage(EXAMPLE, "cart.yaml", "cart.yaml")
    assert (folder / "cart.yaml").read_text() == EXAMPLE


@pytest.mark.parametrize("name", ["config/materials.yaml", "config/Materials.YAML", "config.yaml", "profiles/a.yaml"])
def test_names_of_other_kinds_of_files_are_refused(folder, name):
    (folder / name).parent.mkdir(exist_ok=True)
    (folder / name).write_text(EXAMPLE)
    for act in (lambda: open_carriage(name), lambda: save_carriage("materials: {}\n", name, name)):
        with pytest.raises(InputError, match="is a name of another kind of file"):
            act()
    assert (folder / name).read_text() == EXAMPLE and name not in carriage_files()["files"]


@pytest.mark.parametrize("text", ["axial_force: 3\n", "materials: {}\n", "mass: 3\nrollers: {}\n", ""])
def test_only_a_carriage_is_opened_and_saved(folder, text):
    (folder / "a.yaml").write_text(text)
    with pytest.raises(InputError, match="is no carriage file"):
        open_carriage("a.yaml")
    with pytest.raises(InputError, match="is no carriage file"):
        save_carriage(text, "new.yaml")
    with pytest.raises(InputError, match="is there already"):
        save_carriage(EXAMPLE, "a.yaml", "a.yaml")
    assert (folder / "a.yaml").read_text() == text and not (folder / "new.yaml").exists()


def test_the_list_holds_what_can_be_opened(folder):
    for name in ("a.yaml", ".hidden.yaml", "studies/b.yaml", "results/c.yaml", "carts/d.yml", "carts/deep/e.yaml"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(EXAMPLE)
    (folder / "roller.yaml").write_text("axial_force: 3")
    (folder / "link.yaml").symlink_to(folder / "a.yaml")
    assert carriage_files()["files"] == ["a.yaml", "carts/d.yml"]


@pytest.mark.parametrize(
    "name",
    ["../a.yaml", "/tmp/a.yaml", "a.txt", "", ".a.yaml", "results/a.yaml", "studies/a.yaml", "a/b/c.yaml", "l.yaml"],
)
def test_other_places_are_refused(folder, name):
    (folder / "l.yaml").symlink_to(folder.parent / "elsewhere.yaml")
    for act in (lambda: save_carriage(EXAMPLE, name), lambda: open_carriage(name)):
        with pytest.raises(InputError):
            act()
    if name:
        with pytest.raises(InputError):
            carriage_spectrum(EXAMPLE, "FL", name)


def test_the_spectrum_of_a_roller_is_written(folder):
    assert carriage_spectrum(EXAMPLE, "FL", "shuttle.yaml") == {"file": "shuttle-FL.yaml"}
    blocks = load_spectrum(folder / "shuttle-FL.yaml").blocks
    assert [block.name for block in blocks] == ["start", "curve", "run"]
    with pytest.raises(InputError, match="'FX' is not known"):
        carriage_spectrum(EXAMPLE, "FX", "shuttle.yaml")


def test_rollers_are_found_beside_the_carriage(folder):
    (folder / "carts").mkdir()
    values = parse_mapping(EXAMPLE, "file")["rollers"]["FL"]["roller"]
    (folder / "carts" / "r.yaml").write_text("\n".join(f"{key}: {value}" for key, value in values.items()))
    text = EXAMPLE.replace("*roller", "r.yaml")
    assert carriage_loads(text, "carts/a.yaml")["errors"] == []
    assert "is not there" in carriage_loads(text)["errors"][0]["message"]


def test_a_path_that_leads_nowhere_is_named():
    shown = carriage_loads(EXAMPLE, changes=changed(rollers__FL__at__x="10"))
    assert [one["field"] for one in shown["errors"]] == ["rollers.FL.at.x"]
    assert shown["text"] == EXAMPLE


@pytest.mark.parametrize(
    "body",
    [
        {"text": 5},
        {"text": EXAMPLE, "changes": 3},
        {"text": EXAMPLE, "changes": [{"path": "mass", "value": "1"}]},
        {"text": EXAMPLE, "changes": [{"path": ["mass"]}]},
        {"text": EXAMPLE, "more": 1},
    ],
)
def test_malformed_questions_are_refused(live, body):
    status, found = live.ask("carriage_loads", **body)
    assert status == 400 and found["errors"][0]["message"].startswith("The request is wrong")


@pytest.mark.parametrize(
    "path", [[], [-1], ["mass", "value", "deep"], ["rollers", 3], ["payloads", 7, "value"], ["name", "x"]]
)
def test_odd_paths_are_answered_in_words(live, path):
    status, found = live.ask("carriage_loads", text=EXAMPLE, changes=[{"path": path, "value": "1"}])
    assert status == 200 and (found["errors"] or found["text"] != EXAMPLE)


def scalars(values, path=()):
    """Yield the path of each number and text."""
    for key, value in values.items() if isinstance(values, dict) else enumerate(values):
        if isinstance(value, (dict, list)):
            yield from scalars(value, (*path, key))
        else:
            yield (*path, key)


def test_each_value_of_the_text_can_be_changed():
    """The changed text reads as the changed values; the case that all rollers share is changed for all of them."""
    for path in scalars(parse_mapping(EXAMPLE, "file")):
        expected = parse_mapping(EXAMPLE, "file")
        place = expected
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = 4711
        text = change_yaml(EXAMPLE, [(path, "4711")], "file")
        assert parse_mapping(text, "file") == expected, path
        assert text.count("#") == EXAMPLE.count("#")


def test_a_value_is_added_where_a_mapping_is_missing():
    assert change_yaml("a: 1\n", [(["drive", "at"], "[0, 0, -20]")], "file") == "a: 1\ndrive: {at: [0, 0, -20]}\n"
