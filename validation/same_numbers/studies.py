"""Run the recorded studies through the workflow and keep designs, results and sensitivity indices."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import xarray as xr

import trackroller as tr
from validation.same_numbers.archive import Archive, from_dataset
from validation.same_numbers.signatures import ROOT, environment
from validation.same_numbers.study_files import Study, drawn_designs, small_studies, write_study


def record_studies() -> Archive:
    """Draw all designs, then solve and analyse the small study of every design.

    Returns
    -------
    Archive
        Keys `designs/NAME/...`, `studies/NAME/...` (`study.nc`) and `indices/NAME/...` (`sensitivity.nc`).
    """
    archive: Archive = {}
    with tempfile.TemporaryDirectory(prefix="same_numbers_") as place:
        folder = Path(place)
        (folder / "config").symlink_to(ROOT / "config")  # the Snakefile names its configuration by this path
        for study in drawn_designs(folder):
            archive |= record_design(study, folder)
        for study in small_studies(folder):
            archive |= record_design(study, folder) | run_study(study, folder)
    return archive


def record_design(study: Study, folder: Path) -> Archive:
    """Draw the design of a study.

    Parameters
    ----------
    study : dict
        The study as a mapping.
    folder : Path
        Folder for the study file.

    Returns
    -------
    Archive
        One array a column.
    """
    where = f"designs/{study['name']}"
    try:
        return from_dataset(tr.load_study(write_study(study, folder)).design(), where)
    except tr.InputError as error:
        print(f"{where}: refused: {error}")
        return {}


def run_study(study: Study, folder: Path) -> Archive:
    """Run the workflow for one study up to its sensitivity indices.

    Parameters
    ----------
    study : dict
        The study as a mapping.
    folder : Path
        Working folder of the workflow; the checkout stays untouched.

    Returns
    -------
    Archive
        Variables of `study.nc` and of `sensitivity.nc`.

    Raises
    ------
    RuntimeError
        If the workflow fails; the message holds the end of its output.
    """
    name, results = study["name"], folder / "results"
    path = write_study(study, folder)
    snakefile = ["-s", str(ROOT / "Snakefile"), "--directory", str(folder), "--workflow-profile", "none"]
    config = ["--cores", "1", "--config", f"study={path}", f"results={results}"]
    call = [sys.executable, "-m", "snakemake", *snakefile, *config, "--", f"{results}/{name}/sensitivity.nc"]
    done = subprocess.run(call, env=environment(), cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"the workflow failed for study {name}:\n{done.stdout[-2000:]}{done.stderr[-4000:]}")
    archive: Archive = {}
    for file, subject in (("study.nc", "studies"), ("sensitivity.nc", "indices")):
        with xr.open_dataset(results / name / file, decode_times=False) as ds:
            archive |= from_dataset(ds.load(), f"{subject}/{name}")
    return archive
