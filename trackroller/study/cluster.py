"""Solve cases on dask workers: workers receive batches of cases and return blocks; only this process writes files."""

from __future__ import annotations

import contextlib
import json
import math
import os
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from trackroller.environment import SAFE_PATH
from trackroller.errors import InputError, WorkError
from trackroller.files import cores
from trackroller.study.cost import rate
from trackroller.study.solve_chunk import Executor, solve_cases
from trackroller.study.store import chunks

BATCH_SECONDS = 2.0


@contextlib.contextmanager
def workers(scheduler: str) -> Iterator[Executor]:
    """Connect to dask workers.

    Parameters
    ----------
    scheduler : str
        'local' starts one process for each processor of this machine; 'tcp://host:port' names a running scheduler.

    Yields
    ------
    callable
        An executor for `trackroller.study.solve_chunk.solve_chunk`.

    Raises
    ------
    InputError
        If the address is wrong or no scheduler answers.
    """
    with _client(scheduler) as client:
        yield lambda cases, database: _solve(client, cases, database)


def _client(scheduler: str) -> Any:
    import dask  # slow to import

    try:
        from distributed import Client
    except ImportError:
        remedy = "Install it: pip install 'trackroller[cluster]'."
        raise InputError(
            "--scheduler", scheduler, "", remedy, "needs the package distributed, which is missing"
        ) from None
    if scheduler != "local" and not scheduler.startswith(("tcp://", "tls://")):
        slurm = "Slurm takes a study by the workflow: snakemake -s CLONE/Snakefile --profile CLONE/profiles/slurm."
        remedy = "Write --scheduler local to use this machine."
        if scheduler.lower() == "slurm":
            remedy = slurm
        allowed = "local, or the address of a dask scheduler: tcp://host:port"
        raise InputError("--scheduler", scheduler, allowed, remedy)
    dask.config.set({"distributed.scheduler.allowed-failures": 2})
    if scheduler == "local":
        os.environ[SAFE_PATH] = "1"  # the workers inherit it
        return Client(n_workers=cores(), threads_per_worker=1, dashboard_address=None)  # type: ignore[no-untyped-call]
    try:
        return Client(scheduler, timeout="10s")  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as exc:
        wrong = f"does not answer as a dask scheduler ({exc})"
        remedy = "Start one: dask scheduler, dask worker ADDRESS."
        raise InputError("--scheduler", scheduler, "", remedy, wrong) from None


def _solve(client: Any, cases: xr.Dataset, database: Any) -> Iterator[xr.Dataset]:
    """Yield the blocks of a list; halve a batch that kills its workers until the responsible case is alone."""
    from distributed import KilledWorker, as_completed  # optional and slow to import, as dask is

    def submit(index: np.ndarray) -> Any:
        future = client.submit(solve_cases, cases.isel(case=index), database, pure=False)
        waiting[future.key] = index
        return future

    waiting: dict[str, np.ndarray] = {}
    count = cases.sizes["case"]
    size = max(8, min(2000, math.ceil(BATCH_SECONDS * rate(json.loads(cases.attrs["options"])))))
    batches = []
    if count:
        batches = np.array_split(np.arange(count), max(1, math.ceil(count / size)))
    queue = as_completed([submit(index) for index in batches])  # type: ignore[no-untyped-call]
    for future in queue:
        index = waiting.pop(future.key)
        try:
            yield future.result()
        except KilledWorker:
            if len(index) > 1:
                for half in np.array_split(index, 2):
                    queue.add(submit(half))  # type: ignore[no-untyped-call]
            else:
                yield chunks.failure(cases["case"].values[index], "killed its worker process")
        except (InputError, WorkError):
            raise
        except Exception as exc:
            raise WorkError(f"a dask worker failed: {exc}. Start again: finished cases are kept.") from exc
