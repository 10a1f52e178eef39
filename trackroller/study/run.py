"""Running a study in this process (or on dask workers), with progress, resumable at any time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from trackroller.study.mend import Tell
from trackroller.study.plan import Plan, make_plan, read_parts
from trackroller.study.solve import Solver, forget_failed, solve_chunk, solved

if TYPE_CHECKING:
    from trackroller.study.config import Study

Progress = Callable[[int], None]


def run_study(
    study: Study,
    results: Path | str = "results",
    *,
    rerun_failed: bool = False,
    scheduler: str | None = None,
    tell: Tell | None = None,
    started: Callable[[int, int], None] | None = None,
    progress: Progress | None = None,
    solver: Solver | None = None,
) -> Plan:
    """Plan a study, solve what is missing and gather it.

    Parameters
    ----------
    study : the checked study
    results : parent of the study's folder
    rerun_failed : solve the failed cases anew as well
    scheduler : None for this process, 'local' or 'tcp://host:port' for dask.distributed
    tell : called with one line for each thing worth telling
    started : called once with (number of cases in the plan's chunks, of these finished already)
    progress : called with the number of cases of each finished block

    Raises `InputError` for bad input and `WorkError` for a full disk and the like; what is finished is kept.
    """
    from trackroller.study.gather import gather

    tell = tell or (lambda line: None)
    plan = make_plan(study, results, tell=tell)
    if rerun_failed:
        tell(f"{forget_failed(plan.folder, list(plan.chunks), tell)} failed cases are solved again")
    open_chunks = [name for name in plan.chunks if not solved(plan.folder, name, tell)]
    done = sum(n for name, n in plan.chunks.items() if name not in open_chunks)
    done += sum(len(b.cases) for name in open_chunks for b in read_parts(plan.folder, name, tell))
    if started is not None:
        started(sum(plan.chunks.values()), done)
    if scheduler is None:
        for name in open_chunks:
            tell(solve_chunk(plan.folder, name, study.materials, tell=tell, progress=progress, solver=solver))
    elif open_chunks:
        from trackroller.study.cluster import solve_chunks

        solve_chunks(plan, open_chunks, scheduler, tell=tell, progress=progress)
    gather(plan, tell=tell)
    return plan
