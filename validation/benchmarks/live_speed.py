"""Time of the live page in headless Chromium: from the event of a slider to its picture, and the answers of the server.

    python -m validation.benchmarks.live_speed [--steps N]

Wall times, and the processor time of the server, on an otherwise idle machine. The goals are a median of 60 ms and
120 ms for 95 % with `preview`, 250 ms for `standard`, and 4 s from the command to the first picture.
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
import psutil

from validation.benchmarks.command import run

TESTS = Path(__file__).resolve().parents[2] / "tests"  # the started page and the driver of the browser
PAUSE = 200  # ms between two steps of the slider
STEP = """(async (value) => {
    const slider = document.querySelector('[aria-label="Axial force, slider"]');
    const before = trackroller.times.length;
    slider.value = value;
    slider.dispatchEvent(new Event('input'));
    while (trackroller.times.length === before) await new Promise(requestAnimationFrame);
    return trackroller.times.at(-1);
})"""
ANSWER = """(async (value, accuracy) => {
    const body = JSON.stringify({values: {axial_force: value}, accuracy, page: 'benchmark'});
    const start = performance.now();
    await (await fetch('api/picture', {method: 'POST', headers: {'Content-Type': 'application/json'}, body})).json();
    return performance.now() - start;
})"""


def measure(steps: int = 60) -> dict[str, Any]:
    """Return the time to the first picture [s], and of slider and answers the median and the 95 % quantile [ms]."""
    sys.path.insert(0, str(TESTS))
    browsers, pages = import_module("browser"), import_module("live_page")
    with tempfile.TemporaryDirectory() as folder, closing(browsers.Browser()) as browser:
        start = time.perf_counter()
        live = pages.LivePage(Path(folder))
        with closing(browsers.Page(browser, live.address, width=1280, height=800)) as page:
            page.until("document.querySelector('.drawing') !== null")
            first = time.perf_counter() - start
            page.until("document.querySelector('.stage').dataset.stage === 'complete'")
            forces = np.linspace(10.0, 70.0, steps)
            moved = []
            for force in forces:
                moved.append(page.run(f"{STEP}({force:.1f})"))
                time.sleep(PAUSE / 1e3)
            server = psutil.Process(live.process.pid)
            out: dict[str, Any] = {"first_picture_seconds": first, "slider_ms": _quantiles(moved)}
            for accuracy in ("preview", "standard"):
                before = sum(server.cpu_times()[:2])
                answers = [page.run(f"{ANSWER}({force + 0.05:.3f}, '{accuracy}')") for force in forces]
                busy = (sum(server.cpu_times()[:2]) - before) / steps * 1e3
                out[f"answer_{accuracy}_ms"] = _quantiles(answers) | {"processor": busy}
        live.stop()
    return out


def _quantiles(times: list[float]) -> dict[str, float]:
    return {"median": float(np.median(times)), "quantile_95": float(np.quantile(times, 0.95))}


if __name__ == "__main__":
    run(measure, __doc__)
