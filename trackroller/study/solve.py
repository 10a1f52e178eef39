"""Solving a chunk: block by block, each kept on the disk, a case that raises kept as a failed row."""

from __future__ import annotations

import contextlib
import logging
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from trackroller.errors import InputError, ShapeError
from trackroller.study import store
from trackroller.study.caselists import CaseList, load_list
from trackroller.study.files import StudyFolder, WorkError, link_or_copy, locked
from trackroller.study.identity import fingerprints
from trackroller.study.mend import Tell
from trackroller.study.plan import keep, read_parts
from trackroller.study.sources import solver_digest

log = logging.getLogger("trackroller")
BLOCK_SECONDS = 3.0  # at most so much work is lost when a process is killed
SMALLEST_BLOCK, LARGEST_BLOCK = 16, 8192
Solver = Callable[..., Any]


def solve_rows(cases: CaseList, index: np.ndarray, database: Any, solver: Solver | None = None) -> store.Block:
    """Solve the rows `index` of a list.

    When the solver raises, the rows are halved until the case that does so stands alone; it becomes a row
    with regime failed and the exception as its reason. `InputError` (options that cannot be) goes on; `ShapeError`
    is a case's own.
    """
    if solver is None:
        from trackroller.roller.solver import solve

        solver = solve
    started = time.perf_counter()
    blocks: list[store.Block] = []
    pending = [index]
    while pending:
        rows = pending.pop()
        try:
            dataset = solver(cases.design(rows), database=database, **cases.options)
            blocks.append(store.from_dataset(dataset, cases.cases[rows]))
            if cases.options.get("normal") == "halfspace":
                _explain_shapes(blocks[-1], cases, rows, lambda one: solver(one, database=database, **cases.options))
        except Exception as exc:
            if isinstance(exc, (InputError, WorkError)) and not isinstance(exc, ShapeError):
                raise
            if len(rows) > 1:
                half = len(rows) // 2
                pending += [rows[half:], rows[:half]]
            else:
                blocks.append(store.failure(cases.cases[rows], _reason(exc)))
    block = store.concatenate(blocks)
    block.seconds = time.perf_counter() - started
    return block


def _reason(exc: Exception) -> str:
    told = str(exc).splitlines()[0] if str(exc) else "no message"
    return told[:300] if isinstance(exc, ShapeError) else f"{type(exc).__name__}: {told}"[:200]


def _explain_shapes(block: store.Block, cases: CaseList, rows: np.ndarray, solve: Callable[[Any], Any]) -> None:
    """Beside others, a case whose shapes cannot touch is just a failed row; alone it says why."""
    if len(rows) < 2:
        return
    for i in np.flatnonzero(block.failed):
        try:
            solve(cases.design(rows[i : i + 1]))
        except ShapeError as exc:
            block.reasons[block.cases[i].decode()] = _reason(exc)


def check_identity(cases: CaseList, database: Any) -> None:
    """The materials must still be those of the plan."""
    from trackroller.roller.case import to_table

    if (fingerprints(to_table(cases.design(), database), cases.options) != cases.cases).any():
        raise WorkError(
            f"chunk {cases.name}: the materials or the solver changed after the study was planned. "
            "Start the run again: it plans anew."
        )


def missing_rows(cases: CaseList, blocks: list[store.Block]) -> np.ndarray:
    """Rows of a list that stand in no finished block."""
    if not blocks:
        return np.arange(len(cases.cases))
    return np.flatnonzero(~np.isin(cases.cases, np.concatenate([b.cases for b in blocks])))


def finish(folder: StudyFolder, cases: CaseList, blocks: list[store.Block]) -> store.Block:
    """Put the blocks of a chunk in the order of its list and keep the chunk."""
    block = store.concatenate(blocks)
    _, first = np.unique(block.cases, return_index=True)
    block = block.take(np.sort(first))
    where = {case: i for i, case in enumerate(block.cases.tolist())}
    block = block.take(np.array([where[case] for case in cases.cases.tolist()]))
    block.attrs["solver_digest"] = solver_digest()
    keep(folder, cases.name, block)
    return block


def solved(folder: StudyFolder, name: str, tell: Tell) -> bool:
    """Is the chunk finished? If only one of its two names is there, the other is made again."""
    kept, shown = folder.kept(name), folder.chunk(name)
    if not kept.is_file():
        return False
    if not shown.is_file():
        try:
            store.read_chunk(kept)
        except store.CorruptFile as exc:
            tell(f"corrupt chunk, its cases are solved again: {exc}")
            kept.unlink(missing_ok=True)
            return False
        link_or_copy(kept, shown)
    return True


def write_part(folder: StudyFolder, name: str, block: store.Block) -> None:
    """Keep a finished block of an unfinished chunk."""
    store.write(folder.parts(name) / f"{block.cases[0].decode()}.nc", block)


def solve_chunk(
    folder: StudyFolder,
    name: str,
    database: Any = None,
    *,
    tell: Tell | None = None,
    progress: Callable[[int], None] | None = None,
    solver: Solver | None = None,
) -> str:
    """Solve what is missing of a chunk and keep it.

    `progress` is called with the number of cases after each block. Returns one line that sums it up.
    """
    tell = tell or log.warning
    with locked(folder.lock(name), tell):
        if solved(folder, name, tell):
            return f"chunk {name}: already solved"
        cases = load_list(folder, name)
        check_identity(cases, database)
        blocks = read_parts(folder, name, tell)
        rows = missing_rows(cases, blocks)
        started = time.perf_counter()
        for index in _blocks(rows):
            block = solve_rows(cases, index, database, solver)
            write_part(folder, name, block)
            blocks.append(block)
            if progress is not None:
                progress(len(index))
        chunk = finish(folder, cases, blocks)
    with contextlib.suppress(OSError):
        folder.lock(name).unlink()
    spent = time.perf_counter() - started
    speed = f", {len(rows) / spent:.0f} cases/s" if spent > 0 and len(rows) else ""
    return (
        f"chunk {name}: {len(cases.cases)} cases, {len(rows)} solved now in {spent:.1f} s{speed}, "
        f"{int(chunk.failed.sum())} failed"
    )


def _blocks(rows: np.ndarray) -> Iterator[np.ndarray]:
    """Pieces of rows whose size follows the time they take."""
    start, size = 0, min(64, max(SMALLEST_BLOCK, len(rows)))
    while start < len(rows):
        begun = time.perf_counter()
        yield rows[start : start + size]
        start += size
        spent = max(time.perf_counter() - begun, 1e-3)
        wanted = int(size * min(4.0, BLOCK_SECONDS / spent))
        size = min(max(wanted, SMALLEST_BLOCK), LARGEST_BLOCK)


def forget_failed(folder: StudyFolder, chunks: list[str], tell: Tell) -> int:
    """Take failed cases out of finished chunks, so that the next run solves just those; returns how many."""
    count = 0
    for name in chunks:
        if not folder.kept(name).is_file():
            continue
        with locked(folder.lock(name), tell):
            block = store.read_chunk(folder.kept(name))
            failed = block.failed
            if not failed.any():
                continue
            count += int(failed.sum())
            if not failed.all():
                write_part(folder, name, block.take(np.flatnonzero(~failed)))
            folder.chunk(name).unlink(missing_ok=True)
            folder.kept(name).unlink(missing_ok=True)
    return count
