"""Copy figures and errors of results/contact_models into docs, for docs/validation/contact-models.md.

`snakemake -s validation/Snakefile --cores all contact_models; python -m validation.adopt.contact_models [FOLDER]`
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from validation.adopt.common import DATA, FIGURES, FOLDER, copy_figures

NAMES = ("error", "error-factors", "energy", "patches")
COLOURS = 64


def main() -> None:
    """Copy the figures under the names that the pages use, and the errors."""
    results = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER.parent / "results" / "contact_models"
    copy_figures(results, [f"models-{name}" for name in NAMES], COLOURS)
    for name in NAMES:
        (FIGURES / f"models-{name}.png").replace(FIGURES / f"contact_models_{name.replace('-', '_')}.png")
    shutil.copy(results / "errors.json", DATA / "contact_models.json")
    subprocess.run([sys.executable, str(FOLDER / "generate.py")], check=True)


if __name__ == "__main__":
    main()
