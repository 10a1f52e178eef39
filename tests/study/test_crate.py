"""The RO-Crate of a study lists each file with its digest, reports damaged files, and suffices to solve it again."""

from __future__ import annotations

import hashlib
import json
import shutil
from pathlib import Path

import pytest
import xarray as xr
from command_line import trackroller
from typer.testing import CliRunner

from trackroller.cli.main import app
from trackroller.errors import InputError
from trackroller.study.store.crate import CRATE, compare_results, damaged_files, read_crate
from trackroller.study.store.folder import StudyFolder
from trackroller.study.store.input_files import study_of_folder
from trackroller.study.store.mark import MARK, signed

MATERIALS = """
materials:
  hard steel:
    like: 1.7225-quenched-tempered
    tensile_strength: {value: 1500, unit: MPa, source: data sheet}
"""
STUDY = """
name: crated
description: A study that travels.
base: {roller_material: hard steel}
method: table
table: tables/cases.csv
outputs: [forces, life]
contact_model: sliding
accuracy: preview
"""


@pytest.fixture(scope="module")
def crate(tmp_path_factory) -> Path:
    """Return the folder of a solved study with a table and materials of the user."""
    home = tmp_path_factory.mktemp("home")
    (home / "config").mkdir()
    (home / "tables").mkdir()
    (home / "config" / "materials.yaml").write_text(MATERIALS)
    (home / "tables" / "cases.csv").write_text("axial_force,motor_force\n10,0\n20,0\n30,-10\n")
    (home / "study.yaml").write_text(STUDY)
    _run(home, "run", "study.yaml", "-q")
    return home / "results" / "crated"


def _run(folder: Path, *words: str, code: int = 0) -> str:
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        done = CliRunner().invoke(app, list(words))
    if isinstance(done.exception, InputError):
        raise done.exception
    assert done.exit_code == code, done.output
    return done.output


def test_every_file_stands_in_the_crate_with_its_digest(crate):
    graph = json.loads((crate / CRATE).read_text())["@graph"]
    by_id = {entry["@id"]: entry for entry in graph}
    listed = {part["@id"] for part in by_id["./"]["hasPart"]}
    assert {"study.nc", "design.nc", "inputs/study.yaml", "inputs/cases.csv", "inputs/materials.yaml"} <= listed
    for name in listed:
        assert by_id[name]["sha256"] == hashlib.sha256((crate / name).read_bytes()).hexdigest()
        assert by_id[name]["contentSize"] == (crate / name).stat().st_size
    assert by_id["./"]["license"]["@id"].endswith("MIT") and by_id["#numpy"]["softwareVersion"]
    references = {value["@id"] for entry in graph for value in _flat(entry.values()) if set(value) == {"@id"}}
    assert {name for name in references if not name.startswith("http")} <= set(by_id)


def _flat(values):
    for value in values:
        if isinstance(value, dict):
            yield value
        elif isinstance(value, list):
            yield from _flat(value)


def test_damage_is_named(crate, tmp_path):
    copy = Path(shutil.copytree(crate, tmp_path / "copy"))
    assert damaged_files(copy) == {}
    assert "files are as they were written" in _run(tmp_path, "verify", "copy")
    with (copy / "study.nc").open("r+b") as stream:
        stream.seek(2000)
        stream.write(b"\x55")
    (copy / "design.nc").unlink()
    assert damaged_files(copy) == {"study.nc": "changed", "design.nc": "missing"}
    assert "changed: study.nc" in _run(tmp_path, "verify", "copy", code=1)


@pytest.mark.slow
def test_a_study_is_solved_again_from_its_crate_alone(crate, tmp_path):
    shutil.copytree(crate, tmp_path / "posted", ignore=shutil.ignore_patterns("store", "plan", "chunks"))
    assert "have the same values" in _run(tmp_path, "rerun", "posted")
    again = xr.load_dataset(tmp_path / "rerun" / "crated" / "study.nc")
    before = xr.load_dataset(crate / "study.nc")
    xr.testing.assert_equal(again, before)
    assert float(before["roller_life_hours"].max()) > 0


def test_a_changed_value_is_found(crate, tmp_path):
    ds = xr.load_dataset(crate / "study.nc")
    ds["normal_force"] = ds["normal_force"] * (1 + 1e-3)
    ds.to_netcdf(tmp_path / "other.nc")
    compared = compare_results(crate / "study.nc", tmp_path / "other.nc")
    assert {name for name, difference in compared.items() if difference.exceeds_rounding} == {"normal_force"}
    found = compared["normal_force"]
    assert found.allowed < found.apart < 1e-3, "of the load, which is larger"


def test_a_damaged_input_is_not_solved(crate, tmp_path):
    copy = Path(shutil.copytree(crate, tmp_path / "copy"))
    (copy / "inputs" / "materials.yaml").write_text(MATERIALS.replace("1500", "1600"))
    with pytest.raises(InputError, match=r"inputs/materials\.yaml"):
        _run(tmp_path, "rerun", "copy")


@pytest.mark.parametrize("name", ["../outside.nc", "/etc/passwd"])
def test_a_crate_cannot_name_files_outside_itself(tmp_path, name):
    entry = {"@id": name, "@type": "File", "sha256": "0"}
    (tmp_path / CRATE).write_text(json.dumps({"@graph": [entry]}))
    with pytest.raises(InputError, match="inside the crate"):
        read_crate(tmp_path)


def test_a_folder_without_a_crate_is_refused(tmp_path):
    with pytest.raises(InputError, match=CRATE):
        damaged_files(tmp_path)


def test_a_plan_whose_inputs_are_a_list_is_refused(crate, tmp_path):
    copy = Path(shutil.copytree(crate, tmp_path / "copy"))
    record = json.loads((copy / MARK).read_text())
    record["inputs"] = list(record["inputs"])
    del record["digest"]
    (copy / MARK).write_text(signed(record))
    with pytest.raises(InputError, match=r"plan\.json is damaged"):
        study_of_folder(StudyFolder(copy))


def test_verify_takes_a_name_in_a_folder_of_results(crate, tmp_path):
    shutil.copytree(crate, tmp_path / "kept" / "small")
    assert "files are as they were written" in trackroller("verify", "small", "--results", "kept", cwd=tmp_path).stdout
    assert "small" in trackroller("verify", "small", cwd=tmp_path, code=2).stderr  # not in results/


@pytest.mark.parametrize("name", ["missing.tgz", "missing", "results/missing"])
def test_a_path_that_does_not_exist_is_named(name, tmp_path):
    for command in ("verify", "rerun"):
        said = trackroller(command, name, cwd=tmp_path, code=2).stderr
        assert f"folder = '{name}' exists neither here nor in results" in said


@pytest.mark.parametrize(("kind", "ending", "tool"), [("gztar", "tar.gz", "tar xf"), ("zip", "zip", "unzip")])
def test_an_archive_is_to_be_unpacked_first(crate, tmp_path, kind, ending, tool):
    """What the message says is done, and the folder is verified."""
    shutil.copytree(crate, tmp_path / "results" / "small")
    name = Path(shutil.make_archive(str(tmp_path / "sent"), kind, tmp_path, "results")).name
    shutil.rmtree(tmp_path / "results")
    for command in ("verify", "rerun"):
        said = trackroller(command, name, cwd=tmp_path, code=2).stderr
        assert f"folder = '{name}' is an archive" in said and f"Unpack it ({tool} sent.{ending})" in said
    shutil.unpack_archive(tmp_path / name, tmp_path)
    assert "files are as they were written" in trackroller("verify", "results/small", cwd=tmp_path).stdout
