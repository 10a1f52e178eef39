"""Take the table of the exact theory over into the package.

`snakemake -s validation/Snakefile --cores all kalker_table; python -m validation.adopt.kalker_table [FOLDER]`
"""

from __future__ import annotations

import shutil
from pathlib import Path

from trackroller.contact.table import spline
from validation.adopt.common import DATA, results_of


def main() -> None:
    """Copy the table into the package and its measured errors into the docs."""
    results = results_of("kalker_table")
    shutil.copy(results / spline.TABLE, Path(spline.__file__).with_name(spline.TABLE))
    shutil.copy(results / "errors.json", DATA / "kalker_table.json")


if __name__ == "__main__":
    main()
