"""Write `paper.json` and `figures/` of the published example into a folder: python -m validation.paper FOLDER."""

import json
import sys
from pathlib import Path

from trackroller.files import write_text
from validation.paper.compute import results
from validation.paper.figures import draw_all

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    draw_all(folder / "figures")
    write_text(folder / "paper.json", json.dumps(results(), indent=1) + "\n")
