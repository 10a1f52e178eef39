"""Run one study in a process of its own, which outlives the page and its server.

`python -m trackroller.app.worker NAME` solves `studies/NAME.yaml` in the working directory and
makes its report. It holds the lock `results/NAME/.page.lock` as long as it lives, writes how far it
is into `results/NAME/.page.json`, and stops as at Ctrl-C once the file `results/NAME/.pause` is
there.
"""

from __future__ import annotations

import _thread
import json
import signal
import sys
import threading
import time
import traceback
from pathlib import Path
from typing import Any

from trackroller.errors import InputError, WorkError
from trackroller.files import (
    confine,
    interrupts_wait_for_files,
    refuse_links,
    try_lock,
    wait_for_lock,
)
from trackroller.study.store.folder import StudyFolder
from trackroller.study.store.manifest import Manifest
from trackroller.study.store.put import claim, put_unlisted

LOCK = ".page.lock"
PROGRESS = ".page.json"
PAUSE = ".pause"
TICK = 0.4  # seconds between two looks for the wish to pause, and between two records of progress


class Progress:
    """How far a study is, kept in a file for the page."""

    def __init__(self, root: Path) -> None:
        self.file = claim(root / PROGRESS)
        self.record: dict[str, Any] = {}
        self.written = 0.0

    def say(self, at_once: bool = True, **facts: Any) -> None:
        """Add facts to the record, and write it at once or if the last record is old."""
        self.record |= facts
        if at_once or time.monotonic() - self.written > TICK:
            put_unlisted(
                self.file,
                lambda beside: beside.write_text(json.dumps(self.record), encoding="utf-8"),
            )
            self.written = time.monotonic()

    def started(self, total: int, done: int) -> None:
        """Record the number of cases, and how many were solved before."""
        self.say(total=total, done=done, step="solving")

    def advanced(self, count: int, failed: int) -> None:
        """Record solved cases, of which some failed."""
        self.say(
            at_once=False, done=self.record["done"] + count, failed=self.record["failed"] + failed
        )


def is_held(path: Path) -> bool:
    """Return whether another process holds the lock of a file."""
    if not path.is_file():
        return False
    with open(path, "rb+") as stream:
        return not try_lock(stream)


def _watch(pause: Path) -> None:
    """Interrupt the main thread once the file that asks for a pause is there."""
    while not pause.exists():
        time.sleep(TICK)
    Manifest(pause.parent).unlink([pause])
    _thread.interrupt_main()


def run(name: str) -> None:
    """Solve a study, and make its report and its explorer.

    Parameters
    ----------
    name : str
        Name of the study, whose file is `studies/NAME.yaml`.
    """
    root = Path("results", name)
    refuse_links(root, "results")
    StudyFolder(root).create()
    with open(root / LOCK, "ab") as lock:
        wait_for_lock(lock)  # a look at the lock holds it for a moment
        progress = Progress(root)
        progress.say(step="starting", error="")
        threading.Thread(target=_watch, args=(root / PAUSE,), daemon=True).start()
        try:
            with interrupts_wait_for_files():
                _work(name, progress)
        except KeyboardInterrupt:
            progress.say(step="paused")
        except (InputError, WorkError) as exc:
            progress.say(step="stopped", error=str(exc))
        except Exception as exc:
            traceback.print_exc()
            progress.say(
                step="stopped",
                error=f"internal error, {type(exc).__name__}; see {root / 'page.log'}",
            )


def _work(name: str, progress: Progress) -> None:
    # heavy: SALib; the page shows "starting" meanwhile
    from trackroller.report.build import build_report
    from trackroller.report.explorer.page import write_explorer
    from trackroller.results.run import run_any  # heavy: analysis
    from trackroller.results.stored_study import open_study
    from trackroller.study.status import find_study, status_of

    study, folder = find_study(f"studies/{name}.yaml")
    progress.say(failed=status_of(study, folder).failed)  # in the chunks that an earlier run solved
    ledger = run_any(study, started=progress.started, progress=progress.advanced)
    status = status_of(study, folder)
    progress.say(
        step="making the report", total=status.total, done=status.done, failed=status.failed
    )
    build_report(ledger.folder, lambda line: progress.say(step=line))
    progress.say(step="making the explorer")
    write_explorer(open_study(ledger.folder.root), ledger.folder.root / "explorer.html")
    progress.say(step="done")


if __name__ == "__main__":
    # a shell may start the server with SIGINT ignored
    signal.signal(signal.SIGINT, signal.default_int_handler)
    confine(Path.cwd())
    run(sys.argv[1])
