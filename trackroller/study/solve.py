"""Solve the missing cases of a chunk. Every runner calls `solve_chunk`; runners differ in where cases are solved."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.errors import InputError, ShapeError
from trackroller.roller.case import to_table
from trackroller.study import store
from trackroller.study.caselists import CaseList, list_is_gone, load_list
from trackroller.study.files import StudyFolder, Tell, WorkError, locked
from trackroller.study.identity import fingerprints

log = logging.getLogger("trackroller")
BLOCK_SECONDS = 3.0  # a killed process loses at most the block that it works on
SMALLEST_BLOCK, LARGEST_BLOCK = 16, 8192
Solver = Callable[..., Any]
Executor = Callable[[CaseList, Any], Iterator[store.Block]]  # solves the cases of a list, block by block


def solve_cases(cases: CaseList, database: Any, solver: Solver | None = None) -> store.Block:
    """Solve the cases of a list and return their results as one block.

    If the solver raises, the list is halved until the responsible case is alone. That case becomes a row with
    regime failed and the exception as its reason.

    Parameters
    ----------
    cases : CaseList
        The n cases.
    database : MaterialDatabase or None
        The materials; None takes the built-in ones and the user's.
    solver : callable, optional
        Replaces `trackroller.solve`.

    Returns
    -------
    store.Block
        Results of the n cases.

    Raises
    ------
    InputError
        If an option is wrong for all cases. A `ShapeError` concerns one case only and becomes a failed row.
    """
    if solver is None:
        from trackroller.roller.solver import solve  # numba compiles on import; planning needs no solver

        solver = solve
    started = time.perf_counter()
    blocks: list[store.Block] = []
    pending = [cases]
    while pending:
        part = pending.pop()
        try:
            block = store.from_dataset(solver(part.design(), database=database, **part.options), part.cases)
            if part.options.get("normal") == "halfspace" and len(part.cases) > 1:
                for i in np.flatnonzero(block.failed):  # among others, the solver does not say which shapes are wrong
                    block.reasons |= solve_cases(part.take(np.array([i])), database, solver).reasons
            blocks.append(block)
        except Exception as exc:
            if isinstance(exc, (InputError, WorkError)) and not isinstance(exc, ShapeError):
                raise
            if len(part.cases) > 1:
                pending += [part.take(rows) for rows in np.array_split(np.arange(len(part.cases)), 2)[::-1]]
            else:
                blocks.append(store.failure(part.cases, _reason(exc)))
    block = store.concatenate(blocks)
    block.seconds = time.perf_counter() - started
    return block


def _reason(exc: Exception) -> str:
    text = str(exc).splitlines()[0] if str(exc) else "no message"
    return text[:300] if isinstance(exc, ShapeError) else f"{type(exc).__name__}: {text}"[:200]


def solve_here(cases: CaseList, database: Any, solver: Solver | None = None) -> Iterator[store.Block]:
    """Solve cases in this process, in blocks of about `BLOCK_SECONDS`."""
    start, size = 0, 64
    while start < len(cases.cases):
        rows = np.arange(start, min(start + size, len(cases.cases)))
        begun = time.perf_counter()
        yield solve_cases(cases.take(rows), database, solver)
        start += size
        spent = max(time.perf_counter() - begun, 1e-3)
        size = min(max(int(size * min(4.0, BLOCK_SECONDS / spent)), SMALLEST_BLOCK), LARGEST_BLOCK)


def solve_chunk(
    folder: StudyFolder,
    name: str,
    database: Any = None,
    *,
    executor: Executor = solve_here,
    tell: Tell = log.warning,
    progress: Callable[[int], None] | None = None,
) -> str:
    """Solve the missing cases of a chunk and write its file.

    Each finished block is written at once, so that a killed process loses only the blocks in work.

    Parameters
    ----------
    folder : StudyFolder
        Files of the study.
    name : str
        Name of the chunk.
    database : MaterialDatabase, optional
        The materials; the built-in ones and the user's by default.
    executor : callable
        Solves the cases of a list and yields blocks: `solve_here`, or the dask workers of `cluster`.
    tell : callable
        Receives one line for each event that the user should read.
    progress : callable, optional
        Receives the number of cases that were solved earlier, and that of each finished block.

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
        with locked(folder.lock, shared=True), locked(folder.case_list(name), tell=tell):
            if folder.chunk(name).is_file():
                folder.mark(name).touch()
                return f"chunk {name}: already solved"
            cases = load_list(folder, name)
            _check_identity(cases, database)
            corrupt: dict[Path, str] = {}
            blocks = [block for _, block in store.read_sound(folder.parts(name), corrupt)]
            store.remove_corrupt(corrupt, tell)
            finished = np.concatenate([np.empty(0, dtype="S32"), *(block.cases for block in blocks)])
            missing = cases.take(np.flatnonzero(~np.isin(cases.cases, finished)))
            if progress is not None:
                progress(len(finished))
            started = time.perf_counter()
            for block in executor(missing, database):
                store.write_part(folder, name, block)
                blocks.append(block)
                if progress is not None:
                    progress(len(block.cases))
            spent = time.perf_counter() - started
            return _summary(_complete(folder, cases, blocks), name, len(missing.cases), spent)
    except FileNotFoundError:
        raise list_is_gone(folder, name) from None


def _summary(chunk: store.Block, name: str, count: int, spent: float) -> str:
    speed = f", {count / spent:.0f} cases/s" if spent > 0 and count else ""
    now = f"{count} solved now in {spent:.1f} s{speed}"
    return f"chunk {name}: {len(chunk.cases)} cases, {now}, {int(chunk.failed.sum())} failed"


def _check_identity(cases: CaseList, database: Any) -> None:
    """Raise `WorkError` unless the materials and the solver are those of the plan."""
    if (fingerprints(to_table(cases.design(), database), cases.options) != cases.cases).any():
        raise WorkError(
            f"chunk {cases.name}: the materials or the solver changed after the study was planned. "
            "Start the run again: it plans anew."
        )


def _complete(folder: StudyFolder, cases: CaseList, blocks: list[store.Block]) -> store.Block:
    """Write the blocks of a chunk in the order of its list, and remove the parts."""
    block = store.concatenate(blocks)
    ascending = np.argsort(block.cases, kind="stable")
    block = block.take(ascending[np.searchsorted(block.cases[ascending], cases.cases)])
    store.write(folder.chunk(cases.name), block)
    folder.mark(cases.name).touch()
    for path in folder.parts(cases.name):
        path.unlink(missing_ok=True)
    return block
