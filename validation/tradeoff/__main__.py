"""Measure error and cost of the rungs of accuracy and of the contact models: python -m validation.tradeoff FOLDER.

The folder receives `tradeoff.json` and `figures/`. With `--small`, two designs of each sample show that it runs.
"""

import json
import os
import sys
from pathlib import Path

os.environ.setdefault("NUMBA_NUM_THREADS", "1")  # processor times of one thread; numba reads it when it is loaded

from trackroller.files import write_text
from validation.benchmarks.command import plain
from validation.tradeoff.figures import draw_all
from validation.tradeoff.measure import measure

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    found = measure(few=2, repeats=1) if "--small" in sys.argv else measure()
    draw_all(found, folder / "figures")
    write_text(folder / "tradeoff.json", json.dumps(plain(found), indent=1, allow_nan=False) + "\n")
