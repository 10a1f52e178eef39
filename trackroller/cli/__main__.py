"""Run the command line with `python -m trackroller.cli`, and as the command `trackroller`."""

from __future__ import annotations

import gc
import os
import sys
from pathlib import Path

from trackroller.environment import forget_working_folder, leave_out

if __name__ == "__main__":
    forget_working_folder()

from trackroller.cli import ALLOW_CODE, INTERRUPTED, STOPPED
from trackroller.errors import InputError
from trackroller.files import interrupts_wait_for_files

# Objects that are made before Python looks for circles among them. Its own 700 means that it looks
# some hundred times while the libraries are imported, which took 0.3 of 2.5 s of `trackroller
# solve`.
ALLOCATIONS = 100_000


def run() -> None:
    """Import the command line and run it; Ctrl-C during the import ends in one sentence, too."""
    gc.set_threshold(ALLOCATIONS)
    if sys.argv[1:2] == ["solve"]:
        leave_out("dask", "pint")  # xarray imports them where it can
    try:
        # read before the line is parsed: the import registers the limits
        if ALLOW_CODE in sys.argv:
            sys.argv.remove(ALLOW_CODE)
            os.environ["TRACKROLLER_ALLOW_CODE"] = str(Path("config", "limits").resolve())
        with interrupts_wait_for_files():
            # the import takes longer than everything before it
            from trackroller.cli.main import main

        main()
    except InputError as error:
        print(f"trackroller: {error}", file=sys.stderr)
        raise SystemExit(2) from None
    except KeyboardInterrupt:
        print(f"trackroller: {STOPPED}", file=sys.stderr)
        raise SystemExit(INTERRUPTED) from None


if __name__ == "__main__":
    run()
