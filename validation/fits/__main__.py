"""Measure fits of known lines, and plans of tests: python -m validation.fits FOLDER [--small].

It writes `FOLDER/fits.json`: 500 benches a size and 200 campaigns take some twenty minutes on one core. With `--small`,
a few of each show that it runs.
"""

import json
import sys
from pathlib import Path

from trackroller.files import write_text
from validation.fits.campaigns import campaigns
from validation.fits.coverage import measure

BENCHES, CAMPAIGNS = 500, 200
FEW = 3, 2

if __name__ == "__main__":
    benches, runs = FEW if "--small" in sys.argv else (BENCHES, CAMPAIGNS)
    found = measure(benches) | {"campaigns": campaigns(runs)}
    write_text(Path(sys.argv[1]) / "fits.json", json.dumps(found, indent=1) + "\n")
