"""Commands about the RO-Crate of a study: check its files, solve it again."""

from __future__ import annotations

from pathlib import Path

from trackroller.errors import InputError
from trackroller.study.crate import compare_results, damaged_files, read_crate, study_of_crate
from trackroller.study.run import run_study


def print_verified(folder: Path) -> int:
    """Print the damaged files of a crate and return the exit code: 0 if there is none."""
    damaged = damaged_files(folder)
    for name, what in damaged.items():
        print(f"{what}: {name}")
    if not damaged:
        print(f"{len(read_crate(folder))} files are as they were written")
    return int(bool(damaged))


def print_rerun(crate: Path, results: Path) -> int:
    """Solve the study of a crate again, print the comparison and return the exit code: 0 if every value is the same."""
    stored = crate / "study.nc"
    if stored.name not in read_crate(crate) or not stored.is_file():
        raise InputError("crate", str(crate), "a crate that holds study.nc", "Run the study to its end first.")
    study = study_of_crate(crate)
    if (results / study.name).resolve() == crate.resolve():
        raise InputError("--results", str(results), "another folder than that of the crate", "Choose a new folder.")
    plan = run_study(study, results)
    compared = compare_results(stored, plan.folder.gathered)
    for name, apart in compared.items():
        if apart:
            print(f"{name}: differs by {apart:.1e} (relative)")
    same = not any(compared.values())
    if same:
        print(f"{len(compared)} variables have the same values as {stored}")
    return int(not same)
