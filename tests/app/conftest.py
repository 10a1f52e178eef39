"""One server for the tests that only ask it."""

from __future__ import annotations

import pytest
from live_page import LivePage


@pytest.fixture(scope="session")
def live(tmp_path_factory):
    pytest.importorskip("tornado")
    page = LivePage(tmp_path_factory.mktemp("live"))
    yield page
    page.stop()
