"""Solve the cases of a chunk. Every runner calls `solve_chunk`; runners differ in where cases are
solved.
"""

from __future__ import annotations

import json
import logging
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError, ShapeError, WorkError
from trackroller.files import Reads, locked
from trackroller.materials import MaterialDatabase, load_database
from trackroller.study.store import chunks
from trackroller.study.store.fingerprint import solver_and_materials
from trackroller.study.store.folder import Count, StudyFolder, Tell, unheard
from trackroller.study.store.input_files import check_inputs

log = logging.getLogger("trackroller")
BLOCK_SECONDS = 3.0  # between two steps of the progress bar
FIRST_BLOCK = 64
SMALLEST_BLOCK = 16
LARGEST_BLOCK = 8192
Solver = Callable[..., Any]
# solves the cases of a list, block by block
Executor = Callable[[xr.Dataset, Any], Iterator[xr.Dataset]]


def load_cases(folder: StudyFolder, name: str) -> xr.Dataset:
    """Return the cases of a chunk with all fields along `case`; raise `chunks.CorruptFile` if the
    list is damaged.
    """
    cases = chunks.read(folder.case_list(name))
    number = cases["case"]

    def along_case(column: xr.DataArray) -> xr.DataArray:
        if column.dims:
            return column
        return column.broadcast_like(number)

    # a new data set, which dask can send: that of the file holds its handle
    return cases.map(along_case)


def solve_cases(
    cases: xr.Dataset, database: MaterialDatabase | None, solver: Solver | None = None
) -> xr.Dataset:
    """Solve cases and return their results as one block.

    If the solver raises, the cases are halved until the responsible case is alone. That case
    becomes a row with regime failed and the exception as its reason.

    Parameters
    ----------
    cases : xarray.Dataset
        Case fields along `case`, whose coordinate holds the fingerprints. The attribute `options`
        (JSON) has the keyword arguments of `solve`.
    database : MaterialDatabase or None
        The materials; None takes the built-in ones and the user's.
    solver : callable, optional
        Replaces `trackroller.solve`.

    Returns
    -------
    xarray.Dataset
        Results of the cases, with the `seconds` of processor time that solving took as attribute.

    Raises
    ------
    InputError
        If an option is wrong for all cases. A `ShapeError` concerns one case only and becomes a
        failed row.
    """
    if solver is None:
        # numba compiles on import; planning needs no solver
        from trackroller.roller.solver import solve

        solver = solve
    started = time.process_time()
    options = json.loads(cases.attrs["options"])
    blocks: list[xr.Dataset] = []
    pending = [cases]
    while pending:
        part = pending.pop()
        names = part["case"].values
        try:
            block = chunks.from_results(solver(part, database=database, **options), names)
            if options.get("normal") == "halfspace" and len(names) > 1:
                for i in np.flatnonzero(block["regime"] == chunks.FAILED):
                    # the reason why a shape is wrong is known only if the case is solved alone
                    block["reason"][i] = solve_cases(part.isel(case=[i]), database, solver)[
                        "reason"
                    ].values[0]
            blocks.append(block)
        except Exception as exc:
            if isinstance(exc, (InputError, WorkError)) and not isinstance(exc, ShapeError):
                raise
            if len(names) > 1:
                pending += [
                    part.isel(case=rows) for rows in np.array_split(np.arange(len(names)), 2)[::-1]
                ]
            else:
                blocks.append(chunks.failure(names, _reason(exc)))
    return chunks.join(blocks).assign_attrs(seconds=time.process_time() - started)


def _reason(exc: Exception) -> str:
    text = "no message"
    if str(exc):
        text = str(exc).splitlines()[0]
    if isinstance(exc, ShapeError):
        return text[:300]
    return f"{type(exc).__name__}: {text}"[:200]


@dataclass
class LocalExecutor:
    """Solves lists of cases in this process, in blocks of about `BLOCK_SECONDS`.

    A list begins with the size of block at which the list before it has ended.

    Parameters
    ----------
    solver : callable, optional
        Replaces `trackroller.solve`.
    """

    solver: Solver | None = None
    size: int = FIRST_BLOCK

    def __call__(
        self, cases: xr.Dataset, database: MaterialDatabase | None
    ) -> Iterator[xr.Dataset]:
        """Yield the solved blocks of a list of cases."""
        start = 0
        while start < cases.sizes["case"]:
            begun = time.perf_counter()
            block = cases.isel(case=slice(start, start + self.size))
            solved = solve_cases(block, database, self.solver)
            spent = max(time.perf_counter() - begun, 1e-3)
            start += self.size
            count = block.sizes["case"]
            enough = int(count * min(4.0, BLOCK_SECONDS / spent))
            if count == self.size or enough < self.size:
                self.size = min(max(enough, SMALLEST_BLOCK), LARGEST_BLOCK)
            yield solved


def solve_chunk(
    folder: StudyFolder,
    name: str,
    database: MaterialDatabase | None = None,
    *,
    executor: Executor | None = None,
    tell: Tell = log.warning,
    progress: Count = unheard,
    inputs: Reads | None = None,
) -> str:
    """Solve the cases of a chunk and write its file. A killed process loses the chunk that it works
    on.

    Parameters
    ----------
    folder : StudyFolder
        Files of the study.
    name : str
        Name of the chunk.
    database : MaterialDatabase, optional
        The materials; the built-in ones and the user's by default.
    executor : callable
        Solves the cases of a list and yields blocks: a `LocalExecutor` (default), or the dask
        workers of `cluster`.
    tell : callable
        Receives one line for each event that the user should read.
    progress : callable
        Receives the number of cases of each finished block, and how many of them failed.
    inputs : dict, optional
        Kind and digest of each file that the study was made from, by its path: none may have been
        edited.

    Returns
    -------
    str
        One line that sums up the work.

    Raises
    ------
    WorkError
        If the chunk is no longer planned, the materials have changed, or a file cannot be written.
    """
    try:
        with locked(folder.lock, shared=True), locked(folder.chunk_lock(name), tell=tell):
            if folder.chunk(name).is_file():
                folder.mark(name).touch()
                return f"chunk {name}: already solved"
            cases = load_cases(folder, name)
            check_inputs(folder, inputs or {})
            _check_unchanged(folder, cases, database)
            started = time.perf_counter()
            blocks = []
            for block in (executor or LocalExecutor())(cases, database):
                blocks.append(block)
                progress(*chunks.counts(block))
            spent = time.perf_counter() - started
            chunk = chunks.join(blocks).sel(case=cases["case"].values)
            chunks.write(folder.chunk(name), chunk, packed=True)
            folder.mark(name).touch()
            return _summary(chunk, cases.attrs.get("words", f"chunk {name}"), spent)
    except FileNotFoundError:
        why = "is missing: the study was edited and planned anew by another process"
        raise WorkError(
            f"{folder.case_list(name)} {why}. Start again: every finished case is kept."
        ) from None
    except chunks.CorruptFile as exc:
        raise WorkError(
            f"corrupt case list: {exc}. Start again: its cases are planned anew."
        ) from None


def _summary(chunk: xr.Dataset, words: str, spent: float) -> str:
    count, failed = chunks.counts(chunk)
    if count == 1:
        solved = f"{count} case"
    else:
        solved = f"{count} cases"
    return (
        f"{words}: {solved} solved in {spent:.1f} s, {count / max(spent, 1e-3):.0f} cases/s, "
        f"{failed} failed"
    )


def _check_unchanged(
    folder: StudyFolder, cases: xr.Dataset, database: MaterialDatabase | None
) -> None:
    """Raise `WorkError` unless the materials and the solver are those of the plan."""
    if database is None:
        database = load_database()
    if cases.attrs["identity"] != solver_and_materials(database):
        raise WorkError(
            f"{folder.root}: the materials or the solver changed after the study was planned. "
            "Start the run again: it "
            "plans anew, and the cases that did not change are kept."
        )
