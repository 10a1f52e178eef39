"""Settings for all tests."""

from __future__ import annotations

import os
import signal

import pytest
from hypothesis import settings

# `make test` has a process for each core; more threads would only wait for each other
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    os.environ.setdefault("NUMBA_NUM_THREADS", "1")

# what the developer's terminal says about itself must not fold the lines that tests read
for name in ("COLUMNS", "LINES", "FORCE_COLOR", "TTY_COMPATIBLE"):
    os.environ.pop(name, None)

# in the background of a shell, pytest ignores Ctrl-C, and the programs that tests interrupt would inherit that
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# a busy machine must not fail a test: the benchmarks in validation/ measure what an example costs
settings.register_profile("trackroller", deadline=None)
settings.load_profile("trackroller")

REQUIRED = "TRACKROLLER_REQUIRE_TOOLS"  # CI sets it: a missing tool fails a test there instead of skipping it


@pytest.fixture
def estimates(monkeypatch):
    """Let results state the estimates that a tolerance is held against, see `trackroller.roller.told_errors`."""
    monkeypatch.setattr("trackroller.roller.solver.calibrate", lambda *_: None)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    """Turn a skipped test into a failed one where all tools must be there."""
    report = yield
    reason = str(report.longrepr[-1]) if isinstance(report.longrepr, tuple) else ""
    if os.environ.get(REQUIRED) and report.skipped and not hasattr(report, "wasxfail") and "no right to" not in reason:
        report.outcome, report.longrepr = "failed", f"{reason}: {REQUIRED} forbids to skip"
    return report


def pytest_collection_modifyitems(items):
    """Start with whole workflows: they take longest, and at the end one process would wait for the other."""
    items.sort(key=lambda item: item.path.parent.name != "workflow")


def pytest_terminal_summary(terminalreporter):
    """Say how many tests were skipped, so that they are not taken for passed tests."""
    if skipped := len(terminalreporter.stats.get("skipped", ())):
        terminalreporter.write_line(f"{skipped} tests did not run here for the reasons above; .ci/run runs them all.")
