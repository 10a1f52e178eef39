"""Kill real runs while they solve and while they gather; `validation/benchmarks/survive.py` kills eleven times."""

from __future__ import annotations

import pytest

from validation.benchmarks import survive


@pytest.mark.slow
def test_killed_while_solving_and_while_gathering_no_finished_case_is_solved_again():
    small = survive.STUDY.replace("[0, 60, 40]", "[0, 60, 6]").replace(", 8]", ", 5]").replace("140", "60")
    kills = [(survive.RUN, survive.ALL, "solving"), (survive.FLOW, survive.ALL, "gathering")]
    assert survive.ride(kills, study=small) == []
