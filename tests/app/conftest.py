"""One server for the tests that only ask it, and a browser for those that look at it."""

from __future__ import annotations

import pytest
from browser import Browser
from live_page import LivePage


@pytest.fixture(scope="session")
def live(tmp_path_factory):
    pytest.importorskip("tornado")
    page = LivePage(tmp_path_factory.mktemp("live"))
    yield page
    page.stop()


@pytest.fixture(scope="module")
def browser():
    running = Browser()
    yield running
    running.close()
