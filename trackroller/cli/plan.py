"""Print the cost and the stages of a study or of a case before anything is solved."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from rich.filesize import decimal

from trackroller.cli.case import case_of, is_study
from trackroller.report.terminal import print_table
from trackroller.roller.case import to_table
from trackroller.roller.options import Options
from trackroller.study.config import load_study
from trackroller.study.cost import bytes_a_case, duration
from trackroller.study.design.entries import OPTION_FACTORS
from trackroller.study.explain import explain as stages_of
from trackroller.study.plan import case_options, chunk_size
from trackroller.study.status import status_of

MOST = 20_000  # --explain examines at most this many cases of a study


def print_plan(path: Path | None, results: Path, explain: bool, words: list[str], no_shortcuts: bool) -> None:
    """Print the plan of a study file, or the stages of a case file or of the paper's example with key=value words."""
    if path is None or not is_study(path):
        _print_case(path, words, no_shortcuts)
        return
    _print_study(path, results)
    if explain:
        print()
        _explain_study(path, no_shortcuts)


def _print_study(path: Path, results: Path) -> None:
    """Print the number of cases and chunks, the expected time and the disk space."""
    study = load_study(path)
    status = status_of(study, results)
    chunk = chunk_size(study, status.missing)
    chunks = -(-status.missing // chunk)
    seconds = status.seconds_left
    told = "measured" if status.measured else "estimated"
    print(f"study     {study.name} ({study.config.design})")
    print(f"cases     {status.total}, {status.done} of them solved already")
    print(f"chunks    {chunks} of up to {chunk} cases")
    times = f"{duration(seconds)} on one core, {duration(seconds / 2)} on two"
    print(f"time      {times} ({told} cases/s: {status.speed:.3g})")
    print(f"disk      about {decimal(status.total * bytes_a_case(study.config.outputs))}")


def _print_case(path: Path | None, words: list[str], no_shortcuts: bool) -> None:
    case, told = case_of(path, words)
    if no_shortcuts:
        told["shortcuts"] = False
    _print_stages(to_table(case), Options(**told))


def _explain_study(path: Path, no_shortcuts: bool) -> None:
    study = load_study(path)
    design = study.design()
    table = to_table(design.drop_vars(list(design.coords)), study.materials)
    options, group = case_options(study, design)
    if len(table) > MOST:
        print(f"stages of the first {MOST} of {len(table)} cases")
        table, group = table.take(np.arange(MOST)), group[:MOST]
    for number in np.unique(group):
        rows = np.flatnonzero(group == number)
        told = dict(options[number])
        if no_shortcuts:
            told["shortcuts"] = False
        if len(options) > 1:
            varied = [name for name in OPTION_FACTORS if name in study.factors]
            print(", ".join(f"{name.replace('_', ' ')} {told[name]}" for name in varied) + ":")
        _print_stages(table.take(rows), Options(**told))


def _print_stages(table, options) -> None:
    rows = [
        (stage.name, f"{stage.count}" if stage.runs else "-", f"{stage.total} {stage.unit}", stage.why)
        for stage in stages_of(table, options)
    ]
    print_table(("stage", "runs", "of", "why"), rows, 140, right=(1, 2))
