"""Take the table of the exact theory over into the package.

`snakemake -s validation/Snakefile --cores all kalker_table; python -m validation.adopt.kalker_table [FOLDER]`
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from trackroller.contact.table import spline
from validation.adopt.common import DATA, FOLDER


def main() -> None:
    """Copy the table into the package and its measured errors into the docs."""
    results = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER.parent / "results" / "kalker_table"
    shutil.copy(results / spline.TABLE, Path(spline.__file__).with_name(spline.TABLE))
    shutil.copy(results / "errors.json", DATA / "kalker_table.json")


if __name__ == "__main__":
    main()
