"""The command line: one module for each group of commands, and the functions that the workflow's scripts call."""

from __future__ import annotations

INTERRUPTED = 130  # exit code after Ctrl-C, as in a shell
STOPPED = (
    "stopped. The finished chunks of a study are kept, and no file is half written. Start the same command again to go "
    "on."
)
