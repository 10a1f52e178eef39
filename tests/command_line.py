"""Call the command line in tests: in this process, or in a new one where the test is about processes."""

from __future__ import annotations

import contextlib
import io
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from trackroller.cli.main import app, run_app

PROGRAM = [sys.executable, "-m", "trackroller.cli"]


class Done(NamedTuple):
    """What a command printed."""

    stdout: str
    stderr: str


def trackroller(*words: object, cwd: Path, code: int = 0) -> Done:
    """Run a command in a folder, in this process; require its exit code and that it shows no traceback."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.chdir(cwd), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        ended = run_app(lambda: app(list(map(str, words))))
    return _judged(ended, code, out.getvalue(), err.getvalue())


def trackroller_process(*words: object, cwd: Path, code: int = 0) -> Done:
    """Run a command in a folder as a process of its own, as a user does; require the same as `trackroller`."""
    done = subprocess.run([*PROGRAM, *map(str, words)], cwd=cwd, capture_output=True, text=True, timeout=120)
    return _judged(done.returncode, code, done.stdout, done.stderr)


def _judged(ended: int, code: int, out: str, err: str) -> Done:
    assert ended == code, err
    assert "Traceback" not in err
    return Done(out, err)
