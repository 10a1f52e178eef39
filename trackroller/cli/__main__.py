"""Run the command line with `python -m trackroller.cli`, and as the command `trackroller`."""

from __future__ import annotations

import sys

from trackroller.cli import INTERRUPTED, STOPPED


def run() -> None:
    """Import the command line and run it; Ctrl-C during the import ends in one sentence, too."""
    try:
        from trackroller.cli.main import main  # the import takes longer than everything before it

        main()
    except KeyboardInterrupt:
        print(f"trackroller: {STOPPED}", file=sys.stderr)
        raise SystemExit(INTERRUPTED) from None


if __name__ == "__main__":
    run()
