"""Take results over into the documentation and the package: data, figures, and the pages that show them.

    python -m validation.adopt [TARGET ...] [--results FOLDER]

Targets are those of `validation/Snakefile`; without a target, all that FOLDER (default `results`) holds. What was not
measured again stays. `tradeoff` also writes the costs that `plan` uses and the errors that results state; studies solve
their cases anew by themselves then, because these errors are part of the solver's digest. `kalker_table` also writes
the table of the package, and `measured` our entry in the benchmark.
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
from trackroller.parameters.accuracy import RUNGS
from trackroller.roller import expected_errors
from validation.benchmarks import groove, programs, scaling
from validation.measured.benchmark.entry import OURS
from validation.measured.benchmark.table import PROGRAMS as ENTRIES

DOCS = Path(__file__).resolve().parents[1] / "docs"
DATA, FIGURES = DOCS / "data", DOCS / "figures"
ERRORS = Path(expected_errors.__file__).with_name(expected_errors.FILE)
TABLE = Path(spline.__file__).with_name(spline.TABLE)
COSTS = contact_models.FILE
TARGETS = ("extremes", "tradeoff", "paper", "contact_models", "fits", "measured", "kalker_table", "benchmarks")
# figures that the pages show, by target: pattern of their names, and colours of the reduced palette, if it is reduced
PICTURES = {
    "extremes": ("extremes_*.png", 0),
    "tradeoff": ("tradeoff*.png", 0),
    "paper": ("paper_*.png", 96),
    "measured": ("measured_*.png", 0),
    "contact_models": ("models-*.png", 64),
}


MADE_BY = "python -m validation.adopt tradeoff, from `snakemake -s validation/Snakefile tradeoff`"


def _measured() -> Any:
    return json.loads((DATA / "tradeoff.json").read_text(encoding="utf-8"))


def errors() -> str:
    """Return the text of the file of errors from the stored data.

    Errors of discretisation have median, 95 and 99 %, and bound; told errors have their factors and errors of ratios.
    """
    models: dict[str, Any] = {}
    for row in _measured()["rungs"]:
        levels = {name: [float(f"{float(v):.3g}") for v in own] for name, own in row["levels"].items()}
        models.setdefault(row["model"], {})[row["accuracy"]] = levels
    told: dict[str, Any] = {}
    for row in _measured()["told"]:
        own = {part: {name: float(f"{v:.3g}") for name, v in row[part].items()} for part in ("weights", "ratio")}
        told.setdefault(row["model"], {})[row["accuracy"]] = own
    return json.dumps({"made_by": MADE_BY, "models": models, "told": told}, indent=1) + "\n"


def costs() -> str:
    """Return the text of the file of costs from the stored data: those of forces, and of peaks in addition."""
    measured = _measured()
    ordinary, wide = measured["costs"].values()
    both = [
        own | {name: 0.5 * (own[name] + other[name]) for name in ("complete", "forces")}
        for own, other in zip(ordinary, wide, strict=True)
    ]
    content: dict[str, Any] = {"made_by": MADE_BY}
    for kind, rows in (("models", both), ("falling", measured["falling"])):
        models = content[kind] = {}
        for row in rows:
            if row["accuracy"] in RUNGS:
                forces, complete = row["forces"], max(row["complete"], row["forces"])
                own = [round(forces, 4), round(complete - forces, 4)]
                models.setdefault(row["model"], {})[row["accuracy"]] = own
    content["shares"] = measured["shares"]
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
    """
    folder = results / target
    if target == "benchmarks":
        for name in programs():
            if (folder / f"{name}.json").is_file():
                shutil.copy(folder / f"{name}.json", DATA)
        measured = json.loads((DATA / "scaling.json").read_text(encoding="utf-8"))
        scaling.draw(measured["by_size"], measured["by_accuracy"], FIGURES)
        groove.draw(json.loads((DATA / "groove.json").read_text(encoding="utf-8")), FIGURES)
        return
    data = folder / f"{target}.json"
    shutil.copy(data, DATA)
    if target in PICTURES:
        of_study = target == "contact_models"  # a study has a folder of its own; its template writes the captions
        copy_figures(folder / "study" / "figures" if of_study else folder / "figures", *PICTURES[target])
        if not of_study:
            shutil.copy(folder / "figures" / "index.json", DATA / f"{target}_figures.json")
    if target == "measured":
        shutil.copy(folder / "entry.csv", ENTRIES / f"{OURS}.csv")
    if target == "tradeoff":
        ERRORS.write_text(errors(), encoding="utf-8")
        COSTS.write_text(costs(), encoding="utf-8")
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
