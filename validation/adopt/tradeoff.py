"""Copy results/tradeoff: ladders into the package; page, data and figures into the docs.

    python -m validation.adopt.tradeoff [results/tradeoff]

The presets follow from the ladders, so numbers of solutions may change: run the tests. Studies solve their cases anew
by themselves, because the file of ladders is part of the solver's digest. With `--check` it only compares the ladders
of the package with the kept data and ends with 1 if they differ; `python docs/generate.py --check` compares the page.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from trackroller.roller import accuracy
from validation.adopt.common import DATA, copy_figures, main, write_generated

KEPT = DATA / "tradeoff.json"
LADDERS = Path(accuracy.__file__).with_name("accuracy.json")


def ladders() -> str:
    """Return the text of the file of ladders from the stored data."""
    summary = json.loads(KEPT.read_text(encoding="utf-8"))
    told = {
        "made_by": "python -m validation.adopt.tradeoff, from `snakemake -s validation/Snakefile tradeoff`",
        "sample": summary["sample"],
        "ladders": summary["ladders"],
    }
    return json.dumps(told, indent=1) + "\n"


def adopt(results: Path) -> None:
    """Copy data and figures; a measurement that left out a contact model is refused."""
    measured = results / "tradeoff.json"
    if not all(json.loads(measured.read_text(encoding="utf-8"))["ladders"].values()):
        raise SystemExit("a ladder is empty: measure all contact models first")
    shutil.copy(measured, KEPT)
    shutil.copy(results / "figures" / "index.json", DATA / "tradeoff_figures.json")
    copy_figures(results, [picture.stem for picture in (results / "figures").glob("tradeoff_*.png")])


if __name__ == "__main__":
    main("tradeoff", LADDERS, ladders, adopt)
    write_generated()
