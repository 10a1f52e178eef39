"""Write `measured.json`, `figures/` and our entry in the benchmark, `entry.csv`.

    python -m validation.measured FOLDER [--small]

With `--small`, the coarsest accuracy shows that it runs.
"""

import json
import sys
from pathlib import Path

from trackroller.files import write_text
from validation.benchmarks.command import plain
from validation.measured.benchmark.entry import write_entry
from validation.measured.figures import draw_all
from validation.measured.solve import results

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    accuracy = "preview" if "--small" in sys.argv else "standard"
    own = results(accuracy)
    draw_all(own, folder / "figures")
    write_entry(folder / "entry.csv", accuracy)
    write_text(folder / "measured.json", json.dumps(plain(own), indent=1) + "\n")
