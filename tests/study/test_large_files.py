"""A small netCDF file that declares thousands of millions of values is refused in one line, and takes no memory."""

from __future__ import annotations

import hashlib
import json
import resource
import subprocess
import sys
from pathlib import Path

import fake_solver
import netCDF4
import numpy as np
import pytest
import xarray as xr
from command_line import trackroller

import trackroller as tr
from trackroller.errors import InputError
from trackroller.study.file.load import load_study
from trackroller.study.run import run_study
from trackroller.study.store import chunks, netcdf
from trackroller.study.store.gather import write_design
from trackroller.study.store.ledger import working_ledger
from trackroller.study.store.netcdf import MOST_VARIABLES

MANY = 4_000_000_000
KINDS = {
    "contiguous": {"contiguous": True},
    "packed": {"zlib": True},
    "bytes": {"datatype": "i1"},
    "texts": {"datatype": str},
}


def write_bomb(path, kind="packed", dimensions=("case",), variable="peak_stress", size=MANY):
    """Write a netCDF file of some kB that declares many values."""
    with netCDF4.Dataset(path, "w") as file:
        for name in dimensions:
            file.createDimension(name, round(size ** (1 / len(dimensions))))
        settings = {"datatype": "f8", **KINDS[kind]}
        file.createVariable(variable, settings.pop("datatype"), dimensions, **settings)
        file.study = "name: bomb\nfactors: {axial_force: {values: [1, 2]}}\n"
        file.title, file.source = "a result", "trackroller 0.1.0"
    assert path.stat().st_size < 100_000
    return path


@pytest.fixture(autouse=True)
def little_memory():
    """Let an attempt to read the values fail at once."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (12_000_000_000, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)


@pytest.mark.parametrize("kind", KINDS)
def test_every_reader_refuses_it(tmp_path, kind):
    path = write_bomb(tmp_path / "study.nc", kind)
    write_bomb(tmp_path / "sensitivity.nc", kind)
    for read in (netcdf.read_result, tr.open_study, lambda path: tr.open_study(path.parent)):
        with pytest.raises(InputError, match="4,000,000,000 values") as caught:
            read(path)
        assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("dimensions", [("case",), ("y", "x"), ("a", "b", "c", "d")])
def test_a_coordinate_or_a_field_of_many_values_is_refused(tmp_path, dimensions):
    path = write_bomb(tmp_path / "study.nc", dimensions=dimensions, variable=dimensions[0])
    with pytest.raises(InputError, match="declares"):
        netcdf.read_result(path)


def test_many_variables_and_nested_texts_are_refused(tmp_path):
    with netCDF4.Dataset(tmp_path / "many.nc", "w") as file:
        for i in range(MOST_VARIABLES + 1):
            file.createVariable(f"v{i}", "f4", ())
    with netCDF4.Dataset(tmp_path / "deep.nc", "w") as file:
        file.not_given = "[" * 100_000 + "]" * 100_000
    for name, words in (("many", "declares 5,001 variables"), ("deep", "maximum recursion depth")):
        with pytest.raises(InputError, match=words):
            netcdf.read_result(tmp_path / f"{name}.nc")


def test_a_list_of_cases_and_a_chunk_are_called_corrupt(tmp_path):
    path = write_bomb(tmp_path / "0123456789abcdef.nc", variable="case")
    content = path.read_bytes()
    path.write_bytes(content + hashlib.sha256(content).digest())
    for read in (chunks.check, chunks.read, chunks.read_state):
        with pytest.raises(chunks.CorruptFile, match="4,000,000,000 values"):
            read(path)


def test_commands_refuse_it_in_one_line(tmp_path):
    bomb = write_bomb(tmp_path / "bomb.nc")
    for words in (("explore", bomb), ("wear", "--to", "1km", "-o", bomb, "-q")):
        line = trackroller(*words, cwd=tmp_path, code=2).stderr
        assert "4,000,000,000 values" in line and len(line.splitlines()) <= 2 and "Traceback" not in line


def test_a_large_file_that_holds_its_values_is_read(tmp_path, monkeypatch):
    """Noise packs 1.1 times, whole numbers 1000 times: both are read where the file holds them."""
    monkeypatch.setattr(netcdf, "ANY_BYTES", 100_000)
    rows = np.random.default_rng(1).random(1_000_000)
    ds = xr.Dataset({"stress": ("case", rows), "flag": ("case", np.zeros(rows.size, np.int8))})
    ds.to_netcdf(tmp_path / "ds.nc", encoding={name: {"zlib": True} for name in ds})
    assert netcdf.read_result(tmp_path / "ds.nc").equals(ds)
    monkeypatch.setattr(netcdf, "memory", lambda: 1e6)
    with pytest.raises(InputError, match="fits the memory"):
        netcdf.read_result(tmp_path / "ds.nc")


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the peak of memory is read as Linux tells it")
def test_many_variables_take_little_more_memory_than_their_values(tmp_path):
    """The library keeps up to 64 MB of each open variable; without a small cache this file takes twice its values."""
    size, count = 500_000, 40
    random = np.random.default_rng(1).random(size)
    values = xr.Dataset({f"v{i}": ("case", random + i) for i in range(count)})
    packed = {str(name): {"zlib": True, "complevel": 1} for name in values}
    values.to_netcdf(tmp_path / "many.nc", encoding=packed)
    program = """if True:
        import re, sys
        from pathlib import Path
        from trackroller.study.store.netcdf import read_netcdf
        def peak():
            return int(re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1])
        before = peak()
        read_netcdf(Path(sys.argv[1]), "file", "")
        print(peak() - before)
        """
    command = [sys.executable, "-c", program, str(tmp_path / "many.nc")]
    kilobytes = int(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    assert 0.9 < kilobytes * 1024 / (8 * size * count) < 1.5


def test_the_cache_of_the_library_is_as_before_after_a_file(tmp_path):
    before = netCDF4.get_chunk_cache()
    with pytest.raises(RuntimeError), netcdf.small_cache():
        assert netCDF4.get_chunk_cache()[0] == netcdf.CACHE_BYTES < before[0]
        raise RuntimeError
    assert netCDF4.get_chunk_cache() == before


def test_a_design_is_packed_and_read_as_it_was(tmp_path):
    """The mapping of a bearing and the pair of materials stand in each of 4,000 cases."""
    bearing = {
        "rows": 2,
        "row_distance": 8,
        "dynamic_rating": 4500,
        "static_rating": 2000,
        "e": 0.3,
        "X": 0.56,
        "Y": 1.5,
    }
    bearing |= {"X0": 0.6, "Y0": 0.5, "kind": "ball"}
    study = {
        "name": "many",
        "base": {"bearing": bearing},
        "factors": {
            "friction_coefficient": {"linspace": [0.05, 0.4, 1000]},
            "material_pair": {"values": [["PA6", "1.7225-normalised"], ["POM", "PA6"]]},
            "axial_force": {"values": [0, 10]},
        },
        "outputs": ["forces", "contact", "life", "limits"],
    }
    with working_ledger(load_study(study), tmp_path) as ledger:
        write_design(ledger)
        path = ledger.folder.design
        assert path.stat().st_size < 30 * 4000
        again = xr.load_dataset(path)
        xr.testing.assert_equal(again, ledger.cases.design)
        assert json.loads(str(again.bearing.values[-1]))["dynamic_rating"] == 4500


def test_a_study_with_a_bomb_among_its_chunks_solves_the_chunk_again(tmp_path):
    study = load_study({"name": "two", "factors": {"axial_force": {"values": [0, 30]}}, "contact_model": "sliding"})
    folder = run_study(study, tmp_path, solver=fake_solver.solve).folder
    chunk = folder.solved_files()[0]
    content = write_bomb(tmp_path / "bomb.nc", variable="case").read_bytes()
    chunk.write_bytes(content + hashlib.sha256(content).digest())
    with pytest.raises(InputError, match=f"{chunk.name}.*altered.*Move or remove it"):
        run_study(study, tmp_path, solver=fake_solver.solve)
    chunk.unlink()
    run_study(study, tmp_path, solver=fake_solver.solve)
    assert tr.open_study(folder.root).data.sizes["axial_force"] == 2
