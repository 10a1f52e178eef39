"""Write `measured.json` and `figures/` of the comparison with measurements.

    python -m validation.measured FOLDER [--small]

With `--small`, the coarsest accuracy shows that it runs.
"""

import json
import sys
from pathlib import Path

from trackroller.files import write_text
from validation.benchmarks.command import plain
from validation.measured.figures import draw_all
from validation.measured.solve import results

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    own = results("preview" if "--small" in sys.argv else "standard")
    draw_all(own, folder / "figures")
    write_text(folder / "measured.json", json.dumps(plain(own), indent=1) + "\n")
