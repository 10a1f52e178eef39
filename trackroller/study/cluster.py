"""The same chunks on dask workers: batches of cases out, blocks back; only this process writes files."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from trackroller.errors import InputError
from trackroller.study import store
from trackroller.study.caselists import CaseList, load_list
from trackroller.study.files import WorkError, locked
from trackroller.study.mend import Tell
from trackroller.study.plan import Plan, read_parts
from trackroller.study.solve import check_identity, finish, missing_rows, solve_rows, write_part

BATCH_SECONDS = 2.0


def solve_chunks(
    plan: Plan, names: list[str], scheduler: str, *, tell: Tell, progress: Callable[[int], None] | None = None
) -> None:
    """Solve chunks on the workers of `scheduler` ('local' starts two processes here).

    A batch that kills its worker again and again is halved until the case that does so stands alone and is
    kept as failed.
    """
    client = _client(scheduler)
    try:
        for name in names:
            _solve_chunk(plan, name, client, tell, progress)
    finally:
        client.close()
        if scheduler == "local":
            client.cluster.close()


def _client(scheduler: str) -> Any:
    import dask
    from distributed import Client, LocalCluster

    if scheduler != "local" and not scheduler.startswith(("tcp://", "tls://")):
        raise InputError("--scheduler", scheduler, "local, or the address of a dask scheduler: tcp://host:port")
    dask.config.set({"distributed.scheduler.allowed-failures": 2})
    if scheduler == "local":
        import os

        count = len(os.sched_getaffinity(0))
        return Client(LocalCluster(n_workers=count, threads_per_worker=1, dashboard_address=None))
    try:
        return Client(scheduler, timeout="10s")
    except (OSError, ValueError) as exc:
        raise InputError(
            "--scheduler",
            scheduler,
            f"no dask scheduler answers there ({exc})",
            "Start one: dask scheduler, dask worker ADDRESS.",
        ) from None


def _work(cases: CaseList, database: Any) -> store.Block:
    return solve_rows(cases, np.arange(len(cases.cases)), database)


def _part(cases: CaseList, rows: np.ndarray) -> CaseList:
    return CaseList(cases.name, cases.cases[rows], {k: v[rows] for k, v in cases.columns.items()}, cases.options)


def _solve_chunk(plan: Plan, name: str, client: Any, tell: Tell, progress: Callable[[int], None] | None) -> None:
    from distributed import KilledWorker, as_completed

    from trackroller.study.cost import rate

    folder, database = plan.folder, plan.study.materials
    with locked(folder.lock(name), tell):
        cases = load_list(folder, name)
        check_identity(cases, database)
        blocks = read_parts(folder, name, tell)
        rows = missing_rows(cases, blocks)
        size = max(8, min(2000, math.ceil(BATCH_SECONDS * rate(cases.options))))
        batches = np.array_split(rows, max(1, math.ceil(len(rows) / size))) if len(rows) else []

        def submit(index: np.ndarray) -> Any:
            future = client.submit(_work, _part(cases, index), database, pure=False)
            waiting[future.key] = index
            return future

        waiting: dict[str, np.ndarray] = {}
        queue = as_completed([submit(index) for index in batches])
        for future in queue:
            index = waiting.pop(future.key)
            try:
                block = future.result()
            except KilledWorker:
                if len(index) > 1:
                    for half in np.array_split(index, 2):
                        queue.add(submit(half))
                    continue
                block = store.failure(cases.cases[index], "killed its worker process")
            except (InputError, WorkError):
                raise
            except Exception as exc:
                raise WorkError(f"a dask worker failed: {exc}. Start again: finished cases are kept.") from exc
            write_part(folder, name, block)
            blocks.append(block)
            if progress is not None:
                progress(len(index))
        chunk = finish(folder, cases, blocks)
    tell(f"chunk {name}: {len(cases.cases)} cases, {len(rows)} solved now, {int(chunk.failed.sum())} failed")
