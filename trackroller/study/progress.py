"""Show on a terminal how many cases of a study are solved, how fast, the time left, and the steps
of a report.
"""

from __future__ import annotations

import contextlib
import logging
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeRemainingColumn,
)
from rich.status import Status

_COLUMNS = (
    TextColumn("{task.description}"),
    BarColumn(),
    MofNCompleteColumn(),
    TextColumn("{task.fields[rate]} cases/s, left"),
    TimeRemainingColumn(),
    TextColumn("{task.fields[failed]}"),
)


@dataclass
class Bar:
    """A progress bar with the functions that a run of a study calls."""

    shown: Progress
    task: TaskID
    failed: int = 0

    def started(self, total: int, done: int) -> None:
        """Set the number of cases, and how many of them were solved before."""
        self.shown.update(self.task, total=total, completed=done)

    def advanced(self, count: int, failed: int) -> None:
        """Add solved cases, of which some failed; a search solves more than its budget: polish and
        checks.
        """
        self.shown.advance(self.task, count)
        bar = self.shown.tasks[0]
        if bar.total is not None and bar.completed > bar.total:
            self.shown.update(self.task, total=bar.completed)
        self.failed += failed
        if self.failed:
            self.shown.update(self.task, failed=f"{self.failed} failed")
        self.shown.update(self.task, rate=f"{self.shown.tasks[0].speed or 0:.0f}")

    def tell(self, line: str) -> None:
        """Print a line above the bar."""
        self.shown.console.print(line, highlight=False, markup=False)


@contextlib.contextmanager
def progress_bar(name: str, shown: bool = True) -> Iterator[Bar]:
    """Show a progress bar on standard error until the context ends.

    Parameters
    ----------
    name : str
        Name of the study.
    shown : bool
        Whether to show the bar. Lines of `Bar.tell` are printed anyway.
    """
    console = Console(file=sys.stderr, soft_wrap=True)
    with Progress(
        *_COLUMNS, console=console, disable=not shown, speed_estimate_period=120
    ) as progress:
        yield Bar(progress, progress.add_task(name, total=None, rate="-", failed=""))


class _Last(logging.Handler):
    """Shows the newest log line in the last line of a terminal."""

    def __init__(self, shown: Status) -> None:
        super().__init__(logging.INFO)
        self.shown = shown

    def emit(self, record: logging.LogRecord) -> None:
        self.shown.update(record.getMessage())


@contextlib.contextmanager
def shown_steps() -> Iterator[Callable[[str], None]]:
    """Show what an analysis or report works on in the last line of a terminal, until the context
    ends.

    Yields
    ------
    callable
        Prints a line on standard error, also without a terminal.
    """
    console = Console(file=sys.stderr, soft_wrap=True)
    log = logging.getLogger("trackroller")
    level = log.level
    with console.status("") as shown:
        handler = _Last(shown)
        log.addHandler(handler)
        log.setLevel(logging.INFO)
        try:
            yield lambda line: console.print(line, highlight=False, markup=False)
        finally:
            log.setLevel(level)
            log.removeHandler(handler)
