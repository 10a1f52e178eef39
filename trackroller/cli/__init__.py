"""The command line: one module for each group of commands, and the functions that the workflow's
scripts call.
"""

from __future__ import annotations

import os
import sys
from types import TracebackType

# The last digits of a sum depend on how many threads share it. Snakemake gives each job one thread
# of the linear algebra library, and a command takes one as well, so that both write the same bits.
# This stands before NumPy's import.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

ALLOW_CODE = "--allow-code"  # loads the limits of config/limits
INTERRUPTED = 130  # exit code after Ctrl-C, as in a shell
STOPPED = (
    "stopped. The finished chunks of a study are kept, and no file is half written. Start "
    "the same command again to go "
    "on."
)


def tell_stopped(
    kind: type[BaseException], error: BaseException, trace: TracebackType | None
) -> None:
    """Print one sentence where Ctrl-C comes before the command line is imported, any other error
    with its traceback.
    """
    if issubclass(kind, KeyboardInterrupt):
        print(f"trackroller: {STOPPED}", file=sys.stderr)
    else:
        sys.__excepthook__(kind, error, trace)


sys.excepthook = tell_stopped
