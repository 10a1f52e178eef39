"""Count the cases of a study: solved, missing, failed by reason and by factor level, and estimate
the time left.
"""

from __future__ import annotations

import contextlib
import math
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.filesize import decimal

from trackroller.contact.friction_laws import law_of
from trackroller.errors import InputError, nearest
from trackroller.numerics.numbers import rounded_up
from trackroller.numerics.threads import thread_count
from trackroller.parameters import OPTIONS, REGIMES
from trackroller.parameters.accuracy import tolerance_of
from trackroller.parameters.contact_models import EXACTNESS, LEVELS, measured_costs
from trackroller.roller.measured_errors import ORDINARY_FRICTION, errors_of_rung
from trackroller.study.cost import (
    START,
    bytes_a_case,
    duration,
    seconds_of_report,
    seconds_on,
    study_rate,
)
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
    import xarray as xr

    from trackroller.study.file.study import Study

# s here; a shorter study waits longer for the workers of a cluster than it gains by them
SHORT = 600.0
# quantities whose errors a plan states beside the time of a rung
SHOWN = {"normal_force": "F_N", "peak_stress": "peak stress", "life": "life"}
LEAST_ERROR = 1e-6  # smaller errors are shown as this one


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
    uncalibrated : dict
        Number of cases for whose surfaces no errors were measured, by what the surfaces have.
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
    uncalibrated: dict[str, int] = field(default_factory=dict)

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
        uncalibrated=_uncalibrated(ledger.cases.design),
    )
    for name, factor in study.drawn.factors.items():
        if factor.discrete:
            counts = Counter(
                _level(name, study.drawn.columns[name][i]) for i in ledger.cases.rows[failed]
            )
            status.by_level |= {(name, level): count for level, count in counts.most_common()}
    return status


def _uncalibrated(cases: xr.Dataset) -> dict[str, int]:
    """Return how many cases have surfaces for which no errors were measured, by what these have."""
    high = cases["friction_coefficient"].values > ORDINARY_FRICTION
    film = cases["layer_flexibility"].values > 0.0
    counts = {
        f"friction above {ORDINARY_FRICTION:g}": int(np.sum(high)),
        "a film (layer_flexibility)": int(np.sum(film)),
    }
    return {what: count for what, count in counts.items() if count}


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
    threads = thread_count()
    source = "measured" if status.measured else "estimated"
    pages = seconds_of_report(study.config.method_name, status.total)
    grows = study.config.until is not None or study.config.method.proposes
    small = bool(parts) and not grows and seconds_on(threads, seconds) < SHORT
    rows = [
        ("study", f"{study.name} ({study.config.method_name})"),
        ("cases", f"{status.total}, {status.done} of them solved already"),
        *_growth_rows(study),
    ]
    if status.unused:
        rows.append(("unused", status.unused))
    if parts:
        rows.append(("chunks", f"{parts} of {size}; each is saved once it is solved"))
    rows.append(("time", f"{_times(seconds, threads)} ({source} cases/s: {status.speed:.3g})"))
    rows += _accuracy_rows(study, status)
    if small:
        rows.append(("cluster", f"not needed: {duration(seconds_on(threads, seconds))} here"))
    rows.append(("report", f"{duration(pages)} more on one core, for analysis, figures and page"))
    rows.append(("disk", f"about {decimal(status.total * bytes_a_case(study.config.outputs))}"))
    return rows


def _times(seconds: float, threads: int) -> str:
    """Return in words what takes so many seconds of one core: there, and with all threads of `run`
    and of the workflow.
    """
    if threads == 1:
        return f"{duration(seconds)} on one core"
    alone = f"{duration(seconds_on(threads, seconds))} by trackroller run with {threads} threads"
    together = f"{duration(seconds / threads)} by snakemake --cores {threads}"
    return f"{duration(seconds)} on one core, {alone}, {together}"


def _accuracy_rows(study: Study, status: Status) -> list[tuple[str, str]]:
    """Return time and measured error of each rung of accuracy, and what a tolerance flags.

    The times are in the ratio of the estimates where the speed was measured.
    """
    chosen = study.options.get("accuracy", OPTIONS["accuracy"].default)
    per_estimate = status.speed / study_rate(study)
    rows = []
    model = _model_with_known_errors(study)
    for rung in LEVELS:
        seconds = status.missing / (per_estimate * study_rate(study, rung)) + START
        parts = [f"{rung}: {duration(seconds)} on one core"]
        if rung == chosen:
            parts[0] += ", this study"
        errors = errors_of_rung(model, rung)
        parts += [
            f"{word} {_percent(errors[name].p95)}" for name, word in SHOWN.items() if name in errors
        ]
        rows.append(("accuracy", ", ".join(parts)))
    rows += [("errors", text) for text in _error_texts(study, status, model)]
    if chosen not in LEVELS:
        rows.append(("tolerance", _tolerance_text(study)))
    return rows


def _error_texts(study: Study, status: Status, model: str) -> list[str]:
    """Return what the errors of rungs are, and for which cases they were not measured."""
    if not model:
        return [f"not measured {_why_not_measured(study)}"]
    text = "numerical, which 95 % of random designs keep"
    if model != EXACTNESS[0]:
        text = f"{text}; the error of {model} as a model comes on top"
    alike = f"of friction up to {ORDINARY_FRICTION:g} without a film"
    return [
        text,
        *(
            f"not measured for {count} of {status.total} cases with {what}: those above are {alike}"
            for what, count in status.uncalibrated.items()
        ),
    ]


def _model_with_known_errors(study: Study) -> str:
    """Return the contact model of a study whose errors on each rung were measured; '' for others,
    see `_why_not_measured`.
    """
    if _why_not_measured(study):
        return ""
    return str(study.options.get("contact_model", OPTIONS["contact_model"].default))


def _why_not_measured(study: Study) -> str:
    """Return why the errors of a rung were not measured for a study; '' if they were."""
    varied = [name for name in ("contact_model", "normal") if name in study.factors]
    if varied:
        return f"for studies that vary {' and '.join(varied)}"
    for name in ("normal", "slip_terms"):
        value = study.options.get(name, OPTIONS[name].default)
        if value != OPTIONS[name].default:
            return f"with {name}: {', '.join(np.atleast_1d(value))}"
    if not all(law_of(law).is_constant for law in study.friction_laws):
        return "with friction that falls with the slip speed"
    return ""


def _percent(share: float) -> str:
    return f"{100.0 * rounded_up(max(share, LEAST_ERROR)):.2g} %"


def _tolerance_text(study: Study) -> str:
    """Return what a tolerance costs over `standard`, and which designs miss it."""
    tolerance = tolerance_of(study.options["accuracy"], study.options.get("outputs", ()))
    strictest = min(tolerance.by_quantity.values()) if tolerance is not None else math.inf
    missed = {float(name): share for name, share in measured_costs()["missed"].items()}
    at = min(missed, key=lambda known: abs(math.log(known / strictest)))
    times = study_rate(study, "standard") / study_rate(study)
    return (
        f"takes {times:.2g} times standard; at {at:g}, {missed[at]:.0%} of designs with friction "
        f"to 1 and contact angles of 15 to 70 degrees miss it on every rung and are flagged"
    )


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
