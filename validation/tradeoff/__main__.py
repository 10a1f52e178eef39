"""Measure error against cost.

    python -m validation.tradeoff SIZES.yaml parts/NAME.nc            measures one part
    python -m validation.tradeoff SIZES.yaml OUT.nc parts/*.nc        gathers the parts and draws the figures

The second form writes the summary and the figures beside OUT.nc.
"""

import json
import sys
from pathlib import Path

import xarray as xr

from trackroller.files import write_whole
from validation.tradeoff.figures import draw_all
from validation.tradeoff.parts import write_gathered, write_part
from validation.tradeoff.summary import summary


def show(measured: Path) -> None:
    """Write `tradeoff.json` and `figures/` beside a gathered measurement."""
    ds = xr.load_dataset(measured)
    found = summary(ds)
    draw_all(found, ds, measured.parent / "figures")
    text = json.dumps(found, indent=1, ensure_ascii=False) + "\n"
    write_whole(measured.with_name("tradeoff.json"), lambda beside: beside.write_text(text, encoding="utf-8"))


if __name__ == "__main__":
    sizes, out, *parts = sys.argv[1:]
    if parts:
        write_gathered(parts, sizes, out)
        show(Path(out))
    else:
        write_part(Path(out).stem, sizes, out)
