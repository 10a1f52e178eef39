"""Shares a compiled loop over rows among threads.

Compiled functions release the interpreter lock, so plain threads use all cores; this compiles several times faster
than numba's own parallel loops and keeps the cores busy when rows differ in cost.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor


def thread_count() -> int:
    """NUMBA_NUM_THREADS if set, else the cores of the machine."""
    return int(os.environ.get("NUMBA_NUM_THREADS", 0)) or os.cpu_count() or 1


def share_rows(work: Callable[[int, int], object], rows: int, smallest: int, largest: int | None = None) -> None:
    """Calls `work(first, last)` for pieces of `rows` rows, between `smallest` and `largest` long, on all threads."""
    threads = thread_count()
    size = max(smallest, -(-rows // (8 * threads)))
    size = size if largest is None else min(size, largest)
    pieces = [(i, min(i + size, rows)) for i in range(0, rows, size)]
    if threads == 1 or len(pieces) < 2:
        for first, last in pieces:
            work(first, last)
        return
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(lambda piece: work(*piece), pieces))
