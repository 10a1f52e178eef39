"""One thread that works on the newest request of each page; a request that a newer one replaced is
never worked on.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable
from concurrent.futures import Future
from typing import Any

STALE = {"stale": True}  # the answer to a request that a newer one of the same page replaced


class Lane:
    """A daemon thread with one waiting place for each key; the keys take turns.

    Examples
    --------
    >>> lane = Lane("example")
    >>> lane.submit("page 1", lambda: 2 + 2).result()
    4
    """

    def __init__(self, name: str) -> None:
        self._waiting: dict[Hashable, tuple[Future[Any], Callable[[], Any]]] = {}
        self._changed = threading.Condition()
        threading.Thread(target=self._work, name=name, daemon=True).start()

    def submit(self, key: Hashable, call: Callable[[], Any]) -> Future[Any]:
        """Put a call into the place of its key, and answer the call that waited there with
        `STALE`.
        """
        future: Future[Any] = Future()
        with self._changed:
            replaced = self._waiting.pop(key, None)
            self._waiting[key] = future, call
            self._changed.notify()
        if replaced is not None:
            replaced[0].set_result(STALE)
        return future

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._waiting)
                future, call = self._waiting.pop(next(iter(self._waiting)))
            try:
                future.set_result(call())
            except BaseException as exc:
                future.set_exception(exc)
