"""Studies of a folder: check their texts, start, pause, list, compare and delete them.

A study of the page stands in `studies/NAME.yaml`, and its results in `results/NAME/`, both in the
working directory.
"""

from __future__ import annotations

import contextlib
import datetime
import functools
import json
import math
import os
import subprocess
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from trackroller.app.worker import LOCK, PAUSE, PROGRESS, is_held
from trackroller.environment import python
from trackroller.errors import InputError, WorkError
from trackroller.files import (
    files_beside,
    find_beside,
    open_here,
    read_text,
    refuse_links,
    write_text,
)
from trackroller.report.headlines import headline_of, warning_line
from trackroller.report.html import write_page
from trackroller.report.numbers import rounded, unit_text
from trackroller.report.tables.inputs import factor_table
from trackroller.report.workbook import write_results
from trackroller.results.results import Results, shown_answer
from trackroller.results.stored_study import open_as_reported
from trackroller.roller.aliases import ALIASES
from trackroller.study.file.config import check_name
from trackroller.study.file.load import parse_study
from trackroller.study.file.study import Study
from trackroller.study.outputs import default_names, outputs
from trackroller.study.status import plan_rows, status_of
from trackroller.study.store.digests import digest_of_file, digest_of_text
from trackroller.study.store.folder import StudyFolder, delete_study
from trackroller.study.store.manifest import Manifest, check_unaltered, why_altered
from trackroller.study.store.mark import is_study
from trackroller.study.store.put import claim
from trackroller.yaml_file import errors_by_line, parse_mapping, write_yaml

TEXTS = Path("studies")
RESULTS = Path("results")
# studies and carriages that the page wrote or read
WRITTEN = Manifest(Path(), ".trackroller/files.jsonl")
MOST_CASES = 200_000  # larger studies belong on the command line, where nobody waits for a page
PAGES = ("report.html", "explorer.html")
_REFUSED: dict[str, Any] = {  # what the list shows of a study with a link in its folder
    **dict.fromkeys(("question", "step", "date"), ""),
    **dict.fromkeys(("total", "done", "failed")),
    **{"state": "stopped", "bytes": 0, "pages": []},
}
_running: dict[str, subprocess.Popen[bytes]] = {}  # the studies that this server started


def folder_of(name: Any) -> StudyFolder:
    """Return the folder of a study; refuse names and links that lead out of the results folder."""
    root = RESULTS / check_name(name)
    if _is_link(root):
        raise InputError(
            "name", name, "a folder of this place", "Copy the folder here.", "is a link"
        )
    refuse_links(root, "results")
    return StudyFolder(root)


def _is_link(root: Path) -> bool:
    return root.is_symlink() or RESULTS.is_symlink()


def checked(text: str | None = None, study: dict[str, Any] | None = None) -> dict[str, Any]:
    """Check a study and plan it.

    Parameters
    ----------
    text : str or None
        The study file, or None if the fields of the page give the study.
    study : mapping, optional
        The keys of a study file.

    Returns
    -------
    dict
        The text and the keys, so that each follows the other; what is wrong with field, line and
        message; the rows of the plan; and doubts about values.
    """
    out: dict[str, Any] = {"text": text, "study": None, "errors": [], "plan": [], "doubts": []}
    try:
        out["text"] = text
        if text is None:
            out["text"] = write_yaml(study or {})
        out["study"] = parse_mapping(out["text"], "study file")
        parsed = _study(out["text"])
        out |= {
            "plan": plan_rows(parsed, status_of(parsed, folder_of(parsed.name))),
            "doubts": parsed.doubts(),
        }
    except InputError as exc:
        out["errors"] = [{"field": e.field, "line": e.line, "message": str(e)} for e in exc.errors]
    except WorkError as exc:
        out["errors"] = [{"field": "name", "line": None, "message": str(exc)}]
    return out


def _study(text: str) -> Study:
    """Return the checked study of a text, unless it is too large for the page."""
    data = parse_mapping(text, "study file")
    with errors_by_line(text, aliases=ALIASES), files_beside(TEXTS / "study.yaml"):
        if data.get("table"):
            find_beside(data["table"], "table")  # only the folder of the page is read
        study = parse_study(data, TEXTS / "study.yaml")
    cases = _least_cases(study)
    config = study.config
    if cases <= MOST_CASES:  # a larger design may fill the memory when it is drawn
        searched = 0
        if config.method.proposes:
            searched = config.budget.designs * study.drawn.meta["inner_samples"]
        grown = 0
        if config.until:
            grown = config.until.at_most
        cases = max(study.drawn.size, searched, grown)
    if cases > MOST_CASES:
        allowed = f"at most {MOST_CASES:,} cases on this page"
        raise InputError(
            "method", f"{cases:,} cases", allowed, "Start larger studies with `trackroller run`."
        )
    return study


def _least_cases(study: Study) -> int:
    """Return about how many cases a study has, found without drawing its design."""
    method = study.config.method
    count = 1
    if method.sampled or method.proposes:
        count = int(study.config.samples)
    if method.points or not (method.sampled or method.proposes):
        count *= math.prod(len(factor.levels) for factor in study.parsed.values() if factor.levels)
    return count


def start(text: str) -> dict[str, Any]:
    """Write a study file and run the study in a process of its own; a study that was paused goes
    on.
    """
    name = _study(text).name
    folder = folder_of(name)
    if _works(name, folder):
        raise WorkError(f"{_running_sentence(name, folder)}, or give this study another name.")
    folder.create()
    _write_text(name, text, folder)
    states = [claim(folder.root / file) for file in (PROGRESS, PAUSE)]
    Manifest(folder.root).unlink(states)
    with open_here(claim(folder.root / "page.log"), "ab") as log:
        log.write(
            f"trackroller: started {datetime.datetime.now().isoformat(' ', 'seconds')}\n".encode()
        )
        log.flush()
        _running[name] = subprocess.Popen(
            python("trackroller.app.worker", name),
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # Ctrl-C at the server does not reach it
        )
    return {"name": name}


def _write_text(name: str, text: str, folder: StudyFolder) -> None:
    """Write the file of a study, unless somebody has written another one since the page wrote it or
    read it.

    The page wrote or read what stands in its own record, and what the study was planned from.
    """
    path = TEXTS / f"{name}.yaml"
    digest = digest_of_text(text)
    planned = {one["sha256"] for one in folder.record().get("inputs", {}).values()}
    if not WRITTEN.owns(path, digest) and digest_of_file(path) not in planned:
        remedy = "Give the study another name, or rename the file."
        raise InputError(
            "name",
            name,
            "a name whose file this page wrote",
            remedy,
            f"has a file {path} from elsewhere",
        )
    WRITTEN.note({path.as_posix(): digest})
    write_text(path, text)


def resume(name: str) -> dict[str, Any]:
    """Let a paused study go on, or make the pages of a study that was run on the command line."""
    return start(text_of(name)["text"])


def pause(name: str) -> None:
    """Ask a running study to stop; its finished chunks stay."""
    folder = folder_of(name)
    if not _runs_from_page(name, folder):
        raise WorkError(
            f"The study '{name}' does not run from this page, so the page cannot pause it."
        )
    claim(folder.root / PAUSE).touch()


def delete(name: str, confirm: str = "") -> None:
    """Delete the results of a study; its file in `studies/` stays."""
    folder = folder_of(name)
    if confirm != name:
        raise InputError(
            "confirm",
            confirm,
            f"the name of the study, {name}",
            "Confirm the question of the page.",
        )
    if _works(name, folder):
        raise WorkError(f"{_running_sentence(name, folder)}.")
    if not folder.root.is_dir():
        remedy = "It may be deleted already."
        raise InputError("name", name, "a study of this folder", remedy, "is not there")
    delete_study(folder.create().root)


def _works(name: str, folder: StudyFolder) -> bool:
    """Return whether a process works on a study, started here, by an earlier server or on the
    command line.
    """
    return _runs_from_page(name, folder) or is_held(folder.lock)


def _runs_from_page(name: str, folder: StudyFolder) -> bool:
    """Return whether this server or an earlier one started the process of a study, so that the page
    can pause it.
    """
    return _starts(name) or is_held(folder.root / LOCK)


def _running_sentence(name: str, folder: StudyFolder) -> str:
    """Return that a study runs and how to end it, as a sentence without its full stop."""
    if _runs_from_page(name, folder):
        return f"The study '{name}' runs already. Pause it first"
    return f"The study '{name}' runs on the command line. Wait until it ends, or stop it there"


def _starts(name: str) -> bool:
    """Return whether a process of this server works on a study, which takes its lock after some
    seconds only.
    """
    return name in _running and _running[name].poll() is None


def listing() -> list[dict[str, Any]]:
    """Return the studies of the folder, the newest first."""
    entries = []
    for path in RESULTS.glob("*"):
        with contextlib.suppress(InputError):  # a link, or a folder of something else
            entries.append(_entry(path.name))
    return sorted((e for e in entries if e is not None), key=lambda e: str(e["date"]), reverse=True)


def _entry(name: str) -> dict[str, Any] | None:
    """Return what the list shows of a study; None for a folder of something else."""
    try:
        folder = folder_of(name)
    except InputError as exc:
        if _is_link(RESULTS / check_name(name)):
            return None
        return _REFUSED | {"name": name, "error": str(exc)}
    progress = _progress_of(folder)
    works = _works(name, folder)
    if not (works or progress or folder.gathered.is_file() or is_study(folder.root)):
        return None
    files = list(_stats(folder.root))
    newest = max((stat.st_mtime for stat in files), default=0.0)
    size = sum(stat.st_size for stat in files)
    error = ""
    if not works:
        error = progress.get("error") or _altered(folder.gathered, newest, size)
    return {
        "name": name,
        "question": folder.earlier().get("description", ""),
        "step": progress.get("step", "starting"),
        "error": error,
        **_state_of(folder, progress, works, bool(error)),
        "failed": progress.get("failed"),
        "bytes": size,
        "date": datetime.datetime.fromtimestamp(newest).isoformat(" ", "minutes"),
        "pages": [page for page in PAGES if (folder.root / page).is_file()],
    }


def _progress_of(folder: StudyFolder) -> dict[str, Any]:
    """Return what the process of a study wrote of its progress; {} without such a file."""
    with contextlib.suppress(OSError, ValueError):
        progress: dict[str, Any] = json.loads((folder.root / PROGRESS).read_text(encoding="utf-8"))
        return progress
    return {}


def _state_of(
    folder: StudyFolder, progress: Mapping[str, Any], works: bool, has_error: bool
) -> dict[str, Any]:
    """Return the state of a study, and how many of its cases are done."""
    chunks = folder.record().get("chunks", {})
    total = progress.get("total") or sum(chunks.values()) or None
    solved = sum(n for key, n in chunks.items() if folder.chunk(key).is_file())
    whole = folder.gathered.is_file() and solved == sum(chunks.values())
    done = solved
    if works:
        state = "running"
        done = progress.get("done", solved)
    elif has_error:
        state = "stopped"
    elif whole:
        state = "done"
        done = total
    else:
        state = "paused"
    return {"state": state, "total": total, "done": done}


def _stats(root: Path) -> Iterator[os.stat_result]:
    """Return size and date of each file; the files of a study that runs may vanish meanwhile."""
    for folder, _, names in os.walk(root):
        for name in names:
            with contextlib.suppress(FileNotFoundError):
                yield os.lstat(Path(folder, name))


@functools.lru_cache(1000)  # the list is made every few seconds, and a digest takes up to a second
def _altered(path: Path, newest: float, size: int) -> str:
    """Return what is wrong with a result that was altered after it was written; date and size are
    of its folder.
    """
    return (why_altered(path) if path.is_file() else "") or ""


def text_of(name: str) -> dict[str, Any]:
    """Return the file of a study, as it was written or as it was stored with the results.

    After its folder or its file was renamed, the study has the new name, so that its run goes on
    there.
    """
    for path in (TEXTS / f"{check_name(name)}.yaml", folder_of(name).study_file):
        if path.is_file():
            text = read_text(path, "study file")
            with contextlib.suppress(InputError):  # the page shows what is wrong in the file
                stated = parse_mapping(text, "study file")
                if stated.get("name", name) != name:
                    return {"text": write_yaml(stated | {"name": name})}
            return {"text": text}
    raise InputError(
        "name", name, "a study of this folder", "Choose one of the list.", "is not there"
    )


def page_of(name: str, page: str) -> Path:
    """Return the report of a study, or its explorer."""
    path = folder_of(name).root / page
    if page not in PAGES or path.is_symlink() or not path.is_file():
        allowed = f"{' or '.join(PAGES)} of a study that was run"
        raise InputError("page", f"{name}/{page}", allowed, "Let the study run to its end.")
    return check_unaltered(path)


def file_of_study(name: str, file: str) -> bytes:
    """Return the report of a study as PDF, `report.pdf`, or its cases as a workbook,
    `cases.xlsx`.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, file)
        if path.suffix == ".pdf":
            return write_page(
                path, page_of(name, "report.html").read_text(encoding="utf-8")
            ).read_bytes()
        return write_results(open_as_reported(folder_of(name).root), path).read_bytes()


def headlines(name: str) -> dict[str, Any]:
    """Return factors, headline numbers, and the headline and the warnings of a study."""
    results = open_as_reported(folder_of(name).root)
    table = factor_table(results)
    return {
        "name": name,
        "cases": len(results.table),
        "factors": {str(row[0]): f"{row[2]} {row[1]}".strip(" –") for row in table.rows}
        if table
        else {},
        "numbers": _numbers(results),
        "short": _headline(results),
    }


def _headline(results: Results) -> list[tuple[str, str]]:
    """Return the headline and the warnings of a study, each with its head."""
    answer = shown_answer(results)
    warnings = " · ".join(warning_line(caution) for caution in answer.warnings)
    lines = [("Answer", headline_of(answer).text), ("Warnings", warnings)]
    return [(head, text) for head, text in lines if text]


def _numbers(results: Results) -> dict[str, list[str]]:
    """Return lowest, middle and highest value of each output over the cases that roll."""
    out = {}
    for one in outputs(
        results.data,
        results.dims,
        default_names(results.data, results.dims, results.dims),
        scale="natural",
    ):
        values = sorted(v for v in one.values.tolist() if math.isfinite(v))
        if values:
            label = f"{one.long_name} [{unit_text(one.units)}]".removesuffix(" [–]")
            out[label] = [rounded(v) for v in (values[0], values[len(values) // 2], values[-1])]
    return out
