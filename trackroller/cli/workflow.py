"""What the Snakefile and its scripts call."""

from __future__ import annotations

import logging
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from trackroller.errors import InputError, unknown_name
from trackroller.study.config import Study, load_study
from trackroller.study.plan import Plan, make_plan

CONFIG_KEYS = ("study", "results")
log = logging.getLogger("trackroller")


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


def workflow_plan(config: Mapping[str, Any], check: bool, tell: Any = None) -> Plan:
    """Plan of the workflow's study. `check` reads all kept chunks for damage (the main process does)."""
    return make_plan(workflow_study(config), str(config.get("results", "results")), tell=tell, check=check)


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


def analyse_study(study_nc: str, out: str) -> None:
    """Sensitivity of the study, or a file that says why there is none."""
    from trackroller.analysis.sensitivity import analyse

    try:
        analyse(study_nc, out)
    except InputError as exc:
        import xarray as xr

        from trackroller.study.files import write_whole

        log.info("no sensitivity analysis: %s", exc)
        empty = xr.Dataset(attrs={"comment": f"no sensitivity analysis: {exc}"})
        write_whole(Path(out), lambda beside: empty.to_netcdf(beside))


def draw_study(study_nc: str, sensitivity_nc: str, out_dir: str) -> None:
    """All figures of a study; the folder appears whole or not at all."""
    from trackroller.report.figures.sensitivity import draw_all as draw_sensitivity
    from trackroller.report.figures.study import draw_all as draw_results

    out = Path(out_dir)
    beside = out.with_name(f".{out.name}.tmp")
    shutil.rmtree(beside, ignore_errors=True)
    beside.mkdir(parents=True)
    draw_results(Path(study_nc), beside)
    if has_analysis(sensitivity_nc):
        draw_sensitivity(Path(study_nc), Path(sensitivity_nc), beside)
    shutil.rmtree(out, ignore_errors=True)
    beside.rename(out)


def report_study(study_nc: str, figures: str, sensitivity_nc: str, out: str) -> None:
    """The report, with the sensitivity analysis where there is one."""
    from trackroller.report import write_report

    analysis = Path(sensitivity_nc) if has_analysis(sensitivity_nc) else None
    write_report(Path(study_nc), Path(figures), Path(out), analysis)


def has_analysis(sensitivity_nc: str | Path) -> bool:
    """Does the file hold an analysis (or only say why there is none)?"""
    import netCDF4

    with netCDF4.Dataset(sensitivity_nc) as file:
        return len(file.variables) > 0
