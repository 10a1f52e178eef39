"""Copy figures and errors of results/contact_models into docs, for docs/validation/contact-models.md.

`snakemake -s validation/Snakefile --cores all contact_models; python -m validation.adopt.contact_models [FOLDER]`
"""

from __future__ import annotations

import shutil

from validation.adopt.common import DATA, FIGURES, copy_figures, results_of, write_generated

NAMES = ("error", "error-factors", "energy", "patches")
COLOURS = 64


def main() -> None:
    """Copy the figures under the names that the pages use, and the errors."""
    results = results_of("contact_models")
    copy_figures(results, [f"models-{name}" for name in NAMES], COLOURS)
    for name in NAMES:
        (FIGURES / f"models-{name}.png").replace(FIGURES / f"contact_models_{name.replace('-', '_')}.png")
    shutil.copy(results / "errors.json", DATA / "contact_models.json")
    write_generated()


if __name__ == "__main__":
    main()
