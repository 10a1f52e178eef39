"""Functions that the Snakefile and its scripts call."""

from __future__ import annotations

import contextlib
import json
import logging
import re
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, TextIO

from trackroller.cli import tell_stopped
from trackroller.errors import InputError, WorkError, unknown_name
from trackroller.files import check_utf_8, interrupts_wait_for_files
from trackroller.materials.file import find_user_file
from trackroller.study.cost import duration
from trackroller.study.file.load import load_study
from trackroller.study.file.study import Study
from trackroller.study.store.fingerprint import StudyCases
from trackroller.study.store.folder import StudyFolder, Tell, check_for_workflow, unheard
from trackroller.study.store.ledger import Ledger, read_ledger, study_folder, working_ledger
from trackroller.study.store.put import claim

CONFIG_KEYS = ("study", "results")
_held = contextlib.ExitStack()  # keeps the lock of the study until this process ends


def workflow_config(config: Mapping[str, Any], source: Path, *, strict: bool = True) -> dict[str, str]:
    """Return the paths of the study file and of the results folder that a configuration names.

    Parameters
    ----------
    config : mapping
        The configuration that Snakemake read, with the keys `study` and `results`.
    source : pathlib.Path
        Folder of the workflow. A study file that does not exist in the working directory is looked for here.
    strict : bool
        Refuse unknown keys. An importing workflow that gives no `config:` shares its own keys, so they are ignored.

    Returns
    -------
    dict
        The keys `study` and `results`, both text.

    Raises
    ------
    InputError
        For an unknown key, or a value that is no path.
    """
    for key in config if strict else ():
        if key not in CONFIG_KEYS:
            raise unknown_name("--config key", str(key), CONFIG_KEYS)
    study = config.get("study")
    results = config.get("results", "results")
    advice = "Write it in config/config.yaml or give --config study=config/studies/NAME.yaml."
    if not isinstance(study, str):
        raise InputError("study", study, "the path of a study file", advice)
    if not isinstance(results, str) or not results:
        raise InputError("results", results, "the path of a folder", advice.replace("study=", "results=", 1))
    if not Path(study).exists() and (source / study).is_file():
        study = str(source / study)
    for key, path in (("study", study), ("results", results)):
        check_utf_8(path, key)
        _check_braces(key, path)
    return {"study": study, "results": results}


def _check_braces(key: str, path: str) -> None:
    """Refuse a path with braces, which Snakemake reads as a wildcard."""
    if {"{", "}"} & set(path):
        remedy = "Rename the file or folder, or solve the study with `trackroller run`, which takes any path."
        raise InputError(key, path, "a path without braces, as Snakemake reads braces as wildcards", remedy)


def workflow_ledger(config: Mapping[str, str], main: bool, tell: Tell = unheard) -> Ledger:
    """Return the ledger of the workflow's study.

    The main process plans, and keeps other processes from changing the plan until it ends. Its jobs read the plan.

    Parameters
    ----------
    config : mapping
        What `workflow_config` returned.
    main : bool
        True in Snakemake's main process, False in its jobs.
    tell : callable
        Receives one line for each event that the user should read.

    Returns
    -------
    Ledger
        Chunks of the study and the folder of its results.

    Raises
    ------
    InputError
        If the study is wrong, its folder is somebody else's, or a file of somebody else stands where Snakemake would
        delete it.
    WorkError
        If the study was edited after the main process had planned it.
    """
    study = load_study(config["study"], planned=not main)
    results = config["results"]
    folder = study_folder(study.name, results)
    if main:
        check_for_workflow(folder.create().root)
    if study.decides:  # its rule plans each generation
        return Ledger(StudyCases(study), folder)
    if main:
        return _held.enter_context(working_ledger(study, results, tell=tell))
    ledger = read_ledger(study, folder)
    if ledger is None:
        raise WorkError(
            f"study '{study.name}' (or its materials, or the solver) was edited while the workflow runs. This workflow "
            "solves the earlier version and stops here. Start it again: every finished case is kept."
        )
    return ledger


def study_inputs(study: Study) -> list[str]:
    """Return the files a study's cases depend on: study file, table of cases, and the user's materials."""
    paths = []
    if study.path is not None:
        paths = [str(study.path)]
    if study.config.table is not None:
        paths.append(str(study.table_path))
    user = find_user_file()
    paths += [str(user)] if user is not None else []
    for path in paths:
        _check_braces("input file", path)
    return paths


def captions(study: Study, folder: StudyFolder) -> dict[str, str]:
    """Return what `snakemake --report` writes below the report and each figure, as reStructuredText by name.

    Parameters
    ----------
    study : Study
        The study; its question stands below the report.
    folder : StudyFolder
        The study's folder; without figures only the caption of the report is there.
    """
    index = folder.root / "figures" / "index.json"
    figures = []
    if index.is_file():
        figures = json.loads(index.read_text(encoding="utf-8"))
    texts = {"report": f"Study {study.name}: {study.config.description or 'no description'}"}
    texts |= {item["name"]: f"{item['sentence']} {item['caption']}".strip() for item in figures}
    return {name: _as_paragraph(text) for name, text in texts.items()}


def _as_paragraph(text: str) -> str:
    """Return a user's text as one paragraph of reStructuredText without markup, directives and links.

    A directive such as `.. include::` needs a line of its own, and every markup needs a punctuation mark. So all white
    space becomes single spaces, and each mark is escaped.
    """
    printable = [sign if sign.isprintable() or sign.isspace() else "?" for sign in text]
    words = " ".join("".join(printable).split())
    return re.sub(r"([^\w\s]|_)", r"\\\1", words)


def show_progress(folder: StudyFolder, to: TextIO = sys.stderr) -> None:
    """Say how many cases of a study are solved; on a terminal, each message replaces the one before.

    Parameters
    ----------
    folder : StudyFolder
        The study's folder.
    to : text stream
        Where the message is written.
    """
    plan = folder.record()
    total = plan["distinct"]
    solved = total - sum(size for name, size in plan["chunks"].items() if not folder.chunk(name).is_file())
    line = f"{folder.root.name}: {solved:,} of {total:,} cases solved ({100 * solved // max(total, 1)} %)"
    end = "\n"
    if to.isatty() and solved < total:
        end = "\r"
    print(line, file=to, flush=True, end=end)


def hide_chatter(handlers: Iterable[logging.Handler], report: Callable[[], str]) -> None:
    """Let Snakemake's log handlers pass only warnings, errors and the message that there is nothing to do.

    Parameters
    ----------
    handlers : iterable of logging.Handler
        The handlers of Snakemake's logger.
    report : callable
        Returns the path of the report, which that message names.
    """

    def is_shown(record: logging.LogRecord) -> bool:
        if record.getMessage().startswith("Nothing to be done"):
            record.msg = f"Nothing to be done. Report: {report()}"
            record.args = ()
            return True
        return record.levelno > logging.INFO

    for handler in handlers:
        handler.addFilter(is_shown)


def finished(folder: StudyFolder, seconds: float) -> str:
    """Return the last line of a run: where the report is and how long the run took."""
    report = folder.root / "report.html"
    took = duration(seconds)
    if report.is_file():
        return f"Report: {report}, made in {took}"
    return f"Done in {took}; there is no report yet."


def log_to(path: str, step: str = "") -> None:
    """Send the log lines and warnings of this process to a rule's log file, and tell the user the step's name."""
    sys.excepthook = _tell_error
    _held.enter_context(interrupts_wait_for_files())
    if step:
        print(step, file=sys.stderr, flush=True)
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    claim(Path(path))
    logging.basicConfig(filename=path, level=logging.INFO, format="%(asctime)s %(message)s", force=True)
    logging.captureWarnings(True)


def _tell_error(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """Print an error of the input or the work in one line, any other error with its traceback."""
    if isinstance(error, (InputError, WorkError)):
        print(f"trackroller: {error}", file=sys.stderr)
    else:
        tell_stopped(kind, error, trace)
