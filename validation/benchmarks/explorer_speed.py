"""Time of the explorer in headless Chromium: opening a page, and a brush until the views are drawn.

    python -m validation.benchmarks.explorer_speed [ROWS]

Wall time of 100,000 made-up rows (or ROWS) on an otherwise idle machine; the goals are 3 s and 100 ms.
"""

from __future__ import annotations

import sys
import tempfile
import time
from contextlib import closing
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.report.explorer.page import write_explorer

TESTS = Path(__file__).resolve().parents[2] / "tests"  # made-up rows and the driver of the browser
BRUSHES = 20
READY = """new MutationObserver(() => {
    if (document.querySelector('#explorer[data-ready]')) window.readyAt ??= performance.now();
}).observe(document, {subtree: true, childList: true, attributes: true, attributeFilter: ['data-ready']})"""
BRUSH = """(async high => {
    const start = performance.now();
    trackroller.select({friction_coefficient: [0.02, high]});
    const filtered = performance.now();
    await new Promise(done => requestAnimationFrame(() => setTimeout(done)));
    return [filtered - start, performance.now() - start];
})"""


def measure(rows: int) -> dict[str, Any]:
    """Return the size of the page [MB], the times to open it [s], and filtered and drawn times of brushes [ms]."""
    sys.path.insert(0, str(TESTS))
    browsers, made_up = import_module("browser"), import_module("synthetic_results")
    with tempfile.TemporaryDirectory() as folder, closing(browsers.Browser()) as browser:
        path = Path(folder) / "study.nc"
        made_up.sampled_study(rows).to_netcdf(path)
        written = write_explorer(path)
        start = time.perf_counter()
        page = browser.open(written, before=READY)
        wall = time.perf_counter() - start
        page.call("Performance.enable", timeDomain="threadTicks")
        before = busy(page)
        times = [page.run(f"{BRUSH}({high})") for high in np.linspace(0.1, 0.4, BRUSHES)]
        found = {"brushes": np.array(times), "work": (busy(page) - before) / BRUSHES}
        found |= {"size": written.stat().st_size / 1e6, "wall": wall, "opened": page.run("window.readyAt") / 1e3}
        return found


def busy(page: Any) -> float:
    """Return the processor time that the page has used so far [ms]."""
    told = page.call("Performance.getMetrics")["metrics"]
    return next(metric["value"] for metric in told if metric["name"] == "TaskDuration") * 1e3


def main() -> None:
    """Print the sizes and times."""
    rows = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
    found = measure(rows)
    filtered, drawn = found["brushes"].T
    print(f"{rows:,} rows, page of {found['size']:.1f} MB")
    print(f"open: {found['opened']:.2f} s measured in the page, {found['wall']:.2f} s with the opening of a tab")
    for words, values in (("counted and filtered", filtered), ("and drawn", drawn)):
        print(f"a brush {words}, wall: median {np.median(values):.0f} ms, largest {values.max():.0f} ms")
    print(f"a brush, processor time of the page: mean {found['work']:.0f} ms")


if __name__ == "__main__":
    main()
