"""Run a study of any kind, also one that decides by itself what is solved next."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from trackroller.study.file.study import Study
from trackroller.study.run import run_study
from trackroller.study.store.plan import Plan


def decides(study: Study) -> bool:
    """Return whether the cases of a study depend on results; with a table of its designs a search is at its end."""
    searches = study.config.design == "optimise" and study.config.table is None
    return bool(searches or study.config.until is not None)


def run_any(study: Study, results: Path | str = "results", *, rerun_failed: bool = False, **how: Any) -> Plan:
    """Run a study; see `trackroller.study.run.run_study` for the arguments.

    With `rerun_failed` the failed cases of a search are solved again before it goes on.
    """
    if study.config.until is not None:
        from trackroller.analysis.growing import grow_study  # heavy: scipy.stats, as below

        return grow_study(study, results, rerun_failed=rerun_failed, **how)
    if not decides(study):
        return run_study(study, results, rerun_failed=rerun_failed, **how)
    from trackroller.analysis.optimum import search_designs  # heavy: scipy.stats, which no job of a workflow needs

    return search_designs(study, results, rerun_failed=rerun_failed, **how)
