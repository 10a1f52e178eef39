"""Count the cases of a study: solved, missing, failed by reason and by factor level, and estimate
the time left.
"""

from __future__ import annotations

import contextlib
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.filesize import decimal

from trackroller.errors import InputError, nearest
from trackroller.parameters import REGIMES
from trackroller.study.cost import START, bytes_a_case, duration, seconds_of_report, study_rate
from trackroller.study.design.growth import as_planned
from trackroller.study.design.levels import in_words
from trackroller.study.file.load import load_study
from trackroller.study.store.chunks import FAILED, CorruptFile, read
from trackroller.study.store.fingerprint import StudyCases
from trackroller.study.store.folder import StudyFolder, check_folder
from trackroller.study.store.input_files import study_of_folder
from trackroller.study.store.ledger import Ledger, chunk_size, study_folder, unused_cases
from trackroller.study.store.manifest import why_altered

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

# s on two cores; a shorter study waits longer for the workers of a cluster than it gains by them
SHORT = 600.0


@dataclass
class Status:
    """State of a study.

    Attributes
    ----------
    total, done, failed : int
        Cases of the design, solved cases, and solved cases that failed.
    regimes : dict
        Number of solved cases by regime.
    by_reason : dict
        Number of failed cases by reason.
    by_level : dict
        Number of failed cases by factor and level.
    speed : float
        Cases a second of one processor, measured or estimated.
    measured : bool
        Whether `speed` was measured on solved cases of this study.
    gathered, outdated : bool
        Whether `study.nc` exists, and whether another version of the solver made the files.
    unused : str
        How many solved cases of an earlier design this design does not hold, and why; '' if it
        holds all.
    upcoming : str
        Number and levels of the first chunk that is not solved; '' without one.
    corrupt : list of str
        Damaged or altered files, and what is wrong with each.
    """

    total: int
    done: int
    failed: int
    regimes: dict[str, int]
    by_reason: dict[str, int]
    speed: float
    measured: bool
    gathered: bool
    outdated: bool
    unused: str = ""
    upcoming: str = ""
    by_level: dict[tuple[str, str], int] = field(default_factory=dict)
    corrupt: list[str] = field(default_factory=list)

    @property
    def missing(self) -> int:
        """Return the cases that are not solved."""
        return self.total - self.done

    @property
    def seconds_left(self) -> float:
        """Return the expected time to solve the missing cases on one processor [s]."""
        return self.missing / self.speed


def find_study(study: str, results: Path | str = "results") -> tuple[Study, StudyFolder]:
    """Find a study by the path of its file, by its results folder, or by the name of this folder.

    Returns
    -------
    tuple of Study and StudyFolder
        The study and its folder: the folder that was found, whatever the name of the study in it
        is; for a study file the folder in which `trackroller run` keeps its results.

    Raises
    ------
    InputError
        If there is no such study; the message names the known ones.
    """
    path = Path(study)
    if path.is_file() or (path.suffix in (".yaml", ".yml") and not path.is_dir()):
        checked = load_study(path)
        return checked, study_folder(checked.name, results)
    folder = find_folder(study, results)
    if folder is None:
        known = sorted(p.parent.name for p in Path(results).glob("*/plan.json"))
        close = nearest(study, known)
        allowed = f"a study file, or a study in {results}/: {', '.join(known) or 'none yet'}"
        remedy = ""
        if close:
            remedy = f"Did you mean '{close}'?"
        raise InputError("study", study, allowed, remedy, "is not there")
    return study_of_folder(folder), folder


def find_folder(study: str, results: Path | str = "results") -> StudyFolder | None:
    """Return the folder of a study by its path or by its name in the results folder, None if there
    is none.
    """
    folders = [StudyFolder(root) for root in (Path(study), Path(results) / study)]
    return next((f for f in folders if f.plan_file.is_file() or f.study_file.is_file()), None)


def status_of(study: Study, folder: StudyFolder) -> Status:
    """Determine the state of a study from its files; nothing is written.

    Parameters
    ----------
    study : Study
        The checked study.
    folder : StudyFolder
        Its folder.

    Returns
    -------
    Status
        Numbers of cases and the expected time. The time is proportional to the number of cases.

    Raises
    ------
    InputError
        If the folder is somebody else's, or holds a link.
    """
    check_folder(folder.root)
    study = as_planned(study, folder.record())
    ledger = Ledger(StudyCases(study), folder)
    solved = np.flatnonzero(ledger.state_number >= 0)
    states = ledger.states.isel(case=ledger.state_number[solved])
    bad = states["regime"].values == FAILED
    failed = solved[bad]
    seconds = ledger.states.attrs["seconds"]
    if seconds > 0:
        speed = ledger.states.sizes["case"] / seconds
    else:
        speed = study_rate(study)
    status = Status(
        total=len(ledger.state_number),
        done=len(solved),
        failed=len(failed),
        regimes={name: int((states["regime"] == code).sum()) for code, name in enumerate(REGIMES)},
        by_reason=dict(Counter(states["reason"].values[bad].tolist()).most_common()),
        speed=speed,
        measured=seconds > 0,
        gathered=folder.gathered.is_file(),
        outdated=folder.of_another_solver,
        unused=unused_cases(ledger),
        upcoming=_upcoming(folder),
        corrupt=[
            *ledger.corrupt.values(),
            *(f"{path}: it is gone" for path in folder.lost_files()),
            *filter(None, map(why_altered, (folder.design, folder.gathered))),
        ],
    )
    for name, factor in study.drawn.factors.items():
        if factor.discrete:
            counts = Counter(
                _level(name, study.drawn.columns[name][i]) for i in ledger.cases.rows[failed]
            )
            status.by_level |= {(name, level): count for level, count in counts.most_common()}
    return status


def plan_rows(study: Study, status: Status) -> list[tuple[str, str]]:
    """Return what a run of a study takes, as names and texts: cases, chunks, time, report and disk
    space.

    Parameters
    ----------
    study : Study
        The checked study.
    status : Status
        Its state, see `status_of`.
    """
    chunk = chunk_size(study, status.missing)
    parts = -(-status.missing // chunk)
    if chunk == 1:
        size = "1 case"
    else:
        size = f"up to {chunk} cases"
    seconds = status.seconds_left + START
    source = "measured" if status.measured else "estimated"
    times = f"{duration(seconds)} on one core, {duration(seconds / 2)} on two"
    pages = seconds_of_report(study.config.method_name, status.total)
    grows = study.config.until is not None or study.config.method.proposes
    small = bool(parts) and not grows and seconds / 2 < SHORT
    rows = [
        ("study", f"{study.name} ({study.config.method_name})"),
        ("cases", f"{status.total}, {status.done} of them solved already"),
        *_growth_rows(study),
    ]
    if status.unused:
        rows.append(("unused", status.unused))
    if parts:
        rows.append(("chunks", f"{parts} of {size}; each is saved once it is solved"))
    rows.append(("time", f"{times} ({source} cases/s: {status.speed:.3g})"))
    if small:
        rows.append(("cluster", f"not needed: {duration(seconds / 2)} on two cores"))
    rows.append(("report", f"{duration(pages)} more on one core, for analysis, figures and page"))
    rows.append(("disk", f"about {decimal(status.total * bytes_a_case(study.config.outputs))}"))
    return rows


def _growth_rows(study: Study) -> list[tuple[str, str]]:
    """Return how far a study grows whose results decide which cases follow."""
    rows = []
    until = study.config.until
    where = ""
    if study.config.method.points:
        where = " at unsure design points"
    if until:
        text = (
            f"the sample doubles{where} until its intervals are narrow, up to {until.at_most} cases"
        )
        rows.append(("until", text))
    if study.config.method.proposes:
        designs = f"{study.config.budget.designs} designs"
        if study.config.budget.designs == 1:
            designs = "1 design"
        rows.append(
            (
                "search",
                f"these are the first generation; it goes on to {designs}, and checks the best",
            )
        )
    return rows


def _upcoming(folder: StudyFolder) -> str:
    """Return the words for the first chunk of the plan that is not solved; '' if there is none."""
    for name in folder.record().get("chunks", {}):
        if not folder.chunk(name).is_file():
            # the next run plans its cases anew
            with contextlib.suppress(CorruptFile, FileNotFoundError):
                return str(read(folder.case_list(name)).attrs.get("words", ""))
    return ""


def _level(name: str, level: Any) -> str:
    """Return a level with all its digits, so that neighbouring levels remain distinct."""
    if isinstance(level, float):
        return f"{level:.10g}"
    return in_words(name, level)
