"""Run a study of any kind, also one that decides by itself what is solved next."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from trackroller.study.file.study import Study
from trackroller.study.run import run_study
from trackroller.study.store.ledger import Ledger


def decides(study: Study) -> bool:
    """Return whether the cases of a study depend on results; with a table of its designs a search is at its end."""
    searches = study.config.method.proposes and study.config.table is None
    return bool(searches or study.config.until is not None)


def run_any(study: Study, results: Path | str = "results", **how: Any) -> Ledger:
    """Run a study; see `trackroller.study.run.run_study` for the arguments.

    The failed cases of a search that are to be solved again are solved before it goes on.
    """
    if study.config.until is not None:
        from trackroller.results.growing import grow_study as run  # heavy: scipy.stats, as below
    elif decides(study):
        from trackroller.results.optimum import search_designs as run  # heavy: no job of a workflow needs it
    else:
        run = run_study
    return run(study, results, **how)
