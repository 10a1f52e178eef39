"""Measure error and cost of the rungs of accuracy and of the contact models: python -m validation.tradeoff FOLDER.

The folder receives `tradeoff.json` and `figures/`. With `--small`, two designs of each sample show that it runs.
With `--told`, told errors alone are measured, and with `--costs` costs alone; all other numbers are the stored ones.
"""

import json
import os
import sys
from pathlib import Path

os.environ.setdefault("NUMBA_NUM_THREADS", "1")  # processor times of one thread; numba reads it when it is loaded

from trackroller.files import write_text
from validation.benchmarks.command import plain
from validation.tradeoff.figures import draw_all
from validation.tradeoff.measure import FINEST, all_costs, measure
from validation.tradeoff.told import measure_told
from validation.tradeoff.truth import Truth

STORED = Path(__file__).resolve().parents[2] / "docs" / "data" / "tradeoff.json"

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    few = 2 if "--small" in sys.argv else 0
    if "--told" in sys.argv:
        found = json.loads(STORED.read_text(encoding="utf-8")) | {"told": measure_told(few, FINEST)}
    elif "--costs" in sys.argv:
        costs = all_costs(Truth.read().few(few or 230), few, 1 if few else 2)
        found = json.loads(STORED.read_text(encoding="utf-8")) | costs
    else:
        found = measure(few, repeats=1 if few else 2)
    draw_all(found, folder / "figures")
    write_text(folder / "tradeoff.json", json.dumps(plain(found), indent=1, allow_nan=False) + "\n")
