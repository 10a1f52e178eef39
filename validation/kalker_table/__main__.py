"""Build the table of the exact theory.

    python -m validation.kalker_table levels/N.npz [--small]          solves one level of rho
    python -m validation.kalker_table TABLE.npz levels/*.npz          joins the levels and measures the errors

The second form writes the measured numbers beside the table, as TABLE.json.
"""

import sys
from pathlib import Path

import numpy as np

from validation.kalker_table.build import solve_level
from validation.kalker_table.measure import write_measured

if __name__ == "__main__":
    path, *more = (word for word in sys.argv[1:] if word != "--small")
    if more:
        write_measured([Path(file) for file in more], Path(path), Path(path).with_suffix(".json"))
    else:
        arrays = solve_level(int(Path(path).stem), small="--small" in sys.argv)
        np.savez_compressed(path, **arrays)  # type: ignore[arg-type]
