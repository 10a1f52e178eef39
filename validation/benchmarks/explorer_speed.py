"""Time of the explorer in headless Chromium: opening a page, and a brush until the views are drawn.

    python -m validation.benchmarks.explorer_speed [--rows N]

Wall times and processor times of made-up rows, on an otherwise idle machine; the goals are 3 s and 100 ms.
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
from validation.benchmarks.command import run

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


def measure(rows: int = 100_000) -> dict[str, Any]:
    """Return the size of the page [MB], the times to open it [s], and the times of a brush [ms]."""
    sys.path.insert(0, str(TESTS))
    browsers, made_up = import_module("browser"), import_module("synthetic_results")
    with tempfile.TemporaryDirectory() as folder, closing(browsers.Browser()) as browser:
        written = write_explorer(made_up.results_of(made_up.sampled_study(rows)), Path(folder) / "explorer.html")
        start = time.perf_counter()
        page = browser.open(written, before=READY)
        wall = time.perf_counter() - start
        page.call("Performance.enable", timeDomain="threadTicks")
        before = busy(page)
        times = [page.run(f"{BRUSH}({high})") for high in np.linspace(0.1, 0.4, BRUSHES)]
        filtered, drawn = np.array(times).T
        return {
            "megabytes": written.stat().st_size / 1e6,
            "opened_seconds": page.run("window.readyAt") / 1e3,
            "opened_with_a_tab_seconds": wall,
            "brush_filtered_ms": {"median": np.median(filtered), "largest": filtered.max()},
            "brush_drawn_ms": {"median": np.median(drawn), "largest": drawn.max()},
            "brush_processor_ms": (busy(page) - before) / BRUSHES,
        }


def busy(page: Any) -> float:
    """Return the processor time that the page has used so far [ms]."""
    told = page.call("Performance.getMetrics")["metrics"]
    return next(metric["value"] for metric in told if metric["name"] == "TaskDuration") * 1e3


if __name__ == "__main__":
    run(measure, __doc__)
