"""Run the catalogue of edge scenes, and write `extremes.json` and `figures/`: python -m validation.extremes FOLDER.

With `--small`, two scenes and a few random cases show that it runs.
"""

import json
import sys
from pathlib import Path

from trackroller.files import write_text
from validation.extremes.figures import draw_extremes
from validation.extremes.run import run
from validation.extremes.scenes import scenes

if __name__ == "__main__":
    folder, small = Path(sys.argv[1]), "--small" in sys.argv
    folder.mkdir(parents=True, exist_ok=True)
    record = run(scenes()[:2], {"sliding": 20}, points=9) if small else run(scenes())
    draw_extremes(record, folder / "figures")
    kept = {name: value for name, value in record.items() if name != "map"}  # the figure shows the map of regimes
    write_text(folder / "extremes.json", json.dumps(kept) + "\n")
