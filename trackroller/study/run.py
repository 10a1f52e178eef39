"""Run a study in this process or on dask workers; a run that was interrupted goes on where it stopped."""

from __future__ import annotations

import contextlib
import functools
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from trackroller.files import interrupts_wait_for_files
from trackroller.roller.options import options_of_cases
from trackroller.study.cluster import workers
from trackroller.study.solve import Executor, Solver, solve_chunk, solve_here
from trackroller.study.store import chunks
from trackroller.study.store.folder import Tell
from trackroller.study.store.gather import gather
from trackroller.study.store.labels import labelled
from trackroller.study.store.plan import Plan
from trackroller.study.store.planning import working_plan

if TYPE_CHECKING:
    from trackroller.study.file.study import Study


@interrupts_wait_for_files()
def run_study(
    study: Study,
    results: Path | str = "results",
    *,
    rerun_failed: bool = False,
    scheduler: str | None = None,
    tell: Tell | None = None,
    started: Callable[[int, int], None] | None = None,
    progress: Callable[[int, int], None] | None = None,
    solver: Solver | None = None,
) -> Plan:
    """Plan a study, solve the missing cases and gather the results.

    Parameters
    ----------
    study : Study
        The checked study.
    results : path
        Parent of the study's folder.
    rerun_failed : bool
        Solve the failed cases again as well.
    scheduler : str, optional
        'local' or 'tcp://host:port' solves on dask workers; by default this process solves.
    tell : callable, optional
        Receives one line for each event that the user should read.
    started : callable, optional
        Receives the number of different cases and how many of them the complete chunks hold.
    progress : callable, optional
        Receives the number of cases of each finished block of the other chunks, and how many of them failed.
    solver : callable, optional
        Replaces `trackroller.solve` in this process.

    Returns
    -------
    Plan
        The plan that was carried out.

    Raises
    ------
    InputError
        If the study or the address of the scheduler is wrong.
    WorkError
        If the work cannot be completed, because an input was edited meanwhile or the disk is full, for example; every
        finished chunk is kept.
    """
    tell = tell or (lambda line: None)
    with contextlib.ExitStack() as stack:
        plan = stack.enter_context(working_plan(study, results, tell=tell, rerun_failed=rerun_failed))
        left = plan.open
        if started is not None:
            started(plan.distinct, plan.distinct - sum(plan.chunks[name] for name in left))
        executor = stack.enter_context(executing(scheduler if left else None, solver))
        for name in left:
            tell(solve_chunk(plan.folder, name, study.materials, executor=executor, tell=tell, progress=progress))
        gather(plan, tell=tell)
    return plan


@contextlib.contextmanager
def executing(scheduler: str | None, solver: Solver | None = None) -> Iterator[Executor]:
    """Yield what solves the cases of a chunk: dask workers, or this process without a scheduler; see `run_study`."""
    with contextlib.ExitStack() as stack:
        here: Executor = functools.partial(solve_here, solver=solver)
        yield here if scheduler is None else stack.enter_context(workers(scheduler))


def solve_study(
    study: Study,
    started: Callable[[int, int], None] | None = None,
    progress: Callable[[int, int], None] | None = None,
    solver: Solver | None = None,
) -> xr.Dataset:
    """Solve a study in memory.

    Parameters
    ----------
    study : Study
        The checked study.
    started, progress, solver : callable, optional
        As for `run_study`.

    Returns
    -------
    xarray.Dataset
        The same data set that `run_study` writes to `study.nc`.
    """
    design = study.design()
    options, group = options_of_cases(design, {})
    cases = design.drop_vars(list(design.coords)).drop_attrs().assign_coords(case=np.arange(len(group)))
    if started is not None:
        started(len(group), 0)
    blocks = []
    for number, one in enumerate(options):
        part = cases.isel(case=np.flatnonzero(group == number)).assign_attrs(options=json.dumps(one))
        for block in solve_here(part, study.materials, solver):
            blocks.append(block)
            if progress is not None:
                progress(*chunks.counts(block))
    solved = chunks.join(blocks).sel(case=cases["case"].values)
    results = {name: values.variable for name, values in solved.data_vars.items()}
    axes = {name: values.variable for name, values in solved.coords.items() if name != "case"}
    return labelled(study, study.drawn, design, results, axes, solved.attrs)
