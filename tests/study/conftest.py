"""Settings for the tests of studies."""

from __future__ import annotations

from collections import Counter

import pytest


@pytest.fixture
def solved(tmp_path, monkeypatch):
    """Return a function that counts how often the solver of `fake_solver` solved each case."""
    file = tmp_path / "solved.txt"
    file.touch()
    monkeypatch.setenv("FAKE_SOLVED", str(file))
    return lambda: Counter(file.read_text().splitlines())
