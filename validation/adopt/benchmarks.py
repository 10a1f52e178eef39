"""Take results/benchmarks and results/peers over into docs/data, and write the pages that show them.

    python -m validation.adopt.benchmarks [RESULTS]

`snakemake -s validation/Snakefile --cores all benchmarks peers` measures; single programs write one file each with
`python -m validation.benchmarks.NAME --output results/benchmarks/NAME.json`. What was not measured again stays.
"""

from __future__ import annotations

import json
import shutil

from validation.adopt.common import DATA, FIGURES, results_of, write_generated
from validation.benchmarks import programs, scaling


def main() -> None:
    """Copy the data files, draw the figure of `scaling` and write the pages."""
    results = results_of("")
    files = [results / "benchmarks" / f"{name}.json" for name in programs()] + [results / "peers" / "peers.json"]
    for path in files:
        if path.is_file():
            shutil.copy(path, DATA / path.name)
    measured = json.loads((DATA / "scaling.json").read_text(encoding="utf-8"))
    scaling.draw(measured["by_size"], measured["by_accuracy"], FIGURES)
    write_generated()


if __name__ == "__main__":
    main()
