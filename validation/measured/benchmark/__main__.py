"""Print the errors of all programs of the benchmark, and of further files.

python -m validation.measured.benchmark [FILE ...]
"""

from __future__ import annotations

import sys
from pathlib import Path

from trackroller.errors import InputError
from trackroller.report.terminal import print_table
from validation.measured.benchmark.table import HEADS, all_programs, error_rows

if __name__ == "__main__":
    try:
        rows = error_rows(all_programs(Path(word) for word in sys.argv[1:]))
    except InputError as error:
        print("\n".join(error.shown), file=sys.stderr)
        sys.exit(2)
    print_table(HEADS, rows)
