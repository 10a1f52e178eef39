"""The command line of `validation.same_numbers`."""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import trackroller as tr
from validation.same_numbers.archive import Archive, load, save
from validation.same_numbers.cases import record_cases
from validation.same_numbers.compare import compare
from validation.same_numbers.show import report
from validation.same_numbers.signatures import record_signatures
from validation.same_numbers.studies import record_studies

PARTS = {"cases": record_cases, "studies": record_studies, "signatures": record_signatures}


def record(path: Path, parts: tuple[str, ...]) -> None:
    """Record the version of `trackroller` that Python imports here.

    Parameters
    ----------
    path : Path
        The file to write, `.npz`.
    parts : tuple of str
        Names from `PARTS`.
    """
    print(f"trackroller from {tr.__file__}")
    archive: Archive = {}
    for part in parts:
        began, cpu = time.perf_counter(), time.process_time()
        archive |= PARTS[part]()
        print(f"{part}: {time.perf_counter() - began:.0f} s, {time.process_time() - cpu:.0f} s of CPU in this process")
    save(path, archive)
    print(f"{path}: {len(archive)} arrays, {path.stat().st_size / 1e6:.1f} MB")


def main(arguments: list[str] | None = None) -> int:
    """Run the program.

    Parameters
    ----------
    arguments : list of str, optional
        Command-line arguments; those of the process if not given.

    Returns
    -------
    int
        0 if the work is done and recordings agree, 1 if they differ, 2 if the input is wrong.
    """
    parser = argparse.ArgumentParser(prog="python -m validation.same_numbers", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    recorder = commands.add_parser("record", help="record what the imported trackroller computes")
    recorder.add_argument("file", type=Path, metavar="FILE.npz")
    recorder.add_argument("--part", choices=tuple(PARTS), help="record this part only")
    comparer = commands.add_parser("compare", help="compare two recordings; exit 1 if they differ")
    comparer.add_argument("before", type=Path, metavar="BEFORE.npz")
    comparer.add_argument("after", type=Path, metavar="AFTER.npz")
    comparer.add_argument("--tolerance", type=float, default=0.0, help="allowed relative difference (default 0)")
    given = parser.parse_args(arguments)
    if given.command == "record":
        record(given.file, (given.part,) if given.part else tuple(PARTS))
        return 0
    if not given.tolerance >= 0:
        parser.error(f"--tolerance {given.tolerance} is not allowed: give a number >= 0, for example 1e-12")
    for path in (given.before, given.after):
        if not path.is_file():
            parser.error(f"{path} does not exist: write it with `record {path}`")
    verdicts = compare(load(given.before), load(given.after), given.tolerance)
    print(report(verdicts, given.tolerance))
    return 0 if all(verdict.passed for verdict in verdicts) else 1


if __name__ == "__main__":
    sys.exit(main())
