"""Kills of other kinds than in test_resume and test_workflow, for real; `validation/benchmarks/survive.py` does ten."""

from __future__ import annotations

from validation.benchmarks import survive


def test_killed_while_solving_and_while_gathering_no_finished_case_is_solved_again():
    small = survive.STUDY.replace("[0, 60, 40]", "[0, 60, 6]").replace(", 8]", ", 5]").replace("140", "60")
    kills = [(survive.RUN, survive.ALL, "solving"), (survive.FLOW, survive.ALL, "gathering")]
    assert survive.ride(kills, study=small) == []
