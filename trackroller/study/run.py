"""Run a study in this process or on dask workers; a run that was interrupted goes on where it
stopped.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.files import interrupts_wait_for_files, locked
from trackroller.study.cluster import workers
from trackroller.study.solve_chunk import Executor, LocalExecutor, Solver, solve_chunk
from trackroller.study.store import chunks
from trackroller.study.store.fingerprint import StudyCases
from trackroller.study.store.folder import Count, StudyFolder, Tell, unheard
from trackroller.study.store.gather import gather
from trackroller.study.store.ledger import Ledger, study_folder, working_ledger
from trackroller.study.store.solved_dataset import labelled

if TYPE_CHECKING:
    from trackroller.study.file.study import Study


@dataclass
class Runner:
    """What solves the cases of studies, where the results are kept, and who is told; a context that
    ends its workers.

    Parameters
    ----------
    results : path
        Parent of the folders of studies.
    rerun_failed : bool
        Solve the failed cases again as well.
    scheduler : str, optional
        'local' or 'tcp://host:port' solves on dask workers; by default this process solves.
    tell : callable
        Receives one line for each event that the user should read.
    started : callable
        Receives the number of different cases and how many of them the complete chunks hold.
    progress : callable
        Receives the number of cases of each finished block of the other chunks, and how many of
        them failed.
    solver : callable, optional
        Replaces `trackroller.solve` in this process.
    """

    results: Path | str = "results"
    rerun_failed: bool = False
    scheduler: str | None = None
    tell: Tell = unheard
    started: Count = unheard
    progress: Count = unheard
    solver: Solver | None = None
    _until_end: contextlib.ExitStack = field(default_factory=contextlib.ExitStack, repr=False)

    def __enter__(self) -> Runner:
        self._until_end.enter_context(interrupts_wait_for_files())
        return self

    def __exit__(self, *error: Any) -> None:
        self._until_end.__exit__(*error)

    @cached_property
    def executor(self) -> Executor:
        """Return what solves a list of cases; workers start with the first list."""
        if self.scheduler is None:
            return LocalExecutor(self.solver)
        return self._until_end.enter_context(workers(self.scheduler, self.tell))

    @contextlib.contextmanager
    def solved(self, study: Study, rerun_failed: bool = False) -> Iterator[Ledger]:
        """Plan a study, solve its missing cases, and keep its ledger as it is until the context
        ends.
        """
        with working_ledger(
            study, self.results, tell=self.tell, rerun_failed=rerun_failed
        ) as ledger:
            missing = ledger.open
            tell = self.tell
            progress = self.progress
            self.started(
                ledger.distinct, ledger.distinct - sum(ledger.chunks[name] for name in missing)
            )
            for name in missing:
                settings: dict[str, Any] = {
                    "executor": self.executor,
                    "tell": tell,
                    "progress": progress,
                }
                tell(
                    solve_chunk(
                        ledger.folder, name, study.materials, inputs=study.inputs, **settings
                    )
                )
            yield ledger.anew()

    @contextlib.contextmanager
    def deciding(self, study: Study) -> Iterator[StudyFolder]:
        """Keep other processes from deciding what is solved next; remove failed cases that are to
        be solved again.
        """
        folder = study_folder(study.name, self.results).create()
        with locked(folder.lock.with_name(".search"), tell=self.tell):
            if self.rerun_failed:
                Ledger(StudyCases(study), folder).forget_failed()
            yield folder


def run_study(study: Study, results: Path | str = "results", **how: Any) -> Ledger:
    """Plan a study, solve the missing cases and gather the results.

    Parameters
    ----------
    study : Study
        The checked study.
    results : path
        Parent of the study's folder.
    **how
        Other fields of `Runner`.

    Returns
    -------
    Ledger
        The ledger of the study, whose chunks are all solved.

    Raises
    ------
    InputError
        If the study or the address of the scheduler is wrong.
    WorkError
        If the work cannot be completed, because an input was edited meanwhile or the disk is full,
        for example; every finished chunk is kept.
    """
    with Runner(results, **how) as runner, runner.solved(study, runner.rerun_failed) as ledger:
        gather(ledger, runner.tell)
    return ledger


def solve_study(study: Study, started: Count = unheard, progress: Count = unheard) -> xr.Dataset:
    """Solve a study in memory.

    Parameters
    ----------
    study : Study
        The checked study.
    started, progress : callable
        As for `Runner`.

    Returns
    -------
    xarray.Dataset
        The same data set that `run_study` writes to `study.nc`.
    """
    identified = StudyCases(study)
    design = identified.design
    options, group = identified.options
    cases = (
        design.drop_vars(list(design.coords)).drop_attrs().assign_coords(case=np.arange(len(group)))
    )
    started(len(group), 0)
    blocks = []
    executor = LocalExecutor()
    for number, settings in enumerate(options):
        part = cases.isel(case=np.flatnonzero(group == number)).assign_attrs(
            options=json.dumps(settings)
        )
        for block in executor(part, study.materials):
            blocks.append(block)
            progress(*chunks.counts(block))
    solved = chunks.join(blocks).sel(case=cases["case"].values)
    return labelled(study, study.drawn, design, solved)
