"""Take results over into the documentation and the package: data, figures, and the pages that show them.

    python -m validation.adopt [TARGET ...] [--results FOLDER]

Targets are those of `validation/Snakefile`; without a target, all that FOLDER (default `results`) holds. What was not
measured again stays. `tradeoff` also writes the ladders of settings of the package. The presets follow from the
ladders, so numbers of solutions may change. Studies solve their cases anew by themselves then, because the ladders are
part of the solver's digest. `benchmarks` also writes the costs that `plan` uses, and `kalker_table` the table of the
package.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from PIL import Image

from trackroller.contact.table import spline
from trackroller.parameters import contact_models
from trackroller.roller import accuracy
from validation.benchmarks import groove, programs, scaling, trade

DOCS = Path(__file__).resolve().parents[1] / "docs"
DATA, FIGURES = DOCS / "data", DOCS / "figures"
LADDERS = Path(accuracy.__file__).with_name("accuracy.json")
TABLE = Path(spline.__file__).with_name(spline.TABLE)
COSTS = contact_models.FILE
TARGETS = ("extremes", "tradeoff", "paper", "contact_models", "kalker_table", "benchmarks")
# figures that the pages show, by target: pattern of their names, and colours of the reduced palette, if it is reduced
PICTURES = {
    "extremes": ("extremes_*.png", 0),
    "tradeoff": ("tradeoff_*.png", 0),
    "paper": ("paper_*.png", 96),
    "contact_models": ("models-*.png", 64),
}


def ladders() -> str:
    """Return the text of the file of ladders from the stored data."""
    summary = json.loads((DATA / "tradeoff.json").read_text(encoding="utf-8"))
    content = {
        "made_by": "python -m validation.adopt tradeoff, from `snakemake -s validation/Snakefile tradeoff`",
        "sample": summary["sample"],
        "ladders": summary["ladders"],
    }
    return json.dumps(content, indent=1) + "\n"


def costs() -> str:
    """Return the text of the file of costs from the stored data: those of forces, and of peaks in addition."""
    content: dict[str, Any] = {"made_by": "python -m validation.adopt benchmarks, from validation.benchmarks.trade"}
    measured = json.loads((DATA / "trade.json").read_text(encoding="utf-8"))
    for kind, rows in (("models", measured["rows"]), ("falling", measured["falling"])):
        models = content[kind] = {}
        for row in rows:
            forces, complete = row["forces"], max(row["complete"], row["forces"])
            models.setdefault(row["model"], {})[str(row["accuracy"])] = [round(forces, 4), round(complete - forces, 4)]
    return json.dumps(content, indent=1) + "\n"


def copy_figures(folder: Path, pattern: str, colours: int) -> None:
    """Copy PNGs; a reduced palette keeps the repository small."""
    for source in sorted(folder.glob(pattern)):
        name = source.name.replace("models-", "contact_models_").replace("-", "_")
        if colours:
            with Image.open(source) as image:
                image.convert("RGB").quantize(colours).save(FIGURES / name, optimize=True)
        else:
            shutil.copy(source, FIGURES / name)


def adopt(target: str, results: Path) -> None:
    """Copy data and figures of one target.

    Parameters
    ----------
    target : str
        One of `TARGETS`.
    results : Path
        The folder that holds the folders of the targets.

    Raises
    ------
    SystemExit
        If the trade-off left out a contact model: its ladder would be empty.
    """
    folder = results / target
    if target == "benchmarks":
        for name in programs():
            if (folder / f"{name}.json").is_file():
                shutil.copy(folder / f"{name}.json", DATA)
        measured = json.loads((DATA / "scaling.json").read_text(encoding="utf-8"))
        scaling.draw(measured["by_size"], measured["by_accuracy"], FIGURES)
        trade.draw(json.loads((DATA / "trade.json").read_text(encoding="utf-8")), FIGURES)
        COSTS.write_text(costs(), encoding="utf-8")
        groove.draw(json.loads((DATA / "groove.json").read_text(encoding="utf-8")), FIGURES)
        return
    data = folder / f"{target}.json"
    if target == "tradeoff" and not all(json.loads(data.read_text(encoding="utf-8"))["ladders"].values()):
        raise SystemExit("a ladder is empty: measure all contact models first")
    shutil.copy(data, DATA)
    if target in PICTURES:
        copy_figures(folder / "figures", *PICTURES[target])
        if target != "contact_models":  # its template writes the captions
            shutil.copy(folder / "figures" / "index.json", DATA / f"{target}_figures.json")
    if target == "tradeoff":
        LADDERS.write_text(ladders(), encoding="utf-8")
    if target == "kalker_table":
        shutil.copy(folder / "kalker_table.npz", TABLE)


def main() -> None:
    """Adopt the targets of the command line and write the pages, in a process of its own that reads the new data."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("targets", nargs="*", choices=[*TARGETS, []], metavar="TARGET")
    parser.add_argument("--results", type=Path, default=DOCS.parent / "results")
    given = parser.parse_args()
    for target in given.targets or [name for name in TARGETS if (given.results / name).is_dir()]:
        adopt(target, given.results)
    subprocess.run([sys.executable, str(DOCS / "generate.py")], check=True)


if __name__ == "__main__":
    main()
