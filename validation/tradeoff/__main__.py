"""Measure error against cost.

    python -m validation.tradeoff SIZES.yaml parts/NAME.nc            measures one part
    python -m validation.tradeoff SIZES.yaml OUT.nc parts/*.nc        gathers the parts and draws the figures

The second form writes the summary and the figures beside OUT.nc.
"""

import json
import sys
from pathlib import Path

import xarray as xr

from trackroller.files import write_text
from validation.tradeoff.figures import draw_all
from validation.tradeoff.parts import write_gathered, write_part
from validation.tradeoff.summary import summary


def show(measured: Path) -> None:
    """Write `tradeoff.json` and `figures/` beside a gathered measurement."""
    found = summary(xr.load_dataset(measured))
    draw_all(found, measured.parent / "figures")
    write_text(measured.with_name("tradeoff.json"), json.dumps(found, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    sizes, out, *parts = sys.argv[1:]
    if parts:
        write_gathered(parts, sizes, out)
        show(Path(out))
    else:
        write_part(Path(out).stem, sizes, out)
