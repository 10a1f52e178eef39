"""Solve cases on dask workers: workers receive batches of cases and return blocks; only this
process writes files.
"""

from __future__ import annotations

import contextlib
import json
import logging
import math
import os
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from trackroller.environment import SAFE_PATH, take_in
from trackroller.errors import InputError, WorkError
from trackroller.files import cores
from trackroller.study.cost import rate
from trackroller.study.solve_chunk import Executor, solve_cases
from trackroller.study.store import chunks
from trackroller.study.store.folder import Tell, unheard

BATCH_SECONDS = 2.0
PATIENCE = 30.0  # seconds in which a scheduler must answer; a loaded machine took more than 10
_HOST_AND_PORT = r"(\[[0-9a-fA-F:.]+\]|[^\s:/\[\]]+):[0-9]{1,5}"
_START = "Start one: dask scheduler, then dask worker ADDRESS with the address that it prints."


@contextlib.contextmanager
def workers(scheduler: str, tell: Tell = unheard) -> Iterator[Executor]:
    """Connect to dask workers.

    Parameters
    ----------
    scheduler : str
        'local' starts one process for each processor of this machine; 'tcp://host:port' names a
        running scheduler.
    tell : callable
        Receives one line if the scheduler has no worker yet.

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
        if not client.scheduler_info()["workers"]:
            tell(f"{scheduler} has no worker yet; the run waits for one: dask worker {scheduler}")
        yield lambda cases, database: _solve(client, cases, database)


def _client(scheduler: str) -> Any:
    take_in("dask")
    try:
        import dask  # slow to import
        from distributed import Client
    except ImportError:
        wrong = "needs the packages dask and distributed, of which one is missing"
        remedy = (
            "Install them: pip install 'trackroller[cluster]'. Without --scheduler, this "
            "process solves."
        )
        raise InputError("--scheduler", scheduler, "", remedy, wrong) from None
    _check_address(scheduler)
    dask.config.set({"distributed.scheduler.allowed-failures": 2})
    # the sentence of an error says it
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    if scheduler == "local":
        os.environ[SAFE_PATH] = "1"  # the workers inherit it
        return Client(n_workers=cores(), threads_per_worker=1, dashboard_address=None)  # type: ignore[no-untyped-call]
    try:
        return Client(scheduler, timeout=PATIENCE)  # type: ignore[no-untyped-call]
    except (OSError, ValueError, TypeError) as exc:
        # a TypeError: tls without a certificate in dask's settings
        wrong = f"does not answer as a dask scheduler ({exc})"
        raise InputError("--scheduler", scheduler, "", _START, wrong) from None


def _check_address(scheduler: str) -> None:
    """Refuse what is neither 'local' nor the address of a scheduler."""
    if scheduler == "local" or re.fullmatch(f"(tcp|tls)://{_HOST_AND_PORT}", scheduler):
        return
    if scheduler.lower() == "slurm":
        remedy = (
            "Slurm takes a study by the workflow: snakemake -s CLONE/Snakefile --profile "
            "CLONE/profiles/slurm."
        )
    elif re.fullmatch(_HOST_AND_PORT, scheduler):
        remedy = f"Write --scheduler tcp://{scheduler}."
    else:
        remedy = "Write --scheduler local to use this machine."
    allowed = "local, or the address of a dask scheduler: tcp://host:port"
    raise InputError("--scheduler", scheduler, allowed, remedy)


def _solve(client: Any, cases: xr.Dataset, database: Any) -> Iterator[xr.Dataset]:
    """Yield the blocks of a list; halve a batch that kills its workers until the responsible case
    is alone.
    """
    from distributed import KilledWorker, as_completed  # optional and slow to import, as dask is
    from distributed.client import FutureCancelledError

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
        except FutureCancelledError as exc:
            raise WorkError(
                f"the dask scheduler does not answer any more. {_START} Then start again: every "
                "finished case is kept."
            ) from exc
        except (InputError, WorkError):
            raise
        except Exception as exc:
            raise WorkError(
                f"a dask worker failed: {exc}. Start again: finished cases are kept."
            ) from exc
