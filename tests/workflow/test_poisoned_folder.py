"""The jobs of a workflow and the workers of dask run no Python file of the working folder."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from workflow_place import lay_study, snakemake_process


@pytest.fixture
def place(tmp_path):
    """Return a folder with a study, and with Python files under the names of modules that the program imports."""
    folder = tmp_path / "place"
    folder.mkdir()
    text = f"import pathlib\npathlib.Path({str(tmp_path / 'executed')!r}).touch()\nraise ImportError('executed')\n"
    for name in ("portalocker", "numpy", "trackroller", "xarray", "dask", "selectors", "decimal", "pulp", "yaml"):
        (folder / f"{name}.py").write_text(text)
    yield lay_study(folder)
    assert not (tmp_path / "executed").exists()


@pytest.mark.long
def test_jobs_of_the_workflow(place):
    snakemake_process(place)
    assert (place / "results" / "tiny" / "report.html").is_file()


@pytest.mark.long
def test_workers_of_dask(place):
    pytest.importorskip("distributed")
    words = [sys.executable, "-P", "-m", "trackroller.cli", "run", "tiny.yaml", "-q", "--scheduler", "local"]
    bare = {name: text for name, text in os.environ.items() if name != "PYTHONSAFEPATH"}
    done = subprocess.run(words, cwd=place, env=bare, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert (place / "results" / "tiny" / "study.nc").is_file()
