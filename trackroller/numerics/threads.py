"""Share a compiled loop over rows among threads.

Compiled functions release the interpreter lock, so plain threads use all cores. Compared with
numba's parallel loops, this compiles several times faster, and it keeps all cores busy when rows
differ in cost.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextvars import ContextVar

from trackroller.errors import InputError

_limit: ContextVar[int | None] = ContextVar("threads", default=None)


@contextlib.contextmanager
def limited_to(threads: int | None) -> Iterator[None]:
    """Use this number of threads until the context ends; None changes nothing."""
    before = _limit.set(threads or _limit.get())
    try:
        yield
    finally:
        _limit.reset(before)


def check_threads() -> None:
    """Refuse a value of NUMBA_NUM_THREADS that is no whole number above 0; numba would end with a
    traceback.
    """
    given = os.environ.get("NUMBA_NUM_THREADS", "1")
    if not given.isdecimal() or int(given) < 1:
        raise InputError(
            "NUMBA_NUM_THREADS",
            given,
            "a whole number above 0",
            "Correct the environment variable.",
        )


def thread_count() -> int:
    """Return the number of threads: that of `limited_to`, NUMBA_NUM_THREADS if set, or the cores of
    the machine.
    """
    return _limit.get() or int(os.environ.get("NUMBA_NUM_THREADS", 0)) or os.cpu_count() or 1


def share_rows(
    work: Callable[[int, int], object], rows: int, smallest: int, largest: int | None = None
) -> None:
    """Call a function for pieces of all rows, on all threads.

    Parameters
    ----------
    work : callable
        Function `work(first, last)` that treats the rows first to last - 1.
    rows : int
        Number of rows.
    smallest, largest : int
        Limits of the number of rows in a piece; default: no upper limit.
    """
    if rows <= smallest:  # to count the threads takes longer than a call for a few rows
        if rows:
            work(0, rows)
        return
    threads = thread_count()
    size = max(smallest, -(-rows // (8 * threads))) if threads > 1 else rows
    size = size if largest is None else min(size, largest)
    pieces = [(i, min(i + size, rows)) for i in range(0, rows, max(size, 1))]
    if threads == 1 or len(pieces) < 2:
        for first, last in pieces:
            work(first, last)
        return
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(lambda piece: work(*piece), pieces))
