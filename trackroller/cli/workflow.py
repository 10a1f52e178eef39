"""What the Snakefile and its scripts call."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from trackroller.errors import InputError, unknown_name
from trackroller.report.build import analyse_study, draw_study, report_study
from trackroller.study.config import Study, load_study
from trackroller.study.files import WorkError
from trackroller.study.plan import Plan, read_plan, study_folder, working_plan

__all__ = [
    "analyse_study",
    "draw_study",
    "log_to",
    "report_study",
    "sources",
    "study_inputs",
    "workflow_plan",
    "workflow_study",
]
CONFIG_KEYS = ("study", "results")
log = logging.getLogger("trackroller")
_held = contextlib.ExitStack()  # keeps the lock of the study until this process ends


def workflow_study(config: Mapping[str, Any]) -> Study:
    """The study that the workflow's configuration names; raises `InputError` for a wrong configuration."""
    for key in config:
        if key not in CONFIG_KEYS:
            raise unknown_name("--config key", str(key), CONFIG_KEYS)
    if not isinstance(config.get("study"), str):
        raise InputError(
            "study",
            config.get("study"),
            "the path of a study file",
            "Write it in config/config.yaml or give --config study=config/studies/NAME.yaml.",
        )
    return load_study(config["study"])


def workflow_plan(config: Mapping[str, Any], main: bool, tell: Any = None) -> Plan:
    """Return the plan of the workflow's study.

    The main process plans, and keeps other processes from changing the plan until it ends. Its jobs read the plan.

    Raises
    ------
    InputError
        If the configuration or the study is wrong.
    WorkError
        If the study was edited after the main process had planned it.
    """
    study, results = workflow_study(config), str(config.get("results", "results"))
    if main:
        return _held.enter_context(working_plan(study, results, tell=tell))
    plan = read_plan(study, study_folder(study.name, results))
    if plan is None:
        raise WorkError(
            f"study '{study.name}' was edited while the workflow runs: this workflow solves the earlier version and "
            "stops here. Start it again: every finished case is kept."
        )
    return plan


def study_inputs(study: Study) -> list[str]:
    """Files a study's cases depend on: study file, table, materials of the user."""
    from trackroller.materials.file import find_user_file
    from trackroller.study.design.build import table_path

    found = [str(study.path)] if study.path is not None else []
    if study.config.table is not None:
        found.append(table_path(study))
    user = find_user_file()
    return found + ([str(user)] if user is not None else [])


def sources(*parts: str) -> list[str]:
    """Source files of parts of the package, so that results are redrawn when their code changes."""
    root = Path(__file__).resolve().parents[1]
    found: list[Path] = []
    for part in parts:
        path = (root.parent if part.startswith("validation") else root) / part
        found += (
            sorted(p for p in path.rglob("*") if p.suffix in (".py", ".html", ".css", ".j2"))
            if path.is_dir()
            else [path]
            if path.is_file()
            else []
        )
    return [str(p) for p in found]


def log_to(path: str) -> None:
    """Send this process's log lines to a rule's log file, and warnings with them."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    logging.basicConfig(filename=path, level=logging.INFO, format="%(asctime)s %(message)s", force=True)
    logging.captureWarnings(True)
