"""Solve a study of any kind, also one whose results decide which cases follow."""

from __future__ import annotations

import dataclasses
import tempfile
from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

from trackroller.numerics.threads import limited_to
from trackroller.results.results import Results
from trackroller.results.stored_study import open_study
from trackroller.study.file.load import load_study
from trackroller.study.file.study import Study
from trackroller.study.progress import progress_bar
from trackroller.study.run import run_study, solve_study
from trackroller.study.store.ledger import Ledger


def run(
    study: Study | Path | str | Mapping[str, Any],
    cores: int | None = None,
    progress: bool = True,
    results: Path | str | None = None,
) -> Results:
    """Solve a study in this process.

    Parameters
    ----------
    study : Study, pathlib.Path, str or mapping
        The study, its file, or a mapping with the keys of a study file.
    cores : int, optional
        Number of threads; by default one for each processor.
    progress : bool
        Whether to show a progress bar.
    results : path, optional
        Parent of a folder that keeps every solved case, as `trackroller run` does: a run that was
        interrupted goes on there. By default nothing is written.

    Returns
    -------
    Results
        The results of the study.

    Raises
    ------
    InputError
        If the study is wrong.
    WorkError
        If the folder cannot be written.

    Examples
    --------
    >>> import trackroller as tr
    >>> factors = {"friction_coefficient": {"values": [0.1, 0.2]}}
    >>> factors |= {"roller_profile_radius": {"values": [-7, -8]}}
    >>> study = {"name": "groove", "factors": factors, "contact_model": "sliding"}
    >>> solved = tr.run(study, progress=False)
    >>> float(solved.best(1)["roller_profile_radius"].iloc[0])
    -7.0
    """
    if isinstance(study, Study):
        checked = study
    else:
        checked = load_study(study)
    with limited_to(cores), progress_bar(checked.name, progress) as bar:
        shown: dict[str, Any] = {"started": bar.started, "progress": bar.advanced, "tell": bar.tell}
        if results is None and not checked.decides:
            return Results(checked, checked.drawn, solve_study(checked, bar.started, bar.advanced))
        # the cases of a study that decides follow from stored results
        folder: AbstractContextManager[Path | str]
        if results is None:
            folder = tempfile.TemporaryDirectory()
        else:
            folder = nullcontext(results)
        with folder as place:
            solved = open_study(run_any(checked, place, **shown).folder.root)
            if results is not None:
                return solved
            return dataclasses.replace(solved, materials_file=None)


def run_any(study: Study, results: Path | str = "results", **how: Any) -> Ledger:
    """Run a study; see `trackroller.study.run.run_study` for the arguments.

    The failed cases of a search that are to be solved again are solved before it goes on.
    """
    if study.config.until is not None:
        from trackroller.results.sample_growth import (
            grow_study as run,  # heavy: scipy.stats, as below
        )
    elif study.decides:
        # heavy: no job of a workflow needs it
        from trackroller.results.search import search_candidates as run
    else:
        run = run_study
    return run(study, results, **how)
