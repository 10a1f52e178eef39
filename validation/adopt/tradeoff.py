"""Copy results/tradeoff: ladders into the package; page, data and figures into the docs.

    python -m validation.adopt.tradeoff [results/tradeoff]

The presets follow from the ladders, so numbers of solutions may change: run the tests. Studies solve their cases anew
by themselves, because the file of ladders is part of the solver's digest.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

from trackroller.roller import accuracy
from validation.adopt.common import DATA, FOLDER, copy_figures

LADDERS = Path(accuracy.__file__).with_name("accuracy.json")


def adopt(results: Path) -> None:
    """Copy what the measurement found; the pages are made anew in a process that reads the new ladders."""
    summary = json.loads((results / "tradeoff.json").read_text(encoding="utf-8"))
    if not all(summary["ladders"].values()):
        raise SystemExit("a ladder is empty: measure all contact models first")
    told = {
        "made_by": "python -m validation.adopt.tradeoff, from `snakemake -s validation/Snakefile tradeoff`",
        "sample": summary["sample"],
        "ladders": summary["ladders"],
    }
    LADDERS.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
    DATA.mkdir(exist_ok=True)
    shutil.copy(results / "tradeoff.json", DATA / "tradeoff.json")
    shutil.copy(results / "figures" / "index.json", DATA / "tradeoff_figures.json")
    copy_figures(results, [picture.stem for picture in (results / "figures").glob("tradeoff_*.png")])
    subprocess.run([sys.executable, str(FOLDER / "generate.py")], check=True)


if __name__ == "__main__":
    adopt(Path(sys.argv[1] if len(sys.argv) > 1 else "results/tradeoff"))
