"""Run the command line with `python -m trackroller.cli`, and as the command `trackroller`."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from trackroller.environment import forget_working_folder

if __name__ == "__main__":
    forget_working_folder()

from trackroller.cli import ALLOW_CODE, INTERRUPTED, STOPPED
from trackroller.errors import InputError
from trackroller.files import interrupts_wait_for_files


def run() -> None:
    """Import the command line and run it; Ctrl-C during the import ends in one sentence, too."""
    try:
        if ALLOW_CODE in sys.argv:  # read before the line is parsed: the import registers the limits
            sys.argv.remove(ALLOW_CODE)
            os.environ["TRACKROLLER_ALLOW_CODE"] = str(Path("config", "limits").resolve())
        with interrupts_wait_for_files():
            from trackroller.cli.main import main  # the import takes longer than everything before it

        main()
    except InputError as error:
        print(f"trackroller: {error}", file=sys.stderr)
        raise SystemExit(2) from None
    except KeyboardInterrupt:
        print(f"trackroller: {STOPPED}", file=sys.stderr)
        raise SystemExit(INTERRUPTED) from None


if __name__ == "__main__":
    run()
